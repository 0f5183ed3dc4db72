"""The rules of OpenDRIVE 1.8 on combinations of attributes and children of an element.

Source: the assertions in the schema of its revision 1.8.1.
"""

from __future__ import annotations

from collections.abc import Iterator

from lxml import etree

from scenario_compiler.structure.grammar import Condition

FIRST_MINOR_WITH_CONDITIONS = 8

NOT_WITH_TYPE = {
    "barrier": "radius material surface parkingSpace skeleton",
    "building": "material surface parkingSpace skeleton",
    "crosswalk": "radius parkingSpace skeleton",
    "gantry": "radius material surface parkingSpace",
    "obstacle": "material surface parkingSpace skeleton",
    "parkingSpace": "radius skeleton",
    "pole": "material surface parkingSpace",
    "roadMark": "radius parkingSpace skeleton",
    "roadSurface": "parkingSpace skeleton",
    "trafficIsland": "surface parkingSpace skeleton",
    "tree": "material surface parkingSpace",
    "vegetation": "material surface parkingSpace skeleton",
}
"""Attributes and children that an object of a type must not have."""

CONTINUOUS = {"barrier"}
"""Types whose repetition has the distance 0, that is, no gaps."""

ANY_DISTANCE = {"trafficIsland"}
"""Types whose repetition may have any distance; for the other types in `NOT_WITH_TYPE` it is above 0."""


def _object(element: etree._Element) -> Iterator[str]:
    has = {*element.attrib, *(child.tag for child in element.iterchildren(etree.Element))}
    if has & {"radius"} and has & {"width", "length"}:
        yield "has a radius and a width or length; one excludes the other"
    elif len(has & {"width", "length"}) == 1:
        yield "has a width or a length alone; they stand together"
    kind = element.get("type", "")
    for name in NOT_WITH_TYPE.get(kind, "").split():
        if name in has:
            yield f"of type {kind} has no {name}"
    zero = [_is_zero(one.get("distance", "")) for one in element.iterfind("repeat")]
    if zero and kind in NOT_WITH_TYPE and kind not in ANY_DISTANCE:
        if kind in CONTINUOUS and not any(zero):
            yield f"of type {kind} is repeated without gaps, with the distance 0"
        elif kind not in CONTINUOUS and all(zero):
            yield f"of type {kind} is repeated at a distance above 0"


def _is_zero(text: str) -> bool:
    try:
        return float(text) == 0.0
    except ValueError:
        return False


def _lanes(element: etree._Element) -> Iterator[str]:
    if element.find("laneOffset") is not None and element.find("laneSection//border") is not None:
        yield "has lane offsets and lane borders; one excludes the other"


def _corner_references(attribute: str) -> Condition:
    """Return the condition that corners are named unless the attribute replaces them."""

    def check(element: etree._Element) -> Iterator[str]:
        count = len(element.findall("cornerReference"))
        if element.get(attribute) is not None and count:
            yield f"has {attribute} and corner references; one excludes the other"
        elif element.get(attribute) is None and count < 2:
            yield f"has neither {attribute} nor two corner references"

    return check


def _junction(element: etree._Element) -> Iterator[str]:
    seen: set[str | None] = set()
    for connection in element.iterfind("connection"):
        name = connection.get("id")
        if name is not None and name in seen:
            yield f"has two connections with the id '{name[:40]}'"
        seen.add(name)


CONDITIONS: dict[str, Condition] = {
    "object": _object,
    "lanes": _lanes,
    "object_border": _corner_references("useCompleteOutline"),
    "marking": _corner_references("side"),
    "junction": _junction,
    "direct_junction": _junction,
    "virtual_junction": _junction,
}
"""The conditions by name of the declaration."""
