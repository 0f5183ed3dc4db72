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
