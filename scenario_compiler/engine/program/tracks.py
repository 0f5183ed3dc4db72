"""Trajectories: their tables of corners and samples."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import ceil, dist

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.rows import Slot
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.vocabulary.positions import (
    Clothoid,
    ClothoidSpline,
    FreePosition,
    LanePositionWord,
    Nurbs,
    Polyline,
    Trajectory,
)
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import Number, Word, number_value

Place = Callable[[ProgramBuilder, Word], int]
"""Function that appends a corner's position and returns its row."""

SAMPLE_LENGTH = 4.0
MOST_SAMPLES = 2000
"""Distance between two samples of a clothoid, m, and their greatest number."""

SPAN_SAMPLES = 64
TIMED_SPAN_SAMPLES = 256
"""Number of samples of a NURBS between two knots: without times, and with times if its points are known only in a run.
"""

TIMED_STEP = 1.0
"""A NURBS with times is a polyline with one piece more than the length of its control polygon has such steps, m (esmini
3.6).
"""


def add_track(draft: ProgramBuilder, trajectory: Trajectory, place: Place) -> int:
    """Append a trajectory after those on which its own positions lie; return its row."""
    p, shape = draft.program, trajectory.shape
    first = len(p.track_kind)
    if isinstance(shape, Polyline):
        kind = op.TRACK_POLYLINE
        _add_polyline(draft, shape, trajectory.closed, place)
    elif isinstance(shape, Nurbs):
        kind = op.TRACK_NURBS
        _add_nurbs(draft, shape, place)
    else:
        kind = op.TRACK_CLOTHOIDS
        _add_clothoids(draft, shape, place)
    p.track_kind.append(kind)
    p.track_closed.append(1 if trajectory.closed else 0)
    p.track_inner.append(first)
    p.track_raised.append(1 if raised(trajectory) else 0)
    p.track_order.append(shape.order if isinstance(shape, Nurbs) else 0)
    p.track_corner.append(len(p.corner_position))
    p.track_vertex.append(len(p.vertex_heading))
    p.track_sample.append(len(p.sample_corner))
    p.vertex_count[0] = len(p.vertex_heading)
    return len(p.track_kind) - 1


def raised(trajectory: Trajectory) -> bool:
    """Return whether a position of a trajectory has a height."""
    shape = trajectory.shape
    if isinstance(shape, Clothoid | ClothoidSpline):
        return False
    places = [one.position for one in (shape.points if isinstance(shape, Nurbs) else shape.vertices)]
    return any(getattr(one, "z", None) is not None or getattr(one, "dz", 0.0) != 0.0 for one in places)


def _add_corner(draft: ProgramBuilder, position: int, *numbers: Slot, samples: int = 1) -> None:
    p = draft.program
    p.corner_position.append(position)
    p.corner_const.append(draft.block(*numbers))
    p.corner_samples.append(samples)


def _time(time: Number | None) -> Slot:
    return -1.0 if time is None else time


def _add_polyline(draft: ProgramBuilder, line: Polyline, closed: bool, place: Place) -> None:
    """Append a polyline; a closed one without times returns to its first vertex."""
    vertices = list(line.vertices)
    if closed and vertices[0].time is None and vertices[0] != vertices[-1]:
        vertices.append(vertices[0])
    given = headed([vertex.position for vertex in vertices])
    places = [place(draft, vertex.position) for vertex in vertices]
    for vertex, position, heading in zip(vertices, places, given, strict=True):
        _add_corner(draft, position, _time(vertex.time))
        draft.program.vertex_heading.append(1 if heading else 0)


def headed(positions: Sequence[Word]) -> list[bool]:
    """Return for each position whether its heading is given, absolute or relative.

    If no position has a relative heading other than 0, headings that could be relative are left to the trajectory.
    """
    turned = any(getattr(one, "turn", 0.0) != 0.0 for one in positions)
    return [getattr(one, "heading", None) is not None or (turned and hasattr(one, "turn")) for one in positions]


def _add_clothoids(draft: ProgramBuilder, shape: Clothoid | ClothoidSpline, place: Place) -> None:
    """Append clothoids, and the end of the last one as a piece without length."""
    values = parameter_values(draft.plan.parameters)
    if isinstance(shape, Clothoid):
        rate, length = (number_value(one, values) for one in (shape.curvature_rate, shape.length))
        end = number_value(shape.curvature, values) + rate * length
        pieces: list[tuple[Word | None, tuple[Slot, ...]]] = [
            (shape.position, (_time(shape.start_time), shape.curvature, end, shape.length, 0.0))
        ]
        last = shape.stop_time
    else:
        pieces = [
            (
                one.position,
                (_time(one.time_start), one.curvature_start, one.curvature_end, one.length, one.turn_at_start),
            )
            for one in shape.segments
        ]
        last = shape.time_end
    places = [op.NONE if position is None else place(draft, position) for position, _ in pieces]
    for position, (_, numbers) in zip(places, pieces, strict=True):
        length = number_value(numbers[3], values)
        samples = min(max(ceil(length / SAMPLE_LENGTH), 1), MOST_SAMPLES)
        _add_corner(draft, position, *numbers, samples=samples)
        draft.program.vertex_heading.extend([1] * samples)
    _add_corner(draft, op.NONE, _time(last), 0.0, 0.0, 0.0, 0.0, samples=0)
    draft.program.vertex_heading.append(1)


def _add_nurbs(draft: ProgramBuilder, curve: Nurbs, place: Place) -> None:
    values = parameter_values(draft.plan.parameters)
    weights = [number_value(point.weight, values) for point in curve.points]
    corners = [place(draft, point.position) for point in curve.points]
    for point, position in zip(curve.points, corners, strict=True):
        _add_corner(draft, position, _time(point.time))
    samples = _parameters(curve, None if curve.points[0].time is None else _control_length(draft, curve))
    shares = [basis(curve.knots, curve.order, at, u) for at, u in samples]
    given = all(headed([point.position for point in curve.points]))
    places = _places_between(curve, samples, shares)
    for (at, _), share, between in zip(samples, shares, places, strict=True):
        first = at - curve.order + 1
        weighted = [one * weights[first + q] for q, one in enumerate(share)]
        total = sum(weighted) or 1.0
        draft.program.sample_corner.append(first)
        draft.program.sample_const.append(draft.block(*(one / total for one in weighted), between))
        draft.program.vertex_heading.append(1 if given else 0)


def _parameters(curve: Nurbs, length: float | None) -> list[tuple[int, float]]:
    """Return the samples of a NURBS: the knot span of each, and its parameter.

    `length` is that of the control polygon of a NURBS with times, m; None without times, and if it is not known.
    """
    spans = [
        (at, low, high)
        for at, (low, high) in enumerate(zip(curve.knots, curve.knots[1:], strict=False))
        if high > low and curve.order - 1 <= at < len(curve.points)
    ]
    if length is None:
        count = SPAN_SAMPLES if curve.points[0].time is None else TIMED_SPAN_SAMPLES
        samples = [(at, low + (high - low) * q / count) for at, low, high in spans for q in range(count)]
        return samples + [(at, high) for at, _, high in spans[-1:]]
    begin, end = spans[0][1], spans[-1][2]
    pieces = min(1 + int(length / TIMED_STEP), MOST_SAMPLES)
    samples = []
    for q in range(pieces + 1):
        u = begin + (end - begin) * q / pieces
        samples.append((next((at for at, _, high in spans if u < high), spans[-1][0]), min(u, end)))
    return samples


def _control_length(draft: ProgramBuilder, curve: Nurbs) -> float | None:
    """Return the length of the control polygon, m; None if it is known only in a run."""
    points = [_known_point(draft, one.position) for one in curve.points]
    known = [one for one in points if one is not None]
    return sum(dist(one, other) for one, other in pairwise(known)) if len(known) == len(points) else None


def _known_point(draft: ProgramBuilder, position: Word) -> tuple[float, float] | None:
    """Return (x, y) of a position with the default values of the parameters; None for one relative to an entity."""
    values = parameter_values(draft.plan.parameters)
    if isinstance(position, FreePosition):
        return number_value(position.x, values), number_value(position.y, values)
    if not isinstance(position, LanePositionWord):
        return None
    s, offset = number_value(position.s, values), number_value(position.offset, values)
    pose = draft.network.lane_pose(position.road, position.lane, s, offset)
    return pose.x, pose.y


def _places_between(curve: Nurbs, samples: list[tuple[int, float]], shares: list[list[float]]) -> list[float]:
    """Return the fractional index of each sample among the control points, from 0.

    A control point belongs to the sample in which its weight is greatest; between two of these samples the index grows
    linearly with the parameter (esmini 3.6).
    """
    most = [0.0] * len(curve.points)
    peaks = [samples[0][1]] * len(curve.points)
    for (at, u), share in zip(samples, shares, strict=True):
        for q, one in enumerate(share):
            if one > most[at - curve.order + 1 + q]:
                most[at - curve.order + 1 + q] = one
                peaks[at - curve.order + 1 + q] = u
    places = []
    c = 0
    for _, u in samples:
        while c < len(peaks) - 2 and u >= peaks[c + 1]:
            c += 1
        room = peaks[c + 1] - peaks[c]
        places.append(c + (min(max((u - peaks[c]) / room, 0.0), 1.0) if room > 0.0 else 0.0))
    return places


def basis(knots: tuple[float, ...], order: int, span: int, u: float) -> list[float]:
    """Return the values of the B-splines that are not 0 in a knot span (Piegl and Tiller 1997, algorithm A2.2)."""
    values = [1.0]
    for degree in range(1, order):
        saved = 0.0
        following = []
        for r in range(degree):
            right = knots[span + r + 1] - u
            left = u - knots[span + 1 - degree + r]
            share = values[r] / (right + left) if right + left else 0.0
            following.append(saved + right * share)
            saved = left * share
        values = [*following, saved]
    return values
