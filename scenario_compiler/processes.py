"""The processes over which a command spreads its work: how many, and a pool of them that ends with the command."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from scenario_compiler.interruption import ended_with_this

if TYPE_CHECKING:
    from concurrent.futures import ProcessPoolExecutor


def available_cores() -> int:
    """Return the number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@contextmanager
def spawned_pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Open a pool of processes that inherit nothing of this one, and end with it if the user interrupts.

    Work is handed to it under `left_to_this_process`, because it starts its processes then.
    """
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool, ended_with_this():
        yield pool
