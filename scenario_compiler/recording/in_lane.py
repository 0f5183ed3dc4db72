"""The ego in its lane: distances of its sides from the lane's edges, and the time until it crosses them.

A side is beyond an edge of the lane if a corner of the ego's box is. The formulas are those of
`engine.measures.in_lane`, in the same order and with the C library's functions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from scenario_compiler.engine.measures.in_lane import JUMP
from scenario_compiler.recording.lateral import left_of_centre
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces
from scenario_compiler.vocabulary.horizon import HORIZON


class Sides(NamedTuple):
    """The ego's sides in its lane, each array (..., n); offsets are to the left in its driving direction.

    Attributes:
        left: Offset of its reference point from the lane's centre, m.
        to_left: Distance of its leftmost corner from the reference point, m.
        to_right: Distance of its rightmost corner from the reference point, m.
        width: Width of the lane, m; 0 if there is none.
        on_lane: Whether the reference point is on a lane.
        out: Whether a side is beyond its edge or the reference point is on no lane; false if the ego is absent, and
            after the first collision.
        crossing: Time until a side crosses its edge at the present lateral speed, s; 0 if one has crossed it, infinite
            if none will.
    """

    left: Floats
    to_left: Floats
    to_right: Floats
    width: Floats
    on_lane: Booleans
    out: Booleans
    crossing: Floats


@dataclass
class Departures:
    """The lane departures of a vehicle: each lasts from the first row out of the lane to the last before it is back.

    Attributes:
        count: Their number.
        longest: Rows of the longest.
        deepest: Greatest distance of a side beyond the edge of the lane that was left, m; NaN if that is not known.
    """

    count: int = 0
    longest: int = 0
    deepest: float = math.nan
    _rows: int = 0
    _width: float = 0.0
    _aside: float = 0.0
    _step: float = 0.0
    _left: float = 0.0

    def end(self) -> None:
        """End a departure, because the vehicle is within its lane or absent."""
        self._rows = 0

    def add(self, left: float, to_left: float, to_right: float, width: float, on_lane: bool) -> None:
        """Add a row in which the vehicle is out of its lane; the arguments are elements of `Sides`."""
        change = left - self._left
        if self._rows == 0:
            self.count += 1
            self._width, self._aside, self._step = width, 0.0, 0.0
        elif abs(change) > JUMP:
            self._aside += self._step - change
        else:
            self._step = change
        self._left = left
        self._rows += 1
        self.longest = max(self.longest, self._rows)
        if on_lane and self._width > 0.0:
            at = left + self._aside
            deep = max(at + to_left, to_right - at) - 0.5 * self._width
            self.deepest = deep if math.isnan(self.deepest) else max(self.deepest, deep)


def sides_of(traces: Traces) -> Sides:
    """Return the ego's sides in its lane."""
    length, width, center = float(traces.length[0]), float(traces.width[0]), float(traces.center[0])
    there, left = traces.present[..., 0] & traces.until_collision, left_of_centre(traces)
    turned, along = traces.turned_in_lane
    front, rear = (center + 0.5 * length) * turned, (center - 0.5 * length) * turned
    half = 0.5 * width * np.abs(along)
    to_left, to_right = np.maximum(front, rear) + half, half - np.minimum(front, rear)
    lane = np.where(np.isnan(traces.lane_width), 0.0, traces.lane_width)
    on_lane = (traces.road[..., 0] >= 0) & (traces.lane[..., 0] != 0)
    room_left, room_right = 0.5 * lane - (left + to_left), 0.5 * lane - (to_right - left)
    beyond = (lane > 0.0) & (np.minimum(room_left, room_right) < 0.0)
    out = there & (~on_lane | beyond)
    across = traces.v[..., 0] * turned
    nears = (lane > 0.0) & (across != 0.0) & there
    room = np.where(across > 0.0, room_left, room_right)
    crossing = np.where(nears, room / np.where(nears, np.abs(across), 1.0), np.inf)
    return Sides(left, to_left, to_right, lane, on_lane, out, np.where(out, 0.0, crossing))


def _departures(traces: Traces) -> list[Departures]:
    """Return the departures of each run, with the runs in the order of their indices."""
    sides = sides_of(traces)
    found = []
    for index in np.ndindex(*traces.t.shape[:-1]):
        one = Departures()
        columns = (sides.left, sides.to_left, sides.to_right, sides.width, sides.on_lane)
        out = np.flatnonzero(sides.out[index])
        before = -1
        for row, *numbers in zip(out.tolist(), *(each[index][out].tolist() for each in columns), strict=True):
            if row != before + 1:
                one.end()
            one.add(*numbers)
            before = row
        found.append(one)
    return found


def _of_runs(traces: Traces, found: list[float]) -> Floats:
    """Return one number per run as an array (...)."""
    return np.array(found, dtype=np.float64).reshape(traces.t.shape[:-1])


def lane_departures(traces: Traces) -> Floats:
    """Return the number of lane departures, (...)."""
    return _of_runs(traces, [float(one.count) for one in _departures(traces)])


def first_departure(traces: Traces) -> Floats:
    """Return the time of the first row after the request with the ego out of its lane, s, (...); NaN if none."""
    counts = sides_of(traces).out & traces.between(traces.times["request"])
    return np.asarray(np.fmin.reduce(np.where(counts, traces.t, np.nan), axis=-1, initial=np.nan))


def longest_departure(traces: Traces) -> Floats:
    """Return the duration of the longest lane departure, s, (...); NaN if there is none."""
    longest = _of_runs(traces, [float(one.longest) for one in _departures(traces)])
    return np.where(longest > 0, longest * traces.step, np.nan)


def deepest_departure(traces: Traces) -> Floats:
    """Return the greatest distance of a side beyond the edge of the lane that was left, m, (...); NaN if none was."""
    return _of_runs(traces, [one.deepest for one in _departures(traces)])


def _crossings(traces: Traces) -> Floats:
    """Return the times to lane crossing after the request that are below the horizon, s, (..., n); NaN elsewhere."""
    crossing = sides_of(traces).crossing
    counts = traces.since_request & traces.present[..., 0] & (crossing < HORIZON)
    return np.where(counts, crossing, np.nan)


def least_time_to_crossing(traces: Traces) -> Floats:
    """Return the least time to lane crossing after the request, s, (...); NaN if there is none."""
    return np.asarray(np.fmin.reduce(_crossings(traces), axis=-1, initial=np.nan))


def mean_time_to_crossing(traces: Traces) -> Floats:
    """Return the mean time to lane crossing after the request, s, (...); NaN if there is none."""
    crossings = _crossings(traces)
    there = ~np.isnan(crossings)
    count = there.sum(axis=-1)
    total = np.add.accumulate(np.where(there, crossings, 0.0), axis=-1)[..., -1]
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)


def heading_error_at_response(traces: Traces) -> Floats:
    """Return the heading relative to the lane's direction in the row of the response, rad, (...); NaN if none."""
    return traces.at_response(traces.lane_heading)


def time_off_road(traces: Traces) -> Floats:
    """Return the duration for which the reference point was off the road, s, (...)."""
    off = ~traces.on_road & traces.present[..., 0] & traces.until_collision
    return np.asarray(off.sum(axis=-1) * traces.step)


def lane_departures_total(totals: RunTotals) -> Floats:
    """Return the same as `lane_departures`, (runs,)."""
    return totals.raw("departures")


def longest_departure_total(totals: RunTotals) -> Floats:
    """Return the same as `longest_departure`, (runs,)."""
    return totals.column("longest_departure") * totals.step


def mean_time_to_crossing_total(totals: RunTotals) -> Floats:
    """Return the same as `mean_time_to_crossing`, (runs,)."""
    rows = totals.column("crossing_rows")
    return np.asarray(totals.raw("crossing_sum") / rows)


def time_off_road_total(totals: RunTotals) -> Floats:
    """Return the same as `time_off_road`, (runs,)."""
    return totals.raw("rows_off_road") * totals.step
