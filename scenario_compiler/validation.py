"""Checks files and reports all their faults, in one or several processes, even if processes crash."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from scenario_compiler.compiler import Overrides, compile_expanded, read_source
from scenario_compiler.diagnostics import Code, Diagnostic, Diagnostics, FilePlace
from scenario_compiler.document import Document, read_document
from scenario_compiler.files import MAX_BYTES, suffix_of
from scenario_compiler.garbage_collection import collect_seldom, keep_loaded
from scenario_compiler.interruption import ended_with_this, left_to_this_process
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
"""Suffixes of the files that `validate` checks in a folder."""


def files_below(path: Path) -> list[Path]:
    """Return a file itself, or all scenario and road files below a folder, sorted.

    Anything with the name of such a file is included, and so is a folder that cannot be read: reading it reports the
    fault.
    """
    if not path.is_dir():
        return [path]
    closed: list[OSError] = []
    walked = os.walk(path, onerror=closed.append)
    files = [Path(folder, name) for folder, _, names in walked for name in names if name.lower().endswith(SUFFIXES)]
    return sorted([*files, *(Path(fault.filename) for fault in closed)])


FILES_A_TASK = 8
"""Number of files that a process checks before it returns its findings."""

Check: TypeAlias = Callable[[Sequence[Path]], list[list[Diagnostic]]]
"""A function that returns the findings of each of some files."""


def validate_file(
    path: Path,
    sink: Diagnostics,
    maps: Sequence[Path] = (),
    xsd: Schemas | None = None,
    trust: Trust | None = None,
) -> None:
    """Report every fault of one file: of all its templates and scenarios, or of its roads.

    Code that the file names is imported only if it is trusted; otherwise only its spelling is checked.

    `xsd` has ASAM's schemas. If it has a schema for the version of an OpenDRIVE or OpenSCENARIO file, the structure is
    checked against this schema; otherwise against the tables of this program. Only the structure of an OpenSCENARIO
    file gives errors: faults of its meaning are warnings, and so is a fault of this program while it looks for them.
    """
    suffix = suffix_of(path)
    if suffix == ".xodr":
        document = read_document(path, sink, MAX_BYTES)
        if document is not None and (xsd is None or _by_schema(document, xsd, sink) is None):
            from scenario_compiler.roads.structure import check_structure

            check_structure(document, sink)
        return
    if suffix == ".json":
        read_plan(path, sink)
    elif suffix == ".xosc":
        from scenario_compiler.openscenario.validation import add_meaning, validate_openscenario

        meaning = Diagnostics()
        validate_openscenario(path, sink, xsd)
        with _own_faults_reported(path, meaning):
            _check_scenarios(path, meaning, maps, trust)
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
        from scenario_compiler.study_plans import compile_study

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
        maps: Folders in which maps are looked for first.
        processes: Number of processes that share the files; a few files are checked in this process.
        xsd: ASAM's schemas; None to check without them.
        insisted: Codes of warnings that are reported even if a file allows them.
        trust: Code that may be imported if a file names it.
    """
    check = partial(_findings, maps=maps, xsd=xsd, insisted=insisted, trust=trust, templates=templates_given())
    tasks = [files[at : at + FILES_A_TASK] for at in range(0, len(files), FILES_A_TASK)]
    if processes < 2 or len(tasks) < 2 * processes:
        for file in files:
            yield check([file])[0]
        return
    yield from checked_by_processes(tasks, processes, check)


def checked_by_processes(tasks: Sequence[Sequence[Path]], processes: int, check: Check) -> Iterator[list[Diagnostic]]:
    """Yield the findings of each file of all tasks, in order, from processes of which any may die.

    The other processes of its pool then end too, and it is not known which tasks they had: the tasks that may have been
    begun are checked file by file, and the rest by a new pool.
    """
    in_hand = 2 * processes + 1  # each process has one, and the pool prepares one more than it has processes
    alone: set[int] = set()
    with ended_with_this(), ExitStack() as pools:

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
    """Yield the findings of each file, one file at a time; a file that ends two processes is at fault.

    Each file is tried twice, because the system may end a process because of others (if memory is short, for example).
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
            ended = "the system ended the process that checked it, and also a second one"
            yield [_unchecked(file, ended)]
    pool.shutdown()


def _pool(processes: int) -> ProcessPoolExecutor:
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    return ProcessPoolExecutor(processes, mp_context=get_context("spawn"), initializer=_spare_collector)


def _was_lost(task: Future[list[list[Diagnostic]]]) -> bool:
    """Wait for a task; return whether a process of its pool died before the task was done."""
    from concurrent.futures.process import BrokenProcessPool

    return isinstance(task.exception(), BrokenProcessPool)


def _spare_collector() -> None:
    """Let the garbage collector of a process that checks files run seldom, and exempt everything loaded so far."""
    collect_seldom()
    keep_loaded()


def _findings(
    files: Sequence[Path],
    maps: Sequence[Path],
    xsd: Schemas | None,
    insisted: frozenset[str],
    trust: Trust | None,
    templates: Sequence[Path],
) -> list[list[Diagnostic]]:
    """Return the findings of each file; a fault of this program is a finding too, and does not stop the other files."""
    found = []
    for file in files:
        sink = Diagnostics(insisted=insisted)
        with _own_faults_reported(file, sink), templates_from(templates):
            validate_file(file, sink, maps, xsd, trust)
        found.append(list(sink))
    return found


@contextmanager
def _own_faults_reported(file: Path, sink: Diagnostics) -> Iterator[None]:
    """Report a fault of this program as a finding on a file; a fault of the user's configuration is raised."""
    try:
        yield
    except ConfigurationError:
        raise
    except Exception as fault:
        sink.take((_unchecked(file, f"{type(fault).__name__}: {fault}"[:300]),))


def _unchecked(file: Path, message: str) -> Diagnostic:
    return Diagnostic(UNCHECKED, f"the file could not be checked: {message}", FilePlace(str(file)))
