"""Where the signals of a map stand, and where the lanes that they are for meet their stop lines."""

from __future__ import annotations

import math
from collections.abc import Iterator

from scenario_compiler.frames import CarlaTransform, carla_from_pose
from scenario_compiler.roads import LanePosition, Network
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.model import Signal

LIGHT, STOP, YIELD, LIMIT = "1000001", "206", "205", "274"
"""Types of signals (the German catalogue of signs, as CARLA's maps use it)."""


def stands(network: Network, signal: Signal) -> CarlaTransform:
    """Return where a signal stands; CARLA turns its actor by 90 degrees (MapBuilder, TrafficLightManager)."""
    pose = network.road_pose(signal.road, signal.s, signal.t)
    facing = pose.heading + signal.heading_offset - 0.5 * math.pi
    return carla_from_pose(pose._replace(z=pose.z + signal.z_offset, heading=facing % math.tau))


def places_of(network: Network, signal: Signal) -> list[Signal]:
    """Return a signal and all references to it."""
    return [one for one in network.model().signals if one.id == signal.id]


def stop_lines(network: Network, signal: Signal) -> Iterator[LanePosition]:
    """Yield where lanes that a signal is for meet its stop line: outside the junction."""
    seen: set[tuple[str, int]] = set()
    for place in places_of(network, signal):
        for lane in lanes_of(network, place):
            stop = _outside(network, lane)
            if stop is not None and (stop.road, stop.lane) not in seen:
                seen.add((stop.road, stop.lane))
                yield stop


def lanes_of(network: Network, place: Signal) -> Iterator[LanePosition]:
    """Yield the driving lanes that a signal, or a reference to it, is for, where it stands."""
    s = min(max(place.s, 0.0), network.road(place.road).length)
    for one in network.lanes_at(place.road, s):
        if one.type == "driving" and _is_meant(network, place, one.lane):
            yield LanePosition(place.road, one.lane, s, 0.0)


def _is_meant(network: Network, place: Signal, lane: int) -> bool:
    """Return whether a signal is for a lane: by its validity, which CARLA's maps have, else by its orientation."""
    if place.lanes:
        return any(min(pair) <= lane <= max(pair) for pair in place.lanes)
    along = lane_direction(network.tables, network.road_index(place.road), lane) > 0
    return {"+": along, "-": not along}.get(place.orientation, True)


def _outside(network: Network, place: LanePosition) -> LanePosition | None:
    """Return the last place before a junction on the way to a place, the place itself where it lies in none."""
    at: LanePosition | None = place
    for _ in range(200):
        if at is None or network.road(at.road).junction is None:
            return at
        at = network.previous(at, 0.5)
    return None
