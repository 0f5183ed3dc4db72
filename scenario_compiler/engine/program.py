"""From a plan to a program: indices for ids, codes for words, and one slot for every number."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import radians

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine import slots
from scenario_compiler.engine.conflicts import conflicts_of
from scenario_compiler.engine.tables import Program, validate
from scenario_compiler.expressions import Expression, Value
from scenario_compiler.plan.defaults import CAUSE_DEFAULTS
from scenario_compiler.plan.model import Entity, Plan
from scenario_compiler.plan.places import spans_of
from scenario_compiler.roads.network import Network
from scenario_compiler.vocabulary.actions import (
    RUN_ACTIONS,
    Action,
    EndFailureAction,
    Failure,
    FollowPathAction,
    LaneChangeAction,
    LaneOffsetAction,
    MessageAction,
    SensorNoiseAction,
    SpeedAction,
    StopAction,
    WeatherAction,
)
from scenario_compiler.vocabulary.actions.path import Path
from scenario_compiler.vocabulary.conditions import (
    Condition,
    DistanceCondition,
    EventCondition,
    LaneConfidenceCondition,
    ReachPositionCondition,
    SensorHealthCondition,
    SimulationTimeCondition,
    SpeedCondition,
    StandstillCondition,
    TakeoverStateCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.positions import (
    AnyOfPosition,
    BesidePosition,
    LanePosition,
    RandomPosition,
    RelativeLanePosition,
)
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.sensors import FailureKind
from scenario_compiler.vocabulary.storyboard import Event, Trigger, TriggerCondition
from scenario_compiler.vocabulary.takeover import Cause, CauseKind, DriverModel
from scenario_compiler.vocabulary.weather import Weather, weather_numbers
from scenario_compiler.vocabulary.word import Word, number_value

Slot = float | Expression

__all__ = ["Program", "build_program", "rows"]

RULES = {
    "lessThan": op.RULE_LESS,
    "lessOrEqual": op.RULE_LESS_OR_EQUAL,
    "greaterThan": op.RULE_GREATER,
    "greaterOrEqual": op.RULE_GREATER_OR_EQUAL,
    "equalTo": op.RULE_EQUAL,
    "notEqualTo": op.RULE_NOT_EQUAL,
}
EDGES = {
    "none": op.EDGE_NONE,
    "rising": op.EDGE_RISING,
    "falling": op.EDGE_FALLING,
    "risingOrFalling": op.EDGE_BOTH,
}
PRIORITIES = {
    "override": op.PRIORITY_OVERRIDE,
    "skip": op.PRIORITY_SKIP,
    "parallel": op.PRIORITY_PARALLEL,
}
SHAPES = {
    "linear": op.SHAPE_LINEAR,
    "sinusoidal": op.SHAPE_SINUSOIDAL,
    "cubic": op.SHAPE_CUBIC,
    "step": op.SHAPE_STEP,
}
STATES = {
    "automated": op.TAKEOVER_AUTOMATED,
    "warning": op.TAKEOVER_WARNING,
    "request": op.TAKEOVER_REQUEST,
    "escalation": op.TAKEOVER_ESCALATION,
    "manual": op.TAKEOVER_MANUAL,
    "minimum_risk": op.TAKEOVER_MINIMUM_RISK,
    "standstill": op.TAKEOVER_STANDSTILL,
}
FAILURE_CODES: dict[FailureKind, int] = {
    "noise": op.FAILURE_NOISE,
    "dropout": op.FAILURE_DROPOUT,
    "freeze": op.FAILURE_FREEZE,
    "blackout": op.FAILURE_BLACKOUT,
    "blur": op.FAILURE_BLUR,
    "dirt": op.FAILURE_DIRT,
}
SIDES = {"both": op.SIDE_BOTH, "either": op.SIDE_EITHER, "left": op.SIDE_LEFT, "right": op.SIDE_RIGHT}
EVENT_STATES: dict[str, tuple[int, float]] = {
    "started": (op.RULE_GREATER_OR_EQUAL, 1.0 * op.RUNNING),
    "running": (op.RULE_EQUAL, 1.0 * op.RUNNING),
    "complete": (op.RULE_EQUAL, 1.0 * op.COMPLETE),
}
CAUSE_CODES: dict[CauseKind, int] = {
    "controller": op.CAUSE_CONTROLLER,
    "sensor_health": op.CAUSE_SENSOR_HEALTH,
    "lane_confidence": op.CAUSE_LANE_CONFIDENCE,
    "path_blocked": op.CAUSE_PATH_BLOCKED,
    "lane_ends": op.CAUSE_LANE_ENDS,
}
MOTIONS = {
    "ego": op.MOTION_BICYCLE,
    "static": op.MOTION_STATIC,
    "dynamic": op.MOTION_SCRIPTED,
    "traffic": op.MOTION_TRAFFIC,
    "walker": op.MOTION_WALKER,
}

TRAFFIC_MARGINS = (5.0, 25.0)
"""Distances that vehicles of traffic keep at the start from where a road is entered and left, m: enough to stop in."""

FOLLOW_EGO = (1.5, 2.0, 1.5, 2.0)
"""Car following of the automation: time gap s, gap at standstill m, acceleration and comfortable deceleration m/s2. Our
choice, the same as the defaults of `vocabulary.entities.Follow`."""


def build_program(plan: Plan, network: Network, *, posed: bool = False) -> Program:
    """Lower a plan, with its parameters at their defaults; `posed` leaves the ego's motion to another program.

    Raises:
        KeyError: The plan names a road or entity that there is not; a plan that was made for another map.
        ExpressionError: A parameter without default leaves a number open.
    """
    draft = _Draft(plan, network, posed)
    draft.program.const = draft.row(parameter_values(plan.parameters))
    validate(draft.program, len(network.road_ids))
    return draft.program


def rows(plan: Plan, network: Network, samples: Sequence[Mapping[str, Value]]) -> list[list[float]]:
    """Return a row of `Program.const` for each sample of the parameters; what a sample leaves out is at its default."""
    draft = _Draft(plan, network, posed=False)
    usual = parameter_values(plan.parameters)
    return [draft.row({**usual, **sample}) for sample in samples]


class _Draft:
    """Collects a program's columns; numbers stay expressions until a row is asked for."""

    def __init__(self, plan: Plan, network: Network, posed: bool) -> None:
        self.plan = plan
        self.network = network
        self.program = Program()
        self.numbers: list[Slot] = [0.0] * slots.K_ENTITIES
        self.messages = 0
        self.events: dict[str, int] = {}
        self.awaited: list[tuple[int, str]] = []
        self.spans: dict[tuple[Word, str], tuple[int, int]] = {}
        self.entities = {entity.id: i for i, entity in enumerate(plan.entities)}
        self.run()
        self.takeover()
        for entity in plan.entities:
            self.entity(entity, posed)
        self.program.entity_order = self.start_order()
        self.markings()
        self.traffic()
        self.paths()
        self.storyboard()
        self.program.entity_count[0] = len(plan.entities)

    def row(self, values: Mapping[str, Value]) -> list[float]:
        """Evaluate all numbers."""
        return [number_value(number, values) for number in self.numbers]

    def block(self, *numbers: Slot) -> int:
        """Append numbers and return the slot of the first."""
        self.numbers.extend(numbers)
        return len(self.numbers) - len(numbers)

    def run(self) -> None:
        plan, p, k = self.plan, self.program, self.numbers
        k[slots.K_STEP] = plan.step
        k[slots.K_DURATION] = plan.duration
        k[slots.K_NOISE] = plan.camera.sensor_noise
        for failure in plan.camera.failures:
            self.failure(failure, waits=False)
        self.weather(plan.weather)
        p.ego[0] = 0
        p.control_every[0] = plan.control_every
        p.perception[0] = op.PERCEPTION_CAMERA if plan.perception == "camera" else op.PERCEPTION_IDEAL
        if plan.destination is not None:
            p.destination_road[0] = self.network.road_index(plan.destination.road)
            p.destination_lane[0] = plan.destination.lane
            k[slots.K_DESTINATION_S] = plan.destination.s
            k[slots.K_DESTINATION_OFFSET] = plan.destination.offset
        for leg in plan.route:
            road = self.network.road_index(leg.road)
            if not p.route_road or p.route_road[-1] != road:
                p.route_road.append(road)
        p.route_count[0] = len(p.route_road)

    def takeover(self) -> None:
        takeover, p, k = self.plan.takeover, self.program, self.numbers
        k[slots.K_BUDGET] = takeover.budget
        k[slots.K_ESCALATE_AFTER] = takeover.escalate_after
        k[slots.K_MINIMUM_RISK_AFTER] = takeover.minimum_risk_after
        k[slots.K_MINIMUM_RISK_DECELERATION] = takeover.minimum_risk_deceleration
        p.hazard_lights[0] = 1 if takeover.hazard_lights else 0
        k[slots.K_HAND_BACK_AFTER] = takeover.hand_back_after
        given = {cause.kind: cause for cause in takeover.causes}
        for kind in given or CAUSE_DEFAULTS:
            p.cause_on[CAUSE_CODES[kind]] = 1
            p.cause_order.append(CAUSE_CODES[kind])
        p.cause_count[0] = len(p.cause_order)
        self.cause_limits(given)
        driver = takeover.driver
        if isinstance(driver, DriverModel) and driver.takeover_time is None:
            p.driver_kind[0] = op.DRIVER_LOGNORMAL
            k[slots.K_DRIVER_MU] = driver.mu
            k[slots.K_DRIVER_SIGMA] = driver.sigma
            k[slots.K_DRIVER_LAPSE] = driver.lapse
        elif driver.takeover_time is not None:
            p.driver_kind[0] = op.DRIVER_FIXED
            k[slots.K_DRIVER_TIME] = driver.takeover_time
        else:
            raise ValueError("the plan's driver is not bound to a driver model")

    def cause_limits(self, given: Mapping[CauseKind, Cause]) -> None:
        k = self.numbers
        limits: tuple[tuple[CauseKind, str, int], ...] = (
            ("lane_confidence", "warning_below", slots.K_CONFIDENCE_WARNING),
            ("lane_confidence", "request_below", slots.K_CONFIDENCE_REQUEST),
            ("lane_confidence", "count", slots.K_CONFIDENCE_COUNT),
            ("lane_confidence", "of", slots.K_CONFIDENCE_OF),
            ("sensor_health", "warning_below", slots.K_HEALTH_WARNING),
            ("sensor_health", "request_below", slots.K_HEALTH_REQUEST),
            ("sensor_health", "count", slots.K_HEALTH_COUNT),
            ("sensor_health", "of", slots.K_HEALTH_OF),
            ("path_blocked", "margin", slots.K_BLOCKED_MARGIN),
            ("path_blocked", "sensor_range", slots.K_SENSOR_RANGE),
            ("path_blocked", "field_of_view", slots.K_FIELD_OF_VIEW),
            ("path_blocked", "count", slots.K_BLOCKED_COUNT),
            ("path_blocked", "of", slots.K_BLOCKED_OF),
            ("lane_ends", "gap_front", slots.K_GAP_FRONT),
            ("lane_ends", "gap_rear", slots.K_GAP_REAR),
            ("lane_ends", "count", slots.K_LANE_END_COUNT),
            ("lane_ends", "of", slots.K_LANE_END_OF),
        )
        for kind, field, slot in limits:
            value = getattr(given[kind], field) if kind in given else None
            k[slot] = CAUSE_DEFAULTS[kind][field] if value is None else value

    def entity(self, entity: Entity, posed: bool) -> None:
        p, vehicle = self.program, entity.vehicle
        motion = MOTIONS[entity.kind]
        if posed and motion == op.MOTION_BICYCLE:
            motion = op.MOTION_POSED
        follow: tuple[Slot, Slot, Slot, Slot] = FOLLOW_EGO
        if entity.follow is not None:
            one = entity.follow
            follow = (one.time_gap, one.minimum_gap, one.acceleration, one.deceleration)
        p.entity_motion.append(motion)
        p.entity_follows.append(0 if entity.follow is None else 1)
        p.entity_position.append(self.position(entity.start, entity.kind))
        p.entity_leg_first.append(len(p.leg_road))
        for leg in entity.route:
            road = self.network.road_index(leg.road)
            if len(p.leg_road) == p.entity_leg_first[-1] or p.leg_road[-1] != road:
                p.leg_road.append(road)
        p.entity_leg_last.append(len(p.leg_road))
        p.entity_seed.append(op.NONE if entity.seed is None else entity.seed)
        p.entity_const.append(
            self.block(
                *(vehicle.length, vehicle.width, vehicle.height, vehicle.wheelbase, vehicle.center),
                *(radians(vehicle.max_steer), vehicle.max_acceleration, vehicle.max_deceleration),
                *(vehicle.max_speed, entity.speed, entity.desired_speed, *follow, entity.share),
            )
        )

    def traffic(self) -> None:
        """Count background traffic, and note which ways over the junctions cross."""
        p = self.program
        p.traffic_count[0] = sum(1 for motion in p.entity_motion if motion in (op.MOTION_TRAFFIC, op.MOTION_WALKER))
        if p.traffic_count[0] > 0:
            p.conflict_first, p.conflict_road = conflicts_of(self.network)

    def paths(self) -> None:
        """Append the paths that entities begin with, as actions of the init."""
        p = self.program
        for i, entity in enumerate(self.plan.entities):
            if entity.path is not None:
                p.init_action.append(self.action(entity.path, i))
        p.init_count[0] = len(p.init_action)

    def stretches(self, position: RandomPosition | AnyOfPosition, kind: str) -> tuple[int, int]:
        """Append what a random position is drawn from, once; return its first row and the one after its last."""
        p, network = self.program, self.network
        if (position, kind) not in self.spans:
            first = p.span_count[0]
            if isinstance(position, AnyOfPosition):
                for one in position.places:
                    p.span_road.append(network.road_index(one.road))
                    p.span_lane.append(one.lane)
                    p.span_const.append(self.block(one.s, one.s))
            else:
                behind, before = TRAFFIC_MARGINS if kind == "traffic" else (0.0, 0.0)
                for span in spans_of(network, position, behind=behind, before=before):
                    p.span_road.append(span.road)
                    p.span_lane.append(span.lane)
                    p.span_const.append(self.block(span.s_from, span.s_to))
            p.span_count[0] = len(p.span_road)
            self.spans[position, kind] = (first, p.span_count[0])
        return self.spans[position, kind]

    def position(self, position: Word, kind: str = "") -> int:
        """Append a position, of an entity of a kind; return its row."""
        p = self.program
        seed, spans = op.NONE, (0, 0)
        if isinstance(position, LanePosition):
            road, lane, entity = self.network.road_index(position.road), position.lane, op.NONE
            code = op.POSITION_LANE
            base = self.block(position.s, position.offset, position.turn)
        elif isinstance(position, RelativeLanePosition):
            road, lane, entity = op.NONE, position.lanes, self.entities[position.entity]
            code = op.POSITION_RELATIVE
            base = self.block(position.distance, position.offset, position.turn)
        elif isinstance(position, BesidePosition):
            road, lane, entity = op.NONE, 0, self.entities[position.entity]
            code = op.POSITION_BESIDE
            base = self.block(position.ahead, position.distance, position.turn)
        elif isinstance(position, RandomPosition | AnyOfPosition):
            road, lane, entity, code = op.NONE, 0, op.NONE, op.POSITION_RANDOM
            spans = self.stretches(position, kind)
            if isinstance(position, RandomPosition):
                seed = op.NONE if position.seed is None else position.seed
                base = self.block(position.clear, position.offset, position.turn)
            else:
                base = self.block(0.0, 0.0, 0.0)
        else:
            raise ValueError(f"the plan holds a position that is not bound to a lane: {position.tag()}")
        p.position_op.append(code)
        p.position_road.append(road)
        p.position_lane.append(lane)
        p.position_entity.append(entity)
        p.position_const.append(base)
        p.position_seed.append(seed)
        p.position_first.append(spans[0])
        p.position_last.append(spans[1])
        p.position_count[0] += 1
        return p.position_count[0] - 1

    def start_order(self) -> list[int]:
        """Return the entities so that each comes after the one that its start is relative to, random ones last."""
        p = self.program
        order: list[int] = []
        waiting = list(range(len(p.entity_motion)))
        while waiting:
            ready = [i for i in waiting if p.position_entity[p.entity_position[i]] in (op.NONE, *order)]
            fixed = [i for i in ready if p.position_op[p.entity_position[i]] != op.POSITION_RANDOM]
            ready = fixed or ready
            if not ready:
                names = ", ".join(self.plan.entities[i].id for i in waiting)
                raise ValueError(f"the starts of {names} are relative to each other")
            order.extend(ready)
            waiting = [i for i in waiting if i not in ready]
        return order

    def markings(self) -> None:
        p = self.program
        for stretch in self.plan.markings:
            begin = -1.0 if stretch.quality is None else stretch.quality
            end = begin if stretch.quality_to is None else stretch.quality_to
            p.stretch_road.append(self.network.road_index(stretch.road))
            p.stretch_lane.append(op.ALL_MARKS if stretch.lane is None else stretch.lane)
            p.stretch_const.append(self.block(stretch.s_from, stretch.s_to, begin, end, stretch.coverage))
        p.stretch_count[0] = len(p.stretch_road)

    def storyboard(self) -> None:
        p, board = self.program, self.plan.storyboard
        if board.stop is not None:
            p.stop_trigger[0] = self.trigger(board.stop)
        for story in board.stories:
            at = self.element(op.ELEMENT_STORY, op.NONE)
            for act in story.acts:
                act_at = self.element(op.ELEMENT_ACT, at, start=act.start, stop=act.stop)
                for group in act.groups:
                    group_at = self.element(op.ELEMENT_GROUP, act_at, limit=group.maximum_execution_count)
                    actors = [self.entities[actor] for actor in group.actors]
                    for maneuver in group.maneuvers:
                        maneuver_at = self.element(op.ELEMENT_MANEUVER, group_at)
                        for event in maneuver.events:
                            self.event(event, maneuver_at, actors)
        p.element_count[0] = len(p.element_kind)
        for condition, name in self.awaited:
            p.condition_other[condition] = self.events[name]

    def element(
        self,
        kind: int,
        parent: int,
        *,
        start: Trigger | None = None,
        stop: Trigger | None = None,
        limit: int = 1,
        priority: int = op.PRIORITY_PARALLEL,
        action: int = op.NONE,
    ) -> int:
        """Append an element as the last child of `parent`, whose subtree and its parents' grow by it."""
        p = self.program
        at = len(p.element_kind)
        p.element_kind.append(kind)
        p.element_parent.append(parent)
        p.element_end.append(at + 1)
        p.element_start.append(op.NONE if start is None else self.trigger(start))
        p.element_stop.append(op.NONE if stop is None else self.trigger(stop))
        p.element_limit.append(limit)
        p.element_priority.append(priority)
        p.element_action.append(action)
        while parent >= 0:
            p.element_end[parent] = at + 1
            parent = p.element_parent[parent]
        return at

    def event(self, event: Event, parent: int, actors: list[int]) -> None:
        at = self.element(
            op.ELEMENT_EVENT,
            parent,
            start=event.start,
            limit=event.maximum_execution_count,
            priority=PRIORITIES[event.priority],
        )
        self.events.setdefault(event.name, at)
        for named in event.actions:
            of_all = [self.program.ego[0]] if isinstance(named.action, RUN_ACTIONS) else actors
            for actor in of_all:
                self.element(op.ELEMENT_ACTION, at, action=self.action(named.action, actor))

    def points(self, path: FollowPathAction | Path) -> None:
        """Append the points of a path."""
        p = self.program
        for point in path.points:
            p.point_position.append(self.position(point.position))
            p.point_const.append(self.block(-1.0 if point.time is None else point.time))

    def action(self, action: Action | Path, actor: int) -> int:
        """Append an action of an entity; return its row."""
        p = self.program
        lanes, shape, other = 0, op.SHAPE_STEP, op.NONE
        first, drives_on = len(p.point_position), 0
        if isinstance(action, SpeedAction):
            code, shape, base = op.ACTION_SPEED, SHAPES[action.shape], self.block(action.to, action.over_time)
        elif isinstance(action, LaneChangeAction):
            code, shape, lanes = op.ACTION_LANE_CHANGE, SHAPES[action.shape], action.by
            base = self.block(0.0, action.over_time)
        elif isinstance(action, LaneOffsetAction):
            code, shape, base = op.ACTION_LANE_OFFSET, SHAPES[action.shape], self.block(action.to, action.over_time)
        elif isinstance(action, FollowPathAction | Path):
            self.points(action)
            code, drives_on = op.ACTION_FOLLOW_PATH, 1 if action.then == "drive" else 0
            base = self.block(-1.0 if action.speed is None else action.speed, 0.0)
        elif isinstance(action, SensorNoiseAction):
            code, base = op.ACTION_SENSOR_NOISE, self.block(action.sigma, 0.0)
        else:
            code, other, base = self.run_action(action)
        p.action_op.append(code)
        p.action_entity.append(actor)
        p.action_shape.append(shape)
        p.action_dimension.append(op.DIMENSION_TIME)
        p.action_lanes.append(lanes)
        p.action_other.append(other)
        p.action_const.append(base)
        p.action_point.append(first)
        p.action_points.append(len(p.point_position) - first)
        p.action_drives_on.append(drives_on)
        p.action_count[0] = len(p.action_op)
        return p.action_count[0] - 1

    def run_action(
        self, action: Failure | EndFailureAction | WeatherAction | MessageAction | StopAction
    ) -> tuple[int, int, int]:
        """Return (kind, what it refers to, block) of an action that concerns the run as a whole."""
        if isinstance(action, Failure):
            return op.ACTION_FAILURE, self.failure(action, waits=True), self.block(0.0, 0.0)
        if isinstance(action, EndFailureAction):
            kind = op.NONE if action.kind is None else FAILURE_CODES[action.kind]
            return op.ACTION_END_FAILURE, kind, self.block(0.0, 0.0)
        if isinstance(action, WeatherAction):
            return op.ACTION_WEATHER, self.weather(action), self.block(0.0, action.over_time)
        if isinstance(action, MessageAction):
            self.messages += 1
            return op.ACTION_MESSAGE, self.messages - 1, self.block(0.0, 0.0)
        return op.ACTION_STOP, op.NONE, self.block(0.0, 0.0)

    def failure(self, failure: Failure, *, waits: bool) -> int:
        """Append a failure of the camera, which `waits` for its action or counts from the start; return its row."""
        p = self.program
        duration = -1.0 if failure.duration is None else failure.duration
        p.failure_kind.append(FAILURE_CODES[failure.kind])
        p.failure_waits.append(1 if waits else 0)
        p.failure_const.append(self.block(failure.onset, duration, failure.ramp, failure.amount))
        p.failure_count[0] = len(p.failure_kind)
        return p.failure_count[0] - 1

    def weather(self, weather: Weather) -> int:
        """Append a weather; return its row."""
        p = self.program
        p.weather_const.append(self.block(*weather_numbers(weather)))
        p.weather_count[0] = len(p.weather_const)
        return p.weather_count[0] - 1

    def trigger(self, trigger: Trigger) -> int:
        """Append a trigger with its groups and conditions; return its row."""
        p = self.program
        for group in trigger.groups:
            for condition in group.conditions:
                self.condition(condition)
            p.group_first.append(p.condition_count[0])
        p.trigger_first.append(len(p.group_first) - 1)
        return len(p.trigger_first) - 2

    def condition(self, wrapped: TriggerCondition) -> None:
        p = self.program
        code, rule, value, entity, other = self.measured(wrapped.condition)
        if isinstance(wrapped.condition, EventCondition):
            self.awaited.append((p.condition_count[0], wrapped.condition.name))
        delayed = isinstance(wrapped.delay, Expression) or wrapped.delay > 0.0
        p.condition_op.append(code)
        p.condition_rule.append(rule)
        p.condition_edge.append(EDGES[wrapped.edge])
        p.condition_other.append(other)
        p.condition_all.append(0)
        p.condition_ring.append(p.ring_count[0] if delayed else op.NONE)
        p.ring_count[0] += 1 if delayed else 0
        p.condition_const.append(self.block(value, wrapped.delay))
        if entity:
            p.condition_entity.append(self.entities[entity])
        p.condition_first.append(len(p.condition_entity))
        p.condition_count[0] = len(p.condition_op)

    def measured(self, c: Condition) -> tuple[int, int, Slot, str, int]:
        """Return (kind, rule, value, triggering entity, what it refers to) of a condition."""
        less = op.RULE_LESS
        if isinstance(c, SimulationTimeCondition):
            return op.CONDITION_TIME, op.RULE_GREATER_OR_EQUAL, c.after, "", op.NONE
        if isinstance(c, TimeHeadwayCondition):
            return op.CONDITION_TIME_HEADWAY, less, c.below, c.entity, self.entities[c.to]
        if isinstance(c, DistanceCondition):
            return op.CONDITION_DISTANCE, less, c.below, c.entity, self.entities[c.to]
        if isinstance(c, TimeToCollisionCondition):
            return op.CONDITION_TIME_TO_COLLISION, less, c.below, c.entity, self.entities[c.to]
        if isinstance(c, SpeedCondition):
            return op.CONDITION_SPEED, RULES[c.rule], c.value, c.entity, op.NONE
        if isinstance(c, ReachPositionCondition):
            return op.CONDITION_REACH_POSITION, less, c.tolerance, c.entity, self.position(c.position)
        if isinstance(c, TraveledDistanceCondition):
            return op.CONDITION_TRAVELED_DISTANCE, op.RULE_GREATER_OR_EQUAL, c.distance, c.entity, op.NONE
        if isinstance(c, LaneConfidenceCondition):
            return op.CONDITION_LANE_CONFIDENCE, less, c.below, "", SIDES[c.side]
        if isinstance(c, SensorHealthCondition):
            return op.CONDITION_SENSOR_HEALTH, less, c.below, "", op.NONE
        if isinstance(c, StandstillCondition):
            return op.CONDITION_STANDSTILL, op.RULE_GREATER_OR_EQUAL, c.duration, c.entity, op.NONE
        if isinstance(c, EventCondition):
            rule, state = EVENT_STATES[c.state]
            return op.CONDITION_ELEMENT_STATE, rule, state, "", op.NONE
        assert isinstance(c, TakeoverStateCondition)
        return op.CONDITION_TAKEOVER_STATE, op.RULE_EQUAL, 0.0, "", STATES[c.state]
