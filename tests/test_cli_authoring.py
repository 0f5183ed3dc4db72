"""The commands for authors and for sweeps, as a user sees them."""

from __future__ import annotations

import html
import re
import shlex
from pathlib import Path

import pytest

from tests.command import call
from tests.test_cli import CONFLICT

LIBRARY = Path(__file__).parent.parent / "library"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Work in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_library_is_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("list") == 0
    out = capsys.readouterr().out
    assert "markings_missing" in out
    assert "blocked_lane" in out


def test_a_file_is_listed_as_a_gallery_with_a_picture_each() -> None:
    assert call("list", LIBRARY / "conflicts" / "obstacle_ahead.xml", "--html", "gallery.html") == 0
    page = Path("gallery.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 1
    assert "obstacle_ahead" in page


def test_the_command_in_a_gallery_can_be_pasted_into_a_shell_whatever_the_files_name() -> None:
    Path("my conflict #2.xml").write_text(CONFLICT, encoding="utf-8")
    assert call("list", ".", "--html", "gallery.html") == 0
    (command,) = re.findall(
        "<code>(scenario-compiler run .*?)</code>", Path("gallery.html").read_text(encoding="utf-8")
    )
    target = shlex.split(html.unescape(command))[2]
    assert call("run", target, "--perception", "ideal", "--duration", "0.2") == 0


def test_what_a_file_of_openscenario_varies_is_listed(corpus: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("list", corpus / "esmini/resources/xosc/cut-in_parameter_set.xosc") == 0
    out = capsys.readouterr().out
    assert "varies cut-in.xosc" in out
    assert "grid(1.1, 1.5, 3)" in out
    assert "template" not in out


def test_a_folder_without_scenarios_is_reported(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("list", folder) == 0
    assert "no conflict and no template in" in capsys.readouterr().err


def test_a_folder_that_is_not_there_is_wrong_use() -> None:
    assert call("list", "nowhere") == 2


def test_a_new_conflict_is_valid_and_runs() -> None:
    assert call("new", "mine", "--from", "blocked_lane") == 0
    assert call("validate", "mine.xml") == 0
    assert call("run", "mine.xml", "--perception", "ideal", "--duration", "1") == 0


@pytest.mark.parametrize(
    ("name", "template", "said"),
    [("mine", "blocked_lan", "did you mean 'blocked_lane'"), ("my case", "blocked_lane", "is not a name")],
)
def test_invalid_names_and_templates_of_a_new_conflict_are_reported(
    capsys: pytest.CaptureFixture[str], name: str, template: str, said: str
) -> None:
    assert call("new", name, "--from", template) == 2
    assert said in capsys.readouterr().err
    assert list(Path().iterdir()) == []


def test_an_empty_name_is_not_suggested(capsys: pytest.CaptureFixture[str]) -> None:
    Path("it.xml").write_text(
        '<scenarios version="1"><scenario name="" map="a"/><scenario name="b" map="a"/></scenarios>', encoding="utf-8"
    )
    assert call("run", "it.xml") == 2
    assert capsys.readouterr().err.rstrip().endswith("name one as FILE#name: b")


def test_brackets_are_printed_only_with_a_hint(capsys: pytest.CaptureFixture[str]) -> None:
    assert call("explain", "FOO") == 2
    assert capsys.readouterr().err == "scenario-compiler: there is no code 'FOO'\n"


def test_a_new_conflict_does_not_overwrite() -> None:
    Path("mine.xml").write_text("keep me", encoding="utf-8")
    assert call("new", "mine", "--from", "blocked_lane") == 2
    assert Path("mine.xml").read_text(encoding="utf-8") == "keep me"


@pytest.mark.parametrize(("file", "head"), [("plan.png", b"\x89PNG"), ("plan.svg", b"<?xml")])
def test_a_plan_is_drawn(file: str, head: bytes) -> None:
    assert call("preview", LIBRARY / "conflicts" / "obstacle_ahead.xml", "-o", file) == 0
    assert Path(file).read_bytes().startswith(head)


def test_a_plan_is_drawn_as_a_picture_only() -> None:
    assert call("preview", LIBRARY / "conflicts" / "obstacle_ahead.xml", "-o", "plan.txt") == 2


def test_a_run_shows_its_route() -> None:
    target = LIBRARY / "conflicts" / "obstacle_ahead.xml"
    ideal = ("--perception", "ideal", "--duration", "1")
    assert call("run", target, *ideal, "--show", "route") == 2
    assert call("run", target, *ideal, "--show", "route", "-o", "out") == 0
    assert Path("out/route.png").read_bytes().startswith(b"\x89PNG")


def test_a_file_of_the_toolkit_is_converted(corpus: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = corpus / "aisa-toolkit/simulation/scenarios/aisa_conflicts.xml"
    assert call("convert", file, "-o", "aisa.xml") == 0
    towns = corpus / "Scenic/assets/maps/CARLA"
    monkeypatch.setenv("SCENARIO_COMPILER_MAPS", f"{towns}:{corpus / 'opendrive-test-files/OpenDrive'}")
    assert call("run", "aisa.xml#sensornoise", "--perception", "ideal", "--duration", "1") == 0
    assert call("convert", LIBRARY / "conflicts" / "obstacle_ahead.xml", "-o", "no.xml") == 2


@pytest.mark.slow
def test_a_sweep_leaves_a_table_and_a_report(capsys: pytest.CaptureFixture[str]) -> None:
    target = LIBRARY / "conflicts" / "obstacle_ahead.xml"
    command = ("sweep", target, "--perception", "ideal", "--duration", "6", "--vary", "distance=uniform(60,120)")
    assert call(*command, "--samples", "4", "-o", "sweep") == 0
    assert "0 failed, 0 broken off" in capsys.readouterr().out
    assert {"results.parquet", "report.html"} <= {path.name for path in Path("sweep").iterdir()}


ENDLESS = """<scenarios version="1">{}
<scenario name="it" map="town_grid">
  <parameter name="speed" type="speed" default="10"/>
  <ego speed="$speed"><start><spawn_point name="main_street"/></start></ego>
  <criteria><no_collision/></criteria>
</scenario></scenarios>"""
"""A scenario without a duration, of which SC601 warns."""

SWEEP = ("sweep", "it.xml", "--perception", "ideal", "--vary", "speed=uniform(9,11)", "--samples", "2", "--no-report")


@pytest.mark.parametrize(
    ("allowed", "options", "code", "said"),
    [
        ("", [], 0, "warning[SC601]"),
        ("", ["--allow", "SC601"], 0, ""),
        ("", ["--error", "SC601"], 1, "error[SC601]"),
        ("", ["--error", "all"], 1, "error[SC601]"),
        ("", ["--error", "all", "--allow", "SC601"], 0, ""),
        ('<allow code="SC601"/>', ["--error", "SC601"], 1, "error[SC601]"),
    ],
)
def test_a_sweep_gives_findings_the_chosen_severities(
    capsys: pytest.CaptureFixture[str], allowed: str, options: list[str], code: int, said: str
) -> None:
    Path("it.xml").write_text(ENDLESS.format(allowed), encoding="utf-8")
    assert call(*SWEEP, "-o", "sweep", *options) == code
    err = capsys.readouterr().err
    assert said in err
    assert ("SC601" in err) == bool(said)
    assert Path("sweep/results.parquet").exists() == (code == 0)


@pytest.mark.parametrize(
    "arguments", [["--vary", "distance"], ["--vary", "nothing=uniform(1,2)"], ["--vary", "distance=uniform(2)"]]
)
def test_a_sweep_that_cannot_be_is_wrong_use_or_at_fault(arguments: list[str]) -> None:
    target = LIBRARY / "conflicts" / "obstacle_ahead.xml"
    assert call("sweep", target, "--perception", "ideal", *arguments, "-o", "sweep") in (1, 2)


def test_a_boundary_and_a_minimum_are_searched_for(capsys: pytest.CaptureFixture[str]) -> None:
    command = ("sweep", LIBRARY / "conflicts" / "obstacle_ahead.xml", "--perception", "ideal", "--duration", "8")
    vary = ("--vary", "distance=uniform(60,350)")
    assert call(*command, *vary, "--boundary", "request", "--tolerance", "40", "-o", "boundary") == 0
    assert "request does not hold at distance = " in capsys.readouterr().out
    assert call(*command, *vary, "--minimise", "final_speed", "--evaluations", "5", "-o", "least") == 0
    assert "least final_speed" in capsys.readouterr().out
