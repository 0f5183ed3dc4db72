"""The built-in world: the renderer draws the map for the camera, and the engine moves everything."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from functools import cached_property
from types import TracebackType
from typing import TYPE_CHECKING, ClassVar

from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.painted import lines_beside
from scenario_compiler.roads import Network, SecondaryLine
from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.worlds.model import EgoCommand, EgoState, Snapshot, WorldEvent, WorldOptions

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from scenario_compiler.controllers.data import CameraMounting, SensorData
    from scenario_compiler.perception.degradation import Degradation
    from scenario_compiler.perception.road_camera import RoadCamera
    from scenario_compiler.perception.solids import Box
    from scenario_compiler.perception.stage import Stage


class KinematicWorld:
    """The built-in world; see `World`."""

    name: ClassVar[str] = "kinematic"
    Options: ClassVar[type[WorldOptions]] = WorldOptions
    moves_ego = False
    findings = ()

    def __init__(self, plan: Plan, network: Network, options: WorldOptions | None = None) -> None:
        """Prepare a world for a plan on its map; the camera's scene is made when it is first needed."""
        del options
        self.plan = plan
        self.network = network
        self._seed = 1
        self._camera: RoadCamera | None = None
        self._viewer: RoadCamera | None = None
        self._drawn: Stage | None = None
        self._lines: list[SecondaryLine] = []

    @cached_property
    def mounting(self) -> CameraMounting:
        """The mounting of the camera."""
        from scenario_compiler.controllers.data import CameraMounting

        return CameraMounting.of(self.plan.camera)

    def reset(self, snapshot: Snapshot, seed: int) -> None:
        """Begin a run; its seed determines noise and rain."""
        lines = lines_beside(self.plan, self.network, snapshot.poses)
        if seed != self._seed or lines != self._lines:
            self._camera = self._viewer = self._drawn = None
        self._lines = lines
        if self._camera is not None:
            self._camera.forget()
        self._seed = seed

    def observe(self, snapshot: Snapshot) -> SensorData:
        """Draw the camera's image."""
        from scenario_compiler.controllers.data import SensorData

        image = self._road_camera().frame(
            snapshot.poses[0],
            self._boxes(snapshot),
            self._weather(snapshot),
            degradation_of(snapshot, self.plan.ego.vehicle.wheelbase),
            snapshot.frame,
            dict(snapshot.signals),
            snapshot.t,
        )
        return SensorData(snapshot.t, image, self.mounting)

    def picture(self, snapshot: Snapshot) -> NDArray[np.uint8]:
        """Draw the driver's view."""
        from scenario_compiler.perception.overlay import DRIVER
        from scenario_compiler.perception.road_camera import RoadCamera

        if self._viewer is None:
            self._viewer = RoadCamera(self._stage().scene, DRIVER, self._seed, self.plan.ego.vehicle.center)
        return self._viewer.frame(
            snapshot.poses[0],
            self._boxes(snapshot),
            self._weather(snapshot),
            0.0,
            snapshot.frame,
            dict(snapshot.signals),
        )

    @property
    def versions(self) -> dict[str, str]:
        """Versions on which the images of a run with a camera depend."""
        if self.plan.perception != "camera":
            return {}
        from scenario_compiler.perception.machine import drawn_by

        return drawn_by()

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Do nothing: the engine moves all entities."""
        del snapshot, command
        return None

    def events(self) -> Sequence[WorldEvent]:
        """Return nothing: the engine itself records all events."""
        return ()

    def close(self) -> None:
        """Drop the camera's scene."""
        self._camera = self._viewer = self._drawn = None

    def __enter__(self) -> Self:
        """Return the world."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Drop the camera's scene."""
        self.close()

    def _weather(self, snapshot: Snapshot) -> Weather:
        return self.plan.weather if snapshot.weather is None else snapshot.weather

    def _road_camera(self) -> RoadCamera:
        from scenario_compiler.perception.road_camera import RoadCamera

        if self._camera is None:
            center = self.plan.ego.vehicle.center
            self._camera = RoadCamera(self._stage().scene, self.mounting.camera(), self._seed, center)
        return self._camera

    def _stage(self) -> Stage:
        from scenario_compiler.perception.stage import Stage

        if self._drawn is None:
            self._drawn = Stage(self.plan, self.network, self._lines)
        return self._drawn

    def _boxes(self, snapshot: Snapshot) -> list[Box]:
        others = enumerate(snapshot.entities)
        return self._stage().boxes((k, state.pose, state.braking) for k, state in others if k > 0 and state.shown)


def degradation_of(snapshot: Snapshot, wheelbase: float) -> Degradation:
    """Return the camera's degradation in the image of a snapshot, for an ego with a wheelbase, m.

    The yaw rate is that of the kinematic bicycle model which moves the ego: v tan(steering angle) / wheelbase.
    """
    from scenario_compiler.perception.degradation import Degradation

    ego = snapshot.entities[0]
    yaw_rate = ego.speed * math.tan(ego.steering) / wheelbase
    return Degradation(sigma=snapshot.sigma, speed=ego.speed, yaw_rate=yaw_rate, **asdict(snapshot.faults))
