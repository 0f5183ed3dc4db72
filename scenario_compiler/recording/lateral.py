"""The ego's lateral position: offsets to the left in its driving direction, and their spread."""

from __future__ import annotations

import numpy as np

from scenario_compiler.engine.measures.in_lane import JUMP
from scenario_compiler.engine.measures.lane_keeping import BAND, LEAST_STEP, SETTLED, SETTLING, rows_of_window
from scenario_compiler.recording.durations import Timed, after_request, whole_steps
from scenario_compiler.recording.recording import Booleans, Floats
from scenario_compiler.recording.totals import RunTotals
from scenario_compiler.recording.traces import Traces


def left_of_centre(traces: Traces) -> Floats:
    """Return the offset to the left of the centre of the present lane, in the driving direction, m, (..., n)."""
    step = np.diff(traces.s[..., 0], axis=-1)
    driven = (np.diff(traces.road[..., 0], axis=-1) == 0) & traces.until_collision[..., 1:]
    step = np.sign(np.where(driven & (np.abs(step) > LEAST_STEP), step, 0.0))
    none = np.zeros_like(traces.t[..., :1])
    ahead, behind = np.concatenate([step, none], axis=-1), np.concatenate([none, step], axis=-1)
    direction = np.where(ahead != 0, ahead, behind)
    return traces.off[..., 0] * np.where(_held(direction, direction != 0) < 0, -1.0, 1.0)


def left_of_lane_at_request(traces: Traces) -> Floats:
    """Return the offset to the left of the centre of the lane at the request, m, (..., n); 0 if the ego is absent.

    If the offset changes by more than `JUMP` from one row to the next, it is measured from another lane's centre. The
    distance of the two centres is that change less the vehicle's own motion, which is estimated from the row before.
    Before the request, and after the first collision, the offset is relative to the present lane.
    """
    left = np.nan_to_num(_held(left_of_centre(traces), traces.present[..., 0]))
    change = np.diff(left, axis=-1, prepend=left[..., :1])
    jumps = np.abs(change) > JUMP
    after = traces.since_request
    counts = jumps & after & np.concatenate([np.zeros_like(after[..., :1]), after[..., :-1]], axis=-1)
    moved = _held(change, ~jumps)
    return left + np.add.accumulate(np.where(counts, moved - change, 0.0), axis=-1)


def _held(values: Floats, known: Booleans) -> Floats:
    """Return values (..., n) in which unknown ones are replaced by the last known one, or by the first value."""
    places = np.where(known, np.arange(values.shape[-1]), 0)
    return np.take_along_axis(values, np.maximum.accumulate(places, axis=-1), axis=-1)


def maximum_lateral_offset(traces: Traces) -> Floats:
    """Return the greatest distance from the centre of the lane at the request, m, (...), without rows off the lanes."""
    counts = traces.since_request & (traces.lane[..., 0] != 0) & traces.present[..., 0]
    offsets = np.where(counts, np.abs(left_of_lane_at_request(traces)), np.nan)
    return np.asarray(np.fmax.reduce(offsets, axis=-1, initial=np.nan))


def lateral_offset_at_response(traces: Traces) -> Floats:
    """Return the offset to the left of the centre of the lane at the request, in the row of the response, m, (...)."""
    return traces.at_response(left_of_lane_at_request(traces))


def time_off_lanes(traces: Traces) -> Floats:
    """Return the duration for which the reference point was on no lane, s, (...)."""
    off = (traces.road[..., 0] < 0) | (traces.lane[..., 0] == 0)
    return np.asarray((off & traces.present[..., 0] & traces.until_collision).sum(axis=-1) * traces.step)


def time_off_lanes_total(totals: RunTotals) -> Floats:
    """Return the same as `time_off_lanes`, (runs,)."""
    return totals.raw("rows_off_lanes") * totals.step


def lane_position_deviation(traces: Traces) -> Floats:
    """Return the standard deviation of the lateral position in the first seconds after the response, m, (...)."""
    response = traces.times["response"]
    return _deviation(traces, response, response + SETTLING)


def settled_deviation(traces: Traces) -> Floats:
    """Return the standard deviation of the lateral position in the seconds after those, m, (...)."""
    response = traces.times["response"]
    return _deviation(traces, response + SETTLING, response + SETTLED)


def _deviation(traces: Traces, begin: Floats, end: Floats) -> Floats:
    """Return the standard deviation of the lateral position in a window.

    It is NaN if the window is cut short, if the lane changes, or if the driver does not drive in it all the time. The
    row of the response itself belongs to the window.
    """
    window = traces.between(begin, end)
    left = left_of_centre(traces)
    jumps = np.abs(np.diff(left, axis=-1)) > JUMP
    changes = (jumps & window[..., 1:] & window[..., :-1]).any(axis=-1)
    lasts = np.fmax.reduce(traces.t, axis=-1, initial=np.nan) >= end - 1e-6
    intact = ~(traces.times["collision"] < end - 1e-6)
    by_driver = ~(window & traces.behind(traces.times["response"]) & ~traces.driven).any(axis=-1)
    count = window.sum(axis=-1)
    mean = _total(np.where(window, left, 0.0)) / np.maximum(count, 1)
    square = _total(np.where(window, (left - mean[..., None]) ** 2, 0.0))
    deviation = np.sqrt(square / np.maximum(count - 1, 1))
    return np.where(lasts & intact & by_driver & ~changes & (count > 1), deviation, np.nan)


def _total(values: Floats) -> Floats:
    """Return the sum over the rows in their order, so that the zeros after a run's end do not change it."""
    return np.asarray(np.add.accumulate(values, axis=-1)[..., -1])


def stabilisation_time(traces: Traces) -> Floats:
    """Return the time from the request until the lateral position is stable, s, (...); NaN if it never is."""
    shape = traces.t.shape[:-1]
    size = rows_of_window(traces.step)
    offsets = left_of_lane_at_request(traces)
    first = np.full(shape, np.nan)
    for index in np.ndindex(*shape):
        driven = offsets[index][traces.driven[index]]
        spreads = [float(np.std(driven[k : k + size], ddof=1)) for k in range(0, len(driven) - size + 1, size)]
        for number in reversed(range(len(spreads))):
            if spreads[number] > BAND:
                break
            first[index] = number
    return _from_request(traces, first)


def stabilisation_time_total(totals: RunTotals) -> Floats:
    """Return the same as `stabilisation_time`, (runs,)."""
    return _from_request(totals, totals.column("stable_from"))


def _from_request(runs: Timed, windows: Floats) -> Floats:
    """Return the time from the request to the beginning of the window with a number after the response, s, (...)."""
    waited = after_request(runs, runs.times["response"])
    return whole_steps(runs.step, waited + windows * rows_of_window(runs.step) * runs.step)
