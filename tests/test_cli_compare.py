"""`compare` as a user sees it, with real runs and real sweeps."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from scenario_compiler.batch.execute import run_sweep
from scenario_compiler.batch.spec import SweepSpec
from scenario_compiler.batch.tally import Progress
from scenario_compiler.cli.differences import verdict
from scenario_compiler.recording.comparison import Comparison, Parting
from tests.batch.conftest import conflict_in
from tests.command import call
from tests.test_cli import CONFLICT
from tests.test_streams import FORBIDDEN


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a run, the same again, a faster one, and a longer one."""
    folder = tmp_path_factory.mktemp("runs")
    file = folder / "it.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    for name, *options in (
        ("one",),
        ("again", "--trajectory", folder / "again.csv"),
        ("faster", "--set", "speed=20.1"),
        ("longer", "--duration", "3"),
    ):
        assert call("run", file, "--perception", "ideal", "-o", folder / name, *options) == 0
    return folder


def test_equal_runs_are_reported_as_equal(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("compare", runs / "one", runs / "again") == 0
    out = capsys.readouterr().out
    assert "plan digest" in out
    assert "request_time" not in out
    assert out.endswith("The same happened in both.\n")


def test_differences_between_runs_are_reported_with_place_and_size(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert call("compare", runs / "one", runs / "faster") == 1
    out = capsys.readouterr().out
    assert "$speed" in out
    assert "The rows first differ at 0 s: the speed of ego is 20 m/s in the first, 20.1 m/s in the second." in out
    assert "final_speed" in out
    assert out.endswith("The runs differ.\n")


def test_an_event_that_differs_before_the_rows_do_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for seed in (1, 2):
        run = ("run", "obstacle_ahead", "--perception", "ideal", "--duration", "10", "--seed", seed)
        assert call(*run, "-o", tmp_path / str(seed)) == 0
    assert call("compare", tmp_path / "1", tmp_path / "2") == 1
    out = capsys.readouterr().out
    assert "The rows first differ at 8.35 s: the x of ego" in out
    assert "Events that differ: 6, the first of them at 7.4 s." in out


def test_a_value_that_one_run_does_not_have_has_no_unit() -> None:
    def said(column: str, first: str, second: str) -> str:
        parting = Parting(1.05, "ego", column, first, second)
        found = Comparison((), 3, True, parting, (), (), ())
        return next(iter(verdict(found, None)))

    assert said("blocked_distance", "181.9", "nan").endswith("is 181.9 m in the first, missing in the second.")
    assert said("x, y", "absent", "1.0, 2.0").endswith("is absent in the first, 1.0, 2.0 m in the second.")


@pytest.mark.parametrize(("other", "tolerance", "code"), [("faster", 0.05, 1), ("faster", 0.5, 0), ("longer", 5, 1)])
def test_a_tolerance_lets_positions_differ(runs: Path, other: str, tolerance: float, code: int) -> None:
    assert call("compare", runs / "one", runs / other, "--tolerance", tolerance) == code


def test_a_comparison_is_json(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert call("compare", runs / "one", runs / "longer", "--format", "json") == 1
    found = json.loads(capsys.readouterr().out)
    assert found["equal"] is False
    assert found["same_times"] is False
    assert found["parting"] is None
    assert found["rows"] == 41
    assert {"what": "end, s", "first": "2", "second": "3", "counts": False} in found["facts"]
    assert [one["entity"] for one in found["apart"]] == ["ego"]


def test_recordings_and_trajectories_are_runs_too(runs: Path) -> None:
    assert call("compare", runs / "one", runs / "again" / "recording.parquet") == 0
    assert call("compare", runs / "one", runs / "again.csv") == 0
    assert call("compare", runs / "faster", runs / "again.csv") == 1


def test_a_path_that_is_not_a_run_is_wrong_use(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad"
    shutil.copytree(runs / "one", bad)
    (bad / "outcome.json").write_text("{", encoding="utf-8")
    (tmp_path / "it.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    for other in (tmp_path / "nowhere", tmp_path, runs / "it.xml", bad, tmp_path / "it.csv", tmp_path / "no.csv"):
        assert call("compare", runs / "one", other) == 2
        assert str(other) in capsys.readouterr().err
    assert call("compare", runs / "one", runs / "one", "--tolerance", "-1") == 2


@pytest.fixture(scope="module")
def sweeps(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a sweep, the same again by three processes, one with another driver, and a shorter one."""
    folder = tmp_path_factory.mktemp("sweeps")
    conflict = conflict_in(folder)
    for name, *options in (
        ("one",),
        ("again", "--workers", 3),
        ("absent", "--set", "preset=absent"),
        ("shorter", "--where", "distance < 300"),
    ):
        grid = ("--vary", "distance=grid(30, 330, 7)", "--perception", "ideal", "--no-report")
        assert call("sweep", conflict, *grid, *options, "-o", folder / name) == 0
    assert call("run", conflict, "--perception", "ideal", "--duration", 1, "-o", folder / "run") == 0
    return folder


def test_equal_sweeps_are_reported_as_equal(sweeps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert call("compare", sweeps / "one", sweeps / "again") == 0
    out, err = capsys.readouterr()
    assert "$distance" in out
    assert "takeover_time" not in out
    assert out.endswith("Variants with the same parameters in both sweeps: 7 pairs.\nThe sweeps are equal.\n")
    assert err == ""


def test_sweeps_that_differ_are_compared_by_measure_and_by_outcome(
    sweeps: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    assert call("compare", sweeps / "one", sweeps / "absent") == 1
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["$preset", "absent"] in rows
    headings = ["measure", "unit", "differ", "first", "only", "second", "only", "median", "largest", "variant"]
    assert rows.count(headings) == 1
    assert rows.count(["takeover's", *headings]) == 1
    assert ["takeover_time", "s", "3", "3", "0", "–", "–", "0"] in rows
    assert ["duration", "s", "1", "0", "0", "0", "0.05", "0"] in rows
    assert ["resolution", "driver", "unanswered", "1", "1"] in rows
    assert ["resolution", "no_request", "=", "3"] in rows
    assert rows[-2:] == [["Pairs", "that", "differ:", "3."], ["The", "sweeps", "differ."]]


def test_variants_that_only_one_sweep_has_make_sweeps_differ(sweeps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert call("compare", sweeps / "shorter", sweeps / "one", "--tolerance", "0.5") == 1
    assert capsys.readouterr().out.endswith(
        "Variants with the same parameters in both sweeps: 6 pairs.\n"
        "Variants of the second sweep that are left out: 1.\n"
        "The sweeps differ.\n"
    )


def test_a_comparison_of_sweeps_is_json_with_all_variants(sweeps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert call("compare", sweeps / "one", sweeps / "absent", "--format", "json") == 1
    found = json.loads(capsys.readouterr().out)
    assert (found["equal"], found["paired"], found["differ"]) == (False, 7, 3)
    assert {"what": "$preset", "first": "", "second": "absent", "counts": False} in found["facts"]
    measured = {one["name"]: one for one in found["variants"]["numbers"]}
    assert measured["takeover_time"]["variants"] == [0, 0]
    assert measured["request_time"] == {
        "name": "request_time", "unit": "s", "both": 4, "first_alone": 0, "second_alone": 0,
        "differ": 0, "median": 0.0, "largest": 0.0, "variants": None,
    }  # fmt: skip
    changed = [one for one in found["variants"]["changes"] if one["what"] == "resolution"]
    assert {"what": "resolution", "first": "driver", "second": "open", "rows": 1, "variants": [[2, 2]]} in changed
    assert found["takeovers"]["rows"] == 4
    assert found["first_alone"] == found["second_alone"] == []


def test_a_sweep_is_compared_with_a_sweep_only(sweeps: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for other, why in ((sweeps / "run", "is not"), (sweeps / "nowhere", "does not exist")):
        for pair in ((sweeps / "one", other), (other, sweeps / "one")):
            capsys.readouterr()
            assert call("compare", *pair) == 2
            sentence = (
                f"{sweeps / 'one'} is the folder of a sweep, and {other} {why}: compare two runs or two such folders"
            )
            assert capsys.readouterr().err == f"scenario-compiler: {sentence}\n"


def test_the_page_of_two_sweeps_has_the_printed_tables(
    sweeps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "both.html"
    capsys.readouterr()
    assert call("compare", sweeps / "one", sweeps / "absent", "--html", page) == 1
    told = capsys.readouterr().out.splitlines()
    assert told[-1] == f"page: {page}"
    text = page.read_text(encoding="utf-8")
    assert "<h1>one and absent</h1>" in text
    assert f"<p>{told[-2]}</p>" in text
    cells = ("takeover_time", "s", "3", "3", "0", "–", "–", "0")
    first, *rest = cells
    row = f'<th scope="row">{first}</th>' + "".join(f"<td>{cell}</td>" for cell in rest)
    assert row in text
    assert list(cells) in [line.split() for line in told]


def test_options_that_fit_runs_only_are_refused_for_sweeps(
    sweeps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, page = sweeps / "one", tmp_path / "both.html"
    assert call("compare", one, one, "--html", page, "--camera") == 2
    assert "--camera draws pictures of runs, and these are sweeps" in capsys.readouterr().err
    assert not page.exists()
    table = one / "results.parquet"
    before = table.read_bytes()
    assert call("compare", one, sweeps / "again", "--html", table) == 2
    assert f"{table} is read by this command" in capsys.readouterr().err
    assert table.read_bytes() == before


def test_an_interrupted_sweep_is_compared_when_it_is_finished(
    sweeps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    class StopError(Exception):
        pass

    def stop(progress: Progress) -> None:
        if progress.done >= 16:
            raise StopError

    spec = SweepSpec(vary=("distance=grid(30, 330, 20)",), perception="ideal", interpreted=True)
    run_sweep(sweeps / "short.xml", spec, tmp_path / "whole", workers=1, report=False)
    with pytest.raises(StopError):
        run_sweep(sweeps / "short.xml", spec, tmp_path / "part", workers=1, report=False, progress=stop)
    assert call("compare", tmp_path / "whole", tmp_path / "part") == 2
    said = f"{tmp_path / 'part'} contains an unfinished sweep; `sweep` with --resume finishes it"
    assert said in capsys.readouterr().err
    run_sweep(sweeps / "short.xml", spec, tmp_path / "part", workers=1, report=False, resume=True)
    assert call("compare", tmp_path / "whole", tmp_path / "part") == 0


def test_a_search_is_not_compared(sweeps: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    search = ("--vary", "distance=uniform(30, 330)", "--boundary", "request", "--tolerance", 100)
    assert call("sweep", sweeps / "short.xml", *search, "--perception", "ideal", "-o", tmp_path / "search") == 0
    assert call("compare", sweeps / "one", tmp_path / "search") == 2
    assert f"{tmp_path / 'search'} contains a search: all its runs" in capsys.readouterr().err


@pytest.mark.parametrize("damage", [b"", b"\x1b[31m\n::error::x", b"half"])
@pytest.mark.parametrize("name", ["results.parquet", "takeovers.parquet"])
def test_a_damaged_table_of_a_sweep_is_reported(
    sweeps: Path, tmp_path: Path, name: str, damage: bytes, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copytree(sweeps / "one", tmp_path / "bad")
    file = tmp_path / "bad" / name
    content = file.read_bytes()
    file.write_bytes(content[: len(content) // 2] if damage == b"half" else damage)
    capsys.readouterr()
    assert call("compare", sweeps / "one", tmp_path / "bad") == 2
    err = capsys.readouterr().err
    assert f"{file} is not the table of a sweep" in err
    assert [one for one in FORBIDDEN if one in err] == []
