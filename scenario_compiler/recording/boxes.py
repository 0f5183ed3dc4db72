"""Distances between the entities' boxes, over whole runs at once."""

from __future__ import annotations

import numpy as np

from scenario_compiler.recording.recording import Floats
from scenario_compiler.recording.traces import Traces

STRAIGHT = 1e-6
"""Curvature below which a path counts as straight, 1/m."""

STILL = 0.5
"""Speed below which a vehicle's curvature is not measured, m/s."""


def corners(traces: Traces) -> tuple[Floats, Floats]:
    """Return x and y of the boxes' four corners in turn, (..., n, m, 4)."""
    along = traces.center[:, None] + 0.5 * traces.length[:, None] * np.array([1.0, -1.0, -1.0, 1.0])
    across = 0.5 * traces.width[:, None] * np.array([1.0, 1.0, -1.0, -1.0])
    c, s = np.cos(traces.h)[..., None], np.sin(traces.h)[..., None]
    return traces.x[..., None] + along * c - across * s, traces.y[..., None] + along * s + across * c


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
    """Return the boxes as seen along the circle that the ego vehicle is driving on.

    Returns:
        (along, across, speed): for each box's corners the distance along the circle from the ego's reference point and
        the distance to the left of it, m, (..., n, m, 4); and each entity's speed along the circle, m/s, (..., n, m).
    """
    x, y = corners(traces)
    h = traces.h[..., :1, None]
    dx, dy = x - traces.x[..., :1, None], y - traces.y[..., :1, None]
    ahead, left = np.cos(h) * dx + np.sin(h) * dy, np.cos(h) * dy - np.sin(h) * dx
    curvature = path_curvature(traces)[..., None, None]
    bent = np.abs(curvature) > STRAIGHT
    side = np.where(curvature < 0, -1.0, 1.0)
    radius = 1.0 / np.where(bent, np.abs(curvature), 1.0)
    angle = np.arctan2(ahead, radius - side * left)
    along = np.where(bent, angle * radius, ahead)
    across = np.where(bent, side * (radius - np.hypot(ahead, radius - side * left)), left)
    tangent = traces.h[..., :1] + curvature[..., 0] * along.mean(axis=-1)
    return along, across, traces.v * np.cos(traces.h - tangent)


def box_distance(traces: Traces) -> Floats:
    """Return the distance in the plane from the ego vehicle's box to each other one, m, 0 where they overlap.

    Shape (..., n, m - 1); NaN where the entity is absent.
    """
    x, y = corners(traces)
    both = np.stack([x, y], axis=-1)
    ego, others = both[..., :1, :, :], both[..., 1:, :, :]
    ego = np.broadcast_to(ego, others.shape)
    apart = np.fmin(_to_edges(ego, others), _to_edges(others, ego))
    present = traces.present[..., 1:]
    overlap = _overlap(ego, others) & present
    return np.where(overlap, 0.0, np.where(present, apart, np.nan))


def _to_edges(points: Floats, boxes: Floats) -> Floats:
    """Return the least distance from any of the 4 points to any of the 4 edges of the box."""
    begin = boxes[..., None, :, :]
    edge = np.roll(boxes, -1, axis=-2)[..., None, :, :] - begin
    to = points[..., :, None, :] - begin
    share = np.clip((to * edge).sum(-1) / np.maximum((edge * edge).sum(-1), 1e-12), 0.0, 1.0)
    gap = to - share[..., None] * edge
    return np.asarray(np.sqrt((gap * gap).sum(-1)).min(axis=(-1, -2)))


def _overlap(a: Floats, b: Floats) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Return where two boxes overlap, by the separating axes of both."""
    apart = np.zeros(a.shape[:-2], dtype=bool)
    for box in (a, b):
        for edge in (0, 1):
            axis = box[..., edge + 1, :] - box[..., edge, :]
            on_a, on_b = (a * axis[..., None, :]).sum(-1), (b * axis[..., None, :]).sum(-1)
            apart |= (on_a.max(-1) < on_b.min(-1)) | (on_b.max(-1) < on_a.min(-1))
    return ~apart


def _wrapped(angle: Floats) -> Floats:
    """Return angles in [-pi, pi)."""
    return np.mod(angle + np.pi, 2 * np.pi) - np.pi
