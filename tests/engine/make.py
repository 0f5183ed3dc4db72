"""Programs and maps made for the engine's tests."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.program.checking import check_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.engine.story.table import NUMBERS as CONDITION
from scenario_compiler.roads import Network, load_network
from scenario_compiler.vocabulary.lane_keeping import LANE_KEEPING

ROAD = """<road name="" id="{id}" length="{length}" junction="-1">
  <link>{link}</link>
  <planView><geometry s="0" x="{x}" y="0" hdg="0" length="{length}">{shape}</geometry></planView>
  <lanes><laneSection s="0">{left}
    <center><lane id="0" type="none" level="false">
      <roadMark sOffset="0" type="broken" width="0.15" color="white"/></lane></center>
    <right>{right}</right>
  </laneSection></lanes></road>"""
LANE = """<lane id="{id}" type="driving" level="false"><link>{link}</link>
  <width sOffset="0" a="{a}" b="{b}" c="0" d="0"/>
  <roadMark sOffset="0" type="{mark}" width="0.15" color="white"/></lane>"""


def lane(number: int, mark: str = "broken", *, a: float = 3.5, b: float = 0.0, link: str = "") -> str:
    """Return a driving lane of a width a + b s."""
    return LANE.format(id=number, a=a, b=b, mark=mark, link=link)


def road(
    number: int, length: float, *lanes: str, left: str = "", x: float = 0.0, shape: str = "<line/>", link: str = ""
) -> str:
    """Return a road that begins at (x, 0) along the x axis; `lanes` are its right ones, from the inside."""
    text = f"<left>{left}</left>" if left else ""
    return ROAD.format(id=number, length=length, x=x, shape=shape, left=text, right="".join(lanes), link=link)


@cache
def network_of(*roads: str) -> Network:
    """Return the network of some roads."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "map.xodr"
        header = '<header revMajor="1" revMinor="4" name="" version="1" date="2026"/>'
        path.write_text(f"<OpenDRIVE>{header}{''.join(roads)}</OpenDRIVE>", encoding="utf-8")
        network = load_network(path, cache=False)
        assert network is not None
        network.model()  # pictures need it, when the file is gone
        return network


def highway(length: float = 2000.0) -> Network:
    """Return a straight road with one lane to the left (oncoming) and three to the right."""
    return network_of(road(1, length, lane(-1), lane(-2), lane(-3, "solid"), left=lane(1, "solid")))


def bend(radius: float, length: float = 1000.0) -> Network:
    """Return a left-hand bend with a lane each way."""
    arc = f'<arc curvature="{1.0 / radius!r}"/>'
    return network_of(road(1, length, lane(-1, "solid"), left=lane(1, "solid"), shape=arc))


def ramp(end: float = 300.0, length: float = 1000.0) -> Network:
    """Return a road of two lanes whose right one ends at `end`: it is 3.5 m wide and tapers off over 40 m."""
    begin = end - 40.0
    narrow = (
        f'<lane id="-2" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
        f'<width sOffset="{begin}" a="3.5" b="{-3.5 / 40.0}" c="0" d="0"/>'
        f'<width sOffset="{end}" a="0" b="0" c="0" d="0"/>'
        '<roadMark sOffset="0" type="solid" width="0.15" color="white"/></lane>'
    )
    return network_of(road(1, length, lane(-1), narrow))


CAR = (4.5, 1.8, 1.5, 2.7, 1.4, 0.6, 3.5, 8.0, 60.0)
"""Length, width, height, wheelbase, centre, greatest steering angle, acceleration, deceleration and speed."""

FOLLOW = (1.5, 2.0, 1.5, 2.0)
TOWING = (-1.0, 3.0)
"""x of hitch and coupler."""
PITCHING = (0.0035,)
"""Pitch of the body in braking, rad per m/s2."""
USUAL = {
    slots.K_STEP: 0.05,
    slots.K_DURATION: 30.0,
    slots.K_BUDGET: 7.0,
    slots.K_ESCALATE_AFTER: 4.0,
    **{slots.K_RISK_AFTER + cause: 10.0 for cause in range(op.CAUSES)},
    slots.K_MINIMUM_RISK_DECELERATION: 4.0,
    slots.K_CONFIDENCE_WARNING: 0.6,
    slots.K_CONFIDENCE_REQUEST: 0.3,
    slots.K_CONFIDENCE_COUNT: 5.0,
    slots.K_CONFIDENCE_OF: 8.0,
    slots.K_HEALTH_WARNING: 0.6,
    slots.K_HEALTH_REQUEST: 0.3,
    slots.K_HEALTH_COUNT: 5.0,
    slots.K_HEALTH_OF: 8.0,
    slots.K_BLOCKED_MARGIN: 0.5,
    slots.K_BLOCKED_COUNT: 2.0,
    slots.K_BLOCKED_OF: 3.0,
    slots.K_SENSOR_RANGE: 150.0,
    slots.K_FIELD_OF_VIEW: 1.05,
    slots.K_LANE_END_COUNT: 2.0,
    slots.K_LANE_END_OF: 3.0,
    slots.K_GAP_FRONT: 1.0,
    slots.K_GAP_REAR: 2.0,
    slots.K_DRIVER_TIME: 2.0,
    slots.K_NO_PROGRESS_AFTER: 5.0,
    slots.K_WARNING_LEAD: 1.0,
    slots.K_WARNING_AFTER: 0.3,
    slots.K_WARNING_LEAST: 5.0,
    slots.K_WARNING_CLEAR: 1.0,
    slots.K_CONFIDENCE_OVER: 0.7,
    slots.K_HEALTH_OVER: 0.7,
    slots.K_BLOCKED_BUDGET: -1.0,
    slots.K_BLOCKED_WARNING: -1.0,
    slots.K_LANE_END_BUDGET: -1.0,
    slots.K_LANE_END_WARNING: -1.0,
    slots.K_SLOW_DOWN: 1.0,
    slots.K_EYES_ON: 0.3,
    slots.K_STEERS: 1.0,
    slots.K_DRIVER_DECELERATION: 7.59,
    slots.K_DRIVER_LATERAL: 5.0,
    slots.K_SIGHT: 300.0,
    slots.K_LOOK_BESIDE: 1.0,
    slots.K_HEADLIGHTS: 100.0,
    slots.K_PERCEPTION_TIME: 0.4,
    slots.K_REACTION_TIME: 0.75,
    slots.K_SDLP: 0.2,
    slots.K_SDLP_AT_FIRST: 0.35,
    slots.K_SETTLED_AFTER: 37.5,
    slots.K_HANDS_ON: 0.4,
    slots.K_STAGE_SPREAD: 0.4,
    slots.K_INPUT_STEERING: 0.035,
    slots.K_INPUT_BRAKE: 0.1,
    slots.K_STEERING_RATIO: 16.0,
    **{slots.K_LOOK_AHEAD_TIME + place: number for place, number in enumerate(LANE_KEEPING.values())},
}


class Draft:
    """A program under construction, column by column. Entities are numbered in the order in which they are added."""

    def __init__(self, network: Network, numbers: dict[int, float] | None = None) -> None:
        self.network = network
        self.program = p = Program()
        p.const = [0.0] * slots.K_ENTITIES
        for slot, value in {**USUAL, **(numbers or {})}.items():
            p.const[slot] = value
        p.driver_kind[0] = op.DRIVER_FIXED
        self.causes(
            op.CAUSE_CONTROLLER,
            op.CAUSE_SENSOR_HEALTH,
            op.CAUSE_LANE_CONFIDENCE,
            op.CAUSE_PATH_BLOCKED,
            op.CAUSE_LANE_ENDS,
            op.CAUSE_NO_PROGRESS,
        )

    def causes(self, *codes: int) -> None:
        """Switch these causes on, and no others."""
        p = self.program
        p.cause_on = [1 if code in codes else 0 for code in range(op.CAUSES)]
        p.cause_order = list(codes)
        p.cause_count = [len(codes)]

    def block(self, *numbers: float) -> int:
        """Append numbers; return the slot of the first."""
        self.program.const.extend(float(number) for number in numbers)
        return len(self.program.const) - len(numbers)

    def position(self, road: int, lane: int, s: float, offset: float = 0.0, turn: float = 0.0) -> int:
        """Append a lane position by the road's index; return its row."""
        return self.any_position(op.POSITION_LANE, road, lane, op.NONE, s, offset, turn)

    def ahead_of(self, entity: int, distance: float, lanes: int = 0, offset: float = 0.0, turn: float = 0.0) -> int:
        """Append a position relative to an entity's start; return its row."""
        return self.any_position(op.POSITION_RELATIVE, op.NONE, lanes, entity, distance, offset, turn)

    def any_position(self, kind: int, road: int, lane: int, entity: int, s: float, offset: float, turn: float) -> int:
        """Append a position; return its row."""
        p = self.program
        p.position_op.append(kind)
        p.position_road.append(road)
        p.position_lane.append(lane)
        p.position_entity.append(entity)
        p.position_const.append(self.block(s, offset, turn))
        p.position_flags.append(0)
        p.position_guide.append(op.NONE)
        p.position_seed.append(op.NONE)
        p.position_first.append(0)
        p.position_last.append(0)
        p.position_count[0] += 1
        return p.position_count[0] - 1

    def entity(
        self,
        motion: int,
        position: int,
        speed: float = 0.0,
        *,
        follows: bool = False,
        desired: float | None = None,
        car: tuple[float, ...] = CAR,
    ) -> int:
        """Append an entity; a bicycle or posed one is the ego. Return its number."""
        p = self.program
        at = p.entity_count[0]
        p.entity_count[0] += 1
        p.entity_motion.append(motion)
        p.entity_type.append(op.KIND_VEHICLE)
        p.entity_position.append(position)
        p.entity_follows.append(1 if follows else 0)
        p.entity_order.append(at)
        p.entity_guide.append(op.NONE)
        p.entity_seed.append(op.NONE)
        p.entity_present.append(1)
        p.entity_const.append(
            self.block(*car, speed, speed if desired is None else desired, *FOLLOW, 1.0, *TOWING, *PITCHING)
        )
        if motion in (op.MOTION_BICYCLE, op.MOTION_POSED):
            p.ego[0] = at
        return at

    def ego(self, lane: int = -1, s: float = 50.0, speed: float = 14.0) -> int:
        """Append the ego on the first road."""
        return self.entity(op.MOTION_BICYCLE, self.position(0, lane, s), speed)

    def parked(self, s: float, lane: int = -1, offset: float = 0.0, turn: float = 0.0) -> int:
        """Append a standing vehicle on the first road."""
        return self.entity(op.MOTION_STATIC, self.position(0, lane, s, offset, turn))

    def moving(self, lane: int, s: float, speed: float, *, follows: bool = False) -> int:
        """Append a scripted vehicle on the first road."""
        return self.entity(op.MOTION_SCRIPTED, self.position(0, lane, s), speed, follows=follows)

    def condition(
        self,
        kind: int,
        value: float,
        *,
        rule: int = op.RULE_GREATER_OR_EQUAL,
        entities: tuple[int, ...] = (),
        other: int = op.NONE,
        position: int = op.NONE,
        mode: int = 0,
        flags: int = 0,
        owner: int = op.NONE,
        more: tuple[float, ...] = (),
        edge: int = op.EDGE_NONE,
        delay: float = 0.0,
        every: bool = False,
    ) -> int:
        """Append a condition to the group under construction; return its row."""
        p = self.program
        p.condition_op.append(kind)
        p.condition_rule.append(rule)
        p.condition_edge.append(edge)
        p.condition_other.append(other)
        p.condition_mode.append(mode)
        p.condition_flags.append(flags)
        p.condition_position.append(position)
        p.condition_owner.append(owner)
        p.condition_all.append(1 if every else 0)
        p.condition_ring.append(p.ring_count[0] if delay > 0.0 else op.NONE)
        p.ring_count[0] += 1 if delay > 0.0 else 0
        p.condition_const.append(self.block(value, delay, *more))
        p.condition_entity.extend(entities)
        p.condition_first.append(len(p.condition_entity))
        p.condition_count[0] += 1
        return p.condition_count[0] - 1

    def close_group(self) -> None:
        """End the group of conditions."""
        self.program.group_first.append(self.program.condition_count[0])

    def trigger(self) -> int:
        """End the trigger (and its last group, when conditions wait for one); return its row."""
        p = self.program
        if p.group_first[-1] != p.condition_count[0]:
            self.close_group()
        p.trigger_first.append(len(p.group_first) - 1)
        return len(p.trigger_first) - 2

    def at_time(self, time: float, **details: object) -> int:
        """Return a trigger on the simulation time."""
        self.condition(CONDITION["time"], time, **details)  # type: ignore[arg-type]
        return self.trigger()

    def element(
        self,
        kind: int,
        parent: int = op.NONE,
        *,
        start: int = op.NONE,
        stop: int = op.NONE,
        limit: int = 1,
        priority: int = op.PRIORITY_PARALLEL,
        action: int = op.NONE,
    ) -> int:
        """Append an element of the storyboard as the last child of its parent; return its row."""
        p = self.program
        at = p.element_count[0]
        p.element_count[0] += 1
        p.element_kind.append(kind)
        p.element_parent.append(parent)
        p.element_end.append(at + 1)
        p.element_start.append(start)
        p.element_stop.append(stop)
        p.element_limit.append(limit)
        p.element_priority.append(priority)
        p.element_action.append(action)
        while parent >= 0:
            p.element_end[parent] = at + 1
            parent = p.element_parent[parent]
        return at

    def maneuver(self, *, limit: int = 1, stop: int = op.NONE) -> int:
        """Append a story with an act, a group and a maneuver; return the maneuver's row."""
        story = self.element(op.ELEMENT_STORY)
        act = self.element(op.ELEMENT_ACT, story, stop=stop)
        group = self.element(op.ELEMENT_GROUP, act, limit=limit)
        return self.element(op.ELEMENT_MANEUVER, group)

    def event(
        self, maneuver: int, start: int, *actions: int, priority: int = op.PRIORITY_PARALLEL, limit: int = 1
    ) -> int:
        """Append an event with these actions; return its row."""
        at = self.element(op.ELEMENT_EVENT, maneuver, start=start, priority=priority, limit=limit)
        for action in actions:
            self.element(op.ELEMENT_ACTION, at, action=action)
        return at

    def action(
        self,
        kind: int,
        entity: int,
        *,
        target: float = 0.0,
        value: float = 0.0,
        shape: int = op.SHAPE_LINEAR,
        dimension: int = op.DIMENSION_TIME,
        lanes: int = 0,
    ) -> int:
        """Append an action; return its row."""
        p = self.program
        p.action_op.append(kind)
        p.action_entity.append(entity)
        p.action_shape.append(shape)
        p.action_dimension.append(dimension)
        p.action_lanes.append(lanes)
        p.action_other.append(op.NONE)
        p.action_mode.append(0)
        p.action_flags.append(0)
        p.action_position.append(op.NONE)
        p.action_const.append(self.block(target, value))
        p.action_point.append(0)
        p.action_points.append(0)
        p.action_drives_on.append(0)
        p.action_piece.append(p.piece_count[0])
        p.action_count[0] += 1
        return p.action_count[0] - 1

    def failure(self, kind: int, onset: float, duration: float, ramp: float, amount: float, waits: bool = False) -> int:
        """Append a failure of the camera; return its row."""
        p = self.program
        p.failure_kind.append(kind)
        p.failure_waits.append(1 if waits else 0)
        p.failure_const.append(self.block(onset, duration, ramp, amount))
        p.failure_count[0] += 1
        return p.failure_count[0] - 1

    def weather(self, *numbers: float) -> int:
        """Append a weather; return its row."""
        p = self.program
        p.weather_const.append(self.block(*numbers))
        p.weather_count[0] += 1
        return p.weather_count[0] - 1

    def run_action(self, kind: int, other: int = op.NONE, value: float = 0.0) -> int:
        """Append an action that concerns the run as a whole."""
        k = self.action(kind, 0, value=value)
        self.program.action_other[k] = other
        return k

    def speed(self, entity: int, target: float, value: float, **details: int) -> int:
        """Append a change of speed."""
        return self.action(ACTION["speed"], entity, target=target, value=value, **details)

    def lane_change(
        self, entity: int, lanes: int, value: float, shape: int = op.SHAPE_SINUSOIDAL, **details: int
    ) -> int:
        """Append a change of lane, positive to the left."""
        return self.action(ACTION["lane_change"], entity, value=value, lanes=lanes, shape=shape, **details)

    def done(self) -> Program:
        """Return the program, validated."""
        self.program.road_count[0] = len(self.network.road_ids)
        self.program.road_count[0] = len(self.network.road_ids)
        check_program(self.program)
        return self.program

    def start(self, seed: int = 1) -> Run:
        """Return a run of it at t = 0."""
        return Run(self.network, self.done(), seed)


class Run:
    """An interpreted run."""

    def __init__(self, network: Network, program: Program, seed: int = 1) -> None:
        self.n = network.tables
        self.p = program
        self.st: State = new_state(program)
        self.st.draw[:] = make_draws(seed)
        reset(self.n, self.p, self.st)

    def go(self, until: float = 1e9) -> Run:
        """Step until a time or the end; return itself."""
        while self.st.stop[0] == op.STOP_NONE and self.st.clock[0] < until - 1e-6:
            step(self.n, self.p, self.st)
        return self

    def events(self) -> list[tuple[int, float]]:
        """Return kind and time of what was logged."""
        return [(self.st.log_kind[k], self.st.log_time[k]) for k in range(self.st.log_count[0])]

    def time_of(self, kind: int) -> float:
        """Return when a kind of event was first logged, -1 for never."""
        return next((time for logged, time in self.events() if logged == kind), -1.0)
