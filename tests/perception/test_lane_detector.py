from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from scenario_compiler.perception.calibration.scenes import Fading, Line, Reference, Strip, make_scene
from scenario_compiler.perception.calibration.truth import Truth
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.degradation import add_noise
from scenario_compiler.perception.lane_detector import Boundary, ClassicalLaneDetector, LaneResult, LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.scene import Scene
from scenario_compiler.roads.mesh import Material
from scenario_compiler.roads.positions import Pose
from tests.perception.scenery import CLEAR, EU_DASH, SOLID, US_DASH, bend, fork, in_ground, route, two_lanes, weather

DETECTOR = ClassicalLaneDetector()
X = np.arange(6.0, 18.5, 1.0)


def seen(scene: Scene, pose: Pose, sigma: float = 0.0, prior: LaneState | None = None) -> LaneResult:
    return DETECTOR.detect(RoadCamera(scene).frame(pose, [], CLEAR, sigma, 0), prior)


def true_boundary(reference: Reference, pose: Pose, t: float) -> np.ndarray:
    s = np.arange(0.0, reference.length, 0.25)
    ground = in_ground(reference.at(s, t), pose)
    ahead = (ground[:, 0] > 0.0) & (ground[:, 0] < 40.0)
    return np.asarray(np.interp(X, ground[ahead, 0], ground[ahead, 1]))


@pytest.mark.parametrize("dash", [SOLID, US_DASH, EU_DASH], ids=["solid", "us", "eu"])
@pytest.mark.parametrize("width", [3.0, pytest.param(3.5, marks=pytest.mark.slow), 3.75])
@pytest.mark.parametrize("radius", [0.0, 100.0, pytest.param(-100.0, marks=pytest.mark.slow), 300.0])
def test_new_marks_are_found_and_trusted(radius: float, width: float, dash: tuple[float, float]) -> None:
    reference = bend(radius)
    scene = two_lanes(reference, width, dash)
    results = []
    for s in (70.0, 77.0, 84.0):
        pose = reference.pose(s)
        result = seen(scene, pose)
        results += [result.p_left, result.p_right]
        for boundary, t in ((result.left, width / 2), (result.right, -width / 2)):
            assert np.abs(boundary.y(X) - true_boundary(reference, pose, t)).max() < 0.25
        assert result.lane_width == pytest.approx(width, abs=0.2)
    assert np.mean(results) > 0.9


def test_confidence_falls_steadily_with_wear() -> None:
    reference = bend(250.0)
    means = []
    for quality in (1.0, 0.7, 0.45, 0.3, 0.15, 0.0):
        scene = two_lanes(reference, quality=quality)
        results = [seen(scene, reference.pose(s)) for s in (64.0, 72.0, 80.0, 88.0)]
        means.append(np.mean([(r.p_left + r.p_right) / 2 for r in results]))
    assert means[0] > 0.9
    assert means[-1] < 0.3
    assert all(a > b - 0.02 for a, b in pairwise(means))


def test_sensor_health_falls_with_noise_and_takes_the_probabilities_with_it() -> None:
    reference = bend(0.0)
    scene = two_lanes(reference)
    clean, little, much = (seen(scene, reference.pose(40.0), sigma) for sigma in (0.0, 5.0, 60.0))
    assert clean.sensor_health > 0.99
    assert clean.p_left - little.p_left < 0.03
    assert little.sigma_hat == pytest.approx(5.0, rel=0.1)
    assert much.sensor_health < 0.01
    assert max(much.p_left, much.p_right) < 0.01
    assert much.left.p_geom > 0.6


def test_rain_is_not_taken_for_a_broken_sensor() -> None:
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(40.0), [], weather("HardRainNoon"), 0.0, 3)
    assert DETECTOR.detect(image).sensor_health > 0.98


def test_the_stronger_line_of_the_next_lane_is_not_ours() -> None:
    """Our left line is worn, the one beyond the next lane is new: the pair stays in our lane."""
    reference = bend(150.0)
    lines = [
        Line(5.25, width=0.25),
        Line(1.75, *EU_DASH, quality=Fading(0.5, 0.5)),
        Line(-1.75, quality=Fading(0.5, 0.5)),
        Line(-5.25, width=0.25),
    ]
    scene = make_scene(reference, [Strip(30, -30, Material.VERGE), Strip(6, -6)], lines)
    for s in (68.0, 76.0, 84.0):
        for offset in (-0.4, 0.4):
            result = seen(scene, reference.pose(s, offset))
            assert 3.0 < result.lane_width < 4.0
            assert abs(float(result.left.y(8.0) + result.right.y(8.0)) / 2 + offset) < 0.5


def test_the_rim_of_the_asphalt_is_not_a_line() -> None:
    reference = bend(200.0)
    strips = [Strip(30, -30, Material.VERGE), Strip(2.0, -1.9)]
    scene = make_scene(reference, strips, [])
    for s in (66.0, 74.0, 82.0):
        result = seen(scene, reference.pose(s))
        assert max(result.p_left, result.p_right) < 0.3


def test_a_known_pitch_is_taken_into_account() -> None:
    reference = bend(0.0)
    scene = two_lanes(reference)
    nose_up = reference.pose(40.0)._replace(pitch=-0.015)
    image = RoadCamera(scene).frame(nose_up, [], CLEAR, 0.0, 0)
    blind, told = DETECTOR.detect(image, pitch=0.0), DETECTOR.detect(image, pitch=0.015)
    error = [abs(float(r.left.y(16.0)) - 1.75) for r in (blind, told)]
    assert error[1] < 0.15 < error[0]
    assert DETECTOR.detect(image, pitch=0.0) == blind


@pytest.mark.parametrize("radius", [20.0, 30.0, -40.0])
@pytest.mark.parametrize("pitch", [-0.01, 0.0, 0.01])
def test_in_a_sharp_bend_the_route_tells_a_tilt_from_the_bend(radius: float, pitch: float) -> None:
    reference = bend(radius)
    pose = reference.pose(75.0)
    image = RoadCamera(two_lanes(reference)).frame(pose._replace(pitch=pitch), [], CLEAR, 0.0, 0)
    state = LaneState()
    for _ in range(4):
        found = DETECTOR.detect(image, replace(state, way=route(reference, pose)))
        state = state.after(found)
    assert found.tilt.pitch == pytest.approx(-pitch, abs=0.004)
    s = np.arange(75.0, 100.0, 0.5)
    truth = Truth.of(DETECTOR.camera.view(pose, 1.4), reference.points(s, 1.75), reference.points(s, -1.75), (1.0, 1.0))
    assert max(truth.error(side, one) for side, one in enumerate((found.left, found.right))) < 0.25
    assert max(found.p_left, found.p_right) > 0.5


STRAIGHT = Reference([(150.0, 0.0, 0.0)])
AHEAD = (0.0, 0.0)


def turning(radius: float) -> Reference:
    """A road that is straight for 30 m and then turns left with a radius (right when negative)."""
    return Reference([(30.0, 0.0, 0.0), (90.0, 1.0 / radius, 1.0 / radius)])


@pytest.mark.parametrize("radius", [60.0, -60.0, 80.0, -80.0])
def test_where_painted_lanes_diverge_the_route_selects_one(radius: float) -> None:
    turn, pose = turning(radius), STRAIGHT.pose(32.0)
    image = RoadCamera(fork(STRAIGHT, turn)).frame(pose, [], CLEAR, 0.0, 0)
    for branch in (STRAIGHT, turn):
        found = DETECTOR.detect(image, LaneState(way=route(branch, pose)))
        for boundary, t in ((found.left, 1.75), (found.right, -1.75)):
            assert np.abs(boundary.y(X) - true_boundary(branch, pose, t))[:9].max() < 0.25
            assert boundary.p_geom > 0.6


@pytest.mark.parametrize("way", [AHEAD, (0.0, 0.012), (-0.05, -0.01)])
@pytest.mark.parametrize("quality", [1.0, 0.0])
def test_the_route_adds_no_paint(way: tuple[float, float], quality: float) -> None:
    """A painted lane is found where it is and an unpainted one not at all, even if the route is another's."""
    reference = bend(0.0)
    image = RoadCamera(two_lanes(reference, quality=quality)).frame(reference.pose(40.0), [], CLEAR, 0.0, 0)
    slope, curvature = way
    course = Course.along([WayPoint(float(x), slope * x + 0.5 * curvature * x * x) for x in range(40)])
    blind, told = DETECTOR.detect(image), DETECTOR.detect(image, LaneState(way=course))
    if quality == 0.0:
        assert max(told.p_left, told.p_right) < 0.3
        return
    for without, with_way in ((blind.left, told.left), (blind.right, told.right)):
        assert float(np.abs(without.y([6.0, 18.0]) - with_way.y([6.0, 18.0])).max()) < 0.15
        assert with_way.p_geom < without.p_geom + 0.1
        assert way != AHEAD or with_way.p_geom == pytest.approx(without.p_geom, abs=0.1)


def test_detection_depends_on_its_arguments_only() -> None:
    reference = bend(0.0)
    image = RoadCamera(two_lanes(reference)).frame(reference.pose(40.0), [], CLEAR, 0.0, 0)
    first = DETECTOR.detect(image)
    DETECTOR.detect(add_noise(image, 40.0, 1, 1), LaneState().after(first))
    assert DETECTOR.detect(image) == first
    assert ClassicalLaneDetector().detect(image) == first


@pytest.mark.parametrize("shade", [0, 128, 255])
def test_an_empty_image_has_no_lane(shade: int) -> None:
    result = DETECTOR.detect(np.full((256, 512, 3), shade, np.uint8))
    assert max(result.p_left, result.p_right) < 0.1


def test_pure_noise_has_no_lane() -> None:
    image = add_noise(np.full((256, 512, 3), 90, np.uint8), 20.0, 1, 1)
    assert max(DETECTOR.detect(image).left.p_geom, DETECTOR.detect(image).right.p_geom) < 0.2


def boundary(offset: float, p: float) -> Boundary:
    return Boundary(offset, 0.0, 0.0, p, p, p, (5.0, 25.0))


def test_what_is_remembered() -> None:
    sure, unsure = boundary(1.7, 0.95), boundary(-1.8, 0.2)
    both = LaneResult(sure, boundary(-1.8, 0.9), 1.0, 0.3, 0.95, 0.9, 3.5)
    one = LaneResult(sure, unsure, 1.0, 0.3, 0.95, 0.2, 3.1)
    state = LaneState().after(both)
    assert state.width == 3.5
    later = state.after(one)
    assert later.left == sure
    assert later.right is None
    assert later.width == 3.5
