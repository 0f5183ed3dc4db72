"""Reads <lanes> into the tables: lane sections, lanes, widths, heights, speeds and marks."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Sequence
from itertools import pairwise
from operator import itemgetter

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.attachments import CUT_TOLERANCE
from scenario_compiler.roads.elements import Element, PlainElement, grandchildren
from scenario_compiler.roads.lane_types import LANE_TYPE_CODES, NONE
from scenario_compiler.roads.marks import (
    CHANGE_BOTH,
    CHANGE_NONE,
    LANE_CHANGE_CODES,
    MARK_COLOUR_CODES,
    MARK_CUSTOM,
    MARK_TYPE_CODES,
    STANDARD_WIDTH,
)
from scenario_compiler.roads.reading import LENGTH_LIMIT, UNSORTED, Cubic, Reader, append_cubics, cubics_in
from scenario_compiler.roads.tables import AT_END, AT_START, LANE_LIMIT, RoadTables

BAD_LANE = Code(
    "SC310",
    "bad-lane",
    "A lane cannot be used and is left out: its id is not an integer, is used twice in its section, is beyond a "
    "million, or has the wrong sign for its side (left lanes are positive, right lanes negative).\n\n"
    '    <right><lane id="1" type="driving">...</lane></right>     -1: right lanes have negative ids\n\n'
    "Correct the id; lanes count from 1 (left) and from -1 (right) outward, and the centre lane is 0.",
    Severity.WARNING,
)
BAD_SECTION = Code(
    "SC311",
    "bad-lane-section",
    "A lane section starts at or beyond the end of its road, or where another one starts, so it covers no part of "
    "the road. It is left out.\n\n"
    '    <road length="100" ...> ... <laneSection s="100">     the road ends there\n\n'
    "Correct s, or remove the section.",
    Severity.WARNING,
)
UNKNOWN_LANE_WORD = Code(
    "SC312",
    "unknown-lane-word",
    "OpenDRIVE does not define this lane type, mark type, mark colour or direction. A default is used in its "
    "place.\n\n"
    '    <roadMark sOffset="0" type="dashed" .../>     broken\n\n'
    "Use a value of the standard.",
    Severity.WARNING,
)

MANY_CUTS = Code(
    "SC369",
    "many-attached-roads",
    "So many roads begin or end inside another one (elementS, virtual junctions) that only the first ones are "
    "joined to it.\n\n"
    '    <predecessor elementType="road" elementId="1" elementS="12.5" elementDir="+"/>     on hundreds of roads\n\n'
    "Split the road in which they begin.",
    Severity.WARNING,
)

COPY_LIMIT = 100_000
"""Greatest number of elements of lane sections that are read again because of cuts; protects against hostile files."""

QUALITY_CODE = "marking_quality"
"""Code of the `<userData>` in a `<roadMark>` for the quality of the mark, 0 to 1."""

UNCROSSED_MARKS = frozenset({"solid", "solid solid", "curb", "edge"})
"""Marks that forbid a lane change if the file has no `laneChange`; the others allow it."""

MARK_COLUMNS = (
    *("mark_type", "mark_colour", "mark_change", "mark_width", "mark_quality_from", "mark_quality_to"),
    *("mark_sway_first", "mark_sway_last"),
)
"""The columns with what a mark looks like."""

TRUE = frozenset({"true", "1"})
"""The texts of a true attribute."""

LANE_DIRECTIONS = {"standard": 0, "reversed": 1, "both": 2}

LINK_ENDS = {"predecessor": AT_START, "successor": AT_END}
"""The ends of a lane by the tags of its links."""

RARE_PARTS = frozenset({"speed", "height", "border"})
"""The tags of records that few lanes have."""


LaneLinks = dict[int, list[int]]
"""The lane ids to which the file links an end of a lane, if there are any; the end's number is 2 x its row + `AT_START`
or `AT_END`, as in `RoadTables.lane_link`.
"""


MarkLook = tuple[int, int, int, float, float, float, int, int]
"""The values of a mark for `MARK_COLUMNS`."""

Side = tuple[PlainElement | None, float]
"""The side's element and the s from which its records count."""

Lane = tuple[int, PlainElement, float]
"""The lane's id and element, and the s from which its records count."""

NO_CENTRE = PlainElement("lane")
"""Stands for the centre lane of a section without one."""


def are_two_sides(one: Element, other: Element) -> bool:
    """Return whether two lane sections are one-sided, one for each side of the road."""
    for section in (one, other):
        if section.get("singleSide") not in TRUE or (section.find("left") is None) == (section.find("right") is None):
            return False
    return (one.find("left") is None) != (other.find("left") is None)


class LaneReader:
    """Reads the lanes of the roads, one road after the other."""

    def __init__(self, reader: Reader, tables: RoadTables) -> None:
        """Start before the first road."""
        self._reader = reader
        self._n = tables
        self._copies = COPY_LIMIT
        self._plain_marks: dict[tuple[str | None, ...], MarkLook] = {}
        self._plain_lanes: dict[tuple[str | None, ...], tuple[int, int, int]] = {}
        self._marks_of_road: list[MarkLook] = []
        self._mark_columns = [getattr(tables, name) for name in MARK_COLUMNS]
        self.links = LaneLinks()

    def read(self, road_element: PlainElement, road: int, length: float, cuts: Sequence[float] = ()) -> None:
        """Append the lane sections of a road; `cuts` are the places where other roads are attached, ascending."""
        n = self._n
        n.road_directions.append(0)
        lanes = road_element.find("lanes")
        if lanes is not None:
            self._read_sections(lanes, road, length, cuts)
            for column, values in zip(self._mark_columns, zip(*self._marks_of_road, strict=True), strict=False):
                column.extend(values)
            self._marks_of_road.clear()
        n.road_section.append(len(n.section_s))

    def _read_sections(self, lanes: PlainElement, road: int, length: float, cuts: Sequence[float]) -> None:
        sections = self._sections(lanes, length)
        left: Side = (None, 0.0)
        right: Side = (None, 0.0)
        kept_left = kept_right = True
        for i, (s, element) in enumerate(sections):
            end = sections[i + 1][0] if i + 1 < len(sections) else length
            new_left, new_right = element.find("left"), element.find("right")
            one_sided = i > 0 and element.get("singleSide") in TRUE
            keep_left = one_sided and new_left is None
            keep_right = one_sided and new_right is None
            left = left if keep_left else (new_left, s)
            right = right if keep_right else (new_right, s)
            kept_left, kept_right = kept_left and keep_left, kept_right and keep_right
            if end == s:
                continue
            inside = self._inside(element, s, end, cuts) if cuts else ()
            for k, span in enumerate(pairwise((s, *inside, end))):
                self._section(element, road, span, s, left, right)
                if one_sided or k > 0:
                    self._continue(kept_left or k > 0, kept_right or k > 0)
            kept_left = kept_right = True

    def _inside(self, section: PlainElement, start: float, end: float, cuts: Sequence[float]) -> list[float]:
        """Return the cuts inside a section, as many as `COPY_LIMIT` allows."""
        found = list(cuts[bisect_right(cuts, start + CUT_TOLERANCE) : bisect_left(cuts, end - CUT_TOLERANCE)])
        if found:
            size = sum(1 for _ in section.iter())
            kept = self._copies // size
            if kept < len(found):
                self._reader.report(MANY_CUTS, f"{len(found)} roads begin or end inside the lane section", section)
            self._copies -= size * min(kept, len(found))
            found = found[:kept]
        return found

    def _sections(self, lanes: PlainElement, length: float) -> list[tuple[float, PlainElement]]:
        """Return the usable lane sections with their start, in ascending order.

        Two one-sided sections may start at the same place, one for each side.
        """
        elements = lanes.findall("laneSection")
        written = [(self._reader.number(one, "s", 0.0, limit=LENGTH_LIMIT), one) for one in elements]
        for (before, _), (s, element) in pairwise(written):
            if s < before:
                self._reader.report(UNSORTED, "s is smaller than that of the lane section before", element, "s")
        found: list[tuple[float, PlainElement]] = []
        for s, element in sorted(written, key=itemgetter(0)):
            if not found:
                found.append((min(s, 0.0), element))
            elif s >= length or (s <= found[-1][0] and not are_two_sides(found[-1][1], element)):
                self._reader.report(BAD_SECTION, f"the lane section at s = {s:g} is left out", element, "s")
            else:
                found.append((s, element))
        return found

    def _section(
        self, element: PlainElement, road: int, span: tuple[float, float], origin: float, left: Side, right: Side
    ) -> None:
        n = self._n
        n.section_s.append(span[0])
        n.section_end.append(span[1])
        n.section_road.append(road)
        lanes = self._side(left, 1)
        n.section_left.append(len(lanes))
        centre = next(iter(grandchildren(element, "center", "lane")), NO_CENTRE)
        lanes.append((0, centre, origin))
        lanes += self._side(right, -1)
        self._lanes(lanes, span[1])
        n.section_lane.append(len(n.lane_id))

    def _side(self, side: Side, sign: int) -> list[Lane]:
        """Return the usable lanes of a side from left to right."""
        found: dict[int, Lane] = {}
        parent, origin = side
        if parent is None:
            return []
        for element in parent.findall("lane"):
            lane = self._reader.integer(element, "id")
            if lane is None or not 0 < lane * sign < LANE_LIMIT or lane in found:
                self._reader.report(BAD_LANE, f"the lane '{element.get('id')}' is left out", element, "id")
            else:
                found[lane] = lane, element, origin
        return sorted(found.values(), key=itemgetter(0), reverse=True)

    def _lanes(self, lanes: list[Lane], end: float) -> None:
        """Append the lanes of the last section, which ends at `end`."""
        n = self._n
        section = len(n.section_s) - 1
        widths_of = []
        bordered = False
        for lane, element, origin in lanes:
            n.lane_id.append(lane)
            n.lane_section.append(section)
            written = element.get("type"), element.get("level"), element.get("direction")
            kind, level, direction = self._plain_lanes.get(written) or self._plain_lane(element, written)
            n.lane_type.append(kind)
            n.lane_level.append(level)
            n.lane_direction.append(direction)
            if direction == 1:
                n.road_directions[-1] = 1
            marks, widths = [], []
            rare = False
            for part in element:
                tag = part.tag
                if tag == "roadMark":
                    marks.append(part)
                elif tag == "width":
                    widths.append(part)
                elif tag == "link":
                    self._links(part, len(n.lane_id) - 1)
                elif tag in RARE_PARTS:
                    rare = True
            if rare:
                self._speeds_and_heights(element, origin)
                bordered = bordered or (lane != 0 and not widths and element.find("border") is not None)
            n.lane_height.append(len(n.height_s))
            n.lane_speed.append(len(n.speed_s))
            if marks:
                self._marks(marks, origin, end)
            n.lane_mark.append(len(n.mark_s))
            widths_of.append(widths)
        for (lane, _, origin), widths in zip(lanes, widths_of, strict=True):
            first, last = self._reader.cubics(n, widths, "sOffset", origin) if widths and lane != 0 else (0, 0)
            n.lane_width_first.append(first)
            n.lane_width_last.append(last)
        if bordered:
            self._widths_of_borders(lanes)

    def _plain_lane(self, element: PlainElement, written: tuple[str | None, ...]) -> tuple[int, int, int]:
        """Return type, level and direction of a lane by its attributes, and keep them unless the type is reported."""
        name, level, direction = written
        code = LANE_TYPE_CODES.get("none" if name is None else name, -1)
        found = code, 1 if level in TRUE else 0, LANE_DIRECTIONS.get(direction or "", 0)
        if code >= 0:
            self._plain_lanes[written] = found
            return found
        message = f"unknown lane type '{element.get('type', '')[:40]}'; 'none' is used"
        self._reader.report(UNKNOWN_LANE_WORD, message, element, "type")
        return NONE, *found[1:]

    def _speeds_and_heights(self, element: PlainElement, origin: float) -> None:
        n, number = self._n, self._reader.number
        for speed in element.findall("speed"):
            n.speed_s.append(origin + number(speed, "sOffset", 0.0, limit=LENGTH_LIMIT))
            n.speed_max.append(self._reader.speed(speed))
        for height in element.findall("height"):
            n.height_s.append(origin + number(height, "sOffset", 0.0, limit=LENGTH_LIMIT))
            n.height_inner.append(number(height, "inner", 0.0))
            n.height_outer.append(number(height, "outer", 0.0))

    def _links(self, link: PlainElement, row: int) -> None:
        for one in link:
            end = LINK_ENDS.get(one.tag)
            if end is not None:
                lane = self._reader.integer(one, "id")
                if lane is not None:
                    self.links.setdefault(2 * row + end, []).append(lane)

    def _continue(self, left: bool, right: bool) -> None:
        """Link a side that continues over a one-sided section or a cut to itself in the previous section."""
        n = self._n
        section = len(n.section_s) - 1
        for at, end in ((section - 1, AT_END), (section, AT_START)):
            for row in range(n.section_lane[at], n.section_lane[at + 1]):
                lane = n.lane_id[row]
                if (lane > 0 and left) or (lane < 0 and right):
                    self.links[2 * row + end] = [lane]

    def _widths_of_borders(self, lanes: list[Lane]) -> None:
        """Compute the widths of the last section's lanes that have borders, from the next borders inside."""
        first = len(self._n.lane_width_first) - len(lanes)
        centre = next(i for i, (lane, _, _) in enumerate(lanes) if lane == 0)
        self._borders(lanes[centre + 1 :], first + centre + 1, 1)
        self._borders(lanes[:centre][::-1], first + centre - 1, -1)

    def _borders(self, lanes: list[Lane], row: int, step: int) -> None:
        """Compute widths of the lanes with borders on one side (from the centre outwards); `row` is the first one's."""
        n = self._n
        edge: list[Cubic] = [(-LENGTH_LIMIT, 0.0, 0.0, 0.0, 0.0)]
        for i, (lane, element, origin) in enumerate(lanes):
            at = row + i * step
            borders = element.findall("border")
            if borders and element.find("width") is None:
                sign = 1.0 if lane > 0 else -1.0
                span = self._reader.cubics(n, borders, "sOffset", origin)
                outer = [(c[0], sign * c[1], sign * c[2], sign * c[3], sign * c[4]) for c in cubics_in(n, *span)]
                widths = _sum(outer or [(origin, 0.0, 0.0, 0.0, 0.0)], edge, -1.0)
                n.lane_width_first[at], n.lane_width_last[at] = append_cubics(n, widths)
                edge = outer or [(origin, 0.0, 0.0, 0.0, 0.0)]
            else:
                widths = cubics_in(n, n.lane_width_first[at], n.lane_width_last[at])
                if widths:
                    edge = _sum(widths, edge, 1.0)

    def _marks(self, elements: list[PlainElement], origin: float, end: float) -> None:
        n = self._n
        for element in elements:
            n.mark_s.append(origin + self._reader.number(element, "sOffset", 0.0, limit=LENGTH_LIMIT))
        if len(elements) > 1:
            starts = n.mark_s[-len(elements) :]
            if starts != sorted(starts):
                self._reader.report(UNSORTED, "the lane's road marks are not in ascending order", elements[0])
                elements = [elements[i] for i in sorted(range(len(elements)), key=starts.__getitem__)]
                starts.sort()
                n.mark_s[-len(elements) :] = starts
            n.mark_end += starts[1:]
        n.mark_end.append(max(n.mark_s[-1], end))
        lines = len(n.line_length)
        for element in elements:
            get = element.get
            written = get("type"), get("color"), get("laneChange"), get("width"), get("weight")
            look = self._plain_marks.get(written) or self._plain_mark(element, written)
            if len(element):
                look = self._detailed_mark(look, element, n.mark_s[len(n.mark_line) - 1])
                lines = len(n.line_length)
            self._marks_of_road.append(look)
            n.mark_line.append(lines)

    def _plain_mark(self, element: PlainElement, written: tuple[str | None, ...]) -> MarkLook:
        """Return the look of a mark by its attributes, and keep it for marks with the same unless one is reported."""
        reported = self._reader.sink.reported
        name = element.get("type", "none")
        kind = MARK_TYPE_CODES.get(name, -1)
        if kind < 0:
            kind = MARK_CUSTOM
            message = f"unknown mark type '{name[:40]}'; 'custom' is used"
            self._reader.report(UNKNOWN_LANE_WORD, message, element, "type")
        colour = MARK_COLOUR_CODES.get(element.get("color", "standard"), 0)
        allowed = element.get("laneChange")
        if allowed is None:
            change = CHANGE_NONE if name in UNCROSSED_MARKS else CHANGE_BOTH
        else:
            change = LANE_CHANGE_CODES.get(allowed.lower(), CHANGE_BOTH)
        width = self._reader.number(element, "width", 0.0)
        if width <= 0.0:
            width = 2.0 * STANDARD_WIDTH if element.get("weight") == "bold" else STANDARD_WIDTH
        look = kind, colour, change, width, 1.0, 1.0, 0, 0
        if self._reader.sink.reported == reported:
            self._plain_marks[written] = look
        return look

    def _detailed_mark(self, look: MarkLook, element: PlainElement, s: float) -> MarkLook:
        """Return the look of a mark from s on with what its children say, and append its lines."""
        kind, colour, change, width, *_ = look
        quality = self._quality(element)
        sways = element.findall("sway")
        sway = self._reader.cubics(self._n, sways, "ds", s) if sways else (0, 0)
        self._lines(grandchildren(element, "type", "line"), 0, width, colour)
        self._lines(grandchildren(element, "explicit", "line"), 1, width, colour)
        return kind, colour, change, width, quality, quality, *sway

    def _quality(self, element: PlainElement) -> float:
        for data in element.findall("userData"):
            if data.get("code") == QUALITY_CODE:
                return min(1.0, max(0.0, self._reader.number(data, "value", 1.0)))
        return 1.0

    def _lines(self, elements: Iterable[PlainElement], once: int, width: float, colour: int) -> None:
        n = self._n
        for line in elements:
            number = self._reader.number
            n.line_length.append(number(line, "length", 0.0))
            n.line_space.append(number(line, "space", 0.0))
            n.line_t.append(number(line, "tOffset", 0.0))
            n.line_s.append(number(line, "sOffset", 0.0))
            n.line_width.append(number(line, "width", width))
            n.line_colour.append(MARK_COLOUR_CODES.get(line.get("color", ""), colour))
            n.line_once.append(once)


def _sum(a: list[Cubic], b: list[Cubic], factor: float) -> list[Cubic]:
    """Return a + factor b as cubics with the starts of both."""
    starts = sorted({row[0] for row in a} | {row[0] for row in b if row[0] > a[0][0]})
    out = []
    for s in starts:
        left, right = _shifted(a, s), _shifted(b, s)
        out.append(
            (
                s,
                left[0] + factor * right[0],
                left[1] + factor * right[1],
                left[2] + factor * right[2],
                left[3] + factor * right[3],
            )
        )
    return out


def _shifted(rows: list[Cubic], s: float) -> tuple[float, float, float, float]:
    """Return the coefficients of the cubic that is valid at s, expanded about s."""
    row = rows[0]
    for one in rows:
        if one[0] <= s:
            row = one
    start, a, b, c, d = row
    if s < start:
        return a, 0.0, 0.0, 0.0
    e = s - start
    return a + e * (b + e * (c + e * d)), b + e * (2.0 * c + 3.0 * e * d), c + 3.0 * e * d, d
