"""The msgpack layouts of CARLA's types: positional arrays of numbers, texts and further arrays.

A layout says whether a decoded value is of its type. Numbers are finite and in the range of the type on the wire, so
nothing that has passed a layout can stop the arithmetic behind it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

GREATEST_FLOAT = 3.4028235e38
LONGEST_TEXT = 1 << 20
"""Greatest number of characters of a text other than a map."""


@dataclass(frozen=True)
class Layout:
    """A type on the wire.

    Attributes:
        name: Its name for people.
        holds: Returns whether a decoded value is of this type.
    """

    name: str
    holds: Callable[[Any], bool]


def _whole(name: str, least: int, most: int) -> Layout:
    return Layout(name, lambda value: type(value) is int and least <= value <= most)


U8 = _whole("u8", 0, (1 << 8) - 1)
I8 = _whole("i8", -(1 << 7), (1 << 7) - 1)
U16 = _whole("u16", 0, (1 << 16) - 1)
U32 = _whole("u32", 0, (1 << 32) - 1)
I32 = _whole("i32", -(1 << 31), (1 << 31) - 1)
U64 = _whole("u64", 0, (1 << 64) - 1)
REAL = Layout("real", lambda value: type(value) in (float, int) and -GREATEST_FLOAT <= value <= GREATEST_FLOAT)
BOOL = Layout("bool", lambda value: type(value) is bool)
TEXT = Layout("text", lambda value: type(value) is str and len(value) <= LONGEST_TEXT)
LONG_TEXT = Layout("long text", lambda value: type(value) is str)
BYTES = Layout("bytes", lambda value: type(value) is bytes)
ANYTHING = Layout("anything", lambda value: True)


def struct(name: str, *fields: Layout) -> Layout:
    """Return the layout of a structure: an array of its fields in order."""
    checks = tuple(field.holds for field in fields)
    count = len(checks)

    def holds(value: Any) -> bool:
        if type(value) is not list or len(value) != count:
            return False
        return all(check(one) for check, one in zip(checks, value, strict=True))

    return Layout(name, holds)


def array(of: Layout, most: int = 1 << 16) -> Layout:
    """Return the layout of an array of any number of elements up to `most`."""
    check = of.holds
    return Layout(
        f"array of {of.name}",
        lambda value: type(value) is list and len(value) <= most and all(check(one) for one in value),
    )


def optional(of: Layout) -> Layout:
    """Return the layout of an optional value: [false], or [true, value]."""

    def holds(value: Any) -> bool:
        if type(value) is not list or not value or type(value[0]) is not bool:
            return False
        return of.holds(value[1]) if value[0] and len(value) == 2 else not value[0] and len(value) == 1

    return Layout(f"optional {of.name}", holds)


def variant(name: str, *kinds: Layout) -> Layout:
    """Return the layout of a variant: [index of the kind, value]."""

    def holds(value: Any) -> bool:
        if type(value) is not list or len(value) != 2 or type(value[0]) is not int:
            return False
        return 0 <= value[0] < len(kinds) and kinds[value[0]].holds(value[1])

    return Layout(name, holds)


VECTOR = struct("vector", REAL, REAL, REAL)
VECTOR2 = struct("vector in the plane", REAL, REAL)
TRANSFORM = struct("transform", VECTOR, VECTOR)
BOX = struct("bounding box", VECTOR, VECTOR, VECTOR, U32)
TOKEN = struct("token", BYTES)
ATTRIBUTE = struct("attribute", TEXT, U8, TEXT)
DESCRIPTION = struct("actor description", U32, TEXT, array(ATTRIBUTE, 256))
ACTOR = struct("actor", U32, U32, DESCRIPTION, BOX, BYTES, BYTES)
DEFINITION = struct(
    "actor definition", U32, TEXT, TEXT, array(struct("attribute", TEXT, U8, TEXT, array(TEXT), BOOL, BOOL))
)
SETTINGS = struct("episode settings", BOOL, BOOL, optional(REAL), BOOL, REAL, I32, REAL, BOOL, REAL, REAL, BOOL)
WEATHER = struct("weather", *([REAL] * 14))
CONTROL = struct("vehicle control", REAL, REAL, REAL, BOOL, BOOL, BOOL, I32)
ACKERMANN = struct("Ackermann control", REAL, REAL, REAL, REAL, REAL)
ACKERMANN_SETTINGS = struct("Ackermann controller settings", *([REAL] * 6))
WALKER_CONTROL = struct("walker control", VECTOR, REAL, BOOL)
BONE = struct("bone", TEXT, TRANSFORM)
BONES = struct("bones", array(BONE, 256))
BONES_OUT = struct("bones", array(struct("bone", TEXT, TRANSFORM, TRANSFORM, TRANSFORM), 256))
GEAR = struct("gear", REAL, REAL, REAL)
WHEEL = struct("wheel", *([REAL] * 9), VECTOR)
PHYSICS = struct(
    "vehicle physics control",
    array(VECTOR2, 256), REAL, REAL, REAL, REAL, REAL, BOOL, REAL, REAL, REAL, array(GEAR, 32), REAL, REAL, VECTOR,
    array(VECTOR2, 256), array(WHEEL, 16), BOOL,
)  # fmt: skip
LIGHTS = struct("vehicle light state", U32)
LABELLED_POINT = struct("labelled point", VECTOR, U8)
GENERATION = struct("OpenDRIVE generation parameters", REAL, REAL, REAL, REAL, BOOL, BOOL, BOOL)
MANAGER = struct("address of a Traffic Manager", TEXT, U16)
COLOUR = struct("colour", U8, U8, U8)
POINT = struct("point", VECTOR, REAL)
LINE = struct("line", VECTOR, VECTOR, REAL)
ARROW = struct("arrow", LINE, REAL)
STRING = struct("string", VECTOR, TEXT, BOOL)


def _debug_shape(box: Layout, *display: Layout) -> Layout:
    """Return the layout of a debug shape: a point, line, arrow, box or string, or one of them on the display."""
    shape = variant("primitive", POINT, LINE, ARROW, struct("box", box, VECTOR, REAL), STRING, *display)
    return struct("debug shape", shape, COLOUR, REAL, BOOL)


DEBUG_SHAPE = _debug_shape(BOX, POINT, LINE, ARROW, struct("box", BOX, VECTOR, REAL))
DEBUG_SHAPE_BEFORE = _debug_shape(struct("bounding box", VECTOR, VECTOR, VECTOR))
"""The second is that of 0.9.15, whose boxes name no actor and which has nothing on a display but strings."""
