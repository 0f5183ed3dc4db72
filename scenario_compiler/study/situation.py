"""The queries of a freeze probe: their true answers, read from the frozen row, and whether a given answer is right."""

from __future__ import annotations

import numpy as np

from scenario_compiler.engine.columns.opcodes import FAR
from scenario_compiler.live.wheel import DRIVEN_BY_HAND
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.names import TAKEOVER_STATES
from scenario_compiler.recording.recording import Recording
from scenario_compiler.source.study import Query, QueryAbout
from scenario_compiler.vocabulary.entities import Category

AROUND = 100.0
"""Distance within which vehicles are counted, m."""

VEHICLES: frozenset[Category] = frozenset({"car", "van", "truck", "bus", "motorbike", "bicycle"})
"""Categories of entities that count as vehicles: not pedestrians, cones, barriers, signs and other objects."""

CHOICES: dict[QueryAbout, tuple[str, ...]] = {"control": ("automation", "me"), "blocked": ("yes", "no")}
"""Possible answers to queries that are not answered with a number."""


def true_answer(about: QueryAbout, plan: Plan, recording: Recording, t: float) -> float | str:
    """Return the true answer at a time of a plan's run, s: km/h, a count, or one of `CHOICES`."""
    row = min(int(np.searchsorted(recording.t, t - 1e-9)), len(recording.t) - 1)
    if about == "speed":
        return round(3.6 * float(recording.v[row, 0]), 1)
    if about == "vehicles":
        counted = [one.vehicle.category in VEHICLES for one in plan.entities[1:]]
        there = recording.present[row, 1:].astype(bool) & np.array(counted, dtype=bool)
        x, y = recording.x[row], recording.y[row]
        return int(np.count_nonzero(there & (np.hypot(x[1:] - x[0], y[1:] - y[0]) <= AROUND)))
    if about == "control":
        return "me" if TAKEOVER_STATES[int(recording.takeover_state[row])] in DRIVEN_BY_HAND else "automation"
    return "yes" if float(recording.blocked_distance[row]) < FAR else "no"


def is_right(query: Query, given: str, true: float | str) -> bool:
    """Return whether a given answer is right."""
    if isinstance(true, str):
        return given == true
    try:
        return abs(float(given) - true) <= query.tolerance + 1e-9
    except ValueError:
        return False
