"""A car that steers by what it sees stays in its lane: pure pursuit on the middle of the detected boundaries."""

import math

import pytest

from scenario_compiler.perception.calibration.scenes import Reference
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector, LaneResult, LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.roads.positions import Pose
from tests.perception.scenery import CLEAR, two_lanes

WHEELBASE, BOX_OFFSET = 2.65, 1.4
SENSOR_PERIOD, SUBSTEPS = 1.0 / 15.0, 2


def steer(lane: LaneResult, speed: float) -> float:
    """Pure pursuit with a look-ahead of 0.4 s, 3 to 20 m from the rear axle (Coulter 1992)."""
    reach = min(max(0.4 * speed, 6.0), 20.0)
    ahead = max(reach - BOX_OFFSET - 0.5, 4.0)
    y = float(lane.left.y(ahead) + lane.right.y(ahead)) / 2.0
    x = ahead + BOX_OFFSET + 0.5
    return math.atan(2.0 * WHEELBASE * y / (x * x + y * y))


@pytest.mark.parametrize(("speed", "seconds"), [pytest.param(5.0, 11.0, marks=pytest.mark.slow), (14.0, 10.0)])
def test_a_car_that_follows_the_detected_lane_stays_in_it(speed: float, seconds: float) -> None:
    curvature = 1.0 / 120.0
    reference = Reference([(15, 0, 0), (20, 0, curvature), (50, curvature, curvature), (30, curvature, -curvature),
                           (60, -curvature, -curvature)])  # fmt: skip
    camera, detector = RoadCamera(two_lanes(reference)), ClassicalLaneDetector()
    x, y, heading = reference.pose(2.0)[0], reference.pose(2.0, 0.2)[1], reference.pose(2.0).heading
    state, worst, s = LaneState(), 0.0, 0.0
    for frame in range(round(seconds / SENSOR_PERIOD)):
        image = camera.frame(Pose(x, y, 0.0, heading, 0.0, 0.0), [], CLEAR, 0.0, frame)
        lane = detector.detect(image, state)
        state = state.after(lane)
        angle = steer(lane, speed)
        for _ in range(SUBSTEPS):
            dt = SENSOR_PERIOD / SUBSTEPS
            heading += speed / WHEELBASE * math.tan(angle) * dt
            x, y = x + speed * math.cos(heading) * dt, y + speed * math.sin(heading) * dt
        s, t = reference.offset(x, y)
        worst = max(worst, abs(t))
        if s > reference.length - 35.0:
            break
    assert s > 0.9 * min(speed * seconds, reference.length - 40.0)
    assert worst < 0.4
