"""Finds the lane's two boundaries in a camera image, each with a probability.

A detector is any object with `detect`; `detectors` has the table of the packaged ones. `ClassicalLaneDetector` views
the ground from above (`birds_eye`), votes for pairs of arcs (`lane_fit`) and computes their confidence (`confidence`).

The tilt of the camera against the road ahead is estimated from the image (`road_plane`) and remembered, unless it is
given.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.perception.birds_eye import PITCH_STEP, X_FROM, BirdsEye, Ridges
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import (
    FEATURES,
    LASTING,
    MIDDLE,
    NEWEST,
    PLACES,
    Before,
    Circumstances,
    Confidence,
    Evidence,
    features,
    load_confidence,
    noise_of,
)
from scenario_compiler.perception.course import WIDTH_AT, Course
from scenario_compiler.perception.lane_fit import (
    LEFT,
    NEARBY,
    RIGHT,
    Fit,
    LaneFitter,
    arc_y,
    nearest_parabola,
    parabola_of,
)
from scenario_compiler.perception.road_plane import LEVEL, USUAL_PITCH, Tilt, alike, tilt_beyond
from scenario_compiler.perception.route_ahead import SHARP

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]
Votes = NDArray[np.float32]

USUAL_WIDTH, USUAL_SPREAD = 3.45, 0.5
"""Prior width of a lane and its deviation, m: rural and urban lanes have 3.0 to 3.75 m, some 4."""

KNOWN_SPREAD = 0.25
"""Deviation of the width if it is known from the map or from the images before, m."""

MOST_ROUNDS = 3
"""Greatest number of times that an image is processed with a better pitch; usually one suffices."""

STARTS, COST_OF_PITCH = (0.0, math.radians(1.5), math.radians(-1.5)), 1.5
"""Pitches that are tried if none is known, rad, and the cost in votes of the square of a pitch in standard deviations.
"""

BEND_STARTS = tuple(math.radians(0.5 * k) for k in (0, 1, -1, 2, -2, 3, -3, 4, -4))
"""The same in a sharp bend, where a tilt moves a boundary more than from side to side of a lane, rad."""

FORGOTTEN = 0.7
"""Deviation of the tilt, relative to the usual one, above which it counts as unknown."""

REMEMBERED, IN_VIEW = 0.5, 0.25
"""Probability above which a boundary is searched at its previous position, and the share of the judged stretch in the
image below which the search there goes on, whatever the probability is.
"""


@dataclass(frozen=True)
class Boundary:
    """One boundary of the lane: y = y0 + slope x + curvature x**2 / 2 in the camera's ground frame.

    A boundary with a course is measured along that: x and y are then its s and t, and a boundary that follows it is
    straight, however sharply both bend.

    Attributes:
        y0: Offset below the camera, m, positive to the left.
        slope: dy/dx there.
        curvature: 1/m, positive in left turns.
        p_geom: Probability that it lies within 0.25 m of the true boundary from 6 to 18 m ahead along the lane.
        p_paint: Probability that most of that stretch is painted, however little of it the camera sees.
        p: Confidence, the probability of both: without paint a right guess is luck.
        x_range: Nearest and farthest x at which paint was seen, m.
        course: The planned route along which it is measured; None for straight ahead.
        in_view: Share of the stretch from 6 to 18 m ahead that lies in the image.
    """

    y0: float
    slope: float
    curvature: float
    p_geom: float
    p_paint: float
    p: float
    x_range: tuple[float, float]
    course: Course | None = None
    in_view: float = 1.0

    def across(self, ahead: ArrayLike) -> Floats:
        """Return how far to the left it is at distances ahead, along its course if it has one, m."""
        distance = np.asarray(ahead, np.float64)
        return self.y0 + self.slope * distance + 0.5 * self.curvature * distance * distance

    def points(self, ahead: ArrayLike) -> tuple[Floats, Floats]:
        """Return x and y in the camera's ground frame at distances ahead (n,) along its course if it has one, m.

        They are NaN near the centre of a bend and beyond it.
        """
        distance = np.asarray(ahead, np.float64)
        across = self.across(distance)
        return (distance, across) if self.course is None else self.course.points(distance, across)

    def y(self, x: ArrayLike) -> Floats:
        """Return the lateral position at x metres straight ahead of the camera (see `as_parabola`)."""
        return self.as_parabola().across(x)

    def at(self, ahead: ArrayLike, way: Course | None) -> Floats | None:
        """Return how far to the left it is at some distances ahead, along the route that is known now if one is, m.

        It is None if the boundary does not cross the route's normal there.
        """
        if way is None:
            return self.y(ahead)
        if self.course is not None:
            return self.across(ahead) + way.moved_since(self.course)
        across = way.across(np.asarray(ahead, np.float64), (self.y0, self.slope, self.curvature))
        return across if np.isfinite(across).all() else None

    def slope_at(self, x: float) -> float:
        """Return dy/dx at x metres ahead."""
        return self.slope + self.curvature * x

    def as_parabola(self) -> Boundary:
        """Return the boundary without a course: the parabola straight ahead that is nearest to it 5 to 19 m ahead.

        In a bend with a radius of 10 m, they differ by 0.5 to 2 m.
        """
        if self.course is None:
            return self
        x, y = self.points(NEARBY)
        slopes = np.arctan(self.slope + self.curvature * NEARBY)
        y0, slope, curvature = nearest_parabola(x, y, self.course.heading_at(NEARBY) + slopes)
        return replace(self, y0=y0, slope=slope, curvature=curvature, course=None)


@dataclass(frozen=True)
class LaneResult:
    """The result for one image.

    Attributes:
        left: Left boundary.
        right: Right boundary.
        sensor_health: From 1 (healthy) to 0 (broken); it multiplies both probabilities.
        sigma_hat: Measured noise, grey levels.
        p_left: left.p * sensor_health.
        p_right: right.p * sensor_health.
        lane_width: Distance between the boundaries 10 m ahead, m.
        tilt: Tilt of the camera against the ground ahead, relative to its mounting.
        evidence: The detector's memory of the sides in addition to the boundaries; None if it has none.
    """

    left: Boundary
    right: Boundary
    sensor_health: float
    sigma_hat: float
    p_left: float
    p_right: float
    lane_width: float
    tilt: Tilt = LEVEL
    evidence: Evidence | None = None


@dataclass(frozen=True)
class LaneState:
    """The memory from one image to the next.

    Attributes:
        left: Left boundary, if it was trusted when it was last in view.
        right: Right boundary, if it was trusted when it was last in view.
        width: Lane width, m, averaged over the images in which both sides were sure; None before the first one.
        way: The planned route, if it is known; the search begins with boundaries along it.
        tilt: Tilt of the camera, relative to its mounting, against the ground ahead as the map has it; without a map,
            against the plane that the car stands on.
        last: Both boundaries of the last image, trusted or not.
        evidence: The detector's memory of the sides in addition to the boundaries.
        images: Number of images so far.
    """

    left: Boundary | None = None
    right: Boundary | None = None
    width: float | None = None
    way: Course | None = None
    tilt: Tilt = LEVEL
    last: tuple[Boundary, Boundary] | None = None
    evidence: Evidence | None = None
    images: int = 0

    @property
    def expected_width(self) -> float | None:
        """Width of the lane by the map, or else as it was seen, m; None if neither is known."""
        return self.width if self.way is None or self.way.width is None else self.way.width

    @property
    def newest(self) -> float:
        """Weight of the next image in running means."""
        return max(NEWEST, 1.0 / (self.images + 1))

    def lately(self, names: tuple[str, ...], side: int) -> Floats | None:
        """Return the running means of features of the left side, 0, or the right one, 1 (see `Evidence.before`)."""
        return None if self.evidence is None else self.evidence.before(names, side)

    def after(self, result: LaneResult) -> LaneState:
        """Return the state after one more image."""
        width = self.width
        if min(result.left.p, result.right.p) > 0.8:
            width = result.lane_width if width is None else 0.9 * width + 0.1 * result.lane_width
        return LaneState(
            _remembered(self.left, result.left),
            _remembered(self.right, result.right),
            width,
            self.way,
            tilt=result.tilt.less(grade_of(result.left.course)).later(),
            last=(result.left, result.right),
            evidence=result.evidence,
            images=self.images + 1,
        )


class LaneDetector(Protocol):
    """Finds the lane in an image."""

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """Return the lane that the camera is in.

        Args:
            image: (height, width, 3) uint8, BGR.
            prior: The memory, None for the first image.
            pitch: Upward tilt of the camera against the ground ahead, rad, relative to its mounting, if it is known;
                None to estimate it from the image.
        """
        ...


class CalibratedDetector(LaneDetector, Protocol):
    """A detector with a fitted confidence.

    Attributes:
        features: Names of the confidence's features.
        confidence_file: The file with the confidence, beside the package's modules.
    """

    features: ClassVar[tuple[str, ...]]
    confidence_file: ClassVar[str]

    def __init__(self, camera: Camera | None = None, *, confidence: Confidence | None = None) -> None:
        """Prepare for one camera, by default the default one, and by default with the packaged confidence."""

    def look(
        self, image: Image, prior: LaneState | None = None, pitch: float | None = None
    ) -> tuple[LaneResult, tuple[Floats, Floats]]:
        """Return the result of `detect`, and the features of the left and the right side."""
        ...


class ClassicalLaneDetector:
    """Ridges seen from above, exhaustive voting for pairs of arcs, a calibrated confidence."""

    features: ClassVar[tuple[str, ...]] = FEATURES
    confidence_file: ClassVar[str] = "lane_confidence.json"

    def __init__(self, camera: Camera | None = None, confidence: Confidence | None = None) -> None:
        """Prepare for one camera.

        Args:
            camera: The camera and its mounting, the default camera if None.
            confidence: Computes probabilities from features; the packaged one if None.

        Raises:
            ValueError: The camera does not see the ground where a boundary could be.
        """
        self.camera = camera if camera is not None else Camera()
        self.confidence = confidence or load_confidence(self.confidence_file, self.features)
        self.birds_eye = BirdsEye(self.camera)
        self.fitter = LaneFitter(self.birds_eye)
        if not all(len(curves) for curves in self.fitter.curves):
            raise ValueError("the camera does not see both sides of the lane 5 to 30 m ahead")

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """Return the lane that the camera is in (see `LaneDetector.detect`)."""
        return self.look(image, prior, pitch)[0]

    def look(
        self, image: Image, prior: LaneState | None = None, pitch: float | None = None
    ) -> tuple[LaneResult, tuple[Floats, Floats]]:
        """Return the result of `detect`, and the features of the confidence in the left and the right side."""
        sigma_hat = noise_of(image)
        fits, rows, tilt = self.examine(image, prior, pitch, sigma_hat)
        health = noise_health(sigma_hat)
        said = self.confidence(np.stack(rows)).tolist()
        way = prior.way if prior is not None else None
        left, right = (_boundary(fit, way, *p) for fit, p in zip(fits, said, strict=True))
        return LaneResult(
            left,
            right,
            health,
            sigma_hat,
            left.p * health,
            right.p * health,
            lane_width=_width(*fits),
            tilt=tilt,
            evidence=Evidence.of(rows, LASTING),
        ), rows

    def examine(
        self, image: Image, prior: LaneState | None, pitch: float | None, noise: float
    ) -> tuple[tuple[Fit, Fit], tuple[Floats, Floats], Tilt]:
        """Return the fits of the left and the right side, the features of their confidence, and the detected tilt."""
        state = prior if prior is not None else LaneState()
        expected = state.expected_width
        width, spread = (USUAL_WIDTH, USUAL_SPREAD) if expected is None else (expected, KNOWN_SPREAD)
        grade = grade_of(state.way)
        known = Circumstances(width, Tilt(0.0, 0.0), Tilt(0.0, 0.0), 0.0, self.camera.z, noise, state.way)
        before = _before(state, 0), _before(state, 1)
        if pitch is not None:
            tilt = Tilt(pitch - grade, 0.0)
            ridges = self.birds_eye.ridges(image, tilt.pitch, state.way)
            fits = self._fit(ridges, state, width, spread)
            known = replace(known, tilt=tilt, seen=tilt)
        else:
            start = self._first_pitch(image, state, width, spread)
            for _ in range(MOST_ROUNDS):
                ridges = self.birds_eye.ridges(image, start, state.way)
                fits = self._fit(ridges, state, width, spread)
                beyond = tilt_beyond(*fits, self.camera.z, state.way)
                seen = Tilt(start + beyond.pitch, beyond.deviation)
                found = state.tilt.with_seen(seen)
                looked_at, start = start, found.pitch
                if abs(start - looked_at) <= PITCH_STEP:
                    break
            unsettled = abs(start - looked_at)
            # If successive searches show different tilts, the two sides do not belong to one lane.
            seen = Tilt(seen.pitch, math.hypot(seen.deviation, unsettled))
            known = replace(known, tilt=found, seen=seen, unsettled=unsettled)
            painted = self._painted(features(fits, ridges, known, before))
            tilt = state.tilt.with_seen(seen, alike(*fits, width, spread, painted))
            if abs(tilt.pitch - looked_at) > PITCH_STEP:
                ridges = self.birds_eye.ridges(image, tilt.pitch, state.way)
                fits = self._fit(ridges, state, width, spread)
            known = replace(known, tilt=tilt)
        return fits, features(fits, ridges, known, before), tilt.less(-grade)

    def _painted(self, rows: tuple[Floats, Floats]) -> tuple[float, float]:
        """Return the probabilities that the sides are painted; only from paint can the tilt be estimated."""
        left, right = self.confidence(np.stack(rows))[:, 1].tolist()
        return left, right

    def _first_pitch(self, image: Image, state: LaneState, width: float, spread: float) -> float:
        """Return the initial pitch: the remembered one, or else the one with most paint on two arcs."""
        first = state.tilt.pitch
        if state.tilt.deviation < FORGOTTEN * USUAL_PITCH:
            return first
        best, most = first, -math.inf
        for away in STARTS if state.way is None or abs(state.way.turn) < SHARP else BEND_STARTS:
            votes, chosen = self._chosen(self.birds_eye.ridges(image, first + away, state.way), state, width, spread)
            support = float(votes[LEFT][chosen[LEFT]]) + float(votes[RIGHT][chosen[RIGHT]])
            score = support - COST_OF_PITCH * (away / USUAL_PITCH) ** 2
            if score > most:
                best, most = first + away, score
        return best

    def _fit(self, ridges: Ridges, state: LaneState, width: float, spread: float) -> tuple[Fit, Fit]:
        return self.fitter.refine(ridges, *self._chosen(ridges, state, width, spread))

    def _chosen(
        self, ridges: Ridges, state: LaneState, width: float, spread: float
    ) -> tuple[tuple[Votes, Votes], tuple[int, int]]:
        """Return the votes for the arcs of both sides, and the numbers of the two arcs that are chosen."""
        votes = (self.fitter.votes(ridges, LEFT), self.fitter.votes(ridges, RIGHT))
        scores = (
            self.fitter.scores(votes[LEFT], LEFT, _curve(state.left, state.way)),
            self.fitter.scores(votes[RIGHT], RIGHT, _curve(state.right, state.way)),
        )
        if state.way is None:
            return votes, self.fitter.pair(scores, width, spread)
        # The way only says where to begin: the paint decides what is there, and the probability keeps its sense.
        begun = self.fitter.pair(scores, width, spread, on_course=True)
        return votes, self.fitter.settle(scores, width, spread, begun)


def _before(state: LaneState, side: int) -> Before:
    trusted = (state.left, state.right)[side]
    middle = None if trusted is None else trusted.at(MIDDLE, state.way)
    return Before(
        None if middle is None else float(middle),
        None if state.last is None else state.last[side].at(PLACES, state.way),
        state.lately(LASTING, side),
        state.newest,
    )


def _boundary(fit: Fit, way: Course | None, p_geom: float, p_paint: float, p: float) -> Boundary:
    y0, slope, curvature = parabola_of(fit.curve)
    return Boundary(y0, slope, curvature, p_geom, p_paint, p, (fit.nearest, fit.farthest), way, fit.in_view)


def _remembered(before: Boundary | None, now: Boundary) -> Boundary | None:
    """Return the boundary to search for in the next image, None if there is none to trust.

    What lies outside the image does not contradict what was seen.
    """
    if now.p > REMEMBERED:
        return now
    return before if now.in_view < IN_VIEW else None


def grade_of(way: Course | None) -> float:
    """Return the tilt that the map gives the ground ahead, rad, 0 without a route (see `Course.grade`)."""
    return 0.0 if way is None else way.grade


def _width(left: Fit, right: Fit) -> float:
    at = np.array([WIDTH_AT - X_FROM])
    return float((arc_y(left.curve, at) - arc_y(right.curve, at))[0])


def _curve(boundary: Boundary | None, way: Course | None) -> Floats | None:
    """Return offset, slope and curvature of a boundary 5 m ahead; None if there is none along the route."""
    if boundary is None:
        return None
    places = boundary.at(PLACES, way)
    if places is None:
        return None
    half, slope, offset = np.polyfit(PLACES - X_FROM, places, 2)
    return np.array([offset, slope, 2.0 * half])
