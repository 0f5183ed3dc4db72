"""Declarative scenario compiler: conflicts written as XML become runs with a takeover and a report.

Whatever programs need to build, compile, run, judge, report and sweep scenarios is imported from here, as
docs/python-api.md tells by example; pictures have a door of their own, `scenario_compiler.perception`. `__init__.pyi`
lists the names. Each is imported from its home when it is first used, so that importing the package costs nothing.
"""

from __future__ import annotations


def __getattr__(name: str) -> object:
    """Return a public name, imported from its home on first use."""
    from scenario_compiler.public import public_object

    return public_object(__name__, name)


def __dir__() -> list[str]:
    """Return the public names."""
    from scenario_compiler.public import public_names

    return sorted(public_names(__name__))
