"""State: everything that changes during a run, as flat columns of a fixed size.

`put_to_start` resets every column to its declared start value, except the kept ones, so that one state serves all
variants of a sweep.
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
    INIT,
    PIECE,
    POSITION,
    RING,
    SIGNAL,
    SIGNAL_CONTROLLER,
    VARIABLE,
    VERTEX,
    Program,
)
from scenario_compiler.engine.columns.view import HIDDEN, SAMPLES, UNITS, VIEW_SIZE
from scenario_compiler.forms.declaration import RUN, Columns, Of, at_start, column, container, fixed
from scenario_compiler.randomness import hash_bits, normal

RECORD = Of("past value", lambda p: p.ring_count[0] * op.DELAY_RECORDS)
WAY = fixed("stretch of the way ahead", op.WAY_SIZE)
LOG = Of(
    "event of a step",
    lambda p: op.LOG_SIZE + 3 * ELEMENT.count(p) + 2 * INIT.count(p) + 2 * ENTITY.count(p) + FAILURE.count(p),
)
"""The log has room for all events of a step. In a step, an event of the storyboard can end, start and end again, an
action can have an event of its own and find no lane, and an entity can touch the ego and another entity.
"""
BUCKET = fixed("chain of entities", op.BUCKETS)
HELD_INPUT = fixed("held input", op.HELD_INPUTS)
FAILURE_KIND = fixed("kind of failure", op.FAILURES)
WEATHER_NUMBER = fixed("number of a weather", op.WEATHER_SIZE)
SIDE = fixed("side of the lane", 2)
NOISE = fixed("noise of a place: of the left side, of the right side, of the path", 3)
UNIT = fixed("unit of a network, for each side", 2 * UNITS)
HIDDEN_UNIT = fixed("hidden unit of a network", HIDDEN)
VIEW = fixed("feature of a view", VIEW_SIZE)
LOOKED = fixed("piece of the way in which paint is looked at", SAMPLES)
LOOKED_SIDES = fixed("piece of a line in view", 2 * SAMPLES)
DRAW = fixed("draw", op.DRAWS_PER_RUN)

STEER_RATE = 0.7
"""Greatest rate of the front wheels' angle, rad/s: 640 deg/s at the steering wheel with a ratio of 16, as a quick
driver.
"""


@container("st", 2, written=True)
class State(Columns):
    """The columns of a run: SI units, radians, OpenDRIVE axes; codes are those of `opcodes`."""

    # The run, one element each.
    clock: list[float] = column(RUN)
    """Time, s: the number of steps times the step, so that equal times are equal numbers."""
    steps: list[int] = column(RUN)
    """Number of steps taken."""
    frame: list[int] = column(RUN)
    """Number of the frame; frame 0 has no duration."""
    stop: list[int] = column(RUN, op.STOP_NONE)
    """STOP_... code once the run is over."""
    flag: list[int] = column(RUN, op.FAULT_NONE)
    """FAULT_... code; a fault stops the run."""
    flag_at: list[int] = column(RUN, op.NONE)
    """Entity, condition or action of the fault."""
    start_tight: list[int] = column(RUN)
    """1 if entities stand so close together after the init actions that their boxes may overlap."""
    draw: list[float] = column(DRAW, kept=True)
    """Draws made before the run: DRAW_PERSON and DRAW_SEED."""

    # Entities.
    present: list[int] = column(ENTITY)
    """1 while the entity is in the world; an absent one does not move, collide or hide others, and is not seen."""
    x: list[float] = column(ENTITY)
    """World coordinates of the reference point, m."""
    y: list[float] = column(ENTITY)
    z: list[float] = column(ENTITY)
    h: list[float] = column(ENTITY)
    """Heading, rad."""
    pitch: list[float] = column(ENTITY)
    """Pitch of the road below plus that of the body on its springs, rad."""
    body_pitch: list[float] = column(ENTITY)
    """Pitch of the body relative to the road, rad, of a vehicle that is driven by commands."""
    roll: list[float] = column(ENTITY)
    v: list[float] = column(ENTITY)
    """Speed along the heading, m/s; negative backwards."""
    a: list[float] = column(ENTITY)
    """Acceleration along the heading, m/s2."""
    steer: list[float] = column(ENTITY)
    """Angle of the front wheels, rad, positive to the left."""
    steer_rate: list[float] = column(ENTITY, STEER_RATE)
    """Greatest rate of that angle, rad/s."""
    steer_tangent: list[float] = column(ENTITY)
    tangent_of: list[float] = column(ENTITY)
    """Tangent of the front wheels' angle when it was last needed, and that angle, rad."""
    throttle: list[float] = column(ENTITY)
    """Applied throttle and brake, 0 to 1."""
    brake: list[float] = column(ENTITY)
    road: list[int] = column(ENTITY)
    """Index of the road, -1 off every road."""
    lane: list[int] = column(ENTITY)
    """Id of the lane that contains the reference point, 0 off every lane."""
    s: list[float] = column(ENTITY)
    """Position along the road's reference line, m."""
    off: list[float] = column(ENTITY)
    """Offset to the left of the lane's centre, in the direction of s, m."""
    t: list[float] = column(ENTITY)
    """Offset to the left of the reference line, m."""
    facing: list[int] = column(ENTITY, 1)
    """1 if the entity's forward direction goes along s, else -1."""
    turn: list[float] = column(ENTITY)
    """Heading relative to the lane in the direction `facing`, rad."""
    kept_lane: list[int] = column(ENTITY)
    """Lane that a scripted entity follows: the one it belongs to, or the target of a lane change."""
    kept_off: list[float] = column(ENTITY)
    """Offset to the left of that lane's centre, in the direction of s, m."""
    changing: list[int] = column(ENTITY)
    """1 during a lane change and until the entity has settled in the lane that contains its reference point."""
    here_road: list[int] = column(ENTITY, op.NONE)
    """Road and lane for which the lane's row and the road's piece below the entity were found last."""
    here_lane: list[int] = column(ENTITY)
    here_from: list[float] = column(ENTITY)
    """Row and piece are valid for s from `here_from` to before `here_to`, m."""
    here_to: list[float] = column(ENTITY, -1.0)
    here_row: list[int] = column(ENTITY, op.NONE)
    here_piece: list[int] = column(ENTITY)
    odometer: list[float] = column(ENTITY)
    """Distance travelled, m."""
    still: list[float] = column(ENTITY, -1.0)
    """How long the entity has stood, s; negative while it moves."""
    at_end: list[float] = column(ENTITY, -1.0)
    """How long it has stood at the end of a road, s; negative while it does not."""
    off_road: list[float] = column(ENTITY, -1.0)
    """How long it has been off every lane, s; negative while it is on one."""
    velocity_x: list[float] = column(ENTITY)
    """Velocity, m/s, and acceleration, m/s2, in the world's axes, if a condition uses them."""
    velocity_y: list[float] = column(ENTITY)
    velocity_z: list[float] = column(ENTITY)
    acceleration_x: list[float] = column(ENTITY)
    acceleration_y: list[float] = column(ENTITY)
    acceleration_z: list[float] = column(ENTITY)
    before_x: list[float] = column(ENTITY)
    """Position at the last measurement of the velocity, m."""
    before_y: list[float] = column(ENTITY)
    before_z: list[float] = column(ENTITY)
    follows: list[int] = column(ENTITY)
    """1 while it follows the vehicle ahead."""
    controller: list[int] = column(ENTITY)
    """CONTROLLER_... code of its controller."""
    desired: list[float] = column(ENTITY)
    """Speed that it aims for while it follows, m/s."""
    ended: list[int] = column(ENTITY)
    """1 if the entity stands at the end of its road."""
    lights: list[int] = column(ENTITY)
    """Lights that actions have switched on, as bits: the first of `moves.appearance.LIGHTS` is the lowest."""
    visible: list[int] = column(ENTITY, op.SEEN_BY_ALL)
    """Observers to whom the entity is visible, as SEEN_... bits."""
    towed: list[int] = column(ENTITY, op.NONE)
    """Trailer that it tows, or NONE."""
    towed_by: list[int] = column(ENTITY, op.NONE)
    """Entity that tows it, or NONE."""
    trains: list[int] = column(RUN)
    """1 once a trailer has been connected."""
    moved: list[int] = column(ENTITY)
    """1 if an action has moved the entity in this step; `take_stock` clears it."""
    longitudinal: list[int] = column(ENTITY, op.NONE)
    """Action that changes the entity's speed, or -1."""
    lateral: list[int] = column(ENTITY, op.NONE)
    """Action that changes the entity's lane, or -1."""
    last_x: list[float] = column(ENTITY)
    """Position, m, and speed, m/s, after the last step."""
    last_y: list[float] = column(ENTITY)
    last_v: list[float] = column(ENTITY)
    order: list[int] = column(ENTITY)
    """Entities sorted by the smallest x of their boxes."""
    reach: list[float] = column(ENTITY)
    """Half the diagonal of the entity's box, m."""
    middle_x: list[float] = column(ENTITY)
    """Centre of the entity's box, m."""
    middle_y: list[float] = column(ENTITY)
    box_h: list[float] = column(ENTITY)
    """Heading of the box, rad, with its cosine and sine."""
    box_cos: list[float] = column(ENTITY, 1.0)
    box_sin: list[float] = column(ENTITY)

    # Positions of the plan.
    position_x: list[float] = column(POSITION, op.FAR)
    """World coordinates of each position of the conflict language, m; FAR if it lies nowhere."""
    position_y: list[float] = column(POSITION, op.FAR)

    destination_x: list[float] = column(RUN)
    """The ego's destination."""
    destination_y: list[float] = column(RUN)

    # Variables, traffic signals, the time of day and the road.
    variable: list[float] = column(VARIABLE)
    """Present value of each variable."""
    signal_state: list[int] = column(SIGNAL, op.NONE)
    """State of each signal as the index of a text, NONE if unknown."""
    phase_now: list[int] = column(SIGNAL_CONTROLLER, op.NONE)
    """Phase of each traffic signal controller, NONE before it begins."""
    phase_since: list[float] = column(SIGNAL_CONTROLLER)
    """When that phase began, or when the controller begins, s."""
    day_known: list[int] = column(RUN)
    """1 if there is a time of day."""
    day_runs: list[int] = column(RUN)
    """1 if the time of day advances."""
    day_from: list[float] = column(RUN)
    """Date and time at `day_since`, s since 1970."""
    day_since: list[float] = column(RUN)
    """Time of the run at which the time of day was set, s."""
    friction: list[float] = column(RUN, 1.0)
    """Friction factor of the road."""
    held_on: list[int] = column(HELD_INPUT)
    """1 for each input of the ego that an action holds."""
    held_value: list[float] = column(HELD_INPUT)
    """Value at which it is held."""

    # Storyboard.
    acting: list[int] = column(RUN)
    """1 if an event runs in this frame."""
    init_acting: list[int] = column(RUN, 1)
    """1 until no action of the init runs any more."""
    element_state: list[int] = column(ELEMENT, op.STANDBY)
    """STANDBY, RUNNING or COMPLETE."""
    element_runs: list[int] = column(ELEMENT)
    """Number of executions so far."""
    element_busy: list[int] = column(ELEMENT)
    """Number of running events of a maneuver."""
    element_started: list[int] = column(ELEMENT, -1)
    """Frame in which the last start transition is visible, -1 before the first; likewise end, stop and skip."""
    element_ended: list[int] = column(ELEMENT, -1)
    element_stopped: list[int] = column(ELEMENT, -1)
    element_skipped: list[int] = column(ELEMENT, -1)
    condition_before: list[int] = column(CONDITION, op.NONE)
    """Value of a condition with an edge at its last evaluation; NONE before the first and after the edge has fired."""
    ring_time: list[float] = column(RECORD)
    """Records of past values of delayed conditions: times, s, and values, in rings with a first index and a size."""
    ring_value: list[int] = column(RECORD)
    ring_first: list[int] = column(RING)
    ring_size: list[int] = column(RING)
    action_state: list[int] = column(ACTION, op.STANDBY)
    """STANDBY, RUNNING or COMPLETE."""
    action_element: list[int] = column(ACTION, op.NONE)
    """Storyboard element of an action, or -1 for an action of the init."""
    action_progress: list[float] = column(ACTION)
    """Progress of a transition, from 0 to `action_span`, s or m."""
    action_span: list[float] = column(ACTION)
    action_from: list[float] = column(ACTION)
    """Start value of a transition and its total change."""
    action_change: list[float] = column(ACTION)
    action_phase: list[int] = column(ACTION)
    """Present phase of an action that has several."""
    action_a: list[float] = column(ACTION)
    """Memory of the function that executes the action, like `action_b`."""
    action_b: list[float] = column(ACTION)
    piece_time: list[float] = column(PIECE)
    """Plans of speed profiles: start time of a piece, speed and acceleration then, and its jerk."""
    piece_speed: list[float] = column(PIECE)
    piece_slope: list[float] = column(PIECE)
    piece_jerk: list[float] = column(PIECE)
    track_x: list[float] = column(VERTEX)
    """Vertices of trajectories, as computed when their action last began."""
    track_y: list[float] = column(VERTEX)
    track_h: list[float] = column(VERTEX)
    track_z: list[float] = column(VERTEX)
    track_pitch: list[float] = column(VERTEX)
    track_s: list[float] = column(VERTEX)
    track_time: list[float] = column(VERTEX)
    track_v: list[float] = column(VERTEX)
    """Speed after a vertex, m/s, and in `track_a` the acceleration, for polylines that are followed by their times."""
    track_a: list[float] = column(VERTEX)
    track_bend: list[float] = column(VERTEX)
    """Curvature of a clothoid at a vertex, 1/m, and its rate of change with length, 1/m2."""
    track_bend_rate: list[float] = column(VERTEX)
    guide: list[int] = column(ENTITY)
    """Guide that determines the entity's turns, RANDOM_GUIDE for random turns, or NONE."""
    turn_from: list[int] = column(ENTITY)
    """Road at whose end the turn `turn_to` is taken, NONE before it is drawn. This and the columns up to `along_way`
    belong to background traffic.
    """
    turn_to: list[int] = column(ENTITY)
    """Road that the vehicle turns into, NONE if there is no choice."""
    turns: list[int] = column(ENTITY)
    """Number of turns drawn so far."""
    claim: list[int] = column(ENTITY, op.NONE)
    """Connecting road of a junction that the vehicle may enter, or NONE."""
    entered: list[int] = column(ENTITY)
    """1 once the vehicle has reached that road."""
    asked: list[int] = column(ENTITY)
    """Frame since which it waits for a connecting road, or NONE."""
    wish: list[float] = column(ENTITY)
    """Speed that the driver aims for, m/s, negative before the first decision."""
    lane_rest: list[float] = column(ENTITY)
    """Distance to the end of the lane, m."""
    change_at: list[float] = column(ENTITY)
    """Time at which the last lane change began, s."""
    change_from: list[float] = column(ENTITY)
    """Offset from the new lane's centre when it began, m."""
    bucket_next: list[int] = column(ENTITY)
    """Next entity in the chain of its road."""
    bucket_head: list[int] = column(BUCKET)
    """First entity of each chain."""
    along_way: list[int] = column(RUN)
    """1 if the last way was walked forwards, -1 if backwards."""
    action_keeps_traffic: list[int] = column(ACTION)
    """1 once a swarm, source or sink has begun."""
    action_x: list[float] = column(ACTION)
    """World coordinates of the entity when it began to follow a path, m."""
    action_y: list[float] = column(ACTION)

    # Inputs from outside: the controller and the detector, or ideal perception.
    even_row: list[int] = column(RUN, op.NONE)
    """Row of the path's lane whose marks on both sides are known not to change for a while, or NONE."""
    even_from: list[float] = column(RUN)
    """Range of s on that row in which they do not change, and the qualities of the marks."""
    even_to: list[float] = column(RUN)
    even_left: list[float] = column(RUN)
    even_right: list[float] = column(RUN)
    conf_left: list[float] = column(RUN, 1.0)
    """Confidence in the left and right boundary of the lane, and health of the sensor, 0 to 1."""
    conf_right: list[float] = column(RUN, 1.0)
    health: list[float] = column(RUN, 1.0)
    view: list[float] = column(VIEW)
    """The features of surrogate perception: of the left side, of the right side, of both (`columns.view`)."""
    side_anew: list[int] = column(SIDE, 1)
    """1 where the sums over a side's pieces have been written since they were taken up."""
    lasting_anew: list[int] = column(RUN, 1)
    """1 where a feature that stays as it is for many views has changed since it was taken up."""
    taken_up: list[float] = column(VIEW)
    """The features that `unit` was worked out for."""
    unit: list[float] = column(UNIT)
    """The features' contributions to the hidden units and outputs of the left side, then of the right, without bias."""
    changed: list[int] = column(VIEW)
    """Features that are being taken up, and their changes."""
    change: list[float] = column(VIEW)
    answer: list[float] = column(HIDDEN_UNIT)
    """Answers of one side's hidden units while its outputs are computed."""
    view_row: list[int] = column(RUN, op.NONE)
    """Row and piece of the path for which the view is kept while nothing changes; NONE if it must not be kept."""
    view_piece: list[int] = column(RUN)
    view_speed: list[float] = column(RUN)
    """State at which that view was computed: speed, offset, heading, the body's pitch and the camera's noise."""
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
    """Half of the lane's width in each piece, and its centre to the left of the ego's axis, m."""
    way_centre: list[float] = column(LOOKED)
    piece_quality: list[float] = column(LOOKED_SIDES)
    """Quality of the paint in each piece of the left line and then of the right one, and the share that is painted."""
    piece_share: list[float] = column(LOOKED_SIDES)
    piece_shows: list[int] = column(LOOKED_SIDES)
    """Whether each piece is in the field of view and whether something stands before it (`paint_ahead`)."""
    line_colour: list[int] = column(SIDE)
    """Code of the colour of the line on each side."""
    lines_laid: list[int] = column(RUN)
    """1 where the paint in the pieces holds for as long as the marks stay as they are."""
    summed: list[int] = column(RUN)
    """1 where the sums over the pieces are those of the present paint, ground and air."""
    way_bend: list[float] = column(RUN)
    """Curvature of the way at the ego, 1/m, and its rate, 1/m2."""
    way_bend_rate: list[float] = column(RUN)
    hides_from: list[float] = column(RUN)
    """Directions (y / x) between which the obstacle nearest ahead hides the ground, and from where on, m."""
    hides_to: list[float] = column(RUN)
    hides_at: list[float] = column(RUN)
    seen_logit: list[float] = column(SIDE)
    """Logit of the confidence in each side for that view."""
    seen_drawn: list[float] = column(RUN)
    """How far both sides together shift the path to the left, m."""
    noise_road: list[int] = column(NOISE, op.NONE)
    """Road, lane and cell of which the random numbers are known, and those of the cell's beginning and end."""
    noise_lane: list[int] = column(NOISE)
    noise_cell: list[int] = column(NOISE)
    noise_here: list[float] = column(NOISE)
    noise_there: list[float] = column(NOISE)
    path_error: list[float] = column(RUN)
    """Offset to the left of the lane's centre of the path that surrogate perception follows, m."""
    slow_square: list[float] = column(RUN)
    """Squared speed in the bend that limits the speed, m2/s2."""
    slow_at: list[float] = column(RUN)
    """Odometer at which that bend begins, m."""
    slow_row: list[int] = column(RUN, op.NONE)
    """Row of the path, lateral acceleration and braking, m/s2, for which that bend is known."""
    slow_lateral: list[float] = column(RUN)
    slow_braking: list[float] = column(RUN)
    slow_until: list[float] = column(RUN, -1.0)
    """Odometer up to which that bend is known to be the one that limits the speed, m."""
    slow_known: list[float] = column(RUN)
    """Odometer up to which all bends are known, m."""
    free_until: list[float] = column(RUN, -1.0)
    """Odometer up to which no bend can limit the speed, m."""
    auto_throttle: list[float] = column(RUN)
    """Commands of the controller: throttle and brake, 0 to 1."""
    auto_steer: list[float] = column(RUN)
    """Steering command, -1 to 1 of the greatest angle of the front wheels, positive to the left."""
    auto_brake: list[float] = column(RUN)
    auto_request: list[int] = column(RUN)
    """1 if the controller requests a takeover."""

    # The ego.
    sigma: list[float] = column(RUN)
    """Present noise of the camera, grey levels."""
    noise: list[float] = column(RUN)
    """Noise of the camera itself, without its failures, grey levels."""
    image_health: list[float] = column(RUN)
    """Share of the camera's health that all but missing and repeated images leave, 0 to 1."""
    lines_left: list[float] = column(RUN, 1.0)
    """Share of the confidence in a line that dirt, dead rows and overexposure leave, 0 to 1."""
    sky_level: list[float] = column(RUN)
    """Brightness of the picture's sky in the present weather, grey levels."""
    ground_level: list[float] = column(RUN)
    """Brightness of the picture's ground, grey levels."""
    brightest: list[float] = column(RUN)
    """The picture's brightest tones, grey levels."""
    lamps_on: list[int] = column(RUN)
    """1 if headlights light the ground."""
    tinted: list[int] = column(RUN)
    """1 if the light is coloured by a low sun or by dust."""
    failure_now: list[float] = column(FAILURE_KIND)
    """Severity of each kind of camera failure, 0 to its amount."""
    failure_lately: list[float] = column(FAILURE_KIND)
    """The part of that severity that the detector has noticed."""
    failure_since: list[float] = column(FAILURE)
    """Time from which a failure's onset counts, s; -1 while it waits or is over."""
    failure_severity: list[float] = column(FAILURE)
    """Severity of each failure, 0 to its amount."""
    failure_noticed: list[float] = column(FAILURE)
    """The part of it that the detector has noticed."""
    failure_active: list[int] = column(FAILURE)
    """1 while the failure has an effect."""
    missing: list[int] = column(RUN)
    """1 if the image of this frame does not arrive."""
    frozen: list[int] = column(RUN)
    """1 if the previous image is delivered again."""
    image_taken: list[int] = column(RUN, -1)
    """Number of the newest image that has arrived; -1 before the first one."""
    awaited: list[int] = column(RUN)
    """1 if no newer image has arrived at this frame, because images are late."""
    weather: list[float] = column(WEATHER_NUMBER)
    """The 14 numbers of the present weather."""
    paint_seen: list[float] = column(RUN)
    """Share of the confidence in a line that the weather leaves, 0 to 1."""
    reach_known: list[int] = column(RUN)
    """1 while the weather has not changed since the forward sensor's reach was computed."""
    reach_health: list[float] = column(RUN)
    """Health of the camera for which it was computed."""
    sensor_reach: list[float] = column(RUN)
    """Reach of the forward sensor, m."""
    sight_known: list[int] = column(RUN)
    """1 while the weather has not changed since `driver_sight` was computed."""
    driver_sight: list[float] = column(RUN)
    """How far the driver sees, m."""
    weather_from: list[float] = column(WEATHER_NUMBER)
    """The numbers when the present change began."""
    weather_to: list[int] = column(RUN, op.NONE)
    """Weather at the end of the change, NONE if the weather does not change."""
    weather_since: list[float] = column(RUN)
    """Start and duration of the change, s."""
    weather_over: list[float] = column(RUN)
    target_speed: list[float] = column(RUN)
    """Speed that the automation aims for, m/s; a speed action on the ego changes it."""
    path_road: list[int] = column(RUN, op.NONE)
    """Road, lane and s of the ego's path."""
    path_lane: list[int] = column(RUN)
    path_s: list[float] = column(RUN)
    path_row: list[int] = column(RUN, op.NONE)
    """Row of that lane there, -1 if the road has no such lane."""
    path_piece: list[int] = column(RUN)
    """Piece of the road's reference line there."""
    path_from: list[float] = column(RUN)
    """Range of s in which that row and that piece are valid."""
    path_to: list[float] = column(RUN)
    path_sense: list[int] = column(RUN, 1)
    """1 if the path's lane is driven along s, else -1."""
    path_off: list[float] = column(RUN)
    """Offset from the path lane's centre, m, positive to the left in the direction of travel."""
    path_heading: list[float] = column(RUN)
    """Heading of the ego relative to the path's direction, rad."""
    limit_time: list[float] = column(RUN, op.FAR)
    """Time that the last request left if it was not about an obstacle, s; otherwise FAR."""
    used_beside: list[int] = column(RUN)
    """1 if there was a vehicle in the neighbouring lane when it was last checked."""
    looks_beside: list[float] = column(RUN, -1.0)
    """Time since which the driver has watched a neighbouring lane with traffic, s; -1 if none."""
    traffic_density: list[float] = column(RUN)
    """Vehicles per kilometre in the ego's direction at the last request."""
    lane_time: list[float] = column(RUN, op.FAR)
    """Least time to collision along the lane at the lateral position of the ego's front, s."""
    lane_width: list[float] = column(RUN)
    """Width of the lane that contains the ego's reference point, m; 0 off every lane."""
    on_road: list[int] = column(RUN)
    """1 if that lane is one for motor traffic, or a shoulder or parking lane beside it."""
    path_found: list[int] = column(RUN)
    """1 if the ego is on a lane."""
    route_at: list[int] = column(RUN)
    """Row of `Program.route_road` that the ego has reached."""
    drag: list[float] = column(ENTITY)
    """Deceleration while no pedal is pressed, m/s2; less with throttle, 0 with full throttle. 0 unless a person drives:
    the others' commands are the accelerations that they want.
    """
    command_throttle: list[float] = column(ENTITY)
    """Commands: throttle and brake, 0 to 1; steering, -1 to 1 of the greatest angle, positive to the left."""
    command_steer: list[float] = column(ENTITY)
    command_brake: list[float] = column(ENTITY)
    command_reverse: list[int] = column(ENTITY)
    """1 if the throttle drives the vehicle backwards."""
    pedal: list[float] = column(RUN)
    """Acceleration commanded at the last control step, m/s2, used to limit the jerk."""
    shift_begin: list[float] = column(RUN)
    """Odometer at which the planned lateral move begins, m (see `motion.steering`)."""
    shift_end: list[float] = column(RUN)
    """Odometer at which it ends, m."""
    shift_from: list[float] = column(RUN)
    """Offset from the path lane's centre before it, m, positive to the left in the direction of travel."""
    shift_to: list[float] = column(RUN)
    """Offset after it, m."""

    aside: list[float] = column(RUN)
    """Lateral deviation from the planned offset that is steered for, m, positive to the left; 0 unless a driver steers.
    """

    # What lies ahead: the way (see `motion.ahead`), then each entity relative to it.
    way_road: list[int] = column(WAY)
    """Road, lane, and s at which each road of the way begins."""
    way_lane: list[int] = column(WAY)
    way_row: list[int] = column(WAY)
    """Row of that lane at this s, -1 if there is no such lane."""
    way_s: list[float] = column(WAY)
    way_sign: list[int] = column(WAY)
    """1 if the way goes along s there, else -1."""
    way_from: list[float] = column(WAY)
    """Distance along the way to this s, m."""
    way_count: list[int] = column(RUN)
    """Number of roads of the way."""
    eye_x: list[float] = column(RUN)
    """The sensor of the present look: its position, cosine and sine of its heading, its range, and the cosine of half
    its angle of view.
    """
    eye_y: list[float] = column(RUN)
    eye_cos: list[float] = column(RUN)
    eye_sin: list[float] = column(RUN)
    eye_reach: list[float] = column(RUN)
    eye_view: list[float] = column(RUN, -1.0)
    """Full angle of view, rad, and the cosine of its half."""
    eye_edge: list[float] = column(RUN)
    looked: list[int] = column(RUN)
    """1 while the measurements along the way are those of a look ahead in this control step with that sensor."""
    seen: list[int] = column(ENTITY)
    """1 if the entity is ahead on the way and the forward sensor (or the driver) sees it."""
    on_way: list[int] = column(ENTITY)
    """1 if the entity is on the way; only then the columns from `near` to `border_right` hold."""
    way_angle: list[float] = column(ENTITY)
    """Angle between the entity and the road of the way when it was last measured, rad, with its cosine and sine."""
    way_cos: list[float] = column(ENTITY, 1.0)
    way_sin: list[float] = column(ENTITY)
    near: list[float] = column(ENTITY)
    """Distance along the way from the ego's reference point to the near end of the entity's box, m."""
    far: list[float] = column(ENTITY)
    """Distance to the far end of the box, m."""
    low: list[float] = column(ENTITY)
    """Offset of the right end of the box from the lane's centre, m, positive to the left."""
    high: list[float] = column(ENTITY)
    """Offset of its left end, m."""
    along: list[float] = column(ENTITY)
    """Speed along the way, m/s."""
    across: list[float] = column(ENTITY)
    """Speed to the left of the way, m/s."""
    border_left: list[float] = column(ENTITY)
    """Offset of the lane's left border at the entity from its centre, m."""
    border_right: list[float] = column(ENTITY)
    """Offset of the right border, m."""
    ahead_is: list[int] = column(ENTITY)
    """AHEAD_... code: the entity's class for the ego."""
    led_at: list[float] = column(ENTITY, -op.FAR)
    """Time at which an entity was last a moving leader of the ego, s."""
    red_line: list[float] = column(RUN, op.FAR)
    """Distance along the way from the reference point to the line of the next red signal, m; FAR if there is none."""
    blocked_distance: list[float] = column(RUN, op.FAR)
    """Distance from the front bumper to where the path is blocked, m; FAR if it is free."""
    blocked_speed: list[float] = column(RUN)
    """Speed along the way at which what blocks the path approaches the ego, m/s; 0 if it does not."""
    blocked_far: list[float] = column(RUN, op.FAR)
    """Distance from the front bumper to the far end of the block, which may consist of several objects, m."""
    clear_row: list[int] = column(RUN, op.NONE)
    """Row of the path's lane that is known not to end soon, or NONE."""
    clear_s: list[float] = column(RUN)
    """s on that row up to which this is known, m."""
    lane_end_distance: list[float] = column(RUN, op.FAR)
    """Distance from the front bumper to where the driving lane ends or leaves the route, m; FAR if neither is near."""
    lane_leaves: list[int] = column(RUN)
    """1 if the lane leaves the planned route there, and goes on."""
    through_lane: list[int] = column(RUN)
    """Neighbouring lane that continues when the path's lane ends; 0 if there is none."""
    through_side: list[int] = column(RUN)
    """1 if that lane is on the left in the direction of travel, -1 if on the right."""
    gap_free: list[int] = column(RUN, 1)
    """1 if the gap in that lane is free."""
    contact: list[int] = column(ENTITY)
    """1 while the entity's box overlaps that of the reported vehicle."""
    struck: list[int] = column(ENTITY)
    """1 once the entity's box has overlapped that of another one."""
    crashed: list[int] = column(RUN)
    """1 once the reported vehicle has had a collision."""

    # Takeover.
    takeover_state: list[int] = column(RUN, op.TAKEOVER_AUTOMATED)
    """TAKEOVER_... code."""
    cause: list[int] = column(RUN)
    """CAUSE_... code of the present warning or request."""
    requests: list[int] = column(RUN)
    """Number of requests so far."""
    history: list[int] = column(CAUSE)
    """For each cause, the last 32 control steps as bits, the latest in the lowest bit."""
    quiet: list[int] = column(RUN)
    """Number of successive control steps in which no cause had a reason."""
    asking: list[int] = column(CAUSE)
    """For each cause, 1 if it asks for a takeover at this control step."""
    warning_reason_since: list[float] = column(RUN, -1.0)
    """Time since which there has been a reason to warn, s; -1 if there is none."""
    warning_clear_since: list[float] = column(RUN, -1.0)
    """Time since which there has been no reason to warn, s; -1 if there is one."""
    warning_since: list[float] = column(RUN, -1.0)
    """Time of the present warning, s."""
    ordered_request: list[int] = column(RUN, op.CAUSE_NONE)
    """Cause of the request that an action orders for the next control step, or CAUSE_NONE."""
    ordered_warning: list[int] = column(RUN)
    """1 if an action orders a warning, or a hand-back, for the next control step."""
    ordered_hand_back: list[int] = column(RUN)
    time_warning: list[float] = column(RUN, -1.0)
    """Time of the first event of each kind, s; -1 before it."""
    time_request: list[float] = column(RUN, -1.0)
    time_escalation: list[float] = column(RUN, -1.0)
    time_response: list[float] = column(RUN, -1.0)
    time_minimum_risk: list[float] = column(RUN, -1.0)
    time_standstill: list[float] = column(RUN, -1.0)
    time_no_progress: list[float] = column(RUN, -1.0)
    time_outside_domain: list[float] = column(RUN, -1.0)
    time_obstruction: list[float] = column(RUN, -1.0)
    time_short_start: list[float] = column(RUN, -1.0)
    time_collision: list[float] = column(RUN, -1.0)
    collided_with: list[int] = column(RUN, op.NONE)
    """Entity of the first collision; NONE for none, or for something that is no entity."""
    request_at: list[float] = column(RUN, -1.0)
    """Time of the present request, s."""
    answer_at: list[float] = column(RUN, op.FAR)
    """Time at which the driver responds to the present request, s; FAR for never."""
    looking: list[int] = column(RUN)
    """1 while the driver's eyes are on the road: after a request, and while driving."""
    style: list[int] = column(RUN, op.STYLE_STEERS)
    """STYLE_... code of the driver at this takeover."""
    noticed_at: list[float] = column(ENTITY, -1.0)
    """Time since which the entity has required a reaction of the driver, s; -1 if it does not."""
    called_at: list[float] = column(ENTITY, -1.0)
    """Time at which it last did so, s."""
    place_known: list[int] = column(ENTITY)
    """1 once a reference driver knows the entity's lateral position while it keeps its place in the lane."""
    place_before: list[float] = column(ENTITY)
    """That lateral position, m to the left of the centre of the way's lane."""
    in_lane_before: list[int] = column(ENTITY)
    """1 if that position is in the ego's lane."""
    minded_at: list[float] = column(ENTITY, -1.0)
    """Time since which a reference driver has perceived the entity's cut-in, s; -1 if there is none."""
    danger_at: list[float] = column(ENTITY, -1.0)
    """Time since which it has been dangerous under the reference driver's condition, s; -1 if it is not."""
    was_danger: list[int] = column(ENTITY)
    """1 once it has been dangerous."""
    evaded: list[int] = column(RUN, op.NONE)
    """Moving entity that the driver evades, or NONE."""
    person_throttle: list[float] = column(RUN)
    """Inputs of the person at the wheel, written between steps: throttle and brake, 0 to 1."""
    person_brake: list[float] = column(RUN)
    person_steer: list[float] = column(RUN)
    """Steering input of the person, -1 to 1 of the greatest angle, positive to the left."""
    person_wish: list[int] = column(RUN)
    """What the person wants from the automation, a WISH_... code."""
    eyes_on_at: list[float] = column(RUN, op.FAR)
    """Time at which the driver will look at the road, s; FAR for never or done."""
    hands_on_at: list[float] = column(RUN, op.FAR)
    """Time at which the driver will have the hands on the wheel, s; FAR for never or done."""
    time_eyes_on: list[float] = column(RUN, -1.0)
    """Time at which the eyes were first on the road after a request, s; -1 before."""
    time_hands_on: list[float] = column(RUN, -1.0)
    """Time at which the hands were first on the wheel after a request, s; -1 before."""
    wander_at: list[int] = column(RUN, op.NONE)
    """Number of the drawn lateral position from which the driver steers for the next one, and of the request."""
    wander_request: list[int] = column(RUN)
    wander_from: list[float] = column(RUN)
    """The two drawn positions."""
    wander_to: list[float] = column(RUN)
    manual_since: list[float] = column(RUN, -1.0)
    """Time since which the driver has driven, s; -1 before the first response."""
    still_since: list[float] = column(RUN, -1.0)
    """Time since which the ego has stood, s; -1 while it moves."""
    still_noted: list[int] = column(RUN)
    """1 from the logging of a stop by the driver until the ego has driven on."""
    held_up_since: list[float] = column(RUN, -1.0)
    """Time since which the automated ego has stood without a reason, s; -1 while it does not."""
    held_up: list[int] = column(RUN)
    """1 if it has done so for too long."""
    held_up_logged: list[int] = column(RUN)
    """1 if this stop has been logged."""
    hazard_lights: list[int] = column(RUN)
    """1 while the hazard lights are on."""
    lane_lost: list[int] = column(RUN)
    """1 from when neither side of the lane is seen until it is recognised again."""
    lane_losses: list[int] = column(RUN)
    """Number of times that the lane was lost."""
    lane_seen_since: list[float] = column(RUN, -1.0)
    """Time since which a side of the lane has been seen, s; -1 while neither is."""
    recall_off: list[float] = column(RUN)
    """Error of the estimated offset while the lane is lost, estimated minus true, m, positive to the left."""
    recall_heading: list[float] = column(RUN)
    """Error of the estimated heading, rad."""
    recall_along: list[float] = column(RUN)
    """Error of the estimated distance along the lane, m."""
    recall_bias: list[float] = column(RUN)
    """Rate of the heading's error, rad/s: the gyroscope's bias."""
    recall_share: list[float] = column(RUN)
    """Rate of the distance's error per metre driven."""
    path_anew: list[int] = column(RUN)
    """1 if the ego has left its path for another lane since this was last reset."""
    manoeuvre: list[int] = column(RUN, op.MANOEUVRE_KEEP)
    """MANOEUVRE_... code of the driver."""
    merging: list[int] = column(RUN)
    """1 during a merge."""
    merge_from_lane: list[int] = column(RUN)
    """Lane and road on which the merge began."""
    merge_from_road: list[int] = column(RUN, op.NONE)
    seeks_gap: list[int] = column(RUN)
    """1 while only the traffic in a neighbouring lane prevents an evasion into it."""
    awaits_oncoming: list[int] = column(RUN)
    """1 while a vehicle approaches that may prevent an evasion."""
    evade_until: list[float] = column(RUN)
    """Odometer from which the driver may return to the lane's centre, m."""
    evade_commit: list[float] = column(RUN)
    """Odometer from which the evasion is no longer given up, m."""
    log_time: list[float] = column(LOG)
    """The last events: time, s, EVENT_... code and value of each; event k is at k modulo the number of places."""
    log_kind: list[int] = column(LOG, op.NONE)
    log_value: list[float] = column(LOG)
    log_count: list[int] = column(RUN)
    """Number of events so far."""


def new_state(program: Program) -> State:
    """Return a state of the right sizes for a program, with its declared start values."""
    return at_start(State, program)


def make_draws(seed: int, variant: int = 0) -> list[float]:
    """Return DRAWS_PER_RUN numbers for `State.draw` that depend only on the seed and the variant's index."""
    drawn = [0.0] * op.DRAWS_PER_RUN
    drawn[op.DRAW_PERSON] = normal(seed, variant, "driver/person")
    drawn[op.DRAW_SEED] = float(hash_bits(seed, variant, "steps") & 0xFFFFFFFF)
    return drawn
