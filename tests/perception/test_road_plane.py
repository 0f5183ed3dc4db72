"""The tilt of the camera against the road ahead, told from the lane in its image."""

import math
from dataclasses import replace

import numpy as np
import pytest

from scenario_compiler.perception.calibration.scenes import Line, Reference, Strip, make_scene
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector, LaneState
from scenario_compiler.perception.lane_fit import LEFT, RIGHT, Fit
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.road_plane import LEVEL, USUAL_PITCH, Tilt, alike
from scenario_compiler.roads.mesh import Material
from tests.perception.scenery import CLEAR, bend, two_lanes

DETECTOR = ClassicalLaneDetector()
X = np.arange(6.0, 18.5, 1.0)


@pytest.mark.parametrize("radius", [0.0, 200.0, -120.0])
@pytest.mark.parametrize("degrees", [-1.5, -1.0, 1.0, 1.5])
def test_boundaries_are_right_although_the_cars_pitch_is_unknown(radius: float, degrees: float) -> None:
    reference = bend(radius)
    camera = RoadCamera(two_lanes(reference))
    s = np.arange(0.0, reference.length, 0.25)
    near = 0
    for place in (70.0, 80.0):
        pose = reference.pose(place)._replace(pitch=math.radians(degrees))
        found = DETECTOR.detect(camera.frame(pose, [], CLEAR, 0.0, 0))
        assert -math.degrees(found.tilt.pitch) == pytest.approx(degrees, abs=0.35)
        for boundary, t in ((found.left, 1.75), (found.right, -1.75)):
            ground = camera.view(pose).world_to_ground(np.c_[reference.at(s, t), np.zeros(len(s))])
            ahead = (ground[:, 0] > 0.0) & (ground[:, 0] < 40.0)
            near += np.abs(boundary.y(X) - np.interp(X, ground[ahead, 0], ground[ahead, 1])).max() < 0.25
    assert near >= 3


def test_driving_finds_a_change_of_pitch_within_few_images() -> None:
    reference = bend(0.0)
    camera = RoadCamera(two_lanes(reference))
    state, seen = LaneState(), []
    for frame in range(8):
        pose = reference.pose(40.0 + frame)._replace(pitch=0.0 if frame < 4 else math.radians(1.2))
        found = DETECTOR.detect(camera.frame(pose, [], CLEAR, 0.0, frame), state)
        state = state.after(found)
        seen.append(-math.degrees(found.tilt.pitch))
    assert max(abs(one) for one in seen[:4]) < 0.15
    assert seen[-1] == pytest.approx(1.2, abs=0.3)


def test_without_paint_the_tilt_is_forgotten() -> None:
    reference = Reference([(120.0, 0.0, 0.0)])
    image = RoadCamera(make_scene(reference, [Strip(30.0, -30.0, Material.VERGE), Strip(9.0, -9.0)], [])).frame(
        reference.pose(40.0), [], CLEAR, 0.0, 0
    )
    tilt = Tilt(math.radians(1.0), math.radians(0.1))
    for _ in range(100):
        tilt = DETECTOR.detect(image, LaneState(tilt=tilt)).tilt.later()
    assert abs(math.degrees(tilt.pitch)) < 0.3
    assert tilt.deviation == pytest.approx(USUAL_PITCH, rel=0.5)


def test_an_observation_counts_the_more_the_surer_it_is() -> None:
    sure, unsure = Tilt(0.02, 0.001), Tilt(0.02, 0.1)
    assert LEVEL.with_seen(sure).pitch == pytest.approx(0.02, rel=0.01)
    assert LEVEL.with_seen(unsure).pitch < 0.002
    assert LEVEL.with_seen(Tilt(0.0, math.inf)) == LEVEL
    assert LEVEL.with_seen(sure).deviation < 0.001


def test_what_may_be_of_something_else_counts_by_how_likely_it_is_and_how_well_it_agrees() -> None:
    close, far = Tilt(0.005, 0.002), Tilt(0.06, 0.002)
    known = Tilt(0.0, 0.005)
    assert known.with_seen(close, 0.0) == known
    moved = [known.with_seen(close, real).pitch for real in (0.1, 0.5, 0.9, 1.0)]
    assert moved == sorted(moved)
    assert moved[0] > 0.0
    assert known.with_seen(far, 0.9).pitch < 0.001
    assert known.with_seen(close, 0.5).deviation > known.with_seen(close).deviation


def test_a_certain_observation_counts_however_far_it_is_from_the_estimate() -> None:
    """Its density is too small for a number; there is nothing else that it could be."""
    known, far = Tilt(0.0, 0.0005), Tilt(0.06, 0.0005)
    assert known.with_seen(far).pitch == pytest.approx(0.03)
    assert known.with_seen(far, 0.9).pitch == 0.0


def fits_of(width: float, apart: float) -> tuple[Fit, Fit]:
    """Return the fits of an image of a lane, moved to be so far apart, m, and to bend so differently, 1/m."""
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(60.0), [], CLEAR, 0.0, 0)
    sides, _, _ = DETECTOR.examine(image, None, 0.0, 0.0)
    left, right = np.array([0.5 * width, 0.0, apart]), np.array([-0.5 * width, 0.0, 0.0])
    return replace(sides[LEFT], curve=left), replace(sides[RIGHT], curve=right)


def test_two_sides_are_less_likely_one_lane_if_they_are_far_apart_or_differ() -> None:
    chances = [alike(*fits_of(3.5 + off, 0.0), 3.5, 0.25, (0.5, 1.0)) for off in (0.0, 0.4, 0.8, 1.6)]
    assert chances == sorted(chances, reverse=True)
    assert chances[0] > 0.9
    assert chances[-1] < 0.05
    bends = [alike(*fits_of(3.5, apart), 3.5, 0.25, (0.5, 1.0)) for apart in (0.0, 0.003, 0.006, 0.012)]
    assert bends == sorted(bends, reverse=True)
    assert bends[-1] < 0.05
    assert alike(*fits_of(3.5, 0.0), 3.5, 0.25, (0.0, 1.0)) == 0.0


def test_beside_one_broken_line_the_tilt_stays_near_the_estimate() -> None:
    """The edge of the road is no line, and what noise shows in the asphalt is none: neither tells how the road lies."""
    reference = Reference([(160.0, 0.0, 0.0)])
    strips = [Strip(30.0, -30.0, Material.VERGE), Strip(5.6, -2.2)]
    farthest = []
    for phase in np.arange(0.0, 12.0, 1.5):
        camera = RoadCamera(make_scene(reference, strips, [Line(1.75, 3.0, 9.0, float(phase))]))
        state, seen = LaneState(), []
        for frame in range(12):
            found = DETECTOR.detect(camera.frame(reference.pose(40.0 + frame), [], CLEAR, 20.0, frame), state)
            state = state.after(found)
            seen.append(abs(math.degrees(found.tilt.pitch)))
        farthest.append(max(seen))
    assert np.mean(farthest) < 0.85
