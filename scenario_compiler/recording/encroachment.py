"""The least post-encroachment time of recordings, and of what the engine added up.

The engine looks back from each row; here all rows are compared with those some rows before, one lag after the other.
"""

from __future__ import annotations

import numpy as np

from scenario_compiler.engine.measures.encroachment import rows_between, rows_looked_at
from scenario_compiler.recording.boxes import touching
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces


def least_encroachment(traces: Traces) -> Floats:
    """Return the least post-encroachment time of each run, s, (...); 0 where boxes overlap, NaN where there is none."""
    every = rows_between(traces.step)
    limit = rows_looked_at(traces.step)
    kept = _Kept(traces, every)
    found = np.full(traces.t.shape[:-1], np.nan)
    for lag in range(1, min(limit, kept.x.shape[-2])):
        open_runs = np.isnan(found)
        if traces.x.shape[-1] < 2 or not open_runs.any():
            break
        found = np.where(open_runs & kept.meets(lag), lag * every * traces.step, found)
    return np.where(touching(traces).any(axis=-1), 0.0, found)


def least_encroachment_total(totals: RunTotals) -> Floats:
    """Return the same as `least_encroachment`, (runs,)."""
    rows = totals.column("encroachment_rows") * rows_between(totals.step) * totals.step
    return np.where(totals.raw("touched") > 0, 0.0, rows)


class _Kept:
    """The rows that are compared: arrays (..., k, m)."""

    def __init__(self, traces: Traces, every: int) -> None:
        """Take every so many rows."""
        rows = (..., slice(None, None, every), slice(None))
        self.h, self.z, self.present = traces.h[rows], traces.z[rows], traces.present[rows]
        self.x = traces.x[rows] + traces.center * np.cos(self.h)
        self.y = traces.y[rows] + traces.center * np.sin(self.h)
        self.long, self.wide, self.height = 0.5 * traces.length, 0.5 * traces.width, traces.height
        stepped = (np.diff(self.x, axis=-2) != 0.0) | (np.diff(self.y, axis=-2) != 0.0)
        first = np.zeros_like(self.present[..., :1, :])
        self.moved: Booleans = np.logical_or.accumulate(np.concatenate([first, stepped], axis=-2), axis=-2)

    def meets(self, lag: int) -> Booleans:
        """Return in which runs the ego vehicle is where another was so many rows before, or the other way, (...)."""
        now, then = slice(lag, None), slice(None, -lag)
        met = np.zeros(self.x.shape[:-2], dtype=bool)
        for other in range(1, self.x.shape[-1]):
            for first, second in ((0, other), (other, 0)):
                met |= self._overlap(first, then, second, now, other).any(axis=-1)
        return met

    def _overlap(self, i: int, then: slice, j: int, now: slice, other: int) -> Booleans:
        """Return in which rows the box of j now overlaps the one that i had then, (..., k)."""
        dx, dy = self.x[..., now, j] - self.x[..., then, i], self.y[..., now, j] - self.y[..., then, i]
        above = self.z[..., now, j] - self.z[..., then, i]
        before, after = self.h[..., then, i], self.h[..., now, j]
        with np.errstate(invalid="ignore"):
            there = self.present[..., now, 0] & self.present[..., now, other] & self.present[..., then, i]
            there &= self.moved[..., now, other] & ~((above > self.height[i]) | (-above > self.height[j]))
            there &= dx * dx + dy * dy <= (np.hypot(self.long[i], self.wide[i]) + np.hypot(*self._half(j))) ** 2
            c, s = np.abs(np.cos(after - before)), np.abs(np.sin(after - before))
            for a, b, h in ((i, j, before), (j, i, after)):
                (long, wide), (other_long, other_wide) = self._half(a), self._half(b)
                there &= np.abs(dx * np.cos(h) + dy * np.sin(h)) <= long + other_long * c + other_wide * s
                there &= np.abs(dy * np.cos(h) - dx * np.sin(h)) <= wide + other_long * s + other_wide * c
        return np.asarray(there)

    def _half(self, i: int) -> tuple[float, float]:
        return float(self.long[i]), float(self.wide[i])
