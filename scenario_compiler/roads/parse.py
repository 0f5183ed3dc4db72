"""Reads OpenDRIVE XML into `RoadTables`, with diagnostics for parts that cannot be used.

Faults of a road file are warnings: the record is left out or replaced by the standard's default, and the rest is read.
Only a file without any usable network is an error. Parts that the tables do not contain (objects, signals, controllers,
header) are read by `model` on request.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import nan

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.roads.attachments import Attachment, cuts_of, read_attachments
from scenario_compiler.roads.derived import with_derived_columns, with_knots
from scenario_compiler.roads.elements import PlainElement, RoadFile, grandchildren
from scenario_compiler.roads.lane_parse import LaneReader
from scenario_compiler.roads.lane_types import ROAD_TYPE_CODES
from scenario_compiler.roads.reading import LENGTH_LIMIT, Reader
from scenario_compiler.roads.reference_parse import read_reference_line
from scenario_compiler.roads.tables import NO_SPEED, ParsedNetwork, RoadTables
from scenario_compiler.roads.topology import read_links

NOT_OPENDRIVE = Code(
    "SC301",
    "not-opendrive",
    "The root element of the road file is not <OpenDRIVE>, or the file has no usable <road>.\n\n"
    "    <OpenSCENARIO>...</OpenSCENARIO>     in the file that `map` names\n\n"
    "Check that the scenario names the right file, and that every <road> has a reference line and a length.",
)
DUPLICATE_ROAD = Code(
    "SC302",
    "duplicate-road",
    "Two roads have the same id. Links and positions name a road by its id, so only the first one is used.\n\n"
    '    <road id="4" ...>...</road>\n'
    '    <road id="4" ...>...</road>     not used; which of them would road="4" mean?\n\n'
    "Give one of them another id, and change the links to it.",
    Severity.WARNING,
)
UNUSABLE_ROAD = Code(
    "SC303",
    "unusable-road",
    "A road cannot be used and is left out: it has no id, no reference line (<planView> with <geometry>), or a length "
    "that is 0 or negative."
    '\n\n    <road id="4" length="0">...</road>     a road that is 0 m long'
    "\n\nAdd what is missing, or remove the road and the links to it.",
    Severity.WARNING,
)
UNKNOWN_WORD = Code(
    "SC304",
    "unknown-road-word",
    "An attribute has a value that OpenDRIVE does not know (a lane type, a mark type, a colour, a traffic rule). "
    "The default is used in its place.\n\n"
    '    <road id="4" rule="left" ...>     RHT or LHT\n\n'
    "Use a value of the standard. A file that was written for another program may use values of that program.",
    Severity.WARNING,
)


def read_network(file: RoadFile, sink: Diagnostics) -> ParsedNetwork | None:
    """Parse a file and read its roads, junctions and links; None (and an error) if it has no road.

    A file in which roads begin or end inside other roads is read twice, because these are cut there.
    """
    reading = _Reading(file, {})
    root = file.parse(reading.take, sink)
    if root is None:
        return None
    if root.tag != "OpenDRIVE":
        sink.add(NOT_OPENDRIVE, f"the root element is <{root.tag}>, not <OpenDRIVE>", file.origin(root))
        return None
    attachments = read_attachments(reading.reader, root)
    if attachments:
        reading = _Reading(file, cuts_of(attachments))
        root = file.parse(reading.take, sink)
        if root is None:
            return None
        attachments = read_attachments(reading.reader, root)
    parsed = reading.finish(root, attachments)
    root.clear()  # lxml keeps it until the next garbage collection
    sink.absorb(reading.findings)
    return parsed


class _Reading:
    """Reads the roads of a file one after the other, and then what refers to them.

    Attributes:
        findings: What is found, if the file as a whole can be used.
        reader: Reports there.
    """

    def __init__(self, file: RoadFile, cuts: Mapping[str, Sequence[float]]) -> None:
        """Begin before the first road; `cuts` are the places where other roads are attached, by road, ascending."""
        self.findings = Diagnostics()
        self.reader = Reader(file, self.findings)
        self._file = file
        self._cuts = cuts
        self._n = RoadTables()
        self._lanes = LaneReader(self.reader, self._n)
        self._roads: dict[str, PlainElement] = {}

    def take(self, element: PlainElement) -> None:
        """Read a road; only its links are left in the element."""
        self._take_road(element)
        _report_repeats(self.reader, element)
        for part in element:
            if part.tag != "link":
                part.clear()

    def _take_road(self, element: PlainElement) -> None:
        road_id = element.get("id")
        if road_id is None:
            self.reader.report(UNUSABLE_ROAD, "a road without id is left out", element)
        elif road_id in self._roads:
            message = f"a second road has the id '{road_id}'; it is left out"
            self.reader.report(DUPLICATE_ROAD, message, element, "id")
        elif _read_road(self.reader, self._n, self._lanes, element, self._cuts.get(road_id, ())):
            self._roads[road_id] = element

    def finish(self, root: PlainElement, attachments: Sequence[Attachment]) -> ParsedNetwork | None:
        """Read the junctions and links; return None (and an error) if there is no road."""
        roads, road_ids = list(self._roads.values()), list(self._roads)
        if not roads:
            self.findings.add(NOT_OPENDRIVE, "the file has no usable <road>", self._file.origin(root))
            return None
        junction_ids = [junction.get("id") or "" for junction in root.findall("junction")]
        junctions = {name: i for i, name in reversed(list(enumerate(junction_ids)))}
        n = with_knots(self._n)
        n.road_junction.extend(junctions.get(road.get("junction", "-1"), -1) for road in roads)
        stated = read_links(self.reader, n, root, roads, road_ids, junctions, self._lanes.links, attachments)
        return ParsedNetwork(with_derived_columns(n, stated), road_ids, junction_ids)


def _read_road(
    reader: Reader,
    n: RoadTables,
    lanes: LaneReader,
    element: PlainElement,
    cuts: Sequence[float],
) -> bool:
    """Append one road to the tables; return False if it cannot be used."""
    if element.get("length") is None:
        geometries = grandchildren(element, "planView", "geometry")
        length = sum(reader.number(one, "length", 0.0, limit=LENGTH_LIMIT) for one in geometries)
    else:
        length = reader.number(element, "length", nan, limit=LENGTH_LIMIT, otherwise="the road is left out")
        if length <= 0.0:
            reader.report(UNUSABLE_ROAD, "the road's length is not positive; it is left out", element, "length")
        if not length > 0.0:
            return False
    if length <= 0.0 or not read_reference_line(reader, n, element, length):
        reader.report(UNUSABLE_ROAD, "the road has no reference line of positive length; it is left out", element)
        return False
    n.road_length.append(length)
    rule = element.get("rule", "RHT")
    if rule not in {"RHT", "LHT"}:
        reader.report(UNKNOWN_WORD, f"unknown traffic rule '{rule}'; 'RHT' is used", element, "rule")
    n.road_rule.append(-1 if rule == "LHT" else 1)
    _read_profiles(reader, n, element)
    _read_types(reader, n, element)
    road = len(n.road_length) - 1
    lanes.read(element, road, length, cuts)
    n.road_flat.append(int(_is_flat(n, road)))
    return True


def _report_repeats(reader: Reader, road: PlainElement) -> None:
    repeats = [one for element in grandchildren(road, "objects", "object") for one in element.findall("repeat")]
    if repeats:
        from scenario_compiler.roads.model import report_repeats  # to import it takes a third of a small file's time

        report_repeats(reader, repeats)


def _read_profiles(reader: Reader, n: RoadTables, element: PlainElement) -> None:
    elevation = reader.cubics(n, grandchildren(element, "elevationProfile", "elevation"), "s", 0.0)
    roll = reader.cubics(n, grandchildren(element, "lateralProfile", "superelevation"), "s", 0.0)
    offset = reader.cubics(n, grandchildren(element, "lanes", "laneOffset"), "s", 0.0)
    left, right = (0, 0), (0, 0)
    falls = grandchildren(element, "lateralProfile", "crossfall")
    if falls:
        left = reader.cubics(n, [one for one in falls if one.get("side") != "right"], "s", 0.0)
        right = reader.cubics(n, [one for one in falls if one.get("side") != "left"], "s", 0.0)
    for (first, last), firsts, lasts in (
        (elevation, n.road_elevation_first, n.road_elevation_last),
        (roll, n.road_superelevation_first, n.road_superelevation_last),
        (offset, n.road_offset_first, n.road_offset_last),
        (left, n.road_crossfall_left_first, n.road_crossfall_left_last),
        (right, n.road_crossfall_right_first, n.road_crossfall_right_last),
    ):
        firsts.append(first)
        lasts.append(last)
    stations: dict[float, list[PlainElement]] = {}
    for one in grandchildren(element, "lateralProfile", "shape"):
        stations.setdefault(reader.number(one, "s", 0.0), []).append(one)
    for s in sorted(stations):
        first, last = reader.cubics(n, stations[s], "t", 0.0)
        n.shape_s.append(s)
        n.shape_first.append(first)
        n.shape_last.append(last)
    n.road_shape.append(len(n.shape_s))


def _read_types(reader: Reader, n: RoadTables, element: PlainElement) -> None:
    for one in sorted(element.findall("type"), key=lambda e: reader.number(e, "s", 0.0)):
        speed = one.find("speed")
        n.type_s.append(reader.number(one, "s", 0.0))
        n.type_code.append(ROAD_TYPE_CODES.get(one.get("type", "unknown"), 0))
        n.type_speed.append(NO_SPEED if speed is None else reader.speed(speed))
    n.road_type.append(len(n.type_s))


def _is_flat(n: RoadTables, road: int) -> bool:
    """Return whether height, pitch and roll are 0 on the whole last road."""
    if (
        n.road_elevation_first[road] < n.road_elevation_last[road]
        or n.road_superelevation_first[road] < n.road_superelevation_last[road]
        or n.road_crossfall_left_first[road] < n.road_crossfall_left_last[road]
        or n.road_crossfall_right_first[road] < n.road_crossfall_right_last[road]
        or n.road_shape[road] < len(n.shape_s)
    ):
        return False
    return n.lane_height[n.section_lane[n.road_section[road]]] == len(n.height_s)
