"""State: everything that changes during a run, as flat columns of a fixed size.

`reset` fills every column but the inputs and draws, so one state serves all variants of a sweep.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

from scenario_compiler.engine.opcodes import (
    BUCKETS,
    DELAY_RECORDS,
    DRAWS_PER_RUN,
    FAILURES,
    HELD_INPUTS,
    LOG_SIZE,
    WAY_SIZE,
    WEATHER_SIZE,
)
from scenario_compiler.engine.tables import Program
from scenario_compiler.randomness import hash_bits, normal, uniform


@dataclass(slots=True)
class State:
    """The columns of a run: SI units, radians, OpenDRIVE axes; codes of `opcodes`."""

    # The run, one element each.
    clock: list[float]
    """Time, s: the sum of the steps."""
    frame: list[int]
    """Number of the frame; 0 is the one of length 0."""
    stop: list[int]
    """STOP_... as soon as the run is over."""
    flag: list[int]
    """FAULT_...; a fault stops the run."""
    flag_at: list[int]
    """The entity, condition or action that the fault is about."""
    draw: list[float]
    """Draws made before the run: normal and uniform ones of four requests, then the seed of the counter hash."""

    # Entities.
    present: list[int]
    """1 while the entity is in the world; an absent one does not move, collide or hide, and is not seen."""
    x: list[float]
    y: list[float]
    z: list[float]
    h: list[float]
    pitch: list[float]
    roll: list[float]
    v: list[float]
    a: list[float]
    steer: list[float]
    """Angle of the front wheels, positive to the left."""
    throttle: list[float]
    brake: list[float]
    road: list[int]
    """Index of the road, -1 off every road."""
    lane: list[int]
    s: list[float]
    off: list[float]
    """Left of the lane's centre in the road's s direction."""
    t: list[float]
    """Left of the reference line."""
    facing: list[int]
    """1 where the entity's forward direction goes along s, else -1."""
    turn: list[float]
    """Heading relative to `facing` along the lane."""
    kept_lane: list[int]
    """Lane that a scripted entity is led by: its own, or the target of a lane change."""
    kept_off: list[float]
    here_road: list[int]
    """Where the lane's row and the road's piece below were found last: road and lane."""
    here_lane: list[int]
    here_from: list[float]
    """They hold for every s from here to before `here_to`."""
    here_to: list[float]
    here_row: list[int]
    here_piece: list[int]
    odometer: list[float]
    still: list[float]
    """How long the entity has stood, s; negative while it moves."""
    at_end: list[float]
    """How long it has stood at the end of a road, s; negative while it does not."""
    off_road: list[float]
    """How long it has been off every lane, s; negative while it is on one."""
    velocity_x: list[float]
    """Velocity and acceleration in the world, where a condition asks for them."""
    velocity_y: list[float]
    velocity_z: list[float]
    acceleration_x: list[float]
    acceleration_y: list[float]
    acceleration_z: list[float]
    before_x: list[float]
    before_y: list[float]
    before_z: list[float]
    follows: list[int]
    """1 while it follows the vehicle ahead."""
    controller: list[int]
    """CONTROLLER_... that it has."""
    desired: list[float]
    """Speed that it aims for while it follows."""
    ended: list[int]
    """1 when the entity stands at the end of its road."""
    visible: list[int]
    """Who minds the entity, by SEEN_... bits."""
    towed: list[int]
    """Trailer that it tows, or NONE."""
    towed_by: list[int]
    trains: list[int]
    """1 from the first trailer that is connected on; one element."""
    moved: list[int]
    """1 when an action has moved the entity in this step; taking stock clears it."""
    longitudinal: list[int]
    """Action that changes the entity's speed, or -1."""
    lateral: list[int]
    """Action that changes the entity's lane, or -1."""
    last_x: list[float]
    last_y: list[float]
    last_v: list[float]
    order: list[int]
    """Entities by the x of their boxes' left ends."""
    reach: list[float]
    """Half diagonal of the entity's box."""
    middle_x: list[float]
    """Centre of the entity's box."""
    middle_y: list[float]
    box_h: list[float]
    """Heading of the box, its cosine and its sine."""
    box_cos: list[float]
    box_sin: list[float]

    # Positions of the plan.
    position_x: list[float]
    position_y: list[float]
    position_at_road: list[int]
    position_at_lane: list[int]
    position_at_s: list[float]

    # Variables, traffic signals, the time of day and the road.
    variable: list[float]
    signal_state: list[int]
    """State of each signal as the place of a text, NONE for an unknown one."""
    phase_now: list[int]
    """Phase of each controller of signals, NONE before its begin."""
    phase_since: list[float]
    """When that phase began, or the controller's begin."""
    day_known: list[int]
    """1 when there is a time of day."""
    day_runs: list[int]
    day_from: list[float]
    """Date and time at `day_since`, s since 1970."""
    day_since: list[float]
    friction: list[float]
    """Factor of the road's friction."""
    held_on: list[int]
    """1 for each input of the ego that an action holds."""
    held_value: list[float]

    # Storyboard.
    acting: list[int]
    """1 where an event runs in this frame; one element."""
    init_acting: list[int]
    """1 until no action of the init runs any more; one element."""
    element_state: list[int]
    element_runs: list[int]
    """Executions so far."""
    element_busy: list[int]
    """Of a maneuver, how many of its events run."""
    element_started: list[int]
    """Frame from which the last start transition is seen; -1 before."""
    element_ended: list[int]
    element_stopped: list[int]
    element_skipped: list[int]
    condition_before: list[int]
    """What a condition with an edge was at its last evaluation, NONE before the first and after the edge has fired."""
    ring_time: list[float]
    ring_value: list[int]
    ring_first: list[int]
    ring_size: list[int]
    action_state: list[int]
    action_element: list[int]
    """Element that an action stands in, or -1 for an action of the init."""
    action_progress: list[float]
    action_span: list[float]
    action_from: list[float]
    action_change: list[float]
    action_a: list[float]
    """Free memory of whoever executes the action; so is `action_b`."""
    action_b: list[float]
    track_x: list[float]
    """Vertices of trajectories, as they lay when their action began last."""
    track_y: list[float]
    track_h: list[float]
    track_s: list[float]
    track_time: list[float]
    track_v: list[float]
    """Speed behind a vertex, and `track_a` the acceleration, of polylines that are followed by their times."""
    track_a: list[float]
    track_bend: list[float]
    """Curvature of a clothoid at a vertex, and its change with length."""
    track_bend_rate: list[float]
    guide: list[int]
    """Guide that the entity takes its turns by, RANDOM_GUIDE for turns at random, or NONE."""
    turn_from: list[int]
    """Road at whose end the turn below is taken; NONE before it is drawn. This and what follows is of traffic."""
    turn_to: list[int]
    """Road that the vehicle turns into, NONE where there is no choice."""
    turns: list[int]
    """Number of turns drawn so far."""
    claim: list[int]
    """Connecting road of a junction that the vehicle may drive on, or NONE."""
    entered: list[int]
    """1 from when it has come to that road."""
    asked: list[int]
    """Frame since which it waits for a connecting road, or NONE."""
    wish: list[float]
    """Speed that the driver aims for, negative before the first decision."""
    lane_rest: list[float]
    """How far the lane goes on."""
    change_at: list[float]
    """When the last lane change began."""
    change_from: list[float]
    """Offset from the new lane's centre at its begin."""
    bucket_next: list[int]
    """Next entity in the chain of its road."""
    bucket_head: list[int]
    """First entity of each chain."""
    along_way: list[int]
    """1 when the way was last walked ahead, -1 when back."""
    action_x: list[float]
    """Where the entity was when it began to follow a path."""
    action_y: list[float]

    # Inputs from outside: the controller and the detector, or ideal perception.
    even_row: list[int]
    """Row of the path's lane whose marks on both sides are known to stay as they are for a while, or NONE."""
    even_from: list[float]
    """Between which s on that row, and the marks' qualities."""
    even_to: list[float]
    even_left: list[float]
    even_right: list[float]
    conf_left: list[float]
    conf_right: list[float]
    health: list[float]
    auto_throttle: list[float]
    auto_steer: list[float]
    """-1 .. 1 of the greatest steering angle, positive to the left."""
    auto_brake: list[float]
    auto_request: list[int]

    # The ego.
    sigma: list[float]
    """Camera noise now, grey levels."""
    noise: list[float]
    """Noise of the camera itself, without its failures."""
    image_health: list[float]
    """What noise, blackout, blur and dirt leave of the camera's health, 0 to 1."""
    failure_now: list[float]
    """By kind, how severe the camera's failures are, 0 to 1."""
    failure_since: list[float]
    """Time from which a failure's onset counts, -1 while it waits or is over."""
    failure_active: list[int]
    missing: list[int]
    """1 where the image of this frame does not arrive."""
    frozen: list[int]
    """1 where the image before is delivered again."""
    weather: list[float]
    """The 14 numbers now."""
    paint_seen: list[float]
    """What the weather leaves of the confidence in a line, 0 to 1."""
    weather_from: list[float]
    """The numbers when the present change began."""
    weather_to: list[int]
    """The weather that it goes to, NONE when it does not change."""
    weather_since: list[float]
    weather_over: list[float]
    target_speed: list[float]
    """Speed that the automation aims for; a speed action on the ego changes it."""
    path_road: list[int]
    path_lane: list[int]
    path_s: list[float]
    path_row: list[int]
    """Row of that lane there, -1 where the road has no such lane."""
    path_piece: list[int]
    """Piece of the road's reference line there."""
    path_from: list[float]
    """Between which s that row and that piece hold."""
    path_to: list[float]
    path_sense: list[int]
    """1 where the path's lane is driven along s, else -1."""
    path_off: list[float]
    """Offset from the path lane's centre, positive to the left of the travel."""
    path_heading: list[float]
    """Heading of the ego relative to the path's direction."""
    path_found: list[int]
    route_at: list[int]
    """Row of `Program.route_road` that the ego has come to."""
    command_throttle: list[float]
    command_steer: list[float]
    command_brake: list[float]
    pedal: list[float]
    """Acceleration asked for at the last control step, for limiting jerk."""
    shift_begin: list[float]
    """Odometer at which the planned move to the side begins; see `lane_keeping`."""
    shift_end: list[float]
    shift_from: list[float]
    """Offset from the path lane's centre before it, positive to the left of the direction of travel."""
    shift_to: list[float]

    # What lies ahead: the way, then each entity as seen along it.
    way_road: list[int]
    way_lane: list[int]
    way_row: list[int]
    """Row of that lane at the way's place, -1 where there is no such lane."""
    way_s: list[float]
    way_sign: list[int]
    way_from: list[float]
    way_count: list[int]
    eye_x: list[float]
    """The sensor of the present look: where it is, cosine and sine of its heading, its range and its edge, the cosine
    of half its angle of view.
    """
    eye_y: list[float]
    eye_cos: list[float]
    eye_sin: list[float]
    eye_reach: list[float]
    eye_edge: list[float]
    seen: list[int]
    """1 when the entity is ahead on the way and the forward sensor (or the driver) sees it."""
    on_way: list[int]
    near: list[float]
    """Distance along the way from the ego's reference point to the nearest part of the entity's box."""
    far: list[float]
    low: list[float]
    """Right end of the box across the way, relative to the lane's centre, positive to the left."""
    high: list[float]
    along: list[float]
    """Speed along the way."""
    across: list[float]
    """Speed to the left of the way."""
    border_left: list[float]
    """Left border of the lane at the entity, relative to its centre."""
    border_right: list[float]
    blocked_distance: list[float]
    """From the front bumper to where the path is blocked, FAR when it is free."""
    blocked_far: list[float]
    """From the front bumper to the far end of what blocks the path."""
    clear_row: list[int]
    """Row of the path's lane that has been seen not to end soon, NONE without one."""
    clear_s: list[float]
    """Up to where on that row this is known."""
    lane_end_distance: list[float]
    """From the front bumper to the end of the driving lane, FAR when none is near."""
    through_lane: list[int]
    """Lane beside an ending one that goes on; 0 when there is none."""
    through_side: list[int]
    """1 when that lane is on the left in the direction of travel, -1 on the right."""
    gap_free: list[int]
    contact: list[int]
    """1 while the entity's box overlaps that of the vehicle that is reported."""
    struck: list[int]
    """1 from when the entity's box has overlapped that of another one."""
    crashed: list[int]

    # Takeover.
    takeover_state: list[int]
    cause: list[int]
    requests: list[int]
    """Number of requests so far."""
    history: list[int]
    """By cause, the last 32 control steps as bits, the latest lowest."""
    quiet: list[int]
    """Number of control steps for which no cause has had a reason."""
    asking: list[int]
    """By cause, 1 where it asks for a takeover at this control step."""
    time_warning: list[float]
    """Time of the first of each, -1 before."""
    time_request: list[float]
    time_escalation: list[float]
    time_response: list[float]
    time_minimum_risk: list[float]
    time_standstill: list[float]
    request_at: list[float]
    """Time of the present request."""
    answer_at: list[float]
    """Time at which the driver answers the present request, FAR for never."""
    manual_since: list[float]
    still_since: list[float]
    """Time since which the ego stands, -1 while it moves."""
    hazard_lights: list[int]
    trusted_steer: list[float]
    """Last steering command that the automation could rely on."""
    manoeuvre: list[int]
    merging: list[int]
    merge_from_lane: list[int]
    merge_from_road: list[int]
    evade_until: list[float]
    """Odometer at which the driver may go back to the lane's centre."""
    evade_commit: list[float]
    """Odometer at which the move to the side has gone too far to be given up."""
    log_time: list[float]
    log_kind: list[int]
    log_value: list[float]
    log_count: list[int]


_ENTITY = (
    *[
        "present",
        "x",
        "y",
        "z",
        "h",
        "pitch",
        "roll",
        "v",
        "a",
        "steer",
        "throttle",
        "brake",
        "command_throttle",
        "command_steer",
        "command_brake",
        "road",
        "lane",
        "s",
        "off",
        "t",
        "facing",
        "turn",
        "kept_lane",
        "kept_off",
        "here_road",
        "here_lane",
        "here_from",
        "here_to",
        "here_row",
        "here_piece",
        "odometer",
        "ended",
        "visible",
        "towed",
        "towed_by",
        "still",
        "at_end",
        "off_road",
        "velocity_x",
        "velocity_y",
        "velocity_z",
        "acceleration_x",
        "acceleration_y",
        "acceleration_z",
        "before_x",
        "before_y",
        "before_z",
        "follows",
        "controller",
        "desired",
    ],
    *[
        "moved",
        "longitudinal",
        "lateral",
        "last_x",
        "last_y",
        "last_v",
        "order",
        "reach",
        "middle_x",
        "middle_y",
        "box_h",
        "box_cos",
        "box_sin",
        "seen",
        "on_way",
        "near",
        "far",
        "low",
    ],
    *["high", "along", "across", "border_left", "border_right", "contact", "struck"],
)
_TRAFFIC = (
    *(
        "guide",
        "turn_from",
        "turn_to",
        "turns",
        "claim",
        "entered",
        "asked",
        "wish",
        "lane_rest",
        "change_at",
        "change_from",
    ),
    "bucket_next",
)
_POSITION = ["position_x", "position_y", "position_at_road", "position_at_lane", "position_at_s"]
_ELEMENT = [
    "element_state",
    "element_runs",
    "element_busy",
    "element_started",
    "element_ended",
    "element_stopped",
    "element_skipped",
]
_CONDITION = ("condition_before",)
_RING_ROWS = ("ring_time", "ring_value")
_RING = ("ring_first", "ring_size")
_ACTION = [
    "action_state",
    "action_element",
    "action_progress",
    "action_span",
    "action_from",
    "action_change",
    "action_a",
    "action_b",
    "action_x",
    "action_y",
]
_TRACK = [
    "track_x",
    "track_y",
    "track_h",
    "track_s",
    "track_time",
    "track_v",
    "track_a",
    "track_bend",
    "track_bend_rate",
]
_WAY = ["way_road", "way_lane", "way_row", "way_s", "way_sign", "way_from"]
_LOG = ("log_time", "log_kind", "log_value")


def new_state(program: Program) -> State:
    """Return a state of the right sizes; `reset` gives it the values of t = 0."""
    p = program
    sizes = {name: 1 for name in State.__slots__}
    sizes |= dict.fromkeys(_ENTITY, p.entity_count[0])
    sizes |= dict.fromkeys(_TRAFFIC, p.entity_count[0]) | {"bucket_head": BUCKETS}
    sizes |= dict.fromkeys(_POSITION, p.position_count[0])
    sizes |= dict.fromkeys(_ELEMENT, p.element_count[0])
    sizes |= dict.fromkeys(_CONDITION, p.condition_count[0])
    sizes |= dict.fromkeys(_RING_ROWS, p.ring_count[0] * DELAY_RECORDS)
    sizes |= dict.fromkeys(_RING, p.ring_count[0])
    sizes |= dict.fromkeys(_ACTION, p.action_count[0])
    sizes |= dict.fromkeys(_TRACK, p.vertex_count[0])
    sizes |= dict.fromkeys(_WAY, WAY_SIZE)
    sizes |= {"variable": p.variable_count[0], "signal_state": p.signal_count[0]}
    sizes |= dict.fromkeys(("phase_now", "phase_since"), p.controller_count[0])
    sizes |= dict.fromkeys(("held_on", "held_value"), HELD_INPUTS)
    sizes |= dict.fromkeys(_LOG, LOG_SIZE)
    sizes |= dict.fromkeys(("failure_since", "failure_active"), p.failure_count[0])
    sizes |= {"failure_now": FAILURES, "weather": WEATHER_SIZE, "weather_from": WEATHER_SIZE}
    sizes |= {"draw": DRAWS_PER_RUN, "history": len(p.cause_on), "asking": len(p.cause_on)}
    columns: dict[str, list[float] | list[int]] = {}
    for column in fields(State):
        zero = 0.0 if "float" in str(column.type) else 0
        columns[column.name] = [zero] * sizes[column.name]
    state = State(**columns)  # type: ignore[arg-type]
    state.conf_left[0] = state.conf_right[0] = state.health[0] = 1.0
    return state


REQUESTS_DRAWN = 4


def make_draws(seed: int, variant: int = 0) -> list[float]:
    """Return DRAWS_PER_RUN numbers for `State.draw` that depend on the seed and the variant's index alone.

    A normal and a uniform one for each of four requests, and the seed of the counter hash.
    """
    drawn: list[float] = []
    for k in range(REQUESTS_DRAWN):
        drawn.append(normal(seed, variant, f"driver/takeover_time/{k}"))
        drawn.append(uniform(seed, variant, f"driver/lapse/{k}"))
    drawn.append(float(hash_bits(seed, variant, "steps") & 0xFFFFFFFF))
    return drawn
