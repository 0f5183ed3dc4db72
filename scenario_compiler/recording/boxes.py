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


def along_path(traces: Traces) -> tuple[Floats, Floats, Floats]:
    """Return the other entities' boxes as seen along the circle that the ego vehicle is driving on.

    Returns:
        (along, across, speed): for each box's corners the distance along the circle from the ego's reference point and
        the distance to the left of it, m, (..., n, m - 1, 4); and each entity's speed along the circle, m/s,
        (..., n, m - 1).
    """
    x, y = (np.moveaxis(each, -1, 0)[..., 1:] for each in corners(traces))
    c, s = (each[..., :1] for each in traces.forward)
    dx, dy = x - traces.x[..., :1], y - traces.y[..., :1]
    ahead, left = c * dx + s * dy, c * dy - s * dx
    curvature = path_curvature(traces)[..., None]
    bent = np.abs(curvature) > STRAIGHT
    along, across = ahead.copy(), left.copy()
    rows = np.nonzero(np.broadcast_to(bent, left.shape[1:]))
    if len(rows[0]):
        turned = np.broadcast_to(curvature, left.shape[1:])[rows]
        side, radius = np.where(turned < 0, -1.0, 1.0), 1.0 / np.abs(turned)
        for k in range(len(ahead)):
            forward, inward = ahead[k][rows], radius - side * left[k][rows]
            along[k][rows] = np.arctan2(forward, inward) * radius
            across[k][rows] = side * (radius - np.hypot(forward, inward))
    tangent = traces.h[..., :1] + curvature * along.mean(axis=0)
    speed = traces.v[..., 1:] * np.cos(traces.h[..., 1:] - tangent)
    return np.moveaxis(along, 0, -1), np.moveaxis(across, 0, -1), speed


def least_box_distance(traces: Traces) -> Floats:
    """Return the least distance in the plane from the ego vehicle's box to another one over the run, m, (...).

    0 where boxes overlap, NaN without another entity. Only rows whose boxes can be the nearest are looked at: a box
    lies between the circles of its half diagonal and of its smaller half side.
    """
    apart, (outer, inner) = traces.centre_distance, _circles(traces)
    nearest = np.fmin.reduce(apart - inner, axis=(-1, -2), initial=np.inf)
    near = apart - outer <= np.maximum(nearest, 0.0)[..., None, None]
    distance = np.full(apart.shape, np.nan)
    ego, other = _boxes_at(traces, near)
    gap = np.fmin(_to_edges(ego, other), _to_edges(other, ego))
    distance[near] = np.where(_overlap(ego, other), 0.0, gap)
    return np.asarray(np.fmin.reduce(distance, axis=(-1, -2), initial=np.nan))


def touching(traces: Traces) -> Booleans:
    """Return in which rows the ego vehicle's box overlaps another one, (..., n)."""
    apart, (outer, _) = traces.centre_distance, _circles(traces)
    near = apart <= outer
    overlap = np.zeros(apart.shape, dtype=bool)
    overlap[near] = _overlap(*_boxes_at(traces, near))
    return np.asarray(overlap.any(axis=-1))


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
