"""The built-in world: the map's own geometry, drawn for the camera, with the engine moving everything."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence
from types import TracebackType
from typing import TYPE_CHECKING, ClassVar

from typing_extensions import Self

from scenario_compiler.controllers.model import CameraMounting, SensorData
from scenario_compiler.plan.model import Plan
from scenario_compiler.randomness import random_unit
from scenario_compiler.roads import MarkStretch, Network, Pose, SecondaryLine
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.vocabulary.markings import LineBeside, SecondaryMarkings
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.vocabulary.word import number_value
from scenario_compiler.worlds.model import EgoCommand, EgoState, Snapshot, WorldEvent, WorldOptions

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.perception.degradation import Degradation
    from scenario_compiler.perception.road_camera import RoadCamera
    from scenario_compiler.perception.solids import Box

PIECE = 2.0
"""Length of a piece of a mark that is covered or not, m."""

PAINTS = ((38, 38, 160), (150, 92, 40), (60, 60, 60), (205, 205, 205), (40, 120, 60), (30, 140, 190))
"""Colours of vehicles (blue, green, red); an entity's is chosen by its id."""


class KinematicWorld:
    """The built-in world; see `World`."""

    name: ClassVar[str] = "kinematic"
    Options: ClassVar[type[WorldOptions]] = WorldOptions
    moves_ego = False

    def __init__(self, plan: Plan, network: Network, options: WorldOptions | None = None) -> None:
        """Prepare a world for a plan on its map; the camera's scene is made when it is first needed."""
        del options
        self.plan = plan
        self.network = network
        self._seed = 1
        self._camera: RoadCamera | None = None
        self._viewer: RoadCamera | None = None
        self._lines: list[SecondaryLine] = []
        camera = plan.camera
        self._mounting = CameraMounting(
            camera.width,
            camera.height,
            math.radians(camera.fov),
            camera.x,
            camera.z,
            math.radians(camera.pitch),
            camera.y,
            math.radians(camera.yaw),
            math.radians(camera.roll),
        )

    def reset(self, snapshot: Snapshot, seed: int) -> None:
        """Begin a run: noise and rain are drawn from its seed."""
        lines = lines_beside(self.plan, self.network, snapshot.poses)
        if seed != self._seed or lines != self._lines:
            self._camera = self._viewer = None
        self._lines = lines
        if self._camera is not None:
            self._camera.forget()
        self._seed = seed

    def observe(self, snapshot: Snapshot) -> SensorData:
        """Draw what the camera sees."""
        image = self._road_camera().frame(
            snapshot.poses[0],
            self._boxes(snapshot),
            self._weather(snapshot),
            degradation_of(snapshot),
            snapshot.frame,
            dict(snapshot.signals),
        )
        return SensorData(snapshot.t, image, self._mounting)

    def picture(self, snapshot: Snapshot) -> NDArray[np.uint8]:
        """Draw what the driver sees."""
        from scenario_compiler.perception.overlay import DRIVER
        from scenario_compiler.perception.road_camera import RoadCamera

        if self._viewer is None:
            scene = self._road_camera().scene
            self._viewer = RoadCamera(scene, DRIVER, self._seed, self.plan.ego.vehicle.center)
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
        """What pictures depend on, of a run with a camera."""
        if self.plan.perception != "camera":
            return {}
        from scenario_compiler.perception.machine import drawn_by

        return drawn_by()

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Leave the motion to the engine."""
        del snapshot, command
        return None

    def events(self) -> Sequence[WorldEvent]:
        """Nothing: the engine notices what happens."""
        return ()

    def close(self) -> None:
        """Drop the camera's scene."""
        self._camera = self._viewer = None

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
        from scenario_compiler.perception.road_camera import RoadCamera, scene_of

        if self._camera is None:
            painted = self.network.with_mark_quality(mark_stretches(self.plan))
            scene = scene_of(painted, [*secondary_lines(self.plan), *self._lines])
            center = self.plan.ego.vehicle.center
            self._camera = RoadCamera(scene, self._mounting.camera(), self._seed, center)
        return self._camera

    def _boxes(self, snapshot: Snapshot) -> list[Box]:
        from scenario_compiler.perception.camera import vehicle_axes
        from scenario_compiler.perception.models import Lamp
        from scenario_compiler.perception.solids import Box

        boxes = []
        placed = zip(self.plan.entities, snapshot.entities, strict=True)
        for number, (entity, state) in enumerate(placed):
            if number == 0 or not state.shown:
                continue
            vehicle, pose = entity.vehicle, state.pose
            x, y, z = vehicle_axes(pose)[:, 0] * vehicle.center
            boxes.append(
                Box(
                    pose.x + x,
                    pose.y + y,
                    pose.z + z,
                    pose.heading,
                    vehicle.length,
                    vehicle.width,
                    vehicle.height,
                    PAINTS[zlib.crc32(entity.id.encode()) % len(PAINTS)],
                    vehicle.category,
                    pose.pitch,
                    pose.roll,
                    Lamp.AUTOMATIC | Lamp.BRAKE if state.braking else Lamp.AUTOMATIC,
                    number,
                )
            )
        return boxes


def degradation_of(snapshot: Snapshot) -> Degradation:
    """Return what is wrong with the camera in the image of a snapshot."""
    from scenario_compiler.perception.degradation import Degradation

    faults = snapshot.faults
    return Degradation(snapshot.sigma, faults.dark, faults.blur, faults.dirt, faults.missing, faults.frozen)


def mark_stretches(plan: Plan) -> list[MarkStretch]:
    """Return the plan's overrides of the paint as stretches of the network's marks, at the parameters' values."""
    values = parameter_values(plan.parameters)
    stretches: list[MarkStretch] = []
    for stretch in plan.markings:
        s_from, s_to = number_value(stretch.s_from, values), number_value(stretch.s_to, values)
        quality = end = None
        if stretch.quality is not None:
            quality = end = number_value(stretch.quality, values)
            if stretch.quality_to is not None:
                end = number_value(stretch.quality_to, values)
        if quality is not None or stretch.colour is not None:
            stretches.append(MarkStretch(stretch.road, stretch.lane, s_from, s_to, quality, end, stretch.colour))
        coverage = number_value(stretch.coverage, values)
        stretches += [
            MarkStretch(stretch.road, stretch.lane, begin, min(begin + PIECE, s_to), 0.0, 0.0)
            for begin in covered_pieces(stretch.road, s_from, s_to, coverage)
        ]
    return stretches


def secondary_lines(plan: Plan) -> list[SecondaryLine]:
    """Return the lines that the plan adds beside the network's marks, at the parameters' values."""
    values = parameter_values(plan.parameters)
    return [
        SecondaryLine(
            line.road,
            number_value(line.s_from, values),
            number_value(line.s_to, values),
            number_value(line.t, values),
            line.colour,
            line.type == "broken",
            number_value(line.width, values),
            number_value(line.quality, values),
        )
        for line in plan.secondary_markings
        if isinstance(line, SecondaryMarkings)
    ]


def lines_beside(plan: Plan, network: Network, poses: Sequence[Pose]) -> list[SecondaryLine]:
    """Return the lines that the plan paints beside entities, which start at these poses; none beside one off the roads.

    Args:
        plan: The plan.
        network: Its map.
        poses: Where each entity starts, in the plan's order.
    """
    values = parameter_values(plan.parameters)
    starts = {entity.id: pose for entity, pose in zip(plan.entities, poses, strict=True)}
    found = []
    for line in plan.secondary_markings:
        if not isinstance(line, LineBeside):
            continue
        pose = starts[line.entity]
        for place in network.locate(pose.x, pose.y, nearest=True)[:1]:
            row = network.road_index(place.road)
            centre, _ = lane_centre(network.tables, row, place.lane, place.s)
            along = network.road_pose(place.road, place.s, 0.0).heading
            facing = 1.0 if math.cos(pose.heading - along) > 0.0 else -1.0
            ends = [place.s + facing * number_value(one, values) for one in (line.s_from, line.s_to)]
            t = centre + place.offset + facing * number_value(line.across, values)
            width, quality = number_value(line.width, values), number_value(line.quality, values)
            broken = line.type == "broken"
            found.append(SecondaryLine(place.road, min(ends), max(ends), t, line.colour, broken, width, quality))
    return found


def covered_pieces(road: str, s_from: float, s_to: float, coverage: float) -> list[float]:
    """Return where the covered pieces of a stretch begin, m: the same places in every run."""
    if coverage <= 0.0:
        return []
    seed = zlib.crc32(road.encode())
    pieces = range(max(math.ceil((s_to - s_from) / PIECE), 0))
    return [s_from + PIECE * k for k in pieces if random_unit(seed, 0, 0, k) < coverage]
