"""The lane through the rows of a picture in which its two boundaries were seen, and the tilt of the camera.

Each row tells in which column a boundary is, and how sure that is. The rows are projected to the ground, along the
planned route if it is known (see `course`), and the boundaries are two lines a lane's width apart that are nearly
parallel to each other and to the route. A tilt of the camera moves what is seen ahead, so that lines converge, and in a
bend leave the route's direction. So the lane and the tilt that fit the rows best are searched together, by least
squares after Gauss and Newton. Rows far from their line count less (P. J. Huber, Robust Estimation of a Location
Parameter, Annals of Mathematical Statistics 35, 1964).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.course import Course, moved_aside
from scenario_compiler.perception.road_plane import STEEPEST, USUAL_PITCH, Tilt
from scenario_compiler.perception.route_ahead import LOOKED_AT as JUDGED

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

TRAINED_FOR = Camera()
"""The camera in whose picture the rows are."""

ROWS, COLUMNS = 64, 128
"""Rows and columns in which a picture tells where boundaries are."""

V = (np.arange(ROWS) + 0.5) * TRAINED_FOR.height / ROWS - 0.5
"""(ROWS,) positions of the rows in the picture, pixels."""

PEAK = 4
"""Number of columns on either side of a row's most probable one that belong to the same line."""

LOOKED_AT = (5.0, 22.0)
"""Stretch ahead of the camera whose rows are used, m."""

LEAST_ROWS = 5
"""Least number of rows of a boundary."""

ALIKE_ROWS = 4.0
"""Number of rows that count as one independent one, because neighbouring rows have the same error."""

NEAREST_OFF, COLUMNS_OFF = 0.02, 0.3
"""Least deviation of a row, m, and what is added to its deviation in columns."""

ASTRAY, ROUGH = 1.5, 0.1
"""Distance from its line, in standard deviations, above which a row counts less, and the least such deviation, m."""

ROUNDS, SETTLED, STEP = 8, 2e-4, 1e-3
"""Steps of Gauss and Newton's method at most, the change of the tilt at which they end, and that by which derivatives
are taken, rad.
"""

OFF_ROUTE = (0.01, 0.0005, 0.01)
"""Standard deviations of the lane's direction from that of the route, rad, of their curvatures, 1/m, and of the latter
in parts of the route's: the map and the ego's position in it are not exact.
"""

ANYWHERE = (0.5, 0.2)
"""The same where the route is not known: of the lane's direction from straight ahead, and of its curvature."""

OFF_PARALLEL = (0.005, 0.0005)
"""Standard deviations of the difference of the boundaries' directions, rad, and of their curvatures, 1/m."""

OFFSET_DEVIATION, MEMORY_DEVIATION = 2.0, 0.3
"""Standard deviations of a boundary from half a lane's width aside, and from where it was in the last image, m."""

STRETCH = np.linspace(*JUDGED, 13)
"""(13,) distances ahead on the judged stretch, m."""

LEFT = np.arange(2 * ROWS) < ROWS
"""(2 ROWS,) which of the rows of both sides are those of the left one."""

TO_LEFT, TO_RIGHT = (
    np.array([[side, other, 0, 0, 0, 0], [0, 0, 1, 0, half, 0], [0, 0, 0, 1, 0, half]], np.float64)
    for side, other, half in ((1, 0, 0.5), (0, 1, -0.5))
)
"""(3, 6) matrices from the offsets of both boundaries, their mean slope and curvature, and the differences of these, to
the offset, slope and curvature of one boundary.
"""

NEAR = 0.25
"""Distance up to which a row lies on a line, m."""

LEAST_FALL = 1e-2
"""Least fall of a ray towards the road for each metre ahead."""

MEETINGS, MET, SHORT = 4, 0.02, 1.0
"""Steps of Newton's method, at most, to where a ray meets an uneven road, the last step at which it does, and the
length over which the road's grade is taken, m.
"""


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of one side, (ROWS,) each, or of both, (2 ROWS,).

    Attributes:
        there: Probability that the boundary is in the row.
        column: Its column: the mean around the most probable column, so that two lines are not averaged.
        spread: Standard deviation of the whole distribution, columns.
        alone: Share of the distribution around the most probable column.
    """

    there: Floats
    column: Floats
    spread: Floats
    alone: Floats

    @staticmethod
    def of(rows: Floats) -> Rows:
        """Return the rows for (ROWS, COLUMNS + 1) probabilities; the last column is that of no boundary."""
        place = np.arange(COLUMNS)
        there = 1.0 - rows[:, -1]
        share = rows[:, :-1] / np.maximum(there, 1e-6)[:, None]
        middle = share @ place
        spread = np.sqrt(np.maximum(share @ (place * place) - middle * middle, 0.0))
        peak = share * (np.abs(place - share.argmax(axis=1)[:, None]) <= PEAK)
        alone = peak.sum(axis=1)
        return Rows(there, peak @ place / np.maximum(alone, 1e-9), spread, alone)

    @staticmethod
    def joined(left: Rows, right: Rows) -> Rows:
        """Return the rows of both sides, first those of the left one."""
        return Rows(*(np.concatenate([getattr(side, one.name) for side in (left, right)]) for one in fields(Rows)))

    def seen_at(self, s: Floats) -> Mask:
        """Return which rows have a boundary on the stretch `LOOKED_AT`, if they lie at s, m."""
        return (self.there > 0.5) & (s > LOOKED_AT[0]) & (s < LOOKED_AT[1])


@dataclass(frozen=True, eq=False)
class Expected:
    """What is known of the lane before its rows are seen.

    Attributes:
        tilt: Tilt of the camera against the ground as the map has it, or against the plane below the ego.
        width: Width of the lane, m.
        width_deviation: Its standard deviation, m.
        offsets: Where the left and the right boundary are beside the camera, m to the left; None if not remembered.
        course: The planned route; None if it is not known.
        scale: Height of the camera relative to that of `TRAINED_FOR`.
    """

    tilt: Tilt
    width: float
    width_deviation: float
    offsets: tuple[float | None, float | None] = (None, None)
    course: Course | None = None
    scale: float = 1.0


@dataclass(frozen=True, eq=False)
class Line:
    """One boundary, t = y0 + slope s + curvature s**2 / 2, and its rows on the ground.

    Without a route, s is the distance straight ahead and t the distance to the left.

    Attributes:
        curve: (3,) y0, m, slope, and curvature, 1/m.
        s: (ROWS,) where the rows lie, m.
        off: (ROWS,) their distances from the line, m.
        deviation: (ROWS,) their standard deviations, m.
        uncertain: Standard deviation of the line at the end of the judged stretch, m.
        lever: By how many metres an error of the tilt by one radian moves what is seen of the line, where it moves it
            most; the line itself moves less, because it is held parallel to the other one and to the route.
        in_view: Share of the judged stretch that lies in the picture.
    """

    curve: Floats
    s: Floats
    off: Floats
    deviation: Floats
    uncertain: float
    lever: float
    in_view: float

    def at(self, s: ArrayLike) -> Floats:
        """Return t at s, m."""
        return np.asarray(_shape_of(np.asarray(s, np.float64)) @ self.curve)

    @property
    def judged(self) -> Mask:
        """(ROWS,) which rows lie on the judged stretch."""
        return (self.s > JUDGED[0]) & (self.s < JUDGED[1])


def lane_through(sides: tuple[Rows, Rows], expected: Expected) -> tuple[tuple[Line, Line], Tilt]:
    """Return the left and the right boundary of the lane, and the tilt of the camera (see `Expected.tilt`)."""
    rows = Rows.joined(*sides)
    line, pitch = np.zeros(6), expected.tilt.pitch
    for number in range(ROUNDS):
        seen, moved = (_Ground.of(rows, one, expected) for one in (pitch, pitch + STEP))
        used = _enough(rows.seen_at(seen.s))
        left, s, t, deviation = LEFT[used], seen.s[used], seen.t[used], seen.deviation[used]
        shape = _of_sides(_shape_of(s), left)
        weight = np.sqrt(rows.there[used] / ALIKE_ROWS) / deviation
        if number > 0:
            weight /= np.maximum(np.abs(shape @ line - t) / np.hypot(deviation, ROUGH) / ASTRAY, 1.0)
        slope = _of_sides(_slope_of(s), left) @ line
        by_tilt = ((moved.t - seen.t)[used] - slope * (moved.s - seen.s)[used]) / STEP
        held, means = _expectations(expected, line, pitch)
        system = np.concatenate([np.column_stack([shape, -by_tilt]) * weight[:, None], held])
        values = np.concatenate([t * weight, means])
        found = np.linalg.lstsq(system, values, rcond=None)[0]
        line, pitch = found[:-1], min(max(pitch + float(found[-1]), -STEEPEST), STEEPEST)
        if number > 0 and abs(found[-1]) < SETTLED:
            break
    off = (system @ found - values)[: len(t)]
    uneven = max(ALIKE_ROWS * float(off @ off) / max(len(t), 1), 1.0)
    covariance = np.linalg.inv(system.T @ system) * uneven
    both = [
        _line(seen, side, matrix @ line, matrix @ covariance[:-1, :-1] @ matrix.T, pitch, expected)
        for side, matrix in ((LEFT, TO_LEFT), (~LEFT, TO_RIGHT))
    ]
    return (both[0], both[1]), Tilt(pitch, min(math.sqrt(float(covariance[-1, -1])), USUAL_PITCH))


def _enough(used: Mask) -> Mask:
    """Return which rows are used: those of a side that has enough of them."""
    return np.concatenate([one & (one.sum() >= LEAST_ROWS) for one in (used[LEFT], used[~LEFT])])


def _shape_of(s: Floats) -> Floats:
    """Return (..., 3) by how much offset, slope and curvature move a line at s."""
    return np.stack([np.ones_like(s), s, 0.5 * s * s], axis=-1)


def _slope_of(s: Floats) -> Floats:
    """Return (..., 3) by how much offset, slope and curvature turn a line at s."""
    return np.stack([np.zeros_like(s), np.ones_like(s), s], axis=-1)


def _of_sides(shape: Floats, left: Mask) -> Floats:
    return np.asarray(np.where(left[:, None], shape @ TO_LEFT, shape @ TO_RIGHT))


def _expectations(expected: Expected, line: Floats, pitch: float) -> tuple[Floats, Floats]:
    """Return the equations of what is known before the rows, a matrix (8, 7) and values (8,), all with deviation 1.

    The unknowns are both offsets, the mean slope and curvature, the differences of these, and a change of the tilt.
    Seen straight ahead, the inner boundary of a bend bends more: w sqrt(1 + y'**2) to the left of a line y, there is
    one that is parallel to it, and the second derivative of that distance is about w y''**2.

    Args:
        expected: What is known.
        line: (6,) the latest estimate of the unknowns but the tilt's.
        pitch: The latest estimate of the tilt, rad.
    """
    course, width = expected.course, expected.width
    if course is None:
        (turned, bent), (slope, curvature) = ANYWHERE, line[2:4].tolist()
        apart = [width * slope * curvature, width * curvature * curvature]
    else:
        turned, bent = OFF_ROUTE[0], math.hypot(OFF_ROUTE[1], OFF_ROUTE[2] * course.bend)
        apart = [0.0, 0.0]
    offsets, deviations = [], []
    for remembered, usual in zip(expected.offsets, (0.5 * width, -0.5 * width), strict=True):
        offsets.append(usual if remembered is None else remembered)
        deviations.append(OFFSET_DEVIATION if remembered is None else MEMORY_DEVIATION)
    known = 1.0 / np.array([*deviations, turned, bent, *OFF_PARALLEL, expected.tilt.deviation])
    means = known * np.array([*offsets, 0.0, 0.0, *apart, expected.tilt.pitch - pitch])
    beside = np.array([[1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]]) / expected.width_deviation
    return np.concatenate([np.diag(known), beside]), np.append(means, width / expected.width_deviation)


@dataclass(frozen=True, eq=False)
class _Ground:
    """Where the rows of both sides, first the left one's, lie on the ground, (2 ROWS,) each, m."""

    s: Floats
    t: Floats
    deviation: Floats

    @staticmethod
    def of(rows: Rows, pitch: float, expected: Expected) -> _Ground:
        pixels = TRAINED_FOR.width / COLUMNS
        ahead, fall, right = rays((rows.column + 0.5) * pixels - 0.5, np.concatenate([V, V]), pitch)
        fall = np.maximum(fall, LEAST_FALL)
        height, course = expected.scale * TRAINED_FOR.z, expected.course
        far = height / fall
        if course is None:
            s, t, turned = ahead * far, -right * far, np.ones_like(far)
        else:
            for _ in range(MEETINGS):
                s, t = course.place(ahead * far, -right * far)
                above = height - course.height(s, t) - fall * far
                falls = fall + ahead * (course.height(s + SHORT, t) - course.height(s, t)) / SHORT
                onward = np.where(falls > LEAST_FALL, above / np.maximum(falls, LEAST_FALL), 0.0)
                far = np.clip(far + onward, 0.5 * far, 2.0 * far)
                if np.abs(onward)[s < LOOKED_AT[1]].max(initial=0.0) < MET:
                    break
            turned = np.cos(course.heading_at(s))
        return _Ground(
            s, t, np.hypot((rows.spread + COLUMNS_OFF) * pixels * ahead * far * turned / TRAINED_FOR.focal, NEAREST_OFF)
        )


def rays(u: Floats, v: Floats, pitch: float) -> tuple[Floats, Floats, Floats]:
    """Return by how much the rays of pixels lead ahead, down and to the right, for a unit along the optical axis."""
    tilted = TRAINED_FOR.pitch + pitch
    down = (v - TRAINED_FOR.height / 2.0) / TRAINED_FOR.focal
    right = (u - TRAINED_FOR.width / 2.0) / TRAINED_FOR.focal
    return math.cos(tilted) + down * math.sin(tilted), down * math.cos(tilted) - math.sin(tilted), right


def ground_of(u: Floats, v: Floats, pitch: float) -> tuple[Floats, Floats]:
    """Return where pixels see the level ground, m ahead and to the left; x is infinite above the horizon."""
    ahead, fall, right = rays(u, v, pitch)
    far = np.where(fall > 1e-3, TRAINED_FOR.z / np.maximum(fall, 1e-3), np.inf)
    return ahead * far, -right * np.where(np.isfinite(far), far, 0.0)


def _line(seen: _Ground, side: Mask, curve: Floats, covariance: Floats, pitch: float, expected: Expected) -> Line:
    end, along = _shape_of(np.array(JUDGED[1])), _shape_of(seen.s[side]) @ curve
    height, course = expected.scale * TRAINED_FOR.z, expected.course
    t, slope = _shape_of(STRETCH) @ curve, curve[1] + curve[2] * STRETCH
    if course is None:
        x, y, rise = STRETCH, t, np.zeros_like(t)
        lever = moved_aside(x, y, np.ones_like(x), slope) / height
    else:
        (x, y), rise = course.points(STRETCH, t), course.height(STRETCH, t)
        lever = course.lever(STRETCH, t, slope, height)
    u, v = TRAINED_FOR.project_ground(x / expected.scale, y / expected.scale, pitch, rise / expected.scale)
    inside = (u > 0.0) & (u < TRAINED_FOR.width) & (v > 0.0) & (v < TRAINED_FOR.height)
    uncertain = math.sqrt(float(end @ covariance @ end))
    moved = float(np.abs(lever[np.isfinite(lever)]).max(initial=0.0))
    return Line(curve, seen.s[side], seen.t[side] - along, seen.deviation[side], uncertain, moved, float(inside.mean()))
