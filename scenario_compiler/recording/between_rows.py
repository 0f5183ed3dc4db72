"""By how much the time between two rows in which boxes overlap is too long, as in `engine.measures.between_rows`."""

from __future__ import annotations

import numpy as np

from scenario_compiler.engine.measures.between_rows import STILL
from scenario_compiler.recording.recording import Booleans, Floats

LEAST_LEAN = 1.0e-9
"""As in `engine.columns.numbers.ratio`."""

Interval = tuple[Floats, Floats, Floats]
"""The middle at a sum of 0, what it gains with the sum, and half the length, each (k,)."""

Extent = tuple[Floats, Floats]
"""Half the lengths and half the widths of k boxes, m."""


def rows_too_many(poses: Floats, there: tuple[Booleans, Booleans], first: Extent, second: Extent) -> Floats:
    """Return by how many rows the times from k earlier boxes to k later ones are too long, 0 to 2, (k,).

    Args:
        poses: x, y, and cosine and sine of the heading of the earlier boxes, of the same entities in the next rows, of
            the other entities in the rows before the later boxes, and of the later boxes, (4, 4, k).
        there: Whether the entities are present in those next rows, and in those rows before.
        first: The extents of the earlier boxes.
        second: The extents of the later boxes.
    """
    then, after, before, now = poses
    of_first, of_second = np.where(there[0], after - then, 0.0), np.where(there[1], now - before, 0.0)
    stays, came = (np.where(each, 0.5, 0.0) for each in there)
    zero: Floats = np.zeros(len(stays))
    part, most = zero, zero
    for _ in range(2):
        ci, si = then[2:] + part * of_first[2:]
        cj, sj = now[2:] - (most - part) * of_second[2:]
        c, s = np.abs(ci * cj + si * sj), np.abs(ci * sj - si * cj)
        intervals: list[Interval] = [(stays, zero, stays), (-came, zero + 1.0, came)]
        for cos, sin, (long, wide), (length, width) in ((ci, si, first, second), (cj, sj, second, first)):
            ways = [(x * cos + y * sin, y * cos - x * sin) for x, y in ((now - then)[:2], of_first[:2], of_second[:2])]
            reaches = long + length * c + width * s, wide + length * s + width * c
            intervals += [_on_axis(*axis) for axis in zip(reaches, *ways, strict=True)]
        most = _greatest_sum(intervals)
        part = np.clip(_least_part(intervals, most), 0.0, most)
    return most


def _on_axis(reach: Floats, apart: Floats, first: Floats, second: Floats) -> Interval:
    way = np.where(first < second, -1.0, 1.0)
    closing = np.maximum(way * (first - second), STILL)
    return way * apart / closing, -way * second / closing, reach / closing


def _greatest_sum(intervals: list[Interval]) -> Floats:
    middle, lean, half = (np.array(each) for each in zip(*intervals, strict=True))
    a, b = np.tril_indices(len(intervals), -1)
    more = lean[a] - lean[b]
    room = half[a] + half[b] - np.where(more < 0.0, -1.0, 1.0) * (middle[a] - middle[b])
    slope = np.abs(more)
    limits = np.where(slope > LEAST_LEAN, room / np.maximum(slope, LEAST_LEAN), 2.0)
    return np.asarray(np.clip(limits.min(axis=0), 0.0, 2.0))


def _least_part(intervals: list[Interval], most: Floats) -> Floats:
    starts = [middle + lean * most - half for middle, lean, half in intervals]
    return np.asarray(np.clip(np.max(starts, axis=0), 0.0, 1.0))
