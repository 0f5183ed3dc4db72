"""Batch location: the lanes that hold each of many points, as arrays.

The same formulas as in `locate`, over all points at once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from scenario_compiler.forms.declaration import column_types
from scenario_compiler.roads.geometry import (
    GAUSS_INNER,
    GAUSS_NODE,
    GAUSS_OUTER,
    MIN_SPEED,
    SMALL_ANGLE,
    TAU,
)
from scenario_compiler.roads.lanes import BORDER_TOLERANCE
from scenario_compiler.roads.locate import (
    CELL,
    CELL_BASE,
    MIN_ACROSS,
    NEWTON_LIMIT,
    PLANE_LIMIT,
    S_TOLERANCE,
    STEP_TOLERANCE,
)
from scenario_compiler.roads.tables import ARC, LINE, POLYNOMIAL, SPIRAL, RoadTables

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

BATCH = 50_000
"""Points that are looked up at a time; a bound on memory."""


class BatchLocator:
    """The tables of one network as arrays, and the batch questions over them."""

    def __init__(self, tables: RoadTables) -> None:
        """Copy the columns into arrays."""
        arrays = tables.in_arrays()
        self.columns: dict[str, Any] = {
            name: np.frombuffer(getattr(arrays, name), np.float64 if floats else np.int64)
            for name, floats in column_types(RoadTables).items()
        }

    def candidates(self, xs: Floats, ys: Floats) -> tuple[Ints, Ints, Floats, Floats, Ints]:
        """Return (point, lane row, s, offset, found) of all lanes on chunks that hold a point.

        They are in no order, and a place where two chunks meet may occur twice; found is 1 inside and 2
        across a kink.
        """
        parts = [self._candidates(xs[i : i + BATCH], ys[i : i + BATCH], i) for i in range(0, max(len(xs), 1), BATCH)]
        point, row, s, offset, found = (np.concatenate(column) for column in zip(*parts, strict=True))
        return point, row, s, offset, found

    def _candidates(self, xs: Floats, ys: Floats, base: int) -> tuple[Ints, Ints, Floats, Floats, Ints]:
        n = self.columns
        point, chunk = self._pairs(xs, ys)
        x, y = xs[point], ys[point]
        s, lateral = np.empty(len(point)), np.empty(len(point))
        kind = n["piece_kind"][n["chunk_piece"][chunk]]
        for which, project in (
            (kind == LINE, self._on_line),
            (kind == ARC, self._on_arc),
            ((kind == SPIRAL) | (kind == POLYNOMIAL), self._on_curve),
        ):
            if which.any():
                s[which], lateral[which] = project(chunk[which], x[which], y[which])
        s, t = self._lean(chunk, s, lateral, x, y)
        low, high = n["chunk_s"][chunk], n["chunk_end"][chunk]
        beyond = np.maximum(low - s, s - high)
        slack = np.where(s < low, n["chunk_before"][chunk], n["chunk_after"][chunk])
        found = np.where(beyond <= S_TOLERANCE, 1, np.where(beyond <= slack + S_TOLERANCE, 2, 0))
        s = np.minimum(np.maximum(s, low), high)
        near = (found > 0) & (t >= n["chunk_right"][chunk]) & (t <= n["chunk_left"][chunk])
        point, chunk, s, t, found = point[near], chunk[near], s[near], t[near], found[near]
        row, offset = self._rows(chunk, s, t)
        on = row >= 0
        return base + point[on], row[on], s[on], offset[on], found[on]

    def _pairs(self, xs: Floats, ys: Floats) -> tuple[Ints, Ints]:
        """Return all (point, chunk) with the point in the chunk's bounds."""
        n = self.columns
        inside = (np.abs(xs) < PLANE_LIMIT) & (np.abs(ys) < PLANE_LIMIT)
        ix = np.floor(np.where(inside, xs, 0.0) / CELL).astype(np.int64)
        iy = np.floor(np.where(inside, ys, 0.0) / CELL).astype(np.int64)
        key = (ix + CELL_BASE) * (2 * CELL_BASE) + iy + CELL_BASE
        cell = np.searchsorted(n["cell_key"], key)
        cell = np.minimum(cell, max(len(n["cell_key"]) - 1, 0))
        if len(n["cell_key"]):
            hit = inside & (n["cell_key"][cell] == key)
            first = np.where(hit, n["cell_chunk"][cell], 0)
            count = np.where(hit, n["cell_chunk"][cell + 1] - first, 0)
        else:
            first = count = np.zeros(len(xs), np.int64)
        point = np.repeat(np.arange(len(xs)), count)
        start = np.cumsum(count) - count
        chunk = n["chunk_of_cell"][np.arange(len(point)) - start[point] + first[point]]
        if len(n["wide_chunk"]):
            everywhere = np.flatnonzero(inside)
            point = np.concatenate([point, np.repeat(everywhere, len(n["wide_chunk"]))])
            chunk = np.concatenate([chunk, np.tile(n["wide_chunk"], len(everywhere))])
        x, y = xs[point], ys[point]
        near = (x >= n["chunk_x0"][chunk]) & (x <= n["chunk_x1"][chunk])
        near &= (y >= n["chunk_y0"][chunk]) & (y <= n["chunk_y1"][chunk])
        return point[near], chunk[near]

    def _local(self, piece: Ints, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        n = self.columns
        c, w = np.cos(n["piece_h"][piece]), np.sin(n["piece_h"][piece])
        dx, dy = x - n["piece_x"][piece], y - n["piece_y"][piece]
        return dx * c + dy * w, dy * c - dx * w

    def _on_line(self, chunk: Ints, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        piece = self.columns["chunk_piece"][chunk]
        u, v = self._local(piece, x, y)
        return self.columns["piece_s"][piece] + u, v

    def _on_arc(self, chunk: Ints, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        n = self.columns
        piece = n["chunk_piece"][chunk]
        u, v = self._local(piece, x, y)
        k, start = n["piece_k"][piece], n["piece_s"][piece]
        across = 1.0 - k * v
        q = np.sqrt(k * k * u * u + across * across)
        d = np.arctan2(k * u, across) / k
        turn = TAU / np.abs(k)
        d = d + turn * np.floor((0.5 * (n["chunk_s"][chunk] + n["chunk_end"][chunk]) - start - d) / turn + 0.5)
        return start + d, (2.0 * v - k * (u * u + v * v)) / (1.0 + q)

    def _on_curve(self, chunk: Ints, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Newton's method on spirals and polynomials, as `locate.project_on_piece` does it."""
        n = self.columns
        piece, low, high = n["chunk_piece"][chunk], n["chunk_s"][chunk], n["chunk_end"][chunk]
        margin = high - low + 1.0
        s = 0.5 * (low + high)
        open_ = np.arange(len(s))
        for _ in range(NEWTON_LIMIT):
            at = s[open_]
            px, py, h, k, speed = self._points(piece[open_], at)
            c, w = np.cos(h), np.sin(h)
            dx, dy = x[open_] - px, y[open_] - py
            bend = np.maximum(1.0 - k * (dy * c - dx * w), 0.2)
            step = (dx * c + dy * w) / (bend * np.maximum(speed, 0.001))
            s[open_] = np.clip(at + step, low[open_] - margin[open_], high[open_] + margin[open_])
            open_ = open_[np.abs(step) >= STEP_TOLERANCE]
            if not len(open_):
                break
        px, py, h, _, _ = self._points(piece, s)
        return s, (y - py) * np.cos(h) - (x - px) * np.sin(h)

    def _points(self, piece: Ints, s: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return (x, y, heading, curvature, speed) on spirals and polynomials."""
        n = self.columns
        d = s - n["piece_s"][piece]
        h, k, half = n["piece_h"][piece], n["piece_k"][piece], 0.5 * n["piece_dk"][piece]
        x, y = n["piece_x"][piece].copy(), n["piece_y"][piece].copy()
        for share, weight in (
            (0.5 * (1.0 - GAUSS_NODE), GAUSS_OUTER),
            (0.5, GAUSS_INNER),
            (0.5 * (1.0 + GAUSS_NODE), GAUSS_OUTER),
        ):
            u = share * d
            a = h + (k + half * u) * u
            x += d * weight * np.cos(a)
            y += d * weight * np.sin(a)
        heading, curvature, speed = h + (k + half * d) * d, k + 2.0 * half * d, np.ones(len(s))
        poly = n["piece_poly"][piece]
        curved = poly >= 0
        if curved.any():
            q = poly[curved]
            x[curved], y[curved], heading[curved], curvature[curved], speed[curved] = self._polynomials(
                piece[curved], q, d[curved]
            )
        return x, y, heading, curvature, speed

    def _polynomials(self, piece: Ints, q: Ints, d: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        n = self.columns
        scale = n["poly_scale"][q]
        p = d * scale
        values = []
        for axis in "uv":
            a, b, c, e = (n[f"poly_{letter}{axis}"][q] for letter in "abcd")
            values.append((a + p * (b + p * (c + p * e)), b + p * (2.0 * c + 3.0 * p * e), 2.0 * c + 6.0 * p * e))
        (u, u1, u2), (v, v1, v2) = values
        speed = np.sqrt(u1 * u1 + v1 * v1)
        moving = speed > MIN_SPEED
        safe = np.where(moving, speed, 1.0)
        turn = np.where(moving, np.arctan2(v1, u1), 0.0)
        curvature = np.where(moving, (u1 * v2 - v1 * u2) / (safe * safe * safe), 0.0)
        h = n["piece_h"][piece]
        c, w = np.cos(h), np.sin(h)
        x, y = n["piece_x"][piece] + u * c - v * w, n["piece_y"][piece] + u * w + v * c
        return x, y, h + turn, curvature, speed * scale

    def _cubics(self, first: Ints, last: Ints, s: Floats) -> Floats:
        """Return the values of ranges of cubics, as `geometry.cubic_value` does."""
        n = self.columns
        value = np.zeros(len(s))
        some = np.flatnonzero(first < last)
        if not len(some):
            return value
        row = self._cubic_rows(first[some], last[some], s[some])
        d = np.maximum(s[some] - n["cubic_s"][row], 0.0)
        value[some] = n["cubic_a"][row] + d * (n["cubic_b"][row] + d * (n["cubic_c"][row] + d * n["cubic_d"][row]))
        return value

    def _cubic_rows(self, first: Ints, last: Ints, s: Floats) -> Ints:
        """Return the row that holds s in each of some non-empty ranges of cubics."""
        low, high = first, last - 1
        while (low < high).any():
            middle = (low + high + 1) // 2
            below = self.columns["cubic_s"][middle] <= s
            narrow = low < high
            low = np.where(narrow & below, middle, low)
            high = np.where(narrow & ~below, middle - 1, high)
        return low

    def _road_cubics(self, name: str, road: Ints, s: Floats) -> Floats:
        return self._cubics(self.columns[f"road_{name}_first"][road], self.columns[f"road_{name}_last"][road], s)

    def _lean(self, chunk: Ints, s: Floats, lateral: Floats, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Return (s, t) where roads are rolled, as `locate.lean_on_piece` does; other points are left as they are."""
        n = self.columns
        road = n["chunk_road"][chunk]
        rolled = n["road_superelevation_first"][road] < n["road_superelevation_last"][road]
        if not rolled.any():
            return s, lateral
        s, t = s.copy(), lateral.copy()
        at = np.flatnonzero(rolled)
        along, across = self._axis(road[at], s[at])
        t[at] = lateral[at] / across
        at = at[along != 0.0]
        for _ in range(NEWTON_LIMIT):
            px, py, h, k, speed = self._all_points(n["chunk_piece"][chunk[at]], s[at])
            c, w = np.cos(h), np.sin(h)
            along, across = self._axis(road[at], s[at])
            dx, dy = x[at] - px, y[at] - py
            beside = dy * c - dx * w
            t[at] = beside / across
            bend = np.maximum(1.0 - k * beside, 0.2)
            step = (dx * c + dy * w - t[at] * along) / (bend * np.maximum(speed, 0.001))
            s[at] += step
            at = at[np.abs(step) >= STEP_TOLERANCE]
            if not len(at):
                break
        return s, t

    def _axis(self, road: Ints, s: Floats) -> tuple[Floats, Floats]:
        """Return (along, across) of the axis of t."""
        n = self.columns
        s = np.maximum(s, 0.0)
        roll = self._road_cubics("superelevation", road, s)
        grade = self._slopes(n["road_elevation_first"][road], n["road_elevation_last"][road], s)
        along = -grade / np.sqrt(1.0 + grade * grade) * np.sin(roll)
        return along, np.maximum(np.cos(roll), MIN_ACROSS)

    def _slopes(self, first: Ints, last: Ints, s: Floats) -> Floats:
        """Return the derivatives of ranges of cubics, as `geometry.cubic_slope` does."""
        n = self.columns
        slope = np.zeros(len(s))
        some = np.flatnonzero(first < last)
        if len(some):
            row = self._cubic_rows(first[some], last[some], s[some])
            d = s[some] - n["cubic_s"][row]
            value = n["cubic_b"][row] + d * (2.0 * n["cubic_c"][row] + 3.0 * d * n["cubic_d"][row])
            slope[some] = np.where(d < 0.0, 0.0, value)
        return slope

    def _all_points(self, piece: Ints, s: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return (x, y, heading, curvature, speed) on pieces of every kind."""
        n = self.columns
        columns = (np.empty(len(s)), np.empty(len(s)), np.empty(len(s)), np.empty(len(s)), np.empty(len(s)))
        straight = (n["piece_kind"][piece] == LINE) | (n["piece_kind"][piece] == ARC)
        for which, points in ((straight, self._arc_points), (~straight, self._points)):
            if which.any():
                for column, values in zip(columns, points(piece[which], s[which]), strict=True):
                    column[which] = values
        return columns

    def _arc_points(self, piece: Ints, s: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        n = self.columns
        d = s - n["piece_s"][piece]
        h, k = n["piece_h"][piece], n["piece_k"][piece]
        half = 0.5 * k * d
        bent = np.abs(half) > SMALL_ANGLE
        safe = np.where(bent, half, 1.0)
        chord = np.where(bent, d * np.sin(safe) / safe, d)
        a = h + half
        x, y = n["piece_x"][piece] + chord * np.cos(a), n["piece_y"][piece] + chord * np.sin(a)
        return x, y, h + k * d, k, np.ones(len(s))

    def _rows(self, chunk: Ints, s: Floats, t: Floats) -> tuple[Ints, Floats]:
        """Return (lane row or -1, offset), as `lanes.row_at` does."""
        n = self.columns
        section = n["chunk_section"][chunk]
        beside = t - self._road_cubics("offset", n["chunk_road"][chunk], s)
        first, stop = n["section_lane"][section], n["section_lane"][section + 1]
        row = first + n["section_left"][section]
        right = (beside < 0.0) | (row == first)
        beside = np.where(right, -beside, beside)
        outwards = np.where(right, 1, -1)
        end = np.where(right, stop, first - 1)
        inner = np.zeros(len(s))
        found = np.full(len(s), -1, np.int64)
        offset = np.zeros(len(s))
        open_ = np.flatnonzero(beside >= 0.0)
        row = row + outwards
        while True:
            open_ = open_[row[open_] != end[open_]]
            if not len(open_):
                return found, offset
            at = row[open_]
            width = np.maximum(self._cubics(n["lane_width_first"][at], n["lane_width_last"][at], s[open_]), 0.0)
            edge = inner[open_] + width
            outermost = at + outwards[open_] == end[open_]
            here = (beside[open_] < edge) | (outermost & (beside[open_] <= edge + BORDER_TOLERANCE))
            hit = open_[here]
            found[hit] = at[here]
            away = beside[hit] - inner[hit] - 0.5 * width[here]
            offset[hit] = np.where(right[hit], -away, away)
            inner[open_] = edge
            row[open_] += outwards[open_]
            open_ = open_[~here]
