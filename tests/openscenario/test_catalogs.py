"""Catalogs: found as real files name them, entries with their parameters."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.vocabulary.actions import SpeedAction
from tests.openscenario.made import CAR, declarations, entity, event, expanded, scenario_text, speed, story

HEADER = '<FileHeader revMajor="1" revMinor="3" date="2026-01-01T00:00:00" description="" author=""/>'
VEHICLES = "<VehicleCatalog><Directory path='{}'/></VehicleCatalog>"


def _write(folder: Path, file: str, inside: str, name: str = "Things") -> None:
    folder.mkdir(parents=True, exist_ok=True)
    text = f'<OpenSCENARIO>{HEADER}<Catalog name="{name}">{inside}</Catalog></OpenSCENARIO>'
    (folder / file).write_text(text, encoding="utf-8")


def _reference(entry: str, catalog: str = "Things", *assignments: str) -> str:
    given = "".join(
        f'<ParameterAssignment parameterRef="{one.split("=")[0]}" value="{one.split("=")[1]}"/>' for one in assignments
    )
    inside = f"<ParameterAssignments>{given}</ParameterAssignments>" if given else ""
    return f'<CatalogReference catalogName="{catalog}" entryName="{entry}">{inside}</CatalogReference>'


@pytest.mark.parametrize("path", ["cars", "./cars", "else/where/cars", "cars\\"])
def test_folders_are_found_whole_or_by_their_bare_name(tmp_path: Path, path: str) -> None:
    _write(tmp_path / "cars", "any.xosc", CAR)
    text = scenario_text(entities=entity(inside=_reference("car")), catalogs=VEHICLES.format(path))
    scenario, codes = expanded(text, tmp_path / "made.xosc")
    assert codes == []
    assert scenario.vehicles[0].length == 4.5


def test_a_catalog_is_also_found_by_its_files_name(tmp_path: Path) -> None:
    _write(tmp_path, "Cars.xosc", CAR, "Things")
    _write(tmp_path, "Vans.xosc", CAR.replace("4.5", "5.5"), "Cars")
    text = scenario_text(entities=entity(inside=_reference("car", "Cars")), catalogs=VEHICLES.format("."))
    assert expanded(text, tmp_path / "made.xosc")[0].vehicles[0].length == 4.5


def test_a_catalogs_suffix_may_have_capitals(tmp_path: Path) -> None:
    _write(tmp_path, "Cars.XOSC", CAR)
    text = scenario_text(entities=entity(inside=_reference("car", "Cars")), catalogs=VEHICLES.format("."))
    assert expanded(text, tmp_path / "made.xosc")[1] == []


@pytest.mark.parametrize(("catalog", "entry"), [("Thing", "car"), ("Things", "kar"), ("", "")])
def test_missing_entries_are_reported(tmp_path: Path, catalog: str, entry: str) -> None:
    _write(tmp_path, "a.xosc", CAR)
    text = scenario_text(entities=entity(inside=_reference(entry, catalog)), catalogs=VEHICLES.format("."))
    assert "SC744" in expanded(text, tmp_path / "made.xosc")[1]


def test_missing_folders_are_reported_even_if_nothing_refers_to_them() -> None:
    assert expanded(scenario_text(catalogs=VEHICLES.format("nowhere")))[1] == ["SC745"]


def test_entries_have_parameters_with_defaults_and_assigned_values(tmp_path: Path) -> None:
    inner = declarations("long:double=4", "wide:double=${$long / 2}")
    sized = CAR.replace("<BoundingBox>", inner + "<BoundingBox>").replace(
        'length="4.5" width="1.8"', 'length="$long" width="$wide"'
    )
    _write(tmp_path, "a.xosc", sized)
    two = entity(inside=_reference("car")) + entity("b", _reference("car", "Things", "long=${$size + 1}"))
    text = scenario_text(entities=two, catalogs=VEHICLES.format("."), declared=declarations("size:double=5"))
    scenario, codes = expanded(text, tmp_path / "made.xosc")
    assert codes == []
    assert [(one.length, one.width) for one in scenario.vehicles] == [(4.0, 2.0), (6.0, 3.0)]


def test_a_value_for_a_parameter_that_the_entry_lacks_is_reported(tmp_path: Path) -> None:
    sized = CAR.replace("<BoundingBox>", declarations("long:double=4") + "<BoundingBox>")
    sized = sized.replace('length="4.5" width="1.8"', 'length="$long" width="$undeclared"')
    _write(tmp_path, "a.xosc", sized)
    reference = _reference("car", "Things", "lang=6", "undeclared=2")
    text = scenario_text(entities=entity(inside=reference), catalogs=VEHICLES.format("."))
    scenario, codes = expanded(text, tmp_path / "made.xosc")
    assert codes == ["SC211"]
    assert (scenario.vehicles[0].length, scenario.vehicles[0].width) == (4.0, 2.0)


def test_a_maneuver_comes_from_a_catalog(tmp_path: Path) -> None:
    inside = declarations("to:double=1", "who:string=nobody") + event(action=speed("$to"))
    _write(tmp_path, "a.xosc", f'<Maneuver name="slow">{inside}</Maneuver>')
    catalogs = "<ManeuverCatalog><Directory path='.'/></ManeuverCatalog>"
    text = scenario_text(story(maneuver=_reference("slow", "Things", "to=7")), catalogs=catalogs)
    scenario, codes = expanded(text, tmp_path / "made.xosc")
    assert codes == []
    maneuver = scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0]
    action = maneuver.events[0].actions[0].action
    assert isinstance(action, SpeedAction)
    assert (maneuver.name, action.to) == ("slow", 7.0)


def test_an_entry_of_another_kind_is_reported(tmp_path: Path) -> None:
    _write(tmp_path, "a.xosc", f'<Maneuver name="slow">{event()}</Maneuver>')
    text = scenario_text(entities=entity(inside=_reference("slow")), catalogs=VEHICLES.format("."))
    assert expanded(text, tmp_path / "made.xosc")[1] == ["SC744"]


def test_unread_parts_of_an_entry_are_reported(tmp_path: Path) -> None:
    _write(tmp_path, "a.xosc", CAR.replace("<Axles>", "<Wings/><Axles>"))
    text = scenario_text(entities=entity(inside=_reference("car")), catalogs=VEHICLES.format("."))
    assert expanded(text, tmp_path / "made.xosc")[1] == ["SC750"]
