"""Runs a library's scenarios with four drivers, to see whether their results differ.

A scenario that ends well with every driver shows nothing about takeovers. The runs have the seed 1, and ideal
perception unless the camera is requested; they differ only in the driver.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.files import split_target
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.outcome import Outcome, judge
from scenario_compiler.report.palette import words_of
from scenario_compiler.report.wording import outcome_words
from scenario_compiler.resources import library_folder, templates_from, templates_given
from scenario_compiler.roads import Network
from scenario_compiler.runtime import open_world, run
from scenario_compiler.source.catalogs import load_catalogs
from scenario_compiler.source.expansion import catalog_driver
from scenario_compiler.survey.spreading import results_of
from scenario_compiler.vocabulary.driver import Driver, DriverModel
from scenario_compiler.vocabulary.sensors import Perception

SEED = 1
"""Seed of all runs."""

ATTENTIVE = 2.4
"""Takeover time of the attentive driver, s: the median of the catalog's `study_means`, after Zhang et al. 2019."""

SLOW = 6.061
"""Takeover time of the slow driver, s: the median of drivers who were busy reading, Eriksson and Stanton 2017."""

DRIVERS: dict[str, Driver] = {
    "attentive": Driver(takeover_time=ATTENTIVE),
    "slow": Driver(takeover_time=SLOW),
    "absent": Driver(preset="absent"),
    "reference": Driver(preset="fuzzy_safety_model"),
}
"""The four drivers as words of a scenario."""


class Driven(BaseModel):
    """The result of a scenario with one of the drivers."""

    model_config = ConfigDict(frozen=True)

    result: str = Field(description="pass, fail or error.")
    cause: str = Field(description="Cause of the first request; empty without one.")
    request: float | None = Field(description="Time of the first request, s.")
    takeover_time: float | None = Field(description="Time from it to the response, s.")
    minimum_ttc: float | None = Field(description="Least time to collision of the run, s.")
    outcome: str = Field(description="Outcome of the run in a few words.")
    broken: tuple[str, ...] = Field(description="Criteria that it broke.")


class Separated(BaseModel):
    """The results of a scenario with the four drivers."""

    model_config = ConfigDict(frozen=True)

    target: str = Field(description="FILE#name as `run` takes it.")
    name: str = Field(description="Its name.")
    summary: str = Field(default="", description="Summary of the scenario in one sentence.")
    fault: str = Field(default="", description="Reason why it could not be run; empty if it could.")
    drivers: dict[str, Driven] = Field(default={}, description="Result of the scenario with each driver.")

    @property
    def separates(self) -> bool:
        """Whether the slow or the absent driver fails."""
        return any(self.drivers[name].result == "fail" for name in ("slow", "absent") if name in self.drivers)

    @property
    def asks(self) -> bool:
        """Whether the automation requests a takeover in any of the runs."""
        return any(one.cause for one in self.drivers.values())


def separate_all(
    targets: Sequence[str],
    *,
    processes: int = 1,
    maps: Sequence[Path] = (),
    perception: Perception = "ideal",
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[Separated]:
    """Return the results of each scenario with the four drivers, in order.

    Args:
        targets: FILE#name of each.
        processes: Number of processes.
        maps: Folders in which maps are looked for first.
        perception: Source of the lane confidence.
        progress: Called with the number of finished scenarios and the total.
    """
    task = partial(separate, maps=tuple(maps), templates=templates_given(), perception=perception)
    return results_of(targets, task, given_up, processes=processes, progress=progress)


def given_up(target: str, fault: str) -> Separated:
    """Return the result of a scenario that could not be run."""
    return Separated(target=target, name=split_target(target)[1] or Path(target).stem, fault=fault)


def separate(
    target: str, maps: Sequence[Path] = (), templates: Sequence[Path] = (), perception: Perception = "ideal"
) -> Separated:
    """Run a scenario with the four drivers; if it cannot be compiled, the result has the reason."""
    sink = Diagnostics()
    with templates_from(templates):
        compilation = compile_target(
            target, {}, sink, maps=maps, overrides=Overrides(perception=perception, driven_by="model")
        )
    if compilation is None:
        faults = (one.message for one in sink if one.severity is Severity.ERROR)
        return given_up(target, next(faults, "it cannot be compiled"))
    plan = compilation.plan
    if plan.controller is None:
        return Separated(target=target, name=plan.name, summary=plan.summary, fault="it has no automated vehicle")
    catalogs = load_catalogs(library_folder() / "catalogs", sink)
    models = {name: catalog_driver(driver, catalogs, sink) for name, driver in DRIVERS.items()}
    return Separated(
        target=target,
        name=plan.name,
        summary=plan.summary,
        drivers={name: _driven(plan, compilation.network, model) for name, model in models.items()},
    )


def _driven(plan: Plan, network: Network, driver: Driver | DriverModel) -> Driven:
    """Run a plan with another driver."""
    changed = plan.model_copy(update={"takeover": plan.takeover.model_copy(update={"driver": driver})})
    with open_world("kinematic", changed, network) as world:
        outcome = judge(changed, run(changed, world, SEED))
    return Driven(
        result=outcome.result,
        cause=words_of(outcome.cause),
        request=_value(outcome, "request_time"),
        takeover_time=_value(outcome, "takeover_time"),
        minimum_ttc=_value(outcome, "minimum_time_to_collision"),
        outcome=outcome_words(outcome),
        broken=tuple(one.criterion for one in outcome.criteria if not one.passed),
    )


def _value(outcome: Outcome, measure: str) -> float | None:
    found = outcome.measures.get(measure)
    return None if found is None else found.value
