"""Makes Arrow columns from bytes, for the tables of recordings and sweeps.

`pyarrow.array` would import pandas if it is installed, which takes longer than a thousand variants of a sweep.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray


def arrow_numbers(values: NDArray[Any], absent: NDArray[np.bool_] | None = None) -> pa.Array:
    """Return numbers or truth values (n) as a column of the same type, null if `absent` (n) is true; NaN stays."""
    if values.dtype == np.bool_:
        kind, content = pa.bool_(), np.packbits(values, bitorder="little")
    else:
        kind, content = pa.from_numpy_dtype(values.dtype), np.ascontiguousarray(values)
    return pa.Array.from_buffers(kind, len(values), [_validity(absent), pa.py_buffer(content)])


def arrow_texts(texts: Sequence[str], absent: NDArray[np.bool_] | None = None) -> pa.Array:
    """Return texts (n) as a column, null if `absent` (n) is true."""
    encoded = [text.encode() for text in texts]
    ends = np.zeros(len(encoded) + 1, dtype=np.int32)
    np.cumsum([len(text) for text in encoded], out=ends[1:])
    content = [pa.py_buffer(ends), pa.py_buffer(b"".join(encoded))]
    return pa.Array.from_buffers(pa.string(), len(encoded), [_validity(absent), *content])


def _validity(absent: NDArray[np.bool_] | None) -> pa.Buffer | None:
    """Return the bitmap of the values that are not null; None if all are."""
    if absent is None or not absent.any():
        return None
    return pa.py_buffer(np.packbits(~absent, bitorder="little"))
