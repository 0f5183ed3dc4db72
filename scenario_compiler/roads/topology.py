"""Links of roads, lanes and junctions as rows: the lanes in which each lane continues.

A link joins an end of a lane's row (in one lane section) with an end of another one's, and is kept in both directions,
regardless of which of them the file states. Sources: the lanes' own predecessors and successors, at joints of lane
sections and of roads; the lane links of junction connections (default and direct); and if a connection names no lanes,
the connecting road's own lane links. If a joint names no lane at all, lanes with the same id are linked.
"""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import pi

from scenario_compiler.diagnostics import Code, Severity, did_you_mean
from scenario_compiler.roads.attachments import CUT_TOLERANCE, Attachment
from scenario_compiler.roads.elements import PlainElement, grandchildren
from scenario_compiler.roads.geometry import road_heading, road_reference, wrap_angle
from scenario_compiler.roads.lane_parse import LaneLinks
from scenario_compiler.roads.lanes import lane_row_in
from scenario_compiler.roads.reading import Reader
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables

UNKNOWN_LINK = Code(
    "SC313",
    "unknown-road-link",
    "A road, junction or connection links to a road or junction that the file does not have, or that could not be "
    "used. The link is ignored, so traffic cannot continue there.\n\n"
    '    <successor elementType="road" elementId="77" contactPoint="start"/>     there is no road 77\n\n'
    "Correct the id, or remove the link if the road really ends there.",
    Severity.WARNING,
)

CONTACTS = {"start": AT_START, "end": AT_END}
"""The standard's words for the end of a road that a link touches."""


@dataclass(slots=True)
class Connection:
    """One connection of a junction: from a road into another at its start or end, lane by lane."""

    incoming: int
    road: int
    contact: int
    lanes: list[tuple[int, int]]


class _Links:
    """Collects links between ends of lane rows, each once, in both directions.

    Attributes:
        ends: For an end, numbered as in `LaneLinks`, the row and contact of each end that is linked to it, and whether
            the link is to a place inside another road.
    """

    def __init__(self) -> None:
        self.ends: defaultdict[int, dict[tuple[int, int], bool]] = defaultdict(dict)

    def add(self, row: int, end: int, other: int, contact: int, branch: bool = False) -> None:
        self.ends[2 * row + end][other, contact] = branch
        self.ends[2 * other + contact][row, end] = branch


def build_links(
    reader: Reader,
    n: RoadTables,
    root: PlainElement,
    roads: list[PlainElement],
    road_ids: list[str],
    junctions: dict[str, int],
    lane_links: LaneLinks,
    attachments: Sequence[Attachment] = (),
) -> None:
    """Fill the link columns from the links of roads and lanes, the junctions, and the roads attached to others."""
    index = {name: i for i, name in enumerate(road_ids)}
    inside = {(one.road, one.end) for one in attachments}
    for element in roads:
        _read_road_links(reader, n, element, index, junctions, inside)
    links = _Links()
    for road in range(len(roads)):
        for section in range(n.road_section[road], n.road_section[road + 1] - 1):
            _link_joint(n, links, lane_links, (section, AT_END), (section + 1, AT_START))
    connections = {
        i: list(_read_connections(reader, element, index)) for i, element in enumerate(root.findall("junction"))
    }
    for road in range(len(roads)):
        for end in (AT_START, AT_END):
            _link_road_end(n, links, lane_links, road, end, connections)
    named: dict[tuple[int, int, int], list[tuple[int, int]]] = {}
    for one in (one for found in connections.values() for one in found):
        named.setdefault((one.incoming, one.road, one.contact), []).extend(one.lanes)
    for attachment in attachments:
        _link_attachment(n, links, lane_links, attachment, index, named)
    _store(n, links)


def _read_road_links(
    reader: Reader,
    n: RoadTables,
    element: PlainElement,
    index: dict[str, int],
    junctions: dict[str, int],
    inside: set[tuple[str, int]],
) -> None:
    for name, roads, contacts, into in (
        ("predecessor", n.road_start_road, n.road_start_contact, n.road_start_junction),
        ("successor", n.road_end_road, n.road_end_contact, n.road_end_junction),
    ):
        link = next(iter(grandchildren(element, "link", name)), None)
        road = junction = contact = -1
        end = AT_START if name == "predecessor" else AT_END
        if link is not None and (element.get("id", ""), end) not in inside:
            target = link.get("elementId", "")
            if link.get("elementType") == "junction":
                junction = junctions.get(target, -1)
                known = junctions
            else:
                road = index.get(target, -1)
                known = index
                contact = CONTACTS.get(link.get("contactPoint", ""), -1)
                if road >= 0 and contact < 0:
                    contact = _nearest_contact(n, len(roads), end, road)
            if road < 0 and junction < 0:
                message = f"the {name} '{target}' does not exist"
                if len(known) < 1000:
                    hint = did_you_mean(target, known)
                    message += f"; {hint}" if hint else ""
                reader.report(UNKNOWN_LINK, message, link, "elementId")
        roads.append(road)
        contacts.append(contact)
        into.append(junction)


def _nearest_contact(n: RoadTables, road: int, end: int, other: int) -> int:
    """Return the end of another road that is nearest to an end of a road."""
    x, y, _, _ = road_reference(n, road, n.road_length[road] if end == AT_END else 0.0)
    gaps = []
    for s in (0.0, n.road_length[other]):
        ox, oy, _, _ = road_reference(n, other, s)
        gaps.append((ox - x) * (ox - x) + (oy - y) * (oy - y))
    return AT_START if gaps[0] <= gaps[1] else AT_END


def _read_connections(reader: Reader, junction: PlainElement, index: dict[str, int]) -> Iterator[Connection]:
    for element in junction.findall("connection"):
        attribute = "connectingRoad" if element.get("connectingRoad") is not None else "linkedRoad"
        incoming, road = (
            index.get(element.get("incomingRoad", ""), -1),
            index.get(element.get(attribute, ""), -1),
        )
        contact = CONTACTS.get(element.get("contactPoint", ""), -1)
        if element.get("type") == "virtual":
            continue
        if incoming < 0 or road < 0:
            name = "incomingRoad" if incoming < 0 else attribute
            message = f"the road '{element.get(name, '')}' of a connection does not exist"
            reader.report(UNKNOWN_LINK, message, element, name if element.get(name) is not None else None)
            continue
        lanes = []
        for link in element.findall("laneLink"):
            before, after = reader.integer(link, "from"), reader.integer(link, "to")
            if before is not None and after is not None:
                lanes.append((before, after))
        yield Connection(incoming, road, AT_START if contact < 0 else contact, lanes)


def _end_section(n: RoadTables, road: int, end: int) -> int:
    """Return the first or last lane section of a road, -1 if it has none."""
    if n.road_section[road] == n.road_section[road + 1]:
        return -1
    return n.road_section[road] if end == AT_START else n.road_section[road + 1] - 1


def _rows(n: RoadTables, section: int) -> range:
    return range(n.section_lane[section], n.section_lane[section + 1])


def _link_joint(
    n: RoadTables, links: _Links, lane_links: LaneLinks, one: tuple[int, int], other: tuple[int, int]
) -> None:
    """Link the lanes of two touching sections, each given with the end that is touched."""
    named = False
    for (section, end), (target, contact) in ((one, other), (other, one)):
        for row in _rows(n, section):
            for lane in lane_links.get(2 * row + end, ()):
                named = True
                found = lane_row_in(n, target, lane)
                if found >= 0 and lane != 0 and n.lane_id[row] != 0:
                    links.add(row, end, found, contact)
    if named:
        return
    sign = 1 if one[1] != other[1] else -1
    for row in _rows(n, one[0]):
        found = lane_row_in(n, other[0], sign * n.lane_id[row])
        if n.lane_id[row] != 0 and found >= 0:
            links.add(row, one[1], found, other[1])


def _link_road_end(
    n: RoadTables,
    links: _Links,
    lane_links: LaneLinks,
    road: int,
    end: int,
    connections: dict[int, list[Connection]],
) -> None:
    section = _end_section(n, road, end)
    if section < 0:
        return
    other = n.road_start_road[road] if end == AT_START else n.road_end_road[road]
    contact = n.road_start_contact[road] if end == AT_START else n.road_end_contact[road]
    junction = n.road_start_junction[road] if end == AT_START else n.road_end_junction[road]
    if other >= 0:
        target = _end_section(n, other, contact)
        if target >= 0 and _touches(n, other, contact, road, end):
            _link_joint(n, links, lane_links, (section, end), (target, contact))
    for connection in connections.get(junction, ()):
        if connection.incoming != road or not _touches(n, connection.road, connection.contact, road, end):
            continue
        target = _end_section(n, connection.road, connection.contact)
        if target < 0:
            continue
        for before, after in connection.lanes:
            row, found = lane_row_in(n, section, before), lane_row_in(n, target, after)
            if row >= 0 and found >= 0 and before != 0 and after != 0:
                links.add(row, end, found, connection.contact)
        if not connection.lanes:
            _link_joint(n, links, lane_links, (target, connection.contact), (section, end))


def _link_attachment(
    n: RoadTables,
    links: _Links,
    lane_links: LaneLinks,
    attachment: Attachment,
    index: dict[str, int],
    named: dict[tuple[int, int, int], list[tuple[int, int]]],
) -> None:
    """Link the lanes of a road's end to those of the part of another road that it touches.

    Junction connections and the lanes' own links define them; without either, lanes with the same id are linked, or
    with the opposite one if the roads' directions are opposed.
    """
    road, main = index.get(attachment.road, -1), index.get(attachment.main, -1)
    if road < 0 or main < 0:
        return
    section = _end_section(n, road, attachment.end)
    last = n.road_section[main + 1]
    target = bisect_left(n.section_s, attachment.s - CUT_TOLERANCE, n.road_section[main], last)
    if section < 0 or target == last or n.section_s[target] > attachment.s + CUT_TOLERANCE:
        return
    if attachment.contact == AT_END:
        target -= 1
    rows = _rows(n, section)
    pairs = [(lane, n.lane_id[row]) for row in rows for lane in lane_links.get(2 * row + attachment.end, ())]
    pairs.extend(named.get((main, road, attachment.end), ()))
    sign = 1 if attachment.end != attachment.contact else -1
    for lane, own in pairs or [(sign * n.lane_id[row], n.lane_id[row]) for row in rows]:
        found, row = lane_row_in(n, target, lane), lane_row_in(n, section, own)
        if found >= 0 and row >= 0 and lane != 0 and own != 0:
            links.add(found, attachment.contact, row, attachment.end, branch=True)


def _touches(n: RoadTables, road: int, contact: int, other: int, end: int) -> bool:
    """Return whether an end of a road does not name another road, or another end of that road, as its neighbour."""
    named = n.road_start_road[road] if contact == AT_START else n.road_end_road[road]
    named_end = n.road_start_contact[road] if contact == AT_START else n.road_end_contact[road]
    return named != other or named_end == end


def _store(n: RoadTables, links: _Links) -> None:
    turns = [_turn(n, road) for road in range(len(n.road_length))]
    exits: list[dict[tuple[int, int], None]] = [{} for _ in range(2 * len(n.road_length))]
    for row, section in enumerate(n.lane_section):
        for end in (AT_START, AT_END):
            ends = links.ends.get(2 * row + end)
            if ends is not None:
                road = n.section_road[section]
                at_road_end = section == _end_section(n, road, end)
                for (other, contact), branch in ends.items():
                    target = n.section_road[n.lane_section[other]]
                    n.link_lane.append(other)
                    n.link_contact.append(contact)
                    n.link_turn.append(pi if branch else turns[target])
                    if at_road_end and not branch:
                        exits[2 * road + end][target, contact] = None
            n.lane_link.append(len(n.link_lane))
    for roads in exits:
        n.exit_road.extend([road for road, _ in roads])
        n.exit_contact.extend([contact for _, contact in roads])
        n.road_exit.append(len(n.exit_road))


def _turn(n: RoadTables, road: int) -> float:
    """Return the absolute change of heading between a road's ends, rad, at most pi."""
    if n.road_junction[road] < 0:
        return 0.0
    return min(pi, abs(wrap_angle(road_heading(n, road, n.road_length[road]) - road_heading(n, road, 0.0))))
