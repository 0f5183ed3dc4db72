"""An OpenDRIVE file as CARLA's clients 0.9.15 and 0.9.16 can load it with every lane connected.

What goes in: a document and the network read from it. What comes out: the same text but for what those clients cannot
use:

* A direct junction joins roads without a connecting road. 0.9.15 dies of it, 0.9.16 raises IndexError (both look up
  road 0). It becomes a default junction. At each joint the last `JOINT_LENGTH` of one of the roads is cut off, and
  connecting roads of that length lie there instead, one a direction of travel and neighbour, with links of roads and
  lanes on both sides: 0.9.16 follows a connection only where the connecting road names the incoming road as its
  predecessor and its lanes name theirs.
* A lane link that only one of two joined lanes states is stated by both: traffic that leaves the other does not follow.
* In a ring of one road or of two, 0.9.16 joins nothing: it leaves out what leads back at once. Such a ring gets one or
  two roads more, of `JOINT_LENGTH` each.
* Of a road that leaves a junction and comes back to it, 0.9.16 confuses the ends. Its last `JOINT_LENGTH` becomes a
  road of its own.
* Where a lane has no width, both may compute a negative one. It is widened by a nanometre.
* Both take a link to a junction for one to the road of the same id. Such a junction gets an id of its own.
* A connection that names no connecting road at all (those of virtual junctions) is left out: both clients die of it.
* A signal reference to a signal that does not exist, and a lane link to a lane that does not exist, are left out: the
  clients die of them.
* A lane, also a centre lane, without a road mark at its start gets one of type none: 0.9.16 dies when a vehicle with a
  lane sensor crosses the edge of such a lane.
* A junction without a connection into one of its connecting roads gets it: 0.9.15 does not follow road links there.

What the clients do was found by trying them (wheels of both versions, no server).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from lxml import etree

from scenario_compiler.document import Document
from scenario_compiler.roads.connecting_road import Stretch, build_road
from scenario_compiler.roads.distinct_ids import separate_junction_ids
from scenario_compiler.roads.geometry import road_reference
from scenario_compiler.roads.junction_loops import find_junction_loops, redirect_to_ends, split_off_end
from scenario_compiler.roads.junction_repair import add_missing_connections, dead_lane_links, lanes_at_ends
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.missing_links import complete_lane_links
from scenario_compiler.roads.missing_marks import complete_marks
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.short_rings import break_ring, find_short_rings
from scenario_compiler.roads.shorten import End, cut_range, free_id, name_end, shorten_road
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables
from scenario_compiler.roads.text_edits import TextEdits
from scenario_compiler.roads.thin_lanes import widen_thin_lanes
from scenario_compiler.roads.topology import CONTACTS

JOINT_LENGTH = 0.1
"""Length of a connecting road that replaces a direct joint, m: several steps of a 32-bit coordinate 100 km from the
origin, and too short to be noticed.
"""


@dataclass
class _Direct:
    """A pair of road ends that a direct junction joins: lanes of the first end with those of the other."""

    one: End
    other: End
    lanes: list[tuple[int, int]]


@dataclass
class _Junction:
    """A direct junction: its element, its connections, its pairs of road ends."""

    element: etree._Element
    connections: list[etree._Element]
    pairs: list[_Direct] = field(default_factory=list)


def export_for_carla(document: Document, network: Network) -> bytes:
    """Return the file for CARLA's clients, in the document's own encoding; line ends are single line feeds.

    Args:
        document: An OpenDRIVE document that `network` can be read from.
        network: The network of the same document.
    """
    edits = TextEdits(document)
    n, root = network.tables, document.root
    roads = {str(one.get("id")): one for one in reversed(list(root.iterfind("{*}road")))}
    junctions = list(_direct_junctions(root, network))
    rings = find_short_rings(n)
    cuts = _choose_cuts(n, [pair for one in junctions for pair in one.pairs])
    cuts |= {(road, AT_END): pieces * _cut_length(n, (road, AT_END)) for road, pieces in rings.items()}
    loops = {(road, AT_END): _cut_length(n, (road, AT_END)) for road in find_junction_loops(n)}
    for index, road in enumerate(network.road_ids):
        complete_lane_links(edits, roads[road], n, index, goes_on=(index, AT_END) in loops)
        start, end = (cuts.get((index, side), 0.0) + loops.get((index, side), 0.0) for side in (AT_START, AT_END))
        if start > 0.0 or end > 0.0:
            shorten_road(edits, roads[road], n, index, start, end)
        if start == 0.0:
            widen_thin_lanes(edits, roads[road])
        complete_marks(edits, roads[road])
    taken = set(roads) | set(network.junction_ids)
    renamed = separate_junction_ids(edits, root, taken)
    moved = {name_end(network, end): free_id(taken) for end in loops}
    written = _replace_junctions(edits, network, roads, junctions, cuts, moved, taken, renamed)
    for index, pieces in rings.items():
        written += break_ring(edits, network, roads, index, pieces, cuts[index, AT_END], taken)
    for loop, length in loops.items():
        high = n.road_length[loop[0]] - cuts.get(loop, 0.0)
        junction = network.junction_ids[n.road_end_junction[loop[0]]]
        name, reach = moved[name_end(network, loop)], (high - length, high)
        written.append(split_off_end(edits, network, roads, loop, name, reach, renamed.get(junction, junction)))
    redirect_to_ends(edits, root, roads, moved)
    if written:
        texts = [etree.tostring(one, pretty_print=True, encoding="unicode") for one in written]
        edits.insert_after(next(root.iterchildren(reversed=True, tag="{*}road")), "".join(texts))
    for element in root.iterfind("{*}junction/{*}connection"):
        if element.get("connectingRoad") is None and element.get("linkedRoad") is None:
            edits.remove(element)
    add_missing_connections(edits, root, network, moved)
    for element in (*_dead_references(root), *dead_lane_links(root, lanes_at_ends(network))):
        edits.remove(element)
    encoding = root.getroottree().docinfo.encoding or "utf-8"
    return edits.result().encode(encoding, "xmlcharrefreplace")


def _direct_junctions(root: etree._Element, network: Network) -> Iterator[_Junction]:
    for element in root.iterfind("{*}junction"):
        connections = [
            one
            for one in element.iterfind("{*}connection")
            if one.get("connectingRoad") is None and one.get("linkedRoad") is not None
        ]
        if connections:
            junction = _Junction(element, connections)
            for connection in connections:
                _read_pair(network, junction, connection)
            yield junction


def _read_pair(network: Network, junction: _Junction, connection: etree._Element) -> None:
    """Add a connection's pair of road ends; one without a road, or without a road end at this junction, is ignored."""
    n = network.tables
    try:
        incoming = network.road_index(str(connection.get("incomingRoad")))
        linked = network.road_index(str(connection.get("linkedRoad")))
    except KeyError:
        return
    name = str(junction.element.get("id"))
    contact = CONTACTS.get(str(connection.get("contactPoint")))
    ends = _ends_at(network, incoming, name)
    targets = [end for end in _ends_at(network, linked, name) if contact in (None, end[1])]
    if not targets and contact is not None:
        targets = [(linked, contact)]
    if not ends or not targets:
        return
    _, one, other = min((_gap(n, a, b), a, b) for a in ends for b in targets)
    lanes = []
    for link in connection.iterfind("{*}laneLink"):
        try:
            before, after = int(float(link.get("from", "0"))), int(float(link.get("to", "0")))
        except (ValueError, OverflowError):
            continue
        if before != 0 and after != 0:
            lanes.append((before, after))
    for pair in junction.pairs:
        if {pair.one, pair.other} == {one, other}:
            turned = lanes if pair.one == one else [(after, before) for before, after in lanes]
            pair.lanes += [link for link in turned if link not in pair.lanes]
            return
    junction.pairs.append(_Direct(one, other, lanes))


def _ends_at(network: Network, road: int, junction: str) -> list[End]:
    n = network.tables
    leads = (n.road_start_junction[road], n.road_end_junction[road])
    return [
        (road, end)
        for end, into in zip((AT_START, AT_END), leads, strict=True)
        if into >= 0 and network.junction_ids[into] == junction
    ]


def _gap(n: RoadTables, one: End, other: End) -> float:
    """Return the squared distance of the reference lines' ends, m2."""
    points = [road_reference(n, road, n.road_length[road] if end == AT_END else 0.0) for road, end in (one, other)]
    return (points[0][0] - points[1][0]) ** 2 + (points[0][1] - points[1][1]) ** 2


def _choose_cuts(n: RoadTables, pairs: list[_Direct]) -> dict[End, float]:
    """Return how much of which road end is cut off, m: of the joined ends, those on one side.

    The side is the one with fewer starts of roads (cutting a start shifts the road's s), then with fewer ends.
    """
    beside: dict[End, list[End]] = {}
    for pair in pairs:
        beside.setdefault(pair.one, []).append(pair.other)
        beside.setdefault(pair.other, []).append(pair.one)
    side: dict[End, int] = {}
    cuts: dict[End, float] = {}
    for first in beside:
        if first in side:
            continue
        side[first], group = 0, [first]
        for end in group:
            for other in beside[end]:
                if other not in side:
                    side[other] = 1 - side[end]
                    group.append(other)
        sides = [[end for end in group if side[end] == which] for which in (0, 1)]
        chosen = min(sides, key=lambda ends: (sum(end[1] == AT_START for end in ends), len(ends)))
        cuts |= {end: _cut_length(n, end) for end in chosen}
    return cuts


def _cut_length(n: RoadTables, end: End) -> float:
    """Return how much of a road end can be cut off: at most a quarter of its lane section, m."""
    road, contact = end
    sections = range(n.road_section[road], n.road_section[road + 1])
    if not sections:
        return min(JOINT_LENGTH, 0.25 * n.road_length[road])
    section = sections[-1] if contact == AT_END else sections[0]
    return min(JOINT_LENGTH, 0.25 * (min(n.section_end[section], n.road_length[road]) - n.section_s[section]))


def _replace_junctions(
    edits: TextEdits,
    network: Network,
    roads: dict[str, etree._Element],
    junctions: list[_Junction],
    cuts: dict[End, float],
    moved: dict[tuple[str, str], str],
    taken: set[str],
    renamed: dict[str, str],
) -> list[etree._Element]:
    """Rewrite the junctions' connections; return the connecting roads."""
    written: list[etree._Element] = []
    for junction in junctions:
        name = str(junction.element.get("id"))
        name = renamed.get(name, name)
        edits.set(junction.element, "type", "default")
        connections: list[str] = []
        for stretch in _stretches(network, junction, cuts, moved):
            element, connection = build_road(network, roads, stretch, free_id(taken), name)
            connection.set("id", str(len(connections)))
            written.append(element)
            connections.append(etree.tostring(connection, pretty_print=True, encoding="unicode"))
        for element in junction.connections:
            edits.remove(element)
        kept = [one for one in junction.element.iterfind("{*}connection") if one not in junction.connections]
        for number, element in enumerate(kept):
            edits.set(element, "id", str(len(connections) + number))
        if connections:
            edits.insert_inside(junction.element, "".join(connections))
    return written


def _stretches(
    network: Network, junction: _Junction, cuts: dict[End, float], moved: dict[tuple[str, str], str]
) -> Iterator[Stretch]:
    """Yield the stretches of the connecting roads: lanes of one direction of travel and side, each lane once."""
    n = network.tables
    for pair in junction.pairs:
        if pair.one in cuts:
            cut, beyond, links = pair.one, pair.other, pair.lanes
        else:
            cut, beyond = pair.other, pair.one
            links = [(after, before) for before, after in pair.lanes]
        groups: dict[tuple[bool, bool, int], list[tuple[int, int]]] = {}
        for lane, other in links:
            along = lane_direction(n, cut[0], lane, n.road_length[cut[0]] if cut[1] == AT_END else 0.0) > 0
            layer = 0
            while any(lane == a or other == b for a, b in groups.get((along, lane > 0, layer), [])):
                layer += 1
            groups.setdefault((along, lane > 0, layer), []).append((lane, other))
        low, high = cut_range(n, cut, cuts.get(cut, 0.0))
        for (along, _, _), lanes in groups.items():
            leaves = along == (cut[1] == AT_END)
            named = [name_end(network, end) for end in ((cut, beyond) if leaves else (beyond, cut))]
            ends = [(moved.get(one, one[0]), one[1]) for one in named]
            joined = [(a, a, b) if leaves else (a, b, a) for a, b in lanes]
            yield Stretch(cut[0], low, high, along, ends[0], ends[1], tuple(joined))


def _dead_references(root: etree._Element) -> Iterator[etree._Element]:
    """Yield signal references and lane links inside roads that refer to nothing."""
    signals = {one.get("id") for one in root.iterfind("{*}road/{*}signals/{*}signal")}
    for one in root.iterfind("{*}road/{*}signals/{*}signalReference"):
        if one.get("id") not in signals:
            yield one
    for road in root.iterfind("{*}road"):
        sections = list(road.iterfind("{*}lanes/{*}laneSection"))
        known = [{lane.get("id") for lane in section.iterfind("{*}*/{*}lane")} for section in sections]
        for at, section in enumerate(sections):
            for name, beside in (("predecessor", at - 1), ("successor", at + 1)):
                if 0 <= beside < len(sections):
                    for link in section.iterfind(f"{{*}}*/{{*}}lane/{{*}}link/{{*}}{name}"):
                        if link.get("id") not in known[beside]:
                            yield link
