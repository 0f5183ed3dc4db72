"""Actions across the lanes."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.actions.longitudinal import Shape
from scenario_compiler.vocabulary.word import Number, Word, attribute


class LaneChangeAction(Word):
    """Move to a neighbouring lane, relative to the lane the entity is in."""

    word: Literal["lane_change"] = "lane_change"

    by: int = attribute(
        "Number of lanes, positive to the left in the entity's direction of travel, negative to the right."
    )
    over_time: Number = attribute("Duration of the change, s.", quantity="time", minimum=0)
    shape: Shape = attribute("How the offset goes from one lane to the other.", default="sinusoidal")


class LaneOffsetAction(Word):
    """Move sideways within the lane, or out of it: to an offset from the lane's centre."""

    word: Literal["lane_offset"] = "lane_offset"

    to: Number = attribute(
        "Distance from the lane's centre, m, positive to the left in the entity's direction of travel.",
        quantity="length",
    )
    over_time: Number = attribute("Duration of the move, s.", quantity="time", minimum=0)
    shape: Shape = attribute("How the offset goes from its present value to the target.", default="sinusoidal")
