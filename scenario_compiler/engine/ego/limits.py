"""The distance to a limit ahead, at unchanged speed, within which the automation requests a takeover."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.tables import RoadTables

CLOSE = 5.0
"""Distance to a limit within which the automation requests at any speed, m."""


@compiled
def control_period(p: Program) -> float:
    """Return the time from one control step to the next, s."""
    return p.const[slot.K_STEP] * p.control_every[0]


@compiled
def budget_of(p: Program, own: int) -> float:
    """Return the time budget in a cause's own slot, s, or that of the policy if the slot is negative."""
    return p.const[own] if p.const[own] >= 0.0 else p.const[slot.K_BUDGET]


@compiled
def budget_of_cause(p: Program, cause: int) -> float:
    """Return the time budget of requests for a cause, s; that of the policy unless the cause has its own."""
    if cause == op.CAUSE_PATH_BLOCKED:
        return budget_of(p, slot.K_BLOCKED_BUDGET)
    if cause == op.CAUSE_LANE_ENDS:
        return budget_of(p, slot.K_LANE_END_BUDGET)
    return p.const[slot.K_BUDGET]


@compiled
def closing_speed(st: State, i: int) -> float:
    """Return the speed at which the ego and what blocks its path approach each other, m/s."""
    return st.v[i] + st.blocked_speed[0]


@compiled
def request_distance(p: Program, closing: float, own: int, count: int) -> float:
    """Return the distance to a limit within which there is a reason to request, m, to keep the time budget.

    `closing` is the speed of approach, m/s: the ego's speed plus that of an oncoming entity. A reason must hold for the
    number of control steps in the slot `count`; the distance driven in these steps is added.
    """
    waits = max(p.const[count] - 1.0, 0.0) * control_period(p)
    return max((budget_of(p, own) + waits) * closing, CLOSE)


@compiled
def short_distance(p: Program, closing: float, own: int, count: int) -> float:
    """Return the distance to a limit below which a request, noticed only now, comes a control step late or more, m."""
    waits = max(p.const[count] - 2.0, -1.0) * control_period(p)
    return (budget_of(p, own) + waits) * closing


@compiled
def arrives_before(n: RoadTables, p: Program, st: State, distance: float) -> int:
    """Return 1 if the destination lies on the last measured path, nearer than a distance, m."""
    road = p.destination_road[0]
    lane = p.destination_lane[0]
    s = p.const[slot.K_DESTINATION_S]
    for w in range(st.way_count[0]):
        if st.way_road[w] == road and lane_direction(n, road, lane, s) == st.way_sign[w]:
            ahead = st.way_sign[w] * (s - st.way_s[w])
            return 1 if ahead >= 0.0 and st.way_from[w] + ahead <= distance else 0
    return 0


@compiled
def lane_ends(n: RoadTables, p: Program, st: State, within: float) -> int:
    """Return 1 if the lane ends within a distance, before the destination, and no gap beside it is free."""
    if st.merging[0] == 1 or st.lane_end_distance[0] > within or (st.through_lane[0] != 0 and st.gap_free[0] == 1):
        return 0
    return 1 - arrives_before(n, p, st, st.lane_end_distance[0] + CLOSE)


@compiled
def behaviour(p: Program, st: State) -> int:
    """Return the automation's present behaviour, BEHAVIOUR_..., which may differ before and after a request."""
    asked = st.takeover_state[0] in (op.TAKEOVER_REQUEST, op.TAKEOVER_ESCALATION)
    return p.after_request[0] if asked else p.before_request[0]
