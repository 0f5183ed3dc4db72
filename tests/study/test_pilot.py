"""A pilot goes through a whole study: its files, tables, scores and expected effects."""

from __future__ import annotations

import csv
import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser

from scenario_compiler.study.dataset import TRIAL_COLUMNS, scores_of
from scenario_compiler.study.effects import by_condition, differences, mean_of, needed_for, power_of
from scenario_compiler.study.tables import read_table, tidy_rows
from tests.browser import opened_page
from tests.command import call
from tests.study import made


@pytest.fixture(scope="module")
def piloted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("pilot")
    assert call("study", made.study(folder), "--pilot", "--perception", "ideal", "-o", folder / "data") == 0
    return folder


def test_each_participant_has_their_files_in_the_form_of_bids(piloted: Path) -> None:
    data = piloted / "data"
    about = json.loads((data / "dataset_description.json").read_text(encoding="utf-8"))
    assert about["BIDSVersion"] == "1.9.0"
    assert [row["participant_id"] for row in read_table(data / "participants.tsv")] == ["sub-01", "sub-02"]
    for person in ("sub-01", "sub-02"):
        beh = data / person / "ses-01" / "beh"
        rows = read_table(beh / f"{person}_ses-01_task-short_beh.tsv")
        assert [row["run"] for row in rows] == ["1", "2", "3", "4"]
        assert [row["driven_by"] for row in rows] == ["model"] * 4
        assert {row["hmi"] for row in rows} == {"tone", "text"}
        for row in rows:
            assert (data / row["recording"] / "recording.parquet").is_file()
            events = read_table(beh / f"{person}_ses-01_task-short_run-{int(row['run']):02d}_events.tsv")
            assert [one["onset"] for one in events if one["trial_type"] == "request"][:1] == [row["request_time"]]
            assert row["probe_asked"] == "2"
            assert [one["cause"] for one in events if one["trial_type"] == "probe"] == ["speed", "driver"]
    about = {"TaskName", "TaskDescription"}
    assert (
        set(json.loads((data / "task-short_beh.json").read_text(encoding="utf-8")))
        == {one.column for one in TRIAL_COLUMNS} | about
    )


def test_the_codebook_has_every_column_of_every_table(piloted: Path) -> None:
    data = piloted / "data"
    book = {(one["table"], one["column"]) for one in read_table(data / "codebook.tsv")}
    tables = {
        "task-effort_beh": data / "sub-01/ses-01/beh/sub-01_ses-01_task-effort_beh.tsv",
        "task-short_beh": data / "sub-01/ses-01/beh/sub-01_ses-01_task-short_beh.tsv",
        "task-short_events": data / "sub-01/ses-01/beh/sub-01_ses-01_task-short_run-01_events.tsv",
    }
    for table, file in tables.items():
        assert {(table, name) for name in file.read_text(encoding="utf-8").splitlines()[0].split("\t")} <= book


def test_answers_are_scored(piloted: Path) -> None:
    rows = [row for file in sorted((piloted / "data").rglob("*_task-effort_beh.tsv")) for row in read_table(file)]
    assert [row["run"] for row in rows] == ["1", "2", "3", "4"] * 2
    for row in rows:
        assert float(row["effort"]) == (int(row["hard"]) + 8 - int(row["calm"])) / 2


def test_a_pilot_is_the_same_each_time_and_is_not_done_again(piloted: Path, tmp_path: Path) -> None:
    again = tmp_path / "data"
    study = piloted / "study.xml"
    for _ in range(2):
        assert call("study", study, "--pilot", "--perception", "ideal", "-o", again) == 0
    for file in sorted((piloted / "data").rglob("*.tsv")):
        assert file.read_bytes() == (again / file.relative_to(piloted / "data")).read_bytes()


def test_another_study_does_not_go_on_in_its_folder(piloted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    other = piloted / "other.xml"
    other.write_text(
        (piloted / "study.xml").read_text(encoding="utf-8").replace('seed="3"', 'seed="4"'), encoding="utf-8"
    )
    assert call("study", other, "--pilot", "--perception", "ideal", "-o", piloted / "data") == 2
    assert "another study" in capsys.readouterr().err


def test_a_study_does_not_go_on_with_other_options(piloted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = ("--perception", "surrogate", "--dt", "0.025")
    assert call("study", piloted / "study.xml", "--pilot", *options, "-o", piloted / "data") == 2
    assert "holds the data of this study with other options: --perception ideal, --dt 0.02" in capsys.readouterr().err


def test_export_makes_one_tidy_table(piloted: Path) -> None:
    table = piloted / "table.csv"
    assert call("study", "export", piloted / "data", "-o", table) == 0
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    assert all(row["effort.effort"] for row in rows)
    assert set(rows[0]) == set(json.loads(table.with_suffix(".json").read_text(encoding="utf-8")))
    assert call("study", "export", piloted, "-o", table) == 2


def test_the_page_of_expected_effects_names_its_conditions(piloted: Path) -> None:
    page = (piloted / "data" / "expected.html").read_text(encoding="utf-8")
    for text in ("blocked-tone", "blocked-text", "tone − text", "takeover time, s"):
        assert text in page


def test_a_difference_without_variation_asks_for_no_number_of_participants(piloted: Path) -> None:
    page = (piloted / "data" / "expected.html").read_text()
    rows = re.findall(r"<tr><td>hmi</td>.*?</tr>", page)
    cells = [re.findall(r"<td class=\"n\">(.*?)</td>", row)[-3:] for row in rows]
    assert ["–", "–", "–"] in cells  # the model answers after 3 s in each trial
    assert all((effect == "–") == (needed == "–") for effect, _, needed in cells)


def test_long_names_of_conditions_are_whole_in_the_plots_of_effects(tmp_path: Path, browser: Browser) -> None:
    study = made.study(tmp_path)
    study.write_text(study.read_text().replace('hmi name="text"', 'hmi name="textwithreasonsandadviceforthedriver"'))
    assert call("study", study, "--pilot", "--perception", "ideal", "-o", tmp_path / "data") == 0
    with opened_page(browser, (tmp_path / "data" / "expected.html").as_uri()) as page:
        cut = """() => [...document.querySelectorAll("svg text")].filter((one) => {
          const { x, width } = one.getBBox();
          const box = one.ownerSVGElement.viewBox.baseVal;
          return x < 0 || x + width > box.width;
        }).map((one) => one.textContent)"""
        assert page.locator("svg text").count() > 10
        assert page.evaluate(cut) == []


@pytest.mark.parametrize("width", [pytest.param(1400, marks=pytest.mark.slow), 390])
def test_the_page_of_expected_effects_is_accessible(piloted: Path, browser: Browser, width: int) -> None:
    with opened_page(browser, (piloted / "data" / "expected.html").as_uri(), width) as page:
        assert [one["id"] for one in Axe().run(page).response["violations"]] == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width


def test_plan_prints_who_meets_what(piloted: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("study", "plan", piloted / "study.xml") == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines == [
        "sub-01 ses-01: blocked-tone, blocked-text, blocked-text, blocked-tone",
        "sub-02 ses-01: blocked-text, blocked-tone, blocked-tone, blocked-text",
    ]


def test_a_file_that_is_not_a_study_and_a_missing_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("study", made.study(tmp_path)) == 2
    assert call("study", tmp_path / "conflicts.xml", "--pilot", "-o", tmp_path / "x") == 2
    assert call("study", tmp_path / "effort.xml", "--pilot", "-o", tmp_path / "x") == 2
    assert "is not a study" in capsys.readouterr().err
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thesis.txt").write_text("mine", encoding="utf-8")
    assert call("study", tmp_path / "study.xml", "--pilot", "-o", tmp_path / "full") == 2
    assert "contains no study" in capsys.readouterr().err


def test_scores_count_reversed_items_from_the_other_end(tmp_path: Path) -> None:
    asked = made.questionnaire(tmp_path)
    assert scores_of(asked, {"hard": 7, "calm": 1})["effort"] == 7.0
    assert scores_of(asked, {"hard": 7, "calm": 7})["effort"] == 4.0


def test_power_is_that_of_published_tables() -> None:
    """Cohen 1988: 34 pairs give a power of 80 % for d_z = 0.5 in a two-sided test at 5 %, 15 for 0.8."""
    assert needed_for(0.5) == 34
    assert needed_for(0.8) == 15
    assert power_of(0.5, 34) == pytest.approx(0.8078, abs=1e-3)
    assert power_of(0.0, 20) == pytest.approx(0.05, abs=1e-6)


def test_the_power_of_a_strong_effect_is_a_number_and_grows_with_effect_and_pairs() -> None:
    effects, counts = [0.01, 0.3, 1.0, 2.0, 3.0, 6.63, 12.0, 50.0], [2, 3, 4, 8, 24, 100, 1000]
    table = np.array([[power_of(effect, count) for count in counts] for effect in effects])
    assert np.isfinite(table).all()
    assert (np.diff(table, axis=0) >= -1e-9).all()
    assert (np.diff(table, axis=1) >= -1e-9).all()
    assert [power_of(-effect, 24) for effect in effects] == [power_of(effect, 24) for effect in effects]
    # By numerical integration of the normal distribution over the chi-squared one.
    assert power_of(6.63, 3) == pytest.approx(0.9985, abs=1e-4)
    assert power_of(12.0, 2) == pytest.approx(0.8170, abs=1e-4)
    assert (needed_for(6.63), needed_for(2.0)) == (3, 5)


def test_an_interval_is_students() -> None:
    found = mean_of([1.0, 2.0, 3.0, 4.0])
    assert (found.count, found.mean) == (4, 2.5)
    assert found.low == pytest.approx(2.5 - 3.182446 * 1.290994 / 2, abs=1e-5)


def trial(person: int, hmi: str, setting: str, value: float | None) -> dict[str, str]:
    """Return a row of the trial table; None is a value that is missing."""
    told = {"participant_id": f"sub-{person:02d}", "scenario": "blocked", "hmi": hmi, "setting": setting}
    return told | {"condition": f"{hmi}-{setting}", "takeover_time": "n/a" if value is None else repr(value)}


def test_differences_that_vary_by_rounding_only_have_no_effect_size() -> None:
    """2.1 - 1.8 and 2.35 - 2.05 are not the same number."""
    rows = [
        trial(person, hmi, "near", round((1.8 + 0.05 * person + 0.3 * (hmi == "tone")) / 0.05) * 0.05)
        for person in range(1, 7) for hmi in ("text", "tone")
    ]  # fmt: skip
    (found,) = differences(rows, "hmi", "takeover_time")
    assert found.mean.mean == pytest.approx(0.3)
    assert found.mean.deviation == 0.0
    assert math.isnan(found.effect)
    assert found.needed is None


def test_a_participant_counts_once_however_often_a_trial_is_repeated() -> None:
    """Two people who differ by 2 s and hardly vary: ten trials of each say no more of people in general than one."""
    once = [trial(1, "tone", "near", 2.0), trial(2, "tone", "near", 4.0)]
    noise = [-0.1, 0.1] * 5
    often = [trial(int(row["participant_id"][-1]), "tone", "near", float(row["takeover_time"]) + one)
             for row in once for one in noise]  # fmt: skip
    (single,), (repeated,) = by_condition(once, "takeover_time"), by_condition(often, "takeover_time")
    assert (repeated.trials, repeated.mean.count) == (20, 2)
    assert repeated.mean.low == pytest.approx(single.mean.low)
    assert repeated.mean.deviation == pytest.approx(2.0**0.5)
    assert repeated.within == pytest.approx((10 * 0.01 / 9) ** 0.5)
    assert single.within != single.within  # NaN: nobody has two


def test_unequal_numbers_of_trials_do_not_weigh() -> None:
    rows = [trial(1, "tone", "near", 2.0), *[trial(2, "tone", "near", 4.0)] * 9, trial(2, "tone", "near", None)]
    (found,) = by_condition(rows, "takeover_time")
    assert (found.trials, found.missing, found.mean.mean) == (10, 1, 3.0)


def test_levels_are_compared_where_all_else_is_the_same() -> None:
    """Far is 3 s slower, text 1 s quicker; far trials with text that have no value must not make text look quicker."""
    rows = [
        trial(person, hmi, setting, 4.0 + 0.1 * person * (hmi == "text") - (hmi == "text") + 3.0 * (setting == "far"))
        for person in (1, 2, 3) for hmi in ("tone", "text") for setting in ("near", "far")
    ]  # fmt: skip
    (whole,) = differences(rows, "hmi", "takeover_time")
    assert whole.levels == ("text", "tone")
    assert whole.mean.mean == pytest.approx(0.8)
    gaps = [row | {"takeover_time": "n/a"} if row["condition"] == "text-far" else row for row in rows]
    (found,) = differences(gaps, "hmi", "takeover_time")
    assert found.mean == whole.mean
    assert found.mean.count == 3
    assert found.effect == pytest.approx(0.8 / 0.1)


SICKNESS = """\
<questionnaire version="1" name="sickness">
  <scale name="four" from="0" to="3"/>
  <item name="nausea" text="Nausea" scale="four"/>
</questionnaire>
"""


@pytest.fixture
def asked_twice(tmp_path: Path) -> Path:
    """The data of a pilot whose participants are asked the same before and after."""
    study = made.study(tmp_path)
    (tmp_path / "sickness.xml").write_text(SICKNESS, encoding="utf-8")
    ask = '<ask file="sickness.xml"/>'
    text = study.read_text(encoding="utf-8").replace("</before>", f"{ask}</before>")
    study.write_text(text.replace("</study>", f"<after>{ask}</after></study>"), encoding="utf-8")
    assert call("study", study, "--pilot", "--perception", "ideal", "-o", tmp_path / "data") == 0
    return tmp_path / "data"


def test_answers_before_and_after_are_distinguished(asked_twice: Path) -> None:
    given = read_table(asked_twice / "sub-01/ses-01/beh/sub-01_ses-01_task-sickness_beh.tsv")
    assert [(one["when"], one["run"]) for one in given] == [("before", "n/a"), ("after", "n/a")]
    for row in tidy_rows(asked_twice)[:4]:
        assert [row[f"sickness.{one['when']}.nausea"] for one in given] == [one["nausea"] for one in given]
        assert row["effort.hard"] != "n/a"
    assert call("study", "export", asked_twice, "-o", asked_twice / "table.csv") == 0
    assert "sickness.before.nausea" in json.loads((asked_twice / "table.json").read_text(encoding="utf-8"))


def test_answers_before_and_after_a_practice_drive_are_distinguished(tmp_path: Path) -> None:
    study = made.study(tmp_path)
    (tmp_path / "sickness.xml").write_text(SICKNESS, encoding="utf-8")
    ask = '<ask file="sickness.xml"/>'
    practised = f'{ask}<practice target="obstacle_ahead"/>{ask}</before>'
    study.write_text(study.read_text(encoding="utf-8").replace("</before>", practised), encoding="utf-8")
    data = tmp_path / "data"
    assert call("study", study, "--pilot", "--perception", "ideal", "-o", data) == 0
    given = read_table(data / "sub-01/ses-01/beh/sub-01_ses-01_task-sickness_beh.tsv")
    assert [(one["when"], one["run"]) for one in given] == [("before", "n/a"), ("before_2", "n/a")]
    for row in tidy_rows(data)[:4]:
        assert [row[f"sickness.{one['when']}.nausea"] for one in given] == [one["nausea"] for one in given]
    assert call("study", "export", data, "-o", data / "table.csv") == 0
    assert "sickness.before_2.nausea" in json.loads((data / "table.json").read_text(encoding="utf-8"))


@pytest.mark.slow
def test_the_validator_of_bids_finds_no_error(asked_twice: Path) -> None:
    validator = shutil.which("bids-validator-deno", path=str(Path(sys.executable).parent))
    if validator is None:
        pytest.skip("no bids-validator-deno: pip install '.[bids]'")
    done = subprocess.run([validator, "--json", asked_twice], capture_output=True, check=False)
    found = json.loads(done.stdout)["issues"]["issues"]
    assert [one for one in found if one["severity"] == "error"] == []
    assert len(found) > 0  # what only a researcher knows
