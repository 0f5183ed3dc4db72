"""The entities ahead of the ego on the circle that it drives, and the time until it reaches them."""

from __future__ import annotations

import math

import numpy as np

from scenario_compiler.engine.measures.boxes import STRAIGHT
from scenario_compiler.recording.boxes import Places, boxes_at, by_libm, exact_at, least_by_bounds, touching
from scenario_compiler.recording.recording import Floats, Integers
from scenario_compiler.recording.traces import ROUNDING, SINGLE, Singles, Traces
from scenario_compiler.vocabulary.horizon import HORIZON

STEEPEST = 20.0
"""Greatest deceleration to avoid a crash that is distinguished from others, m/s2.

The number is our own choice, twice what tyres give: with the gap it would grow beyond any limit before a contact.
"""


def time_to_collision(traces: Traces, below: Floats) -> Floats:
    """Time to collision of the ego vehicle in every row, s, (..., n); NaN if nothing is reached within `HORIZON`.

    It is NaN in the first row, as the path that is driven is known from the second on, unless boxes overlap.
    It may be NaN also where it is not below a number of each run, (...): what is above it takes no time then.
    """
    bounds = time_bounds(traces)
    places = np.nonzero(bounds < np.minimum(below, HORIZON)[..., None])
    least = exact_at(places, times_at(traces, places), bounds.shape).min(axis=0, initial=np.inf)
    return np.where(touching(traces), 0.0, _within_horizon(least))


def least_time_to_collision(traces: Traces) -> Floats:
    """Return the least time to collision of each run, s, (...); NaN if nothing is ever reached within `HORIZON`."""
    least = least_by_bounds(time_bounds(traces), lambda places: times_at(traces, places))
    return np.where(touching(traces).any(axis=-1), 0.0, _within_horizon(least))


def _within_horizon(times: Floats) -> Floats:
    return np.where(times < HORIZON, times, np.nan)


def least_headway(traces: Traces) -> Floats:
    """Return the least time gap of each run, s, (...); NaN if nothing in the path is within `HORIZON`."""

    def exact(places: Places) -> Floats:
        gap, _ = ahead_at(traces, places)
        own = traces.v[..., 0][places[1:]]
        return np.where(own > 0, gap / np.where(own > 0, own, 1.0), np.inf)

    gap, _ = bounds_ahead(traces)
    own = np.maximum(traces.v[..., 0], 0.0).astype(np.float32) * np.float32(1.0 + SINGLE)
    with np.errstate(divide="ignore", invalid="ignore"):
        bounds = np.where(own > 0, gap / own, np.float32(np.inf))
    least = least_by_bounds(bounds, exact)
    return np.where(touching(traces).any(axis=-1), 0.0, _within_horizon(least))


def greatest_drac(traces: Traces) -> Floats:
    """Return the greatest deceleration to avoid a crash of each run, m/s2, (...); NaN where none was needed."""

    def exact(places: Places) -> Floats:
        gap, closing = ahead_at(traces, places)
        counts = np.isfinite(gap) & (closing * closing > 0) & (closing > 0)
        gap, closing = np.where(counts, gap, 0.0), np.where(counts, closing, 1.0)
        return np.where(counts & (gap / closing < HORIZON), 2.0 * gap / (closing * closing), np.inf)

    gap, closing = bounds_ahead(traces)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        soon = (closing > 0.0) & (gap < np.float32(HORIZON) * closing)
        bounds = np.where(soon, np.float32(2.0 - SINGLE) * gap / (closing * closing), np.float32(np.inf))
    room = least_by_bounds(bounds, exact)
    return drac_of_room(np.where(touching(traces).any(axis=-1), 0.0, np.where(np.isinf(room), np.nan, room)))


def drac_of_room(room: Floats) -> Floats:
    """Return the deceleration whose inverse is the room to brake, s2/m, at most `STEEPEST`; NaN stays."""
    return np.asarray(1.0 / np.maximum(room, 1.0 / STEEPEST))


def times_at(traces: Traces, places: Places) -> Floats:
    """Return the times to collision at k places, s, (k,); infinite if there is none."""
    gap, closing = ahead_at(traces, places)
    counts = np.isfinite(gap) & (closing > 0)
    return np.where(counts, gap / np.where(counts, closing, 1.0), np.inf)


def ahead_at(traces: Traces, places: Places) -> tuple[Floats, Floats]:
    """Return the gaps to entities in the path ahead, m, infinite for others, and the closing speeds, m/s, each (k,).

    A box on the far side of the circle, where ahead and behind meet, and one around its middle count as not ahead.
    """
    rows = tuple(places[1:])
    bend = traces.curvature[rows]
    ahead, left = seen_from_ego(traces, places)
    along, _ = on_circle(ahead, left, bend)
    gap = least_along(ahead, left, bend, 0.5 * traces.width[0]) - _front(traces)
    one_way = np.ptp(along, axis=0) * np.abs(bend) < np.pi
    place = (*rows, places[0] + 1)
    tangent = traces.h[(*rows, np.zeros_like(places[0]))] + bend * ((along[0] + along[1] + along[2] + along[3]) / 4.0)
    speed = traces.v[place] * by_libm(math.cos, traces.h[place] - tangent)
    counts = one_way & (gap >= 0) & np.isfinite(gap)
    return np.where(counts, gap, np.inf), traces.v[..., 0][rows] - speed


def least_along(ahead: Floats, left: Floats, bend: Floats, half: float) -> Floats:
    """Return how near the parts of boxes are that lie in a strip along a circle, m, (k,); infinite without such a part.

    `engine.measures.boxes.least_along` explains the formulas.

    Args:
        ahead: The boxes' corners in turn ahead of the circle's start, m, (4, k), joined by straight edges.
        left: The same to the left.
        bend: The circles' curvatures, 1/m, (k,).
        half: Half the strip's width, m.
    """
    along, across = on_circle(ahead, left, bend)
    curved = np.where(np.abs(bend) > STRAIGHT, bend, 0.0)
    least = np.where(np.abs(across) <= half, along, np.inf).min(axis=0)
    low, high = across.min(axis=0), across.max(axis=0)
    long, wide = np.roll(ahead, -1, axis=0) - ahead, np.roll(left, -1, axis=0) - left
    square = -curved * (long * long + wide * wide)
    slope = wide - curved * (ahead * long + left * wide)

    def at(share: Floats) -> tuple[Floats, Floats, tuple[Integers, ...]]:
        inside = np.nonzero((share >= 0.0) & (share <= 1.0))
        part = share[inside]
        reached = ahead[inside] + part * long[inside], left[inside] + part * wide[inside]
        return *on_circle(*reached, bend[inside[1]]), inside

    with np.errstate(divide="ignore", invalid="ignore"):
        foot = -slope / square
        _, beside, (_, box) = at(np.where((square != 0.0) & (foot > 0.0) & (foot < 1.0), foot, -1.0))
        np.minimum.at(low, box, beside)
        np.maximum.at(high, box, beside)
        for edge in (-half, half):
            start = 2.0 * (left - edge) - curved * (ahead * ahead + left * left - edge * edge)
            both = -(slope + np.copysign(np.sqrt(slope * slope - square * start), slope))
            for share in (start / both, both / square):
                nearest, _, (_, box) = at(np.where(np.isfinite(share), share, -1.0))
                np.minimum.at(least, box, nearest)
    return np.where((low < half) & (high > -half), least, np.inf)


def on_circle(ahead: Floats, left: Floats, bend: Floats) -> tuple[Floats, Floats]:
    """Return points' distances along circles from where they begin, and across them, m, positive to the left.

    All are (..., k), the circles' curvatures `bend`, 1/m, (k,); circles of less than `STRAIGHT` are straight.
    """
    along, across = ahead.copy(), left.copy()
    bent = np.broadcast_to(np.abs(bend) > STRAIGHT, ahead.shape)
    curvature = np.broadcast_to(bend, ahead.shape)[bent]
    side, radius = np.where(curvature < 0, -1.0, 1.0), 1.0 / np.abs(curvature)
    forward, inward = ahead[bent], radius - side * left[bent]
    along[bent] = by_libm(math.atan2, forward, inward) * radius
    across[bent] = side * (radius - np.sqrt(forward * forward + inward * inward))
    return along, across


def _front(traces: Traces) -> float:
    """Return how far ahead of its reference point the ego vehicle's box reaches, m."""
    return float(traces.center[0] + 0.5 * traces.length[0])


def seen_from_ego(traces: Traces, places: Places) -> tuple[Floats, Floats]:
    """Return the corners of other entities' boxes at k places, ahead of the ego's reference point and to its left, m.

    Both are (4, k).
    """
    other, *rows = places
    ego = (*rows, np.zeros_like(other))
    _, (x, y) = boxes_at(traces, places)
    c, s = by_libm(math.cos, traces.h[ego]), by_libm(math.sin, traces.h[ego])
    dx, dy = x - traces.x[ego], y - traces.y[ego]
    return c * dx + s * dy, c * dy - s * dx


def time_bounds(traces: Traces) -> Singles:
    """Return times that no time to collision is below, s, (m - 1, ..., n); infinite if there is none."""
    gap, closing = bounds_ahead(traces)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(closing > 0.0, gap / closing, np.float32(np.inf))


def bounds_ahead(traces: Traces) -> tuple[Singles, Singles]:
    """Return gaps that none ahead is below, m, infinite without one, and speeds that none closes in above, m/s.

    Both are (m - 1, ..., n).

    The middle of a box is taken to the circle with the curvature k that the ego vehicle is driving on. With q as its
    distance from the circle's centre times k, its distance from the circle is (2 left - k (ahead^2 + left^2)) / (1 +
    q), also for k = 0. From there the corners reach as far as the box is long and wide in the direction of the radius,
    and a little more where they stand beside it. An arc is longer than the sine of its angle; the mean of the corners'
    angles differs from the middle's in the second order alone. No part of a box is nearer than its nearest corner.
    """
    single = np.float32
    seen, half, rounding = traces.seen, single(0.5), single(ROUNDING)
    length, width = (traces.of_others(each) for each in (traces.length, traces.width))
    outer = half * np.hypot(length, width) + rounding
    curvature = traces.curvature
    k = np.where(np.abs(curvature) <= STRAIGHT, 0.0, curvature).astype(single)
    v = np.moveaxis(traces.v, -1, 0).astype(single)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        sine, cosine = k * seen.ahead, single(1.0) - k * seen.left
        q = np.sqrt(sine * sine + cosine * cosine)
        from_circle = single(2.0) * seen.left - k * (seen.ahead * seen.ahead + seen.left * seen.left)
        across = np.abs(from_circle) / (single(1.0) + q)
        share = single(1.0) / np.maximum(q, rounding)
        sine, cosine = sine * share, cosine * share
        along_circle, across_circle = seen.cos * cosine + seen.sin * sine, seen.sin * cosine - seen.cos * sine
        beside = np.abs(k) * outer
        turn = beside / np.maximum(q - beside, rounding)
        reach = half * (length * np.abs(across_circle) + width * np.abs(along_circle) + outer * turn)
        in_path = across <= reach + seen.slack + single(0.5 * traces.width[0])
        slack = np.abs(v[1:]) * (half * turn * turn + single(SINGLE)) + single(SINGLE) * (np.abs(v[0]) + single(1.0))
        closing = v[0] - v[1:] * along_circle + slack
        gap = np.maximum(seen.ahead - seen.reach - seen.slack, single(0.0)) / (q + beside) - single(_front(traces))
        reaches_ahead = (seen.ahead + seen.reach >= -seen.slack) | (_front(traces) < 0.0)
        counts = in_path & reaches_ahead & np.isfinite(seen.apart)
        gap = np.maximum(gap - seen.slack, single(0.0))
    return np.where(counts, gap, single(np.inf)), closing
