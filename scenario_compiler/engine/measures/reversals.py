"""Steering reversals: the number of reversals of at least a given angle, after a low-pass filter.

Markkula and Engstrom 2006 count them with a cut-off of 0.6 Hz and a gap of 3 degrees, and with 2 Hz and 0.1 degrees for
the small corrections of a loaded driver (not verified). The filter here is causal, so that it uses no later rows: a
Butterworth filter of second order by the bilinear transform.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.marker import compiled

ROOT = 1.4142135623730951
"""Square root of 2: the filter's damping."""

DEGREE = 0.017453292519943295
"""A degree, rad."""


@compiled
def cut_off(k: int) -> float:
    """Return the filter's cut-off frequency for a variant of the measure, Hz."""
    return 0.6 if k == 0 else 2.0


@compiled
def least_gap(k: int) -> float:
    """Return the least angle of the steering wheel between two reversals of a variant of the measure, rad."""
    return 3.0 * DEGREE if k == 0 else 0.1 * DEGREE


@compiled
def begin_filter(m: Totals, k: int, angle: float, step: float) -> None:
    """Begin to measure: write the filter's weights; before the first row the wheel stood still at an angle, rad."""
    m.wheel_high[k] = angle
    m.wheel_low[k] = angle
    m.wheel_before[k] = angle
    m.wheel_long_before[k] = angle
    m.smooth_before[k] = angle
    m.smooth_long_before[k] = angle
    turn = pi * cut_off(k) * step
    warped = sin(turn) / cos(turn) if cos(turn) > 0.0 else 0.0
    square = warped * warped
    norm = 1.0 / max(1.0 + ROOT * warped + square, 1.0)
    m.raw_weight[k] = square * norm
    m.smooth_weight[k] = 2.0 * (square - 1.0) * norm
    m.smooth_long_weight[k] = (1.0 - ROOT * warped + square) * norm


@compiled
def filtered(m: Totals, k: int, angle: float) -> float:
    """Return the filtered angle of this row, rad."""
    weight = m.raw_weight[k]
    fed = weight * angle + 2.0 * weight * m.wheel_before[k] + weight * m.wheel_long_before[k]
    smooth = fed - m.smooth_weight[k] * m.smooth_before[k] - m.smooth_long_weight[k] * m.smooth_long_before[k]
    m.wheel_long_before[k] = m.wheel_before[k]
    m.wheel_before[k] = angle
    m.smooth_long_before[k] = m.smooth_before[k]
    m.smooth_before[k] = smooth
    return smooth


@compiled
def count_reversal(m: Totals, k: int, smooth: float) -> None:
    """Follow the filtered angle; a return by the gap from the last extreme value is a reversal.

    The first turn by the gap defines the direction and is not a reversal.
    """
    gap = least_gap(k)
    m.wheel_high[k] = max(m.wheel_high[k], smooth)
    m.wheel_low[k] = min(m.wheel_low[k], smooth)
    if m.wheel_sense[k] != -1 and m.wheel_high[k] - smooth >= gap:
        m.wheel_count[k] += 1.0 if m.wheel_sense[k] == 1 else 0.0
        m.wheel_sense[k] = -1
        m.wheel_low[k] = smooth
    elif m.wheel_sense[k] != 1 and smooth - m.wheel_low[k] >= gap:
        m.wheel_count[k] += 1.0 if m.wheel_sense[k] == -1 else 0.0
        m.wheel_sense[k] = 1
        m.wheel_high[k] = smooth


@compiled
def add_steering(p: Program, m: Totals) -> None:
    """Add the last row if the driver of the first response drives; its inputs must have been added.

    The wheel begins at its angle in the row of the response, so that the driver's first turn counts at any step: a long
    one completes it within the row after the response.
    """
    if m.driving[0] != 1 or m.row_present[0] == 0:
        return
    angle = m.row_steer[0] * p.const[slot.K_STEERING_RATIO]
    for k in range(2):
        if m.driven_rows[0] == 0:
            begin_filter(m, k, m.response_steer[0] * p.const[slot.K_STEERING_RATIO], p.const[slot.K_STEP])
        count_reversal(m, k, filtered(m, k, angle))
    m.driven_rows[0] += 1
    m.coarse_reversals[0] = m.wheel_count[0]
    m.fine_reversals[0] = m.wheel_count[1]
