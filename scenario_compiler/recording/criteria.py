"""Criteria: whether a run did what its plan asks of it, when it failed, and why."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.recording.measures import time_to_collision
from scenario_compiler.recording.recording import Booleans, Recording
from scenario_compiler.recording.traces import Traces
from scenario_compiler.vocabulary.criteria import (
    Criterion,
    MinimumTimeToCollision,
    NoCollision,
    ReachDestination,
    StayOnRoad,
)
from scenario_compiler.vocabulary.word import number_value


class CriterionResult(BaseModel):
    """How a run fares by one criterion."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    criterion: str = Field(description="Name of the criterion in the conflict language.")
    passed: bool = Field(description="Whether it holds.")
    when: float | None = Field(default=None, description="Time at which it was first broken, s.")
    why: str = Field(description="A sentence on what was found.")


def judge_criterion(criterion: Criterion, recording: Recording, traces: Traces) -> CriterionResult:
    """Return how a run fares by a criterion."""
    passed, when, why = _JUDGES[type(criterion)](criterion, recording, traces)
    return CriterionResult(criterion=criterion.word, passed=passed, when=when, why=why)


_Judged = tuple[bool, float | None, str]


def _no_collision(criterion: NoCollision, recording: Recording, traces: Traces) -> _Judged:
    del criterion, traces
    crash = next((event for event in recording.events if event.kind == "collision"), None)
    if crash is None:
        return True, None, "nothing was touched"
    with_whom = f" with {crash.entity}" if crash.entity else ""
    return False, crash.t, f"collision{with_whom} at {crash.t:.2f} s"


def _stay_on_road(criterion: StayOnRoad, recording: Recording, traces: Traces) -> _Judged:
    del criterion, recording
    when = _first_time(traces, (traces.road[:, 0] < 0) | (traces.lane[:, 0] == 0))
    if when is None:
        return True, None, "the reference point stayed on a lane"
    return False, when, f"off the lanes from {when:.2f} s"


def _reach_destination(criterion: ReachDestination, recording: Recording, traces: Traces) -> _Judged:
    del criterion
    if recording.stop_reason == "destination":
        return True, None, f"reached after {traces.t[-1]:.2f} s"
    end = float(traces.t[-1]) if len(traces.t) else None
    return False, end, f"the run ended before the destination: {recording.stop_reason or 'no reason given'}"


def _minimum_ttc(criterion: MinimumTimeToCollision, recording: Recording, traces: Traces) -> _Judged:
    limit = number_value(criterion.at_least, recording.header.parameters)
    ttc = time_to_collision(traces)
    when = _first_time(traces, ttc < limit)
    least = float(np.fmin.reduce(ttc, initial=np.nan))
    found = "nothing was closed in on" if np.isnan(least) else f"the least was {least:.2f} s"
    return when is None, when, f"{found}, at least {limit:g} s is asked for"


_JUDGES: dict[type[Criterion], Callable[..., _Judged]] = {
    NoCollision: _no_collision,
    StayOnRoad: _stay_on_road,
    ReachDestination: _reach_destination,
    MinimumTimeToCollision: _minimum_ttc,
}


def _first_time(traces: Traces, where: Booleans) -> float | None:
    return float(traces.t[np.argmax(where)]) if where.any() else None
