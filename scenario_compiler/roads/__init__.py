"""Roads: reads OpenDRIVE files as a `Network`.

In: an OpenDRIVE file of version 1.1 to 1.8 (`load_network`). Out: a `Network`, which answers queries on poses, lanes,
marks and routes by road id, and its `RoadTables`: flat columns that the marked functions of `geometry`, `lanes`,
`locate`, `travel` and `marks` read, which the engine and the camera call too. Faults in the file are diagnostics.
Imports `forms` and the hall. Public names are imported when they are first used, so that the engine's machine code can
be built without the packages that reading a file needs.
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
