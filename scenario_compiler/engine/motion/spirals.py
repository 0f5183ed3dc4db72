"""The integration of clothoids, whose curvature changes linearly with the distance."""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.marker import compiled

GAUSS_SIDE = 0.1127016653792583
GAUSS_SIDE_WEIGHT = 0.2777777777777778
GAUSS_MIDDLE_WEIGHT = 0.4444444444444444
"""Nodes (this, 1/2, 1 - this) and weights of the three-point Gauss rule on 0 to 1."""

SPIRAL_STEP = 2.0
MOST_SPIRAL_STEPS = 64.0
"""Greatest length of a clothoid for one application of the rule, m, and the greatest number of applications."""


@compiled
def gauss_step(h: float, bend: float, rate: float, length: float) -> tuple[float, float]:
    """Return (dx, dy) along a short piece of a clothoid from its heading, curvature and curvature rate (1/m2)."""
    x = 0.0
    y = 0.0
    for node in range(3):
        share = 0.5
        weight = GAUSS_MIDDLE_WEIGHT
        if node == 0:
            share = GAUSS_SIDE
            weight = GAUSS_SIDE_WEIGHT
        if node == 2:
            share = 1.0 - GAUSS_SIDE
            weight = GAUSS_SIDE_WEIGHT
        at = share * length
        turned = h + bend * at + 0.5 * rate * at * at
        x = x + weight * length * cos(turned)
        y = y + weight * length * sin(turned)
    return x, y


@compiled
def spiral_step(h: float, bend: float, rate: float, length: float) -> tuple[float, float, float]:
    """Return (dx, dy, change of heading) along a piece of a clothoid."""
    count = int(clip(abs(length) / SPIRAL_STEP, 0.0, MOST_SPIRAL_STEPS)) + 1
    part = length / max(count, 1)
    x = 0.0
    y = 0.0
    for q in range(count):
        at = q * part
        dx, dy = gauss_step(h + bend * at + 0.5 * rate * at * at, bend + rate * at, rate, part)
        x = x + dx
        y = y + dy
    return x, y, bend * length + 0.5 * rate * length * length
