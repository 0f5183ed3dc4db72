"""Reads the links of roads and junctions, and what the file states about the lanes in which each lane continues.

A link joins an end of a lane's row (in one lane section) with an end of another one's, and is kept in both directions,
regardless of which of them the file states. Sources: the lanes' own predecessors and successors, at joints of lane
sections and of roads; the lane links of junction connections (default and direct); and if a connection names no lanes,
the connecting road's own lane links. If a joint names no lane at all, lanes with the same id are linked.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, chain

from scenario_compiler.diagnostics import Code, Severity, did_you_mean
from scenario_compiler.roads.attachments import CUT_TOLERANCE, Attachment
from scenario_compiler.roads.elements import PlainElement, grandchildren
from scenario_compiler.roads.geometry import road_reference
from scenario_compiler.roads.lane_parse import LaneLinks
from scenario_compiler.roads.lanes import lane_row_in
from scenario_compiler.roads.link_build import end_section
from scenario_compiler.roads.reading import Reader
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables

UNKNOWN_LINK = Code(
    "SC313",
    "unknown-road-link",
    "A road, junction or connection names a road or junction that the file does not have, or that could not be "
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


@dataclass(frozen=True, slots=True)
class StatedLinks:
    """What a road file states about the links of lanes, as arrays for the functions of `link_build`.

    Attributes:
        of_ends: Row starts of `lanes`, by ends of lanes.
        lanes: The ids of the lanes to which the ends are linked.
        of_junctions: Row starts of `connections`, by junctions.
        connections: Four numbers of each connection: road it comes from, road it leads to, touched end, start of its
            pairs. The last four numbers are only the end of the last one's pairs.
        pairs: The two lanes of each pair of lanes that a connection names.
        branches: Pairs of ends of lanes: one is that of a road, the other a place inside another road.
    """

    of_ends: array[int]
    lanes: array[int]
    of_junctions: array[int]
    connections: array[int]
    pairs: array[int]
    branches: list[tuple[int, int]]


def read_links(
    reader: Reader,
    n: RoadTables,
    root: PlainElement,
    roads: list[PlainElement],
    road_ids: list[str],
    junctions: dict[str, int],
    lane_links: LaneLinks,
    attachments: Sequence[Attachment] = (),
) -> StatedLinks:
    """Fill the columns of the links of roads, and return what the file states about those of lanes.

    The knots of curves must be filled: a link without a contact point is to the nearest end of the other road.
    """
    index = {name: i for i, name in enumerate(road_ids)}
    inside = {(one.road, one.end) for one in attachments}
    for element in roads:
        _read_road_links(reader, n, element, index, junctions, inside)
    connections = [list(_read_connections(reader, element, index)) for element in root.findall("junction")]
    named: dict[tuple[int, int, int], list[tuple[int, int]]] = {}
    if attachments:
        for one in chain.from_iterable(connections):
            named.setdefault((one.incoming, one.road, one.contact), []).extend(one.lanes)
    branches = [pair for one in attachments for pair in _branches(n, lane_links, one, index, named)]
    return _stated(2 * len(n.lane_id), lane_links, connections, branches)


def _stated(
    ends: int, lane_links: LaneLinks, connections: list[list[Connection]], branches: list[tuple[int, int]]
) -> StatedLinks:
    counts = [0] * ends
    for end, lanes in lane_links.items():
        counts[end] = len(lanes)
    rows, pairs = array("q"), array("q")
    for one in chain.from_iterable(connections):
        rows.extend((one.incoming, one.road, one.contact, len(pairs) // 2))
        pairs.extend(chain.from_iterable(one.lanes))
    rows.extend((-1, -1, -1, len(pairs) // 2))
    return StatedLinks(
        of_ends=array("q", accumulate(counts, initial=0)),
        lanes=array("q", chain.from_iterable(lane_links[end] for end in sorted(lane_links))),
        of_junctions=array("q", accumulate(map(len, connections), initial=0)),
        connections=rows,
        pairs=pairs,
        branches=branches,
    )


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
    """Yield the connections of a junction; one without lanes, which joins all lanes of its roads, only once."""
    whole: set[tuple[int, int, int]] = set()
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
        found = Connection(incoming, road, AT_START if contact < 0 else contact, lanes)
        if lanes:
            yield found
        elif (incoming, road, found.contact) not in whole:
            whole.add((incoming, road, found.contact))
            yield found


def _branches(
    n: RoadTables,
    lane_links: LaneLinks,
    attachment: Attachment,
    index: dict[str, int],
    named: dict[tuple[int, int, int], list[tuple[int, int]]],
) -> Iterator[tuple[int, int]]:
    """Yield links between ends of lanes: of a road's end, and of the part of another road that it touches.

    Junction connections and the lanes' own links define them; without either, lanes with the same id are linked, or
    with the opposite one if the roads' directions are opposed.
    """
    road, main = index.get(attachment.road, -1), index.get(attachment.main, -1)
    if road < 0 or main < 0:
        return
    section = end_section(n, road, attachment.end)
    last = n.road_section[main + 1]
    target = bisect_left(n.section_s, attachment.s - CUT_TOLERANCE, n.road_section[main], last)
    if section < 0 or target == last or n.section_s[target] > attachment.s + CUT_TOLERANCE:
        return
    if attachment.contact == AT_END:
        target -= 1
    rows = range(n.section_lane[section], n.section_lane[section + 1])
    pairs = [(lane, n.lane_id[row]) for row in rows for lane in lane_links.get(2 * row + attachment.end, ())]
    pairs.extend(named.get((main, road, attachment.end), ()))
    sign = 1 if attachment.end != attachment.contact else -1
    for lane, own in pairs or [(sign * n.lane_id[row], n.lane_id[row]) for row in rows]:
        found, row = lane_row_in(n, target, lane), lane_row_in(n, section, own)
        if found >= 0 and row >= 0 and lane != 0 and own != 0:
            yield 2 * found + attachment.contact, 2 * row + attachment.end
