"""A program without a storyboard: places for entities that come and go, and are driven from outside."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.motion.watching import WATCH_MOTION
from scenario_compiler.engine.program.checking import check_program

BLOCK = slot.E_PITCH_GRADIENT + 1
"""Size of an entity's block of numbers."""


def build_stage(places: int, roads: int, step: float) -> Program:
    """Return a program that does not end by itself, in which all places for entities are empty.

    Args:
        places: Greatest number of entities at the same time.
        roads: Number of roads of the map.
        step: The time step, s.
    """
    p = Program()
    p.const = [0.0] * (slot.K_ENTITIES + BLOCK * places)
    p.const[slot.K_STEP] = step
    p.const[slot.K_DURATION] = op.FAR
    p.entity_count[0] = places
    p.road_count[0] = roads
    p.watches[0] = WATCH_MOTION
    p.entity_motion = [op.MOTION_BICYCLE] * places
    p.entity_type = [op.KIND_VEHICLE] * places
    p.entity_const = [slot.K_ENTITIES + BLOCK * i for i in range(places)]
    p.entity_order = list(range(places))
    for name in ("entity_position", "entity_guide", "entity_seed"):
        setattr(p, name, [op.NONE] * places)
    for name in ("entity_present", "entity_follows"):
        setattr(p, name, [0] * places)
    check_program(p)
    return p
