"""`compare` as a user sees it, with real runs."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from tests.command import call
from tests.test_cli import CONFLICT


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
    assert "The runs first differ at 0 s: the speed of ego is 20 m/s in the first, 20.1 m/s in the second." in out
    assert "final_speed" in out
    assert out.endswith("The runs differ.\n")


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
