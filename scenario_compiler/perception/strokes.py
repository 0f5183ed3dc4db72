"""Lines in the world that are not part of it, as simulators draw them for debugging.

A stroke has a width in metres and turns its broad side to the camera. Light and air do not affect it, but things in
front of it hide it. It is only in the picture: depth and labels do not contain it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View
from scenario_compiler.perception.polygons import NEAR, SUBPIXEL, Floats, flatten, nearness_planes

MOST = 60_000
"""Greatest number of strokes in a picture, because they are numbered with 16 bits."""

SUNK = 0.01
"""How much deeper than the scene at a pixel a stroke may be and still be visible, as a share of the depth, in addition
to half its width, so that one on a road is completely visible.
"""

Point = tuple[float, float, float]


class Stroke(NamedTuple):
    """A stroke, or a square if it begins and ends at the same point.

    Attributes:
        begin: Where it begins, m, world.
        end: Where it ends, m, world.
        width: Its width, m.
        colour: (blue, green, red), 0-255.
    """

    begin: Point
    end: Point
    width: float
    colour: tuple[int, int, int]


def draw_strokes(image: NDArray[np.uint8], depth: NDArray[np.float32], view: View, strokes: Sequence[Stroke]) -> None:
    """Draw strokes into a picture.

    Args:
        image: (height, width, 3), BGR; it is changed.
        depth: (height, width) of the scene without the strokes, m along the optical axis.
        view: The camera in the world.
        strokes: The strokes, of which the last `MOST` are drawn.
    """
    strokes = strokes[-MOST:]
    points = np.array([(*one.begin, *one.end) for one in strokes], np.float64).reshape(-1, 2, 3)
    ends = view.to_camera(points).transpose(1, 2, 0)
    seen = np.flatnonzero(ends[:, 2].max(axis=0) > NEAR)
    if not len(seen):
        return
    begin, end = _before_the_lens(ends[0][:, seen], ends[1][:, seen])
    corners = _broadside(begin, end, np.array([strokes[k].width for k in seen.tolist()]))
    flat = flatten(corners, view.camera)
    far = np.square(corners.mean(axis=1)).sum(axis=0)[flat.index]
    ids = np.zeros(depth.shape, np.uint16)
    for k in np.argsort(-far, kind="stable").tolist():
        cv2.fillConvexPoly(ids, flat.shapes[k], k + 1, cv2.LINE_8, SUBPIXEL)
    rows, columns = np.nonzero(ids)
    index = ids[rows, columns].astype(np.intp) - 1
    shown = corners[:, :, flat.index]
    plane = nearness_planes(shown)[:, index]
    camera = view.camera
    x, y = (columns - camera.width / 2.0) / camera.focal, (rows - camera.height / 2.0) / camera.focal
    near = 1.0 / np.maximum(shown[2], NEAR)
    nearness = np.clip(plane[0] * x + plane[1] * y + plane[2], near.min(axis=0)[index], near.max(axis=0)[index])
    sunk = np.array([0.5 * strokes[k].width for k in seen[flat.index].tolist()])[index]
    free = 1.0 / nearness - sunk < depth[rows, columns] * (1.0 + SUNK)
    colours = np.array([strokes[k].colour for k in seen[flat.index].tolist()], np.uint8).reshape(-1, 3)
    image[rows[free], columns[free]] = colours[index[free]]


def _before_the_lens(begin: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Return segments (3, K), camera axes, clipped at the near plane; each must extend in front of it."""
    gained = end[2] - begin[2]
    share = (NEAR - begin[2]) / np.where(np.abs(gained) < 1e-9, 1.0, gained)
    cut = begin + np.clip(share, 0.0, 1.0) * (end - begin)
    return np.where(begin[2] < NEAR, cut, begin), np.where(end[2] < NEAR, cut, end)


def _broadside(begin: Floats, end: Floats, width: Floats) -> Floats:
    """Return the corners (3, 4, K) of strokes whose broad sides face the lens."""
    along, middle = end - begin, 0.5 * (begin + end)
    length = np.sqrt((along * along).sum(axis=0))
    square = length < 1e-6
    along = np.where(square, np.array([[1.0], [0.0], [0.0]]), along / np.maximum(length, 1e-6))
    side = np.cross(along, middle, axis=0)
    size = np.sqrt((side * side).sum(axis=0))
    side = np.where(size < 1e-9, np.array([[0.0], [1.0], [0.0]]), side / np.maximum(size, 1e-9)) * (0.5 * width)
    beyond = np.where(square, along * (0.5 * width), 0.0)
    return np.stack([begin - beyond + side, end + beyond + side, end + beyond - side, begin - beyond - side], axis=1)
