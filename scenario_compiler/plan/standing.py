"""The positions of entities at the start of a run, from their starts and the init's teleport actions.

They are what the engine determines when a run begins, computed in advance for pictures and checks. Positions that are
random or that refer to routes and trajectories are left out.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from scenario_compiler.plan.binding import OFF_ROAD, Binder
from scenario_compiler.plan.model import StartPose
from scenario_compiler.roads import LanePosition as FoundLane
from scenario_compiler.roads.below import place_below
from scenario_compiler.roads.lanes import lane_direction, lane_pose
from scenario_compiler.roads.relative import across_road, lanes_away
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import LANE_STEP, advance, along_reference
from scenario_compiler.vocabulary.actions import AddEntityAction, TeleportAction
from scenario_compiler.vocabulary.positions import (
    BesidePosition,
    BoundPosition,
    FreePosition,
    LanesAwayPosition,
    Position,
    RelativeLanePosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
)
from scenario_compiler.vocabulary.storyboard import Storyboard


class Standing(NamedTuple):
    """An entity's pose, and the lane on which it stands; None if it is not on a road."""

    pose: StartPose
    lane: FoundLane | None


Standings = Mapping[str, Standing]
"""Standings by entity id."""


def standings_of(
    binder: Binder, starts: Mapping[str, BoundPosition], known: Standings | None = None
) -> tuple[dict[str, Standing], set[str]]:
    """Return the standings of the starts, and the ids of the entities whose starts depend on themselves.

    Args:
        binder: The map and the parameters' values; faults are reported to its sink.
        starts: The starts by entity id.
        known: Standings of further entities.
    """
    waiting = dict(starts)
    found: dict[str, Standing] = {}
    while waiting:
        ready = {name: start for name, start in waiting.items() if getattr(start, "entity", None) not in waiting}
        if not ready:
            break
        for name, start in ready.items():
            del waiting[name]
            before = {**known, **found} if known else found
            standing = stands_at(binder, start, before)
            if standing is not None:
                found[name] = standing
            elif isinstance(start, BesidePosition | RelativeLanePosition):
                base = before.get(start.entity)
                if base is not None and base.lane is None:
                    message = f"'{start.entity}' is on no road, along which <{start.word}> could be measured"
                    binder.sink.add(OFF_ROAD, message, start.origin)
    return found, set(waiting)


def after_init(binder: Binder, storyboard: Storyboard, starts: Standings) -> dict[str, Standing]:
    """Return the standings after the init's actions; `starts` are those before it."""
    standings = dict(starts)
    for initial in storyboard.init:
        action = initial.action
        if isinstance(action, TeleportAction):
            name = initial.entity
        elif isinstance(action, AddEntityAction):
            name = action.entity
        else:
            continue
        found = stands_at(binder, action.position, standings)
        if found is not None:
            standings[name] = found
        else:
            standings.pop(name, None)
    return standings


def stands_at(binder: Binder, position: Position | BoundPosition, standings: Standings) -> Standing | None:
    """Return the standing of a bound position; None if it is random or relative to an entity without a standing."""
    if isinstance(position, FreePosition):
        facing = 0.0 if position.heading is None else position.heading
        x, y, heading = (binder.value(n, position) for n in (position.x, position.y, facing))
        z = None if position.z is None else binder.value(position.z, position)
        return _at_point(binder, x, y, z, heading)
    if isinstance(position, RelativeObjectPosition | RelativeWorldPosition):
        base = standings.get(position.entity)
        return None if base is None else _beside_point(binder, position, base)
    if isinstance(position, LanesAwayPosition | RelativeRoadPosition):
        base = standings.get(position.entity)
        return None if base is None or base.lane is None else _along_road(binder, position, base.lane)
    name = position.entity if isinstance(position, BesidePosition | RelativeLanePosition) else ""
    base = standings.get(name)
    lanes = {} if base is None or base.lane is None else {name: base.lane}
    try:
        found = binder.resolve(position, lanes)
    except ValueError:  # the map has no such place; binding has reported it
        return None
    return None if found is None else Standing(found[1], found[0])


def _at_point(binder: Binder, x: float, y: float, z: float | None, heading: float) -> Standing:
    network = binder.network
    n = network.tables
    height = 0.0 if z is None else z
    found, road, lane, s, offset = place_below(n, x, y, heading, height, 0 if z is None else 1)
    on_lane = None
    if found:
        _, _, height, _, _, _ = lane_pose(n, road, lane, s, offset)
        on_lane = FoundLane(network.road_ids[road], lane, s, offset)
    return Standing(StartPose.model_construct(x=x, y=y, z=height, heading=heading % (2 * math.pi)), on_lane)


def _beside_point(binder: Binder, position: RelativeObjectPosition | RelativeWorldPosition, base: Standing) -> Standing:
    dx, dy, dz = (binder.value(n, position) for n in (position.dx, position.dy, position.dz))
    if isinstance(position, RelativeObjectPosition):
        c, w = math.cos(base.pose.heading), math.sin(base.pose.heading)
        dx, dy = dx * c - dy * w, dx * w + dy * c
    heading = _heading(binder, position, base.pose.heading)
    return _at_point(binder, base.pose.x + dx, base.pose.y + dy, base.pose.z + dz, heading)


def _along_road(binder: Binder, position: LanesAwayPosition | RelativeRoadPosition, base: FoundLane) -> Standing | None:
    network = binder.network
    n = network.tables
    start = network.road_index(base.road)
    before = lane_direction(n, start, base.lane, base.s)
    if isinstance(position, LanesAwayPosition):
        along_lane = position.along == "lane"
        ahead = binder.value(position.distance, position)
        if along_lane:
            road, lane, s = _advance_in_lane(n, start, base.lane, base.s, ahead)
        else:
            road, lane, s, _ = advance(n, start, base.lane, base.s, ahead * before, -1)
        left = binder.value(position.offset, position)
        lane, offset, along = lanes_away(n, road, lane, s, position.lanes, left, int(along_lane))
    else:
        ahead = binder.value(position.ds, position) * before
        road, lane, s, _ = advance(n, start, base.lane, base.s, ahead, -1)
        aside = base.offset * before * lane_direction(n, road, lane, s)
        lane, offset, along = across_road(n, road, lane, s, aside, binder.value(position.dt, position))
    if lane == 0:
        return None
    x, y, z, _, _, _ = lane_pose(n, road, lane, s, offset)
    heading = _heading(binder, position, along) % (2 * math.pi)
    pose = StartPose.model_construct(x=x, y=y, z=z, heading=heading)
    return Standing(pose, FoundLane(network.road_ids[road], lane, s, offset))


def _advance_in_lane(n: RoadTables, road: int, lane: int, s: float, ds: float) -> tuple[int, int, float]:
    """Return (road, lane, s) after ds along the centre line of a lane, at most at its end."""
    left = abs(ds)
    while left > 0.0:
        step = min(left, LANE_STEP)
        road, lane, s, rest = advance(n, road, lane, s, along_reference(n, road, lane, s, math.copysign(step, ds)), -1)
        left = 0.0 if rest > 0.0 else left - step
    return road, lane, s


def _heading(
    binder: Binder,
    position: LanesAwayPosition | RelativeRoadPosition | RelativeObjectPosition | RelativeWorldPosition,
    along: float,
) -> float:
    """Return a position's heading in the world, rad; its turn is relative to `along`."""
    if position.heading is not None:
        return binder.value(position.heading, position)
    return along + binder.value(position.turn, position)
