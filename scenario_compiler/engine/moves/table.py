"""The table of all actions in the order of their opcodes, and tables derived from their entries."""

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
"""The modules of the actions, one for each family."""

ACTIONS: tuple[Entry, ...] = tuple(
    one for family in FAMILIES for one in vars(family).values() if isinstance(one, Entry)
)
"""Every action in the order of the families; the index of an action is its opcode."""

STARTS = tuple(entry.start for entry in ACTIONS)
STEPS = tuple(entry.step for entry in ACTIONS)
HOLDS = tuple(entry.holds for entry in ACTIONS)
ENDS = tuple(entry.holds | entry.ends for entry in ACTIONS)
RELATIVE = tuple(entry.relative for entry in ACTIONS)
TOLD = tuple(1 if entry.told is not None else 0 for entry in ACTIONS)
"""By opcode: start, step, controlled domains, domains in which it ends other actions, when it depends on another
entity, and whether it is logged.
"""

NUMBERS: dict[str, int] = {tag: number for number, entry in enumerate(ACTIONS) for tag in entry.words}
"""Opcode of the action to which a word is lowered, by the word's tag."""
