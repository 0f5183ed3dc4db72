"""Trajectories as chains of vertices: where they lie when an action begins, and the pose at a distance or a time.

A polyline's vertices are its own. Clothoids are sampled at even distances, each piece integrated with three Gauss
points; a NURBS at even parameters, each sample a weighted sum of control points. Between two vertices the chain is
straight; its heading is that of esmini 3.6: turned evenly from one vertex to the next, or, where a polyline's vertices
give none and positions are followed, turned near the corners alone.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.numbers import angle_between, bearing, clip, length_of
from scenario_compiler.engine.opcodes import (
    FAULT_OFF_ROAD_START,
    TOLERANCE,
    TRACK_CLOTHOIDS,
    TRACK_NURBS,
)
from scenario_compiler.engine.positions import PLACE_NONE, place_of
from scenario_compiler.engine.slots import T_CURVATURE, T_CURVATURE_END, T_LENGTH, T_TIME, T_TURN
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

CORNER = 4.0
"""Distance before and behind a corner over which the heading turns, m (esmini 3.6)."""

GAUSS_SIDE = 0.1127016653792583
GAUSS_SIDE_WEIGHT = 0.2777777777777778
GAUSS_MIDDLE_WEIGHT = 0.4444444444444444
"""Nodes (this, 1/2, 1 - this) and weights of the three-point Gauss rule on 0 to 1."""


@compiled
def spiral_step(h: float, bend: float, rate: float, length: float) -> tuple[float, float, float]:
    """Return (dx, dy, change of heading) over a short piece of a clothoid of a heading, curvature and its rate."""
    x = 0.0
    y = 0.0
    for node in range(3):
        share = 0.5
        weight = GAUSS_MIDDLE_WEIGHT
        if node == 0:
            share = GAUSS_SIDE
            weight = GAUSS_SIDE_WEIGHT
        if node == 2:
            share = 1.0 - GAUSS_SIDE
            weight = GAUSS_SIDE_WEIGHT
        at = share * length
        turned = h + bend * at + 0.5 * rate * at * at
        x = x + weight * length * cos(turned)
        y = y + weight * length * sin(turned)
    return x, y, bend * length + 0.5 * rate * length * length


@compiled
def fill_polyline(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place the vertices of a polyline for entity i."""
    v = p.track_vertex[track]
    for c in range(p.track_corner[track], p.track_corner[track + 1]):
        kind, _, _, _, _, x, y, _, h = place_of(n, p, st, p.corner_position[c], i)
        if kind == PLACE_NONE:
            fault(st, FAULT_OFF_ROAD_START, i)
        st.track_x[v] = x
        st.track_y[v] = y
        st.track_h[v] = h
        st.track_time[v] = p.const[p.corner_const[c] + T_TIME]
        v = v + 1


@compiled
def fill_clothoids(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place the samples of clothoids for entity i: each piece's begin, samples inside it, and the last one's end."""
    v = p.track_vertex[track]
    x = 0.0
    y = 0.0
    h = 0.0
    for c in range(p.track_corner[track], p.track_corner[track + 1]):
        base = p.corner_const[c]
        if p.corner_position[c] >= 0:
            kind, _, _, _, _, x, y, _, h = place_of(n, p, st, p.corner_position[c], i)
            if kind == PLACE_NONE:
                fault(st, FAULT_OFF_ROAD_START, i)
        h = h + p.const[base + T_TURN]
        count = p.corner_samples[c]
        length = p.const[base + T_LENGTH] / count if count > 0 else 0.0
        bend = p.const[base + T_CURVATURE]
        change = p.const[base + T_CURVATURE_END] - bend
        rate = change / p.const[base + T_LENGTH] if p.const[base + T_LENGTH] > TOLERANCE else 0.0
        begin = p.const[base + T_TIME]
        end = p.const[p.corner_const[c + 1] + T_TIME] if c + 1 < len(p.corner_const) else -1.0
        for q in range(count):
            st.track_x[v] = x
            st.track_y[v] = y
            st.track_h[v] = h
            st.track_time[v] = begin + (end - begin) * q / count if begin >= 0.0 and end >= 0.0 else begin
            dx, dy, turned = spiral_step(h, bend, rate, length)
            x = x + dx
            y = y + dy
            h = h + turned
            bend = bend + rate * length
            v = v + 1
        if count == 0:
            st.track_x[v] = x
            st.track_y[v] = y
            st.track_h[v] = h
            st.track_time[v] = begin
            v = v + 1


@compiled
def fill_nurbs(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place the samples of a NURBS for entity i: weighted sums of its control points, and of their times."""
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1]
    for v in range(first, last):
        st.track_x[v] = 0.0
        st.track_y[v] = 0.0
        st.track_time[v] = 0.0
    order = p.track_order[track]
    corner = p.track_corner[track]
    timed = 1 if p.const[p.corner_const[corner] + T_TIME] >= 0.0 else 0
    for c in range(corner, p.track_corner[track + 1]):
        kind, _, _, _, _, x, y, _, _ = place_of(n, p, st, p.corner_position[c], i)
        if kind == PLACE_NONE:
            fault(st, FAULT_OFF_ROAD_START, i)
        time = p.const[p.corner_const[c] + T_TIME]
        for v in range(first, last):
            q = c - corner - p.sample_corner[p.track_sample[track] + v - first]
            if q >= 0 and q < order:
                weight = p.const[p.sample_const[p.track_sample[track] + v - first] + q]
                st.track_x[v] += weight * x
                st.track_y[v] += weight * y
                st.track_time[v] += weight * time
    if timed == 0:
        for v in range(first, last):
            st.track_time[v] = -1.0


@compiled
def fill_track(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place a trajectory's vertices for entity i, with their headings and distances from its begin."""
    kind = p.track_kind[track]
    if kind == TRACK_CLOTHOIDS:
        fill_clothoids(n, p, st, track, i)
    elif kind == TRACK_NURBS:
        fill_nurbs(n, p, st, track, i)
    else:
        fill_polyline(n, p, st, track, i)
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1]
    along = 0.0
    for v in range(first, last):
        if v > first:
            along = along + length_of(st.track_x[v] - st.track_x[v - 1], st.track_y[v] - st.track_y[v - 1])
        st.track_s[v] = along
        given = 1 if kind == TRACK_CLOTHOIDS else p.vertex_heading[v]
        if given == 1:
            continue
        if v + 1 < last:
            dx = st.track_x[v + 1] - st.track_x[v]
            dy = st.track_y[v + 1] - st.track_y[v]
            if length_of(dx, dy) > TOLERANCE:
                st.track_h[v] = bearing(dx, dy)
            elif v > first:
                st.track_h[v] = st.track_h[v - 1]
        elif v > first:
            st.track_h[v] = st.track_h[v - 1]


@compiled
def track_length(p: Program, st: State, track: int) -> float:
    """Return the length of a trajectory, m."""
    return st.track_s[p.track_vertex[track + 1] - 1]


@compiled
def vertex_before(p: Program, st: State, track: int, s: float) -> int:
    """Return the vertex that a distance lies behind: never the last one, unless it is alone."""
    low = p.track_vertex[track]
    high = p.track_vertex[track + 1] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if st.track_s[middle] <= s:
            low = middle
        else:
            high = middle
    return low


@compiled
def distance_at_time(p: Program, st: State, track: int, time: float) -> float:
    """Return the distance along a trajectory at a time of its own."""
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    v = first
    while v < last - 1 and st.track_time[v + 1] <= time:
        v = v + 1
    if last == first:
        return 0.0
    span = st.track_time[v + 1] - st.track_time[v]
    share = clip((time - st.track_time[v]) / span, 0.0, 1.0) if span > TOLERANCE else 1.0
    return st.track_s[v] + share * (st.track_s[v + 1] - st.track_s[v])


@compiled
def corner_heading(p: Program, st: State, track: int, v: int, s: float) -> float:
    """Return the heading of a polyline that turns near its corners alone."""
    begin = st.track_s[v]
    end = st.track_s[v + 1]
    radius = min(CORNER, end - begin)
    h = st.track_h[v]
    if radius <= TOLERANCE:
        return h
    if s < begin + radius and v > p.track_vertex[track]:
        share = (radius + s - begin) / (2.0 * radius)
        return st.track_h[v - 1] + share * angle_between(h, st.track_h[v - 1])
    if s > end - radius and v + 2 < p.track_vertex[track + 1]:
        share = (s - end + radius) / (2.0 * radius)
        return h + share * angle_between(st.track_h[v + 1], h)
    return h


@compiled
def track_pose(p: Program, st: State, track: int, s: float, smooth: int) -> tuple[float, float, float]:
    """Return (x, y, heading) at a distance along a trajectory, beyond its ends straight on.

    `smooth` is 1 where the heading turns evenly between vertices, 0 where it turns near corners alone.
    """
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    if last == first:
        h = st.track_h[first]
        return st.track_x[first] + s * cos(h), st.track_y[first] + s * sin(h), h
    v = vertex_before(p, st, track, s)
    length = st.track_s[v + 1] - st.track_s[v]
    if s > st.track_s[last]:
        rest = s - st.track_s[last]
        h = st.track_h[last]
        return st.track_x[last] + rest * cos(h), st.track_y[last] + rest * sin(h), h
    share = clip((s - st.track_s[v]) / length, 0.0, 1.0) if length > TOLERANCE else 0.0
    x = st.track_x[v] + share * (st.track_x[v + 1] - st.track_x[v])
    y = st.track_y[v] + share * (st.track_y[v + 1] - st.track_y[v])
    given = 1 if p.track_kind[track] == TRACK_CLOTHOIDS else p.vertex_heading[v]
    if smooth == 0 and given == 0 and p.track_kind[track] != TRACK_NURBS:
        return x, y, corner_heading(p, st, track, v, clip(s, 0.0, st.track_s[last]))
    return x, y, st.track_h[v] + share * angle_between(st.track_h[v + 1], st.track_h[v])
