"""The weather now: CARLA's 14 numbers, each on a straight line from what it was to what it is to be."""

from __future__ import annotations

from scenario_compiler.engine.faults import log_event
from scenario_compiler.engine.numbers import clip
from scenario_compiler.engine.opcodes import EVENT_WEATHER, NONE, WEATHER_SIZE
from scenario_compiler.engine.slots import A_DYNAMICS
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.visibility import weather_visibility
from scenario_compiler.marker import compiled


@compiled
def reset_weather(p: Program, st: State) -> None:
    """Put the weather to that of the start, where the program has one."""
    st.weather_to[0] = NONE
    st.weather_since[0] = 0.0
    st.weather_over[0] = 0.0
    for k in range(WEATHER_SIZE):
        st.weather[k] = p.const[p.weather_const[0] + k] if p.weather_count[0] > 0 else 0.0
        st.weather_from[k] = st.weather[k]
    st.paint_seen[0] = weather_visibility(st)


@compiled
def begin_weather(p: Program, st: State, action: int) -> None:
    """Let the weather change from now on as an action says."""
    st.weather_to[0] = p.action_other[action]
    st.weather_since[0] = st.clock[0]
    st.weather_over[0] = p.const[p.action_const[action] + A_DYNAMICS]
    for k in range(WEATHER_SIZE):
        st.weather_from[k] = st.weather[k]
    log_event(st, EVENT_WEATHER, 1.0 * p.action_other[action])


@compiled
def update_weather(p: Program, st: State) -> None:
    """Bring the weather to where its change has come."""
    target = st.weather_to[0]
    if target < 0:
        return
    over = st.weather_over[0]
    share = 1.0
    if over > 1.0e-9:
        share = clip((st.clock[0] - st.weather_since[0]) / over, 0.0, 1.0)
    base = p.weather_const[target]
    for k in range(WEATHER_SIZE):
        st.weather[k] = st.weather_from[k] + share * (p.const[base + k] - st.weather_from[k])
    st.paint_seen[0] = weather_visibility(st)
    if share >= 1.0:
        st.weather_to[0] = NONE
