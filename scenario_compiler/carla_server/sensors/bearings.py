"""GNSS and IMU: the position of a sensor on the globe, and its acceleration and turning rate.

Positions are those that the client's own `Map.transform_to_geolocation` computes, so that sensor and map agree. About
the reference point of the map, latitude 42 and longitude 2 where it names none, 0.9.15 has a spherical Mercator
projection with north along -y (LibCarla's `geom/GeoLocation`), 0.9.16 a spherical transverse one with the factor 0.9996
and north along +y (found by trying the client; whether a 0.9.16 server's sensor does the same is not verified).
"""

from __future__ import annotations

import math
import re

import msgpack
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.sensors.instrument import Simple, generator
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.frames import carla_axes
from scenario_compiler.vocabulary.weather import Weather

Vector = NDArray[np.float64]

EARTH_RADIUS = 6378137.0
"""Radius of the earth, m: LibCarla's."""

REFERENCE = (42.0, 2.0)
"""Latitude and longitude, degrees, of a map without a reference: LibCarla's."""


NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
"""A number as clients read it (C++'s `stod`): CARLA's towns have 4.9000000000000000e+1."""


def reference_of(georeference: str) -> tuple[float, float]:
    """Return latitude and longitude of a map's reference point, degrees, from the PROJ string of its header.

    As the clients do, it takes `+lat_0` and `+lon_0` whatever the projection; a map that lacks one has LibCarla's.
    """
    given = dict(part.split("=", 1) for part in georeference.split() if "=" in part)
    found = [NUMBER.match(given.get(name, "")) for name in ("+lat_0", "+lon_0")]
    if found[0] is None or found[1] is None:
        return REFERENCE
    return float(found[0].group()), float(found[1].group())


SHRUNK = 0.9996
"""Factor of the transverse projection on its middle meridian."""


def on_globe(version: str, reference: tuple[float, float], x: float, y: float) -> tuple[float, float]:
    """Return latitude and longitude, degrees, of a point in CARLA's axes, as a version's client has it."""
    latitude, longitude = reference
    if version >= "0.9.16":
        along, across = math.radians(latitude) + y / (EARTH_RADIUS * SHRUNK), x / (EARTH_RADIUS * SHRUNK)
        north = math.asin(math.sin(along) / math.cosh(across))
        return math.degrees(north), longitude + math.degrees(math.atan2(math.sinh(across), math.cos(along)))
    scale = math.cos(math.radians(latitude))
    east = scale * math.radians(longitude) * EARTH_RADIUS + x
    north = scale * EARTH_RADIUS * math.log(math.tan(math.radians(90.0 + latitude) / 2.0)) - y
    return (
        math.degrees(2.0 * math.atan(math.exp(north / (EARTH_RADIUS * scale)))) - 90.0,
        math.degrees(east / (EARTH_RADIUS * scale)),
    )


class Gnss(Simple):
    """A receiver of satellite positions."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Look the map's reference point up."""
        super().__init__(stage, sensor)
        self.reference = reference_of(stage.town.network.model().header.geo_reference)

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Return latitude, longitude and altitude with their noise."""
        del frame, dt, weather
        at = stage.transform_of(sensor)
        latitude, longitude = on_globe(stage.version, self.reference, at.x, at.y)
        drawn = generator(sensor).standard_normal(3).tolist()
        noisy = [
            value + sensor.number(f"noise_{name}_bias") + sensor.number(f"noise_{name}_stddev") * one
            for value, name, one in zip((latitude, longitude, at.z), ("lat", "lon", "alt"), drawn, strict=True)
        ]
        packed: bytes = msgpack.packb(noisy)
        return packed


class Imu(Simple):
    """An inertial unit with a compass."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Begin without a turning rate."""
        super().__init__(stage, sensor)
        self._turned: Vector | None = None

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Return acceleration with gravity, m/s2, and turning rates, rad/s, in the sensor's axes; the compass, rad."""
        del frame, weather
        at = stage.transform_of(sensor)
        axes = np.array(carla_axes(*at[3:]))
        parent = stage.actors.get(sensor.parent)
        gained, turning = np.zeros(3), np.zeros(3)
        if parent is not None and parent.row >= 0:
            row = stage.measured.rows.every[parent.row]
            gained, turning = row["acceleration"].astype(np.float64), np.radians(row["angular"].astype(np.float64))
            arm = np.array(at[:3]) - np.array(stage.transform_of(parent)[:3])
            gained += self._swing(turning, arm, dt)
        drawn = generator(sensor).standard_normal(6)
        felt = axes @ (gained + np.array([0.0, 0.0, stage.gravity]))
        turned = axes @ turning
        for k, axis in enumerate("xyz"):
            felt[k] += sensor.number(f"noise_accel_stddev_{axis}") * drawn[k]
            turned[k] += sensor.number(f"noise_gyro_bias_{axis}")
            turned[k] += sensor.number(f"noise_gyro_stddev_{axis}") * drawn[3 + k]
        compass = (math.radians(at.yaw) + 0.5 * math.pi) % math.tau
        packed: bytes = msgpack.packb([felt.tolist(), turned.tolist(), compass], use_single_float=True)
        return packed

    def _swing(self, turning: Vector, arm: Vector, dt: float) -> Vector:
        """Return by how much a point at an arm from its carrier's origin accelerates more than that, m/s2.

        That is a rigid body's acceleration: the change of the turning rate across the arm, and towards the axis the
        square of the rate times the arm.
        """
        before, self._turned = self._turned, turning
        changed = np.zeros(3) if before is None else (turning - before) / dt
        return np.asarray(np.cross(changed, arm) + np.cross(turning, np.cross(turning, arm)))
