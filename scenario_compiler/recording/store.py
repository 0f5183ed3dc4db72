"""Recordings as Parquet files: one row for each step and present entity, with entities in document order.

The run's own columns stand in the first row of each step, which is the ego vehicle's if it is present, and are null in
the others. A step at which no entity is present has no row. Codes and roads are written by name.
Header, units, events and the end of the run are JSON in the file's metadata under `scenario-compiler`, first-person
pictures are PNG in base64 under `frame.0`, `frame.1`, ... Equal recordings give equal bytes.
"""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from scenario_compiler.outputs import write_whole
from scenario_compiler.recording.arrow import KEY, arrow_numbers, arrow_texts, opened_parquet
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import CODES
from scenario_compiler.recording.recording import COLUMNS, Column, Frame, Header, Recording

FORMAT = "scenario-compiler/recording/1"
_UNREADABLE = (pa.ArrowException, OSError, KeyError, ValueError, TypeError, AttributeError, IndexError)
"""Exceptions of reading a file that is missing, damaged or of another kind."""


class RecordingError(ValueError):
    """The file is not a readable recording."""


def write_recording(recording: Recording, path: Path) -> None:
    """Write the recording to a Parquet file."""
    present = recording.present
    row, entity = np.nonzero(present)
    first = _begins_step(row)
    arrays: dict[str, Any] = {}
    for column in COLUMNS:
        if column.name == "present":
            continue
        values = getattr(recording, column.name)
        if column.name == "t":
            arrays["t"] = arrow_numbers(values[row])
            arrays["name"] = _named(entity, recording.header.entities)
        elif column.per == "entity":
            arrays[column.name] = _encoded(column, values[present], recording.lists)
        else:
            arrays[column.name] = _encoded(column, values[row], recording.lists, absent=~first)
    table = pa.table(arrays)
    content = pa.BufferOutputStream()
    with pq.ParquetWriter(
        content,
        table.schema,
        version="2.6",
        data_page_version="1.0",
        compression="zstd",
        compression_level=3,
        use_dictionary=True,
        write_statistics=True,
        store_schema=False,
    ) as file:
        file.write_table(table, row_group_size=1 << 16)
        file.add_key_value_metadata(_metadata(recording))
    write_whole(path, content.getvalue().to_pybytes())


def read_recording(path: Path) -> Recording:
    """Read a recording; it equals the written one, except that steps without any entity are missing.

    Raises:
        RecordingError: The file has none.
    """
    try:
        with opened_parquet(path) as file:
            table, metadata = file.read(), file.metadata.metadata or {}
        about = json.loads(metadata.get(KEY, b"{}"))
        if about.get("format") != FORMAT:
            raise RecordingError(f"{path} is not a recording of the format {FORMAT}")
        lacking = sorted({c.name for c in COLUMNS if c.name != "present"} - set(table.column_names))
        if lacking:
            raise RecordingError(f"{path} lacks columns that this version needs ({', '.join(lacking)}); repeat the run")
        return _decoded(table, about, metadata)
    except RecordingError:
        raise
    except _UNREADABLE as problem:
        if isinstance(problem, OSError) and problem.strerror is not None:
            raise RecordingError(f"{path} cannot be read: {problem.strerror}") from problem
        raise RecordingError(f"{path} is not a recording: {problem}") from problem


def _begins_step(steps: NDArray[Any]) -> NDArray[np.bool_]:
    """Return which rows are the first of their step, from the steps' numbers or times, which are the same in a step."""
    return np.append(np.ones(min(1, len(steps)), np.bool_), steps[1:] != steps[:-1])


def _metadata(recording: Recording) -> dict[bytes, bytes]:
    about = {
        "format": FORMAT,
        "columns": {c.name: {"unit": c.unit, "description": c.description} for c in COLUMNS},
        "header": recording.header.model_dump(mode="json"),
        "roads": recording.roads,
        "events": [event.model_dump(mode="json") for event in recording.events],
        "frames": [{"t": frame.t, "label": frame.label} for frame in recording.frames],
        "stop_reason": recording.stop_reason,
        "error": recording.error,
        "trajectory_hash": recording.trajectory_hash,
    }
    pictures = {
        f"frame.{number}".encode(): base64.b64encode(frame.png) for number, frame in enumerate(recording.frames)
    }
    return {KEY: json.dumps(about, sort_keys=True, allow_nan=False).encode(), **pictures}


def _named(codes: NDArray[np.int64], names: tuple[str, ...], absent: NDArray[np.bool_] | None = None) -> pa.Array:
    """Return names for codes, null for codes below 0."""
    missing = (codes < 0) if absent is None else absent | (codes < 0)
    indices = arrow_numbers(codes.astype(np.int32), missing)
    return pa.DictionaryArray.from_arrays(indices, arrow_texts(names)).cast(pa.string())


def _encoded(
    column: Column, values: NDArray[Any], lists: dict[str, tuple[str, ...]], absent: NDArray[np.bool_] | None = None
) -> pa.Array:
    if column.kind in lists:
        return _named(values, lists[column.kind], absent)
    if column.kind in CODES:
        return _named(values, _code_names(column), absent)
    if column.kind == "integer":
        return arrow_numbers(values.astype(np.int32), absent)
    return arrow_numbers(values, absent)


def _code_names(column: Column) -> tuple[str, ...]:
    names = CODES[column.kind]
    return tuple(names.get(code, "") for code in range(max(names) + 1))


def _decoded(table: pa.Table, about: dict[str, Any], metadata: dict[bytes, bytes]) -> Recording:
    header = Header.model_validate(about["header"])
    roads = tuple(about["roads"])
    lists = {"road": roads, "entity": header.entities}
    names = np.array(_codes(table, "name", header.entities))
    first = _begins_step(table["t"].to_numpy())
    row = np.cumsum(first) - 1
    shape = (int(first.sum()), len(header.entities))
    arrays: dict[str, Any] = {}
    for column in COLUMNS:
        if column.per == "run":
            array = np.full(shape[:1], column.nothing, dtype=column.dtype)
            array[:] = _values(table, column, lists)[first]
        else:
            array = np.full(shape, column.nothing, dtype=column.dtype)
            array[row, names] = True if column.name == "present" else _values(table, column, lists)
        array.setflags(write=False)
        arrays[column.name] = array
    frames = tuple(
        Frame(one["t"], one["label"], base64.b64decode(metadata[f"frame.{number}".encode()]))
        for number, one in enumerate(about["frames"])
    )
    events = tuple(EventRow.model_validate(event) for event in about["events"])
    end = {"stop_reason": about["stop_reason"], "error": about["error"]}
    return Recording(header=header, roads=roads, **arrays, events=events, frames=frames, **end)


def _values(table: pa.Table, column: Column, lists: dict[str, tuple[str, ...]]) -> NDArray[Any]:
    if column.kind in lists:
        return _codes(table, column.name, lists[column.kind])
    if column.kind in CODES:
        return _codes(table, column.name, _code_names(column))
    values = table[column.name]
    if column.kind == "flag":
        return np.asarray(values.fill_null(False).to_numpy(zero_copy_only=False), dtype=column.dtype)
    nothing = pa.scalar(column.nothing if column.kind == "float" else int(column.nothing), values.type)
    return np.asarray(values.fill_null(nothing).to_numpy(), dtype=column.dtype)


def _codes(table: pa.Table, name: str, names: tuple[str, ...]) -> NDArray[np.int64]:
    """Return the indices of a column's texts in `names`, -1 for null; KeyError for an unknown text."""
    encoded = table[name].combine_chunks().dictionary_encode()
    numbers = {text: number for number, text in enumerate(names)}
    code = np.array([numbers[text] for text in encoded.dictionary.to_pylist()] + [-1], dtype=np.int64)
    indices = encoded.indices.fill_null(len(code) - 1).to_numpy()
    found: NDArray[np.int64] = code[indices]
    return found
