"""The row of a variant: its outcome and every measure, from the arrays of many runs at once.

The measures and criteria are those of `recording`, so that a row says what `outcome.json` of the same run says.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from scenario_compiler.engine.columns.numbers import LARGEST
from scenario_compiler.engine.columns.opcodes import FAR
from scenario_compiler.engine.columns.trace import SUMMARY, TRACE_FIELDS, TRACE_HEAD
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.break_off import break_off_text
from scenario_compiler.recording.criteria import broken_at, limit_of
from scenario_compiler.recording.measures import MEASURES, measures_of
from scenario_compiler.recording.names import CAUSES, STOP_REASONS, EventKind
from scenario_compiler.recording.recording import Booleans, Floats, Recording
from scenario_compiler.recording.resolution import resolutions
from scenario_compiler.recording.traces import SAME_TIME, Traces, traces_of

Columns = dict[str, list[Any]]
"""Rows by column."""

AT = {name: place for place, name in enumerate(SUMMARY)}
HEAD = ("t", "takeover_state", "cause", "conf_left", "conf_right", "health", "blocked", "lane_end")
ENTITY = ("x", "y", "z", "h", "v", "a", "steer", "road", "lane", "s", "off", "throttle", "brake", "present")
"""Fields of the head of a trace's row, and of each entity in it, as the engine writes them."""

MOTION = ("x", "y", "h", "v")
"""Fields of an entity that the measures of every plan look at."""

OUTCOME = ("result", "error", "stop_reason", "duration", "resolution", "cause", "collision_with", "failed")
"""Columns of the outcome, before the measures."""


@dataclass(frozen=True)
class Ends:
    """How runs ended, one of each list a run.

    Attributes:
        stop_reason: Why it stopped.
        error: The fault in words; empty for none.
        cause: Cause of the first request; empty without one.
        collision_with: Id of the first entity that the ego vehicle hit.
    """

    stop_reason: list[str]
    error: list[str]
    cause: list[str]
    collision_with: list[str | None]


def outcome_columns(plan: Plan, traces: Traces, ends: Ends, parameters: Sequence[Mapping[str, Value]]) -> Columns:
    """Return the outcome and measures of runs; a run that broke off has no measures.

    Args:
        plan: The plan of all of them.
        traces: Their arrays, with one leading axis.
        ends: How they ended.
        parameters: Each run's values of the plan's parameters.
    """
    reached = np.array([reason == "destination" for reason in ends.stop_reason])
    failed: list[list[str]] = [[] for _ in parameters]
    for criterion in plan.criteria:
        limit = np.array([limit_of(criterion, values) for values in parameters])
        for names, broken in zip(failed, broken_at(criterion, traces, reached, limit), strict=True):
            if not math.isnan(broken):
                names.append(criterion.word)
    columns: Columns = {
        "result": [
            "error" if error else "fail" if names else "pass" for error, names in zip(ends.error, failed, strict=True)
        ],
        "error": ends.error,
        "stop_reason": ends.stop_reason,
        "duration": np.fmax.reduce(traces.t, axis=-1, initial=0.0).tolist(),
        "resolution": resolutions(traces.times),
        "cause": ends.cause,
        "collision_with": ends.collision_with,
        "failed": [" ".join(names) for names in failed],
    }
    sound = np.array([not error for error in ends.error])
    measured = measures_of(plan)
    for measure in MEASURES:
        values = np.where(sound, measure.compute(traces) if measure in measured else np.nan, np.nan)
        columns[measure.name] = [value if math.isfinite(value) else None for value in values.tolist()]
    return columns


def error_columns(count: int, error: str) -> Columns:
    """Return the outcome of variants that have no run."""
    columns: Columns = {name: [None] * count for name in (*OUTCOME, *(measure.name for measure in MEASURES))}
    return columns | {"result": ["error"] * count, "error": [error] * count}


def from_recording(plan: Plan, recording: Recording) -> tuple[Traces, Ends]:
    """Return one run as arrays with a leading axis of length 1, and how it ended."""
    traces = traces_of(plan, recording)
    arrays = {
        field.name: getattr(traces, field.name)[None]
        for field in fields(Traces)
        if field.name not in ("length", "width", "center", "times")
    }
    single = Traces(
        **arrays,
        length=traces.length,
        width=traces.width,
        center=traces.center,
        times={kind: value[None] for kind, value in traces.times.items()},
    )
    request = next((event for event in recording.events if event.kind == "request"), None)
    crash = next((event for event in recording.events if event.kind == "collision"), None)
    return single, Ends(
        stop_reason=[recording.stop_reason],
        error=[_why_broken(recording)],
        cause=[request.cause if request else ""],
        collision_with=[crash.entity if crash else None],
    )


def from_sweep(plan: Plan, summaries: Floats, flat: Floats) -> tuple[Traces, Ends]:
    """Return what the engine's sweep wrote as arrays with a leading axis, and how the runs ended.

    Args:
        plan: The plan of all of them.
        summaries: (runs, SUMMARY_SIZE).
        flat: Traces with a row each step, (runs, rows times numbers of a row), longer than any run.
    """
    written = _written(plan, summaries, flat)
    blocked, lane_end = written.head("blocked"), written.head("lane_end")
    road, lane, s, off = _lane_places(written)
    vehicles = [entity.vehicle for entity in plan.entities]
    traces = Traces(
        t=written.head("t"),
        present=np.moveaxis(~written.gone, 0, -1),
        x=written.body("x"),
        y=written.body("y"),
        h=_within_a_turn(written.body("h")),
        v=written.body("v"),
        a=written.body("a"),
        road=road.astype(np.int64),
        lane=lane.astype(np.int64),
        s=s,
        off=off,
        brake=written.body("brake"),
        cause=written.head("cause", 0.0).astype(np.int64),
        confidence_left=written.head("conf_left"),
        confidence_right=written.head("conf_right"),
        blocked_distance=np.where(blocked >= FAR, np.nan, blocked),
        lane_end_distance=np.where(lane_end >= FAR, np.nan, lane_end),
        length=np.array([vehicle.length for vehicle in vehicles]),
        width=np.array([vehicle.width for vehicle in vehicles]),
        center=np.array([vehicle.center for vehicle in vehicles]),
        times=_first_times(summaries),
    )
    return traces, _ends(plan, summaries, traces)


@dataclass(frozen=True)
class _Written:
    """Traces of many runs as the engine's sweep wrote them, the fields of a row outermost.

    Attributes:
        whole: (numbers of a row, runs, longest).
        over: Where a run had ended, (runs, longest).
        gone: Where an entity was not there, or its run over, (entities, runs, longest).
        judged: Whether the plan has takeovers or criteria; what only they look at is left out otherwise.
        any_over: Whether a run ended before another.
        any_gone: Whether an entity was ever gone.
    """

    whole: Floats
    over: Booleans
    gone: Booleans
    judged: bool
    any_over: bool
    any_gone: bool

    def head(self, name: str, nothing: float = np.nan) -> Floats:
        """Return a field of the run, (runs, longest)."""
        if not self.judged and name != "t":
            return np.broadcast_to(nothing, self.over.shape)
        values: Floats = self.whole[HEAD.index(name)].copy()
        if self.any_over:
            values[self.over] = nothing
        return values

    def body(self, name: str, nothing: float = np.nan) -> Floats:
        """Return a field of all entities, (runs, longest, entities), the entities outermost in memory."""
        if not self.judged and name not in MOTION:
            return np.broadcast_to(nothing, (*self.over.shape, len(self.gone)))
        values: Floats = self.whole[TRACE_HEAD + ENTITY.index(name) :: TRACE_FIELDS].copy()
        if self.any_gone:
            values[self.gone] = nothing
        return np.moveaxis(values, 0, -1)


def _written(plan: Plan, summaries: Floats, flat: Floats) -> _Written:
    runs = len(summaries)
    width = TRACE_HEAD + TRACE_FIELDS * len(plan.entities)
    rows = summaries[:, AT["rows"]].astype(np.int64)
    longest = int(rows.max(initial=0))
    whole: Floats = np.moveaxis(flat.reshape(runs, -1, width)[:, :longest], -1, 0)
    over = np.arange(longest) >= rows[:, None]
    gone = over | (whole[TRACE_HEAD + ENTITY.index("present") :: TRACE_FIELDS] == 0.0)
    judged = plan.controller is not None or bool(plan.criteria)
    return _Written(whole, over, gone, judged, any_over=bool(over.any()), any_gone=bool(gone.any()))


def _lane_places(written: _Written) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the entities' roads, lanes, s and offsets, the last three 0 off the roads."""
    road, lane = written.body("road", -1.0), written.body("lane", 0.0)
    s, off = written.body("s"), written.body("off")
    if not written.judged:
        return road, lane, s, off
    off_road = road < 0.0
    return road, np.where(off_road, 0.0, lane), np.where(off_road, 0.0, s), np.where(off_road, 0.0, off)


def _within_a_turn(h: Floats) -> Floats:
    """Return headings in [0, 2 pi), changed in place where there are others."""
    turn = 2 * np.pi
    around = ~((h >= 0) & (h < turn))
    if around.any():
        h[around] = np.mod(h[around], turn)
    return h


def _first_times(summaries: Floats) -> dict[EventKind, Floats]:
    kinds: dict[EventKind, str] = {
        "warning": "time_warning",
        "request": "time_request",
        "escalation": "time_escalation",
        "response": "time_response",
        "minimum_risk": "time_minimum_risk",
        "standstill": "time_standstill",
        "collision": "ego_collision_time",
    }
    return {kind: _or_nan(summaries[:, AT[column]]) for kind, column in kinds.items()}


def _or_nan(times: Floats) -> Floats:
    return np.where(times < 0.0, np.nan, times)


def _ends(plan: Plan, summaries: Floats, traces: Traces) -> Ends:
    stops = [STOP_REASONS[int(code)] for code in summaries[:, AT["stop"]]]
    faults = [int(code) for code in summaries[:, AT["flag"]]]
    request = traces.times["request"]
    later = traces.t > request[:, None] + SAME_TIME
    row = np.where(later.any(axis=-1), np.argmax(later, axis=-1), np.maximum((~np.isnan(traces.t)).sum(axis=-1) - 1, 0))
    cause = traces.cause[np.arange(len(row)), row]
    hit = summaries[:, AT["ego_collision_with"]].astype(np.int64)
    return Ends(
        stop_reason=[str(stop) for stop in stops],
        error=[_fault(plan, traces, run, code) for run, code in enumerate(faults)],
        cause=["" if math.isnan(t) else CAUSES[int(code)] for t, code in zip(request, cause, strict=True)],
        collision_with=[plan.entities[one].id if one >= 0 else None for one in hit],
    )


def _why_broken(recording: Recording) -> str:
    """Return why a run could not go on; empty where it could."""
    told = [event.message for event in recording.events if event.kind == "broken_off"]
    return told[0] if told else ""


def _fault(plan: Plan, traces: Traces, run: int, code: int) -> str:
    """Return why the engine ended a run, empty where it did not: of which entity its last row tells."""
    if code == 0:
        return ""
    last = max(int((~np.isnan(traces.t[run])).sum()) - 1, 0)
    columns = {name: getattr(traces, name)[run, last].tolist() for name in MOTION}
    wrong = [any(not abs(columns[name][at]) < LARGEST for name in MOTION) for at in range(len(plan.entities))]
    at = wrong.index(True) if True in wrong else -1
    t = float(np.nan_to_num(traces.t[run, last]))
    return break_off_text(code, at, [entity.id for entity in plan.entities], columns, t)
