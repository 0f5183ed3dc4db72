"""Signs of a map as CARLA has them: stop and yield signs hold vehicles, speed limits are actors only.

A stop sign lets a vehicle see red, without a light, as soon as its box touches the area before the stop line, for 2 s
at least; a yield sign only while it must give way. It must while another vehicle is on a conflicting way through the
junction, or shortly before it; that is looked up again 1 s (stop) or 0.5 s (yield) later, and 0.5 s after a vehicle has
left such an area. A vehicle keeps what a sign has let it see until the next sign or light. CARLA's Traffic Manager
takes red without a light for a junction to negotiate.

Conflicting ways are known to signs only that stand, or are referred to, on the junction's own roads, as in CARLA's
towns.
Sources: `UStopSignComponent`, `UYieldSignComponent`, `USpeedLimitComponent`, `UBoundingBoxCalculator::CombineBoxes` of
CARLA 0.9.15 and 0.9.16.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from scenario_compiler.carla_server.areas import LEAST_WIDTH, AreaIndex, Box, area_before, box_at
from scenario_compiler.carla_server.signals import LIMIT, STOP, YIELD, Signals, lanes_of, stands
from scenario_compiler.carla_server.traffic_lights import GREEN, RED
from scenario_compiler.frames import CarlaTransform, vector_from_carla
from scenario_compiler.roads import LanePosition, Network
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.model import Signal

PAINTED = "Stencil_STOP"
"""Name of a stop sign that is painted on the road; CARLA makes no actor of it."""

HELD = 2.0
AGAIN = {"traffic.stop": 1.0, "traffic.yield": 0.5}
CLEARED = 0.5
"""Least time for which a vehicle sees red at a stop sign, s; time after which a sign looks again for vehicles with the
right of way, s; and the same time after one has left, s.
"""

CHECK_SHARE, LIMIT_SHARE = 0.9, 0.7
"""Widths of the areas as shares of their lane's width: on a conflicting way, at a speed limit."""

CLOSE = 2.0
"""Distance between the middles of two ways through a junction below which they conflict, m."""

FORESEEN = 0.1
DEFAULT_SPEED = 40.0
"""Length of the areas on a way before the junction, hours at its speed limit in km/h, as CARLA computes it."""

SAMPLED = 1.0
"""Distance of points along a way, m."""


@dataclass(frozen=True, eq=False)
class Sign:
    """A sign: type id of its actor, id of its signal, where it stands (CARLA's axes), and the areas of its effect."""

    kind: str
    signal: str
    transform: CarlaTransform
    areas: tuple[Box, ...] = ()

    def trigger(self) -> tuple[list[float], list[float], list[float]]:
        """Return the box about its areas on the wire: middle in its own axes, half extents along the world's, turn."""
        turn = [0.0, -self.transform.yaw, 0.0]
        if not self.areas:
            return [0.0, 0.0, 0.0], [0.0, 0.0, 0.0], turn
        spans = zip(*(one.sides() for one in self.areas), strict=True)
        sides = [(min(low for low, _ in one), max(high for _, high in one)) for one in spans]
        x, y, z = vector_from_carla(*(0.5 * (low + high) for low, high in sides))
        dx, dy, dz = (at - own for at, own in zip((x, y, z), self.transform[:3], strict=True))
        yaw = math.radians(self.transform.yaw)
        c, s = math.cos(yaw), math.sin(yaw)
        return [dx * c + dy * s, dy * c - dx * s, dz], [0.5 * (high - low) for low, high in sides], turn


@dataclass(eq=False)
class RightOfWay:
    """The state that a stop or yield sign shows to vehicles.

    Attributes:
        sign: The sign, in whose areas vehicles wait.
        crossed: Areas on the ways that have the right of way.
        waiting: Ids of the vehicles in its areas.
        crossing: Ids of the vehicles in the areas crossed, each with the index of the area.
        due: The time at which it looks again, s.
    """

    sign: Sign
    crossed: tuple[Box, ...]
    waiting: set[int] = field(default_factory=set)
    crossing: set[tuple[int, int]] = field(default_factory=set)
    due: list[float] = field(default_factory=list)

    def step(self, time: float, waiting: set[int], crossing: set[tuple[int, int]]) -> dict[int, int]:
        """Return the states that it shows from a time on, RED or GREEN by vehicle id; other vehicles see no change."""
        came, left = waiting - self.waiting, self.crossing - crossing
        entered = any(car not in waiting for car, _ in crossing - self.crossing)
        self.waiting, self.crossing = waiting, crossing
        shown: dict[int, int] = {}
        if came and self.sign.kind == "traffic.stop":
            shown.update(dict.fromkeys(came, RED))
            self.due.append(time + HELD)
        elif came:
            shown.update(self._decide(time))
        if entered:
            shown.update(self._decide(time))
        if left:
            self.due.append(time + CLEARED)
        reached = [one for one in self.due if one <= time + 1e-9]
        if reached:
            self.due = [one for one in self.due if one > time + 1e-9]
            shown.update(self._decide(time))
        return shown

    def _decide(self, time: float) -> dict[int, int]:
        if all(car in self.waiting for car, _ in self.crossing):
            return dict.fromkeys(self.waiting, GREEN)
        if self.waiting:
            self.due.append(time + AGAIN[self.sign.kind])
        return dict.fromkeys(self.waiting, RED)


class SignRules:
    """The stop and yield signs of a map, and which vehicles they concern."""

    def __init__(self, signals: Signals, signs: Iterable[Sign]) -> None:
        """Find the ways that have the right of way, and index all areas by their places."""
        ways = _ways_by_junction(signals.network)
        self._rules = [
            RightOfWay(sign, tuple(_crossed(signals, ways, sign)))
            for sign in signs
            if sign.kind in AGAIN and sign.areas
        ]
        self._index = AreaIndex(
            (area, (rule, number))
            for rule in self._rules
            for number, area in enumerate((*rule.sign.areas, *rule.crossed), -len(rule.sign.areas))
        )

    @property
    def empty(self) -> bool:
        """Whether there is no such sign."""
        return not self._rules

    def is_near(self, x: float, y: float) -> bool:
        """Return whether a sign may concern a vehicle whose middle is at a point."""
        return self._index.is_near(x, y)

    def step(self, time: float, boxes: Iterable[tuple[int, Box]]) -> dict[int, int]:
        """Return the states that signs show from a time on, RED or GREEN by vehicle id.

        Args:
            time: s.
            boxes: Id and box of each vehicle that a sign may concern.
        """
        waiting: dict[RightOfWay, set[int]] = {}
        crossing: dict[RightOfWay, set[tuple[int, int]]] = {}
        for car, box in boxes:
            for rule, number in self._index.touched(box):
                if number < 0:
                    waiting.setdefault(rule, set()).add(car)
                else:
                    crossing.setdefault(rule, set()).add((car, number))
        shown: dict[int, int] = {}
        for rule in self._rules:
            if rule in waiting or rule in crossing or rule.waiting or rule.crossing or rule.due:
                shown.update(rule.step(time, waiting.get(rule, set()), crossing.get(rule, set())))
        return shown


def signs_of(signals: Signals) -> list[Sign]:
    """Return the stop signs, yield signs and speed limits of a map."""
    network, found = signals.network, []
    for signal in signals.own:
        if signal.name == PAINTED:
            continue
        where = stands(network, signal)
        if signal.type in (STOP, YIELD):
            kind = "traffic.stop" if signal.type == STOP else "traffic.yield"
            areas = tuple(area_before(network, line) for line in signals.stop_lines(signal))
            found.append(Sign(kind, signal.id, where, areas))
        elif signal.type == LIMIT and (signal.value or signal.subtype):
            number = (signal.value or signal.subtype).partition(".")[0]
            if number.isdigit():
                areas = tuple(_limit_areas(signals, signal))
                found.append(Sign(f"traffic.speed_limit.{number}", signal.id, where, areas))
    return found


def _cube(network: Network, at: LanePosition, edge: float) -> Box:
    return box_at(network.lane_pose(at.road, at.lane, at.s), edge, edge, edge)


def _limit_areas(signals: Signals, signal: Signal) -> Iterator[Box]:
    network = signals.network
    for place in signals.places_of(signal.id):
        for at in lanes_of(network, place):
            edge = max(LIMIT_SHARE * network.lane_width(at.road, at.lane, at.s), LEAST_WIDTH)
            yield _cube(network, network.previous(at, 0.5 * edge) or at, edge)


def _ways_by_junction(network: Network) -> dict[str, list[str]]:
    """Return the roads through each junction, in the map's order."""
    found: dict[str, list[str]] = {}
    for road in network.road_ids:
        junction = network.road(road).junction
        if junction is not None:
            found.setdefault(junction, []).append(road)
    return found


def _crossed(signals: Signals, ways: Mapping[str, Sequence[str]], sign: Sign) -> Iterator[Box]:
    """Yield the areas on ways through the junction that conflict with the way that a sign is on.

    `ways` are the roads through each junction.
    """
    network = signals.network
    seen: set[tuple[str, int]] = set()
    for place in signals.places_of(sign.signal):
        own = [(at.road, at.lane) for at in lanes_of(network, place)]
        junction = network.road(place.road).junction
        if junction is None or not own:
            continue
        points = [point for road, lane in own for point in _points(network, road, lane)]
        origins = {_origin(network, road, lane) for road, lane in own}
        for road in ways[junction]:
            for lane in _driving_lanes(network, road) if road != place.road else ():
                if (road, lane) in seen or _origin(network, road, lane) in origins:
                    continue
                if any(math.dist(one, other) <= CLOSE for one in _points(network, road, lane) for other in points):
                    seen.add((road, lane))
                    yield from _along(network, road, lane)


def _driving_lanes(network: Network, road: str) -> list[int]:
    middle = 0.5 * network.road(road).length
    return [one.lane for one in network.lanes_at(road, middle) if one.type == "driving"]


def _start(network: Network, road: str, lane: int) -> LanePosition:
    """Return the place at which traffic enters a lane."""
    length = network.road(road).length
    along = lane_direction(network.tables, network.road_index(road), lane, 0.5 * length) > 0
    return LanePosition(road, lane, 0.0 if along else length, 0.0)


def _origin(network: Network, road: str, lane: int) -> str | None:
    """Return the road from which traffic enters a lane of a road in a junction; None if there is none."""
    before = network.previous(_start(network, road, lane), 0.1)
    return None if before is None else before.road


def _points(network: Network, road: str, lane: int) -> list[tuple[float, float]]:
    """Return points along the middle of a lane, 1 m apart."""
    length = network.road(road).length
    count = max(math.ceil(length / SAMPLED), 1)
    poses = [network.lane_pose(road, lane, length * k / count) for k in range(count + 1)]
    return [(pose.x, pose.y) for pose in poses]


def _along(network: Network, road: str, lane: int) -> Iterator[Box]:
    """Yield the areas along a lane in a junction, and those before it."""
    at = _start(network, road, lane)
    edge = max(CHECK_SHARE * network.lane_width(at.road, at.lane, at.s), LEAST_WIDTH)
    length = network.road(road).length
    for k in range(math.floor(length / edge) + 1):
        yield _cube(network, at._replace(s=edge * k if at.s == 0.0 else length - edge * k), edge)
    left, before = FORESEEN, network.previous(at, edge)
    while before is not None and left > 0.0:
        yield _cube(network, before, edge)
        limit = network.speed_limit(before.road, before.lane, before.s)
        speed = DEFAULT_SPEED if limit is None or not 0.0 < limit < math.inf else 3.6 * limit
        left, before = left - 0.5 * edge / speed, network.previous(before, edge)
