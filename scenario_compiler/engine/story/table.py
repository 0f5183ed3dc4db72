"""All conditions, in the order of their numbers, and what follows from their entries."""

from __future__ import annotations

from scenario_compiler.engine.story import clearance, of_entity, of_run
from scenario_compiler.engine.story.entry import Condition

CONDITIONS: tuple[Condition, ...] = (
    *(of_run.TIME, of_run.EVENT, of_run.ELEMENT_STATE),
    *(of_entity.SPEED, of_entity.ACCELERATION, of_entity.TRAVELED_DISTANCE, of_entity.STANDSTILL),
    *(of_entity.END_OF_ROAD, of_entity.OFF_ROAD),
    *(of_entity.TIME_HEADWAY, of_entity.TIME_TO_COLLISION, of_entity.DISTANCE, of_entity.POSITION_DISTANCE),
    *(of_entity.RELATIVE_SPEED, of_entity.REACH_POSITION, of_entity.COLLISION, clearance.CLEARANCE),
    *(of_entity.ANGLE, of_entity.RELATIVE_ANGLE),
    *(of_run.LANE_CONFIDENCE, of_run.SENSOR_HEALTH, of_run.TAKEOVER_STATE),
    *(of_run.TIME_OF_DAY, of_run.VARIABLE_VALUE, of_run.USER_VALUE, of_run.SIGNAL_STATE, of_run.SIGNAL_PHASE),
)
"""Every condition; its place is the number that a program has for it."""

HOLDS = tuple(entry.holds for entry in CONDITIONS)
OF_THE_RUN = tuple(1 if entry.of_the_run else 0 for entry in CONDITIONS)
"""By the number of a condition what evaluates it, and whether it speaks of the run as a whole."""

NUMBERS: dict[str, int] = {tag: number for number, entry in enumerate(CONDITIONS) for tag in entry.words}
"""Number of the condition that a word becomes, by the word's tag."""
