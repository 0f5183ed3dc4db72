"""Everything upright: others on the road, and poles, signs, walls, buildings and trees beside it.

Faces of all of them are drawn from far to near, those of one model in its own order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import View
from scenario_compiler.perception.ground import Spot, Spots, Traced, hidden
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.lighting import Air, Light
from scenario_compiler.perception.models import SHINES, TAG, TRAITS, Colour, Kind, Lamp, model_of, traits_of
from scenario_compiler.perception.polygons import SUBPIXEL, Floats, Index, Polygon, flatten
from scenario_compiler.perception.roadside import GREEN_LAMP, RED_LAMP, YELLOW_LAMP, lit_lamps
from scenario_compiler.perception.scene import Scene, Seen, Uprights
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]

REACH = 200.0
"""Distance up to which all boxes are drawn, m, and the greatest one on hilly maps, whose ground ends little farther."""

FAR_REACH, LEAST_SIZE = 400.0, 2.0
"""Distance up to which boxes are drawn on flat maps, m, if they are at least so many pixels wide or high."""

COARSE = 32.0
"""Height below which a box is drawn without details, pixels."""

SIGNAL_COLOURS = {RED_LAMP: (70, 70, 255), YELLOW_LAMP: (50, 200, 255), GREEN_LAMP: (140, 245, 70)}
"""Colours of the lamps of traffic lights when they are lit."""

LIT = frozenset({"car", "van", "truck", "bus", "motorbike"})
"""Kinds whose headlights light the road."""

BEAM = (8.0, 16.0, 28.0)
"""Lengths of the cones that form the light of headlights on the road, m."""

DARK, RAINY = 0.35, 0.3
"""Luminance below which, and rain above which, drivers have their lights on."""


class Box(NamedTuple):
    """A thing on the road.

    Attributes:
        x: Centre of its footprint, m, world.
        y: Centre of its footprint, m, world.
        z: Height of its underside there, m, world.
        heading: Direction of its front, rad.
        length: Along the heading, m.
        width: Across it, m.
        height: Upwards, m.
        colour: (blue, green, red), 0-255.
        kind: What it is drawn as.
        pitch: Pitch, rad, positive with the nose down.
        roll: Roll, rad, positive with the left side up.
        lamps: Which lamps are on.
        instance: Its number in the picture of instances, above 0.
        tag: What it is labelled as; None for what things of its kind are.
    """

    x: float
    y: float
    z: float
    heading: float
    length: float
    width: float
    height: float
    colour: Colour = (150, 80, 60)
    kind: Kind = "car"
    pitch: float = 0.0
    roll: float = 0.0
    lamps: Lamp = Lamp.AUTOMATIC
    instance: int = 1
    tag: Tag | None = None


@dataclass(frozen=True, eq=False)
class Placed:
    """Boxes in front of a camera, from far to near. N boxes.

    Attributes:
        boxes: The boxes.
        distance: (N,) distance of each one's centre from the eye, m.
        level_distance: (N,) the same in the horizontal plane, which determines the order of uprights.
        rotations: (N, 3, 3) rotations from each one's axes to the camera's.
        origins: (N, 3) centre of each one's footprint in camera axes, m.
        eyes: (N, 3) the eye in each one's axes, m.
    """

    boxes: list[Box]
    distance: Floats
    level_distance: Floats
    rotations: Floats
    origins: Floats
    eyes: Floats


@dataclass(frozen=True, eq=False)
class Faces:
    """Faces in drawing order. F faces.

    Attributes:
        shapes: Their corners in the image.
        points: (3, 4, F) corners in camera axes.
        colours: (F, 3) colours before lighting, including shade.
        shines: (F,) bool, whether the face is a lamp that is on.
        tags: (F,) uint8, a `Tag`.
        instances: (F,) int32.
    """

    shapes: list[Polygon]
    points: Floats
    colours: Floats
    shines: NDArray[np.bool_]
    tags: NDArray[np.uint8]
    instances: NDArray[np.int32]


NO_FACES = Faces(
    [],
    np.empty((3, 4, 0)),
    np.empty((0, 3)),
    np.empty(0, np.bool_),
    np.empty(0, np.uint8),
    np.empty(0, np.int32),
)


NOTHING = Placed([], np.empty(0), np.empty(0), np.empty((0, 3, 3)), np.empty((0, 3)), np.empty((0, 3)))


def place(view: View, boxes: Sequence[Box], reach: float = FAR_REACH) -> Placed:
    """Return the boxes in front of the camera, the farthest first, equal ones in the given order.

    Args:
        view: The camera in the world.
        boxes: The boxes.
        reach: Distance up to which large ones are placed, m.
    """
    if not boxes:
        return NOTHING
    half = math.hypot(view.camera.width, view.camera.height) / 2.0 / view.camera.focal
    numbers = np.array([box[:7] + box[9:11] for box in boxes], np.float64).reshape(-1, 9).T
    way = numbers[:3] - view.position[:, None]
    away = way.copy()
    away[2] += 0.5 * numbers[6]
    distance = np.sqrt((away * away).sum(axis=0))
    size = 0.5 * numbers[4:7].sum(axis=0)
    depth = view.rotation[2] @ away
    beside = np.sqrt(np.maximum(distance * distance - depth * depth, 0.0))
    large = numbers[5:7].max(axis=0) * view.camera.focal > LEAST_SIZE * distance
    seen = ((distance - size < REACH) | (large & (distance < reach))) & (depth > -size)
    seen &= beside < np.maximum(depth, 0.0) * half + size * math.hypot(1.0, half)
    level = np.sqrt((way[:2] * way[:2]).sum(axis=0))
    kept = np.flatnonzero(seen)
    kept = kept[np.argsort(-level[kept], kind="stable")]
    axes = _axes(*numbers[[3, 7, 8]][:, kept])
    from_eye = way[:, kept].T
    return Placed(
        [boxes[k] for k in kept.tolist()],
        distance[kept],
        level[kept],
        view.rotation @ axes,
        from_eye @ view.rotation.T,
        -(from_eye[:, None] @ axes)[:, 0],
    )


def _axes(heading: Floats, pitch: Floats, roll: Floats) -> Floats:
    """Return the (N, 3, 3) matrices of `camera.vehicle_axes` for N things at once."""
    ch, sh, cp, sp, cr, sr = (wave(angle) for angle in (heading, pitch, roll) for wave in (np.cos, np.sin))
    axes = np.empty((len(heading), 3, 3))
    axes[:, 0, 0], axes[:, 0, 1], axes[:, 0, 2] = ch * cp, ch * sp * sr - sh * cr, ch * sp * cr + sh * sr
    axes[:, 1, 0], axes[:, 1, 1], axes[:, 1, 2] = sh * cp, sh * sp * sr + ch * cr, sh * sp * cr - ch * sr
    axes[:, 2, 0], axes[:, 2, 1], axes[:, 2, 2] = -sp, cp * sr, cp * cr
    return axes


def faces_of(
    placed: Placed, traced: Traced, uprights: Seen, scene: Scene, look: Look, signals: Mapping[str, str]
) -> Faces:
    """Return the visible faces of boxes and of uprights, from far to near.

    Args:
        placed: The boxes.
        traced: The ground, which hides things behind it.
        uprights: The visible uprights.
        scene: Their scene.
        look: The weather, which determines the lamps.
        signals: States of traffic lights by their id, as scenarios write them.
    """
    if not placed.boxes and not len(uprights.index):
        return NO_FACES
    view, table = traced.view, scene.uprights
    points, traits, counts = [np.empty((3, 4, 0))], [np.empty((0, TRAITS))], []
    drivers = Lamp.LOW_BEAM if look.luminance < DARK or look.rain > RAINY else Lamp.NONE
    near = (view.camera.focal / COARSE / np.maximum(placed.distance, 1e-3)).tolist()
    for box, size, rotation, origin, eye in zip(
        placed.boxes, near, placed.rotations, placed.origins, placed.eyes, strict=True
    ):
        coarse = size * box.height < 1.0
        model = model_of(box.kind, box.length, box.width, box.height, coarse)
        lamps = box.lamps | drivers if box.lamps & Lamp.AUTOMATIC else box.lamps
        order = model.rear_first if eye[0] >= 0.0 else model.front_first
        shown = order[(eye @ model.normals > model.offsets)[order]]
        corners = rotation @ model.points[:, :, shown].reshape(3, -1) + origin[:, None]
        points.append(corners.reshape(3, 4, -1))
        size_of_box = (box.length, box.width, box.height)
        traits.append(traits_of(box.kind, *size_of_box, box.colour, lamps, coarse, box.tag)[shown])
        counts.append(len(shown))
    every = np.concatenate(points, axis=2)
    flat = flatten(every, view.camera)
    here, there = flat.index, uprights.index
    corners = np.concatenate([every[:, :, here], uprights.points], axis=2)
    far = np.concatenate([np.repeat(placed.level_distance, counts)[here], _upright_distances(table, there, view)])
    order = np.argsort(-far, kind="stable")
    if traced.hides and len(order):
        order = order[~hidden(traced, corners[:, :, order])]
    shapes = [*flat.shapes, *uprights.shapes]
    of_boxes = np.concatenate(traits)[here]
    of_uprights, lit = _signal_lamps(table, there, signals)
    numbers = np.repeat(np.array([box.instance for box in placed.boxes], np.int32), counts)[here]
    return Faces(
        [shapes[k] for k in order.tolist()],
        corners[:, :, order],
        np.concatenate([of_boxes[:, :3], of_uprights])[order],
        np.concatenate([of_boxes[:, SHINES] > 0.0, lit])[order],
        np.concatenate([of_boxes[:, TAG].astype(np.uint8), table.tag[there]])[order],
        np.concatenate([numbers, table.instance[there]])[order],
    )


def _upright_distances(table: Uprights, index: Index, view: View) -> Floats:
    """Return the distances of uprights from the eye in the horizontal plane, which determine the drawing order.

    A wall below a ceiling is in front of the parts of the ceiling that it hides, so a ceiling counts by its farthest
    corner, and is drawn before all walls below it.
    """
    eye = view.position[:2] - table.origin[:2]
    beside = table.place[index] - eye
    distance = np.sqrt((beside * beside).sum(axis=1))
    over = np.flatnonzero(table.overhead[index])
    if len(over):
        corners = table.quads[index[over], :, :2] - eye
        distance[over] = np.sqrt((corners * corners).sum(axis=2).max(axis=1))
    return np.asarray(distance, np.float64)


def _signal_lamps(table: Uprights, index: Index, signals: Mapping[str, str]) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the colours of uprights and which of them are shining lamps, in these states of the traffic lights."""
    colours, shines = table.colour[index], np.zeros(len(index), np.bool_)
    for name, state in signals.items():
        for number in table.signals.get(name, ()):
            for lamp in lit_lamps(state):
                lit = (table.instance[index] == number) & (table.lamp[index] == lamp)
                colours[lit], shines[lit] = SIGNAL_COLOURS[lamp], True
    return colours, shines


def draw_faces(image: Image, view: View, faces: Faces, light: Light, air: Air) -> None:
    """Draw faces into an image (height, width, 4)."""
    if not faces.shapes:
        return
    camera_to_vehicle = view.camera.rotation.T
    middle = faces.points.mean(axis=1)
    distance = np.sqrt((middle * middle).sum(axis=0)).astype(np.float32)
    ahead, left, _ = (camera_to_vehicle @ middle).astype(np.float32)
    bright = light.at(ahead, left)[:, None] * light.look.tint
    lit = np.where(faces.shines[:, None], faces.colours, faces.colours * bright)
    seen = air.seen(distance)[:, None]
    tones = np.clip(np.minimum(lit, 255.0) * seen + air.colour * (1.0 - seen), 0, 255)
    dark = 1.0 - light.look.luminance / DARK
    blooming = faces.shines.tolist() if dark > 0.0 else [False] * len(faces.shapes)
    for shape, tone, blooms in zip(faces.shapes, tones.tolist(), blooming, strict=True):
        cv2.fillConvexPoly(image, shape, tone, cv2.LINE_AA, SUBPIXEL)
        if blooms:
            _bloom(image, shape, tone, dark)


def spots_of(placed: Placed, traced: Traced, light: Light) -> Spots:
    """Return the soft shadows of boxes on the ground below them, and in the dark the light of their headlights."""
    if not placed.boxes:
        return Spots()
    foot = np.array([[-0.56, 0.56, 0.56, -0.56], [-0.56, -0.56, 0.56, 0.56]])
    sizes = np.array([(box.length, box.width) for box in placed.boxes])
    corners = placed.rotations[:, :, :2] @ (foot * sizes[:, :, None]) + placed.origins[:, :, None]
    left = 1.0 - 0.6 * (1.0 - 0.7 * light.look.cloud)
    return Spots(_spots(corners.transpose(1, 2, 0), traced, left), _beams(placed, traced, light))


def _spots(corners: Floats, traced: Traced, strength: float) -> list[Spot]:
    """Return polygons (3, 4, K), camera axes, that lie on the ground, without those that a hill hides."""
    if traced.hides:
        corners = corners[:, :, ~hidden(traced, corners)]
    return [(shape, strength) for shape in flatten(corners, traced.view.camera).shapes]


def _beams(placed: Placed, traced: Traced, light: Light) -> list[Spot]:
    """Return the light of headlights on the road: three overlapping cones, so that it fades with distance."""
    if light.lamps <= 0.0:
        return []
    corners = []
    for box, rotation, origin in zip(placed.boxes, placed.rotations, placed.origins, strict=True):
        if box.kind in LIT and box.lamps & (Lamp.AUTOMATIC | Lamp.LOW_BEAM | Lamp.HIGH_BEAM):
            begin = 0.5 * box.length + 0.8
            for reach in BEAM:
                near, far = 0.6 * box.width, 0.6 * box.width + 0.14 * reach
                cone = np.array([[begin, begin, begin + reach, begin + reach], [near, -near, -far, far], [0.0] * 4])
                corners.append(rotation @ cone + origin[:, None])
    return _spots(np.stack(corners, axis=2), traced, 0.3 * light.lamps) if corners else []


def _bloom(image: Image, shape: Polygon, tone: Sequence[float], strength: float) -> None:
    """Add the glow around a lamp that dazzles in the dark."""
    height, width = image.shape[:2]
    low, high = shape.min(axis=0) >> SUBPIXEL, shape.max(axis=0) >> SUBPIXEL
    radius = int(width / 128.0 + 0.9 * float((high - low).max()))
    u, v = ((low + high) // 2).tolist()
    x0, x1, y0, y1 = max(u - radius, 0), min(u + radius + 1, width), max(v - radius, 0), min(v + radius + 1, height)
    if x1 <= x0 or y1 <= y0 or radius > width // 4:
        return
    glow = _glow(radius)[y0 - v + radius : y1 - v + radius, x0 - u + radius : x1 - u + radius, None]
    part = image[y0:y1, x0:x1]
    part[...] = cv2.add(
        part, (glow * (np.array((*tone, 0.0), np.float32) * np.float32(0.5 * strength))).astype(np.uint8)
    )


@lru_cache(maxsize=64)
def _glow(radius: int) -> NDArray[np.float32]:
    """Return the brightness of a glow around its centre, (2 radius + 1, 2 radius + 1): 1 there, 0 at the radius."""
    x = np.arange(-radius, radius + 1, dtype=np.float32) / np.float32(max(radius, 1))
    away = np.sqrt(x * x + x[:, None] * x[:, None])
    return np.asarray(np.square(np.clip(1.0 - away, 0.0, 1.0)), np.float32)
