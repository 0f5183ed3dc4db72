"""The pictures of a current run as JPEG: the view ahead with the automation's detections, and the mirror."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.overlay import DRIVER, RED, Image, draw_on_ground, draw_seen, encode_jpeg
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.stage import Stage
from scenario_compiler.plan.painted import lines_beside
from scenario_compiler.runtime.loop import Execution
from scenario_compiler.runtime.pictures import camera_path
from scenario_compiler.worlds.model import Snapshot

AHEAD = replace(DRIVER, width=1280, height=720, fov=math.radians(75.0))
"""The driver's view."""

MIRROR = Camera(width=360, height=100, fov=math.radians(50.0), x=-0.4, z=1.25, yaw=math.pi, pitch=0.0, windscreen=False)
"""The view of the inside mirror, before it is mirrored."""


HALF_LANE = 1.7
"""Half the width of the bar where the path is blocked, m."""


class Sight:
    """Draws the person's view of a run; every picture shows a state that is recorded."""

    def __init__(
        self, execution: Execution, size: tuple[int, int] = (AHEAD.width, AHEAD.height), *, plain: bool = False
    ) -> None:
        """Prepare the scene of a run.

        Args:
            execution: The run.
            size: Width and height of the view ahead, pixels.
            plain: Whether to leave out the automation's detections and plans.
        """
        self._plain = plain
        self._execution = execution
        plan, network = execution.plan, execution.world.network
        start = execution.snapshot()
        self._stage = Stage(plan, network, lines_beside(plan, network, start.poses))
        self.ahead = replace(AHEAD, width=size[0], height=size[1])
        center = plan.entities[0].vehicle.center
        self._cameras = {camera: RoadCamera(self._stage.scene, camera, 1, center) for camera in (self.ahead, MIRROR)}
        self._built_in = execution.world.name == "kinematic"

    def view(self, snapshot: Snapshot, *, marked: bool = False) -> bytes:
        """Return the view ahead: the world's, with the detected lane and the followed path.

        Args:
            snapshot: The state to show.
            marked: Whether to mark on the road where the path is blocked (the message modality `overlay`).
        """
        image = self._draw(snapshot, self.ahead) if self._built_in else self._execution.world.picture(snapshot)
        camera = self.ahead if self._built_in else DRIVER
        if not self._plain:
            self._draw_plans(image, camera)
        if marked:
            self._mark_block(image, camera)
        return encode_jpeg(image)

    def _draw_plans(self, image: Image, camera: Camera) -> None:
        """Draw the detected lane and the followed path; without a detector, the planned route."""
        control, seen = self._execution.control, self._execution.seen
        center = self._execution.plan.entities[0].vehicle.center
        if control is not None and seen is not None:
            sensor = seen.camera
            path = camera_path(control, sensor, center)
            draw_seen(image, camera, control.lanes, path, (sensor.x - camera.x, sensor.y - camera.y))
        elif self._execution.program.ego[0] >= 0:
            way = self._execution.simulation.look_out().way
            draw_seen(image, camera, None, [(x - center - camera.x, y) for x, y in way] or None)

    def _mark_block(self, image: Image, camera: Camera) -> None:
        """Draw a bar on the road where the path is blocked, as far as the planned route is known."""
        execution = self._execution
        vehicle = execution.plan.entities[0].vehicle
        ahead = execution.state.blocked_distance[0] + vehicle.center + 0.5 * vehicle.length
        place = next(((x, y) for x, y in execution.simulation.look_out().way if x >= ahead), None)
        if place is not None:
            x, y = place[0] - vehicle.center - camera.x, place[1]
            draw_on_ground(image, camera, [(x, y + HALF_LANE), (x, y - HALF_LANE)], RED)

    def mirror(self, snapshot: Snapshot) -> bytes:
        """Return the view of the inside mirror."""
        return encode_jpeg(np.ascontiguousarray(self._draw(snapshot, MIRROR)[:, ::-1]))

    def _draw(self, snapshot: Snapshot, camera: Camera) -> Image:
        others = enumerate(snapshot.entities)
        boxes = self._stage.boxes((k, one.pose, one.braking) for k, one in others if k > 0 and one.shown)
        weather = self._execution.plan.weather if snapshot.weather is None else snapshot.weather
        viewer = self._cameras[camera]
        return viewer.frame(snapshot.poses[0], boxes, weather, 0.0, snapshot.frame, dict(snapshot.signals))
