"""The places of a map's signals, and the places at which the lanes they apply to meet their stop lines."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from scenario_compiler.frames import CarlaTransform, carla_from_pose
from scenario_compiler.roads import LanePosition, Network, Pose
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.model import RoadObject, Signal

LIGHT, STOP, YIELD, LIMIT = "1000001", "206", "205", "274"
"""Types of signals (the German catalogue of signs, as CARLA's maps use it)."""


LIGHTS_AHEAD = 0.25
"""Distance by which lights are put ahead of their places in the file, m (LibCarla's `MapBuilder`)."""

SPEED = re.compile(r"[Ss]peed_(?:STATIC_)?([0-9]+)")
"""Name of an object that LibCarla's `ObjectParser` reads as a speed limit, as in CARLA's towns."""


class Signals:
    """The signals of a map, the references to them, and the objects that CARLA reads as speed limits.

    Attributes:
        network: The map.
        own: All of them except the references, in the file's order, the objects last.
    """

    def __init__(self, network: Network) -> None:
        """Find all signals, and sort them by their ids."""
        self.network = network
        model = network.model()
        limits = ((one, SPEED.match(one.name)) for one in model.objects)
        every = [*model.signals, *(_limit(one, found.group(1)) for one, found in limits if found is not None)]
        self.own = [one for one in every if not one.reference]
        self._by_id: dict[str, list[Signal]] = {}
        for one in every:
            self._by_id.setdefault(one.id, []).append(one)

    def places_of(self, number: str) -> list[Signal]:
        """Return the signals with an id and all references to them."""
        return self._by_id.get(number, [])

    def stop_lines(self, signal: Signal) -> Iterator[LanePosition]:
        """Yield the places outside the junction at which the lanes of a signal meet its stop line."""
        seen: set[tuple[str, int]] = set()
        for place in self.places_of(signal.id):
            for lane in lanes_of(self.network, place):
                stop = _outside(self.network, lane)
                if stop is not None and (stop.road, stop.lane) not in seen:
                    seen.add((stop.road, stop.lane))
                    yield stop


def _limit(one: RoadObject, number: str) -> Signal:
    return Signal(
        road=one.road,
        id=one.id,
        name=one.name,
        type=LIMIT,
        subtype=number,
        country="OpenDRIVE",
        value=number,
        unit="mph",
        text=number,
        s=one.s,
        t=one.t,
        z_offset=one.z_offset,
        heading_offset=one.heading,
        orientation=one.orientation,
        dynamic=False,
        reference=False,
        height=one.height,
        width=one.width,
        lanes=one.lanes,
        user_data=(),
        rest=(),
    )


def stands(network: Network, signal: Signal) -> CarlaTransform:
    """Return the transform of a signal's actor: upright, and turned by 90 degrees (MapBuilder, TrafficLightManager)."""
    pose = network.road_pose(signal.road, _on_road(network, signal), signal.t)
    heading = pose.heading + signal.heading_offset
    ahead = LIGHTS_AHEAD if signal.type == LIGHT else 0.0
    x, y = pose.x + ahead * math.cos(heading), pose.y + ahead * math.sin(heading)
    return carla_from_pose(Pose(x, y, pose.z + signal.z_offset, (heading - 0.5 * math.pi) % math.tau, 0.0, 0.0))


def lanes_of(network: Network, place: Signal) -> Iterator[LanePosition]:
    """Yield the driving lanes to which a signal, or a reference to it, applies at its place."""
    s = _on_road(network, place)
    for one in network.lanes_at(place.road, s):
        if one.type == "driving" and _is_meant(network, place, one.lane):
            yield LanePosition(place.road, one.lane, s, 0.0)


def _on_road(network: Network, place: Signal) -> float:
    """Return the s of a signal; if it lies beyond the end of its road, that of this end."""
    return min(max(place.s, 0.0), network.road(place.road).length)


def _is_meant(network: Network, place: Signal, lane: int) -> bool:
    """Return whether a signal applies to a lane: by its validity, which CARLA's maps have, or by its orientation."""
    if place.lanes:
        return any(min(pair) <= lane <= max(pair) for pair in place.lanes)
    along = lane_direction(network.tables, network.road_index(place.road), lane, _on_road(network, place)) > 0
    return {"+": along, "-": not along}.get(place.orientation, True)


def _outside(network: Network, place: LanePosition) -> LanePosition | None:
    """Return the last place before the junction on the way to a place; the place itself if it lies in no junction."""
    at: LanePosition | None = place
    for _ in range(200):
        if at is None or network.road(at.road).junction is None:
            return at
        at = network.previous(at, 0.5)
    return None
