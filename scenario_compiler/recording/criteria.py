"""Criteria: whether a run meets those of its plan, and when and why it failed."""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from scenario_compiler.engine.columns.numbers import SAME_TIME
from scenario_compiler.expressions import Value
from scenario_compiler.recording.durations import Timed
from scenario_compiler.recording.measures import cause_of_request
from scenario_compiler.recording.names import CAUSES, EventKind
from scenario_compiler.recording.on_path import least_time_to_collision, time_to_collision
from scenario_compiler.recording.recording import Booleans, Floats, Recording
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces
from scenario_compiler.records import Record, field
from scenario_compiler.vocabulary.criteria import (
    Criterion,
    MakesProgress,
    MaximumLateralOffset,
    MinimumTimeToCollision,
    NoAvoidableCollision,
    NoCollision,
    NoMinimumRisk,
    NoObstruction,
    ReachDestination,
    Requested,
    StayOnRoad,
    TakeoverWithin,
)
from scenario_compiler.vocabulary.driver import ReferenceName
from scenario_compiler.vocabulary.horizon import HORIZON
from scenario_compiler.vocabulary.word import number_value

NOBODY: Mapping[ReferenceName, bool] = {}
"""Verdicts of no reference driver."""


class Where(Record):
    """The place of the judged vehicle at a time."""

    road: str | None = field(description="Road below its reference point; null off every road.")
    lane: int | None = field(description="Lane; null off every road.")
    s: float | None = field(description="Distance along the road's reference line, m; null off every road.")
    x: float = field(description="x of the reference point, m.")
    y: float = field(description="y of the reference point, m.")


class CriterionResult(Record):
    """The result of a criterion for a run."""

    criterion: str = field(description="Name of the criterion in the conflict language.")
    passed: bool = field(description="Whether it holds.")
    when: float | None = field(default=None, description="Time at which it was first broken, s.")
    where: Where | None = field(
        default=None, description="Position of the vehicle at that time; null if it was not present."
    )
    why: str = field(description="The reason, as a sentence.")


class Rule(NamedTuple):
    """The functions that judge a criterion.

    Attributes:
        broken_at: From the criterion, traces, which runs reached their destination (...) and the criterion's limits
            (...): the time at which each run first broke it, s, (...); NaN if it holds.
        fails: From the criterion, totals and the same: which runs broke it, (runs,).
        found: Returns a description of what is found in a recording.
    """

    broken_at: Callable[[Criterion, Traces, Booleans, Floats], Floats]
    fails: Callable[[Criterion, RunTotals, Booleans, Floats], Booleans]
    found: Callable[[Recording, Traces, float | None, float], str]


def broken_at(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    """Return the time at which each run first broke a criterion, s, (...); NaN if it holds.

    Args:
        criterion: The criterion.
        traces: The runs.
        reached: Which runs ended at their destination, (...).
        limit: The criterion's limit for each run, from `limit_of`, (...).
    """
    return RULES[type(criterion)].broken_at(criterion, traces, reached, limit)


def fails(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    """Return which runs broke a criterion, (runs,), from their totals; the arguments are those of `broken_at`."""
    return RULES[type(criterion)].fails(criterion, totals, reached, limit)


def _event(kind: EventKind) -> tuple[Callable[..., Floats], Callable[..., Booleans]]:
    """Return the two functions for a criterion that the first event of a kind breaks."""

    def first_time(criterion: Criterion, runs: Timed, reached: Booleans, limit: Floats) -> Floats:
        del criterion, reached, limit
        return runs.times[kind]

    def happened(criterion: Criterion, runs: Timed, reached: Booleans, limit: Floats) -> Booleans:
        del criterion, reached, limit
        return ~np.isnan(runs.times[kind])

    return first_time, happened


def _off_road(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    del reached, limit
    assert isinstance(criterion, StayOnRoad)
    return _first_time(traces, _off_the_road(traces) & criterion.required)


def _off_the_road(traces: Traces) -> Booleans:
    """Return the rows off the road up to the first collision, (..., n)."""
    return ~traces.on_road & traces.present[..., 0] & traces.until_collision


def _was_off_road(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    del reached, limit
    assert isinstance(criterion, StayOnRoad)
    return ~np.isnan(totals.column("time_off_road")) & criterion.required


def _not_reached(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    del criterion, limit
    return np.where(reached, np.nan, traces.last_time)


def _never_reached(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    del criterion, totals, limit
    return ~reached


def _late_response(criterion: Criterion, runs: Traces | RunTotals, reached: Booleans, limit: Floats) -> Floats:
    """Return the time by which the driver should have responded but did not, s; NaN otherwise.

    It is the time of a collision before that, after which nobody responds.
    """
    del criterion, reached
    due = np.minimum(runs.times["request"] + limit, np.fmin(runs.times["collision"], np.inf))
    response = runs.times["response"]
    late = np.where(np.isnan(response), runs.last_time >= due - SAME_TIME, response > due + SAME_TIME)
    return np.where(late, due, np.nan)


def _responded_late(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    return ~np.isnan(_late_response(criterion, totals, reached, limit))


def _not_requested(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    del reached, limit
    requested = _was_requested(criterion, traces, cause_of_request(traces))
    return np.where(requested, np.nan, traces.last_time)


def _never_requested(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    del reached, limit
    return ~_was_requested(criterion, totals, totals.column("request_cause"))


def _was_requested(criterion: Criterion, runs: Timed, cause: Floats) -> Booleans:
    """Return which runs had a request whose first cause is the criterion's."""
    assert isinstance(criterion, Requested)
    asked = ~np.isnan(runs.times["request"])
    if criterion.cause is None:
        return asked
    code = next(code for code, name in CAUSES.items() if name == criterion.cause)
    return np.asarray(asked & (cause == code))


def _too_far_off(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    del criterion, reached
    far = (np.abs(traces.off[..., 0]) > limit[..., None]) | (traces.lane[..., 0] == 0)
    return _first_time(traces, far & traces.present[..., 0] & traces.until_collision)


def _was_too_far_off(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    del criterion, reached
    return np.asarray((totals.column("greatest_offset") > limit) | (totals.raw("rows_off_lanes") > 0))


def _too_soon(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    del criterion, reached
    return _first_time(traces, time_to_collision(traces, limit) < limit[..., None])


def _was_too_soon(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    del criterion, reached
    return np.asarray(totals.column("least_time_to_collision") < limit)


def _avoidable(criterion: Criterion, traces: Traces, reached: Booleans, limit: Floats) -> Floats:
    del criterion, reached
    return np.where(limit > 0.0, traces.times["collision"], np.nan)


def _was_avoidable(criterion: Criterion, totals: RunTotals, reached: Booleans, limit: Floats) -> Booleans:
    del criterion, reached
    return np.asarray((limit > 0.0) & ~np.isnan(totals.times["collision"]))


def limit_of(
    criterion: Criterion, parameters: Mapping[str, Value], avoided: Mapping[ReferenceName, bool] = NOBODY
) -> float:
    """Return the number with which a criterion compares; NaN if it has none.

    Args:
        criterion: The criterion.
        parameters: Values of the plan's parameters.
        avoided: Whether each reference driver avoids a collision in this run; a criterion on one has the limit 1 or 0.
    """
    if isinstance(criterion, NoAvoidableCollision):
        return float(avoided.get(criterion.by, False))
    if isinstance(criterion, MinimumTimeToCollision):
        return number_value(criterion.at_least, parameters)
    if isinstance(criterion, TakeoverWithin):
        return number_value(criterion.time, parameters)
    if isinstance(criterion, MaximumLateralOffset):
        return number_value(criterion.at_most, parameters)
    return math.nan


def judge_criterion(criterion: Criterion, recording: Recording, traces: Traces) -> CriterionResult:
    """Return the result of a criterion for a run."""
    limit = limit_of(criterion, recording.header.parameters, recording.header.avoided)
    reached = np.asarray(recording.stop_reason == "destination")
    broken = float(broken_at(criterion, traces, reached, np.asarray(limit)))
    when = None if math.isnan(broken) else broken
    why = RULES[type(criterion)].found(recording, traces, when, limit)
    where = None if when is None else where_at(recording, when)
    return CriterionResult.model_construct(
        criterion=criterion.word, passed=when is None, when=when, where=where, why=why
    )


def where_at(recording: Recording, when: float) -> Where | None:
    """Return the first entity's place in the last row that is not after a time, s.

    It is None if the entity was absent, or if its position was not finite, as when the engine stops.
    """
    row = int(np.searchsorted(recording.t, when + SAME_TIME, side="right")) - 1
    if row < 0 or not recording.present[row, 0]:
        return None
    x, y, road = float(recording.x[row, 0]), float(recording.y[row, 0]), int(recording.road[row, 0])
    if not math.isfinite(x) or not math.isfinite(y):
        return None
    if road < 0:
        return Where.model_construct(road=None, lane=None, s=None, x=x, y=y)
    lane, s = int(recording.lane[row, 0]), float(recording.s[row, 0])
    return Where.model_construct(road=recording.roads[road], lane=lane, s=s, x=x, y=y)


def _collision_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del traces, limit
    if when is None:
        return "nothing was touched"
    whom = next((event.entity for event in recording.events if event.kind == "collision"), "")
    if not whom:
        whom = next((event.message for event in recording.events if event.kind == "world_collision"), "")
    return f"collision{f' with {whom}' if whom else ''} at {when:.2f} s"


def _road_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, limit
    off = float(_first_time(traces, _off_the_road(traces)))
    if math.isnan(off):
        return "the reference point stayed on the road"
    return f"off the road from {off:.2f} s" + (", which is allowed" if when is None else "")


def _destination_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del limit
    if when is None:
        return f"reached after {traces.t[-1]:.2f} s"
    return f"the run ended before the destination: {recording.stop_reason or 'no reason given'}"


def _least_time_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, when
    least = float(least_time_to_collision(traces))
    none = f"nothing would have been reached within {HORIZON:g} s"
    found = none if math.isnan(least) else f"the least was {least:.2f} s"
    return f"{found}, at least {limit:g} s is required"


def _response_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording
    if np.isnan(traces.times["request"]):
        return "no request was made"
    request, response, collision = (float(traces.times[kind]) for kind in ("request", "response", "collision"))
    said = f"the driver responded after {response - request:.2f} s"
    if math.isnan(response):
        end, what = (traces.last_time, "end of the run") if math.isnan(collision) else (collision, "collision")
        said = f"the driver did not respond in the {end - request:.2f} s until the {what}"
    return said if when is None else f"{said}, at most {limit:g} s are allowed"


def _request_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del traces, when, limit
    request = next((event for event in recording.events if event.kind == "request"), None)
    return "no request was made" if request is None else f"requested at {request.t:.2f} s for {request.cause}"


def _minimum_risk_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, traces, limit
    return "none was begun" if when is None else f"begun at {when:.2f} s"


def _progress_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, traces, limit
    return "the vehicle never stood without a reason" if when is None else f"it stood without a reason at {when:.2f} s"


def _obstruction_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, traces, limit
    return "no lane was obstructed" if when is None else f"it stands in a lane that goes on, from {when:.2f} s on"


def _offset_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, when
    counts = traces.present[..., 0] & traces.until_collision
    off_lanes = float(_first_time(traces, counts & (traces.lane[..., 0] == 0)))
    greatest = float(np.abs(traces.off[..., 0][counts]).max(initial=0.0))
    left = "" if math.isnan(off_lanes) else f"off every lane from {off_lanes:.2f} s; on lanes "
    return f"{left}the greatest was {greatest:.2f} m, at most {limit:g} m is allowed"


def _avoidable_found(recording: Recording, traces: Traces, when: float | None, limit: float) -> str:
    del recording, when
    if np.isnan(traces.times["collision"]):
        return "nothing was touched"
    would = "would have avoided it" if limit > 0.0 else "would not have avoided it"
    return f"collision at {float(traces.times['collision']):.2f} s, the reference driver {would}"


RULES: dict[type[Criterion], Rule] = {
    NoCollision: Rule(*_event("collision"), _collision_found),
    StayOnRoad: Rule(_off_road, _was_off_road, _road_found),
    ReachDestination: Rule(_not_reached, _never_reached, _destination_found),
    MinimumTimeToCollision: Rule(_too_soon, _was_too_soon, _least_time_found),
    TakeoverWithin: Rule(_late_response, _responded_late, _response_found),
    Requested: Rule(_not_requested, _never_requested, _request_found),
    NoMinimumRisk: Rule(*_event("minimum_risk"), _minimum_risk_found),
    MakesProgress: Rule(*_event("no_progress"), _progress_found),
    NoObstruction: Rule(*_event("obstruction"), _obstruction_found),
    MaximumLateralOffset: Rule(_too_far_off, _was_too_far_off, _offset_found),
    NoAvoidableCollision: Rule(_avoidable, _was_avoidable, _avoidable_found),
}
"""The rule of each criterion of the vocabulary."""


def _first_time(traces: Traces, where: Booleans) -> Floats:
    return np.asarray(np.fmin.reduce(np.where(where, traces.t, np.nan), axis=-1, initial=np.nan))
