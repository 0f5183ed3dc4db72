"""Files and folders out: whole or not there.

What cannot be written is an OSError that names the file and says why, for the command line to tell in one line.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

from scenario_compiler.interruption import put_off


def write_whole(path: str | Path, content: bytes | str) -> None:
    """Write a file that is whole or not there; text as UTF-8 with the line ends that it has. See `whole_file`."""
    with whole_file(path) as file:
        file.write(content.encode() if isinstance(content, str) else content)


@contextlib.contextmanager
def whole_file(path: str | Path) -> Iterator[BinaryIO]:
    """Open a file that is whole or not there when it is closed, also when the machine stops.

    The content goes to a draft beside the file, which then takes its place; who else writes the file at that time has a
    draft of its own. A device or pipe is written to as it is.

    Raises:
        OSError: It cannot be written; nothing of it is left, and what was there before is as it was.
    """
    try:
        given = Path(path)
        special = given.exists() and not given.is_file()
        with given.open("wb") if special else _draft_of(given.resolve()) as file:
            yield file
    except OSError as fault:
        raise _cannot(path, fault) from None


def make_folder(path: str | Path) -> None:
    """Make a folder and those above it where there are none; OSError where that cannot be."""
    try:
        Path(path).mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise _cannot(path, fault) from None


@contextlib.contextmanager
def whole_folder(path: str | Path) -> Iterator[Path]:
    """Yield an empty folder whose files all come to stand in the folder `path` when it is closed, or none of them.

    What was there before under other names stays. A folder that is made for it is gone again where that fails.

    Raises:
        OSError: It cannot be written.
    """
    target = Path(path)
    missing = [one for one in (target, *target.parents) if not one.exists()]
    make_folder(target)
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
