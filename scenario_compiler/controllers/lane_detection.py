"""The lane-keeping automation that drives by what its camera sees.

Pure pursuit of the middle between the detected boundaries and a proportional speed controller, with the AISA toolkit's
numbers (look-ahead 0.4 s within 3 to 20 m, speed gain 2). When the detector loses the lane, the last trusted path is
kept in the odometry's frame and followed to its end, and beyond its end at the curvature that the lane had. The
detector searches along the planned route, and a boundary that leaves it does not belong to the lane to follow: the
sooner it leaves, the less it counts. Anything that the forward sensor sees ahead in the path is followed at a time gap.
Bends are driven at the speed that the planned route allows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, ClassVar, NamedTuple

from pydantic import Field

from scenario_compiler.controllers.data import Control, SensorData, VehicleState
from scenario_compiler.controllers.model import ControllerModel, ControllerParams
from scenario_compiler.perception.planned_way import on_way
from scenario_compiler.perception.route_ahead import WayPoint, without_folds
from scenario_compiler.vocabulary.lane_keeping import LANE_KEEPING, TRUSTED

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.perception.course import Course
    from scenario_compiler.perception.lane_detector import Boundary, LaneDetector, LaneResult, LaneState

Point = tuple[float, float]

PATH_LENGTH = 25
"""Length of the path ahead of the camera that is kept, m: the detector's range."""

NEAREST = 5.0
"""Distance ahead of the camera from which the detector sees the ground, m."""

NEW_SHARE, UNSEEN_SHARE = 0.4, 0.1
"""Share by which a trusted image moves the remembered path, where the ground is visible and where it is extrapolated.
"""

BEND_SHARE = 0.1
"""Share by which each trusted image moves the remembered curvature of the lane."""

END_POINTS = 6
"""Number of points at the path's end from which its direction is taken; the end of a single image is too noisy."""

USUAL_WIDTH = 3.5
"""Assumed width of a lane of which only one side has been seen, m."""


class LaneDetectionParams(ControllerParams):
    """Parameters of the lane-keeping automation."""

    look_ahead_time: float = Field(
        default=LANE_KEEPING["look_ahead_time"], gt=0, le=5, description="Look-ahead of the pure pursuit, s."
    )
    look_ahead_min: float = Field(
        default=LANE_KEEPING["look_ahead_min"], gt=0, le=50, description="Least look-ahead, m."
    )
    look_ahead_max: float = Field(
        default=LANE_KEEPING["look_ahead_max"], gt=0, le=100, description="Greatest look-ahead, m."
    )
    speed_gain: float = Field(
        default=LANE_KEEPING["speed_gain"], gt=0, le=20, description="Throttle per m/s of missing speed."
    )
    time_gap: float = Field(
        default=LANE_KEEPING["time_gap"], gt=0, le=10, description="Time gap to the vehicle ahead, s."
    )
    minimum_gap: float = Field(default=LANE_KEEPING["minimum_gap"], gt=0, le=20, description="Gap at standstill, m.")
    lateral_acceleration: float = Field(
        default=LANE_KEEPING["lateral_acceleration"], gt=0, le=10, description="Lateral acceleration in bends, m/s2."
    )
    following_acceleration: float = Field(
        default=LANE_KEEPING["following_acceleration"],
        gt=0,
        le=10,
        description="Greatest acceleration in following, m/s2.",
    )
    following_deceleration: float = Field(
        default=LANE_KEEPING["following_deceleration"], gt=0, le=10, description="Comfortable deceleration, m/s2."
    )


class LaneDetectionController(ControllerModel):
    """Drives in the lane that the detector finds."""

    Params: ClassVar[type[ControllerParams]] = LaneDetectionParams
    params: LaneDetectionParams
    uses_detector: ClassVar[bool] = True

    def reset(self, seed: int) -> None:
        """Forget the lane and the path."""
        del seed
        self._detector: LaneDetector | None = None
        self._prior: LaneState | None = None
        self._place: Point | None = None
        self._path: list[Point] = []
        self._bend = 0.0
        self._lanes: LaneResult | None = None
        self._seen_at = 0.0

    def control(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> Control:
        """Detect the lane, follow its middle and hold the desired speed."""
        if self._lanes is None or sensor_data.t > self._seen_at:
            self._look(sensor_data, vehicle)
        assert self._lanes is not None
        lanes, path = self._lanes, _to_vehicle(self._path, vehicle)
        reach = min(max(self.params.look_ahead_time * speed, self.params.look_ahead_min), self.params.look_ahead_max)
        x, y = _target(path, reach, self._bend)
        curvature = 2.0 * y / (x * x + y * y)
        if max(lanes.left.p, lanes.right.p) >= 2 * TRUSTED:
            self._bend += BEND_SHARE * (curvature - self._bend)
        angle = math.atan(vehicle.wheelbase * curvature)
        throttle, brake = self._pedals(sensor_data, speed, vehicle)
        return Control(
            throttle=throttle,
            steer=min(max(angle / vehicle.max_steer, -1.0), 1.0),
            brake=brake,
            trajectory=tuple(point for point in path if point[0] > 0.0),
            confidence_left=lanes.p_left,
            confidence_right=lanes.p_right,
            sensor_health=lanes.sensor_health,
            lanes=lanes,
        )

    def _look(self, sensor_data: SensorData, vehicle: VehicleState) -> None:
        """Detect the lane in a new image and move the remembered path towards it."""
        self._seen_at = sensor_data.t
        ahead = vehicle.center + sensor_data.camera.x
        left = sensor_data.camera.y
        lanes = self._detect(sensor_data, ahead, self._travelled(vehicle))
        middle = self._middle(lanes)
        if middle:
            seen = [spot.moved(ahead, left) for spot in middle]
            trust = max(lanes.left.p, lanes.right.p)
            path = _blend(_to_vehicle(self._path, vehicle), seen, trust, self._bend)
            self._path = _to_world(path, vehicle)

    def _pedals(self, sensor_data: SensorData, speed: float, vehicle: VehicleState) -> tuple[float, float]:
        """Return throttle and brake that hold the desired speed, or the gap to what is ahead."""
        desired = min(vehicle.desired_speed, sensor_data.bend_speed)
        missing = self.params.speed_gain * (desired - speed)
        throttle, brake = min(max(missing, 0.0), 1.0), min(max(-missing / 4.0, 0.0), 1.0)
        if sensor_data.lead_gap is None:
            return throttle, brake
        followed = self._following(speed, sensor_data.lead_speed, sensor_data.lead_gap, desired)
        if followed >= 0.0:
            return min(throttle, followed / vehicle.max_acceleration), brake
        return 0.0, max(brake, min(-followed / vehicle.max_deceleration, 1.0))

    def _following(self, speed: float, lead: float, gap: float, desired: float) -> float:
        """Return the acceleration of the intelligent driver model (Treiber, Hennecke and Helbing 2000), m/s2."""
        a, b = self.params.following_acceleration, self.params.following_deceleration
        closing = speed * (speed - lead) / (2.0 * math.sqrt(a * b))
        wanted = self.params.minimum_gap + max(0.0, speed * self.params.time_gap + closing)
        free = (speed / max(desired, 0.1)) ** 4
        return a * (1.0 - min(free, 2.0) - (wanted / max(gap, 0.1)) ** 2)

    def display_info(self) -> dict[str, str]:
        """Return both sides' confidences and the sensor's health."""
        if self._lanes is None:
            return {}
        return {
            "left lane": f"{self._lanes.p_left:.2f}",
            "right lane": f"{self._lanes.p_right:.2f}",
            "sensor": f"{self._lanes.sensor_health:.2f}",
        }

    def warning_messages(self) -> list[str]:
        """Return which boundary is weak."""
        if self._lanes is None:
            return []
        sides = (("Left", self._lanes.p_left), ("Right", self._lanes.p_right))
        return [f"{side} lane marking is hard to see" for side, p in sides if TRUSTED <= p < 2 * TRUSTED]

    def critical_messages(self) -> list[str]:
        """Return why the driver must take over."""
        if self._lanes is None:
            return []
        if self._lanes.sensor_health < TRUSTED:
            return ["Camera fails: take over"]
        return ["Lane markings lost: take over"] if max(self._lanes.p_left, self._lanes.p_right) < TRUSTED else []

    def overlay_image(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Return the image with the boundaries that are trusted, in green."""
        if self._lanes is None:
            return image
        from scenario_compiler.perception.overlay import draw_lanes

        return draw_lanes(image, self._lanes, self._camera)

    def _travelled(self, vehicle: VehicleState) -> float:
        """Return the distance since the last image, m."""
        before, self._place = self._place, (vehicle.x, vehicle.y)
        return 0.0 if before is None else math.dist(before, self._place)

    def _detect(self, sensor_data: SensorData, ahead: float, travelled: float) -> LaneResult:
        from scenario_compiler.perception.course import Course
        from scenario_compiler.perception.lane_detector import LaneState
        from scenario_compiler.perception.sensor_health import SensorMonitor

        if self._detector is None:
            self._camera = sensor_data.camera.camera()
            self._detector = self.make_detector(self._camera)
            self._monitor = SensorMonitor()
            self._prior = LaneState()
        assert self._prior is not None
        way = _way_of(sensor_data, ahead)
        junction = math.inf if sensor_data.junction is None else max(sensor_data.junction - ahead, 0.0)
        self._prior = replace(self._prior, way=Course.along(way, junction))
        lanes = self._detector.detect(sensor_data.image, self._prior)
        self._prior = self._prior.after(lanes)
        health = self._monitor.observe(sensor_data.image, travelled).health
        left, right = (on_way(boundary, way) for boundary in (lanes.left, lanes.right))
        self._lanes = replace(
            lanes,
            left=left,
            right=right,
            sensor_health=health,
            p_left=left.p * health,
            p_right=right.p * health,
        )
        return self._lanes

    def _middle(self, lanes: LaneResult) -> list[_Spot]:
        """Return the lane's middle from the trusted sides, in the camera's ground frame; nothing without any."""
        expected = None if self._prior is None else self._prior.expected_width
        width = USUAL_WIDTH if expected is None else expected
        left, right = lanes.left, lanes.right
        if left.course is not right.course:
            left, right = left.as_parabola(), right.as_parabola()
        trusted = [side.p if side.p >= TRUSTED else 0.0 for side in (left, right)]
        if sum(trusted) == 0.0:
            return []
        share = trusted[0] / sum(trusted)
        ahead = list(range(-2, PATH_LENGTH + 1))
        across = [
            share * (of_left - _half(width, left, x)) + (1.0 - share) * (of_right + _half(width, right, x))
            for x, of_left, of_right in zip(
                ahead, left.across(ahead).tolist(), right.across(ahead).tolist(), strict=True
            )
        ]
        if left.course is None:
            return [_Spot(x, y, 0.0, x >= NEAREST) for x, y in zip(ahead, across, strict=True)]
        return _along_course(left.course, ahead, across)


def _way_of(sensor_data: SensorData, ahead: float) -> Sequence[WayPoint]:
    """Return the planned route in the camera's ground frame."""
    points = [(x - ahead, y - sensor_data.camera.y) for x, y in sensor_data.route]
    if not sensor_data.route_widths:
        return without_folds(WayPoint(x, y) for x, y in points)
    of_map = zip(sensor_data.route_widths, sensor_data.route_heights, sensor_data.route_banks, strict=True)
    return without_folds(WayPoint(x, y, *more) for (x, y), more in zip(points, of_map, strict=True))


class _Spot(NamedTuple):
    """A point of the middle of a lane: x, y and the direction of the line along which the lane is measured, m and rad.

    Nearer than `NEAREST` the camera does not see the ground, and the boundaries are extrapolated.
    """

    x: float
    y: float
    heading: float
    visible: bool

    def moved(self, dx: float, dy: float) -> _Spot:
        """Return it seen from a place that is behind by dx and to the right by dy, m."""
        return self._replace(x=self.x + dx, y=self.y + dy)


def _half(width: float, boundary: Boundary, x: float) -> float:
    """Return half a lane's width, measured across the line along which the boundary is, m."""
    return width / 2.0 * math.hypot(1.0, boundary.slope_at(x))


def _along_course(course: Course, ahead: Sequence[float], across: Sequence[float]) -> list[_Spot]:
    """Return the points at some distances ahead along a course and to the left of it, but those that are undefined."""
    import numpy as np

    s = np.array(ahead, np.float64)
    x, y = course.points(s, np.array(across))
    rows = zip(x.tolist(), y.tolist(), course.heading_at(s).tolist(), ahead, strict=True)
    return [_Spot(x, y, heading, s >= NEAREST) for x, y, heading, s in rows if math.isfinite(x)]


def _to_world(path: list[Point], vehicle: VehicleState) -> list[Point]:
    c, s = math.cos(vehicle.heading), math.sin(vehicle.heading)
    return [(vehicle.x + c * x - s * y, vehicle.y + s * x + c * y) for x, y in path]


def _to_vehicle(path: list[Point], vehicle: VehicleState) -> list[Point]:
    c, s = math.cos(vehicle.heading), math.sin(vehicle.heading)
    moved = [(x - vehicle.x, y - vehicle.y) for x, y in path]
    return [(c * x + s * y, -s * x + c * y) for x, y in moved]


def _blend(old: list[Point], seen: list[_Spot], trust: float, bend: float) -> list[Point]:
    """Return the remembered path, moved towards the seen one by its trust; the seen one if nothing is remembered.

    Where the lane is extrapolated, the remembered path has more weight. Beyond its end the remembered path continues in
    its direction with the curvature `bend`, 1/m.
    """
    blended = []
    for spot in seen:
        c, s = math.cos(spot.heading), math.sin(spot.heading)
        from_here = [(x - spot.x, y - spot.y) for x, y in old]
        before = _y_at([(c * x + s * y, c * y - s * x) for x, y in from_here], 0.0, bend)
        kept = 0.0 if before is None else before * (1.0 - trust * (NEW_SHARE if spot.visible else UNSEEN_SHARE))
        blended.append((spot.x - s * kept, spot.y + c * kept))
    return blended


def _y_at(path: list[Point], x: float, bend: float) -> float | None:
    for (x0, y0), (x1, y1) in pairwise(path):
        if x0 <= x <= x1 and x1 > x0:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    if len(path) < END_POINTS or x < path[-1][0]:
        return None
    (x0, y0), (x1, y1) = path[-END_POINTS], path[-1]
    beyond = x - x1
    return y1 + beyond * (y1 - y0) / (x1 - x0) + 0.5 * bend * beyond * beyond if x1 > x0 else None


def _target(path: list[Point], reach: float, bend: float) -> Point:
    """Return the point of a path at a distance from the rear axle; after its end it has a curvature `bend`, 1/m."""
    for (x0, y0), (x1, y1) in pairwise(path):
        if x1 > 0.0 and math.hypot(x1, y1) >= reach:
            near = math.hypot(x0, y0)
            share = 1.0 if near >= reach else (reach - near) / (math.hypot(x1, y1) - near)
            return x0 + share * (x1 - x0), y0 + share * (y1 - y0)
    if len(path) < END_POINTS or path[-1][0] <= 0.0:
        return reach, 0.5 * bend * reach * reach
    (x0, y0), (x1, y1) = path[-END_POINTS], path[-1]
    rest = reach - math.hypot(x1, y1)
    heading = math.atan2(y1 - y0, x1 - x0) + 0.5 * bend * rest
    return x1 + rest * math.cos(heading), y1 + rest * math.sin(heading)
