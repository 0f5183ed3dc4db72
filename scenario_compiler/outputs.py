"""Writes files and folders as a whole or not at all.

If something cannot be written, an OSError has the file and the reason, which the command line prints in one line.
"""

from __future__ import annotations

import contextlib
import errno
import os
import shutil
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from scenario_compiler.interruption import put_off


def write_whole(path: str | Path, content: bytes | str) -> None:
    """Write a file as a whole or not at all. See `whole_file`.

    Text is written in UTF-8, with unchanged line ends. A byte of a file's name that is not UTF-8 becomes an escape.
    """
    with whole_file(path) as file:
        file.write(content.encode(errors="backslashreplace") if isinstance(content, str) else content)


@contextlib.contextmanager
def whole_file(path: str | Path) -> Iterator[BinaryIO]:
    """Open a file for writing; afterwards it is complete or unchanged, even if the machine stops.

    The content is written to a draft beside the file, which then replaces the file. A process that writes the same file
    at that time has a draft of its own. Devices and pipes are written to directly.

    Raises:
        OSError: The file cannot be written; the draft is removed, and an existing file is unchanged.
    """
    try:
        given = Path(path)
        special = given.exists() and not given.is_file()
        with given.open("wb") if special else _draft_of(given.resolve()) as file:
            yield file
    except OSError as fault:
        raise _cannot(path, fault) from None


def make_private_folder(path: Path, within: Path) -> None:
    """Make a folder that only the user can open, and the folders above it up to `within`.

    Raises:
        OSError: One of them cannot be made, or belongs to somebody else.
    """
    folders = [within, *reversed([one for one in (path, *path.parents) if within in one.parents])]
    make_folder(within.parent)
    for folder in folders:
        with contextlib.suppress(FileExistsError):
            folder.mkdir(mode=0o700)
        status = folder.stat()
        if not (_is_own(status) and _is_own(folder.lstat())):
            raise PermissionError(errno.EPERM, "it belongs to another user", str(folder))
        if status.st_mode & 0o077:
            folder.chmod(0o700)


def _is_own(status: os.stat_result) -> bool:
    return not hasattr(os, "geteuid") or status.st_uid == os.geteuid()


def make_folder(path: str | Path) -> None:
    """Make a folder and missing parents; raise OSError if that fails."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise NotADirectoryError(errno.ENOTDIR, "cannot be written: it is a file, not a folder", str(path)) from None
    except OSError as fault:
        raise _cannot(path, fault) from None


class LockedError(Exception):
    """Another process holds a lock; the message names it in brackets, to follow the name of the locked thing."""


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock while the context is open: a file that no other process has locked, and that is deleted at the end.

    The system releases the lock if this process dies, so a lock is never stale.

    Raises:
        LockedError: Another process holds it.
        OSError: It cannot be written.
    """
    try:
        file = _held(path)
    except OSError as fault:
        raise _cannot(path, fault) from None
    try:
        file.truncate(0)
        file.write(str(os.getpid()).encode())
        file.flush()
        yield
    finally:
        with contextlib.suppress(OSError):
            path.unlink()
        file.close()


def _held(path: Path) -> BinaryIO:
    """Return the lock's file, opened and locked; if its holder deletes it meanwhile, it is made again."""
    while True:
        file = path.open("a+b")
        if not _lock(file):
            file.seek(0)
            holder = file.read(20).decode("ascii", "replace").strip()
            file.close()
            raise LockedError(f" (process {holder})" if holder.isdecimal() else "")
        with contextlib.suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                return file
        file.close()


def _lock(file: BinaryIO) -> bool:
    """Lock an open file; return False if another process has locked it."""
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    return True


@contextlib.contextmanager
def whole_folder(path: str | Path) -> Iterator[Path]:
    """Yield an empty folder; at the end of the context, all of its files are moved into the folder `path`, or none.

    Files with other names stay there. If that fails, folders that were made for it are removed.

    Raises:
        OSError: It cannot be written.
    """
    target = Path(path).absolute()  # code of the user's may change the current folder meanwhile
    missing = [one for one in (target, *target.parents) if not one.exists()]
    make_folder(path)
    draft = target / f".{os.getpid()}-{threading.get_ident()}.tmp"
    try:
        make_folder(draft)
        yield draft
        with put_off():
            for file in sorted(draft.iterdir()):
                file.replace(target / file.name)
            draft.rmdir()
    except BaseException:
        shutil.rmtree(draft, ignore_errors=True)
        for one in missing:
            with contextlib.suppress(OSError):
                one.rmdir()
        raise


@contextlib.contextmanager
def _draft_of(target: Path) -> Iterator[BinaryIO]:
    draft = target.with_name(f"{target.name}.{os.getpid()}-{threading.get_ident()}.tmp")
    try:
        with draft.open("wb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        draft.replace(target)
    except BaseException:
        with contextlib.suppress(OSError):
            draft.unlink()
        raise


def _cannot(path: str | Path, fault: OSError) -> OSError:
    return OSError(fault.errno, f"cannot be written: {fault.strerror}", str(path))
