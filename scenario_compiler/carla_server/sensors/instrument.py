"""The interface of sensors, and the source of their noise."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.vocabulary.weather import Weather


class Instrument(Protocol):
    """A sensor at work."""

    def prepare(self) -> None:
        """Do the work that takes long, in a thread of its own, before the first measurement."""
        ...

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes | None:
        """Return the body of the message of this tick, None for no message."""
        ...


class Simple:
    """An instrument that needs no preparation."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Measure for a sensor on a stage."""
        del stage, sensor

    def prepare(self) -> None:
        """Do nothing."""


def generator(sensor: Sensor) -> np.random.Generator:
    """Return the source of a sensor's noise: as in CARLA, a run of its own that begins with the sensor's seed.

    The same sensor therefore measures the same in a repetition that begins at another frame.
    """
    seed = int(sensor.number("noise_seed"))
    return np.random.Generator(np.random.Philox(key=[seed & (1 << 63) - 1, sensor.measured]))
