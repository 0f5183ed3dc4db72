"""Actions on the world at large: variables, traffic signals, the time of day, other programs."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.world import variable_value
from scenario_compiler.engine.surroundings import SETS_FRICTION, SETS_TIME, TIME_RUNS
from scenario_compiler.vocabulary.actions import (
    CommandAction,
    EnvironmentAction,
    ModifyVariableAction,
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from scenario_compiler.vocabulary.variables import seconds_of


def _set_variable(draft: Draft, word: SetVariableAction, actor: int) -> ActionRow:
    del actor
    at, variable = draft.variables[word.variable]
    return ActionRow(op.ACTION_SET_VARIABLE, (variable_value(draft, variable, word.value), 0.0), other=at)


def _modify_variable(draft: Draft, word: ModifyVariableAction, actor: int) -> ActionRow:
    del actor
    mode = op.MODIFY_ADD if word.by == "add" else op.MODIFY_MULTIPLY
    return ActionRow(op.ACTION_MODIFY_VARIABLE, (word.value, 0.0), other=draft.variables[word.variable][0], mode=mode)


def _signal_state(draft: Draft, word: TrafficSignalStateAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_SIGNAL_STATE, other=draft.signal(word.signal), mode=draft.texts[word.state])


def _signal_phase(draft: Draft, word: TrafficSignalControllerAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_SIGNAL_PHASE, other=draft.controllers[word.controller], mode=draft.texts[word.phase])


def _environment(draft: Draft, word: EnvironmentAction, actor: int) -> ActionRow:
    del draft, actor
    flags = SETS_TIME if word.date_time else 0
    flags |= TIME_RUNS if word.animated else 0
    flags |= 0 if word.friction is None else SETS_FRICTION
    time = seconds_of(word.date_time) if word.date_time else 0.0
    return ActionRow(op.ACTION_ENVIRONMENT, (time, 1.0 if word.friction is None else word.friction), flags=flags)


def _command(draft: Draft, word: CommandAction, actor: int) -> ActionRow:
    del draft, word, actor
    return ActionRow(op.ACTION_COMMAND)


ACTIONS: Family = {
    SetVariableAction: _set_variable,
    ModifyVariableAction: _modify_variable,
    TrafficSignalStateAction: _signal_state,
    TrafficSignalControllerAction: _signal_phase,
    EnvironmentAction: _environment,
    CommandAction: _command,
}
