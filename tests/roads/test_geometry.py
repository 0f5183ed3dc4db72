from __future__ import annotations

import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from scenario_compiler.roads.geometry import road_reference, wrap_heading
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


def test_arc_is_a_circle(tmp_path: Path) -> None:
    made = network(tmp_path, road(length=50.0, plan=plan('<arc curvature="-0.1"/>', 50.0)))
    for s in (0.0, 7.0, 31.4, 50.0):
        pose = made.road_pose("1", s, 0.0)
        assert math.hypot(pose.x, pose.y + 10.0) == pytest.approx(10.0, abs=1e-12)
        assert pose.heading == pytest.approx((-0.1 * s) % math.tau)
    assert made.curvature("1", 3.0) == -0.1


@pytest.mark.parametrize(("p_range", "scale"), [("normalized", 1.0), ("arcLength", 40.0)])
def test_parametric_polynomials_take_both_ranges(tmp_path: Path, p_range: str, scale: float) -> None:
    shape = (
        f'<paramPoly3 pRange="{p_range}" aU="0" bU="{40.0 / scale}" cU="0" dU="0" '
        f'aV="0" bV="0" cV="{4.0 / scale**2}" dV="0"/>'
    )
    pose = network(tmp_path, road(length=40.0, plan=plan(shape, 40.0))).road_pose("1", 20.0, 0.0)
    assert (pose.x, pose.y) == pytest.approx((20.0, 1.0))
    assert pose.heading == pytest.approx(math.atan(4.0 / 40.0))


def test_poly3_ends_where_its_arc_length_does(tmp_path: Path) -> None:
    u = 30.0
    length = quad(lambda v: math.sqrt(1.0 + (0.02 * v) ** 2), 0.0, u)[0]
    made = network(tmp_path, road(length=length, plan=plan('<poly3 a="0" b="0" c="0.01" d="0"/>', length)))
    pose = made.road_pose("1", length, 0.0)
    assert (pose.x, pose.y) == pytest.approx((u, 9.0), abs=1e-4)


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
    assert pose.roll == 0.0


@given(st.floats(-1e6, 1e6))
def test_headings_are_wrapped(h: float) -> None:
    wrapped = wrap_heading(h)
    assert 0.0 <= wrapped < math.tau
    assert math.cos(wrapped - h) == pytest.approx(1.0, abs=1e-6)


def test_headings_just_below_zero_wrap_to_zero() -> None:
    assert wrap_heading(-1e-17) == 0.0
