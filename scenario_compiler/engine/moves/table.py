"""The table of all actions in the order of their numbers, and tables derived from their entries."""

from __future__ import annotations

from types import ModuleType

from scenario_compiler.engine.moves import (
    appearance,
    camera,
    control,
    follow_path,
    keeping_aside,
    keeping_distance,
    lane_changes,
    lane_offsets,
    places,
    routing,
    run,
    signals,
    speed_profiles,
    speeds,
    synchronizing,
    takeover,
    traffic,
    trajectories,
    variables,
)
from scenario_compiler.engine.moves.entry import Entry

FAMILIES: tuple[ModuleType, ...] = (
    *(speeds, speed_profiles, keeping_distance, synchronizing),
    *(lane_changes, lane_offsets, keeping_aside, follow_path, trajectories),
    *(routing, places, control, appearance, camera, run, variables, signals, traffic, takeover),
)
"""The modules of the actions, one a family."""

ACTIONS: tuple[Entry, ...] = tuple(
    one for family in FAMILIES for one in vars(family).values() if isinstance(one, Entry)
)
"""Every action, as the families declare them; its place is the number that a program has for it."""

STARTS = tuple(entry.start for entry in ACTIONS)
STEPS = tuple(entry.step for entry in ACTIONS)
HOLDS = tuple(entry.holds for entry in ACTIONS)
TOLD = tuple(1 if entry.told is not None else 0 for entry in ACTIONS)
"""By the number of an action: its start, its step, the domains that it holds, whether it is logged."""

NUMBERS: dict[str, int] = {tag: number for number, entry in enumerate(ACTIONS) for tag in entry.words}
"""Number of the action that a word becomes, by the word's tag."""
