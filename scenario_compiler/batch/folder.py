"""The names of the files in the folder of a sweep."""

from __future__ import annotations

from pathlib import Path

MANIFEST = "sweep.json"
LOCK = "sweep.lock"
TABLE = "results.parquet"
TAKEOVER_TABLE = "takeovers.parquet"
CODEBOOK = "codebook.csv"
PARTS = "parts"


def is_sweep(path: Path) -> bool:
    """Return whether a path is the folder of a sweep or of a search, finished or not."""
    return any((path / name).is_file() for name in (MANIFEST, TABLE))
