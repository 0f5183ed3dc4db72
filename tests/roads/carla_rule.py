"""How CARLA's client finds the nearest waypoint, on our geometry: to tell its search's errors from errors of ours.

LibCarla (road/Map.cpp, `CreateRtree` and `GetClosestWaypointOnRoad`, as in 0.9.16) covers the centre of every lane with
chords: from the lane's start in its direction of travel, in steps of 1 m of s, a chord ends where the direction has
turned by more than 1.8 degrees. A point is projected on the nearest chord, and the length along that chord is added to
the s of the chord's start, as if chord, lane centre and reference line were of one length; beyond the s of the chord's
end that end is returned.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise

from scenario_compiler.roads import Network, lanes
from scenario_compiler.roads.positions import Pose

STEP = 1.0
THRESHOLD = math.pi / 100.0

Knot = tuple[float, float, float]
"""End of a chord: s, x, y."""


@cache
def chords(network: Network, road: int, lane: int, section: int) -> tuple[Knot, ...]:
    """Return the ends of the chords of a lane, in its direction of travel."""
    n = network.tables
    start, end = n.section_s[section], n.section_end[section]
    sense = 1.0 if lane < 0 else -1.0

    def pose(gone: float) -> tuple[float, Pose]:
        s = min(max(start + gone if sense > 0 else end - gone, start), end - 1e-9)
        return s, Pose(*lanes.lane_pose(n, road, lane, s, 0.0))

    here = pose(0.0)
    found = [(here[0], here[1].x, here[1].y)]
    for k in range(1, math.floor((end - start) / STEP) + 1):
        there = pose(k * STEP)
        if _angle(here[1], there[1]) > THRESHOLD or abs(here[0] - there[0]) > 100.0:
            found.append((there[0], there[1].x, there[1].y))
            here = there
    last = pose(end - start)
    return (*found, (last[0], last[1].x, last[1].y))


def _angle(one: Pose, other: Pose) -> float:
    turn = math.cos(one.pitch) * math.cos(other.pitch) * math.cos(one.heading - other.heading)
    return math.acos(min(1.0, turn + math.sin(one.pitch) * math.sin(other.pitch)))


def nearest_s(network: Network, road: int, lane: int, section: int, x: float, y: float) -> float:
    """Return the s that CARLA's search gives a point on a lane."""
    knots = chords(network, road, lane, section)
    best = (math.inf, 0.0)
    for (s0, x0, y0), (s1, x1, y1) in pairwise(knots):
        length = math.hypot(x1 - x0, y1 - y0)
        if length > 0.0:
            along = min(max(((x - x0) * (x1 - x0) + (y - y0) * (y1 - y0)) / length, 0.0), length)
            share = along / length
            gap = math.hypot(x - x0 - share * (x1 - x0), y - y0 - share * (y1 - y0))
            best = min(best, (gap, max(s1, s0 - along) if s1 < s0 else min(s1, s0 + along)))
    return best[1]
