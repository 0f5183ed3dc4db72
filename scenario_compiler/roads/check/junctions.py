"""Checks junctions: connections must join existing roads at the right ends, lane by lane."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.check.filed import (
    END,
    OTHER_END,
    Connection,
    Filed,
    Road,
)
from scenario_compiler.roads.check.links import ZERO_WIDTH
from scenario_compiler.roads.lane_types import LANE_TYPE_CODES, is_drivable
from scenario_compiler.roads.lanes import lane_width
from scenario_compiler.structure.findings import Findings

LOST_CONNECTION = Code(
    "SC338",
    "lost-connection",
    "A connection of a junction cannot be used: it names no roads, its connecting road is not part of the "
    "junction, or the end of the connecting road that it names (contactPoint) is not linked to the incoming road. "
    "Traffic cannot enter there, or enters at the wrong end.\n\n"
    '    <connection id="0" incomingRoad="1" connectingRoad="9" contactPoint="end">     road 9 starts at road 1\n\n'
    "Correct the roads or `contactPoint`. The named end of the connecting road must be linked to the incoming "
    "road. Rules: asam.net:xodr:1.7.0:junctions.connection.start_along_linkage and end_opposite_linkage, "
    "openmsl.net:xodr:1.4.0:road.semantic.junction_connection_road_linkage.",
    Severity.WARNING,
)
UNKNOWN_LINKED_LANE = Code(
    "SC339",
    "unknown-connected-lane",
    "A lane link of a junction names a lane that the incoming or the connecting road does not have at the place "
    "where they meet. Traffic cannot continue there.\n\n"
    '    <laneLink from="-4" to="-1"/>     the incoming road has lanes -1 and -2\n\n'
    "Correct the ids. They refer to the lane sections that meet. Rule: "
    "openmsl.net:xodr:1.4.0:road.semantic.junction_connection_lane_link_id.",
    Severity.WARNING,
)
UNORDERED_LINKS = Code(
    "SC340",
    "unordered-lane-links",
    "The lane links of a connection are not listed from left to right (with descending ids of the incoming "
    "lanes). They are valid, but harder to read.\n\n"
    '    <laneLink from="-2" to="-2"/><laneLink from="-1" to="-1"/>     -1 comes first\n\n'
    "Change the order if people read the file. Rule: "
    "openmsl.net:xodr:1.4.0:road.semantic.junction_connection_lane_linkage_order.",
    Severity.NOTE,
)
UNCONNECTED_LANE = Code(
    "SC341",
    "unconnected-lane",
    "Traffic can drive on a lane into a junction, but the lane has no connection there, so it ends at the "
    "junction.\n\n"
    '    <connection incomingRoad="1" ...><laneLink from="-1" to="-1"/></connection>     lane -2 has no connection\n\n'
    "Add a <laneLink>, or end the lane before the junction. Rule: "
    "openmsl.net:xodr:1.4.0:road.semantic.junction_driving_lanes_continue.",
    Severity.WARNING,
)
REPEATED_CONNECTION = Code(
    "SC342",
    "repeated-connection",
    "A junction connects the same two roads twice. Each connecting road has one connection for each incoming "
    "road.\n\n"
    '    <connection id="0" incomingRoad="1" connectingRoad="9" ...>\n'
    '    <connection id="1" incomingRoad="1" connectingRoad="9" ...>\n\n'
    "Merge them into one connection with the lane links of both. Rules: "
    "asam.net:xodr:1.7.0:junctions.connection.one_connection_element, "
    "asam.net:xodr:1.8.0:junctions.connection.one_link_to_incoming.",
    Severity.WARNING,
)
CONNECTING_AS_INCOMING = Code(
    "SC343",
    "connecting-road-as-incoming",
    "A road inside a junction is named as an incoming road of the same junction. Incoming roads are outside the "
    "junction.\n\n"
    '    <road id="9" junction="3"> ... <junction id="3"><connection incomingRoad="9" ...>\n\n'
    "Name the road outside the junction from which traffic comes. Rule: "
    "asam.net:xodr:1.4.0:junctions.connection.connect_road_no_incoming_road.",
    Severity.WARNING,
)


def check_junctions(filed: Filed, findings: Findings) -> None:
    """Report the faults in the connections of each junction."""
    for junction, found in zip(filed.junctions, filed.connections, strict=True):
        direct = junction.get("type") == "direct"
        inner = set() if direct else {one.connecting for one in found}
        pairs: set[tuple[str, str]] = set()
        for connection in found:
            if connection.incoming in inner:
                message = f"road {connection.incoming} lies within the junction and is named as incoming"
                findings.report(CONNECTING_AS_INCOMING, message, connection.element, "incomingRoad")
            pair = (connection.incoming, connection.connecting)
            if pair in pairs:
                message = f"roads {pair[0]} and {pair[1]} are connected a second time"
                findings.report(REPEATED_CONNECTION, message, connection.element)
            pairs.add(pair)
            _check_roads(filed, junction, connection, direct, findings)
            _check_lanes(filed, junction, connection, findings)
        _check_incoming_lanes(filed, junction, found, findings)


def _check_roads(
    filed: Filed, junction: etree._Element, connection: Connection, direct: bool, findings: Findings
) -> None:
    incoming, inner = filed.roads.get(connection.incoming), filed.roads.get(connection.connecting)
    if not connection.connecting or not connection.incoming:
        findings.report(LOST_CONNECTION, "the connection does not name both of its roads", connection.element)
        return
    if incoming is None or inner is None:
        return
    name = junction.get("id", "")
    if not direct and inner.junction != name:
        message = f"road {inner.id} connects in junction {name}, but its attribute junction is '{inner.junction[:40]}'"
        findings.report(LOST_CONNECTION, message, connection.element, "connectingRoad")
    if connection.contact not in OTHER_END:
        return
    link = inner.links.get(connection.contact)
    if direct:
        fits = link is not None and link.kind == "junction" and link.id == name
    else:
        fits = link is not None and link.kind == "road" and link.id == incoming.id
    if not fits and junction.get("type") != "virtual":
        message = f"the {connection.contact} of road {inner.id} is not linked to "
        message += f"junction {name}" if direct else f"road {incoming.id}"
        findings.report(LOST_CONNECTION, message, connection.element, "contactPoint")


def touched_ends(filed: Filed, junction: etree._Element, connection: Connection) -> tuple[Road, str, Road, str] | None:
    """Return (incoming road, its end, connecting road, its end) where they touch; None if they are not stated."""
    incoming, inner = filed.roads.get(connection.incoming), filed.roads.get(connection.connecting)
    if incoming is None or inner is None or connection.contact not in OTHER_END:
        return None
    link = inner.links.get(connection.contact)
    if link is not None and link.kind == "road" and link.id == incoming.id and link.contact in OTHER_END:
        return incoming, link.contact, inner, connection.contact
    name = junction.get("id")
    ends = [end for end, one in incoming.links.items() if one.kind == "junction" and one.id == name]
    return (incoming, ends[0], inner, connection.contact) if len(ends) == 1 else None


def _check_lanes(filed: Filed, junction: etree._Element, connection: Connection, findings: Findings) -> None:
    last: int | None = None
    for first, _, element in connection.lanes:
        if last is not None and first >= last:
            findings.report(UNORDERED_LINKS, f"the link of lane {first} follows that of lane {last}", element)
            break
        last = first
    ends = touched_ends(filed, junction, connection)
    if ends is None:
        return
    incoming, end, inner, contact = ends
    sections = incoming.section(end), inner.section(contact)
    for first, second, element in connection.lanes:
        for attribute, lane, road, section in (
            ("from", first, incoming, sections[0]),
            ("to", second, inner, sections[1]),
        ):
            if section is not None and lane not in section.lanes:
                message = f"road {road.id} has no lane {lane} where the roads touch"
                findings.report(UNKNOWN_LINKED_LANE, message, element, attribute)


def _ends_before(filed: Filed, road: Road, end: str, lane: int) -> bool:
    """Return whether a lane has no width at an end of its road."""
    if filed.network is None or road.index < 0:
        return False
    n, i = filed.network.tables, road.index
    return lane_width(n, i, lane, n.road_length[i] if end == END else 0.0) < ZERO_WIDTH


def _check_incoming_lanes(filed: Filed, junction: etree._Element, found: list[Connection], findings: Findings) -> None:
    """Report lanes of incoming roads that lead into the junction and have no connection there."""
    name = junction.get("id", "")
    linked: dict[str, set[int]] = {}
    whole: set[str] = set()
    for connection in found:
        linked.setdefault(connection.incoming, set()).update(first for first, _, _ in connection.lanes)
        if not connection.lanes:
            whole.add(connection.incoming)
    if junction.get("type") in {"virtual", "crossing"}:
        return
    for road_name, lanes in linked.items():
        road = filed.roads.get(road_name)
        if road is None or road_name in whole:
            continue
        for end, link in road.links.items():
            section = road.section(end)
            if link.kind != "junction" or link.id != name or section is None:
                continue
            for lane, element in section.lanes.items():
                code = LANE_TYPE_CODES.get(element.get("type", "none"), -1)
                leads_in = lane != 0 and road.direction(lane, element) == (1 if end == END else -1)
                if not leads_in or lane in lanes or code < 0 or not is_drivable(code):
                    continue
                if not _ends_before(filed, road, end, lane):
                    message = f"lane {lane} of road {road.id} leads into junction {name} and has no connection there"
                    findings.report(UNCONNECTED_LANE, message, element)
