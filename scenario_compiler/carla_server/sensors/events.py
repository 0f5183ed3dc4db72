"""The event camera: a pixel reports when its brightness has changed by a threshold.

The law is that of CARLA's documentation of `sensor.camera.dvs` and of the simulator that it is made after (Rebecq,
Gehrig and Scaramuzza, "ESIM: an Open Event Camera Simulator", CoRL 2018): the brightness is taken as linear in time
between two pictures. Each pixel remembers the level of its last event, and has another event at each further threshold
above or below that level.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.carla_server.actors import Sensor
from scenario_compiler.carla_server.sensors.cameras import CameraInstrument
from scenario_compiler.carla_server.sensors.instrument import generator
from scenario_compiler.carla_server.shared_camera import SEED
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.vocabulary.weather import Weather

Floats = NDArray[np.float32]

EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("t", "<i8"), ("pol", "?")])
"""An event in the layout of the wire: column, row, time of the simulation in ns, and whether it became brighter."""

GREY = np.array([0.114, 0.587, 0.2989], np.float32)
"""Shares of blue, green and red in the brightness, as CARLA weighs them."""

SLIGHTEST = 1e-6
"""Change of brightness below which nothing happens."""

LEAST_THRESHOLD = 0.01
"""Least threshold, also with noise and for any value of a client."""

MOST_EVENTS = 4_000_000
"""Events of one message after which its pixels report no further crossings."""


class EventPixels:
    """Pixels that report when their brightness has changed by a threshold."""

    def __init__(self, thresholds: tuple[float, float], spread: tuple[float, float], rest: int) -> None:
        """Wait for the first picture.

        Args:
            thresholds: For changes downwards and upwards, in the unit of the brightness.
            spread: Standard deviations of these thresholds, which are drawn again for each pixel and picture.
            rest: Time after an event for which a pixel reports no other, ns.
        """
        self._thresholds, self._spread, self._rest = np.array(thresholds), np.array(spread), rest
        self._time = 0
        self._before = np.empty(0, np.float32)
        self._level = np.empty(0, np.float32)
        self._last = np.empty(0, np.int64)

    def see(self, brightness: Floats, time: int, noise: np.random.Generator) -> NDArray[np.void]:
        """Return the events since the picture before, in the order of their times; none for the first picture.

        Args:
            brightness: (height, width) brightness of each pixel.
            time: The picture's time, ns.
            noise: Source of the noise of the thresholds.
        """
        now, since = brightness.ravel(), self._time
        if not len(self._before):
            self._before, self._level, self._last = now, now.copy(), np.full(len(now), -1)
        before, self._before, self._time = self._before, now, time
        change = now - before
        pixel = np.flatnonzero(np.abs(change) > SLIGHTEST)
        brighter = change[pixel] > 0.0
        threshold = self._thresholds[brighter.astype(np.intp)]
        if self._spread.any():
            threshold = threshold + self._spread[brighter.astype(np.intp)] * noise.standard_normal(len(pixel))
        sign = np.where(brighter, 1.0, -1.0)
        step = sign * np.maximum(threshold, LEAST_THRESHOLD)
        level = self._level[pixel] + step
        low, high = before[pixel].astype(np.float64), now[pixel].astype(np.float64)
        left, found = np.arange(len(pixel)), [np.empty(0, EVENT)]
        while sum(map(len, found)) < MOST_EVENTS:
            reached = level[left]
            crosses = (sign[left] * (reached - low[left]) > 0.0) & (sign[left] * (high[left] - reached) >= 0.0)
            left = left[crosses]
            if not len(left):
                break
            share = (level[left] - low[left]) / (high[left] - low[left])
            at = since + (share * (time - since)).astype(np.int64)
            here = pixel[left]
            self._level[here] = level[left]
            rested = (self._last[here] < 0) | (at - self._last[here] >= self._rest)
            self._last[here[rested]] = at[rested]
            events = np.empty(int(rested.sum()), EVENT)
            events["y"], events["x"] = np.divmod(here[rested], brightness.shape[1])
            events["t"], events["pol"] = at[rested], brighter[left[rested]]
            found.append(events)
            level[left] += step[left]
        every = np.concatenate(found)
        return every[np.argsort(every["t"], kind="stable")]


class EventCamera(CameraInstrument):
    """A camera that reports changes of brightness."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Read its attributes; see `CameraInstrument`."""
        super().__init__(stage, sensor)
        self._pixels = EventPixels(
            (sensor.number("negative_threshold"), sensor.number("positive_threshold")),
            (max(sensor.number("sigma_negative_threshold"), 0.0), max(sensor.number("sigma_positive_threshold"), 0.0)),
            max(int(sensor.number("refractory_period_ns")), 0),
        )
        self._logarithmic = sensor.says("use_log")
        self._least_light = max(sensor.number("log_eps"), SLIGHTEST)

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes | None:
        """Return the events since the picture before; None if there are none, as CARLA sends nothing then."""
        del dt
        picture = self.draw(stage, sensor, frame, weather).image(SEED, frame, stage.shapes.at(stage.time))
        events = self._pixels.see(self._brightness(picture), int(stage.time * 1e9), generator(sensor))
        return self.message(events) if len(events) else None

    def _brightness(self, picture: NDArray[np.uint8]) -> Floats:
        """Return the brightness of each pixel: grey levels, or the logarithm of their share of white."""
        grey = np.asarray(picture.astype(np.float32) @ GREY, np.float32)
        if not self._logarithmic:
            return grey
        return np.asarray(np.log(np.float32(self._least_light) + grey / np.float32(255.0)))
