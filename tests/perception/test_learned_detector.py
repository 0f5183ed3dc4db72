"""The learned detector's own parts; what every detector keeps is in `tests/contracts/test_detectors.py`."""

from __future__ import annotations

import hashlib
import math
from dataclasses import replace
from importlib import resources

import numpy as np
import pytest

from scenario_compiler.perception.calibration.scenes import Reference
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import PLACES
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_detector import LaneState
from scenario_compiler.perception.learned_detector import (
    COLUMNS,
    LEARNED_FEATURES,
    NETWORK_FILE,
    ROWS,
    TRAINED_FOR,
    LearnedLaneDetector,
    Rows,
    ground_of,
    homography_to_trained,
    tilt_between,
)
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.solids import Box
from tests.perception.scenery import CLEAR, EU_DASH, US_DASH, bend, two_lanes


@pytest.mark.parametrize("pitch", [0.0, 0.02, -0.02])
def test_pixels_are_laid_on_the_ground_that_they_show(pitch: float) -> None:
    x, y = np.array([6.0, 12.0, 20.0]), np.array([1.75, -1.75, 0.3])
    u, v = TRAINED_FOR.project_ground(x, y, pitch)
    back_x, back_y = ground_of(u, v, pitch)
    assert back_x == pytest.approx(x)
    assert back_y == pytest.approx(y)


def test_pixels_over_the_horizon_show_no_ground() -> None:
    x, _ = ground_of(np.array([256.0]), np.array([10.0]), 0.0)
    assert np.isinf(x[0])


V = (np.arange(ROWS) + 0.5) * TRAINED_FOR.height / ROWS - 0.5


def rows_of(y: float, pitch: float, widens: float = 0.0) -> Rows:
    """Return the rows of a straight boundary y m to the left, seen under a tilt, that moves out by a share of x."""
    x, _ = ground_of(np.zeros(ROWS), V, pitch)
    seen = np.isfinite(x)
    u, _ = TRAINED_FOR.project_ground(x[seen], y + math.copysign(widens, y) * x[seen], pitch)
    column = np.zeros(ROWS)
    column[seen] = (u + 0.5) * COLUMNS / TRAINED_FOR.width - 0.5
    return Rows(seen.astype(float), column, np.full(ROWS, 0.5), np.ones(ROWS))


@pytest.mark.parametrize("pitch", [0.0, 0.01, -0.01, 0.02])
def test_converging_sides_determine_the_tilt(pitch: float) -> None:
    tilt = tilt_between(rows_of(1.75, pitch), rows_of(-1.75, pitch), V, 0.0)
    assert tilt.pitch == pytest.approx(pitch, abs=0.1 * abs(pitch) + 1e-6)
    assert tilt.deviation < math.radians(0.4)


def test_a_lane_that_widens_is_taken_for_a_tilt_no_surer_than_tapers_allow() -> None:
    taper = tilt_between(rows_of(1.75, 0.0, 0.01), rows_of(-1.75, 0.0, 0.01), V, 0.0)
    assert abs(taper.pitch) < 3.0 * taper.deviation


def test_one_side_does_not_determine_the_tilt() -> None:
    left = rows_of(1.75, 0.0)
    nothing = replace(left, there=np.zeros(ROWS))
    assert math.isinf(tilt_between(left, nothing, V, 0.0).deviation)


def test_a_row_tells_the_likeliest_of_two_lines() -> None:
    one = np.zeros((ROWS, COLUMNS + 1))
    one[:, 19:22] = 0.15, 0.3, 0.15
    one[:, 60] = 0.2
    one[:, -1] = 0.2
    rows = Rows.of(one)
    assert rows.column == pytest.approx(np.full(ROWS, 20.0))
    assert rows.alone == pytest.approx(np.full(ROWS, 0.75))
    assert rows.there == pytest.approx(np.full(ROWS, 0.8))
    assert (rows.spread > 15.0).all()


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
    crossing, (with_way, _) = detector.look(image, LaneState(way=straight))
    assert (row[way], with_way[way]) == (0.0, 1.0)
    assert row[junction] < 0.0 < with_way[junction]
    of_route = [way, junction, *(LEARNED_FEATURES.index(name) for name in ("off_route", "bent_off_route"))]
    assert np.array_equal(np.delete(row, of_route), np.delete(with_way, of_route))
    assert crossing.left.y0 == free.left.y0
    turning = Course.along([WayPoint(float(x), 0.01 * x * x) for x in range(40)])
    (left, right), bend_to = detector.look(image, LaneState(way=turning))[1], LEARNED_FEATURES.index("bend")
    assert left[bend_to] == -right[bend_to] == pytest.approx(2.0 * math.atan(0.32), rel=0.1)


@pytest.mark.parametrize(("turned", "bent"), [(0.1, 0.0), (-0.05, 0.01)])
def test_the_confidence_knows_by_how_much_a_boundary_turns_from_the_route(turned: float, bent: float) -> None:
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(60.0), [], CLEAR, 0.0, 0)
    ahead = np.arange(40.0)
    way = Course.along(
        [WayPoint(float(x), float(y)) for x, y in zip(ahead, turned * ahead + 0.5 * bent * ahead**2, strict=True)]
    )
    assert way is not None
    begin, end = (way.heading_at(np.array([6.0, 18.0]))).tolist()
    _, (left, right) = LearnedLaneDetector().look(image, LaneState(way=way))
    for row, sign in ((left, -1.0), (right, 1.0)):
        assert row[LEARNED_FEATURES.index("off_route")] == pytest.approx(sign * 5.0 * (begin + end), abs=0.1)
        assert row[LEARNED_FEATURES.index("bent_off_route")] == pytest.approx(sign * 10.0 * (end - begin), abs=0.2)


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


@pytest.mark.parametrize("radius", [0.0, 50.0, -50.0])
def test_an_error_of_the_tilt_moves_a_boundary_by_its_lever(radius: float) -> None:
    detector, error = LearnedLaneDetector(), 1e-4
    image = RoadCamera(two_lanes(bend(radius))).frame(bend(radius).pose(60.0), [], CLEAR, 0.0, 0)
    (level, rows), tilted = detector.look(image, pitch=0.0), detector.detect(image, pitch=error)
    for row, before, after in zip(rows, (level.left, level.right), (tilted.left, tilted.right), strict=True):
        moved = np.abs(after.y(PLACES) - before.y(PLACES)).max()
        assert moved / error == pytest.approx(20.0 * row[LEARNED_FEATURES.index("lever")], rel=0.15)


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
