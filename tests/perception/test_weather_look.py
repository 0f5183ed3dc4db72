import re
from itertools import pairwise

import pytest

from scenario_compiler.engine.ego.visibility import paint_contrast
from scenario_compiler.perception import weather_look
from scenario_compiler.perception.weather_look import look_of
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather
from tests.perception.scenery import CLEAR, weather


def test_the_published_table_agrees_with_the_curve() -> None:
    table = re.findall(r"(\w+(?:Noon|Sunset|Night)) +(\d\.\d\d)", weather_look.__doc__ or "")
    assert len(table) == 15
    for name, value in table:
        assert look_of(weather(name)).contrast == pytest.approx(float(value), abs=0.006), name


def test_rain_hides_paint_more_than_wetness_and_a_low_sun_more_than_a_high_one() -> None:
    clear, wet, rain = paint_contrast(0, 0, 45), paint_contrast(1, 0, 45), paint_contrast(1, 1, 45)
    assert clear > wet > rain > paint_contrast(1, 1, 15)
    assert paint_contrast(1, 1, -90) == rain


def test_contrast_falls_steadily_with_rain() -> None:
    values = [paint_contrast(1, rain / 20, 15) for rain in range(21)]
    assert all(a > b for a, b in pairwise(values))


def test_unset_numbers_look_like_a_clear_noon() -> None:
    unset, clear = look_of(weather("Default")), look_of(CLEAR)
    assert unset.sun_altitude == clear.sun_altitude
    assert unset.contrast == clear.contrast
    assert unset.luminance == pytest.approx(clear.luminance)


@pytest.mark.parametrize("name", WEATHER_PRESETS)
def test_every_preset_has_a_look_in_range(name: str) -> None:
    look = look_of(weather(name))
    for share in (look.cloud, look.rain, look.wet, look.dust, look.contrast, look.luminance, look.warmth):
        assert 0.0 <= share <= 1.0
    assert look.fog >= 0.0
    assert look.spray > 0.0


def test_numbers_beyond_their_range_are_taken_into_it() -> None:
    look = look_of(Weather.model_construct(**CLEAR.model_dump() | {"precipitation": 900.0, "fog_falloff": -3.0}))
    assert look.rain == 1.0
