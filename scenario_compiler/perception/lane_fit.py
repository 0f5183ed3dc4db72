"""Finds the two boundaries of the lane ahead in a map of ridges, by voting for arcs and choosing the best pair.

The pair is chosen together, with a prior on the lane's width and on the parallelism of the two. A side chosen alone
would lock onto the next lane's line if that is stronger.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import COMPARED, X_FROM, Y_FROM, Y_STEP, BirdsEye, Ridges
from scenario_compiler.perception.route_ahead import LOOKED_AT

Floats = NDArray[np.float64]

OFFSETS = np.arange(0.7, 3.61, 0.1)
HEADINGS = np.linspace(-0.12, 0.12, 13)
SHARP = np.array([0.030, 0.033, 0.036, 0.040])
CURVATURES = np.concatenate([-SHARP[::-1], np.linspace(-0.028, 0.028, 29), SHARP])
"""The grid of arcs, given at d = x - 5 m = 0 by offset, slope and curvature: m, rad, 1/m (radii down to 25 m). The
heading is that of the boundary beside the camera, where a car drives along it: slope - 5 m curvature. In bends with a
radius below 33 m, the default camera does not see both boundaries as far as 18 m ahead."""

ENOUGH = 3.0
"""Strength at which the vote of a row is clipped, so that a few bright rows do not outvote many."""

GRASSY = 15.0
"""Greenness beside a ridge, grey levels, from which it counts little, as at kerbs and the edge of a meadow; grass has
30.
"""

STANDS_OUT = 1.5
"""Strength from which a row counts as painted."""

NEAR_GUESS = np.array([0.8, 5.0, 60.0])
PARALLEL = np.array([10.0, 100.0])
"""Regularisation of the fit: the deviation of a row, 0.05 m, divided by that of offset, slope and curvature from the
voted arc, and of slope and curvature from the other side's.
"""

OFF_WAY = np.array([13.0, 84.5])
"""Effect on t 18 m ahead along the planned route, m, of slope and curvature relative to it."""

FREE_OFF_WAY, COST_OFF_WAY = 0.25, 20.0
"""Difference without a cost, m, because navigation is not exact, and the cost in votes of each further metre; solid
lines have 20 votes.
"""

NEIGHBOURS = np.array([0.25, 0.05, 0.005])
"""Greatest differences in offset, slope and curvature between neighbours: two steps of the grid."""

ALIKE_SCORES = 6
"""Decimal places to which scores are compared. Neighbouring arcs run through the same cells where few rows show paint,
and then have equal votes, and a step of the slope costs as much as one of the curvature (`LaneFitter.scores`). The last
digits, which differ between processors, would choose among such arcs.
"""

MOST_STEPS = 20
"""Greatest number of steps from an arc to better neighbours; the grid's whole width takes ten."""

MOST_TURNED = 0.95
"""Sine of the heading beyond which an arc is continued straight; the camera sees no farther."""

RIVALS_AT, ELSEWHERE = 12.0, 0.4
"""Distance ahead at which arcs are compared, and the least difference there of distinct arcs, m."""

ON_LINE, STRAY = 0.08, 0.25
"""Distance from an arc within which a ridge lies on it, m, and the share of other ridges above which the slope is
uncertain; of random ridges in the window two thirds are others.
"""

ROW_DEVIATION, ALIKE = 0.03, 4.0
"""Deviation of a row's ridge from its line, m, and the number of adjacent rows with the same deviation."""

USUAL_SCATTER = 0.1
"""Root mean square distance of ridges from an arc on which none lies, m."""

BOUNDARY_DEVIATIONS = np.array([0.5, 0.05, 0.01])
"""Standard deviations of a boundary's offset, slope and curvature before a row is seen, m, rad, 1/m."""


NEARBY = np.arange(5.0, 19.5, 1.0)
TO_PARABOLA = np.linalg.pinv(np.vander(NEARBY, 3))
"""Distances ahead, m, and the matrix from values there to the coefficients of the nearest parabola."""

MOST_HEADING = math.radians(80.0)
"""Heading up to which an arc is approximated by a parabola."""

HELD = np.array([1e-3, 1e-3, 1e-3])
"""Weights that hold a parabola through fewer than three points."""


def _shape_of(d: Floats) -> Floats:
    """Return (n, 3) by how much offset, slope and curvature move an arc at d (n,), m."""
    return np.stack([np.ones_like(d), d, 0.5 * d * d], axis=1)


JUDGED = _shape_of(np.array([6.0, 18.0]) - X_FROM)
"""The same where a boundary has to be right: 6 and 18 m ahead of the camera."""

LEFT, RIGHT = 0, 1

SIDES = np.array([-COMPARED, COMPARED])
"""Columns beside a ridge with which it is compared."""


@dataclass(frozen=True, eq=False)
class Fit:
    """One side's boundary.

    Attributes:
        curve: (3,) offset, slope and curvature of the refined arc at d = x - 5 m = 0.
        support: Vote of the grid's arc.
        prominence: How much the vote exceeds all votes of its side, in robust deviations.
        residual: Root mean square distance of the painted rows from the arc, m.
        painted: Share of the rows within 20 m that have a ridge within 0.25 m of the arc.
        on_curve: (rows,) strength on the refined arc itself.
        near_curve: (rows,) strength of the strongest ridge within 0.25 m of the refined arc.
        contrast: (rows,) grey levels on the refined arc itself.
        green: Greenness of the greener side of the arc where there is paint, grey levels.
        slope_deviation: Standard deviation of the arc's slope, from the painted rows; infinite if there are none.
        rivals: Largest votes of other arcs of the side, nearer to the car and farther from it 12 m ahead.
        beside: (rows,) brightness of the ground beside the arc, grey levels.
        step: (rows,) difference in brightness between its two sides, grey levels.
        stray: Share of the ridges near the arc, by their strength, that do not lie on it; 1 if there are none.
        scatter: Root mean square distance of the other ridges from the arc, m.
        deviations: Standard deviations of the arc 6 and 18 m ahead, from those other ridges, m.
        nearest: Smallest x with paint on two rows, m; the map's last row if there is none.
        farthest: Largest x with paint on two rows, m.
        in_view: Share of the rows from 6 to 18 m ahead in which the arc lies in the image.
    """

    curve: Floats
    support: float
    prominence: float
    residual: float
    painted: float
    on_curve: Floats
    near_curve: Floats
    contrast: Floats
    green: float
    slope_deviation: float
    rivals: tuple[float, float]
    beside: Floats
    step: Floats
    stray: float
    scatter: float
    deviations: tuple[float, float]
    nearest: float
    farthest: float
    in_view: float


def added_up(rows: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the sum (m,) of rows (n, m), n from 8 to 128, with numpy's order of summation for n numbers in a row.

    Eight sums are computed side by side and then added, and the remaining rows last.
    """
    whole = len(rows) - len(rows) % 8
    a, b, c, d, e, f, g, h = rows[:whole].reshape(-1, 8, rows.shape[1]).sum(axis=0)
    total: NDArray[np.float32] = ((a + b) + (c + d)) + ((e + f) + (g + h))
    for row in rows[whole:]:
        total += row
    return total


class LaneFitter:
    """Voting, pairing and refinement on the map of one `BirdsEye`."""

    def __init__(self, birds_eye: BirdsEye) -> None:
        """Prepare the grid of arcs; about 12 000 for each side are in the field of view."""
        self.x = birds_eye.x.astype(np.float64)
        self.d = self.x - X_FROM
        self._shape = _shape_of(self.d)
        self.rows = np.arange(len(self.x))
        self.columns = len(birds_eye.y)
        offsets, headings, curvatures = (
            one.ravel() for one in np.meshgrid(OFFSETS, HEADINGS, CURVATURES, indexing="ij")
        )
        grid = np.stack([offsets, headings + X_FROM * curvatures, curvatures], axis=1)
        self.curves: list[Floats] = []
        self._cells: list[NDArray[np.intp]] = []
        self._weights: list[NDArray[np.float32]] = []
        self._norms: list[NDArray[np.float32]] = []
        self._bins: list[list[int]] = []
        self._middles: list[Floats] = []
        self._turned: list[Floats] = []
        self._off_course: list[Floats] = []
        self._neighbours: tuple[dict[int, NDArray[np.int64]], ...] = ({}, {})
        for sign in (1.0, -1.0):
            self._add_side(grid * np.array([sign, 1.0, 1.0]), birds_eye)

    def _add_side(self, curves: Floats, birds_eye: BirdsEye) -> None:
        rows = self.rows[::2]
        column = self._column(curves[:, None], self.d[rows])
        inside = (column >= 0) & (column < self.columns)
        column = np.clip(column, 0, self.columns - 1)
        seen = inside & (birds_eye.seen[rows[None, :], column] > 0)
        kept = seen.sum(axis=1) > 8
        self.curves.append(curves[kept])
        self._cells.append(np.ascontiguousarray((rows * self.columns + column)[kept].T, np.intp))
        self._weights.append(np.ascontiguousarray(seen[kept].T, np.float32))
        self._norms.append(np.sqrt(seen[kept].sum(axis=1)).astype(np.float32))
        first = np.unique(np.abs(curves[kept, 0]), return_index=True)[1].tolist()
        self._bins.append([*first, int(kept.sum())])
        off, turned = np.abs(curves[kept, 1:]) @ OFF_WAY, np.abs(curves[kept, 1] - X_FROM * curves[kept, 2])
        self._off_course.append(COST_OFF_WAY * np.maximum(off - FREE_OFF_WAY, 0.0))
        self._turned.append(COST_OFF_WAY * np.maximum(OFF_WAY[0] * turned - FREE_OFF_WAY, 0.0))
        self._middles.append(np.sign(curves[kept, 0]) * arc_y(curves[kept], np.array(RIVALS_AT - X_FROM)))

    def _column(self, curve: Floats, d: Floats) -> NDArray[np.int64]:
        """Return the columns of arcs (..., 3) at d."""
        return np.round((Y_FROM - arc_y(curve, d)) / Y_STEP - 0.5).astype(np.int64)

    def votes(self, ridges: Ridges, side: int) -> NDArray[np.float32]:
        """Return the vote for each arc of a side."""
        doubt = np.clip(1.2 - ridges.green / np.float32(GRASSY), 0.4, 1.0)
        strength = (np.minimum(ridges.strength, ENOUGH) * doubt).ravel()
        counted = strength.take(self._cells[side]) * self._weights[side]
        return np.asarray(added_up(counted) / self._norms[side], np.float32)

    def scores(self, votes: NDArray[np.float32], side: int, previous: Floats | None) -> Floats:
        """Return the votes for the arcs of a side, less what an arc costs by its distance from the remembered one.

        Args:
            votes: The votes.
            side: The side.
            previous: The side's boundary in the previous image as offset, slope and curvature at d = 0, if any.
        """
        score = votes.astype(np.float64)
        if previous is not None:
            away = np.abs(self.curves[side] - previous) @ np.array([1.2, 6.0, 30.0])
            score -= 2.5 * np.minimum(away, 2.0)
        return score

    def pair(
        self, scores: tuple[Floats, Floats], width: float, width_sigma: float, on_course: bool = False
    ) -> tuple[int, int]:
        """Return the best left and right arc.

        Args:
            scores: Scores of the arcs of the two sides.
            width: Expected distance between the boundaries, m.
            width_sigma: Its standard deviation, m.
            on_course: Whether the ground is viewed along the planned route, so that its lane is straight ahead.
        """
        left, right = (self._best_of_bins(scores[side], side, on_course) for side in (LEFT, RIGHT))
        return self._best_pair(left, right, width, width_sigma)

    def settle(
        self, scores: tuple[Floats, Floats], width: float, width_sigma: float, chosen: tuple[int, int]
    ) -> tuple[int, int]:
        """Return the left and right arc that are better than all near them, by hill climbing from the chosen ones.

        It is for ground that is viewed along the planned route, with which the boundaries are nearly parallel.
        """
        for _ in range(MOST_STEPS):
            left, right = (self._near(scores[side], side, chosen[side]) for side in (LEFT, RIGHT))
            better = self._best_pair(left, right, width, width_sigma)
            if better == chosen:
                break
            chosen = better
        return chosen

    def _near(self, scores: Floats, side: int, chosen: int) -> tuple[NDArray[np.int64], Floats]:
        """Return the arcs near a chosen one, which are kept for the next images, and their scores."""
        near = self._neighbours[side].get(chosen)
        if near is None:
            curves = self.curves[side]
            near = np.flatnonzero((np.abs(curves - curves[chosen]) <= NEIGHBOURS).all(axis=1))
            self._neighbours[side][chosen] = near
        return near, scores[near] - self._turned[side][near]

    def _best_pair(
        self,
        of_left: tuple[NDArray[np.int64], Floats],
        of_right: tuple[NDArray[np.int64], Floats],
        width: float,
        width_sigma: float,
    ) -> tuple[int, int]:
        """Return the best pair of arcs, given by number and score, at the expected distance and nearly parallel."""
        (left, left_score), (right, right_score) = of_left, of_right
        a, b = self.curves[LEFT][left], self.curves[RIGHT][right]
        off = (a[:, None, 0] - b[None, :, 0] - width) / width_sigma
        joint = left_score[:, None] + right_score[None, :] - 2.0 * np.minimum(off * off, 4.0)
        joint -= 25.0 * np.abs(a[:, None, 1] - b[None, :, 1]) + 150.0 * np.abs(a[:, None, 2] - b[None, :, 2])
        i, j = np.unravel_index(int(np.argmax(np.round(joint, ALIKE_SCORES))), joint.shape)
        return int(left[i]), int(right[j])

    def _best_of_bins(self, scores: Floats, side: int, on_course: bool) -> tuple[NDArray[np.int64], Floats]:
        """Return the best arc for each offset, and its score; of equal ones the first."""
        score = np.round(scores - self._off_course[side] if on_course else scores, ALIKE_SCORES)
        ends = pairwise(self._bins[side])
        best = np.array([first + int(np.argmax(score[first:end])) for first, end in ends])
        return best, score[best]

    def refine(
        self, ridges: Ridges, votes: tuple[NDArray[np.float32], NDArray[np.float32]], chosen: tuple[int, int]
    ) -> tuple[Fit, Fit]:
        """Return both boundaries, fitted to the ridges near the chosen arcs."""
        guesses = [self.curves[side][chosen[side]] for side in (LEFT, RIGHT)]
        peaks = [self._peaks(ridges, guess) for guess in guesses]
        curves = self._least_squares(guesses, peaks)
        left, right = (
            self._judge(ridges, votes[side], side, chosen[side], curves[side], peaks[side]) for side in (LEFT, RIGHT)
        )
        return left, right

    def _peaks(self, ridges: Ridges, guess: Floats) -> tuple[Floats, Floats]:
        """Return for each row y of the strongest ridge within 0.25 m of an arc, and its strength."""
        column = self._column(guess, self.d)
        around = column[:, None] + np.arange(-5, 6)
        inside = (around >= 0) & (around < self.columns)
        cells = np.clip(around, 0, self.columns - 1)
        strength = np.where(inside, ridges.strength[self.rows[:, None], cells], 0.0)
        best = strength.argmax(axis=1)
        y = Y_FROM - (around[self.rows, best] + 0.5) * Y_STEP
        return y, strength[self.rows, best].astype(np.float64)

    def _least_squares(self, guesses: list[Floats], peaks: list[tuple[Floats, Floats]]) -> list[Floats]:
        """Fit both arcs to the rows' ridges at once, regularised towards the guesses and towards parallelism."""
        shape = self._shape
        blocks, values = [], []
        for side, (guess, (y, _)) in enumerate(zip(guesses, peaks, strict=True)):
            y = y - arc_y(guess, self.d) + shape @ guess
            root = np.concatenate([np.sqrt(self._weight(peaks[side])), NEAR_GUESS])
            block = np.zeros((len(root), 6))
            block[:, 3 * side : 3 * side + 3] = np.vstack([shape, np.eye(3)]) * root[:, None]
            blocks.append(block)
            values.append(np.concatenate([y, guess]) * root)
        parallel = np.hstack([np.eye(3), -np.eye(3)])[1:] * PARALLEL[:, None]
        system = np.vstack([*blocks, parallel])
        solution = np.linalg.lstsq(system, np.concatenate([*values, np.zeros(2)]), rcond=None)[0]
        return [solution[:3], solution[3:]]

    def _weight(self, peaks: tuple[Floats, Floats]) -> Floats:
        """Return the rows' weights; all are 0 if too few rows show paint for a curve."""
        weight = np.where(peaks[1] > STANDS_OUT, np.minimum(peaks[1], 4.0), 0.0)
        return weight if np.count_nonzero(weight) >= 8 else np.zeros_like(weight)

    def _judge(
        self,
        ridges: Ridges,
        votes: NDArray[np.float32],
        side: int,
        chosen: int,
        curve: Floats,
        peaks: tuple[Floats, Floats],
    ) -> Fit:
        """Return the boundary with everything that its confidence depends on."""
        weight = self._weight(peaks)
        miss = (peaks[0] - arc_y(curve, self.d)) ** 2
        painted, near = peaks[1] > STANDS_OUT, self.x < 20.0
        shown = self.x[:-1][painted[:-1] & painted[1:]]
        on_curve, contrast, green, beside, step = self._along(ridges, curve)
        nearby = self._peaks(ridges, curve)
        stray, scatter, deviations = self._deviations(nearby, curve)
        middle = float(np.median(votes))
        spread = float(np.median(np.abs(votes - middle))) + 0.15
        return Fit(
            curve=curve,
            support=float(votes[chosen]),
            prominence=(float(votes[chosen]) - middle) / spread,
            residual=float(np.sqrt((miss * weight).sum() / weight.sum())) if weight.any() else 0.2,
            painted=float(painted[near].mean()),
            on_curve=on_curve,
            near_curve=nearby[1],
            contrast=contrast,
            green=float((green * on_curve)[near].sum() / (on_curve[near].sum() + 1.0)),
            slope_deviation=self._slope_deviation(weight, miss),
            rivals=self._rivals(votes, side, chosen),
            beside=beside,
            step=step,
            stray=stray,
            scatter=scatter,
            deviations=deviations,
            nearest=float(shown[0]) if len(shown) else float(self.x[-1]),
            farthest=float(shown[-1]) if len(shown) else float(self.x[-1]),
            in_view=self._in_view(ridges, curve),
        )

    def _in_view(self, ridges: Ridges, curve: Floats) -> float:
        """Return the share of the judged stretch of an arc that lies in the image."""
        rows = self.rows[(self.x > LOOKED_AT[0]) & (self.x < LOOKED_AT[1])]
        column = self._column(curve, self.d[rows])
        inside = (column >= 0) & (column < self.columns)
        return float(np.where(inside, ridges.seen[rows, np.clip(column, 0, self.columns - 1)], 0.0).mean())

    def _rivals(self, votes: NDArray[np.float32], side: int, chosen: int) -> tuple[float, float]:
        beyond = self._middles[side] - self._middles[side][chosen]
        inner, outer = (votes[way * beyond > ELSEWHERE].max(initial=0.0) for way in (-1.0, 1.0))
        return float(inner), float(outer)

    def _slope_deviation(self, weight: Floats, miss: Floats) -> float:
        """Return the standard deviation of an arc's slope from weighted rows with the mean squared residual `miss`.

        Without paint, the strongest ridges lie anywhere in the window and contain no information.
        """
        total, near = float(weight.sum()), weight * (miss < ON_LINE * ON_LINE)
        if not near.any():
            return math.inf
        middle = float(near @ self.d) / float(near.sum())
        spread = float(near @ (self.d - middle) ** 2) / float(near.sum())
        scatter = float(near @ miss) / float(near.sum()) + ROW_DEVIATION**2
        rows = np.count_nonzero(near) / ALIKE
        stray = 1.0 - float(near.sum()) / total
        return math.sqrt(scatter / (rows * max(spread, 0.1))) * (1.0 + (stray / STRAY) ** 4)

    def _deviations(self, peaks: tuple[Floats, Floats], curve: Floats) -> tuple[float, float, tuple[float, float]]:
        """Return the share of ridges that lie off an arc, the others' scatter, m, and the arc's deviations, m.

        The deviations are those of least squares over the rows that lie on the arc, of which some neighbours are off
        alike, with what is usual of a boundary before any row is seen.
        """
        miss = (peaks[0] - arc_y(curve, self.d)) ** 2
        weight = np.where(peaks[1] > STANDS_OUT, np.minimum(peaks[1], 4.0), 0.0)
        near = weight * (miss < ON_LINE * ON_LINE)
        total, kept = float(weight.sum()), float(near.sum())
        scatter = math.sqrt(float(near @ miss) / kept) if kept else USUAL_SCATTER
        rows = self._shape[near > 0.0]
        known = rows.T @ rows / (ALIKE * (scatter * scatter + ROW_DEVIATION**2)) + np.diag(BOUNDARY_DEVIATIONS**-2)
        variances = ((JUDGED @ np.linalg.inv(known)) * JUDGED).sum(axis=1)
        first, last = np.sqrt(variances).tolist()
        return 1.0 - kept / total if total else 1.0, scatter, (first, last)

    def _along(self, ridges: Ridges, curve: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
        """Return what lies on the arc: strength, contrast, greenness, brightness beside it and the sides' difference.

        Strength and contrast are the best of three neighbouring columns.
        """
        column = self._column(curve, self.d)
        around = np.clip(column[:, None] + np.arange(-1, 2), 0, self.columns - 1)
        inside = (column >= 0) & (column < self.columns)
        pick = (self.rows[:, None], around)
        sides = np.clip(around[:, 1:2] + SIDES, 0, self.columns - 1)
        left, right = ridges.ground[self.rows[:, None], sides].astype(np.float64).T
        return (
            np.where(inside, ridges.strength[pick].max(axis=1), 0.0).astype(np.float64),
            np.where(inside, ridges.contrast[pick].max(axis=1), 0.0).astype(np.float64),
            ridges.green[self.rows, around[:, 1]].astype(np.float64),
            0.5 * (left + right),
            np.abs(left - right),
        )


def arc_y(curve: Floats, d: Floats) -> Floats:
    """Return y of circular arcs at d, m.

    Args:
        curve: (..., 3) y, dy/dd and the second derivative at d = 0.
        d: Distances that broadcast with the arcs.
    """
    offset, slope, curvature = curve[..., 0], curve[..., 1], curve[..., 2]
    steep = 1.0 + np.square(slope)
    sine = slope / np.sqrt(steep)
    bend = curvature / steep**1.5
    turned = np.clip(sine + bend * d, -MOST_TURNED, MOST_TURNED)
    both = np.sqrt(1.0 - sine * sine) + np.sqrt(1.0 - turned * turned)
    return np.asarray(offset + d * (sine + turned) / both)


def parabola_of(curve: Floats) -> tuple[float, float, float]:
    """Return the parabola that is nearest to an arc 5 to 19 m ahead.

    Args:
        curve: (3,) offset, slope and curvature of the arc at d = 0.

    Returns:
        y below the camera, m, dy/dx there and the second derivative, 1/m.
    """
    half, slope, y0 = (TO_PARABOLA @ arc_y(curve, NEARBY - X_FROM)).tolist()
    return y0, slope, 2.0 * half


def nearest_parabola(x: Floats, y: Floats, heading: Floats) -> tuple[float, float, float]:
    """Return the parabola that is nearest to a line, without the points that are NaN and those that lead aside.

    Args:
        x: (n,) points of the line, m ahead of the camera.
        y: (n,) its points, m to the left of the camera.
        heading: (n,) its direction there, rad.

    Returns:
        y below the camera, m, dy/dx there and the second derivative, 1/m.
    """
    kept = np.isfinite(x) & (np.abs(heading) < MOST_HEADING)
    weight = np.cos(heading[kept])
    system = np.concatenate([np.vander(x[kept], 3) * weight[:, None], np.diag(HELD)])
    values = np.concatenate([y[kept] * weight, np.zeros(3)])
    half, slope, y0 = np.linalg.lstsq(system, values, rcond=None)[0].tolist()
    return y0, slope, 2.0 * half
