"""Binds positions to the map: a position of any type becomes a road, a lane, s and an offset."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Severity, did_you_mean
from scenario_compiler.expressions import Expression, ExpressionError, Value
from scenario_compiler.frames import heading_from_carla, point_from_carla, reference_from_center
from scenario_compiler.plan.model import StartPose
from scenario_compiler.plan.places import spans_of
from scenario_compiler.randomness import uniform
from scenario_compiler.roads import LanePosition as FoundLane
from scenario_compiler.roads import Network, Pose
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction, lane_type
from scenario_compiler.roads.spawn_points import read_spawn_points
from scenario_compiler.vocabulary.positions import (
    AnyOfPosition,
    BesidePosition,
    BoundPosition,
    FreePosition,
    GeoPosition,
    LanePositionWord,
    LanesAwayPosition,
    NumberedSpawnPoint,
    Position,
    RandomPosition,
    RandomSpawnPoint,
    RelativeLanePosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
    RoadPosition,
    RoutePosition,
    SpawnPoint,
    TrajectoryPosition,
    WorldPosition,
)
from scenario_compiler.vocabulary.word import Number, Word

UNKNOWN_ROAD = Code(
    "SC371",
    "unknown-road",
    "A position names a road that the map does not have. Road ids are those of the OpenDRIVE file; `scenario-compiler "
    "map plot FILE` draws them."
    '\n\n    <lane road="31" lane="-1" s="20"/>     the map\'s roads are 1 to 30',
)
UNKNOWN_LANE = Code(
    "SC372",
    "unknown-lane",
    "A position names a lane that the road does not have at this s. Lanes are numbered from the reference line: -1, "
    "-2, ... to the right, 1, 2, ... to the left, and a road may have different lanes in different sections. 0 is the "
    "centre lane, the line between the two."
    '\n\n    <lane road="3" lane="-4" s="20"/>     road 3 has the lanes -2 to 2',
)
BEYOND_ROAD = Code(
    "SC373",
    "beyond-road",
    "A position is before the start or beyond the end of its road. s is measured along the road's reference line from "
    "0 to the road's length.\n\n"
    '    <lane road="3" lane="-1" s="900"/>     road 3 is 400 m long',
)
OFF_ROAD = Code(
    "SC374",
    "off-road",
    "A position in the world lies on no lane of the map, so nothing can drive there, or a position is measured along "
    "the road of an entity that is on none. Check the frame: CARLA's y axis points in the opposite direction to "
    'OpenDRIVE\'s (`frame="carla"`). Maps of different releases also differ.\n\n'
    '    <world x="151.4" y="-91.5" frame="carla"/>     y has the opposite sign in OpenDRIVE\'s axes',
)
LANE_ENDS_EARLY = Code(
    "SC375",
    "lane-ends-early",
    "A position ahead of an entity is beyond the end of the entity's lane. Shorten the distance, or start the entity "
    "on a longer road.\n\n"
    '    <ahead_of entity="ego" distance="800"/>     the ego vehicle\'s lane ends after 420 m',
)
UNKNOWN_SPAWN_POINT = Code(
    "SC376",
    "unknown-spawn-point",
    "A position names a spawn point that neither the scenario's <spawn_points> nor the map's map.toml lists, or asks "
    "for one beyond the end of the list:\n\n"
    '    <spawn_points><point name="bridge"><lane road="3" lane="-1" s="20"/></point></spawn_points>\n'
    '    <start><spawn_point name="bridge"/></start>\n'
    '    <start><numbered_spawn_point index="0"/></start>\n\n'
    "`scenario-compiler map info FILE` lists the spawn points of a map.",
)
NO_RANDOM_PLACE = Code(
    "SC382",
    "no-random-place",
    "No lane matches a <random> position: the roads have no lane of that kind or id, or `s_from` and `s_to` are "
    "outside the roads. Allow more roads or lanes:\n\n"
    '    <random on="sidewalk" roads="1 2"/>',
)
RANDOM_HERE = Code(
    "SC383",
    "random-position-here",
    "A random position is used where only a fixed one is allowed: as a destination, in a condition or an action, or "
    "as the start of an ego vehicle that has a destination (its route would differ from run to run). Give a "
    "<random_spawn_point> a `seed`, or write a fixed position; a <random> depends on the entities placed before, also "
    "with a seed.\n\n"
    '    <destination><random on="driving"/></destination>     would differ from run to run',
)
NO_VALUE = Code(
    "SC377",
    "no-value",
    "An expression has no value for the parameters' values: a division by zero, the root of a negative number, or a "
    "result that is not finite."
    '\n\n    <ahead_of entity="ego" distance="${100 / $count}"/>     has no value where count is 0',
)
NOT_ON_EARTH = Code(
    "SC385",
    "map-without-projection",
    "A position is given by latitude and longitude, but the `geoReference` in the map's header is missing or not "
    "known. Known are PROJ strings with `+proj=tmerc`, `utm`, `merc`, `webmerc` or `lcc`, in metres, with `+towgs84` "
    "if the datum is another one than WGS 84, and EPSG codes of UTM zones and of some national grids, such as "
    "`EPSG:25832`. Give the map such a projection, or write the position in the map's own axes:\n\n"
    '    <geographic latitude="49.0069" longitude="8.4037"/>\n'
    '    <free x="120.5" y="-33.2" heading="90"/>',
)

AT_USE = (
    RelativeLanePosition
    | BesidePosition
    | FreePosition
    | LanesAwayPosition
    | RelativeRoadPosition
    | RelativeObjectPosition
    | RelativeWorldPosition
    | RoutePosition
    | TrajectoryPosition
)
"""Types of positions that the engine resolves when they are used."""


@dataclass(frozen=True)
class Binder:
    """Binds positions to one map at one set of parameter values.

    Attributes:
        network: The map.
        values: Values of the scenario's parameters, for checks and for positions that must become numbers.
        sink: The sink for diagnostics.
        named: The scenario's own spawn points, in document order.
        forgiving: Whether a position beyond its road's end is moved to the end, and one on a missing lane to the
            nearest lane, with a warning. Set for scenarios without an automated vehicle, which are often written for
            other programs.
    """

    network: Network
    values: Mapping[str, Value]
    sink: Diagnostics
    named: Mapping[str, Position] = field(default_factory=dict)
    forgiving: bool = False

    def value(self, number: Number, position: Position) -> float:
        """Return a number of a position at the parameters' values; report one without a value, and return 0 for it."""
        if not isinstance(number, Expression):
            return number
        try:
            return number.number(self.values)
        except ExpressionError as error:
            self.sink.add(NO_VALUE, str(error), position.origin)
            return 0.0

    def bind(self, position: Position, center: float) -> BoundPosition | None:
        """Return the position bound to a lane; report a position that is on no lane, and return None for it.

        `center` is the distance from the reference point of the entity at this position to its box's centre, m. It is
        needed because positions in CARLA's frame are those of the centre.
        """
        if isinstance(position, LanePositionWord):
            return self._on_lane(position)
        if isinstance(position, AT_USE):
            return position
        if isinstance(position, GeoPosition):
            return self._bind_geographic(position)
        if isinstance(position, RoadPosition):
            return self._bind_road(position)
        if isinstance(position, SpawnPoint | NumberedSpawnPoint):
            return self._bind_spawn_point(position, center)
        if isinstance(position, RandomSpawnPoint):
            return self._bind_random_spawn_point(position, center)
        if isinstance(position, RandomPosition):
            return self._bind_random(position)
        return self._bind_world(position, center)

    def _on_lane(self, position: LanePositionWord) -> LanePositionWord | None:
        s = self._on_length(position, self.value(position.s, position))
        if s is None:
            return None
        lanes = [lane.lane for lane in self.network.lanes_at(position.road, s) if lane.lane != 0]
        lane = position.lane
        if lane not in (0, *lanes):
            nearest = min(lanes, key=lambda one: (abs(one - lane), one), default=None) if self.forgiving else None
            self.sink.add(
                UNKNOWN_LANE,
                f"road '{position.road}' has no lane {lane} at s = {s:g} m",
                position.place_of("lane"),
                hint=f"lanes there: {', '.join(map(str, lanes)) or 'none'}"
                if nearest is None
                else f"lane {nearest} is used",
                severity=Severity.ERROR if nearest is None else Severity.WARNING,
            )
            if nearest is None:
                return None
            lane = nearest
        changes: dict[str, float] = {} if lane == position.lane else {"lane": lane}
        if not isinstance(position.s, Expression) and s != position.s:
            changes["s"] = s
        return position.model_copy(update=changes) if changes else position

    def _on_length(self, position: LanePositionWord | RoadPosition, s: float) -> float | None:
        """Return the s of a position on its road; report one that is not on its road, and return None for it.

        A forgiving binder returns the nearest s on the road instead.
        """
        if not self.forgiving or position.road not in self.network.road_ids:
            return s if self.on_road(position, position.road, s) else None
        length = self.network.road(position.road).length
        if not 0.0 <= s <= length:
            message = f"s = {s:g} m is outside road '{position.road}', which is {length:.2f} m long"
            hint = "the road's end is used"
            self.sink.add(BEYOND_ROAD, message, position.place_of("s"), hint=hint, severity=Severity.WARNING)
        return min(max(s, 0.0), length)

    def on_road(self, word: Word, road: str, s: float, attribute: str = "road") -> bool:
        """Return whether the map has the road, which `attribute` names, and s is on it; report what is wrong."""
        if road not in self.network.road_ids:
            self.sink.add(
                UNKNOWN_ROAD,
                f"the map '{self.network.name}' has no road '{road}'",
                word.place_of(attribute),
                hint=did_you_mean(road, self.network.road_ids),
            )
            return False
        length = self.network.road(road).length
        if not 0.0 <= s <= length:
            message = f"s = {s:g} m is outside road '{road}', which is {length:.2f} m long"
            self.sink.add(BEYOND_ROAD, message, word.place_of("s"))
            return False
        return True

    def _bind_road(self, position: RoadPosition) -> LanePositionWord | None:
        s, t = self._on_length(position, self.value(position.s, position)), self.value(position.t, position)
        if s is None:
            return None
        pose = self.network.road_pose(position.road, s, t)
        heading = pose.heading + self.value(position.turn, position)
        if position.heading is not None:
            heading = self.value(position.heading, position)
        lanes = [lane for lane in self.network.lanes_at(position.road, s) if lane.lane != 0]
        if not lanes:
            self.sink.add(OFF_ROAD, f"road '{position.road}' has no lanes at s = {s:g} m", position.origin)
            return None
        nearest = min(lanes, key=lambda lane: (abs(t - (lane.t_left + lane.t_right) / 2), lane.lane))
        offset = t - (nearest.t_left + nearest.t_right) / 2
        return self._facing(FoundLane(position.road, nearest.lane, s, offset), heading, position)

    def _bind_geographic(self, position: GeoPosition) -> FreePosition | None:
        from scenario_compiler.roads.georeference import read_georeference

        header = self.network.model().header
        georeference = read_georeference(header.geo_reference)
        if georeference is None:
            hint = f"its geoReference is '{header.geo_reference}'" if header.geo_reference else "it has no geoReference"
            message = f"the map '{self.network.name}' does not specify a known projection"
            self.sink.add(NOT_ON_EARTH, message, position.origin, hint=hint)
            return None
        found = georeference.project(math.radians(position.latitude), math.radians(position.longitude))
        if found is None:
            message = f"the projection of the map '{self.network.name}' has no such place"
            self.sink.add(NOT_ON_EARTH, message, position.origin, hint=f"its geoReference is '{header.geo_reference}'")
            return None
        x, y = found
        away_x, away_y, _, turned = header.offset
        dx, dy = x - away_x, y - away_y
        c, w = math.cos(turned), math.sin(turned)
        x, y = dx * c + dy * w, dy * c - dx * w
        heading = position.heading
        if heading is None:
            heading = self._heading_of_s(x, y) + self.value(position.turn, position)
        return FreePosition.model_construct(x=x, y=y, heading=heading).written_at(position.origin)

    def _heading_of_s(self, x: float, y: float) -> float:
        """Return the direction of s of the road at a point, rad; 0 off the roads. Drivable lanes come first."""
        found = self.network.locate(x, y)
        if not found:
            return 0.0
        road, _, s, _ = min(found, key=lambda one: not drivable_at(self.network, one.road, one.lane, one.s))
        return self.network.road_pose(road, s, 0.0).heading

    def _spawn_points(self) -> Mapping[str, Position]:
        """Return the scenario's spawn points, or the map's if the scenario has none."""
        return self.named or self._map_points()

    def _map_points(self) -> dict[str, Position]:
        points = read_spawn_points(self.network.path, self.sink)
        return {
            name: LanePositionWord.model_construct(road=one.road, lane=one.lane, s=one.s)
            for name, one in points.items()
        }

    def _bind_spawn_point(self, position: SpawnPoint | NumberedSpawnPoint, center: float) -> BoundPosition | None:
        if isinstance(position, SpawnPoint):
            points = {**self._map_points(), **self.named}
            found = points.get(position.name)
            if found is None:
                message = f"neither the scenario nor the map '{self.network.name}' has a spawn point '{position.name}'"
                names = f"there are {len(points)}, such as '{min(points)}'" if points else "the map has no spawn points"
                known = did_you_mean(position.name, points) or names
                self._report_spawn_point(message, position.place_of("name"), known)
        else:
            listed = list(self._spawn_points().values())
            found = listed[position.index] if position.index < len(listed) else None
            if found is None:
                numbers = f"they are numbered from 0 to {len(listed) - 1}" if listed else "there are no spawn points"
                message = f"there is no spawn point {position.index}"
                self._report_spawn_point(message, position.place_of("index"), numbers)
        return None if found is None else self._bind_listed(found, position, center)

    def _report_spawn_point(self, message: str, place: Place, known: str) -> None:
        """Report a spawn point that neither the scenario nor the map has; `known` says which they have."""
        self.sink.add(UNKNOWN_SPAWN_POINT, message, place, hint=f"{known} (the map is {self.network.path})")

    def _bind_listed(self, found: Position, position: Position, center: float) -> BoundPosition | None:
        """Bind a spawn point of a list; faults in one of the map's are reported at `position`, which uses it."""
        if not found.origin.line:
            found = found.model_copy().written_at(position.origin)
        return replace(self, named={}).bind(found, center)

    def _bind_random_spawn_point(self, position: RandomSpawnPoint, center: float) -> BoundPosition | None:
        listed = list(self._spawn_points().values())
        if not listed:
            message = "there are no spawn points to draw from"
            hint = f"list some in <spawn_points> (the map is {self.network.path})"
            self.sink.add(UNKNOWN_SPAWN_POINT, message, position.origin, hint=hint)
            return None
        if position.seed is not None:
            drawn = int(uniform(position.seed, 0, "spawn_point") * len(listed))
            return self._bind_listed(listed[drawn], position, center)
        bound = [self._bind_listed(one, position, center) for one in listed]
        places = tuple(one for one in bound if isinstance(one, LanePositionWord))
        return AnyOfPosition(places=places).written_at(position.origin) if len(places) == len(listed) else None

    def _bind_random(self, position: RandomPosition) -> RandomPosition | None:
        known = [self.on_road(position, road, 0.0, "roads") for road in position.roads]
        if not all(known):
            return None
        if not spans_of(self.network, position):
            backwards = position.s_to is not None and position.s_to <= position.s_from
            hint = "s_to is not greater than s_from" if backwards else ""
            message = f"no {position.on} lane matches this position"
            self.sink.add(NO_RANDOM_PLACE, message, position.origin, hint=hint)
            return None
        return position

    def _bind_world(self, position: WorldPosition, center: float) -> LanePositionWord | None:
        x, y, yaw = (self.value(n, position) for n in (position.x, position.y, position.yaw))
        written, heading = (x, y), yaw
        if position.frame == "carla":
            written = x, y = point_from_carla(x, y)
            heading = heading_from_carla(math.degrees(yaw))
            x, y = reference_from_center(x, y, heading, center)
        found = self.network.locate(x, y)
        if not found:
            message = f"the point ({written[0]:g}, {written[1]:g}) in OpenDRIVE's axes lies on no lane"
            hint = self._nearest_road(*written)
            self.sink.add(OFF_ROAD, f"{message} of '{self.network.name}'", position.origin, hint=hint)
            return None
        best = min(found, key=lambda lane: self._preference(lane, heading))
        return self._facing(best, heading, position)

    def _nearest_road(self, x: float, y: float) -> str:
        """Return a hint with a point's distance from the nearest road's lane, a drivable one if the road has any."""
        nearest = self.network.locate(x, y, nearest=True)
        if not nearest:
            return ""
        road, s = nearest[0].road, nearest[0].s
        lanes = [one.lane for one in self.network.lanes_at(road, s)]
        away = {}
        for lane in [one for one in lanes if drivable_at(self.network, road, one, s)] or [nearest[0].lane]:
            pose = self.network.lane_pose(road, lane, s)
            away[lane] = math.dist((x, y), (pose.x, pose.y))
        lane = min(away, key=lambda one: away[one])
        return f"the nearest road is {away[lane]:.0f} m away: road '{road}', lane {lane}, s = {s:.1f} m"

    def _preference(self, lane: FoundLane, heading: float) -> tuple[bool, bool, float]:
        """Return the sort key of lanes at a point: drivable lanes first, then by direction, then by distance."""
        drivable = drivable_at(self.network, lane.road, lane.lane, lane.s)
        turned = abs(wrap(heading - self.travel_heading(lane)))
        return (not drivable, turned > math.pi / 4, abs(lane.offset))

    def _facing(self, lane: FoundLane, heading: float, position: Position) -> LanePositionWord:
        turn = wrap(heading - self.travel_heading(lane))
        return LanePositionWord.model_construct(
            road=lane.road, lane=lane.lane, s=lane.s, offset=lane.offset, turn=turn
        ).written_at(position.origin)

    def travel_heading(self, lane: FoundLane) -> float:
        """Return the heading of a lane's driving direction at a position, rad."""
        return self._travel_heading(lane, self.network.lane_pose(lane.road, lane.lane, lane.s, lane.offset))

    def _travel_heading(self, lane: FoundLane, pose: Pose) -> float:
        direction = travel_direction(self.network, lane)
        return pose.heading if direction > 0 else pose.heading + math.pi

    def resolve(
        self, position: Position | BoundPosition, starts: Mapping[str, FoundLane]
    ) -> tuple[FoundLane, StartPose] | None:
        """Return the place and pose of a lane position, or of one ahead of or beside an entity.

        `starts` are the entities' lanes so far. The result is None for a position relative to an entity with a random
        start, and for positions of other types.
        """
        if isinstance(position, LanePositionWord):
            s, offset = self.value(position.s, position), self.value(position.offset, position)
            lane: FoundLane | None = FoundLane(position.road, position.lane, s, offset)
        elif isinstance(position, BesidePosition):
            lane = self._beside(position, starts)
        elif isinstance(position, RelativeLanePosition):
            lane = self._ahead(position, starts)
        else:
            return None
        if lane is None:
            return None
        pose = self.network.lane_pose(lane.road, lane.lane, lane.s, lane.offset)
        heading = self._travel_heading(lane, pose) + self.value(position.turn, position)
        if isinstance(position, LanePositionWord) and position.heading is not None:
            heading = self.value(position.heading, position)
        return lane, _start_pose(pose, heading)

    def _beside(self, position: BesidePosition, starts: Mapping[str, FoundLane]) -> FoundLane | None:
        base = starts.get(position.entity)
        if base is None:
            return None
        left = base.offset * travel_direction(self.network, base)
        ahead = self._along(FoundLane(base.road, base.lane, base.s, 0.0), position, "ahead", position.ahead)
        if ahead is None:
            return None
        left += self.value(position.distance, position)
        offset = left * travel_direction(self.network, ahead)
        return FoundLane(ahead.road, ahead.lane, ahead.s, offset)

    def _along(
        self,
        start: FoundLane,
        position: RelativeLanePosition | BesidePosition,
        attribute: str,
        number: Number,
        same: int = 1,
    ) -> FoundLane | None:
        """Return the place at a distance ahead in the lane, behind if negative; report a lane that ends before.

        With `same` = -1 the driving direction of the lane is opposite to that of the entity, to which "ahead" refers.
        """
        distance = same * self.value(number, position)
        ahead = self.network.next(start, distance) if distance >= 0 else self.network.previous(start, -distance)
        if ahead is None:
            self.sink.add(
                LANE_ENDS_EARLY,
                f"the lane of '{position.entity}' ends before {abs(distance):g} m",
                position.place_of(attribute),
            )
        return ahead

    def _ahead(self, position: RelativeLanePosition, starts: Mapping[str, FoundLane]) -> FoundLane | None:
        base = starts.get(position.entity)
        if base is None:
            return None
        centred, same = FoundLane(base.road, base.lane, base.s, 0.0), 1
        facing = travel_direction(self.network, base) if position.lanes else same
        for _ in range(abs(position.lanes)):
            towards_left = position.lanes * same > 0
            beside = self.network.left(centred) if towards_left else self.network.right(centred)
            if beside is None:
                self.sink.add(
                    UNKNOWN_LANE,
                    f"there is no lane {position.lanes:+d} beside the lane of '{position.entity}'",
                    position.place_of("lanes"),
                )
                return None
            centred, same = beside, facing * travel_direction(self.network, beside)
        ahead = self._along(centred, position, "distance", position.distance, same)
        if ahead is None:
            return None
        direction = same * travel_direction(self.network, ahead)
        return FoundLane(ahead.road, ahead.lane, ahead.s, self.value(position.offset, position) * direction)


def travel_direction(network: Network, place: FoundLane) -> int:
    """Return 1 if the driving direction of a place's lane is along s, -1 if it is against s."""
    return lane_direction(network.tables, network.road_index(place.road), place.lane, place.s)


def is_bound(network: Network, position: LanePositionWord, s: float) -> bool:
    """Return whether the map has a position's road and, at s, its lane; if not, binding has reported it."""
    if position.road not in network.road_ids or not 0.0 <= s <= network.road(position.road).length:
        return False
    return position.lane == 0 or any(one.lane == position.lane for one in network.lanes_at(position.road, s))


def drivable_at(network: Network, road: str, lane: int, s: float) -> bool:
    """Return whether a lane is a driving lane at s."""
    return bool(is_drivable(lane_type(network.tables, network.road_index(road), lane, s)))


def wrap(angle: float) -> float:
    """Return an angle in (-pi, pi], rad."""
    wrapped = math.remainder(angle, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def _start_pose(pose: Pose, heading: float) -> StartPose:
    return StartPose.model_construct(x=pose.x, y=pose.y, z=pose.z, heading=heading % (2 * math.pi))
