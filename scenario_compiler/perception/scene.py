"""The static scene as quads in square cells: quick to draw from, so that a town costs what a village does."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View
from scenario_compiler.roads.mesh import Marks, Surface

CELL = 32.0
"""Side of a cell, m: about a fifth of the distance drawn, so that few quads outside the view are touched."""

NEAR = 0.3
"""Distance of the near plane, m."""

SUBPIXEL = 4
"""Fractional bits of polygon corners handed to OpenCV."""

Polygon = NDArray[np.int32]


class QuadGrid:
    """Quads sorted into square cells by their centres."""

    def __init__(self, quads: NDArray[np.float32], origin: NDArray[np.float64] | None = None) -> None:
        """Sort quads of shape (N, 4, 3), m from an origin (3,) in the world, the world's own when None."""
        self.quads = quads
        self.origin = np.zeros(3) if origin is None else origin
        self.centres = quads[:, :, :2].mean(axis=1)
        self.reach = float(np.abs(quads[:, :, :2] - self.centres[:, None]).max()) if len(quads) else 0.0
        cells = np.floor(self.centres / CELL).astype(np.int64)
        self.order = np.lexsort((cells[:, 1], cells[:, 0]))
        cells = cells[self.order]
        first = np.nonzero(np.any(np.diff(cells, axis=0, prepend=cells[:1] - 1) != 0, axis=1))[0]
        ends = np.append(first, len(cells))[1:]
        self.cells = {(int(cells[a, 0]), int(cells[a, 1])): self.order[a:b] for a, b in zip(first, ends, strict=True)}

    def ahead(self, view: View, distance: float) -> NDArray[np.int64]:
        """Return, in ascending order, the quads that may be seen within `distance` metres of the camera."""
        x, y = float(view.position[0] - self.origin[0]), float(view.position[1] - self.origin[1])
        low_i, high_i = math.floor((x - distance) / CELL), math.floor((x + distance) / CELL)
        low_j, high_j = math.floor((y - distance) / CELL), math.floor((y + distance) / CELL)
        cells = self.cells
        found = [
            cells[i, j]
            for i in range(low_i, high_i + 1)
            for j in range(low_j, high_j + 1)
            if (i, j) in cells and _may_see(view, (i + 0.5) * CELL - x, (j + 0.5) * CELL - y, self.reach)
        ]
        if not found:
            return np.empty(0, np.int64)
        near = np.concatenate(found)
        offset = self.centres[near] - (x, y)
        depth, side = _along(view, offset[:, 0], offset[:, 1])
        spread = math.tan(view.camera.fov / 2.0) * 1.1
        keep = (depth > -self.reach) & (depth < distance) & (np.abs(side) < depth * spread + 2.0 * self.reach + 2.0)
        return np.sort(near[keep])


@dataclass(frozen=True, eq=False)
class Projected:
    """Quads in the image.

    Attributes:
        index: (K,) which quads, nearest last.
        polygons: For each of them its corners, (corners, 2), in units of 2**-SUBPIXEL pixels.
        thickness: (K,) area by longest side, pixels: how thin a mark looks.
        from_below: (K,) bool, the quad's underside is seen.
        height: (K,) mean height over the ground that the vehicle stands on, m.
    """

    index: NDArray[np.int64]
    polygons: list[Polygon]
    thickness: NDArray[np.float64]
    from_below: NDArray[np.bool_]
    height: NDArray[np.float64]


class RoadScene:
    """Everything that stands still: the road's surface and its paint."""

    def __init__(self, surface: Surface, marks: Marks) -> None:
        """Index the quads. Neighbouring lanes of one material are joined: the picture is the same and comes sooner."""
        quads, kept = _joined(surface)
        self.material = surface.material[kept]
        self.layer = surface.layer[kept]
        self.relief = bool(len(quads)) and float(np.ptp(quads[:, :, 2])) > 0.3
        self.marks = marks
        self.origin = surface.origin
        self.surface_grid = QuadGrid(quads, surface.origin)
        self.mark_grid = QuadGrid(marks.quads, marks.origin)


def _joined(surface: Surface) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Return quads that span all neighbouring quads of one material, and the first of each.

    Neighbours to the right come later, as `road_surface` gives them; others (twisted slivers) are left as they are.
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


def project(view: View, grid: QuadGrid, distance: float, first_row: int) -> Projected:
    """Return the quads before the lens, clipped at the near plane, sorted from far to near.

    Args:
        view: The camera in the world.
        grid: The quads.
        distance: How far they are looked for, m.
        first_row: Image row that the polygons' rows are counted from.
    """
    index = grid.ahead(view, distance)
    shift = np.array((0, first_row << SUBPIXEL), np.int32)
    world = grid.quads[index] + grid.origin
    points = view.to_camera(world)
    keep = points[..., 2].max(axis=1) > NEAR
    index, points, world = index[keep], points[keep], world[keep]
    nearest_last = np.argsort(-points[..., 2].mean(axis=1), kind="stable")
    index, points, world = index[nearest_last], points[nearest_last], world[nearest_last]
    whole = points[..., 2].min(axis=1) > NEAR
    flat = view.to_image(np.where(whole[:, None, None], points, 1.0))
    polygons = list(_fixed(flat) - shift)
    for k in np.nonzero(~whole)[0].tolist():
        polygons[k] = _fixed(view.to_image(_clip_near(points[k]))) - shift
    normal = np.cross(points[:, 1] - points[:, 0], points[:, 3] - points[:, 0])
    return Projected(
        index,
        polygons,
        np.where(whole, _thickness(flat), np.inf),
        np.einsum("ij,ij->i", normal, points[:, 0]) < 0.0,
        (world.mean(axis=1) - view.foot) @ (view.position - view.foot) / view.camera.z,
    )


def _thickness(pixels: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return area by longest side of quadrilaterals (N, 4, 2)."""
    across, along = pixels[:, 2] - pixels[:, 0], pixels[:, 3] - pixels[:, 1]
    area = 0.5 * np.abs(across[:, 0] * along[:, 1] - across[:, 1] * along[:, 0])
    sides = np.linalg.norm(pixels - np.roll(pixels, -1, axis=1), axis=2)
    return np.asarray(area / np.maximum(sides.max(axis=1), 1e-6))


def project_polygon(view: View, corners: NDArray[np.float64]) -> Polygon | None:
    """Return one planar polygon (N, 3) of the world in the image, None when it lies behind the lens."""
    points = view.to_camera(corners)
    if points[:, 2].max() <= NEAR:
        return None
    if points[:, 2].min() <= NEAR:
        points = _clip_near(points)
    return _fixed(view.to_image(points))


def _fixed(pixels: NDArray[np.float64]) -> Polygon:
    limit = float(2**19)
    return np.clip(np.round(pixels * (1 << SUBPIXEL)), -limit, limit).astype(np.int32)


def _clip_near(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cut a polygon (N, 3), camera axes, at the near plane (Sutherland and Hodgman 1974)."""
    kept: list[NDArray[np.float64]] = []
    for a, b in zip(points, np.roll(points, -1, axis=0), strict=True):
        if a[2] > NEAR:
            kept.append(a)
        if (a[2] > NEAR) != (b[2] > NEAR):
            kept.append(a + (b - a) * ((NEAR - a[2]) / (b[2] - a[2])))
    clipped = np.array(kept)
    clipped[:, 2] = np.maximum(clipped[:, 2], NEAR)
    return clipped


def _along(
    view: View, dx: NDArray[np.float64], dy: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    cos, sin = math.cos(view.pose.heading), math.sin(view.pose.heading)
    return dx * cos + dy * sin, dy * cos - dx * sin


def _may_see(view: View, dx: float, dy: float, reach: float) -> bool:
    """Whether a cell with its centre at (dx, dy) from the camera touches the field of view."""
    cos, sin = math.cos(view.pose.heading), math.sin(view.pose.heading)
    margin = CELL * 0.71 + reach
    depth, side = dx * cos + dy * sin, abs(dy * cos - dx * sin)
    half = view.camera.fov / 2.0
    return depth > -margin and side * math.cos(half) - depth * math.sin(half) < margin
