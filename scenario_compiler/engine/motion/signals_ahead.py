"""The next signal on a walked way at which a vehicle has to stop.

A signal applies to the lanes and the direction of travel that the road file states, where it stands and where another
road refers to it. Its state, a text of the scenario, means stop or caution (`aspect_of`). A vehicle stops if its brakes
still suffice; at caution, only if a comfortable deceleration suffices.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.extent import front_of
from scenario_compiler.engine.columns.numbers import ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.ahead import row_on_way
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

LINE_BEFORE = 1.0
"""Distance between the front of a waiting vehicle and the signal, m."""

CAUTION_DECELERATION = 3.5
"""Greatest deceleration with which a vehicle stops when a signal turns yellow, m/s2: that from which yellow times are
computed in Germany (RiLSA), not verified.
"""


@compiled
def signal_counts(n: RoadTables, p: Program, st: State, k: int, w: int) -> int:
    """Return 1 if a head of a signal lies ahead on the way's row w and applies to its lane and direction."""
    if p.head_road[k] != st.way_road[w] or p.head_sense[k] * st.way_sign[w] < 0:
        return 0
    s = p.const[p.head_const[k]]
    ahead = st.way_sign[w] * (s - st.way_s[w])
    if ahead < 0.0:
        return 0
    goes_on, row = row_on_way(n, st, w, s, ahead)
    if goes_on == 0 or row < 0:
        return 0
    lane = n.lane_id[row]
    return 1 if lane >= p.head_from[k] and lane <= p.head_to[k] else 0


@compiled
def red_ahead(n: RoadTables, p: Program, st: State, i: int) -> float:
    """Return the distance along the way from i's reference point to the line at which it stops, m; FAR if none."""
    line = op.FAR
    base = p.entity_const[i]
    front = front_of(p, i)
    for k in range(p.head_count[0]):
        state = st.signal_state[p.head_signal[k]]
        if state < 0 or p.text_aspect[state] == op.ASPECT_NONE:
            continue
        hardest = 0.9 * p.const[base + slot.E_MAX_DECELERATION]
        if p.text_aspect[state] == op.ASPECT_CAUTION:
            hardest = min(CAUTION_DECELERATION, hardest)
        for w in range(st.way_count[0]):
            if signal_counts(n, p, st, k, w) == 1:
                at = st.way_from[w] + st.way_sign[w] * (p.const[p.head_const[k]] - st.way_s[w]) - LINE_BEFORE
                room = at - front
                needed = ratio(st.v[i] * st.v[i], 2.0 * room, op.FAR) if room > 0.0 else op.FAR
                if at < line and (needed <= hardest or st.v[i] < op.STANDING):
                    line = at
    return line
