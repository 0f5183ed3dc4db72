"""The files of schemas/, and pages of docs/, agree with the models; `--update` rewrites them."""

from __future__ import annotations

import argparse
import importlib.util
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import get_args

import pytest
from lxml import etree

from scenario_compiler.cli import make_parser
from scenario_compiler.expressions import parse_expression
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.names import EVENT_TEXTS, StopReason
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.recording import COLUMNS, Header
from scenario_compiler.recording.trajectory import TRAJECTORY_COLUMNS
from scenario_compiler.report.run_folder_page import STOPS
from tests.report.made import RUN_FILES

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
PAGES: dict[str, Callable[[], str]] = GENERATOR.PAGES


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


@pytest.mark.parametrize("name", sorted(PAGES))
def test_page_is_fresh(name: str, assert_fresh: Callable[[Path, str], None]) -> None:
    assert_fresh(GENERATOR.PAGES_FOLDER / name, PAGES[name]())


def test_stub_of_the_public_names_is_fresh(assert_fresh: Callable[[Path, str], None]) -> None:
    assert_fresh(GENERATOR.STUB, GENERATOR.stub())


def test_page_of_commands_has_every_command_and_option() -> None:
    page = PAGES["commands.md"]()
    for words, parser in _parsers(make_parser()):
        section = page.partition(f"## {words}\n")[2].partition("\n## ")[0]
        assert section, words
        options = [text for action in parser._actions for text in action.option_strings]
        assert [one for one in options if one not in ("-h", "--help") and f"`{one}" not in section] == []


def _parsers(parser: argparse.ArgumentParser, before: str = "") -> Iterator[tuple[str, argparse.ArgumentParser]]:
    """Yield every command that does something, with its words."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                below = list(_parsers(inner, f"{before}{name} "))
                yield from below or [(f"{before}{name}", inner)]


def test_page_of_the_run_folder_has_every_name() -> None:
    page = PAGES["run-folder.md"]()
    names = [*RUN_FILES, *TRAJECTORY_COLUMNS, *EventRow.model_fields, *EVENT_TEXTS, *get_args(StopReason)]
    names += [*Outcome.model_fields, *Plan.model_fields, *Header.model_fields]
    names += [*(one.name for one in MEASURES), *(one.name for one in COLUMNS if one.name != "present")]
    assert [name for name in names if f"`{name}`" not in page and name] == []
    assert set(STOPS) == set(get_args(StopReason))


def test_language_page_explains_every_element_of_the_schema_by_example() -> None:
    page = GENERATOR.language_page()
    schema = etree.fromstring(GENERATED["conflict.xsd"]().encode())
    names = [str(one.get("name")) for one in schema.iter("{*}element") if one.get("ref", one.get("name")) != "nothing"]
    assert [name for name in names if f"`<{name}>`" not in page] == []
    links = set(re.findall(r"\]\(#([\w-]+)\)", page))
    assert links <= set(re.findall(r'<a id="([\w-]+)">', page))
    sections = [one for one in page.split("<a id=")[1:] if "\n## `<" in one]
    assert len(sections) > 150
    assert [one.splitlines()[0] for one in sections if "```xml" not in one] == []


def test_examples_of_expressions_on_the_language_page_have_the_values_that_it_states() -> None:
    examples = re.findall(r"\(`([^`]+)`\s+is\s+(-?\d+)\)", GENERATOR.language_page())
    assert len(examples) == 4
    assert [(text, parse_expression(text).evaluate({})) for text, value in examples] == [
        (text, float(value)) for text, value in examples
    ]
