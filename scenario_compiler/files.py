"""Reads ordinary files only, and never more bytes than a limit.

A pipe or a device may never end, so neither is read; and the size that the system states for a file is not relied on. A
fault is an OSError, whose `strerror` describes it to the author.
"""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import BinaryIO

MAX_BYTES = 512 * 1024 * 1024
"""Largest file that is read, bytes; a bound on memory, far above any real road file (the largest known has 60 MB)."""

SCENARIO_BYTES = 16 * 1024 * 1024
"""Largest scenario file that is read, bytes; the largest of the library has 10 kB, of the corpus 1.5 MB."""

_PIECE = 1024 * 1024
_AT_ONCE = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)

_UNSAVED: ContextVar[Mapping[str, bytes] | None] = ContextVar("unsaved", default=None)
"""Contents that replace those of files, by the real paths of the files."""


@contextmanager
def unsaved(contents: Mapping[str, bytes]) -> Iterator[None]:
    """Let `read_file` return unsaved contents of an editor, by the files' real paths, while the context is open."""
    token = _UNSAVED.set(contents)
    try:
        yield
    finally:
        _UNSAVED.reset(token)


def is_file(path: Path) -> bool:
    """Return whether a path is a file; a path that the system does not accept is not."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """Return whether a path is a folder; a path that the system does not accept is not."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def suffix_of(path: str | Path) -> str:
    """Return a path's suffix in small letters: files of other systems may end in .XOSC."""
    return Path(path).suffix.lower()


def is_plan_file(path: str | Path) -> bool:
    """Return whether a path is that of a compiled plan by its suffix."""
    return suffix_of(path) == ".json"


def files_in(folder: Path, *suffixes: str, deep: bool = False) -> list[Path]:
    """Return the paths in a folder that have one of the suffixes, which are in small letters, sorted.

    Anything with such a name is included: reading it reports the fault. With `deep`, subfolders are searched too.
    """
    return sorted(path for path in (folder.rglob("*") if deep else folder.glob("*")) if suffix_of(path) in suffixes)


def split_target(target: str | Path) -> tuple[str, str | None]:
    """Split FILE#name into the file and the scenario's name, each of which may contain a '#' itself.

    The file is the longest part of the target that is the path of a file. If there is no such file, the last '#'
    separates the two.
    """
    text = str(target)
    if "#" not in text or is_file(Path(text)):
        return text, None
    splits = [(text[:at], text[at + 1 :]) for at in range(len(text) - 1, -1, -1) if text[at] == "#"]
    return next((split for split in splits if is_file(Path(split[0]))), splits[0])


def read_file(path: str | Path, limit: int = MAX_BYTES) -> bytes:
    """Return the content of an ordinary file, or its unsaved content (see `unsaved`).

    Args:
        path: The file.
        limit: Greatest size of the file, bytes.

    Raises:
        OSError: The file is missing, cannot be opened, is not an ordinary file, or is too large.
        ValueError: No file can have such a name.
    """
    standing_in = _UNSAVED.get()
    if standing_in is not None and (held := standing_in.get(os.path.realpath(path))) is not None:
        return held
    with opened_file(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > limit:
            raise OSError(errno.EFBIG, f"it has {size} bytes; at most {limit} are read")
        return _content(file.fileno(), size, limit)


@contextmanager
def opened_file(path: str | Path) -> Iterator[BinaryIO]:
    """Open an ordinary file for reading while the context is open.

    The kind of the file is read from the opened file, which nobody can replace any more. A pipe is opened without
    waiting for its other end.

    Raises:
        OSError: The file is missing, cannot be opened, or is not an ordinary file.
        ValueError: No file can have such a name.
    """
    handle = os.open(path, os.O_RDONLY | _AT_ONCE)
    try:
        kind = os.fstat(handle).st_mode
        if stat.S_ISDIR(kind):
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        if not stat.S_ISREG(kind):
            raise OSError(errno.EINVAL, "it is a pipe, a socket or a device")
        with os.fdopen(handle, "rb", closefd=False) as file:
            yield file
    finally:
        os.close(handle)


def _content(handle: int, size: int, limit: int) -> bytes:
    """Return the content of an open file; `size` is the size that the system states.

    The memory that a read may fill is reserved before, so no read asks for much more than is still to come.
    """
    pieces, left = [], limit + 1
    while left > 0 and (piece := os.read(handle, min(left, max(_PIECE, size + 1)))):
        pieces.append(piece)
        left -= len(piece)
        size -= len(piece)
    if left <= 0:
        raise OSError(errno.EFBIG, f"it is longer than {limit} bytes; the rest is not read")
    return b"".join(pieces)
