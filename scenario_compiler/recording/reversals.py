"""The steering reversal rate, from recordings and from the engine's totals (`engine.measures.reversals`)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from scenario_compiler.engine.measures.reversals import cut_off, least_gap
from scenario_compiler.recording.recording import Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces

COARSE, FINE = 0, 1
"""Index of the usual variant, and of the variant for small corrections, in the engine."""

LEAST = 5.0
"""Least duration for which a rate is given, s: our own choice."""


def coarse_rate(traces: Traces) -> Floats:
    """Return the steering reversals per minute of the usual variant, (...)."""
    return _rate(traces, COARSE)


def fine_rate(traces: Traces) -> Floats:
    """Return the steering reversals per minute of the variant for small corrections, (...)."""
    return _rate(traces, FINE)


def coarse_total(totals: RunTotals) -> Floats:
    """Return the same as `coarse_rate`, (runs,)."""
    return _a_minute(totals.raw("coarse_reversals"), totals.raw("driven_rows"), totals.step, COARSE)


def fine_total(totals: RunTotals) -> Floats:
    """Return the same as `fine_rate`, (runs,)."""
    return _a_minute(totals.raw("fine_reversals"), totals.raw("driven_rows"), totals.step, FINE)


def _rate(traces: Traces, variant: int) -> Floats:
    wheel = traces.steer[..., 0] * traces.inputs.steering_ratio
    shape = traces.t.shape[:-1]
    at_response = traces.at_response(wheel)
    found, rows = np.zeros(shape), np.zeros(shape)
    for index in np.ndindex(*shape):
        angles, start = wheel[index][traces.driven[index]].tolist(), float(at_response[index])
        smooth = smoothed(angles, cut_off(variant), traces.step, start)
        found[index], rows[index] = reversals(smooth, least_gap(variant), start), len(angles)
    return _a_minute(found, rows, traces.step, variant)


def _a_minute(counts: Floats, rows: Floats, step: float, variant: int) -> Floats:
    """Return counts per minute; NaN if the rows are too few, or too rare for the filter's frequency (Nyquist)."""
    lasts = rows * step
    measured = (lasts >= LEAST - 1e-6) & (cut_off(variant) * step < 0.5)
    return np.where(measured, counts / np.where(rows > 0, lasts, 1.0) * 60.0, np.nan)


def smoothed(angles: Sequence[float], limit: float, step: float, start: float) -> list[float]:
    """Return angles after a forward Butterworth low-pass filter of second order, at rest at a start angle.

    Args:
        angles: The angles, one per step.
        limit: The filter's cut-off frequency, Hz; below half the rate of the steps.
        step: Duration of a step, s.
        start: The angle before the first of them.
    """
    turn = math.pi * limit * step
    warped = math.sin(turn) / math.cos(turn) if math.cos(turn) > 0.0 else 0.0
    square, root = warped * warped, math.sqrt(2.0)
    norm = 1.0 / max(1.0 + root * warped + square, 1.0)
    weight = square * norm
    found: list[float] = []
    one = two = before = long_before = start
    for angle in angles:
        fed = weight * angle + 2.0 * weight * one + weight * two
        smooth = fed - 2.0 * (square - 1.0) * norm * before - (1.0 - root * warped + square) * norm * long_before
        one, two, before, long_before = angle, one, smooth, before
        found.append(smooth)
    return found


def reversals(angles: Sequence[float], gap: float, start: float) -> int:
    """Return the number of times that angles return by at least a gap from the farthest value since the last reversal.

    They begin at a start angle. The first change of at least the gap only sets the direction and is not a reversal.
    """
    turning, sense = [], 0
    low = high = start
    for angle in angles:
        low, high = min(low, angle), max(high, angle)
        if sense >= 0 and high - angle >= gap:
            turning.append(sense)
            sense, low = -1, angle
        elif sense <= 0 and angle - low >= gap:
            turning.append(sense)
            sense, high = 1, angle
    return sum(before != 0 for before in turning)
