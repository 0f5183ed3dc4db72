"""CARLA's weather presets by name and by the index that the AISA toolkit counts."""

from __future__ import annotations

import pytest

from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, weather_preset


@pytest.mark.parametrize(
    ("index", "name"), [(0, "ClearNight"), (1, "ClearNoon"), (6, "Default"), (10, "HardRainSunset")]
)
def test_index_counts_the_sorted_names(index: int, name: str) -> None:
    assert list(WEATHER_PRESETS) == sorted(WEATHER_PRESETS)
    by_index, by_name = weather_preset(str(index)), weather_preset(name)
    assert by_index is not None
    assert by_index.preset == name
    assert by_index == by_name


@pytest.mark.parametrize("text", ["23", "-1", "1.0", "clearnoon", "", "²"])
def test_unknown_preset_is_none(text: str) -> None:
    assert weather_preset(text) is None


def test_presets_are_those_of_the_client() -> None:
    carla = pytest.importorskip("carla", reason="the CARLA client is not installed")
    for name in WEATHER_PRESETS:
        ours, theirs = weather_preset(name), getattr(carla.WeatherParameters, name)
        assert ours is not None
        for field in type(ours).model_fields:
            if field not in ("word", "preset"):
                assert getattr(ours, field) == pytest.approx(getattr(theirs, field), abs=1e-6), (name, field)
