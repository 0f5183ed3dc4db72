"""Distances between the entities' boxes, computed for whole runs at once.

Exact distances take long. For that reason bounds are computed for all rows, and exact distances only for the rows that
the bounds do not exclude. The exact formulas are those of `engine.measures.boxes`, in the same order and with the C
library's functions: numpy's own sines differ from them in the last bit, and from one processor to the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from scenario_compiler.recording.recording import Booleans, Floats, Integers
from scenario_compiler.recording.traces import Singles, Traces

GREATEST = float(np.finfo(np.float64).max)
"""The greatest finite number."""


def corners(traces: Traces) -> tuple[Floats, Floats]:
    """Return x and y of the boxes' four corners in order, (..., n, m, 4).

    The corners' axis is outermost in memory, so that reductions over it are fast.
    """
    c, s = np.cos(traces.h), np.sin(traces.h)
    along, across = _corner_offsets(traces, (1,) * c.ndim)
    x, y = traces.x + along * c - across * s, traces.y + along * s + across * c
    return np.moveaxis(x, 0, -1), np.moveaxis(y, 0, -1)


def _corner_offsets(traces: Traces, shape: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return the offsets of the corners ahead and to the left of the reference points, (4, 1, ..., m)."""
    front = np.array([1.0, -1.0, -1.0, 1.0]).reshape(-1, *shape)
    left = np.array([1.0, 1.0, -1.0, -1.0]).reshape(-1, *shape)
    return traces.center + 0.5 * traces.length * front, 0.5 * traces.width * left


Places = tuple[Integers, ...]
"""Indices of k places in arrays (m - 1, ..., n): other entity, run if there are several, and row."""


def least_of_run(values: Floats | Singles) -> Floats:
    """Return the least value over all entities and rows, (m - 1, ..., n) to (...); infinite if there is none."""
    least = values.min(axis=-1, initial=np.inf).min(axis=0, initial=np.inf)
    return np.asarray(least, dtype=np.float64)


def exact_at(places: Places, values: Floats, shape: tuple[int, ...]) -> Floats:
    """Return an array (m - 1, ..., n) with k values at their places and infinity elsewhere."""
    whole = np.full(shape, np.inf)
    whole[places] = values
    return whole


def least_by_bounds(bounds: Singles, exact: Callable[[Places], Floats]) -> Floats:
    """Return the least value of each run, (...), infinite if there is none, from lower bounds of all values.

    The exact value is computed where a run's bound is least, then wherever a bound is not above the value found there.

    Args:
        bounds: Lower bounds, (m - 1, ..., n); infinite where there is no value.
        exact: Returns the values at k places, (k,); infinite if there is none.
    """

    def least_within(limit: Floats) -> Floats:
        places = np.nonzero(bounds <= np.minimum(limit, GREATEST)[..., None])
        return least_of_run(exact_at(places, exact(places), bounds.shape))

    return least_within(least_within(least_of_run(bounds)))


def least_box_distance(traces: Traces) -> Floats:
    """Return the least distance in the plane from the ego's box to another one over the run, m, (...).

    It is 0 if boxes overlap, and NaN without another entity.
    """
    touched = np.asarray(touching(traces).any(axis=-1))
    bounds = np.where(touched[..., None], np.float32(np.inf), traces.seen.apart)
    least = least_by_bounds(bounds, lambda places: distance_at(traces, places))
    return np.where(touched, 0.0, np.where(np.isinf(least), np.nan, least))


def distance_at(traces: Traces, places: Places) -> Floats:
    """Return the distances from the ego's box of k boxes that do not overlap it, m, (k,)."""
    ego, other = boxes_at(traces, places)
    number, *rows = places
    from_ego = _from_box(traces, rows, np.zeros_like(number), other)
    return np.minimum(from_ego, _from_box(traces, rows, number + 1, ego))


def touching(traces: Traces) -> Booleans:
    """Return in which rows the ego's box overlaps another one, (..., n)."""
    near = np.nonzero(traces.seen.apart <= 0.0)
    touched = np.zeros(traces.t.shape, dtype=bool)
    overlap = _overlap(traces, near)
    touched[tuple(place[overlap] for place in near[1:])] = True
    return touched


Box = tuple[Floats, Floats]
"""x and y of the four corners, in order, of k boxes, each (4, k)."""


def boxes_at(traces: Traces, places: Places) -> tuple[Box, Box]:
    """Return the ego's box and the other entity's box at k places."""
    other, *rows = places
    return _box_at(traces, rows, np.zeros_like(other)), _box_at(traces, rows, other + 1)


def _box_at(traces: Traces, rows: Sequence[Integers], entity: Integers) -> Box:
    x, y, c, s = _poses(traces, rows, entity)
    along, across = (each[:, entity] for each in _corner_offsets(traces, (1,)))
    return x + along * c - across * s, y + along * s + across * c


def _poses(traces: Traces, rows: Sequence[Integers], entity: Integers) -> tuple[Floats, Floats, Floats, Floats]:
    """Return x, y, and the cosine and sine of the heading, of k entities in their rows."""
    place = (*rows, entity)
    h = traces.h[place]
    return traces.x[place], traces.y[place], by_libm(math.cos, h), by_libm(math.sin, h)


def _from_box(traces: Traces, rows: Sequence[Integers], entity: Integers, points: Box) -> Floats:
    """Return the least distance from the boxes of k entities to the 4 corners of another box, m, (k,).

    The distance of two boxes that do not overlap is the lesser of the results for both orders of the boxes.
    """
    x, y, c, s = _poses(traces, rows, entity)
    dx, dy = points[0] - x, points[1] - y
    along = np.abs(dx * c + dy * s - traces.center[entity]) - 0.5 * traces.length[entity]
    across = np.abs(dy * c - dx * s) - 0.5 * traces.width[entity]
    along, across = np.maximum(along, 0.0), np.maximum(across, 0.0)
    return np.asarray(np.sqrt((along * along + across * across).min(axis=0)))


def _overlap(traces: Traces, places: Places) -> Booleans:
    """Return at which places two boxes overlap, by the separating axes of both, (k,)."""
    number, *rows = places
    ego, other = (_poses(traces, rows, entity) for entity in (np.zeros_like(number), number + 1))
    middles = [
        (x + traces.center[entity] * c, y + traces.center[entity] * s)
        for (x, y, c, s), entity in ((ego, 0), (other, number + 1))
    ]
    dx, dy = middles[1][0] - middles[0][0], middles[1][1] - middles[0][1]
    turned = traces.h[(*rows, number + 1)] - traces.h[(*rows, np.zeros_like(number))]
    cos, sin = np.abs(by_libm(math.cos, turned)), np.abs(by_libm(math.sin, turned))
    apart = np.zeros(number.shape, dtype=bool)
    for (_, _, c, s), a, b in ((ego, 0, number + 1), (other, number + 1, 0)):
        long, wide = 0.5 * traces.length[b], 0.5 * traces.width[b]
        apart |= np.abs(dx * c + dy * s) > 0.5 * traces.length[a] + long * cos + wide * sin
        apart |= np.abs(dy * c - dx * s) > 0.5 * traces.width[a] + long * sin + wide * cos
    return ~apart


def by_libm(function: Callable[..., float], *values: Floats) -> Floats:
    """Return a function that applies a function of `math` to each element."""
    shape = np.broadcast_shapes(*(each.shape for each in values))
    lists = [np.broadcast_to(each, shape).ravel().tolist() for each in values]
    return np.array([function(*one) for one in zip(*lists, strict=True)], dtype=np.float64).reshape(shape)
