"""Codes of the lane types and road types of OpenDRIVE 1.1 to 1.8, as plain numbers for the compiled functions.

Lane types that motor traffic may use come first, so that one comparison tells them (`code <= LAST_DRIVABLE`).
"""

from scenario_compiler.marker import compiled

DRIVING = 0
ENTRY = 1
EXIT = 2
ON_RAMP = 3
OFF_RAMP = 4
CONNECTING_RAMP = 5
SLIP_LANE = 6
BIDIRECTIONAL = 7
BUS = 8
TAXI = 9
HOV = 10
SHARED = 11
MOTORWAY_ENTRY = 12
MOTORWAY_EXIT = 13
NO_OVERTAKING_TRUCKS = 14
LAST_DRIVABLE = 14
NONE = 15
SHOULDER = 16
BORDER = 17
STOP = 18
RESTRICTED = 19
PARKING = 20
MEDIAN = 21
BIKING = 22
SIDEWALK = 23
WALKING = 24
CURB = 25
TRAM = 26
RAIL = 27
ROAD_WORKS = 28
SPECIAL_1 = 29
SPECIAL_2 = 30
SPECIAL_3 = 31

LANE_TYPES = (
    *("driving", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "slipLane", "bidirectional", "bus"),
    *(
        "taxi",
        "HOV",
        "shared",
        "mwyEntry",
        "mwyExit",
        "noOvertakeTrucks",
        "none",
        "shoulder",
        "border",
        "stop",
    ),
    *(
        "restricted",
        "parking",
        "median",
        "biking",
        "sidewalk",
        "walking",
        "curb",
        "tram",
        "rail",
        "roadWorks",
    ),
    *("special1", "special2", "special3"),
)
"""The standard's spelling of each code; `walking` is `sidewalk` since 1.8."""

LANE_TYPE_CODES = {name: code for code, name in enumerate(LANE_TYPES)}

ROAD_TYPES = (
    *("unknown", "rural", "motorway", "town", "lowSpeed", "pedestrian", "bicycle", "townExpressway"),
    *("townCollector", "townArterial", "townPrivate", "townLocal", "townPlayStreet"),
)
"""The standard's spelling of each road type code."""

ROAD_TYPE_CODES = {name: code for code, name in enumerate(ROAD_TYPES)}


@compiled
def is_drivable(lane_type: int) -> int:
    """Return 1 for lane types that motor traffic drives on, else 0."""
    if lane_type >= DRIVING and lane_type <= LAST_DRIVABLE:
        return 1
    return 0


@compiled
def is_road(lane_type: int) -> int:
    """Return 1 for every lane type except `none`, which counts as off the road."""
    if lane_type <= LAST_DRIVABLE or lane_type >= SHOULDER:
        return 1
    return 0


@compiled
def is_roadside(lane_type: int) -> int:
    """Return 1 for lane types beside the traffic on which a vehicle may stop: shoulder, border, stop, parking."""
    return 1 if lane_type in (SHOULDER, BORDER, STOP, PARKING) else 0
