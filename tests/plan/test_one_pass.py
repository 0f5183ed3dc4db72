"""Every fault of a file is found in one pass: no fault hides an independent one."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.validation import validate_file

EGO = '<ego speed="12"><start><spawn_point name="main_street"/></start></ego>'
OVERLAPPING = (
    '<static id="a"><at><ahead_of entity="ego" distance="30"/></at></static>'
    '<static id="b"><at><ahead_of entity="ego" distance="31"/></at></static>'
)
LATE = '<when><time after="60"/><do><speed to="0"/></do></when>'


def _scenario(name: str, body: str, ego: str = EGO, end: str = "") -> str:
    return f'<scenario name="{name}" map="town_grid" duration="5">{ego}{body}{end}</scenario>'


def _codes(folder: Path, *scenarios: str) -> list[str]:
    path = folder / "faults.xml"
    path.write_text("\n".join(['<scenarios version="1">', *scenarios, "</scenarios>"]), encoding="utf-8")
    sink = Diagnostics()
    validate_file(path, sink)
    return [one.code.id for one in sink]


@pytest.mark.parametrize(
    ("first", "code"),
    [
        (OVERLAPPING, "SC381"),
        ('<static id="c"><at><ahead_of entity="egoo" distance="30"/></at></static>', "SC222"),
        ('<static id="c"><at><ahead_of entity="ego" distance="30" turm="1"/></at></static>', "SC106"),
        ('<static id="c"><at><lane road="77" lane="-1" s="3"/></at></static>', "SC371"),
    ],
)
def test_a_fault_of_one_scenario_hides_no_fault_of_the_next(tmp_path: Path, first: str, code: str) -> None:
    found = _codes(tmp_path, _scenario("one", first), _scenario("two", OVERLAPPING + LATE))
    assert found[0] == code
    assert found[-2:] == ["SC381", "SC402"]


@pytest.mark.parametrize(
    ("fault", "code"),
    [
        ('<static id="c"><at><ahead_of entity="egoo" distance="60"/></at></static>', "SC222"),
        ('<static id="c"><at><lane road="77" lane="-1" s="3"/></at></static>', "SC371"),
        ('<static id="c"><at><lane road="1" lane="-9" s="3"/></at></static>', "SC372"),
        ('<static id="c"><at><lane road="1" lane="-1" s="9999"/></at></static>', "SC373"),
        ('<static id="c"><at><world x="9999" y="0"/></at></static>', "SC374"),
        ('<static id="c"><at><ahead_of entity="ego" distance="60" lanes="4"/></at></static>', "SC372"),
        ('<static id="c"><at><spawn_point name="nowhere"/></at></static>', "SC376"),
        ('<static id="c"><at><ahead_of entity="c" distance="9"/></at></static>', "SC230"),
        ('<static id="c"><at><random roads="77"/></at></static>', "SC371"),
        ('<static id="c"><at><random roads="1" lane="9"/></at></static>', "SC382"),
        ('<static id="a"><at><ahead_of entity="ego" distance="60"/></at></static>', "SC216"),
        ('<traffic id="flow" vehicles="3" roads="77"/>', "SC371"),
        ('<markings road="77" from="0" to="9" quality="0"/>', "SC371"),
        ('<when><event name="nothing"/><do><speed to="0"/></do></when>', "SC228"),
        ('<when><reached><lane road="77" lane="1" s="3"/></reached><do><speed to="0"/></do></when>', "SC371"),
        ('<when><time after="1"/><do><teleport><lane road="1" lane="9" s="3"/></teleport></do></when>', "SC372"),
    ],
)
def test_a_fault_hides_no_independent_fault(tmp_path: Path, fault: str, code: str) -> None:
    found = _codes(tmp_path, _scenario("one", OVERLAPPING + fault + LATE))
    assert sorted(found) == sorted([code, "SC381", "SC402"])


def test_a_start_off_every_road_hides_no_other_fault_and_is_not_a_missing_start(tmp_path: Path) -> None:
    ego = EGO.replace("main_street", "nowhere")
    body = '<static id="a"><at><lane road="1" lane="-1" s="30"/></at></static>'
    found = _codes(tmp_path, _scenario("one", body + body.replace('"a"', '"b"') + LATE, ego))
    assert sorted(found) == ["SC376", "SC381", "SC402"]


def test_a_fault_of_names_hides_no_unused_template(tmp_path: Path) -> None:
    templates = "".join(f'<template name="{name}">{OVERLAPPING}</template>' for name in ("forgotten", "wanted"))
    unknown = '<static id="c"><at><ahead_of entity="egoo" distance="60"/></at></static>'
    twice = _scenario("one", "") + _scenario("one", '<use template="wanted"/>')
    assert _codes(tmp_path, templates, _scenario("two", unknown), twice) == ["SC226", "SC222", "SC216"]


def test_a_template_with_a_misspelt_use_is_not_reported_as_unused(tmp_path: Path) -> None:
    template = f'<template name="wanted">{OVERLAPPING}</template>'
    assert _codes(tmp_path, template, _scenario("one", '<use template="wantd"/>')) == ["SC213"]


def test_unreadable_parts_are_not_reported_as_missing(tmp_path: Path) -> None:
    nowhere = '<dynamic id="c" speed="3"><strat><lane road="1" lane="1" s="9"/></strat></dynamic>'
    assert _codes(tmp_path, _scenario("one", nowhere)) == ["SC105"]


def test_an_unknown_argument_of_the_command_line_hides_nothing(tmp_path: Path) -> None:
    path = tmp_path / "faults.xml"
    path.write_text(f'<scenarios version="1">{_scenario("one", OVERLAPPING)}</scenarios>', encoding="utf-8")
    sink = Diagnostics()
    assert compile_target(path, {"speed": "3"}, sink) is None
    assert sorted(one.code.id for one in sink) == ["SC211", "SC381"]
