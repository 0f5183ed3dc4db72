"""Checks the shape of single roads: lane widths, lane sections, the order of lanes and records, polynomials."""

from __future__ import annotations

from math import hypot, sqrt

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.check.filed import Filed, Road, Section, number, whole
from scenario_compiler.roads.lane_parse import are_two_sides
from scenario_compiler.roads.lanes import lane_row_in
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.structure.findings import Findings

NEGATIVE_WIDTH = Code(
    "SC346",
    "negative-lane-width",
    "A lane's width falls below 0, or its border crosses that of the lane beside it. The width is taken as 0 "
    "there.\n\n"
    '    <width sOffset="0" a="3.5" b="-0.1" c="0" d="0"/>     less than 0 after 35 m\n\n'
    "Correct the polynomial, or end the lane by starting a new lane section. Rules: "
    "openmsl.net:xodr:1.4.0:road.semantic.lane_width, "
    "asam.net:xodr:1.4.0:road.lane.border.overlap_with_inner_lanes.",
    Severity.WARNING,
)
CURVE_LENGTH = Code(
    "SC347",
    "curve-length",
    "The length of a paramPoly3 curve differs from the length of its geometry. Positions along it are stretched "
    "or compressed.\n\n"
    '    <geometry ... length="50"><paramPoly3 pRange="normalized" bU="30" .../></geometry>     30 m long\n\n'
    "Correct `length`, or `pRange`: with normalized, the parameter goes from 0 to 1; with arcLength, from 0 to "
    "the length. Rules: asam.net:xodr:1.7.0:road.geometry.parampoly3.length_match, arclength_range and "
    "normalized_range.",
    Severity.WARNING,
)
CURVE_START = Code(
    "SC348",
    "curve-start",
    "A paramPoly3 does not start at the position of its geometry (aU or aV is not 0), or not in its direction (bV "
    "is not 0, or bU is not positive).\n\n"
    '    <paramPoly3 aU="2" bU="50" aV="0" bV="1" .../>     starts 2 m ahead and is turned\n\n'
    "Give the start by x, y and hdg of the <geometry>. Rule: "
    "openmsl.net:xodr:1.4.0:road.geometry.parampoly3_attributes.",
    Severity.WARNING,
)
SECTION_START = Code(
    "SC349",
    "lane-section-start",
    "The lane sections of a road do not cover it: the first one does not start at 0, or one starts beyond the road's "
    "end or where another one starts."
    '\n\n    <lanes><laneSection s="5">...</laneSection></lanes>     without lanes from 0 to 5 m'
    "\n\nCorrect s; the first section starts at 0. Rule: openmsl.net:xodr:1.4.0:road.semantic.lanesection_s.",
    Severity.WARNING,
)
LANE_ORDER = Code(
    "SC350",
    "lane-order",
    "The ids of the lanes of a section do not descend from left to right without a gap (..., 2, 1, 0, -1, -2, "
    "...). Lanes are placed by their ids, so a missing or exchanged id puts a lane in the wrong place.\n\n"
    '    <right><lane id="-1" .../><lane id="-3" .../></right>     -2 is missing\n\n'
    "Number the lanes without gaps, and correct the links to them. Rule: "
    "openmsl.net:xodr:1.4.0:road.semantic.lane_id_order.",
    Severity.WARNING,
)
RECORD_OFFSET = Code(
    "SC351",
    "record-offset",
    "The records of a lane (widths, borders, heights, marks, speeds) are not in ascending order of sOffset, or "
    "start beyond the end of their section. Records of widths, borders and heights must also start at 0, and a lane "
    "needs a width or a border.\n\n"
    '    <lane id="-1"><width sOffset="5" a="3.5" .../></lane>     how wide is it before?\n\n'
    "Correct sOffset. It is measured from the start of the lane section, not of the road. Rules: "
    "openmsl.net:xodr:1.4.0:road.semantic.lane_property_sOffset, "
    "asam.net:xodr:1.7.0:road.lane.width.width_defined_whole_section.",
    Severity.WARNING,
)
LANE_WITHOUT_TYPE = Code(
    "SC352",
    "lane-without-type",
    "A lane has the type 'none': it exists, but nothing may use it. Often the type was forgotten.\n\n"
    '    <lane id="-2" type="none" level="false">\n\n'
    "Give its type: driving, shoulder, border, sidewalk, or another type of the standard. Rule: "
    "openmsl.net:xodr:1.4.0:road.semantic.lane_type_none.",
    Severity.NOTE,
)

LENGTH_TOLERANCE = 0.001
"""Largest difference of a curve's length that is not reported, m (the ASAM quality checker's)."""

WIDTH_TOLERANCE = 1e-6
"""Amount by which a width may be negative without a report, m: rounding of written decimals."""

OFFSET_TOLERANCE = 1e-3
"""Distance by which a record may start beyond its section without a report, m."""

START_TOLERANCE = 1e-6
"""Largest coefficient at a curve's start that counts as 0."""

CURVE_STEPS = 200
"""Steps of Simpson's rule over a curve; its error is below 1e-6 m for curves that roads have."""

RECORDS = ("width", "border", "roadMark", "material", "visibility", "speed", "access", "height", "rule")
WHOLE_LENGTH = {"width", "border", "height"}
"""Records that must cover their section from its start."""


def check_shapes(filed: Filed, findings: Findings) -> None:
    """Report faults in the shape of single roads."""
    for road in filed.roads.values():
        _check_curves(road, findings)
        _check_sections(road, findings)
        for section in road.sections:
            _check_lane_order(section, findings)
        for section, following, lanes in road.spans():
            end = road.length if following is None else following.s
            for name, lane in lanes.items():
                _check_lane(name, lane, end - section.s, findings)
        if filed.network is not None and road.index >= 0:
            _check_widths(filed.network.tables, road, findings)


def _check_curves(road: Road, findings: Findings) -> None:
    for geometry in road.element.iterfind("planView/geometry"):
        curve = geometry.find("paramPoly3")
        if curve is None:
            continue
        if any(abs(number(curve, name)) > START_TOLERANCE for name in ("aU", "aV", "bV")) or number(curve, "bU") <= 0.0:
            findings.report(
                CURVE_START, "the curve does not start at its geometry's position or in its direction", curve
            )
        length = number(geometry, "length")
        curved = _curve_length(curve, length if curve.get("pRange") == "arcLength" else 1.0)
        if abs(curved - length) > LENGTH_TOLERANCE:
            message = f"the curve is {curved:.6g} m long, its geometry {length:.6g} m"
            findings.report(CURVE_LENGTH, message, geometry, "length")


def _curve_length(curve: etree._Element, last: float) -> float:
    """Return the length of a paramPoly3 from 0 to `last` by Simpson's rule."""
    bu, cu, du = (number(curve, name) for name in ("bU", "cU", "dU"))
    bv, cv, dv = (number(curve, name) for name in ("bV", "cV", "dV"))
    step = last / CURVE_STEPS
    total = 0.0
    for i in range(CURVE_STEPS + 1):
        p = i * step
        speed = hypot(bu + p * (2.0 * cu + 3.0 * du * p), bv + p * (2.0 * cv + 3.0 * dv * p))
        total += speed * (1 if i in {0, CURVE_STEPS} else 4 if i % 2 else 2)
    return total * step / 3.0


def _check_sections(road: Road, findings: Findings) -> None:
    before: Section | None = None
    for section in road.sections:
        if before is None:
            if section.s != 0.0:
                message = f"the first lane section starts at s = {section.s:g}, not at 0"
                findings.report(SECTION_START, message, section.element, "s")
        elif section.s == before.s and not are_two_sides(before.element, section.element):
            findings.report(SECTION_START, f"a second lane section starts at s = {section.s:g}", section.element, "s")
        elif section.s >= road.length:
            message = f"the lane section starts at s = {section.s:g}, beyond the road's end at {road.length:g}"
            findings.report(SECTION_START, message, section.element, "s")
        before = section


def _check_lane_order(section: Section, findings: Findings) -> None:
    """Report lane ids that do not descend by one from left to right, or do not start beside the centre."""
    for side, sign in (("left", 1), ("right", -1)):
        ids = [whole(lane, "id") for lane in section.element.iterfind(f"{side}/lane")]
        elements = section.element.findall(f"{side}/lane")
        count = len(ids)
        expected = list(range(count, 0, -1)) if sign > 0 else list(range(-1, -count - 1, -1))
        for name, wanted, element in zip(ids, expected, elements, strict=True):
            if name != wanted:
                message = f"lane {element.get('id', '')[:20]} is at the place of lane {wanted}"
                findings.report(LANE_ORDER, message, element, "id")
                break


def _check_lane(name: int, lane: etree._Element, length: float, findings: Findings) -> None:
    if name != 0 and lane.get("type") == "none":
        findings.report(LANE_WITHOUT_TYPE, f"lane {name} has the type 'none'", lane, "type")
    if name != 0 and lane.find("width") is None and lane.find("border") is None:
        findings.report(RECORD_OFFSET, f"lane {name} has neither <width> nor <border>: it is 0 m wide", lane)
    for tag in RECORDS:
        last: float | None = None
        for record in lane.iterfind(tag):
            s = number(record, "sOffset")
            if last is None and tag in WHOLE_LENGTH and s != 0.0:
                findings.report(
                    RECORD_OFFSET, f"the first <{tag}> starts at sOffset = {s:g}, not at 0", record, "sOffset"
                )
            elif last is not None and s < last:
                message = f"<{tag}> starts at sOffset = {s:g}, before the one above it"
                findings.report(RECORD_OFFSET, message, record, "sOffset")
            if s > length + OFFSET_TOLERANCE:
                message = f"<{tag}> starts at sOffset = {s:g}, beyond its section, which is {length:g} m long"
                findings.report(RECORD_OFFSET, message, record, "sOffset")
            last = s


def _check_widths(n: RoadTables, road: Road, findings: Findings) -> None:
    for section in road.sections:
        if section.row < 0:
            continue
        end = n.section_end[section.row]
        for name, lane in section.lanes.items():
            row = lane_row_in(n, section.row, name)
            if row < 0 or name == 0:
                continue
            first, last = n.lane_width_first[row], n.lane_width_last[row]
            for i in range(first, last):
                stop = min(n.cubic_s[i + 1], end) if i + 1 < last else end
                low, s = _lowest(n, i, max(0.0, n.section_s[section.row] - n.cubic_s[i]), stop - n.cubic_s[i])
                if low < -WIDTH_TOLERANCE:
                    message = f"the width of lane {name} falls to {low:.3g} m at s = {n.cubic_s[i] + s:.6g}"
                    findings.report(NEGATIVE_WIDTH, message, lane)
                    break


def _lowest(n: RoadTables, i: int, start: float, stop: float) -> tuple[float, float]:
    """Return (the lowest value of a cubic, its place) from `start` to `stop`."""
    a, b, c, d = n.cubic_a[i], n.cubic_b[i], n.cubic_c[i], n.cubic_d[i]
    places = [start, max(start, stop)]
    if d != 0.0:
        inside = c * c - 3.0 * b * d
        if inside >= 0.0:
            places.extend(((-c + sqrt(inside)) / (3.0 * d), (-c - sqrt(inside)) / (3.0 * d)))
    elif c != 0.0:
        places.append(-b / (2.0 * c))
    return min((a + s * (b + s * (c + s * d)), s) for s in places if start <= s <= max(start, stop))
