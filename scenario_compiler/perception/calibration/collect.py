"""Runs a detector on clips and situations, and keeps its output together with the truth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.bank import BANK, Situation, drawn_situation, picture, pictures
from scenario_compiler.perception.calibration.maps import Conditions, MapRoads
from scenario_compiler.perception.calibration.truth import Truth
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.lane_detector import CalibratedDetector, LaneResult, LaneState
from scenario_compiler.perception.planned_way import LEAST_SHARE, worth_on_way
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.weather_look import look_of

Floats = NDArray[np.float64]

CONDITIONS = ("contrast", "sigma", "pitch", "leader", "beside", "curvature", "junction", "number")
"""Columns of `Looks.conditions`: the contrast of paint that the weather leaves, noise in grey levels, the body's pitch
in rad, the distance to the leader in m, whether a truck is beside, the path's curvature in 1/m, whether a junction is
near, and the image's index in its clip.
"""

RIGHT = 0.25
"""Largest distance of a boundary that counts as right from the true one, m."""


@dataclass(frozen=True, eq=False)
class Looks:
    """Observations of sides of lanes. N of them.

    Attributes:
        rows: (N, features) the features of the confidence.
        p: (N, 3) probabilities, as the automation uses them, that the geometry is right, that paint is there, and of
            both.
        error: (N,) largest distance from the true boundary, m.
        painted: (N,) painted share of the stretch.
        worth: (N,) factor by which the automation lowers the probabilities of a boundary that leaves the planned route.
        clip: (N,) number of the clip; observations of one clip are never separated.
        conditions: (N, len(CONDITIONS)).
    """

    rows: Floats
    p: Floats
    error: Floats
    painted: Floats
    worth: Floats
    clip: NDArray[np.int64]
    conditions: Floats

    @staticmethod
    def joined(parts: Sequence[Looks]) -> Looks:
        """Return the observations of all parts."""
        return Looks(*(np.concatenate([getattr(part, one.name) for part in parts]) for one in fields(Looks)))

    def only(self, chosen: NDArray[np.bool_]) -> Looks:
        """Return the chosen observations."""
        return Looks(*(getattr(self, one.name)[chosen] for one in fields(Looks)))

    @property
    def labels(self) -> Floats:
        """(N, 3) whether the geometry was right, paint was there, and both, as 0 or 1."""
        right, there = self.error < RIGHT, self.painted > LEAST_SHARE
        return np.stack([right, there, right & there], axis=1).astype(np.float64)

    def condition(self, name: str) -> Floats:
        """Return one of the conditions, (N,)."""
        return np.asarray(self.conditions[:, CONDITIONS.index(name)])


class Taker:
    """Records the output of a detector."""

    def __init__(self, detector: CalibratedDetector) -> None:
        """Begin without observations."""
        self.detector = detector
        self.rows: list[Floats] = []
        self.rest: list[tuple[float, ...]] = []

    def look(
        self,
        image: NDArray[np.uint8],
        state: LaneState,
        truth: Truth,
        clip: int,
        about: tuple[float, ...],
        way: Sequence[WayPoint] = (),
        junction: float = math.inf,
    ) -> LaneResult:
        """Run the detector on one image, with the planned route in the camera's ground frame (see `Course.along`)."""
        result, rows = self.detector.look(image, replace(state, way=Course.along(way, junction)))
        for side, (row, found) in enumerate(zip(rows, (result.left, result.right), strict=True)):
            self.rows.append(row)
            said = (found.p_geom, found.p_paint, found.p)
            seen = (truth.error(side, found), truth.painted[side], worth_on_way(found, way))
            self.rest.append((*said, *seen, float(clip), *about))
        return result

    @property
    def looks(self) -> Looks:
        """Return the recorded observations."""
        rest = np.array(self.rest).reshape(-1, 7 + len(CONDITIONS))
        rows = np.array(self.rows).reshape(len(rest), len(self.detector.features))
        error, painted, worth = rest[:, 3], rest[:, 4], rest[:, 5]
        p = as_used(rest[:, :3], worth)
        return Looks(rows, p, error, painted, worth, rest[:, 6].astype(np.int64), rest[:, 7:])


def as_used(p: Floats, worth: Floats) -> Floats:
    """Return a detector's probabilities (N, 3) as the automation uses them (see `planned_way.on_way`)."""
    return p * np.stack([worth, np.ones_like(worth), worth], axis=1)


def look_at_map(roads: MapRoads, detector: CalibratedDetector, seed: int, numbers: range) -> Looks:
    """Return the observations of clips with the given numbers, whose images are seen in order with memory."""
    taker = Taker(detector)
    for clip, conditions, views in roads.clips(seed, numbers):
        state = LaneState()
        for view in views:
            about = (*numbers_of(conditions), float(view.number))
            state = state.after(taker.look(view.image, state, view.truth, clip, about, view.way, view.junction))
    return taker.looks


def look_at_bank(detector: CalibratedDetector, situation: int, seed: int, count: int) -> Looks:
    """Return the observations of `count` pictures of one situation of the bank, without memory."""
    taker = Taker(detector)
    for number, (image, truth) in enumerate(pictures(BANK[situation], seed, count)):
        taker.look(image, LaneState(), truth, number, _of_situation(BANK[situation]))
    return taker.looks


def look_at_drawn(detector: CalibratedDetector, seed: int, numbers: range) -> Looks:
    """Return the observations of pictures of random situations, without memory."""
    taker = Taker(detector)
    for number in numbers:
        draw = np.random.default_rng([seed, number])
        situation = drawn_situation(draw)
        image, truth = picture(situation, draw)
        taker.look(image, LaneState(), truth, number, _of_situation(situation))
    return taker.looks


def numbers_of(conditions: Conditions) -> tuple[float, ...]:
    """Return the conditions of a clip in the order of `CONDITIONS`, without the image's index."""
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
