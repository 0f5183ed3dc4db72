"""A learned lane detector: a small network finds both boundaries in each row of the image.

The network (`lane_network.onnx`, run by cv2.dnn) receives the picture at 256 x 128. For each side and each second row
it returns a distribution over 128 columns and the case that the boundary is not there; its width is the row's
uncertainty. It also returns whether either side is painted, the tilt of the camera and the width of the lane. The lane
through the rows and the tilt are determined together (`lane_rows`), along the planned route if it is known. The
confidence is calibrated like that of the classical detector, on properties of the rows and of the paint along the lane
(`stripe`), because a network also takes a boundary for painted where boundaries usually are.

It was trained for the default camera by `tools/train_lane_network.py`, `tools/fit_lane_head.py` and
`tools/fit_confidence.py`; the picture of another camera is rectified to that camera. docs/perception-learned.md
has its results.
"""

from __future__ import annotations

import math
from functools import lru_cache
from importlib import resources
from typing import ClassVar

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.perception.birds_eye import bright_of
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import (
    MIDDLE,
    Confidence,
    Evidence,
    continued,
    in_order,
    junction_ahead,
    load_confidence,
    longest_gap,
    noise_of,
    running_means,
)
from scenario_compiler.perception.course import WIDTH_AT, Course
from scenario_compiler.perception.lane_detector import (
    KNOWN_SPREAD,
    USUAL_SPREAD,
    Boundary,
    LaneResult,
    LaneState,
    grade_of,
)
from scenario_compiler.perception.lane_rows import (
    LOOKED_AT,
    NEAR,
    ROWS,
    TRAINED_FOR,
    Expected,
    Line,
    Rows,
    lane_through,
)
from scenario_compiler.perception.road_plane import Tilt
from scenario_compiler.perception.stripe import AHEAD, BEYOND, FARTHER, JUDGED, NEARER, Stripe, stripe_along

Image = NDArray[np.uint8]
Floats = NDArray[np.float64]

WIDTH, HEIGHT = 256, 128
"""Size of the network's input picture."""

NETWORK_FILE = "lane_network.onnx"

TILT_DEVIATION, GIVEN_DEVIATION = math.radians(0.4), 1e-5
"""Standard deviations of the tilt that the network returns for one image, and of one that is given, rad."""

LEARNED_FEATURES = (
    *("painted", "present", "certain", "spread", "alone", "on_line", "residual"),
    *("astray_near", "astray_far", "certain_far", "reach", "in_view", "uncertain"),
    *("curvature", "offset", "tilt", "tilt_deviation", "width_off"),
    *("other_painted", "other_present", "other_certain", "other_on_line", "apart_slope", "apart_curvature"),
    *("noise", "remembered", "moved", "way"),
    *("lever", "deviation_tilt", "seen_off", "bend"),
    *("junction", "turn", "place", "heading"),
    *("stripe_near", "stripe_far", "weber_near", "weber_far", "contrast_spread", "contrast", "beside"),
    *("gap", "gap_at", "beyond", "ends", "resumes"),
    *("other_stripe_near", "other_stripe_far", "other_weber_near"),
    *("painted_lately", "certain_lately"),
)
"""Names of the features of its confidence; the last ones are running means of `LASTING`."""

LASTING = ("painted", "certain")
"""Features of which running means are features as well: paint that was there a moment ago is there."""

DIM = 10.0
"""Brightness that darker ground counts as where paint is compared with it, grey levels: there noise would be paint."""


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

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """Return the lane that the camera is in (see `lane_detector.LaneDetector`)."""
        return self.look(image, prior, pitch)[0]

    def look(
        self, image: Image, prior: LaneState | None = None, pitch: float | None = None
    ) -> tuple[LaneResult, tuple[Floats, Floats]]:
        """Return the result of `detect`, and the features of the confidence in the left and the right side."""
        state = prior if prior is not None else LaneState()
        way, grade = state.way, grade_of(state.way)
        told, painted, seen_pitch, seen_width = self.tell(image)
        rows = Rows.of(told[0]), Rows.of(told[1])
        seen = Tilt(seen_pitch - grade, TILT_DEVIATION)
        width = state.expected_width
        lines, tilt = lane_through(
            rows,
            Expected(
                state.tilt.with_seen(seen) if pitch is None else Tilt(pitch - grade, GIVEN_DEVIATION),
                *((seen_width, USUAL_SPREAD) if width is None else (width, KNOWN_SPREAD)),
                (_beside(state.left, way), _beside(state.right, way)),
                way,
                self._scale,
            ),
        )
        bright = bright_of(image)
        stripes = [stripe_along(bright, self.camera, line.at(AHEAD), tilt.pitch, way) for line in lines]
        sides = [_Side(*one) for one in zip(rows, painted.tolist(), lines, stripes, strict=True)]
        sigma_hat = noise_of(image)
        health = noise_health(sigma_hat)
        features = [
            _features(side, other, tilt, seen.pitch, seen_width, sigma_hat, state, number)
            for side, other, number in ((sides[0], sides[1], 0), (sides[1], sides[0], 1))
        ]
        left, right = (
            _boundary(side, way, *p)
            for side, p in zip(sides, self.confidence(np.stack(features)).tolist(), strict=True)
        )
        both = features[0], features[1]
        result = LaneResult(
            left, right, health, sigma_hat, left.p * health, right.p * health,
            lane_width=float(lines[0].at(WIDTH_AT) - lines[1].at(WIDTH_AT)),
            tilt=tilt.less(-grade) if pitch is None else Tilt(pitch, 0.0),
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


class _Side:
    """What the network says of one side, its boundary, and what the picture shows along that."""

    def __init__(self, rows: Rows, painted: float, line: Line, stripe: Stripe) -> None:
        there, near, off, seen = rows.there, line.judged, np.abs(line.off), rows.seen_at(line.s)
        self.painted, self.line = painted, line
        far = near & (line.s > MIDDLE)
        self.present = _mean(there, near)
        self.certain, self.certain_far = (_mean(np.log(line.deviation), part) for part in (near, far))
        self.spread = _mean(np.log(rows.spread + 0.1), near)
        self.alone = _mean(rows.alone, near)
        self.on_line = _mean(there * (off < NEAR), near)
        self.astray_near, self.astray_far = (_mean(line.off, there * part) for part in (near & ~far, far))
        self.residual = float(np.sqrt(np.mean((off / line.deviation)[seen] ** 2))) if seen.any() else 3.0
        self.of_paint = _of_paint(stripe)
        self.reach = (float(line.s[seen].min()), float(line.s[seen].max())) if seen.any() else (LOOKED_AT[1],) * 2


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
    sign, way, line = 1.0 - 2.0 * number, state.way, side.line
    (y0, slope, curvature), others = line.curve.tolist(), other.line.curve.tolist()
    trusted = (state.left, state.right)[number]
    before = None if trusted is None else trusted.at(MIDDLE, way)
    moved = 0.0 if before is None else abs(float(line.at(MIDDLE) - before))
    numbers = {
        "painted": _logit(side.painted),
        "present": side.present,
        "certain": side.certain,
        "spread": side.spread,
        "alone": side.alone,
        "on_line": side.on_line,
        "residual": min(side.residual, 3.0),
        "astray_near": _within(sign * side.astray_near),
        "astray_far": _within(sign * side.astray_far),
        "certain_far": side.certain_far,
        "reach": side.reach[1] / 10.0,
        "in_view": line.in_view,
        "uncertain": math.log(line.uncertain / 0.1 + 0.1),
        "curvature": 40.0 * abs(curvature),
        "offset": min(abs(abs(y0) - 1.75), 1.5),
        "tilt": 20.0 * abs(tilt.pitch),
        "tilt_deviation": 60.0 * tilt.deviation,
        "width_off": min(abs(abs(y0 - others[0]) - width), 1.0),
        "other_painted": _logit(other.painted),
        "other_present": other.present,
        "other_certain": other.certain,
        "other_on_line": other.on_line,
        "apart_slope": min(100.0 * abs(slope - others[1]), 2.0),
        "apart_curvature": min(200.0 * abs(curvature - others[2]), 2.0),
        "noise": math.log(sigma + 1.0),
        "remembered": float(trusted is not None),
        "moved": min(4.0 * moved, 2.0),
        "way": float(way is not None),
        "lever": line.lever / 20.0,
        "deviation_tilt": math.log(line.lever * tilt.deviation / 0.1 + 0.1),
        "seen_off": min(line.lever * abs(seen_pitch - tilt.pitch), 1.5),
        "bend": 0.0 if way is None else 2.0 * sign * way.turn,
        "junction": junction_ahead(way),
        "turn": 40.0 * sign * curvature,
        "place": min(max(sign * y0 - 1.75, -1.5), 1.5),
        "heading": 10.0 * sign * slope,
        **side.of_paint,
        **{"other_" + name: other.of_paint[name] for name in ("stripe_near", "stripe_far", "weber_near")},
    }
    # What lies outside the image is no evidence against what was seen.
    newest = state.newest * line.in_view
    means = running_means(LASTING, numbers, state.lately(LASTING, number), newest)
    return in_order(LEARNED_FEATURES, numbers | means)


def _of_paint(stripe: Stripe) -> dict[str, float]:
    """Return the features of what a picture shows along a line."""
    shown, contrast = stripe.shown, stripe.contrast[JUDGED]
    weber = stripe.contrast / np.maximum(stripe.beside, DIM)
    marked = contrast[shown[JUDGED]]
    nearer, farther = (
        (float(shown[part].mean()), math.log1p(10.0 * _strongest(weber[part], 12))) for part in (NEARER, FARTHER)
    )
    return {
        "stripe_near": nearer[0],
        "stripe_far": farther[0],
        "weber_near": nearer[1],
        "weber_far": farther[1],
        "contrast_spread": float(np.log(np.maximum(marked, 1.0)).std()) if len(marked) > 3 else 0.0,
        "contrast": math.log1p(0.1 * _strongest(contrast, 20)),
        "beside": math.log(max(float(stripe.beside[JUDGED].mean()), 1.0)),
        **longest_gap(shown[JUDGED]),
        **continued(shown[JUDGED], shown[BEYOND]),
    }


def _strongest(numbers: Floats, count: int) -> float:
    """Return the mean of the largest numbers."""
    return float(np.sort(numbers)[-count:].mean())


def _beside(boundary: Boundary | None, way: Course | None) -> float | None:
    """Return where a boundary is beside the camera along the route that is known now, m to the left."""
    beside = None if boundary is None else boundary.at(np.zeros(1), way)
    return None if beside is None else float(beside[0])


def _boundary(side: _Side, way: Course | None, p_geom: float, p_paint: float, p: float) -> Boundary:
    y0, slope, curvature = side.line.curve.tolist()
    return Boundary(y0, slope, curvature, p_geom, p_paint, p, side.reach, way, side.line.in_view)


def _mean(numbers: Floats, weight: Floats | NDArray[np.bool_]) -> float:
    """Return the weighted mean, 0 without a weight."""
    return float(numbers @ weight) / max(float(weight.sum()), 1e-9)


def _within(metres: float) -> float:
    return min(max(metres, -1.5), 1.5)


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
