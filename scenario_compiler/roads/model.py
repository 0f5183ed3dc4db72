"""The contents of a road file besides the tables: header, objects, signals, controllers, junctions.

They are not needed to run a scenario, so they are read only on request (`Network.model`). Words are kept as the file
spells them; numbers are in metres and radians in the road's frame (s, t, h). The names of child elements and attributes
that are not interpreted are available as `rest`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isfinite
from typing import NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.document import Document
from scenario_compiler.roads.elements import Element
from scenario_compiler.roads.lane_details import LaneDetails, read_lane_details
from scenario_compiler.roads.reading import Reader

TOO_MANY_REPEATS = Code(
    "SC314",
    "too-many-repeats",
    "A repeated object would have more copies than any road needs. Only the first ones are used; its distance is "
    "probably wrong.\n\n"
    '    <repeat s="0" length="900" distance="0.0001" .../>     9 million poles\n\n'
    "Correct `distance`; 0 means one continuous object, such as a guard rail.",
    Severity.WARNING,
)

REPEAT_LIMIT = 10_000
"""Greatest number of places of one repeated object."""

CONTINUOUS_STEP = 10.0
"""Distance between the places of an object that is repeated without gaps (distance 0), m."""


class UserData(NamedTuple):
    """A `<userData>` element: a code and a value defined by the author of the file."""

    code: str
    value: str


class Corner(NamedTuple):
    """A corner of an outline.

    Attributes:
        local: Whether its place is given in the object's frame (u, v, z), otherwise in the road's (s, t, dz).
        first, second, z: Its place, m.
        height: Height of the object above it, m.
        id: As in the file; empty if not given.
    """

    local: bool
    first: float
    second: float
    z: float
    height: float
    id: str = ""


@dataclass(frozen=True, slots=True)
class Outline:
    """The outline of an object: its corners in order, whether it is closed, and whether it is the outer one."""

    corners: tuple[Corner, ...]
    closed: bool
    outer: bool


@dataclass(frozen=True, slots=True)
class Marking:
    """Paint along an object's outline: a line through given corners, or along a side of its box.

    Attributes:
        side: "left", "right", "front" or "rear"; empty if corners are given.
        corners: Ids of corners of the outlines.
        colour: A colour of the standard.
        width: Width of the line, m.
        line, space: Lengths of the painted and the unpainted pieces, m; without a space the line is solid.
        start, stop: Lengths that are left out at both ends, m.
    """

    side: str
    corners: tuple[str, ...]
    colour: str
    width: float
    line: float
    space: float
    start: float
    stop: float


class Place(NamedTuple):
    """One of the places of a repeated object: s, t, height above the road, m, and its relative position, 0 to 1."""

    s: float
    t: float
    z: float
    share: float


@dataclass(frozen=True, slots=True)
class Repeat:
    """The repetition of an object, with values at its first and last place.

    Attributes:
        s: The first place, m.
        length: Length of the stretch with the places, m.
        distance: Distance between places, m; 0 without gaps.
        t_start, t_end: t of the origin, m.
        z_start, z_end: Height of the origin above the road, m.
        length_start, length_end, width_start, width_end: Size, m; 0 if the object's own size is used.
        height_start, height_end, radius_start, radius_end: The same.
    """

    s: float
    length: float
    distance: float
    t_start: float
    t_end: float
    z_start: float
    z_end: float
    length_start: float = 0.0
    length_end: float = 0.0
    width_start: float = 0.0
    width_end: float = 0.0
    height_start: float = 0.0
    height_end: float = 0.0
    radius_start: float = 0.0
    radius_end: float = 0.0

    def places(self, limit: int = REPEAT_LIMIT) -> Iterator[Place]:
        """Yield at most `limit` places."""
        step = self.distance if self.distance > 0.0 else CONTINUOUS_STEP
        for i in range(min(self.count(), limit)):
            share = min(1.0, i * step / self.length) if self.length > 0.0 else 0.0
            yield Place(
                self.s + i * step,
                self.t_start + share * (self.t_end - self.t_start),
                self.z_start + share * (self.z_end - self.z_start),
                share,
            )

    def count(self) -> int:
        """Return the number of places, without a limit."""
        step = self.distance if self.distance > 0.0 else CONTINUOUS_STEP
        places = self.length / step
        return int(places) + 1 if isfinite(places) and places >= 0.0 else 1


@dataclass(frozen=True, slots=True)
class RoadObject:
    """An object beside or on a road, such as a crosswalk or a parking space.

    Attributes:
        road: Id of the road.
        id, name, subtype: As in the file.
        type: The standard's word: "crosswalk", "parkingSpace", "barrier", ...
        s, t, z_offset: Position of its origin, m.
        heading, pitch, roll: Relative to the road's direction, rad.
        orientation: "+", "-" or "none": the direction of travel to which it applies.
        length, width, height, radius: Size, m; 0 if not given.
        valid_length: Length of the stretch of road for which it is valid, m; 0 for a point.
        dynamic: Whether the file calls it dynamic, as an object with moving parts; its position never changes.
        repeats: Its repetitions.
        outlines: Its outlines.
        markings: Paint along its outlines.
        lanes: (from, to) lane ids of each validity record; empty for all lanes.
        user_data: Additional data of the file's author.
        rest: Tags of the children that are not interpreted, each once.
    """

    road: str
    id: str
    name: str
    type: str
    subtype: str
    s: float
    t: float
    z_offset: float
    heading: float
    pitch: float
    roll: float
    orientation: str
    length: float
    width: float
    height: float
    radius: float
    valid_length: float
    dynamic: bool
    repeats: tuple[Repeat, ...]
    outlines: tuple[Outline, ...]
    markings: tuple[Marking, ...]
    lanes: tuple[tuple[int, int], ...]
    user_data: tuple[UserData, ...]
    rest: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Signal:
    """A sign, traffic light or painted sign. Fields that are not listed are as in `RoadObject`.

    For a reference from another road, `reference` is True and only the fields of a reference are set.

    Attributes:
        type, subtype: Codes of the sign in the catalogue of its country.
        country: Code of the country, such as "DE" or "OpenDRIVE"; empty if not given.
        value: The number of the sign, in `unit`, as text; empty if not given.
        unit: As in the file: "km/h", "m/s", "m", ...
        text: Text on the sign.
        heading_offset: Relative to the road's direction in which it applies, rad.
        reference: Whether it refers to a signal of another road.
        height, width: Size, m; 0 if not given.
    """

    road: str
    id: str
    name: str
    type: str
    subtype: str
    country: str
    value: str
    unit: str
    text: str
    s: float
    t: float
    z_offset: float
    heading_offset: float
    orientation: str
    dynamic: bool
    reference: bool
    height: float
    width: float
    lanes: tuple[tuple[int, int], ...]
    user_data: tuple[UserData, ...]
    rest: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Structure:
    """A tunnel or a bridge, and the stretch of road that it covers, m."""

    road: str
    kind: str
    id: str
    name: str
    type: str
    s: float
    length: float


@dataclass(frozen=True, slots=True)
class ConnectionEnd:
    """Where a connection of a virtual junction leaves or enters a road.

    `s` is in m; `direction` is "+" for travel along s and "-" for travel against it.
    """

    road: str
    s: float
    direction: str


@dataclass(frozen=True, slots=True)
class JunctionConnection:
    """A connection as written: road ids, the touched end of the entered road, (from, to) lane ids.

    Those of virtual junctions may name places inside roads. Without a connecting road they have no path to follow.
    """

    id: str
    incoming: str
    connecting: str
    contact: str
    type: str
    lanes: tuple[tuple[int, int], ...]
    predecessor: ConnectionEnd | None
    successor: ConnectionEnd | None


@dataclass(frozen=True, slots=True)
class Junction:
    """A junction: type "default", "direct", "virtual" or "crossing"; priorities are (high, low) road ids.

    A virtual one lies on its main road from s_start to s_end, m, for travel of an orientation: "+", "-" or "none".
    """

    id: str
    name: str
    type: str
    main_road: str
    s_start: float
    s_end: float
    orientation: str
    connections: tuple[JunctionConnection, ...]
    priorities: tuple[tuple[str, str], ...]
    controllers: tuple[str, ...]
    user_data: tuple[UserData, ...]
    rest: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class SignalGroup:
    """A controller: (signal id, type) of the signals that it switches."""

    id: str
    name: str
    controls: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Header:
    """The header; geo_reference is a PROJ string, offset is the network's (x, y, z in m, heading in rad)."""

    version: tuple[int, int]
    name: str
    date: str
    vendor: str
    geo_reference: str
    offset: tuple[float, float, float, float]
    user_data: tuple[UserData, ...]


@dataclass(frozen=True, slots=True)
class RoadModel:
    """The complete model, each part in the file's order."""

    header: Header
    objects: tuple[RoadObject, ...]
    signals: tuple[Signal, ...]
    structures: tuple[Structure, ...]
    junctions: tuple[Junction, ...]
    controllers: tuple[SignalGroup, ...]
    lanes: tuple[LaneDetails, ...]

    def signals_of(self, controller: str) -> tuple[str, ...]:
        """Return the ids of the signals that a controller switches, by its name or id; empty for an unknown one."""
        group = next((one for one in self.controllers if controller in (one.name, one.id)), None)
        return () if group is None else tuple(signal for signal, _ in group.controls)


def read_model(document: Document, sink: Diagnostics) -> RoadModel:
    """Read the parts that the tables leave out from a document with the root `<OpenDRIVE>`."""
    root = document.root
    reader = _ModelReader(Reader(document, sink))
    roads = root.findall("road")
    return RoadModel(
        reader.header(root),
        tuple(reader.object(road, one) for road in roads for one in road.iterfind("objects/object")),
        tuple(
            reader.signal(road, one)
            for road in roads
            for one in road.iterfind("signals/*")
            if one.tag in {"signal", "signalReference"}
        ),
        tuple(
            reader.structure(road, one)
            for road in roads
            for one in road.iterfind("objects/*")
            if one.tag in {"tunnel", "bridge"}
        ),
        tuple(reader.junction(one) for one in root.iterfind("junction")),
        tuple(_controller(one) for one in root.iterfind("controller")),
        tuple(read_lane_details(reader.numbers, roads)),
    )


def read_repeat(reader: Reader, element: Element) -> Repeat:
    """Read a `<repeat>`."""
    names = (
        *("s", "length", "distance", "tStart", "tEnd", "zOffsetStart", "zOffsetEnd"),
        *("lengthStart", "lengthEnd", "widthStart", "widthEnd", "heightStart", "heightEnd", "radiusStart", "radiusEnd"),
    )
    return Repeat(*(reader.number(element, name, 0.0) for name in names))


def report_repeats(reader: Reader, repeats: Iterable[Element]) -> None:
    """Report objects with more places than `REPEAT_LIMIT`."""
    for element in repeats:
        count = read_repeat(reader, element).count()
        if count > REPEAT_LIMIT:
            message = f"the object is repeated at {count} places; {REPEAT_LIMIT} are used"
            reader.report(TOO_MANY_REPEATS, message, element)


class _ModelReader:
    def __init__(self, reader: Reader) -> None:
        self.numbers = reader

    def _number(self, element: etree._Element, name: str) -> float:
        return self.numbers.number(element, name, 0.0)

    def header(self, root: etree._Element) -> Header:
        element = root.find("header")
        if element is None:
            return Header((0, 0), "", "", "", "", (0.0, 0.0, 0.0, 0.0), ())
        major, minor = (self.numbers.number(element, name, 0.0, limit=1e6) for name in ("revMajor", "revMinor"))
        offset = element.find("offset")
        shift = (0.0, 0.0, 0.0, 0.0)
        if offset is not None:
            x, y, z, h = (self._number(offset, name) for name in ("x", "y", "z", "hdg"))
            shift = (x, y, z, h)
        return Header(
            version=(int(major), int(minor)),
            name=element.get("name", ""),
            date=element.get("date", ""),
            vendor=element.get("vendor", ""),
            geo_reference=(element.findtext("geoReference") or "").strip(),
            offset=shift,
            user_data=_user_data(element),
        )

    def object(self, road: etree._Element, element: etree._Element) -> RoadObject:
        return RoadObject(
            road=road.get("id", ""),
            id=element.get("id", ""),
            name=element.get("name", ""),
            type=element.get("type", ""),
            subtype=element.get("subtype", ""),
            s=self._number(element, "s"),
            t=self._number(element, "t"),
            z_offset=self._number(element, "zOffset"),
            heading=self._number(element, "hdg"),
            pitch=self._number(element, "pitch"),
            roll=self._number(element, "roll"),
            orientation=element.get("orientation", "none"),
            length=self._number(element, "length"),
            width=self._number(element, "width"),
            height=self._number(element, "height"),
            radius=self._number(element, "radius"),
            valid_length=self._number(element, "validLength"),
            dynamic=element.get("dynamic") == "yes",
            repeats=tuple(read_repeat(self.numbers, one) for one in element.iterfind("repeat")),
            outlines=tuple(
                self._outline(one) for one in (*element.findall("outline"), *element.findall("outlines/outline"))
            ),
            markings=tuple(self._marking(one) for one in element.iterfind("markings/marking")),
            lanes=self._lanes(element),
            user_data=_user_data(element),
            rest=_rest(element, {"repeat", "outline", "outlines", "markings", "validity", "userData"}),
        )

    def _outline(self, element: etree._Element) -> Outline:
        corners = []
        for one in element:
            if one.tag == "cornerLocal":
                u, v, z, height = (self._number(one, name) for name in ("u", "v", "z", "height"))
                corners.append(Corner(True, u, v, z, height, one.get("id", "")))
            elif one.tag == "cornerRoad":
                s, t, z, height = (self._number(one, name) for name in ("s", "t", "dz", "height"))
                corners.append(Corner(False, s, t, z, height, one.get("id", "")))
        return Outline(tuple(corners), element.get("closed") != "false", element.get("outer") != "false")

    def _marking(self, element: etree._Element) -> Marking:
        return Marking(
            side=element.get("side", ""),
            corners=tuple(one.get("id", "") for one in element.iterfind("cornerReference")),
            colour=element.get("color", "white"),
            width=self._number(element, "width"),
            line=self._number(element, "lineLength"),
            space=self._number(element, "spaceLength"),
            start=self._number(element, "startOffset"),
            stop=self._number(element, "stopOffset"),
        )

    def _lanes(self, element: etree._Element) -> tuple[tuple[int, int], ...]:
        found = []
        for one in element.iterfind("validity"):
            first, last = self.numbers.integer(one, "fromLane"), self.numbers.integer(one, "toLane")
            if first is not None and last is not None:
                found.append((first, last))
        return tuple(found)

    def signal(self, road: etree._Element, element: etree._Element) -> Signal:
        return Signal(
            road=road.get("id", ""),
            id=element.get("id", ""),
            name=element.get("name", ""),
            type=element.get("type", ""),
            subtype=element.get("subtype", ""),
            country=element.get("country", ""),
            value=element.get("value", ""),
            unit=element.get("unit", ""),
            text=element.get("text", ""),
            s=self._number(element, "s"),
            t=self._number(element, "t"),
            z_offset=self._number(element, "zOffset"),
            heading_offset=self._number(element, "hOffset"),
            orientation=element.get("orientation", "none"),
            dynamic=element.get("dynamic") == "yes",
            reference=element.tag == "signalReference",
            height=self._number(element, "height"),
            width=self._number(element, "width"),
            lanes=self._lanes(element),
            user_data=_user_data(element),
            rest=_rest(element, {"validity", "userData"}),
        )

    def structure(self, road: etree._Element, element: etree._Element) -> Structure:
        return Structure(
            road=road.get("id", ""),
            kind=element.tag,
            id=element.get("id", ""),
            name=element.get("name", ""),
            type=element.get("type", ""),
            s=self._number(element, "s"),
            length=self._number(element, "length"),
        )

    def junction(self, element: etree._Element) -> Junction:
        connections = []
        for one in element.iterfind("connection"):
            lanes = []
            for link in one.iterfind("laneLink"):
                before, after = self.numbers.integer(link, "from"), self.numbers.integer(link, "to")
                if before is not None and after is not None:
                    lanes.append((before, after))
            connections.append(
                JunctionConnection(
                    id=one.get("id", ""),
                    incoming=one.get("incomingRoad", ""),
                    connecting=one.get("connectingRoad", one.get("linkedRoad", "")),
                    contact=one.get("contactPoint", ""),
                    type=one.get("type", "default"),
                    lanes=tuple(lanes),
                    predecessor=self._connection_end(one.find("predecessor")),
                    successor=self._connection_end(one.find("successor")),
                )
            )
        return Junction(
            id=element.get("id", ""),
            name=element.get("name", ""),
            type=element.get("type", "default"),
            main_road=element.get("mainRoad", ""),
            s_start=self._number(element, "sStart"),
            s_end=self._number(element, "sEnd"),
            orientation=element.get("orientation", "none"),
            connections=tuple(connections),
            priorities=tuple((one.get("high", ""), one.get("low", "")) for one in element.iterfind("priority")),
            controllers=tuple(one.get("id", "") for one in element.iterfind("controller")),
            user_data=_user_data(element),
            rest=_rest(element, {"connection", "priority", "controller", "userData"}),
        )

    def _connection_end(self, element: etree._Element | None) -> ConnectionEnd | None:
        if element is None:
            return None
        return ConnectionEnd(
            element.get("elementId", ""), self._number(element, "elementS"), element.get("elementDir", "+")
        )


def _controller(element: etree._Element) -> SignalGroup:
    controls = ((one.get("signalId", ""), one.get("type", "")) for one in element.iterfind("control"))
    return SignalGroup(element.get("id", ""), element.get("name", ""), tuple(controls))


def _user_data(element: etree._Element) -> tuple[UserData, ...]:
    return tuple(UserData(one.get("code", ""), one.get("value", "")) for one in element.iterfind("userData"))


def _rest(element: etree._Element, read: set[str]) -> tuple[str, ...]:
    """Return the tags of the children that are not interpreted, each once, in order."""
    return tuple(dict.fromkeys(str(one.tag) for one in element.iterchildren(etree.Element) if one.tag not in read))
