"""The row of a variant, with its outcome and all measures, from the engine's totals or from a recording.

The measures and criteria are those of `recording`, so that a row says what `outcome.json` of the same run says.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from scenario_compiler.batch.codebook import OUTCOME
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.break_off import QUANTITIES, break_off_text
from scenario_compiler.recording.criteria import fails, limit_of
from scenario_compiler.recording.measures import MEASURES, measures_of
from scenario_compiler.recording.names import CAUSES, STOP_REASONS
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.resolution import resolutions
from scenario_compiler.recording.takeovers import takeovers_of_totals
from scenario_compiler.recording.totals import RunTotals, finite_or_none
from scenario_compiler.vocabulary.driver import ReferenceName

Columns = dict[str, list[Any]]
"""Rows by column."""

TAKEOVERS = "takeovers"
"""Column of the takeovers of each run, which have a table of their own; each is the values of a `Takeover`'s fields."""


def rows_of_totals(
    plan: Plan,
    totals: RunTotals,
    parameters: Sequence[Mapping[str, Value]],
    avoided: Sequence[Mapping[ReferenceName, bool]],
) -> Columns:
    """Return the outcome and measures of runs; a run that broke off has no measures.

    Args:
        plan: The plan of all of them.
        totals: Their totals.
        parameters: Each run's values of the plan's parameters.
        avoided: For each run whether the reference drivers that criteria name have no collision.
    """
    stops = [str(STOP_REASONS[code]) for code in totals.code("stop")]
    errors = _errors(plan, totals)
    reached = np.array([stop == "destination" for stop in stops])
    failed: list[list[str]] = [[] for _ in parameters]
    for criterion in plan.criteria:
        limit = np.array([limit_of(criterion, *of_run) for of_run in zip(parameters, avoided, strict=True)])
        for names, broken in zip(failed, fails(criterion, totals, reached, limit), strict=True):
            if broken:
                names.append(criterion.word)
    columns: Columns = {
        "result": [
            "error" if error else "fail" if names else "pass" for error, names in zip(errors, failed, strict=True)
        ],
        "error": errors,
        "stop_reason": stops,
        "duration": totals.last_time.tolist(),
        "resolution": resolutions(totals.times),
        "cause": [
            "" if np.isnan(first) else CAUSES[int(first)] for first in totals.of_takeovers("takeover_cause")[:, 0]
        ],
        "collision_with": [plan.entities[one].id if one >= 0 else None for one in totals.code("collided_with")],
        "failed": [" ".join(names) for names in failed],
        "avoided_by": [_avoiders(verdicts) for verdicts in avoided],
    }
    columns[TAKEOVERS] = takeovers_of_totals(totals)
    sound = np.array([not error for error in errors])
    measured = measures_of(plan)
    for measure in MEASURES:
        values = np.where(sound, measure.total(totals), np.nan) if measure in measured else np.full(len(stops), np.nan)
        columns[measure.name] = finite_or_none(values)
    return columns


def _errors(plan: Plan, totals: RunTotals) -> list[str]:
    """Return why each run broke off; empty for one that did not."""
    ids = [entity.id for entity in plan.entities]
    times = totals.raw("flag_time").tolist()
    values = np.stack([totals.raw(f"flag_{name}") for name in QUANTITIES], axis=1).tolist()
    return [
        break_off_text(code, at, ids, dict(zip(QUANTITIES, of_entity, strict=True)), t) if code else ""
        for code, at, of_entity, t in zip(totals.code("flag"), totals.code("flag_at"), values, times, strict=True)
    ]


def row_of_recording(plan: Plan, recording: Recording) -> Columns:
    """Return the outcome and measures of one run as columns of one row."""
    outcome = judge(plan, recording)
    broken = outcome.result == "error"
    columns: Columns = {
        "result": [outcome.result],
        "error": [_why_broken(recording)],
        "stop_reason": [outcome.stop_reason],
        "duration": [outcome.duration],
        "resolution": [outcome.resolution],
        "cause": [outcome.cause],
        "collision_with": [outcome.collision_with],
        "failed": [" ".join(one.criterion for one in outcome.criteria if not one.passed)],
        "avoided_by": [_avoiders(recording.header.avoided)],
    }
    columns[TAKEOVERS] = [[tuple(vars(one).values()) for one in outcome.takeovers]]
    values = {} if broken else {name: measure.value for name, measure in outcome.measures.items()}
    return columns | {measure.name: [values.get(measure.name)] for measure in MEASURES}


def error_columns(count: int, error: str) -> Columns:
    """Return the outcome of variants without a run."""
    columns: Columns = {name: [None] * count for name in (*OUTCOME, *(measure.name for measure in MEASURES))}
    return columns | {"result": ["error"] * count, "error": [error] * count, TAKEOVERS: [[] for _ in range(count)]}


def _avoiders(verdicts: Mapping[ReferenceName, bool]) -> str | None:
    """Return the names of the reference drivers without a collision; None if none was asked for."""
    return " ".join(name for name, avoids in verdicts.items() if avoids) if verdicts else None


def _why_broken(recording: Recording) -> str:
    """Return why a run stopped; empty if it did not."""
    told = [event.message for event in recording.events if event.kind == "broken_off"]
    return told[0] if told else ""
