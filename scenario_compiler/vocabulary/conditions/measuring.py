"""Measurement and comparison in conditions: ASAM's rules, coordinate systems and directions."""

from typing import Literal, get_args

Rule = Literal["lessThan", "lessOrEqual", "greaterThan", "greaterOrEqual", "equalTo", "notEqualTo"]
"""Comparison of a measured value."""

ORDERS: tuple[Rule, ...] = ("lessThan", "lessOrEqual", "greaterThan", "greaterOrEqual")
"""The rules that need an order of the values."""

CoordinateSystem = Literal["entity", "lane", "road", "trajectory", "world"]
COORDINATE_SYSTEMS: tuple[CoordinateSystem, ...] = get_args(CoordinateSystem)
"""Coordinate systems in which a distance is measured."""

OwnSystem = Literal["entity", "lane", "road", "trajectory"]
"""Coordinate systems in which a distance is kept: those that turn with the entity or its way, along which it moves."""

DistanceType = Literal["euclidianDistance", "longitudinal", "lateral"]
"""Kind of distance: the straight one, or its component along or across."""

Direction = Literal["total", "longitudinal", "lateral", "vertical"]
"""Component of a velocity or acceleration, in the entity's own axes."""

ENTITY = "Id of the triggering entity; the actor that contains the <when> if left out."
RULE = "Comparison with the limit. By default the value must be less than the limit."
FREESPACE = "Whether the distance is measured between the bounding boxes, not between the reference points."
COORDINATES = "Coordinate system of the measurement."
DISTANCE = "Kind of distance."
