"""Roads: OpenDRIVE in, a `Network` out.

In: an OpenDRIVE file of version 1.1 to 1.8 (`load_network`). Out: a `Network`, which answers questions about poses,
lanes, marks and routes by road id, and its `RoadTables`, flat columns that the marked functions of `geometry`, `lanes`,
`locate`, `travel` and `marks` read; engine and camera call the same ones. Faults in the file are diagnostics. Imports
the hall and nothing else of ours. What is named here is imported when it is first asked for, so that the engine's
machine code can be made without the packages that reading a file needs.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from scenario_compiler.roads.network import Network, load_network
    from scenario_compiler.roads.positions import (
        LaneAt,
        LanePosition,
        Leg,
        Located,
        Mark,
        MarkStretch,
        Pose,
        RoadDescription,
        Route,
        SecondaryLine,
    )

__all__ = [
    "LaneAt",
    "LanePosition",
    "Leg",
    "Located",
    "Mark",
    "MarkStretch",
    "Network",
    "Pose",
    "RoadDescription",
    "Route",
    "SecondaryLine",
    "load_network",
]

_OF_NETWORK = ("Network", "load_network")


def __getattr__(name: str) -> object:
    """Import a public name from its home on first use."""
    if name not in __all__:
        raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
    home = "network" if name in _OF_NETWORK else "positions"
    return getattr(importlib.import_module(f"{__name__}.{home}"), name)
