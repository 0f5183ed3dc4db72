"""A learned lane detector: a small network finds both boundaries in each row of the image.

The network (`lane_network.onnx`, run by cv2.dnn) receives the picture at 256 x 128. For each side and each second row
it returns a distribution over 128 columns and the case that the boundary is not there; its width is the row's
uncertainty. It also returns whether either side is painted, the tilt of the camera and the width of the lane. The two
sides of a lane usually are parallel, so the tilt is estimated from their rows as well, and the two estimates are
combined (see `road_plane`). Rows are projected to the ground with the tilt, and a parabola is fitted to them, weighted
by their certainty. The confidence is calibrated like that of the classical detector, on properties of the rows.

It was trained for the default camera by `tools/train_lane_network.py`, `tools/fit_lane_head.py` and
`tools/fit_learned_confidence.py`; the picture of another camera is rectified to that camera. docs/perception-learned.md
has its results.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import (
    PLACES,
    Confidence,
    Evidence,
    in_order,
    junction_ahead,
    load_confidence,
    noise_of,
    running_means,
)
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_detector import Boundary, LaneResult, LaneState
from scenario_compiler.perception.road_plane import Tilt, tilt_of_widening

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

WIDTH, HEIGHT = 256, 128
"""Size of the network's input picture."""

ROWS, COLUMNS = 64, 128
"""Rows and columns of its output; each is two pixels of its input."""

NETWORK_FILE = "lane_network.onnx"

TILT_DEVIATION = math.radians(0.3)
"""Standard deviation of the tilt that the network returns for one image, rad."""

PARALLEL = 0.8
"""Prior probability that the two sides belong to one lane and their rows determine the tilt."""

ALIKE_ROWS = 4.0
"""Number of rows that count as one independent one, because neighbouring rows have the same error."""

EVEN = 0.2
"""Least mean square of the rows' residuals in their own deviations; smaller ones are chance, not certainty."""

PEAK = 4
"""Number of columns on either side of a row's most probable one that belong to the same line."""

LOOKED_AT = (5.0, 22.0)
"""Stretch ahead of the camera whose rows are used, m."""

LEAST_ROWS = 5
"""Least number of rows of a boundary."""

LEARNED_FEATURES = (
    *("painted", "present", "certain", "spread", "alone", "residual", "reach", "curvature", "offset"),
    *("tilt", "tilt_deviation", "width_off"),
    *("other_painted", "other_present", "other_certain", "apart_slope", "apart_curvature"),
    *("noise", "remembered", "moved", "way"),
    *("lever", "deviation_tilt", "seen_off", "bend"),
    *("junction", "off_route", "bent_off_route", "turn", "place", "heading"),
    *("painted_lately", "certain_lately"),
)
"""Names of the features of its confidence; the last ones are running means of `LASTING`."""

LASTING = ("painted", "certain")
"""Features of which running means are features as well: paint that was there a moment ago is there."""

TRAINED_FOR = Camera()


class LearnedLaneDetector:
    """The learned detector."""

    features: ClassVar[tuple[str, ...]] = LEARNED_FEATURES
    confidence_file: ClassVar[str] = "learned_confidence.json"

    def __init__(
        self, camera: Camera | None = None, network: bytes | None = None, confidence: Confidence | None = None
    ) -> None:
        """Prepare for one camera, by default with the packaged network and confidence."""
        self.camera = camera if camera is not None else Camera()
        data = network if network is not None else _shipped_network()
        self._net = cv2.dnn.readNetFromONNX(np.frombuffer(data, np.uint8))
        self.confidence = confidence or load_confidence(self.confidence_file, self.features)
        self._turn = None if _alike(self.camera, TRAINED_FOR) else homography_to_trained(self.camera)
        self._scale = self.camera.z / TRAINED_FOR.z
        self._v = (np.arange(ROWS) + 0.5) * TRAINED_FOR.height / ROWS - 0.5

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """Return the lane that the camera is in (see `lane_detector.LaneDetector`)."""
        return self.look(image, prior, pitch)[0]

    def look(
        self, image: Image, prior: LaneState | None = None, pitch: float | None = None
    ) -> tuple[LaneResult, tuple[Floats, Floats]]:
        """Return the result of `detect`, and the features of the confidence in the left and the right side."""
        state = prior if prior is not None else LaneState()
        rows, painted, seen_pitch, width = self.tell(image)
        told = Rows.of(rows[0]), Rows.of(rows[1])
        if pitch is not None:
            tilt = Tilt(pitch, 0.0)
        else:
            tilt = state.tilt.with_seen(Tilt(seen_pitch, TILT_DEVIATION))
            tilt = tilt.with_seen(tilt_between(*told, self._v, tilt.pitch), PARALLEL)
        sides = [_Side(one, paint, self._v, tilt.pitch, self._scale) for one, paint in zip(told, painted, strict=True)]
        sigma_hat = noise_of(image)
        health = noise_health(sigma_hat)
        features = [
            _features(side, other, tilt, seen_pitch, width, sigma_hat, state, number)
            for side, other, number in ((sides[0], sides[1], 0), (sides[1], sides[0], 1))
        ]
        left, right = (
            _boundary(side, *p) for side, p in zip(sides, self.confidence(np.stack(features)).tolist(), strict=True)
        )
        lane_width = float(left.y(10.0) - right.y(10.0))
        both = features[0], features[1]
        result = LaneResult(
            left, right, health, sigma_hat, left.p * health, right.p * health, lane_width, tilt,
            evidence=Evidence.of(both, LASTING),
        )  # fmt: skip
        return result, both

    def tell(self, image: Image) -> tuple[Floats, Floats, float, float]:
        """Return the network's output for an image.

        Returns:
            (2, ROWS, COLUMNS + 1) probabilities that a boundary lies in a column, the last that it is not there; (2,)
            probabilities that the sides are painted; the tilt, rad; the lane's width, m.
        """
        if self._turn is not None:
            size = (TRAINED_FOR.width, TRAINED_FOR.height)
            image = np.asarray(cv2.warpPerspective(image, self._turn, size), np.uint8)
        small = cv2.resize(image, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
        blob = small.transpose(2, 0, 1)[None].astype(np.float32) / np.float32(255.0) - np.float32(0.5)
        self._net.setInput(np.ascontiguousarray(blob))
        maps, rest = (np.asarray(one, np.float64) for one in self._net.forward(["rows", "rest"]))
        logits = np.concatenate([maps[0], np.zeros((2, ROWS, 1))], axis=2)
        exponents = np.exp(logits - logits.max(axis=2, keepdims=True))
        rows = exponents / exponents.sum(axis=2, keepdims=True)
        numbers = rest.ravel()
        painted = 1.0 / (1.0 + np.exp(-numbers[:2]))
        return rows, painted, 0.03 * float(numbers[2]), (3.5 + float(numbers[3])) * self._scale


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows of one side, (ROWS,) each.

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
        """Return the rows for (ROWS, COLUMNS + 1) probabilities."""
        place = np.arange(COLUMNS)
        there = 1.0 - rows[:, -1]
        share = rows[:, :-1] / np.maximum(there, 1e-6)[:, None]
        middle = share @ place
        spread = np.sqrt(np.maximum(share @ (place * place) - middle * middle, 0.0))
        peak = share * (np.abs(place - share.argmax(axis=1)[:, None]) <= PEAK)
        alone = peak.sum(axis=1)
        return Rows(there, peak @ place / np.maximum(alone, 1e-9), spread, alone)

    def ground(self, v: Floats, pitch: float) -> tuple[Floats, Floats, Floats]:
        """Return the positions of the rows on the ground, x and y, and the deviation of y, m, at the trained height."""
        x, y = ground_of((self.column + 0.5) * TRAINED_FOR.width / COLUMNS - 0.5, v, pitch)
        return x, y, np.hypot((self.spread + 0.3) * x * TRAINED_FOR.width / COLUMNS / TRAINED_FOR.focal, 0.02)


def tilt_between(left: Rows, right: Rows, v: Floats, pitch: float) -> Tilt:
    """Return the tilt at which both sides are parallel, as `road_plane.tilt_beyond` does for two fits.

    Args:
        left: The left side's rows.
        right: The right side's rows.
        v: (ROWS,) positions of the rows in the image.
        pitch: Assumed tilt, rad; the result is linear about it.

    Returns:
        The tilt, rad, with an infinite deviation if the sides have too few rows in common or are less than 1 m apart.
    """
    (x, y_left, off_left), (_, y_right, off_right) = left.ground(v, pitch), right.ground(v, pitch)
    kept = (left.there > 0.5) & (right.there > 0.5) & (x > LOOKED_AT[0]) & (x < LOOKED_AT[1])
    if kept.sum() <= LEAST_ROWS:
        return Tilt(0.0, math.inf)
    x, weight = x[kept], 1.0 / np.hypot(off_left[kept], off_right[kept])
    half, slope, _ = np.polyfit(x, 0.5 * (y_left + y_right)[kept], 2, w=weight)
    apart = (y_left - y_right)[kept] / np.hypot(1.0, 2.0 * half * x + slope)
    share = weight * weight / float(weight @ weight)
    middle = float(share @ x)
    reach = float(share @ (x - middle) ** 2)
    widens = float(share @ ((x - middle) * apart)) / reach
    width = float(share @ apart) - widens * middle
    uneven = max(float(np.mean((weight * (apart - width - widens * x)) ** 2)), EVEN)
    variance = ALIKE_ROWS * uneven / (float(weight @ weight) * reach)
    beyond = tilt_of_widening(widens, width, 2.0 * float(half), variance, TRAINED_FOR.z)
    return Tilt(pitch + beyond.pitch, beyond.deviation)


class _Side:
    """One side's boundary from its rows.

    An error of the tilt moves it by `lever` metres per radian, where it moves most between 6 and 18 m ahead: at x by
    p x (x dy/dx - y) / h for a small tilt p (see `road_plane`). The outer side of a bend moves the most.
    """

    def __init__(self, rows: Rows, painted: float, v: Floats, pitch: float, scale: float) -> None:
        self.painted = painted
        there, spread = rows.there, rows.spread
        x, y, deviation = (one * scale for one in rows.ground(v, pitch))
        kept = (there > 0.5) & (x > LOOKED_AT[0]) & (x < LOOKED_AT[1])
        near = (x > 6.0) & (x < 18.0)
        self.present = float(there[near].mean()) if near.any() else 0.0
        self.certain = float(np.log(deviation[near]).mean()) if near.any() else 0.0
        self.spread = float(np.log(spread[near] + 0.1).mean()) if near.any() else 0.0
        self.alone = float(rows.alone[near].mean()) if near.any() else 0.0
        self.reach = (float(x[kept].min()), float(x[kept].max())) if kept.any() else (LOOKED_AT[1], LOOKED_AT[1])
        self.curve, self.residual = (0.0, 0.0, 0.0), 1.0
        if kept.sum() >= LEAST_ROWS:
            weight = there[kept] / deviation[kept]
            shape = np.vander(x[kept], 3) * weight[:, None]
            held = np.diag([20.0, 2.0, 0.1])
            system = np.concatenate([shape, held])
            values = np.concatenate([y[kept] * weight, np.zeros(3)])
            curve = np.linalg.lstsq(system, values, rcond=None)[0]
            off = (np.vander(x[kept], 3) @ curve - y[kept]) * weight
            self.residual = float(np.sqrt((off * off).mean()))
            self.curve = (float(curve[0]), float(curve[1]), float(curve[2]))
        height = scale * TRAINED_FOR.z
        half, _, y0 = self.curve
        self.lever = float(np.abs(PLACES * (half * PLACES * PLACES - y0)).max()) / height


def ground_of(u: Floats, v: Floats, pitch: float) -> tuple[Floats, Floats]:
    """Return where pixels of the trained camera see the ground, m; x is infinite above the horizon."""
    camera = TRAINED_FOR
    tilted = camera.pitch + pitch
    down = (v - camera.height / 2.0) / camera.focal
    right = (u - camera.width / 2.0) / camera.focal
    ahead, fall = math.cos(tilted) + down * math.sin(tilted), down * math.cos(tilted) - math.sin(tilted)
    far = np.where(fall > 1e-3, camera.z / np.maximum(fall, 1e-3), np.inf)
    return ahead * far, -right * np.where(np.isfinite(far), far, 0.0)


def _features(
    side: _Side,
    other: _Side,
    tilt: Tilt,
    seen_pitch: float,
    width: float,
    sigma: float,
    state: LaneState,
    number: int,
) -> Floats:
    """Return the features of the left side, whose number is 0, or of the right one, 1."""
    sign, way = 1.0 - 2.0 * number, state.way
    trusted = (state.left, state.right)[number]
    x = np.array([12.0])
    off = abs(abs(side.curve[2] - other.curve[2]) - width)
    moved = 0.0
    if trusted is not None:
        moved = abs(float((np.vander(x, 3) @ np.array(side.curve))[0] - trusted.y(x)[0]))
    numbers = {
        "painted": _logit(side.painted),
        "present": side.present,
        "certain": side.certain,
        "spread": side.spread,
        "alone": side.alone,
        "residual": min(side.residual, 3.0),
        "reach": side.reach[1] / 10.0,
        "curvature": 80.0 * abs(side.curve[0]),
        "offset": min(abs(abs(side.curve[2]) - 1.75), 1.5),
        "tilt": 20.0 * abs(tilt.pitch),
        "tilt_deviation": 60.0 * tilt.deviation,
        "width_off": min(off, 1.0),
        "other_painted": _logit(other.painted),
        "other_present": other.present,
        "other_certain": other.certain,
        "apart_slope": min(20.0 * abs(side.curve[1] - other.curve[1]), 2.0),
        "apart_curvature": min(100.0 * abs(side.curve[0] - other.curve[0]), 2.0),
        "noise": math.log(sigma + 1.0),
        "remembered": float(trusted is not None),
        "moved": min(4.0 * moved, 2.0),
        "way": float(way is not None),
        "lever": side.lever / 20.0,
        "deviation_tilt": math.log(side.lever * tilt.deviation / 0.1 + 0.1),
        "seen_off": min(side.lever * abs(seen_pitch - tilt.pitch), 1.5),
        "bend": 0.0 if way is None else 2.0 * sign * way.turn,
        "junction": junction_ahead(way),
        **_off_route(side, way, sign),
        "turn": 80.0 * sign * side.curve[0],
        "place": min(max(sign * side.curve[2] - 1.75, -1.5), 1.5),
        "heading": 10.0 * sign * side.curve[1],
    }
    means = running_means(LASTING, numbers, state.lately(LASTING, number), state.newest)
    return in_order(LEARNED_FEATURES, numbers | means)


def _off_route(side: _Side, way: Course | None, sign: float) -> dict[str, float]:
    """Return by how much the boundary turns from the route on the judged stretch, and by how much more at its end."""
    if way is None:
        return {"off_route": 0.0, "bent_off_route": 0.0}
    half, slope, _ = side.curve
    ahead = PLACES[[0, -1]]
    begin, end = (sign * (np.arctan(2.0 * half * ahead + slope) - way.heading_at(ahead))).tolist()
    return {"off_route": _within(5.0 * (begin + end)), "bent_off_route": _within(10.0 * (end - begin))}


def _boundary(side: _Side, p_geom: float, p_paint: float, p: float) -> Boundary:
    curvature, slope, y0 = side.curve
    return Boundary(y0, slope, 2.0 * curvature, p_geom, p_paint, p, side.reach)


def _within(number: float) -> float:
    return min(max(number, -5.0), 5.0)


def _logit(p: float) -> float:
    kept = min(max(p, 1e-4), 1.0 - 1e-4)
    return 0.3 * math.log(kept / (1.0 - kept))


def _alike(camera: Camera, other: Camera) -> bool:
    names = ("width", "height", "fov", "yaw", "pitch", "roll")
    return all(getattr(camera, name) == getattr(other, name) for name in names)


def homography_to_trained(camera: Camera) -> Floats:
    """Return the matrix from pixels of a camera to those of the trained camera."""
    inner = [
        np.array([[one.focal, 0.0, one.width / 2.0], [0.0, one.focal, one.height / 2.0], [0.0, 0.0, 1.0]])
        for one in (TRAINED_FOR, camera)
    ]
    return np.asarray(inner[0] @ TRAINED_FOR.rotation @ camera.rotation.T @ np.linalg.inv(inner[1]))


@lru_cache(maxsize=1)
def _shipped_network() -> bytes:
    return resources.files("scenario_compiler.perception").joinpath(NETWORK_FILE).read_bytes()
