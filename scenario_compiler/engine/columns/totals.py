"""Totals: the sums and extremes that the measures of a run add up while it runs, as flat columns.

A sweep judges its runs by them, so that it keeps no traces. A total that still has its start value is undefined: what
it measures did not happen. `MEASURES` in `recording` says what each means and computes the same from whole recordings.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import ENTITY
from scenario_compiler.forms.declaration import RUN, Columns, Of, column, columns_of, container, fixed
from scenario_compiler.vocabulary.horizon import HORIZON

CORNER = fixed("corner of a box", 4)
CORNERS = fixed("corner of two boxes", 8)

SPREAD = fixed("spread of the lateral position", 3)

VARIANT = fixed("variant of the steering reversal rate", 2)

TAKEOVERS = 8
"""Takeovers of a run that are kept, the first ones; all are counted."""
TAKEOVER = fixed("takeover", TAKEOVERS)


TRAIL_ROWS = 256
"""Rows that are kept of where each entity was."""
TRAIL = Of("place on an entity's trail", lambda program: TRAIL_ROWS * ENTITY.count(program))


@container("m", 3, written=True)
class Totals(Columns):
    """The columns of the measures: SI units; times of what never happened are -1, least values FAR before the first."""

    # What the run came to.
    rows: list[int] = column(RUN)
    """Number of rows, that of t = 0 included."""
    stop: list[int] = column(RUN, op.STOP_NONE)
    flag: list[int] = column(RUN, op.FAULT_NONE)
    flag_at: list[int] = column(RUN, op.NONE)
    flag_time: list[float] = column(RUN, -1.0)
    flag_x: list[float] = column(RUN)
    """Of the entity that the fault is about, at that time: its place, heading, speed and steering angle."""
    flag_y: list[float] = column(RUN)
    flag_h: list[float] = column(RUN)
    flag_v: list[float] = column(RUN)
    flag_steer: list[float] = column(RUN)
    time_warning: list[float] = column(RUN, -1.0)
    time_request: list[float] = column(RUN, -1.0)
    time_escalation: list[float] = column(RUN, -1.0)
    time_eyes_on: list[float] = column(RUN, -1.0)
    time_hands_on: list[float] = column(RUN, -1.0)
    time_response: list[float] = column(RUN, -1.0)
    time_minimum_risk: list[float] = column(RUN, -1.0)
    time_standstill: list[float] = column(RUN, -1.0)
    time_no_progress: list[float] = column(RUN, -1.0)
    time_outside_domain: list[float] = column(RUN, -1.0)
    time_obstruction: list[float] = column(RUN, -1.0)
    time_collision: list[float] = column(RUN, -1.0)
    collision_with: list[float] = column(RUN, -1.0)
    """First entity that the ego hit."""
    events: list[int] = column(RUN)
    """Number of events so far."""
    asked_for: list[float] = column(RUN, -1.0)
    """Cause of the first request, as it was made."""

    # Of all rows.
    least_distance: list[float] = column(RUN, op.FAR)
    least_time_to_collision: list[float] = column(RUN, HORIZON)
    least_lane_time: list[float] = column(RUN, HORIZON)
    least_headway: list[float] = column(RUN, HORIZON)
    least_room: list[float] = column(RUN, op.FAR)
    """Twice the gap over the square of the closing speed, s2/m: the inverse of the deceleration that would do."""
    encroachment_rows: list[int] = column(RUN)
    """Least number of kept rows between one vehicle's being at a place and the ego's, or the other way."""
    touched: list[int] = column(RUN)
    """1 from when the ego's box has overlapped that of another entity; all these least values are 0 then."""
    least_confidence: list[float] = column(RUN, op.FAR)
    greatest_offset: list[float] = column(RUN, -1.0)
    """Distance from the lane's centre, m."""
    time_off_lanes: list[float] = column(RUN, -1.0)
    rows_off_lanes: list[int] = column(RUN)
    rows_off_road: list[int] = column(RUN)
    departures: list[int] = column(RUN)
    """Times that the ego came out of its lane, rows of the longest, and how far a side was beyond the edge, m."""
    longest_departure: list[int] = column(RUN)
    deepest_departure: list[float] = column(RUN, -1.0)
    speed_before_collision: list[float] = column(RUN, op.FAR)

    # From the first request on.
    request_cause: list[int] = column(RUN, op.CAUSE_NONE)
    """Cause in the first row behind the request that has one, and the limit's distance in the same row; the speed in
    the row of the request."""
    request_blocked: list[float] = column(RUN, op.FAR)
    request_blocked_speed: list[float] = column(RUN, op.FAR)
    request_lane_end: list[float] = column(RUN, op.FAR)
    request_speed: list[float] = column(RUN, op.FAR)
    asked: list[int] = column(RUN)
    """1 from the first request on."""
    request_density: list[float] = column(RUN, op.FAR)
    request_limit_time: list[float] = column(RUN, op.FAR)
    """Time that it left, where it was not about an obstacle."""
    time_departed: list[float] = column(RUN, -1.0)
    """Time of the first row behind the request in which the ego was out of its lane."""
    time_first_brake: list[float] = column(RUN, -1.0)
    driving: list[int] = column(RUN)
    """1 while the driver drives who took over first, 2 from when control was handed back."""
    response_seen: list[int] = column(RUN)
    """1 from the first row from the response on, with the angle of the front wheels in it, rad."""
    response_steer: list[float] = column(RUN)
    time_steered: list[float] = column(RUN, -1.0)
    """Time of the driver's first steering and of the first braking."""
    time_braked: list[float] = column(RUN, -1.0)
    greatest_longitudinal: list[float] = column(RUN, -1.0)
    """Acceleration or deceleration along the heading, m/s2, and the lateral one."""
    greatest_lateral: list[float] = column(RUN, -1.0)
    greatest_offset_after: list[float] = column(RUN, -1.0)
    """Distance from the centre of the lane at the request, m."""

    offset_at_response: list[float] = column(RUN, op.FAR)
    """Distance to the left of the centre of the lane at the request, m."""
    heading_at_response: list[float] = column(RUN, op.FAR)
    """Heading against the lane's direction, rad."""
    least_crossing: list[float] = column(RUN, HORIZON)
    """Time until a side crosses the lane's edge, s: the least, the sum and the number of rows that have one."""
    crossing_sum: list[float] = column(RUN)
    crossing_rows: list[int] = column(RUN)

    # The steering wheel while the driver drives who took over first: coarse reversals, and fine ones.
    driven_rows: list[int] = column(RUN)
    coarse_reversals: list[float] = column(RUN)
    fine_reversals: list[float] = column(RUN)
    wheel_before: list[float] = column(VARIANT)
    """Angle in the row before, and in the one before that, rad, as it was and filtered."""
    wheel_long_before: list[float] = column(VARIANT)
    smooth_before: list[float] = column(VARIANT)
    smooth_long_before: list[float] = column(VARIANT)
    wheel_high: list[float] = column(VARIANT)
    """Greatest and least filtered angle since the last reversal, rad."""
    wheel_low: list[float] = column(VARIANT)
    wheel_sense: list[int] = column(VARIANT)
    """1 where the wheel is turned to the left, -1 to the right, 0 before it was turned by the gap."""
    wheel_count: list[float] = column(VARIANT)

    # The takeovers, each by its request.
    requests: list[int] = column(RUN)
    """Number of requests."""
    state: list[int] = column(RUN)
    """State of the takeover in the row before."""
    undescribed: list[int] = column(RUN)
    """1 where there was no row with a cause behind the last request."""
    takeover_request: list[float] = column(TAKEOVER, -1.0)
    takeover_cause: list[float] = column(TAKEOVER, -1.0)
    takeover_blocked: list[float] = column(TAKEOVER, op.FAR)
    takeover_blocked_speed: list[float] = column(TAKEOVER, op.FAR)
    takeover_lane_end: list[float] = column(TAKEOVER, op.FAR)
    takeover_speed: list[float] = column(TAKEOVER, op.FAR)
    takeover_escalation: list[float] = column(TAKEOVER, -1.0)
    takeover_response: list[float] = column(TAKEOVER, -1.0)
    takeover_minimum_risk: list[float] = column(TAKEOVER, -1.0)
    takeover_standstill: list[float] = column(TAKEOVER, -1.0)
    takeover_hand_back: list[float] = column(TAKEOVER, -1.0)
    takeover_limit_time: list[float] = column(TAKEOVER, op.FAR)
    takeover_density: list[float] = column(TAKEOVER, op.FAR)
    takeover_lane_time: list[float] = column(TAKEOVER, HORIZON)
    """Least time to collision along the lane from the request to the next, s, and greatest accelerations, m/s2."""
    takeover_longitudinal: list[float] = column(TAKEOVER, -1.0)
    takeover_lateral: list[float] = column(TAKEOVER, -1.0)

    # Lane keeping after the response: of the two windows, and of the one that may be stable.
    spread_count: list[int] = column(SPREAD)
    spread_mean: list[float] = column(SPREAD)
    """Mean of the lateral position, and the sum of squared distances from it."""
    spread_squares: list[float] = column(SPREAD)
    spread_broken: list[int] = column(SPREAD)
    """1 from when the lane was changed, or the ego was gone, in the window."""
    settling_deviation: list[float] = column(RUN, -1.0)
    """Standard deviation of the first window, m, and of the second."""
    settled_deviation: list[float] = column(RUN, -1.0)
    windows: list[int] = column(RUN)
    """Windows that are over, and the first of those that were stable up to the last one, or NONE."""
    stable_from: list[int] = column(RUN, op.NONE)

    # The ego in the last row.
    row_time: list[float] = column(RUN, -1.0)
    row_present: list[int] = column(RUN)
    row_v: list[float] = column(RUN, op.FAR)
    row_a: list[float] = column(RUN)
    row_h: list[float] = column(RUN)
    row_road: list[int] = column(RUN, op.NONE)
    row_lane: list[int] = column(RUN)
    row_s: list[float] = column(RUN)
    row_off: list[float] = column(RUN)
    row_steer: list[float] = column(RUN)
    row_brake: list[float] = column(RUN)
    row_state: list[int] = column(RUN)
    row_cause: list[int] = column(RUN)
    row_confidence: list[float] = column(RUN)
    """Of the better side."""
    row_blocked: list[float] = column(RUN, op.FAR)
    row_blocked_speed: list[float] = column(RUN)
    row_lane_end: list[float] = column(RUN, op.FAR)
    row_limit_time: list[float] = column(RUN, op.FAR)
    row_density: list[float] = column(RUN)
    row_lane_time: list[float] = column(RUN, op.FAR)
    row_width: list[float] = column(RUN)
    """Width of the lane, 0 off the lanes, and the heading against its direction."""
    row_heading: list[float] = column(RUN)
    row_on_road: list[int] = column(RUN)
    curvature: list[float] = column(RUN)
    """Curvature that was driven to the last row, 1/m, positive to the left; known from the second row on."""

    # The row that lane keeping adds when the next one is there, and the one that it added last.
    before_road: list[int] = column(RUN, op.NONE)
    before_s: list[float] = column(RUN)
    before_off: list[float] = column(RUN)
    before_present: list[int] = column(RUN)
    before_inside: list[int] = column(SPREAD)
    """1 where it lies in the window."""
    before_driven: list[int] = column(RUN)
    """1 where the driver drove who took over first."""
    added_left: list[float] = column(RUN)
    """Offset to the left in the direction of travel."""
    added_inside: list[int] = column(SPREAD)
    before_lane: list[int] = column(RUN)
    before_time: list[float] = column(RUN)
    before_v: list[float] = column(RUN)
    before_width: list[float] = column(RUN)
    before_heading: list[float] = column(RUN)
    before_after: list[int] = column(RUN)
    """1 where it lies behind the request."""
    added_after: list[int] = column(RUN)
    before_answered: list[int] = column(RUN)
    """1 where it lies behind the response."""
    added_count: list[int] = column(RUN)
    added_step: list[float] = column(RUN)
    """Change of the offset from one row to the next, the last that was no change of lane."""
    aside: list[float] = column(RUN)
    """Distance from the centre of the present lane to that of the lane at the request, by the changes of lane since."""
    sense: list[int] = column(RUN)
    """Sign of the last step along the road, 0 where there was none, and of the last that had one."""
    sense_kept: list[int] = column(RUN)

    # The present departure from the lane.
    departed: list[int] = column(RUN)
    """1 while the ego is out of its lane."""
    departed_rows: list[int] = column(RUN)
    departed_width: list[float] = column(RUN)
    """Width of the lane that was left, the offset in the row before, its change to there, and what changes of lane made
    of it since."""
    departed_left: list[float] = column(RUN)
    departed_step: list[float] = column(RUN)
    departed_aside: list[float] = column(RUN)

    # Where everybody was: middle of the box, height, cosine and sine of the heading, and whether it was there.
    trail_x: list[float] = column(TRAIL, kept=True)
    trail_y: list[float] = column(TRAIL, kept=True)
    trail_z: list[float] = column(TRAIL, kept=True)
    trail_cos: list[float] = column(TRAIL, kept=True)
    trail_sin: list[float] = column(TRAIL, kept=True)
    trail_there: list[int] = column(TRAIL, kept=True)
    trail_count: list[int] = column(RUN)
    """Number of rows that have been kept."""
    trail_at: list[int] = column(RUN)
    """Where in the rings the next row goes."""
    trail_square: list[float] = column(ENTITY)
    """Square of the greatest way from one row to the next, m2."""
    trail_way: list[float] = column(ENTITY)
    """Way from the row before, m."""
    free_before: list[float] = column(ENTITY)
    """How far the ego and the entity may drive together until it may be where the ego was, and the other way, m."""
    free_behind: list[float] = column(ENTITY)
    trail_every: list[int] = column(RUN, 1)
    """Steps from one kept row to the next, and the number of rows that are looked back at, and one."""
    trail_limit: list[int] = column(RUN, 1)
    movers: list[int] = column(RUN)
    """Number of other entities that may move."""

    # Boxes.
    seen_h: list[float] = column(ENTITY)
    """Heading as it is recorded, in [0, 2 pi), with its cosine and sine."""
    seen_cos: list[float] = column(ENTITY, 1.0)
    seen_sin: list[float] = column(ENTITY)
    corner_x: list[float] = column(CORNERS)
    """Corners of the ego's box, then of another one."""
    corner_y: list[float] = column(CORNERS)
    corner_along: list[float] = column(CORNER)
    """The other one's along the circle that the ego drives on, and across it."""
    corner_across: list[float] = column(CORNER)


SUMMARY: tuple[str, ...] = tuple(name for name, one in columns_of(Totals).items() if one.of is RUN)
"""What a sweep writes for a run, in this order."""

TAKEOVER_FIELDS: tuple[str, ...] = tuple(name for name, one in columns_of(Totals).items() if one.of is TAKEOVER)
"""What it writes for each takeover, in this order, after that."""

SUMMARY_SIZE = len(SUMMARY) + TAKEOVERS * len(TAKEOVER_FIELDS)
"""Numbers that a sweep writes for a run."""

TAKEOVERS_AT = len(SUMMARY)
"""Where the takeovers begin in them."""
