"""The survey of a library: situations, near-duplicates, scenarios without requests or failures, and gaps."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.resources import library_folder
from scenario_compiler.survey.examining import Examined, examine, examine_all, given_up
from scenario_compiler.survey.page import page_of
from scenario_compiler.survey.spreading import spread
from scenario_compiler.survey.survey import Survey, survey
from tests.command import call

HEAD = '<scenarios version="1">'
TEMPLATES = """
  <template name="used"><static id="a"><at><ahead_of entity="ego" distance="120"/></at></static></template>
  <template name="inside"><use template="inmost"/></template>
  <template name="inmost">
    <static id="b" model="vehicle.seat.leon"><at><ahead_of entity="ego" distance="150"/></at></static>
  </template>
  <template name="unused"><static id="c"><at><ahead_of entity="ego" distance="90"/></at></static></template>"""


def scenario(
    name: str, body: str, *, classified: str = "", criteria: str = "<no_collision/>", speed: float = 12
) -> str:
    """Return a scenario in which the car asks where its path is blocked."""
    judged = f"<criteria>{criteria}</criteria>" if criteria else ""
    return f"""
  <scenario name="{name}" map="town_grid" duration="20">{classified}
    <ego speed="{speed}"><start><spawn_point name="main_street"/></start></ego>{body}
    <takeover budget="7"><cause kind="path_blocked"/><driver preset="study_means"/></takeover>{judged}
  </scenario>"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with a small library."""
    one = '<classification scheme="r157" situation="4.2_1"/><classification scheme="ours" situation="first"/>'
    (tmp_path / "library").mkdir()
    (tmp_path / "library" / "good.xml").write_text(
        HEAD
        + TEMPLATES
        + scenario("blocked", '<use template="used"/>', classified=one)
        + scenario("blocked_faster", '<use template="used"/>', speed=13)
        + scenario("nested", '<use template="inside"/>')
        + scenario("nothing_there", "")
        + scenario("not_judged", '<static id="d"><at><lane road="1" lane="1" s="300"/></at></static>', criteria="")
        + "</scenarios>",
        encoding="utf-8",
    )
    (tmp_path / "library" / "bad.xml").write_text(
        f"{HEAD}{scenario('bad', '<use template=chr34nowherechr34/>'.replace('chr34', chr(34)))}</scenarios>",
        encoding="utf-8",
    )
    return tmp_path / "library"


def named(targets: tuple[str, ...]) -> list[str]:
    """Return the scenarios' names alone."""
    return [target.rpartition("#")[2] for target in targets]


def test_a_library_is_surveyed(folder: Path) -> None:
    found = survey(folder, Diagnostics(), runs=2)
    assert [one.name for one in found.scenarios if one.fault] == ["bad"]
    assert "SC213" in next(one.fault for one in found.scenarios if one.fault)
    r157 = next(one for one in found.taxonomies if one.scheme == "r157")
    assert {one.place: named(one.scenarios) for one in r157.situations if one.scenarios} == {"4.2_1": ["blocked"]}
    ours = next(one for one in found.taxonomies if one.scheme == "ours")
    assert (ours.title, [one.place for one in ours.situations], ours.whole) == ("ours", ["first"], False)
    assert named(found.broken) == ["bad"]
    assert set(named(found.never_ask)) == {"nothing_there", "not_judged"}
    assert set(named(found.never_fail)) == {"blocked", "blocked_faster", "nested", "nothing_there", "not_judged"}
    assert found.templates["unused"] == ()
    assert all(found.templates[name] for name in ("used", "inside", "inmost"))
    (alike,) = found.alike
    assert named(alike.scenarios) == ["blocked", "blocked_faster"]
    assert {tuple(sorted(values.values())) for values in alike.differ.values()} == {(12.0, 13.0)}


def test_gaps_are_described_in_sentences(folder: Path) -> None:
    said = survey(folder, Diagnostics()).missing
    assert all(re.fullmatch(r"[A-Z0-9].*\.", sentence) for sentence in said)
    together = " ".join(said)
    assert "No scenario names a situation of Gold et al. 2018." in together
    assert "4.1_1 (Lane keeping: free driving)" in together
    assert "4.2_1" not in together
    assert "No scenario has these conditions (weather): rain, snow" in together
    assert "unused" in next(sentence for sentence in said if "templates" in sentence)


def test_without_runs_the_page_says_nothing_about_runs(folder: Path) -> None:
    found = survey(folder, Diagnostics())
    assert (found.never_ask, found.never_fail) == ((), ())
    assert all(one.runs == () for one in found.scenarios)
    assert "Never ask" not in page_of(found)


def test_many_processes_have_the_findings_of_one(folder: Path) -> None:
    done: list[tuple[int, int]] = []
    alone = survey(folder, Diagnostics(), runs=1)
    many = survey(folder, Diagnostics(), runs=1, processes=2, progress=lambda *now: done.append(now))
    assert many == alone
    assert done == [(number, 6) for number in range(1, 7)]


def killed_by(target: str) -> Examined:
    """End the process that examines one scenario, as the system does with one that takes too much memory."""
    if target.endswith("#nested"):
        os._exit(9)
    return examine(target)


@pytest.mark.slow
def test_a_process_that_dies_costs_only_its_own_scenario(folder: Path) -> None:
    targets = [f"{folder / 'good.xml'}#{name}" for name in ("blocked", "nested", "blocked_faster", "nothing_there")]
    found = list(spread(targets, killed_by, given_up, 2))
    assert [bool(one.fault) for one in found] == [False, True, False, False]
    assert "ended by the system" in found[1].fault


def takes_long(target: str) -> Examined:
    """Examine a scenario for ten minutes."""
    sys.stdout.write("begun\n")
    sys.stdout.flush()
    time.sleep(600.0)
    return examine(target)


def test_ctrl_c_ends_all_processes_at_once(repository: Path) -> None:
    """The signal goes to the whole group, as a terminal sends it; the scenarios that wait are not begun."""
    program = f"from {__name__} import given_up, spread, takes_long; list(spread(['one'] * 8, takes_long, given_up, 2))"
    with subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=repository,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None
        assert [process.stdout.readline() for _ in range(2)] == ["begun\n"] * 2
        os.killpg(process.pid, signal.SIGINT)
        _, told = process.communicate(timeout=120)
    assert told.splitlines()[-1] == "KeyboardInterrupt"
    assert "SpawnProcess" not in told


def test_scenarios_with_other_content_are_not_near_duplicates(folder: Path) -> None:
    examined = list(examine_all([f"{folder / 'good.xml'}#{name}" for name in ("blocked", "nested", "nothing_there")]))
    assert len({one.likeness for one in examined}) == 3


def test_the_command_writes_page_data_and_tags(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = folder.parent / "out"
    assert call("library", folder, "-o", out, "--workers", "1") == 1
    told = capsys.readouterr().out
    assert "at fault" in told
    assert f"page: {out / 'library.html'}" in told
    assert Survey.model_validate_json((out / "library.json").read_text(encoding="utf-8")).folder == str(folder)
    tags = sorted(one.name for one in (out / "openlabel").iterdir())
    assert tags == [
        f"good_{name}.json" for name in ("blocked", "blocked_faster", "nested", "not_judged", "nothing_there")
    ]
    tagged = json.loads((out / "openlabel" / "good_blocked.json").read_text(encoding="utf-8"))
    assert tagged["openlabel"]["metadata"]["tagged_file"] == str(folder / "good.xml")
    assert call("library", folder, "-o", out) == 2
    (folder / "bad.xml").unlink()
    assert call("library", folder, "-o", out, "--force", "--workers", "1") == 0
    assert call("library", folder / "nowhere") == 2
    (folder / "empty").mkdir()
    capsys.readouterr()
    assert call("library", folder / "empty", "-o", out, "--force") == 2
    assert "there is no scenario in" in capsys.readouterr().err


def test_text_of_a_library_is_only_text_in_the_page(folder: Path) -> None:
    text = (folder / "good.xml").read_text(encoding="utf-8")
    evil = text.replace('name="nothing_there"', 'name="n" summary="&lt;script&gt;alert(1)&lt;/script&gt;"')
    (folder / "good.xml").write_text(evil, encoding="utf-8")
    page = page_of(survey(folder, Diagnostics()))
    assert "<script>" not in page
    assert "&lt;script&gt;" in page


@pytest.mark.slow
def test_our_library_is_sound() -> None:
    found = survey(library_folder(), Diagnostics(), runs=1, processes=2)
    assert found.broken == ()
    assert [name for name, files in found.templates.items() if not files] == []
    gold = next(one for one in found.taxonomies if one.scheme == "gold2018")
    assert all(one.scenarios for one in gold.situations)
