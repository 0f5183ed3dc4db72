"""Scenarios with an attentive, a slow, an absent and a reference driver: who fails, and the page of results."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from scenario_compiler.resources import library_folder
from scenario_compiler.survey.separating import ATTENTIVE, DRIVERS, SLOW, Separated, given_up, separate
from scenario_compiler.survey.separation_page import separation_page
from scenario_compiler.survey.spreading import spread
from tests.command import call

CONFLICTS = library_folder() / "conflicts"
FAIL = {
    "markings_variants.xml#missing_stretch": ("absent",),
    "camera_failures.xml#freeze_in_curve": ("slow", "absent"),
    "r157_situations.xml#pedestrian": ("slow", "absent"),
    "obstacle_ahead.xml#obstacle_ahead": (),
}
"""Some conflicts and the drivers who fail in each."""


@pytest.fixture(scope="module")
def some() -> dict[str, Separated]:
    """Return these conflicts with the four drivers."""
    return {target: separate(f"{CONFLICTS / target}") for target in FAIL}


def test_the_expected_drivers_fail_and_the_reference_never_does(some: dict[str, Separated]) -> None:
    for target, failing in FAIL.items():
        drivers = some[target].drivers
        assert tuple(drivers) == tuple(DRIVERS)
        assert tuple(name for name, one in drivers.items() if one.result == "fail") == failing, target
        assert some[target].separates == bool(failing)


def test_each_driver_responds_at_the_stated_time(some: dict[str, Separated]) -> None:
    drivers = some["markings_variants.xml#missing_stretch"].drivers
    assert drivers["attentive"].takeover_time == pytest.approx(ATTENTIVE, abs=0.1)
    assert drivers["slow"].takeover_time == pytest.approx(SLOW, abs=0.1)
    assert drivers["absent"].takeover_time is None
    assert drivers["reference"].takeover_time == pytest.approx(0.0, abs=0.1001)
    assert len({one.request for one in drivers.values()}) == 1


def test_the_page_has_a_row_for_each_driver_and_names_what_was_broken(some: dict[str, Separated]) -> None:
    broken = Separated(target="x.xml#bad", name="bad", fault="there is no map 'nowhere'")
    page = separation_page([*some.values(), broken])
    rows = [line for line in page.splitlines() if re.match(r"\|.*\| (attentive|slow|absent|reference) \|", line)]
    assert len(rows) == 4 * len(some)
    assert page.count("**fail**: no_obstruction") == sum(map(len, FAIL.values()))
    assert "**3 of 4 scenarios fail for the slow or the absent driver, 0 for the attentive driver" in page
    assert "- `bad`: there is no map 'nowhere'" in page


def test_a_scenario_that_cannot_be_compiled_has_a_reason(tmp_path: Path) -> None:
    path = tmp_path / "bad.xml"
    path.write_text('<scenarios version="1"><scenario name="bad" map="nowhere"/></scenarios>', encoding="utf-8")
    found = separate(f"{path}#bad")
    assert found.fault
    assert not found.drivers


def killed_by(target: str) -> Separated:
    """End the process, as the system does with one that takes too much memory; for other scenarios, give up at once."""
    if target.endswith("#large"):
        os._exit(9)
    return given_up(target, "it is not run in this test")


@pytest.mark.slow
def test_a_process_that_dies_is_the_fault_of_its_own_scenario() -> None:
    targets = ["some.xml#small", "some.xml#large", "some.xml#other"]
    found = list(spread(targets, killed_by, given_up, 2))
    assert [one.name for one in found] == ["small", "large", "other"]
    assert ["ended by the system" in one.fault for one in found] == [False, True, False]


def test_the_command_writes_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "page.md"
    assert call("library", CONFLICTS / "markings_missing.xml", "--separation", page, "--workers", 1) == 0
    assert "1 of 1 fail for the slow or the absent driver" in capsys.readouterr().out
    assert "| `markings_missing` | attentive |" in page.read_text(encoding="utf-8")


@pytest.mark.slow
def test_with_the_camera_the_same_drivers_fail() -> None:
    """The camera asks a little later: it follows paint that ideal perception finds too worn already."""
    target = f"{CONFLICTS / 'markings_missing.xml'}#markings_missing"
    seen, ideal = (separate(target, perception=perception) for perception in ("camera", "ideal"))
    for name in DRIVERS:
        assert seen.drivers[name].result == ideal.drivers[name].result
    assert abs((seen.drivers["absent"].request or 0.0) - (ideal.drivers["absent"].request or 0.0)) < 4.0
    page = separation_page([seen], "camera")
    assert "with the camera and the seed" in page


def test_the_library_separates_drivers(repository: Path) -> None:
    """The page that `make library-table` wrote has every conflict, and says what the library promises."""
    page = (repository / "docs" / "separation.md").read_text(encoding="utf-8")
    found = re.search(r"\*\*(\d+) of (\d+) scenarios fail .* 0 for the reference driver", page.replace(" and ", " "))
    assert found is not None
    failing, count = (int(number) for number in found.groups())
    names = re.findall(
        r"<scenario name=\"(\w+)\"", "".join(path.read_text(encoding="utf-8") for path in CONFLICTS.glob("*.xml"))
    )
    assert count == len(names)
    assert all(f"#{name}`" in page or f"| `{name}`" in page for name in names)
    assert 3 * failing >= count
    silent = page.partition("Without a takeover request:")[2].partition("## ")[0].strip().splitlines()
    assert silent
    assert all("without asking" in line for line in silent)


@pytest.mark.slow
def test_the_page_of_the_library_is_fresh(repository: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    assert call("library", CONFLICTS, "--separation", page) == 0
    assert page.read_text(encoding="utf-8") == (repository / "docs" / "separation.md").read_text(encoding="utf-8")
