"""Everybody else on the road, as a few boxes each, with a soft shadow."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View
from scenario_compiler.perception.scene import SUBPIXEL, Polygon, project_polygon
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]
Colour = tuple[int, int, int]
Corners = NDArray[np.float64]

REACH = 200.0
"""Boxes farther away than this are not drawn, m."""


Kind = Literal["vehicle", "van", "cycle", "pedestrian", "cone", "barrier", "sign", "object"]
"""What a box is drawn as: a car, anything with a box for a body, a rider on two wheels, a person, and things."""


class Box(NamedTuple):
    """A thing that stands or moves on the road.

    Attributes:
        x: Centre of its footprint, m, world.
        y: Centre of its footprint, m, world.
        z: Height of its underside, m, world.
        heading: Where its front points, rad.
        length: Along the heading, m.
        width: Across it, m.
        height: Upwards, m.
        colour: (blue, green, red), 0-255.
        kind: What it is drawn as.
    """

    x: float
    y: float
    z: float
    heading: float
    length: float
    width: float
    height: float
    colour: Colour = (150, 80, 60)
    kind: Kind = "vehicle"


class Face(NamedTuple):
    """A visible face of a box: four corners (4, 3) in the world, its colour before lighting, its shade."""

    corners: Corners
    colour: Colour
    shade: float


def draw_shadows(image: Image, top: int, view: View, boxes: Sequence[Box], look: Look) -> None:
    """Darken the ground under each box; `image` starts at row `top` of the frame."""
    strength = 0.6 * (1.0 - 0.7 * look.cloud) / 255.0
    shift = np.array((0, -top << SUBPIXEL), np.int32)
    height, width = image.shape[:2]
    for box in boxes:
        polygon = project_polygon(view, _rectangle(box, 0.0, 1.12))
        if polygon is None:
            continue
        polygon = polygon + shift
        x0, y0 = np.maximum((polygon.min(axis=0) >> SUBPIXEL) - 8, 0).tolist()
        x1, y1 = np.minimum((polygon.max(axis=0) >> SUBPIXEL) + 9, (width, height)).tolist()
        if x1 - x0 < 2 or y1 - y0 < 2:
            continue
        mask = np.zeros((y1 - y0, x1 - x0), np.uint8)
        corner = np.array((x0, y0), np.int32) << SUBPIXEL
        cv2.fillConvexPoly(mask, polygon - corner, 255, cv2.LINE_AA, SUBPIXEL)
        dark = 1.0 - cv2.blur(mask, (5, 3)).astype(np.float32) * strength
        image[y0:y1, x0:x1] = (image[y0:y1, x0:x1] * dark[..., None]).astype(np.uint8)


def draw_boxes(image: Image, view: View, boxes: Sequence[Box], look: Look) -> list[tuple[Polygon, float]]:
    """Draw the boxes, given from far to near, and return their outlines with their distances, m, for the haze."""
    silhouettes = []
    light = look.luminance * look.tint
    lamps = look.luminance < 0.35 or look.rain > 0.3
    for box in boxes:
        corners: list[Polygon] = []
        distance = math.dist((box.x, box.y), (float(view.position[0]), float(view.position[1])))
        beam = 0.5 * max(0.0, 1.0 - look.luminance) * math.exp(-((distance / 40.0) ** 2))
        for face in _faces(box, lamps):
            away = np.cross(face.corners[1] - face.corners[0], face.corners[3] - face.corners[0])
            if away @ (face.corners[0] - view.position) >= 0.0:
                continue
            polygon = project_polygon(view, face.corners)
            if polygon is None:
                continue
            gain = np.float32(face.shade) * (light + beam) if face.shade < 2.0 else np.float32(1.0)
            tone = np.clip(np.asarray(face.colour, np.float32) * gain, 0, 255)
            cv2.fillConvexPoly(image, polygon, tuple(float(c) for c in tone), cv2.LINE_AA, SUBPIXEL)
            corners.append(polygon)
        if corners:
            silhouettes.append((np.asarray(cv2.convexHull(np.concatenate(corners)), np.int32), distance))
    return silhouettes


def far_to_near(view: View, boxes: Sequence[Box]) -> list[Box]:
    """Return the boxes within `REACH` of the camera, the farthest first, equals in the order given."""
    x, y = float(view.position[0]), float(view.position[1])
    near = [(math.dist((box.x, box.y), (x, y)), box) for box in boxes]
    return [box for distance, box in sorted(near, key=lambda pair: -pair[0]) if distance < REACH]


LIT = 2.0
"""Shade of a face that shines by itself."""


WHITE, RED, ORANGE, YELLOW = (225, 225, 225), (40, 40, 200), (30, 95, 235), (20, 190, 245)
DARK, SKIN, CLOTH = (28, 28, 28), (130, 160, 205), (70, 60, 50)
ALL = (-0.5, 0.5)


def _faces(box: Box, lamps: bool) -> Iterator[Face]:
    if box.kind == "object":
        yield from _block(box, ALL, ALL, (0.0, 1.0), box.colour)
    elif box.kind == "pedestrian":
        yield from _block(box, (-0.3, 0.3), (-0.35, 0.35), (0.0, 0.48), CLOTH)
        yield from _block(box, (-0.35, 0.35), ALL, (0.48, 0.85), box.colour)
        yield from _block(box, (-0.25, 0.25), (-0.22, 0.22), (0.86, 1.0), SKIN)
    elif box.kind == "cycle":
        yield from _cycle(box)
    elif box.kind == "cone":
        yield from _cone(box)
    elif box.kind == "barrier":
        yield from _barrier(box)
    elif box.kind == "sign":
        yield from _sign(box)
    elif box.kind == "van":
        yield from _van(box, lamps)
    else:
        yield from _car(box, lamps)


def _car(box: Box, lamps: bool) -> Iterator[Face]:
    belt = 0.55
    for axle in (-0.31, 0.31):
        yield from _block(box, (axle - 0.075, axle + 0.075), (-0.49, 0.49), (0.0, 0.42), DARK)
    yield from _block(box, ALL, ALL, (0.15, belt), box.colour)
    yield from _lights(box, belt, lamps)
    roof = list(_block(box, (-0.38, 0.24), (-0.47, 0.47), (belt, 1.0), (70, 60, 52)))
    yield from roof[:4]
    yield Face(roof[4].corners, box.colour, roof[4].shade)


def _van(box: Box, lamps: bool) -> Iterator[Face]:
    """Van, truck or bus: one box on wheels with a band of windows in front and at the sides."""
    for axle in (-0.31, 0.36):
        yield from _block(box, (axle - 0.06, axle + 0.06), (-0.49, 0.49), (0.0, 0.26), DARK)
    yield from _block(box, ALL, ALL, (0.1, 0.5), box.colour)
    yield from _lights(box, 0.34, lamps)
    band = list(_block(box, ALL, ALL, (0.5, 0.78), (70, 60, 52)))
    yield Face(band[0].corners, box.colour, band[0].shade)
    yield from band[1:4]
    yield from _block(box, ALL, ALL, (0.78, 1.0), box.colour)


def _cycle(box: Box) -> Iterator[Face]:
    """Two wheels, a frame and the rider on it."""
    for middle in (-0.33, 0.33):
        yield from _block(box, (middle - 0.17, middle + 0.17), (-0.06, 0.06), (0.0, 0.36), DARK)
    yield from _block(box, (-0.3, 0.3), (-0.08, 0.08), (0.22, 0.42), box.colour)
    yield from _block(box, (0.2, 0.28), ALL, (0.54, 0.58), DARK)
    yield from _block(box, (-0.16, 0.08), (-0.22, 0.22), (0.28, 0.55), CLOTH)
    yield from _block(box, (-0.16, 0.06), (-0.32, 0.32), (0.55, 0.86), box.colour)
    yield from _block(box, (-0.08, 0.08), (-0.16, 0.16), (0.86, 1.0), SKIN)


def _cone(box: Box) -> Iterator[Face]:
    """Foot, and a cone of four steps with a white collar."""
    yield from _block(box, ALL, ALL, (0.0, 0.06), DARK)
    for half, low, high, colour in (
        (0.36, 0.06, 0.32, ORANGE), (0.28, 0.32, 0.55, WHITE), (0.2, 0.55, 0.78, ORANGE), (0.12, 0.78, 1.0, ORANGE),
    ):  # fmt: skip
        yield from _block(box, (-half, half), (-half, half), (low, high), colour)


def _barrier(box: Box) -> Iterator[Face]:
    """Two feet and a board striped in red and white."""
    for middle in (-0.4, 0.4):
        yield from _block(box, (middle - 0.05, middle + 0.05), ALL, (0.0, 0.5), DARK)
    for k in range(6):
        stripe = (-0.5 + k / 6, -0.5 + (k + 1) / 6)
        yield from _block(box, stripe, (-0.2, 0.2), (0.5, 1.0), RED if k % 2 == 0 else WHITE)


def _sign(box: Box) -> Iterator[Face]:
    """A stand with a board across the heading: red rim, yellow field."""
    yield from _block(box, (-0.06, 0.06), (-0.06, 0.06), (0.0, 0.45), DARK)
    yield from _block(box, (-0.03, 0.03), ALL, (0.45, 1.0), RED)
    for side in (-0.035, 0.03):
        yield from _block(box, (side, side + 0.005), (-0.38, 0.38), (0.52, 0.93), YELLOW)


def _lights(box: Box, belt: float, lamps: bool) -> Iterator[Face]:
    """Rear and front lamps, a little proud of the body."""
    for side in (-1.0, 1.0):
        low, high = sorted((side * 0.30, side * 0.46))
        span, z = (low, high), (belt * 0.70, belt * 0.92)
        rear, *_ = _block(box, (-0.505, -0.5), span, z, (40, 40, 255) if lamps else (30, 30, 190))
        _, front, *_ = _block(box, (0.5, 0.505), span, z, (235, 235, 235))
        yield Face(rear.corners, rear.colour, LIT if lamps else 1.0)
        yield Face(front.corners, front.colour, LIT if lamps else 1.0)


def _block(
    box: Box, along: tuple[float, float], across: tuple[float, float], up: tuple[float, float], colour: Colour
) -> Iterator[Face]:
    """Yield the back, front, right, left and top of a part of the box given in shares of its size.

    Corners run so that the cross product of the first and last edge points out of the block.
    """
    (a0, a1), (c0, c1), (z0, z1) = along, across, up
    low, high = _part(box, a0, a1, c0, c1, z0), _part(box, a0, a1, c0, c1, z1)
    for (i, j), shade in (((3, 0), 0.72), ((1, 2), 0.78), ((0, 1), 0.88), ((2, 3), 0.88)):
        yield Face(np.array([low[i], low[j], high[j], high[i]]), colour, shade)
    yield Face(high, colour, 1.1)


def _part(box: Box, a0: float, a1: float, c0: float, c1: float, z: float) -> Corners:
    """Return rear right, front right, front left, rear left of a level slice."""
    along = np.array([a0, a1, a1, a0]) * box.length
    across = np.array([c0, c0, c1, c1]) * box.width
    cos, sin = math.cos(box.heading), math.sin(box.heading)
    x, y = box.x + cos * along - sin * across, box.y + sin * along + cos * across
    return np.stack([x, y, np.full(4, box.z + z * box.height)], axis=1)


def _rectangle(box: Box, z: float, scale: float) -> Corners:
    half = scale / 2.0
    return _part(box, -half, half, -half, half, z)
