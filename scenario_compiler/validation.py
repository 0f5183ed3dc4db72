"""Checks files and reports all their faults, in one or several processes, even if processes crash."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from scenario_compiler.compiler import Overrides, compile_expanded, compile_study, read_source
from scenario_compiler.diagnostics import Code, Diagnostic, Diagnostics, FilePlace
from scenario_compiler.document import Document, read_document
from scenario_compiler.files import MAX_BYTES
from scenario_compiler.interruption import left_to_this_process
from scenario_compiler.languages import check_source, drop_allowed
from scenario_compiler.plan.store import read_plan
from scenario_compiler.resources import templates_from, templates_given
from scenario_compiler.source.study_file import StudyFile
from scenario_compiler.structure.schemas import Schemas
from scenario_compiler.trust import ConfigurationError, Trust

if TYPE_CHECKING:
    from concurrent.futures import Future, ProcessPoolExecutor

UNCHECKED = Code(
    "SC117",
    "unchecked-file",
    "The file could not be checked because of this program or the machine, not because of the file: a fault of the "
    "program, or not enough memory. The other files were checked.\n\n"
    "    the file could not be checked: MemoryError\n\n"
    "Check the file alone; if that fails too, please report it with the file.",
)


SUFFIXES = (".xml", ".xosc", ".xodr")
"""Endings of the files that `validate` takes from a folder."""


def files_below(path: Path) -> list[Path]:
    """Return a file itself, or all scenario and road files below a folder, sorted.

    Whatever has the name of such a file is one, and so is a folder that cannot be looked into: reading it says what is
    wrong with it.
    """
    if not path.is_dir():
        return [path]
    closed: list[OSError] = []
    walked = os.walk(path, onerror=closed.append)
    files = [Path(folder, name) for folder, _, names in walked for name in names if name.endswith(SUFFIXES)]
    return sorted([*files, *(Path(fault.filename) for fault in closed)])


FILES_A_TASK = 8
"""Files that a process checks before it hands its findings over."""

Check: TypeAlias = Callable[[Sequence[Path]], list[list[Diagnostic]]]
"""What returns the findings of each of some files."""


def validate_file(
    path: Path,
    sink: Diagnostics,
    maps: Sequence[Path] = (),
    xsd: Schemas | None = None,
    trust: Trust | None = None,
) -> None:
    """Report every fault of one file: of all its templates and scenarios, or of the roads that it holds.

    Code that the file names is imported only where it is trusted; otherwise its spelling alone is checked.

    `xsd` is where ASAM's schemas are: where there is one of the version of a road file, or of a file in OpenSCENARIO,
    that schema judges the file's structure, else what our readers declare does. Of a file in OpenSCENARIO, the
    structure alone decides: what its meaning lacks is a warning, and so is a fault of this program in telling that.
    """
    if path.suffix == ".xodr":
        document = read_document(path, sink, MAX_BYTES)
        if document is not None and (xsd is None or _by_schema(document, xsd, sink) is None):
            from scenario_compiler.roads.structure import check_structure

            check_structure(document, sink)
        return
    if path.suffix == ".json":
        read_plan(path, sink)
    elif path.suffix == ".xosc":
        from scenario_compiler.openscenario.validation import add_meaning, validate_openscenario

        meaning = Diagnostics()
        validate_openscenario(path, sink, xsd)
        try:
            _check_scenarios(path, meaning, maps, trust)
        except ConfigurationError:
            raise
        except Exception as fault:
            meaning.take((_unchecked(path, f"{type(fault).__name__}: {fault}"[:300]),))
        add_meaning(meaning, sink)
    else:
        _check_scenarios(path, sink, maps, trust)


def _check_scenarios(path: Path, sink: Diagnostics, maps: Sequence[Path], trust: Trust | None) -> None:
    """Report every fault of all templates and scenarios of a file."""
    read = read_source(path, sink)
    if read is None:
        return
    document, source = read
    if isinstance(source, StudyFile):
        check_source(source, sink)
        compile_study(source, sink, maps=maps, trust=trust)
        return
    trusted = Overrides().trusting(trust or Trust(), path.parent)
    for one in check_source(source, sink):
        compile_expanded(one.scenario, document, sink, maps, Overrides(), whole=one.whole, trust=trusted)
    drop_allowed(sink, source)


def _by_schema(document: Document, schemas: Schemas, sink: Diagnostics) -> bool | None:
    from scenario_compiler.roads.xsd import validate_with_xsd

    return None if schemas.folder is None else validate_with_xsd(document, schemas.folder, sink)


def validate_files(
    files: Sequence[Path],
    maps: Sequence[Path] = (),
    processes: int = 1,
    xsd: Schemas | None = None,
    insisted: frozenset[str] = frozenset(),
    trust: Trust | None = None,
) -> Iterator[list[Diagnostic]]:
    """Yield the findings of each file, in the order of the files.

    Args:
        files: The files.
        maps: Folders that maps are looked for in first.
        processes: Number of processes to spread the files over; few files are checked in this one.
        xsd: Where ASAM's schemas are, None to do without.
        insisted: Codes of warnings that are reported even where a file allows them.
        trust: Code that may be imported where a file names it.
    """
    check = partial(_findings, maps=maps, xsd=xsd, insisted=insisted, trust=trust, templates=templates_given())
    tasks = [files[at : at + FILES_A_TASK] for at in range(0, len(files), FILES_A_TASK)]
    if processes < 2 or len(tasks) < 2 * processes:
        for file in files:
            yield check([file])[0]
        return
    yield from checked_by_processes(tasks, processes, check)


def checked_by_processes(tasks: Sequence[Sequence[Path]], processes: int, check: Check) -> Iterator[list[Diagnostic]]:
    """Yield the findings of each file of all tasks, in order, found by processes of which any may die.

    The others of its pool then end too, and nobody knows which tasks they were at: those that may have been in hand
    are checked file by file, and the rest goes to a new pool.
    """
    in_hand = 2 * processes + 1  # each process has one, and the pool lays out one more than it has processes
    alone: set[int] = set()
    with _ended_with_this(), ExitStack() as pools:

        def hand_out(numbers: Sequence[int]) -> dict[int, Future[list[list[Diagnostic]]]]:
            pool = _pool(processes)
            pools.callback(pool.shutdown, cancel_futures=True)
            with left_to_this_process():
                return {number: pool.submit(check, tasks[number]) for number in numbers}

        found = hand_out(range(len(tasks)))
        for number, task in enumerate(tasks):
            if number not in alone and _was_lost(found[number]):
                lost = [one for one in range(number, len(tasks)) if one not in alone and _was_lost(found[one])]
                alone.update(lost[:in_hand])
                found |= hand_out(lost[in_hand:])
            yield from _one_by_one(task, check) if number in alone else found[number].result()


def _one_by_one(files: Sequence[Path], check: Check) -> Iterator[list[Diagnostic]]:
    """Yield the findings of each file, checked with no other at hand; one that ends two processes is at fault.

    It is tried twice, since the system may end a process for what others do (for want of memory, for example).
    """
    pool = _pool(1)
    for file in files:
        for _ in range(2):
            with left_to_this_process():
                only = pool.submit(check, [file])
            if not _was_lost(only):
                yield only.result()[0]
                break
            pool.shutdown()
            pool = _pool(1)
        else:
            ended = "the process that checked it was ended by the system, and so was one that tried again"
            yield [_unchecked(file, ended)]
    pool.shutdown()


@contextmanager
def _ended_with_this() -> Iterator[None]:
    """End the processes that were started meanwhile when the user interrupts: they know nothing of that."""
    from multiprocessing import active_children

    before = set(active_children())
    try:
        yield
    except (KeyboardInterrupt, GeneratorExit):
        for process in set(active_children()) - before:
            process.kill()
        raise


def _pool(processes: int) -> ProcessPoolExecutor:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    return ProcessPoolExecutor(processes, mp_context=get_context("spawn"), initializer=_spare_collector)


def _was_lost(task: Future[list[list[Diagnostic]]]) -> bool:
    """Wait for a task; return whether a process of its pool has died before it was done."""
    from concurrent.futures.process import BrokenProcessPool

    return isinstance(task.exception(), BrokenProcessPool)


def _spare_collector() -> None:
    """Let the garbage collector of a process that checks files look seldom, and never at what is loaded by now."""
    gc.set_threshold(100_000, 50, 50)
    gc.freeze()


def _findings(
    files: Sequence[Path],
    maps: Sequence[Path],
    xsd: Schemas | None,
    insisted: frozenset[str],
    trust: Trust | None,
    templates: Sequence[Path],
) -> list[list[Diagnostic]]:
    """Return the findings of each file; a fault of this program is a finding too, and the other files go on."""
    found = []
    for file in files:
        sink = Diagnostics(insisted=insisted)
        try:
            with templates_from(templates):
                validate_file(file, sink, maps, xsd, trust)
        except ConfigurationError:
            raise
        except Exception as fault:
            sink.take((_unchecked(file, f"{type(fault).__name__}: {fault}"[:300]),))
        found.append(list(sink))
    return found


def _unchecked(file: Path, message: str) -> Diagnostic:
    return Diagnostic(UNCHECKED, f"the file could not be checked: {message}", FilePlace(str(file)))
