"""The state at t = 0: every column as the plan's initial words say, whatever a run before has left."""

from __future__ import annotations

from scenario_compiler.engine.collision import prepare_boxes, update_boxes
from scenario_compiler.engine.faults import fault
from scenario_compiler.engine.motion import place_scripted
from scenario_compiler.engine.numbers import clip, is_number
from scenario_compiler.engine.opcodes import (
    CAUSES,
    DELAY_RECORDS,
    FAR,
    FAULT_NONE,
    FAULT_NOT_FINITE,
    FAULT_OFF_ROAD_START,
    LOG_SIZE,
    MANOEUVRE_KEEP,
    MOTION_BICYCLE,
    MOTION_POSED,
    NONE,
    POSITION_RELATIVE,
    STANDBY,
    STOP_NONE,
    TAKEOVER_AUTOMATED,
)
from scenario_compiler.engine.path import locate_ego, set_path
from scenario_compiler.engine.slots import (
    E_DESIRED_SPEED,
    E_SPEED,
    K_NOISE,
    P_OFFSET,
    P_S,
    P_TURN,
)
from scenario_compiler.engine.starts import neighbour_lane
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_exists, lane_pose
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.travel import advance


@compiled
def reset_entities(p: Program, st: State) -> None:
    """Clear the entities' columns and set their speeds."""
    for i in range(p.entity_count[0]):
        base = p.entity_const[i]
        st.v[i] = p.const[base + E_SPEED]
        st.last_v[i] = st.v[i]
        st.a[i] = 0.0
        st.steer[i] = 0.0
        st.throttle[i] = 0.0
        st.brake[i] = 0.0
        st.odometer[i] = 0.0
        st.ended[i] = 0
        st.moved[i] = 0
        st.longitudinal[i] = NONE
        st.lateral[i] = NONE
        st.seen[i] = 0
        st.on_way[i] = 0
        st.near[i] = 0.0
        st.far[i] = 0.0
        st.low[i] = 0.0
        st.high[i] = 0.0
        st.along[i] = 0.0
        st.across[i] = 0.0
        st.border_left[i] = 0.0
        st.border_right[i] = 0.0


@compiled
def reset_story(p: Program, st: State) -> None:
    """Put the storyboard and its memories back to the start."""
    for e in range(p.element_count[0]):
        st.element_state[e] = STANDBY
        st.element_runs[e] = 0
        st.element_started[e] = -1
        st.element_ended[e] = -1
        st.element_stopped[e] = -1
        st.element_skipped[e] = -1
    for c in range(p.condition_count[0]):
        st.condition_known[c] = 0
        st.condition_before[c] = 0
    for r in range(p.ring_count[0]):
        st.ring_first[r] = 0
        st.ring_size[r] = 0
        for k in range(DELAY_RECORDS):
            st.ring_time[r * DELAY_RECORDS + k] = 0.0
            st.ring_value[r * DELAY_RECORDS + k] = 0
    for k in range(p.action_count[0]):
        st.action_state[k] = STANDBY
        st.action_element[k] = NONE
        st.action_progress[k] = 0.0
        st.action_span[k] = 0.0
        st.action_from[k] = 0.0
        st.action_change[k] = 0.0


@compiled
def reset_takeover(p: Program, st: State) -> None:
    """Put the takeover back to automated driving with nothing seen."""
    st.takeover_state[0] = TAKEOVER_AUTOMATED
    st.cause[0] = 0
    st.requests[0] = 0
    for c in range(CAUSES):
        st.history[c] = 0
    st.time_warning[0] = -1.0
    st.time_request[0] = -1.0
    st.time_escalation[0] = -1.0
    st.time_response[0] = -1.0
    st.time_minimum_risk[0] = -1.0
    st.time_standstill[0] = -1.0
    st.request_at[0] = -1.0
    st.answer_at[0] = FAR
    st.manual_since[0] = -1.0
    st.still_since[0] = -1.0
    st.hazard_lights[0] = 0
    st.trusted_steer[0] = 0.0
    st.manoeuvre[0] = MANOEUVRE_KEEP
    st.merging[0] = 0
    st.merge_from_lane[0] = 0
    st.merge_from_road[0] = NONE
    st.evade_until[0] = 0.0
    st.evade_commit[0] = 0.0
    st.shift_begin[0] = 0.0
    st.shift_end[0] = 0.0
    st.shift_from[0] = 0.0
    st.shift_to[0] = 0.0
    st.blocked_distance[0] = FAR
    st.blocked_far[0] = FAR
    st.lane_end_distance[0] = FAR
    st.through_lane[0] = 0
    st.through_side[0] = 0
    st.gap_free[0] = 1
    st.min_ttc[0] = FAR
    st.command_throttle[0] = 0.0
    st.command_steer[0] = 0.0
    st.command_brake[0] = 0.0
    st.pedal[0] = 0.0


@compiled
def reset_run(p: Program, st: State) -> None:
    """Put the clock, the log and the inputs from outside back."""
    st.clock[0] = 0.0
    st.frame[0] = 0
    st.stop[0] = STOP_NONE
    st.flag[0] = FAULT_NONE
    st.flag_at[0] = NONE
    st.sigma[0] = p.const[K_NOISE]
    st.conf_left[0] = 1.0
    st.conf_right[0] = 1.0
    st.health[0] = 1.0
    st.auto_throttle[0] = 0.0
    st.auto_steer[0] = 0.0
    st.auto_brake[0] = 0.0
    st.auto_request[0] = 0
    st.route_at[0] = 0
    st.path_road[0] = NONE
    st.path_lane[0] = 0
    st.path_s[0] = 0.0
    st.path_off[0] = 0.0
    st.path_heading[0] = 0.0
    st.path_found[0] = 0
    st.way_count[0] = 0
    st.target_speed[0] = 0.0
    if p.ego[0] >= 0:
        st.target_speed[0] = p.const[p.entity_const[p.ego[0]] + E_DESIRED_SPEED]
    st.log_count[0] = 0
    for k in range(LOG_SIZE):
        st.log_time[k] = 0.0
        st.log_kind[k] = NONE
        st.log_value[k] = 0.0


@compiled
def resolve_position(n: RoadTables, p: Program, st: State, k: int) -> tuple[int, int, float, float, int]:
    """Return (road, lane, s, offset to the left along s, direction of travel) of a position; road -1 for none.

    A relative position is counted from where the entity starts: along its lane, then to the side.
    """
    base = p.position_const[k]
    s = p.const[base + P_S]
    offset = p.const[base + P_OFFSET]
    road = p.position_road[k]
    lane = p.position_lane[k]
    if is_number(s) == 0 or is_number(offset) == 0:
        return -1, 0, 0.0, 0.0, 1
    if p.position_op[k] == POSITION_RELATIVE:
        other = p.position_entity[k]
        road, lane, s, rest = advance(n, st.road[other], st.lane[other], st.s[other], s, -1)
        direction = lane_direction(n, road, lane)
        if rest > 0.0:
            return -1, 0, 0.0, 0.0, 1
        lane = neighbour_lane(n, road, lane, s, p.position_lane[k], direction)
        if lane == 0:
            return -1, 0, 0.0, 0.0, 1
        return road, lane, s, offset * direction, lane_direction(n, road, lane)
    s = clip(s, 0.0, n.road_length[road])
    if lane_exists(n, road, lane, s) == 0:
        return -1, 0, 0.0, 0.0, 1
    return road, lane, s, offset, lane_direction(n, road, lane)


@compiled
def start_entity(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Put an entity where it starts; the ego's path starts in its lane."""
    k = p.entity_position[i]
    road, lane, s, offset, direction = resolve_position(n, p, st, k)
    if road < 0:
        st.road[i] = 0
        st.lane[i] = 0
        st.s[i] = 0.0
        fault(st, FAULT_OFF_ROAD_START, i)
        return
    turn = p.const[p.position_const[k] + P_TURN]
    if is_number(turn + st.v[i]) == 0:
        fault(st, FAULT_NOT_FINITE, i)
        return
    st.road[i] = road
    st.s[i] = s
    st.kept_lane[i] = lane
    st.kept_off[i] = offset
    st.facing[i] = direction
    st.turn[i] = turn
    place_scripted(n, p, st, i)
    st.last_x[i] = st.x[i]
    st.last_y[i] = st.y[i]
    if i == p.ego[0]:
        set_path(st, road, lane, s)
        if p.entity_motion[i] == MOTION_BICYCLE or p.entity_motion[i] == MOTION_POSED:
            locate_ego(n, p, st, i)


@compiled
def reset_positions(n: RoadTables, p: Program, st: State) -> None:
    """Evaluate the plan's positions; those relative to an entity hold for where it starts."""
    for k in range(p.position_count[0]):
        road, lane, s, offset, _ = resolve_position(n, p, st, k)
        st.position_x[k] = FAR
        st.position_y[k] = FAR
        if road >= 0:
            x, y, _, _, _, _ = lane_pose(n, road, lane, s, offset)
            st.position_x[k] = x
            st.position_y[k] = y


@compiled
def reset_columns(n: RoadTables, p: Program, st: State) -> None:
    """Put every column to t = 0, before the init actions."""
    reset_run(p, st)
    reset_entities(p, st)
    reset_story(p, st)
    reset_takeover(p, st)
    for k in range(p.entity_count[0]):
        start_entity(n, p, st, p.entity_order[k])
        if st.flag[0] != FAULT_NONE:
            return
    reset_positions(n, p, st)
    prepare_boxes(p, st)
    update_boxes(p, st)
