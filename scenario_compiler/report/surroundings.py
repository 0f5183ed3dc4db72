"""The roads around a run as outlines in the plane, for drawing."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scenario_compiler.recording.recording import Floats
from scenario_compiler.roads.lane_types import LANE_TYPES, LAST_DRIVABLE
from scenario_compiler.roads.network import Network

QUALITY_STEPS = 10
"""Number of steps of the drawn quality of a mark."""

PAVED = ("sidewalk", "walking", "biking", "curb")
"""Types of lanes that are drawn as pavement."""

END = 1e-6
"""Distance of the last sample from a lane section's end, so that it belongs to that section, m."""


@dataclass(frozen=True, slots=True)
class Window:
    """A rectangle in the plane: OpenDRIVE x and y, m."""

    x_min: float
    y_min: float
    x_max: float
    y_max: float


@dataclass(frozen=True, slots=True)
class Strip:
    """A stretch of a lane.

    Attributes:
        type: The standard's word for the lane's type.
        drivable: Whether motor traffic may use it.
        outline: (k, 2) outline, m.
    """

    type: str
    drivable: bool
    outline: Floats


@dataclass(frozen=True, slots=True)
class MarkLine:
    """A stretch of a road mark with a constant appearance.

    Attributes:
        type: The standard's word for its type.
        colour: The standard's word for its colour.
        quality: 0 to 1.
        points: (k, 2) points, m.
    """

    type: str
    colour: str
    quality: float
    points: Floats


@dataclass(frozen=True, slots=True)
class Surroundings:
    """The lanes and marks that lie in a window or extend into it."""

    strips: tuple[Strip, ...]
    marks: tuple[MarkLine, ...]


def surroundings(network: Network, window: Window, spacing: float) -> Surroundings:
    """Return the roads in a window, sampled at most `spacing` metres apart along each reference line."""
    strips: list[Strip] = []
    marks: list[MarkLine] = []
    for road, begin, end in _stretches(network, window):
        count = max(2, math.ceil((end - begin) / spacing) + 1)
        stations = np.linspace(begin, max(begin, end - END), count).tolist()
        borders = _borders(network, road, stations)
        kinds = {lane.lane: lane.type for lane in network.lanes_at(road, stations[0])}
        strips += [_strip(kinds[lane], *borders[lane]) for lane in kinds if kinds[lane] != "none"]
        for lane in (*kinds, 0):
            outer = borders[lane][0] if lane > 0 else borders[lane][1]
            marks += _mark_lines(network, road, lane, stations, outer)
    return Surroundings(tuple(strips), tuple(marks))


def _stretches(network: Network, window: Window) -> Iterator[tuple[str, float, float]]:
    """Yield (road, s from, s to) of the stretches that touch the window, each within one lane section."""
    n = network.tables
    open_stretch: tuple[int, int, float, float] | None = None
    for k, (road, section) in enumerate(zip(n.chunk_road, n.chunk_section, strict=True)):
        if (
            n.chunk_x0[k] > window.x_max
            or n.chunk_x1[k] < window.x_min
            or n.chunk_y0[k] > window.y_max
            or n.chunk_y1[k] < window.y_min
        ):
            continue
        begin, end = n.chunk_s[k], n.chunk_end[k]
        if open_stretch and open_stretch[:2] == (road, section) and abs(open_stretch[3] - begin) < END:
            open_stretch = (road, section, open_stretch[2], end)
            continue
        if open_stretch:
            yield network.road_ids[open_stretch[0]], open_stretch[2], open_stretch[3]
        open_stretch = (road, section, begin, end)
    if open_stretch:
        yield network.road_ids[open_stretch[0]], open_stretch[2], open_stretch[3]


def _borders(network: Network, road: str, stations: list[float]) -> dict[int, tuple[Floats, Floats]]:
    """Return the left and right border of each lane, (k, 2) each; lane 0 is the centre line."""
    found: dict[int, tuple[list[tuple[float, float]], list[tuple[float, float]]]] = {}
    for s in stations:
        lanes = network.lanes_at(road, s)
        centre = next((lane.t_left for lane in lanes if lane.lane < 0), lanes[-1].t_right if lanes else 0.0)
        sides = [(lane.lane, lane.t_left, lane.t_right) for lane in lanes] + [(0, centre, centre)]
        points = {t: network.road_pose(road, s, t)[:2] for _, *borders in sides for t in borders}
        for lane, t_left, t_right in sides:
            left, right = found.setdefault(lane, ([], []))
            left.append(points[t_left])
            right.append(points[t_right])
    return {lane: (np.array(left), np.array(right)) for lane, (left, right) in found.items()}


def _strip(kind: str, left: Floats, right: Floats) -> Strip:
    drivable = LANE_TYPES.index(kind) <= LAST_DRIVABLE
    return Strip(kind, drivable, np.concatenate([left, right[::-1]]))


def _mark_lines(network: Network, road: str, lane: int, stations: list[float], points: Floats) -> Iterator[MarkLine]:
    """Yield the lane's outer mark, cut where its look changes."""
    looks = []
    for s in stations:
        mark = network.marks(road, lane, s)[0]
        gone = mark is None or mark.type in ("none", "grass", "curb")
        quality = 0.0 if mark is None else round(mark.quality * QUALITY_STEPS) / QUALITY_STEPS
        looks.append(("", "", 0.0) if gone or mark is None else (mark.type, mark.colour, quality))
    first = 0
    for k in range(1, len(stations) + 1):
        if k == len(stations) or looks[k] != looks[first]:
            if looks[first][0] and k - first + (k < len(stations)) > 1:
                yield MarkLine(*looks[first], points[first : k + 1])
            first = k
