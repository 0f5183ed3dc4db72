"""The data that a controller receives at a control step and returns, without the packages that its own code needs."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.perception.camera import Camera
    from scenario_compiler.perception.lane_detector import LaneResult
    from scenario_compiler.vocabulary import sensors


@dataclass(frozen=True, slots=True)
class CameraMounting:
    """The mounting of the camera that takes the images, as in the plan; it is turned by yaw, then pitch, then roll.

    Attributes:
        width: Columns of the image, pixels.
        height: Rows of the image, pixels.
        fov: Horizontal field of view, rad.
        x: Distance ahead of the centre of the vehicle's box, m.
        z: Height above the ground, m.
        pitch: Upward turn of the optical axis, rad; negative looks down.
        y: Distance to the left of that centre, m.
        yaw: Turn of the optical axis to the left, rad.
        roll: Turn about the optical axis, rad; positive lowers the camera's right side.
    """

    width: int
    height: int
    fov: float
    x: float
    z: float
    pitch: float
    y: float = 0.0
    yaw: float = 0.0
    roll: float = 0.0

    @classmethod
    def of(cls, word: sensors.Camera) -> CameraMounting:
        """Return the mounting of a scenario's `<camera>`, whose angles are in degrees."""
        return cls(
            width=word.width,
            height=word.height,
            fov=math.radians(word.fov),
            x=word.x,
            y=word.y,
            z=word.z,
            yaw=math.radians(word.yaw),
            pitch=math.radians(word.pitch),
            roll=math.radians(word.roll),
        )

    def camera(self) -> Camera:
        """Return the camera with this mounting."""
        from scenario_compiler.perception.camera import Camera

        return Camera(
            width=self.width,
            height=self.height,
            fov=self.fov,
            x=self.x,
            y=self.y,
            z=self.z,
            yaw=self.yaw,
            pitch=self.pitch,
            roll=self.roll,
        )


@dataclass(frozen=True, slots=True)
class SensorData:
    """The data of the sensors at a control step.

    Attributes:
        t: Time of the image, s; it does not change until the camera takes the next image.
        image: (height, width, 3) uint8, BGR.
        camera: The camera that took it.
        lead_gap: Distance from the front bumper to the nearest thing to which the ego must keep its distance, m: a
            leader or a queue that the forward sensor sees, the line of a red signal, and from a request on also an
            object that blocks the path; None if there is no such thing.
        lead_speed: Speed of that thing along the path, m/s.
        route: The planned route ahead, as a navigation system knows it: points (x ahead, y to the left) relative to
            the rear axle, m, one metre apart, beginning beside the axle; empty if the ego is off every road.
        route_widths: Width of the lane at each of these points by the map, m.
        route_heights: Height of each of them above the plane of the road below the ego by the map, m.
        route_banks: By how much the road rises to the left there for each metre, against that plane.
        junction: Distance along the route to the next junction, m, rounded to the metre, 0 inside a junction; None if
            there is none on the known route.
        bend_speed: Greatest speed from which comfortable braking suffices for the bends of the planned route, m/s. The
            properties `lateral_acceleration` and `following_deceleration` of the controller say what is comfortable; by
            default 2.5 and 2 m/s2. Infinite if no bend limits the speed.
    """

    t: float
    image: NDArray[np.uint8]
    camera: CameraMounting
    lead_gap: float | None = None
    lead_speed: float = 0.0
    route: tuple[tuple[float, float], ...] = ()
    route_widths: tuple[float, ...] = ()
    route_heights: tuple[float, ...] = ()
    route_banks: tuple[float, ...] = ()
    junction: float | None = None
    bend_speed: float = math.inf


@dataclass(frozen=True, slots=True)
class VehicleState:
    """The ego's state and limits, from its own odometry.

    Attributes:
        x: x of the rear axle, m, OpenDRIVE axes.
        y: y of the rear axle, m.
        heading: Heading, rad.
        wheelbase: Distance between the axles, m.
        center: Distance from the rear axle ahead to the box's centre, m.
        max_steer: Greatest angle of the front wheels, rad.
        max_acceleration: Acceleration at full throttle, m/s2.
        max_deceleration: Deceleration at full brake, m/s2.
        desired_speed: Speed that the automation aims for, m/s.
        period: Time between two control steps, s.
    """

    x: float
    y: float
    heading: float
    wheelbase: float
    center: float
    max_steer: float
    max_acceleration: float
    max_deceleration: float
    desired_speed: float
    period: float


@dataclass(frozen=True, slots=True)
class Control:
    """The output of a controller.

    Attributes:
        throttle: Throttle, 0 to 1; a value beyond counts as the nearest of these.
        steer: Steering angle as a share of the greatest one, -1 to 1, positive to the left; limited likewise.
        brake: Brake, 0 to 1; limited likewise.
        trajectory: Predicted path: points (x ahead, y to the left) relative to the rear axle, m.
        confidence_left: Confidence in the left lane boundary, 0 to 1.
        confidence_right: Confidence in the right lane boundary, 0 to 1.
        sensor_health: Health of the sensor, 0 to 1.
        lanes: The lane that the controller sees, for the display and the recording; None if it sees none.
    """

    throttle: float
    steer: float
    brake: float
    trajectory: tuple[tuple[float, float], ...] = ()
    confidence_left: float = 1.0
    confidence_right: float = 1.0
    sensor_health: float = 1.0
    lanes: LaneResult | None = None
