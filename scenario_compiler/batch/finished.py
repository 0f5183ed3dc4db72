"""Reads the tables of finished sweeps, whole or one column at a time."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa

from scenario_compiler.batch.codebook import Column
from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.folder import TABLE, TAKEOVER_TABLE, is_sweep
from scenario_compiler.batch.measuring import Columns
from scenario_compiler.batch.results import FORMAT, read_columns, schema_of
from scenario_compiler.recording.arrow import KEY, opened_parquet
from scenario_compiler.recording.recording import Floats, Integers


@dataclass(frozen=True)
class SweepTable:
    """A table of a finished sweep, whose columns are read one at a time.

    Attributes:
        path: Its file.
        rows: Number of its rows.
        columns: Its columns by name, in order, as its file describes them.
    """

    path: Path
    rows: int
    columns: Mapping[str, Column]

    def numbers(self, name: str) -> Floats:
        """Return a column of numbers or truth values, (rows,), NaN if there is no value; SweepError if unreadable."""
        with _faults_of(self.path):
            return np.asarray(self._column(name).cast(pa.float64()).fill_null(np.nan).to_numpy())

    def integers(self, name: str) -> Integers:
        """Return a column of integers, (rows,), -1 if there is no value; SweepError if unreadable."""
        with _faults_of(self.path):
            return np.asarray(self._column(name).fill_null(-1).to_numpy())

    def texts(self, name: str) -> tuple[Integers, list[str]]:
        """Return the number of each row's text, (rows,), -1 if there is none, and the texts; SweepError if unreadable.

        Each text is in the list once.
        """
        with _faults_of(self.path):
            encoded = self._column(name).combine_chunks().dictionary_encode()
            return np.asarray(encoded.indices.fill_null(-1).to_numpy(), dtype=np.int64), encoded.dictionary.to_pylist()

    def _column(self, name: str) -> pa.ChunkedArray:
        return read_columns(self.path, [name])[name]


@dataclass(frozen=True)
class FinishedSweep:
    """A finished sweep.

    Attributes:
        manifest: Everything that determines its rows, and `columns`.
        variants: Its table of variants.
        takeovers: Its table of takeovers.
    """

    manifest: Mapping[str, Any]
    variants: SweepTable
    takeovers: SweepTable


def open_sweep(folder: Path) -> FinishedSweep:
    """Return the sweep in a folder.

    Raises:
        SweepError: The folder contains no sweep, or a search, or a sweep that is not finished; or a table is missing or
            cannot be read.
    """
    if not is_sweep(folder):
        raise SweepError(f"{folder} contains no sweep")
    if not (folder / TABLE).is_file():
        raise SweepError(f"{folder} contains an unfinished sweep; `sweep` with --resume finishes it")
    if not (folder / TAKEOVER_TABLE).is_file():
        raise SweepError(f"{folder} is incomplete: it has no {TAKEOVER_TABLE}")
    about, takeovers = _about_variants(folder / TABLE), _about(folder / TAKEOVER_TABLE)
    if "asked" in about:
        raise SweepError(f"{folder} contains a search: all its runs are those of variant 0, with other parameters")
    return FinishedSweep(
        about,
        _sweep_table(folder / TABLE, about.get("columns"), ("variant",)),
        _sweep_table(folder / TAKEOVER_TABLE, takeovers, ("variant", "number")),
    )


def _sweep_table(path: Path, described: Any, integers: Collection[str]) -> SweepTable:
    """Return a table with the columns that its metadata describe; SweepError if the file has others.

    `integers` are the columns of integers that it must have.
    """
    with _faults_of(path), opened_parquet(path) as file:
        rows, schema = file.metadata.num_rows, file.schema_arrow
    try:
        columns = {one["column"]: Column(**one) for one in described}
        sound = schema.equals(schema_of(tuple(columns.values())))
        sound = sound and all(columns[name].kind == "integer" for name in integers)
        texts = all(isinstance(text, str) for one in columns.values() for text in vars(one).values())
    except (TypeError, KeyError):
        sound = texts = False
    if not (sound and texts):
        raise SweepError(f"{path} is not the table of a sweep: it does not describe its columns")
    return SweepTable(path, rows, columns)


def read_results(path: Path) -> tuple[Columns, dict[str, Any]]:
    """Return the rows of a sweep by column, and the file's metadata; SweepError if it has none.

    Args:
        path: The table, or the folder of a finished sweep.
    """
    file = path / TABLE if path.is_dir() else path
    about = _about_variants(file)
    with _faults_of(file):
        columns: Columns = read_columns(file).to_pydict()
    return columns, about


def _about_variants(file: Path) -> dict[str, Any]:
    """Return the metadata of a table of variants; SweepError if it is not one of this version."""
    about = _about(file)
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        raise SweepError(f"{file} is not the table of a sweep")
    return about


def _about(file: Path) -> Any:
    """Return the metadata of a table's file; None if it has none."""
    with _faults_of(file), opened_parquet(file) as opened:
        return json.loads((opened.metadata.metadata or {}).get(KEY, b"null"))


@contextmanager
def _faults_of(file: Path) -> Iterator[None]:
    """Turn faults of a sweep's file into SweepErrors."""
    try:
        yield
    except (OSError, ValueError, pa.ArrowException) as problem:
        raise SweepError(f"{file} is not the table of a sweep: {problem}") from problem
