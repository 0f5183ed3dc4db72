"""How conditions measure and compare: ASAM's rules, coordinate systems and directions."""

from typing import Literal

Rule = Literal["lessThan", "lessOrEqual", "greaterThan", "greaterOrEqual", "equalTo", "notEqualTo"]
"""How a measured value is compared."""

CoordinateSystem = Literal["entity", "lane", "road", "trajectory", "world"]
"""In which system a distance is measured."""

DistanceType = Literal["euclidianDistance", "longitudinal", "lateral"]
"""Which distance is meant: the straight one, or its part along or across."""

Direction = Literal["total", "longitudinal", "lateral", "vertical"]
"""Which part of a velocity or acceleration is meant, in the entity's own axes."""

ENTITY = "Id of the triggering entity; the actor that holds the <when> when left out."
RULE = "How it is compared with the limit, where `less than` is not meant."
FREESPACE = "Whether it is measured between the boxes, not the reference points."
COORDINATES = "In which system it is measured."
DISTANCE = "Which distance is meant."
