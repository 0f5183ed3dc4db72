"""A small slice of `make fuzz`, so that it goes on working."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.fuzz.mutants import Mirrors, mutant, originals
from tests.fuzz.trial import run_trial


@pytest.mark.parametrize(
    ("kind", "commands", "count"), [("mutants", ("validate", "compile"), 60), ("runs", ("run",), 15)]
)
def test_mutants_are_dealt_with_cleanly(
    repository: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, commands: tuple[str, ...], count: int
) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    sources = originals(repository, None)
    faults = []
    mirrors = Mirrors(tmp_path / "mirrors")
    for number in range(count):
        made = mutant(number, kind, sources, mirrors)
        faults += [f"{made.name}: {fault}" for fault in run_trial(made, commands).faults]
    assert faults == []


def test_a_mutant_is_decided_by_its_number(repository: Path, tmp_path: Path) -> None:
    sources = originals(repository, None)
    made = [mutant(7, "mutants", sources, Mirrors(tmp_path / again)).content for again in ("one", "two")]
    assert made[0] == made[1]
