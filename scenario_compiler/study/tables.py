"""The tables of a study, tab-separated as BIDS has them, and the one tidy table of all its runs."""

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
from scenario_compiler.study.keeping import MANIFEST, StudyError

MISSING = "n/a"
"""What stands in a table for a value that is missing, after BIDS."""


def write_table(path: Path, columns: Sequence[Column], rows: Iterable[Mapping[str, Any]]) -> None:
    """Write a tab-separated table; `MISSING` stands for what a row does not have."""
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


def read_table(path: Path) -> list[dict[str, str]]:
    """Return the rows of a tab-separated table; none where there is no file."""
    if not path.is_file():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, delimiter="\t"))


def tidy_rows(root: Path) -> list[dict[str, str]]:
    """Return one row a run of all participants, with the answers and scores that belong to the run, to the session.

    The columns of a questionnaire begin with its name and a point: answers given after a run stand in the run's row,
    those given once in a session in each of its rows.

    Raises:
        StudyError: The folder holds no study.
    """
    if not (root / MANIFEST).is_file():
        raise StudyError(f"{root} holds no study")
    rows = [row for file in sorted(root.glob("sub-*/ses-*/beh/*_beh.tsv")) for row in read_table(file)]
    for file in sorted((root / "phenotype").glob("*.tsv")):
        answers = read_table(file)
        told = [name for name in answers[0] if name not in ("participant_id", "session_id", "run")] if answers else []
        for row in rows:
            here = [one for one in answers if all(one[key] == row[key] for key in ("participant_id", "session_id"))]
            own = [one for one in here if one["run"] in (row["run"], MISSING)]
            for name in told:
                row[f"{file.stem}.{name}"] = own[0][name] if own else MISSING
    return rows


def write_tidy(root: Path, output: Path) -> int:
    """Write the tidy table of a study as CSV, an absent value as an empty cell; return the number of its rows.

    A JSON file beside it says what the columns hold.

    Raises:
        StudyError: The folder holds no study, or no run yet.
        OSError: The table cannot be written.
    """
    rows = tidy_rows(root)
    if not rows:
        raise StudyError(f"{root} holds no run yet")
    lines = [list(rows[0]), *([value if value != MISSING else "" for value in row.values()] for row in rows)]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(lines)
    write_whole(output, text.getvalue())
    book = {}
    for one in read_table(root / "codebook.tsv"):
        part = one["table"].removeprefix("phenotype/")
        name = one["column"] if one["table"] == "beh" else f"{part}.{one['column']}"
        if name in rows[0]:
            book[name] = {key: one[key] for key in ("kind", "unit", "definition", "missing") if one[key] != MISSING}
    write_whole(output.with_suffix(".json"), json.dumps(book, indent=1, ensure_ascii=False) + "\n")
    return len(rows)
