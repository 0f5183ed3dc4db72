"""The surroundings of the vehicles other than the weather: the time of day and the road's friction."""

from __future__ import annotations

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled

SETS_TIME = 1
TIME_RUNS = 2
SETS_FRICTION = 4
"""Bits of an environment action's flags."""

COMFORT_SHARE = 0.5
"""Share of the tyres' greatest force that comfortable driving uses on a slippery road; chosen: with half of it sideways
and half in braking, 0.7 of the friction circle is used."""


@compiled
def change_surroundings(p: Program, st: State, k: int) -> None:
    """Set the time of day and the friction that an action gives."""
    flags = p.action_flags[k]
    base = p.action_const[k]
    if flags & SETS_TIME != 0:
        st.day_known[0] = 1
        st.day_runs[0] = 1 if flags & TIME_RUNS != 0 else 0
        st.day_from[0] = p.const[base + slot.A_TARGET]
        st.day_since[0] = st.clock[0]
    if flags & SETS_FRICTION != 0:
        st.friction[0] = max(p.const[base + slot.A_DYNAMICS], 0.0)


@compiled
def time_of_day(st: State) -> float:
    """Return the date and time now as seconds since 1970."""
    if st.day_runs[0] == 1:
        return st.day_from[0] + (st.clock[0] - st.day_since[0])
    return st.day_from[0]


@compiled
def grip(st: State, limit: float) -> float:
    """Return what the road's friction leaves of an acceleration that tyres give on a dry road, m/s2."""
    return limit * min(st.friction[0], 1.0)


@compiled
def comfort(st: State, wanted: float, limit: float) -> float:
    """Return a comfortable acceleration, m/s2, or less if the road is so slippery that it is more than COMFORT_SHARE.

    Who drives with a greater share on a dry road does so on every road.

    Args:
        st: The state.
        wanted: The acceleration on a dry road, m/s2.
        limit: The greatest acceleration that tyres give on a dry road, m/s2.
    """
    return min(wanted, grip(st, max(wanted, COMFORT_SHARE * limit)))
