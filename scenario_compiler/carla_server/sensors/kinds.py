"""The kinds of sensors by blueprint: the class that measures, or the reason why it cannot be spawned."""

from __future__ import annotations

from collections.abc import Callable

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.sensors.bearings import Gnss, Imu
from scenario_compiler.carla_server.sensors.cameras import ENCODINGS, ImageCamera
from scenario_compiler.carla_server.sensors.events import EventCamera
from scenario_compiler.carla_server.sensors.flow import FlowCamera
from scenario_compiler.carla_server.sensors.instrument import Instrument
from scenario_compiler.carla_server.sensors.rays import Lidar, Obstacle, Radar
from scenario_compiler.carla_server.stage import Stage

INSTRUMENTS: dict[str, Callable[[Stage, Sensor], Instrument]] = {
    **dict.fromkeys(ENCODINGS, ImageCamera),
    "sensor.camera.dvs": EventCamera,
    "sensor.camera.optical_flow": FlowCamera,
    "sensor.lidar.ray_cast": Lidar,
    "sensor.lidar.ray_cast_semantic": Lidar,
    "sensor.other.radar": Radar,
    "sensor.other.obstacle": Obstacle,
    "sensor.other.gnss": Gnss,
    "sensor.other.imu": Imu,
}
"""Class of the instrument that measures in every tick, by blueprint."""

ON_OCCASION = ("sensor.other.collision", "sensor.other.lane_invasion")
"""Sensors without an instrument: a collision is reported when it happens, lanes are watched by the client itself."""

REFUSED = {
    "sensor.camera.cosmos_visualization": "there is no such rendering here",
    "sensor.other.rss": "it needs a client that is built with RSS",
    "sensor.other.v2x": "messages between vehicles are not simulated",
    "sensor.other.v2x_custom": "messages between vehicles are not simulated",
}
"""Sensors that cannot be spawned, and why."""
