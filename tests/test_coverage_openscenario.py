"""Every element of OpenSCENARIO is read by the module in the table, or is listed with a reason."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from scenario_compiler.coverage.conflict import NOT_YET
from scenario_compiler.coverage.openscenario import FORMS, HOMES, UNREAD, WITHOUT_EFFECT, openscenario_table, words_of
from scenario_compiler.coverage.uses import backing_of, files_naming
from scenario_compiler.openscenario.structure.elements import Element, elements

OTHERS = ("structure", "export")
"""Folders of the front end that do not read."""

PAIRS = {"GeoPosition": {"latitudeDeg", "longitudeDeg"}}
"""Attributes whose names the reader puts together."""


@cache
def texts_of(file: Path) -> frozenset[str]:
    """Return all texts in a module's source."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    return frozenset(
        one.value for one in ast.walk(tree) if isinstance(one, ast.Constant) and isinstance(one.value, str)
    )


@pytest.fixture
def front_end(repository: Path) -> Path:
    """Folder of the modules that read OpenSCENARIO."""
    return repository / "scenario_compiler" / "openscenario"


def read_by_front_end(front_end: Path) -> frozenset[str]:
    """Return the names of elements and attributes that the readers know."""
    files = [file for file in front_end.rglob("*.py") if file.relative_to(front_end).parts[0] not in OTHERS]
    return frozenset().union(*(texts_of(file) for file in files if file.name != "xsd.py"))


def test_every_element_of_the_standard_has_one_place() -> None:
    listed = [*UNREAD, *(name for home in HOMES for name in home.names())]
    words = [name for name, element in elements().items() if words_of(element)]
    assert sorted([*listed, *words]) == sorted(elements())


def test_every_form_is_an_element_of_the_standard() -> None:
    assert {form.tag for form in FORMS} <= set(elements())


def test_elements_are_read_in_the_module_of_the_table(front_end: Path) -> None:
    for home in HOMES:
        module = front_end.joinpath(*home.reader.split("."))
        file = module / "__init__.py" if module.is_dir() else module.with_suffix(".py")
        for name in home.names():
            element = elements()[name]
            assert set(element.tags) & texts_of(file) or stands_for_parts(element, file), (name, home.reader)


def stands_for_parts(element: Element, file: Path) -> bool:
    """Return whether a module reads an element whose tags it builds from parts or passes on."""
    return bool(set(element.children) & texts_of(file)) or element.name in {"OpenSCENARIO"}


def test_unread_parts_have_a_reason() -> None:
    assert all(UNREAD.values())


def test_every_attribute_is_read_or_listed(front_end: Path) -> None:
    known = read_by_front_end(front_end)
    for element in elements().values():
        if element.name in UNREAD:
            continue
        unread = set(element.attributes) - known - PAIRS.get(element.name, set())
        listed = set(WITHOUT_EFFECT.get(element.name, "").split())
        assert unread <= listed, element.name
        assert listed <= {*element.attributes, *(f"<{tag}>" for tag in element.tags)}, element.name


def test_the_table_is_complete() -> None:
    table = openscenario_table()
    assert len(table.rows) == len(elements())
    assert all(len(row) == len(table.columns) and all(row) for row in table.rows)


def test_every_word_that_is_read_is_executed() -> None:
    assert [row["element"] for row in openscenario_table().records() if row["executed"] == NOT_YET] == []


def test_exported_elements_are_elements() -> None:
    for row in openscenario_table().records():
        for tag in re.findall(r"<(\w+)>", row["exported"]):
            assert tag in elements()


def test_files_are_counted_by_their_elements(tmp_path: Path) -> None:
    (tmp_path / "a.xosc").write_text("<Act/><Act/><Event name=''/>", encoding="utf-8")
    (tmp_path / "b.py").write_text("'<Actors>'", encoding="utf-8")
    assert files_naming(sorted(tmp_path.iterdir())) == {"Act": 1, "Event": 1, "Actors": 1}


def test_what_backs_a_feature_is_counted_by_its_variants() -> None:
    page = """## Variants of features

| feature | variant | verdict | runs that agree | why, or the test |
|---|---|---|---|---|
| One | a | agrees | 1 of 1 |  |
| One | b | not recorded, law stated |  | test_b |
| Two | a | differs by decision | 0 of 1 | why |
| Two | b | not recorded |  |  |
| Two | c | agrees | 2 of 3 |  |

## Recorded runs

| Three | x | agrees | | |
"""
    assert backing_of(page) == {
        "One": "yes, 2 of 2 variants",
        "Two": "1 of 3 variants; 1 differs by decision, 1 not recorded",
    }
