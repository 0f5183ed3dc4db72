"""Trailers: the coupler of each follows the hitch of the towing vehicle (esmini 3.6).

A trailer's heading points from the last position of its axle to the present position of the hitch; its axle is then
placed one coupler length behind the hitch. A trailer may tow another one.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import bearing
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.free import place_free
from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import wrap_heading
from scenario_compiler.roads.tables import RoadTables


@compiled
def front_of_train(p: Program, st: State, i: int) -> int:
    """Return the entity that tows i, directly or through other trailers, and is not towed itself; i if none tows it."""
    at = i
    for _ in range(p.entity_count[0]):
        if st.towed_by[at] < 0:
            return at
        at = st.towed_by[at]
    return at


@compiled
def coupled(p: Program, st: State, i: int, j: int) -> int:
    """Return 1 if one of two entities tows the other, directly or through other trailers, or if one entity tows both.

    They are one combination: they touch at the couplings, and neither is another road user to the other.
    """
    if st.trains[0] == 0 or front_of_train(p, st, i) != front_of_train(p, st, j):
        return 0
    return 1


@compiled
def follow_hitch(n: RoadTables, p: Program, st: State, i: int, j: int, straight: int) -> None:
    """Put trailer j behind i, and in line with it if `straight` is 1."""
    hitch = p.const[p.entity_const[i] + slot.E_HITCH]
    coupler = p.const[p.entity_const[j] + slot.E_COUPLER]
    x = st.x[i] + hitch * cos(st.h[i])
    y = st.y[i] + hitch * sin(st.h[i])
    h = st.h[i]
    if straight == 0:
        h = wrap_heading(bearing(x - st.x[j], y - st.y[j]))
    st.h[j] = h
    st.x[j] = x - coupler * cos(h)
    st.y[j] = y - coupler * sin(h)
    st.z[j] = st.z[i]
    st.v[j] = st.v[i]
    st.ended[j] = 0
    if st.road[j] < 0:
        st.road[j] = st.road[i]
        st.s[j] = st.s[i]
    place_free(n, st, j)


@compiled
def straighten_trailers(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Put the trailers of an entity in line behind it."""
    at = i
    for _ in range(p.entity_count[0]):
        j = st.towed[at]
        if j < 0:
            return
        follow_hitch(n, p, st, at, j, 1)
        st.last_x[j] = st.x[j]
        st.last_y[j] = st.y[j]
        at = j


@compiled
def draw_trailers(n: RoadTables, p: Program, st: State) -> None:
    """Move all trailers behind their towing vehicles, from the front of each combination to its end."""
    for i in range(p.entity_count[0]):
        if st.towed_by[i] < 0 and st.towed[i] >= 0 and st.present[i] == 1:
            at = i
            for _ in range(p.entity_count[0]):
                j = st.towed[at]
                if j < 0:
                    break
                follow_hitch(n, p, st, at, j, 0)
                at = j


@compiled
def connect_trailer(p: Program, st: State, i: int, j: int) -> None:
    """Let an entity tow another one instead of its present trailer; a circle of trailers is not made."""
    at = i
    for _ in range(p.entity_count[0]):
        if at == j:
            return
        if st.towed_by[at] >= 0:
            at = st.towed_by[at]
    disconnect_trailer(st, i)
    if st.towed_by[j] >= 0:
        st.towed[st.towed_by[j]] = op.NONE
    st.trains[0] = 1
    st.towed[i] = j
    st.towed_by[j] = i


@compiled
def disconnect_trailer(st: State, i: int) -> None:
    """Uncouple an entity's trailer, which stops where it is."""
    j = st.towed[i]
    if j >= 0:
        st.v[j] = 0.0
        st.towed[i] = op.NONE
        st.towed_by[j] = op.NONE
