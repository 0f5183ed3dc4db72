"""The confidence in a detected boundary: calibrated probabilities, and separately the sensor's health.

The probabilities are those that the geometry is right, that paint is there, and of both (see `lane_detector.Boundary`).
They are functions of `features`: sums of decision trees that `calibration.fit` fits to rendered clips of maps and of
artificial roads. `scenario-compiler calibrate` measures their reliability and writes
docs/perception.md.

The health falls with the noise that is measured in the image, as defined in `engine.camera_health`. This is policy, not
measurement, because the geometry stays right under far more noise. Other faults of a camera are detected by
`sensor_health`. sigma_hat is Immerkaer's estimate (Computer Vision and Image Understanding 64, 1996) with a median
instead of the mean, so that edges, paint and rain do not count.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.birds_eye import X_FROM, X_STEP, Ridges
from scenario_compiler.perception.course import Course, moved_aside
from scenario_compiler.perception.lane_fit import STANDS_OUT, Fit, arc_y
from scenario_compiler.perception.road_plane import Tilt

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

TOGETHER = 256
"""Number of sides whose probabilities are computed together, which keeps the memory small and fast."""

FEATURES = (
    *("prominence", "painted", "residual", "contrast", "support", "row_scale", "width_off", "along", "stretch"),
    *("contrast_along", "green", "blind", "reach", "curvature", "offset", "slope_deviation", "near", "far"),
    *("inner_rival", "outer_rival", "tilt", "tilt_deviation", "moved", "remembered", "way"),
    *("bend", "in_view", "other_in_view"),
    *("other_prominence", "other_along", "other_slope_deviation", "other_far", "apart_slope", "apart_curvature"),
    *("weber", "weber_spread", "uneven", "beside", "ground", "gap", "gap_at", "deviation_near", "deviation_far"),
    *("lever", "deviation_tilt", "deviation", "turn", "place", "heading", "last_moved", "last_far", "unsettled"),
    *("seen_off", "seen_deviation", "width", "wide", "noise", "stray", "scatter"),
    *("junction", "beyond", "ends", "resumes"),
    *("other_weber", "other_painted", "other_near"),
    *("prominence_lately", "painted_lately", "along_lately", "stretch_lately", "contrast_along_lately"),
    *("near_lately", "far_lately", "weber_lately"),
)
"""Names of the features in the order of the confidence's weights."""

_HALVES = slice(round(1.0 / X_STEP), round(7.0 / X_STEP)), slice(round(7.0 / X_STEP), round(13.0 / X_STEP))
"""Rows from 6 to 12 m and from 12 to 18 m ahead of the camera."""

_JUDGED = slice(_HALVES[0].start, _HALVES[1].stop)
"""Rows from 6 to 18 m."""

_BEYOND = slice(_JUDGED.stop, None)
"""Rows from there on: a broken line goes on, and one that ends at a junction does not."""

JUNCTION_WITHIN, WITHOUT_ROUTE = 25.0, -5.0
"""Distance beyond which a junction is as good as none, and the number that stands for an unknown distance, m."""

PLACES, MIDDLE = np.array([6.0, 9.0, 12.0, 15.0, 18.0]), np.array(12.0)
"""Distances ahead of the camera at which boundaries are compared with where they were, m."""

SHORT = 0.01
"""Step over which a slope is taken, m."""

DARKEST = 4.0
"""Brightness of the ground below which the contrast of paint with it says nothing, grey levels."""

LATELY = "_lately"
"""Ending of the names of running means."""

LASTING = tuple(name.removesuffix(LATELY) for name in FEATURES if name.endswith(LATELY))
"""Features of which running means are features as well: paint that was there a moment ago is there."""

NEWEST = 0.3
"""Least weight of the newest image in them."""

_SECOND = np.array([1, -2, 1], np.float32)
"""The second difference. Taken along and across, it is the difference of two Laplacians that Immerkaer uses."""

_LARGEST, _STRIP = 8 * 255, 64
"""Greatest response to it, and the number of rows that are processed together, which keeps the memory small and fast.
"""


class Tree(NamedTuple):
    """A decision tree, its nodes level by level from the root: the two nodes behind an inner node are neighbours.

    Attributes:
        feature: Number of the feature that each node compares; -1 for a leaf.
        threshold: For each inner node, the number from which on the second of the nodes behind it follows.
        value: For each leaf, what it adds to the logits of the three probabilities.
    """

    feature: Sequence[int]
    threshold: Sequence[float]
    value: Sequence[Sequence[float]]


@dataclass(frozen=True, eq=False)
class Confidence:
    """Three probabilities as functions of the features: logistic functions of the sums of T trees with M nodes.

    Attributes:
        start: (3,) logits before the trees.
        trees: The trees.
        root: (T,) the first node of each tree, all nodes numbered through.
        feature: (M,) the feature that a node compares; 0 for a leaf.
        threshold: (M,) the number from which on the node after `behind` follows; infinite for a leaf.
        behind: (M,) the node that follows for smaller numbers; a leaf itself.
        value: (M, 3) what a leaf adds to the logits; 0 for other nodes.
        depth: Greatest number of comparisons of a tree.
    """

    start: Floats
    trees: tuple[Tree, ...]
    root: Integers
    feature: Integers
    threshold: Floats
    behind: Integers
    value: Floats
    depth: int

    @staticmethod
    def of(start: Sequence[float], trees: Iterable[Tree]) -> Confidence:
        """Return the confidence of trees."""
        kept = tuple(trees)
        sizes = np.array([len(one.feature) for one in kept])
        feature = np.concatenate([np.array(one.feature) for one in kept])
        root, leaf = np.cumsum(sizes) - sizes, feature < 0
        inner: Integers = np.cumsum(~leaf) - ~leaf
        # The k-th inner node of a tree comes before its nodes 2 k + 1 and 2 k + 2.
        first = np.repeat(root, sizes)
        following = first + 2 * (inner - inner[first]) + 1
        place = np.where(leaf, np.arange(len(feature)), following)
        threshold, value = np.full(len(feature), np.inf), np.zeros((len(feature), 3))
        threshold[~leaf] = np.concatenate([np.array(one.threshold, np.float64) for one in kept])
        value[leaf] = np.concatenate([np.array(one.value).reshape(-1, 3) for one in kept])
        depth, level = 0, root[~leaf[root]]
        while len(level):
            behind = np.concatenate([following[level], following[level] + 1])
            depth, level = depth + 1, behind[~leaf[behind]]
        return Confidence(np.array(start), kept, root, np.maximum(feature, 0), threshold, place, value, depth)

    def __call__(self, rows: Floats) -> Floats:
        """Return the probabilities (N, 3) that the geometry is right, that paint is there, and of both.

        Args:
            rows: (N, F) features of N sides.
        """
        total = np.empty((len(rows), 3))
        for begin in range(0, len(rows), TOGETHER):
            some = rows[begin : begin + TOGETHER]
            numbers, place = some.ravel(), some.shape[1] * np.arange(len(some))[:, None]
            node = np.broadcast_to(self.root, (len(some), len(self.root)))
            for _ in range(self.depth):
                node = self.behind[node] + (numbers[place + self.feature[node]] >= self.threshold[node])
            total[begin : begin + TOGETHER] = self.start + self.value[node].sum(axis=1)
        return np.asarray(1.0 / (1.0 + np.exp(-np.clip(total, -30.0, 30.0))))


@lru_cache(maxsize=4)
def load_confidence(file: str, names: tuple[str, ...]) -> Confidence:
    """Return a packaged confidence from its file, which must have the features with these names."""
    data = json.loads(resources.files("scenario_compiler.perception").joinpath(file).read_text("utf-8"))
    if tuple(data["features"]) != names:
        raise RuntimeError(f"{file} was made for other features; fit it again with tools/fit_confidence.py")
    return Confidence.of(data["start"], (Tree(**one) for one in data["trees"]))


def confidence_text(confidence: Confidence, names: tuple[str, ...]) -> str:
    """Return the text of the file for a confidence over the features with these names."""
    data = {
        "features": names,
        "start": confidence.start.tolist(),
        "trees": [one._asdict() for one in confidence.trees],
    }
    return json.dumps(data, indent=None, separators=(",", ":")).replace("},", "},\n") + "\n"


@dataclass(frozen=True)
class Circumstances:
    """Information in addition to an image's ridges and arcs.

    Attributes:
        width: Expected width of the lane, m.
        tilt: The detected tilt, for which the ridges were looked up.
        seen: The tilt according to this image alone.
        unsettled: Change of the tilt that the last look would still have made, rad.
        height: Height of the camera above the ground, m.
        noise: Noise of the image, grey levels.
        way: The planned route, if it was given; rows and arcs are along it then.
    """

    width: float
    tilt: Tilt
    seen: Tilt
    unsettled: float
    height: float
    noise: float
    way: Course | None


@dataclass(frozen=True)
class Before:
    """Results of the previous image for one side.

    Attributes:
        trusted: y at `MIDDLE` if the boundary was trusted, m; None otherwise.
        places: (5,) y at `PLACES`, whether trusted or not, m; None for the first image.
        evidence: (len(LASTING),) running means of some features; None for the first image.
        share: Weight of the next image in them.
    """

    trusted: float | None = None
    places: Floats | None = None
    evidence: Floats | None = None
    share: float = 1.0


def features(
    sides: tuple[Fit, Fit], ridges: Ridges, known: Circumstances, before: tuple[Before, Before]
) -> tuple[Floats, Floats]:
    """Return the features of the left and the right side, (len(FEATURES),), all of the order of 1."""
    (left, right), brightness = sides, math.log(max(float(ridges.ground[_JUDGED].mean()), 1.0))
    scale = math.log(float(ridges.scale.mean()))
    mine = [
        _of_side(fit, other, known, past, sign, (scale, brightness))
        for fit, other, past, sign in ((left, right, before[0], 1.0), (right, left, before[1], -1.0))
    ]
    rows = []
    for fit, own, others, other, past in (
        (left, mine[0], mine[1], right, before[0]),
        (right, mine[1], mine[0], left, before[1]),
    ):
        of_both = {
            **own,
            "other_weber": others["weber"],
            "other_painted": other.painted,
            "other_near": float((other.on_curve[_HALVES[0]] > STANDS_OUT).mean()),
        }
        # What lies outside the image is no evidence against what was seen.
        means = running_means(LASTING, of_both, past.evidence, past.share * fit.in_view)
        rows.append(in_order(FEATURES, {**of_both, **means}))
    return rows[0], rows[1]


def running_means(
    names: tuple[str, ...], numbers: Mapping[str, float], before: Floats | None, share: float
) -> dict[str, float]:
    """Return the running means of features with one more image, by the names that the means have as features.

    Args:
        names: Names of the features.
        numbers: The features of the new image.
        before: (len(names),) means before it; None for the first image.
        share: Weight of the new image.
    """
    now = np.array([numbers[name] for name in names])
    lately = now if before is None else before + share * (now - before)
    return {name + LATELY: float(mean) for name, mean in zip(names, lately, strict=True)}


def in_order(names: tuple[str, ...], numbers: Mapping[str, float]) -> Floats:
    """Return the features (len(names),) in the order of their names.

    Raises:
        RuntimeError: A name has no number, or a number has another name.
    """
    if numbers.keys() != set(names):
        raise RuntimeError(f"features without a number or a name: {sorted(numbers.keys() ^ set(names))}")
    return np.array([numbers[name] for name in names])


@dataclass(frozen=True)
class Evidence:
    """What a detector keeps of both sides for the next image besides the boundaries: running means of features.

    Attributes:
        names: Names of the features, which tell whose memory it is.
        means: (len(names),) of the left and of the right side.
    """

    names: tuple[str, ...]
    means: tuple[tuple[float, ...], tuple[float, ...]]

    @staticmethod
    def of(rows: tuple[Floats, Floats], names: tuple[str, ...]) -> Evidence:
        """Return the evidence from the features of both sides, which end with the running means."""
        left, right = (tuple(row[-len(names) :].tolist()) for row in rows)
        return Evidence(names, (left, right))

    def before(self, names: tuple[str, ...], side: int) -> Floats | None:
        """Return the means of the left side, 0, or the right one, 1; None if another detector keeps others."""
        return np.array(self.means[side]) if self.names == names else None


def _of_side(
    fit: Fit, other: Fit, known: Circumstances, before: Before, sign: float, picture: tuple[float, float]
) -> dict[str, float]:
    """Return the features of one side but those that need the other side's or the memory's."""
    near = slice(0, round(15.0 / X_STEP))
    window = np.ones(4) / 4.0
    bright = np.convolve(fit.contrast[near], window, mode="valid")
    longest = _longest_run(fit.on_curve[near] > 1.2)[0] * X_STEP
    apart = fit.curve - other.curve
    wide = sign * float(apart[0])
    scale, brightness = picture
    y = arc_y(fit.curve, PLACES - X_FROM)
    moved = None if before.trusted is None else float(arc_y(fit.curve, MIDDLE - X_FROM)) - before.trusted
    nearer, farther = (float((fit.on_curve[rows] > STANDS_OUT).mean()) for rows in _HALVES)
    nearby = fit.near_curve > STANDS_OUT
    inner, outer = (0.1 * (fit.support - rival) for rival in fit.rivals)
    return {
        "prominence": math.log(max(fit.prominence, 0.1)),
        "painted": fit.painted,
        "residual": 5.0 * fit.residual,
        "contrast": math.log1p(float(np.sort(fit.contrast[near])[-20:].mean()) / 10.0),
        "support": 0.1 * fit.support,
        "row_scale": scale,
        "width_off": min(max(abs(wide - known.width) - 0.2, 0.0), 1.0),
        "along": _along(fit),
        "stretch": math.log1p(longest),
        "contrast_along": math.log1p(float(np.sort(bright)[-16:].mean()) / 10.0),
        "green": min(max(fit.green, 0.0), 30.0) / 10.0,
        "blind": min(max(fit.nearest - 6.0, 0.0), 12.0) / 4.0,
        "reach": fit.farthest / 10.0,
        "curvature": 40.0 * abs(float(fit.curve[2])),
        "offset": min(max(abs(float(fit.curve[0])) - 1.75, -1.0), 1.5),
        "slope_deviation": _log_deviation(fit),
        "near": nearer,
        "far": farther,
        "inner_rival": inner,
        "outer_rival": outer,
        "tilt": 20.0 * abs(known.tilt.pitch),
        "tilt_deviation": 60.0 * known.tilt.deviation,
        "moved": 0.0 if moved is None else min(4.0 * abs(moved), 2.0),
        "remembered": 0.0 if moved is None else 1.0,
        "way": 0.0 if known.way is None else 1.0,
        "bend": 0.0 if known.way is None else 2.0 * sign * known.way.turn,
        "in_view": fit.in_view,
        "other_in_view": other.in_view,
        "other_prominence": math.log(max(other.prominence, 0.1)),
        "other_along": _along(other),
        "other_slope_deviation": _log_deviation(other),
        "other_far": float((other.on_curve[_HALVES[1]] > STANDS_OUT).mean()),
        "apart_slope": min(20.0 * abs(float(apart[1])), 2.0),
        "apart_curvature": min(100.0 * abs(float(apart[2])), 2.0),
        **_paint(fit, near, brightness),
        **_deviations(fit, known),
        "turn": 40.0 * sign * float(fit.curve[2]),
        "place": min(max(sign * float(arc_y(fit.curve, np.array(-X_FROM))) - 1.75, -1.5), 1.5),
        "heading": 10.0 * sign * float(fit.curve[1]),
        **_moved(y, before),
        "unsettled": min(40.0 * known.unsettled, 3.0),
        "seen_off": min(40.0 * abs(known.seen.pitch - known.tilt.pitch), 3.0),
        "seen_deviation": _in_decimetres(5.0 * min(known.seen.deviation, 1.0)),
        "width": min(abs(wide - 3.5), 2.0),
        "wide": min(max(wide - known.width, -1.5), 1.5),
        "noise": math.log1p(known.noise),
        "stray": fit.stray,
        "scatter": 10.0 * fit.scatter,
        "junction": junction_ahead(known.way),
        **continued(nearby[: _BEYOND.start], nearby[_BEYOND]),
    }


def junction_ahead(way: Course | None) -> float:
    """Return the feature that says how far the next junction is along the route."""
    return 0.1 * (WITHOUT_ROUTE if way is None else min(way.junction, JUNCTION_WITHIN))


def _paint(fit: Fit, near: slice, brightness: float) -> dict[str, float]:
    """Return how what lies on the arc compares with the ground beside it, and the longest gap in it."""
    shown = fit.on_curve > STANDS_OUT
    marked, beside = shown[near], fit.beside
    weber = np.sort((fit.contrast / np.maximum(beside, DARKEST))[near])[-20:]
    spread, uneven = 0.0, 1.0
    if marked.sum() > 3:
        contrast = fit.contrast[near][marked]
        spread = float(np.log(np.maximum(contrast, 1.0)).std())
        uneven = min(float(fit.step[near][marked].mean()) / (float(contrast.mean()) + 1.0), 3.0)
    return {
        "weber": math.log1p(10.0 * float(weber.mean())),
        "weber_spread": spread,
        "uneven": uneven,
        "beside": math.log(max(float(beside[near].mean()), 1.0)),
        "ground": brightness,
        **longest_gap(shown[_JUDGED]),
    }


def longest_gap(shown: NDArray[np.bool_]) -> dict[str, float]:
    """Return the features of the longest gap: its length, and where it ends on the stretch.

    Args:
        shown: (n,) where paint was seen on the stretch on which a boundary has to be right, in steps of `X_STEP`.
    """
    gap, last = _longest_run(~shown)
    return {"gap": 0.25 * gap * X_STEP, "gap_at": last / len(shown)}


def continued(before: NDArray[np.bool_], after: NDArray[np.bool_]) -> dict[str, float]:
    """Return the features of the line beyond the stretch on which it has to be right, and of the gap around its end.

    Args:
        before: (n,) where paint was seen up to the end of that stretch, in steps of `X_STEP`.
        after: (n,) where it was seen from there on.
    """
    before = before[::-1]
    ends, resumes = (int(part.argmax()) if part.any() else len(part) for part in (before, after))
    return {"beyond": float(after.mean()), "ends": 0.1 * X_STEP * ends, "resumes": 0.1 * X_STEP * resumes}


def _deviations(fit: Fit, known: Circumstances) -> dict[str, float]:
    """Return how far the boundary may be off where it has to be right, by its rows and by the tilt."""
    (x, y), (further_x, further_y) = (_ground(fit, s, known.way) for s in (PLACES, PLACES + SHORT))
    dx, dy = further_x - x, further_y - y
    moved = moved_aside(x, y, dx, dy) / np.hypot(dx, dy)
    lever = float(np.nan_to_num(np.abs(moved)).max()) / known.height
    tilted = lever * known.tilt.deviation
    near, far = fit.deviations
    return {
        "deviation_near": _in_decimetres(near),
        "deviation_far": _in_decimetres(far),
        "lever": lever,
        "deviation_tilt": _in_decimetres(tilted),
        "deviation": _in_decimetres(math.hypot(tilted, max(near, far))),
    }


def _ground(fit: Fit, s: Floats, way: Course | None) -> tuple[Floats, Floats]:
    """Return x and y of the boundary at s in the camera's ground frame."""
    t = arc_y(fit.curve, s - X_FROM)
    return (s, t) if way is None else way.points(s, t)


def _moved(y: Floats, before: Before) -> dict[str, float]:
    """Return how far the boundary is from where the image before had it, in the middle and where it is farthest."""
    away = np.zeros(len(PLACES)) if before.places is None else np.abs(y - before.places)
    return {"last_moved": min(4.0 * float(away[2]), 3.0), "last_far": min(2.0 * float(away.max()), 3.0)}


def _in_decimetres(deviation: float) -> float:
    return math.log(min(max(deviation, 0.005), 3.0) / 0.1)


def _along(fit: Fit) -> float:
    """Return the mean strength of the four best metres within 20 m."""
    run = np.convolve(np.minimum(fit.on_curve, 5.0)[: round(15.0 / X_STEP)], np.ones(4) / 4.0, mode="valid")
    return float(np.sort(run)[-16:].mean())


def _log_deviation(fit: Fit) -> float:
    return 0.5 * math.log(min(max(fit.slope_deviation, 1e-3), 1.0) / 0.01)


def noise_of(image: NDArray[np.uint8]) -> float:
    """Return sigma_hat, the noise of a BGR image in grey levels (see the module's docstring)."""
    counts = np.zeros(_LARGEST + 1, np.int64)
    for top in range(0, image.shape[0] - 2, _STRIP):
        part = cv2.extractChannel(image[top : top + _STRIP + 2], 1)
        response = cv2.sepFilter2D(part, cv2.CV_16S, _SECOND, _SECOND)
        counts += np.bincount(np.abs(response[1:-1:2, 1:-1:2]).ravel(), minlength=_LARGEST + 1)
    below = np.cumsum(counts)
    middle = np.searchsorted(below, ((int(below[-1]) - 1) // 2, int(below[-1]) // 2), side="right")
    return float(middle.mean()) / (6.0 * 0.67448975)


def _longest_run(flags: NDArray[np.bool_]) -> tuple[int, int]:
    """Return the length of the longest run of true flags, and where it ends; 0 and 0 without one."""
    longest = current = end = 0
    for place, flag in enumerate(flags.tolist()):
        current = current + 1 if flag else 0
        if current > longest:
            longest, end = current, place
    return longest, end
