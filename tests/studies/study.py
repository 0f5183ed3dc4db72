"""Runs of a study's conflict, without a camera, one a seed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from scenario_compiler import Outcome, Recording, judge, open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.recording.recording import Floats
from scenario_compiler.vocabulary.horizon import HORIZON


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


@dataclass(frozen=True)
class Sample:
    """What comes of a condition of a study over its runs.

    Attributes:
        times: Takeover times of those who answered, s.
        inputs: Times of the first steering or braking after the request, s.
        least: Least time to collision of each run, s; HORIZON where nothing was ever approached.
        along: The same along the lane, until the vehicle has moved aside.
        crashed: Share of the runs with a collision.
    """

    times: Floats
    inputs: Floats
    least: Floats
    along: Floats
    crashed: float


def sample(found: Iterable[Compilation], seeds: range) -> Sample:
    """Run each compilation with each seed."""
    outcomes = [outcome for one in found for _, outcome in runs(one, seeds)]

    def numbers(measure: str) -> list[float]:
        return [value for one in outcomes if (value := one.measures[measure].value) is not None]

    def least(measure: str) -> Floats:
        values = [one.measures[measure].value for one in outcomes]
        return np.array([HORIZON if value is None else value for value in values])

    return Sample(
        times=np.array(numbers("takeover_time")),
        inputs=np.array(numbers("input_time")),
        least=least("minimum_time_to_collision"),
        along=least("minimum_lane_time_to_collision"),
        crashed=float(np.mean([one.collision_with is not None for one in outcomes])),
    )
