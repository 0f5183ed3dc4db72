"""The tables of a study, tab-separated as in BIDS, and one tidy table of all its runs."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from scenario_compiler.batch.codebook import Column
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.recording.cells import text_cell
from scenario_compiler.study.folder import StudyError, kept_manifest

KEYS = ("participant_id", "session_id", "run")
"""Columns that say to which run a row belongs."""

MISSING = "n/a"
"""Text for a missing value in a table, after BIDS."""


def write_table(path: Path, columns: Sequence[Column], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a tab-separated table, with `MISSING` for values that a row does not have."""
    make_folder(path.parent)
    text = io.StringIO()
    writer = csv.writer(text, delimiter="\t", lineterminator="\n", quoting=csv.QUOTE_MINIMAL)
    writer.writerow(one.column for one in columns)
    for row in rows:
        writer.writerow(_cell(row.get(one.column)) for one in columns)
    write_whole(path, text.getvalue())


def _cell(value: Any) -> str:
    if value is None or value == "":
        return MISSING
    if isinstance(value, float):
        return repr(round(value, 9))
    return text_cell(" ".join(str(value).split()))


def read_table(path: Path, columns: Sequence[str] = ()) -> list[dict[str, str]]:
    """Return the rows of a tab-separated table; none if there is no file.

    Args:
        path: The table.
        columns: Columns that it must have, if it has rows.

    Raises:
        StudyError: It is damaged: it is not text in UTF-8, a row is not as long as the first line, or a column is
            missing.
    """
    if not path.is_file():
        return []
    try:
        with path.open(encoding="utf-8", newline="") as file:
            head, *lines = csv.reader(file, delimiter="\t")
            rows = [dict(zip(head, line, strict=True)) for line in lines]
    except (ValueError, csv.Error):
        raise StudyError(f"{path} is damaged: it is not a table of a study") from None
    missing = [one for one in columns if rows and one not in head]
    if missing:
        raise StudyError(f"{path} is damaged: it has no column {', '.join(missing)}")
    return rows


def tidy_rows(root: Path) -> list[dict[str, str]]:
    """Return one row for each run of all participants, with the answers and scores of the run and of the session.

    The columns of a questionnaire begin with its name and a point. Answers after a run are in the run's row; those
    given once in a session are in each of its rows. If a questionnaire is asked at several places, the place follows,
    as in `sickness.before.nausea`, or `sickness.before_2.nausea` of the second time before the trials.

    Raises:
        StudyError: The folder contains no study, or a damaged one.
    """
    own_task = _task(root)
    tables: dict[str, list[dict[str, str]]] = {}
    for file in sorted(root.glob("sub-*/ses-*/beh/*_beh.tsv")):
        task = file.stem.split("_task-")[1].removesuffix("_beh")
        needed = KEYS if task == own_task else (*KEYS, "when")
        tables.setdefault(task, []).extend(read_table(file, needed))
    rows = tables.pop(own_task, [])
    for task, answers in sorted(tables.items()):
        places = sorted({one["when"] for one in answers})
        for place in places:
            prefix = task if len(places) == 1 else f"{task}.{place}"
            given = {_key(one): one for one in answers if one["when"] == place}
            told = [name for name in answers[0] if name not in (*KEYS, "when")]
            for row in rows:
                own = given.get(_key(row) if place == "trial" else (*_key(row)[:2], MISSING))
                row |= {f"{prefix}.{name}": MISSING if own is None else own[name] for name in told}
    return rows


def _task(root: Path) -> str:
    """Return the task of the tables with the runs: the name of the study; StudyError if the folder contains none."""
    kept = kept_manifest(root)
    if kept is None:
        raise StudyError(f"{root} contains no study")
    return str(kept["study"])


def _key(row: Mapping[str, str]) -> tuple[str, str, str]:
    participant, session, run = KEYS
    return row[participant], row[session], row[run]


def write_tidy(root: Path, output: Path) -> int:
    """Write the tidy table of a study as CSV, with empty cells for missing values; return the number of its rows.

    A JSON file beside it describes the columns.

    Raises:
        StudyError: The folder contains no study, a damaged one, or no run yet.
        OSError: The table cannot be written.
    """
    rows = tidy_rows(root)
    if not rows:
        raise StudyError(f"{root} contains no run yet")
    lines = [list(rows[0]), *([value if value != MISSING else "" for value in row.values()] for row in rows)]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    book, own = {}, _task(root)
    for one in read_table(root / "codebook.tsv", ("table", "column", "kind", "unit", "definition", "missing")):
        task = one["table"].removeprefix("task-").removesuffix("_beh")
        column = one["column"]
        for name in rows[0]:
            parts = name.split(".")
            if name == column if task == own else (parts[0], parts[-1]) == (task, column):
                book[name] = {key: one[key] for key in ("kind", "unit", "definition", "missing") if one[key] != MISSING}
    write_whole(output, text.getvalue())
    write_whole(output.with_suffix(".json"), json.dumps(book, indent=1, ensure_ascii=False) + "\n")
    return len(rows)
