"""Actions that concern the run as a whole: the camera, the weather, messages, the end."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.run import FAILURE_CODES, add_failure, add_weather
from scenario_compiler.vocabulary.actions import (
    EndFailureAction,
    Failure,
    MessageAction,
    SensorNoiseAction,
    StopAction,
    WeatherAction,
)


def _sensor_noise(draft: Draft, word: SensorNoiseAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_SENSOR_NOISE, (word.sigma, 0.0))


def _failure(draft: Draft, word: Failure, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_FAILURE, other=add_failure(draft, word, waits=True))


def _end_failure(draft: Draft, word: EndFailureAction, actor: int) -> ActionRow:
    del draft, actor
    return ActionRow(op.ACTION_END_FAILURE, other=op.NONE if word.kind is None else FAILURE_CODES[word.kind])


def _weather(draft: Draft, word: WeatherAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_WEATHER, (0.0, word.over_time), other=add_weather(draft, word))


def _message(draft: Draft, word: MessageAction, actor: int) -> ActionRow:
    del word, actor
    draft.messages += 1
    return ActionRow(op.ACTION_MESSAGE, other=draft.messages - 1)


def _stop(draft: Draft, word: StopAction, actor: int) -> ActionRow:
    del draft, word, actor
    return ActionRow(op.ACTION_STOP)


ACTIONS: Family = {
    SensorNoiseAction: _sensor_noise,
    Failure: _failure,
    EndFailureAction: _end_failure,
    WeatherAction: _weather,
    MessageAction: _message,
    StopAction: _stop,
}
