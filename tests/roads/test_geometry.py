from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from scenario_compiler.roads.geometry import piece_point, polynomial_parameter, road_reference, wrap_heading
from tests.roads.make import lane, network, road, section


def plan(shape: str, length: float, h: float = 0.0) -> str:
    return f'<geometry s="0" x="0" y="0" hdg="{h}" length="{length}">{shape}</geometry>'


@pytest.mark.parametrize(("k0", "k1"), [(0.0, 0.02), (0.02, -0.02), (-0.001, 0.1), (0.05, 0.0)])
def test_spiral_equals_quadrature_over_a_kilometre(tmp_path: Path, k0: float, k1: float) -> None:
    length, h = 1000.0, 0.3
    made = network(tmp_path, road(length=length, plan=plan(f'<spiral curvStart="{k0}" curvEnd="{k1}"/>', length, h)))
    rate = (k1 - k0) / length
    x = y = at = 0.0
    for s in (1.0, 33.3, 250.0, 499.9, 777.0, 1000.0):
        for a in range(int(at), math.ceil(s)):
            low, high = max(at, float(a)), min(s, a + 1.0)
            x += quad(lambda u: math.cos(h + k0 * u + 0.5 * rate * u * u), low, high, epsabs=1e-13)[0]
            y += quad(lambda u: math.sin(h + k0 * u + 0.5 * rate * u * u), low, high, epsabs=1e-13)[0]
        at = s
        px, py, heading, curvature = road_reference(made.tables, 0, s)
        assert math.hypot(px - x, py - y) < 1e-6
        assert heading == pytest.approx(h + k0 * s + 0.5 * rate * s * s, abs=1e-9)
        assert curvature == pytest.approx(k0 + rate * s, abs=1e-12)


def test_the_next_geometry_has_the_road_where_a_spiral_is_stated_too_long(tmp_path: Path) -> None:
    spiral = plan('<spiral curvStart="0" curvEnd="0.05"/>', 100.0)
    line = '<geometry s="60" x="0" y="500" hdg="0" length="90"><line/></geometry>'
    made = network(tmp_path, road(length=150.0, plan=spiral + line))
    assert (np.diff(made.tables.piece_s) > 0.0).all()
    for s in (60.0, 75.0, 99.0, 140.0):
        assert road_reference(made.tables, 0, s) == (s - 60.0, 500.0, 0.0, 0.0)
    assert road_reference(made.tables, 0, 59.0)[3] == pytest.approx(0.05 * 0.59)


def test_arc_is_a_circle(tmp_path: Path) -> None:
    made = network(tmp_path, road(length=50.0, plan=plan('<arc curvature="-0.1"/>', 50.0)))
    for s in (0.0, 7.0, 31.4, 50.0):
        pose = made.road_pose("1", s, 0.0)
        assert math.hypot(pose.x, pose.y + 10.0) == pytest.approx(10.0, abs=1e-12)
        assert pose.heading == pytest.approx((-0.1 * s) % math.tau)
    assert made.curvature("1", 3.0) == -0.1


PARABOLA = 0.02
"""The parabola y = 0.02 x^2 to x = 30 m, where its direction is 50 degrees."""


def length_of_parabola(x: float) -> float:
    slope = 2.0 * PARABOLA * x
    return (math.asinh(slope) + slope * math.sqrt(1.0 + slope * slope)) / (4.0 * PARABOLA)


@pytest.mark.parametrize("shape", ["normalized", "arcLength", "poly3"])
def test_a_parabola_is_followed_by_its_arc_length(tmp_path: Path, shape: str) -> None:
    length = length_of_parabola(30.0)
    wide = 30.0 if shape == "normalized" else 30.0 / length
    text = (
        f'<paramPoly3 pRange="{shape}" aU="0" bU="{wide!r}" cU="0" dU="0" '
        f'aV="0" bV="0" cV="{PARABOLA * wide**2!r}" dV="0"/>'
    )
    if shape == "poly3":
        text = f'<poly3 a="0" b="0" c="{PARABOLA}" d="0"/>'
    made = network(tmp_path, road(length=length, plan=plan(text, length)))
    for at in (0.0, 1.0, 7.7, 15.0, 22.0, 29.9, 30.0):
        x, y, heading, curvature = road_reference(made.tables, 0, length_of_parabola(at))
        slope = 2.0 * PARABOLA * at
        assert math.hypot(x - at, y - PARABOLA * at * at) < 5e-4
        assert heading == pytest.approx(math.atan(slope), abs=1e-4)
        assert curvature == pytest.approx(2.0 * PARABOLA / (1.0 + slope * slope) ** 1.5, abs=1e-5)


@pytest.mark.parametrize("b", [1.0, 0.75, 1.5, 0.3])
def test_a_line_with_a_cubic_parameter_is_a_line(tmp_path: Path, b: float) -> None:
    """U = 20 m (b p + (3 - 3 b) p^2 + (2 b - 2) p^3); its speeds at the ends are b times the mean, or 4.5 : 1."""
    shape = (
        f'<paramPoly3 pRange="normalized" aU="0" bU="{20.0 * b}" cU="{60.0 - 60.0 * b}" dU="{40.0 * b - 40.0}" '
        'aV="0" bV="0" cV="0" dV="0"/>'
    )
    n = network(tmp_path, road(length=20.0, plan=plan(shape, 20.0))).tables
    for i in range(201):
        x, y, heading, curvature, speed = piece_point(n, 0, 0.1 * i)
        assert (x, y, heading, curvature) == pytest.approx((0.1 * i, 0.0, 0.0, 0.0), abs=5e-4)
        assert speed == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("stated", [20.0, 45.0])
def test_a_wrong_length_stretches_the_whole_curve_evenly(tmp_path: Path, stated: float) -> None:
    """As in esmini, the curve ends where the geometry does."""
    shape = '<paramPoly3 pRange="normalized" aU="0" bU="22.5" cU="22.5" dU="-15" aV="0" bV="0" cV="0" dV="0"/>'
    n = network(tmp_path, road(length=stated, plan=plan(shape, stated))).tables
    for share in (0.0, 0.2, 0.5, 0.9, 1.0):
        x, _, _, _, speed = piece_point(n, 0, stated * share)
        assert x == pytest.approx(30.0 * share, abs=5e-4)
        assert speed == pytest.approx(30.0 / stated, rel=1e-3)


@pytest.mark.parametrize("shape", ['dU="30" bU="0"', 'dU="-60" bU="90" cU="0"', 'bU="1e200" dU="1e300"', 'bU="0"'])
def test_curves_that_stand_still_turn_back_or_overflow_are_followed(tmp_path: Path, shape: str) -> None:
    n = network(tmp_path, road(length=30.0, plan=plan(f'<paramPoly3 pRange="normalized" {shape}/>', 30.0))).tables
    before = -math.inf
    for i in range(-20, 321):
        place, rate = polynomial_parameter(n, 0, 0.1 * i)
        assert place >= before
        assert 0.0 <= rate < math.inf
        before = place
    assert polynomial_parameter(n, 0, 0.0)[0] == 0.0
    assert polynomial_parameter(n, 0, 30.0)[0] == pytest.approx(1.0)
    assert len(n.knot_p) <= 513


def test_a_curve_that_starts_from_a_standstill_keeps_its_places(tmp_path: Path) -> None:
    shape = '<paramPoly3 pRange="normalized" aU="0" bU="0" cU="30" dU="0" aV="0" bV="0" cV="0" dV="0"/>'
    n = network(tmp_path, road(length=30.0, plan=plan(shape, 30.0))).tables
    for i in range(301):
        assert road_reference(n, 0, 0.1 * i)[0] == pytest.approx(0.1 * i, abs=0.03)


def test_a_curve_goes_on_beyond_its_ends(tmp_path: Path) -> None:
    shape = '<paramPoly3 pRange="normalized" aU="0" bU="15" cU="45" dU="-30" aV="0" bV="0" cV="0" dV="0"/>'
    n = network(tmp_path, road(length=30.0, plan=plan(shape, 30.0))).tables
    for s in (-1.0, -0.01, 30.01, 31.0):
        x, _, heading, _, speed = piece_point(n, 0, s)
        assert x == pytest.approx(s, abs=0.3)
        assert heading == 0.0
        assert speed > 0.0


@pytest.mark.parametrize("shape", ["paramPoly3", "poly3"])
@pytest.mark.parametrize("length", ["0", "1e-320"])
def test_a_curve_without_a_length_is_a_point(tmp_path: Path, shape: str, length: str) -> None:
    text = f'<geometry s="0" x="2" y="1" hdg="0" length="{length}"><{shape} bU="1"/></geometry>'
    line = '<geometry s="0" x="2" y="1" hdg="0" length="50"><line/></geometry>'
    x, y, _, _ = road_reference(network(tmp_path, road(length=50.0, plan=text + line)).tables, 0, 10.0)
    assert (x, y) == (12.0, 1.0)
    alone = network(tmp_path, road(length=1.0, plan=text)).tables
    assert road_reference(alone, 0, 0.0)[:2] == (2.0, 1.0)


COORDINATE = st.floats(-60.0, 60.0)


@given(st.floats(3.0, 60.0), COORDINATE, COORDINATE, COORDINATE, COORDINATE, st.booleans(), st.floats(0.8, 1.25))
@settings(suppress_health_check=[HealthCheck.filter_too_much])
def test_curves_are_followed_at_the_speed_1(
    tmp_path_factory: pytest.TempPathFactory,
    ahead: float,
    x2: float,
    y2: float,
    x3: float,
    y3: float,
    by_length: bool,
    stretch: float,
) -> None:
    """Bezier curves are compared with a dense numerical integration, with right and wrong lengths."""
    u = (3.0 * ahead, 3.0 * x2 - 6.0 * ahead, x3 - 3.0 * x2 + 3.0 * ahead)
    v = (0.0, 3.0 * y2, y3 - 3.0 * y2)
    at = np.linspace(0.0, 1.0, 20001)
    speeds = np.hypot(*(b + at * (2.0 * c + 3.0 * at * d) for b, c, d in (u, v)))
    assume(speeds.min() > 0.3 * speeds.mean())
    done = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(at))])
    length = float(done[-1]) * stretch
    unit = length if by_length else 1.0
    names = [f"{name}{axis}" for axis in "UV" for name in "bcd"]
    values = [value / unit ** (i % 3 + 1) for i, value in enumerate((*u, *v))]
    more = " ".join(f'{name}="{value!r}"' for name, value in zip(names, values, strict=True))
    text = f'<paramPoly3 pRange="{"arcLength" if by_length else "normalized"}" aU="0" aV="0" {more}/>'
    n = network(tmp_path_factory.getbasetemp(), road(length=length, plan=plan(text, length))).tables
    for s in np.linspace(0.0, length, 150):
        q = np.interp(s / stretch, done, at)
        x, y, _, _, speed = piece_point(n, 0, s)
        there = [q * (b + q * (c + q * d)) for b, c, d in (u, v)]
        assert math.hypot(x - there[0], y - there[1]) < 2e-3
        assert speed * stretch == pytest.approx(1.0, abs=1e-3)


@given(st.floats(-0.5, 0.5), st.floats(-0.02, 0.02), st.floats(-0.0003, 0.0003), st.floats(5.0, 80.0))
def test_a_poly3_is_followed_at_the_speed_1(
    tmp_path_factory: pytest.TempPathFactory, b: float, c: float, d: float, length: float
) -> None:
    text = f'<poly3 a="0" b="{b!r}" c="{c!r}" d="{d!r}"/>'
    n = network(tmp_path_factory.getbasetemp(), road(length=length, plan=plan(text, length))).tables
    u = np.linspace(0.0, length, 20001)
    speeds = np.hypot(1.0, b + u * (2.0 * c + 3.0 * u * d))
    done = np.concatenate([[0.0], np.cumsum(0.5 * (speeds[1:] + speeds[:-1]) * np.diff(u))])
    for s in np.linspace(0.0, length, 100):
        at = np.interp(s, done, u)
        x, y, _, _, speed = piece_point(n, 0, s)
        assert math.hypot(x - at, y - at * (b + at * (c + at * d))) < 2e-3
        assert speed == pytest.approx(1.0, abs=1e-3)


def test_elevation_and_superelevation(tmp_path: Path) -> None:
    more = (
        '<elevationProfile><elevation s="0" a="5" b="0.1" c="0" d="0"/></elevationProfile>'
        '<lateralProfile><superelevation s="0" a="0.1" b="0" c="0" d="0"/></lateralProfile>'
    )
    made = network(tmp_path, road(more=more))
    pose = made.road_pose("1", 10.0, 2.0)
    assert pose.y == pytest.approx(2.0 * math.cos(0.1))
    pitch = -math.atan(0.1)
    assert pose.x == pytest.approx(10.0 + 2.0 * math.sin(pitch) * math.sin(0.1))
    assert pose.z == pytest.approx(6.0 + 2.0 * math.cos(pitch) * math.sin(0.1))
    assert pose.pitch == pytest.approx(pitch)
    assert pose.roll == pytest.approx(0.1)
    assert made.grade("1", 10.0) == pytest.approx(0.1)
    place = made.locate(pose.x, pose.y)[0]
    assert (place.s, place.offset) == pytest.approx((10.0, 2.0 - 1.75))


def test_lateral_shape_lies_between_its_stations(tmp_path: Path) -> None:
    stations = "".join(
        f'<shape s="{s}" t="{t}" a="0" b="{b}" c="0" d="0"/>' for s, b in ((0, 0.1), (50, 0.3)) for t in (-5, 0)
    )
    made = network(tmp_path, road(more=f"<lateralProfile>{stations}</lateralProfile>"))
    assert made.road_pose("1", 25.0, 2.0).z == pytest.approx(0.4)
    assert made.road_pose("1", 80.0, 2.0).z == pytest.approx(0.6)


def test_crossfall_falls_to_the_outside(tmp_path: Path) -> None:
    fall = '<crossfall side="both" s="0" a="0.05" b="0" c="0" d="0"/>'
    made = network(tmp_path, road(more=f"<lateralProfile>{fall}</lateralProfile>"))
    for t in (-3.0, 3.0):
        assert made.road_pose("1", 10.0, t).z == pytest.approx(-3.0 * math.sin(0.05))


def test_a_level_lane_stays_horizontal(tmp_path: Path) -> None:
    width = '<width sOffset="0" a="3" b="0" c="0" d="0"/>'
    curb = f'<lane id="-2" type="sidewalk" level="true">{width}<height sOffset="0" inner="0.1" outer="0.2"/></lane>'
    more = '<lateralProfile><superelevation s="0" a="0.1" b="0" c="0" d="0"/></lateralProfile>'
    made = network(tmp_path, road(more=more, lanes=section(lane(1), lane(-1, width) + curb)))
    pose = made.lane_pose("1", -2, 10.0)
    assert pose.z == pytest.approx(-3.0 * math.sin(0.1) + 0.15)
    assert pose.y == pytest.approx(-4.5 * math.cos(0.1))
    rim = made.lane_pose("1", -2, 10.0, -1.495)
    assert made.locate(rim.x, rim.y)[0] == pytest.approx(("1", -2, 10.0, -1.495))
    assert pose.roll == 0.0


@given(st.floats(-1e6, 1e6))
def test_headings_are_wrapped(h: float) -> None:
    wrapped = wrap_heading(h)
    assert 0.0 <= wrapped < math.tau
    assert math.cos(wrapped - h) == pytest.approx(1.0, abs=1e-6)


def test_headings_just_below_zero_wrap_to_zero() -> None:
    assert wrap_heading(-1e-17) == 0.0
