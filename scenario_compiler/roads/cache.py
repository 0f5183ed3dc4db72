"""The cache of parsed tables, which are used only if they are exactly those that were written.

The name of a cache file is a key made from the road file's contents and the sources of the reader, so that a changed
map or reader never uses an old file. The key is also inside, so that a file under another's name is rejected. The
contents are plain data: the key and a JSON header, the columns as binary numbers, and a SHA-256 digest of all. A file
is written completely or not at all, so that no process reads a partial one, in a folder that belongs to the user alone.
If anything is wrong, the road file is read again.
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

from lxml.etree import LIBXML_VERSION, LXML_VERSION

from scenario_compiler.diagnostics import CODES, Diagnostic, Diagnostics, FilePlace, Severity
from scenario_compiler.files import read_file
from scenario_compiler.forms.arrays import type_code
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.outputs import make_private_folder, write_whole
from scenario_compiler.resources import cache_folder
from scenario_compiler.roads.tables import ParsedNetwork, RoadTables

MAGIC = b"SCROADS3"
DIGEST_SIZE = 32


def read_cached(sha256: str, path: str, sink: Diagnostics) -> ParsedNetwork | None:
    """Return the cached network of a road file with this digest, or None if there is no valid one.

    The findings made when the file was read are reported again, at `path`.
    """
    try:
        file = _cache_file(sha256)
        make_private_folder(file.parent, cache_folder())
        parsed, findings = _decoded(read_file(file), _key(sha256), path)
    except _UNBELIEVABLE:
        return None
    sink.take(findings)
    return parsed


_UNBELIEVABLE = (OSError, RuntimeError, ValueError, KeyError, TypeError, AttributeError, IndexError, struct.error)
"""Exceptions from reading a cache file that is missing, damaged or of another kind."""


def _decoded(raw: bytes, key: str, path: str) -> tuple[ParsedNetwork, list[Diagnostic]]:
    """Return the network in a cache file and the findings made when it was read; ValueError for another file."""
    start = len(MAGIC) + DIGEST_SIZE
    if raw[: len(MAGIC)] != MAGIC or hashlib.sha256(raw[start:]).digest() != raw[len(MAGIC) : start]:
        raise ValueError("it is damaged, or not a file of the cache")
    (size,) = struct.unpack_from("<Q", raw, start)
    start += 8
    head = json.loads(raw[start : start + size])
    if head["key"] != key:
        raise ValueError("it belongs to another road file, or was made by another version")
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
    findings = [
        Diagnostic(CODES[code], message, FilePlace(path, line, at, length, source), hint, Severity(severity))
        for code, severity, message, hint, line, at, length, source in head["findings"]
    ]
    return ParsedNetwork(arrays, head["roads"], head["junctions"]), findings


def write_cached(sha256: str, parsed: ParsedNetwork, findings: Diagnostics) -> None:
    """Write a network to the cache; failures are ignored."""
    columns = {name: getattr(parsed.arrays, name) for name in columns_of(RoadTables)}
    sizes = [(name, len(column)) for name, column in columns.items()]
    rows = [(d.code.id, d.severity.value, d.message, d.hint, *_numbers(d)) for d in findings]
    about = {"key": _key(sha256), "roads": parsed.road_ids, "junctions": parsed.junction_ids}
    head = json.dumps({**about, "columns": sizes, "findings": rows}).encode()
    payload = b"".join((struct.pack("<Q", len(head)), head, *columns.values()))
    with contextlib.suppress(OSError, RuntimeError):
        path = _cache_file(sha256)
        make_private_folder(path.parent, cache_folder())
        if path.is_file() or not path.exists():
            write_whole(path, b"".join((MAGIC, hashlib.sha256(payload).digest(), payload)))


def _numbers(finding: Diagnostic) -> tuple[int, int, int, str]:
    place = finding.place
    return place.line, place.column, place.length, place.source_line


def _cache_file(sha256: str) -> Path:
    return cache_folder() / "roads" / f"{sha256[:32]}-{_reader_version()}.tables"


def _key(sha256: str) -> str:
    return f"{sha256}-{_reader_version()}"


PACKAGE = Path(__file__).parent.parent


def sources() -> list[Path]:
    """Return the modules that can affect the reading of a road file: of this package, the forms and the hall."""
    return sorted(
        path for pattern in ("roads/*.py", "*.py", "structure/*.py", "forms/*.py") for path in PACKAGE.glob(pattern)
    )


@lru_cache(maxsize=1)
def _reader_version() -> str:
    """Return a digest of everything that affects the tables of a road file.

    This is the source of this package, of the forms and of the hall, the version of the XML parser, and the machine's
    number formats.
    """
    machine = f"{sys.byteorder} {array('i').itemsize} {LXML_VERSION} {LIBXML_VERSION}"
    digest = hashlib.blake2b(machine.encode(), digest_size=8)
    for path in sources():
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
