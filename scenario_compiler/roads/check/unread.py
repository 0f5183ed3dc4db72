"""Lists the parts of a road file that are not read: elements and attributes, known to OpenDRIVE or not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

from lxml import etree

from scenario_compiler.document import Document
from scenario_compiler.roads.structure import road_version
from scenario_compiler.roads.structure.grammar import FIRST_MINOR, LAST_MINOR, declarations
from scenario_compiler.structure.notation import Declaration

READ = """
OpenDRIVE
header revMajor revMinor name date vendor
geoReference
offset x y z hdg
userData code value
road id junction length rule
road_link
road_neighbour elementId elementType contactPoint elementS elementDir
road_type s type
road_speed max unit
planView
geometry s x y hdg length
plain
spiral curvStart curvEnd
arc curvature
poly3 a b c d
paramPoly3 aU bU cU dU aV bV cV dV pRange
elevationProfile
lateralProfile
cubic s a b c d
crossfall side s a b c d
shape s t a b c d
lanes
laneSection s singleSide
left
right
center
left_lane id type level direction advisory dynamicLaneDirection dynamicLaneType roadWorks
right_lane id type level direction advisory dynamicLaneDirection dynamicLaneType roadWorks
centre_lane id type level
lane_link
lane_neighbour id
width sOffset a b c d
border sOffset a b c d
speed sOffset max unit
height sOffset inner outer
access sOffset rule restriction
restriction type
material sOffset friction roughness surface
rule sOffset value
visibility sOffset forward back left right
roadMark sOffset type color weight width laneChange
sway ds a b c d
mark_type
mark_line length space tOffset sOffset width color
explicit
explicit_line length tOffset sOffset width
objects
object id name type subtype s t zOffset hdg pitch roll orientation length width height radius validLength dynamic
repeat s length distance tStart tEnd zOffsetStart zOffsetEnd lengthStart lengthEnd widthStart widthEnd heightStart \
  heightEnd radiusStart radiusEnd
outlines
outline closed outer
cornerRoad s t dz height id
cornerLocal u v z height id
markings
marking side color width lineLength spaceLength startOffset stopOffset
cornerReference id
validity fromLane toLane
tunnel id name type s length
bridge id name type s length
signals
signal id name type subtype country value unit text s t zOffset hOffset orientation dynamic height width
signalReference id s t orientation
controller id name
control signalId type
junction id name type mainRoad sStart sEnd orientation
direct_junction id name type
virtual_junction id name type mainRoad sStart sEnd orientation
connection id incomingRoad connectingRoad linkedRoad contactPoint type
direct_connection id incomingRoad linkedRoad contactPoint
virtual_connection id incomingRoad connectingRoad contactPoint type
bypassing_connection id incomingRoad connectingRoad contactPoint type
connection_end elementId elementS elementDir
laneLink from to
priority high low
junction_controller id
"""
"""Declarations (see `structure.grammar`) of elements that are read, with the attributes that are read."""

READ_ATTRIBUTES = {line.split()[0]: frozenset(line.split()[1:]) for line in READ.split("\n") if line}
"""Attributes that are read, by declaration."""

_JUNCTION_PARTS = frozenset({"planView", "objects"})
NOT_READ_IN = {
    "junction": _JUNCTION_PARTS,
    "virtual_junction": _JUNCTION_PARTS,
    "direct_junction": _JUNCTION_PARTS,
    "centre_lane": frozenset({"width", "border"}),
    "tunnel": frozenset({"validity", "Validity", "laneValidity"}),
    "bridge": frozenset({"validity", "Validity", "laneValidity"}),
    "object": frozenset({"Validity", "laneValidity"}),
    "signal": frozenset({"Validity", "laneValidity"}),
    "signalReference": frozenset({"Validity", "laneValidity"}),
}
"""Tags of elements that are read in other declarations but not in these."""

USER_DATA_IN = frozenset(
    {"header", "left_lane", "right_lane", "centre_lane", "roadMark", "object", "signal", "signalReference", "junction"}
    | {"virtual_junction", "direct_junction"}
)
"""Declarations whose user data is read."""


@dataclass(frozen=True, slots=True)
class Unread:
    """An element (or one of its attributes) that is not read.

    Attributes:
        path: Tags from the root, such as "road/lanes/laneSection/right/lane/access".
        attribute: The attribute, "" for the whole element.
        count: Number of occurrences in the file.
        line: Line of the first one.
    """

    path: str
    attribute: str
    count: int
    line: int


def unread(document: Document) -> tuple[Unread, ...]:
    """Return the parts of a road file that are not read, each kind once, in the order of the file."""
    version = road_version(document)
    minor = version[1] if version is not None and FIRST_MINOR <= version[1] <= LAST_MINOR else LAST_MINOR
    known = declarations(minor)
    found: dict[tuple[str, str], tuple[int, etree._Element]] = {}
    pending: list[tuple[etree._Element, Declaration | None, str]] = [(document.root, known["OpenDRIVE"], "")]
    while pending:
        element, declaration, path = pending.pop()
        if declaration is not None and declaration.switch is not None:
            attribute, cases = declaration.switch
            declaration = known[cases.get(element.get(attribute, ""), declaration.name)]
        if declaration is None or declaration.name not in READ_ATTRIBUTES:
            _count(found, (path, ""), element)
            continue
        for name in cast("Mapping[str, str]", element.attrib):
            if name not in READ_ATTRIBUTES[declaration.name] and not name.startswith("{"):
                _count(found, (path, name), element)
        inner: list[tuple[etree._Element, Declaration | None, str]] = []
        for child in element.iterchildren(etree.Element) if not declaration.anything else ():
            tag = etree.QName(child).localname
            below = f"{path}/{tag}".lstrip("/")
            target = declaration.content.declaration(tag)
            elsewhere = tag in NOT_READ_IN.get(declaration.name, ())
            elsewhere |= tag == "userData" and declaration.name not in USER_DATA_IN
            inner.append((child, None if target is None or elsewhere else known[target], below))
        pending.extend(reversed(inner))
    return tuple(
        Unread(path, attribute, count, document.origin(first, attribute or None).line)
        for (path, attribute), (count, first) in found.items()
    )


def _count(
    found: dict[tuple[str, str], tuple[int, etree._Element]], key: tuple[str, str], element: etree._Element
) -> None:
    count, first = found.get(key, (0, element))
    found[key] = (count + 1, first)
