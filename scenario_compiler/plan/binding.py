"""Positions bound to the map: road, lane, s and offset for every way an author can write a position."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from scenario_compiler.diagnostics import Code, Diagnostics, did_you_mean
from scenario_compiler.expressions import Expression, ExpressionError, Value
from scenario_compiler.frames import heading_from_carla, point_from_carla, reference_from_center
from scenario_compiler.plan.model import StartPose
from scenario_compiler.roads import LanePosition as FoundLane
from scenario_compiler.roads import Network, Pose
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction, lane_type
from scenario_compiler.roads.spawn_points import read_spawn_points
from scenario_compiler.vocabulary.positions import (
    BoundPosition,
    LanePosition,
    Position,
    RelativeLanePosition,
    RoadPosition,
    SpawnPoint,
    WorldPosition,
)
from scenario_compiler.vocabulary.word import Number, Word

UNKNOWN_ROAD = Code(
    "SC371",
    "unknown-road",
    "A position names a road that the map does not have. Road ids are those of the OpenDRIVE file; `scenario-compiler "
    "map plot FILE` draws them.",
)
UNKNOWN_LANE = Code(
    "SC372",
    "unknown-lane",
    "A position names a lane that the road does not have at this s. Lanes are numbered from the reference line: -1, "
    "-2, ... to the right, 1, 2, ... to the left, and a road may have different lanes in different sections.",
)
BEYOND_ROAD = Code(
    "SC373",
    "beyond-road",
    "A position lies before the begin or behind the end of its road. s is measured along the road's reference line "
    "from 0 to the road's length.",
)
OFF_ROAD = Code(
    "SC374",
    "off-road",
    "A position in the world lies on no lane of the map, so nothing can drive there. Check the frame: CARLA's y axis "
    'points the other way than OpenDRIVE\'s (`frame="carla"`), and maps of different releases differ.',
)
LANE_ENDS_EARLY = Code(
    "SC375",
    "lane-ends-early",
    "A position ahead of an entity lies beyond the end of the lane that the entity drives on. Shorten the distance, or "
    "start the entity on a road that goes on.",
)
UNKNOWN_SPAWN_POINT = Code(
    "SC376",
    "unknown-spawn-point",
    "A position names a spawn point that the map's map.toml does not list.",
)
NO_VALUE = Code(
    "SC377",
    "no-value",
    "An expression has no value for the parameters' values: a division by zero, the root of a negative number, or a "
    "result that is not finite.",
)


@dataclass(frozen=True)
class Binder:
    """Binds positions to one map for one set of parameter values.

    Attributes:
        network: The map.
        values: Values of the scenario's parameters, for checks and for positions that must become numbers.
        sink: Where faults go.
    """

    network: Network
    values: Mapping[str, Value]
    sink: Diagnostics

    def value(self, number: Number, position: Position) -> float:
        """Return a number of a position at the parameters' values; 0 and a diagnostic when it has none."""
        if not isinstance(number, Expression):
            return number
        try:
            return number.number(self.values)
        except ExpressionError as error:
            self.sink.add(NO_VALUE, str(error), position.origin)
            return 0.0

    def bind(self, position: Position, center: float) -> BoundPosition | None:
        """Return the position bound to a lane; None and a diagnostic when it is on none.

        `center` is the distance from the reference point to the box's centre of the entity that stands there, m: a
        position in CARLA's frame speaks of the centre.
        """
        if isinstance(position, LanePosition):
            return position if self._on_lane(position) else None
        if isinstance(position, RelativeLanePosition):
            return position
        if isinstance(position, RoadPosition):
            return self._bind_road(position)
        if isinstance(position, SpawnPoint):
            return self._bind_spawn_point(position)
        return self._bind_world(position, center)

    def _on_lane(self, position: LanePosition) -> bool:
        s = self.value(position.s, position)
        if not self.on_road(position, position.road, s):
            return False
        lanes = [lane.lane for lane in self.network.lanes_at(position.road, s)]
        if position.lane not in lanes or position.lane == 0:
            known = ", ".join(str(lane) for lane in lanes if lane != 0)
            self.sink.add(
                UNKNOWN_LANE,
                f"road '{position.road}' has no lane {position.lane} at s = {s:g} m",
                position.place_of("lane"),
                hint=f"lanes there: {known}",
            )
            return False
        return True

    def on_road(self, word: Word, road: str, s: float) -> bool:
        """Return whether the map has the road and s lies on it; report what does not."""
        if road not in self.network.road_ids:
            self.sink.add(
                UNKNOWN_ROAD,
                f"the map '{self.network.name}' has no road '{road}'",
                word.place_of("road"),
                hint=did_you_mean(road, self.network.road_ids),
            )
            return False
        length = self.network.road(road).length
        if not 0.0 <= s <= length:
            message = f"s = {s:g} m is outside road '{road}', which is {length:.2f} m long"
            self.sink.add(BEYOND_ROAD, message, word.place_of("s"))
            return False
        return True

    def _bind_road(self, position: RoadPosition) -> LanePosition | None:
        s, t = self.value(position.s, position), self.value(position.t, position)
        if not self.on_road(position, position.road, s):
            return None
        pose = self.network.road_pose(position.road, s, t)
        heading = pose.heading + self.value(position.turn, position)
        lanes = [lane for lane in self.network.lanes_at(position.road, s) if lane.lane != 0]
        if not lanes:
            self.sink.add(OFF_ROAD, f"road '{position.road}' has no lanes at s = {s:g} m", position.origin)
            return None
        nearest = min(lanes, key=lambda lane: (abs(t - (lane.t_left + lane.t_right) / 2), lane.lane))
        offset = t - (nearest.t_left + nearest.t_right) / 2
        return self._facing(FoundLane(position.road, nearest.lane, s, offset), heading, position)

    def _bind_spawn_point(self, position: SpawnPoint) -> LanePosition | None:
        points = read_spawn_points(self.network.path, self.sink)
        if position.name not in points:
            self.sink.add(
                UNKNOWN_SPAWN_POINT,
                f"the map '{self.network.name}' has no spawn point '{position.name}'",
                position.place_of("name"),
                hint=did_you_mean(position.name, points) or "the map names no spawn points",
            )
            return None
        point = points[position.name]
        bound = LanePosition(road=point.road, lane=point.lane, s=point.s).written_at(position.origin)
        return bound if self._on_lane(bound) else None

    def _bind_world(self, position: WorldPosition, center: float) -> LanePosition | None:
        x, y, yaw = (self.value(n, position) for n in (position.x, position.y, position.yaw))
        heading = yaw
        if position.frame == "carla":
            x, y = point_from_carla(x, y)
            heading = heading_from_carla(math.degrees(yaw))
            x, y = reference_from_center(x, y, heading, center)
        found = self.network.locate(x, y)
        if not found:
            nearest = self.network.locate(x, y, nearest=True)
            hint = ""
            if nearest:
                pose = self.network.lane_pose(nearest[0].road, nearest[0].lane, nearest[0].s)
                away = math.dist((x, y), (pose.x, pose.y))
                hint = (
                    f"the nearest lane is {away:.0f} m away: road '{nearest[0].road}', lane {nearest[0].lane}, "
                    f"s = {nearest[0].s:.1f} m"
                )
            self.sink.add(
                OFF_ROAD,
                f"the point ({x:g}, {y:g}) in OpenDRIVE's axes lies on no lane of '{self.network.name}'",
                position.origin,
                hint=hint,
            )
            return None
        best = min(found, key=lambda lane: self._preference(lane, heading))
        return self._facing(best, heading, position)

    def _preference(self, lane: FoundLane, heading: float) -> tuple[bool, bool, float]:
        """Order lanes that contain a point: drivable first, then by direction, then by distance to the centre."""
        drivable = drivable_at(self.network, lane.road, lane.lane, lane.s)
        turned = abs(wrap(heading - self.travel_heading(lane)))
        return (not drivable, turned > math.pi / 4, abs(lane.offset))

    def _facing(self, lane: FoundLane, heading: float, position: Position) -> LanePosition:
        turn = wrap(heading - self.travel_heading(lane))
        return LanePosition(road=lane.road, lane=lane.lane, s=lane.s, offset=lane.offset, turn=turn).written_at(
            position.origin
        )

    def travel_heading(self, lane: FoundLane) -> float:
        """Return the heading of a lane's direction of travel at a position, rad."""
        pose = self.network.lane_pose(lane.road, lane.lane, lane.s, lane.offset)
        direction = travel_direction(self.network, lane.road, lane.lane)
        return pose.heading if direction > 0 else pose.heading + math.pi

    def resolve(self, position: BoundPosition, starts: Mapping[str, FoundLane]) -> tuple[FoundLane, StartPose] | None:
        """Return where a bound position lies at the parameters' values; `starts` are the entities' lanes so far."""
        if isinstance(position, LanePosition):
            lane = FoundLane(
                position.road,
                position.lane,
                self.value(position.s, position),
                self.value(position.offset, position),
            )
        else:
            ahead = self._ahead(position, starts)
            if ahead is None:
                return None
            lane = ahead
        pose = self.network.lane_pose(lane.road, lane.lane, lane.s, lane.offset)
        turn = self.value(position.turn, position)
        return lane, _start_pose(pose, self.travel_heading(lane) + turn)

    def _ahead(self, position: RelativeLanePosition, starts: Mapping[str, FoundLane]) -> FoundLane | None:
        base = starts.get(position.entity)
        if base is None:
            return None
        distance = self.value(position.distance, position)
        centred = FoundLane(base.road, base.lane, base.s, 0.0)
        for _ in range(abs(position.lanes)):
            beside = self.network.left(centred) if position.lanes > 0 else self.network.right(centred)
            if beside is None:
                self.sink.add(
                    UNKNOWN_LANE,
                    f"there is no lane {position.lanes:+d} beside the lane of '{position.entity}'",
                    position.place_of("lanes"),
                )
                return None
            centred = beside
        ahead = self.network.next(centred, distance) if distance >= 0 else self.network.previous(centred, -distance)
        if ahead is None:
            self.sink.add(
                LANE_ENDS_EARLY,
                f"the lane of '{position.entity}' ends before {abs(distance):g} m",
                position.place_of("distance"),
            )
            return None
        offset = self.value(position.offset, position) * travel_direction(self.network, ahead.road, ahead.lane)
        return FoundLane(ahead.road, ahead.lane, ahead.s, offset)


def travel_direction(network: Network, road: str, lane: int) -> int:
    """Return 1 where a lane's traffic goes along s, -1 where it goes against it."""
    return lane_direction(network.tables, network.road_index(road), lane)


def drivable_at(network: Network, road: str, lane: int, s: float) -> bool:
    """Return whether a lane is for driving at s."""
    return bool(is_drivable(lane_type(network.tables, network.road_index(road), lane, s)))


def wrap(angle: float) -> float:
    """Return an angle in (-pi, pi], rad."""
    wrapped = math.remainder(angle, 2 * math.pi)
    return math.pi if wrapped == -math.pi else wrapped


def _start_pose(pose: Pose, heading: float) -> StartPose:
    return StartPose(x=pose.x, y=pose.y, z=pose.z, heading=heading % (2 * math.pi))
