"""What stands in a road file and is not read is listed, and the list tells the truth."""

from __future__ import annotations

from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, parse_document, read_document
from scenario_compiler.roads.check import unread
from scenario_compiler.roads.check.unread import READ_ATTRIBUTES
from scenario_compiler.roads.model import read_model
from scenario_compiler.roads.parse import drop_namespace, read_network
from scenario_compiler.roads.structure import road_version
from scenario_compiler.roads.structure.grammar import FIRST_MINOR, LAST_MINOR, declarations
from tests.roads.make import lane, road, section


def made(*parts: str, minor: int = 7) -> Document:
    text = f'<OpenDRIVE><header revMajor="1" revMinor="{minor}"/>' + "\n".join(parts) + "</OpenDRIVE>"
    document = parse_document(text.encode(), "made.xodr", Diagnostics())
    assert document is not None
    return document


def test_what_is_not_read_is_listed() -> None:
    inside = '<access sOffset="0" restriction="bus"/>\n<colour sOffset="0"/>\n<access sOffset="0" colour="red"/>'
    document = made(
        road(more='<made up="1"/>').replace("junction=", 'name="a" junction='),
        road("2", lanes=section(lane(1), lane(-1, inside))),
    )
    assert [(one.path, one.attribute, one.count, one.line) for one in unread(document)] == [
        ("road", "name", 1, 1),
        ("road/made", "", 1, 1),
        ("road/lanes/laneSection/right/lane/colour", "", 1, 3),
        ("road/lanes/laneSection/right/lane/access", "colour", 1, 4),
    ]


def test_a_switched_declaration_may_be_unread() -> None:
    junction = '<junction id="5" type="crossing"><roadSection id="0"/></junction>'
    document = made(road(), junction, minor=8)
    assert [(one.path, one.attribute) for one in unread(document)] == [("junction", "")]


LARGEST = 20_000
"""Size of the largest file that is tried, bytes."""

OTHER_VALUES = (
    *("0.37", "5", "x", "LHT", "start", "end", "true", "false", "arcLength", "normalized", "driving", "sidewalk"),
    *("solid", "broken", "bold", "red", "yellow", "none", "junction", "km/h", "town", "yes", "no", "left", "right"),
    *("+", "-", "increase"),
)
"""Values of which one at least differs in meaning from any value of an attribute."""

WITHOUT_EFFECT = {
    ("centre_lane", "id"): "it is 0",
    ("road", "junction"): "only ids of junctions that exist mean something",
    ("roadMark", "weight"): "a width takes precedence",
    ("laneSection", "singleSide"): "no file has it where it matters",
    ("lane_neighbour", "id"): "the same lane goes on in most files, linked or not",
    ("shape", "t"): "shapes are level in the files tried",
    ("userData", "code"): "only kept, and for few elements",
    ("userData", "value"): "only kept, and for few elements",
}
"""Attributes that are read and make no difference in the files tried."""


def note_changes(root: etree._Element, changes: dict[tuple[str, str], bool]) -> None:
    """Change one attribute after another and note whether that changed what is read."""
    header = root.find("header")
    minor = int(header.get("revMinor", "0")) if header is not None else 0
    before = state(root)
    if not FIRST_MINOR <= minor <= LAST_MINOR or before is None:
        return
    known = declarations(minor)
    tried: set[tuple[str, str]] = set()
    pending = [(root, known["OpenDRIVE"])]
    while pending:
        element, declaration = pending.pop()
        if declaration.switch is not None:
            declaration = known[declaration.switch[1].get(element.get(declaration.switch[0], ""), declaration.name)]
        for name, value in list(element.attrib.items()):
            pair = (declaration.name, str(name))
            if declaration.name in READ_ATTRIBUTES and pair not in tried and not changes.get(pair):
                tried.add(pair)
                changes[pair] = any(state(root, element, str(name), other) != before for other in OTHER_VALUES)
                element.set(name, value)
        for child in element.iterchildren(etree.Element) if not declaration.anything else ():
            inner = declaration.content.declaration(str(child.tag))
            if inner is not None:
                pending.append((child, known[inner]))


def state(root: etree._Element, element: etree._Element | None = None, name: str = "", value: str = "") -> str | None:
    """Return all that is read of a file, after a change."""
    if element is not None:
        element.set(name, value)
    sink = Diagnostics()
    document = parse_document(etree.tostring(root), "made.xodr", sink)
    assert document is not None
    drop_namespace(document.root)
    parsed = read_network(document, sink)
    if parsed is None:
        return None
    tables = [getattr(parsed.tables, column) for column in parsed.tables.__slots__]
    return repr((tables, parsed.road_ids, parsed.junction_ids, read_model(document, sink)))


@pytest.mark.slow
def test_what_counts_as_read_is_read(corpus: Path) -> None:
    """Changing the value of an attribute changes what is read of the file, if and only if it counts as read."""
    changes: dict[tuple[str, str], bool] = {}
    for path in sorted(corpus.rglob("*.xodr")):
        document = read_document(path, Diagnostics())
        if path.stat().st_size < LARGEST and document is not None and road_version(document) is not None:
            note_changes(document.root, changes)
    listed = {(name, attribute) for name, attributes in READ_ATTRIBUTES.items() for attribute in attributes}
    assert len(changes) > 150
    assert {pair for pair, change in changes.items() if change} <= listed
    assert {pair for pair, change in changes.items() if not change} & listed <= set(WITHOUT_EFFECT)
