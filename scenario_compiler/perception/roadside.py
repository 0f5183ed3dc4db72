"""Objects and signals of a road file as simple shapes: poles, signs, barriers, buildings, trees, crosswalks.

Shapes have the sizes of the file, or typical ones if it gives none. Objects without a size and of an unknown kind are
left out. Things have negative numbers in the picture of instances, from -1 downwards: the objects in the file's order,
then its signals.
"""

from __future__ import annotations

import math
import re
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import vehicle_axes
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.models import shade_of
from scenario_compiler.perception.polygons import clip
from scenario_compiler.perception.scene import Uprights
from scenario_compiler.roads.mesh import Marks, Paint, mesh_origin
from scenario_compiler.roads.model import Outline, Repeat, RoadObject, Signal
from scenario_compiler.roads.positions import Pose

if TYPE_CHECKING:
    from scenario_compiler.roads.network import Network

Floats = NDArray[np.float64]
Colour = tuple[int, int, int]
Drawn = Literal["block", "wall", "building", "tree", "gantry", "lamp", "zebra", "bay", "mark"]

LONGEST = 8.0
"""Greatest length of a face of a wall, m, because drawing from far to near needs short faces."""

ALONG = 4.0
"""Length of the pieces of an object that continues along a road without gaps, m."""

LARGEST = 300.0
"""Greatest size, m; greater ones are reduced to it."""

MOST_PLACES = 40_000
"""Greatest number of drawn places of objects; protects against hostile files."""

UP = np.array([0.0, 0.0, 1.0])

STRIPE, BORDER = 0.5, 0.12
"""Width of a stripe of a crosswalk and of the bare ground between two, and width of lines round parking spaces, m."""

FLOOR = 3.2
"""Height of a storey of a building, m."""

BEFORE = 0.1
"""How far the face of a signal is before its post, m."""

LEAST_BOTTOM = 1.0
"""Height of a signal above the road below which it means the foot of its post, m: then its face is put at a typical
height.
"""

GREY, STEEL, CONCRETE, WOOD, GLASS = (132, 132, 130), (150, 152, 152), (150, 155, 158), (45, 62, 82), (92, 78, 66)
LEAVES = ((48, 92, 62), (40, 84, 70), (58, 104, 72), (44, 78, 52))
WALLS = ((150, 172, 190), (170, 178, 182), (120, 140, 178), (158, 190, 200), (150, 150, 160))
WHITE, BLACK, RED, YELLOW, BLUE = (235, 235, 235), (30, 30, 30), (40, 40, 200), (30, 190, 240), (170, 90, 30)


class Look(NamedTuple):
    """How objects of a type are drawn: shape, colour (None: one of several, by the id), tag, length, width, height.

    The sizes are for objects without a size in the file, m; 0 means that such an object is left out.
    """

    drawn: Drawn
    colour: Colour | None
    tag: Tag
    length: float
    width: float
    height: float


_POST = Look("block", GREY, Tag.POLE, 0.12, 0.12, 3.0)
LOOKS = {
    "barrier": Look("wall", STEEL, Tag.GUARD_RAIL, 0.0, 0.15, 0.8),
    "railing": Look("wall", STEEL, Tag.FENCE, 0.0, 0.06, 1.0),
    "soundBarrier": Look("wall", CONCRETE, Tag.WALL, 0.0, 0.3, 3.0),
    "building": Look("building", None, Tag.BUILDING, 10.0, 10.0, 8.0),
    "tree": Look("tree", None, Tag.VEGETATION, 0.0, 0.0, 7.0),
    "vegetation": Look("block", LEAVES[0], Tag.VEGETATION, 0.0, 0.0, 1.5),
    "pole": _POST,
    "guide-post": Look("block", WHITE, Tag.POLE, 0.12, 0.12, 1.0),
    "rail-pole": Look("block", STEEL, Tag.GUARD_RAIL, 0.08, 0.08, 0.6),
    "streetLamp": Look("lamp", GREY, Tag.POLE, 0.16, 0.16, 8.0),
    "gantry": Look("gantry", GREY, Tag.POLE, 0.5, 0.0, 6.0),
    "trafficIsland": Look("block", CONCRETE, Tag.SIDEWALK, 0.0, 0.0, 0.15),
    "obstacle": Look("block", GREY, Tag.STATIC, 0.0, 0.0, 1.0),
    "crosswalk": Look("zebra", None, Tag.ROAD_LINE, 0.0, 0.0, 0.0),
    "parkingSpace": Look("bay", None, Tag.ROAD_LINE, 0.0, 0.0, 0.0),
    "roadMark": Look("mark", None, Tag.ROAD_LINE, 0.0, 0.0, 0.0),
}
"""How objects are drawn, by their type. All others are blocks if the file gives their size."""

OTHER = Look("block", GREY, Tag.OTHER, 0.0, 0.0, 0.0)

_PAINTS = {paint.name.lower(): paint for paint in Paint}


@dataclass(frozen=True, eq=False)
class Roadside:
    """The objects of a road file: everything upright, and the paint of objects."""

    uprights: Uprights
    marks: Marks


class _Place(NamedTuple):
    """The place of an object: its origin, the axes of the road surface turned by its heading, and upright axes."""

    pose: Pose
    origin: Floats
    surface: Floats
    upright: Floats


class _Size(NamedTuple):
    length: float
    width: float
    height: float
    radius: float


@dataclass(frozen=True, eq=False)
class _Board:
    """A board: the centre of its lower edge, the direction of its face, and its size."""

    origin: Floats
    ahead: Floats
    width: float
    height: float

    @property
    def left(self) -> Floats:
        """Left from the board's own point of view."""
        return np.array([-self.ahead[1], self.ahead[0], 0.0])

    def at(self, points: Floats, lift: float) -> Floats:
        """Return points (N, 2) of the face (right of its centre as seen, up from its lower edge) as (N, 3)."""
        points = np.asarray(points)
        return np.asarray(self.origin + points[:, :1] * self.left + points[:, 1:2] * UP + lift * self.ahead)


RED_LAMP, YELLOW_LAMP, GREEN_LAMP = 1, 2, 3
_LAMP_WORDS = {
    RED_LAMP: ("red", "stop"),
    YELLOW_LAMP: ("yellow", "amber", "attention"),
    GREEN_LAMP: ("green", "go"),
}


def lit_lamps(state: str) -> frozenset[int]:
    """Return which lamps of a traffic light with three lamps are lit in a state as scenarios write it.

    This is a word, such as "green" or "red_yellow", or the state of each lamp from the top, "off;off;on". In any other
    state the light is dark.
    """
    words = state.lower()
    if ";" in words:
        parts = [part.strip() for part in words.split(";")]
        return frozenset(
            lamp for lamp, part in zip((RED_LAMP, YELLOW_LAMP, GREEN_LAMP), parts, strict=False) if part == "on"
        )
    return frozenset(lamp for lamp, names in _LAMP_WORDS.items() if any(name in words for name in names))


def roadside_of(network: Network) -> Roadside:
    """Return the shapes of a network's objects and signals; its file is read again (see `Network.model`)."""
    model = network.model()
    shapes = _Shapes(network)
    for number, thing in enumerate(model.objects, 1):
        shapes.add_object(thing, -number)
    for number, signal in enumerate(model.signals, len(model.objects) + 1):
        if not signal.reference:
            shapes.add_signal(signal, -number)
    return shapes.made()


class _Shapes:
    """Collects shapes."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.origin = mesh_origin(network)
        self.left = MOST_PLACES
        self.faces: list[Floats] = []
        self.looks: list[tuple[Colour, Tag, int, bool, int]] = []
        self.signals: dict[str, tuple[int, ...]] = {}
        self.stands: list[Floats] = []
        self.paint: list[Floats] = []
        self.tones: list[tuple[Paint, float]] = []

    def made(self) -> Roadside:
        quads = np.array(self.faces).reshape(-1, 4, 3)
        normals = np.cross(quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]).T
        normals = normals / np.maximum(np.sqrt((normals * normals).sum(axis=0)), 1e-12)
        colours = np.array([look[0] for look in self.looks], np.float64).reshape(-1, 3)
        uprights = Uprights(
            quads=(quads - self.origin).astype(np.float32),
            colour=colours * shade_of(normals)[:, None],
            tag=np.array([look[1] for look in self.looks], np.uint8),
            instance=np.array([look[2] for look in self.looks], np.int32),
            two_sided=np.array([look[3] for look in self.looks], np.bool_),
            lamp=np.array([look[4] for look in self.looks], np.uint8),
            place=(np.array(self.stands).reshape(-1, 2) - self.origin[:2]).astype(np.float32),
            signals=self.signals,
            origin=self.origin,
        )
        painted = np.array(self.paint).reshape(-1, 4, 3)
        count = len(painted)
        marks = Marks(
            quads=(painted - self.origin).astype(np.float32),
            colour=np.array([tone for tone, _ in self.tones], np.uint8),
            quality=np.ones(count, np.float32),
            width=np.array([width for _, width in self.tones], np.float32),
            road=np.full(count, -1, np.int32),
            lane=np.zeros(count, np.int32),
            s=np.zeros((count, 2)),
            origin=self.origin,
        )
        return Roadside(uprights, marks)

    # Objects

    def add_object(self, thing: RoadObject, number: int) -> None:
        look = LOOKS.get(thing.type, OTHER)
        if look.drawn != "wall" or not any(repeat.distance <= 0.0 for repeat in thing.repeats):
            for place, size in self._places(thing, look):
                self._add_one(thing, look, place, size, number)
            return
        for repeat in thing.repeats:
            self._add_along(thing, look, repeat, number)

    def _places(self, thing: RoadObject, look: Look) -> Iterator[tuple[_Place, _Size]]:
        own = _size(thing, look, None, 0.0)
        if not thing.repeats:
            place = self._place(thing, thing.s, thing.t, thing.z_offset)
            if place is not None:
                yield place, own
        for repeat in thing.repeats:
            for s, t, z, share in repeat.places():
                place = self._place(thing, s, t, z)
                if place is not None:
                    yield place, _size(thing, look, repeat, share)

    def _place(self, thing: RoadObject, s: float, t: float, z: float) -> _Place | None:
        """Return the place of an object, None if its road does not exist or there are too many places."""
        pose = self._pose(thing.road, s, t)
        self.left -= 1
        if pose is None or self.left < 0:
            return None
        cos, sin = math.cos(thing.heading), math.sin(thing.heading)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        level = vehicle_axes(Pose(pose.x, pose.y, pose.z, pose.heading, 0.0, 0.0))
        origin = np.array([pose.x, pose.y, pose.z + z])
        return _Place(pose, origin, vehicle_axes(pose) @ turn, level @ turn)

    def _pose(self, road: str, s: float, t: float) -> Pose | None:
        try:
            return self.network.road_pose(road, s, t)
        except ValueError:
            return None

    def _add_one(self, thing: RoadObject, look: Look, place: _Place, size: _Size, number: int) -> None:
        if look.drawn in {"zebra", "bay", "mark"}:
            self._add_flat(thing, look, place, size)
        elif look.drawn == "tree":
            self._add_tree(thing, place, size, number)
        elif look.drawn == "gantry":
            self._add_gantry(look, place, size, number)
        else:
            colour = look.colour or _one_of(WALLS, thing.id)
            outlines = [outline for outline in thing.outlines if outline.outer and len(outline.corners) > 2]
            for outline in outlines:
                foot, height = self._outline(thing, outline, place, flat=False)
                self._add_prism(foot, height or size.height, colour, look, number)
            if not outlines:
                foot = _foot(place.upright, size) + place.origin
                if size.height > 0.0 and np.ptp(foot, axis=0)[:2].max() > 0.0:
                    self._add_prism(foot, size.height, colour, look, number)
            if look.drawn == "lamp":
                self._add_lamp(look, place, size, number)

    def _outline(self, thing: RoadObject, outline: Outline, place: _Place, *, flat: bool) -> tuple[Floats, float]:
        """Return the corners (N, 3) of an outline in the world and the mean height over them."""
        axes = place.surface if flat else place.upright
        points = []
        for corner in outline.corners:
            if corner.local:
                points.append(place.origin + axes @ (corner.first, corner.second, corner.z))
            else:
                shift = place.pose if thing.repeats else None
                there = self._corner(thing, corner.first, corner.second, shift)
                points.append(there + UP * corner.z)
        return np.array(points), sum(min(corner.height, LARGEST) for corner in outline.corners) / len(points)

    def _corner(self, thing: RoadObject, s: float, t: float, repeated: Pose | None) -> Floats:
        """Return the point at (s, t) of an object's road, moved together with the object if it is repeated."""
        length = self.network.road(thing.road).length
        pose = self._pose(thing.road, min(max(s, 0.0), length), t)
        assert pose is not None
        point = np.array([pose.x, pose.y, pose.z])
        if repeated is not None:
            first = self._pose(thing.road, min(max(thing.s, 0.0), length), thing.t)
            assert first is not None
            away = vehicle_axes(first).T @ (point - (first.x, first.y, first.z))
            point = vehicle_axes(repeated) @ away + (repeated.x, repeated.y, repeated.z)
        return point

    def _add_along(self, thing: RoadObject, look: Look, repeat: Repeat, number: int) -> None:
        """Add a wall that follows the road without gaps, piece by piece."""
        if repeat.length <= 0.0:
            return
        pieces = min(max(math.ceil(repeat.length / ALONG), 1), MOST_PLACES)
        ends: list[tuple[Pose, float, _Size] | None] = []
        for k in range(pieces + 1):
            share = k / pieces
            t = repeat.t_start + share * (repeat.t_end - repeat.t_start)
            pose = self._pose(thing.road, repeat.s + share * repeat.length, t)
            z = repeat.z_start + share * (repeat.z_end - repeat.z_start)
            ends.append(None if pose is None else (pose, z, _size(thing, look, repeat, share)))
        sections = [None if end is None else _section(*end) for end in ends]
        for k, (begin, end) in enumerate(pairwise(sections)):
            self.left -= 1
            if begin is None or end is None or self.left < 0:
                continue
            colour = look.colour or GREY
            (a, b, c, d), (e, f, g, h) = begin, end
            strips = max(math.ceil(float(np.linalg.norm(b - a)) / LONGEST), 1)
            for quad in ((a, e, h, d), (f, b, c, g), *_strips(d, h, g, c, strips), *_strips(b, f, e, a, strips)):
                self._face(quad, colour, look.tag, number)
            if k == 0 or sections[k - 1] is None:
                self._face((b, a, d, c), colour, look.tag, number)
            if k == pieces - 1 or sections[k + 2] is None:
                self._face((e, f, g, h), colour, look.tag, number)

    # Solids

    def _face(
        self,
        corners: Sequence[Floats] | Floats,
        colour: Colour,
        tag: Tag,
        number: int,
        *,
        both: bool = False,
        lamp: int = 0,
        stands: Floats | None = None,
    ) -> None:
        """Add a face; `stands` is its place, by default its centre."""
        points = np.asarray(corners, np.float64)
        self.faces.append(points)
        self.looks.append((colour, tag, number, both, lamp))
        self.stands.append(points.mean(axis=0)[:2] if stands is None else stands[:2])

    def _add_prism(self, foot: Floats, height: float, colour: Colour, look: Look, number: int) -> None:
        """Add walls on a base (N, 3) and a roof above them."""
        foot = foot if _area(foot) >= 0.0 else foot[::-1]
        up = UP * height
        for a, b in zip(foot, np.roll(foot, -1, axis=0), strict=True):
            self._add_wall(a, b, up, colour, look, number)
        for quad in _quads(foot + up):
            self._face(quad, colour, look.tag, number)

    def _add_wall(self, a: Floats, b: Floats, up: Floats, colour: Colour, look: Look, number: int) -> None:
        """Add an upright face above the line from a to b, visible from its right, in pieces."""
        length = float(np.hypot(*(b - a)[:2]))
        if length < 1e-3:
            return
        pieces = min(max(math.ceil(length / LONGEST), 1), 64)
        for k in range(pieces):
            p, q = a + (b - a) * (k / pieces), a + (b - a) * ((k + 1) / pieces)
            self._face((p, q, q + up, p + up), colour, look.tag, number)
            if look.drawn == "building" and length / pieces > 2.5:
                self._add_windows(p, q, float(up[2]), number)

    def _add_windows(self, p: Floats, q: Floats, height: float, number: int) -> None:
        along = (q - p) / np.linalg.norm(q - p)
        outwards = np.array([along[1], -along[0], 0.0]) * 0.03
        left, right = p + along * 0.7 + outwards, q - along * 0.7 + outwards
        for k in range(min(int((height - 0.4) / FLOOR), 8)):
            low, high = UP * (FLOOR * k + 1.0), UP * (FLOOR * k + 2.4)
            self._face((left + low, right + low, right + high, left + high), GLASS, Tag.BUILDING, number)

    def _add_tree(self, thing: RoadObject, place: _Place, size: _Size, number: int) -> None:
        """Add a trunk, and a crown of two crossing faces."""
        height = size.height
        trunk = max(0.015 * height, 0.08)
        look = LOOKS["tree"]._replace(drawn="block")
        foot = _foot(place.upright, _Size(2 * trunk, 2 * trunk, 0.0, 0.0)) + place.origin
        self._add_prism(foot, 0.4 * height, WOOD, look, number)
        crown = max(size.radius, 0.2 * height) if size.radius < 0.5 * height else 0.5 * height
        colour = _one_of(LEAVES, thing.id)
        for axis in (0, 1):
            side = place.upright[:, axis]
            for low, high, lower, upper in ((0.28, 0.6, 0.65, 1.0), (0.6, 1.0, 1.0, 0.35)):
                corners = [
                    place.origin + side * (way * share * crown) + UP * (z * height)
                    for way, share, z in ((-1, lower, low), (1, lower, low), (1, upper, high), (-1, upper, high))
                ]
                shade = tuple(round(c * (0.9 if high < 1.0 else 1.1)) for c in colour)
                self._face(corners, (shade[0], shade[1], shade[2]), Tag.VEGETATION, number, both=True)

    def _add_gantry(self, look: Look, place: _Place, size: _Size, number: int) -> None:
        """Add two posts and a beam across the road."""
        if size.width <= 0.0:
            return
        thick, colour = 0.3, look.colour or GREY
        for side in (-0.5, 0.5):
            foot = _foot(place.upright, _Size(thick, thick, 0.0, 0.0)) + place.origin
            self._add_prism(foot + place.upright[:, 1] * (side * size.width), size.height, colour, look, number)
        beam = _foot(place.upright, _Size(thick, size.width, 0.0, 0.0)) + place.origin
        self._add_prism(beam + UP * (size.height - 0.6), 0.6, colour, look, number)

    def _add_lamp(self, look: Look, place: _Place, size: _Size, number: int) -> None:
        """Add an arm towards the road."""
        left = vehicle_axes(place.pose)[:, 1]
        lane = self.network.locate(place.pose.x, place.pose.y, nearest=True)
        inwards = left if not lane or lane[0].offset < 0.0 else -left
        arm = _foot(place.upright, _Size(0.25, 0.25, 0.0, 0.0)) + place.origin + UP * (size.height - 0.15)
        reach = np.where((arm - place.origin) @ inwards > 0.0, 1.6, 0.0)[:, None] * inwards
        self._add_prism(arm + reach, 0.15, look.colour or GREY, look, number)

    # Paint

    def _add_flat(self, thing: RoadObject, look: Look, place: _Place, size: _Size) -> None:
        outlines = [outline for outline in thing.outlines if len(outline.corners) > 1]
        feet = [self._outline(thing, outline, place, flat=True)[0] for outline in outlines]
        corners = {
            corner.id: point
            for outline, foot in zip(outlines, feet, strict=True)
            for corner, point in zip(outline.corners, foot, strict=True)
        }
        box = _foot(place.surface, size) + place.origin
        sides = {"rear": (3, 0), "right": (0, 1), "front": (1, 2), "left": (2, 3)}
        for marking in thing.markings:
            line = [corners[name] for name in marking.corners if name in corners]
            if not line and marking.side in sides:
                line = [box[k] for k in sides[marking.side]]
            tone = _PAINTS.get(marking.colour, Paint.WHITE)
            dash, gap = marking.line, marking.space
            for a, b in _dashes(line, dash, gap, marking.start, marking.stop):
                self._line(a, b, marking.width or BORDER, tone)
        if thing.markings:
            return
        for foot in feet or [box]:
            if len(foot) < 3 or abs(_area(foot)) < 0.05:
                continue
            if look.drawn == "zebra":
                for stripe in _stripes(foot):
                    self._polygon(stripe)
            elif look.drawn == "mark":
                self._polygon(foot)
            else:
                for a, b in zip(foot, np.roll(foot, -1, axis=0), strict=True):
                    self._line(a, b, BORDER, Paint.WHITE)

    def _polygon(self, corners: Floats) -> None:
        for quad in _quads(corners):
            self.paint.append(quad)
            self.tones.append((Paint.WHITE, STRIPE))

    def _line(self, a: Floats, b: Floats, width: float, tone: Paint) -> None:
        along = (b - a)[:2]
        length = float(np.hypot(*along))
        if length < 1e-3:
            return
        beside = np.array([-along[1], along[0], 0.0]) / length * (0.5 * width)
        pieces = min(max(math.ceil(length / LONGEST), 1), 64)
        for k in range(pieces):
            p, q = a + (b - a) * (k / pieces), a + (b - a) * ((k + 1) / pieces)
            self.paint.append(np.array([p + beside, q + beside, q - beside, p - beside]))
            self.tones.append((tone, width))

    # Signals

    def add_signal(self, signal: Signal, number: int) -> None:
        pose = self._pose(signal.road, signal.s, signal.t)
        self.left -= 1
        if pose is None or self.left < 0:
            return
        if signal.type in PAINTED:
            self._add_stop_line(signal, pose)
            return
        light = signal.dynamic or signal.type.startswith("10000")
        width = min(signal.width, 6.0) or (0.35 if light else 0.7)
        height = min(signal.height, 6.0) or (1.0 if light else width)
        bottom = signal.z_offset if signal.z_offset >= LEAST_BOTTOM else (2.6 if light else 2.2)
        heading = _facing(signal, pose)
        ahead = np.array([math.cos(heading), math.sin(heading), 0.0])
        foot = np.array([pose.x, pose.y, pose.z])
        board = _Board(foot + ahead * BEFORE + UP * bottom, ahead, width, height)
        over_road = any(place.lane for place in self.network.locate(pose.x, pose.y)) and bottom > 4.0
        if not over_road:
            post = _foot(np.column_stack([ahead, (-ahead[1], ahead[0], 0.0), (0.0, 0.0, 1.0)]), _THIN) + foot
            self._add_prism(post, bottom, GREY, _POST, number)
        if light:
            self.signals[signal.id] = (*self.signals.get(signal.id, ()), number)
            self._add_light(board, number)
        else:
            self._add_sign(board, signal, number)

    def _add_light(self, board: _Board, number: int) -> None:
        """Add the housing of a traffic light with its three lamps, green, yellow and red from below."""
        axes = np.column_stack([board.ahead, board.left, (0.0, 0.0, 1.0)])
        look = Look("block", BLACK, Tag.TRAFFIC_LIGHT, 0.0, 0.0, 0.0)
        foot = _foot(axes, _Size(0.16, board.width, 0.0, 0.0)) + board.origin
        self._add_prism(foot, board.height, BLACK, look, number)
        for k, (lamp, colour) in enumerate(
            ((GREEN_LAMP, (50, 110, 40)), (YELLOW_LAMP, (30, 110, 130)), (RED_LAMP, (40, 40, 130)))
        ):
            disc = _octagon(0.32 * min(board.width, board.height / 3.0))
            disc[:, 1] += board.height * (k + 0.5) / 3.0
            for quad in _quads(disc):
                self._face(
                    board.at(quad, 0.09),
                    colour,
                    Tag.TRAFFIC_LIGHT,
                    number,
                    lamp=lamp,
                    stands=board.at(CENTRE, 0.2)[0],
                )

    def _add_sign(self, board: _Board, signal: Signal, number: int) -> None:
        """Add a board: a coloured field within a rim, with a grey back."""
        shape, rim, field_colour = _sign_look(signal)
        size = np.array([board.width, board.height])
        for share, lift, colour in ((1.0, 0.0, rim), (0.8, 0.012, field_colour)):
            outline = shape * share
            outline = outline * size + (0.0, 0.5 * board.height)
            for quad in _quads(outline):
                self._face(board.at(quad, lift), colour, Tag.TRAFFIC_SIGN, number, stands=board.origin)
                if share == 1.0:
                    self._face(board.at(quad, 0.0)[::-1], STEEL, Tag.TRAFFIC_SIGN, number, stands=board.origin)

    def _add_stop_line(self, signal: Signal, pose: Pose) -> None:
        across = 0.5 * (min(signal.width, 20.0) or 3.0)
        left = vehicle_axes(pose)[:, 1]
        middle = np.array([pose.x, pose.y, pose.z])
        self._line(middle - left * across, middle + left * across, 0.5, Paint.WHITE)


CENTRE = np.zeros((1, 2))

_THIN = _Size(0.08, 0.08, 0.0, 0.0)

PAINTED = frozenset({"294", "294.0"})
"""Types of signals that are paint on the road: the German stop line, which CARLA's maps use too."""


def _octagon(radius: float) -> Floats:
    turn = np.arange(8) * (math.pi / 4.0) + math.pi / 8.0
    return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)


_ROUND = _octagon(0.53)
_SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])
_DIAMOND = np.array([[0.0, -0.5], [0.5, 0.0], [0.0, 0.5], [-0.5, 0.0]])
_UPWARDS = np.array([[-0.5, -0.45], [0.5, -0.45], [0.0, 0.5]])
_DOWNWARDS = np.array([[0.0, -0.5], [0.5, 0.45], [-0.5, 0.45]])


def _sign_look(signal: Signal) -> tuple[Floats, Colour, Colour]:
    """Return the outline of a sign within a unit square around its centre, and the colours of its rim and field.

    Numbers are those of the German catalogue (Vienna Convention 1968), which CARLA's maps use too; others are boards.
    """
    kind = signal.type.split("-")[0].split(".")[0]
    if kind == "206":
        return _ROUND, WHITE, RED
    if kind == "205":
        return _DOWNWARDS, RED, WHITE
    if kind == "306":
        return _DIAMOND, WHITE, YELLOW
    if not re.fullmatch("[0-9]{1,9}", kind):
        return (_ROUND, RED, WHITE if signal.country.lower() != "se" else YELLOW) if kind == "c" else _PLATE
    number = int(kind)
    if 101 <= number < 200:
        return _UPWARDS, RED, WHITE
    if 209 <= number < 240:
        return _ROUND, WHITE, BLUE
    if 240 <= number < 290:
        return _ROUND, RED, WHITE
    if 300 <= number < 460:
        return _SQUARE, WHITE, BLUE
    return _PLATE


_PLATE = (_SQUARE, BLACK, WHITE)


def _facing(signal: Signal, pose: Pose) -> float:
    """Return the direction of a signal's face, rad: against the traffic to which it applies.

    The standard measures its heading from there; some programs measure it from the road's direction. Therefore a sign
    that would show its back to this traffic is turned round.
    """
    meant = pose.heading + (0.0 if signal.orientation == "-" else math.pi)
    looks = meant + signal.heading_offset
    return looks if math.cos(looks - meant) >= 0.0 else looks + math.pi


def _size(thing: RoadObject, look: Look, repeat: Repeat | None, share: float) -> _Size:
    """Return the size of an object at a relative position of a repetition, within sensible limits."""

    def one(own: float, start: float, end: float, usual: float) -> float:
        here = start + share * (end - start)
        return min(max(here if here > 0.0 else own, 0.0), LARGEST) or usual

    r = repeat if repeat is not None else Repeat(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    radius = one(thing.radius, r.radius_start, r.radius_end, 0.0)
    return _Size(
        one(thing.length, r.length_start, r.length_end, 2.0 * radius or look.length),
        one(thing.width, r.width_start, r.width_end, 2.0 * radius or look.width),
        one(thing.height, r.height_start, r.height_end, look.height),
        radius,
    )


def _section(pose: Pose, z: float, size: _Size) -> Floats:
    """Return the section of a wall along a road, (4, 3): right and left at its base, left and right at its top."""
    half = vehicle_axes(pose)[:, 1] * (0.5 * max(size.width, 0.02))
    foot = np.array([pose.x, pose.y, pose.z + z])
    up = UP * size.height
    return np.array([foot - half, foot + half, foot + half + up, foot - half + up])


def _strips(a: Floats, b: Floats, c: Floats, d: Floats, count: int) -> Iterator[tuple[Floats, ...]]:
    """Yield strips of a quad from the side a-b to the side d-c."""
    for k in range(count):
        low, high = k / count, (k + 1) / count
        yield a + (d - a) * low, b + (c - b) * low, b + (c - b) * high, a + (d - a) * high


def _foot(axes: Floats, size: _Size) -> Floats:
    """Return the base (N, 3) of a box or a cylinder around the origin, counter-clockwise from its rear right corner."""
    if size.radius > 0.4:
        turn = np.arange(8) * (math.pi / 4.0)
        flat = size.radius * np.stack([np.cos(turn), np.sin(turn), np.zeros(8)], axis=1)
    else:
        half = np.array([[-0.5, -0.5, 0.0], [0.5, -0.5, 0.0], [0.5, 0.5, 0.0], [-0.5, 0.5, 0.0]])
        flat = half * (size.length, size.width, 0.0)
    return np.asarray(flat @ axes.T)


def _area(points: Floats) -> float:
    """Return the area of a polygon seen from above, m2, positive if its corners are counter-clockwise."""
    x, y = points[:, 0] - points[0, 0], points[:, 1] - points[0, 1]
    return float(0.5 * (x * np.roll(y, -1) - np.roll(x, -1) * y).sum())


def _quads(corners: Floats) -> Iterator[Floats]:
    """Yield the quads of a polygon (N, D); triangles repeat a corner. Reflex corners are removed first."""
    rest = [np.asarray(point) for point in corners]
    if len(rest) > 4:
        yield from _ears(rest)
    while len(rest) >= 3:
        yield np.array(rest[:4] if len(rest) > 3 else [*rest, rest[-1]])
        rest = [rest[0], *rest[3:]]


def _ears(rest: list[Floats]) -> Iterator[Floats]:
    """Cut ears off a polygon in place until it is convex (Meisters 1975), and yield them."""
    while len(rest) > 3:
        turns = [_turn(rest[k - 1], rest[k], rest[(k + 1) % len(rest)]) for k in range(len(rest))]
        whole = sum(turns)
        if all(turn * whole >= 0.0 for turn in turns):
            return
        for k, turn in enumerate(turns):
            a, b, c = rest[k - 1], rest[k], rest[(k + 1) % len(rest)]
            others = (p for p in rest if p is not a and p is not b and p is not c)
            if turn * whole > 0.0 and not any(_inside(p, a, b, c) for p in others):
                yield np.array([a, b, c, c])
                del rest[k]
                break
        else:
            return


def _turn(a: Floats, b: Floats, c: Floats) -> float:
    return float((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]))


def _inside(p: Floats, a: Floats, b: Floats, c: Floats) -> bool:
    signs = [_turn(a, b, p), _turn(b, c, p), _turn(c, a, p)]
    return min(signs) >= 0.0 or max(signs) <= 0.0


def _stripes(corners: Floats) -> Iterator[Floats]:
    """Yield the stripes of a crosswalk with these corners (N, 3), perpendicular to its longest side.

    Stripe and gap are about half a metre wide, so that both fit.
    """
    sides = np.roll(corners, -1, axis=0) - corners
    walk = sides[int(np.argmax(np.hypot(sides[:, 0], sides[:, 1])))][:2]
    walk = walk / np.hypot(*walk)
    along = corners[:, :2] @ walk
    first, last = float(along.min()), float(along.max())
    count = min(max(round((last - first) / (2.0 * STRIPE)), 1), 200)
    gap = (last - first) / count
    points = corners.T[:, :, None]
    for k in range(count):
        low, high = first + gap * (k + 0.25), first + gap * (k + 0.75)
        cut, number = clip(points, (along - low)[:, None], np.array([len(corners)]))
        reach = high - np.tensordot(walk, cut[:2], axes=1)
        cut, number = clip(cut, reach, number)
        if number[0] > 2:
            yield cut[:, : number[0], 0].T


def _dashes(
    line: Sequence[Floats], dash: float, gap: float, start: float, stop: float
) -> Iterator[tuple[Floats, Floats]]:
    """Yield the painted pieces of a line through points, without the unpainted lengths at its ends."""
    ends = np.cumsum([0.0, *(float(np.linalg.norm(b - a)) for a, b in pairwise(line))])
    total = float(ends[-1])
    period = dash + gap if gap > 0.0 and dash > 0.0 else 0.0
    if period > 0.0 and total / period > 1000.0:
        period = 0.0
    begins = np.arange(start, total - stop, period) if period > 0.0 else np.array([start])
    for begin in begins.tolist():
        end = min(begin + dash, total - stop) if period > 0.0 else total - stop
        for (a, b), (from_, to) in zip(pairwise(line), pairwise(ends.tolist()), strict=True):
            low, high = max(begin, from_), min(end, to)
            if high - low > 1e-3:
                yield a + (b - a) * ((low - from_) / (to - from_)), a + (b - a) * ((high - from_) / (to - from_))


def _one_of(colours: Sequence[Colour], name: str) -> Colour:
    return colours[zlib.crc32(name.encode()) % len(colours)]
