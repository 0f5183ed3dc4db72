"""The time to a limit ahead at unchanged speed, from which on the automation requests a takeover."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.tables import RoadTables

CLOSE = 5.0
"""Distance to a limit within which the automation asks at any speed, m."""


@compiled
def control_period(p: Program) -> float:
    """Return the time from one control step to the next, s."""
    return p.const[slot.K_STEP] * p.control_every[0]


@compiled
def budget_of(p: Program, own: int) -> float:
    """Return the budget in a cause's slot, s; the policy's where that is negative."""
    return p.const[own] if p.const[own] >= 0.0 else p.const[slot.K_BUDGET]


@compiled
def closing_speed(st: State, i: int) -> float:
    """Return the speed at which the ego and what blocks its path close up, m/s."""
    return st.v[i] + st.blocked_speed[0]


@compiled
def request_distance(p: Program, closing: float, own: int, count: int) -> float:
    """Return the distance within which a limit is a reason to ask, m, so that it asks within the budget.

    The limit is closed up to with the speed `closing`: the ego's own, and that of what comes towards it. A reason must
    have been there in a number of control steps, which is in the slot `count`: they are driven before it asks.
    """
    waits = max(p.const[count] - 1.0, 0.0) * control_period(p)
    return max((budget_of(p, own) + waits) * closing, CLOSE)


@compiled
def arrives_before(n: RoadTables, p: Program, st: State, distance: float) -> int:
    """Return 1 where the destination lies on the way that was walked last, nearer than a distance."""
    road = p.destination_road[0]
    for w in range(st.way_count[0]):
        if st.way_road[w] == road and lane_direction(n, road, p.destination_lane[0]) == st.way_sign[w]:
            ahead = st.way_sign[w] * (p.const[slot.K_DESTINATION_S] - st.way_s[w])
            return 1 if ahead >= 0.0 and st.way_from[w] + ahead <= distance else 0
    return 0


@compiled
def lane_ends(n: RoadTables, p: Program, st: State, within: float) -> int:
    """Return 1 where the lane ends within a distance, before the destination, and no gap beside it is free."""
    if st.merging[0] == 1 or st.lane_end_distance[0] > within or (st.through_lane[0] != 0 and st.gap_free[0] == 1):
        return 0
    return 1 - arrives_before(n, p, st, st.lane_end_distance[0] + CLOSE)


@compiled
def behaviour(p: Program, st: State) -> int:
    """Return what the automation does now, BEHAVIOUR_...: before a request or after it."""
    asked = st.takeover_state[0] in (op.TAKEOVER_REQUEST, op.TAKEOVER_ESCALATION)
    return p.after_request[0] if asked else p.before_request[0]
