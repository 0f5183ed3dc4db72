"""The learned detector's own parts; what every detector keeps is in `tests/contracts/test_detectors.py`."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from scenario_compiler.perception.calibration.scenes import Fading, Reference
from scenario_compiler.perception.calibration.truth import Truth
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import PLACES
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_detector import LaneState
from scenario_compiler.perception.lane_rows import COLUMNS, ROWS, TRAINED_FOR
from scenario_compiler.perception.learned_detector import (
    LEARNED_FEATURES,
    NETWORK_FILE,
    LearnedLaneDetector,
    homography_to_trained,
)
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.solids import Box
from tests.perception.scenery import CLEAR, EU_DASH, US_DASH, bend, route, two_lanes


def test_images_of_another_camera_are_warped_to_the_trained_one() -> None:
    camera = Camera(width=800, height=500, fov=math.radians(60.0), yaw=0.1, pitch=-0.15, roll=0.05)
    homography = homography_to_trained(camera)
    x, y = np.array([8.0, 15.0]), np.array([1.0, -2.0])
    u, v = camera.project_ground(x, y)
    turned = homography @ np.stack([u, v, np.ones(2)])
    wanted = replace(TRAINED_FOR, z=camera.z).project_ground(x, y)
    assert turned[:2] / turned[2] == pytest.approx(np.stack(wanted), abs=1e-6)


def test_the_confidence_knows_whether_the_route_is_known() -> None:
    detector, way, junction = LearnedLaneDetector(), LEARNED_FEATURES.index("way"), LEARNED_FEATURES.index("junction")
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(60.0), [], CLEAR, 0.0, 0)
    free, (row, _) = detector.look(image)
    straight = Course.along([WayPoint(float(x), 0.0) for x in range(40)])
    along, (with_way, _) = detector.look(image, LaneState(way=straight))
    assert (row[way], with_way[way]) == (0.0, 1.0)
    assert row[junction] < 0.0 < with_way[junction]
    assert free.left.course is None
    assert along.left.course is straight
    for before, after in ((free.left, along.left), (free.right, along.right)):
        assert after.y(PLACES) == pytest.approx(before.y(PLACES), abs=0.1)
    turning = Course.along([WayPoint(float(x), 0.01 * x * x) for x in range(40)])
    (left, right), bend_to = detector.look(image, LaneState(way=turning))[1], LEARNED_FEATURES.index("bend")
    assert left[bend_to] == -right[bend_to] == pytest.approx(2.0 * math.atan(0.32), rel=0.1)


@pytest.mark.parametrize("curvature", [0.02, -0.02])
def test_the_confidence_knows_that_a_boundary_leaves_the_route(curvature: float) -> None:
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(60.0), [], CLEAR, 0.0, 0)
    astray, on_line = LEARNED_FEATURES.index("astray_far"), LEARNED_FEATURES.index("on_line")
    straight, turning = (
        Course.along([WayPoint(float(x), 0.5 * bent * x * x) for x in range(40)]) for bent in (0.0, curvature)
    )
    detector = LearnedLaneDetector()
    ahead = detector.look(image, LaneState(way=straight))[1]
    found, aside = detector.look(image, LaneState(way=turning))
    for number, sign in ((0, 1.0), (1, -1.0)):
        assert abs(ahead[number][astray]) < 0.1
        assert aside[number][astray] * sign * curvature < 0.0
        assert aside[number][on_line] < ahead[number][on_line]
    assert max(found.left.p_geom, found.right.p_geom) < 0.5


@pytest.mark.parametrize("radius", [30.0, -30.0, 20.0, -20.0])
def test_sharp_bends_are_found_along_the_route(radius: float) -> None:
    reference = bend(radius)
    pose = reference.pose(66.0)
    view = TRAINED_FOR.view(pose, 1.4)
    left, right = (reference.points(np.arange(60.0, 110.0, 0.5), t) for t in (1.75, -1.75))
    truth = Truth.of(view, left, right, (1.0, 1.0))
    image = RoadCamera(two_lanes(reference)).frame(pose, [], CLEAR, 0.0, 0)
    found = LearnedLaneDetector().detect(image, LaneState(way=route(reference, pose)))
    assert max(truth.error(0, found.left), truth.error(1, found.right)) < 0.25


def test_paint_of_the_images_before_counts() -> None:
    camera, detector = RoadCamera(two_lanes(bend(0.0))), LearnedLaneDetector()
    bare = RoadCamera(two_lanes(bend(0.0), quality=0.0))
    now, lately = (LEARNED_FEATURES.index(name) for name in ("painted", "painted_lately"))
    state, seen, means = LaneState(), [], []
    for number, one in enumerate((camera, camera, bare, bare, bare)):
        found, (row, _) = detector.look(one.frame(bend(0.0).pose(60.0 + number), [], CLEAR, 0.0, number), state)
        state = state.after(found)
        seen.append(row[now])
        means.append(row[lately])
    assert means[0] == seen[0]
    assert means[1] == pytest.approx(np.mean(seen[:2]))
    assert means[2] == pytest.approx(np.mean(seen[:3]))
    assert seen[2] < means[2] < means[1]
    assert seen[4] < means[4] < means[3] < means[2]


def test_the_confidence_sees_the_paint_along_each_boundary_and_beside_the_other_one() -> None:
    """The left line is broken, and the right one wears away from 11 to 13 m ahead of the camera."""
    road = two_lanes(bend(0.0), quality=Fading(1.0, 0.0, 73.0, 75.0))
    image = RoadCamera(road).frame(bend(0.0).pose(60.0), [], CLEAR, 0.0, 0)
    left, right = (
        dict(zip(LEARNED_FEATURES, row.tolist(), strict=True)) for row in LearnedLaneDetector().look(image)[1]
    )
    assert right["stripe_near"] > 0.8 > left["stripe_near"] > 0.2
    assert right["stripe_far"] < 0.3
    assert right["beyond"] == 0.0
    assert right["gap"] > 0.25 * 4.0
    assert right["ends"] > 0.1 * 4.0
    assert right["weber_near"] > right["weber_far"]
    for mine, others in ((left, right), (right, left)):
        for name in ("stripe_near", "stripe_far", "weber_near"):
            assert mine["other_" + name] == others[name]


@pytest.mark.parametrize("radius", [40.0, -40.0])
def test_the_confidence_knows_the_outer_side_of_a_bend(radius: float) -> None:
    image = RoadCamera(two_lanes(bend(radius))).frame(bend(radius).pose(65.0), [], CLEAR, 0.0, 0)
    found, (left, right) = LearnedLaneDetector().look(image)
    outer, inner = (right, left) if radius > 0.0 else (left, right)
    for name in ("lever", "deviation_tilt"):
        index = LEARNED_FEATURES.index(name)
        assert outer[index] > inner[index]
    sides = (found.right, found.left) if radius > 0.0 else (found.left, found.right)
    assert sides[0].p_geom < sides[1].p_geom


@pytest.mark.parametrize("dash", [EU_DASH, US_DASH])
@pytest.mark.parametrize("gap", [6.0, 8.0])
def test_lines_beside_a_lorry_close_ahead_are_still_painted(dash: tuple[float, float], gap: float) -> None:
    straight = Reference([(200.0, 0.0, 0.0)])
    detector, camera, sides = LearnedLaneDetector(), RoadCamera(two_lanes(straight, dash=dash)), []
    for k in range(8):
        here = 40.0 + 2.5 * k
        rear = straight.pose(here + 3.5 + gap + 4.25)
        lorry = Box(rear.x, rear.y, rear.z, rear.heading, 8.5, 2.5, 3.5, (90, 120, 160), "truck", rear.pitch)
        found = detector.detect(camera.frame(straight.pose(here), [lorry], CLEAR, 0.0, k))
        sides.append(max(found.left.p, found.right.p))
    assert min(sides) > 0.3
    assert np.mean(sides) > 0.6


def test_the_network_is_that_of_the_page() -> None:
    data = resources.files("scenario_compiler.perception").joinpath(NETWORK_FILE).read_bytes()
    assert len(data) < 1_000_000
    assert hashlib.sha256(data).hexdigest() == "e194f83acc0a20d259c2894306f4d0d417e36d503dcdb17bf36228df6ced391b"


def test_rows_are_distributions_over_columns() -> None:
    reference = bend(0.0)
    image = RoadCamera(two_lanes(reference)).frame(reference.pose(40.0), [], CLEAR, 0.0, 0)
    rows, painted, tilt, width = LearnedLaneDetector().tell(image)
    assert rows.shape == (2, ROWS, COLUMNS + 1)
    assert rows.sum(axis=2) == pytest.approx(np.ones((2, ROWS)))
    assert (rows[:, :10, -1] > 0.9).all()  # the sky
    assert painted.min() > 0.8
    assert abs(tilt) < math.radians(0.5)
    assert width == pytest.approx(3.5, abs=0.3)
