"""Parsed tables in the user's cache: read back only when they are exactly what was written.

A cache file is named by the road file's content and by this package's own sources, so a changed map or a changed reader
never meets an old file. It is plain data: a JSON head, the columns as machine numbers and a SHA-256 over both. It is
written whole or not at all, so two processes never see half of one. Whatever goes wrong, the road file is read again.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import struct
import sys
from array import array
from functools import lru_cache
from pathlib import Path

from scenario_compiler.diagnostics import CODES, Diagnostic, Diagnostics, FilePlace, Severity
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.resources import cache_folder
from scenario_compiler.roads.tables import FLOAT_COLUMNS, ParsedNetwork, RoadTables

MAGIC = b"SCROADS1"
DIGEST_SIZE = 32


def read_cached(sha256: str, path: str, sink: Diagnostics) -> ParsedNetwork | None:
    """Return the network cached for a road file's content, None where there is none that can be trusted.

    The findings made when the file was read are reported again, at `path`.
    """
    try:
        raw = _cache_file(sha256).read_bytes()
    except (OSError, RuntimeError):
        return None
    start = len(MAGIC) + DIGEST_SIZE
    if raw[: len(MAGIC)] != MAGIC or hashlib.sha256(raw[start:]).digest() != raw[len(MAGIC) : start]:
        return None
    (size,) = struct.unpack_from("<Q", raw, start)
    start += 8
    head = json.loads(raw[start : start + size])
    start += size
    parsed = ParsedNetwork(RoadTables(), head["roads"], head["junctions"])
    for name, kind, count in head["columns"]:
        column = array(kind)
        end = start + count * column.itemsize
        column.frombytes(raw[start:end])
        setattr(parsed.tables, name, column.tolist())
        start = end
    if head["findings"]:
        from scenario_compiler.roads import parse  # noqa: F401  # makes the codes of its findings known
    for code, severity, message, hint, line, at, length, source in head["findings"]:
        place = FilePlace(path, line, at, length, source)
        sink.take((Diagnostic(CODES[code], message, place, hint, Severity(severity)),))
    return parsed


def write_cached(sha256: str, parsed: ParsedNetwork, findings: Diagnostics) -> None:
    """Put a network into the cache; a cache that cannot be written is no fault."""
    columns, blocks = [], []
    for name in RoadTables.__slots__:
        column = _as_array(name, getattr(parsed.tables, name))
        columns.append((name, column.typecode, len(column)))
        blocks.append(column.tobytes())
    rows = [(d.code.id, d.severity.value, d.message, d.hint, *_numbers(d)) for d in findings]
    head = json.dumps(
        {"roads": parsed.road_ids, "junctions": parsed.junction_ids, "columns": columns, "findings": rows}
    ).encode()
    payload = struct.pack("<Q", len(head)) + head + b"".join(blocks)
    with contextlib.suppress(OSError, RuntimeError):
        path = _cache_file(sha256)
        make_folder(path.parent)
        write_whole(path, MAGIC + hashlib.sha256(payload).digest() + payload)


def _numbers(finding: Diagnostic) -> tuple[int, int, int, str]:
    place = finding.place
    return place.line, place.column, place.length, place.source_line


def _as_array(name: str, values: list[float] | list[int]) -> array[float] | array[int]:
    if name in FLOAT_COLUMNS:
        return array("d", values)
    try:
        return array("i", [int(v) for v in values])
    except OverflowError:
        return array("q", [int(v) for v in values])


def _cache_file(sha256: str) -> Path:
    return cache_folder() / "roads" / f"{sha256[:32]}-{_reader_version()}.tables"


@lru_cache(maxsize=1)
def _reader_version() -> str:
    """Return a digest of what turns a road file into tables: this package's sources and the machine's number format."""
    digest = hashlib.sha256(f"{sys.byteorder} {array('i').itemsize}".encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
