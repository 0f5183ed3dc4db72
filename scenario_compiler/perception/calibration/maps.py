"""Pictures along a map's own lanes, with the truth about the lane in each.

A clip is a few images from a car that drives along a lane, with random traffic, weather, wear, noise and pitch. It
depends only on the map, the seed and its number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.lines import JunctionLines, LinePlace, Lines
from scenario_compiler.perception.calibration.truth import SEEN, Truth
from scenario_compiler.perception.camera import Camera, vehicle_axes
from scenario_compiler.perception.camera import View as CameraView
from scenario_compiler.perception.course import NARROWEST
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.roadside import roadside_of
from scenario_compiler.perception.route_ahead import LOOKED_AT, WayPoint, without_folds
from scenario_compiler.perception.scene import Scene, joined_marks
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.textures import GROUND_SEED
from scenario_compiler.perception.weather_look import look_of
from scenario_compiler.roads import LanePosition, Network, Pose
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_borders, lane_direction
from scenario_compiler.roads.mesh import road_marks, road_surface
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_preset

Floats = NDArray[np.float64]

IMAGES = 6
"""Number of images of a clip; the first is seen without memory."""

PERIOD = 1.0 / 15.0
"""Time between two images, s."""

LATERAL = 2.5
"""Lateral acceleration in bends, m/s2."""

REACH = 40
"""Length of the known path ahead of the car, m."""

BEHIND = 6
"""Length of the known path behind it, m."""

LORRIES_AHEAD = (4.0, 14.0)
"""Least and greatest distance to a lorry ahead, m."""

NAVIGATED = 0.8
"""Share of the clips in which the automation knows the path; in the others the detector has nothing but the images."""

CLEAR_DAY = weather_preset("ClearNoon") or Weather()


@dataclass(frozen=True)
class View:
    """One image of a clip.

    Attributes:
        image: (height, width, 3) uint8, BGR.
        truth: The lane's boundaries and paint.
        way: Points of the path in the camera's ground frame, if the automation knows them; otherwise empty.
        junction: Distance along the path from beside the camera to the next junction, m (see `Course.junction`).
        number: Index in the clip.
    """

    image: NDArray[np.uint8]
    truth: Truth
    way: tuple[WayPoint, ...]
    junction: float
    number: int


@dataclass(frozen=True)
class Conditions:
    """The random conditions of a clip.

    Attributes:
        weather: The weather.
        sigma: Noise, grey levels.
        pitch: Pitch of the body, rad, positive with the nose down.
        leader: Distance to the vehicle ahead in the lane, m; infinite without one.
        beside: Whether a truck drives beside.
        curvature: Greatest curvature of the path within 20 m, 1/m.
        junction: Whether a junction is within 25 m.
        navigated: Whether the automation knows the path.
    """

    weather: Weather
    sigma: float
    pitch: float
    leader: float
    beside: bool
    curvature: float
    junction: bool
    navigated: bool


class MapRoads:
    """A map prepared for clips."""

    def __init__(
        self, network: Network, camera: Camera | None = None, texture: int = GROUND_SEED, lorries: float = 0.0
    ) -> None:
        """Prepare surfaces and marks once.

        Args:
            network: The map.
            camera: The camera; by default the default one.
            texture: Seed of the ground's texture.
            lorries: Share of the clips in which a lorry is close ahead.
        """
        self.network, self.camera, self.texture = network, camera if camera is not None else Camera(), texture
        self._lorries = lorries
        self._surface, self._marks, self._beside = road_surface(network), road_marks(network), roadside_of(network)
        self._in_junctions = JunctionLines(network, Lines(self._marks))
        n = network.tables
        rows = [row for row, lane in enumerate(n.lane_id) if lane != 0 and is_drivable(n.lane_type[row])]
        sections = [n.lane_section[row] for row in rows]
        self._lanes = [
            (n.section_road[section], n.lane_id[row], n.section_s[section], n.section_end[section])
            for row, section in zip(rows, sections, strict=True)
        ]
        lengths = np.array([end - start for _, _, start, end in self._lanes])
        self._share = np.cumsum(lengths) / max(float(lengths.sum()), 1e-9)

    def clips(self, seed: int, numbers: range, per_scene: int = 24) -> Iterator[tuple[int, Conditions, Iterator[View]]]:
        """Yield number, conditions and views of the clips with some numbers; `per_scene` share the wear of the paint.

        A number whose place has too short a path ahead is left out. A map without a driving lane has no clips.
        """
        if not self._lanes:
            return
        for first in range(numbers.start, numbers.stop, per_scene):
            wear = self._wear(seed, first)
            marks = joined_marks(wear.marks, self._beside.marks)
            scene = Scene(self._surface, marks, self._beside.uprights, self.texture)
            camera = RoadCamera(scene, self.camera, seed=first)
            for number in range(first, min(first + per_scene, numbers.stop)):
                found = self._clip(np.random.default_rng([seed, number]), camera, wear)
                if found is not None:
                    yield number, *found

    def _wear(self, seed: int, first: int) -> Lines:
        draw = np.random.default_rng([seed, first, 1])
        marks = self._marks
        key, index = np.unique(np.stack([marks.road, marks.lane]), axis=1, return_inverse=True)
        kind, level = draw.random(key.shape[1]), draw.random(key.shape[1])
        left = np.where(kind < 0.6, 1.0, np.where(kind < 0.7, 0.0, level))
        quality = marks.quality * left[index.ravel()]
        return Lines(replace(marks, quality=quality.astype(np.float32)))

    def _place(self, draw: np.random.Generator) -> LanePosition:
        road, lane, start, end = self._lanes[int(np.searchsorted(self._share, draw.random()))]
        s = float(draw.uniform(start, end))
        return LanePosition(self.network.road_ids[road], lane, s)

    def _clip(
        self, draw: np.random.Generator, camera: RoadCamera, lines: Lines
    ) -> tuple[Conditions, Iterator[View]] | None:
        way = self._way(self._place(draw))
        if way is None:
            return None
        curvature = way.curvature
        speed = min(float(draw.uniform(5.0, 25.0)), math.sqrt(LATERAL / max(curvature, 1e-4)))
        boxes, leader, beside = _traffic(draw, way, curvature, self._lorries)
        weather = CLEAR_DAY
        if draw.random() < 0.5:
            weather = weather_preset(str(int(draw.integers(len(WEATHER_PRESETS))))) or CLEAR_DAY
        sigma = 0.0 if draw.random() < 0.6 else float(draw.uniform(0.0, 60.0))
        pitch = 0.0 if draw.random() < 0.5 else float(np.clip(draw.normal(0.0, 0.012), -0.03, 0.03))
        offset = float(np.clip(draw.normal(0, 0.22), -0.7, 0.7))
        drift = float(np.clip(draw.normal(0, 0.012), -0.04, 0.04))
        near, navigated = way.junction_from(0.0) < 25.0 + BEHIND, bool(draw.random() < NAVIGATED)
        conditions = Conditions(weather, sigma, pitch, leader, beside, curvature, near, navigated)
        return conditions, self._views(camera, lines, way, conditions, boxes, (offset, drift, speed * PERIOD))

    def _views(
        self,
        camera: RoadCamera,
        lines: Lines,
        way: _Way,
        conditions: Conditions,
        boxes: list[Box],
        motion: tuple[float, float, float],
    ) -> Iterator[View]:
        offset, drift, step = motion
        contrast = look_of(conditions.weather).contrast
        paint = [lines.along(border, way.distance) for border in (way.left_lines, way.right_lines)]
        for number in range(IMAGES):
            at = BEHIND + number * step
            road = way.pose(at, offset + drift * number * step, drift)
            pose = road._replace(pitch=road.pitch + conditions.pitch)
            dx, dy = way.moved(number * step)
            moved = [box._replace(x=box.x + dx, y=box.y + dy) for box in boxes]
            image = camera.frame(pose, moved, conditions.weather, conditions.sigma, number)
            view = camera.view(pose)
            ahead = camera.box_offset + self.camera.x
            distance = way.distance - at - ahead
            near = (distance >= LOOKED_AT[0]) & (distance <= LOOKED_AT[1])
            painted = [float(np.mean(quality[near] * contrast > SEEN)) if near.any() else 0.0 for quality in paint]
            truth = Truth.of(view, way.left, way.right, (painted[0], painted[1]))
            meant: Sequence[WayPoint] = ()
            if conditions.navigated:
                meant = way.points(view, at, road)
            yield View(image, truth, tuple(meant), max(way.junction_from(at) - ahead, 0.0), number)

    def _way(self, here: LanePosition) -> _Way | None:
        """Return the path that starts behind a place, None if it is too short."""
        network = self.network
        back = network.previous(here, BEHIND)
        if back is None:
            return None
        places = [back]
        for _ in range(REACH + BEHIND + round(IMAGES * 25.0 * PERIOD)):
            onward = network.next(places[-1], 1.0)
            if onward is None:
                break
            places.append(onward)
        if len(places) < REACH + BEHIND:
            return None
        return _Way.along(network, places, self._in_junctions)


@dataclass(frozen=True, eq=False)
class _Way:
    """A lane followed from junction to junction, with one place per metre.

    Attributes:
        distance: (n,) along it, m.
        left: (n, 3) left border, world, m.
        right: (n, 3) right border.
        heading: (n,) rad.
        pitch: (n,) rad, positive downhill.
        roll: (n,) rad.
        left_lines: The lines on the left border for each place, that of its own road first.
        right_lines: The same for the right border.
        crossing: (n,) whether it is in a junction there.
    """

    distance: Floats
    left: Floats
    right: Floats
    heading: Floats
    pitch: Floats
    roll: Floats
    left_lines: list[tuple[LinePlace, ...]]
    right_lines: list[tuple[LinePlace, ...]]
    crossing: NDArray[np.bool_]

    @staticmethod
    def along(network: Network, places: list[LanePosition], in_junctions: JunctionLines) -> _Way:
        """Return the path through some places."""
        n = network.tables
        left, right, angles = [], [], []
        left_lines, right_lines = [], []
        for place in places:
            road = network.road_index(place.road)
            sense = lane_direction(n, road, place.lane, place.s)
            borders = lane_borders(n, road, place.lane, place.s)
            points = [network.road_pose(place.road, place.s, t) for t in borders]
            outer = LinePlace(road, place.lane, place.s)
            inner = outer._replace(lane=place.lane - 1 if place.lane > 0 else place.lane + 1)
            lines = [outer, inner] if place.lane > 0 else [inner, outer]
            if sense < 0:
                points.reverse()
                lines.reverse()
            left.append(points[0][:3])
            right.append(points[1][:3])
            left_lines.append(in_junctions.with_others(lines[0], points[0]))
            right_lines.append(in_junctions.with_others(lines[1], points[1]))
            pose = points[0]
            turned = 0.0 if sense > 0 else math.pi
            angles.append((pose.heading + turned, sense * pose.pitch, sense * pose.roll))
        heading, pitch, roll = (np.array(one) for one in zip(*angles, strict=True))
        middle = 0.5 * (np.array(left) + np.array(right))
        crossing = np.array([n.road_junction[network.road_index(place.road)] >= 0 for place in places])
        gone = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(middle[:, :2], axis=0).T))])
        return _Way(
            gone, np.array(left), np.array(right), np.unwrap(heading), pitch, roll, left_lines, right_lines, crossing
        )

    def junction_from(self, at: float) -> float:
        """Return the distance along it from a place on to the next junction, m, 0 inside; infinite without one."""
        there = self.distance[self.crossing & (self.distance >= at - 0.5)]
        return max(float(there[0]) - at, 0.0) if len(there) else math.inf

    def points(self, view: CameraView, at: float, road: Pose) -> list[WayPoint]:
        """Return the points of the path from a place on, at which the road lies in the ground plane of a pose."""
        ahead = self.distance >= at
        x, y = view.world_to_ground(0.5 * (self.left + self.right)[ahead]).T
        up = vehicle_axes(road)[:, 2]
        left, right = ((one[ahead] - np.array(road[:3])) @ up for one in (self.left, self.right))
        width = np.linalg.norm((self.left - self.right)[ahead], axis=1)
        rows = np.stack([x, y, width, 0.5 * (left + right), (left - right) / np.maximum(width, NARROWEST)], axis=1)
        return without_folds(WayPoint(*row) for row in rows.tolist())

    @property
    def curvature(self) -> float:
        """Greatest curvature over 5 m, 1/m, of the part that the camera sees."""
        turn = np.abs(self.heading[BEHIND + 5 : BEHIND + 28] - self.heading[BEHIND : BEHIND + 23])
        return float(turn.max() / 5.0)

    def pose(self, at: float, offset: float, turn: float) -> Pose:
        """Return the pose at a distance along the path, with an offset to the left of its centre, turned left."""
        middle = 0.5 * (self.left + self.right)
        x, y, z = (float(np.interp(at, self.distance, middle[:, k])) for k in range(3))
        heading, pitch, roll = (
            float(np.interp(at, self.distance, one)) for one in (self.heading, self.pitch, self.roll)
        )
        x, y = x - offset * math.sin(heading), y + offset * math.cos(heading)
        return Pose(x, y, z, heading + turn, pitch, roll)

    def moved(self, distance: float) -> tuple[float, float]:
        """Return the displacement of a vehicle that drives in the same way, m."""
        begin, end = self.pose(BEHIND, 0.0, 0.0), self.pose(BEHIND + distance, 0.0, 0.0)
        return end.x - begin.x, end.y - begin.y


def _traffic(draw: np.random.Generator, way: _Way, curvature: float, lorries: float) -> tuple[list[Box], float, bool]:
    """Return the other vehicles near the car, the distance to the leader, and whether a truck is beside."""
    boxes: list[Box] = []
    leader, beside = math.inf, False
    width = float(np.hypot(*(way.left - way.right)[BEHIND, :2]))
    if draw.random() < 0.25:
        leader = float(draw.uniform(6.0, 25.0))
        boxes.append(_box(draw, way, leader + 3.5, 0.0))
    if curvature < 0.01 and draw.random() < 0.1:
        beside = True
        pose = way.pose(BEHIND + float(draw.uniform(2.0, 16.0)), float(draw.choice([-1.0, 1.0])) * width, 0.0)
        boxes.append(Box(pose.x, pose.y, pose.z, pose.heading, 8.5, 2.5, 3.5, (90, 90, 110), "truck", pose.pitch))
    for _ in range(int(draw.integers(0, 3)) if draw.random() < 0.4 else 0):
        side = float(draw.choice([-1.0, 1.0])) * width
        boxes.append(_box(draw, way, float(draw.uniform(8.0, REACH - BEHIND)), side))
    if lorries and draw.random() < lorries:
        boxes = boxes if math.isinf(leader) else boxes[1:]
        leader = float(draw.uniform(*LORRIES_AHEAD))
        pose = way.pose(BEHIND + leader + 5.5, 0.0, 0.0)
        shade = int(draw.integers(30, 240))
        size = (8.5, 2.5, float(draw.uniform(2.8, 4.0)))
        boxes.append(Box(pose.x, pose.y, pose.z, pose.heading, *size, (shade, shade, shade), "truck", pose.pitch))
    return boxes, leader, beside


def _box(draw: np.random.Generator, way: _Way, ahead: float, offset: float) -> Box:
    pose = way.pose(BEHIND + ahead, offset, 0.0)
    colour = (int(draw.integers(30, 240)), int(draw.integers(30, 240)), int(draw.integers(30, 240)))
    kind = "van" if draw.random() < 0.2 else "car"
    height = 2.4 if kind == "van" else 1.45
    return Box(pose.x, pose.y, pose.z, pose.heading, 4.5, 1.9, height, colour, kind, pose.pitch)  # type: ignore[arg-type]
