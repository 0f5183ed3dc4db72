"""The journal of a session survives the end of its program at any byte."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.study.folder import StudyError
from scenario_compiler.study.journal import Journal, attempts_at, read_journal, step_reached
from tests.live.serving import file_sizes_limited


def test_what_is_written_is_there_at_once(tmp_path: Path) -> None:
    file = tmp_path / "deep" / "journal.jsonl"
    journal = Journal(file)
    journal.add("done", 0, answers={"more": "Grüße\nund mehr"})
    assert read_journal(file) == [{"kind": "done", "step": 0, "answers": {"more": "Grüße\nund mehr"}}]
    journal.close()


def test_a_journal_goes_on_behind_its_last_whole_line(tmp_path: Path) -> None:
    file = tmp_path / "journal.jsonl"
    journal = Journal(file)
    for step in range(3):
        journal.add("done", step, answers={"text": "äöü"})
    journal.close()
    whole = file.read_bytes()
    starts = [0, *(k + 1 for k, byte in enumerate(whole) if byte == ord("\n"))]
    for length in range(len(whole)):
        file.write_bytes(whole[:length])
        lines = sum(start <= length for start in starts) - 1
        again = Journal(file)
        assert step_reached(again.records) == lines
        again.add("begun", lines)
        again.close()
        records = read_journal(file)
        assert [one["kind"] for one in records] == ["done"] * lines + ["begun"]
        assert attempts_at(records, lines) == 1


@pytest.mark.parametrize("line", ["{", "5", '{"kind": "done"}', '{"kind": 1, "step": 1}', "\udcff", "[" * 100_000])
def test_a_damaged_line_is_reported_with_its_place(tmp_path: Path, line: str) -> None:
    file = tmp_path / "journal.jsonl"
    file.write_bytes(b'{"kind": "done", "step": 0}\n' + line.encode("utf-8", "surrogateescape") + b"\n")
    with pytest.raises(StudyError, match=r"journal\.jsonl:2: the journal is damaged"):
        read_journal(file)


def test_a_record_that_cannot_be_written_leaves_the_journal_as_it_was(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "journal.jsonl")
    journal.add("done", 0)
    with file_sizes_limited(100), pytest.raises(OSError, match="File too large"):
        journal.add("note", 1, text="x" * 200)
    journal.add("done", 1)
    journal.close()
    kept = [{"kind": "done", "step": 0}, {"kind": "done", "step": 1}]
    assert journal.records == kept
    assert read_journal(tmp_path / "journal.jsonl") == kept


def test_of_an_empty_journal_the_first_step_is_reached(tmp_path: Path) -> None:
    assert read_journal(tmp_path / "none.jsonl") == []
    assert step_reached([]) == 0
    assert step_reached([{"kind": "note", "step": 3}]) == 0
