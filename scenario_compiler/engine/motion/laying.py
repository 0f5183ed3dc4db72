"""The geometry of a trajectory when its action begins: vertices with headings, distances, times and speeds.

A polyline has its own vertices. Clothoids are sampled at equal distances, from which `tracks` integrates. A NURBS is
sampled at equal parameters; each sample is a weighted sum of control points.
"""

from __future__ import annotations

from math import atan2

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import fault
from scenario_compiler.engine.columns.numbers import angle_between, bearing, clip, length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.positions import PLACE_NONE, place_of, point_of, position_is_number
from scenario_compiler.engine.motion.spirals import spiral_step
from scenario_compiler.engine.motion.tracks import beside_track, track_pose
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def point_beside_track(p: Program, st: State, k: int) -> tuple[float, float, float]:
    """Return (x, y, heading) of a position along a trajectory whose vertices are computed."""
    base = p.position_const[k]
    x, y, h, along = track_pose(p, st, p.position_lane[k], p.const[base + slot.P_S], 0)
    x, y = beside_track(x, y, along, 0.0, p.const[base + slot.P_OFFSET])
    turn = p.const[base + slot.P_TURN]
    return x, y, turn if p.position_flags[k] & op.POSITION_ABSOLUTE != 0 else h + turn


@compiled
def corner_place(n: RoadTables, p: Program, st: State, c: int, i: int) -> tuple[float, float, float, float]:
    """Return (x, y, z, heading) of a corner for entity i, with z as given or on the road; a fault if there is none."""
    k = p.corner_position[c]
    if p.position_op[k] == op.POSITION_ON_TRAJECTORY:
        if position_is_number(p, k) == 0:
            fault(st, op.FAULT_OFF_ROAD_START, i)
        x, y, h = point_beside_track(p, st, k)
        return x, y, 0.0, h
    kind, _, _, _, _, x, y, z, h = place_of(n, p, st, k, i)
    if kind == PLACE_NONE:
        fault(st, op.FAULT_OFF_ROAD_START, i)
    if p.position_op[k] in (op.POSITION_FREE, op.POSITION_RELATIVE_OBJECT, op.POSITION_RELATIVE_WORLD):
        _, _, given, _, with_height = point_of(p, st, k)
        if with_height == 1:
            z = given
    return x, y, z, h


@compiled
def lay_polyline(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place the vertices of a polyline."""
    v = p.track_vertex[track]
    for c in range(p.track_corner[track], p.track_corner[track + 1]):
        x, y, z, h = corner_place(n, p, st, c, i)
        st.track_x[v] = x
        st.track_y[v] = y
        st.track_z[v] = z
        st.track_h[v] = h
        st.track_time[v] = p.const[p.corner_const[c] + slot.T_TIME]
        v = v + 1


@compiled
def lay_clothoids(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place the samples of clothoids: the beginning of each piece, samples inside it, and the end of the last piece.

    A first piece without a position begins at the entity's pose.
    """
    v = p.track_vertex[track]
    x = 0.0
    y = 0.0
    h = 0.0
    if i >= 0:
        x = st.x[i]
        y = st.y[i]
        h = st.h[i]
    last = p.track_corner[track + 1] - 1
    for c in range(p.track_corner[track], last + 1):
        base = p.corner_const[c]
        if p.corner_position[c] >= 0:
            x, y, _, h = corner_place(n, p, st, c, i)
        h = h + p.const[base + slot.T_TURN]
        count = p.corner_samples[c]
        length = p.const[base + slot.T_LENGTH] / max(count, 1)
        bend = p.const[base + slot.T_CURVATURE]
        rate = 0.0
        if p.const[base + slot.T_LENGTH] > op.TOLERANCE:
            rate = (p.const[base + slot.T_CURVATURE_END] - bend) / p.const[base + slot.T_LENGTH]
        begin = p.const[base + slot.T_TIME]
        end = begin
        if c < last and begin >= 0.0:
            end = p.const[p.corner_const[c + 1] + slot.T_TIME]
        for q in range(max(count, 1)):
            st.track_x[v] = x
            st.track_y[v] = y
            st.track_h[v] = h
            st.track_bend[v] = bend
            st.track_bend_rate[v] = rate
            st.track_time[v] = begin + (end - begin) * q / max(count, 1)
            dx, dy, turned = spiral_step(h, bend, rate, length)
            x = x + dx
            y = y + dy
            h = h + turned
            bend = bend + rate * length
            v = v + 1


@compiled
def time_of_sample(p: Program, track: int, place: float) -> float:
    """Return the time at a fractional index of a NURBS' control points, from 0; negative if no times are given."""
    first = p.track_corner[track]
    last = p.track_corner[track + 1] - 1
    c = first + int(clip(place, 0.0, 1.0e6))
    if c >= last:
        return p.const[p.corner_const[last] + slot.T_TIME]
    begin = p.const[p.corner_const[c] + slot.T_TIME]
    return begin + (place - (c - first)) * (p.const[p.corner_const[c + 1] + slot.T_TIME] - begin)


@compiled
def lay_nurbs(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Place the samples of a NURBS: weighted sums of its control points and of their headings, if they have any."""
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1]
    order = p.track_order[track]
    sample = p.track_sample[track] - first
    corner = p.track_corner[track]
    base_h = 0.0
    for v in range(first, last):
        st.track_x[v] = 0.0
        st.track_y[v] = 0.0
        st.track_z[v] = 0.0
        st.track_h[v] = 0.0
        st.track_time[v] = time_of_sample(p, track, p.const[p.sample_const[sample + v] + order])
    for c in range(corner, p.track_corner[track + 1]):
        x, y, z, h = corner_place(n, p, st, c, i)
        if c == corner:
            base_h = h
        for v in range(first, last):
            q = c - corner - p.sample_corner[sample + v]
            if q >= 0 and q < order:
                weight = p.const[p.sample_const[sample + v] + q]
                st.track_x[v] += weight * x
                st.track_y[v] += weight * y
                st.track_z[v] += weight * z
                st.track_h[v] += weight * angle_between(h, base_h)
    for v in range(first, last):
        st.track_h[v] += base_h


@compiled
def measure_track(p: Program, st: State, track: int) -> None:
    """Write the distance of each vertex from the trajectory's beginning, m."""
    first = p.track_vertex[track]
    kind = p.track_kind[track]
    along = 0.0
    st.track_s[first] = 0.0
    for c in range(p.track_corner[track], p.track_corner[track + 1]):
        if kind == op.TRACK_CLOTHOIDS:
            count = p.corner_samples[c]
            for _ in range(count):
                first = first + 1
                along = along + p.const[p.corner_const[c] + slot.T_LENGTH] / max(count, 1)
                st.track_s[first] = along
    if kind != op.TRACK_CLOTHOIDS:
        for v in range(first + 1, p.track_vertex[track + 1]):
            along = along + length_of(st.track_x[v] - st.track_x[v - 1], st.track_y[v] - st.track_y[v - 1])
            st.track_s[v] = along


@compiled
def line_heading(p: Program, st: State, track: int, v: int) -> float:
    """Return the direction of the line after a vertex; at the end, or if it has no length, of the line before."""
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    while v > first and (v == last or st.track_s[v + 1] - st.track_s[v] <= op.TOLERANCE):
        v = v - 1
    if v == last:
        return st.track_h[v]
    return bearing(st.track_x[v + 1] - st.track_x[v], st.track_y[v + 1] - st.track_y[v])


@compiled
def head_vertices(p: Program, st: State, track: int) -> None:
    """Give each vertex without a heading of its own that of the line after it; for a NURBS, that of the curve."""
    if p.track_kind[track] == op.TRACK_CLOTHOIDS:
        return
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    for v in range(first, last + 1):
        if p.vertex_heading[v] == 1:
            continue
        h = line_heading(p, st, track, v)
        if p.track_kind[track] == op.TRACK_NURBS and v > first and v < last:
            before = line_heading(p, st, track, v - 1)
            h = before + 0.5 * angle_between(h, before)
        st.track_h[v] = h


@compiled
def pitch_vertices(p: Program, st: State, track: int) -> None:
    """Give each vertex the pitch of the line after it, the last one that of the line before it; uphill is negative."""
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    for v in range(first, last + 1):
        st.track_pitch[v] = 0.0
        if p.track_raised[track] == 1 and v < last:
            st.track_pitch[v] = -atan2(
                st.track_z[v + 1] - st.track_z[v], max(st.track_s[v + 1] - st.track_s[v], op.TOLERANCE)
            )
    if last > first:
        st.track_pitch[last] = st.track_pitch[last - 1]


@compiled
def pace_vertices(p: Program, st: State, track: int, speed: float, smooth: int) -> None:
    """Give the vertices of a polyline the speeds and accelerations that keep its times.

    With `smooth` 1, an entity accelerates uniformly from vertex to vertex, starting with its own speed; it may arrive
    too early if it would otherwise have to reverse. Two vertices of the same time are passed with the speed before
    them. Without `smooth`, the speed is constant between two vertices.
    """
    first = p.track_vertex[track]
    for v in range(first, p.track_vertex[track + 1]):
        st.track_v[v] = speed
        st.track_a[v] = 0.0
        if v == p.track_vertex[track + 1] - 1:
            return
        ds = st.track_s[v + 1] - st.track_s[v]
        span = st.track_time[v + 1] - st.track_time[v]
        mean = ds / span if span > op.TOLERANCE else 0.0
        if smooth == 0:
            st.track_v[v] = mean
        elif span <= op.TOLERANCE:
            continue
        elif ds <= op.TOLERANCE:
            speed = 0.0
        elif 2.0 * mean < speed:
            st.track_a[v] = -0.5 * speed * speed / ds
            speed = 0.0
        else:
            st.track_a[v] = 2.0 * (mean - speed) / span
            speed = 2.0 * mean - speed


@compiled
def lay_alone(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Compute a trajectory's vertices; those of the trajectories on which some of them lie are computed."""
    kind = p.track_kind[track]
    if kind == op.TRACK_CLOTHOIDS:
        lay_clothoids(n, p, st, track, i)
    elif kind == op.TRACK_NURBS:
        lay_nurbs(n, p, st, track, i)
    else:
        lay_polyline(n, p, st, track, i)
    measure_track(p, st, track)
    head_vertices(p, st, track)
    pitch_vertices(p, st, track)


@compiled
def lay_track(n: RoadTables, p: Program, st: State, track: int, i: int) -> None:
    """Compute a trajectory's vertices for entity i, or for no particular entity (NONE)."""
    for inner in range(p.track_inner[track], track + 1):
        lay_alone(n, p, st, inner, i)
