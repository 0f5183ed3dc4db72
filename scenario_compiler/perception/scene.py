"""The static scene in a form that is quick to draw from: quads in square cells, so that a town costs what a village does."""

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

    def __init__(self, quads: NDArray[np.float32]) -> None:
        """Sort quads of shape (N, 4, 3)."""
        self.quads = quads
        self.centres = quads[:, :, :2].mean(axis=1)
        self.reach = float(np.abs(quads[:, :, :2] - self.centres[:, None]).max()) if len(quads) else 0.0
        cells = np.floor(self.centres / CELL).astype(np.int64)
        self.order = np.lexsort((cells[:, 1], cells[:, 0]))
        cells = cells[self.order]
        first = np.nonzero(np.any(np.diff(cells, axis=0, prepend=cells[:1] - 1) != 0, axis=1))[0]
        ends = np.append(first[1:], len(cells))
        self.cells = {
            (int(cells[a, 0]), int(cells[a, 1])): self.order[a:b] for a, b in zip(first, ends, strict=True)
        }

    def ahead(self, view: View, distance: float) -> NDArray[np.int64]:
        """Return, in ascending order, the quads that may be seen within `distance` metres of the camera."""
        x, y = float(view.position[0]), float(view.position[1])
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
        keep = (
            (depth > -self.reach)
            & (depth < distance)
            & (np.abs(side) < depth * spread + 2.0 * self.reach + 2.0)
        )
        return np.sort(near[keep])


@dataclass(frozen=True, eq=False)
class Projected:
    """Quads in the image.

    Attributes:
        index: (K,) which quads, nearest last.
        polygons: For each of them its corners, (corners, 2), in units of 2**-SUBPIXEL pixels.
        depth: (K,) mean distance along the optical axis, m.
        from_below: (K,) bool, the quad's underside is seen.
        height: (K,) mean height over the ground that the vehicle stands on, m.
    """

    index: NDArray[np.int64]
    polygons: list[Polygon]
    depth: NDArray[np.float64]
    from_below: NDArray[np.bool_]
    height: NDArray[np.float64]


class RoadScene:
    """Everything that stands still: the road's surface and its paint."""

    def __init__(self, surface: Surface, marks: Marks) -> None:
        """Index the quads; the arrays are shared, not copied."""
        self.surface = surface
        self.marks = marks
        self.surface_grid = QuadGrid(surface.quads)
        self.mark_grid = QuadGrid(marks.quads)


def project(view: View, quads: NDArray[np.float32], index: NDArray[np.int64]) -> Projected:
    """Return the quads of `index` that lie before the lens, clipped at the near plane, sorted from far to near."""
    world = quads[index].astype(np.float64)
    points = view.to_camera(world)
    keep = points[..., 2].max(axis=1) > NEAR
    index, points, world = index[keep], points[keep], world[keep]
    nearest_last = np.argsort(-points[..., 2].mean(axis=1), kind="stable")
    index, points, world = index[nearest_last], points[nearest_last], world[nearest_last]
    whole = points[..., 2].min(axis=1) > NEAR
    pixels = _fixed(view.to_image(np.where(whole[:, None, None], points, 1.0)))
    polygons = [
        pixels[k] if whole[k] else _fixed(view.to_image(_clip_near(points[k]))) for k in range(len(index))
    ]
    normal = np.cross(points[:, 1] - points[:, 0], points[:, 3] - points[:, 0])
    return Projected(
        index,
        polygons,
        points[..., 2].mean(axis=1),
        np.einsum("ij,ij->i", normal, points[:, 0]) < 0.0,
        (world.mean(axis=1) - view.foot) @ (view.position - view.foot) / view.camera.z,
    )


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
