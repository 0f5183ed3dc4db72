"""Maps of the server: roads, OpenDRIVE text for clients, spawn points, and the scene for cameras."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import TYPE_CHECKING
from weakref import WeakValueDictionary

from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.frames import CarlaTransform, carla_from_pose
from scenario_compiler.resources import MapNotFoundError, find_map, known_maps
from scenario_compiler.roads import LanePosition, Network, Pose, load_network
from scenario_compiler.roads.export_carla import export_for_carla
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.spawn_points import read_spawn_points

if TYPE_CHECKING:
    from scenario_compiler.carla_server.level_boxes import LevelBoxes
    from scenario_compiler.carla_server.shared_camera import SharedCamera
    from scenario_compiler.perception.camera import Camera
    from scenario_compiler.perception.scene import Scene
    from scenario_compiler.perception.terrain import Terrain

DRIVING = re.compile(rb"<lane\b[^>]*\btype\s*=\s*[\"']driving")
"""A lane for vehicles in an OpenDRIVE file."""

GENERATED = "OpenDriveMap"
"""Name of a world that is generated from a client's own OpenDRIVE file, as CARLA calls it."""

OPTIONAL = "_Opt"
"""Suffix in CARLA of a town whose layers can be switched; here it is the same town."""

APART = 11.5
"""Least distance between spawn points, m: the half diagonals of two of CARLA's longest vehicle, 10.3 m by 3.9 m."""

SPACING = 12.0
LIFTED = 0.5
"""Distance along a lane from one possible spawn point to the next, and their height over the road, m."""

AHEAD = 30.0
"""Least length of the lane ahead of a spawn point, m, if there is such a place: a Traffic Manager removes a vehicle at
the end of a lane at once.
"""

MOST_POINTS = 400
NARROWEST = 2.5
"""Greatest number of spawn points of a map, and the least width of a lane with one, m."""


@dataclass(frozen=True, eq=False)
class Town:
    """A loaded map.

    Attributes:
        name: Its name, as clients know it, without folders.
        network: Its roads.
        text: Its OpenDRIVE in the form that CARLA's clients load.
        spawn_points: Places at which vehicles can start, CARLA's axes; the longest vehicles fit on any two of them.
    """

    name: str
    network: Network
    text: str
    spawn_points: tuple[CarlaTransform, ...]
    _lock: Lock = field(default_factory=Lock, repr=False)
    _ground_lock: Lock = field(default_factory=Lock, repr=False)
    _box_lock: Lock = field(default_factory=Lock, repr=False)
    _cameras: WeakValueDictionary[tuple[Camera, int, float], SharedCamera] = field(
        default_factory=WeakValueDictionary, repr=False
    )

    @cached_property
    def _scene(self) -> Scene:
        from scenario_compiler.perception.camera import Camera
        from scenario_compiler.perception.road_camera import RoadCamera, scene_of
        from scenario_compiler.vocabulary.weather import Weather

        scene = scene_of(self.network)
        camera = RoadCamera(scene, Camera(64, 32, math.radians(90.0), windscreen=False), 1)
        camera.draw(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), [], Weather(), {}).image(1, 0)
        return scene

    @cached_property
    def _terrain(self) -> Terrain:
        from scenario_compiler.perception.terrain import Terrain
        from scenario_compiler.roads.mesh import road_surface

        return Terrain(road_surface(self.network))

    @cached_property
    def _level_boxes(self) -> LevelBoxes:
        from scenario_compiler.carla_server.level_boxes import LevelBoxes

        return LevelBoxes(self.network)

    @property
    def has_terrain(self) -> bool:
        """Whether the ground is made."""
        return "_terrain" in self.__dict__

    def terrain(self) -> Terrain:
        """Return the ground for rays; it is made at the first call."""
        with self._ground_lock:
            return self._terrain

    def level_boxes(self) -> LevelBoxes:
        """Return the boxes about the things beside the roads; they are made at the first call."""
        with self._box_lock:
            return self._level_boxes

    def scene(self) -> Scene:
        """Return the scene for cameras; it is made at the first call.

        A small picture is drawn then too: the first one of a process takes several times as long as those after it.
        """
        with self._lock:
            return self._scene

    def camera(self, camera: Camera, carrier: int, center: float) -> SharedCamera:
        """Return the camera at a mount of an actor, the same one for all who use it.

        Args:
            camera: Lens, size and mounting.
            carrier: Id of the actor that it is mounted on.
            center: How far ahead of the actor's reference point the mount's origin is, m.
        """
        from scenario_compiler.carla_server.shared_camera import SharedCamera

        scene, key = self.scene(), (camera, carrier, center)
        with self._lock:
            found = self._cameras.get(key)
            if found is None:
                found = self._cameras[key] = SharedCamera(scene, camera, center)
            return found

    def prepare(self) -> None:
        """Make the ground and the scene, the ground first: it is the quicker one, and rays wait for it alone."""
        self.terrain()
        self.scene()

    def ground_at(self, x: float, y: float) -> Pose | None:
        """Return the pose of the road's surface at a point in OpenDRIVE's axes, or at the nearest lane's."""
        for place in self.network.locate(x, y, nearest=True)[:1]:
            return self.network.lane_pose(place.road, place.lane, place.s, place.offset)
        return None


def known_towns(folders: Sequence[Path]) -> list[str]:
    """Return the names of the maps on the search path."""
    return sorted({Path(name).stem for name in known_maps(folders)})


def drivable_towns(folders: Sequence[Path]) -> list[str]:
    """Return the names of those maps that have a lane for vehicles: the others load by their name alone.

    CARLA's clients take each map of the list to have waypoints.
    """
    paths = {name: find_map(name, folders=folders) for name in known_towns(folders)}
    return [name for name, path in paths.items() if _is_drivable(path, path.stat().st_mtime_ns)]


@lru_cache(maxsize=256)
def _is_drivable(path: Path, written: int) -> bool:
    """Return whether a file, as it was written at a time, has a lane for vehicles."""
    del written
    return DRIVING.search(path.read_bytes()) is not None


def town_name(name: str) -> str:
    """Return the bare name of a map, of a path as CARLA writes it (`/Game/Carla/Maps/Town01`) too."""
    return name.replace("\\", "/").rstrip("/").rpartition("/")[2]


def load_town(name: str, folders: Sequence[Path]) -> Town:
    """Load a map by its name.

    Raises:
        CallError: There is no such map, or its file cannot be used.
    """
    bare = town_name(name)
    if bare not in known_towns(folders) and bare.removesuffix(OPTIONAL) not in known_towns(folders):
        raise CallError(f"map '{bare}' not found; there are {', '.join(known_towns(folders))}")
    try:
        path = find_map(bare, folders=folders)
    except MapNotFoundError:
        path = find_map(bare.removesuffix(OPTIONAL), folders=folders)
    return _town(bare, path)


def generate_town(text: str) -> Town:
    """Make a map of a client's own OpenDRIVE text.

    Raises:
        CallError: It cannot be used as OpenDRIVE.
    """
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"{GENERATED}.xodr"
        path.write_text(text, encoding="utf-8", errors="surrogateescape")
        return _town(GENERATED, path)


def _town(name: str, path: Path) -> Town:
    sink = Diagnostics()
    network = load_network(path, sink=sink)
    document = read_document(path, sink)
    if network is None or document is None or not network.road_ids:
        why = next((one.message for one in sink.found), "it has no road")
        raise CallError(f"map '{name}' cannot be used: {why}")
    network.model()
    text = export_for_carla(document, network).decode(document.root.getroottree().docinfo.encoding or "utf-8")
    return Town(name, network, text, tuple(_spawn_points(network, path)))


def _spawn_points(network: Network, path: Path) -> list[CarlaTransform]:
    """Return the map's named points, then points along the driving lanes outside junctions, free of each other."""
    taken: dict[tuple[int, int], list[tuple[float, float]]] = {}
    found: list[CarlaTransform] = []

    def try_at(road: str, lane: int, s: float) -> None:
        pose = _driving(network, road, lane, s)
        cell = (math.floor(pose.x / APART), math.floor(pose.y / APART))
        near = [
            point for dx in (-1, 0, 1) for dy in (-1, 0, 1) for point in taken.get((cell[0] + dx, cell[1] + dy), ())
        ]
        if len(found) < MOST_POINTS and all(math.dist(point, pose[:2]) >= APART for point in near):
            taken.setdefault(cell, []).append(pose[:2])
            found.append(carla_from_pose(pose)._replace(z=pose.z + LIFTED))

    for point in read_spawn_points(str(path), Diagnostics()).values():
        try_at(point.road, point.lane, point.s)
    for ahead in (AHEAD, 0.0):
        for road in network.road_ids:
            for lane, s in _places_on(network, road):
                if ahead == 0.0 or network.next(LanePosition(road, lane, s, 0.0), ahead) is not None:
                    try_at(road, lane, s)
        if found:
            break
    return found


def _places_on(network: Network, road: str) -> Iterator[tuple[int, float]]:
    """Yield lane and s of the places along a road's driving lanes, none for one in a junction."""
    described = network.road(road)
    if described.junction is not None:
        return
    s = min(6.0, 0.5 * described.length)
    while s < described.length:
        for one in network.lanes_at(road, s):
            if one.type == "driving" and one.t_left - one.t_right >= NARROWEST:
                yield one.lane, s
        s += SPACING


def _driving(network: Network, road: str, lane: int, s: float) -> Pose:
    """Return the pose in the middle of a lane, in its direction of travel."""
    pose = network.lane_pose(road, lane, s)
    if lane_direction(network.tables, network.road_index(road), lane, s) > 0:
        return pose
    return Pose(pose.x, pose.y, pose.z, (pose.heading + math.pi) % math.tau, -pose.pitch, -pose.roll)
