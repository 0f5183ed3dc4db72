"""Lidar, semantic lidar, radar and obstacle detection, by rays that hit the ground and the bodies' boxes.

On a level map, the ground is the plane that the sensor's carrier stands on. What a lidar loses follows CARLA's
documentation of `sensor.lidar.ray_cast`: intensity falls by exp(-attenuation x distance), a share of the points is
dropped at random, and of those below an intensity more the weaker they are.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Collection

import msgpack
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.carla_server.actors import Body, Sensor, Walker
from scenario_compiler.carla_server.sensors.instrument import Simple, generator
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.frames import carla_axes
from scenario_compiler.perception.labels import Tag
from scenario_compiler.vocabulary.weather import Weather

Floats = NDArray[np.float64]

MOST_RAYS = 2_000_000
"""Greatest number of rays in a tick."""

MIRRORED = np.array([1.0, -1.0, 1.0])
"""Factors that turn a vector in CARLA's axes into one in OpenDRIVE's, and back."""

MOST_MOVES = 256
TOUCHES = 1e-4
"""Greatest number of steps of an obstacle sensor's sphere, and the distance below which it touches, m."""

GROUND = -1
NOTHING = -2
"""Numbers in place of a body's for a ray that hits the ground or nothing."""


class Rays:
    """The hits of rays from a point.

    Attributes:
        distance: (rays,) to their hits, m; infinite without a hit.
        target: (rays,) place in `bodies`, GROUND or NOTHING.
        bodies: The bodies.
        normal: (rays, 3) of the surface that is met, CARLA's axes.
    """

    def __init__(
        self,
        stage: Stage,
        origin: Floats,
        directions: Floats,
        reach: float,
        without: int,
        unseen: Collection[int] = (),
    ) -> None:
        """Cast rays.

        Args:
            stage: The world.
            origin: (3,) where they begin, CARLA's axes, m.
            directions: (rays, 3) unit vectors.
            reach: How far they go, m.
            without: Id of the actor that they pass through: the sensor's carrier.
            unseen: Ids of further actors that they pass through.
        """
        count = len(directions)
        self.distance = np.full(count, np.inf)
        self.target = np.full(count, NOTHING)
        self.normal = np.zeros((count, 3))
        self.bodies: list[Body] = []
        self._origin, self._directions = origin, directions
        self._terrain = stage.town.terrain()
        if self._terrain.level:
            self._meet_plane(stage, origin, directions, without)
        else:
            self._meet_slopes(origin, directions, reach)
        for body in stage.bodies():
            if body.id != without and body.id not in unseen:
                self._meet_box(stage, body, origin, directions, reach)
        far = self.distance > reach
        self.distance[far], self.target[far] = np.inf, NOTHING

    def _meet_slopes(self, origin: Floats, directions: Floats, reach: float) -> None:
        window = self._terrain.window(float(origin[0]), -float(origin[1]), reach)
        distance, normal = window.meet(origin * MIRRORED, directions * MIRRORED, reach)
        meets = np.isfinite(distance)
        self.distance[meets], self.target[meets], self.normal[meets] = distance[meets], GROUND, normal[meets] * MIRRORED

    def _meet_plane(self, stage: Stage, origin: Floats, directions: Floats, without: int) -> None:
        carrier = stage.actors.get(without)
        if isinstance(carrier, Body):
            x, y, z, pitch, yaw, roll = stage.transform_of(carrier)
            up = np.array(carla_axes(pitch, yaw, roll)[2])
            foot = np.array([x, y, z]) - carrier.up * up
        else:
            ground = stage.town.ground_at(float(origin[0]), -float(origin[1]))
            up = np.array([0.0, 0.0, 1.0])
            foot = np.array([origin[0], origin[1], 0.0 if ground is None else ground.z])
        height = float(up @ (origin - foot))
        fall = -(directions @ up)
        meets = (fall > 1e-6) & (height > 0.0)
        self.distance[meets] = height / fall[meets]
        self.target[meets] = GROUND
        self.normal[meets] = up

    def _meet_box(self, stage: Stage, body: Body, origin: Floats, directions: Floats, reach: float) -> None:
        axes, middle, half = _box_of(stage, body)
        to = middle - origin
        if float(np.linalg.norm(to)) > reach + float(np.linalg.norm(half)):
            return
        here, rays = axes @ -to, directions @ axes.T
        with np.errstate(divide="ignore", invalid="ignore"):
            one, two = (-half - here) / rays, (half - here) / rays
        near, far = np.minimum(one, two), np.maximum(one, two)
        near, far = np.nan_to_num(near, nan=-np.inf), np.nan_to_num(far, nan=np.inf)
        face = np.argmax(near, axis=1)
        enters, leaves = near.max(axis=1), far.min(axis=1)
        met = (enters <= leaves) & (enters > 0.0) & (enters < self.distance)
        if not met.any():
            return
        self.distance[met] = enters[met]
        self.target[met] = len(self.bodies)
        self.normal[met] = axes[face[met]] * -np.sign(rays[met, face[met]])[:, None]
        self.bodies.append(body)

    def tags(self) -> NDArray[np.uint32]:
        """Return the semantic tag of each ray's hit."""
        tags = np.array([*(body.tag for body in self.bodies), Tag.UNLABELED, Tag.TERRAIN], np.uint32)[self.target]
        ground = np.flatnonzero(self.target == GROUND)
        if len(ground):
            distance = self.distance[ground]
            points = (self._origin + self._directions[ground] * distance[:, None])[:, :2] * MIRRORED[:2]
            x, y, _ = (self._origin * MIRRORED).tolist()
            tags[ground] = self._terrain.window(x, y, float(distance.max())).tags(points)
        return np.asarray(tags, np.uint32)

    def numbers(self) -> NDArray[np.uint32]:
        """Return the id of the actor that each ray hits; 0 for none."""
        return np.asarray(np.array([*(body.id for body in self.bodies), 0, 0], np.uint32)[self.target], np.uint32)


class RayCaster(Simple):
    """An instrument that casts rays."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Remember the map."""
        super().__init__(stage, sensor)
        self._town = stage.town

    def prepare(self) -> None:
        """Make the map's ground."""
        self._town.terrain()


class Lidar(RayCaster):
    """A lidar that turns, plain or semantic."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Begin to turn."""
        super().__init__(stage, sensor)
        self.channels = int(sensor.number("channels"))
        self.semantic = sensor.blueprint.name.endswith("semantic")
        self._angle = 0.0

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Turn further and return the points of this tick, channel by channel."""
        del frame, weather
        field = sensor.number("horizontal_fov")
        turn = min(sensor.number("rotation_frequency") * field * dt, field)
        each = min(round(sensor.number("points_per_second") * dt / self.channels), MOST_RAYS // self.channels)
        fans = np.radians(np.linspace(sensor.number("upper_fov"), sensor.number("lower_fov"), self.channels))
        angles = np.radians((self._angle + turn * np.arange(each) / max(each, 1)) % max(field, 1e-6) - 0.5 * field)
        self._angle = (self._angle + turn) % max(field, 1e-6)
        up, around = np.meshgrid(fans, angles, indexing="ij")
        local = np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], axis=2).reshape(-1, 3)
        at = stage.transform_of(sensor)
        axes = np.array(carla_axes(*at[3:]))
        reach = sensor.number("range")
        rays = Rays(stage, np.array(at[:3]), local @ axes, reach, sensor.parent, sensor.unseen)
        kept = np.isfinite(rays.distance)
        if self.semantic:
            return self._message(each, kept, self._semantic(rays, local, local @ axes, kept))
        strength = np.exp(-sensor.number("atmosphere_attenuation_rate") * np.where(kept, rays.distance, 0.0))
        noise = generator(sensor)
        kept &= noise.random(len(kept)) >= sensor.number("dropoff_general_rate")
        zero, limit = sensor.number("dropoff_zero_intensity"), sensor.number("dropoff_intensity_limit")
        weak = 0.0 if limit <= 0.0 else zero * (1.0 - strength / limit)
        kept &= noise.random(len(kept)) >= np.where(strength < limit, weak, 0.0)
        distance = rays.distance[kept] + sensor.number("noise_stddev") * noise.standard_normal(int(kept.sum()))
        points = np.concatenate([local[kept] * distance[:, None], strength[kept, None]], axis=1).astype("<f4")
        return self._message(each, kept, points)

    def _semantic(self, rays: Rays, local: Floats, directions: Floats, kept: NDArray[np.bool_]) -> NDArray[np.void]:
        names = ["x", "y", "z", "cosine", "instance", "tag"]
        points = np.zeros(
            int(kept.sum()), np.dtype([(name, "<f4" if k < 4 else "<u4") for k, name in enumerate(names)])
        )
        where = local[kept] * rays.distance[kept, None]
        for k, name in enumerate("xyz"):
            points[name] = where[:, k]
        points["cosine"] = -(directions[kept] * rays.normal[kept]).sum(axis=1)
        points["instance"], points["tag"] = rays.numbers()[kept], rays.tags()[kept]
        return points

    def _message(self, each: int, kept: NDArray[np.bool_], points: NDArray[np.generic]) -> bytes:
        counts = kept.reshape(self.channels, each).sum(axis=1).astype("<u4")
        head = struct.pack("<fI", math.radians(self._angle), self.channels)
        return head + bytes(counts.tobytes()) + bytes(points.tobytes())


class Radar(RayCaster):
    """A radar: rays at random in its field; it sees boxes and the road, and how fast they come nearer."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Remember where it is; see `RayCaster`."""
        super().__init__(stage, sensor)
        self._before = np.array(stage.transform_of(sensor)[:3])

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Return the detections: velocity towards the sensor is negative, azimuth, altitude, depth.

        As in CARLA, rays are spread evenly over the distance from the middle of the field and the angle about it, and
        the radar's own velocity is by how far it has come since the last measurement's tick.
        """
        del frame, weather
        count = min(int(sensor.number("points_per_second") * dt), MOST_RAYS)
        noise = generator(sensor)
        radius, angle = noise.random(count), noise.random(count) * math.tau
        wide, high = (math.tan(math.radians(0.5 * sensor.number(f"{name}_fov"))) for name in ("horizontal", "vertical"))
        local = np.stack([np.ones(count), wide * radius * np.cos(angle), high * radius * np.sin(angle)], axis=1)
        local /= np.linalg.norm(local, axis=1)[:, None]
        azimuth, altitude = np.arctan2(local[:, 1], local[:, 0]), np.arcsin(local[:, 2])
        at = stage.transform_of(sensor)
        origin = np.array(at[:3])
        directions = local @ np.array(carla_axes(*at[3:]))
        rays = Rays(stage, origin, directions, sensor.number("range"), sensor.parent)
        met = np.isfinite(rays.distance)
        own, self._before = (origin - self._before) / dt, origin
        velocities = stage.measured.rows.every["velocity"]
        still = np.zeros(3)
        others = [velocities[body.row].astype(np.float64) if body.row >= 0 else still for body in rays.bodies]
        relative = np.array([*others, still, still])[rays.target] - own
        speed = (relative * directions).sum(axis=1)
        found = np.stack([speed, azimuth, altitude, np.where(met, rays.distance, 0.0)], axis=1)[met]
        return bytes(found.astype("<f4").tobytes())


class Obstacle(Simple):
    """An obstacle sensor: it reports the nearest body that a sphere moved forward touches, as Unreal's sweeps do."""

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes | None:
        """Return the carrier, the obstacle and the way of the sphere, m; None if the way is free."""
        del frame, dt, weather
        carrier = stage.actors.get(sensor.parent)
        if carrier is None:
            return None
        at = stage.transform_of(sensor)
        ahead = np.array(carla_axes(*at[3:])[0])
        radius, reach = sensor.number("hit_radius"), sensor.number("distance")
        moving = sensor.says("only_dynamics")
        best: tuple[float, Body] | None = None
        for body in stage.bodies():
            if body is carrier or (moving and not isinstance(body, Walker) and not body.simulates):
                continue
            way = _sweep(stage, body, np.array(at[:3]), ahead, radius, reach if best is None else best[0])
            if way is not None:
                best = (way, body)
        if best is None:
            return None
        packed: bytes = msgpack.packb([stage.wire(carrier), stage.wire(best[1]), best[0]], use_single_float=True)
        return packed


def _sweep(stage: Stage, body: Body, begin: Floats, ahead: Floats, radius: float, reach: float) -> float | None:
    """Return the way of a sphere until it touches a body's box, m; None if it does not within its reach.

    Sphere tracing: it moves by its distance from the box until that is nothing.
    """
    axes, middle, half = _box_of(stage, body)
    here, way = axes @ (begin - middle), axes @ ahead
    gone = 0.0
    for _ in range(MOST_MOVES):
        outside = np.abs(here + gone * way) - half
        distance = float(np.linalg.norm(np.maximum(outside, 0.0)) + min(outside.max(), 0.0)) - radius
        if distance < TOUCHES:
            return gone
        gone += distance
        if gone >= reach:
            return None
    return None


def _box_of(stage: Stage, body: Body) -> tuple[Floats, Floats, Floats]:
    """Return a body's box: its axes (3, 3), its middle and its half extents, CARLA's axes."""
    x, y, z, pitch, yaw, roll = stage.transform_of(body)
    axes = np.array(carla_axes(pitch, yaw, roll))
    half = np.array(body.box)
    return axes, np.array([x, y, z]) + axes[2] * (half[2] - body.up), half
