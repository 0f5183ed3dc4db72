"""Everything that moves on the road, as faces: a car, a van, a truck, a bus, riders, a person, and obstacles.

A model is made once for a kind and a size. Its faces are listed so that each covers those before it, seen from outside;
parts one behind the other (a cab and its load) are groups, of which the farther one is drawn first. Sizes within a
model are shares of the box's. The shapes are simple, to be recognised at a glance, and not those of real vehicles.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import IntFlag
from functools import lru_cache
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.labels import Tag

Floats = NDArray[np.float64]
Span = tuple[float, float]
Colour = tuple[int, int, int]

Kind = Literal["car", "van", "truck", "bus", "motorbike", "bicycle", "pedestrian", "cone", "barrier", "sign", "prop"]
"""Model that a box is drawn as: one of the categories of entities."""


class Lamp(IntFlag):
    """Lamps of a vehicle that are on, with the numbers of CARLA's `VehicleLightState`.

    AUTOMATIC, which CARLA does not have, stands for low beams in the dark and in rain, as drivers switch them on.
    """

    NONE = 0
    POSITION = 1
    LOW_BEAM = 2
    HIGH_BEAM = 4
    BRAKE = 8
    RIGHT_BLINKER = 16
    LEFT_BLINKER = 32
    REVERSE = 64
    FOG = 128
    AUTOMATIC = 1 << 15


BODY = None
"""Tone of a face that has the colour of its box."""

WHITE, RED, ORANGE, YELLOW = (225, 225, 225), (40, 40, 200), (30, 95, 235), (20, 190, 245)
DARK, TYRE, RIM, GLASS = (28, 28, 28), (22, 22, 24), (120, 120, 122), (70, 60, 52)
SKIN, CLOTH = (130, 160, 205), (70, 60, 50)
ALL = (-0.5, 0.5)


class _Bulb(NamedTuple):
    """A lamp's colour when off and when on, and the lamp that switches it."""

    off: Colour
    on: Colour
    by: Lamp


_TAIL = Lamp.POSITION | Lamp.LOW_BEAM | Lamp.HIGH_BEAM
_BULBS = (
    _Bulb((225, 225, 225), (235, 250, 255), Lamp.LOW_BEAM | Lamp.HIGH_BEAM),
    _Bulb((30, 30, 150), (40, 40, 235), _TAIL),
    _Bulb((30, 30, 150), (110, 110, 255), Lamp.BRAKE),
    _Bulb((30, 80, 150), (30, 165, 255), Lamp.LEFT_BLINKER),
    _Bulb((30, 80, 150), (30, 165, 255), Lamp.RIGHT_BLINKER),
    _Bulb((200, 200, 200), (245, 245, 245), Lamp.REVERSE),
)
_HEAD, _REAR, _STOP, _LEFT, _RIGHT, _BACKING = range(1, len(_BULBS) + 1)
NO_BULB = 0


@dataclass(frozen=True, eq=False)
class Model:
    """Faces of a thing. F faces.

    Attributes:
        points: (3, 4, F) corners in the thing's axes, m: x ahead, y left, z up from the centre of its footprint;
            counter-clockwise as seen from outside.
        normals: (3, F) outward normals.
        offsets: (F,) distance of each face's plane from the origin along its normal, m.
        colours: (F, 3) blue, green, red before lighting; undefined for faces of the body.
        body: (F,) bool, whether the face has the colour of its box.
        shades: (F,) brightness of the face, from its slope.
        bulbs: (F,) number of its lamp, `NO_BULB` if it is not a lamp.
        tags: (F,) uint8, a `Tag`.
        rear_first: (F,) the faces in drawing order for an eye ahead of the thing's centre.
        front_first: (F,) the same for an eye behind it.
    """

    points: Floats
    normals: Floats
    offsets: Floats
    colours: Floats
    body: NDArray[np.bool_]
    shades: Floats
    bulbs: NDArray[np.int64]
    tags: NDArray[np.uint8]
    rear_first: NDArray[np.int64]
    front_first: NDArray[np.int64]


class _Face(NamedTuple):
    """A face in shares of the box's size: corners (4, 3), counter-clockwise as seen from outside.

    A detail is left out at a distance. A tag of None stands for that of the kind.
    """

    corners: Floats
    tone: Colour | None
    bulb: int = NO_BULB
    tag: Tag | None = None
    group: int = 0
    detail: bool = False


@lru_cache(maxsize=256)
def model_of(kind: Kind, length: float, width: float, height: float, coarse: bool = False) -> Model:
    """Return the model of a kind for the size of a box, m; a coarse one leaves out details for long distances."""
    make, tag = _KINDS[kind]
    faces = [face for face in make(length, height) if not (coarse and face.detail)]
    corners = np.stack([face.corners.T for face in faces], axis=2) * np.array([length, width, height])[:, None, None]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0], axis=0)
    normals /= np.maximum(np.linalg.norm(normals, axis=0), 1e-12)
    groups = np.array([face.group for face in faces])
    return Model(
        points=corners,
        normals=normals,
        offsets=(normals * corners[:, 0]).sum(axis=0),
        colours=np.array([face.tone or (0, 0, 0) for face in faces], np.float64),
        body=np.array([face.tone is BODY for face in faces]),
        shades=shade_of(normals),
        bulbs=np.array([face.bulb for face in faces]),
        tags=np.array([face.tag or tag for face in faces], np.uint8),
        rear_first=np.argsort(groups, kind="stable"),
        front_first=np.argsort(-groups, kind="stable"),
    )


def shade_of(normals: Floats) -> Floats:
    """Return the brightness of faces from their outward normals (3, F), (F,): 1.1 for a roof, 0.7 for a back."""
    return np.asarray(0.74 + 0.14 * np.abs(normals[1]) + 0.36 * np.maximum(normals[2], 0.0) + 0.04 * normals[0])


SHINES, TAG, TRAITS = 3, 4, 5
"""Columns of the traits of faces: blue, green and red in full light, then these two; and the number of columns."""


@lru_cache(maxsize=256)
def traits_of(
    kind: Kind,
    length: float,
    width: float,
    height: float,
    body: Colour,
    lamps: Lamp,
    coarse: bool = False,
    tag: Tag | None = None,
) -> Floats:
    """Return (F, TRAITS): colours of a model's faces in full light, whether they are lamps that shine, their tags.

    A tag stands for that of the kind; a rider keeps its own.
    """
    model = model_of(kind, length, width, height, coarse)
    of_bulbs, shine = _bulbs(lamps)
    colours = np.where(model.body[:, None], np.array(body, np.float64), model.colours)
    colours = np.where((model.bulbs != NO_BULB)[:, None], of_bulbs[model.bulbs], colours)
    shines = shine[model.bulbs]
    colours *= np.where(shines, 1.0, model.shades)[:, None]
    tags = model.tags if tag is None else np.where(model.tags == _KINDS[kind][1], tag, model.tags)
    return np.column_stack([colours, shines, tags])


def _bulbs(lamps: Lamp) -> tuple[Floats, NDArray[np.bool_]]:
    """Return the colour of each bulb (bulbs + 1, 3) and whether it shines (bulbs + 1,) with these lamps on."""
    colours, shines = np.zeros((len(_BULBS) + 1, 3)), np.zeros(len(_BULBS) + 1, np.bool_)
    for k, bulb in enumerate(_BULBS, 1):
        on = bool(lamps & bulb.by)
        colours[k], shines[k] = bulb.on if on else bulb.off, on
    if lamps & Lamp.BRAKE:
        colours[_REAR], shines[_REAR] = _BULBS[_STOP - 1].on, True
    elif lamps & _TAIL:
        colours[_STOP], shines[_STOP] = _BULBS[_REAR - 1].on, True
    return colours, shines


def _solid(
    along: Span,
    across: Span,
    up: Span,
    tone: Colour | None,
    *,
    top: Colour | Literal["same", "hidden"] | None = "same",
    top_along: Span | None = None,
    top_across: Span | None = None,
    tag: Tag | None = None,
    group: int = 0,
    detail: bool = False,
) -> Iterator[_Face]:
    """Yield the back, front, right, left and top of a block whose top may be smaller than its base."""
    low, high = _level(along, across, up[0]), _level(top_along or along, top_across or across, up[1])
    for i, j in ((3, 0), (1, 2), (0, 1), (2, 3)):
        yield _Face(np.array([low[i], low[j], high[j], high[i]]), tone, NO_BULB, tag, group, detail)
    if top != "hidden":
        yield _Face(high, tone if top == "same" else top, NO_BULB, tag, group, detail)


def _level(along: Span, across: Span, z: float) -> Floats:
    """Return the corners of a horizontal slice: rear right, front right, front left, rear left."""
    (rear, front), (right, left) = along, across
    return np.array([[rear, right, z], [front, right, z], [front, left, z], [rear, left, z]])


def _pane(
    x: float, across: Span, up: Span, tone: Colour | None, *, bulb: int = NO_BULB, group: int = 0, detail: bool = True
) -> _Face:
    """Return an upright face across the heading at x, which faces forwards if x is positive, else backwards."""
    left, right = (across[1], across[0]) if x < 0.0 else (across[0], across[1])
    corners = np.array([[x, left, up[0]], [x, right, up[0]], [x, right, up[1]], [x, left, up[1]]])
    return _Face(corners, tone, bulb, None, group, detail)


def _panel(along: Span, y: float, up: Span, tone: Colour | None, *, group: int = 0, detail: bool = True) -> _Face:
    """Return an upright face along the heading at y, which faces outwards."""
    begin, end = (along[0], along[1]) if y < 0.0 else (along[1], along[0])
    corners = np.array([[begin, y, up[0]], [end, y, up[0]], [end, y, up[1]], [begin, y, up[1]]])
    return _Face(corners, tone, NO_BULB, None, group, detail)


def _wheels(axles: tuple[float, ...], radius: Span) -> Iterator[_Face]:
    """Yield the discs of wheels on both sides: six corners each, with a rim. The radius is given along and up."""
    along, up = radius
    for x in axles:
        for y in (-0.504, 0.504):
            for low, high, foot, head in ((0.0, 1.0, 0.5, 1.0), (1.0, 2.0, 1.0, 0.5)):
                flip = 1.0 if y < 0.0 else -1.0
                corners = [
                    [x + flip * side * half * along, y, z * up]
                    for side, half, z in ((-1, foot, low), (1, foot, low), (1, head, high), (-1, head, high))
                ]
                yield _Face(np.array(corners), TYRE, detail=True)
            yield _panel((x - 0.45 * along, x + 0.45 * along), 1.004 * y, (0.55 * up, 1.45 * up), RIM)


def _tail(up: Span, width: Span = (0.26, 0.47)) -> Iterator[_Face]:
    """Yield the rear lamps of both sides: tail, brake, blinker."""
    inner, outer = width
    step = (outer - inner) / 3.0
    for side, blinker in ((1.0, _LEFT), (-1.0, _RIGHT)):
        for k, bulb in enumerate((_STOP, _REAR, blinker)):
            a, b = sorted((side * (inner + k * step), side * (inner + (k + 1) * step)))
            yield _pane(-0.506, (a, b), up, RED, bulb=bulb, detail=bulb is not _REAR)


def _front(up: Span, width: Span = (0.28, 0.46), x: float = 0.506, group: int = 0) -> Iterator[_Face]:
    """Yield the headlamps and blinkers of both sides."""
    inner, outer = width
    middle = outer - (outer - inner) / 4.0
    for side, blinker in ((1.0, _LEFT), (-1.0, _RIGHT)):
        for begin, end, bulb in ((inner, middle, _HEAD), (middle, outer, blinker)):
            a, b = sorted((side * begin, side * end))
            yield _pane(x, (a, b), up, WHITE, bulb=bulb, group=group, detail=bulb is blinker)


def _car(length: float, height: float) -> Iterator[_Face]:
    yield from _solid((-0.44, 0.44), (-0.46, 0.46), (0.04, 0.26), DARK, top="hidden")
    yield from _solid(ALL, ALL, (0.18, 0.56), BODY, top_along=(-0.49, 0.47), top_across=(-0.48, 0.48))
    yield from _wheels((-0.3, 0.32), (0.33 / length, 0.33 / height))
    yield _pane(0.504, (-0.24, 0.24), (0.24, 0.38), DARK)
    yield _pane(-0.504, (-0.14, 0.14), (0.27, 0.36), WHITE)
    yield from _tail((0.38, 0.51))
    yield from _front((0.38, 0.49))
    cabin = {"top_along": (-0.31, 0.06), "top_across": (-0.39, 0.39)}
    yield from _solid((-0.43, 0.2), (-0.46, 0.46), (0.56, 1.0), GLASS, top=BODY, **cabin)  # type: ignore[arg-type]


def _van(length: float, height: float) -> Iterator[_Face]:
    yield from _solid((-0.46, 0.46), (-0.46, 0.46), (0.04, 0.2), DARK, top="hidden")
    yield from _solid(ALL, ALL, (0.12, 0.5), BODY)
    yield from _wheels((-0.3, 0.34), (0.36 / length, 0.36 / height))
    yield _pane(0.504, (-0.3, 0.3), (0.18, 0.32), DARK)
    yield _pane(-0.504, (-0.13, 0.13), (0.2, 0.26), WHITE)
    yield from _tail((0.3, 0.44), (0.34, 0.48))
    yield from _front((0.3, 0.4))
    back, front, right, left, top = _solid(ALL, ALL, (0.5, 1.0), BODY, top_along=(-0.5, 0.36), top_across=(-0.47, 0.47))
    yield from (back, front._replace(tone=GLASS), right, left, top)
    for side in (-0.506, 0.506):
        yield _panel((0.12, 0.38), side, (0.52, 0.76), GLASS)
    for window in ((-0.42, -0.03), (0.03, 0.42)):
        yield _pane(-0.506, window, (0.58, 0.88), GLASS)


def _truck(length: float, height: float) -> Iterator[_Face]:
    behind = 0.5 - min(2.3 / length, 0.4)
    yield from _solid((-0.48, 0.48), (-0.44, 0.44), (0.08, 0.26), DARK, top="hidden")
    yield from _wheels((-0.38, -0.26, 0.36), (0.48 / length, 0.48 / height))
    yield from _solid((-0.5, behind - 0.02), ALL, (0.26, 1.0), BODY)
    yield from _tail((0.14, 0.22), (0.3, 0.48))
    cab, windscreen = (behind, 0.5), (0.42, 0.72)
    yield from _solid(cab, (-0.48, 0.48), (0.1, 0.82), BODY, top_along=(behind, 0.48), group=1)
    yield _pane(0.506, (-0.43, 0.43), windscreen, GLASS, group=1, detail=False)
    yield _pane(0.506, (-0.36, 0.36), (0.2, 0.36), DARK, group=1)
    yield from _front((0.14, 0.2), group=1)
    for side in (-0.49, 0.49):
        yield _panel((behind + 0.03, 0.47), side, windscreen, GLASS, group=1)


def _bus(length: float, height: float) -> Iterator[_Face]:
    yield from _solid((-0.48, 0.48), (-0.46, 0.46), (0.04, 0.14), DARK, top="hidden")
    yield from _solid(ALL, ALL, (0.1, 1.0), BODY)
    yield from _wheels((-0.28, 0.3), (0.48 / length, 0.48 / height))
    for side in (-0.504, 0.504):
        yield _panel((-0.47, 0.47), side, (0.46, 0.84), GLASS, detail=False)
        for k in range(1, 6):
            yield _panel((-0.47 + 0.157 * k - 0.006, -0.47 + 0.157 * k + 0.006), 1.004 * side, (0.46, 0.84), BODY)
    yield _pane(0.504, (-0.46, 0.46), (0.36, 0.86), GLASS, detail=False)
    yield _pane(-0.504, (-0.4, 0.4), (0.52, 0.82), GLASS, detail=False)
    yield from _tail((0.2, 0.34), (0.36, 0.48))
    yield from _front((0.16, 0.26))


MOTORBIKE_LAMP = 0.7, 0.1
"""Height of the middle of a motorbike's lamps above the road, and their own height, m."""


def _two_wheels(rider: Colour | None, thick: float) -> Iterator[_Face]:
    """Yield a rear wheel, a frame with its rider, a front wheel."""
    for group, middle in ((0, -0.33), (2, 0.33)):
        yield from _solid((middle - 0.17, middle + 0.17), (-thick, thick), (0.0, 0.36), TYRE, group=group)
    yield from _solid((-0.3, 0.3), (-1.4 * thick, 1.4 * thick), (0.22, 0.42), BODY, group=1)
    yield _pane(-0.32, (-thick, thick), (0.3, 0.36), RED, bulb=_REAR, group=1)
    yield from _solid((0.2, 0.28), ALL, (0.54, 0.58), DARK, group=1, detail=True)
    yield _pane(0.3, (-thick, thick), (0.42, 0.5), WHITE, bulb=_HEAD, group=1)
    for along, across, up, tone in (
        ((-0.16, 0.08), (-0.22, 0.22), (0.28, 0.55), CLOTH),
        ((-0.16, 0.06), (-0.32, 0.32), (0.55, 0.86), rider),
        ((-0.08, 0.08), (-0.16, 0.16), (0.86, 1.0), SKIN if rider is BODY else rider),
    ):
        yield from _solid(along, across, up, tone, tag=Tag.RIDER, group=1)


def _bicycle(length: float, height: float) -> Iterator[_Face]:
    del length, height
    yield from _two_wheels(BODY, 0.06)


def _motorbike(length: float, height: float) -> Iterator[_Face]:
    """Yield a motorbike; its lamps belong to the groups of the wheels, so that neither wheel nor rider covers them."""
    del length
    yield from (face for face in _two_wheels(DARK, 0.1) if face.bulb == NO_BULB)
    middle, high = MOTORBIKE_LAMP
    up = (middle - 0.5 * high) / height, (middle + 0.5 * high) / height
    yield _pane(-0.45, (-0.1, 0.1), up, RED, bulb=_REAR, group=0, detail=False)
    yield _pane(0.3, (-0.1, 0.1), up, WHITE, bulb=_HEAD, group=2, detail=False)


def _pedestrian(length: float, height: float) -> Iterator[_Face]:
    del length, height
    for across in ((-0.33, -0.03), (0.03, 0.33)):
        yield from _solid((-0.28, 0.28), across, (0.0, 0.48), CLOTH)
    for across in ((-0.5, -0.36), (0.36, 0.5)):
        yield from _solid((-0.2, 0.2), across, (0.45, 0.8), BODY, detail=True)
    yield from _solid((-0.34, 0.34), (-0.36, 0.36), (0.46, 0.84), BODY, top_across=(-0.42, 0.42))
    yield from _solid((-0.25, 0.25), (-0.22, 0.22), (0.86, 1.0), SKIN)


def _cone(length: float, height: float) -> Iterator[_Face]:
    """Yield the base, and a cone with a white collar."""
    del length, height
    yield from _solid(ALL, ALL, (0.0, 0.06), DARK)
    for low, high, tone in ((0.06, 0.4, ORANGE), (0.4, 0.66, WHITE), (0.66, 1.0, ORANGE)):
        foot, head = 0.4 - 0.34 * low, 0.4 - 0.34 * high
        yield from _solid(
            (-foot, foot), (-foot, foot), (low, high), tone, top_along=(-head, head), top_across=(-head, head)
        )


def _barrier(length: float, height: float) -> Iterator[_Face]:
    """Yield two feet and a board with red and white stripes."""
    del length, height
    for group, middle in ((0, -0.4), (2, 0.4)):
        yield from _solid((middle - 0.05, middle + 0.05), ALL, (0.0, 0.5), DARK, group=group)
    yield from _solid(ALL, (-0.2, 0.2), (0.5, 1.0), WHITE, group=1)
    for k in range(0, 6, 2):
        for side in (-0.204, 0.204):
            yield _panel((-0.5 + k / 6, -0.5 + (k + 1) / 6), side, (0.5, 1.0), RED, group=1, detail=False)


def _sign(length: float, height: float) -> Iterator[_Face]:
    """Yield a stand with a board across the heading: red rim, yellow field."""
    del length, height
    yield from _solid((-0.06, 0.06), (-0.06, 0.06), (0.0, 0.45), DARK)
    yield from _solid((-0.03, 0.03), ALL, (0.45, 1.0), RED)
    for x in (-0.035, 0.035):
        yield _pane(x, (-0.38, 0.38), (0.52, 0.93), YELLOW, detail=False)


def _prop(length: float, height: float) -> Iterator[_Face]:
    del length, height
    yield from _solid(ALL, ALL, (0.0, 1.0), BODY)


_KINDS: dict[Kind, tuple[Callable[[float, float], Iterator[_Face]], Tag]] = {
    "car": (_car, Tag.CAR),
    "van": (_van, Tag.CAR),
    "truck": (_truck, Tag.TRUCK),
    "bus": (_bus, Tag.BUS),
    "motorbike": (_motorbike, Tag.MOTORCYCLE),
    "bicycle": (_bicycle, Tag.BICYCLE),
    "pedestrian": (_pedestrian, Tag.PEDESTRIAN),
    "cone": (_cone, Tag.STATIC),
    "barrier": (_barrier, Tag.STATIC),
    "sign": (_sign, Tag.TRAFFIC_SIGN),
    "prop": (_prop, Tag.STATIC),
}
"""Function that makes each kind from a length and a height, m, and its tag. CARLA has no tag for vans, which are cars
or trucks there, depending on their size.
"""
