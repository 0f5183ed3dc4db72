"""Everything static on a map, as quads in square cells, so that a town takes no longer to draw than a village.

Three kinds of quads make a scene: surfaces (lanes, the verge beside them), marks (paint on them) and uprights (faces of
poles, signs, walls, buildings, trees).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View
from scenario_compiler.perception.polygons import Floats, Index, Polygon, facing, flatten, thickness
from scenario_compiler.perception.textures import GROUND_SEED
from scenario_compiler.roads.mesh import Marks, Surface

CELL = 32.0
"""Side of a cell, m: about a fifth of the drawing distance, so that few quads outside the view are processed."""

SURFACE_DISTANCE, MARK_DISTANCE, UPRIGHT_DISTANCE = 220.0, 130.0, 220.0
"""Distance up to which surfaces, marks and uprights are drawn, m; a mark 0.12 m wide covers half a pixel at 150 m."""

SMALLEST = 0.4
"""Least size of a drawn upright, pixels."""

STOREY, BELOW_CELL = 3.0, 4.0
"""Height above another road from which a road is a bridge there (clearances are 4 m and more), and the side of the
cells in which roads are compared, m.
"""

CEILING = 0.7
"""Cosine of the angle to the vertical below which a face that looks down is a ceiling."""

RELIEF = 0.3
"""Difference of height above which a scene counts as hilly, m."""


@dataclass(frozen=True, eq=False)
class Uprights:
    """Upright faces. N faces.

    Attributes:
        quads: (N, 4, 3) float32, m from the origin; counter-clockwise as seen from the front.
        colour: (N, 3) float64 blue, green, red before lighting, including shade.
        tag: (N,) uint8, a `labels.Tag`.
        instance: (N,) int32 number of the thing to which the face belongs.
        two_sided: (N,) bool, whether the face is visible from behind too.
        lamp: (N,) uint8, 0 if the face is not a lamp of a traffic light, else 1 for red, 2 for yellow, 3 for green.
        place: (N, 2) float32 position of the face, m from the origin: its centre, or that of its board.
        signals: Instances of the traffic lights by their id in the road file.
        origin: (3,) float64, world, m.
    """

    quads: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 4, 3), np.float32))
    colour: Floats = field(default_factory=lambda: np.empty((0, 3)))
    tag: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    instance: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    two_sided: NDArray[np.bool_] = field(default_factory=lambda: np.empty(0, np.bool_))
    lamp: NDArray[np.uint8] = field(default_factory=lambda: np.empty(0, np.uint8))
    place: NDArray[np.float32] = field(default_factory=lambda: np.empty((0, 2), np.float32))
    signals: Mapping[str, tuple[int, ...]] = field(default_factory=dict)
    origin: Floats = field(default_factory=lambda: np.zeros(3))

    @cached_property
    def overhead(self) -> NDArray[np.bool_]:
        """(N,) bool, whether the face is a ceiling: it looks down."""
        corners = self.quads.astype(np.float64)
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        return np.asarray(normal[:, 2] < -CEILING * np.sqrt((normal * normal).sum(axis=1)))


class QuadGrid:
    """Quads sorted into square cells by their centres."""

    def __init__(self, quads: NDArray[np.float32], origin: Floats | None = None) -> None:
        """Sort quads of shape (N, 4, 3), m from an origin (3,) in the world, by default that of the world."""
        self.origin = np.zeros(3) if origin is None else origin
        self.corners = np.ascontiguousarray(quads.transpose(2, 1, 0))
        self.centres = self.corners[:2].mean(axis=1)
        away = self.corners[:2] - self.centres[:, None]
        self.reach = np.sqrt((away * away).sum(axis=0)).max(axis=0, initial=0.0)
        cells = np.floor(self.centres / CELL).astype(np.int64)
        self.low = cells.min(axis=1) if len(quads) else np.zeros(2, np.int64)
        self.span = int(np.ptp(cells[1])) + 3 if len(quads) else 1
        keys = self._key(cells[0], cells[1])
        self.order = np.argsort(keys, kind="stable")
        self.keys = keys[self.order]

    def near(self, view: View, distance: float) -> Index:
        """Return, in ascending order, the quads that may be visible within `distance` metres of the camera."""
        eye = view.position[:2] - self.origin[:2]
        margin = float(self.reach.max(initial=0.0)) + CELL
        inwards = field_of_view(view)
        first, last = np.floor((eye[0] + np.array([-distance, distance])) / CELL).astype(np.int64)
        columns = np.arange(first, last + 1)
        from_eye = np.stack([columns * CELL, (columns + 1) * CELL]) - eye[0]
        low, high = np.full(len(columns), -distance), np.full(len(columns), distance)
        for x, y in inwards:
            rest = -margin - np.maximum(from_eye[0] * x, from_eye[1] * x)
            if y > 1e-9:
                low = np.maximum(low, rest / y)
            elif y < -1e-9:
                high = np.minimum(high, rest / y)
            else:
                high = np.where(rest > 0.0, -np.inf, high)
        seen = low <= high
        bounds = np.floor((np.stack([low, high])[:, seen] + eye[1]) / CELL).astype(np.int64)
        bounds = np.clip(bounds, self.low[1] - 1, self.low[1] + self.span - 2)
        begin = np.searchsorted(self.keys, self._key(columns[seen], bounds[0]))
        end = np.searchsorted(self.keys, self._key(columns[seen], bounds[1]), side="right")
        found = [self.order[a:b] for a, b in zip(begin.tolist(), end.tolist(), strict=True) if b > a]
        if not found:
            return np.empty(0, np.int64)
        index = np.concatenate(found)
        dx, dy = self.centres[:, index] - eye[:, None].astype(np.float32)
        reach = self.reach[index]
        kept = dx * dx + dy * dy < np.square(reach + np.float32(distance))
        for x, y in inwards:
            kept &= np.float32(x) * dx + np.float32(y) * dy > -reach
        return np.sort(index[kept])

    def _key(self, i: Index, j: Index) -> Index:
        return np.asarray((i - self.low[0]) * self.span + (j - self.low[1]) + 1)


def field_of_view(view: View) -> list[tuple[float, float]]:
    """Return the inward normals (x, y) of the vertical planes through the eye that bound the view.

    There are none for a camera that looks so far up or down that it may see ground in every direction.
    """
    camera = view.camera
    half = camera.width / 2.0 / camera.focal, camera.height / 2.0 / camera.focal
    right, down, ahead = view.rotation.tolist()
    size = math.hypot(ahead[0], ahead[1])
    if size < 0.2:
        return []
    corners = []
    for x, y in ((-half[0], -half[1]), (-half[0], half[1]), (half[0], -half[1]), (half[0], half[1])):
        east, north = (x * right[k] + y * down[k] + ahead[k] for k in (0, 1))
        along = (east * ahead[0] + north * ahead[1]) / size
        if along <= 0.02:
            return []
        beside = (north * ahead[0] - east * ahead[1]) / size / along
        corners.append((beside, east / math.hypot(east, north), north / math.hypot(east, north)))
    _, right_x, right_y = min(corners)
    _, left_x, left_y = max(corners)
    return [(left_y, -left_x), (-right_y, right_x)]


@dataclass(frozen=True, eq=False)
class Seen:
    """Quads of one kind in the image. K quads.

    Attributes:
        index: (K,) index among their kind.
        shapes: The corners of each in the image, (corners, 2), in units of 2**-SUBPIXEL pixels.
        points: (3, 4, K) corners in camera axes.
        pixels: (2, 4, K) corners in pixels; undefined where `whole` is False.
        whole: (K,) bool, whether the quad lies completely in front of the near plane.
    """

    index: Index
    shapes: list[Polygon]
    points: Floats
    pixels: Floats
    whole: NDArray[np.bool_]

    def only(self, chosen: Index) -> Seen:
        """Return the chosen quads, in the order of `chosen`."""
        return Seen(
            self.index[chosen],
            [self.shapes[k] for k in chosen.tolist()],
            self.points[:, :, chosen],
            self.pixels[:, :, chosen],
            self.whole[chosen],
        )

    @property
    def middle(self) -> Floats:
        """(3, K) centres, camera axes."""
        return np.asarray(self.points.mean(axis=1))

    @property
    def thickness(self) -> Floats:
        """(K,) area divided by the longest side, pixels: how thin a mark looks; infinite next to the camera."""
        return np.where(self.whole, thickness(self.pixels), np.inf)


class Scene:
    """Everything static, prepared once for a map.

    Attributes:
        surface: The given surface of the roads.
        material: (S,) material of each surface, a `Material`.
        layer: (S,) where surfaces overlap, the larger value is on top.
        bridge: (S,) bool, whether the surface is above another one.
        relief: Whether surfaces differ in height.
        marks: The paint.
        uprights: The objects beside the roads.
        origin: (3,) point of the world to which quads are relative, m.
        texture: Seed of the ground's texture.
        grid: All quads by place: surfaces, marks, uprights.
    """

    def __init__(
        self, surface: Surface, marks: Marks, uprights: Uprights | None = None, texture: int = GROUND_SEED
    ) -> None:
        """Index the quads. Adjacent lanes of one material are joined, which gives the same picture faster.

        Args:
            surface: The roads' surface.
            marks: The paint; its origin is that of the surface.
            uprights: The objects beside the roads; their origin is that of the surface.
            texture: Seed of the ground's texture.
        """
        self.surface, self.texture = surface, texture
        quads, kept = _joined(surface)
        self.material = surface.material[kept]
        self.layer = surface.layer[kept]
        self.relief = bool(len(quads)) and float(np.ptp(quads[:, :, 2])) > RELIEF
        self.bridge = _over_others(quads) if self.relief else np.zeros(len(quads), np.bool_)
        self.marks = marks
        self.uprights = uprights if uprights is not None else Uprights(origin=surface.origin)
        self.origin = surface.origin
        self.grid = QuadGrid(np.concatenate([quads, marks.quads, self.uprights.quads]), surface.origin)
        self._starts = np.cumsum([0, len(quads), len(marks.quads), len(self.uprights.quads)])
        reach = (SURFACE_DISTANCE, MARK_DISTANCE, UPRIGHT_DISTANCE)
        self._distance = np.repeat(np.array(reach), np.diff(self._starts))

    def seen(self, view: View) -> tuple[Seen, Seen, Seen]:
        """Return the surfaces, the marks and the uprights in front of the camera, each in ascending order."""
        index = self.grid.near(view, max(SURFACE_DISTANCE, MARK_DISTANCE, UPRIGHT_DISTANCE))
        x, y, z = points = self._in_camera(view, index)
        camera = view.camera
        right, down = camera.width / 2.0 / camera.focal * z, camera.height / 2.0 / camera.focal * z
        out = (x - right).min(axis=0) > 0.0
        out |= (x + right).max(axis=0) < 0.0
        out |= (y - down).min(axis=0) > 0.0
        out |= (y + down).max(axis=0) < 0.0
        out |= z.min(axis=0) > self._distance[index]
        kept = np.flatnonzero(~out)
        index, points = index[kept], points[:, :, kept]
        flat = flatten(points, camera)
        index, points = index[flat.index], points[:, :, flat.index]
        ends = np.searchsorted(index, self._starts).tolist()
        surfaces, marks, uprights = (
            Seen(
                index[a:b] - self._starts[kind],
                flat.shapes[a:b],
                points[:, :, a:b],
                flat.pixels[:, :, a:b],
                flat.whole[a:b],
            )
            for kind, (a, b) in enumerate(pairwise(ends))
        )
        return surfaces, marks, self._shown(uprights)

    def _in_camera(self, view: View, index: Index) -> Floats:
        """Return the corners of quads in camera axes, (3, 4, K)."""
        shift = self.origin - view.position
        corners = self.grid.corners[:, :, index].reshape(3, -1) + shift[:, None]
        return (view.rotation @ corners).reshape(3, 4, -1)

    def _shown(self, uprights: Seen) -> Seen:
        """Return the uprights whose front is visible and that are large enough."""
        if not len(uprights.index):
            return uprights
        shown = self.uprights.two_sided[uprights.index] | facing(uprights.points)
        size = np.ptp(uprights.pixels, axis=1).max(axis=0)
        return uprights.only(np.flatnonzero(shown & (~uprights.whole | (size > SMALLEST))))


def _over_others(quads: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Return which quads (N, 4, 3) lie above others, by at least a storey."""
    points = np.concatenate([quads, quads.mean(axis=1, keepdims=True)], axis=1)
    cells = np.floor(points[..., :2] / BELOW_CELL).astype(np.int64)
    cells -= cells.min(axis=(0, 1))
    keys, place = np.unique(cells[..., 0] * (int(cells[..., 1].max()) + 1) + cells[..., 1], return_inverse=True)
    lowest = np.full(len(keys), np.inf)
    np.minimum.at(lowest, place.ravel(), points[..., 2].ravel())
    return np.asarray((points[..., 2] - lowest[place.reshape(points.shape[:2])] > STOREY).any(axis=1))


def joined_marks(first: Marks, second: Marks) -> Marks:
    """Return the marks of both, which must have the same origin."""
    columns = ("quads", "colour", "quality", "width", "road", "lane", "s")
    joined = {column: np.concatenate([getattr(one, column) for one in (first, second)]) for column in columns}
    return Marks(**joined, origin=first.origin)


def _joined(surface: Surface) -> tuple[NDArray[np.float32], Index]:
    """Return quads that span all adjacent quads of one material, and the first of each.

    Neighbours to the right come later, as in the result of `road_surface`; others (twisted slivers) are left unchanged.
    """
    wide = np.nonzero((surface.quads[:, :2] != surface.quads[:, :1:-1]).any(axis=(1, 2)))[0].tolist()
    materials = surface.material.tolist()
    left_edge = {(surface.quads[k, 0].tobytes(), surface.quads[k, 1].tobytes(), materials[k]): k for k in wide}
    beside = {
        k: left_edge.get((surface.quads[k, 3].tobytes(), surface.quads[k, 2].tobytes(), materials[k]), -1) for k in wide
    }
    beside = {k: other if other > k else -1 for k, other in beside.items()}
    starts = sorted(set(beside) - set(beside.values()))
    ends = []
    for start in starts:
        end = start
        while beside[end] >= 0:
            end = beside[end]
        ends.append(end)
    kept = np.array(starts, np.int64)
    quads = surface.quads[kept]
    quads[:, 2:] = surface.quads[np.array(ends, np.int64)][:, 2:]
    return quads, kept
