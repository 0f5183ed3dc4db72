"""Real files: each is read or diagnosed, none crashes or hangs."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.languages import expand, parse, read_scenario_document

EVERY = 9
"""One file of so many is read where not all are."""


def _read(files: list[Path]) -> dict[str, int]:
    """Return how many files became scenarios, hold none, or are at fault and told so."""
    counts = {"scenario": 0, "other": 0, "fault": 0}
    for file in files:
        sink = Diagnostics()
        document = read_scenario_document(file, sink)
        source = None if document is None else parse(document, sink)
        for name in () if source is None else source.scenarios:
            assert expand(source, name, {}, sink) is not None  # type: ignore[arg-type]  # it has a name
        kind = "fault" if source is None else "scenario" if source.scenarios else "other"
        assert kind != "fault" or sink.has_errors, file
        counts[kind] += 1
    return counts


def test_some_real_files_are_read_or_diagnosed(corpus: Path) -> None:
    counts = _read(sorted(corpus.rglob("*.xosc"))[::EVERY])
    assert counts["scenario"] > counts["other"] > counts["fault"]


@pytest.mark.slow
def test_every_real_file_is_read_or_diagnosed(corpus: Path) -> None:
    files = sorted(corpus.rglob("*.xosc"))
    counts = _read(files)
    unread = [file for file in files if read_document(file, Diagnostics()) is None]
    assert counts["fault"] <= len(unread) + 3
    assert counts["scenario"] > 300
