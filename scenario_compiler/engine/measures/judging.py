"""Adds the rows of a run to its totals, in order."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.measures.boxes import measure_waiting
from scenario_compiler.engine.measures.inputs import add_inputs
from scenario_compiler.engine.measures.lane_keeping import add_keeping, add_to_keeping, finish_keeping
from scenario_compiler.engine.measures.reversals import add_steering
from scenario_compiler.engine.measures.takeover import add_takeover, behind_collision
from scenario_compiler.engine.measures.takeovers import add_takeovers
from scenario_compiler.engine.motion.collision import reported_entity
from scenario_compiler.marker import compiled


@compiled
def note_events(st: State, m: Totals) -> None:
    """Copy the times of the first event of each kind, and the entity of the first collision."""
    m.time_warning[0] = st.time_warning[0]
    m.time_request[0] = st.time_request[0]
    m.time_escalation[0] = st.time_escalation[0]
    m.time_eyes_on[0] = st.time_eyes_on[0]
    m.time_hands_on[0] = st.time_hands_on[0]
    m.time_response[0] = st.time_response[0]
    m.time_minimum_risk[0] = st.time_minimum_risk[0]
    m.time_standstill[0] = st.time_standstill[0]
    m.time_no_progress[0] = st.time_no_progress[0]
    m.time_outside_domain[0] = st.time_outside_domain[0]
    m.time_obstruction[0] = st.time_obstruction[0]
    m.time_short_start[0] = st.time_short_start[0]
    m.time_collision[0] = st.time_collision[0]
    m.collided_with[0] = st.collided_with[0]


@compiled
def judge_row(p: Program, st: State, m: Totals) -> None:
    """Add the last row once the next step has begun, when all events of its time are known.

    Rows after the first collision say nothing about driving: only the speed of the last row is measured there. Contact
    already makes the least distances and times 0, so that these need no end.
    """
    if st.log_count[0] != m.events[0]:
        m.events[0] = st.log_count[0]
        note_events(st, m)
    intact = 1 - behind_collision(m)
    if intact == 1:
        m.least_confidence[0] = min(m.least_confidence[0], m.row_confidence[0])
        m.least_lane_time[0] = min(m.least_lane_time[0], m.row_lane_time[0])
    if intact == 1 and m.row_present[0] == 1:
        m.greatest_offset[0] = max(m.greatest_offset[0], abs(m.row_off[0]))
        if m.row_road[0] < 0 or m.row_lane[0] == 0:
            m.rows_off_lanes[0] += 1
        if m.row_on_road[0] == 0:
            m.rows_off_road[0] += 1
            if m.time_off_road[0] < 0.0:
                m.time_off_road[0] = m.row_time[0]
    before = m.time_collision[0] < 0.0 or m.row_time[0] < m.time_collision[0] - SAME_TIME
    if before or m.rows[0] == 1:
        m.speed_before_collision[0] = m.row_v[0]
    add_takeover(m)
    add_takeovers(st, m)
    add_inputs(p, m)
    add_steering(p, m)
    add_to_keeping(p, m)


@compiled
def note_fault(st: State, m: Totals) -> None:
    """Store the fault that stopped the run, and the state of its entity."""
    m.flag[0] = st.flag[0]
    m.flag_at[0] = st.flag_at[0]
    m.flag_time[0] = st.clock[0]
    at = st.flag_at[0]
    if st.flag[0] != op.FAULT_NONE and 0 <= at < len(st.x):
        m.flag_x[0] = st.x[at]
        m.flag_y[0] = st.y[at]
        m.flag_h[0] = st.h[at]
        m.flag_v[0] = st.v[at]
        m.flag_steer[0] = st.steer[at]


@compiled
def finish_totals(p: Program, st: State, m: Totals) -> None:
    """Add the last row of the run, and how the run ended."""
    judge_row(p, st, m)
    measure_waiting(p, m, reported_entity(p))
    add_keeping(p, m, 0)
    finish_keeping(m)
    m.stop[0] = st.stop[0]
    m.start_tight[0] = st.start_tight[0]
    note_fault(st, m)
