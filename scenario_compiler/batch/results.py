"""The table of a sweep as Parquet, with one row for each variant, written in parts as a whole or not at all.

A part goes to a temporary file that is moved into place, so that whatever ends a sweep leaves what was finished. When
all parts are there they become `results.parquet`. A manifest says which sweep the folder belongs to. Equal sweeps give
equal bytes.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from scenario_compiler.batch.codebook import (
    Column,
    ColumnKind,
    codebook_text,
    result_columns,
    takeover_columns,
)
from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.folder import CODEBOOK, LOCK, MANIFEST, PARTS, TABLE, TAKEOVER_TABLE
from scenario_compiler.batch.measuring import TAKEOVERS, Columns
from scenario_compiler.batch.tally import TALLIED, Tally
from scenario_compiler.outputs import LockedError, locked, make_folder, whole_file, write_whole
from scenario_compiler.recording.arrow import KEY, arrow_numbers, arrow_texts, opened_parquet
from scenario_compiler.recording.break_off import equal_reasons

FORMAT = "scenario-compiler/sweep/1"
GROUP = 1 << 16
"""Least number of rows in a row group of the table; a part is never split."""

_TYPES: dict[ColumnKind, pa.DataType] = {
    "integer": pa.int64(),
    "number": pa.float64(),
    "boolean": pa.bool_(),
    "text": pa.string(),
}


def schema_of(columns: Sequence[Column]) -> pa.Schema:
    """Return the Arrow schema of a table's columns."""
    return pa.schema({one.column: _TYPES[one.kind] for one in columns})


_NAMES = {
    "allowed": "--allow",
    "asked": "what is searched for",
    "digest": "the plan",
    "errors": "--error",
    "format": "the format of its files",
    "interpreted": "the form of the engine",
    "part_size": "the size of its parts",
    "settings": "--set",
    "step": "--dt",
    "target": "the scenario's file",
    "variants": "the number of variants",
    "version": "the version of scenario-compiler",
}
"""What messages call the parts of a manifest; the others are options of the command."""

_TAKEOVER = list(schema_of(takeover_columns()))[1:]
"""The fields of a takeover in the parts, where they belong to the row of their variant."""


def tally_of(table: Path) -> Tally:
    """Return the counts of results in a sweep's table or in a part of it."""
    found = read_columns(table, list(TALLIED))
    return Tally.of(*(found[name].to_pylist() for name in TALLIED))


class ResultStore:
    """The folder of a sweep."""

    def __init__(self, folder: Path, parameters: Sequence[Column], manifest: Mapping[str, Any]) -> None:
        """Set the folder of a sweep; nothing is written.

        Args:
            folder: The folder.
            parameters: The columns of the parameters that vary.
            manifest: Everything that determines the rows; a folder with another manifest belongs to another sweep.
        """
        self.folder = folder
        self.table = folder / TABLE
        self._takeovers = folder / TAKEOVER_TABLE
        self._parts = folder / PARTS
        self._columns = result_columns(parameters)
        self._schema = schema_of(self._columns)
        self._part_schema = self._schema.append(pa.field(TAKEOVERS, pa.list_(pa.struct(_TAKEOVER))))
        self._manifest = {"format": FORMAT, **manifest}

    def open(self, *, resume: bool) -> None:
        """Begin or continue the sweep; raises as `check` and `begin` do."""
        self.check(resume=resume)
        self.begin()

    def check(self, *, resume: bool) -> None:
        """Check that the sweep may begin or resume; nothing is written.

        Raises:
            SweepError: There is another sweep in the folder, or the same one without `resume`, or other files.
        """
        path = self.folder / MANIFEST
        if path.is_file():
            if not resume:
                raise SweepError(f"{self.folder} contains a sweep already; --resume continues it")
            try:
                found = json.loads(path.read_text(encoding="utf-8"))
            except ValueError:
                found = None
            if found != self._manifest:
                raise SweepError(f"{self.folder} holds another sweep: {_difference(found, self._manifest)}")
        elif self.folder.is_dir() and any(self.folder.iterdir()) and not self._unfinished_start():
            raise SweepError(f"{self.folder} is not empty and contains no sweep")

    @contextmanager
    def owned(self) -> Iterator[None]:
        """Keep other sweeps out of the folder while this one writes to it.

        Raises:
            SweepError: Another sweep is writing to it, or this one may not begin or resume (see `check`).
            OSError: The folder cannot be written.
        """
        make_folder(self.folder)
        try:
            with locked(self.folder / LOCK):
                yield
        except LockedError as taken:
            raise SweepError(f"another sweep is writing into {self.folder}{taken}") from None
        finally:
            with suppress(OSError):  # a sweep that did not begin leaves no folder
                self.folder.rmdir()

    def begin(self) -> None:
        """Make the folder the sweep's own, unless the sweep is finished; OSError when it cannot be written."""
        if self.finished:
            return
        make_folder(self._parts)
        write_whole(self.folder / MANIFEST, (json.dumps(self._manifest, indent=1, sort_keys=True) + "\n").encode())

    def _unfinished_start(self) -> bool:
        return all(path.name in (PARTS, LOCK) or path.suffix == ".tmp" for path in self.folder.iterdir())

    @property
    def finished(self) -> bool:
        """Whether the tables exist."""
        return self.table.is_file() and self._takeovers.is_file()

    def drop_damaged(self) -> list[Path]:
        """Delete the tables and the parts that cannot be read back whole, so that they are made again; return them.

        What a process that was killed was writing or deleting is deleted too.
        """
        for left in list(self.folder.glob("**/*.tmp")):
            if left.is_dir():
                shutil.rmtree(left)
            else:
                left.unlink()
        files = [self.table, self._takeovers] if self.finished else sorted(self._parts.glob("*.parquet"))
        damaged = [path for path in files if not self._is_sound(path)]
        for path in damaged:
            path.unlink()
        if self.finished:
            shutil.rmtree(self._parts, ignore_errors=True)
        return damaged

    def _is_sound(self, path: Path) -> bool:
        """Return whether a file can be read to its end, with the columns of this sweep and its pages' checksums.

        The metadata of the two tables, which state what they are written with, must be those of this sweep too.
        """
        schema, wanted = {
            self.table: (self._schema, self._about()),
            self._takeovers: (schema_of(takeover_columns()), _about_takeovers()),
        }.get(path, (self._part_schema, b""))
        try:
            with opened_parquet(path, page_checksum_verification=True) as file:
                about = (file.metadata.metadata or {}).get(KEY, b"")
                if not file.schema_arrow.equals(schema) or about != wanted:
                    return False
                rows = sum(file.read_row_group(number).num_rows for number in range(file.num_row_groups))
                return bool(rows == file.metadata.num_rows)
        except (OSError, ValueError, pa.ArrowException):
            return False

    def done(self) -> set[int]:
        """Return the numbers of the parts that exist."""
        return {int(path.stem) for path in self._parts.glob("*.parquet") if path.stem.isdecimal()}

    def write_part(self, number: int, columns: Columns) -> None:
        """Write the rows of a part; OSError if there is no room, and then no file is left."""
        table = table_of(columns, self._part_schema)
        sink = pa.BufferOutputStream()
        with _writer(sink, self._part_schema, lasting=False) as file:
            file.write_table(table)
        write_whole(self._part(number), sink.getvalue().to_pybytes())

    def part_columns(self, number: int) -> Columns:
        """Return the rows of a part."""
        columns: Columns = read_columns(self._part(number)).to_pydict()
        return columns

    def tally(self, number: int) -> Tally:
        """Return the counts of results in a part."""
        return tally_of(self._part(number))

    def errors(self) -> list[tuple[str, int, int]]:
        """Return the errors in the table's rows, as `equal_reasons` does."""
        with opened_parquet(self.table) as file:
            groups = (file.read_row_group(k, columns=["error"]) for k in range(file.num_row_groups))
            every = enumerate(error for group in groups for error in group["error"].to_pylist())
            return equal_reasons((variant, error) for variant, error in every if error)

    def merge(self, parts: int) -> None:
        """Write the codebook; write the tables from all parts, in order, and delete the parts, unless this was done."""
        columns = takeover_columns()
        write_whole(self.folder / CODEBOOK, codebook_text({TABLE: self._columns, TAKEOVER_TABLE: columns}))
        if self.finished:
            return
        schema = schema_of(columns)
        with (
            whole_file(self.table) as sink,
            whole_file(self._takeovers) as beside,
            _writer(sink, self._schema) as file,
            _writer(beside, schema) as takeovers,
        ):
            for tables in self._grouped(parts):
                whole = pa.concat_tables(tables)
                takeovers.write_table(_takeovers_in(whole, schema))
                file.write_table(whole.drop_columns([TAKEOVERS]))
            file.add_key_value_metadata({KEY: self._about()})
            takeovers.add_key_value_metadata({KEY: _about_takeovers()})
        for number in range(parts):
            self._part(number).unlink()
        self._parts.rmdir()

    def _grouped(self, parts: int) -> Iterator[list[pa.Table]]:
        tables: list[pa.Table] = []
        for number in range(parts):
            tables.append(read_columns(self._part(number)))
            if sum(table.num_rows for table in tables) >= GROUP:
                yield tables
                tables = []
        if tables or not parts:
            yield tables or [self._part_schema.empty_table()]

    def _about(self) -> bytes:
        """Return the metadata of the table as JSON."""
        return json.dumps({**self._manifest, "columns": [vars(one) for one in self._columns]}, sort_keys=True).encode()

    def _part(self, number: int) -> Path:
        return self._parts / f"{number:08}.parquet"


def _about_takeovers() -> bytes:
    """Return the metadata of the table of takeovers as JSON."""
    return json.dumps([vars(one) for one in takeover_columns()]).encode()


def table_of(columns: Columns, schema: pa.Schema) -> pa.Table:
    """Return rows by column as a table; a missing value is None."""
    return pa.table([arrow_array(columns[field.name], field.type) for field in schema], schema=schema)


def _takeovers_in(rows: pa.Table, schema: pa.Schema) -> pa.Table:
    """Return the takeovers of runs, one row each, in the order of the runs."""
    takeovers = rows[TAKEOVERS].combine_chunks()
    counts = np.diff(np.from_dlpack(takeovers.offsets))
    variants = np.repeat(np.from_dlpack(rows["variant"].combine_chunks()), counts)
    return pa.table([arrow_numbers(variants), *takeovers.values.flatten()], schema=schema)


def arrow_array(values: Sequence[Any], kind: pa.DataType) -> pa.Array:
    """Return values, with None for missing ones, as a column of a type of the table; rows of a list are tuples."""
    if pa.types.is_list(kind):
        fields = list(kind.value_type)
        rows = [one for some in values for one in some]
        columns = zip(*rows, strict=True) if rows else [()] * len(fields)
        found = [arrow_array(column, field.type) for column, field in zip(columns, fields, strict=True)]
        ends = arrow_numbers(np.cumsum([0, *map(len, values)], dtype=np.int32))
        return pa.ListArray.from_arrays(ends, pa.StructArray.from_arrays(found, fields=fields))
    absent = np.array([value is None for value in values], dtype=bool) if None in values else None
    if pa.types.is_string(kind):
        return arrow_texts(values if absent is None else ["" if value is None else value for value in values], absent)
    present = values if absent is None else [0 if value is None else value for value in values]
    return arrow_numbers(np.array(present, dtype=np.dtype(kind.to_pandas_dtype())), absent)


def read_columns(path: Path, columns: list[str] | None = None) -> pa.Table:
    """Return the columns of a table, by default all; raises as `opened_parquet` does."""
    with opened_parquet(path) as file:
        return file.read(columns=columns, use_threads=False)


def _writer(sink: Any, schema: pa.Schema, *, lasting: bool = True) -> pq.ParquetWriter:
    """Return a writer; a file that does not last is read once and then deleted, so it is not compressed.

    It has checksums nevertheless, because a sweep may be interrupted before it is read. Only texts have dictionaries:
    with a dictionary of numbers, which are seldom equal, a table takes twice the time to write, and a tenth more room.
    """
    return pq.ParquetWriter(
        sink,
        schema,
        version="2.6",
        data_page_version="1.0",
        compression="zstd" if lasting else "none",
        compression_level=3 if lasting else None,
        use_dictionary=[field.name for field in schema if lasting and pa.types.is_string(field.type)],
        write_statistics=lasting,
        store_schema=False,
        write_page_checksum=True,
    )


def _difference(found: Any, wanted: Mapping[str, Any]) -> str:
    if not isinstance(found, dict):
        return "its manifest cannot be read"
    before, now = _by_option(found), _by_option(wanted)
    changed = (key for key in {*before, *now} if before.get(key) != now.get(key))
    return f"it differs in {', '.join(sorted(_NAMES.get(key, f'--{key}') for key in changed))}"


def _by_option(manifest: Mapping[str, Any]) -> dict[str, Any]:
    """Return what a manifest contains, with each option of the sweep by itself."""
    options = manifest.get("spec")
    return {**manifest, "spec": None, **(options if isinstance(options, dict) else {})}
