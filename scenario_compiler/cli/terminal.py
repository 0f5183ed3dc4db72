"""The one place that prints: lines that can be read, on streams that may be closed or broken.

Nothing that a file or its name holds reaches a terminal or a log raw (see `legible`). That nobody reads what is printed
is no fault: what is left is thrown away, and the command goes on to its own exit code.
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
    """Open what is closed of the standard streams, to nowhere, and let them print what their encoding lacks as escapes.

    A file that is opened while one of them is closed would get its number, and what is printed would go there.
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
    """Print one line, on stdout without a `file`."""
    put_raw(legible_line(str(line)), file)


def tell(line: object) -> None:
    """Print one line on stderr."""
    put(line, sys.stderr)


def complain(line: object) -> None:
    """Print one line on stderr that says what is wrong, with the program's name before it."""
    tell(f"scenario-compiler: {line}")


def put_raw(text: str, file: TextIO | None = None) -> None:
    """Print text that is legible already, such as diagnostics in one of their formats."""
    stream = sys.stdout if file is None else file
    try:
        print(text, file=stream)
    except BrokenPipeError:
        _discard(stream)


def put_table(headings: Sequence[str], rows: Sequence[Sequence[str]], file: TextIO | None = None) -> None:
    """Print a table, on stdout without a `file`; nothing without a row.

    It folds to a terminal's width; for a program that searches lines each row is one.
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
"""Characters of a line where nothing folds."""


def put_rendered(shown: RenderableType, file: TextIO | None = None) -> None:
    """Print what rich draws; the texts in it are legible already."""
    from rich.console import Console

    stream = sys.stdout if file is None else file
    console = Console(file=stream, width=None if stream.isatty() else WIDEST)
    with console.capture() as drawn:
        console.print(shown)
    put_raw(drawn.get().removesuffix("\n"), file)


@contextmanager
def shown_progress(what: str) -> Iterator[Callable[[float, float], None] | None]:
    """Yield what shows how much is done, and of how much, with the time left; None where stderr is no terminal."""
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
    """Print what is still held back; OSError where it cannot be, but for a reader that is gone."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            _discard(stream)
        except OSError:
            _discard(stream)
            raise


def _discard(stream: TextIO) -> None:
    """Send what a stream still holds, and all that follows, to nowhere."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)
