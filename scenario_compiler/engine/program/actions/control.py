"""Actions on who drives an entity, and on its lights and looks."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.controllers import HOLDS_INPUT, SPEED_ON, SWITCHES_SPEED
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.slots import E_MINIMUM_GAP, E_TIME_GAP
from scenario_compiler.vocabulary.actions import (
    ActivateControllerAction,
    AnimationAction,
    AssignControllerAction,
    LightAction,
    OverrideControllerAction,
)

CONTROLLERS = {"acc": op.CONTROLLER_FOLLOW, "alks": op.CONTROLLER_FOLLOW}
"""Models of assigned controllers that drive an entity; every other one leaves it as it is."""

INPUTS = {
    "throttle": op.HELD_THROTTLE,
    "brake": op.HELD_BRAKE,
    "clutch": op.HELD_CLUTCH,
    "parking_brake": op.HELD_PARKING_BRAKE,
    "steering_wheel": op.HELD_WHEEL,
    "gear": op.HELD_GEAR,
}

GAPS = {"timeGap": E_TIME_GAP, "time_gap": E_TIME_GAP, "minimum_gap": E_MINIMUM_GAP}
"""Properties of car following that are numbers of the entity, and where these stand."""


def _switched(longitudinal: bool | None) -> int:
    if longitudinal is None:
        return 0
    return SWITCHES_SPEED | (SPEED_ON if longitudinal else 0)


def _activate(draft: Draft, word: ActivateControllerAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_ACTIVATE_CONTROLLER, flags=_switched(word.longitudinal))


def _assign(draft: Draft, word: AssignControllerAction, actor: int) -> ActionRow:
    model = CONTROLLERS.get(word.model, op.CONTROLLER_DEFAULT)
    given = {one.name: one.value for one in word.properties} if model == op.CONTROLLER_FOLLOW else {}
    for name, slot in GAPS.items():
        if name in given:
            draft.numbers[draft.program.entity_const[actor] + slot] = float(given[name])
    speed = float(given.get("setSpeed", given.get("speed", "-1")))
    return ActionRow(op.ACTION_ASSIGN_CONTROLLER, (speed, 0.0), mode=model, flags=_switched(word.longitudinal))


def _override(draft: Draft, word: OverrideControllerAction, actor: int) -> ActionRow:
    del draft, actor
    flags = HOLDS_INPUT if word.active else 0
    return ActionRow(op.ACTION_OVERRIDE_CONTROLLER, (word.value, 0.0), mode=INPUTS[word.input], flags=flags)


def _light(draft: Draft, word: LightAction, actor: int) -> ActionRow:
    del draft, word, actor
    return ActionRow(op.ACTION_LIGHT)


def _animation(draft: Draft, word: AnimationAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_ANIMATION, (word.state, 0.0 if word.duration is None else word.duration))


ACTIONS: Family = {
    ActivateControllerAction: _activate,
    AssignControllerAction: _assign,
    OverrideControllerAction: _override,
    LightAction: _light,
    AnimationAction: _animation,
}
