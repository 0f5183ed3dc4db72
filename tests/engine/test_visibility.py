"""The weather reduces ideal perception's confidence as it was measured with the camera."""

from __future__ import annotations

import re

import pytest

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import new_state
from scenario_compiler.engine.ego import visibility
from scenario_compiler.engine.ego.visibility import weather_visibility
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_numbers, weather_preset


def seen_in(weather: Weather) -> float:
    """Return the share of the confidence that a weather leaves."""
    state = new_state(Program())
    state.weather = list(weather_numbers(weather))
    return weather_visibility(state)


def preset(name: str) -> Weather:
    """Return a weather of CARLA's."""
    weather = weather_preset(name)
    assert weather is not None
    return weather


def test_the_published_table_agrees_with_the_curve() -> None:
    rows = re.findall(
        r"^ {4}(\w+(?:Noon|Sunset)) +\d.\d\d +\d.\d\d +(\d.\d\d)$", visibility.__doc__ or "", re.MULTILINE
    )
    assert len(rows) == 5
    for name, value in rows:
        assert seen_in(preset(name)) == pytest.approx(float(value), abs=0.006), name


def test_a_clear_noon_and_numbers_left_to_the_map_hide_nothing() -> None:
    assert seen_in(preset("ClearNoon")) > 0.999
    assert seen_in(Weather()) > 0.999


def test_the_share_stays_between_0_and_1_for_any_numbers() -> None:
    for numbers in ([1e6] * 14, [-1e6] * 14, [0.0] * 14):
        state = new_state(Program())
        state.weather = numbers
        assert 0.0 <= weather_visibility(state) <= 1.0
    assert all(0.0 < seen_in(preset(name)) <= 1.0 for name in WEATHER_PRESETS)
