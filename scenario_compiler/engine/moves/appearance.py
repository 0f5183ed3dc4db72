"""Actions on the lights and animations of an entity, which are only logged and shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft, flags_of
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import Entry, Told
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import AnimationAction, LightAction

LIGHTS = (
    *("daytimeRunningLights", "lowBeam", "highBeam", "fogLights", "fogLightsFront", "fogLightsRear", "brakeLights"),
    *("warningLights", "indicatorLeft", "indicatorRight", "reversingLights", "licensePlateIllumination"),
    "specialPurposeLights",
)
"""Lights of vehicles that are part of the state, by ASAM OpenSCENARIO's names."""

LOGGED = "A light or an animation of `entity` changes: `cause` is its name, `message` its state."


@compiled
def start_light(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Switch a light of an entity; a light with a user-defined name has no bit and is only logged."""
    del n
    i = p.action_entity[k]
    bit = p.action_mode[k]
    lit = st.lights[i] & bit
    st.lights[i] = st.lights[i] - lit
    if p.action_flags[k] == 1:
        st.lights[i] = st.lights[i] + bit


@compiled
def step_animation(n: RoadTables, p: Program, st: State, k: int, dt: float) -> int:
    """Advance an animation; return 1 if it is over; a continuous one never is."""
    del n
    if p.action_flags[k] & op.FLAG_CONTINUOUS != 0:
        return 0
    st.action_progress[k] = st.action_progress[k] + dt
    return 1 if st.action_progress[k] >= p.const[p.action_const[k] + slot.A_DYNAMICS] - op.TOLERANCE else 0


def light_row(draft: ProgramDraft, word: LightAction, actor: int) -> ActionRow:
    """Return the row of an action that switches a light."""
    del draft, actor
    bit = 1 << LIGHTS.index(word.type) if word.type in LIGHTS else 0
    return ActionRow(mode=bit, flags=0 if word.mode == "off" else 1)


def animation_row(draft: ProgramDraft, word: AnimationAction, actor: int) -> ActionRow:
    """Return the row of an animation."""
    del draft, actor
    return ActionRow(
        (word.state, 0.0 if word.duration is None else word.duration),
        flags=flags_of((op.FLAG_CONTINUOUS, word.continuous)),
    )


def _animation_words(word: AnimationAction) -> tuple[str, str]:
    return word.type, f"to {word.state:g}" if isinstance(word.state, float) else "moves"


LIGHT = Entry(("light",), light_row, start_light, told=Told("light", LOGGED, lambda word: (word.type, word.mode)))
ANIMATION = Entry(("animation",), animation_row, step=step_animation, told=Told("light", LOGGED, _animation_words))
