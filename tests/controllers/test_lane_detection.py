"""The lane-keeping automation looks for the lane along the planned route, and never follows a route without a lane."""

from __future__ import annotations

import math

import numpy as np
import pytest

from scenario_compiler.controllers import CameraMounting, Control, SensorData, VehicleState, create_controller
from scenario_compiler.perception.calibration.scenes import Reference
from scenario_compiler.perception.detectors import DETECTORS
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.roads import Pose
from scenario_compiler.vocabulary.entities import Controller, Detector
from tests.perception.scenery import CLEAR, bend, fork, two_lanes

CAMERA = CameraMounting(512, 256, math.radians(45.0), 0.5, 1.3, math.radians(-5.0))
AHEAD = tuple((float(k), 0.0) for k in range(41))
TURN = tuple((float(k), max(k - 10.0, 0.0) ** 2 / 8.0) for k in range(30))
"""Ways straight on and, from 10 m ahead of the rear axle, to the left."""

GENTLE = tuple((float(k), k * k / 300.0) for k in range(30))
"""A way with a radius of 150 m."""


def driven(paint: float, route: tuple[tuple[float, float], ...], junction: float | None) -> list[Control]:
    """Return the commands in the first images of a straight road, on which the car drives along its lane."""
    reference = bend(0.0)
    camera = RoadCamera(two_lanes(reference, quality=paint))
    controller = create_controller(Controller(model="lane_detection"))
    controller.reset(1)
    found = []
    for k in range(5):
        pose = reference.pose(20.0 + 0.5 * k, 0.2)
        image = camera.frame(pose, [], CLEAR, 0.0, k)
        vehicle = VehicleState(pose.x, pose.y, pose.heading, 2.65, 1.4, 0.7, 3.5, 8.0, 5.0, 0.1)
        data = SensorData(0.1 * k, image, CAMERA, route=route, junction=junction)
        found.append(controller.control(data, 5.0, vehicle))
    return found


def commands(found: list[Control]) -> list[tuple[float, float, float]]:
    return [(one.steer, one.confidence_left, one.confidence_right) for one in found]


@pytest.mark.parametrize("junction", [None, 30.0])
def test_a_lane_along_the_route_is_trusted_as_much_as_without_a_route(junction: float | None) -> None:
    here, there = driven(1.0, AHEAD, junction)[-1], driven(1.0, (), None)[-1]
    assert here.confidence_left == pytest.approx(there.confidence_left, abs=0.1)
    assert here.confidence_right == pytest.approx(there.confidence_right, abs=0.1)
    assert here.steer == pytest.approx(there.steer, abs=0.02)


def test_a_junction_close_ahead_makes_paint_a_little_less_certain_because_lines_end_there() -> None:
    close, far = driven(1.0, AHEAD, 5.0)[-1], driven(1.0, AHEAD, None)[-1]
    assert 0.6 < close.confidence_left < far.confidence_left
    assert close.steer == pytest.approx(far.steer, abs=0.02)


def test_a_lane_is_followed_although_the_route_is_a_little_different() -> None:
    here, there = driven(1.0, GENTLE, None)[-1], driven(1.0, (), None)[-1]
    assert here.steer == pytest.approx(there.steer, abs=0.02)


def test_a_painted_lane_that_leaves_the_route_is_not_followed() -> None:
    last = driven(1.0, TURN, 10.0)[-1]
    assert max(last.confidence_left, last.confidence_right) < 0.3


@pytest.mark.parametrize("route", [AHEAD, TURN])
def test_without_paint_the_route_adds_neither_confidence_nor_steering(route: tuple[tuple[float, float], ...]) -> None:
    for one in driven(0.0, route, 5.0):
        assert max(one.confidence_left, one.confidence_right) < 0.3
        assert one.steer == 0.0


@pytest.mark.parametrize(
    ("bend_speed", "speed", "brakes"),
    [(math.inf, 14.0, False), (7.1, 8.0, True), (7.1, 6.5, False), (20.0, 14.0, False)],
)
def test_the_car_is_no_faster_than_the_bends_of_the_route_allow(bend_speed: float, speed: float, brakes: bool) -> None:
    controller = create_controller(Controller(model="lane_detection"))
    controller.reset(1)
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(20.0), [], CLEAR, 0.0, 0)
    vehicle = VehicleState(0.0, 0.0, 0.0, 2.65, 1.4, 0.7, 3.5, 8.0, 14.0, 0.1)
    command = controller.control(SensorData(0.0, image, CAMERA, bend_speed=bend_speed), speed, vehicle)
    assert (command.brake > 0.0) == brakes


STRAIGHT = Reference([(150.0, 0.0, 0.0)])
TURNING = Reference([(30.0, 0.0, 0.0), (90.0, 1.0 / 80.0, 1.0 / 80.0)])
SPEED, PERIOD = 8.0, 0.1


def followed(painted: tuple[Reference, ...], meant: Reference) -> tuple[float, float]:
    """Drive over a junction that begins at 30 m, where roads part; return the farthest offset and the least confidence.

    The offset is that from the road that is meant, m; the confidence that of the better side.
    """
    camera = RoadCamera(fork(*painted))
    controller = create_controller(Controller(model="lane_detection"))
    controller.reset(1)
    x, y, heading, farthest, least = 8.0, 0.0, 0.0, 0.0, 1.0
    for k in range(60):
        s, t = meant.offset(x, y)
        ahead = meant.at(np.arange(s, s + 40.0)) - (x, y)
        c, w = math.cos(heading), math.sin(heading)
        route = tuple((float(c * dx + w * dy), float(c * dy - w * dx)) for dx, dy in ahead)
        image = camera.frame(Pose(x, y, 0.0, heading, 0.0, 0.0), [], CLEAR, 0.0, k)
        data = SensorData(PERIOD * k, image, CAMERA, route=route, junction=max(30.0 - s, 0.0))
        vehicle = VehicleState(x, y, heading, 2.65, 1.4, 0.7, 3.5, 8.0, SPEED, PERIOD)
        command = controller.control(data, SPEED, vehicle)
        farthest = max(farthest, abs(t))
        least = min(least, max(command.confidence_left, command.confidence_right))
        heading += SPEED / 2.65 * math.tan(0.7 * command.steer) * PERIOD
        x, y = x + SPEED * math.cos(heading) * PERIOD, y + SPEED * math.sin(heading) * PERIOD
    return farthest, least


def test_the_detector_is_chosen_by_name() -> None:
    image = RoadCamera(two_lanes(bend(0.0))).frame(bend(0.0).pose(20.0, 0.2), [], CLEAR, 0.0, 0)
    vehicle = VehicleState(0.0, 0.0, 0.0, 2.65, 1.4, 0.7, 3.5, 8.0, 14.0, 0.1)
    found = []
    for name in DETECTORS:
        controller = create_controller(Controller(detector=Detector(model=name)))
        controller.reset(1)
        command = controller.control(SensorData(0.0, image, CAMERA), 10.0, vehicle)
        assert min(command.confidence_left, command.confidence_right) > 0.8
        assert command.steer < 0.0
        found.append(command.confidence_left)
    assert len(set(found)) == len(DETECTORS)


@pytest.mark.parametrize(
    "meant", [pytest.param(STRAIGHT, id="straight", marks=pytest.mark.slow), pytest.param(TURNING, id="turning")]
)
def test_where_painted_lanes_diverge_the_car_follows_the_planned_one(meant: Reference) -> None:
    farthest, least = followed((STRAIGHT, TURNING), meant)
    assert farthest < 0.5
    assert least > 0.6


@pytest.mark.parametrize(
    ("painted", "meant"),
    [
        pytest.param(STRAIGHT, TURNING, id="straight painted"),
        pytest.param(TURNING, STRAIGHT, id="turn painted", marks=pytest.mark.slow),
    ],
)
def test_where_the_planned_lane_has_no_paint_the_confidence_falls(painted: Reference, meant: Reference) -> None:
    assert followed((painted,), meant)[1] < 0.3
