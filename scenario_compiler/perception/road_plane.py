"""The tilt of the road ahead against the plane that the car stands on, from the two boundaries of the lane.

Seen from above through a camera that is tilted up by an unknown angle p, a point x metres ahead appears at x' with 1 /
x' = 1 / x + p / h (h is the camera's height), and lateral distances shrink by x' / x = 1 - p x' / h. So two boundaries
that are parallel on the road appear to converge, by w p / h for each metre ahead, where w is the lane's width. A
braking car and a road that falls or rises ahead look the same.

A narrowing lane looks like a tilt as well. Prior distributions of how much lanes narrow and how far cars and roads tilt
determine which is more likely, together with the result for the previous image.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import X_FROM
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_fit import Fit, arc_y

Floats = NDArray[np.float64]

COMPARED = (6.0, 20.0)
"""Distances ahead of the camera at which the lane's widths are compared, m."""

TAPER = 0.008
"""Standard deviation of a lane's widening per metre: most keep their width, a taper has 1:30 to 1:50."""

BEND_DOUBT = 8.0
"""Addition to it for each unit of the squared curvature, m2, because the far ends of a bend are not visible."""

USUAL_PITCH = math.radians(1.0)
"""Prior standard deviation of the tilt, rad: beginning grades, and braking with 4 m/s2."""

PITCH_CHANGE = math.radians(0.25)
"""Standard deviation of its change from one image to the next, rad: braking hard changes it by 1 degree in 0.3 s."""

WIDTH_DEVIATION, BEND_DEVIATION = 0.15, 0.002
"""Standard deviations of the distance of two fitted boundaries, m, and of the difference of their curvatures, 1/m."""

FIT_DEVIATION, MAP_DEVIATION, LEVER = 0.001, 0.03, 84.5
"""Standard deviations of the curvature of a well visible boundary, 1/m, and of the map's, in parts of it, and by how
much a unit of curvature moves a boundary 18 m ahead, m2.
"""

SHORTEST, LEAST_EFFECT = 1.5, 1e-9
"""Length of the visible part of a boundary, m, and the effect of a tilt from which a tilt can be observed."""

WIDTHS, BENDS = 5.0, 0.04
"""Ranges of the two over which boundaries that belong to no lane are spread, m and 1/m."""

KEPT = 0.98
"""Share of the tilt that remains after one image without an observation: the body levels, the grade ends."""

STEEPEST = math.radians(4.0)
"""Greatest possible tilt, rad."""


@dataclass(frozen=True)
class Tilt:
    """A tilt of the camera against the ground ahead.

    Attributes:
        pitch: Upward tilt relative to the mounting, rad.
        deviation: Its standard deviation, rad.
    """

    pitch: float
    deviation: float

    def and_also(self, other: Tilt) -> Tilt:
        """Return the estimate from two independent observations, which is uncertain by as much as they contradict."""
        own, others = 1.0 / self.deviation**2, 1.0 / other.deviation**2
        if own == 0.0 or others == 0.0:
            return self if others == 0.0 else other
        pitch, deviation = (own * self.pitch + others * other.pitch) / (own + others), 1.0 / math.sqrt(own + others)
        apart = max(abs(self.pitch - other.pitch) - self.deviation - other.deviation, 0.0)
        return Tilt(pitch, math.hypot(deviation, apart))

    def less(self, grade: float) -> Tilt:
        """Return the tilt against a plane that is itself tilted by `grade`, rad."""
        return Tilt(self.pitch - grade, self.deviation)

    def later(self) -> Tilt:
        """Return the prediction for the next image."""
        return Tilt(KEPT * self.pitch, min(math.hypot(self.deviation, PITCH_CHANGE), USUAL_PITCH))

    def with_seen(self, seen: Tilt, real: float = 1.0) -> Tilt:
        """Return the tilt after another independent observation of it.

        An observation that may be wrong is weighted by its agreement with what is known, as in the probabilistic data
        association filter (Bar-Shalom and Tse, Automatica 11, 1975): it is normally distributed if it is right, and
        uniformly up to `STEEPEST` if it is not.

        Args:
            seen: The observation.
            real: Prior probability that it is an observation of the tilt.
        """
        variance = self.deviation**2 + seen.deviation**2
        if not math.isfinite(variance):
            return self
        away, gain = seen.pitch - self.pitch, self.deviation**2 / variance
        density = math.exp(-0.5 * away * away / variance) / math.sqrt(2.0 * math.pi * variance)
        true, false = real * density, (1.0 - real) / (2.0 * STEEPEST)
        chance = true / (true + false) if false > 0.0 else 1.0
        pitch = self.pitch + chance * gain * away
        spread = chance * (1.0 - chance) * (gain * away) ** 2
        left = (1.0 - chance * gain) * self.deviation**2 + spread
        return Tilt(min(max(pitch, -STEEPEST), STEEPEST), min(math.sqrt(left), USUAL_PITCH))


LEVEL = Tilt(0.0, USUAL_PITCH)
"""The tilt without any image."""

UNKNOWN = Tilt(0.0, math.inf)
"""An observation that says nothing."""


def tilt_beyond(left: Fit, right: Fit, height: float, course: Course | None = None) -> Tilt:
    """Return the remaining tilt after two boundaries were fitted in a map of the ground.

    Args:
        left: The left boundary.
        right: The right boundary.
        height: Height of the camera, m.
        course: The planned route, if the ground is viewed along it.
    """
    near, far = (_width(left, right, x - X_FROM) for x in COMPARED)
    slope = (far - near) / (COMPARED[1] - COMPARED[0])
    width = near - slope * COMPARED[0]
    variance = left.slope_deviation**2 + right.slope_deviation**2
    bend = 0.5 * float(left.curve[2] + right.curve[2])
    if course is None:
        return tilt_of_widening(slope, width, bend, variance, height)
    bend += course.bend
    return tilt_of_widening(slope, width, bend, variance, height).and_also(tilt_of_bend(left, right, course, height))


def tilt_of_bend(left: Fit, right: Fit, course: Course, height: float) -> Tilt:
    """Return the tilt at which the better visible boundary, fitted along the planned route, is parallel to the route.

    A tilt moves what is seen the more, the farther it is, and in a bend also sideways (see `moved_aside`), so that a
    boundary leaves the route's direction and bends differently. The two contradict each other if it is no tilt.

    Args:
        left: The left boundary.
        right: The right boundary.
        course: The planned route along which the ground is viewed.
        height: Height of the camera, m.

    Returns:
        The remaining tilt, rad, with an infinite deviation if the route is straight or no paint was found.
    """
    seen = min((left, right), key=lambda fit: fit.slope_deviation)
    if not math.isfinite(seen.slope_deviation) or seen.farthest - seen.nearest < SHORTEST:
        return UNKNOWN
    s = np.linspace(seen.nearest, seen.farthest, 15)
    middle = 0.5 * (seen.nearest + seen.farthest)
    d = s - X_FROM
    lever = course.lever(s, arc_y(seen.curve, d), seen.curve[1] + seen.curve[2] * d, height)
    if not np.isfinite(lever).all():
        return UNKNOWN
    half, leaning, _ = np.polyfit(s - middle, lever, 2).tolist()
    slope = float(seen.curve[1] + seen.curve[2] * (middle - X_FROM))
    curved = math.hypot(FIT_DEVIATION, seen.deviations[1] / LEVER, MAP_DEVIATION * course.bend)
    leaned = _tilt_of(slope, leaning, math.hypot(seen.slope_deviation, TAPER))
    return leaned.and_also(_tilt_of(float(seen.curve[2]), 2.0 * half, curved))


def _tilt_of(seen: float, of_tilt: float, deviation: float) -> Tilt:
    """Return the tilt from a quantity, its change for each radian of tilt, and its deviation."""
    return Tilt(seen / of_tilt, deviation / abs(of_tilt)) if abs(of_tilt) > LEAST_EFFECT else UNKNOWN


def alike(left: Fit, right: Fit, width: float, spread: float, painted: tuple[float, float]) -> float:
    """Return the probability that a tilt is observed: that of two boundaries which are painted and those of one lane.

    The sides of a lane are as far apart as it is wide, and bend alike. Those that belong to nothing are anywhere. Where
    only one of them is visible, nothing but its paint counts.

    Args:
        left: The left boundary.
        right: The right boundary.
        width: Expected width of the lane, m.
        spread: Its standard deviation, m.
        painted: Probabilities that the left and the right side are painted.
    """
    if left.in_view == 0.0 or right.in_view == 0.0:
        return painted[1] if left.in_view == 0.0 else painted[0]
    both = painted[0] * painted[1]
    off, apart = float(left.curve[0] - right.curve[0]) - width, float(left.curve[2] - right.curve[2])
    true = both * _normal(off, math.hypot(spread, WIDTH_DEVIATION)) * _normal(apart, BEND_DEVIATION)
    false = (1.0 - both) / (WIDTHS * BENDS)
    return true / (true + false)


def _normal(off: float, deviation: float) -> float:
    return math.exp(-0.5 * (off / deviation) ** 2) / (deviation * math.sqrt(2.0 * math.pi))


def tilt_of_widening(slope: float, width: float, bend: float, variance: float, height: float) -> Tilt:
    """Return the tilt at which a lane that appears to widen has a constant width.

    Args:
        slope: Its apparent widening per metre ahead.
        width: Its width below the camera, m.
        bend: Its curvature, 1/m, which increases the uncertainty, because a lane may taper.
        variance: Variance of the slope.
        height: Height of the camera, m.

    Returns:
        The tilt, rad, with an infinite deviation if the lane is less than 1 m wide.
    """
    if width < 1.0:
        return UNKNOWN
    doubt = TAPER + BEND_DOUBT * bend * bend
    deviation = math.sqrt(variance + doubt * doubt)
    return Tilt(-height * slope / width, height * deviation / width)


def _width(left: Fit, right: Fit, d: float) -> float:
    """Return the distance of two boundaries d metres ahead, m, perpendicular to the lane between them."""
    at = np.array([d - 0.5, d + 0.5])
    y_left, y_right = arc_y(left.curve, at), arc_y(right.curve, at)
    heading = 0.5 * float((y_left + y_right) @ np.array([-1.0, 1.0]))
    return float((y_left - y_right).mean()) / math.hypot(1.0, heading)
