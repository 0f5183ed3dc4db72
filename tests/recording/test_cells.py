"""Cells of CSV files are shown by a spreadsheet, never run, and read back as they were."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.recording.cells import cell_text, text_cell
from scenario_compiler.recording.events import EventRow, write_events
from scenario_compiler.recording.trajectory import read_trajectory, write_trajectory
from tests.recording.made import record

FORMULAS = ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "\n=1", "'=1"]


@pytest.mark.parametrize("text", FORMULAS)
def test_a_formula_is_marked_as_text(text: str) -> None:
    assert text_cell(text) == f"'{text}"


@pytest.mark.parametrize("text", ["", "ego", "-1", "+3.5e-7", "-0.25", "a=b", "'tis", "1e5"])
def test_numbers_and_plain_texts_stay(text: str) -> None:
    assert text_cell(text) == text


@given(st.text(alphabet="'=+-@\t\r\nab1.", max_size=6))
def test_a_cell_reads_back(text: str) -> None:
    assert cell_text(text_cell(text)) == text


def test_names_and_messages_in_files_cannot_become_formulas(tmp_path: Path) -> None:
    names = ("=HYPERLINK(1)", "@car")
    run = record(names, 3, lambda _: {name: (0.0, 5.0) for name in ("x", "y", "h", "v", "s", "off")})
    write_trajectory(run, tmp_path / "t.csv")
    write_events([EventRow(t=0.0, kind="message", entity="=a", cause="+b", message="-c")], tmp_path / "e.csv")
    for file in ("t.csv", "e.csv"):
        with (tmp_path / file).open(newline="") as opened:
            cells = [cell for row in list(csv.reader(opened))[1:] for cell in row]
        assert not [cell for cell in cells if cell[:1] in ("=", "+", "@")]
    assert read_trajectory(tmp_path / "t.csv").header.entities == names
