"""Transition shapes of ASAM OpenSCENARIO's dynamics: value, slope and peak slope over a progress from 0 to 1."""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled


@compiled
def shape_value(st: State, shape: int, u: float) -> float:
    """Return the completed share of the change at progress u."""
    if shape == op.SHAPE_LINEAR:
        return u
    if shape == op.SHAPE_SINUSOIDAL:
        return 0.5 * (1.0 - cos(pi * u))
    if shape == op.SHAPE_CUBIC:
        return u * u * (3.0 - 2.0 * u)
    if shape == op.SHAPE_STEP:
        return 1.0
    fault(st, op.FAULT_UNKNOWN_SHAPE, shape)
    return 1.0


@compiled
def shape_slope(shape: int, u: float) -> float:
    """Return the derivative of `shape_value` with respect to u."""
    if shape == op.SHAPE_SINUSOIDAL:
        return 0.5 * pi * sin(pi * u)
    if shape == op.SHAPE_CUBIC:
        return 6.0 * u * (1.0 - u)
    return 1.0


@compiled
def shape_peak(shape: int) -> float:
    """Return the greatest slope; esmini reads `rate` as the peak rate of the change."""
    if shape == op.SHAPE_SINUSOIDAL:
        return 0.5 * pi
    if shape == op.SHAPE_CUBIC:
        return 1.5
    return 1.0


@compiled
def transition_span(shape: int, dimension: int, value: float, change: float) -> float:
    """Return the length of a transition given by time, distance or peak rate, in s or m; 0 for a step."""
    if shape == op.SHAPE_STEP:
        return 0.0
    if dimension != op.DIMENSION_RATE:
        return max(value, 0.0)
    rate = abs(value)
    if rate < 1.0e-9:
        return 0.0
    return shape_peak(shape) * abs(change) / rate
