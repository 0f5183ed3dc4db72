"""Controllers, which drive the ego from Python at control steps, and the table of their names.

In: camera images, speed and the vehicle's state. Out: throttle, steer and brake. Imports perception, recordings, the
plan, the vocabulary and the hall. Public names are imported when they are first used: a run that calls no controller
does not load what controllers need.
"""

from __future__ import annotations


def __getattr__(name: str) -> object:
    """Return a public name, imported from its module on first use."""
    from scenario_compiler.public import public_object

    return public_object(__name__, name)


def __dir__() -> list[str]:
    """Return the public names."""
    from scenario_compiler.public import public_names

    return sorted(public_names(__name__))
