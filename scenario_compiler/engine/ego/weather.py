"""The present weather: CARLA's 14 numbers, each interpolated linearly during a change, or kept."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.brightness import note_brightness
from scenario_compiler.engine.ego.failures import note_image
from scenario_compiler.engine.ego.visibility import weather_visibility
from scenario_compiler.marker import compiled
from scenario_compiler.vocabulary.kept import KEPT


@compiled
def note_weather(st: State) -> None:
    """Write how well paint is seen and how bright the picture is in the present weather."""
    st.paint_seen[0] = weather_visibility(st)
    note_brightness(st)
    note_image(st)
    st.reach_known[0] = 0
    st.sight_known[0] = 0


@compiled
def reset_weather(p: Program, st: State) -> None:
    """Set the weather of the start, if the program has one."""
    if p.weather_count[0] > 0:
        for k in range(op.WEATHER_SIZE):
            st.weather[k] = p.const[p.weather_const[0] + k]
            st.weather_from[k] = st.weather[k]
    note_weather(st)


@compiled
def begin_weather(p: Program, st: State, action: int) -> None:
    """Begin the change of weather that an action orders."""
    st.weather_to[0] = p.action_other[action]
    st.weather_since[0] = st.clock[0]
    st.weather_over[0] = p.const[p.action_const[action] + slot.A_DYNAMICS]
    for k in range(op.WEATHER_SIZE):
        st.weather_from[k] = st.weather[k]


@compiled
def update_weather(p: Program, st: State) -> None:
    """Advance a change of weather to the present time."""
    target = st.weather_to[0]
    if target < 0:
        return
    over = st.weather_over[0]
    share = 1.0
    if over > 1.0e-9:
        share = clip((st.clock[0] - st.weather_since[0]) / over, 0.0, 1.0)
    base = p.weather_const[target]
    for k in range(op.WEATHER_SIZE):
        if p.const[base + k] != KEPT:
            st.weather[k] = st.weather_from[k] + share * (p.const[base + k] - st.weather_from[k])
    note_weather(st)
    if share >= 1.0:
        st.weather_to[0] = op.NONE
