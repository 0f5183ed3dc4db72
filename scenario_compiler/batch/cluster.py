"""Sweeps on an existing Dask cluster: each worker gets plans and maps once, and finished rows come back.

A worker that dies loses its parts, which Dask gives to others; a part whose workers die again and again comes back as
an error and is run variant by variant, so that one bad variant costs its own row. Only a few parts a worker are under
way at a time, so that memory does not grow with the sweep.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
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
"""Parts under way for each thread of the cluster."""

CONNECT = 30.0
"""Longest wait for the scheduler and a first worker, s."""


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
        self._runner: Any = self._client.submit(Runner, form, trust or Trust(), pure=False)
        self._freight: dict[int, Any] = {}

    def run(self, parts: Iterator[Part]) -> Iterator[tuple[int, Batch]]:
        """Yield the rows of all parts, in any order of parts."""
        under_way: dict[str, Part] = {}
        results: Any = distributed.as_completed()

        def start(part: Part) -> None:
            future = self._submit(part)
            under_way[future.key] = part
            results.add(future)

        for part in self._up_to(parts, AHEAD * self._threads()):
            start(part)
        while under_way:
            future = next(results)
            part = under_way.pop(future.key)
            if future.status == "finished":
                for batch in future.result():
                    yield part.number, batch
            else:
                yield from self._one_by_one(part, str(future.exception()))
            future.release()
            for following in self._up_to(parts, 1):
                start(following)

    def close(self) -> None:
        """Leave the cluster as it is."""
        self._client.close()

    def _up_to(self, parts: Iterator[Part], count: int) -> Iterator[Part]:
        for _ in range(count):
            part = next(parts, None)
            if part is None:
                return
            yield part

    def _threads(self) -> int:
        threads: int = sum(self._client.nthreads().values())
        return max(1, threads)

    def _submit(self, part: Part) -> Any:
        for sent in part.plans:
            if sent.family not in self._freight:
                file = Path(sent.map_file)
                freight = Freight(sent.text, file.name, file.read_bytes())
                self._freight[sent.family] = self._client.scatter(freight, broadcast=True, hash=True)
        freight_of = {sent.family: self._freight[sent.family] for sent in part.plans}
        bare = replace(part, plans=())
        return self._client.submit(run_part, self._runner, bare, freight_of, pure=False, retries=2)

    def _one_by_one(self, part: Part, why: str) -> Iterator[tuple[int, Batch]]:
        """Run the variants of a part that failed as a whole each on its own."""
        for variant in part.variants:
            alone: tuple[Variant, ...] = (variant,)
            future = self._submit(replace(part, variants=alone, one_by_one=True))
            try:
                for batch in future.result():
                    yield part.number, batch
            except Exception as fault:
                yield part.number, Batch(alone, error_columns(1, str(fault) or why))
