"""Swarms: vehicles in an ellipse around an entity, which turns with the entity.

When the action begins, its vehicles appear anywhere in the ellipse outside the inner radius. A vehicle that leaves the
ellipse or the map disappears and appears again near the rim, where it drives into the ellipse. Places are drawn with
the counter hash, alternately along the lanes of the entity and from the whole map.
"""

from __future__ import annotations

from math import cos, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import is_number, length_of, ratio
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.motion.path import leave_road
from scenario_compiler.engine.motion.places import place_by_share
from scenario_compiler.engine.traffic.driving import vanish
from scenario_compiler.engine.traffic.free_places import appears_at, lane_by_draw, try_place
from scenario_compiler.engine.traffic.neighbours import list_by_road
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_hash, random_unit
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance

FILLED = 1.0
"""Value of `State.action_a` once the vehicles have appeared for the first time."""

FIRST_TRIES = 60
"""Number of places that are drawn for each vehicle when a swarm begins."""

TRIES = 12
"""Number of places that are drawn in a frame for all vehicles that appear again."""

RIM = 0.6
"""Share of the ellipse's extent outside which vehicles appear again."""

DRAWS = 4
"""Number of random numbers for each place."""


@compiled
def extent_at(p: Program, st: State, k: int, x: float, y: float) -> float:
    """Return the squared relative position of a point in a swarm's ellipse: 0 at its centre, 1 at its rim."""
    base = p.action_const[k]
    c = p.action_flags[k]
    along = cos(st.h[c])
    across = sin(st.h[c])
    dx = x - st.x[c]
    dy = y - st.y[c]
    ahead = ratio(dx * along + dy * across - p.const[base + slot.W_OFFSET], p.const[base + slot.W_MAJOR], 1.0e9)
    left = ratio(dy * along - dx * across, p.const[base + slot.W_MINOR], 1.0e9)
    return ahead * ahead + left * left


@compiled
def place_along(n: RoadTables, p: Program, st: State, k: int, i: int, draw: int) -> tuple[int, int, float]:
    """Return (road, lane, s) of a place ahead of or behind the central entity; road -1 if there is none."""
    c = p.action_flags[k]
    road = st.road[c]
    base = p.action_const[k]
    seed = run_seed(st, op.NONE)
    share = 2.0 * random_unit(seed, op.STREAM_TRAFFIC, i, draw + 1) - 1.0
    ahead = p.const[base + slot.W_OFFSET] + share * p.const[base + slot.W_MAJOR]
    if road < 0 or st.lane[c] == 0 or is_number(ahead) == 0:
        return -1, 0, 0.0
    facing = st.facing[c] * lane_direction(n, road, st.lane[c], st.s[c])
    road, lane, s, rest = advance(n, road, st.lane[c], st.s[c], facing * ahead, op.NONE)
    if rest > 0.0:
        return -1, 0, 0.0
    lane = lane_by_draw(n, road, s, random_hash(seed, op.STREAM_TRAFFIC, i, draw + 2))
    if lane == 0:
        return -1, 0, 0.0
    return road, lane, s


@compiled
def place_in_swarm(n: RoadTables, p: Program, st: State, k: int, i: int, draw: int) -> tuple[int, int, float]:
    """Return (road, lane, s) of a drawn place: alternately along the entity's road and on the whole map."""
    if (draw // DRAWS) % 2 == 0:
        return place_along(n, p, st, k, i, draw)
    unit = random_unit(run_seed(st, op.NONE), op.STREAM_TRAFFIC, i, draw + 1)
    road, lane, s, _, _ = place_by_share(n, p, p.action_position[k], unit)
    return road, lane, s


@compiled
def goes_as_wanted(p: Program, st: State, k: int, i: int, draw: int) -> int:
    """Return 1 if a vehicle drives in the direction (with the entity or against it) that the draw requires."""
    base = p.action_const[k]
    c = p.action_flags[k]
    both = p.const[base + slot.W_SAME] + p.const[base + slot.W_OPPOSITE]
    unit = random_unit(run_seed(st, op.NONE), op.STREAM_TRAFFIC, i, draw + 3)
    with_it = unit * both < p.const[base + slot.W_SAME]
    if cos(st.h[i] - st.h[c]) >= 0.0:
        return 1 if with_it else 0
    return 0 if with_it else 1


@compiled
def comes_nearer(st: State, i: int, c: int) -> int:
    """Return 1 if a vehicle does not move away from an entity."""
    dx = st.x[i] - st.x[c]
    dy = st.y[i] - st.y[c]
    speed_x = st.v[i] * cos(st.h[i]) - st.v[c] * cos(st.h[c])
    speed_y = st.v[i] * sin(st.h[i]) - st.v[c] * sin(st.h[c])
    return 1 if dx * speed_x + dy * speed_y <= 0.0 else 0


@compiled
def fits_in(p: Program, st: State, k: int, i: int, draw: int) -> int:
    """Return 1 if a vehicle has been put into the part of the ellipse where it may appear."""
    c = p.action_flags[k]
    extent = extent_at(p, st, k, st.x[i], st.y[i])
    distance = length_of(st.x[i] - st.x[c], st.y[i] - st.y[c])
    if extent > 1.0 or distance < p.const[p.action_const[k] + slot.W_INNER]:
        return 0
    if st.action_a[k] == FILLED and (extent < RIM * RIM or comes_nearer(st, i, c) == 0):
        return 0
    return goes_as_wanted(p, st, k, i, draw)


@compiled
def join_swarm(n: RoadTables, p: Program, st: State, k: int, i: int, tries: int) -> int:
    """Let a vehicle of a swarm appear at the first suitable one of several drawn places; return the number of tries."""
    for attempt in range(tries):
        draw = DRAWS * (FIRST_TRIES * (st.frame[0] & 65535) + attempt)
        road, lane, s = place_in_swarm(n, p, st, k, i, draw)
        if road < 0:
            continue
        try_place(n, p, st, i, road, lane, s)
        if fits_in(p, st, k, i, draw) == 0:
            leave_road(st, i)
        elif appears_at(n, p, st, i) == 1:
            return attempt + 1
    return tries


@compiled
def keep_swarm(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Remove the vehicles outside the ellipse, and let absent ones appear."""
    c = p.action_flags[k]
    if st.present[c] == 0 or st.road[c] < 0:
        return
    first = max(p.action_other[k], 0)
    last = first + p.action_lanes[k]
    for i in range(first, last):
        if st.present[i] == 1 and extent_at(p, st, k, st.x[i], st.y[i]) > 1.0:
            vanish(st, i)
    list_by_road(p, st)
    left = TRIES
    for i in range(first, last):
        if st.present[i] == 0:
            if st.action_a[k] != FILLED:
                join_swarm(n, p, st, k, i, FIRST_TRIES)
            elif left > 0:
                left = left - join_swarm(n, p, st, k, i, min(left, 4))
    st.action_a[k] = FILLED
