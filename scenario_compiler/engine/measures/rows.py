"""The ego's rows. Each is kept until the next step has begun, so that the events at its time belong to it."""

from __future__ import annotations

from math import pi

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.measures.boxes import measure_boxes, see_heading
from scenario_compiler.engine.measures.encroachment import add_encroachment
from scenario_compiler.engine.motion.collision import reported_entity
from scenario_compiler.marker import compiled

STILL = 0.5
"""Speed below which the driven curvature is not computed, m/s."""


@compiled
def curvature_driven(st: State, m: Totals, ego: int) -> float:
    """Return the curvature driven from the previous row to this one, 1/m; 0 at standstill.

    The way between the rows is that of the speed in this row: a step first changes the speed, then the place.
    """
    if m.row_present[0] == 0 or abs(st.v[ego]) <= STILL:
        return 0.0
    turned = m.seen_h[ego] - m.row_h[0]
    if turned >= pi:
        turned = turned - 2.0 * pi
    if turned < -pi:
        turned = turned + 2.0 * pi
    return ratio(turned, st.v[ego] * (st.clock[0] - m.row_time[0]), 0.0)


@compiled
def take_row(p: Program, st: State, m: Totals) -> None:
    """Write the ego's present row, and measure its distances."""
    m.rows[0] += 1
    ego = reported_entity(p)
    if p.entity_count[0] > 0 and st.present[ego] == 1:
        see_heading(st, m, ego)
        if m.rows[0] > 1:
            m.curvature[0] = curvature_driven(st, m, ego)
        measure_boxes(p, st, m, ego)
        m.row_present[0] = 1
        m.row_v[0] = st.v[ego]
        m.row_a[0] = st.a[ego]
        m.row_h[0] = m.seen_h[ego]
        m.row_road[0] = st.road[ego]
        m.row_lane[0] = st.lane[ego] if st.road[ego] >= 0 else 0
        m.row_s[0] = st.s[ego] if st.road[ego] >= 0 else 0.0
        m.row_off[0] = st.off[ego] if st.road[ego] >= 0 else 0.0
        m.row_steer[0] = st.steer[ego]
        m.row_brake[0] = st.brake[ego]
        m.row_width[0] = st.lane_width[0]
        m.row_heading[0] = st.path_heading[0]
        m.row_on_road[0] = st.on_road[0]
    else:
        m.row_present[0] = 0
        m.row_v[0] = op.FAR
        m.row_road[0] = op.NONE
        m.row_lane[0] = 0
        m.row_brake[0] = 0.0
    if p.entity_count[0] > 1:
        add_encroachment(p, st, m, ego)
    m.row_time[0] = st.clock[0]
    m.row_state[0] = st.takeover_state[0]
    m.row_cause[0] = st.cause[0]
    m.row_confidence[0] = max(st.conf_left[0], st.conf_right[0])
    m.row_blocked[0] = st.blocked_distance[0]
    m.row_blocked_speed[0] = st.blocked_speed[0]
    m.row_lane_end[0] = st.lane_end_distance[0]
    m.row_limit_time[0] = st.limit_time[0]
    m.row_density[0] = st.traffic_density[0]
    m.row_lane_time[0] = st.lane_time[0]
