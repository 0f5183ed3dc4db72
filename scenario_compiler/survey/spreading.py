"""Does a task for each scenario of a library, in one or several processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from scenario_compiler.interruption import left_to_this_process
from scenario_compiler.processes import spawned_pool

FEW = 4
"""Number of scenarios up to which no worker process is started."""

ENDED = "its process was ended by the system"
"""Fault of a scenario whose process died twice, as one does that takes too much memory."""

Result = TypeVar("Result")


def results_of(
    targets: Sequence[str],
    task: Callable[[str], Result],
    given_up: Callable[[str, str], Result],
    *,
    processes: int = 1,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[Result]:
    """Yield the result for each scenario, in order.

    Args:
        targets: FILE#name of each.
        task: Returns the result of a scenario, by its FILE#name.
        given_up: Returns the result of a scenario that cannot be examined, by its FILE#name and the reason.
        processes: Number of processes.
        progress: Called with the number of finished scenarios and the total.
    """
    alone = processes < 2 or len(targets) <= FEW
    found = map(task, targets) if alone else spread(targets, task, given_up, processes)
    for done, one in enumerate(found, start=1):
        if progress is not None:
            progress(done, len(targets))
        yield one


def spread(
    targets: Sequence[str], task: Callable[[str], Result], given_up: Callable[[str, str], Result], processes: int
) -> Iterator[Result]:
    """Yield results from worker processes. If one dies, its scenario is tried again alone, and then given up."""
    with spawned_pool(processes) as pool:
        with left_to_this_process():
            waiting = [pool.submit(task, target) for target in targets]
        for target, future in zip(targets, waiting, strict=True):
            yield _alone(target, task, given_up) if _was_lost(future) else future.result()


def _alone(target: str, task: Callable[[str], Result], given_up: Callable[[str, str], Result]) -> Result:
    with spawned_pool(1) as pool:
        with left_to_this_process():
            future = pool.submit(task, target)
        return given_up(target, ENDED) if _was_lost(future) else future.result()


def _was_lost(future: Future[Any]) -> bool:
    return isinstance(future.exception(), BrokenProcessPool)
