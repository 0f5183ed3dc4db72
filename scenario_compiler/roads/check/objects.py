"""Checks objects and signals: their place on the road, their size, and the lanes that they apply to."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.check.filed import Filed, Road, number, whole
from scenario_compiler.structure.findings import Findings

OFF_ROAD = Code(
    "SC355",
    "object-off-road",
    "An object, signal, tunnel or bridge is beyond the end of its road, or too far to the side or too high to "
    "belong to it.\n\n"
    '    <road length="100" ...> ... <object id="1" s="140" t="5" .../>     40 m beyond the end\n\n'
    "Correct s, t and zOffset, or move it to the right road. Rules: "
    "openmsl.net:xodr:1.4.0:road.semantic.object_position and signal_position.",
    Severity.WARNING,
)
ODD_SIZE = Code(
    "SC356",
    "odd-object-size",
    "The size of an object or signal is missing, negative, or unusually large. It is drawn as it is in the file.\n\n"
    '    <object id="1" type="pole" height="4" .../>     neither a radius nor a length and a width\n\n'
    "Give its size in metres. Rules: openmsl.net:xodr:1.4.0:road.semantic.object_size and signal_size.",
    Severity.WARNING,
)
VALIDITY = Code(
    "SC357",
    "odd-lane-validity",
    "The validity of a signal or object names lanes that the road does not have there, or lanes in which traffic "
    "does not drive in its direction (orientation).\n\n"
    '    <signal id="1" orientation="+" ...><validity fromLane="1" toLane="2"/></signal>     lanes -1 and -2\n\n'
    "Name lanes with the direction of the orientation; in right-hand traffic, lanes with negative ids have the "
    "orientation '+'. Rule: openmsl.net:xodr:1.4.0:road.semantic.signal_object_lane_linkage.",
    Severity.WARNING,
)
LOST_CORNER = Code(
    "SC359",
    "lost-corner",
    "A marking or border of an object names a corner that no outline of the object has."
    '\n\n    <marking ...><cornerReference id="7"/></marking>     the outline has corners 0 to 3'
    "\n\nName a corner of the outline. Rule: asam.net:xodr:1.7.0:road.object.no_cornerreference_if_no_outline.",
    Severity.WARNING,
)
NO_ORIENTATION = Code(
    "SC360",
    "object-without-orientation",
    "An object has no orientation ('+', '-' or 'none'), so its direction of travel is not known.\n\n"
    '    <object id="1" type="barrier" s="10" t="4" .../>     for both directions?\n\n'
    'Write orientation="none" for both directions. Rule: asam.net:xodr:1.7.0:road.object.orientation.',
    Severity.NOTE,
)
BOARDS = Code(
    "SC361",
    "signal-boards",
    "A signal of type multiBoard must contain static boards and variable message boards, and must be dynamic.\n\n"
    '    <signal type="multiBoard" dynamic="no"><staticBoard .../></signal>     it has no variable board\n\n'
    'Add the boards and dynamic="yes", or change the signal\'s type. Rules: '
    "asam.net:xodr:1.8.0:road.signal.boards.multi_board_have_sub_boards and multi_board_use_dynamic_true.",
    Severity.WARNING,
)

SIDE_LIMIT, HEIGHT_LIMIT = 50.0, 20.0
"""Largest distance from the reference line and height above it, m (the openMSL quality checker's)."""

OBJECT_LIMIT, SIGNAL_LIMIT = 50.0, 5.0
"""Largest length, width, radius and height of an object; width and height of a signal; m (the openMSL quality
checker's)."""

END_TOLERANCE = 1e-6
"""Distance beyond its road's end up to which an object is not reported, m."""

FIRST_MINOR_WITH_FREE_SIZE = 6
"""First minor version in which an object with an outline needs no size."""


def check_objects(filed: Filed, findings: Findings) -> None:
    """Report faults of objects and signals."""
    header = filed.document.root.find("header")
    minor = whole(header, "revMinor") if header is not None else None
    for road in filed.roads.values():
        for tag in ("object", "objectReference", "tunnel", "bridge"):
            for one in road.element.iterfind(f"objects/{tag}"):
                _check_place(road, one, findings)
                _check_validity(road, one, findings)
                if tag == "object":
                    _check_object(one, minor or 0, findings)
        for tag in ("signal", "signalReference"):
            for one in road.element.iterfind(f"signals/{tag}"):
                _check_place(road, one, findings)
                _check_validity(road, one, findings)
                _check_sizes(one, ("width", "height"), SIGNAL_LIMIT, findings)
                if one.get("type") == "multiBoard":
                    _check_boards(one, findings)


def _check_place(road: Road, one: etree._Element, findings: Findings) -> None:
    s = number(one, "s")
    last = s + number(one, "length") if one.tag in {"tunnel", "bridge"} else s
    if last > road.length + END_TOLERANCE and road.length > 0.0:
        message = f"<{one.tag}> reaches s = {last:.6g}, the road ends at {road.length:.6g}"
        findings.report(OFF_ROAD, message, one, "s" if one.get("s") is not None else None)
    if one.tag in {"tunnel", "bridge"}:
        return
    for name, limit in (("t", SIDE_LIMIT), ("zOffset", HEIGHT_LIMIT)):
        if abs(number(one, name)) > limit:
            findings.report(OFF_ROAD, f"{name} is {number(one, name):.6g}, beyond {limit:g} m", one, name)


def _check_object(one: etree._Element, minor: int, findings: Findings) -> None:
    outlined = one.find("outline") is not None or one.find("outlines/outline") is not None
    sized = one.get("radius") is not None or (one.get("length") is not None and one.get("width") is not None)
    if not sized and not (outlined and minor >= FIRST_MINOR_WITH_FREE_SIZE) and one.find("repeat") is None:
        findings.report(ODD_SIZE, "the object has neither a radius nor a length and a width", one)
    _check_sizes(one, ("length", "width", "radius", "height"), OBJECT_LIMIT, findings)
    if minor >= FIRST_MINOR_WITH_FREE_SIZE and one.get("orientation") is None:
        findings.report(NO_ORIENTATION, "the object has no orientation", one)
    corners = {
        corner.get("id")
        for outline in one.iter("outline")
        for corner in outline.iterchildren("cornerRoad", "cornerLocal")
    }
    for reference in one.iter("cornerReference"):
        if reference.get("id") not in corners:
            message = f"no outline of the object has a corner '{reference.get('id', '')[:20]}'"
            findings.report(LOST_CORNER, message, reference, "id")


def _check_sizes(one: etree._Element, names: tuple[str, ...], limit: float, findings: Findings) -> None:
    for name in names:
        size = number(one, name)
        if not 0.0 <= size <= limit:
            findings.report(ODD_SIZE, f"{name} is {size:.6g}; 0 to {limit:g} m is usual", one, name)


def _check_validity(road: Road, one: etree._Element, findings: Findings) -> None:
    s = number(one, "s")
    if road.section_at(s, 0) is None:
        return
    for validity in one.iterfind("validity"):
        lanes: dict[int, int] = {}
        for name in ("fromLane", "toLane"):
            lane = whole(validity, name)
            if lane is None:
                continue
            section = road.section_at(s, lane)
            element = None if section is None else section.lanes.get(lane)
            lanes[lane] = road.direction(lane, element) if lane != 0 else 0
            if element is None:
                findings.report(VALIDITY, f"the road has no lane {lane} there", validity, name)
        if 0 in lanes:
            message = "lane 0 is the centre line; nothing drives on it"
            findings.report(VALIDITY, message, validity, severity=Severity.NOTE)
        if {"+": -1, "-": 1}.get(one.get("orientation", "")) in lanes.values():
            message = f"orientation '{one.get('orientation')}' does not fit lanes {min(lanes)} to {max(lanes)}"
            findings.report(VALIDITY, message, validity)


def _check_boards(one: etree._Element, findings: Findings) -> None:
    for tag in ("staticBoard", "vmsBoard"):
        if one.find(tag) is None:
            findings.report(BOARDS, f"the board has no <{tag}>", one)
    if one.get("dynamic") != "yes":
        findings.report(BOARDS, "the board is not dynamic", one)
