"""Checks the traffic rules of lanes: access, level, speed limits for the road's type."""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from operator import itemgetter

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.check.filed import (
    END,
    OTHER_END,
    Filed,
    Road,
    Section,
    lane_links,
    number,
)
from scenario_compiler.roads.check.junctions import touched_ends
from scenario_compiler.roads.reading import SPEED_UNITS
from scenario_compiler.structure.findings import Findings

MIXED_ACCESS = Code(
    "SC354",
    "mixed-lane-access",
    "A lane has rules that allow and rules that deny access at the same place. One kind is enough: with `allow` "
    "everything else is denied, with `deny` everything else is allowed.\n\n"
    '    <access sOffset="0" rule="allow" restriction="bus"/>\n'
    '    <access sOffset="0" rule="deny" restriction="trucks"/>     the first rule denies it already\n\n'
    "Keep one of the two kinds. Rule: asam.net:xodr:1.7.0:road.lane.access.no_mix_of_deny_or_allow.",
    Severity.WARNING,
)
LEVEL = Code(
    "SC353",
    "lane-level",
    "A lane that follows the road's cross slope is outside a level lane, or a level lane continues in a lane that "
    "is not level. From a level lane outward, all lanes up to the road's border must be level.\n\n"
    '    <lane id="-1" level="true"/><lane id="-2" level="false"/>     -2 must be level too\n\n'
    'Make all lanes outside it level too, or set level="false" for this one. Rule: '
    "asam.net:xodr:1.7.0:road.lane.level_true_one_side.",
    Severity.WARNING,
)
SPEED_OF_TYPE = Code(
    "SC358",
    "speed-against-road-type",
    "The speed limit of a lane is unusual for the type of its road. The type or the unit is probably wrong.\n\n"
    '    <type s="0" type="motorway"/> ... <speed sOffset="0" max="13" unit="mph"/>     is m/s meant?\n\n'
    "Correct the type of the road or the unit; the default unit is m/s. Rule: "
    "openmsl.net:xodr:1.4.0:road.road_type_vs_speed_limit.",
    Severity.NOTE,
)

SAME_PLACE = 1e-6
"""Distance below which two records stand at the same place, m (the ASAM quality checker's)."""

SPEEDS = {
    "rural": (50, 100),
    "motorway": (80, 999),
    "town": (10, 100),
    "lowSpeed": (10, 30),
    "pedestrian": (1, 20),
    "bicycle": (1, 40),
    "townExpressway": (80, 130),
    "townCollector": (50, 100),
    "townArterial": (50, 90),
    "townPrivate": (10, 30),
    "townLocal": (10, 30),
    "townPlayStreet": (10, 30),
}
"""Lowest and highest usual speed limit of each type of road, km/h (from the openMSL quality checker)."""


def check_traffic(filed: Filed, findings: Findings) -> None:
    """Report access, level and speed records with faults."""
    for road in filed.roads.values():
        types = sorted(
            ((number(one, "s"), one.get("type", "")) for one in road.element.iterfind("type")), key=itemgetter(0)
        )
        for section in road.sections:
            _check_access(section, findings)
            _check_level(section, findings)
            _check_speeds(section, types, findings)
        _check_level_along(filed, road, findings)
    for junction, found in zip(filed.junctions, filed.connections, strict=True):
        for connection in found:
            ends = touched_ends(filed, junction, connection)
            if ends is not None:
                here, there = ends[0].section(ends[1]), ends[2].section(ends[3])
                for first, second, element in connection.lanes:
                    if here is not None and there is not None and _levels_differ(here, first, there, second):
                        lanes = f"lane {first} of road {ends[0].id} and lane {second} of road {ends[2].id}"
                        message = f"{lanes} differ in level"
                        findings.report(LEVEL, message, element)


def _check_access(section: Section, findings: Findings) -> None:
    for lane in section.lanes.values():
        records = sorted(
            ((number(one, "sOffset"), one.get("rule") == "allow", one) for one in lane.iterfind("access")),
            key=lambda record: record[0],
        )
        last: dict[bool, float] = {}
        for s, allows, element in records:
            if s - last.get(not allows, -inf) < SAME_PLACE:
                findings.report(MIXED_ACCESS, f"access is allowed and denied at sOffset = {s:g}", element)
            last[allows] = s


def _check_level(section: Section, findings: Findings) -> None:
    for sign in (1, -1):
        level = False
        for name in sorted((one for one in section.lanes if one * sign > 0), key=abs):
            here = _is_level(section, name)
            if level and not here:
                message = f"lane {name} is not level, but lies outside a lane that is"
                findings.report(LEVEL, message, section.lanes[name])
            level = level or here


def _is_level(section: Section, lane: int) -> bool:
    return section.lanes[lane].get("level") in {"true", "1"}


def _levels_differ(here: Section, first: int, there: Section, second: int) -> bool:
    if first not in here.lanes or second not in there.lanes:
        return False
    return _is_level(here, first) != _is_level(there, second)


def _check_level_along(filed: Filed, road: Road, findings: Findings) -> None:
    """Compare the level of lanes with that of the lanes to which they are linked."""
    joints = [(a, lanes, END, b) for a, b, lanes in road.spans() if b is not None]
    for end, link in road.links.items():
        other = filed.roads.get(link.id) if link.kind == "road" and link.contact in OTHER_END else None
        here, there = road.section(end), other.section(link.contact) if other is not None else None
        if here is not None and there is not None:
            joints.append((here, here.lanes, end, there))
    for here, lanes, end, there in joints:
        for name, lane in lanes.items():
            for target, element in lane_links(lane, end):
                if name != 0 and _levels_differ(here, name, there, target):
                    findings.report(
                        LEVEL, f"lane {name} and lane {target}, which it is linked to, differ in level", element
                    )


def _check_speeds(section: Section, types: list[tuple[float, str]], findings: Findings) -> None:
    """Compare speed limits with the road's type where they begin; `types` are (s, type), in order of s."""
    for lane in section.lanes.values():
        if lane.get("type") != "driving":
            continue
        for speed in lane.iterfind("speed"):
            at = bisect_right(types, section.s + number(speed, "sOffset") + SAME_PLACE, key=itemgetter(0))
            usual = SPEEDS.get(types[at - 1][1]) if at > 0 else None
            limit = 3.6 * number(speed, "max", -1.0) * SPEED_UNITS.get(speed.get("unit", "m/s"), 1.0)
            if usual is not None and limit >= 0.0 and not usual[0] <= limit <= usual[1]:
                message = f"the limit is {limit:.3g} km/h; roads of this type have {usual[0]} to {usual[1]} km/h"
                findings.report(SPEED_OF_TYPE, message, speed, "max")
