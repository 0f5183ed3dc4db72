"""The shapes of a map plot: lanes, marks, arrows of travel, junctions; in OpenDRIVE axes, metres."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.report.surroundings import Window
from scenario_compiler.roads import geometry, lanes, mesh
from scenario_compiler.roads.lane_types import LANE_TYPE_CODES, LANE_TYPES, is_drivable
from scenario_compiler.roads.network import Network

Points = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class LaneShape:
    """The part of a lane in a lane section that the window shows: its outline (N, 2), type and road."""

    outline: Points
    type: str
    road: int


@dataclass(frozen=True, eq=False)
class Arrow:
    """Position and heading of an arrow that shows the direction of travel; its length in m."""

    x: float
    y: float
    heading: float
    length: float


def lane_shapes(network: Network, window: Window) -> list[LaneShape]:
    """Return the outlines of all lanes that touch the window, without the verge."""
    n = network.tables
    surface = mesh.road_surface(network)
    corners = surface.quads + surface.origin
    kept = inside(corners, window) & (surface.lane != 0)
    quads, road, lane = corners[kept, :, :2], surface.road[kept], surface.lane[kept]
    s = surface.s[kept]
    joined = (
        (road[1:] == road[:-1])
        & (lane[1:] == lane[:-1])
        & (quads[1:, 0] == quads[:-1, 1]).all(axis=1)
        & (quads[1:, 3] == quads[:-1, 2]).all(axis=1)
    )
    breaks = np.flatnonzero(~joined) + 1
    shapes = []
    for part in np.split(np.arange(len(quads)), breaks):
        if len(part):
            q = quads[part]
            outline = np.concatenate([q[:1, 0], q[:, 1], q[::-1, 2], q[:1, 3]])
            first = part[0]
            middle = float(s[part].mean())
            kind = lanes.lane_type(n, int(road[first]), int(lane[first]), middle)
            shapes.append(LaneShape(outline, LANE_TYPES[kind], int(road[first])))
    return shapes


def turning_paths(network: Network, shapes: list[LaneShape]) -> list[Points]:
    """Return the centre lines (N, 2) of the lanes for motor traffic on connecting roads."""
    paths = []
    for shape in shapes:
        if network.tables.road_junction[shape.road] >= 0 and is_drivable(LANE_TYPE_CODES[shape.type]):
            half = len(shape.outline) // 2
            paths.append(0.5 * (shape.outline[:half] + shape.outline[: half - 1 : -1]))
    return paths


def holds(window: Window, x: float, y: float) -> bool:
    """Return whether a point lies in a window."""
    return window.x_min <= x <= window.x_max and window.y_min <= y <= window.y_max


def inside(quads: Points, window: Window) -> NDArray[np.bool_]:
    """Return which quads (N, 4, 3) touch a window, by their bounds."""
    low, high = quads[:, :, :2].min(axis=1), quads[:, :, :2].max(axis=1)
    top = np.array([window.x_max, window.y_max])
    bottom = np.array([window.x_min, window.y_min])
    touching: NDArray[np.bool_] = ((high >= bottom) & (low <= top)).all(axis=1)
    return touching


def mark_lines(marks: mesh.Marks, window: Window) -> tuple[NDArray[np.bool_], Points]:
    """Return (which painted pieces touch the window, their centre lines (N, 2, 2))."""
    corners = marks.quads + marks.origin
    kept = inside(corners, window)
    q = corners[kept, :, :2]
    return kept, np.stack([(q[:, 0] + q[:, 3]) / 2.0, (q[:, 1] + q[:, 2]) / 2.0], axis=1)


def travel_arrows(network: Network, window: Window, length: float, spacing: float, junctions: bool) -> Iterator[Arrow]:
    """Yield arrows in the lanes for motor traffic: one in each lane if they fit, otherwise one a side.

    Arrows along s and against s alternate, so that they do not overlap on a narrow road.

    Args:
        network: The roads.
        window: The part to show.
        length: Least visible length of an arrow, m.
        spacing: Least distance between arrows along a lane, m.
        junctions: Whether connecting roads have arrows, one in each lane.
    """
    n = network.tables
    for section in range(len(n.section_s)):
        road = n.section_road[section]
        start, end = n.section_s[section], min(n.section_end[section], n.road_length[road])
        if (n.road_junction[road] >= 0 and not junctions) or end - start < 2.0 * length:
            continue
        count = max(1, int((end - start) / spacing)) if n.road_junction[road] < 0 else 1
        rows = range(n.section_lane[section], n.section_lane[section + 1])
        for k in range(2 * count):
            s = start + (end - start) * (k + 0.5) / (2 * count)
            x, y, h, _ = geometry.road_reference(n, road, s)
            for t, direction, size in _travel_at(network, road, rows, s, length):
                ax, ay = x - t * math.sin(h), y + t * math.cos(h)
                if (direction > 0) == (k % 2 == 0) and holds(window, ax, ay):
                    yield Arrow(ax, ay, h if direction > 0 else h + math.pi, size)


def _travel_at(network: Network, road: int, rows: range, s: float, length: float) -> Iterator[tuple[float, int, float]]:
    """Yield (t, direction, length) of arrows at s: one in each lane if the lanes are wide enough, else one a side."""
    n = network.tables
    found = []
    for row in rows:
        width = lanes.row_width(n, row, s)
        if n.lane_id[row] != 0 and width > 1.0 and is_drivable(n.lane_type[row]):
            t, _ = lanes.row_centre(n, road, row, s)
            found.append((t, n.lane_sense[row], width))
    if all(0.5 * width >= 0.35 * length for _, _, width in found):
        for t, direction, width in found:
            yield t, direction, max(length, min(0.9 * width, 2.5 * length))
        return
    for direction in (1, -1):
        side = [t for t, towards, _ in found if towards == direction]
        if side:
            yield sum(side) / len(side), direction, length


def arrow_outline(arrow: Arrow) -> Points:
    """Return the corners of an arrow head with a notch, (4, 2)."""
    shape = np.array([[0.5, 0.0], [-0.5, 0.36], [-0.22, 0.0], [-0.5, -0.36]]) * arrow.length
    c, s = math.cos(arrow.heading), math.sin(arrow.heading)
    turned: Points = shape @ np.array([[c, s], [-s, c]]) + np.array([arrow.x, arrow.y])
    return turned


def junction_hulls(network: Network, shapes: list[LaneShape], window: Window) -> dict[str, Points]:
    """Return the convex hull (N, 2) of each junction's connecting roads in the window, by the junction's id.

    For a junction without connecting roads (a direct one) it is the hull of the adjacent road ends.
    """
    n = network.tables
    corners: dict[int, list[Points]] = {}
    for shape in shapes:
        junction = n.road_junction[shape.road]
        if junction >= 0:
            corners.setdefault(junction, []).append(shape.outline)
    with_roads = set(n.road_junction)
    for road in range(len(n.road_length)):
        for junction, s in ((n.road_start_junction[road], 0.0), (n.road_end_junction[road], n.road_length[road])):
            if junction >= 0 and junction not in with_roads:
                ends = _road_end(network, road, s)
                if any(holds(window, x, y) for x, y in ends):
                    corners.setdefault(junction, []).append(np.array(ends))
    return {network.junction_ids[j]: convex_hull(np.concatenate(corners[j])) for j in sorted(corners)}


def _road_end(network: Network, road: int, s: float) -> list[tuple[float, float]]:
    """Return the outer borders of a road's lanes at one of its ends and 1 m before it."""
    n = network.tables
    points = []
    for at in (s, min(max(s, 1.0), max(n.road_length[road] - 1.0, 0.0))):
        x, y, h, _ = geometry.road_reference(n, road, at)
        found = network.lanes_at(network.road_ids[road], at)
        for t in [found[0].t_left, found[-1].t_right] if found else [0.0]:
            points.append((x - t * math.sin(h), y + t * math.cos(h)))
    return points


def convex_hull(points: Points) -> Points:
    """Return the corners of the convex hull counter-clockwise (Andrew's monotone chain)."""
    ordered = np.unique(points, axis=0).tolist()
    if len(ordered) < 3:
        return np.array(ordered)

    def half(chain: list[list[float]]) -> list[list[float]]:
        kept: list[list[float]] = []
        for p in chain:
            while len(kept) > 1 and _turn(kept[-2], kept[-1], p) <= 0.0:
                kept.pop()
            kept.append(p)
        return kept[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def _turn(a: list[float], b: list[float], c: list[float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
