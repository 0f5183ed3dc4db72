"""Actions on the control of an entity: assigning, switching and overriding controllers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.controllers import (
    HOLDS_INPUT,
    SPEED_ON,
    SWITCHES_SPEED,
    activate_controller,
    assign_controller,
    override_controller,
)
from scenario_compiler.engine.moves.entry import Entry
from scenario_compiler.forms.declaration import codes
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import (
        ActivateControllerAction,
        AssignControllerAction,
        OverrideControllerAction,
    )

CONTROLLERS = {"acc": op.CONTROLLER_FOLLOW, "alks": op.CONTROLLER_FOLLOW}
"""Models of assigned controllers that drive an entity; all others leave it unchanged."""

INPUTS = {
    "throttle": op.HELD_THROTTLE,
    "brake": op.HELD_BRAKE,
    "clutch": op.HELD_CLUTCH,
    "parking_brake": op.HELD_PARKING_BRAKE,
    "steering_wheel": op.HELD_WHEEL,
    "gear": op.HELD_GEAR,
}
"""Codes of the inputs of the ego that an action may hold."""

GAPS = {"timeGap": slot.E_TIME_GAP, "time_gap": slot.E_TIME_GAP, "minimum_gap": slot.E_MINIMUM_GAP}
"""Properties of car following that are numbers of the entity, and their slots."""


@compiled
def start_activate(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Switch a controller of an entity on or off."""
    del n
    activate_controller(p, st, k)


@compiled
def start_assign(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Give an entity a controller."""
    del n
    assign_controller(p, st, k)


@compiled
def start_override(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Hold an input of the ego, or release it."""
    del n
    override_controller(p, st, k)


def _switched(longitudinal: bool | None) -> int:
    if longitudinal is None:
        return 0
    return SWITCHES_SPEED | (SPEED_ON if longitudinal else 0)


def activate_row(draft: ProgramDraft, word: ActivateControllerAction, actor: int) -> ActionRow:
    """Return the row of an action that activates or deactivates a controller; of two with one name, the last."""
    mode, speed = op.CONTROLLER_PRESENT, -1.0
    for who, one in draft.plan.storyboard.actions():
        if one.word == "assign_controller" and one.name == word.controller and draft.entities.get(who) == actor:
            mode, speed = CONTROLLERS.get(one.model, op.CONTROLLER_DEFAULT), _desired_speed(one)
    return ActionRow((speed, 0.0), mode=mode, flags=_switched(word.longitudinal))


def _desired_speed(word: AssignControllerAction) -> float:
    """Return the speed that a controller aims for, m/s; -1 if none is given."""
    given = {one.name: one.value for one in word.properties} if word.model in CONTROLLERS else {}
    return float(given.get("setSpeed", given.get("speed", "-1")))


def assign_row(draft: ProgramDraft, word: AssignControllerAction, actor: int) -> ActionRow:
    """Return the row of an action that assigns a controller; its car-following properties become the entity's."""
    model = CONTROLLERS.get(word.model, op.CONTROLLER_DEFAULT)
    given = {one.name: one.value for one in word.properties} if model == op.CONTROLLER_FOLLOW else {}
    for name, place in GAPS.items():
        if name in given:
            draft.numbers[draft.program.entity_const[actor] + place] = float(given[name])
    return ActionRow((_desired_speed(word), 0.0), mode=model, flags=_switched(word.longitudinal))


def override_row(draft: ProgramDraft, word: OverrideControllerAction, actor: int) -> ActionRow:
    """Return the row of an action that holds an input."""
    del draft, actor
    return ActionRow((word.value, 0.0), mode=INPUTS[word.input], flags=HOLDS_INPUT if word.active else 0)


ACTIVATE_CONTROLLER = Entry(("activate_controller",), activate_row, start_activate)
ASSIGN_CONTROLLER = Entry(("assign_controller",), assign_row, start_assign)
OVERRIDE_CONTROLLER = Entry(
    ("override_controller",), override_row, start_override, refers={"mode": codes(op.HELD_INPUTS)}
)
