"""A short stretch of a road as a road of its own, written as OpenDRIVE elements."""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass

from lxml import etree

from scenario_compiler.roads.geometry import (
    road_elevation,
    road_reference,
    road_superelevation,
    wrap_angle,
)
from scenario_compiler.roads.lanes import lane_borders, lane_width
from scenario_compiler.roads.missing_marks import mark_lanes
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.text_edits import number_of

_RECORDS = ("roadMark", "material", "speed", "access", "height", "rule")
"""Records of a lane that are valid from an sOffset on; the one valid at the joint is copied."""


@dataclass(frozen=True)
class Stretch:
    """A stretch of a road that becomes a road of its own, in the direction of travel, and its neighbours.

    Attributes:
        road: Index of the road.
        low: s of its start, m.
        high: s of its end, m; both within one lane section.
        along: Whether the new road runs along the road's s.
        before: Id of the road before it and the end that it touches ("start" or "end").
        after: Likewise for the road after it, or the id of a junction and "".
        lanes: (lane of the road, lane of the road before, lane of the road after; 0 if there is none), each once.
    """

    road: int
    low: float
    high: float
    along: bool
    before: tuple[str, str]
    after: tuple[str, str]
    lanes: tuple[tuple[int, int, int], ...]

    @property
    def ends(self) -> tuple[float, float]:
        """The s of the road where the new one starts and where it ends, m."""
        return (self.low, self.high) if self.along else (self.high, self.low)


def build_road(
    network: Network, roads: dict[str, etree._Element], stretch: Stretch, name: str, junction: str
) -> tuple[etree._Element, etree._Element]:
    """Return (the new road, the connection of a junction that leads into it).

    Its surface is that of the original road: the reference line is an arc with the mean curvature (over 0.1 m the error
    is below a micrometre); widths, lane offset, height and roll are linear.

    Args:
        network: The network of the road.
        roads: The roads' elements by id.
        stretch: The stretch that becomes the new road.
        name: Id of the new road.
        junction: Id of its junction, "-1" for none.
    """
    source = roads[network.road_ids[stretch.road]]
    road = etree.Element("road", name="", length=repr(stretch.high - stretch.low), id=name, junction=junction)
    if network.tables.road_rule[stretch.road] < 0:
        road.set("rule", "LHT")
    link = etree.SubElement(road, "link")
    for tag, (neighbour, contact) in (("predecessor", stretch.before), ("successor", stretch.after)):
        attributes = {"elementType": "road" if contact else "junction", "elementId": neighbour}
        etree.SubElement(link, tag, attributes | ({"contactPoint": contact} if contact else {}))
    _copy_type(road, source, stretch.low)
    _write_line(road, network.tables, stretch)
    _write_profiles(road, network.tables, stretch)
    incoming = {"incomingRoad": stretch.before[0], "connectingRoad": name, "contactPoint": "start"}
    connection = etree.Element("connection", {"id": "0", **incoming})
    _write_lanes(road, connection, network.tables, source, stretch)
    return road, connection


def _copy_type(road: etree._Element, source: etree._Element, s: float) -> None:
    records = [one for one in source.iterfind("{*}type") if number_of(one, "s") <= s + 1e-9]
    if records:
        kept = copy.deepcopy(max(records, key=lambda one: number_of(one, "s")))
        kept.tail = None
        kept.set("s", "0")
        road.append(kept)


def _write_line(road: etree._Element, n: RoadTables, stretch: Stretch) -> None:
    start, end = stretch.ends
    length = stretch.high - stretch.low
    x, y, heading, _ = road_reference(n, stretch.road, start)
    turn = wrap_angle(road_reference(n, stretch.road, end)[2] - heading)
    curvature = turn / length if length > 0.0 else 0.0
    if not stretch.along:
        heading += math.pi
    plan = etree.SubElement(road, "planView")
    attributes = {"s": "0", "x": repr(x), "y": repr(y), "hdg": repr(heading), "length": repr(length)}
    piece = etree.SubElement(plan, "geometry", attributes)
    if abs(curvature) < 1e-9:
        etree.SubElement(piece, "line")
    else:
        etree.SubElement(piece, "arc", curvature=repr(curvature))


def _write_profiles(road: etree._Element, n: RoadTables, stretch: Stretch) -> None:
    sign = 1.0 if stretch.along else -1.0
    z = [road_elevation(n, stretch.road, s) for s in stretch.ends]
    roll = [sign * road_superelevation(n, stretch.road, s) for s in stretch.ends]
    length = stretch.high - stretch.low
    profile = etree.SubElement(road, "elevationProfile")
    if any(z):
        _cubic(profile, "elevation", "s", z, length)
    profile = etree.SubElement(road, "lateralProfile")
    if any(roll):
        _cubic(profile, "superelevation", "s", roll, length)


def _cubic(parent: etree._Element, tag: str, key: str, ends: list[float], length: float) -> None:
    """Append a record that runs linearly from one value to another."""
    slope = (ends[1] - ends[0]) / length if length > 0.0 else 0.0
    values = {key: "0", "a": repr(ends[0]), "b": repr(slope), "c": "0", "d": "0"}
    etree.SubElement(parent, tag, values)


def _write_lanes(
    road: etree._Element, connection: etree._Element, n: RoadTables, source: etree._Element, stretch: Stretch
) -> None:
    """Write the lane section: on each side all lanes from the inmost to the outmost named one; others have no links.

    If only one side has lanes, the lane offset shifts the centre lane to their inner border.
    """
    chosen = {lane: (before, after) for lane, before, after in stretch.lanes}
    signs = sorted({1 if lane > 0 else -1 for lane in chosen})
    inmost = 1 if len(signs) == 2 else min(map(abs, chosen))
    inner = [_inner_border(n, stretch.road, signs[0] * inmost, s) for s in stretch.ends]
    if not stretch.along:
        inner = [-t for t in inner]
    lanes = etree.SubElement(road, "lanes")
    if any(inner):
        _cubic(lanes, "laneOffset", "s", inner, stretch.high - stretch.low)
    section = etree.SubElement(lanes, "laneSection", s="0")
    originals = _lanes_at(source, 0.5 * (stretch.low + stretch.high))
    sides: dict[int, etree._Element] = {}
    for sign in signs:
        side = sign if stretch.along else -sign
        sides[side] = etree.Element("left" if side > 0 else "right")
        outmost = max(abs(lane) for lane in chosen if lane * sign > 0)
        for distance in range(inmost, outmost + 1):
            lane, own = sign * distance, side * (distance - inmost + 1)
            element = _lane(n, stretch, lane, own, chosen.get(lane), originals.get(lane))
            sides[side].insert(0 if side > 0 else len(sides[side]), element)
            if chosen.get(lane, (0, 0))[0] != 0:
                etree.SubElement(connection, "laneLink", {"from": str(chosen[lane][0]), "to": str(own)})
    centre = etree.Element("center")
    etree.SubElement(centre, "lane", id="0", type="none", level="false")
    if len(signs) == 2 and 0 in originals:
        _copy_records(centre[0], originals[0], stretch.low)
    section.extend([one for one in (sides.get(1), centre, sides.get(-1)) if one is not None])
    mark_lanes(road)


def _lane(
    n: RoadTables,
    stretch: Stretch,
    lane: int,
    own: int,
    neighbours: tuple[int, int] | None,
    original: etree._Element | None,
) -> etree._Element:
    element = etree.Element("lane", id=str(own), type="none", level="false")
    if neighbours is not None and any(neighbours):
        link = etree.SubElement(element, "link")
        for tag, linked in zip(("predecessor", "successor"), neighbours, strict=True):
            if linked != 0:
                etree.SubElement(link, tag, id=str(linked))
    widths = [lane_width(n, stretch.road, lane, s) for s in stretch.ends]
    _cubic(element, "width", "sOffset", widths, stretch.high - stretch.low)
    if original is not None and neighbours is not None:
        element.set("type", original.get("type", "none"))
        element.set("level", original.get("level", "false"))
        _copy_records(element, original, stretch.low)
    return element


def _inner_border(n: RoadTables, road: int, lane: int, s: float) -> float:
    left, right = lane_borders(n, road, lane, s)
    return right if lane > 0 else left


def _lanes_at(source: etree._Element, s: float) -> dict[float, etree._Element]:
    """Return the elements of the lanes at s by id, which need not be an integer."""
    sections = [one for one in source.iterfind("{*}lanes/{*}laneSection") if number_of(one, "s") <= s]
    if not sections:
        return {}
    section = max(sections, key=lambda one: number_of(one, "s"))
    return {number_of(one, "id"): one for one in section.iterfind("{*}*/{*}lane")}


def _copy_records(element: etree._Element, original: etree._Element, low: float) -> None:
    """Copy the records that are valid at the joint, from the start of the new lane on."""
    for tag in _RECORDS:
        s = low - _section_start(original)
        records = [one for one in original.iterfind(f"{{*}}{tag}") if number_of(one, "sOffset") <= s + 1e-9]
        latest = max((number_of(one, "sOffset") for one in records), default=0.0)
        for one in records:
            if number_of(one, "sOffset") == latest:
                kept = copy.deepcopy(one)
                kept.tail = None
                kept.set("sOffset", "0")
                for explicit in kept.findall("{*}explicit"):
                    kept.remove(explicit)
                element.append(kept)


def _section_start(lane: etree._Element) -> float:
    side = lane.getparent()
    section = side.getparent() if side is not None else None
    return number_of(section, "s") if section is not None else 0.0
