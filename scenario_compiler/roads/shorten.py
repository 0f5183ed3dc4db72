"""Cuts short stretches off the ends of a road in its OpenDRIVE text; the rest of the road stays in place."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from lxml import etree

from scenario_compiler.roads.geometry import polynomial_parameter, road_piece_at, road_reference
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.tables import AT_END, RoadTables
from scenario_compiler.roads.text_edits import TextEdits, number_of

End = tuple[int, int]
"""A road's index and one of its ends, `AT_START` or `AT_END`."""

_CUBICS = {"elevation", "superelevation", "crossfall", "laneOffset", "width", "border"}
_STATIONS = ("s", "sStart", "sEnd")


def cut_range(n: RoadTables, end: End, length: float) -> tuple[float, float]:
    """Return the range of s of the last `length` m before a road's end."""
    whole = n.road_length[end[0]]
    return (whole - length, whole) if end[1] == AT_END else (0.0, length)


def name_end(network: Network, end: End) -> tuple[str, str]:
    """Return the id of a road and the standard's word for its end."""
    return network.road_ids[end[0]], "end" if end[1] == AT_END else "start"


def free_id(taken: set[str]) -> str:
    """Return a road id above all numeric ids, and reserve it."""
    numbers = [int(one) for one in taken if one.isascii() and one.isdigit() and len(one) < 10]
    name = str(max(numbers, default=0) + 1)
    taken.add(name)
    return name


def shorten_road(
    edits: TextEdits, element: etree._Element, n: RoadTables, road: int, at_start: float, at_end: float
) -> None:
    """Cut stretches off the start and the end of a road.

    A cut at the start moves the origin of s: every s in the road decreases by it, and every cubic is rewritten.

    Args:
        edits: Receives the changes; one call for each road.
        element: The road's element.
        n: The tables of the network.
        road: Index of the road.
        at_start: Length to cut off the start, m, less than that of the first lane section.
        at_end: Length to cut off the end, m, less than that of the last lane section.
    """
    limit = n.road_length[road] - at_end
    _set(edits, element, "length", limit - at_start)
    geometries = sorted(element.iterfind("{*}planView/{*}geometry"), key=lambda one: number_of(one, "s"))
    for one in geometries:
        s, span = number_of(one, "s"), number_of(one, "length")
        start, end = max(at_start - s, 0.0), min(span, limit - s)
        if end <= start and len(geometries) > 1:
            edits.remove(one)
            continue
        _set(edits, one, "s", max(s - at_start, 0.0))
        if start > 0.0:
            x, y, heading, _ = road_reference(n, road, at_start)
            _set(edits, one, "x", x)
            _set(edits, one, "y", y)
            if one.find("{*}poly3") is None and one.find("{*}paramPoly3") is None:
                _set(edits, one, "hdg", heading)
        if start > 0.0 or end < span:
            first = _parameter(n, road, s + start) if start > 0.0 else 0.0
            last = _parameter(n, road, s + end) if end < span else None
            _trim(edits, one, start, end, first, last)
    if at_start > 0.0:
        _move_stations(edits, element, at_start)
        _move_offsets(edits, element, at_start)


def _set(edits: TextEdits, element: etree._Element, attribute: str, value: float) -> None:
    """Set an attribute to a number; if it has this value already, its text is not changed."""
    if element.get(attribute) is None or number_of(element, attribute) != value:
        edits.set(element, attribute, repr(value))


def _parameter(n: RoadTables, road: int, s: float) -> float:
    """Return the parameter of a poly3 or paramPoly3 at s; 0 on other geometries."""
    piece = road_piece_at(n, road, s)
    q = n.piece_poly[piece]
    return polynomial_parameter(n, q, s - n.piece_s[piece])[0] if q >= 0 else 0.0


def _trim(
    edits: TextEdits, geometry: etree._Element, start: float, end: float, first: float, last: float | None
) -> None:
    """Keep the part of a piece of the reference line between two distances from its own start, m.

    On a polynomial, it is the part between the parameters `first` and `last`; without `last`, the rest.
    """
    whole = number_of(geometry, "length")
    _set(edits, geometry, "length", end - start)
    for shape in geometry.iterchildren("{*}*"):
        name = etree.QName(shape).localname
        if name == "spiral":
            k0, k1 = number_of(shape, "curvStart"), number_of(shape, "curvEnd")
            _set(edits, shape, "curvStart", k0 + (k1 - k0) * start / whole)
            _set(edits, shape, "curvEnd", k0 + (k1 - k0) * end / whole)
        elif name == "poly3":
            _restate(edits, shape, "abcd", first, 1.0)
        elif name == "paramPoly3":
            by_length = shape.get("pRange") == "arcLength"
            if last is None:
                last = whole if by_length else 1.0
            stretch = (last - first) / (end - start if by_length else 1.0)
            for axis in "UV":
                _restate(edits, shape, [f"{power}{axis}" for power in "abcd"], first, stretch)


def _restate(
    edits: TextEdits, element: etree._Element, names: Sequence[str], by: float, stretch: float, at: float = 0.0
) -> None:
    """Rewrite a + b p + c p2 + d p3 for p = by + stretch q; the constant becomes `at` if p moves."""
    a, b, c, d = (number_of(element, name) for name in names)
    moved = (
        a if by == 0.0 else at,
        (b + by * (2.0 * c + 3.0 * d * by)) * stretch,
        (c + 3.0 * d * by) * stretch**2,
        d * stretch**3,
    )
    for name, before, after in zip(names, (a, b, c, d), moved, strict=True):
        if before != after:
            _set(edits, element, name, after)


def _move_stations(edits: TextEdits, road: etree._Element, by: float) -> None:
    """Decrease every s of a road; places on the part that was cut off move to 0."""
    for group in _groups(one for one in road.iter(etree.Element) if one.get("s") is not None):
        _lower(edits, group, "s", by)
    for one in road.iter(etree.Element):
        for attribute in _STATIONS[1:]:
            if one.get(attribute) is not None:
                _set(edits, one, attribute, max(number_of(one, attribute) - by, 0.0))


def _move_offsets(edits: TextEdits, road: etree._Element, by: float) -> None:
    """Decrease every sOffset of the lanes of the first lane section, which now starts later."""
    sections = sorted(road.iterfind("{*}lanes/{*}laneSection"), key=lambda one: number_of(one, "s"))
    for lane in sections[0].iterfind("{*}*/{*}lane") if sections else ():
        for group in _groups(one for one in lane.iterchildren("{*}*") if one.get("sOffset") is not None):
            _lower(edits, group, "sOffset", by)


def _groups(elements: Iterator[etree._Element]) -> list[list[etree._Element]]:
    """Group records by parent and name; in such a group, records follow each other."""
    groups: dict[tuple[etree._Element | None, str, str | None], list[etree._Element]] = {}
    for one in elements:
        name = etree.QName(one).localname
        if name not in {"geometry", "line"}:
            groups.setdefault((one.getparent(), name, one.get("side")), []).append(one)
    return list(groups.values())


def _lower(edits: TextEdits, records: list[etree._Element], attribute: str, by: float) -> None:
    records = sorted(records, key=lambda one: number_of(one, attribute))
    for one, following in zip(records, [*records[1:], None], strict=True):
        s = number_of(one, attribute)
        if etree.QName(one).localname in _CUBICS and s < by:
            if following is not None and number_of(following, attribute) <= by:
                edits.remove(one)
                continue
            a, b, c, d = (number_of(one, name) for name in "abcd")
            p = by - s
            _restate(edits, one, "abcd", p, 1.0, a + p * (b + p * (c + p * d)))
        _set(edits, one, attribute, max(s - by, 0.0))
