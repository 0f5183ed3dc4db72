"""The ground for rays: the roads' surface with its slopes, and beside it ground at the height of the nearest road.

The triangles of the roads' surface are rasterised into a grid of cells around a place, twice: the topmost and the
lowest ones, so that rays meet a bridge and the road below it. A ray is followed over the heights of the cells' centres
to where it crosses them, and is then intersected with the triangle's own plane, so that only the borders between
surfaces depend on the cells.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.ground import MATERIAL_TAGS
from scenario_compiler.perception.labels import Tag
from scenario_compiler.roads.mesh import Surface

Floats = NDArray[np.float64]
Narrow = NDArray[np.float32]
Ids = NDArray[np.int32]

CELL = 0.5
"""Side of a cell, m."""

TILE = 64.0
"""Windows begin and end at multiples of this, m, so that one can be used for a while."""

FARTHEST = 250.0
"""Greatest distance from a sensor at which the ground's slopes are used, m."""

LEVEL = 1e-3
"""Difference of height up to which a map counts as a plane, m."""

STEPS, HALVINGS = 64, 6
"""Number of steps in which a ray is followed through the range of heights, and number of bisections of the last step.
"""

CHUNK = 16_384
"""Number of rays that are followed at once."""

KEPT = 8
SHIFT = 4
"""Number of windows that are kept, and fractional bits of corners for OpenCV."""


class Terrain:
    """The ground of a map.

    Attributes:
        level: Whether all of it is one level plane.
    """

    def __init__(self, surface: Surface) -> None:
        """Store the triangles of the roads' surface."""
        quads = surface.quads.astype(np.float64)
        self.level = not len(quads) or float(np.ptp(quads[..., 2])) < LEVEL
        corners = np.concatenate([quads[:, (0, 1, 2)], quads[:, (0, 2, 3)]])
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        upright = np.abs(normal[:, 2]) < 1e-6
        self._corners = corners[~upright]
        slope = -normal[~upright, :2] / normal[~upright, 2:]
        rest = self._corners[:, 0, 2] - (slope * self._corners[:, 0, :2]).sum(axis=1)
        self._planes = np.concatenate([slope, rest[:, None]], axis=1)
        self._tags = MATERIAL_TAGS[np.tile(surface.material, 2)[~upright]]
        self._layer = np.tile(surface.layer, 2)[~upright]
        self._origin = surface.origin[:2].astype(np.float64)
        self._low, self._high = self._corners[..., :2].min(axis=1), self._corners[..., :2].max(axis=1)
        self._windows: dict[tuple[float, ...], Window] = {}

    def window(self, x: float, y: float, reach: float) -> Window:
        """Return the ground around a point, OpenDRIVE's axes, m."""
        reach = min(reach, FARTHEST)
        here = np.array([x, y]) - self._origin
        low, high = np.floor((here - reach) / TILE) * TILE, np.ceil((here + reach) / TILE) * TILE
        key = (*low.tolist(), *high.tolist())
        if key not in self._windows:
            while len(self._windows) >= KEPT:
                del self._windows[next(iter(self._windows))]
            self._windows[key] = self._painted(low, high)
        return self._windows[key]

    def _painted(self, low: Floats, high: Floats) -> Window:
        near = np.flatnonzero((self._low < high).all(axis=1) & (self._high > low).all(axis=1))
        height = self._corners[near, :, 2].mean(axis=1)
        shape = tuple(np.rint((high - low)[::-1] / CELL).astype(int).tolist())
        fixed = (self._corners[near, :, :2] - low) / CELL - 0.5
        polygons = list(np.rint(fixed * (1 << SHIFT)).astype(np.int32))
        grids: list[Ids] = []
        for upwards in (1.0, -1.0):
            ids = np.full(shape, -1, np.int32)
            for k in np.lexsort((upwards * height, self._layer[near])).tolist():
                cv2.fillConvexPoly(ids, polygons[k], k, cv2.LINE_8, SHIFT)
            grids.append(ids)
        planes = self._planes[near].copy()
        planes[:, 2] += planes[:, :2] @ low
        return Window(low + self._origin, planes, self._tags[near], grids)


class Window:
    """The ground around a place."""

    def __init__(self, low: Floats, planes: Floats, tags: NDArray[np.uint8], grids: list[Ids]) -> None:
        """Fill the ground beside the roads.

        Args:
            low: (2,) its corner, OpenDRIVE's axes, m.
            planes: (T, 3) slopes along x and y of triangles, and their height at the corner, m.
            tags: (T,) their material, a `Tag`.
            grids: (rows, columns) the triangle of each cell, -1 for none: topmost, and lowest.
        """
        self._low, self._planes, self._grids = low, planes, grids
        self._tags = np.append(tags, np.uint8(Tag.TERRAIN))
        self._beside = [self._filled(ids) for ids in grids]
        if np.abs(self._beside[0] - self._beside[1]).max() < LEVEL:
            del self._grids[1:], self._beside[1:]
        self._middles = [one.astype(np.float32).ravel() for one in self._beside]
        self._bounds = min(one.min() for one in self._beside) - 1.0, max(one.max() for one in self._beside) + 1.0

    def _filled(self, ids: Ids) -> Floats:
        """Return the height of each cell's centre, m; without a road that of the nearest cell with one."""
        rows, columns = np.nonzero(ids >= 0)
        if not len(rows):
            return np.zeros(ids.shape)
        plane = self._planes[ids[rows, columns]]
        heights = plane[:, 0] * (columns + 0.5) * CELL + plane[:, 1] * (rows + 0.5) * CELL + plane[:, 2]
        _, labels = cv2.distanceTransformWithLabels(
            (ids < 0).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5, labelType=cv2.DIST_LABEL_PIXEL
        )
        of_label = np.zeros(int(labels.max()) + 1)
        of_label[labels[rows, columns]] = heights
        return np.asarray(of_label[labels])

    def _cells(self, x: Floats, y: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return rows and columns of points, m from the corner; for points outside, those of the nearest cell."""
        rows, columns = self._grids[0].shape
        row = np.clip((y * (1.0 / CELL)).astype(np.intp), 0, rows - 1)
        return row, np.clip((x * (1.0 / CELL)).astype(np.intp), 0, columns - 1)

    def _above(self, layer: int, x: Narrow, y: Narrow, z: Narrow) -> NDArray[np.bool_]:
        """Return whether points, m from the corner, are above the centres of their cells."""
        rows, columns = self._grids[0].shape
        row = np.clip(y * np.float32(1.0 / CELL), 0, rows - 1).astype(np.int32)
        column = np.clip(x * np.float32(1.0 / CELL), 0, columns - 1).astype(np.int32)
        return np.asarray(z > self._middles[layer][row * np.int32(columns) + column])

    def _height(self, layer: int, x: Floats, y: Floats) -> Floats:
        """Return the height of the ground at points, m from the corner."""
        row, column = self._cells(x, y)
        ids = self._grids[layer][row, column]
        plane = self._planes[ids] if len(self._planes) else np.zeros((*ids.shape, 3))
        on_road = plane[..., 0] * x + plane[..., 1] * y + plane[..., 2]
        return np.where(ids >= 0, on_road, self._beside[layer][row, column])

    def tags(self, points: Floats) -> NDArray[np.uint8]:
        """Return the material of the ground at points (N, 2), OpenDRIVE's axes: a `Tag`."""
        x, y = (points - self._low).T
        return np.asarray(self._tags[self._grids[0][self._cells(x, y)]])

    def meet(self, origin: Floats, directions: Floats, reach: float) -> tuple[Floats, Floats]:
        """Return where rays meet the ground.

        Args:
            origin: (3,) their origin, OpenDRIVE's axes, m.
            directions: (N, 3) unit vectors.
            reach: Their length, m.

        Returns:
            (N,) distances, m, infinite for rays that meet nothing; (N, 3) the ground's normals there, upwards.
        """
        distance = np.full(len(directions), np.inf)
        normal = np.tile(np.array([0.0, 0.0, 1.0]), (len(directions), 1))
        begin = np.array([*(origin[:2] - self._low), origin[2]])
        farther = min(reach, FARTHEST) * (1.0 + 4.0 / STEPS)  # the ray may cross cells' centres later than the surface
        for layer in range(len(self._grids)):
            for first in range(0, len(directions), CHUNK):
                part = slice(first, first + CHUNK)
                self._follow(layer, begin, directions[part], farther, distance[part], normal[part])
        distance[distance > reach] = np.inf
        return distance, normal

    def _follow(
        self, layer: int, begin: Floats, directions: Floats, reach: float, distance: Floats, normal: Floats
    ) -> None:
        """Follow rays to one of the surfaces; write distance and normal for rays that meet it sooner."""
        least, most = self._bounds
        fall = -directions[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):  # a level ray: both are infinite, or not a number
            to_most, to_least = (begin[2] - most) / fall, (begin[2] - least) / fall
        enters = np.clip(np.where(fall > 0.0, to_most, np.where(fall < 0.0, to_least, 0.0)), 0.0, reach)
        leaves = np.clip(np.where(fall > 0.0, to_least, np.where(fall < 0.0, to_most, reach)), 0.0, reach)
        some = np.flatnonzero(leaves > enters)
        if not len(some):
            return
        ways = directions[some]
        steps = (leaves - enters)[some] / STEPS
        t = (enters[some, None] + steps[:, None] * np.arange(STEPS + 1)).astype(np.float32)
        narrow = ways.astype(np.float32)
        above = self._above(layer, *(np.float32(begin[k]) + t * narrow[:, k, None] for k in range(3)))
        passed = above[:, 1:] != above[:, :1]
        met = np.flatnonzero(passed.any(axis=1))
        low = enters[some[met]] + steps[met] * passed[met].argmax(axis=1)
        high, starts_above, ways = low + 2.0 * steps[met], above[met, 0], ways[met]
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            x, y, z = (begin[k] + middle * ways[:, k] for k in range(3))
            before = (z > self._height(layer, x, y)) == starts_above
            low, high = np.where(before, middle, low), np.where(before, high, middle)
        found, slope = self._cut(layer, begin, ways, low, high)
        index = some[met]
        sooner = found < distance[index]
        distance[index[sooner]] = found[sooner]
        up = np.concatenate([-slope, np.ones((len(slope), 1))], axis=1)[sooner]
        normal[index[sooner]] = up / np.linalg.norm(up, axis=1)[:, None]

    def _cut(self, layer: int, begin: Floats, ways: Floats, low: Floats, high: Floats) -> tuple[Floats, Floats]:
        """Return where rays meet the planes of the triangles between two distances, and the planes' slopes."""
        middle = 0.5 * (low + high)
        x, y = (begin[k] + middle * ways[:, k] for k in range(2))
        ids = self._grids[layer][self._cells(x, y)]
        plane = self._planes[ids] if len(self._planes) else np.zeros((len(ids), 3))
        slope = np.where((ids >= 0)[:, None], plane[:, :2], 0.0)
        rest = np.where(ids >= 0, plane[:, 2], self._height(layer, x, y))
        nears = (slope * ways[:, :2]).sum(axis=1) - ways[:, 2]
        over = begin[2] - rest - (slope * begin[:2]).sum(axis=1)
        exact = over / np.where(np.abs(nears) < 1e-12, 1e-12, nears)
        x, y, z = (begin[k] + exact * ways[:, k] for k in range(3))
        on_it = (exact > 0.0) & (np.abs(z - self._height(layer, x, y)) < LEVEL)
        return np.where(on_it, exact, middle), slope
