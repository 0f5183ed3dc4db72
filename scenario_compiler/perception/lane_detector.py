"""Finds the lane's two boundaries in a camera image, each with a probability.

A detector is anything with `detect`; `ClassicalLaneDetector` is the one in the box: it looks at the ground
from above (`birds_eye`), votes for pairs of parabolas (`lane_fit`) and says how far they can be trusted
(`confidence`).

What the probabilities do not cover: a camera that is pitched otherwise than it was mounted (one degree moves
the boundaries by more than 0.25 m and the score does not see it; `detect` takes the pitch where it is
known), and anything that is not a line (a car ahead, an obstacle).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.perception.birds_eye import X_FROM, BirdsEye, Ridges
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import (
    features,
    load_calibration,
    noise_of,
    probability,
)
from scenario_compiler.perception.lane_fit import CURVATURES, LEFT, RIGHT, Fit, LaneFitter

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

USUAL_WIDTH, USUAL_SPREAD = 3.45, 0.5
"""Width of a lane and its deviation before any was seen, m: rural and urban lanes have 3.0 to 3.75 m, some 4."""

TRACKED_SPREAD = 0.25
"""Deviation of the width once it is known, m."""

REMEMBERED = 0.5
"""Probability over which a boundary is looked for again where it was."""


@dataclass(frozen=True)
class Boundary:
    """One boundary of the lane: y = y0 + slope x + curvature x**2 / 2 in the camera's ground frame.

    Attributes:
        y0: Offset below the camera, m, left positive.
        slope: dy/dx there.
        curvature: 1/m, left turns positive.
        p_geom: Probability that it is right and painted, 0-1: by the image alone as the detector has it.
        x_range: Nearest and farthest x at which paint was seen, m.
    """

    y0: float
    slope: float
    curvature: float
    p_geom: float
    x_range: tuple[float, float]

    def y(self, x: ArrayLike) -> Floats:
        """Return the lateral position at x metres ahead of the camera."""
        ahead = np.asarray(x, np.float64)
        return self.y0 + self.slope * ahead + 0.5 * self.curvature * ahead * ahead


@dataclass(frozen=True)
class LaneResult:
    """What was found in one image.

    Attributes:
        left: Left boundary.
        right: Right boundary.
        sensor_health: 1 well, 0 broken; it multiplies both probabilities.
        sigma_hat: Measured noise, grey levels.
        p_left: left.p_geom * sensor_health.
        p_right: right.p_geom * sensor_health.
        lane_width: Distance between the boundaries 10 m ahead, m.
    """

    left: Boundary
    right: Boundary
    sensor_health: float
    sigma_hat: float
    p_left: float
    p_right: float
    lane_width: float


@dataclass(frozen=True)
class LaneState:
    """What is remembered from one image for the next.

    Attributes:
        left: Left boundary when it was trusted.
        right: Right boundary when it was trusted.
        width: Lane width, m, averaged over the images in which both sides were sure; None before there was
            one.
        way: Slope below the camera and curvature, 1/m, of the way that the car is to go, where others branch off:
            the search begins with boundaries that go that way.
    """

    left: Boundary | None = None
    right: Boundary | None = None
    width: float | None = None
    way: tuple[float, float] | None = None

    def after(self, result: LaneResult) -> LaneState:
        """Return the state after one more image."""
        width = self.width
        if min(result.left.p_geom, result.right.p_geom) > 0.8:
            width = result.lane_width if width is None else 0.9 * width + 0.1 * result.lane_width
        left = result.left if result.left.p_geom > REMEMBERED else None
        right = result.right if result.right.p_geom > REMEMBERED else None
        return LaneState(left, right, width)


class LaneDetector(Protocol):
    """Finds the lane in an image."""

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float = 0.0) -> LaneResult:
        """Return the lane that the camera is in.

        Args:
            image: (height, width, 3) uint8, BGR.
            prior: What is remembered, None for the first image.
            pitch: Upward tilt of the camera against the ground ahead, rad, beyond its mounting.
        """
        ...


class ClassicalLaneDetector:
    """Ridges seen from above, exhaustive voting for pairs of parabolas, a calibrated logistic score."""

    def __init__(self, camera: Camera | None = None, weights: tuple[float, ...] | None = None) -> None:
        """Prepare for one camera.

        Args:
            camera: The camera and its mounting, the default camera when None.
            weights: Weights of the confidence; those of the shipped calibration when None.
        """
        self.camera = camera if camera is not None else Camera()
        self.weights = weights if weights is not None else load_calibration().weights
        self.birds_eye = BirdsEye(self.camera)
        self.fitter = LaneFitter(self.birds_eye)

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float = 0.0) -> LaneResult:
        """Return the lane that the camera is in (see `LaneDetector.detect`)."""
        fits, rows = self.examine(image, prior, pitch)
        sigma_hat = noise_of(image)
        health = noise_health(sigma_hat)
        left, right = (_boundary(fit, probability(row, self.weights)) for fit, row in zip(fits, rows, strict=True))
        return LaneResult(
            left=left,
            right=right,
            sensor_health=health,
            sigma_hat=sigma_hat,
            p_left=left.p_geom * health,
            p_right=right.p_geom * health,
            lane_width=float(left.y(10.0) - right.y(10.0)),
        )

    def examine(
        self, image: Image, prior: LaneState | None = None, pitch: float = 0.0
    ) -> tuple[tuple[Fit, Fit], tuple[Floats, Floats]]:
        """Return the fits of the left and the right side and the features of their confidence."""
        state = prior if prior is not None else LaneState()
        width, spread = (USUAL_WIDTH, USUAL_SPREAD)
        if state.width is not None:
            width, spread = state.width, TRACKED_SPREAD
        ridges = self.birds_eye.ridges(image, pitch)
        votes = (self.fitter.votes(ridges, LEFT), self.fitter.votes(ridges, RIGHT))
        tracked = (_curve(state.left), _curve(state.right))
        way = _shape(state.way)
        chosen = self.fitter.pair(votes, width, spread, tracked, way)
        if way is not None:
            # The way only says where to begin: the paint decides what is there, and the probability keeps its sense.
            chosen = self.fitter.settle(votes, width, spread, chosen)
        left, right = self.fitter.refine(ridges, votes, chosen)
        return (left, right), self._features(left, right, ridges, width)

    def _features(self, left: Fit, right: Fit, ridges: Ridges, width: float) -> tuple[Floats, Floats]:
        off = float(left.curve[0] - right.curve[0]) - width
        return features(left, ridges, off), features(right, ridges, off)


def _boundary(fit: Fit, p_geom: float) -> Boundary:
    """Return the fit with its parabola moved from 5 m ahead to the camera's foot."""
    offset, slope, curvature = (float(value) for value in fit.curve)
    y0 = offset - slope * X_FROM + 0.5 * curvature * X_FROM * X_FROM
    return Boundary(y0, slope - curvature * X_FROM, curvature, p_geom, (fit.nearest, fit.farthest))


def _shape(way: tuple[float, float] | None) -> Floats | None:
    """Return a way as (slope, curvature) 5 m ahead, None where it bends much more than any boundary voted for."""
    if way is None or abs(way[1]) > 1.5 * CURVATURES[-1]:
        return None
    return np.array([way[0] + way[1] * X_FROM, way[1]])


def _curve(boundary: Boundary | None) -> Floats | None:
    if boundary is None:
        return None
    return np.array([float(boundary.y(X_FROM)), boundary.slope + boundary.curvature * X_FROM, boundary.curvature])
