"""A pool of worker processes in which a crash or a hang costs only the variant that caused it.

A worker says which variants it begins and sends their rows when they are done. When it dies, or takes longer than the
time limit, it is replaced; several variants that ran together are tried one by one, and a single one is tried once more
and then becomes a row with its error.
"""

from __future__ import annotations

import multiprocessing
import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.measuring import error_columns
from scenario_compiler.batch.runner import Batch, Form, Part, Runner, Variant
from scenario_compiler.interruption import left_to_this_process
from scenario_compiler.trust import Trust

START_ATTEMPTS = 3
"""Deaths before the first variant of a part begins after which the sweep gives up."""

PATIENCE = 0.5
"""Interval at which time limits are checked, s."""


def serve(connection: Connection, form: Form, trust: Trust) -> None:
    """Run the parts that arrive through the connection until it closes; the body of a worker process."""
    runner = Runner(form, trust=trust)
    try:
        while True:
            part = connection.recv()
            for batch in runner.batches(part, lambda begun: connection.send(("begin", len(begun)))):
                connection.send(("rows", batch))
            connection.send(("done", None))
    except (EOFError, ConnectionError):
        return
    except Exception as fault:
        connection.send(("fault", f"{type(fault).__name__}: {fault}"))


@dataclass
class _Worker:
    process: BaseProcess
    connection: Connection
    part: Part | None = None
    at: int = 0
    """Number of the part's variants that are done."""
    begun: int = 0
    """Number of variants that run now."""
    since: float = 0.0


class Pool:
    """Worker processes for the parts of a sweep."""

    def __init__(self, form: Form, workers: int, time_limit: float | None = None, trust: Trust | None = None) -> None:
        """Start the workers, by spawning: nothing of this process is inherited."""
        self._context = multiprocessing.get_context("spawn")
        self._setup = (form, trust or Trust())
        self._time_limit = time_limit
        self._workers = [self._start() for _ in range(workers)]
        self._deaths: dict[int, int] = {}

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        """Yield the rows of all parts as (number of the part, batch), in any order of parts.

        Raises:
            SweepError: Workers die before they run anything, or report a fault of the program.
        """
        waiting: deque[Part] = deque()
        exhausted = False
        while True:
            for place, worker in enumerate(self._workers):
                if worker.part is None:
                    if not waiting and not exhausted:
                        following = next(parts, None)
                        exhausted = following is None
                        waiting.extend([] if following is None else [following])
                    if waiting:
                        self._give(place, waiting.popleft())
            busy = [worker for worker in self._workers if worker.part is not None]
            if not busy:
                return
            yield from self._listen(busy, waiting)

    def close(self) -> None:
        """End the workers."""
        for worker in self._workers:
            worker.process.kill()
            worker.connection.close()
        for worker in self._workers:
            worker.process.join()

    def _start(self) -> _Worker:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=serve, args=(theirs, *self._setup), daemon=True)
        with left_to_this_process():
            process.start()
        theirs.close()
        return _Worker(process, ours)

    def _give(self, place: int, part: Part) -> None:
        worker = self._workers[place]
        try:
            worker.connection.send(part)
        except (BrokenPipeError, ConnectionResetError):
            self._workers[place] = worker = self._start()
            worker.connection.send(part)
        worker.part, worker.at, worker.begun = part, 0, 0

    def _listen(self, busy: list[_Worker], waiting: deque[Part]) -> Iterator[tuple[int, Batch]]:
        ready = wait([worker.connection for worker in busy], timeout=PATIENCE)
        for worker in busy:
            part = worker.part
            if part is None:
                continue
            if worker.connection in ready:
                try:
                    kind, content = worker.connection.recv()
                except (EOFError, ConnectionResetError):
                    worker.process.join()
                    yield from self._lost(worker, waiting, f"the process ended with code {worker.process.exitcode}")
                    continue
                if kind == "fault":
                    raise SweepError(f"a worker failed: {content}")
                if kind == "begin":
                    worker.begun, worker.since = content, time.perf_counter()
                elif kind == "rows":
                    worker.at, worker.begun = worker.at + len(content.variants), 0
                    yield part.number, content
                else:
                    worker.part = None
            elif self._late(worker):
                worker.process.kill()
                worker.process.join()
                yield from self._lost(worker, waiting, f"it took longer than {self._time_limit:g} s", again=False)

    def _late(self, worker: _Worker) -> bool:
        if self._time_limit is None or not worker.begun:
            return False
        return time.perf_counter() - worker.since > self._time_limit * worker.begun

    def _lost(
        self, worker: _Worker, waiting: deque[Part], why: str, *, again: bool = True
    ) -> Iterator[tuple[int, Batch]]:
        """Replace a worker; its variants are queued again or given up."""
        part = worker.part
        worker.connection.close()
        self._workers[self._workers.index(worker)] = self._start()
        if part is None:
            return
        rest = part.variants[worker.at :]
        if not worker.begun:
            self._deaths[-1] = self._deaths.get(-1, 0) + 1
            if self._deaths[-1] >= START_ATTEMPTS:
                raise SweepError(f"the workers cannot run anything: {why}")
            waiting.appendleft(replace(part, variants=rest))
            return
        if worker.begun > 1:
            waiting.appendleft(replace(part, variants=rest, one_by_one=True))
            return
        culprit: Variant = rest[0]
        self._deaths[culprit.index] = self._deaths.get(culprit.index, 0) + 1
        if again and self._deaths[culprit.index] < 2:
            waiting.appendleft(replace(part, variants=rest, one_by_one=True))
            return
        yield part.number, Batch((culprit,), error_columns(1, why))
        if rest[1:]:
            waiting.appendleft(replace(part, variants=rest[1:]))
