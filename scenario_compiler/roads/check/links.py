"""Checks links of roads and lanes: they must be mutual, unambiguous, and to existing lanes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.check.filed import (
    END,
    OTHER_END,
    START,
    Connection,
    Filed,
    Road,
    Section,
    lane_links,
)
from scenario_compiler.roads.lanes import lane_row_in, row_width
from scenario_compiler.roads.topology import UNKNOWN_LINK
from scenario_compiler.structure.findings import Findings

ONE_SIDED_LINK = Code(
    "SC333",
    "one-sided-road-link",
    "A road is linked to another road that is not linked back to it, or not to this end of it. Traffic can pass "
    "the joint in one direction only, and programs differ in which of the two links they use.\n\n"
    '    <road id="1"> ... <successor elementType="road" elementId="2" contactPoint="start"/>\n'
    '    <road id="2"> ... <predecessor elementType="road" elementId="3" contactPoint="end"/>     not road 1\n\n'
    "Link both roads to each other. Use a junction if three roads meet. Rule: "
    "openmsl.net:xodr:1.4.0:road.semantic.road_link_backward.",
    Severity.WARNING,
)
AMBIGUOUS_LINK = Code(
    "SC334",
    "ambiguous-road-link",
    "Several roads are linked directly to the same end of a road, or a link does not name the end (contactPoint). It "
    "is not clear which road continues where. For several roads, a junction is needed; without `contactPoint`, the "
    "nearer end is used.\n\n"
    '    <road id="1"> ... <successor elementType="road" elementId="3" contactPoint="start"/>\n'
    '    <road id="2"> ... <successor elementType="road" elementId="3" contactPoint="start"/>\n\n'
    "Make a junction with a connecting road for each of them. Rule: "
    "asam.net:xodr:1.4.0:road.linkage.is_junction_needed.",
    Severity.WARNING,
)
UNKNOWN_LANE = Code(
    "SC335",
    "unknown-linked-lane",
    "A lane is linked to a lane that does not exist in the next lane section or road. The link is ignored, so "
    "traffic on this lane cannot continue there.\n\n"
    '    <lane id="-3"><link><successor id="-3"/></link></lane>     the next section has lanes -1 and -2\n\n'
    "Correct the id, or remove the link if the lane ends there. Rules: "
    "openmsl.net:xodr:1.4.0:road.semantic.lane_link_id, "
    "asam.net:xodr:1.4.0:road.lane.link.lanes_across_lane_sections.",
    Severity.WARNING,
)
ONE_SIDED_LANE = Code(
    "SC336",
    "one-sided-lane-link",
    "A lane is linked to a lane that is not linked back to it.\n\n"
    '    <lane id="-1"><link><successor id="-1"/></link></lane>     in the first section\n'
    '    <lane id="-1"><link><predecessor id="-2"/></link></lane>     in the second\n\n'
    "Link both lanes to each other. Rule: asam.net:xodr:1.4.0:road.lane.link.lanes_across_lane_sections.",
    Severity.WARNING,
)
ZERO_WIDTH_LINK = Code(
    "SC337",
    "zero-width-lane-link",
    "A lane has a link at an end at which its width is 0. A lane that begins or ends within the road has no "
    "predecessor or successor.\n\n"
    '    <lane id="-2"><link><predecessor id="-2"/></link><width sOffset="0" a="0" b="0.1" .../></lane>\n\n'
    "Remove the link: the lane begins here. Rules: asam.net:xodr:1.7.0:road.lane.link.zero_width_at_start, "
    "asam.net:xodr:1.7.0:road.lane.link.zero_width_at_end, asam.net:xodr:1.4.0:road.lane.link.new_lane_appear.",
    Severity.WARNING,
)

ZERO_WIDTH = 1e-6
"""Width below which a lane counts as having no width, m (from the ASAM quality checker)."""


def check_road_links(filed: Filed, findings: Findings) -> None:
    """Report links that are not mutual, and ends to which several roads are linked."""
    taken: dict[tuple[str, str], etree._Element] = {}
    known = [_joined_roads(filed, found) for found in filed.connections]
    for road in filed.roads.values():
        if road.in_junction and filed.junction(road.junction) < 0:
            message = f"the road belongs to junction '{road.junction[:40]}', which does not exist"
            findings.report(UNKNOWN_LINK, message, road.element, "junction")
        for end, link in road.links.items():
            if link.kind == "junction":
                _check_junction_link(filed, road, end, known, findings)
                continue
            other = filed.roads.get(link.id)
            if other is None:
                continue
            if link.contact not in OTHER_END:
                if link.element.get("elementS") is None:
                    message = f"the link to road {link.id} does not name the end of that road"
                    findings.report(AMBIGUOUS_LINK, message, link.element)
                continue
            back = other.links.get(link.contact)
            if not road.in_junction:
                place = (link.id, link.contact)
                if place in taken:
                    message = f"another road is linked to the {link.contact} of road {link.id}, too"
                    findings.report(AMBIGUOUS_LINK, message, link.element)
                taken.setdefault(place, link.element)
                returned = back is not None and back.kind == "road" and (back.id, back.contact) == (road.id, end)
                leads_in = back is not None and back.kind == "junction"
                if not returned and not leads_in:
                    message = f"the {link.contact} of road {link.id} is not linked back to the {end} of road {road.id}"
                    findings.report(ONE_SIDED_LINK, message, link.element)


def _check_junction_link(filed: Filed, road: Road, end: str, known: list[set[str]], findings: Findings) -> None:
    """Report a road that leads into a junction but has no connection there."""
    link = road.links[end]
    at = filed.junction(link.id)
    if at < 0 or filed.junctions[at].get("type") in {"virtual", "crossing"}:
        return
    if road.id not in known[at]:
        message = f"junction {link.id} has no connection from or to road {road.id}"
        findings.report(ONE_SIDED_LINK, message, link.element)


def _joined_roads(filed: Filed, found: list[Connection]) -> set[str]:
    """Return the ids of the roads that a junction's connections join, including the successors of connecting roads."""
    known: set[str] = set()
    for connection in found:
        known.update((connection.incoming, connection.connecting))
        inner = filed.roads.get(connection.connecting)
        if inner is not None:
            known.update(one.id for one in inner.links.values() if one.kind == "road")
    return known


class _Joint(NamedTuple):
    """A joint of lane sections: the end, its lanes, the other section and its end, and whether it is in a junction."""

    lanes: dict[int, etree._Element]
    end: str
    other: Section
    contact: str
    in_junction: bool


def check_lane_links(filed: Filed, findings: Findings) -> None:
    """Report lane links to lanes that do not exist, links that are not mutual, and links of lanes without width."""
    for road in filed.roads.values():
        for joint in _joints(filed, road):
            for name, lane in joint.lanes.items():
                for target, element in lane_links(lane, joint.end):
                    _check_lane_link(joint, name, target, element, findings)
        _check_ends_without_neighbour(road, findings)
        _check_zero_widths(filed, road, findings)


def _check_lane_link(joint: _Joint, name: int, target: int, element: etree._Element, findings: Findings) -> None:
    linked = joint.other.lanes.get(target)
    if linked is None:
        message = f"lane {name} is linked to lane {target}, which does not exist there"
        findings.report(UNKNOWN_LANE, message, element, "id")
    elif name != 0 and not joint.in_junction and name not in joint.other.linked(target, joint.contact):
        message = f"lane {name} is linked to lane {target}, which is not linked back to it"
        findings.report(ONE_SIDED_LANE, message, element)


def _joints(filed: Filed, road: Road) -> Iterator[_Joint]:
    """Yield the joints at both ends of each lane section of a road."""
    before: Section | None = None
    for here, following, lanes in road.spans():
        if before is not None:
            yield _Joint(lanes, START, before, END, False)
        if following is not None:
            yield _Joint(lanes, END, following, START, False)
        before = here if following is not None else None
    for end, link in road.links.items():
        section = road.section(end)
        other = filed.roads.get(link.id) if link.kind == "road" and link.contact in OTHER_END else None
        there = other.section(link.contact) if other is not None else None
        if section is not None and other is not None and there is not None:
            yield _Joint(section.lanes, end, there, link.contact, road.in_junction or other.in_junction)


def _check_ends_without_neighbour(road: Road, findings: Findings) -> None:
    """Report lane links at an end to which no road is linked."""
    for end in (START, END):
        section = road.section(end)
        if section is None or end in road.links:
            continue
        for name, lane in section.lanes.items():
            for target, element in lane_links(lane, end):
                message = (
                    f"lane {name} is linked to lane {target}, but road {road.id} is linked to no road at its {end}"
                )
                findings.report(UNKNOWN_LANE, message, element, "id")


def _check_zero_widths(filed: Filed, road: Road, findings: Findings) -> None:
    if filed.network is None or road.index < 0:
        return
    n = filed.network.tables
    for section, following, lanes in road.spans():
        last = n.road_section[road.index + 1] - 1 if following is None else following.row - 1
        if section.row < 0 or last < section.row:
            continue
        ends = {START: (section.row, n.section_s[section.row]), END: (last, n.section_end[last])}
        for name, lane in lanes.items():
            for end, (at, s) in ends.items():
                row = lane_row_in(n, at, name)
                link = next(lane_links(lane, end), None)
                if name != 0 and row >= 0 and link is not None and row_width(n, row, s) < ZERO_WIDTH:
                    message = f"lane {name} has no width at its {end} and is linked there to lane {link[0]}"
                    findings.report(ZERO_WIDTH_LINK, message, link[1])
