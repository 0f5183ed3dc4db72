"""Program: a plan as flat columns, the container `p` of every compiled function, and the checks of its indices.

All columns but `const` stay as they are during a run and over a sweep. Lists of `..._first` are row starts (CSR): the
members of k are `first[k] .. first[k + 1] - 1`. Elements of the storyboard stand in document order, parents before
children, so that `element_end[e]` closes the subtree of `e`.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields

from scenario_compiler.engine.opcodes import (
    ACTION_ADD_ENTITY,
    ACTION_COMMAND,
    ACTION_CONNECT_TRAILER,
    ACTION_DELETE_ENTITY,
    ACTION_END_FAILURE,
    ACTION_ENVIRONMENT,
    ACTION_FAILURE,
    ACTION_KINDS,
    ACTION_MESSAGE,
    ACTION_MODIFY_VARIABLE,
    ACTION_OVERRIDE_CONTROLLER,
    ACTION_SENSOR_NOISE,
    ACTION_SET_VARIABLE,
    ACTION_SIGNAL_PHASE,
    ACTION_SIGNAL_STATE,
    ACTION_STOP,
    ACTION_STOP_TRAFFIC,
    ACTION_TELEPORT,
    ACTION_TRAFFIC_SINK,
    ACTION_TRAFFIC_SOURCE,
    ACTION_TRAFFIC_SWARM,
    ACTION_WEATHER,
    ALL_MARKS,
    CAUSES,
    CONDITION_CLEARANCE,
    CONDITION_DISTANCE,
    CONDITION_ELEMENT_STATE,
    CONDITION_KINDS,
    CONDITION_POSITION_DISTANCE,
    CONDITION_REACH_POSITION,
    CONDITION_RELATIVE_ANGLE,
    CONDITION_RELATIVE_SPEED,
    CONDITION_SIGNAL,
    CONDITION_SIGNAL_PHASE,
    CONDITION_TIME_HEADWAY,
    CONDITION_TRANSITION,
    CONDITION_VARIABLE,
    DIMENSION_DISTANCE,
    DRIVER_FIXED,
    EDGE_BOTH,
    ELEMENT_ACTION,
    FAILURES,
    HELD_INPUTS,
    KIND_THING,
    MOTION_WALKER,
    NONE,
    PERCEPTION_CAMERA,
    POSITION_BESIDE,
    POSITION_KINDS,
    POSITION_LANE,
    POSITION_LANES_AWAY,
    POSITION_ON_TRAJECTORY,
    POSITION_RELATIVE,
    POSITION_RELATIVE_OBJECT,
    POSITION_RELATIVE_ROAD,
    POSITION_RELATIVE_WORLD,
    PRIORITY_SKIP,
    RANDOM_GUIDE,
    RULE_NOT_EQUAL,
    SHAPE_STEP,
    TRACK_NURBS,
)

OF_THE_RUN = frozenset(
    {
        ACTION_SENSOR_NOISE,
        ACTION_FAILURE,
        ACTION_END_FAILURE,
        ACTION_WEATHER,
        ACTION_MESSAGE,
        ACTION_STOP,
        ACTION_SET_VARIABLE,
        ACTION_MODIFY_VARIABLE,
        ACTION_SIGNAL_STATE,
        ACTION_SIGNAL_PHASE,
        ACTION_ENVIRONMENT,
        ACTION_COMMAND,
        ACTION_STOP_TRAFFIC,
        ACTION_TRAFFIC_SWARM,
        ACTION_TRAFFIC_SOURCE,
        ACTION_TRAFFIC_SINK,
        ACTION_ADD_ENTITY,
        ACTION_DELETE_ENTITY,
    }
)
"""Actions that need no entity."""

TO_AN_ENTITY = (ACTION_ADD_ENTITY, ACTION_DELETE_ENTITY, ACTION_CONNECT_TRAILER)
"""Actions that something happens to another entity by."""

TO_A_POSITION = (
    ACTION_TELEPORT,
    ACTION_ADD_ENTITY,
    ACTION_TRAFFIC_SWARM,
    ACTION_TRAFFIC_SOURCE,
    ACTION_TRAFFIC_SINK,
)
"""Actions that need a position."""

FROM_AN_ENTITY = (
    POSITION_RELATIVE,
    POSITION_BESIDE,
    POSITION_LANES_AWAY,
    POSITION_RELATIVE_ROAD,
    POSITION_RELATIVE_OBJECT,
    POSITION_RELATIVE_WORLD,
)
"""Positions counted from where an entity is."""

OF_AN_ENTITY = (CONDITION_TIME_HEADWAY, CONDITION_DISTANCE, CONDITION_RELATIVE_SPEED, CONDITION_RELATIVE_ANGLE)
"""Conditions between two entities."""

OF_AN_ELEMENT = (CONDITION_ELEMENT_STATE, CONDITION_TRANSITION)
"""Conditions on elements of the storyboard: the first, and by their flags how many after it."""

OF_A_POSITION = (CONDITION_REACH_POSITION, CONDITION_POSITION_DISTANCE)
"""Conditions on a position."""


@dataclass(slots=True)
class Program:
    """The columns of a plan: SI units, radians, indices into other columns, codes of `opcodes`."""

    const: list[float] = field(default_factory=list)
    """Every number, by the slots of `slots`; replaced row by row in a sweep."""

    # One element each.
    entity_count: list[int] = field(default_factory=lambda: [0])
    ego: list[int] = field(default_factory=lambda: [NONE])
    """Number of the vehicle that the takeover is about, or NONE."""
    perception: list[int] = field(default_factory=lambda: [0])
    control_every: list[int] = field(default_factory=lambda: [1])
    image_every: list[int] = field(default_factory=lambda: [1])
    """Number of time steps between two images of the camera, whole control steps."""
    driver_kind: list[int] = field(default_factory=lambda: [0])
    hazard_lights: list[int] = field(default_factory=lambda: [1])
    """1 where the hazard lights flash from the minimum-risk manoeuvre on."""
    destination_road: list[int] = field(default_factory=lambda: [NONE])
    destination_lane: list[int] = field(default_factory=lambda: [0])
    route_count: list[int] = field(default_factory=lambda: [0])
    stretch_count: list[int] = field(default_factory=lambda: [0])
    position_count: list[int] = field(default_factory=lambda: [0])
    element_count: list[int] = field(default_factory=lambda: [0])
    condition_count: list[int] = field(default_factory=lambda: [0])
    action_count: list[int] = field(default_factory=lambda: [0])
    init_count: list[int] = field(default_factory=lambda: [0])
    stop_trigger: list[int] = field(default_factory=lambda: [NONE])

    entity_motion: list[int] = field(default_factory=list)
    entity_type: list[int] = field(default_factory=list)
    """KIND_... of what the entity is."""
    entity_present: list[int] = field(default_factory=list)
    """1 where it is there from the start, 0 where an action lets it appear."""
    entity_const: list[int] = field(default_factory=list)
    """First slot of the entity's block."""
    entity_position: list[int] = field(default_factory=list)
    """Position that it starts at, or NONE: off every road."""
    entity_follows: list[int] = field(default_factory=list)
    """1 where it follows the vehicle ahead."""
    track_kind: list[int] = field(default_factory=list)
    """TRACK_..., by trajectory."""
    track_closed: list[int] = field(default_factory=list)
    """1 where a trajectory goes on at its begin."""
    track_order: list[int] = field(default_factory=list)
    """Order of a NURBS."""
    track_corner: list[int] = field(default_factory=lambda: [0])
    """Row starts of corners by trajectory: vertices, pieces of clothoids, control points."""
    track_vertex: list[int] = field(default_factory=lambda: [0])
    """Row starts of vertices, in the state's columns, by trajectory."""
    track_sample: list[int] = field(default_factory=lambda: [0])
    """Row starts of a NURBS' samples by trajectory."""
    corner_position: list[int] = field(default_factory=list)
    """Position of a corner, or NONE for a piece that begins where the one before ends."""
    corner_const: list[int] = field(default_factory=list)
    corner_samples: list[int] = field(default_factory=list)
    vertex_heading: list[int] = field(default_factory=list)
    """1 where the heading of a vertex is given."""
    vertex_count: list[int] = field(default_factory=lambda: [0])
    sample_corner: list[int] = field(default_factory=list)
    """First of the control points that a sample is made of."""
    sample_const: list[int] = field(default_factory=list)
    """Their shares, and then its place between the control points, counted from 0, for its time."""
    entity_guide: list[int] = field(default_factory=list)
    """Guide to the entity's destination, or NONE."""
    guide_next: list[int] = field(default_factory=list)
    """By guide, road and sense (against s, along s): the road that comes next, or NONE."""
    guide_last: list[int] = field(default_factory=list)
    """Road with which a guide ends, or NONE where it goes round."""
    road_count: list[int] = field(default_factory=lambda: [0])
    entity_seed: list[int] = field(default_factory=list)
    """Seed of traffic's turns, or NONE for the run's."""
    traffic_count: list[int] = field(default_factory=lambda: [0])
    """Number of entities that are background traffic."""
    conflict_first: list[int] = field(default_factory=lambda: [0])
    """Row starts by road, with background traffic alone."""
    conflict_road: list[int] = field(default_factory=list)
    """Connecting roads that the road crosses."""
    entity_order: list[int] = field(default_factory=list)
    """Entities so that each comes after the one that its start is relative to."""

    position_op: list[int] = field(default_factory=list)
    position_road: list[int] = field(default_factory=list)
    position_lane: list[int] = field(default_factory=list)
    """Lane id; for relative positions the number of lanes to the left."""
    position_entity: list[int] = field(default_factory=list)
    position_const: list[int] = field(default_factory=list)
    position_flags: list[int] = field(default_factory=list)
    """Switches as bits: POSITION_ABSOLUTE and those after it."""
    position_guide: list[int] = field(default_factory=list)
    """Guide of the route that it lies on, which an entity that is put there takes, or NONE."""
    position_seed: list[int] = field(default_factory=list)
    """Seed of a random position, or NONE for the run's."""
    position_first: list[int] = field(default_factory=list)
    """First stretch that a random position is drawn from."""
    position_last: list[int] = field(default_factory=list)
    """The stretch after its last."""
    span_road: list[int] = field(default_factory=list)
    span_lane: list[int] = field(default_factory=list)
    span_const: list[int] = field(default_factory=list)
    span_count: list[int] = field(default_factory=lambda: [0])

    route_road: list[int] = field(default_factory=list)
    """Roads of the ego's way in order, each once a pass."""

    stretch_road: list[int] = field(default_factory=list)
    stretch_lane: list[int] = field(default_factory=list)
    """Lane on whose outer border the marks lie, 0 for the centre line, or ALL_MARKS."""
    stretch_const: list[int] = field(default_factory=list)

    element_kind: list[int] = field(default_factory=list)
    element_parent: list[int] = field(default_factory=list)
    element_end: list[int] = field(default_factory=list)
    element_start: list[int] = field(default_factory=list)
    """Start trigger of an act or event, or NONE."""
    element_stop: list[int] = field(default_factory=list)
    """Stop trigger of an act, or NONE."""
    element_limit: list[int] = field(default_factory=list)
    """Greatest number of executions of a group or event."""
    element_priority: list[int] = field(default_factory=list)
    element_action: list[int] = field(default_factory=list)
    """Action of an ELEMENT_ACTION, or NONE."""

    trigger_first: list[int] = field(default_factory=lambda: [0])
    """Row starts of groups by trigger."""
    group_first: list[int] = field(default_factory=lambda: [0])
    """Row starts of conditions by group."""

    failure_kind: list[int] = field(default_factory=list)
    failure_waits: list[int] = field(default_factory=list)
    """1 where the failure waits for the action that begins it, 0 where it counts from the start."""
    failure_const: list[int] = field(default_factory=list)
    failure_count: list[int] = field(default_factory=lambda: [0])

    weather_const: list[int] = field(default_factory=list)
    """Blocks of 14 numbers: the weather at the start, then those of actions."""
    weather_count: list[int] = field(default_factory=lambda: [0])

    condition_op: list[int] = field(default_factory=list)
    condition_rule: list[int] = field(default_factory=list)
    condition_edge: list[int] = field(default_factory=list)
    condition_const: list[int] = field(default_factory=list)
    condition_other: list[int] = field(default_factory=list)
    """The reference entity, element, takeover state or side of the lane, by kind."""
    condition_mode: list[int] = field(default_factory=list)
    """A choice between ways to measure, by kind."""
    condition_flags: list[int] = field(default_factory=list)
    """Switches as bits, by kind."""
    condition_position: list[int] = field(default_factory=list)
    """Position that it speaks of, or NONE."""
    condition_all: list[int] = field(default_factory=list)
    """1 where all triggering entities must fulfil it, 0 where any does."""
    condition_first: list[int] = field(default_factory=lambda: [0])
    """Row starts of triggering entities by condition."""
    condition_entity: list[int] = field(default_factory=list)
    condition_owner: list[int] = field(default_factory=list)
    """Element whose trigger it stands in, NONE for the stop trigger of the storyboard."""
    condition_ring: list[int] = field(default_factory=list)
    """Number of its record of past values, or NONE for a condition without delay."""
    ring_count: list[int] = field(default_factory=lambda: [0])

    set_first: list[int] = field(default_factory=lambda: [0])
    """Row starts of sets of integers that conditions look into."""
    set_member: list[int] = field(default_factory=list)
    watches: list[int] = field(default_factory=lambda: [0])
    """WATCH_... bits: what is measured of entities because some condition asks for it."""

    variable_const: list[int] = field(default_factory=list)
    """Slot of the value that each variable begins with."""
    variable_count: list[int] = field(default_factory=lambda: [0])
    signal_count: list[int] = field(default_factory=lambda: [0])
    """Number of traffic signals that the scenario names."""
    controller_reference: list[int] = field(default_factory=list)
    """By controller of signals the one that its delay counts from, or NONE."""
    controller_const: list[int] = field(default_factory=list)
    controller_count: list[int] = field(default_factory=lambda: [0])
    phase_first: list[int] = field(default_factory=lambda: [0])
    """Row starts of phases by controller."""
    phase_name: list[int] = field(default_factory=list)
    """Place of the phase's name in the list of texts."""
    phase_const: list[int] = field(default_factory=list)
    light_first: list[int] = field(default_factory=lambda: [0])
    """Row starts of states by phase."""
    light_signal: list[int] = field(default_factory=list)
    light_state: list[int] = field(default_factory=list)

    action_op: list[int] = field(default_factory=list)
    action_entity: list[int] = field(default_factory=list)
    """The entity that does it, NONE for an action on the run as a whole without an ego."""
    action_shape: list[int] = field(default_factory=list)
    action_dimension: list[int] = field(default_factory=list)
    action_lanes: list[int] = field(default_factory=list)
    """Lanes to the left, the lane's id, the number of entries or an entity, by kind."""
    action_other: list[int] = field(default_factory=list)
    """The failure that an action begins, the kind that it ends, the weather or the message; by kind."""
    action_mode: list[int] = field(default_factory=list)
    """A choice between ways to do it, by kind."""
    action_flags: list[int] = field(default_factory=list)
    """Switches as bits, or the entity in the middle of a swarm, by kind."""
    action_position: list[int] = field(default_factory=list)
    """Position that it speaks of, or NONE."""
    action_const: list[int] = field(default_factory=list)
    action_point: list[int] = field(default_factory=list)
    """First point of a path."""
    action_points: list[int] = field(default_factory=list)
    """Number of its points."""
    action_drives_on: list[int] = field(default_factory=list)
    """1 where the entity goes on along the lane at the end of its path."""
    point_position: list[int] = field(default_factory=list)
    point_const: list[int] = field(default_factory=list)
    init_action: list[int] = field(default_factory=list)
    """Actions that start with the run, in order."""

    cause_on: list[int] = field(default_factory=lambda: [0] * CAUSES)
    """1 for each cause of a takeover request that is switched on."""
    cause_count: list[int] = field(default_factory=lambda: [0])
    cause_order: list[int] = field(default_factory=list)
    """The causes that are switched on; where several ask at once, the first is named."""


def _validate_tracks(p: Program) -> None:
    """Check the columns of trajectories."""
    _column("track_kind", p.track_kind, len(p.track_closed), 0, TRACK_NURBS + 1)
    _rows("track_corner", p.track_corner, len(p.corner_position))
    _rows("track_vertex", p.track_vertex, p.vertex_count[0])
    _rows("track_sample", p.track_sample, len(p.sample_corner))
    _column("track_closed", p.track_closed, len(p.track_kind), 0, 2)
    _column("track_order", p.track_order, len(p.track_kind), 0, 1000)
    _column("corner_position", p.corner_position, len(p.corner_const), NONE, p.position_count[0])
    _column("corner_samples", p.corner_samples, len(p.corner_const), 0, p.vertex_count[0] + 1)
    _inside("corner_const", p.corner_const, 0, len(p.const) + 1)
    _column("sample_const", p.sample_const, len(p.sample_corner), 0, len(p.const) + 1)
    _inside("sample_corner", p.sample_corner, 0, len(p.corner_const) + 1)
    _column("vertex_heading", p.vertex_heading, p.vertex_count[0], 0, 2)


def validate(program: Program, roads: int) -> None:
    """Check every code, index and row start against its column; `roads` is the number of roads of the map.

    Raises:
        ValueError: A column refers outside another one; a fault of the code that filled it.
    """
    p = program
    entities, positions = p.entity_count[0], p.position_count[0]
    conditions, actions, elements = p.condition_count[0], p.action_count[0], p.element_count[0]
    triggers = len(p.trigger_first) - 1
    _inside("ego", p.ego, NONE, entities)
    _validate_run(p, roads)
    _column("entity_motion", p.entity_motion, entities, 0, MOTION_WALKER + 1)
    _column("entity_type", p.entity_type, entities, 0, KIND_THING + 1)
    _column("entity_present", p.entity_present, entities, 0, 2)
    _column("entity_const", p.entity_const, entities, 0, len(p.const) + 1)
    _column("entity_position", p.entity_position, entities, NONE, positions)
    _column("entity_follows", p.entity_follows, entities, 0, 2)
    _validate_tracks(p)
    _column("entity_guide", p.entity_guide, entities, NONE, len(p.guide_last))
    _column("guide_next", p.guide_next, 2 * roads * len(p.guide_last), NONE, roads)
    _inside("guide_last", p.guide_last, NONE, roads)
    _inside("road_count", p.road_count, roads, roads + 1)
    _column("entity_seed", p.entity_seed, entities, NONE, 1 << 32)
    _rows("conflict_first", p.conflict_first, len(p.conflict_road))
    _inside("conflict_road", p.conflict_road, 0, roads)
    if p.traffic_count[0] > 0:
        _column("conflict_first", p.conflict_first, roads + 1, 0, len(p.conflict_road) + 1)
    _column("entity_order", p.entity_order, entities, 0, entities)
    _column("position_op", p.position_op, positions, 0, POSITION_KINDS)
    _column("position_flags", p.position_flags, positions, 0, 1 << 30)
    _column("position_road", p.position_road, positions, NONE, roads)
    _column("position_entity", p.position_entity, positions, NONE, entities)
    _column("position_const", p.position_const, positions, 0, len(p.const) + 1)
    _column("position_guide", p.position_guide, positions, NONE, len(p.guide_last))
    _column("position_seed", p.position_seed, positions, NONE, 1 << 32)
    _column("position_first", p.position_first, positions, 0, p.span_count[0] + 1)
    _column("position_last", p.position_last, positions, 0, p.span_count[0] + 1)
    _column("span_road", p.span_road, p.span_count[0], 0, roads)
    _column("span_lane", p.span_lane, p.span_count[0], -1000, 1000)
    _column("span_const", p.span_const, p.span_count[0], 0, len(p.const) + 1)
    _validate_story(p, elements, triggers, conditions, actions)
    for column in fields(Program):
        values = getattr(p, column.name)
        kind = float if column.name == "const" else int
        if any(type(value) is not kind for value in values):
            raise ValueError(f"column {column.name} holds something else than {kind.__name__}")


def _validate_run(p: Program, roads: int) -> None:
    _inside("perception", p.perception, 0, PERCEPTION_CAMERA + 1)
    _inside("control_every", p.control_every, 1, 1 << 30)
    _inside("image_every", p.image_every, 1, 1 << 30)
    _inside("driver_kind", p.driver_kind, 0, DRIVER_FIXED + 1)
    _inside("hazard_lights", p.hazard_lights, 0, 2)
    _inside("destination_road", p.destination_road, NONE, roads)
    _column("route_road", p.route_road, p.route_count[0], 0, roads)
    _column("stretch_road", p.stretch_road, p.stretch_count[0], NONE, roads)
    _column("stretch_lane", p.stretch_lane, p.stretch_count[0], -ALL_MARKS, ALL_MARKS + 1)
    _column("stretch_const", p.stretch_const, p.stretch_count[0], 0, len(p.const) + 1)
    _column("failure_kind", p.failure_kind, p.failure_count[0], 0, FAILURES)
    _column("failure_waits", p.failure_waits, p.failure_count[0], 0, 2)
    _column("failure_const", p.failure_const, p.failure_count[0], 0, len(p.const) + 1)
    _column("weather_const", p.weather_const, p.weather_count[0], 0, len(p.const) + 1)
    _inside("cause_on", p.cause_on, 0, 2)
    _column("cause_order", p.cause_order, p.cause_count[0], 1, CAUSES)


def _validate_story(p: Program, elements: int, triggers: int, conditions: int, actions: int) -> None:
    entities = p.entity_count[0]
    _column("element_kind", p.element_kind, elements, 0, ELEMENT_ACTION + 1)
    _column("element_parent", p.element_parent, elements, NONE, elements)
    _column("element_end", p.element_end, elements, 1, elements + 1)
    _column("element_start", p.element_start, elements, NONE, triggers)
    _column("element_stop", p.element_stop, elements, NONE, triggers)
    _column("element_limit", p.element_limit, elements, 1, 1 << 30)
    _column("element_priority", p.element_priority, elements, 0, PRIORITY_SKIP + 1)
    _column("element_action", p.element_action, elements, NONE, actions)
    _inside("stop_trigger", p.stop_trigger, NONE, triggers)
    _rows("trigger_first", p.trigger_first, len(p.group_first) - 1)
    _rows("group_first", p.group_first, conditions)
    _column("condition_op", p.condition_op, conditions, 0, CONDITION_KINDS)
    _column("condition_rule", p.condition_rule, conditions, 0, RULE_NOT_EQUAL + 1)
    _column("condition_edge", p.condition_edge, conditions, 0, EDGE_BOTH + 1)
    _column("condition_const", p.condition_const, conditions, 0, len(p.const) + 1)
    _column("condition_mode", p.condition_mode, conditions, 0, 1 << 30)
    _column("condition_flags", p.condition_flags, conditions, 0, 1 << 30)
    _column("condition_position", p.condition_position, conditions, NONE, p.position_count[0])
    _column("condition_all", p.condition_all, conditions, 0, 2)
    _column("condition_owner", p.condition_owner, conditions, NONE, elements)
    _column("condition_ring", p.condition_ring, conditions, NONE, p.ring_count[0])
    _rows("condition_first", p.condition_first, len(p.condition_entity))
    _inside("condition_entity", p.condition_entity, 0, entities)
    _rows("set_first", p.set_first, len(p.set_member))
    _validate_world(p)
    _validate_places(p)
    _column("action_op", p.action_op, actions, 0, ACTION_KINDS)
    _column("action_entity", p.action_entity, actions, NONE, entities)
    for kind, entity in zip(p.action_op, p.action_entity, strict=True):
        if entity == NONE and kind not in OF_THE_RUN:
            raise ValueError(f"column action_entity holds no entity for an action of kind {kind}")
    _column("action_shape", p.action_shape, actions, 0, SHAPE_STEP + 1)
    _column("action_dimension", p.action_dimension, actions, 0, DIMENSION_DISTANCE + 1)
    _column("action_other", p.action_other, actions, RANDOM_GUIDE, 1 << 30)
    _column("action_mode", p.action_mode, actions, 0, 1 << 30)
    _column("action_flags", p.action_flags, actions, 0, 1 << 30)
    _column("action_position", p.action_position, actions, NONE, p.position_count[0])
    _column("action_const", p.action_const, actions, 0, len(p.const) + 1)
    _column("action_point", p.action_point, actions, 0, len(p.point_position) + 1)
    _column("action_points", p.action_points, actions, 0, len(p.point_position) + 1)
    _column("action_drives_on", p.action_drives_on, actions, 0, 2)
    _inside("point_position", p.point_position, 0, p.position_count[0])
    _column("point_const", p.point_const, len(p.point_position), 0, len(p.const) + 1)
    _column("init_action", p.init_action, p.init_count[0], 0, actions)


def _validate_places(p: Program) -> None:
    """Check what positions are relative to, and what actions on places refer to."""
    for k, kind in enumerate(p.position_op):
        if kind in FROM_AN_ENTITY:
            _inside("position_entity", p.position_entity[k : k + 1], 0, p.entity_count[0])
        if kind == POSITION_ON_TRAJECTORY:
            _inside("position_lane", p.position_lane[k : k + 1], 0, len(p.track_kind))
        if kind == POSITION_LANE:
            _inside("position_road", p.position_road[k : k + 1], 0, 1 << 30)
    for k, kind in enumerate(p.action_op):
        if kind in TO_AN_ENTITY:
            _inside("action_other", p.action_other[k : k + 1], 0, p.entity_count[0])
        if kind in TO_A_POSITION:
            _inside("action_position", p.action_position[k : k + 1], 0, p.position_count[0])


def _validate_world(p: Program) -> None:
    """Check the columns of variables and traffic signals, and what conditions and actions refer to."""
    entities, elements, slots = p.entity_count[0], p.element_count[0], len(p.const) + 1
    phases, lights = len(p.phase_name), len(p.light_signal)
    _column("variable_const", p.variable_const, p.variable_count[0], 0, slots)
    _column("controller_reference", p.controller_reference, p.controller_count[0], NONE, p.controller_count[0])
    _column("controller_const", p.controller_const, p.controller_count[0], 0, slots)
    _column("phase_first", p.phase_first, p.controller_count[0] + 1, 0, phases + 1)
    _rows("phase_first", p.phase_first, phases)
    _column("phase_const", p.phase_const, phases, 0, slots)
    _column("light_first", p.light_first, phases + 1, 0, lights + 1)
    _rows("light_first", p.light_first, lights)
    _inside("light_signal", p.light_signal, 0, p.signal_count[0])
    _column("light_state", p.light_state, lights, 0, 1 << 30)
    _column("condition_other", p.condition_other, p.condition_count[0], NONE, 1 << 30)
    sizes = {
        **dict.fromkeys(OF_AN_ENTITY, entities),
        **dict.fromkeys(OF_AN_ELEMENT, elements),
        CONDITION_CLEARANCE: len(p.set_first) - 2,
        CONDITION_VARIABLE: p.variable_count[0],
        CONDITION_SIGNAL: p.signal_count[0],
        CONDITION_SIGNAL_PHASE: p.controller_count[0],
    }
    for c, kind in enumerate(p.condition_op):
        if kind in sizes:
            _inside("condition_other", p.condition_other[c : c + 1], 0, sizes[kind])
        if kind in OF_AN_ELEMENT:
            _inside("condition_flags", p.condition_flags[c : c + 1], 0, elements - p.condition_other[c])
        if kind in OF_A_POSITION:
            _inside("condition_position", p.condition_position[c : c + 1], 0, p.position_count[0])
    sizes = {
        ACTION_SET_VARIABLE: p.variable_count[0],
        ACTION_MODIFY_VARIABLE: p.variable_count[0],
        ACTION_SIGNAL_STATE: p.signal_count[0],
        ACTION_SIGNAL_PHASE: p.controller_count[0],
    }
    for k, kind in enumerate(p.action_op):
        if kind in sizes:
            _inside("action_other", p.action_other[k : k + 1], 0, sizes[kind])
        if kind == ACTION_TRAFFIC_SWARM:
            _inside("action_flags", p.action_flags[k : k + 1], 0, entities)
        if kind in (ACTION_STOP_TRAFFIC, ACTION_TRAFFIC_SWARM, ACTION_TRAFFIC_SOURCE):
            _inside("action_lanes", [p.action_other[k] + p.action_lanes[k]], 0, entities + 1)
        if kind == ACTION_OVERRIDE_CONTROLLER:
            _inside("action_mode", p.action_mode[k : k + 1], 0, HELD_INPUTS)


def _inside(name: str, values: list[int], low: int, high: int) -> None:
    for value in values:
        if not low <= value < high:
            raise ValueError(f"column {name} holds {value}, outside {low} .. {high - 1}")


def _column(name: str, values: list[int], count: int, low: int, high: int) -> None:
    if len(values) != count:
        raise ValueError(f"column {name} has {len(values)} values, not {count}")
    _inside(name, values, low, high)


def _rows(name: str, starts: list[int], total: int) -> None:
    if starts[0] != 0 or starts[-1] != total or sorted(starts) != starts:
        raise ValueError(f"row starts {name} do not divide {total} members")
