"""The labels of a picture's pixels in addition to their colour (see `render.Drawing`)."""

from __future__ import annotations

from enum import IntEnum

FARTHEST_DEPTH = 1000.0
"""Depth of the sky, m: the end of CARLA's depth camera."""


class Tag(IntEnum):
    """Kinds of things: the semantic tags of CARLA 0.9.14 to 0.9.16 (`carla.CityObjectLabel`)."""

    UNLABELED = 0
    ROAD = 1
    SIDEWALK = 2
    BUILDING = 3
    WALL = 4
    FENCE = 5
    POLE = 6
    TRAFFIC_LIGHT = 7
    TRAFFIC_SIGN = 8
    VEGETATION = 9
    TERRAIN = 10
    SKY = 11
    PEDESTRIAN = 12
    RIDER = 13
    CAR = 14
    TRUCK = 15
    BUS = 16
    TRAIN = 17
    MOTORCYCLE = 18
    BICYCLE = 19
    STATIC = 20
    DYNAMIC = 21
    OTHER = 22
    WATER = 23
    ROAD_LINE = 24
    GROUND = 25
    BRIDGE = 26
    RAIL_TRACK = 27
    GUARD_RAIL = 28
