"""Totals: sums and extremes of a run's measures, updated while it runs, as flat columns.

A sweep judges its runs by them and therefore keeps no traces. A total that still has its start value is undefined: the
measured event did not occur. `MEASURES` in `recording` defines each measure and computes it from whole recordings too.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import ENTITY
from scenario_compiler.forms.declaration import RUN, Columns, Of, column, columns_of, container, fixed
from scenario_compiler.vocabulary.horizon import HORIZON

WAITING = 32
"""Number of pairs of the ego and another entity that wait until they are measured together; chosen."""
PAIR = fixed("waiting pair", WAITING)

CORNER = fixed("corner of a box", 4)
CORNERS = fixed("corner of two boxes", 8)

INTERVALS = 6
"""Number of conditions on two moments between rows: one for each moment, and one for each axis of two boxes."""
INTERVAL = fixed("condition on two moments", INTERVALS)

PLANE = fixed("coordinate in the plane", 2)

SPREAD = fixed("spread of the lateral position", 3)

VARIANT = fixed("variant of the steering reversal rate", 2)

TAKEOVERS = 8
"""Number of takeovers of a run that are described, the first ones; all are counted."""
TAKEOVER = fixed("takeover", TAKEOVERS)


TRAIL_ROWS = 256
"""Number of rows for which the poses of all entities are kept."""
TRAIL = Of("place on an entity's trail", lambda program: TRAIL_ROWS * ENTITY.count(program))


@container("m", 3, written=True)
class Totals(Columns):
    """The columns of the measures, in SI units.

    The times of events that did not occur are -1; least values start at FAR.
    """

    # The outcome of the run.
    rows: list[int] = column(RUN)
    """Number of rows, including that of t = 0."""
    stop: list[int] = column(RUN, op.STOP_NONE)
    flag: list[int] = column(RUN, op.FAULT_NONE)
    flag_at: list[int] = column(RUN, op.NONE)
    flag_time: list[float] = column(RUN, -1.0)
    flag_x: list[float] = column(RUN)
    """Position, heading, speed and steering angle, at that time, of the entity of the fault."""
    flag_y: list[float] = column(RUN)
    flag_h: list[float] = column(RUN)
    flag_v: list[float] = column(RUN)
    flag_steer: list[float] = column(RUN)
    start_tight: list[int] = column(RUN)
    """As in `State`. If it is 0 and there is no fault, the start is sound, without the slower checks of the plan."""
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
    time_short_start: list[float] = column(RUN, -1.0)
    time_collision: list[float] = column(RUN, -1.0)
    collided_with: list[int] = column(RUN, op.NONE)
    """First entity that the ego hit."""
    events: list[int] = column(RUN)
    """Number of events so far."""

    # Of all rows.
    least_distance: list[float] = column(RUN, op.FAR)
    least_time_to_collision: list[float] = column(RUN, HORIZON)
    least_lane_time: list[float] = column(RUN, HORIZON)
    least_headway: list[float] = column(RUN, HORIZON)
    least_room: list[float] = column(RUN, op.FAR)
    """Twice the gap divided by the square of the closing speed, s2/m: the inverse of the deceleration that would
    suffice.
    """
    encroachment_rows: list[float] = column(RUN, op.FAR)
    """Least time between the presence of one vehicle at a place and that of the ego, in either order, in kept rows."""
    touched: list[int] = column(RUN)
    """1 once the ego's box has overlapped that of another entity; then all these least values are 0."""
    least_confidence: list[float] = column(RUN, op.FAR)
    greatest_offset: list[float] = column(RUN, -1.0)
    """Greatest distance from the lane's centre, m."""
    time_off_road: list[float] = column(RUN, -1.0)
    rows_off_lanes: list[int] = column(RUN)
    rows_off_road: list[int] = column(RUN)
    departures: list[int] = column(RUN)
    """Number of times that the ego left its lane."""
    longest_departure: list[int] = column(RUN)
    """Rows of the longest departure."""
    deepest_departure: list[float] = column(RUN, -1.0)
    """Greatest distance of a side beyond the lane's edge, m."""
    speed_before_collision: list[float] = column(RUN, op.FAR)

    # From the first request on.
    request_cause: list[int] = column(RUN, op.CAUSE_NONE)
    """Cause in the first row after the request that has one."""
    request_blocked: list[float] = column(RUN, op.FAR)
    """Distance and speed of the block, and distance of the lane's end, in the same row, m and m/s."""
    request_blocked_speed: list[float] = column(RUN, op.FAR)
    request_lane_end: list[float] = column(RUN, op.FAR)
    request_speed: list[float] = column(RUN, op.FAR)
    """Speed in the row of the request, m/s."""
    asked: list[int] = column(RUN)
    """1 from the first request."""
    request_density: list[float] = column(RUN, op.FAR)
    request_limit_time: list[float] = column(RUN, op.FAR)
    """Time that the request left if it was not about an obstacle, s."""
    time_departed: list[float] = column(RUN, -1.0)
    """Time of the first row after the request in which the ego was outside its lane, s."""
    time_first_brake: list[float] = column(RUN, -1.0)
    driving: list[int] = column(RUN)
    """1 while the driver drives after the first response, 2 from the following hand-back."""
    response_seen: list[int] = column(RUN)
    """1 from the first row after the response."""
    response_steer: list[float] = column(RUN)
    """Angle of the front wheels in that row, rad."""
    time_steered: list[float] = column(RUN, -1.0)
    """Time of the driver's first steering and of the first braking, s."""
    time_braked: list[float] = column(RUN, -1.0)
    greatest_longitudinal: list[float] = column(RUN, -1.0)
    """Greatest acceleration or deceleration along the heading and greatest lateral acceleration, m/s2."""
    greatest_lateral: list[float] = column(RUN, -1.0)
    greatest_offset_after: list[float] = column(RUN, -1.0)
    """Greatest distance from the centre of the lane of the request, m."""

    offset_at_response: list[float] = column(RUN, op.FAR)
    """Offset to the left of the centre of the lane of the request, m."""
    heading_at_response: list[float] = column(RUN, op.FAR)
    """Heading relative to the lane's direction, rad."""
    least_crossing: list[float] = column(RUN, HORIZON)
    """Time until a side crosses the lane's edge, s: the least value, the sum, and the number of rows that have one."""
    crossing_sum: list[float] = column(RUN)
    crossing_rows: list[int] = column(RUN)

    # The steering wheel while the driver drives after the first response: coarse and fine reversals.
    driven_rows: list[int] = column(RUN)
    coarse_reversals: list[float] = column(RUN)
    fine_reversals: list[float] = column(RUN)
    wheel_before: list[float] = column(VARIANT)
    """Angle in the previous row and in the one before it, rad, raw and filtered."""
    wheel_long_before: list[float] = column(VARIANT)
    smooth_before: list[float] = column(VARIANT)
    smooth_long_before: list[float] = column(VARIANT)
    raw_weight: list[float] = column(VARIANT)
    """Weights of the filter: of the raw angle, and of the filtered one in the previous row and in the one before it."""
    smooth_weight: list[float] = column(VARIANT)
    smooth_long_weight: list[float] = column(VARIANT)
    wheel_high: list[float] = column(VARIANT)
    """Greatest and least filtered angle since the last reversal, rad."""
    wheel_low: list[float] = column(VARIANT)
    wheel_sense: list[int] = column(VARIANT)
    """1 if the wheel was last turned to the left, -1 to the right, 0 before it was turned by the gap."""
    wheel_count: list[float] = column(VARIANT)

    # The takeovers, each by its request.
    requests: list[int] = column(RUN)
    """Number of requests."""
    state: list[int] = column(RUN)
    """State of the takeover in the previous row."""
    undescribed: list[int] = column(RUN)
    """1 if no row after the last request has had a cause."""
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
    """Least time to collision along the lane from this request to the next, s."""
    takeover_longitudinal: list[float] = column(TAKEOVER, -1.0)
    """Greatest longitudinal and lateral acceleration in the same period, m/s2."""
    takeover_lateral: list[float] = column(TAKEOVER, -1.0)

    # Lane keeping after the response: in the two windows, and in the one that may be stable.
    spread_count: list[int] = column(SPREAD)
    spread_mean: list[float] = column(SPREAD)
    """Mean of the lateral position, m, and the sum of squared deviations from it, m2."""
    spread_squares: list[float] = column(SPREAD)
    spread_broken: list[int] = column(SPREAD)
    """1 once the lane was changed, the ego was absent or the driver did not drive in the window."""
    settling_deviation: list[float] = column(RUN, -1.0)
    """Standard deviation in the first window and in the second, m."""
    settled_deviation: list[float] = column(RUN, -1.0)
    windows: list[int] = column(RUN)
    """Number of windows that are over."""
    stable_from: list[int] = column(RUN, op.NONE)
    """First window from which all windows up to the last one were stable, or NONE."""

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
    """Confidence in the better side."""
    row_blocked: list[float] = column(RUN, op.FAR)
    row_blocked_speed: list[float] = column(RUN)
    row_lane_end: list[float] = column(RUN, op.FAR)
    row_limit_time: list[float] = column(RUN, op.FAR)
    row_density: list[float] = column(RUN)
    row_lane_time: list[float] = column(RUN, op.FAR)
    row_width: list[float] = column(RUN)
    """Width of the lane, m, 0 off the lanes."""
    row_heading: list[float] = column(RUN)
    """Heading relative to the lane's direction, rad."""
    row_on_road: list[int] = column(RUN)
    curvature: list[float] = column(RUN)
    """Curvature driven up to the last row, 1/m, positive to the left; defined from the second row on."""

    # Lane keeping adds a row when the next one is known: the row to be added, and the one added last.
    before_road: list[int] = column(RUN, op.NONE)
    before_s: list[float] = column(RUN)
    before_off: list[float] = column(RUN)
    before_present: list[int] = column(RUN)
    before_inside: list[int] = column(SPREAD)
    """1 if the row lies in the window."""
    before_driven: list[int] = column(RUN)
    """1 if the driver of the first response drove."""
    added_left: list[float] = column(RUN)
    """Offset to the left in the direction of travel, m."""
    added_inside: list[int] = column(SPREAD)
    before_lane: list[int] = column(RUN)
    before_time: list[float] = column(RUN)
    before_v: list[float] = column(RUN)
    before_width: list[float] = column(RUN)
    before_heading: list[float] = column(RUN)
    before_intact: list[int] = column(RUN)
    """1 if the row is not after the first collision."""
    before_after: list[int] = column(RUN)
    """1 if the row is after the request and not after the first collision."""
    added_after: list[int] = column(RUN)
    before_answered: list[int] = column(RUN)
    """1 if the row is after the response."""
    added_count: list[int] = column(RUN)
    added_step: list[float] = column(RUN)
    """Last change of the offset between two rows that was not a lane change, m."""
    aside: list[float] = column(RUN)
    """Distance from the centre of the present lane to that of the lane of the request, summed over the lane changes, m.
    """
    sense: list[int] = column(RUN)
    """Sign of the last step along the road, 0 if there was none."""
    sense_kept: list[int] = column(RUN)
    """Sign of the last step that was not 0."""

    # The present departure from the lane.
    departed: list[int] = column(RUN)
    """1 while the ego is outside its lane."""
    departed_rows: list[int] = column(RUN)
    departed_width: list[float] = column(RUN)
    """Width of the lane that was left, m; the offset in the row before; its change in that step; and the sum of the
    lane changes since.
    """
    departed_left: list[float] = column(RUN)
    departed_step: list[float] = column(RUN)
    departed_aside: list[float] = column(RUN)

    # Past poses of all entities: centre of the box, height, cosine and sine of the heading, and presence.
    trail_x: list[float] = column(TRAIL, kept=True)
    trail_y: list[float] = column(TRAIL, kept=True)
    trail_z: list[float] = column(TRAIL, kept=True)
    trail_cos: list[float] = column(TRAIL, kept=True)
    trail_sin: list[float] = column(TRAIL, kept=True)
    trail_there: list[int] = column(TRAIL, kept=True)
    trail_count: list[int] = column(RUN)
    """Number of kept rows."""
    trail_at: list[int] = column(RUN)
    """Index of the next row in the rings."""
    trail_square: list[float] = column(ENTITY)
    """Square of the greatest displacement from one row to the next, m2."""
    trail_way: list[float] = column(ENTITY)
    """Displacement since the previous row, m."""
    free_before: list[float] = column(ENTITY)
    """Distance that the ego and the entity may travel together before the entity may be where the ego was, m."""
    free_behind: list[float] = column(ENTITY)
    """The same before the ego may be where the entity was, m."""
    strip_cos: list[float] = column(ENTITY, 2.0)
    """The strip in which the entity has driven straight: cosine and sine of its heading, and how far its middle line
    lies to the left of the origin, m.
    """
    strip_sin: list[float] = column(ENTITY)
    strip_off: list[float] = column(ENTITY)
    beside_rows: list[int] = column(ENTITY)
    """Number of kept rows for which the ego has been beside that strip, and the last of them."""
    beside_at: list[int] = column(ENTITY, op.NONE)
    strip_for: list[float] = column(ENTITY)
    """Distance that both may still travel together while `free_before` and `free_behind` leave out the rows since which
    the ego has been beside that strip, m; 0 if they leave out none."""
    place_apart: list[float] = column(PLANE)
    """Of two boxes at one place at different times: the way from the earlier centre to the later one, and what each of
    them moves from one row to the next, m.
    """
    place_first: list[float] = column(PLANE)
    place_second: list[float] = column(PLANE)
    allowed_middle: list[float] = column(INTERVAL)
    """Intervals of the moment, as parts of the time between two rows: the middle, what it gains with the sum of both
    parts, and half the length.
    """
    allowed_lean: list[float] = column(INTERVAL)
    allowed_half: list[float] = column(INTERVAL)
    trail_every: list[int] = column(RUN, 1)
    """Number of steps from one kept row to the next."""
    trail_limit: list[int] = column(RUN, 1)
    """Number of rows that are compared, plus one."""
    movers: list[int] = column(RUN)
    """Number of other entities that may move."""

    # Boxes.
    seen_h: list[float] = column(ENTITY)
    """Heading as recorded, rad, in [0, 2 pi), with its cosine and sine."""
    seen_cos: list[float] = column(ENTITY, 1.0)
    seen_sin: list[float] = column(ENTITY)
    waiting: list[int] = column(RUN)
    """Number of pairs of the ego and another entity whose boxes wait to be measured."""
    pair_other: list[int] = column(PAIR, kept=True)
    """The other entity, lower bounds of the distance and of the gap, whether it may be ahead, and the curvature."""
    pair_apart: list[float] = column(PAIR, kept=True)
    pair_gap: list[float] = column(PAIR, kept=True)
    pair_ahead: list[int] = column(PAIR, kept=True)
    pair_bend: list[float] = column(PAIR, kept=True)
    own_x: list[float] = column(PAIR, kept=True)
    """Pose and speed of the ego, with cosine and sine of the heading."""
    own_y: list[float] = column(PAIR, kept=True)
    own_h: list[float] = column(PAIR, kept=True)
    own_cos: list[float] = column(PAIR, kept=True)
    own_sin: list[float] = column(PAIR, kept=True)
    own_v: list[float] = column(PAIR, kept=True)
    other_x: list[float] = column(PAIR, kept=True)
    """The same of the other entity."""
    other_y: list[float] = column(PAIR, kept=True)
    other_h: list[float] = column(PAIR, kept=True)
    other_cos: list[float] = column(PAIR, kept=True)
    other_sin: list[float] = column(PAIR, kept=True)
    other_v: list[float] = column(PAIR, kept=True)
    corner_x: list[float] = column(CORNERS)
    """Corners of the ego's box, then of another one, m."""
    corner_y: list[float] = column(CORNERS)
    corner_ahead: list[float] = column(CORNER)
    """Corners of the other box ahead of the ego's reference point and to its left, m."""
    corner_left: list[float] = column(CORNER)
    corner_along: list[float] = column(CORNER)
    """The same corners along and across the circle on which the ego drives, m."""
    corner_across: list[float] = column(CORNER)


SUMMARY: tuple[str, ...] = tuple(name for name, one in columns_of(Totals).items() if one.of is RUN)
"""The columns that a sweep writes for a run, in this order."""

TAKEOVER_FIELDS: tuple[str, ...] = tuple(name for name, one in columns_of(Totals).items() if one.of is TAKEOVER)
"""The columns that it writes after them for each takeover, in this order."""

SUMMARY_SIZE = len(SUMMARY) + TAKEOVERS * len(TAKEOVER_FIELDS)
"""Number of values that a sweep writes for a run."""

TAKEOVERS_AT = len(SUMMARY)
"""Index of the first takeover in these values."""
