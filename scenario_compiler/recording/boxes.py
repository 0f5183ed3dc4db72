"""Distances between the entities' boxes, over whole runs at once."""

from __future__ import annotations

import numpy as np

from scenario_compiler.recording.recording import Booleans, Floats, Integers
from scenario_compiler.recording.traces import Traces

STRAIGHT = 1e-6
"""Curvature below which a path counts as straight, 1/m."""

STILL = 0.5
"""Speed below which a vehicle's curvature is not measured, m/s."""

ROUNDING = 1e-6
"""Slack of the circles around and inside a box, m."""


def corners(traces: Traces) -> tuple[Floats, Floats]:
    """Return x and y of the boxes' four corners in turn, (..., n, m, 4).

    The corners lie outermost in memory, so that reductions over them are fast.
    """
    c, s = traces.forward
    along, across = _corner_offsets(traces, (1,) * c.ndim)
    x, y = traces.x + along * c - across * s, traces.y + along * s + across * c
    return np.moveaxis(x, 0, -1), np.moveaxis(y, 0, -1)


def _corner_offsets(traces: Traces, shape: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Return how far ahead and to the left of the reference points the corners lie, (4, 1, ..., m)."""
    front = np.array([1.0, -1.0, -1.0, 1.0]).reshape(-1, *shape)
    left = np.array([1.0, 1.0, -1.0, -1.0]).reshape(-1, *shape)
    return traces.center + 0.5 * traces.length * front, 0.5 * traces.width * left


def path_curvature(traces: Traces) -> Floats:
    """Return the curvature that the ego vehicle drives, 1/m, positive to the left, (..., n).

    From the change of heading since the row before; 0 in the first row and at a standstill.
    """
    if traces.t.shape[-1] < 2:
        return np.zeros_like(traces.t)
    turned = _wrapped(np.diff(traces.h[..., 0], axis=-1))
    way = traces.v[..., :-1, 0] * np.diff(traces.t, axis=-1)
    moving = np.abs(traces.v[..., :-1, 0]) > STILL
    curvature = np.where(moving, turned / np.where(moving, way, 1.0), 0.0)
    return np.concatenate([curvature[..., :1], curvature], axis=-1)


def along_path(traces: Traces, where: Booleans) -> tuple[Floats, Floats, Floats]:
    """Return other entities' boxes as seen along the circle that the ego vehicle is driving on.

    Args:
        traces: The runs.
        where: Which rows and entities are asked for, (..., n, m - 1), k of them true.

    Returns:
        (along, across, speed): for each box's corners the distance along the circle from the ego's reference point and
        the distance to the left of it, m, (4, k); and each entity's speed along the circle, m/s, (k,).
    """
    at = np.nonzero(where)
    rows, other = at[:-1], at[-1] + 1
    ego = (*rows, np.zeros_like(other))
    x, y = _box_at(traces, rows, other)
    c, s = (each[ego] for each in traces.forward)
    dx, dy = x - traces.x[ego], y - traces.y[ego]
    along, across = c * dx + s * dy, c * dy - s * dx
    curvature = path_curvature(traces)[rows]
    bent = np.nonzero(np.abs(curvature) > STRAIGHT)[0]
    side, radius = np.where(curvature[bent] < 0, -1.0, 1.0), 1.0 / np.abs(curvature[bent])
    for k in range(len(along)):
        forward, inward = along[k, bent], radius - side * across[k, bent]
        along[k, bent] = np.arctan2(forward, inward) * radius
        across[k, bent] = side * (radius - np.hypot(forward, inward))
    tangent = traces.h[ego] + curvature * along.mean(axis=0)
    place = (*rows, other)
    return along, across, traces.v[place] * np.cos(traces.h[place] - tangent)


def may_lie_ahead(traces: Traces) -> Booleans:
    """Return which boxes may lie across the path ahead of the ego vehicle, (..., n, m - 1); no other one does.

    The box's middle is taken to the circle that the ego vehicle is driving on. From there the corners reach as far as
    the box is long and wide in the direction of the circle's radius, and a little more where they stand beside it.
    """
    c, s = traces.forward
    dx = (traces.x + traces.center * c)[..., 1:] - traces.x[..., :1]
    dy = (traces.y + traces.center * s)[..., 1:] - traces.y[..., :1]
    ahead = c[..., :1] * dx + s[..., :1] * dy
    front = traces.center[0] + 0.5 * traces.length[0]
    before: Booleans = np.asarray(traces.present[..., 1:] & ((ahead >= -ROUNDING) | (front < 0.0)))
    at = np.nonzero(before)
    rows, other = at[:-1], at[-1] + 1
    ego, place = (*rows, np.zeros_like(other)), (*rows, other)
    left = c[ego] * dy[before] - s[ego] * dx[before]
    forward = ahead[before]
    c_turned, s_turned = c[place] * c[ego] + s[place] * s[ego], s[place] * c[ego] - c[place] * s[ego]
    length, width = traces.length[other], traces.width[other]
    curvature = path_curvature(traces)[rows]
    bent = np.abs(curvature) > STRAIGHT
    radius = 1.0 / np.where(bent, curvature, 1.0)
    outwards = left - radius
    distance = np.maximum(np.sqrt(forward * forward + outwards * outwards), ROUNDING)
    across = np.where(bent, np.abs(np.abs(radius) - distance), np.abs(left))
    u, v = np.where(bent, forward / distance, 0.0), np.where(bent, outwards / distance, 1.0)
    reach = 0.5 * (length * np.abs(c_turned * u + s_turned * v) + width * np.abs(c_turned * v - s_turned * u))
    outer = 0.5 * np.hypot(length, width)
    beside = np.where(bent, outer * outer / (2.0 * np.maximum(distance - outer, ROUNDING)), 0.0)
    before[at] = across <= 0.5 * traces.width[0] + reach + beside + ROUNDING
    return before


def least_box_distance(traces: Traces) -> Floats:
    """Return the least distance in the plane from the ego vehicle's box to another one over the run, m, (...).

    0 where boxes overlap, NaN without another entity. Only rows whose boxes can be the nearest are looked at: a box
    lies between the circles of its half diagonal and of its smaller half side.
    """
    apart, (outer, inner) = traces.centre_distance, _circles(traces)
    nearest = np.fmin(least_of_run(apart - inner), np.inf)
    near = apart - outer <= np.maximum(nearest, 0.0)[..., None, None]
    distance = np.full(apart.shape, np.nan)
    ego, other = _boxes_at(traces, near)
    gap = np.fmin(_to_edges(ego, other), _to_edges(other, ego))
    distance[near] = np.where(_overlap(ego, other), 0.0, gap)
    return least_of_run(distance)


def least_of_run(values: Floats) -> Floats:
    """Return the least of all rows and entities, (..., n, m - 1) to (...), NaN where all are NaN.

    Laid out in one piece, they are gone through several times faster than by two axes.
    """
    return np.asarray(np.fmin.reduce(values.reshape(*values.shape[:-2], -1), axis=-1, initial=np.nan))


def touching(traces: Traces) -> Booleans:
    """Return in which rows the ego vehicle's box overlaps another one, (..., n)."""
    apart, (outer, _) = traces.centre_distance, _circles(traces)
    near = apart <= outer
    if not near.any():
        return np.zeros(apart.shape[:-1], dtype=bool)
    overlap = _overlap(*_boxes_at(traces, near))
    touched = np.zeros(apart.shape[:-1], dtype=bool)
    touched[tuple(place[overlap] for place in np.nonzero(near)[:-1])] = True
    return touched


def _circles(traces: Traces) -> tuple[Floats, Floats]:
    """Return the sums of the ego vehicle's and each other box's half diagonals and smaller half sides, m, (m - 1,)."""
    outer = 0.5 * np.hypot(traces.length, traces.width) + ROUNDING
    inner = 0.5 * np.minimum(traces.length, traces.width) - ROUNDING
    return outer[0] + outer[1:], inner[0] + inner[1:]


_Box = tuple[Floats, Floats]
"""x and y of the four corners in turn of k boxes, each (4, k)."""


def _boxes_at(traces: Traces, where: Booleans) -> tuple[_Box, _Box]:
    """Return the ego vehicle's box and the other one for the k true places of `where`."""
    at = np.nonzero(where)
    rows, other = at[:-1], at[-1] + 1
    return _box_at(traces, rows, np.zeros_like(other)), _box_at(traces, rows, other)


def _box_at(traces: Traces, rows: tuple[Integers, ...], entity: Integers) -> _Box:
    place = (*rows, entity)
    x, y = traces.x[place], traces.y[place]
    c, s = (each[place] for each in traces.forward)
    along, across = (each[:, entity] for each in _corner_offsets(traces, (1,)))
    return x + along * c - across * s, y + along * s + across * c


def _to_edges(points: _Box, box: _Box) -> Floats:
    """Return the least distance from any of the 4 points to any of the 4 edges of the box, (k,)."""
    begin_x, begin_y = box
    edge_x, edge_y = (np.roll(each, -1, axis=0) - each for each in box)
    to_x, to_y = points[0][:, None] - begin_x, points[1][:, None] - begin_y
    square = np.maximum(edge_x * edge_x + edge_y * edge_y, 1e-12)
    share = np.clip((to_x * edge_x + to_y * edge_y) / square, 0.0, 1.0)
    gap_x, gap_y = to_x - share * edge_x, to_y - share * edge_y
    return np.asarray(np.sqrt((gap_x * gap_x + gap_y * gap_y).min(axis=(0, 1))))


def _overlap(a: _Box, b: _Box) -> Booleans:
    """Return where two boxes overlap, by the separating axes of both, (k,)."""
    apart = np.zeros(a[0].shape[1:], dtype=bool)
    for x, y in (a, b):
        for edge in (0, 1):
            axis_x, axis_y = x[edge + 1] - x[edge], y[edge + 1] - y[edge]
            on_a, on_b = (each[0] * axis_x + each[1] * axis_y for each in (a, b))
            apart |= (on_a.max(axis=0) < on_b.min(axis=0)) | (on_b.max(axis=0) < on_a.min(axis=0))
    return ~apart


def _wrapped(angle: Floats) -> Floats:
    """Return angles in [-pi, pi)."""
    return np.mod(angle + np.pi, 2 * np.pi) - np.pi
