"""The place at which the ego's path is blocked, and the entity that blocks it, for pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from scenario_compiler.plan.model import RouteLeg
from scenario_compiler.recording.recording import Floats, Integers
from scenario_compiler.report.run import Run
from scenario_compiler.roads.positions import LanePosition

NEAR = 6.0
"""Greatest distance between the place where the path is blocked and the box of the blocking entity, m."""


@dataclass(frozen=True, eq=False)
class Blocks:
    """The place in each row where the path is blocked, NaN if it is free.

    Attributes:
        x: (n,) m; y likewise.
        y: See x.
        h: (n,) direction of the lane there, rad.
        by: (n,) number of the blocking entity, -1 if none is near.
    """

    x: Floats
    y: Floats
    h: Floats
    by: Integers


def blocks_of(run: Run) -> Blocks:
    """Compute where the path is blocked: at the recorded distance from the ego's front, along its lane.

    At junctions the lane of the plan's route is followed, or else the straightest one.
    """
    recording = run.recording
    n = len(recording.t)
    x, y, h = (np.full(n, np.nan) for _ in range(3))
    by = np.full(n, -1, np.int64)
    vehicle = run.plan.entities[0].vehicle if run.plan.entities else None
    for row in np.nonzero(np.isfinite(recording.blocked_distance))[0].tolist():
        if vehicle is None or recording.road[row, 0] < 0:
            continue
        ahead = float(recording.blocked_distance[row]) + vehicle.center + 0.5 * vehicle.length
        place = _ahead(run, row, ahead)
        if place is None:
            continue
        pose = run.network.lane_pose(place.road, place.lane, place.s)
        x[row], y[row], h[row] = pose.x, pose.y, pose.heading
        by[row] = _nearest(run, row, pose.x, pose.y)
    return Blocks(x, y, h, by)


def _ahead(run: Run, row: int, distance: float) -> LanePosition | None:
    """Return the place a distance ahead of the ego in a row along its route, or else along its lane."""
    recording, network = run.recording, run.network
    road, lane = recording.roads[recording.road[row, 0]], int(recording.lane[row, 0])
    s = float(recording.s[row, 0])
    legs = run.plan.route
    on = next((k for k, leg in enumerate(legs) if (leg.road, leg.lane) == (road, lane) and _holds(leg, s)), len(legs))
    left = distance
    for k, leg in enumerate(legs[on:]):
        begin = s if k == 0 else leg.s_from
        if left <= abs(leg.s_to - begin):
            return LanePosition(leg.road, leg.lane, begin + math.copysign(left, leg.s_to - begin), 0.0)
        left -= abs(leg.s_to - begin)
    try:
        return network.next(LanePosition(road, lane, s, 0.0), distance)
    except ValueError:
        return None


def _holds(leg: RouteLeg, s: float) -> bool:
    """Return whether a place on a leg's road belongs to the leg."""
    return min(leg.s_from, leg.s_to) <= s <= max(leg.s_from, leg.s_to)


def _nearest(run: Run, row: int, x: float, y: float) -> int:
    """Return the entity whose box is nearest to a point, -1 if none is near."""
    recording, best = run.recording, (NEAR, -1)
    for i, entity in enumerate(run.plan.entities[1:], start=1):
        if recording.present[row, i]:
            vehicle, heading = entity.vehicle, float(recording.h[row, i])
            dx, dy = x - float(recording.x[row, i]), y - float(recording.y[row, i])
            along = dx * math.cos(heading) + dy * math.sin(heading) - vehicle.center
            across = dy * math.cos(heading) - dx * math.sin(heading)
            apart = math.hypot(max(abs(along) - 0.5 * vehicle.length, 0.0), max(abs(across) - 0.5 * vehicle.width, 0.0))
            best = min(best, (apart, i))
    return best[1]
