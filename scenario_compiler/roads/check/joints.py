"""Checks joints: gaps and kinks of reference lines and lane borders, inside and between roads and junctions."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Iterable, Iterator
from math import cos, degrees, hypot, pi, sin
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
    lane_links,
    number,
)
from scenario_compiler.roads.check.junctions import touched_ends
from scenario_compiler.roads.geometry import piece_point, road_elevation, road_reference, wrap_angle
from scenario_compiler.roads.lanes import lane_row_in, row_inner_border, row_width
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.structure.findings import Findings

GAP = Code(
    "SC344",
    "road-gap",
    "A reference line or a lane does not end where the next one begins, or a lane jumps aside or becomes wider "
    "abruptly between its joints. Vehicles jump there, the surface has a "
    "hole or an overlap, and a position near the joint is on no lane or on two lanes.\n\n"
    '    <geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry>\n'
    '    <geometry s="50" x="50.4" y="0" hdg="0" length="50"><line/></geometry>     x="50"\n\n'
    "Move the start of the next one to the end of this one. Gaps of millimetres, as left by programs that round "
    "coordinates, are not reported. Rules: asam.net:xodr:1.7.0:lane_smoothness.contact_point_no_horizontal_gaps, "
    "asam.net:xodr:1.4.0:road.geometry.contact_point.",
    Severity.WARNING,
)
KINK = Code(
    "SC345",
    "road-kink",
    "The reference line changes its direction abruptly at a joint. Vehicles turn abruptly there; the road surface "
    "overlaps on the inner side and has a gap on the outer side.\n\n"
    '    <geometry s="0" x="0" y="0" hdg="0" length="50"><line/></geometry>\n'
    '    <geometry s="50" x="50" y="0" hdg="0.2" length="50"><line/></geometry>     11 degrees to the left\n\n'
    "Insert an <arc> or a <spiral> between the two, or correct `hdg`.",
    Severity.WARNING,
)
STEP = Code(
    "SC363",
    "road-step",
    "The height of the road jumps, at a joint of two roads or inside a road. Vehicles jump there, and the surface "
    "has a step.\n\n"
    '    <road id="1" length="100"> ... <elevation s="0" a="0" b="0.02" c="0" d="0"/>     2 m high at its end\n'
    '    <road id="2"> ... <elevation s="0" a="0" b="0" c="0" d="0"/>     0 m high at its start\n\n'
    'Start the elevation of the second road at the height at which the first ends: a="2".',
    Severity.WARNING,
)
COVERAGE = Code(
    "SC364",
    "road-length",
    "The lengths of a road's geometries do not agree with the starts of the next geometries, or with the length "
    "of the road. The line is extended beyond its end, or cut.\n\n"
    '    <road length="120" ...><planView><geometry s="0" ... length="100">     20 m are missing\n\n'
    "Correct the lengths, or add the missing geometry. Rule: openmsl.net:xodr:1.4.0:road.geometry.length.",
    Severity.WARNING,
)

GAP_TOLERANCE = 0.01
"""Largest gap that is not reported, m (the ASAM quality checker's)."""

KINK_TOLERANCE = 0.02
"""Largest change of direction at a joint that is not reported, rad (1.1 degrees)."""

STEP_TOLERANCE = 0.05
"""Largest step in height that is not reported, m."""

BESIDE = 1e-4
"""Distance from a joint at which lane borders are compared, m: records that start there may start a bit aside."""

LENGTH_TOLERANCE = 0.01
"""Largest difference of lengths along s that is not reported, m."""


class _Borders(NamedTuple):
    """The left and right border points of a lane at an end, as seen along s, in the plane."""

    left: tuple[float, float]
    right: tuple[float, float]


def check_joints(filed: Filed, findings: Findings) -> None:
    """Report gaps, kinks, steps in height, and inconsistent lengths."""
    if filed.network is None:
        return
    n = filed.network.tables
    for road in filed.roads.values():
        if road.index >= 0:
            _check_reference_line(n, road, findings)
            _check_sections(n, road, findings)
            _check_records(road, findings)
            for end in road.links:
                _check_road_joint(n, filed, road, end, findings)
    for junction, found in zip(filed.junctions, filed.connections, strict=True):
        _check_connections(n, filed, junction, found, findings)


def _check_reference_line(n: RoadTables, road: Road, findings: Findings) -> None:
    """Compare each geometry with the end of the one before."""
    geometries = sorted(
        ((number(one, "s"), one) for one in road.element.iterfind("planView/geometry")), key=lambda pair: pair[0]
    )
    first, last = n.road_piece[road.index], n.road_piece[road.index + 1]
    stations = n.piece_s[first:last]
    end = 0.0
    for i, (s, element) in enumerate(geometries):
        if i > 0 and abs(s - end) > LENGTH_TOLERANCE:
            message = f"the geometry starts at s = {s:.6g}, the one before ends at s = {end:.6g}"
            findings.report(COVERAGE, message, element, "s")
        end = s + number(element, "length")
        piece = first + bisect_left(stations, s)
        if i == 0 or piece >= last or piece == first or n.piece_s[piece] != s:
            continue
        x, y, h, *_ = piece_point(n, piece - 1, s)
        start = n.piece_x[piece], n.piece_y[piece], n.piece_h[piece]
        _compare(findings, element, (x, y, h), start, "the geometry before")
    if geometries and road.length > 0.0 and abs(road.length - end) > LENGTH_TOLERANCE:
        message = f"the road is {road.length:.6g} m long, its last geometry ends at s = {end:.6g}"
        findings.report(COVERAGE, message, road.element, "length")


def _compare(
    findings: Findings,
    element: etree._Element,
    before: tuple[float, float, float],
    after: tuple[float, float, float],
    what: str,
) -> None:
    """Compare two points with headings."""
    gap = hypot(after[0] - before[0], after[1] - before[1])
    if gap > GAP_TOLERANCE:
        findings.report(GAP, f"a gap of {gap:.3g} m to {what}", element)
    _compare_headings(findings, element, before[2], after[2], what)


def _compare_headings(findings: Findings, element: etree._Element, before: float, after: float, what: str) -> None:
    turn = abs(wrap_angle(after - before))
    if turn > KINK_TOLERANCE:
        findings.report(KINK, f"a kink of {degrees(turn):.3g} degrees against {what}", element)


def _check_sections(n: RoadTables, road: Road, findings: Findings) -> None:
    """Compare the borders of linked lanes where lane sections meet."""
    for _, after, lanes in road.spans():
        if after is None or after.row <= n.road_section[road.index]:
            continue
        links = {name: [target for target, _ in lane_links(lane, END)] for name, lane in lanes.items() if name != 0}
        sources: dict[int, list[int]] = {}
        for name, targets in links.items():
            for target in targets:
                sources.setdefault(target, []).append(name)
        for name, targets in links.items():
            merging = sources[targets[0]] if len(targets) == 1 else [name]
            here = _t_borders(n, after.row - 1, END, merging)
            there = _t_borders(n, after.row, START, targets)
            if name != merging[0] or here is None or there is None:
                continue
            beyond = there[0] - here[0], here[1] - there[1]
            gap = max(map(abs, beyond)) if len(merging) == 1 else max(beyond)
            if gap > GAP_TOLERANCE:
                pair = [" and ".join(map(str, ids)) for ids in (merging, targets)]
                message = f"a gap of {gap:.3g} m between lane {pair[0]} and lane {pair[1]} at s = {after.s:.6g}"
                findings.report(GAP, message, lanes[name])


def _t_borders(n: RoadTables, section: int, end: str, lanes: list[int]) -> tuple[float, float] | None:
    """Return (t of the left border, t of the right border) of lanes side by side at an end of a section, or None.

    They are those just inside the section: an offset or a width that starts at its end belongs to the next one.
    """
    inside = min(BESIDE, 0.5 * (n.section_end[section] - n.section_s[section]))
    s = n.section_s[section] + inside if end == START else n.section_end[section] - inside
    borders = []
    for lane in lanes:
        row = lane_row_in(n, section, lane)
        if row >= 0:
            inner, width = row_inner_border(n, n.section_road[section], row, s), row_width(n, row, s)
            borders.append((inner + width, inner) if lane > 0 else (inner, inner - width))
    return (max(one[0] for one in borders), min(one[1] for one in borders)) if borders else None


def _check_records(road: Road, findings: Findings) -> None:
    """Report jumps of the lane offset, of widths and borders, and of the elevation between joints."""
    starts = [one.s for one in road.sections]
    for s, jump, record in _jumps(road.element.iterfind("lanes/laneOffset")):
        at = bisect_left(starts, s - BESIDE)
        if jump > GAP_TOLERANCE and (at == len(starts) or starts[at] > s + BESIDE):
            findings.report(GAP, f"the lanes jump aside by {jump:.3g} m at s = {s:.6g}", record)
    for section, _, lanes in road.spans():
        for name, lane in lanes.items():
            for tag in ("width", "border"):
                for s, jump, record in _jumps(lane.iterfind(tag), "sOffset"):
                    if jump > GAP_TOLERANCE:
                        message = f"the {tag} of lane {name} jumps by {jump:.3g} m at s = {section.s + s:.6g}"
                        findings.report(GAP, message, record)
    for s, jump, record in _jumps(road.element.iterfind("elevationProfile/elevation")):
        if jump > STEP_TOLERANCE:
            findings.report(STEP, f"a step of {jump:.3g} m at s = {s:.6g}", record)


def _jumps(records: Iterable[etree._Element], station: str = "s") -> Iterator[tuple[float, float, etree._Element]]:
    """Yield (s, distance from the value of the cubic before to that of its own, m, record) for the start of each."""
    before: tuple[float, ...] | None = None
    for record in sorted(records, key=lambda one: number(one, station)):
        s, a, b, c, d = (number(record, name) for name in (station, "a", "b", "c", "d"))
        if before is not None and s > before[0]:
            ds = s - before[0]
            yield s, abs(a - (before[1] + ds * (before[2] + ds * (before[3] + ds * before[4])))), record
        before = s, a, b, c, d


def _check_road_joint(n: RoadTables, filed: Filed, road: Road, end: str, findings: Findings) -> None:
    """Compare a road's end with the road to which it is linked; each joint once, at the road that comes first."""
    link = road.links[end]
    other = filed.roads.get(link.id) if link.kind == "road" else None
    if other is None or other.index < 0 or link.contact not in OTHER_END or link.element.get("elementS") is not None:
        return
    back = other.links.get(link.contact)
    if back is not None and (back.kind, back.id, back.contact) == ("road", road.id, end) and other.index < road.index:
        return
    within = road.in_junction or other.in_junction
    here, there = _end_pose(n, road, end), _end_pose(n, other, link.contact)
    turned = pi if end == link.contact else 0.0
    if within:
        _compare_headings(findings, link.element, here[2], there[2] + turned, f"road {other.id}")
    else:
        _compare(findings, link.element, here[:3], (there[0], there[1], there[2] + turned), f"road {other.id}")
        step = abs(there[3] - here[3])
        if step > STEP_TOLERANCE:
            findings.report(STEP, f"a step of {step:.3g} m to road {other.id}", link.element)
    pairs: list[tuple[int, int, etree._Element]] = []
    section = road.section(end)
    for name, lane in section.lanes.items() if section is not None else ():
        pairs.extend((name, target, lane) for target, _ in lane_links(lane, end) if name != 0)
    _compare_lanes(n, (road, end), (other, link.contact), pairs, findings)


def _end_pose(n: RoadTables, road: Road, end: str) -> tuple[float, float, float, float]:
    """Return (x, y, heading, z) of the reference line at an end."""
    s = 0.0 if end == START else n.road_length[road.index]
    x, y, h, _ = road_reference(n, road.index, s)
    return x, y, h, road_elevation(n, road.index, s)


def _compare_lanes(
    n: RoadTables,
    here: tuple[Road, str],
    there: tuple[Road, str],
    pairs: list[tuple[int, int, etree._Element]],
    findings: Findings,
) -> None:
    """Compare the borders of linked lanes; not of lanes that merge or split, which have several links."""
    linked = Counter(name for name, _, _ in pairs), Counter(target for _, target, _ in pairs)
    for name, target, element in pairs:
        if linked[0][name] > 1 or linked[1][target] > 1:
            continue
        mine, other = _borders(n, *here, name), _borders(n, *there, target)
        if mine is None or other is None:
            continue
        left, right = (other.right, other.left) if here[1] == there[1] else (other.left, other.right)
        gap = max(
            hypot(mine.left[0] - left[0], mine.left[1] - left[1]),
            hypot(mine.right[0] - right[0], mine.right[1] - right[1]),
        )
        if gap > GAP_TOLERANCE:
            lanes = f"lane {name} of road {here[0].id} and lane {target} of road {there[0].id}"
            message = f"a gap of {gap:.3g} m between {lanes}"
            findings.report(GAP, message, element)


def _borders(n: RoadTables, road: Road, end: str, lane: int) -> _Borders | None:
    first, last = n.road_section[road.index], n.road_section[road.index + 1] - 1
    found = _t_borders(n, first if end == START else last, end, [lane]) if first <= last else None
    if found is None:
        return None
    left, right = found
    x, y, h, _ = road_reference(n, road.index, 0.0 if end == START else n.road_length[road.index])
    return _Borders((x - left * sin(h), y + left * cos(h)), (x - right * sin(h), y + right * cos(h)))


def _check_connections(
    n: RoadTables, filed: Filed, junction: etree._Element, found: list[Connection], findings: Findings
) -> None:
    """Compare the borders of lanes that a junction links."""
    for connection in found:
        ends = touched_ends(filed, junction, connection)
        if ends is None or ends[0].index < 0 or ends[2].index < 0:
            continue
        _compare_lanes(n, ends[:2], ends[2:], connection.lanes, findings)
