"""Makes Arrow columns from bytes and opens Parquet files, for the tables of recordings and sweeps.

`pyarrow.array` would import pandas if it is installed, which takes longer than a thousand variants of a sweep.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from scenario_compiler.files import opened_file

KEY = b"scenario-compiler"
"""Key of the metadata in which a table describes itself, as JSON."""


@contextmanager
def opened_parquet(path: Path, **options: Any) -> Iterator[pq.ParquetFile]:
    """Open a Parquet file; pyarrow itself opens only names in UTF-8, and waits for the other end of a pipe.

    Raises:
        OSError: The file is missing, cannot be opened, or is not an ordinary file.
        ArrowException: It is not a Parquet file.
    """
    with opened_file(path) as content, pq.ParquetFile(content, **options) as file:
        yield file


def arrow_numbers(values: NDArray[Any], absent: NDArray[np.bool_] | None = None) -> pa.Array:
    """Return numbers or truth values (n) as a column of the same type, null if `absent` (n) is true; NaN stays."""
    if values.dtype == np.bool_:
        kind, content = pa.bool_(), np.packbits(values, bitorder="little")
    else:
        kind, content = pa.from_numpy_dtype(values.dtype), np.ascontiguousarray(values)
    return pa.Array.from_buffers(kind, len(values), [_validity(absent), pa.py_buffer(content)])


def arrow_texts(texts: Sequence[str], absent: NDArray[np.bool_] | None = None) -> pa.Array:
    """Return texts (n) as a column, null if `absent` (n) is true; bytes of names that are not UTF-8 become escapes."""
    encoded = [text.encode(errors="backslashreplace") for text in texts]
    ends = np.zeros(len(encoded) + 1, dtype=np.int32)
    np.cumsum([len(text) for text in encoded], out=ends[1:])
    content = [pa.py_buffer(ends), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(encoded), [_validity(absent), *content])


def _validity(absent: NDArray[np.bool_] | None) -> pa.Buffer | None:
    """Return the bitmap of the values that are not null; None if all are."""
    if absent is None or not absent.any():
        return None
    return pa.py_buffer(np.packbits(~absent, bitorder="little"))
