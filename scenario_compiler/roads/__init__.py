"""Roads: OpenDRIVE in, a `Network` out.

What enters: an OpenDRIVE file of version 1.1 to 1.8 (`load_network`). What leaves: a `Network`, which
answers questions about
poses, lanes, marks and routes by road id, and its `RoadTables`, flat columns that the compiled functions of
`geometry`, `lanes`,
`locate`, `travel` and `marks` read; engine and camera call the same ones. Faults in the file leave as
diagnostics. Imports the hall
(diagnostics, document, marker, resources) and nothing else of ours.
"""

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
