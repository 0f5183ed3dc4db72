"""Places for random positions: stretches of lanes of the requested kind."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from scenario_compiler.plan.model import Entity
from scenario_compiler.roads import Network
from scenario_compiler.roads.lane_types import BIKING, LAST_DRIVABLE, SHOULDER, SIDEWALK, WALKING
from scenario_compiler.roads.lanes import row_width
from scenario_compiler.vocabulary.positions import AnyOfPosition, BesidePosition, RandomPosition, Surface
from scenario_compiler.vocabulary.word import Number

SURFACES: dict[Surface, frozenset[int]] = {
    "driving": frozenset(range(LAST_DRIVABLE + 1)),
    "biking": frozenset({BIKING}),
    "shoulder": frozenset({SHOULDER}),
    "sidewalk": frozenset({SIDEWALK, WALKING}),
}
"""Lane types of each kind of surface."""

NARROWEST = 0.5
"""Least width of a lane at both ends of a stretch, m."""


def reach(entity: Entity) -> float:
    """Return the distance from an entity's reference point to the farthest corner of its box or more, m."""
    vehicle = entity.vehicle
    return abs(vehicle.center) + math.hypot(vehicle.length, vehicle.width) / 2


def rooms_needed(
    entities: Sequence[Entity], value: Callable[[Number, BesidePosition], float]
) -> dict[str, tuple[Entity, float]]:
    """Return each entity with a random start and the clearance of its place from all others, m, by id.

    At that distance between two reference points neither entity is in the other's box. Entities `beside` a random start
    are considered too, because they are placed after all random starts.

    Args:
        entities: All entities but those of traffic.
        value: Returns the value of a number of a position, m.
    """
    drawn = {one.id: one for one in entities if isinstance(one.start, RandomPosition | AnyOfPosition)}
    extents = {one.id: reach(one) for one in entities}
    for one in entities if drawn else ():
        place = one.start
        if isinstance(place, BesidePosition) and place.entity in drawn:
            away = math.hypot(value(place.distance, place), value(place.ahead, place))
            extents[place.entity] = max(extents[place.entity], away + reach(one))
    largest = sorted(extents, key=lambda name: -extents[name])[:2]
    others = {name: max((extents[one] for one in largest if one != name), default=0.0) for name in drawn}
    return {name: (one, extents[name] + others[name]) for name, one in drawn.items()}


class Span(NamedTuple):
    """A stretch of a lane: index of the road, lane id, and least and greatest s, m."""

    road: int
    lane: int
    s_from: float
    s_to: float


def spans_of(network: Network, place: RandomPosition, *, behind: float = 0.0, before: float = 0.0) -> list[Span]:
    """Return the stretches of lanes from which a random position is drawn, in the order of the map.

    Args:
        network: The map.
        place: The random position.
        behind: Distance to keep from where traffic enters a road, m.
        before: Distance to keep from where traffic leaves it, m.
    """
    n = network.tables
    types = SURFACES[place.on]
    spans = []
    for road, name in enumerate(network.road_ids):
        if (place.roads and name not in place.roads) or (not place.roads and n.road_junction[road] >= 0):
            continue
        for section in range(n.road_section[road], n.road_section[road + 1]):
            for row in range(n.section_lane[section], n.section_lane[section + 1]):
                lane = n.lane_id[row]
                if lane == 0 or n.lane_type[row] not in types or place.lane not in (None, lane):
                    continue
                low, high = behind, n.road_length[road] - before
                if n.lane_sense[row] < 0:
                    low, high = before, n.road_length[road] - behind
                low = max(low, place.s_from, n.section_s[section])
                high = min(high, n.section_end[section], high if place.s_to is None else place.s_to)
                if high > low and min(row_width(n, row, low), row_width(n, row, high)) >= NARROWEST:
                    spans.append(Span(road, lane, low, high))
    return spans
