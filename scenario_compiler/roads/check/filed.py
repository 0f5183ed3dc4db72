"""The contents of a road file as written: roads, lane sections, lanes, links and junctions, with their elements.

The tables of a network contain only what is usable; checks need what is in the file, and where.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import zip_longest
from math import isfinite
from typing import NamedTuple

from lxml import etree

from scenario_compiler.document import Document
from scenario_compiler.roads.lane_parse import TRUE
from scenario_compiler.roads.network import Network

START, END = "start", "end"
OTHER_END = {START: END, END: START}
LINK_AT = {START: "predecessor", END: "successor"}


class Link(NamedTuple):
    """A road's predecessor or successor: its element, kind ("road", "junction"), id and contact point."""

    element: etree._Element
    kind: str
    id: str
    contact: str


@dataclass(slots=True)
class Section:
    """A lane section: its start, its lanes by id (the first of each), and its row in the tables or -1."""

    element: etree._Element
    s: float
    lanes: dict[int, etree._Element]
    row: int = -1
    _linked: dict[tuple[int, str], frozenset[int]] = field(default_factory=dict)

    def linked(self, lane: int, end: str) -> frozenset[int]:
        """Return the lane ids to which a lane of the section is linked at an end."""
        key = (lane, end)
        if key not in self._linked:
            self._linked[key] = frozenset(target for target, _ in lane_links(self.lanes[lane], end))
        return self._linked[key]


@dataclass(slots=True)
class Road:
    """A road: its sections in ascending order of s, its links by end, its index in the tables or -1.

    `sides` has the sections that define the left lanes (1) and the others (-1): a one-sided section leaves those of the
    other side as they are.
    """

    element: etree._Element
    id: str
    length: float
    rule: str
    junction: str
    sections: list[Section]
    links: dict[str, Link]
    sides: dict[int, list[Section]]
    index: int = -1
    _ends: dict[str, Section] = field(default_factory=dict)

    @property
    def in_junction(self) -> bool:
        """Whether the road lies in a junction."""
        return self.junction not in {"-1", ""}

    def section(self, end: str) -> Section | None:
        """Return the lane section at an end, with the lanes of both sides."""
        if not self.sections:
            return None
        if end not in self._ends:
            at = 0 if end == START else -1
            left, other = (side[at] if side else self.sections[at] for side in self.sides.values())
            self._ends[end] = left
            if left is not other:
                last = max(left, other, key=lambda one: one.s)
                self._ends[end] = Section(last.element, last.s, {**other.lanes, **left.lanes}, last.row)
        return self._ends[end]

    def section_at(self, s: float, lane: int) -> Section | None:
        """Return the lane section that defines a lane's side at s."""
        side = self.sides[1 if lane > 0 else -1]
        at = bisect_right(side, s, key=lambda one: one.s) - 1
        return side[at] if at >= 0 else None

    def direction(self, lane: int, element: etree._Element | None) -> int:
        """Return 1 if a lane (element None: one that does not exist) is driven along s, -1 against it, 0 both ways."""
        direction = 1 if (lane < 0) == (self.rule != "LHT") else -1
        if element is None:
            return direction
        if element.get("direction") == "both" or element.get("type") == "bidirectional":
            return 0
        return -direction if element.get("direction") == "reversed" else direction

    def spans(self) -> Iterator[tuple[Section, Section | None, dict[int, etree._Element]]]:
        """Yield (section, next section of the same side or None, lanes of the side) for both sides of each section."""
        for sign, side in self.sides.items():
            for section, following in zip_longest(side, side[1:]):
                yield section, following, {k: lane for k, lane in section.lanes.items() if (k > 0) == (sign > 0)}


@dataclass(slots=True)
class Connection:
    """A junction's connection: its roads ("" if it names none) and its lane links (from, to, element)."""

    element: etree._Element
    incoming: str
    connecting: str
    contact: str
    lanes: list[tuple[int, int, etree._Element]]


@dataclass
class Filed:
    """The file, its network (None if there is none), and the connections by junction."""

    document: Document
    network: Network | None
    roads: dict[str, Road] = field(default_factory=dict)
    junctions: list[etree._Element] = field(default_factory=list)
    connections: list[list[Connection]] = field(default_factory=list)

    def junction(self, name: str) -> int:
        """Return the index of the first junction with an id, -1 if there is none."""
        return self._junctions.get(name, -1)

    @cached_property
    def _junctions(self) -> dict[str, int]:
        return {one.get("id", ""): i for i, one in reversed(list(enumerate(self.junctions)))}


def read_filed(document: Document, network: Network | None) -> Filed:
    """Collect the contents of a document; elements that cannot be distinguished (no id, a repeated id) count once."""
    junctions = list(document.root.iterfind("junction"))
    filed = Filed(document, network, {}, junctions, [list(_connections(junction)) for junction in junctions])
    for element in document.root.iterfind("road"):
        name = element.get("id")
        if name is not None and name not in filed.roads:
            filed.roads[name] = _road(element, name)
    if network is not None:
        for index, name in enumerate(network.road_ids):
            if name in filed.roads:
                _join(filed.roads[name], index, network)
    return filed


def number(element: etree._Element, name: str, default: float = 0.0) -> float:
    """Return an attribute as a finite number, or the default; the reader reports other texts."""
    try:
        value = float(element.get(name, ""))
    except ValueError:
        return default
    return value if isfinite(value) else default


def whole(element: etree._Element, name: str) -> int | None:
    """Return an attribute as an integer, None if it is not one."""
    text = element.get(name, "")
    try:
        return int(text) if len(text) < 16 else None
    except ValueError:
        return None


def lane_links(lane: etree._Element, end: str) -> Iterator[tuple[int, etree._Element]]:
    """Yield (lane id, element) of a lane's predecessors (at the start) or successors (at the end)."""
    for element in lane.iterfind(f"link/{LINK_AT[end]}"):
        name = whole(element, "id")
        if name is not None:
            yield name, element


def _connections(junction: etree._Element) -> Iterator[Connection]:
    """Yield the connections of a junction; those without a physical road ("virtual") are left out."""
    for element in junction.iterfind("connection"):
        if element.get("type") == "virtual":
            continue
        lanes = []
        for link in element.iterfind("laneLink"):
            first, last = whole(link, "from"), whole(link, "to")
            if first is not None and last is not None:
                lanes.append((first, last, link))
        connecting = element.get("connectingRoad") or element.get("linkedRoad") or ""
        yield Connection(element, element.get("incomingRoad", ""), connecting, element.get("contactPoint", ""), lanes)


def _road(element: etree._Element, name: str) -> Road:
    sections = [
        Section(section, number(section, "s"), _lanes(section)) for section in element.iterfind("lanes/laneSection")
    ]
    sections.sort(key=lambda one: one.s)
    links = {}
    for end, tag in LINK_AT.items():
        link = element.find(f"link/{tag}")
        if link is not None:
            kind, target = link.get("elementType", "road"), link.get("elementId", "")
            links[end] = Link(link, kind, target, link.get("contactPoint", ""))
    junction = element.get("junction", "-1")
    rule = element.get("rule", "RHT")
    sides = {1: _defining(sections, "left"), -1: _defining(sections, "right")}
    return Road(element, name, number(element, "length"), rule, junction, sections, links, sides)


def _defining(sections: list[Section], side: str) -> list[Section]:
    """Return the sections that define the lanes of a side."""
    return [
        one
        for i, one in enumerate(sections)
        if i == 0 or one.element.get("singleSide") not in TRUE or one.element.find(side) is not None
    ]


def _lanes(section: etree._Element) -> dict[int, etree._Element]:
    found: dict[int, etree._Element] = {}
    for side in ("left", "center", "right"):
        for lane in section.iterfind(f"{side}/lane"):
            name = whole(lane, "id")
            if name is not None:
                found.setdefault(name, lane)
    return found


def _join(road: Road, index: int, network: Network) -> None:
    """Find the rows of the road's sections in the tables, by s."""
    n = network.tables
    road.index = index
    rows = {n.section_s[row]: row for row in range(n.road_section[index], n.road_section[index + 1])}
    for i, section in enumerate(road.sections):
        section.row = rows.get(section.s, -1)
        if i == 0 and section.row < 0:
            section.row = rows.get(min(section.s, 0.0), -1)
