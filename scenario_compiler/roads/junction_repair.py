"""Repairs the connections of junctions: removes dead lane links and adds missing connections."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from lxml import etree

from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.tables import AT_END, AT_START
from scenario_compiler.roads.text_edits import TextEdits
from scenario_compiler.roads.topology import CONTACTS

_WORDS = {end: word for word, end in CONTACTS.items()}

LaneIds = dict[str, tuple[set[str], set[str]]]
"""The ids of the lanes at the start and at the end of each road."""


def lanes_at_ends(network: Network) -> LaneIds:
    """Return the ids of the lanes in the first and last lane section of each road."""
    found: LaneIds = {}
    for road in network.road_ids:
        sections = network.road(road).sections or ((0.0, ()),)
        first, last = ({str(lane) for lane in sections[k][1]} for k in (0, -1))
        found[road] = first, last
    return found


def dead_lane_links(root: etree._Element, known: LaneIds) -> Iterator[etree._Element]:
    """Yield lane links to lanes that do not exist: of connections, and of lanes to the previous or next road."""
    for connection in root.iterfind("{*}junction/{*}connection"):
        into = known.get(str(connection.get("connectingRoad")))
        outof = known.get(str(connection.get("incomingRoad")))
        if into is None or outof is None:
            continue
        contact = CONTACTS.get(str(connection.get("contactPoint")), AT_START)
        for link in connection.iterfind("{*}laneLink"):
            if link.get("to") not in into[contact] or link.get("from") not in outof[0] | outof[1]:
                yield link
    for road in root.iterfind("{*}road"):
        sections = list(road.iterfind("{*}lanes/{*}laneSection"))
        for name, k in (("predecessor", 0), ("successor", -1)):
            target = road.find(f"{{*}}link/{{*}}{name}")
            if not sections or target is None or target.get("elementType") != "road":
                continue
            beyond = known.get(str(target.get("elementId")))
            contact = CONTACTS.get(str(target.get("contactPoint")), -1)
            if beyond is not None and contact >= 0:
                for link in sections[k].iterfind(f"{{*}}*/{{*}}lane/{{*}}link/{{*}}{name}"):
                    if _whole(link.get("id")) not in beyond[contact]:
                        yield link


def _whole(number: str | None) -> str:
    """Return a lane id as CARLA reads it: "-1.0" is lane -1."""
    try:
        return str(int(float(number or "")))
    except (ValueError, OverflowError):
        return ""


def add_missing_connections(
    edits: TextEdits, root: etree._Element, network: Network, moved: Mapping[tuple[str, str], str]
) -> None:
    """Add the connections into connecting roads that follow from the links of roads and lanes.

    Args:
        edits: Receives the changes.
        root: The document's root.
        network: The network of the document.
        moved: Id of the road that replaces an end, by the original road and the standard's word for the end.
    """
    n = network.tables
    lacking: dict[int, dict[tuple[str, str, str], list[tuple[int, int]]]] = {}
    stated = {
        (*(connection.get(name) for name in _NAMES), _whole(link.get("from")), _whole(link.get("to")))
        for connection in root.iterfind("{*}junction/{*}connection")
        for link in connection.iterfind("{*}laneLink")
    }
    for road, section, row, end in _entries(network):
        for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
            other = n.link_lane[link]
            beyond = n.section_road[n.lane_section[other]]
            if n.lane_section[other] == section or n.road_junction[beyond] == n.road_junction[road]:
                continue
            key = network.road_ids[beyond], network.road_ids[road], _WORDS[end]
            lanes = n.lane_id[other], n.lane_id[row]
            if (*key, str(lanes[0]), str(lanes[1])) not in stated:
                name = moved.get((key[0], _WORDS[n.link_contact[link]]), key[0])
                lacking.setdefault(n.road_junction[road], {}).setdefault((name, *key[1:]), []).append(lanes)
    elements = {one.get("id"): one for one in reversed(list(root.iterfind("{*}junction")))}
    for junction, connections in lacking.items():
        element = elements[network.junction_ids[junction]]
        children = element.findall("{*}connection")
        if children:
            edits.insert_after(children[-1], _connections_text(connections, children))


_NAMES = ("incomingRoad", "connectingRoad", "contactPoint")


def _entries(network: Network) -> Iterator[tuple[int, int, int, int]]:
    """Yield (road, lane section, row, end) for each lane end where motor traffic enters a road of a junction."""
    n = network.tables
    for road in range(len(n.road_length)):
        first, last = n.road_section[road], n.road_section[road + 1] - 1
        if n.road_junction[road] < 0 or first > last:
            continue
        for section, end, towards in ((first, AT_START, 1), (last, AT_END, -1)):
            for row in range(n.section_lane[section], n.section_lane[section + 1]):
                drivable = n.lane_id[row] != 0 and is_drivable(n.lane_type[row])
                if drivable and n.lane_sense[row] == towards:
                    yield road, section, row, end


def _connections_text(
    connections: dict[tuple[str, str, str], list[tuple[int, int]]], children: list[etree._Element]
) -> str:
    taken = [int(one.get("id", "")) for one in children if re.fullmatch("[0-9]{1,9}", one.get("id", ""))]
    texts = []
    for number, (key, lanes) in enumerate(connections.items(), max(taken, default=0) + 1):
        attributes = {"id": str(number), **dict(zip(_NAMES, key, strict=True))}
        element = etree.Element("connection", attributes)
        for before, after in lanes:
            etree.SubElement(element, "laneLink", {"from": str(before), "to": str(after)})
        texts.append(etree.tostring(element, pretty_print=True, encoding="unicode"))
    return "".join(texts)
