"""Planar polygons of the world as polygons of the image: clipped, projected, in fixed point for OpenCV.

Points of many polygons are stored by axis, then corner, then polygon, (3, corners, K), because numpy is fast along the
last axis. Polygons that extend behind the near plane, or so far out of the image that fixed point would bend their
edges, are clipped (Sutherland and Hodgman, Communications of the ACM 17, 1974).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera

Floats = NDArray[np.float64]
Index = NDArray[np.int64]
Polygon = NDArray[np.int32]

NEAR = 0.3
"""Greatest distance of the near plane, m: that of a camera which sees no ground nearer than this."""

NEAREST_GROUND = 0.8
"""Distance of the near plane as a share of the depth of the nearest ground that the camera sees."""

SUBPIXEL = 4
"""Fractional bits of polygon corners handed to OpenCV."""

MARGIN = 64.0
"""Distance beyond the image at which polygons are clipped if necessary, pixels."""

FARTHEST = 8192.0
"""Distance from the principal point up to which OpenCV draws edges exactly, pixels; with corners farther out the slopes
of the edges overflow.
"""


@dataclass(frozen=True, eq=False)
class Flat:
    """Polygons in the image. K polygons, without those that lie completely behind the lens.

    Attributes:
        index: (K,) which of the given polygons it is.
        shapes: The corners of each, (corners, 2), in units of 2**-SUBPIXEL pixels.
        pixels: (2, N, K) corners in pixels; undefined for clipped polygons.
        whole: (K,) bool, whether the polygon was not clipped.
    """

    index: Index
    shapes: list[Polygon]
    pixels: Floats
    whole: NDArray[np.bool_]


@lru_cache(maxsize=64)
def near_plane(camera: Camera) -> float:
    """Return the distance of a camera's near plane, m, so that the ground on which the vehicle stands is in front."""
    right, down, ahead = (-camera.rotation[:, 2]).tolist()
    across, along = camera.width / 2.0 / camera.focal, camera.height / 2.0 / camera.focal
    steepest = abs(right) * across + abs(down) * along + ahead
    return min(NEAR, NEAREST_GROUND * camera.z / steepest) if steepest > 0.0 < camera.z else NEAR


def flatten(points: Floats, camera: Camera) -> Flat:
    """Return planar convex polygons in the image.

    Args:
        points: (3, N, K) corners in camera axes, counter-clockwise or clockwise.
        camera: The camera.
    """
    count = points.shape[2]
    if not count:
        return Flat(np.empty(0, np.int64), [], np.empty((2, points.shape[1], 0)), np.empty(0, np.bool_))
    centre = np.array([camera.width / 2.0, camera.height / 2.0])[:, None, None]
    depth, nearest = points[2], near_plane(camera)
    if float(depth.min()) > nearest:
        pixels = points[:2] * (camera.focal / depth)
        if max(float(pixels.max()), -float(pixels.min())) < FARTHEST:
            pixels += centre
            return Flat(np.arange(count), list(_fixed(pixels)), pixels, np.ones(count, np.bool_))
    index = np.flatnonzero(depth.max(axis=0) > nearest)
    points, depth = points[:, :, index], depth[:, index]
    whole = depth.min(axis=0) > nearest
    pixels = points[:2] * (camera.focal / np.where(whole, depth, 1.0))
    whole &= np.abs(pixels).max(axis=(0, 1)) < FARTHEST
    pixels += centre
    shapes = list(_fixed(np.where(whole, pixels, 0.0)))
    cut = np.flatnonzero(~whole)
    if not len(cut):
        return Flat(index, shapes, pixels, whole)
    for k, shape in zip(cut.tolist(), _cut(points[:, :, cut], camera), strict=True):
        shapes[k] = shape
    kept = [k for k, shape in enumerate(shapes) if len(shape) > 2]
    return Flat(index[kept], [shapes[k] for k in kept], pixels[:, :, kept], whole[kept])


def _fixed(pixels: Floats) -> Polygon:
    """Return corners (2, N, K) in fixed point, (K, N, 2)."""
    scaled = np.rint(pixels * (1 << SUBPIXEL)).astype(np.int32)
    return np.ascontiguousarray(scaled.transpose(2, 1, 0))


def _cut(points: Floats, camera: Camera) -> list[Polygon]:
    """Return polygons (3, N, K), camera axes, clipped near the image's borders and at the near plane.

    A border is skipped if neither depths nor corners require it.
    """
    nearest = near_plane(camera)
    across = (camera.width / 2.0 + MARGIN) / camera.focal
    down = (camera.height / 2.0 + MARGIN) / camera.focal
    count = np.full(points.shape[2], points.shape[1])
    for plane in ((0.0, -1.0, down), (0.0, 1.0, down), (-1.0, 0.0, across), (1.0, 0.0, across), (0.0, 0.0, 1.0)):
        depth = points[2]
        if depth.min() > nearest and (np.abs(points[:2]).max(axis=0) * camera.focal < FARTHEST * depth).all():
            break
        inside = plane[0] * points[0] + plane[1] * points[1] + plane[2] * depth
        points, count = clip(points, inside - nearest if plane[2] == 1.0 else inside, count)
    pixels = points[:2] * (camera.focal / np.maximum(points[2], nearest))
    pixels += np.array([camera.width / 2.0, camera.height / 2.0])[:, None, None]
    return [shape[:corners] for shape, corners in zip(_fixed(pixels), count.tolist(), strict=True)]


def clip(points: Floats, inside: Floats, count: Index) -> tuple[Floats, Index]:
    """Clip convex polygons by a plane.

    Args:
        points: (D, N, K) corners; each polygon's own are the first `count`, and the others repeat its last.
        inside: (N, K) distance of each corner from the plane, positive on the side that is kept.
        count: (K,) numbers of corners.

    Returns:
        The corners (D, N + 1, K), in the same order, and their numbers (K,), 0 if nothing is left.
    """
    size, total = inside.shape
    following = np.arange(1, size + 1)[:, None]
    following = np.where(following < count, following, 0)
    columns = np.arange(total)
    kept = inside > 0.0
    inside_after = inside[following, columns]
    crossed = kept != (inside_after > 0.0)
    own = np.arange(size)[:, None] < count
    share = inside / np.where(crossed, inside - inside_after, 1.0)
    corners = np.stack([points, points + share * (points[:, following, columns] - points)], axis=2)
    chosen = np.stack([kept & own, crossed & own], axis=1).reshape(2 * size, total)
    order = np.argsort(~chosen, axis=0, kind="stable")
    count = chosen.sum(axis=0)
    order = order[np.minimum(np.arange(size + 1)[:, None], np.maximum(count - 1, 0)), columns]
    return corners.reshape(len(points), 2 * size, total)[:, order, columns], count


def thickness(pixels: Floats) -> Floats:
    """Return the area divided by the longest side of quadrilaterals (2, 4, K), pixels."""
    across, along = pixels[:, 2] - pixels[:, 0], pixels[:, 3] - pixels[:, 1]
    area = 0.5 * np.abs(across[0] * along[1] - across[1] * along[0])
    sides = pixels - pixels[:, (1, 2, 3, 0)]
    longest = np.sqrt((sides * sides).sum(axis=0).max(axis=0, initial=0.0))
    return np.asarray(area / np.maximum(longest, 1e-6))


def facing(points: Floats) -> NDArray[np.bool_]:
    """Return which polygons (3, N, K), camera axes, show the side from which their corners are counter-clockwise."""
    normal = _cross(points[:, 1] - points[:, 0], points[:, -1] - points[:, 0])
    return np.asarray((normal * points[:, 0]).sum(axis=0) < 0.0)


def nearness_planes(points: Floats) -> Floats:
    """Return for planar polygons (3, N, K), camera axes, the (3, K) coefficients of 1 / depth.

    If a polygon's plane is seen at (x, y) = (right / depth, down / depth), then 1 / depth = a x + b y + c, because the
    points p of a plane satisfy n . p = d. For planes through the lens, which are seen edge-on, d is taken as 1e-6.
    """
    one = _cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    other = _cross(points[:, 2] - points[:, 0], points[:, -1] - points[:, 0])
    normal = np.where((one * one).sum(axis=0) >= (other * other).sum(axis=0), one, other)
    normal = normal / np.sqrt(np.maximum((normal * normal).sum(axis=0), 1e-30))
    distance = (normal * points[:, 0]).sum(axis=0)
    return np.asarray(normal / np.where(np.abs(distance) < 1e-6, 1e-6, distance))


def _cross(a: Floats, b: Floats) -> Floats:
    """Return the cross products of vectors (3, K)."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])
