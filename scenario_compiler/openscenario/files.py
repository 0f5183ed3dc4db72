"""Reads files of OpenSCENARIO, tolerating common faults, and finds the files that they name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path, PureWindowsPath

from scenario_compiler.diagnostics import Diagnostics, Place
from scenario_compiler.document import MALFORMED, Document, parse_document, read_document
from scenario_compiler.files import SCENARIO_BYTES, read_file
from scenario_compiler.openscenario.codes import MENDED_COMMENT, UNKNOWN_VERSION

VERSIONS = ((1, 0), (1, 1), (1, 2), (1, 3))
"""Versions of OpenSCENARIO XML that are read."""


def read_forgiving(path: str | Path, sink: Diagnostics) -> Document | None:
    """Read a file as `read_document` does; comments that contain two hyphens are corrected, with a warning."""
    attempt = Diagnostics()
    document = read_document(path, attempt)
    if document is None and any(one.code is MALFORMED for one in attempt.found):
        raw = _read_again(path)
        mended = b"".join(_mended(raw))
        again = Diagnostics()
        document = None if mended == raw else parse_document(mended, str(path), again)
        if document is not None:
            sink.add(MENDED_COMMENT, "a comment holds '--'", attempt.found[0].place)
            sink.absorb(again)
            return document
    sink.absorb(attempt)
    return document


def _read_again(path: str | Path) -> bytes:
    """Return the contents of a file that was read before; empty if the file no longer exists."""
    try:
        return read_file(path, SCENARIO_BYTES)
    except OSError:
        return b""


def _mended(raw: bytes) -> Iterator[bytes]:
    """Yield the pieces of a file with corrected comments; a comment without an end is unchanged."""
    at = 0
    while (begin := raw.find(b"<!--", at)) >= 0 and (end := raw.find(b"-->", begin + 4)) >= 0:
        yield raw[at : begin + 4]
        yield _without_hyphens(raw[begin + 4 : end])
        at = end
    yield raw[at:]


def _without_hyphens(comment: bytes) -> bytes:
    mended = re.sub(rb"-(?=-)", b" ", comment)
    return mended[:-1] + b" " if mended.endswith(b"-") else mended


def beside(folder: Path, written: str) -> list[Path]:
    """Return the paths at which a path in a file is looked for: the whole path first, then its bare name."""
    path = Path(PureWindowsPath(written).as_posix() if "\\" in written else written)
    return list(dict.fromkeys([folder / path, folder / path.name])) if written.strip() else []


def read_version(major: str, minor: str, place: Place, sink: Diagnostics) -> tuple[int, int]:
    """Return the version in a header, or the nearest existing one with a warning."""
    named = (int(major), int(minor)) if major.isdecimal() and minor.isdecimal() and len(major + minor) < 9 else None
    if named in VERSIONS:
        return named
    nearest = VERSIONS[-1] if named is None or named > VERSIONS[-1] else VERSIONS[0]
    message = f"there is no version '{major}.{minor}'; the file is read as {nearest[0]}.{nearest[1]}"
    sink.add(UNKNOWN_VERSION, message, place)
    return nearest
