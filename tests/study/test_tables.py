"""The folder of a study that somebody has damaged: a sentence with the file, and no table."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.command import call

HEAD = "participant_id\tsession_id\trun"


@pytest.mark.parametrize(
    ("file", "content", "said"),
    [
        ("sourcedata/study.json", b"{", "does not describe a study"),
        ("sourcedata/study.json", b"[1]", "does not describe a study"),
        ("sub-01/ses-01/beh/sub-01_ses-01_task-it_beh.tsv", b"\xff\xfe", "not a table of a study"),
        ("sub-01/ses-01/beh/sub-01_ses-01_task-it_beh.tsv", b"", "not a table of a study"),
        ("sub-01/ses-01/beh/sub-01_ses-01_task-it_beh.tsv", b"a\tb\n1\n", "not a table of a study"),
        ("sub-01/ses-01/beh/sub-01_ses-01_task-it_beh.tsv", b"run\n1\n", "no column participant_id, session_id"),
        ("sub-01/ses-01/beh/sub-01_ses-01_task-effort_beh.tsv", f"{HEAD}\n1\t1\t1\n".encode(), "no column when"),
        ("codebook.tsv", b"table\n1\n", "no column column, kind"),
    ],
)
def test_a_damaged_file_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], file: str, content: bytes, said: str
) -> None:
    whole = {
        "sourcedata/study.json": b'{"study": "it"}',
        "sub-01/ses-01/beh/sub-01_ses-01_task-it_beh.tsv": f"{HEAD}\nsub-01\tses-01\t1\n".encode(),
    }
    for name, text in (whole | {file: content}).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_bytes(text)
    assert call("study", "export", tmp_path, "-o", tmp_path / "table.csv") == 2
    assert f"{tmp_path / file} is damaged: " in (error := capsys.readouterr().err)
    assert said in error
    assert not (tmp_path / "table.csv").exists()
