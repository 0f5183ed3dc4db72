"""The network as quads: road surfaces by material and painted marks, for the camera, plots and mesh export.

Lanes are cut at stations every two metres, of which those are left out between which the surface is flat and straight.
A mark is drawn by the lines of its type where the file gives them, else by `_LINES_OF_TYPE`: the standard leaves the
dashes of a "broken" mark open (`marks.STANDARD_DASH`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import IntEnum
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.roads import geometry, lane_types, lanes
from scenario_compiler.roads import marks as road_marks_codes
from scenario_compiler.roads.positions import SecondaryLine
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.roads.network import Network

Floats = NDArray[np.float64]
Point = tuple[float, float, float]

VERGE_WIDTH = 6.0
"""Width of the strip of grass along roads that are not level, m; it connects them with the ground."""

STATIONS = 2.0
"""Distance of the stations at which a lane's borders are evaluated, m."""

TOLERANCE = 0.01
"""Distance by which a surface or a line may lie off the quad that stands for it, m."""

LONGEST = 20.0
"""Greatest length of a piece of a surface, m."""

ORIGIN_GRID = 10_000.0
"""Origins of meshes are multiples of it, m. Corners in single precision are then exact to 0.5 mm up to 8 km from it,
wherever in the world the map lies."""

MOST_PIECES = 20_000
"""Greatest number of stations of a lane section and of pieces of a mark; beyond it they become longer. This protects
against hostile files.
"""


class Material(IntEnum):
    """The material of a piece of ground."""

    VERGE = 0
    ASPHALT = 1
    SHOULDER = 2
    CONCRETE = 3
    GRASS = 4
    CYCLE = 5


class Paint(IntEnum):
    """Colour of a mark."""

    WHITE = 0
    YELLOW = 1
    BLUE = 2
    GREEN = 3
    RED = 4
    ORANGE = 5
    VIOLET = 6
    BLACK = 7


@dataclass(frozen=True, eq=False)
class Surface:
    """Pieces of lanes, and of the verge beside them. N pieces.

    Attributes:
        quads: (N, 4, 3) float32, m from the origin: left and right are as seen along increasing s; corners are left
            start, left end, right end, right start.
        material: (N,) uint8, a `Material`.
        layer: (N,) uint8: where pieces overlap, the larger value is on top.
        road: (N,) int32 index of the road.
        lane: (N,) int32 id of the lane, 0 for the verge.
        s: (N, 2) float64 start and end, m.
        origin: (3,) float64, world, m; z is 0.
    """

    quads: NDArray[np.float32]
    material: NDArray[np.uint8]
    layer: NDArray[np.uint8]
    road: NDArray[np.int32]
    lane: NDArray[np.int32]
    s: Floats
    origin: Floats = field(default_factory=lambda: np.zeros(3))


@dataclass(frozen=True, eq=False)
class Marks:
    """Painted pieces. M pieces.

    Attributes:
        quads: (M, 4, 3) float32, m from the origin, corners as in `Surface`.
        colour: (M,) uint8, a `Paint`.
        quality: (M,) float32 share of the paint that is left, 1 new, 0 gone.
        width: (M,) float32, m.
        road: (M,) int32 index of the road.
        lane: (M,) int32 id of the lane whose outer border the mark lies on; 0 for the centre mark and secondary lines.
        s: (M, 2) float64 start and end, m.
        origin: (3,) float64, as in `Surface`.
    """

    quads: NDArray[np.float32]
    colour: NDArray[np.uint8]
    quality: NDArray[np.float32]
    width: NDArray[np.float32]
    road: NDArray[np.int32]
    lane: NDArray[np.int32]
    s: Floats
    origin: Floats = field(default_factory=lambda: np.zeros(3))


_MATERIALS = {
    lane_types.NONE: Material.VERGE,
    lane_types.SHOULDER: Material.SHOULDER,
    lane_types.BORDER: Material.SHOULDER,
    lane_types.RESTRICTED: Material.SHOULDER,
    lane_types.MEDIAN: Material.GRASS,
    lane_types.BIKING: Material.CYCLE,
    lane_types.SIDEWALK: Material.CONCRETE,
    lane_types.WALKING: Material.CONCRETE,
    lane_types.CURB: Material.CONCRETE,
    lane_types.TRAM: Material.CONCRETE,
    lane_types.RAIL: Material.GRASS,
}
_LAYERS = {
    Material.VERGE: 0,
    Material.GRASS: 1,
    Material.CONCRETE: 1,
    Material.CYCLE: 2,
    Material.SHOULDER: 2,
    Material.ASPHALT: 3,
}
_PAINTS = dict.fromkeys(range(len(road_marks_codes.MARK_COLOURS)), Paint.WHITE) | {
    road_marks_codes.MARK_COLOUR_CODES[paint.name.lower()]: paint for paint in Paint
}


class _Line(NamedTuple):
    """One line of a mark: dash and gap, m (gap 0: solid), and outward offset in widths of the mark."""

    dash: float
    gap: float
    beside: float


_SOLID = (0.0, 0.0)
_BROKEN = (road_marks_codes.STANDARD_DASH, road_marks_codes.STANDARD_GAP)
_LINES_OF_TYPE = {
    road_marks_codes.MARK_SOLID: (_Line(*_SOLID, 0.0),),
    road_marks_codes.MARK_BROKEN: (_Line(*_BROKEN, 0.0),),
    road_marks_codes.MARK_SOLID_SOLID: (_Line(*_SOLID, -1.0), _Line(*_SOLID, 1.0)),
    road_marks_codes.MARK_SOLID_BROKEN: (_Line(*_SOLID, -1.0), _Line(*_BROKEN, 1.0)),
    road_marks_codes.MARK_BROKEN_SOLID: (_Line(*_BROKEN, -1.0), _Line(*_SOLID, 1.0)),
    road_marks_codes.MARK_BROKEN_BROKEN: (_Line(*_BROKEN, -1.0), _Line(*_BROKEN, 1.0)),
    road_marks_codes.MARK_BOTTS_DOTS: (_Line(road_marks_codes.DOT, road_marks_codes.DOT_GAP, 0.0),),
}


def mesh_origin(network: Network) -> Floats:
    """Return the point of `ORIGIN_GRID` nearest to the middle of a network, (3,), world, m; z is 0.

    It is (0, 0, 0) for maps around the world's origin.
    """
    x0, y0, x1, y1 = network.bounds()
    middle = np.array([(x0 + x1) / 2.0, (y0 + y1) / 2.0, 0.0])
    return np.rint(middle / ORIGIN_GRID) * ORIGIN_GRID + 0.0


def road_surface(network: Network) -> Surface:
    """Return every lane of every road, junctions included, and the verge beside roads that are not level."""
    n = network.tables
    quads: list[Floats] = []
    columns: list[tuple[int, int, int, float, float]] = []
    for section in range(len(n.section_s)):
        for material, lane, corners, s in _strips(n, section):
            road = n.section_road[section]
            quads.append(corners)
            columns += [(material, road, lane, a, b) for a, b in pairwise(s)]
    table = np.array(columns, np.float64).reshape(-1, 5)
    origin = mesh_origin(network)
    layer = np.array([_LAYERS[kind] for kind in Material], np.uint8)
    materials = table[:, 0].astype(np.uint8)
    return Surface(
        quads=(np.concatenate([*quads, np.empty((0, 4, 3))]) - origin).astype(np.float32),
        material=materials,
        layer=layer[materials],
        road=table[:, 1].astype(np.int32),
        lane=table[:, 2].astype(np.int32),
        s=table[:, 3:],
        origin=origin,
    )


def _strips(n: RoadTables, section: int) -> Iterator[tuple[Material, int, Floats, list[float]]]:
    """Yield material, lane, quads (N, 4, 3) and the N + 1 stations of each lane of a section."""
    road = n.section_road[section]
    start, end = n.section_s[section], min(n.section_end[section], n.road_length[road])
    rows = [r for r in range(n.section_lane[section], n.section_lane[section + 1]) if n.lane_id[r] != 0]
    if not rows or end - start < 1e-6:
        return
    count = min(max(1, math.ceil((end - start) / STATIONS)), MOST_PIECES)
    stations = [start + (end - start) * k / count for k in range(count)] + [end]
    borders = np.array([_borders(n, road, section, rows, s) for s in stations])
    kept = _needed(borders, np.array(stations))
    borders, stations = borders[kept], [stations[k] for k in kept]
    for k, row in enumerate(rows):
        left, right = borders[:, 2 * k + 1], borders[:, 2 * k + 2]
        if float(np.abs(left - right).max()) < 1e-3:
            continue
        material = _MATERIALS.get(n.lane_type[row], Material.ASPHALT)
        yield material, n.lane_id[row], _quads(left, right), stations
    if n.road_flat[road] == 0:
        yield Material.VERGE, 0, _quads(borders[:, 0], borders[:, 1]), stations
        yield Material.VERGE, 0, _quads(borders[:, -2], borders[:, -1]), stations


def _quads(left: Floats, right: Floats) -> Floats:
    return np.stack([left[:-1], left[1:], right[1:], right[:-1]], axis=1)


def _borders(n: RoadTables, road: int, section: int, rows: list[int], s: float) -> list[Point]:
    """Return points from left to right: the verge's rim, left and right border of each lane, the other rim."""
    s = _inside(n, section, s)
    points: list[Point] = []
    for row in rows:
        half = 0.5 * lanes.row_width(n, row, s)
        for offset in (half, -half):
            points.append(lanes.lane_pose(n, road, n.lane_id[row], s, offset)[:3])
    heading = geometry.road_reference(n, road, s)[2]
    x, y = -VERGE_WIDTH * math.sin(heading), VERGE_WIDTH * math.cos(heading)
    left, right = points[0], points[-1]
    return [(left[0] + x, left[1] + y, left[2]), *points, (right[0] - x, right[1] - y, right[2])]


def _inside(n: RoadTables, section: int, s: float) -> float:
    """Return s, moved by a micrometre where it is the section's end, so that it is not the next one's."""
    return max(min(s, n.section_end[section] - 1e-6), n.section_s[section])


def _needed(borders: Floats, s: Floats) -> list[int]:
    """Return the stations, including first and last, between which the borders are straight within `TOLERANCE`."""
    kept, last = [0], len(s) - 1
    while kept[-1] < last:
        here = kept[-1]
        ahead = here + 1
        while ahead < last and s[ahead + 1] - s[here] <= LONGEST:
            share = ((s[here + 1 : ahead + 1] - s[here]) / (s[ahead + 1] - s[here]))[:, None, None]
            chord = borders[here] + share * (borders[ahead + 1] - borders[here])
            if float(np.abs(borders[here + 1 : ahead + 1] - chord).max()) > TOLERANCE:
                break
            ahead += 1
        kept.append(ahead)
    return kept


def road_marks(network: Network, secondary: Sequence[SecondaryLine] = ()) -> Marks:
    """Return the painted pieces of every mark: solid lines, dashes, double lines.

    Args:
        network: The roads, with the quality of their marks.
        secondary: Lines beside the marks, painted after them.

    Raises:
        KeyError: When a secondary line names a road or a colour that does not exist.
    """
    n = network.tables
    quads: list[tuple[Point, Point, Point, Point]] = []
    columns: list[tuple[int, float, float, int, int, float, float]] = []
    for section in range(len(n.section_s)):
        for row in range(n.section_lane[section], n.section_lane[section + 1]):
            for mark in range(n.lane_mark[row], n.lane_mark[row + 1]):
                for line in _lines(n, row, mark):
                    _paint(n, row, mark, line, quads, columns)
    for beside in secondary:
        _paint_secondary(n, network.road_index(beside.road), beside, quads, columns)
    table = np.array(columns, np.float64).reshape(-1, 7)
    origin = mesh_origin(network)
    return Marks(
        quads=(np.array(quads, np.float64).reshape(-1, 4, 3) - origin).astype(np.float32),
        colour=table[:, 0].astype(np.uint8),
        quality=table[:, 1].astype(np.float32),
        width=table[:, 2].astype(np.float32),
        road=table[:, 3].astype(np.int32),
        lane=table[:, 4].astype(np.int32),
        s=table[:, 5:],
        origin=origin,
    )


class _Stroke(NamedTuple):
    """A line to be painted: offset to the left from the border, width, colour, dash, gap, first and last s."""

    t: float
    width: float
    colour: Paint
    dash: float
    gap: float
    start: float
    end: float


def _lines(n: RoadTables, row: int, mark: int) -> Iterator[_Stroke]:
    """Yield the lines of a mark: those of the file, or else those of its type, which lie from inside to outside."""
    start, end, width = n.mark_s[mark], n.mark_end[mark], n.mark_width[mark]
    if n.mark_type[mark] == road_marks_codes.MARK_NONE:
        return
    explicit = range(n.mark_line[mark], n.mark_line[mark + 1])
    for k in explicit:
        own = n.line_width[k] if n.line_width[k] > 0.0 else width
        first, length = start + n.line_s[k], n.line_length[k]
        last = min(first + length, end) if n.line_once[k] else end
        gap = 0.0 if n.line_once[k] else n.line_space[k]
        yield _Stroke(n.line_t[k], own, _PAINTS[n.line_colour[k]], length, gap, first, last)
    if not explicit:
        colour = _PAINTS[n.mark_colour[mark]]
        outwards = width if n.lane_id[row] > 0 else -width
        for dash, gap, beside in _LINES_OF_TYPE.get(n.mark_type[mark], ()):
            yield _Stroke(beside * outwards, width, colour, dash, gap, start, end)


def _paint(
    n: RoadTables,
    row: int,
    mark: int,
    line: _Stroke,
    quads: list[tuple[Point, Point, Point, Point]],
    columns: list[tuple[int, float, float, int, int, float, float]],
) -> None:
    """Append the pieces of one line."""
    section = n.lane_section[row]
    road, lane = n.section_road[section], n.lane_id[row]
    low = max(line.start, n.section_s[section], 0.0)
    high = min(line.end, n.section_end[section], n.road_length[road])
    from_q, to_q = n.mark_quality_from[mark], n.mark_quality_to[mark]
    span = n.mark_end[mark] - n.mark_s[mark]
    for a, b in _dashes(line, low, high):
        for s0, s1 in _pieces(n, road, a, b, 1.0 if from_q != to_q else 10.0):
            left0, right0 = _across(n, road, row, mark, s0, line.t, line.width)
            left1, right1 = _across(n, road, row, mark, s1, line.t, line.width)
            share = ((s0 + s1) / 2.0 - n.mark_s[mark]) / span if span > 0.0 else 0.0
            quads.append((left0, left1, right1, right0))
            columns.append((line.colour, from_q + share * (to_q - from_q), line.width, road, lane, s0, s1))


def _paint_secondary(
    n: RoadTables,
    road: int,
    line: SecondaryLine,
    quads: list[tuple[Point, Point, Point, Point]],
    columns: list[tuple[int, float, float, int, int, float, float]],
) -> None:
    """Append the pieces of a line at a constant distance from the reference line."""
    colour = _PAINTS[road_marks_codes.MARK_COLOUR_CODES[line.colour]]
    dash, gap = _BROKEN if line.broken else _SOLID
    stroke = _Stroke(line.t, line.width, colour, dash, gap, line.s_from, line.s_to)
    rims = (line.t + line.width / 2.0, line.t - line.width / 2.0)
    for a, b in _dashes(stroke, max(line.s_from, 0.0), min(line.s_to, n.road_length[road])):
        for s0, s1 in _pieces(n, road, a, b, 10.0):
            left0, right0 = (geometry.road_pose(n, road, s0, t)[:3] for t in rims)
            left1, right1 = (geometry.road_pose(n, road, s1, t)[:3] for t in rims)
            quads.append((left0, left1, right1, right0))
            columns.append((colour, line.quality, line.width, road, 0, s0, s1))


def _dashes(line: _Stroke, low: float, high: float) -> Iterator[tuple[float, float]]:
    """Yield the painted ranges of s between `low` and `high`."""
    period = line.dash + line.gap
    if line.gap <= 0.0 or line.dash <= 0.0 or (high - low) / period > MOST_PIECES:
        if high > low:
            yield low, high
        return
    first = math.floor((low - line.start) / period)
    for k in range(first, math.ceil((high - line.start) / period)):
        a, b = line.start + k * period, line.start + k * period + line.dash
        if min(b, high) - max(a, low) > 0.01:
            yield max(a, low), min(b, high)


def _pieces(n: RoadTables, road: int, low: float, high: float, longest: float) -> Iterator[tuple[float, float]]:
    """Yield ranges over which the reference line is straight within `TOLERANCE`, at most `longest` m."""
    if n.road_flat[road] == 0:
        longest = min(longest, 4.0)
    longest = max(longest, (high - low) / MOST_PIECES)
    s = low
    while high - s > 1e-6:
        k = abs(geometry.road_reference(n, road, s)[3])
        ahead = abs(geometry.road_reference(n, road, min(s + longest, high))[3])
        chord = math.sqrt(8.0 * TOLERANCE / max(k, ahead, 1e-6))
        parts = max(1, math.ceil((high - s) / max(min(longest, chord), (high - low) / MOST_PIECES)))
        step = (high - s) / parts
        yield s, s + step
        s += step


def _across(
    n: RoadTables, road: int, row: int, mark: int, s: float, beside: float, width: float
) -> tuple[Point, Point]:
    """Return the left and right edge of a line at s on the outer border of a lane's row."""
    s = _inside(n, n.lane_section[row], s)
    lane = n.lane_id[row]
    t = beside + geometry.cubic_value(n, n.mark_sway_first[mark], n.mark_sway_last[mark], s)
    if lane == 0:
        t += lanes.lane_offset(n, road, s)
        left, right = (geometry.road_pose(n, road, s, rim) for rim in (t + width / 2.0, t - width / 2.0))
    else:
        t += math.copysign(0.5 * lanes.row_width(n, row, s), lane)
        left, right = (lanes.lane_pose(n, road, lane, s, rim) for rim in (t + width / 2.0, t - width / 2.0))
    return left[:3], right[:3]
