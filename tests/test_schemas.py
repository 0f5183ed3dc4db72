"""The files of schemas/ are what the models say; `--update` rewrites them."""

from __future__ import annotations

import importlib.util
import json
import re
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from lxml import etree

FOLDER = Path(__file__).resolve().parent.parent / "schemas"


def _generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("generate", FOLDER / "generate.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


GENERATOR = _generator()
GENERATED: dict[str, Callable[[], str]] = GENERATOR.GENERATED


@pytest.mark.parametrize("name", sorted(GENERATED))
def test_schema_is_fresh(name: str, assert_fresh: Callable[[Path, str], None]) -> None:
    assert_fresh(FOLDER / name, GENERATED[name]())


def test_nothing_else_lies_there() -> None:
    assert {path.name for path in FOLDER.iterdir() if path.is_file()} == {*GENERATED, "generate.py"}


@pytest.mark.parametrize("name", sorted(GENERATED))
def test_schema_is_well_formed(name: str) -> None:
    text = GENERATED[name]()
    if name.endswith(".xsd"):
        etree.XMLSchema(etree.fromstring(text.encode()))
    else:
        assert "properties" in json.loads(text)


def test_language_page_is_fresh(assert_fresh: Callable[[Path, str], None]) -> None:
    assert_fresh(GENERATOR.LANGUAGE_PAGE, GENERATOR.language_reference())


def test_coverage_page_is_fresh(assert_fresh: Callable[[Path, str], None]) -> None:
    assert_fresh(GENERATOR.COVERAGE_PAGE, GENERATOR.coverage_page())


def test_language_page_explains_every_element_of_the_schema() -> None:
    page = GENERATOR.language_reference()
    schema = etree.fromstring(GENERATED["conflict.xsd"]().encode())
    names = [str(one.get("name")) for one in schema.iter("{*}element") if one.get("ref", one.get("name")) != "nothing"]
    assert [name for name in names if f"`<{name}>`" not in page] == []
    links = set(re.findall(r"\]\(#(\w+)\)", page))
    assert links <= set(re.findall(r'<a id="(\w+)">', page))
