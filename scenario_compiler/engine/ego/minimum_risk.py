"""The minimum-risk manoeuvre: stay in the lane and brake to standstill at the given rate, with hazard lights on.

After UN R157 5.5, it begins a given time after an unanswered request, or earlier if a limit ahead leaves no more than
the distance to stop.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.limits import behaviour, control_period
from scenario_compiler.engine.ego.sensor import lane_closes
from scenario_compiler.engine.motion.surroundings import grip
from scenario_compiler.marker import compiled

STOP_MARGIN = 3.0
"""Distance to the limit that remains after the stop, m; chosen."""


@compiled
def stopping_distance(p: Program, st: State, i: int, towards: float) -> float:
    """Return the stopping distance at the manoeuvre's deceleration if it begins at the next control step, m.

    On a slippery road the deceleration is at most what the tyres hold. The distance includes the one that an entity
    approaching with the speed `towards`, m/s, covers until the vehicle stands.
    """
    v = st.v[i]
    hardest = grip(st, p.const[p.entity_const[i] + slot.E_MAX_DECELERATION])
    deceleration = max(min(p.const[slot.K_MINIMUM_RISK_DECELERATION], hardest), 0.1)
    wait = control_period(p)
    return (0.5 * v + towards) * v / deceleration + (v + towards) * wait


@compiled
def minimum_risk_due(p: Program, st: State, i: int) -> int:
    """Return 1 if the manoeuvre has to begin now; never if the policy has no such manoeuvre."""
    if p.minimum_risk[0] == 0 or behaviour(p, st) == op.BEHAVIOUR_LET_GO:
        return 0
    if st.clock[0] - st.request_at[0] >= p.const[slot.K_RISK_AFTER + st.cause[0]] - op.TOLERANCE:
        return 1
    blocked = st.blocked_distance[0]
    if blocked < op.FAR and blocked <= stopping_distance(p, st, i, st.blocked_speed[0]) + STOP_MARGIN:
        return 1
    end = lane_closes(st)
    return 1 if end < op.FAR and end <= stopping_distance(p, st, i, 0.0) + STOP_MARGIN else 0
