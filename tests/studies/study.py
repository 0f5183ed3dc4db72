"""Runs of a study's conflict, without a camera, one a seed."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from scenario_compiler import Outcome, Recording, judge, open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text


def compiled(folder: Path, text: str, **arguments: object) -> Compilation:
    """Return the compilation of a conflict's text."""
    path = folder / "study.xml"
    path.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    settings = {name: str(value) for name, value in arguments.items()}
    found = compile_target(str(path), settings, sink, overrides=Overrides(perception="ideal"))
    assert found is not None, "\n".join(as_text(one) for one in sink)
    return found


def runs(found: Compilation, seeds: range) -> Iterator[tuple[Recording, Outcome]]:
    """Yield a run a seed."""
    with open_world("kinematic", found.plan, found.network) as world:
        for seed in seeds:
            recording = run(found.plan, world, seed=seed)
            yield recording, judge(found.plan, recording)


def time_of(recording: Recording, kind: str) -> float:
    """Return the time of the first event of a kind, infinity without one."""
    return next((event.t for event in recording.events if event.kind == kind), float("inf"))


def row_at(recording: Recording, time: float) -> int:
    """Return the row of a time."""
    return int(np.searchsorted(recording.t, time - 1e-6))
