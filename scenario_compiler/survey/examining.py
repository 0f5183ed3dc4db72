"""Examines scenarios one by one, in one or several processes: compiles, tags and runs them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, Severity, position_text
from scenario_compiler.files import split_target
from scenario_compiler.recording.outcome import judge
from scenario_compiler.resources import templates_from, templates_given
from scenario_compiler.runtime import open_world, run
from scenario_compiler.survey.duplicates import likeness
from scenario_compiler.survey.odd import Tags, tags_of
from scenario_compiler.survey.spreading import results_of
from scenario_compiler.vocabulary.scenario import Classification


class Ran(BaseModel):
    """The result of one run with ideal perception."""

    model_config = ConfigDict(frozen=True)

    seed: int = Field(description="Seed of the run.")
    result: str = Field(description="pass, fail or error.")
    cause: str = Field(description="Cause of the first takeover request; empty without one.")
    resolution: str = Field(description="How the first takeover request ended.")


class Examined(BaseModel):
    """The results for one scenario."""

    model_config = ConfigDict(frozen=True)

    target: str = Field(description="FILE#name as `run` takes it.")
    name: str = Field(description="Its name.")
    fault: str = Field(default="", description="Why it could not be compiled; empty where it could.")
    summary: str = Field(default="", description="One sentence: what happens.")
    map: str = Field(default="", description="Its map.")
    digest: str = Field(default="", description="Digest of its plan.")
    automated: bool = Field(default=True, description="It has an automated vehicle.")
    causes: tuple[str, ...] = Field(default=(), description="Causes for which the automation asks.")
    judged: bool = Field(default=True, description="It has criteria.")
    places: tuple[tuple[str, str], ...] = Field(default=(), description="Taxonomies and its situation in each.")
    tags: Tags = Field(default={}, description="Its conditions, as OpenLABEL's tags, with what belongs to each.")
    runs: tuple[Ran, ...] = Field(default=(), description="Its runs.")
    likeness: str = Field(default="", description="Digest of all that its plan says but its numbers.")
    numbers: dict[str, float] = Field(default={}, description="The numbers of its plan, by where they stand.")


def examine_all(
    targets: Sequence[str],
    *,
    runs: int = 0,
    processes: int = 1,
    maps: Sequence[Path] = (),
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[Examined]:
    """Return the results for each scenario, in order.

    Args:
        targets: FILE#name of each.
        runs: Number of runs of each, with ideal perception and the seeds from 1 on.
        processes: Number of processes.
        maps: Folders in which maps are looked for first.
        progress: Called with the number of finished scenarios and the total.
    """
    task = partial(examine, runs=runs, maps=tuple(maps), templates=templates_given())
    return results_of(targets, task, given_up, processes=processes, progress=progress)


def given_up(target: str, fault: str) -> Examined:
    """Return the results for a scenario that could not be examined."""
    return Examined(target=target, name=split_target(target)[1] or Path(target).stem, fault=fault)


def examine(target: str, runs: int = 0, maps: Sequence[Path] = (), templates: Sequence[Path] = ()) -> Examined:
    """Return the results for one scenario; if it cannot be compiled, they have the reason."""
    sink = Diagnostics()
    with templates_from(templates):
        compilation = compile_target(
            target, {}, sink, maps=maps, overrides=Overrides(perception="ideal", driven_by="model")
        )
    if compilation is None:
        first = next((one for one in sink if one.severity is Severity.ERROR), None)
        if first is None:
            return given_up(target, "it cannot be compiled")
        return given_up(target, f"{first.code.id} {first.message} ({position_text(first.place)})")
    plan = compilation.plan
    same, numbers = likeness(plan)
    return Examined(
        target=target,
        name=plan.name,
        summary=plan.summary,
        map=plan.map.name,
        digest=plan.digest,
        automated=plan.controller is not None,
        causes=tuple(cause.kind for cause in plan.takeover.causes),
        judged=bool(plan.criteria),
        places=tuple(_placed(one) for one in plan.classifications),
        tags=tags_of(plan, compilation.network),
        runs=tuple(_run(compilation, seed) for seed in range(1, runs + 1)),
        likeness=same,
        numbers=dict(numbers),
    )


def _placed(one: Classification) -> tuple[str, str]:
    return one.scheme, one.place


def _run(compilation: Compilation, seed: int) -> Ran:
    world = open_world("kinematic", compilation.plan, compilation.network)
    try:
        outcome = judge(compilation.plan, run(compilation.plan, world, seed))
    finally:
        world.close()
    return Ran(seed=seed, result=outcome.result, cause=outcome.cause, resolution=outcome.resolution)
