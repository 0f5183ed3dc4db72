"""Sweeps on an existing Dask cluster: each worker gets plans and maps once, and finished rows come back.

A worker that dies loses its parts, which Dask gives to others. Plans, maps and runners are results of tasks, so that
Dask makes them again if all workers that had them are dead. A part whose workers die again and again is run variant by
variant, so that one bad variant costs its own row. Anything else that goes wrong ends the sweep, which can be resumed.
Only a few parts a worker are under way at a time, so that memory does not grow with the sweep.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from errno import ECONNABORTED
from hashlib import sha256
from itertools import islice
from pathlib import Path
from threading import Lock
from typing import Any

import distributed

from scenario_compiler.batch.distributions import SweepError
from scenario_compiler.batch.measuring import error_columns
from scenario_compiler.batch.runner import Batch, Form, Part, Runner, SentPlan, Variant
from scenario_compiler.files import read_file
from scenario_compiler.outputs import make_private_folder, write_whole
from scenario_compiler.resources import cache_folder
from scenario_compiler.trust import Trust

AHEAD = 3
"""Parts under way for each worker of the cluster."""

CONNECT = 30.0
"""Longest wait for the scheduler and a first worker, s."""

FIRST, SOON = 2, 1
"""Dask's priorities of what parts need and of variants that run alone; a part has 0.

When a worker dies, Dask suspects all its tasks, also those that wait: these should not wait behind the culprit.
"""

_ONE_PART = Lock()
"""Held by the thread of a worker that runs a part, because runners and engines are not safe for threads."""


@dataclass(frozen=True)
class Freight:
    """A plan and its map as they go to a worker."""

    plan: str
    map_name: str
    content: bytes


def run_part(runner: Runner, part: Part, freight: dict[int, Freight]) -> list[Batch]:
    """Run a part on a worker; the body of a task.

    Dask keeps the runner on the worker between the parts of a sweep, with its plans, maps and the compiled engine, and
    drops it after the sweep.
    """
    sent = []
    with _ONE_PART:
        for family, one in freight.items():
            place = cache_folder() / "maps" / sha256(one.content).hexdigest()
            file = place / one.map_name
            make_private_folder(place, cache_folder())
            if not file.is_file() or read_file(file) != one.content:
                write_whole(file, one.content)
            sent.append(SentPlan(family, one.plan, str(file)))
        return list(runner.batches(replace(part, plans=tuple(sent))))


class Cluster:
    """Runs the parts of a sweep on the workers of a Dask scheduler."""

    def __init__(self, form: Form, scheduler: str, patience: float = CONNECT, trust: Trust | None = None) -> None:
        """Connect within `patience` seconds.

        Raises:
            SweepError: There is no scheduler at the address, or it has no workers.
        """
        try:
            self._client: Any = distributed.Client(scheduler, timeout=patience)
            self._client.wait_for_workers(1, timeout=patience)
        except (OSError, TimeoutError) as fault:
            raise SweepError(f"no Dask cluster answers at {scheduler}: {fault}") from None
        except (ValueError, ImportError) as fault:
            raise SweepError(f"'{scheduler}' is not an address such as tcp://host:8786: {fault}") from None
        self._runner: Any = self._client.submit(Runner, form, trust or Trust(), pure=False, priority=FIRST)
        self._freight: dict[int, Any] = {}
        self._address = scheduler

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        """Yield the rows of all parts, in any order of parts.

        Raises:
            SweepError: A worker cannot run a part at all; a variant that fails has its error as its row instead.
            OSError: The cluster has lost the sweep; the rows that came back are kept.
        """
        under_way: dict[str, Part] = {}
        results: Any = distributed.as_completed()
        while True:
            for part in islice(parts, max(0, AHEAD * self._workers() - len(under_way))):
                future = self._submit(part)
                under_way[future.key] = part
                results.add(future)
            if not under_way:
                return
            future = next(results)
            part = under_way.pop(future.key)
            try:
                batches = self._result(future)
            except distributed.KilledWorker:
                yield from self._one_by_one(part)
            else:
                for batch in batches:
                    yield part.number, batch
            future.release()

    def close(self) -> None:
        """Leave the cluster as it is."""
        self._client.close()

    def _workers(self) -> int:
        """Return the number of workers now, at least 1: a cluster may still be starting its workers."""
        try:
            return max(1, len(self._client.nthreads()))
        except OSError as fault:
            raise self._lost() from fault

    def _lost(self) -> OSError:
        return OSError(ECONNABORTED, "the cluster has lost the tasks of the sweep", self._address)

    def _submit(self, part: Part, priority: int = 0) -> Any:
        for sent in part.plans:
            if sent.family not in self._freight:
                file = Path(sent.map_file)
                freight = (sent.text, file.name, file.read_bytes())
                self._freight[sent.family] = self._client.submit(Freight, *freight, pure=False, priority=FIRST)
        freight_of = {sent.family: self._freight[sent.family] for sent in part.plans}
        bare = replace(part, plans=())
        return self._client.submit(run_part, self._runner, bare, freight_of, pure=False, retries=2, priority=priority)

    def _one_by_one(self, part: Part) -> Iterator[tuple[int, Batch]]:
        """Run the variants of a part whose workers died each on its own."""
        for variant in part.variants:
            alone: tuple[Variant, ...] = (variant,)
            try:
                batches = self._result(self._submit(replace(part, variants=alone, one_by_one=True), SOON))
            except distributed.KilledWorker:
                batches = [Batch(alone, error_columns(1, "each worker that ran it died"))]
            for batch in batches:
                yield part.number, batch

    def _result(self, future: Any) -> list[Batch]:
        """Return the rows of a task when it has ended; KilledWorker if its workers died, and the faults of `run`."""
        try:
            batches: list[Batch] = future.result()
        except distributed.CancelledError:
            raise self._lost() from None
        except Exception as fault:
            if isinstance(fault, distributed.KilledWorker) and fault.task == future.key:
                raise
            raise SweepError(f"a worker failed: {type(fault).__name__}: {fault}") from None
        return batches
