"""Parts of a road file that are not read are listed, and the list is correct."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document, drop_namespace, parse_document, read_document
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.roads.check import unread
from scenario_compiler.roads.check.opendrive_page import KEPT_ATTRIBUTES, coverage_page
from scenario_compiler.roads.check.unread import READ_ATTRIBUTES
from scenario_compiler.roads.elements import RoadFile
from scenario_compiler.roads.model import read_model
from scenario_compiler.roads.parse import read_network
from scenario_compiler.roads.structure import road_version
from scenario_compiler.roads.structure.grammar import FIRST_MINOR, LAST_MINOR, declarations
from scenario_compiler.roads.tables import RoadTables
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


def test_an_element_that_is_read_elsewhere_is_listed_where_it_is_not() -> None:
    junction = '<junction id="5"><objects><object id="1" s="0" t="0"/></objects></junction>'
    tunnel = '<tunnel id="1" s="0" length="5" type="standard"><validity fromLane="1" toLane="1"/></tunnel>'
    inside = f'</lanes><objects>{tunnel}</objects><userData code="a" value="b"/>'
    document = made(road().replace("</lanes>", inside), junction, minor=8)
    assert [one.path for one in unread(document)] == [
        "road/objects/tunnel/validity",
        "road/userData",
        "junction/objects",
    ]


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
    ("connection", "type"): "only virtual ones differ, and the one in the files tried joins no roads",
    ("shape", "t"): "shapes are level in the files tried",
    ("userData", "code"): "only kept, and for few elements",
    ("userData", "value"): "only kept, and for few elements",
}
"""Attributes that are read and make no difference in the files tried."""


def note_changes(root: etree._Element, changes: dict[tuple[str, str], str]) -> None:
    """Change one attribute after another and note what that changed: "tables", only "model", or ""."""
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
            kept = pair[1] in KEPT_ATTRIBUTES.get(pair[0], ())
            known_use = changes.get(pair) == "tables" or (kept and changes.get(pair) == "model")
            if declaration.name in READ_ATTRIBUTES and pair not in tried and not known_use:
                tried.add(pair)
                changes.setdefault(pair, "")
                for other in OTHER_VALUES:
                    after = state(root, element, str(name), other)
                    if after is None or after[0] != before[0]:
                        changes[pair] = "tables"
                        break
                    if after != before:
                        changes[pair] = "model"
                element.set(name, value)
        for child in element.iterchildren(etree.Element) if not declaration.anything else ():
            inner = declaration.content.declaration(str(child.tag))
            if inner is not None:
                pending.append((child, known[inner]))


def state(
    root: etree._Element, element: etree._Element | None = None, name: str = "", value: str = ""
) -> tuple[str, str] | None:
    """Return all that is read of a file, after a change: tables, and what is only kept."""
    if element is not None:
        element.set(name, value)
    sink = Diagnostics()
    document = parse_document(etree.tostring(root), "made.xodr", sink)
    assert document is not None
    drop_namespace(document.root)
    parsed = read_network(RoadFile("made.xodr", etree.tostring(root)), sink)
    if parsed is None:
        return None
    tables = [getattr(parsed.arrays, column) for column in columns_of(RoadTables)]
    return repr((tables, parsed.road_ids, parsed.junction_ids)), repr(read_model(document, sink))


@pytest.mark.slow
def test_what_counts_as_read_is_read(corpus: Path) -> None:
    """Changing the value of an attribute changes what is read of the file, if and only if it counts as read."""
    changes: dict[tuple[str, str], str] = {}
    for path in sorted(corpus.rglob("*.xodr")):
        document = read_document(path, Diagnostics())
        if path.stat().st_size < LARGEST and document is not None and road_version(document) is not None:
            note_changes(document.root, changes)
    listed = {(name, attribute) for name, attributes in READ_ATTRIBUTES.items() for attribute in attributes}
    assert len(changes) > 150
    assert {pair for pair, change in changes.items() if change} <= listed
    assert {pair for pair, change in changes.items() if not change} & listed <= set(WITHOUT_EFFECT)
    kept = {(name, attribute) for name, attributes in KEPT_ATTRIBUTES.items() for attribute in attributes}
    assert {pair for pair, change in changes.items() if change == "tables"} & kept == set()
    assert {pair for pair, change in changes.items() if change == "model"} <= kept | set(WITHOUT_EFFECT)


def test_the_page_of_what_is_read_is_fresh(repository: Path, assert_fresh: Callable[[Path, str], None]) -> None:
    assert_fresh(repository / "docs" / "opendrive.md", coverage_page())


def test_every_element_and_attribute_has_its_place_on_the_page() -> None:
    page = coverage_page()
    read = {tag for name in READ_ATTRIBUTES for tag in (name, *READ_ATTRIBUTES[name])}
    assert {attribute for names in KEPT_ATTRIBUTES.values() for attribute in names} <= read | {"name"}
    assert "| `access` | lane | " in page
    assert page.count("\n") > 100
