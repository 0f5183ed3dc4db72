"""The only module that prints: lines without control characters, on streams that may be closed or broken.

Text from a file, or a file's name, never reaches a terminal or a log without its control characters escaped (see
`legible`). A reader that closes the pipe is not an error: the rest of the output is thrown away, and the command goes
on to its own exit code. The same holds for messages that cannot be written to stderr; a result that cannot be written
to stdout is an error.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TextIO

from scenario_compiler.legible import legible_line

if TYPE_CHECKING:
    from rich.console import RenderableType


def prepare_streams() -> None:
    """Redirect closed standard streams to the null device, and print characters that an encoding lacks as escapes.

    A file that is opened while a standard stream is closed would get the stream's number, and output would go into it.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, io.TextIOWrapper(io.FileIO(os.devnull, "w"), encoding="utf-8"))
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def put(line: object = "", file: TextIO | None = None) -> None:
    """Print one line to `file`, by default stdout."""
    put_raw(legible_line(str(line)), file)


def tell(line: object) -> None:
    """Print one line on stderr."""
    put(line, sys.stderr)


def complain(line: object) -> None:
    """Print an error message in one line on stderr, with the program's name before it."""
    tell(f"scenario-compiler: {line}")


def put_raw(text: str, file: TextIO | None = None) -> None:
    """Print text whose control characters are escaped already, such as formatted diagnostics."""
    stream = sys.stdout if file is None else file
    with _written(stream):
        print(text, file=stream)


def put_table(headings: Sequence[str], rows: Sequence[Sequence[str]], file: TextIO | None = None) -> None:
    """Print a table to `file`, by default stdout; a table without rows is not printed.

    On a terminal, cells are folded to its width; otherwise each row is one line, so that programs can search it.
    """
    from rich import box
    from rich.table import Column, Table
    from rich.text import Text

    table = Table(*(Column(one, overflow="fold") for one in headings), box=box.SIMPLE_HEAD, pad_edge=False)
    for row in rows:
        table.add_row(*(Text(legible_line(one)) for one in row))
    if rows:
        put_rendered(table, file)


WIDEST = 100_000
"""Width of a line where cells are not folded, characters."""


def put_rendered(shown: RenderableType, file: TextIO | None = None) -> None:
    """Print a renderable of rich, in whose texts control characters are escaped already."""
    from rich.console import Console

    stream = sys.stdout if file is None else file
    console = Console(file=stream, width=None if stream.isatty() else WIDEST)
    with console.capture() as drawn:
        console.print(shown)
    put_raw(drawn.get().removesuffix("\n"), file)


@contextmanager
def shown_progress(what: str) -> Iterator[Callable[[float, float], None] | None]:
    """Yield a function that shows progress, given what is done and the total; None if stderr is not a terminal."""
    if not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(escape(legible_line(what)), total=None)
        yield lambda done, of_all: bar.update(task, completed=done, total=of_all)


def flush_streams() -> None:
    """Write all buffered output.

    Raises:
        OSError: Results cannot be written to stdout, for example because the disk is full.
    """
    with _written(sys.stderr):
        sys.stderr.flush()
    with _written(sys.stdout):
        sys.stdout.flush()


@contextmanager
def _written(stream: TextIO) -> Iterator[None]:
    """Throw away what a stream does not take; raise OSError if that is a result, and not because its reader left."""
    try:
        yield
    except OSError as fault:
        _discard(stream)
        if stream is not sys.stderr and not isinstance(fault, BrokenPipeError):
            raise


def _discard(stream: TextIO) -> None:
    """Send what a stream has buffered, and all later output, to the null device."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
