"""Program: a plan as flat columns, the container `p` of every marked function.

All columns but `const` stay as they are during a run and over a sweep. Elements of the storyboard stand in document
order, parents before children, so that `element_end[e]` closes the subtree of `e`.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.forms.declaration import (
    FLAG,
    RUN,
    Allowed,
    Columns,
    Of,
    codes,
    column,
    container,
    fixed,
    index,
    index_or_none,
    row_starts,
    whole,
)
from scenario_compiler.roads.tables import LANE_LIMIT

ENTITY = Of("entity", lambda p: p.entity_count[0])
POSITION = Of("position", lambda p: p.position_count[0])
SPAN = Of("span", lambda p: p.span_count[0])
STRETCH = Of("stretch", lambda p: p.stretch_count[0])
ROUTE = Of("road of the route", lambda p: p.route_count[0])
ROAD = Of("road", lambda p: p.road_count[0])
GUIDE = Of("guide", lambda p: len(p.guide_last))
TURN = Of("turn of a guide", lambda p: 2 * p.road_count[0] * len(p.guide_last))
CONFLICT_OWNER = Of("road that others cross", lambda p: p.road_count[0] if p.traffic_count[0] > 0 else 0)
CONFLICT = Of("crossing road", lambda p: len(p.conflict_road))
TRACK = Of("trajectory", lambda p: len(p.track_kind))
CORNER = Of("corner", lambda p: len(p.corner_position))
VERTEX = Of("vertex", lambda p: p.vertex_count[0])
SAMPLE = Of("sample", lambda p: len(p.sample_corner))
ELEMENT = Of("element", lambda p: p.element_count[0])
TRIGGER = Of("trigger", lambda p: len(p.trigger_first) - 1)
GROUP = Of("group of conditions", lambda p: len(p.group_first) - 1)
CONDITION = Of("condition", lambda p: p.condition_count[0])
TRIGGERING = Of("triggering entity", lambda p: len(p.condition_entity))
RING = Of("record of past values", lambda p: p.ring_count[0])
SET = Of("set of whole numbers", lambda p: len(p.set_first) - 1)
MEMBER = Of("member of a set", lambda p: len(p.set_member))
VARIABLE = Of("variable", lambda p: p.variable_count[0])
SIGNAL = Of("signal", lambda p: p.signal_count[0])
HEAD = Of("head of a signal", lambda p: p.head_count[0])
TEXT = Of("text", lambda p: len(p.text_aspect))
SIGNAL_CONTROLLER = Of("controller of signals", lambda p: p.controller_count[0])
PHASE = Of("phase", lambda p: len(p.phase_name))
LIGHT = Of("state of a signal", lambda p: len(p.light_signal))
ACTION = Of("action", lambda p: p.action_count[0])
PIECE = Of("piece of a plan of speeds", lambda p: p.piece_count[0])
POINT = Of("point of a path", lambda p: len(p.point_position))
INIT = Of("action of the init", lambda p: p.init_count[0])
CAUSE = fixed("cause", op.CAUSES)
ASKING = Of("cause that is switched on", lambda p: p.cause_count[0])
FAILURE = Of("failure", lambda p: p.failure_count[0])
WEATHER = Of("weather", lambda p: p.weather_count[0])
NUMBER = Of("number", lambda p: len(p.const))

SLOT = Allowed(Of("place of a number", lambda p: len(p.const) + 1))
"""Slot of a number in `const`, or of the first of several; a block without numbers may begin after the last slot."""

COUNT = whole(0)


@container("p", 1)
class Program(Columns):
    """The columns of a plan: SI units, radians, indices into other columns, codes of `opcodes`."""

    const: list[float] = column(NUMBER, written=True)
    """All numbers of the plan, at the slots of `slots`; a sweep replaces them row by row."""

    # The run.
    entity_count: list[int] = column(RUN, 0, COUNT)
    ego: list[int] = column(RUN, op.NONE, index_or_none(ENTITY))
    """Index of the automated vehicle, or NONE."""
    perception: list[int] = column(RUN, 0, codes(op.PERCEPTION_SURROGATE + 1))
    surrogate_const: list[int] = column(RUN, 0, SLOT)
    """Slot of the first coefficient of surrogate perception; not read with another perception."""
    forward_sensor: list[int] = column(RUN, op.SENSOR_CAMERA, codes(op.SENSOR_LIDAR + 1))
    control_every: list[int] = column(RUN, 1, whole(1))
    """Number of time steps between two control steps."""
    image_every: list[int] = column(RUN, 1, whole(1))
    """Number of time steps between two images of the camera, a multiple of `control_every`."""
    driver_reference: list[int] = column(RUN, 0, codes(op.REFERENCES))
    """Reference driver that drives after the response, or REFERENCE_NONE for the model of a human driver."""
    replaced_by: list[int] = column(RUN, 0, codes(op.REFERENCES))
    """Reference driver that drives from the start instead of automation and driver, or REFERENCE_NONE."""
    driver_kind: list[int] = column(RUN, 0, codes(op.DRIVER_SUMO + 1))
    person: list[int] = column(RUN, 0, FLAG)
    """1 if a person is at the wheel, whose inputs Python writes."""
    minimum_risk: list[int] = column(RUN, 1, FLAG)
    """1 if there is a minimum-risk manoeuvre."""
    hazard_lights: list[int] = column(RUN, 1, FLAG)
    """1 if the hazard lights flash from the beginning of the minimum-risk manoeuvre."""
    destination_road: list[int] = column(RUN, op.NONE, index_or_none(ROAD))
    destination_lane: list[int] = column(RUN)
    road_count: list[int] = column(RUN, 0, COUNT)
    watches: list[int] = column(RUN, 0, COUNT)
    """WATCH_... bits: quantities of entities that conditions use and that are therefore measured."""
    stop_trigger: list[int] = column(RUN, op.NONE, index_or_none(TRIGGER))

    # Numbers of rows.
    route_count: list[int] = column(RUN, 0, COUNT)
    stretch_count: list[int] = column(RUN, 0, COUNT)
    position_count: list[int] = column(RUN, 0, COUNT)
    element_count: list[int] = column(RUN, 0, COUNT)
    condition_count: list[int] = column(RUN, 0, COUNT)
    action_count: list[int] = column(RUN, 0, COUNT)
    init_count: list[int] = column(RUN, 0, COUNT)
    vertex_count: list[int] = column(RUN, 0, COUNT)
    piece_count: list[int] = column(RUN, 0, COUNT)
    span_count: list[int] = column(RUN, 0, COUNT)
    traffic_count: list[int] = column(RUN, 0, COUNT)
    """Number of entities that are background traffic."""
    failure_count: list[int] = column(RUN, 0, COUNT)
    weather_count: list[int] = column(RUN, 0, COUNT)
    ring_count: list[int] = column(RUN, 0, COUNT)
    variable_count: list[int] = column(RUN, 0, COUNT)
    signal_count: list[int] = column(RUN, 0, COUNT)
    """Number of traffic signals that the scenario names."""
    controller_count: list[int] = column(RUN, 0, COUNT)
    cause_count: list[int] = column(RUN, 0, COUNT)

    # Entities.
    entity_motion: list[int] = column(ENTITY, 0, codes(op.MOTION_WALKER + 1))
    entity_type: list[int] = column(ENTITY, 0, codes(op.KIND_THING + 1))
    """KIND_... code of the entity."""
    entity_present: list[int] = column(ENTITY, 0, FLAG)
    """1 if the entity is present from the start, 0 if an action lets it appear."""
    entity_const: list[int] = column(ENTITY, 0, SLOT)
    """First slot of the entity's block of numbers."""
    entity_position: list[int] = column(ENTITY, 0, index_or_none(POSITION))
    """Start position, or NONE for one off every road."""
    entity_follows: list[int] = column(ENTITY, 0, FLAG)
    """1 if it follows the vehicle ahead."""
    entity_guide: list[int] = column(ENTITY, 0, index_or_none(GUIDE))
    """Guide to the entity's destination, or NONE."""
    entity_seed: list[int] = column(ENTITY, 0, whole(op.NONE, 1 << 32))
    """Seed of the random turns of background traffic, or NONE for the run's."""
    entity_order: list[int] = column(ENTITY, 0, index(ENTITY))
    """Entities in an order in which each comes after the one that its start position is relative to."""

    # Trajectories: corners are vertices, pieces of clothoids or control points.
    track_kind: list[int] = column(TRACK, 0, codes(op.TRACK_NURBS + 1))
    track_closed: list[int] = column(TRACK, 0, FLAG)
    """1 if a trajectory continues at its beginning."""
    track_inner: list[int] = column(TRACK, 0, index(TRACK))
    """First of the trajectories on which its vertices lie, which are all before it; itself if there is none."""
    track_raised: list[int] = column(TRACK, 0, FLAG)
    """1 if positions of a trajectory have heights."""
    track_order: list[int] = column(TRACK, 0, whole(0, 1000))
    """Order of a NURBS."""
    track_corner: list[int] = row_starts(TRACK, CORNER)
    track_vertex: list[int] = row_starts(TRACK, VERTEX)
    """Row starts of the vertices, which are columns of the state."""
    track_sample: list[int] = row_starts(TRACK, SAMPLE)
    """Row starts of the samples of a NURBS."""
    corner_position: list[int] = column(CORNER, 0, index_or_none(POSITION))
    """Position of a corner, or NONE for a piece that begins at the end of the previous one."""
    corner_const: list[int] = column(CORNER, 0, SLOT)
    corner_samples: list[int] = column(CORNER, 0, Allowed(Of("vertex", lambda p: p.vertex_count[0] + 1)))
    vertex_heading: list[int] = column(VERTEX, 0, FLAG)
    """1 if the heading of a vertex is given."""
    sample_corner: list[int] = column(SAMPLE, 0, Allowed(Of("corner", lambda p: len(p.corner_const) + 1)))
    """First of the control points that contribute to a sample."""
    sample_const: list[int] = column(SAMPLE, 0, SLOT)
    """Weights of these control points, then the sample's fractional index among the control points, counted from 0."""

    # Routes.
    guide_next: list[int] = column(TURN, 0, index_or_none(ROAD))
    """By guide, road and direction of travel (against s, along s): the next road, or NONE."""
    guide_last: list[int] = column(GUIDE, 0, index_or_none(ROAD))
    """Last road of a guide, or NONE if it is a circuit."""
    conflict_first: list[int] = row_starts(CONFLICT_OWNER, CONFLICT)
    """Row starts by road; empty without background traffic."""
    conflict_road: list[int] = column(CONFLICT, 0, index(ROAD))
    """Connecting roads that cross the road."""
    route_road: list[int] = column(ROUTE, 0, index(ROAD))
    """Roads of the ego's route in order, once for each time they are driven."""

    # Positions.
    position_op: list[int] = column(POSITION, 0, codes(op.POSITION_KINDS))
    position_road: list[int] = column(POSITION, 0, index_or_none(ROAD))
    position_lane: list[int] = column(POSITION)
    """Lane id; for relative positions the number of lanes to the left, for one on a trajectory the trajectory's index.
    """
    position_entity: list[int] = column(POSITION, 0, index_or_none(ENTITY))
    position_const: list[int] = column(POSITION, 0, SLOT)
    position_flags: list[int] = column(POSITION, 0, COUNT)
    """Switches as bits: POSITION_ABSOLUTE and the following ones."""
    position_guide: list[int] = column(POSITION, 0, index_or_none(GUIDE))
    """Guide of the route on which the position lies, which an entity placed there follows, or NONE."""
    position_seed: list[int] = column(POSITION, 0, whole(op.NONE, 1 << 32))
    """Seed of a random position, or NONE for the run's."""
    position_first: list[int] = column(POSITION, 0, Allowed(Of("span", lambda p: p.span_count[0] + 1)))
    """First of the stretches from which a random position is drawn."""
    position_last: list[int] = column(POSITION, 0, Allowed(Of("span", lambda p: p.span_count[0] + 1)))
    """The stretch after the last one."""
    span_road: list[int] = column(SPAN, 0, index(ROAD))
    span_lane: list[int] = column(SPAN, 0, whole(1 - LANE_LIMIT, LANE_LIMIT))
    span_const: list[int] = column(SPAN, 0, SLOT)

    # Marks that are worn or repainted.
    stretch_road: list[int] = column(STRETCH, 0, index_or_none(ROAD))
    stretch_lane: list[int] = column(STRETCH, 0, whole(-op.ALL_MARKS, op.ALL_MARKS + 1))
    """Lane on whose outer border the marks lie, 0 for the centre line, or ALL_MARKS."""
    stretch_const: list[int] = column(STRETCH, 0, SLOT)

    # The storyboard.
    element_kind: list[int] = column(ELEMENT, 0, codes(op.ELEMENT_ACTION + 1))
    element_parent: list[int] = column(ELEMENT, 0, index_or_none(ELEMENT))
    element_end: list[int] = column(ELEMENT, 0, Allowed(Of("element", lambda p: p.element_count[0] + 1), 1))
    element_start: list[int] = column(ELEMENT, 0, index_or_none(TRIGGER))
    """Start trigger of an act or event, or NONE."""
    element_stop: list[int] = column(ELEMENT, 0, index_or_none(TRIGGER))
    """Stop trigger of an act, or NONE."""
    element_limit: list[int] = column(ELEMENT, 0, whole(1))
    """Greatest number of executions of a group or event."""
    element_priority: list[int] = column(ELEMENT, 0, codes(op.PRIORITY_SKIP + 1))
    element_action: list[int] = column(ELEMENT, 0, index_or_none(ACTION))
    """Action of an ELEMENT_ACTION, or NONE."""
    trigger_first: list[int] = row_starts(TRIGGER, GROUP)
    group_first: list[int] = row_starts(GROUP, CONDITION)

    # Conditions.
    condition_op: list[int] = column(CONDITION, 0, COUNT)
    condition_rule: list[int] = column(CONDITION, 0, codes(op.RULE_NOT_EQUAL + 1))
    condition_edge: list[int] = column(CONDITION, 0, codes(op.EDGE_BOTH + 1))
    condition_const: list[int] = column(CONDITION, 0, SLOT)
    condition_other: list[int] = column(CONDITION, 0, whole(op.NONE))
    """Reference entity, element, takeover state or side of the lane, depending on the condition."""
    condition_mode: list[int] = column(CONDITION, 0, COUNT)
    """What is measured and how, depending on the condition."""
    condition_flags: list[int] = column(CONDITION, 0, COUNT)
    """Switches as bits, depending on the condition."""
    condition_position: list[int] = column(CONDITION, 0, index_or_none(POSITION))
    """Position of the condition, or NONE."""
    condition_all: list[int] = column(CONDITION, 0, FLAG)
    """1 if all triggering entities must fulfil the condition, 0 if any of them suffices."""
    condition_first: list[int] = row_starts(CONDITION, TRIGGERING)
    condition_entity: list[int] = column(TRIGGERING, 0, index(ENTITY))
    condition_owner: list[int] = column(CONDITION, 0, index_or_none(ELEMENT))
    """Element to whose trigger the condition belongs, NONE for the stop trigger of the storyboard."""
    condition_ring: list[int] = column(CONDITION, 0, index_or_none(RING))
    """Index of its record of past values, or NONE for a condition without delay."""
    set_first: list[int] = row_starts(SET, MEMBER)
    set_member: list[int] = column(MEMBER)
    """Members of the sets of integers that conditions use."""

    # Actions.
    action_op: list[int] = column(ACTION, 0, COUNT)
    action_entity: list[int] = column(ACTION, 0, index_or_none(ENTITY))
    """Actor of the action, NONE for an action on the run as a whole without an ego."""
    action_shape: list[int] = column(ACTION, 0, codes(op.SHAPE_STEP + 1))
    action_dimension: list[int] = column(ACTION, 0, codes(op.DIMENSION_DISTANCE + 1))
    action_lanes: list[int] = column(ACTION)
    """Number of lanes to the left, lane id, number of entries or entity, depending on the action."""
    action_other: list[int] = column(ACTION, 0, whole(op.RANDOM_GUIDE))
    """The failure that begins, the kind of failure that ends, the weather or the message, depending on the action."""
    action_mode: list[int] = column(ACTION, 0, COUNT)
    """Variant of the action, depending on the action."""
    action_flags: list[int] = column(ACTION, 0, COUNT)
    """Switches as bits, or the central entity of a swarm, depending on the action."""
    action_position: list[int] = column(ACTION, 0, index_or_none(POSITION))
    """Position of the action, or NONE."""
    action_const: list[int] = column(ACTION, 0, SLOT)
    action_point: list[int] = column(ACTION, 0, Allowed(Of("point", lambda p: len(p.point_position) + 1)))
    """First point of a path."""
    action_points: list[int] = column(ACTION, 0, Allowed(Of("point", lambda p: len(p.point_position) + 1)))
    """Number of its points."""
    action_drives_on: list[int] = column(ACTION, 0, FLAG)
    """1 if the entity continues along the lane at the end of its path."""
    action_piece: list[int] = row_starts(ACTION, PIECE)
    """Row starts of the pieces of a speed profile's plan."""
    point_position: list[int] = column(POINT, 0, index(POSITION))
    point_const: list[int] = column(POINT, 0, SLOT)
    init_action: list[int] = column(INIT, 0, index(ACTION))
    """Actions that start with the run, in order."""

    # The camera, the weather, variables and traffic signals.
    failure_kind: list[int] = column(FAILURE, 0, codes(op.FAILURES))
    failure_waits: list[int] = column(FAILURE, 0, FLAG)
    """1 if the failure waits for an action to begin it, 0 if it counts from the start."""
    failure_const: list[int] = column(FAILURE, 0, SLOT)
    weather_const: list[int] = column(WEATHER, 0, SLOT)
    """Blocks of 14 numbers: the weather at the start, then those of actions."""
    variable_const: list[int] = column(VARIABLE, 0, SLOT)
    """Slot of each variable's start value."""
    controller_reference: list[int] = column(SIGNAL_CONTROLLER, 0, index_or_none(SIGNAL_CONTROLLER))
    """For each traffic signal controller the one from which its delay counts, or NONE."""
    controller_const: list[int] = column(SIGNAL_CONTROLLER, 0, SLOT)
    phase_first: list[int] = row_starts(SIGNAL_CONTROLLER, PHASE)
    phase_name: list[int] = column(PHASE)
    """Index of the phase's name in the list of texts."""
    phase_const: list[int] = column(PHASE, 0, SLOT)
    light_first: list[int] = row_starts(PHASE, LIGHT)
    light_signal: list[int] = column(LIGHT, 0, index(SIGNAL))
    light_state: list[int] = column(LIGHT, 0, COUNT)

    head_count: list[int] = column(RUN)
    """Number of heads: one where a signal stands, and one where another road refers to it."""
    head_signal: list[int] = column(HEAD, 0, index(SIGNAL))
    head_road: list[int] = column(HEAD, 0, index(ROAD))
    head_const: list[int] = column(HEAD, 0, SLOT)
    """Slot of the head's s."""
    head_sense: list[int] = column(HEAD, 0, whole(-1, 2))
    """1 if it applies to travel along s, -1 against s, 0 to both."""
    head_from: list[int] = column(HEAD)
    """First and last lane to which it applies."""
    head_to: list[int] = column(HEAD)
    text_aspect: list[int] = column(TEXT, 0, codes(op.ASPECT_STOP + 1))
    """ASPECT_... code of each text as the state of a signal."""

    # The takeover.
    before_request: list[int] = column(RUN, op.BEHAVIOUR_FOLLOW)
    """BEHAVIOUR_... code of the automation before and after a request."""
    after_request: list[int] = column(RUN, op.BEHAVIOUR_FOLLOW)
    cause_on: list[int] = column(CAUSE, 0, FLAG)
    """1 for each cause of a takeover request that is switched on."""
    cause_order: list[int] = column(ASKING, 0, whole(1, op.CAUSES))
    """The causes that are switched on; if several ask at the same time, the first one is reported.

    The camera's health is always the first of them, because the confidence falls with it.
    """
