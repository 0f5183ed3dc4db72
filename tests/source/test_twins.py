"""Repeated names: the finding at the second one names the place of the first."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.validation import validate_file

EGO = '<ego speed="10"><start><lane road="1" lane="-1" s="20"/></start></ego>'
AT = '<at><lane road="1" lane="-1" s="{}"/></at>'

INSIDE = {
    "statics": '<static id="x">{}</static>\n',
    "uses": '<use template="sensor_failure" id="x"/>\n',
    "events": '<when name="x"><time after="{}"/><do><sensor_noise sigma="3"/></do></when>\n',
    "traffic": '<traffic id="x" vehicles="1"/>\n',
}


def twins(path: Path, text: str) -> list[tuple[int, list[int]]]:
    """Return the line of each finding of a name that is taken, and the lines of the twins that it names."""
    path.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    validate_file(path, sink)
    return [(one.place.line, [other.place.line for other in one.related]) for one in sink if one.code.id == "SC216"]


@pytest.mark.parametrize("kind", INSIDE)
def test_two_of_a_kind_in_a_scenario(tmp_path: Path, kind: str) -> None:
    lines = [INSIDE[kind].format(AT.format(80) if kind == "statics" else 3), "<!-- -->\n"] * 2
    head = '<scenarios version="1">\n<scenario name="s" map="town_grid" duration="5">\n'
    text = f"{head}{EGO}\n{''.join(lines)}</scenario></scenarios>"
    assert twins(tmp_path / "a.xml", text) == [(6, [4])]


def test_an_actor_with_the_egos_name(tmp_path: Path) -> None:
    head = '<scenarios version="1">\n<scenario name="s" map="town_grid" duration="5">\n'
    static = f'<static id="ego">{AT.format(80)}</static>'
    assert twins(tmp_path / "a.xml", f"{head}{EGO}\n{static}\n</scenario></scenarios>") == [(4, [3])]


def test_two_templates_scenarios_and_parameters(tmp_path: Path) -> None:
    parameter = '<parameter name="p" type="length" default="1"/>\n'
    scenario = f'<scenario name="s" map="town_grid" duration="5">\n{EGO}</scenario>\n'
    template = f'<template name="t">\n{parameter}{parameter}</template>\n'
    text = f'<scenarios version="1">\n{template}{template}{scenario}{scenario}</scenarios>'
    assert twins(tmp_path / "a.xml", text) == [(4, [3]), (6, [2]), (12, [10])]


def test_two_vehicles_of_a_catalog(tmp_path: Path) -> None:
    size = 'length="4" width="2" height="1.5" wheelbase="2.6" center="1.3"'
    vehicle = f'<vehicle name="v" summary="s" source="s" {size}/>\n'
    found = twins(tmp_path / "c.xml", f'<catalog version="1">\n{vehicle}{vehicle}</catalog>')
    assert found == [(3, [2])]


def test_two_entities_in_openscenario(tmp_path: Path) -> None:
    case = Path(__file__).parent.parent / "cases" / "SC749_duplicate_storyboard_element.xosc"
    path = tmp_path / "a.xosc"
    path.write_text(case.read_text(encoding="utf-8"), encoding="utf-8")
    sink = Diagnostics()
    validate_file(path, sink)
    (found,) = [one for one in sink if one.code.id == "SC749"]
    assert len(found.related) == 1
    assert found.related[0].place.line <= found.place.line
