"""A group's own templates: from given folders and from installed packages, by name and in order."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from scenario_compiler import compile_scenario
from scenario_compiler.diagnostics import CompileError
from scenario_compiler.resources import templates_from
from scenario_compiler.validation import validate_files
from tests.command import call
from tests.pages import code_blocks

PAGE = Path(__file__).resolve().parents[2] / "docs" / "sharing-templates.md"


def template(name: str, model: str = "vehicle.audi.tt") -> str:
    """Return a file with a template that puts one thing on the road."""
    place = '<at><ahead_of entity="ego" distance="60"/></at>'
    return f'''<scenarios version="1"><template name="{name}" summary="Ours"><static id="thing" model="{model}">{place}
      </static></template></scenarios>'''


def conflict(name: str) -> str:
    """Return a file with a scenario that uses a template."""
    return f'''<scenarios version="1"><scenario name="s" map="town_grid" duration="30">
      <ego speed="5"><start><spawn_point name="main_street"/></start></ego><use template="{name}"/>
      <takeover><cause kind="path_blocked"/></takeover></scenario></scenarios>'''


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a conflict that uses a template of a folder beside it."""
    (tmp_path / "ours" / "deeper").mkdir(parents=True)
    (tmp_path / "ours" / "deeper" / "ours.xml").write_text(template("ours"), encoding="utf-8")
    (tmp_path / "conflict.xml").write_text(conflict("ours"), encoding="utf-8")
    return tmp_path


def test_a_template_of_a_folder_is_used_by_name(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = folder / "conflict.xml"
    assert call("validate", file) == 1
    assert "SC213" in capsys.readouterr().err
    assert call("validate", file, "--templates", folder / "ours") == 0
    assert call("compile", file, "--templates", folder / "ours", "-o", folder / "plan.json") == 0
    assert call("validate", file) == 1


def test_python_takes_folders_of_templates(folder: Path) -> None:
    plan = compile_scenario(folder / "conflict.xml", templates=[folder / "ours"])
    assert [one.id for one in plan.entities] == ["ego", "ours1.thing"]
    with pytest.raises(CompileError):
        compile_scenario(folder / "conflict.xml")
    with pytest.raises(TypeError):
        compile_scenario(folder / "conflict.xml", templates="ours")


def test_files_that_are_checked_by_other_processes_see_the_folders(folder: Path) -> None:
    files = [folder / f"{number}.xml" for number in range(40)]
    for file in files:
        file.write_text(conflict("ours"), encoding="utf-8")
    with templates_from([folder / "ours"]):
        assert [one for found in validate_files(files, processes=2) for one in found] == []


def test_a_folder_that_is_named_goes_before_the_library(folder: Path) -> None:
    (folder / "ours" / "blocked_lane.xml").write_text(template("blocked_lane"), encoding="utf-8")
    (folder / "conflict.xml").write_text(conflict("blocked_lane"), encoding="utf-8")
    named = compile_scenario(folder / "conflict.xml", templates=[folder / "ours"])
    assert [one.id for one in named.entities] == ["ego", "blocked_lane1.thing"]
    assert [one.id for one in compile_scenario(folder / "conflict.xml").entities] == ["ego", "blocked_lane1.blocker"]


def test_vehicles_beside_a_template_come_with_it(folder: Path) -> None:
    (folder / "ours" / "vehicles.xml").write_text(
        '<catalog version="1"><vehicle name="vehicle.ours" length="3" width="2" height="2" wheelbase="2" center="1"/>'
        "</catalog>",
        encoding="utf-8",
    )
    (folder / "ours" / "deeper" / "ours.xml").write_text(template("ours", "vehicle.ours"), encoding="utf-8")
    plan = compile_scenario(folder / "conflict.xml", templates=[folder / "ours"])
    assert plan.entities[1].vehicle.length == 3.0


def test_a_fault_in_a_folder_is_reported_with_its_file(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "ours" / "broken.xml").write_text("<scenarios", encoding="utf-8")
    assert call("validate", folder / "conflict.xml", "--templates", folder / "ours") == 1
    assert "broken.xml" in capsys.readouterr().err


def installed(folder: Path, name: str) -> None:
    """Write an installed package that brings a template and ends whoever imports it."""
    package = folder / name
    (package / "templates").mkdir(parents=True)
    (package / "__init__.py").write_text("raise SystemExit(3)", encoding="utf-8")
    (package / "templates" / "one.xml").write_text(template(name), encoding="utf-8")
    (package / "templates" / "two.xml").write_text(template("blocked_lane"), encoding="utf-8")
    described = folder / f"{name}-1.0.dist-info"
    described.mkdir()
    (described / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n", encoding="utf-8")
    entry = f"[scenario_compiler_templates]\n{name} = {name}.templates\nnowhere = no_such_package.templates\n"
    (described / "entry_points.txt").write_text(entry, encoding="utf-8")


def test_an_installed_package_brings_templates_and_is_not_imported(tmp_path: Path) -> None:
    installed(tmp_path / "site", "their_group")
    (tmp_path / "conflict.xml").write_text(conflict("their_group"), encoding="utf-8")
    (tmp_path / "other.xml").write_text(conflict("blocked_lane"), encoding="utf-8")

    def run(*arguments: str) -> str:
        command = [sys.executable, "-m", "scenario_compiler", *arguments]
        environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path, check=False)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "1 file checked, 0 errors" in run("validate", "conflict.xml")
    assert "their_group" in run("list", "--templates")
    run("compile", "other.xml", "-o", "plan.json")
    assert "blocked_lane1.blocker" in (tmp_path / "plan.json").read_text(encoding="utf-8")


def test_templates_are_listed_with_units_and_limits(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "200")
    assert call("list", "--templates", folder / "ours") == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "ours" in told
    assert "blocked_lane" in told
    assert "fraction, from 0.3 to 1" in told
    assert call("list", folder / "ours", "--templates") == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "blocked_lane" not in told


def test_the_page_is_true(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    text = PAGE.read_text(encoding="utf-8")
    (file,) = re.findall(r"```xml\n<!-- (\S+) -->\n(.*?)```", text, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    Path(file[0]).parent.mkdir()
    Path(file[0]).write_text(file[1], encoding="utf-8")
    Path("conflict.xml").write_text(conflict("parked_row"), encoding="utf-8")
    (commands,) = code_blocks(text, "sh")
    for line in commands.splitlines():
        assert call(*shlex.split(line)[1:]) == 0
    assert "parked_row" in capsys.readouterr().out
    assert [one.id for one in compile_scenario("conflict.xml", templates=["templates"]).entities][-1].endswith("cars.3")


def test_two_templates_of_a_folder_with_one_name_are_reported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "ours" / "again.xml").write_text(template("ours"), encoding="utf-8")
    assert call("validate", folder / "conflict.xml", "--templates", folder / "ours") == 1
    assert "a template named 'ours' is already in" in capsys.readouterr().err


def test_a_folder_that_is_not_there_is_wrong_use(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("validate", folder / "conflict.xml", "--templates", folder / "nowhere") == 2
    assert "there is no folder" in capsys.readouterr().err


def test_a_package_whose_entry_point_is_not_a_folder_is_skipped(tmp_path: Path) -> None:
    installed(tmp_path / "site", "their_group")
    described = tmp_path / "site" / "their_group-1.0.dist-info" / "entry_points.txt"
    described.write_text("[scenario_compiler_templates]\na = ../..\nb = their_group:name\nc = sys\n", encoding="utf-8")
    (tmp_path / "conflict.xml").write_text(conflict("their_group"), encoding="utf-8")
    command = [sys.executable, "-m", "scenario_compiler", "validate", "conflict.xml"]
    environment = {**os.environ, "PYTHONPATH": str(tmp_path / "site")}
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=tmp_path, check=False)
    assert done.returncode == 1
    assert "SC213" in done.stderr
