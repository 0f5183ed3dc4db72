"""The bound by which boxes beside the ego's path are left out of times to collision."""

from __future__ import annotations

import numpy as np

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import new_state
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.measures.boxes import (
    OTHER,
    is_off_circle,
    lay_across_circle,
    lay_corners,
    see_heading,
    surely_beside,
)
from scenario_compiler.engine.motion.collision import prepare_boxes, update_boxes
from scenario_compiler.forms.declaration import at_start

BLOCK = slot.E_COUPLER + 1


def pair_of_boxes(dice: np.random.Generator) -> Program:
    """Return a program of the ego and another vehicle with boxes of random sizes."""
    program = Program()
    program.entity_count[:], program.ego[:] = [2], [0]
    program.entity_motion[:] = [op.MOTION_BICYCLE, op.MOTION_SCRIPTED]
    program.entity_const[:] = [slot.K_ENTITIES, slot.K_ENTITIES + BLOCK]
    program.const[:] = [0.0] * (slot.K_ENTITIES + 2 * BLOCK)
    for base in program.entity_const:
        program.const[base + slot.E_LENGTH] = dice.uniform(0.5, 16.0)
        program.const[base + slot.E_WIDTH] = dice.uniform(0.4, 3.0)
        program.const[base + slot.E_CENTER] = dice.uniform(-2.0, 5.0)
    return program


def test_a_box_that_is_surely_beside_the_path_is_not_in_it() -> None:
    dice = np.random.default_rng(1)
    found = {(sure, off): 0 for sure in (0, 1) for off in (0, 1)}
    for _ in range(2000):
        program = pair_of_boxes(dice)
        st, m = new_state(program), at_start(Totals, program)
        prepare_boxes(program, st)
        st.h[:] = dice.choice([0.0, 0.01, 1.6, 3.2, 6.1], 2).tolist()
        m.curvature[0] = float(dice.choice([0.0, 1.0e-7, 2.0e-6, 0.001, -0.02, 0.1, -0.25]))
        ahead, left = dice.uniform(-20.0, 60.0), dice.normal(0.0, 5.0)
        c, s = np.cos(st.h[0]), np.sin(st.h[0])
        st.x[:], st.y[:] = [0.0, float(ahead * c - left * s)], [0.0, float(ahead * s + left * c)]
        update_boxes(program, st)
        for i in range(2):
            see_heading(st, m, i)
        lay_corners(program, m, 1, st.x[1], st.y[1], m.seen_cos[1], m.seen_sin[1], OTHER)
        m.own_cos[0], m.own_sin[0], m.pair_bend[0] = m.seen_cos[0], m.seen_sin[0], m.curvature[0]
        lay_across_circle(m, 0)
        off = is_off_circle(m, m.curvature[0], 0.5 * program.const[slot.K_ENTITIES + slot.E_WIDTH])
        found[surely_beside(program, st, m, 0, 1), off] += 1
    assert found[1, 0] == 0
    assert found[1, 1] > 9 * found[0, 1], "the bound finds most of the boxes beside the path"
    assert found[0, 0] > 250
