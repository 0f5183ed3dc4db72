"""State: everything that changes during a run, as flat columns of a fixed size.

`put_to_start` puts every column to its declared start but what is kept, so one state serves all variants of a sweep.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import (
    ACTION,
    CAUSE,
    CONDITION,
    ELEMENT,
    ENTITY,
    FAILURE,
    PIECE,
    POSITION,
    RING,
    SIGNAL,
    SIGNAL_CONTROLLER,
    VARIABLE,
    VERTEX,
    Program,
)
from scenario_compiler.engine.columns.view import SAMPLES, UNITS, VIEW_SIZE
from scenario_compiler.forms.declaration import RUN, Columns, Of, at_start, column, container, fixed
from scenario_compiler.randomness import hash_bits, normal

RECORD = Of("past value", lambda p: p.ring_count[0] * op.DELAY_RECORDS)
WAY = fixed("stretch of the way ahead", op.WAY_SIZE)
LOG = fixed("event", op.LOG_SIZE)
BUCKET = fixed("chain of entities", op.BUCKETS)
HELD_INPUT = fixed("held input", op.HELD_INPUTS)
FAILURE_KIND = fixed("kind of failure", op.FAILURES)
WEATHER_NUMBER = fixed("number of a weather", op.WEATHER_SIZE)
SIDE = fixed("side of the lane", 2)
UNIT = fixed("unit of a network, for each side", 2 * UNITS)
VIEW = fixed("feature of a view", VIEW_SIZE)
LOOKED = fixed("piece of the way in which paint is looked at", SAMPLES)
DRAW = fixed("draw", op.DRAWS_PER_RUN)

STEER_RATE = 0.7
"""Greatest rate of the front wheels' angle, rad/s: 640 deg/s at the steering wheel with a ratio of 16, a quick
driver's.
"""


@container("st", 2, written=True)
class State(Columns):
    """The columns of a run: SI units, radians, OpenDRIVE axes; codes of `opcodes`."""

    # The run, one element each.
    clock: list[float] = column(RUN)
    """Time, s: the number of steps times the step, so that equal times are equal numbers."""
    steps: list[int] = column(RUN)
    """Number of steps that were taken."""
    frame: list[int] = column(RUN)
    """Number of the frame; 0 is the one of length 0."""
    stop: list[int] = column(RUN, op.STOP_NONE)
    """STOP_... as soon as the run is over."""
    flag: list[int] = column(RUN, op.FAULT_NONE)
    """FAULT_...; a fault stops the run."""
    flag_at: list[int] = column(RUN, op.NONE)
    """The entity, condition or action that the fault is about."""
    draw: list[float] = column(DRAW, kept=True)
    """Draws made before the run: DRAW_PERSON and DRAW_SEED."""

    # Entities.
    present: list[int] = column(ENTITY)
    """1 while the entity is in the world; an absent one does not move, collide or hide, and is not seen."""
    x: list[float] = column(ENTITY)
    y: list[float] = column(ENTITY)
    z: list[float] = column(ENTITY)
    h: list[float] = column(ENTITY)
    pitch: list[float] = column(ENTITY)
    """Of the road below and of the body on its springs."""
    body_pitch: list[float] = column(ENTITY)
    """What the body adds to the pitch of the road, of a vehicle that is driven by commands."""
    roll: list[float] = column(ENTITY)
    v: list[float] = column(ENTITY)
    a: list[float] = column(ENTITY)
    steer: list[float] = column(ENTITY)
    """Angle of the front wheels, positive to the left."""
    steer_rate: list[float] = column(ENTITY, STEER_RATE)
    """Greatest rate of that angle, rad/s."""
    throttle: list[float] = column(ENTITY)
    brake: list[float] = column(ENTITY)
    road: list[int] = column(ENTITY)
    """Index of the road, -1 off every road."""
    lane: list[int] = column(ENTITY)
    s: list[float] = column(ENTITY)
    off: list[float] = column(ENTITY)
    """Left of the lane's centre in the road's s direction."""
    t: list[float] = column(ENTITY)
    """Left of the reference line."""
    facing: list[int] = column(ENTITY, 1)
    """1 where the entity's forward direction goes along s, else -1."""
    turn: list[float] = column(ENTITY)
    """Heading relative to `facing` along the lane."""
    kept_lane: list[int] = column(ENTITY)
    """Lane that a scripted entity is led by: the one it belongs to, or the target of a lane change."""
    kept_off: list[float] = column(ENTITY)
    changing: list[int] = column(ENTITY)
    """1 where a lane change leads the entity, until it settles: it belongs to the lane that its point is in."""
    here_road: list[int] = column(ENTITY, op.NONE)
    """Where the lane's row and the road's piece below were found last: road and lane."""
    here_lane: list[int] = column(ENTITY)
    here_from: list[float] = column(ENTITY)
    """They hold for every s from here to before `here_to`."""
    here_to: list[float] = column(ENTITY, -1.0)
    here_row: list[int] = column(ENTITY, op.NONE)
    here_piece: list[int] = column(ENTITY)
    odometer: list[float] = column(ENTITY)
    still: list[float] = column(ENTITY, -1.0)
    """How long the entity has stood, s; negative while it moves."""
    at_end: list[float] = column(ENTITY, -1.0)
    """How long it has stood at the end of a road, s; negative while it does not."""
    off_road: list[float] = column(ENTITY, -1.0)
    """How long it has been off every lane, s; negative while it is on one."""
    velocity_x: list[float] = column(ENTITY)
    """Velocity and acceleration in the world, where a condition asks for them."""
    velocity_y: list[float] = column(ENTITY)
    velocity_z: list[float] = column(ENTITY)
    acceleration_x: list[float] = column(ENTITY)
    acceleration_y: list[float] = column(ENTITY)
    acceleration_z: list[float] = column(ENTITY)
    before_x: list[float] = column(ENTITY)
    before_y: list[float] = column(ENTITY)
    before_z: list[float] = column(ENTITY)
    follows: list[int] = column(ENTITY)
    """1 while it follows the vehicle ahead."""
    controller: list[int] = column(ENTITY)
    """CONTROLLER_... that it has."""
    desired: list[float] = column(ENTITY)
    """Speed that it aims for while it follows."""
    ended: list[int] = column(ENTITY)
    """1 when the entity stands at the end of its road."""
    lights: list[int] = column(ENTITY)
    """Lights that actions have switched on, as bits: the first of `moves.appearance.LIGHTS` is the lowest."""
    visible: list[int] = column(ENTITY, op.SEEN_BY_ALL)
    """Observers to whom the entity is visible, as SEEN_... bits."""
    towed: list[int] = column(ENTITY, op.NONE)
    """Trailer that it tows, or NONE."""
    towed_by: list[int] = column(ENTITY, op.NONE)
    trains: list[int] = column(RUN)
    """1 from the first trailer that is connected on; one element."""
    moved: list[int] = column(ENTITY)
    """1 when an action has moved the entity in this step; taking stock clears it."""
    longitudinal: list[int] = column(ENTITY, op.NONE)
    """Action that changes the entity's speed, or -1."""
    lateral: list[int] = column(ENTITY, op.NONE)
    """Action that changes the entity's lane, or -1."""
    last_x: list[float] = column(ENTITY)
    last_y: list[float] = column(ENTITY)
    last_v: list[float] = column(ENTITY)
    order: list[int] = column(ENTITY)
    """Entities by the x of their boxes' left ends."""
    reach: list[float] = column(ENTITY)
    """Half diagonal of the entity's box."""
    middle_x: list[float] = column(ENTITY)
    """Centre of the entity's box."""
    middle_y: list[float] = column(ENTITY)
    box_h: list[float] = column(ENTITY)
    """Heading of the box, its cosine and its sine."""
    box_cos: list[float] = column(ENTITY, 1.0)
    box_sin: list[float] = column(ENTITY)

    # Positions of the plan.
    position_x: list[float] = column(POSITION, op.FAR)
    position_y: list[float] = column(POSITION, op.FAR)
    position_at_road: list[int] = column(POSITION)
    position_at_lane: list[int] = column(POSITION)
    position_at_s: list[float] = column(POSITION)

    # Variables, traffic signals, the time of day and the road.
    variable: list[float] = column(VARIABLE)
    signal_state: list[int] = column(SIGNAL, op.NONE)
    """State of each signal as the place of a text, NONE for an unknown one."""
    phase_now: list[int] = column(SIGNAL_CONTROLLER, op.NONE)
    """Phase of each controller of signals, NONE before its begin."""
    phase_since: list[float] = column(SIGNAL_CONTROLLER)
    """When that phase began, or the controller's begin."""
    day_known: list[int] = column(RUN)
    """1 when there is a time of day."""
    day_runs: list[int] = column(RUN)
    day_from: list[float] = column(RUN)
    """Date and time at `day_since`, s since 1970."""
    day_since: list[float] = column(RUN)
    friction: list[float] = column(RUN, 1.0)
    """Factor of the road's friction."""
    held_on: list[int] = column(HELD_INPUT)
    """1 for each input of the ego that an action holds."""
    held_value: list[float] = column(HELD_INPUT)

    # Storyboard.
    acting: list[int] = column(RUN)
    """1 where an event runs in this frame; one element."""
    init_acting: list[int] = column(RUN, 1)
    """1 until no action of the init runs any more; one element."""
    element_state: list[int] = column(ELEMENT, op.STANDBY)
    element_runs: list[int] = column(ELEMENT)
    """Executions so far."""
    element_busy: list[int] = column(ELEMENT)
    """Of a maneuver, how many of its events run."""
    element_started: list[int] = column(ELEMENT, -1)
    """Frame from which the last start transition is seen; -1 before."""
    element_ended: list[int] = column(ELEMENT, -1)
    element_stopped: list[int] = column(ELEMENT, -1)
    element_skipped: list[int] = column(ELEMENT, -1)
    condition_before: list[int] = column(CONDITION, op.NONE)
    """What a condition with an edge was at its last evaluation, NONE before the first and after the edge has fired."""
    ring_time: list[float] = column(RECORD)
    ring_value: list[int] = column(RECORD)
    ring_first: list[int] = column(RING)
    ring_size: list[int] = column(RING)
    action_state: list[int] = column(ACTION, op.STANDBY)
    action_element: list[int] = column(ACTION, op.NONE)
    """Element that an action stands in, or -1 for an action of the init."""
    action_progress: list[float] = column(ACTION)
    action_span: list[float] = column(ACTION)
    action_from: list[float] = column(ACTION)
    action_change: list[float] = column(ACTION)
    action_phase: list[int] = column(ACTION)
    """Phase that an action is in, of those that go through several."""
    action_a: list[float] = column(ACTION)
    """Memory for the function that executes the action; so is `action_b`."""
    action_b: list[float] = column(ACTION)
    piece_time: list[float] = column(PIECE)
    """Plans of speed profiles: from when a piece holds, its speed and acceleration then, and its jerk."""
    piece_speed: list[float] = column(PIECE)
    piece_slope: list[float] = column(PIECE)
    piece_jerk: list[float] = column(PIECE)
    track_x: list[float] = column(VERTEX)
    """Vertices of trajectories, as they lay when their action began last."""
    track_y: list[float] = column(VERTEX)
    track_h: list[float] = column(VERTEX)
    track_z: list[float] = column(VERTEX)
    track_pitch: list[float] = column(VERTEX)
    track_s: list[float] = column(VERTEX)
    track_time: list[float] = column(VERTEX)
    track_v: list[float] = column(VERTEX)
    """Speed behind a vertex, and `track_a` the acceleration, of polylines that are followed by their times."""
    track_a: list[float] = column(VERTEX)
    track_bend: list[float] = column(VERTEX)
    """Curvature of a clothoid at a vertex, and its change with length."""
    track_bend_rate: list[float] = column(VERTEX)
    guide: list[int] = column(ENTITY)
    """Guide that the entity takes its turns by, RANDOM_GUIDE for turns at random, or NONE."""
    turn_from: list[int] = column(ENTITY)
    """Road at whose end the turn below is taken; NONE before it is drawn. This and what follows is of traffic."""
    turn_to: list[int] = column(ENTITY)
    """Road that the vehicle turns into, NONE where there is no choice."""
    turns: list[int] = column(ENTITY)
    """Number of turns drawn so far."""
    claim: list[int] = column(ENTITY, op.NONE)
    """Connecting road of a junction that the vehicle may drive on, or NONE."""
    entered: list[int] = column(ENTITY)
    """1 after the entity has reached that road."""
    asked: list[int] = column(ENTITY)
    """Frame since which it waits for a connecting road, or NONE."""
    wish: list[float] = column(ENTITY)
    """Speed that the driver aims for, negative before the first decision."""
    lane_rest: list[float] = column(ENTITY)
    """How far the lane goes on."""
    change_at: list[float] = column(ENTITY)
    """When the last lane change began."""
    change_from: list[float] = column(ENTITY)
    """Offset from the new lane's centre at its begin."""
    bucket_next: list[int] = column(ENTITY)
    """Next entity in the chain of its road."""
    bucket_head: list[int] = column(BUCKET)
    """First entity of each chain."""
    along_way: list[int] = column(RUN)
    """1 when the way was last walked ahead, -1 when back."""
    action_keeps_traffic: list[int] = column(ACTION)
    """1 from when a swarm, source or sink has begun."""
    action_x: list[float] = column(ACTION)
    """Where the entity was when it began to follow a path."""
    action_y: list[float] = column(ACTION)

    # Inputs from outside: the controller and the detector, or ideal perception.
    even_row: list[int] = column(RUN, op.NONE)
    """Row of the path's lane whose marks on both sides are known to stay as they are for a while, or NONE."""
    even_from: list[float] = column(RUN)
    """Between which s on that row, and the marks' qualities."""
    even_to: list[float] = column(RUN)
    even_left: list[float] = column(RUN)
    even_right: list[float] = column(RUN)
    conf_left: list[float] = column(RUN, 1.0)
    conf_right: list[float] = column(RUN, 1.0)
    health: list[float] = column(RUN, 1.0)
    view: list[float] = column(VIEW)
    """What surrogate perception goes by: features of the left side, of the right side, of both (`columns.view`)."""
    taken_up: list[float] = column(VIEW)
    """The features that `unit` was worked out for."""
    unit: list[float] = column(UNIT)
    """What the features give to the hidden units and the outputs of the left side, then of the right, without bias."""
    view_row: list[int] = column(RUN, op.NONE)
    """Row and piece of the path for which the view is kept while nothing changes, NONE where it is not to be kept."""
    view_piece: list[int] = column(RUN)
    view_speed: list[float] = column(RUN)
    """What that view was written for: speed, offset, heading, the body's pitch and the camera's noise."""
    view_off: list[float] = column(RUN)
    view_heading: list[float] = column(RUN)
    view_pitch: list[float] = column(RUN)
    view_sigma: list[float] = column(RUN)
    view_looks: list[int] = column(RUN)
    """Number of looks so far."""
    view_dashed: list[int] = column(RUN)
    """1 where a line ahead is not painted alike everywhere, so that the view changes with every metre."""
    air_weather: list[float] = column(WEATHER_NUMBER, -1.0e9)
    """The weather that the following is of."""
    air_lit: list[float] = column(LOOKED)
    """Light from the ground in each piece, 1 at a clear noon; how rough hard ground and meadow look there."""
    air_hard: list[float] = column(LOOKED)
    air_soft: list[float] = column(LOOKED)
    air_ground: list[float] = column(RUN)
    """Brightness of the asphalt, grey levels, the share of paint's contrast that is left, and how rough rain looks."""
    air_contrast: list[float] = column(RUN)
    air_streaks: list[float] = column(RUN)
    air_glare: list[float] = column(RUN)
    """How much the sun dazzles from straight ahead, 0-1, and its direction, rad."""
    air_sun: list[float] = column(RUN)
    stands_out: list[float] = column(LOOKED)
    """Strength in each piece per grey level by which paint is brighter than the ground: light over roughness."""
    beside_row: list[int] = column(RUN, op.NONE)
    """Row of the lane, s and the camera's noise for which was noted what lies beside the lane."""
    beside_s: list[float] = column(RUN)
    beside_sigma: list[float] = column(RUN)
    way_half: list[float] = column(LOOKED)
    """Half of the lane's width in each piece, m."""
    way_bend: list[float] = column(RUN)
    """Curvature of the way at the ego, 1/m, and its rate, 1/m2."""
    way_bend_rate: list[float] = column(RUN)
    hides_from: list[float] = column(RUN)
    """Directions (y / x) between which the obstacle nearest ahead hides the ground, and from where on, m."""
    hides_to: list[float] = column(RUN)
    hides_at: list[float] = column(RUN)
    seen_logit: list[float] = column(SIDE)
    """Logit of the confidence in each side, as of that view, and how far both together draw the path to the left, m."""
    seen_drawn: list[float] = column(RUN)
    path_error: list[float] = column(RUN)
    """How far left of the lane's centre the path lies that surrogate perception follows, m."""
    slow_square: list[float] = column(RUN)
    """Squared speed at which the bend is driven that limits the speed, m2/s2, and the odometer where it begins."""
    slow_at: list[float] = column(RUN)
    slow_row: list[int] = column(RUN, op.NONE)
    """Row of the path for which that is known."""
    slow_until: list[float] = column(RUN, -1.0)
    """Odometer up to which that bend is known to be the one that limits the speed."""
    auto_throttle: list[float] = column(RUN)
    auto_steer: list[float] = column(RUN)
    """-1 .. 1 of the greatest steering angle, positive to the left."""
    auto_brake: list[float] = column(RUN)
    auto_request: list[int] = column(RUN)

    # The ego.
    sigma: list[float] = column(RUN)
    """Camera noise now, grey levels."""
    noise: list[float] = column(RUN)
    """Noise of the camera itself, without its failures."""
    image_health: list[float] = column(RUN)
    """What noise, blackout, blur and dirt leave of the camera's health, 0 to 1."""
    failure_now: list[float] = column(FAILURE_KIND)
    """By kind, how severe the camera's failures are, 0 to 1."""
    failure_since: list[float] = column(FAILURE)
    """Time from which a failure's onset counts, -1 while it waits or is over."""
    failure_active: list[int] = column(FAILURE)
    missing: list[int] = column(RUN)
    """1 where the image of this frame does not arrive."""
    frozen: list[int] = column(RUN)
    """1 where the image before is delivered again."""
    weather: list[float] = column(WEATHER_NUMBER)
    """The 14 numbers now."""
    paint_seen: list[float] = column(RUN)
    """What the weather leaves of the confidence in a line, 0 to 1."""
    reach_known: list[int] = column(RUN)
    """1 while the weather is the one for which the forward sensor's reach was worked out."""
    reach_health: list[float] = column(RUN)
    """The camera's health for which it was, and the reach, m."""
    sensor_reach: list[float] = column(RUN)
    sight_known: list[int] = column(RUN)
    """1 while the weather is that for which `driver_sight`, m, was worked out."""
    driver_sight: list[float] = column(RUN)
    weather_from: list[float] = column(WEATHER_NUMBER)
    """The numbers when the present change began."""
    weather_to: list[int] = column(RUN, op.NONE)
    """The weather that it goes to, NONE when it does not change."""
    weather_since: list[float] = column(RUN)
    weather_over: list[float] = column(RUN)
    target_speed: list[float] = column(RUN)
    """Speed that the automation aims for; a speed action on the ego changes it."""
    path_road: list[int] = column(RUN, op.NONE)
    path_lane: list[int] = column(RUN)
    path_s: list[float] = column(RUN)
    path_row: list[int] = column(RUN, op.NONE)
    """Row of that lane there, -1 where the road has no such lane."""
    path_piece: list[int] = column(RUN)
    """Piece of the road's reference line there."""
    path_from: list[float] = column(RUN)
    """Between which s that row and that piece hold."""
    path_to: list[float] = column(RUN)
    path_sense: list[int] = column(RUN, 1)
    """1 where the path's lane is driven along s, else -1."""
    path_off: list[float] = column(RUN)
    """Offset from the path lane's centre, positive to the left of the travel."""
    path_heading: list[float] = column(RUN)
    """Heading of the ego relative to the path's direction."""
    limit_time: list[float] = column(RUN, op.FAR)
    """Time that the last request left, where it was not about an obstacle, s."""
    used_beside: list[int] = column(RUN)
    """1 where there was a vehicle in the lane beside that was looked at last."""
    looks_beside: list[float] = column(RUN, -1.0)
    """Since when the driver has looked at a lane with traffic beside, s; -1 while he does not."""
    traffic_density: list[float] = column(RUN)
    """Vehicles per kilometre that went the ego's way at the last request."""
    lane_time: list[float] = column(RUN, op.FAR)
    """Least time to collision along the lane at the ego's place in it, s."""
    lane_width: list[float] = column(RUN)
    """Width of the lane that the ego's point is in, 0 off every lane."""
    on_road: list[int] = column(RUN)
    """1 where that lane is one for motor traffic, or a shoulder or parking lane beside it."""
    path_found: list[int] = column(RUN)
    route_at: list[int] = column(RUN)
    """Row of `Program.route_road` that the ego has reached."""
    command_throttle: list[float] = column(ENTITY)
    command_steer: list[float] = column(ENTITY)
    command_brake: list[float] = column(ENTITY)
    command_reverse: list[int] = column(ENTITY)
    """1 where the throttle drives the vehicle backwards."""
    pedal: list[float] = column(RUN)
    """Acceleration asked for at the last control step, for limiting jerk."""
    shift_begin: list[float] = column(RUN)
    """Odometer at which the planned move to the side begins; see `lane_keeping`."""
    shift_end: list[float] = column(RUN)
    shift_from: list[float] = column(RUN)
    """Offset from the path lane's centre before it, positive to the left of the direction of travel."""
    shift_to: list[float] = column(RUN)

    aside: list[float] = column(RUN)
    """How far left of the planned offset is steered for, m; 0 but while a driver steers."""

    # What lies ahead: the way, then each entity as seen along it.
    way_road: list[int] = column(WAY)
    way_lane: list[int] = column(WAY)
    way_row: list[int] = column(WAY)
    """Row of that lane at the way's place, -1 where there is no such lane."""
    way_s: list[float] = column(WAY)
    way_sign: list[int] = column(WAY)
    way_from: list[float] = column(WAY)
    way_count: list[int] = column(RUN)
    eye_x: list[float] = column(RUN)
    """The sensor of the present look: where it is, cosine and sine of its heading, its range and its edge, the cosine
    of half its angle of view.
    """
    eye_y: list[float] = column(RUN)
    eye_cos: list[float] = column(RUN)
    eye_sin: list[float] = column(RUN)
    eye_reach: list[float] = column(RUN)
    eye_edge: list[float] = column(RUN)
    seen: list[int] = column(ENTITY)
    """1 when the entity is ahead on the way and the forward sensor (or the driver) sees it."""
    on_way: list[int] = column(ENTITY)
    near: list[float] = column(ENTITY)
    """Distance along the way from the ego's reference point to the nearest part of the entity's box."""
    far: list[float] = column(ENTITY)
    low: list[float] = column(ENTITY)
    """Right end of the box across the way, relative to the lane's centre, positive to the left."""
    high: list[float] = column(ENTITY)
    along: list[float] = column(ENTITY)
    """Speed along the way."""
    across: list[float] = column(ENTITY)
    """Speed to the left of the way."""
    border_left: list[float] = column(ENTITY)
    """Left border of the lane at the entity, relative to its centre."""
    border_right: list[float] = column(ENTITY)
    ahead_is: list[int] = column(ENTITY)
    """AHEAD_...: what the entity is to the ego."""
    led_at: list[float] = column(ENTITY, -op.FAR)
    """When an entity last led the ego: moved ahead of it in its path."""
    red_line: list[float] = column(RUN, op.FAR)
    """Distance along the way from the reference point to the line of the next red signal, FAR without one."""
    blocked_distance: list[float] = column(RUN, op.FAR)
    """From the front bumper to where the path is blocked, FAR when it is free."""
    blocked_speed: list[float] = column(RUN)
    """Speed at which what blocks the path comes towards the ego along the way, m/s; 0 for what does not."""
    blocked_far: list[float] = column(RUN, op.FAR)
    """From the front bumper to the far end of the row that stands in the path and begins with what blocks it."""
    clear_row: list[int] = column(RUN, op.NONE)
    """Row of the path's lane that has been seen not to end soon, NONE without one."""
    clear_s: list[float] = column(RUN)
    """Up to where on that row this is known."""
    lane_end_distance: list[float] = column(RUN, op.FAR)
    """From the front bumper to the end of the driving lane, FAR when none is near."""
    through_lane: list[int] = column(RUN)
    """Lane beside an ending one that goes on; 0 when there is none."""
    through_side: list[int] = column(RUN)
    """1 when that lane is on the left in the direction of travel, -1 on the right."""
    gap_free: list[int] = column(RUN, 1)
    contact: list[int] = column(ENTITY)
    """1 while the entity's box overlaps that of the vehicle that is reported."""
    struck: list[int] = column(ENTITY)
    """1 from when the entity's box has overlapped that of another one."""
    crashed: list[int] = column(RUN)

    # Takeover.
    takeover_state: list[int] = column(RUN, op.TAKEOVER_AUTOMATED)
    cause: list[int] = column(RUN)
    requests: list[int] = column(RUN)
    """Number of requests so far."""
    history: list[int] = column(CAUSE)
    """By cause, the last 32 control steps as bits, the latest lowest."""
    quiet: list[int] = column(RUN)
    """Number of control steps for which no cause has had a reason."""
    asking: list[int] = column(CAUSE)
    """By cause, 1 where it asks for a takeover at this control step."""
    warning_reason_since: list[float] = column(RUN, -1.0)
    """Since when there is a reason to warn, -1 while there is none; since when there is none, -1 while there is."""
    warning_clear_since: list[float] = column(RUN, -1.0)
    warning_since: list[float] = column(RUN, -1.0)
    """Time of the present warning."""
    ordered_request: list[int] = column(RUN, op.CAUSE_NONE)
    """Cause of the request that an action orders for the next control step, CAUSE_NONE for none."""
    ordered_warning: list[int] = column(RUN)
    ordered_hand_back: list[int] = column(RUN)
    time_warning: list[float] = column(RUN, -1.0)
    """Time of the first of each, -1 before."""
    time_request: list[float] = column(RUN, -1.0)
    time_escalation: list[float] = column(RUN, -1.0)
    time_response: list[float] = column(RUN, -1.0)
    time_minimum_risk: list[float] = column(RUN, -1.0)
    time_standstill: list[float] = column(RUN, -1.0)
    time_no_progress: list[float] = column(RUN, -1.0)
    time_outside_domain: list[float] = column(RUN, -1.0)
    time_obstruction: list[float] = column(RUN, -1.0)
    request_at: list[float] = column(RUN, -1.0)
    """Time of the present request."""
    answer_at: list[float] = column(RUN, op.FAR)
    """Time at which the driver answers the present request, FAR for never."""
    looking: list[int] = column(RUN)
    """1 while the driver's eyes are on the road: from a request on, and while he drives."""
    style: list[int] = column(RUN, op.STYLE_STEERS)
    """STYLE_... of the driver at this takeover."""
    noticed_at: list[float] = column(ENTITY, -1.0)
    """Time since which the entity has called for a reaction of the driver, -1 where it does not."""
    called_at: list[float] = column(ENTITY, -1.0)
    """Time at which it did so last."""
    place_known: list[int] = column(ENTITY)
    """1 from when a reference driver knows where the entity drives while it keeps its place in the lane."""
    place_before: list[float] = column(ENTITY)
    """That place, m to the left of the way's lane."""
    in_lane_before: list[int] = column(ENTITY)
    """1 where that is in the ego's lane."""
    minded_at: list[float] = column(ENTITY, -1.0)
    """Time since which a reference driver perceives that the entity comes in, -1 where he does not."""
    danger_at: list[float] = column(ENTITY, -1.0)
    """Time since which it is dangerous by the reference driver's condition, -1 where it is not."""
    was_danger: list[int] = column(ENTITY)
    """1 from when it has been."""
    evaded: list[int] = column(RUN, op.NONE)
    """Moving entity that the driver goes around, NONE without one."""
    person_throttle: list[float] = column(RUN)
    """What the person at the wheel does, written between steps: throttle and brake, 0 to 1."""
    person_brake: list[float] = column(RUN)
    person_steer: list[float] = column(RUN)
    """-1 to 1 of the greatest steering angle, positive to the left."""
    person_wish: list[int] = column(RUN)
    """What the person wants of the automation, a WISH code."""
    eyes_on_at: list[float] = column(RUN, op.FAR)
    """Time at which the driver will look at the road, FAR where that is not to come."""
    hands_on_at: list[float] = column(RUN, op.FAR)
    time_eyes_on: list[float] = column(RUN, -1.0)
    """When the driver's eyes were on the road first after a request, and the hands on the wheel; -1 before."""
    time_hands_on: list[float] = column(RUN, -1.0)
    manual_since: list[float] = column(RUN, -1.0)
    still_since: list[float] = column(RUN, -1.0)
    """Time since which the ego stands, -1 while it moves."""
    still_noted: list[int] = column(RUN)
    """1 from when a stop by hand was logged until the ego has driven on."""
    held_up_since: list[float] = column(RUN, -1.0)
    """Time since which the automated ego stands without a reason, -1 while it does not."""
    held_up: list[int] = column(RUN)
    """1 where it has done so for too long; and where this stop has been logged."""
    held_up_logged: list[int] = column(RUN)
    hazard_lights: list[int] = column(RUN)
    lane_lost: list[int] = column(RUN)
    """1 from when neither side of the lane is seen until it is recognised again; and how often that was."""
    lane_losses: list[int] = column(RUN)
    lane_seen_since: list[float] = column(RUN, -1.0)
    """Time since which a side of the lane is seen, -1 while neither is."""
    recall_off: list[float] = column(RUN)
    """What the ego believes of its place while the lane is lost, less what is true: offset to the left, m, ..."""
    recall_heading: list[float] = column(RUN)
    """... heading, rad, ..."""
    recall_along: list[float] = column(RUN)
    """... distance along the lane, m; and the rates of the last two: rad/s, and per metre."""
    recall_bias: list[float] = column(RUN)
    recall_share: list[float] = column(RUN)
    path_anew: list[int] = column(RUN)
    """1 where the ego has left its path for another place since this was last put to 0."""
    manoeuvre: list[int] = column(RUN, op.MANOEUVRE_KEEP)
    merging: list[int] = column(RUN)
    merge_from_lane: list[int] = column(RUN)
    merge_from_road: list[int] = column(RUN, op.NONE)
    seeks_gap: list[int] = column(RUN)
    """1 while a lane beside would serve the driver but for the traffic in it."""
    evade_until: list[float] = column(RUN)
    """Odometer at which the driver may go back to the lane's centre."""
    evade_commit: list[float] = column(RUN)
    """Odometer at which the move to the side has gone too far to be given up."""
    log_time: list[float] = column(LOG)
    log_kind: list[int] = column(LOG, op.NONE)
    log_value: list[float] = column(LOG)
    log_count: list[int] = column(RUN)


def new_state(program: Program) -> State:
    """Return a state of the right sizes for a program, at its declared start."""
    return at_start(State, program)


def make_draws(seed: int, variant: int = 0) -> list[float]:
    """Return DRAWS_PER_RUN numbers for `State.draw` that depend on the seed and the variant's index alone."""
    drawn = [0.0] * op.DRAWS_PER_RUN
    drawn[op.DRAW_PERSON] = normal(seed, variant, "driver/person")
    drawn[op.DRAW_SEED] = float(hash_bits(seed, variant, "steps") & 0xFFFFFFFF)
    return drawn
