"""The outcome of a run: the judged criteria, the takeover's timeline and the measures, as outcome.json."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from scenario_compiler.engine.columns.opcodes import STANDING
from scenario_compiler.files import read_file
from scenario_compiler.outputs import write_whole
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.criteria import CriterionResult, judge_criterion
from scenario_compiler.recording.decimals import to_the_nanosecond
from scenario_compiler.recording.measures import MEASURES, Measure, measures_of
from scenario_compiler.recording.names import (
    BROKEN_OFF,
    BY_HAND,
    STANDING_PLACES,
    STATE_AFTER,
    StandingPlace,
    StopReason,
    TimelineState,
)
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.resolution import MEANINGS, Resolution, resolutions
from scenario_compiler.recording.takeovers import Takeover, takeovers_of
from scenario_compiler.recording.traces import Traces, traces_of
from scenario_compiler.records import Record, field


class Interval(Record):
    """An interval of time in one state of the takeover."""

    state: TimelineState = field(description="The state; `collision` from the first collision on.")
    begin: float = field(description="Begin, s.")
    end: float = field(description="End, s.")


class MeasureValue(Record):
    """A measure of the run."""

    value: float | None = field(description="The value; null if the measure is not defined.")
    unit: str = field(description="SI unit.")
    definition: str = field(description="How it is computed.")
    source: str = field(default="", description="Source of the definition; empty for our own.")
    undefined: str = field(default="", description="Why the value is null.")


class Outcome(Record):
    """The outcome of a run."""

    format: Literal["scenario-compiler/outcome/1"] = field(
        default="scenario-compiler/outcome/1", description="Version of this format."
    )
    name: str = field(description="Name of the scenario.")
    plan_digest: str = field(description="Digest of the plan.")
    seed: int = field(description="Seed of the run.")
    variant: int = field(default=0, description="Index of the variant in a sweep.")
    result: Literal["pass", "fail", "error"] = field(
        description="pass if all criteria are met; error if the run broke off."
    )
    resolution: Resolution = field(
        description="How the first request ended: "
        + "; ".join(f"{name}: {meaning}" for name, meaning in MEANINGS.items())
        + "."
    )
    cause: str = field(default="", description="Cause of the first request; empty without a request.")
    collision_with: str | None = field(
        default=None,
        description="Id of the first entity with which the ego vehicle collided; null without a collision, and empty "
        "if the world's own physics reported a collision with something that the scenario does not have.",
    )
    stands: StandingPlace = field(
        default="",
        description="Where the vehicle stands after a minimum-risk manoeuvre or a driver's stop: own_lane, other_lane, "
        "shoulder, across_edge (part of it beyond the edge of its lane or shoulder), off_road; empty if it was not "
        "stopped.",
    )
    stop_reason: StopReason = field(description="Why the run ended.")
    error: int = field(default=0, description="The engine's fault code; 0 for none.")
    duration: float = field(description="Time of the last row, s.")
    criteria: tuple[CriterionResult, ...] = field(description="Results of the plan's criteria.")
    timeline: tuple[Interval, ...] = field(
        description="The takeover's states in order, up to the first collision; empty without an automated vehicle."
    )
    takeovers: tuple[Takeover, ...] = field(default=(), description="All takeovers, one for each request.")
    measures: dict[str, MeasureValue] = field(description="The measures by name, each with the definition used.")
    trajectory_hash: str = field(description="SHA-256 of the trajectories: identical runs have identical hashes.")
    versions: dict[str, str] = field(description="Versions of the software on which the result depends.")


class OtherPlanError(ValueError):
    """A recording is not one of the plan by which it should be judged."""


@np.errstate(over="ignore", invalid="ignore")
def judge(plan: Plan, recording: Recording) -> Outcome:
    """Judge a run by its plan's criteria and measure it.

    Numbers that are too large to be measured, of a run that broke off or of a vehicle of any size, leave measures
    without a value; numpy's warnings about them are not printed.

    Raises:
        OtherPlanError: The recording has other entities than the plan.
    """
    if recording.header.entities != tuple(entity.id for entity in plan.entities):
        raise OtherPlanError(f"the recording of '{recording.header.plan_name}' has other entities than '{plan.name}'")
    traces = traces_of(plan, recording)
    automated = plan.controller is not None
    criteria = tuple(judge_criterion(criterion, recording, traces) for criterion in plan.criteria)
    header = recording.header
    passed = all(one.passed for one in criteria)
    broken = recording.stop_reason in BROKEN_OFF or recording.error != 0
    request = next((event for event in recording.events if event.kind == "request"), None)
    crash = next((event for event in recording.events if event.kind == "collision"), None)
    takeovers = takeovers_of(recording, traces) if automated else ()
    return Outcome.model_construct(
        name=header.plan_name,
        plan_digest=header.plan_digest,
        seed=header.seed,
        variant=header.variant,
        result="error" if broken else "pass" if passed else "fail",
        resolution=takeovers[0].resolution if takeovers else resolutions(traces.times)[0],
        cause=request.cause if request else "",
        collision_with=crash.entity if crash else None,
        stands=standing_place(recording),
        stop_reason=recording.stop_reason,
        error=recording.error,
        duration=float(recording.t[-1]) if len(recording.t) else 0.0,
        criteria=criteria,
        timeline=timeline(recording) if automated else (),
        takeovers=takeovers,
        measures=measure_run(traces, measures_of(plan)),
        trajectory_hash=recording.trajectory_hash,
        versions=dict(sorted(header.versions.items())),
    )


def standing_place(recording: Recording) -> StandingPlace:
    """Return where the vehicle stands if the run ended with a standstill, else empty."""
    stops = [event for event in recording.events if event.kind == "standstill"]
    if recording.stop_reason not in ("standstill", "duration") or not stops:
        return ""
    if not len(recording.v) or recording.v[-1, 0] >= STANDING:
        return ""
    return next((place for place in STANDING_PLACES.values() if place == stops[-1].message), "")


def measure_run(traces: Traces, measures: Sequence[Measure] = MEASURES) -> dict[str, MeasureValue]:
    """Return these measures of one run."""
    if not len(traces.t):
        return {}
    values = {measure.name: float(measure.compute(traces)) for measure in measures}
    return {
        m.name: MeasureValue.model_construct(
            value=values[m.name] if np.isfinite(values[m.name]) else None,
            unit=m.unit,
            definition=m.definition,
            source=m.source,
            undefined="" if np.isfinite(values[m.name]) else m.undefined,
        )
        for m in measures
    }


def timeline(recording: Recording) -> tuple[Interval, ...]:
    """Return the takeover's states from the first row to the last; events mark their begins, a collision the last."""
    if not len(recording.t):
        return ()
    begin, end = float(recording.t[0]), float(recording.t[-1])
    states: list[tuple[float, TimelineState]] = [(begin, "automated")]
    for event in recording.events:
        state = STATE_AFTER.get(event.kind)
        if state is None or state == states[-1][1] or event.cause == BY_HAND:
            continue
        if event.t <= states[-1][0]:
            states.pop()
        states.append((min(event.t, end), state))
        if state == "collision":
            break
    ends = [at for at, _ in states[1:]] + [end]
    return tuple(
        Interval.model_construct(state=state, begin=to_the_nanosecond(at), end=to_the_nanosecond(until))
        for (at, state), until in zip(states, ends, strict=True)
    )


class OutcomeError(ValueError):
    """The file is not a readable outcome."""


def write_outcome(outcome: Outcome, path: Path) -> None:
    """Write outcome.json: keys sorted, undefined numbers as null."""
    text = json.dumps(outcome.model_dump(mode="json"), indent=2, sort_keys=True, allow_nan=False, ensure_ascii=False)
    write_whole(path, text + "\n")


def read_outcome(path: Path) -> Outcome:
    """Read an outcome back; raises OutcomeError if the file does not contain one."""
    from pydantic import ValidationError

    try:
        return Outcome.model_validate_json(read_file(path))
    except ValidationError as problem:
        fault = problem.errors(include_url=False)[0]
        where = "".join(f"{part}: " for part in fault["loc"])
        raise OutcomeError(f"{path} is not an outcome: {where}{fault['msg']}") from problem
