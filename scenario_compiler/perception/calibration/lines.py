"""Which painted lines run along the borders of a path, and how much of their paint is left.

A border is painted where the picture shows a line on it. Its own road's line is not always the one that is seen: in a
junction, connecting roads lie on one another, and each has its own lines. And a broken line that goes on from one road
to the next is one line: the gap between its dashes is no end of it, wherever the border of the roads lies.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from scenario_compiler.roads import Network, Pose
from scenario_compiler.roads.lanes import lane_borders
from scenario_compiler.roads.mesh import Marks

Floats = NDArray[np.float64]

GAP = 13.0
"""Longest gap between two pieces of paint of the same line, m."""

TOGETHER = 0.2
"""Distance within which two lines look like one, m."""

PARALLEL = 0.97
"""Cosine of the greatest angle between such lines."""

STEP = 1.0
"""Distance between the points of the lines in junctions, m."""


class LinePlace(NamedTuple):
    """A place on the line on the outer border of a lane; lane 0 has the line in the middle of the road."""

    road: int
    lane: int
    s: float


class Lines:
    """Marks, and how much paint is left of each line along its road."""

    def __init__(self, marks: Marks) -> None:
        """Sort the pieces of paint by line."""
        self.marks = marks
        order = np.lexsort((marks.s[:, 0], marks.lane, marks.road))
        self._s, self._quality = marks.s[order], marks.quality[order]
        key = np.stack([marks.road[order], marks.lane[order]])
        changes = np.flatnonzero((np.diff(key, axis=1) != 0).any(axis=0)) + 1
        bounds = np.concatenate([[0], changes, [len(order)]])
        self._rows = {(int(key[0, a]), int(key[1, a])): (a, b) for a, b in pairwise(bounds.tolist()) if b > a}

    def extents(self) -> dict[tuple[int, int], tuple[float, float]]:
        """Return from where to where, in s, there is paint of each line, by its road and lane, m."""
        return {line: (float(self._s[a, 0]), float(self._s[a:b, 1].max())) for line, (a, b) in self._rows.items()}

    def paint(self, place: LinePlace) -> float:
        """Return the quality of a line at a place; 0 where there is none."""
        found = self._rows.get((place.road, place.lane))
        if found is None:
            return 0.0
        a, b = found
        before = a + int(np.searchsorted(self._s[a:b, 0], place.s, side="right")) - 1
        if before >= a and place.s <= self._s[before, 1] + 0.01:
            return float(self._quality[before])
        if before >= a and before + 1 < b and self._s[before + 1, 0] - self._s[before, 1] < GAP:
            return float(self._quality[before])
        return 0.0

    def along(self, border: Sequence[Sequence[LinePlace]], distance: Floats) -> Floats:
        """Return the quality of the paint that is seen on the border of a path, (n,).

        Args:
            border: For each place of the path, the lines there, that of its own road first.
            distance: (n,) distance along the path, m.
        """
        quality = np.array([max(self.paint(line) for line in lines) for lines in border])
        own = [lines[0][:2] for lines in border]
        bounds = [0, *(k for k in range(1, len(own)) if own[k] != own[k - 1]), len(own)]
        for begin, seam, end in zip(bounds, bounds[1:], bounds[2:], strict=False):
            before, after = np.flatnonzero(quality[begin:seam]), np.flatnonzero(quality[seam:end])
            if not len(before) or not len(after):
                continue
            last, first = begin + int(before[-1]), seam + int(after[0])
            if distance[first] - distance[last] < GAP:
                quality[last + 1 : first] = min(quality[last], quality[first])
        return quality


class JunctionLines:
    """The lines of all connecting roads, in which those are found that run along a border."""

    def __init__(self, network: Network, lines: Lines) -> None:
        """Walk along the lines of the roads in junctions."""
        n = network.tables
        self._junction = n.road_junction
        places, points, directions = [], [], []
        for (road, lane), (first, last) in lines.extents().items():
            if n.road_junction[road] < 0:
                continue
            for s in np.linspace(first, last, 1 + math.ceil((last - first) / STEP)).tolist():
                left, right = lane_borders(n, road, lane, s)
                pose = network.road_pose(network.road_ids[road], s, left if lane > 0 else right)
                places.append(LinePlace(road, lane, s))
                points.append(pose[:3])
                directions.append((math.cos(pose.heading), math.sin(pose.heading)))
        self._places, self._points, self._directions = places, np.array(points), np.array(directions)
        self._tree = cKDTree(self._points) if places else None

    def with_others(self, own: LinePlace, border: Pose) -> tuple[LinePlace, ...]:
        """Return a place on a border's own line, and the places of other lines that run along the border there.

        Args:
            own: The place on the line of the border's own road.
            border: The point of the border, heading along the road.
        """
        if self._tree is None or self._junction[own.road] < 0:
            return (own,)
        near = np.array(self._tree.query_ball_point(border[:3], math.hypot(0.5 * STEP, TOGETHER)), np.int64)
        direction = np.array([math.cos(border.heading), math.sin(border.heading)])
        away = np.array(border[:2]) - self._points[near, :2]
        aside = np.abs(away[:, 0] * direction[1] - away[:, 1] * direction[0])
        alike = (aside < TOGETHER) & (np.abs(self._directions[near] @ direction) > PARALLEL)
        others = (self._places[k] for k in np.sort(near[alike]).tolist())
        return (own, *(place for place in others if place[:2] != own[:2]))
