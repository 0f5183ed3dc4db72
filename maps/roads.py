"""Roads as tables of lanes, and the OpenDRIVE file they become.

Lanes of one name belong together: they are linked across every joint of sections and of roads, except where a
lane's width is zero, for there it begins or ends.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from lxml import etree
from scenariogeneration import xodr

from maps.paths import Path, Pose, end_of, length_of

DATE = "2026-01-01T00:00:00"
QUALITY_CODE = "marking_quality"
WIDE = 0.2


@dataclass(frozen=True)
class Mark:
    """A painted line: `kind` as in OpenDRIVE, width, and for broken lines the dash and the gap (m)."""

    kind: str
    width: float = 0.15
    dash: float = 0.0
    gap: float = 0.0


@dataclass(frozen=True)
class Lane:
    """A lane: name, OpenDRIVE type, width (m; a pair where it changes), outer mark, links if not by name."""

    name: str
    kind: str
    width: float | tuple[float, float]
    mark: Mark | None = None
    before: int | None = None
    after: int | None = None

    @property
    def widths(self) -> tuple[float, float]:
        """Width (m) at the section's start and end."""
        return self.width if isinstance(self.width, tuple) else (self.width, self.width)


@dataclass(frozen=True)
class Section:
    """A lane section: lanes from the centre outwards, centre mark, length (m; None: the road's rest)."""

    right: tuple[Lane, ...]
    left: tuple[Lane, ...] = ()
    centre: Mark | None = None
    length: float | None = None

    def lanes(self) -> dict[int, Lane]:
        """The lanes by OpenDRIVE id, left to right."""
        left = {i + 1: lane for i, lane in enumerate(self.left)}
        right = {-i - 1: lane for i, lane in enumerate(self.right)}
        return dict(sorted((left | right).items(), reverse=True))


@dataclass(frozen=True)
class Wear:
    """Paint of a given quality from `start` to `end` (m along the road): 1 fresh, 0 gone."""

    start: float
    end: float
    quality: float


@dataclass(frozen=True)
class Neighbour:
    """What a road is joined to: a road at its "start" or "end", or a junction (no contact)."""

    id: int
    contact: str | None = None


@dataclass(frozen=True)
class Signal:
    """A traffic light of three lamps: id, place (m), the travel it is meant for ("+" or "-"), first and last lane."""

    id: str
    s: float
    t: float
    orientation: str
    lanes: tuple[int, int]


@dataclass(frozen=True)
class Controller:
    """Signals that are switched together: OpenDRIVE id, name, ids of the signals."""

    id: str
    name: str
    signals: tuple[str, ...]


@dataclass(frozen=True)
class Road:
    """A road: OpenDRIVE type, speed limit (km/h), reference line, sections, wear, what it is joined to, signals."""

    id: int
    name: str
    kind: str
    speed: float
    start: Pose
    path: Path
    sections: tuple[Section, ...]
    wear: tuple[Wear, ...] = ()
    predecessor: Neighbour | None = None
    successor: Neighbour | None = None
    junction: int = -1
    signals: tuple[Signal, ...] = ()

    @property
    def length(self) -> float:
        """Length (m)."""
        return length_of(self.path)

    @property
    def end(self) -> Pose:
        """Pose of the reference line at the road's end."""
        return end_of(self.start, self.path)

    def section_at(self, contact: str) -> Section:
        """The first section for "start", the last for "end"."""
        return self.sections[0 if contact == "start" else -1]


@dataclass(frozen=True)
class Junction:
    """A junction: its connecting roads are the roads that name it."""

    id: int
    name: str


def opendrive(
    name: str, roads: Sequence[Road], junctions: Sequence[Junction], controllers: Sequence[Controller] = ()
) -> bytes:
    """The OpenDRIVE 1.6 file of a map, the same bytes for the same description."""
    by_id = {road.id: road for road in roads}
    drive = xodr.OpenDrive(name, revMinor="6")
    for road in roads:
        drive.add_road(_road(road, by_id))
    for junction in junctions:
        drive.add_junction(_junction(junction, roads, by_id))
    element = drive.get_element()
    _add_controllers(element, controllers)
    return _canonical(element)


def _road(road: Road, roads: Mapping[int, Road]) -> xodr.Road:
    lanes = xodr.Lanes()
    for index, (s, length) in enumerate(_extents(road)):
        lanes.add_lanesection(_section(road, index, s, length, roads))
    made = xodr.Road(road.id, _plan_view(road), lanes, road_type=road.junction, name=road.name)
    made.add_elevation(0, 0, 0, 0, 0)
    made.add_type(xodr.RoadType[road.kind], 0, None, road.speed, "km/h")
    for add, neighbour in ((made.add_predecessor, road.predecessor), (made.add_successor, road.successor)):
        if neighbour is not None:
            kind = xodr.ElementType.road if neighbour.contact else xodr.ElementType.junction
            contact = xodr.ContactPoint[neighbour.contact] if neighbour.contact else None
            add(kind, neighbour.id, contact)
    for signal in road.signals:
        made.add_signal(_signal(signal))
    return made


def _signal(signal: Signal) -> xodr.Signal:
    made = xodr.Signal(
        signal.s,
        signal.t,
        "DE",
        "1000001",
        "-1",
        id=signal.id,
        name=f"light_{signal.id}",
        dynamic=xodr.Dynamic.yes,
        orientation=xodr.Orientation.positive if signal.orientation == "+" else xodr.Orientation.negative,
        zOffset=2.5,
        height=0.9,
        width=0.3,
    )
    made.add_validity(*signal.lanes)
    return made


def _add_controllers(drive: ElementTree.Element, controllers: Sequence[Controller]) -> None:
    """Writes the controllers after the roads, where the schema wants them."""
    place = max(index for index, child in enumerate(drive) if child.tag == "road") + 1
    for number, one in enumerate(controllers):
        element = ElementTree.Element("controller", {"id": one.id, "name": one.name, "sequence": str(number)})
        for signal in one.signals:
            ElementTree.SubElement(element, "control", {"signalId": signal, "type": "0"})
        drive.insert(place + number, element)


def _plan_view(road: Road) -> xodr.PlanView:
    view = xodr.PlanView()
    pose, s = road.start, 0.0
    turns = pose.heading - math.remainder(pose.heading, math.tau)
    for piece in road.path:
        k0, k1, length = piece.curvature_start, piece.curvature_end, piece.known_length
        if k0 == k1 == 0.0:
            shape = xodr.Line(length)
        elif k0 == k1:
            shape = xodr.Arc(k0, length)
        else:
            shape = xodr.Spiral(k0, k1, length)
        heading = pose.heading - turns
        view.add_fixed_geometry(shape, round(pose.x, 7), round(pose.y, 7), round(heading, 10), round(s, 6))
        pose, s = end_of(pose, (piece,)), s + length
    return view


def _extents(road: Road) -> list[tuple[float, float]]:
    """Start and length (m) of each section.

    Raises:
        ValueError: The sections do not fill the road.
    """
    known = sum(section.length or 0.0 for section in road.sections)
    extents, s = [], 0.0
    for section in road.sections:
        length = round(road.length - known, 6) if section.length is None else section.length
        extents.append((round(s, 6), length))
        s += length
    if abs(s - road.length) > 1e-6 or any(length <= 0.0 for _, length in extents):
        raise ValueError(f"the sections of road {road.name} do not fill its {road.length} m")
    return extents


def _section(road: Road, index: int, s: float, length: float, roads: Mapping[int, Road]) -> xodr.LaneSection:
    section = road.sections[index]
    clipped = [Wear(max(w.start - s, 0.0), min(w.end - s, length), w.quality) for w in road.wear]
    wear = [w for w in clipped if w.end > w.start]
    centre = xodr.Lane()
    _add_marks(centre, section.centre, wear, length)
    made = xodr.LaneSection(s, centre)
    for number, lane in sorted(section.lanes().items(), key=lambda item: abs(item[0])):
        first, last = lane.widths
        quadratic, cubic = 3.0 * (last - first) / length**2, 2.0 * (first - last) / length**3
        written = xodr.Lane(xodr.LaneType[lane.kind], first, 0.0, quadratic, cubic)
        _add_marks(written, lane.mark, wear, length)
        for side, link in (
            ("predecessor", lane_before(road, index, lane, roads)),
            ("successor", lane_after(road, index, lane, roads)),
        ):
            if link is not None:
                written.add_link(side, link)
        if number > 0:
            made.add_left_lane(written)
        else:
            made.add_right_lane(written)
    return made


def lane_before(road: Road, index: int, lane: Lane, roads: Mapping[int, Road]) -> int | None:
    """Id of the lane that precedes `lane` of the road's section `index`, None where it begins there."""
    if lane.before is not None:
        return lane.before
    if lane.widths[0] == 0.0:
        return None
    if index > 0:
        return _named(road.sections[index - 1], lane.name)
    return _across(road.predecessor, lane.name, roads)


def lane_after(road: Road, index: int, lane: Lane, roads: Mapping[int, Road]) -> int | None:
    """Id of the lane that follows `lane` of the road's section `index`, None where it ends there."""
    if lane.after is not None:
        return lane.after
    if lane.widths[1] == 0.0:
        return None
    if index + 1 < len(road.sections):
        return _named(road.sections[index + 1], lane.name)
    return _across(road.successor, lane.name, roads)


def _across(neighbour: Neighbour | None, name: str, roads: Mapping[int, Road]) -> int | None:
    if neighbour is None or neighbour.contact is None:
        return None
    return _named(roads[neighbour.id].section_at(neighbour.contact), name)


def _named(section: Section, name: str) -> int | None:
    return next((number for number, lane in section.lanes().items() if lane.name == name), None)


def _add_marks(lane: xodr.Lane, mark: Mark | None, wear: Sequence[Wear], length: float) -> None:
    """Writes the lane's mark, cut where its quality changes; dashes start anew at each cut."""
    if mark is None:
        lane.add_roadmark(xodr.RoadMark(xodr.RoadMarkType.none))
        return
    s = 0.0
    for stretch in (*wear, Wear(length, length, 1.0)):
        if stretch.start > s:
            lane.add_roadmark(_mark(mark, s, 1.0))
        if stretch.end > stretch.start:
            lane.add_roadmark(_mark(mark, stretch.start, stretch.quality))
        s = stretch.end


def _mark(mark: Mark, s: float, quality: float) -> xodr.RoadMark:
    if quality == 0.0:
        return xodr.RoadMark(xodr.RoadMarkType.none, soffset=s, laneChange=xodr.LaneChange.both)
    solid = mark.kind == "solid"
    written = xodr.RoadMark(
        xodr.RoadMarkType[mark.kind],
        mark.width,
        soffset=s,
        color=xodr.RoadMarkColor.white,
        marking_weight=xodr.RoadMarkWeight.bold if mark.width > WIDE else xodr.RoadMarkWeight.standard,
        laneChange=xodr.LaneChange.none if solid else xodr.LaneChange.both,
    )
    if not solid:
        rule = xodr.MarkRule.none
        written.add_specific_road_line(xodr.RoadLine(mark.width, mark.dash, mark.gap, rule=rule))
    if quality < 1.0:
        written.add_userdata(xodr.UserData(QUALITY_CODE, str(quality)))
    return written


def _junction(junction: Junction, roads: Sequence[Road], by_id: Mapping[int, Road]) -> xodr.Junction:
    made = xodr.Junction(junction.name, junction.id)
    for road in roads:
        if road.junction != junction.id or road.predecessor is None:
            continue
        connection = xodr.Connection(road.predecessor.id, road.id, xodr.ContactPoint.start)
        for number, lane in road.sections[0].lanes().items():
            before = lane_before(road, 0, lane, by_id)
            if before is not None:
                connection.add_lanelink(before, number)
        made.add_connection(connection)
    return made


def _canonical(drive: ElementTree.Element) -> bytes:
    """The document with a fixed date, extra data last in its parent as the schema asks, evenly indented."""
    header = _child(drive, "header")
    header.set("date", DATE)
    for side in ("north", "south", "east", "west"):
        del header.attrib[side]
    for road in drive.iter("road"):
        road.remove(_child(road, "lateralProfile"))
        for measured in (road, *road.iter("geometry")):
            measured.set("length", str(round(float(measured.get("length", "0")), 6)))
    for mark in drive.iter("roadMark"):
        for data in mark.findall("userData"):
            mark.remove(data)
            mark.append(data)
    tree = etree.fromstring(ElementTree.tostring(drive), etree.XMLParser(remove_blank_text=True))
    etree.indent(tree, "  ")
    return etree.tostring(tree, encoding="utf-8", xml_declaration=True) + b"\n"


def _child(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    found = element.find(tag)
    if found is None:
        raise ValueError(f"<{element.tag}> has no <{tag}>")
    return found
