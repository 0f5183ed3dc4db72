"""The debug shapes of clients, as colour cameras see them.

Points, lines, arrows and boxes stand in the world, and CARLA's `sensor.camera.rgb` sees them (its issue 6705); they are
made of lines as its `DebugShapeDrawer.cpp` makes them. Strings, and the shapes of 0.9.16's `draw_hud_...`, are on the
display of the server's window alone (issues 1788 and 7168), and there is no window here.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.frames import carla_axes, vector_from_carla
from scenario_compiler.perception.strokes import MOST, Stroke

POINT, LINE, ARROW, BOX = range(4)
"""Kinds of shapes in the world in the order of their numbers on the wire; all further kinds are on the display."""

FARTHEST = 1.0e6
"""Greatest absolute value of coordinates, sizes and angles, m and degrees."""

LATE = 1e-6
"""Time for which a shape stays visible after its life time, s: one that lives for a step is in the next picture."""


class DebugShapes:
    """The shapes of a world."""

    def __init__(self) -> None:
        """Begin without shapes."""
        self._strokes: list[Stroke] = []
        self._ends: list[float] = []
        self._first = math.inf

    def add(self, wire: list[Any], time: float) -> None:
        """Take a shape as it is encoded on the wire: its kind, colour and life time, and whether it persists.

        A life time of 0 or less lasts until the shapes are cleared, as Unreal's batches of lines have it. Of too many
        lines the newest are left out.

        Args:
            wire: The shape.
            time: Time now, s.

        Raises:
            CallError: It is too large or too far away.
        """
        (kind, primitive), (red, green, blue), lasts, _ = wire
        if kind > BOX:
            return
        if kind == BOX:  # its actor's number is not set by the client: it is whatever was in its memory
            (middle, extent, *_), *rest = primitive
            primitive = [[middle, extent], *rest]
        if any(abs(number) > FARTHEST for number in _numbers(primitive)):
            raise CallError("the shape is out of bounds")
        self._forget(time)
        ends = time + lasts + LATE if lasts > 0.0 else math.inf
        for begin, end, width in _lines(kind, primitive):
            if len(self._strokes) >= MOST:
                return
            self._strokes.append(
                Stroke(vector_from_carla(*begin), vector_from_carla(*end), max(width, 0.0), (blue, green, red))
            )
            self._ends.append(ends)
            self._first = min(self._first, ends)

    def at(self, time: float) -> list[Stroke]:
        """Return the lines that are seen at a time, s, in the order in which they were drawn."""
        self._forget(time)
        return self._strokes

    def clear(self) -> None:
        """Forget all shapes."""
        self._strokes, self._ends, self._first = [], [], math.inf

    def _forget(self, time: float) -> None:
        """Remove the shapes that have ended before a time, s."""
        if self._first < time:
            kept = [k for k, end in enumerate(self._ends) if end >= time]
            self._strokes, self._ends = [self._strokes[k] for k in kept], [self._ends[k] for k in kept]
            self._first = min(self._ends, default=math.inf)


def _numbers(primitive: list[Any]) -> Iterator[float]:
    """Yield all numbers of a shape."""
    for one in primitive:
        if isinstance(one, list):
            yield from _numbers(one)
        else:
            yield one


def _lines(kind: int, primitive: list[Any]) -> Iterator[tuple[list[float], list[float], float]]:
    """Yield start and end, CARLA's axes, and width of the lines of a shape, m; a point is a line of length 0."""
    if kind == POINT:
        place, size = primitive
        yield place, place, size
    elif kind == LINE:
        begin, end, width = primitive
        yield begin, end, width
    elif kind == ARROW:
        (begin, end, width), size = primitive
        yield begin, end, width
        for place in _barbs(np.array(begin, np.float64), np.array(end, np.float64), size):
            yield place, end, width
    else:
        (middle, extent), (pitch, yaw, roll), width = primitive
        axes = np.array(carla_axes(pitch, yaw, roll)) * np.array(extent, np.float64)[:, None]
        corners = {signs: (np.array(middle) + np.array(signs) @ axes).tolist() for signs in product((-1, 1), repeat=3)}
        for one, other in product(corners, repeat=2):
            if one < other and sum(a != b for a, b in zip(one, other, strict=True)) == 1:
                yield corners[one], corners[other], width


def _barbs(begin: Any, end: Any, size: float) -> list[list[float]]:
    """Return the starts of the four barbs of an arrow's head: `size` before its end and to the sides."""
    along = end - begin
    length = float(np.linalg.norm(along))
    if length < 1e-9:
        return []
    x, y, z = along / length
    axes = np.array(carla_axes(math.degrees(math.asin(max(min(z, 1.0), -1.0))), math.degrees(math.atan2(y, x)), 0.0))
    foot = end - size * axes[0]
    return [(foot + size * (right * axes[1] + up * axes[2])).tolist() for right, up in product((1, -1), repeat=2)]
