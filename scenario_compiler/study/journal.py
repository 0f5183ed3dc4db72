"""The journal of a session: one JSON object for each event, on the disk before the session continues."""

from __future__ import annotations

import json
import os
import threading
from collections import Counter
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from scenario_compiler.outputs import make_folder
from scenario_compiler.study.folder import StudyError

Record = dict[str, Any]
"""A line of a journal: `kind` is the kind of event, `step` the step of the session."""


def read_journal(path: Path) -> list[Record]:
    """Return the records of a journal; none if there is no file.

    An incomplete last line, as after a power failure, is left out.

    Raises:
        StudyError: A whole line is not a record.
    """
    lines = _whole_lines(path).split(b"\n")
    return [_record(line, f"{path}:{number}") for number, line in enumerate(lines, 1) if line]


def _record(line: bytes, place: str) -> Record:
    try:
        found = json.loads(line)
    except (ValueError, RecursionError):
        found = None
    if not isinstance(found, dict) or not isinstance(found.get("kind"), str) or type(found.get("step")) is not int:
        raise StudyError(f"{place}: the journal is damaged: this line is not a record")
    return found


def _whole_lines(path: Path) -> bytes:
    content = path.read_bytes() if path.is_file() else b""
    return content[: content.rfind(b"\n") + 1]


class Journal:
    """A journal for writing; opening an existing one appends to it."""

    def __init__(self, path: Path, heard: Callable[[Record], None] | None = None) -> None:
        """Open the journal of a file, which is created if it does not exist; `heard` is called with each record."""
        self._heard = heard
        make_folder(path.parent)
        self.records = read_journal(path)
        self._file = path.open("r+b" if path.exists() else "w+b", buffering=0)
        self._file.truncate(len(_whole_lines(path)))
        self._file.seek(0, os.SEEK_END)
        self._lock = threading.Lock()

    def add(self, kind: str, step: int, **values: Any) -> None:
        """Write an event at a step; it is on the disk when this returns.

        Raises:
            OSError: It cannot be written; the journal is as before.
        """
        record = {"kind": kind, "step": step, **values}
        with self._lock:
            before = self._file.tell()
            try:
                self._write(json.dumps(record, ensure_ascii=False).encode() + b"\n")
            except OSError:
                self._file.truncate(before)
                self._file.seek(before)
                raise
            self.records.append(record)
        if self._heard is not None:
            self._heard(record)

    def _write(self, line: bytes) -> None:
        while line:
            line = line[self._file.write(line) :]
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def step_reached(records: Iterable[Record]) -> int:
    """Return the number of the first step that is not done."""
    return 1 + max((one["step"] for one in records if one["kind"] == "done"), default=-1)


def attempts_at(records: Iterable[Record], step: int) -> int:
    """Return how often the run of a step has been started."""
    return Counter(one["step"] for one in records if one["kind"] == "begun")[step]
