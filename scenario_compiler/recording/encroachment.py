"""The least post-encroachment time, from recordings and from the engine's totals.

The engine looks back from each row; here all rows are compared with those one lag before, for one lag after the other.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.measures.encroachment import LONGEST, rows_between, rows_looked_at
from scenario_compiler.recording.between_rows import rows_too_many
from scenario_compiler.recording.boxes import touching
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces


def least_encroachment(traces: Traces) -> Floats:
    """Return the least post-encroachment time of each run, s, (...); 0 if boxes overlap, NaN if there is none."""
    every = rows_between(traces.step)
    limit = rows_looked_at(traces.step)
    kept = _Kept(traces, every)
    for lag in range(1, min(limit, kept.x.shape[-2])):
        if traces.x.shape[-1] < 2 or not kept.compare(lag):
            break
    return np.where(touching(traces).any(axis=-1), 0.0, _in_seconds(kept.least, every * traces.step))


def least_encroachment_total(totals: RunTotals) -> Floats:
    """Return the same as `least_encroachment`, (runs,)."""
    time = _in_seconds(totals.column("encroachment_rows"), rows_between(totals.step) * totals.step)
    return np.where(totals.raw("touched") > 0, 0.0, time)


def _in_seconds(rows: Floats, apart: float) -> Floats:
    time = rows * apart
    return np.where(time < LONGEST, time, np.nan)


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
        self.counts: Booleans = moved & self.present & self.present[..., :1] & ~traces.coupled[rows]
        self.cos, self.sin = np.cos(self.h), np.sin(self.h)
        self.least = np.full(self.x.shape[:-2], np.inf)
        self._open = {True: self.counts.copy(), False: self.counts.copy()}

    def compare(self, lag: int) -> bool:
        """Compare all rows with those of `lag` kept rows before; return whether a longer lag can give a smaller time.

        Of a row, only the last earlier row in which the other was at this place counts.
        """
        worth = lag < self.least + 2.0
        for ego_was_there, still in self._open.items():
            near = self._near(lag, ego_was_there=ego_was_there) & still[..., lag:, :] & worth[..., None, None]
            *runs, then, others = np.nonzero(near)
            if others.size == 0:
                continue
            i, j = (np.zeros_like(others), others) if ego_was_there else (others, np.zeros_like(others))
            hit = self._overlap((*runs, then, i), (*runs, then + lag, j))
            at, places = tuple(run[hit] for run in runs), (then[hit], i[hit], j[hit])
            rows = np.full(still.shape, np.inf)
            now = (*at, places[0] + lag, others[hit])
            rows[now] = np.maximum(lag - self._rows_too_many(at, *places, lag), 0.0)
            still[now] = False
            self.least = np.minimum(self.least, rows.min(axis=(-2, -1)))
        return bool((lag + 1 < self.least + 2.0).any())

    def _rows_too_many(
        self, runs: Places, then: NDArray[np.intp], i: NDArray[np.intp], j: NDArray[np.intp], lag: int
    ) -> Floats:
        """Return what `between_rows.rows_too_many` returns for k earlier boxes of i and later ones of j, (k,)."""
        ends = (*runs, then, i), (*runs, then + 1, i), (*runs, then + lag - 1, j), (*runs, then + lag, j)
        poses = np.array([[values[at] for values in (self.x, self.y, self.cos, self.sin)] for at in ends])
        there = self.present[ends[1]], self.present[ends[2]]
        return rows_too_many(poses, there, (self.long[i], self.wide[i]), (self.long[j], self.wide[j]))

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
