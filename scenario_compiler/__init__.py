"""A scenario compiler: it turns conflicts written in XML into runs with a takeover and a report.

Programs import from here everything that they need to build, compile, run, judge, report and sweep scenarios;
docs/python-api.md has examples. `scenario_compiler.perception` does the same for pictures. `__init__.pyi` lists the
names. Each name is imported from its module when it is first used, so that importing this package takes no time.
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
