"""The least post-encroachment time, from recordings and from the engine's totals.

The engine looks back from each row; here each row is compared with the row one lag before, for one lag after the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.measures.encroachment import rows_between, rows_looked_at
from scenario_compiler.recording.boxes import touching
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces


def least_encroachment(traces: Traces) -> Floats:
    """Return the least post-encroachment time of each run, s, (...); 0 if boxes overlap, NaN if there is none."""
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


Places = tuple[NDArray[np.intp], ...]
"""Indices into arrays (..., k, m), one index array per dimension."""


class _Kept:
    """The rows that are compared, as arrays (..., k, m)."""

    def __init__(self, traces: Traces, every: int) -> None:
        """Take every `every`-th row."""
        rows = (..., slice(None, None, every), slice(None))
        self.h, self.z, self.present = traces.h[rows], traces.z[rows], traces.present[rows]
        self.x = traces.x[rows] + traces.center * np.cos(self.h)
        self.y = traces.y[rows] + traces.center * np.sin(self.h)
        self.long, self.wide, self.height = 0.5 * traces.length, 0.5 * traces.width, traces.height
        self.reach = (np.hypot(self.long[0], self.wide[0]) + np.hypot(self.long, self.wide)) ** 2
        stepped = (np.diff(self.x, axis=-2) != 0.0) | (np.diff(self.y, axis=-2) != 0.0)
        first = np.zeros_like(self.present[..., :1, :])
        moved: Booleans = np.logical_or.accumulate(np.concatenate([first, stepped], axis=-2), axis=-2)
        self.counts: Booleans = moved & self.present & self.present[..., :1]
        self.counts[..., 0] = False

    def meets(self, lag: int) -> Booleans:
        """Return in which runs the ego is where another entity was `lag` kept rows before, or vice versa, (...)."""
        met = np.zeros(self.x.shape[:-2], dtype=bool)
        for ego_was_there in (True, False):
            *runs, then, others = np.nonzero(self._near(lag, ego_was_there=ego_was_there))
            if others.size == 0:
                continue
            i, j = (np.zeros_like(others), others) if ego_was_there else (others, np.zeros_like(others))
            hit = self._overlap((*runs, then, i), (*runs, then + lag, j))
            if hit.any():
                met[tuple(run[hit] for run in runs)] = True
        return met

    def _near(self, lag: int, *, ego_was_there: bool) -> Booleans:
        """Return in which earlier rows a box is so near to the other's later one that they may overlap, (..., k, m)."""
        now, then = slice(lag, None), slice(None, -lag)
        of_ego, of_others = (then, now) if ego_was_there else (now, then)
        dx = self.x[..., of_others, :] - self.x[..., of_ego, :1]
        dy = self.y[..., of_others, :] - self.y[..., of_ego, :1]
        with np.errstate(invalid="ignore"):
            return np.asarray((dx * dx + dy * dy <= self.reach) & self.counts[..., now, :])

    def _overlap(self, then: Places, now: Places) -> Booleans:
        """Return where an entity's later box overlaps another entity's earlier box, (n,).

        Args:
            then: Indices of the n earlier boxes: runs, rows and entities.
            now: Indices of the later boxes.
        """
        i, j = then[-1], now[-1]
        dx, dy = self.x[now] - self.x[then], self.y[now] - self.y[then]
        above = self.z[now] - self.z[then]
        turned = self.h[now] - self.h[then]
        c, s = np.abs(np.cos(turned)), np.abs(np.sin(turned))
        there = self.present[then] & ~((above > self.height[i]) | (-above > self.height[j]))
        for a, b, h in ((i, j, self.h[then]), (j, i, self.h[now])):
            there &= np.abs(dx * np.cos(h) + dy * np.sin(h)) <= self.long[a] + self.long[b] * c + self.wide[b] * s
            there &= np.abs(dy * np.cos(h) - dx * np.sin(h)) <= self.wide[a] + self.long[b] * s + self.wide[b] * c
        return np.asarray(there)
