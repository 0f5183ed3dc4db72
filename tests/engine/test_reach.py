"""The range of the forward sensor: the formulas by hand, their consequences, and both forms of the engine."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.ego.reach import (
    fog_on_radar,
    lit_reach,
    quality_of_sensor,
    rain_attenuation,
    reach_in_weather,
    seen_through,
    sensor_reach,
)
from scenario_compiler.engine.ego.visibility import haze_extinction
from scenario_compiler.engine.program.run import SENSOR_CODES
from scenario_compiler.vocabulary.sensors import SensorKind
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_numbers, weather_preset
from tests.engine.both import run_both
from tests.engine.make import Draft, highway

PAGE = Path(__file__).resolve().parents[2] / "docs" / "takeover.md"
KINDS: tuple[SensorKind, ...] = ("camera", "lidar", "radar")


def program_of(kind: SensorKind, reach: float = 150.0) -> Program:
    """Return a program with a forward sensor and nothing else."""
    program = Program()
    program.const = [0.0] * slots.K_ENTITIES
    program.const[slots.K_SENSOR_RANGE] = reach
    program.const[slots.K_HEADLIGHTS] = 100.0
    program.forward_sensor[0] = SENSOR_CODES[kind]
    return program


def reach_in(kind: SensorKind, weather: Weather, reach: float = 150.0) -> float:
    """Return how far a sensor without noise sees in a weather, m."""
    program = program_of(kind, reach)
    state = new_state(program)
    state.weather = list(weather_numbers(weather))
    return reach_in_weather(program, state, 1.0)


def day(**numbers: float) -> Weather:
    """Return a weather by day that has these numbers and nothing else."""
    usual = {"sun_altitude_angle": 45.0, "fog_density": 0.0, "fog_distance": 0.0, "fog_falloff": 0.0}
    return Weather.model_validate({**usual, "precipitation": 0.0, **numbers})


@pytest.mark.parametrize(("extinction", "begin"), [(0.07, 0.0), (0.01, 40.0), (0.001, 0.0)])
def test_the_range_solves_the_equation(extinction: float, begin: float) -> None:
    d = seen_through(150.0, 0.002, extinction, begin)
    assert d * math.exp(0.002 * d + extinction * max(d - begin, 0.0)) == pytest.approx(150.0, rel=1e-9)


def test_clear_air_does_not_reduce_the_range() -> None:
    assert seen_through(150.0, 0.0, 0.0, 0.0) == 150.0
    assert [reach_in(kind, day()) for kind in KINDS] == [150.0, 150.0, 150.0]


def test_fog_that_begins_beyond_the_range_does_not_reduce_it() -> None:
    assert reach_in("camera", day(fog_density=100.0, fog_distance=200.0)) == pytest.approx(150.0)


def test_the_extinctions_of_rain_are_those_of_their_sources() -> None:
    """50 mm/h: 1.076 * 50^0.67 is 14.79 dB/km for light, 1.13 * 50^0.717 is 18.67 dB/km at 77 GHz; ln 10 / 10 a dB."""
    assert rain_attenuation(50.0, 1.076, 0.67) == pytest.approx(14.79 * 2.302585e-4, rel=1e-3)
    assert rain_attenuation(50.0, 1.13, 0.717) == pytest.approx(18.67 * 2.302585e-4, rel=1e-3)
    assert rain_attenuation(0.0, 1.076, 0.67) == 0.0


@pytest.mark.parametrize(("visibility", "water"), [(50.0, 0.5), (300.0, 0.05)])
def test_fog_on_a_radar_has_the_water_that_the_recommendation_gives_it(visibility: float, water: float) -> None:
    extinction = math.log(20.0) / visibility
    assert fog_on_radar(extinction) == pytest.approx(3.15 * water * 2.302585e-4, rel=1e-6)


def test_the_coefficients_at_77_ghz_are_those_of_the_recommendation() -> None:
    """P.838-3, equations 2 and 3 with tables 1 and 3, worked out for 77 GHz."""

    def curve(a: tuple[float, ...], b: tuple[float, ...], c: tuple[float, ...], m: float, rest: float) -> float:
        log = math.log10(77.0)
        bells = sum(x * math.exp(-(((log - y) / z) ** 2)) for x, y, z in zip(a, b, c, strict=True))
        return bells + m * log + rest

    k = curve(
        (-5.33980, -0.35351, -0.23789, -0.94158),
        (-0.10008, 1.26970, 0.86036, 0.64552),
        (1.13098, 0.45400, 0.15354, 0.16817),
        -0.18961,
        0.71147,
    )
    alpha = curve(
        (-0.14318, 0.29591, 0.32177, -5.37610, 16.1721),
        (1.82442, 0.77564, 0.63773, -0.96230, -3.29980),
        (-0.55187, 0.19822, 0.13164, 1.47828, 3.43990),
        0.67849,
        -1.95537,
    )
    assert 10.0**k == pytest.approx(1.13, abs=0.005)
    assert alpha == pytest.approx(0.717, abs=0.001)


def test_fog_at_77_ghz_is_that_of_the_double_debye_water() -> None:
    """P.840 for 77 GHz and 10 degrees Celsius."""
    f, warm = 77.0, 300.0 / 283.15 - 1.0
    still = 77.66 + 103.3 * warm
    fast, rest = 0.0671 * still, 3.52
    first = 20.20 - 146.0 * warm + 316.0 * warm**2
    second = 39.8 * first
    lost = f * (still - fast) / (first * (1 + (f / first) ** 2)) + f * (fast - rest) / (
        second * (1 + (f / second) ** 2)
    )
    real = (still - fast) / (1 + (f / first) ** 2) + (fast - rest) / (1 + (f / second) ** 2) + rest
    assert 0.819 * f / (lost * (1 + ((2 + real) / lost) ** 2)) == pytest.approx(3.15, abs=0.005)


def test_more_fog_rain_or_dust_reduces_the_range() -> None:
    for name in ("fog_density", "precipitation", "dust_storm"):
        for kind in KINDS:
            found = [reach_in(kind, day(**{name: share})) for share in (0.0, 10.0, 30.0, 60.0, 100.0)]
            assert found == sorted(found, reverse=True), (name, kind)
    assert reach_in("camera", day(fog_density=100.0)) < 30.0


def test_fog_and_dust_hardly_touch_a_radar() -> None:
    assert reach_in("radar", day(fog_density=100.0)) > 0.96 * 150.0
    assert reach_in("radar", day(dust_storm=100.0)) == 150.0
    assert reach_in("radar", day(precipitation=100.0)) > 0.75 * 150.0


@pytest.mark.parametrize(("sun", "seen"), [(10.0, 150.0), (0.0, 150.0), (-3.0, 125.0), (-6.0, 100.0), (-90.0, 100.0)])
def test_a_camera_sees_by_headlights_at_night(sun: float, seen: float) -> None:
    assert lit_reach(150.0, 100.0, sun) == pytest.approx(seen)
    assert reach_in("camera", day(sun_altitude_angle=sun)) == pytest.approx(seen)
    assert reach_in("lidar", day(sun_altitude_angle=sun)) == 150.0


def test_headlights_do_not_lengthen_a_short_range() -> None:
    assert reach_in("camera", day(sun_altitude_angle=-30.0), 60.0) == pytest.approx(60.0)


def test_noise_halves_the_reach_of_radar_and_lidar_at_12_decibels() -> None:
    for kind in ("radar", "lidar"):
        program = program_of(kind)
        program.const[slots.K_SENSOR_NOISE] = 40.0 * math.log10(2.0)
        assert quality_of_sensor(program, 0.0) == pytest.approx(0.5)


def test_a_camera_sees_as_far_as_its_health_lets_it() -> None:
    program = program_of("camera")
    state = new_state(program)
    state.weather = list(weather_numbers(day()))
    for health, seen in ((1.0, 150.0), (0.5, 75.0), (0.0, 0.0)):
        state.image_health[0] = health
        assert sensor_reach(program, state) == pytest.approx(seen, rel=2e-3)
    state.image_health[0], state.missing[0] = 1.0, 1
    assert sensor_reach(program, state) == 0.0


def test_the_published_table_agrees_with_the_formulas() -> None:
    """The table of the page: weather, then what camera, lidar and radar see of 150 m."""
    rows = re.findall(r"^\| `(\w+)` \|.*?\| (\d+) m \| (\d+) m \| (\d+) m \|$", PAGE.read_text("utf-8"), re.MULTILINE)
    assert len(rows) >= 6
    for name, *seen in rows:
        weather = weather_preset(name)
        assert weather is not None
        assert [round(reach_in(kind, weather)) for kind in KINDS] == [int(one) for one in seen], name


def test_the_published_extinctions_agree_with_the_formulas() -> None:
    rows = re.findall(
        r"^\| fog (\d+) % \| (\d+) m \| (\d+) m \| (\d+) m \| (\d+) m \|$", PAGE.read_text("utf-8"), re.MULTILINE
    )
    assert len(rows) >= 4
    for fog, optical, *seen in rows:
        assert round(math.log(20.0) / haze_extinction(0.01 * int(fog), 0.0, 0.0)) == int(optical)
        weather = day(fog_density=float(fog))
        assert [round(reach_in(kind, weather)) for kind in KINDS] == [int(one) for one in seen], fog


def in_weather(kind: SensorKind, weather: Weather) -> Draft:
    """Return a draft that drives at 20 m/s towards what is parked 200 m on, in a weather, with cameras that fail."""
    draft = Draft(highway(), {slots.K_HEADLIGHTS: 80.0, slots.K_SENSOR_NOISE: 3.0, slots.K_NOISE: 10.0})
    p = draft.program
    p.forward_sensor[0] = SENSOR_CODES[kind]
    p.weather_const, p.weather_count = [draft.block(*weather_numbers(weather))], [1]
    p.failure_kind, p.failure_waits, p.failure_count = [op.FAILURE_DIRT, op.FAILURE_DROPOUT], [0, 0], [2]
    p.failure_const = [draft.block(2.0, 5.0, 1.0, 0.5), draft.block(4.0, -1.0, 0.0, 0.3)]
    draft.ego(speed=20.0)
    draft.parked(200.0)
    return draft


@pytest.mark.parametrize("kind", KINDS)
def test_both_forms_of_the_engine_see_the_same(kind: SensorKind) -> None:
    for name in ("ClearNoon", "HardRainNight", "SoftRainSunset", "DustStorm"):
        weather = weather_preset(name)
        assert weather is not None
        draft = in_weather(kind, weather)
        run = run_both(draft.network.tables, draft.program, [draft.program.const], [make_draws(3)], 200)
        assert run.interpreted == run.compiled, name
    assert len(WEATHER_PRESETS) == 23
