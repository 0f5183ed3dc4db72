"""Lets a detector look at clips and situations, and keeps what it says beside what is true."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.bank import BANK, Situation, drawn_situation, picture, pictures
from scenario_compiler.perception.calibration.maps import Conditions, MapRoads
from scenario_compiler.perception.calibration.truth import SEEN_SHARE, Truth
from scenario_compiler.perception.lane_detector import CalibratedDetector, LaneResult, LaneState
from scenario_compiler.perception.weather_look import look_of

Floats = NDArray[np.float64]

CONDITIONS = ("contrast", "sigma", "pitch", "leader", "beside", "curvature", "junction", "number")
"""Columns of `Looks.conditions`: the contrast that the weather leaves of paint, noise in grey levels, the body's pitch
in rad, the distance to the leader in m, whether a truck is beside, the way's curvature in 1/m, whether a junction
is near, and the image's place in its clip."""

RIGHT = 0.25
"""Largest lateral error of a boundary that is right, m."""


@dataclass(frozen=True, eq=False)
class Looks:
    """Sides of lanes that were looked at. N of them.

    Attributes:
        rows: (N, features) what the confidence was made from.
        p: (N, 3) what the detector said: that the geometry is right, that paint is there, and of both.
        error: (N,) largest lateral error, m.
        painted: (N,) share of the stretch on which paint is there.
        clip: (N,) number of the clip; looks of one clip are never parted.
        conditions: (N, len(CONDITIONS)).
    """

    rows: Floats
    p: Floats
    error: Floats
    painted: Floats
    clip: NDArray[np.int64]
    conditions: Floats

    @staticmethod
    def joined(parts: Sequence[Looks]) -> Looks:
        """Return all looks of several."""
        return Looks(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Looks)))

    def only(self, chosen: NDArray[np.bool_]) -> Looks:
        """Return some of the looks."""
        return Looks(*(getattr(self, one.name)[chosen] for one in fields(Looks)))

    @property
    def labels(self) -> Floats:
        """(N, 3) whether the geometry was right, paint was there, and both, 0 or 1."""
        right, there = self.error < RIGHT, self.painted > SEEN_SHARE
        return np.stack([right, there, right & there], axis=1).astype(np.float64)

    def condition(self, name: str) -> Floats:
        """Return one of the conditions, (N,)."""
        return np.asarray(self.conditions[:, CONDITIONS.index(name)])


class _Taker:
    """Takes down what a detector says."""

    def __init__(self, detector: CalibratedDetector) -> None:
        self.detector = detector
        self.rows: list[Floats] = []
        self.rest: list[tuple[float, ...]] = []

    def look(
        self, image: NDArray[np.uint8], state: LaneState, truth: Truth, clip: int, about: tuple[float, ...]
    ) -> LaneResult:
        """Let the detector look at one image."""
        result, rows = self.detector.look(image, state)
        for side, (row, found) in enumerate(zip(rows, (result.left, result.right), strict=True)):
            self.rows.append(row)
            said = (found.p_geom, found.p_paint, found.p)
            self.rest.append((*said, truth.error(side, found), truth.painted[side], float(clip), *about))
        return result

    @property
    def looks(self) -> Looks:
        """What was taken down."""
        rest = np.array(self.rest).reshape(-1, 6 + len(CONDITIONS))
        rows = np.array(self.rows).reshape(len(rest), len(self.detector.features))
        return Looks(rows, rest[:, :3], rest[:, 3], rest[:, 4], rest[:, 5].astype(np.int64), rest[:, 6:])


def look_at_map(roads: MapRoads, detector: CalibratedDetector, seed: int, numbers: range) -> Looks:
    """Return the looks at the clips of some numbers, each seen in order with memory."""
    taker = _Taker(detector)
    for clip, conditions, views in roads.clips(seed, numbers):
        state = LaneState()
        for view in views:
            about = (*_numbers(conditions), float(view.number))
            state = state.after(taker.look(view.image, replace(state, way=view.way), view.truth, clip, about))
    return taker.looks


def look_at_bank(detector: CalibratedDetector, situation: int, seed: int, count: int) -> Looks:
    """Return the looks at `count` pictures, without memory, of one situation of the bank."""
    taker = _Taker(detector)
    for number, (image, truth) in enumerate(pictures(BANK[situation], seed, count)):
        taker.look(image, LaneState(), truth, number, _of_situation(BANK[situation]))
    return taker.looks


def look_at_drawn(detector: CalibratedDetector, seed: int, numbers: range) -> Looks:
    """Return the looks at pictures, without memory, of situations that are drawn."""
    taker = _Taker(detector)
    for number in numbers:
        draw = np.random.default_rng([seed, number])
        situation = drawn_situation(draw)
        image, truth = picture(situation, draw)
        taker.look(image, LaneState(), truth, number, _of_situation(situation))
    return taker.looks


def _numbers(conditions: Conditions) -> tuple[float, ...]:
    return (
        look_of(conditions.weather).contrast,
        conditions.sigma,
        conditions.pitch,
        conditions.leader,
        float(conditions.beside),
        conditions.curvature,
        float(conditions.junction),
    )


def _of_situation(one: Situation) -> tuple[float, ...]:
    curvature = 1.0 / abs(one.radius) if one.radius else 0.0
    contrast = look_of(one.light()).contrast
    return (
        contrast,
        one.sigma,
        np.radians(one.pitch),
        one.leader or np.inf,
        float(one.truck != 0),
        curvature,
        0.0,
        0.0,
    )
