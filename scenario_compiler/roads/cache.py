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

from scenario_compiler import forms
from scenario_compiler.diagnostics import CODES, Diagnostic, Diagnostics, FilePlace, Severity
from scenario_compiler.forms.arrays import type_code
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.outputs import make_folder, write_whole
from scenario_compiler.resources import cache_folder
from scenario_compiler.roads.tables import ParsedNetwork, RoadTables

MAGIC = b"SCROADS3"
DIGEST_SIZE = 32


def read_cached(sha256: str, path: str, sink: Diagnostics) -> ParsedNetwork | None:
    """Return the network cached for a road file's content, None where there is none that can be trusted.

    The findings made when the file was read are reported again, at `path`.
    """
    try:
        raw = memoryview(_cache_file(sha256).read_bytes())
    except (OSError, RuntimeError):
        return None
    start = len(MAGIC) + DIGEST_SIZE
    if raw[: len(MAGIC)] != MAGIC or hashlib.sha256(raw[start:]).digest() != raw[len(MAGIC) : start]:
        return None
    (size,) = struct.unpack_from("<Q", raw, start)
    start += 8
    head = json.loads(bytes(raw[start : start + size]))
    start += size
    arrays = object.__new__(RoadTables)
    for name, count in head["columns"]:
        column = array(type_code(RoadTables, name))
        end = start + count * column.itemsize
        column.frombytes(raw[start:end])
        setattr(arrays, name, column)
        start = end
    if head["findings"]:
        from scenario_compiler.roads import parse  # noqa: F401  # makes the codes of its findings known
    for code, severity, message, hint, line, at, length, source in head["findings"]:
        place = FilePlace(path, line, at, length, source)
        sink.found.append(Diagnostic(CODES[code], message, place, hint, Severity(severity)))
    return ParsedNetwork(arrays, head["roads"], head["junctions"])


def write_cached(sha256: str, parsed: ParsedNetwork, findings: Diagnostics) -> None:
    """Put a network into the cache; a cache that cannot be written is no fault."""
    columns = {name: getattr(parsed.arrays, name) for name in columns_of(RoadTables)}
    sizes = [(name, len(column)) for name, column in columns.items()]
    rows = [(d.code.id, d.severity.value, d.message, d.hint, *_numbers(d)) for d in findings]
    head = json.dumps(
        {"roads": parsed.road_ids, "junctions": parsed.junction_ids, "columns": sizes, "findings": rows}
    ).encode()
    payload = b"".join((struct.pack("<Q", len(head)), head, *columns.values()))
    with contextlib.suppress(OSError, RuntimeError):
        path = _cache_file(sha256)
        make_folder(path.parent)
        write_whole(path, b"".join((MAGIC, hashlib.sha256(payload).digest(), payload)))


def _numbers(finding: Diagnostic) -> tuple[int, int, int, str]:
    place = finding.place
    return place.line, place.column, place.length, place.source_line


def _cache_file(sha256: str) -> Path:
    return cache_folder() / "roads" / f"{sha256[:32]}-{_reader_version()}.tables"


@lru_cache(maxsize=1)
def _reader_version() -> str:
    """Return a digest of what turns a road file into tables: the sources that do, and the machine's number format."""
    digest = hashlib.sha256(sys.byteorder.encode())
    folders = (Path(__file__).parent, Path(forms.__file__).parent)
    for path in sorted(path for folder in folders for path in folder.glob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:16]
