"""The state of a world for clients: a structured array with one row of 119 bytes for each actor.

Layout: LibCarla's `sensor::data::ActorDynamicState` of CARLA 0.9.15 and 0.9.16, whose last 54 bytes depend on the
kind of actor.
"""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

UNION = 65
"""Offset in a row of the part that depends on the kind of actor, bytes."""

ROW = 119
ACTIVE = 1
"""Size of a row, bytes; and the state of an actor that is not dormant."""

ACTOR = np.dtype(
    {
        "names": ["id", "state", "transform", "velocity", "angular", "acceleration"],
        "formats": ["<u4", "u1", ("<f4", 6), ("<f4", 3), ("<f4", 3), ("<f4", 3)],
        "offsets": [0, 4, 5, 29, 41, 53],
        "itemsize": ROW,
    }
)
"""The part of a row that every kind of actor has."""

VEHICLE = struct.Struct("<3f3?ifB?IB")
"""Throttle, steer, brake; hand brake, reverse, manual; gear, speed limit; state of its light, whether, id; failures."""

WALKER = struct.Struct("<4f?")
"""Direction, speed, jump."""

LIGHT = struct.Struct("<32s4fI?B")
"""OpenDRIVE id; green, yellow, red and elapsed time; number in its group; frozen, state. Signs have only the id."""

SIGN = struct.Struct("<32s")

HEADER = struct.Struct("<QQd6f")
"""Of every message: index of the sensor's type, frame, time, transform."""

EPISODE = struct.Struct("<Qdf3iI")
"""Of a snapshot: episode, platform's time, step, the map's origin, bits of what has changed."""

MAP_CHANGED, LIGHTS_CHANGED = 1, 2

SENSORS = (
    *("collision", "depth", "normals", "dvs", "gnss", "imu", "lane_invasion", "obstacle", "optical_flow", "radar"),
    *("ray_cast_semantic", "ray_cast", "rss", "rgb", "semantic_segmentation", "instance_segmentation"),
)
WORLD = {"0.9.15": 16, "0.9.16": 17}
"""Indices of types: the order of LibCarla's sensor registry; that of snapshots depends on the version."""


class Rows:
    """The rows of all actors.

    Attributes:
        every: One row an actor, as `ACTOR`.
    """

    def __init__(self, count: int) -> None:
        """Make rows of zeros."""
        self._bytes = bytearray(count * ROW)
        self.every: NDArray[Any] = np.frombuffer(self._bytes, ACTOR)
        self.every["state"] = ACTIVE

    def copy_row(self, row: int, other: Rows, from_row: int) -> None:
        """Copy another row."""
        self._bytes[row * ROW : (row + 1) * ROW] = other._bytes[from_row * ROW : (from_row + 1) * ROW]

    def put(self, layout: struct.Struct, row: int, *values: float | bytes) -> None:
        """Write the part that depends on the kind of actor."""
        layout.pack_into(self._bytes, row * ROW + UNION, *values)

    def message(
        self, version: str, frame: int, time: float, episode: int, platform: float, dt: float, bits: int
    ) -> bytes:
        """Return the message of a snapshot."""
        head = HEADER.pack(WORLD[version], frame, time, *([0.0] * 6))
        return head + EPISODE.pack(episode, platform, dt, 0, 0, 0, bits) + self._bytes
