"""Poses on a trajectory at a distance or a time, and the trajectory that an entity follows.

A clothoid is integrated; other trajectories are straight between two vertices. The heading on a line is that of esmini
3.6: it changes only near the corners, or, if the vertices have headings and are followed smoothly, linearly from one
vertex to the next.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import angle_between, bearing, clip, length_of, ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.spirals import spiral_step
from scenario_compiler.marker import compiled

CORNER = 2.0
"""Distance before and after a corner over which the heading changes, m (esmini 3.6)."""


@compiled
def track_length(p: Program, st: State, track: int) -> float:
    """Return the length of a trajectory, m."""
    return st.track_s[p.track_vertex[track + 1] - 1]


@compiled
def track_is_timed(p: Program, st: State, track: int) -> int:
    """Return 1 if a trajectory's vertices have times."""
    first = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    return 1 if st.track_time[first] >= 0.0 and st.track_time[last] > st.track_time[first] else 0


@compiled
def vertex_before(p: Program, st: State, track: int, s: float) -> int:
    """Return the vertex before a distance, the first one if several are at the same distance; never the last vertex."""
    low = p.track_vertex[track]
    high = p.track_vertex[track + 1] - 1
    while high - low > 1:
        middle = (low + high) // 2
        if st.track_s[middle] < s - op.TOLERANCE:
            low = middle
        else:
            high = middle
    return low


@compiled
def distance_at_time(p: Program, st: State, track: int, time: float) -> float:
    """Return the distance along a trajectory at a time on its own time scale, m."""
    v = p.track_vertex[track]
    last = p.track_vertex[track + 1] - 1
    if time > st.track_time[last]:
        return st.track_s[last]
    while v < last - 1 and st.track_time[v + 1] < time:
        v = v + 1
    t = max(time - st.track_time[v], 0.0)
    if p.track_kind[track] == op.TRACK_POLYLINE:
        a = st.track_a[v]
        if a < 0.0:
            t = min(t, -st.track_v[v] / a)
        return st.track_s[v] + t * st.track_v[v] + 0.5 * a * t * t
    if last == v:
        return 0.0
    span = st.track_time[v + 1] - st.track_time[v]
    share = clip(t / span, 0.0, 1.0) if span > op.TOLERANCE else 1.0
    return st.track_s[v] + share * (st.track_s[v + 1] - st.track_s[v])


@compiled
def time_at_distance(p: Program, st: State, track: int, s: float) -> float:
    """Return the time at a distance along a trajectory, assuming constant speed between vertices, s."""
    v = vertex_before(p, st, track, s)
    if v == p.track_vertex[track + 1] - 1:
        return st.track_time[v]
    length = st.track_s[v + 1] - st.track_s[v]
    share = clip((s - st.track_s[v]) / length, 0.0, 1.0) if length > op.TOLERANCE else 0.0
    return st.track_time[v] + share * (st.track_time[v + 1] - st.track_time[v])


@compiled
def near_corner(p: Program, st: State, track: int, v: int, s: float) -> tuple[int, int, float]:
    """Return (vertex, vertex, share): near a corner of a polyline, angles change from one vertex's to the other's.

    `v` is the vertex before s.
    """
    begin = st.track_s[v]
    end = st.track_s[v + 1]
    radius = min(CORNER, 0.5 * (end - begin))
    if radius <= op.TOLERANCE:
        return v, v, 0.0
    if s < begin + radius and v > p.track_vertex[track]:
        return v - 1, v, (radius + s - begin) / (2.0 * radius)
    if s > end - radius:
        return v, v + 1, (s - end + radius) / (2.0 * radius)
    return v, v, 0.0


@compiled
def corner_heading(p: Program, st: State, track: int, v: int, s: float) -> float:
    """Return the heading after vertex v of a polyline whose heading changes only near its corners."""
    before, after, share = near_corner(p, st, track, v, s)
    h = st.track_h[before]
    return h + share * angle_between(st.track_h[after], h)


@compiled
def track_height(p: Program, st: State, track: int, s: float) -> tuple[float, float]:
    """Return (z, pitch) at a distance along a trajectory with heights; the pitch changes only near the corners."""
    last = p.track_vertex[track + 1] - 1
    if last == p.track_vertex[track]:
        return st.track_z[last], 0.0
    s = clip(s, 0.0, st.track_s[last])
    v = vertex_before(p, st, track, s)
    length = st.track_s[v + 1] - st.track_s[v]
    share = clip((s - st.track_s[v]) / length, 0.0, 1.0) if length > op.TOLERANCE else 0.0
    z = st.track_z[v] + share * (st.track_z[v + 1] - st.track_z[v])
    before, after, turned = near_corner(p, st, track, v, s)
    pitch = st.track_pitch[before]
    return z, pitch + turned * (st.track_pitch[after] - pitch)


@compiled
def track_pose(p: Program, st: State, track: int, s: float, smooth: int) -> tuple[float, float, float, float]:
    """Return (x, y, heading, direction of the trajectory) at a distance along it, which is clipped to its ends.

    `smooth` is 1 if given headings are followed smoothly.
    """
    last = p.track_vertex[track + 1] - 1
    if last == p.track_vertex[track]:
        h = st.track_h[last]
        return st.track_x[last], st.track_y[last], h, h
    s = clip(s, 0.0, st.track_s[last])
    v = vertex_before(p, st, track, s)
    if p.track_kind[track] == op.TRACK_CLOTHOIDS:
        dx, dy, turned = spiral_step(st.track_h[v], st.track_bend[v], st.track_bend_rate[v], s - st.track_s[v])
        h = st.track_h[v] + turned
        return st.track_x[v] + dx, st.track_y[v] + dy, h, h
    length = st.track_s[v + 1] - st.track_s[v]
    share = clip((s - st.track_s[v]) / length, 0.0, 1.0) if length > op.TOLERANCE else 0.0
    x = st.track_x[v] + share * (st.track_x[v + 1] - st.track_x[v])
    y = st.track_y[v] + share * (st.track_y[v + 1] - st.track_y[v])
    along = bearing(st.track_x[v + 1] - st.track_x[v], st.track_y[v + 1] - st.track_y[v])
    if length <= op.TOLERANCE:
        along = st.track_h[v]
    if p.track_kind[track] == op.TRACK_NURBS or (smooth == 1 and p.vertex_heading[v] == 1):
        return x, y, st.track_h[v] + share * angle_between(st.track_h[v + 1], st.track_h[v]), along
    return x, y, corner_heading(p, st, track, v, s), along


@compiled
def nearest_on_track(p: Program, st: State, track: int, x: float, y: float) -> float:
    """Return the distance along a trajectory of its point nearest to (x, y), straight between vertices, m."""
    first = p.track_vertex[track]
    best = st.track_s[first]
    nearest = length_of(x - st.track_x[first], y - st.track_y[first])
    for v in range(first, p.track_vertex[track + 1] - 1):
        dx = st.track_x[v + 1] - st.track_x[v]
        dy = st.track_y[v + 1] - st.track_y[v]
        share = clip(ratio((x - st.track_x[v]) * dx + (y - st.track_y[v]) * dy, dx * dx + dy * dy, 0.0), 0.0, 1.0)
        away = length_of(x - st.track_x[v] - share * dx, y - st.track_y[v] - share * dy)
        if away < nearest:
            nearest = away
            best = st.track_s[v] + share * (st.track_s[v + 1] - st.track_s[v])
    return best


@compiled
def beside_track(x: float, y: float, h: float, ahead: float, left: float) -> tuple[float, float]:
    """Return the point `ahead` of and `left` of a pose, m."""
    return x + ahead * cos(h) + left * cos(h + 0.5 * pi), y + ahead * sin(h) + left * sin(h + 0.5 * pi)


@compiled
def track_followed(p: Program, st: State, i: int) -> int:
    """Return the action by which an entity follows a trajectory, or NONE."""
    k = st.lateral[i]
    if k < 0 or k >= p.action_count[0] or p.action_flags[k] & op.FLAG_ON_TRACK == 0:
        return op.NONE
    return k
