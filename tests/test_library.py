"""The library as files: it reads without a finding, says where things come from, and keeps to its conventions."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from scenario_compiler.compiler import compile_target, validate_file
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.document import read_document
from scenario_compiler.expressions import format_value
from scenario_compiler.resources import library_folder
from scenario_compiler.source import parse
from scenario_compiler.source.catalogs import load_catalogs
from scenario_compiler.source.conflict import Library, Part
from scenario_compiler.source.parameters import limits
from scenario_compiler.source.templates import template_parameters
from scenario_compiler.vocabulary.scenario import Parameter

LIBRARY = library_folder()
FILES = sorted(LIBRARY.rglob("*.xml"))
CONFLICTS = sorted((LIBRARY / "conflicts").glob("*.xml"))
TEMPLATES = sorted((LIBRARY / "templates").glob("*.xml"))

GOLD = {
    "sensor_failure": (2, "3", "1-2"),
    "ramp_blocked": (5, "3", "3"),
    "road_narrows": (7, "3", "2"),
    "obstacle_ahead": (9, "3", "1-3"),
    "markings_missing": (10, "3", "1"),
}
"""Number, urgency and response of Gold et al. 2018 as the AISA paper's table 1 quotes them."""


def _library(path: Path) -> Library:
    sink = Diagnostics()
    document = read_document(path, sink)
    assert document is not None
    source = parse(document, sink)
    assert isinstance(source, Library)
    return source


def _parameters(part: Part) -> Mapping[str, Parameter]:
    return template_parameters(part, Diagnostics()).known


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_file_has_no_finding(path: Path) -> None:
    sink = Diagnostics()
    validate_file(path, sink)
    assert [as_text(one) for one in sink] == []


@pytest.mark.parametrize("path", [*CONFLICTS, *TEMPLATES], ids=lambda path: path.stem)
def test_file_is_named_after_what_it_holds(path: Path) -> None:
    library = _library(path)
    held = {**library.scenarios, **library.templates}
    assert list(held) == [path.stem]
    element = held[path.stem].element
    assert element.get("summary")
    assert element.get("source")


@pytest.mark.parametrize("path", [*CONFLICTS, *TEMPLATES], ids=lambda path: path.stem)
def test_parameters_are_documented_and_limited(path: Path) -> None:
    library = _library(path)
    for part in (*library.scenarios.values(), *library.templates.values()):
        for parameter in _parameters(part).values():
            assert parameter.summary.endswith("."), parameter.name
            if parameter.type not in ("text", "boolean"):
                found = limits(parameter)
                assert None not in (found.minimum, found.maximum), parameter.name


@pytest.mark.parametrize("name", sorted(GOLD))
def test_conflict_has_its_place_in_the_taxonomy(name: str) -> None:
    sink = Diagnostics()
    compiled = compile_target(LIBRARY / "conflicts" / f"{name}.xml", {}, sink)
    assert compiled is not None, [as_text(one) for one in sink]
    found = compiled.plan.classification
    assert found is not None
    assert (found.scheme, found.number, found.urgency, found.response) == ("gold2018", *GOLD[name])
    assert (found.predictability, found.criticality) == ("", "")


def _ends() -> list[tuple[Path, str, str]]:
    """Return every conflict with each of its parameters at either end of its range."""
    return [
        (path, parameter.name, format_value(float(end)))
        for path in CONFLICTS
        for part in _library(path).scenarios.values()
        for parameter in _parameters(part).values()
        for end in (limits(parameter).minimum, limits(parameter).maximum)
        if end is not None
    ]


@pytest.mark.parametrize(("path", "name", "value"), _ends(), ids=lambda part: getattr(part, "stem", part))
def test_conflict_compiles_at_the_ends_of_its_parameters(path: Path, name: str, value: str) -> None:
    sink = Diagnostics()
    compiled = compile_target(path, {name: value}, sink)
    assert [as_text(one) for one in sink] == []
    assert compiled is not None
    assert {one.name: one.default for one in compiled.plan.parameters}[name] == value


def test_every_template_is_used_by_a_conflict() -> None:
    used = {use.get("template") for path in CONFLICTS for use in _library(path).document.root.iter("use")}
    assert used == {path.stem for path in TEMPLATES}


def test_catalog_entries_are_plausible_and_name_their_source() -> None:
    catalogs = load_catalogs(LIBRARY / "catalogs", Diagnostics())
    assert {"vehicle.audi.tt", "vehicle.tesla.model3"} <= set(catalogs.vehicles)
    for vehicle in catalogs.vehicles.values():
        assert vehicle.source, vehicle.name
        assert vehicle.wheelbase <= vehicle.length, vehicle.name
        rear, front = vehicle.center - vehicle.length / 2, vehicle.center + vehicle.length / 2
        if vehicle.name.startswith("vehicle."):
            assert rear < 0 < vehicle.wheelbase < front, vehicle.name
    for driver in catalogs.drivers.values():
        assert driver.source, driver.name
    assert {"urgent", "unhurried", "unhurried_with_task", "mixed", "absent"} <= set(catalogs.drivers)
