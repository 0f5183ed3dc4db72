"""Catalogs: entries by name, their faults, and missing values."""

from __future__ import annotations

from pathlib import Path

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.languages import expand
from scenario_compiler.source.catalogs import Catalogs, load_catalogs
from scenario_compiler.vocabulary.driver import DriverModel
from tests.source.made import EGO, codes_of, expanded, library_text, parsed

CAR = '<vehicle name="our.car" length="4" width="2" height="1.5" wheelbase="2.5" center="1.2"/>'
DRIVER = '<driver_model name="ours" mu="1" sigma="0.3"/>'


def _catalog(entries: str) -> str:
    return f'<catalog version="1">{entries}</catalog>'


def _codes(entries: str) -> list[str]:
    sink = Diagnostics()
    parsed(_catalog(entries), sink)
    return [one.code.id for one in sink]


def test_entries_of_a_folder_come_by_name(tmp_path: Path) -> None:
    (tmp_path / "cars.xml").write_text(_catalog(CAR), encoding="utf-8")
    (tmp_path / "people.xml").write_text(_catalog(DRIVER), encoding="utf-8")
    (tmp_path / "notes.txt").write_text("no catalog", encoding="utf-8")
    catalogs = load_catalogs(tmp_path, Diagnostics())
    assert (list(catalogs.vehicles), list(catalogs.drivers), catalogs.complete) == (["our.car"], ["ours"], True)


def test_a_catalogs_faults_are_reported_each_time(tmp_path: Path) -> None:
    (tmp_path / "cars.xml").write_text(_catalog(CAR.replace('"4"', '"-4"')), encoding="utf-8")
    for _ in range(2):
        sink = Diagnostics()
        assert load_catalogs(tmp_path, sink).vehicles == {}
        assert [one.code.id for one in sink] == ["SC112"]


def test_repeated_entries_are_reported() -> None:
    assert _codes(CAR + CAR) == ["SC216"]
    assert _codes(DRIVER + DRIVER) == ["SC216"]
    assert _codes(CAR + DRIVER.replace("ours", "our.car")) == []


def test_later_catalogs_win() -> None:
    first, second = parsed(_catalog(CAR), Diagnostics()), parsed(_catalog(CAR.replace('"4"', '"5"')), Diagnostics())
    both = first.catalogs.extended(second.catalogs)  # type: ignore[union-attr]
    assert both.vehicles["our.car"].length == 5.0
    assert both.extended(Catalogs().with_a_gap()).complete is False


def test_a_faulty_entry_is_not_reported_as_missing(tmp_path: Path) -> None:
    (tmp_path / "fleet.xml").write_text(_catalog(CAR.replace('"4"', '"four"')), encoding="utf-8")
    text = library_text(head='<include file="fleet.xml"/>', ego=EGO.replace("<ego", '<ego model="our.car"'))
    assert codes_of(text, tmp_path / "made.xml") == ["SC111"]


def _driver_of(tmp_path: Path, word: str, entry: str) -> DriverModel:
    (tmp_path / "people.xml").write_text(_catalog(entry), encoding="utf-8")
    text = library_text(head='<include file="people.xml"/>', items=f"<takeover>{word}</takeover>")
    driver = expanded(text, tmp_path / "made.xml").takeover.driver
    assert isinstance(driver, DriverModel)
    return driver


def test_a_takeover_time_of_the_catalog_counts_until_the_scenario_gives_one(tmp_path: Path) -> None:
    entry = '<driver_model name="quick" takeover_time="0.75" source="ours"/>'
    assert _driver_of(tmp_path, '<driver preset="quick"/>', entry).takeover_time == 0.75
    assert _driver_of(tmp_path, '<driver preset="quick" takeover_time="2"/>', entry).takeover_time == 2.0


def _hints(items: str) -> list[str]:
    sink = Diagnostics()
    expand(parsed(library_text(items), sink), None, {}, sink)
    return [one.hint for one in sink]


def test_old_names_are_refused_with_the_new_ones() -> None:
    assert _hints('<takeover><driver preset="urgent"/></takeover>') == ["it is called 'study_means' now"]
    assert _hints('<takeover><message modality="text audio"/></takeover>') == ["write tone or speech"]
    for listed in ("text,tone", "text, tone"):
        hints = _hints(f'<takeover><message modality="{listed}"/></takeover>')
        assert hints == ["separate the values by spaces, without commas"]


def test_kinds_of_parameters_of_other_languages_are_refused_with_ours() -> None:
    """A similar word is none of the same meaning: 'duration' got the hint 'fraction'."""
    for kind, ours in (("duration", "time"), ("double", "number"), ("string", "text")):
        assert f"write {ours}" in _hints(f'<parameter name="p" type="{kind}" default="3"/>')


def test_vehicles_of_a_category_are_named_where_a_model_is_its_name() -> None:
    hints = {}
    for model in ("truck", "car", "tesla"):
        sink = Diagnostics()
        text = library_text(ego=EGO.replace("<ego", f'<ego model="{model}"'))
        expand(parsed(text, sink), None, {}, sink)
        hints[model] = next(one.hint for one in sink if one.code.id == "SC217")
    assert hints["truck"].startswith("vehicles of the category 'truck': vehicle.carlamotors.carlacola, ")
    assert hints["car"].endswith(", ...")
    assert hints["tesla"] == "known with 'tesla' in it: vehicle.tesla.cybertruck, vehicle.tesla.model3"
