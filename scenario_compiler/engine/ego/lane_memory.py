"""The automation's estimate of its position in a lane that it cannot see, and steering by this estimate.

While at least one side of the lane is seen, the vehicle knows its position in the lane. When both are lost, it
continues from that position by odometry along the lane of the planned route: a gyroscope measures the change of
heading, the wheels the distance. The estimate is the true value plus an error that grows; the columns `recall_...` are
estimated minus true. The sizes of the errors are given by the plan, and they are drawn with the run's seed.

    heading' = bias + random walk        offset' = v sin(heading)        along' = share v

A lane that is seen again is used after the time RECOGNISED, but not while a request is open.
"""

from __future__ import annotations

from math import cos, pi, sin

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.limits import control_period
from scenario_compiler.engine.motion.path import section_holds
from scenario_compiler.engine.motion.steering import aim, path_point, preview_distance
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_normal
from scenario_compiler.roads.geometry import road_piece_at
from scenario_compiler.roads.lanes import row_place
from scenario_compiler.roads.tables import RoadTables

RECOGNISED = 1.0
"""Time for which a lane must be seen again before it is used, s; chosen: longer than false detections of paint last."""


@compiled
def asks_now(st: State) -> int:
    """Return 1 while a request is unanswered, including the minimum-risk manoeuvre."""
    state = st.takeover_state[0]
    return 1 if state in (op.TAKEOVER_REQUEST, op.TAKEOVER_ESCALATION, op.TAKEOVER_MINIMUM_RISK) else 0


@compiled
def draw_error(p: Program, st: State, size: int, which: int) -> float:
    """Return a normal error for the present loss of the lane; `size` is the slot of its standard deviation."""
    return p.const[size] * random_normal(run_seed(st, op.NONE), op.STREAM_ODOMETRY, st.lane_losses[0], which)


@compiled
def lose_lane(p: Program, st: State) -> None:
    """Begin an estimate: draw the errors of the measured position and heading, of the gyroscope and of the wheels."""
    st.lane_lost[0] = 1
    st.lane_losses[0] += 1
    st.recall_off[0] = draw_error(p, st, slot.K_PLACE_ERROR, 0)
    st.recall_heading[0] = draw_error(p, st, slot.K_HEADING_ERROR, 1)
    st.recall_bias[0] = draw_error(p, st, slot.K_GYRO_BIAS, 2)
    st.recall_share[0] = draw_error(p, st, slot.K_DISTANCE_ERROR, 3)
    st.recall_along[0] = 0.0


@compiled
def drift(p: Program, st: State, i: int) -> None:
    """Let the errors grow over one control step.

    The draws are numbered by the control steps, so that the same walk is drawn at any time step. The odd numbers are
    those of the frames at two frames per control step, as in the library.
    """
    dt = control_period(p)
    draw = 2 * ((st.frame[0] - 1) // max(p.control_every[0], 1)) + 1
    walk = random_normal(run_seed(st, op.NONE), op.STREAM_ODOMETRY, 4096 + st.lane_losses[0], draw)
    st.recall_heading[0] += st.recall_bias[0] * dt + p.const[slot.K_GYRO_NOISE] * safe_sqrt(dt) * walk
    st.recall_off[0] += st.v[i] * sin(st.recall_heading[0]) * dt
    st.recall_along[0] += st.recall_share[0] * st.v[i] * dt


@compiled
def remember_lane(p: Program, st: State, i: int) -> None:
    """Update the estimate at a control step, depending on how well the sides of the lane are seen."""
    limit = p.const[slot.K_CONFIDENCE_REQUEST]
    if st.conf_left[0] < limit and st.conf_right[0] < limit:
        st.lane_seen_since[0] = -1.0
        if st.lane_lost[0] == 0:
            lose_lane(p, st)
    elif st.lane_seen_since[0] < 0.0:
        st.lane_seen_since[0] = st.clock[0]
    if st.lane_lost[0] == 0:
        return
    seen = st.lane_seen_since[0] >= 0.0 and st.clock[0] - st.lane_seen_since[0] >= RECOGNISED - op.TOLERANCE
    if seen and asks_now(st) == 0:
        st.lane_lost[0] = 0
    else:
        drift(p, st, i)


@compiled
def steers_by_memory(p: Program, st: State) -> int:
    """Return 1 if the automation steers by the estimate: it does not see the lane, and has requested or is about to."""
    if st.lane_lost[0] == 0:
        return 0
    if asks_now(st) == 1:
        return 1
    about_to = p.cause_on[op.CAUSE_LANE_CONFIDENCE] == 1 or p.cause_on[op.CAUSE_SENSOR_HEALTH] == 1
    return 1 if about_to and st.takeover_state[0] in (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING) else 0


@compiled
def believed_pose(n: RoadTables, st: State) -> tuple[float, float, float]:
    """Return the estimated pose (x, y, heading) of the ego in the map's axes, m and rad."""
    road = st.path_road[0]
    row = st.path_row[0]
    s = st.path_s[0] + st.path_sense[0] * st.recall_along[0]
    if section_holds(n, row, s) == 0:
        s = st.path_s[0]
    off = st.path_off[0] + st.recall_off[0]
    x, y, _, h, _, _, _ = row_place(n, road, row, road_piece_at(n, road, s), s, st.path_sense[0] * off)
    if st.path_sense[0] < 0:
        h = h + pi
    return x, y, h + st.path_heading[0] + st.recall_heading[0]


@compiled
def remembered_angle(n: RoadTables, p: Program, st: State, i: int, most: float) -> float:
    """Return the angle of the front wheels that follows the lane from the estimated pose, rad."""
    if st.path_road[0] < 0 or st.path_row[0] < 0:
        return 0.0
    x, y, h = believed_pose(n, st)
    preview = preview_distance(st, i)
    to_x, to_y = path_point(n, p, st, i, max(preview + st.recall_along[0], 0.0), preview, 0.0)
    c = cos(h)
    w = sin(h)
    dx = to_x - x
    dy = to_y - y
    return aim(p, st, i, dx * c + dy * w, dy * c - dx * w, most)
