"""The ego vehicle within its lane: how far its sides are from the edges, when they cross them, and how soon they would.

A side is beyond an edge of the lane where a corner of the vehicle's box is. The formulas are those of
`engine.measures.in_lane`, in the same order and with the C library's functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from scenario_compiler.engine.measures.in_lane import JUMP
from scenario_compiler.recording.lateral import left_of_centre
from scenario_compiler.recording.recording import Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces
from scenario_compiler.vocabulary.horizon import HORIZON


@dataclass(frozen=True, slots=True)
class Place:
    """The ego vehicle in its lane in one row.

    Attributes:
        left: Offset of its reference point from the lane's centre, m; to the left, as all of these.
        to_left: Distance of its outermost corners from the reference point, m.
        to_right: The same to the right.
        width: Width of the lane, m; 0 where there is none.
        on_lane: Whether the reference point is on a lane.
        across: Speed across the lane, m/s.
        after: Whether the row lies behind the request.
    """

    left: float
    to_left: float
    to_right: float
    width: float
    on_lane: bool
    across: float
    after: bool

    @property
    def rooms(self) -> tuple[float, float]:
        """Distance from the left and from the right side to the lane's edge there, m; negative beyond it."""
        return 0.5 * self.width - (self.left + self.to_left), 0.5 * self.width - (self.to_right - self.left)

    @property
    def out(self) -> bool:
        """Whether a side is beyond its edge, or the reference point off every lane."""
        return not self.on_lane or (self.width > 0.0 and min(self.rooms) < 0.0)

    @property
    def crossing(self) -> float:
        """Time until a side crosses its edge at the present speed across the lane, s; 0 where one has."""
        if self.out:
            return 0.0
        if self.width <= 0.0 or self.across == 0.0:
            return math.inf
        return self.rooms[0 if self.across > 0.0 else 1] / abs(self.across)


@dataclass
class Departures:
    """The times that a vehicle was out of its lane: each from the row in which it comes out to that before it is in.

    Attributes:
        count: Their number.
        longest: Rows of the longest.
        deepest: How far a side was beyond the edge of the lane that it had left, m; NaN where that is not known.
    """

    count: int = 0
    longest: int = 0
    deepest: float = math.nan
    _rows: int = 0
    _width: float = 0.0
    _aside: float = 0.0
    _step: float = 0.0
    _left: float = field(default=0.0)

    def end(self) -> None:
        """Note that the vehicle is within its lane, or gone."""
        self._rows = 0

    def add(self, place: Place) -> None:
        """Add a row in which it is out."""
        change = place.left - self._left
        if self._rows == 0:
            self.count += 1
            self._width, self._aside, self._step = place.width, 0.0, 0.0
        elif abs(change) > JUMP:
            self._aside += self._step - change
        else:
            self._step = change
        self._left = place.left
        self._rows += 1
        self.longest = max(self.longest, self._rows)
        if place.on_lane and self._width > 0.0:
            at = place.left + self._aside
            deep = max(at + place.to_left, place.to_right - at) - 0.5 * self._width
            self.deepest = deep if math.isnan(self.deepest) else max(self.deepest, deep)


def places(traces: Traces, index: tuple[int, ...]) -> Iterator[Place | None]:
    """Yield where the ego vehicle is in each row of a run, None where it is absent."""
    length, width, center = float(traces.length[0]), float(traces.width[0]), float(traces.center[0])
    rows = int((~np.isnan(traces.t[index])).sum())
    columns = (
        traces.present[..., 0],
        left_of_centre(traces),
        traces.lane_heading,
        traces.lane_width,
        (traces.road[..., 0] >= 0) & (traces.lane[..., 0] != 0),
        traces.v[..., 0],
        traces.between(traces.times["request"]),
    )
    for present, left, heading, wide, on_lane, v, after in zip(
        *(each[index][:rows].tolist() for each in columns), strict=True
    ):
        if not present:
            yield None
            continue
        heading = 0.0 if math.isnan(heading) else heading
        turned = math.sin(heading)
        front, rear = (center + 0.5 * length) * turned, (center - 0.5 * length) * turned
        half = 0.5 * width * abs(math.cos(heading))
        lane = 0.0 if math.isnan(wide) else wide
        yield Place(left, max(front, rear) + half, half - min(front, rear), lane, on_lane, v * turned, after)


def _of_runs(traces: Traces, measure: Callable[[Iterator[Place | None]], float]) -> Floats:
    """Return a number of each run, (...)."""
    shape = traces.t.shape[:-1]
    found = [measure(places(traces, index)) for index in np.ndindex(*shape)]
    return np.array(found, dtype=np.float64).reshape(shape)


def _departures(rows: Iterator[Place | None]) -> Departures:
    found = Departures()
    for place in rows:
        if place is None or not place.out:
            found.end()
        else:
            found.add(place)
    return found


def _crossings(rows: Iterator[Place | None]) -> list[float]:
    """Return the times to lane crossing behind the request that are below the horizon, s."""
    return [one.crossing for one in rows if one is not None and one.after and one.crossing < HORIZON]


def lane_departures(traces: Traces) -> Floats:
    """Return how often the vehicle came out of its lane, (...)."""
    return _of_runs(traces, lambda rows: float(_departures(rows).count))


def first_departure(traces: Traces) -> Floats:
    """Return the time of the first row behind the request in which it was out of its lane, s, (...); NaN for none."""

    def first(index: tuple[int, ...]) -> float:
        times = traces.t[index].tolist()
        there = enumerate(places(traces, index))
        return next((times[k] for k, one in there if one is not None and one.after and one.out), math.nan)

    shape = traces.t.shape[:-1]
    return np.array([first(index) for index in np.ndindex(*shape)], dtype=np.float64).reshape(shape)


def longest_departure(traces: Traces) -> Floats:
    """Return how long it was out of its lane at a time, s, (...); NaN where it never was."""
    longest = _of_runs(traces, lambda rows: float(_departures(rows).longest))
    return np.where(longest > 0, longest * traces.step, np.nan)


def deepest_departure(traces: Traces) -> Floats:
    """Return how far a side was beyond the edge of the lane that it had left, m, (...); NaN where none was."""
    return _of_runs(traces, lambda rows: _departures(rows).deepest)


def least_time_to_crossing(traces: Traces) -> Floats:
    """Return the least time to lane crossing behind the request, s, (...); NaN where there is none."""
    return _of_runs(traces, lambda rows: min(_crossings(rows), default=math.nan))


def mean_time_to_crossing(traces: Traces) -> Floats:
    """Return the mean time to lane crossing behind the request, s, (...); NaN where there is none."""

    def mean(rows: Iterator[Place | None]) -> float:
        times = _crossings(rows)
        total = 0.0
        for time in times:
            total += time
        return total / len(times) if times else math.nan

    return _of_runs(traces, mean)


def heading_error_at_response(traces: Traces) -> Floats:
    """Return the heading against the lane's direction in the row of the response, rad, (...); NaN without one."""
    there = traces.between(traces.times["response"]) & traces.present[..., 0]
    row = np.argmax(there, axis=-1)[..., None]
    heading = np.take_along_axis(traces.lane_heading, row, axis=-1)[..., 0]
    return np.where(there.any(axis=-1), heading, np.nan)


def time_off_road(traces: Traces) -> Floats:
    """Return how long the reference point was off the road, s, (...); NaN where it never was."""
    count = (~traces.on_road & traces.present[..., 0]).sum(axis=-1)
    return np.where(count > 0, count * traces.step, np.nan)


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
    return totals.column("rows_off_road") * totals.step
