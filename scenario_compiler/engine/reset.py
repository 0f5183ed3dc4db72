"""The state at t = 0: every column as the plan's initial words say, whatever a run before has left."""

from __future__ import annotations

from scenario_compiler.engine.appearing import start_entity
from scenario_compiler.engine.collision import prepare_boxes, update_boxes
from scenario_compiler.engine.controllers import reset_controllers
from scenario_compiler.engine.failures import reset_camera
from scenario_compiler.engine.opcodes import (
    CAUSES,
    DELAY_RECORDS,
    FAR,
    FAULT_NONE,
    LOG_SIZE,
    MANOEUVRE_KEEP,
    NONE,
    SEEN_BY_ALL,
    STANDBY,
    STOP_NONE,
    TAKEOVER_AUTOMATED,
)
from scenario_compiler.engine.placing import reset_positions
from scenario_compiler.engine.signals import reset_signals
from scenario_compiler.engine.slots import (
    E_DESIRED_SPEED,
    E_SPEED,
)
from scenario_compiler.engine.state import State
from scenario_compiler.engine.surroundings import reset_surroundings
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.traffic import prepare_traffic
from scenario_compiler.engine.variables import reset_variables
from scenario_compiler.engine.watching import reset_watches
from scenario_compiler.engine.weather import reset_weather
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def reset_entities(p: Program, st: State) -> None:
    """Clear the entities' columns and set their speeds."""
    st.trains[0] = 0
    for i in range(p.entity_count[0]):
        base = p.entity_const[i]
        st.present[i] = p.entity_present[i]
        st.visible[i] = SEEN_BY_ALL
        st.towed[i] = NONE
        st.towed_by[i] = NONE
        st.v[i] = p.const[base + E_SPEED]
        st.last_v[i] = st.v[i]
        st.a[i] = 0.0
        st.steer[i] = 0.0
        st.throttle[i] = 0.0
        st.brake[i] = 0.0
        st.command_throttle[i] = 0.0
        st.command_steer[i] = 0.0
        st.command_brake[i] = 0.0
        st.odometer[i] = 0.0
        st.ended[i] = 0
        st.moved[i] = 0
        st.here_road[i] = NONE
        st.here_lane[i] = 0
        st.here_from[i] = 0.0
        st.here_to[i] = -1.0
        st.here_row[i] = NONE
        st.here_piece[i] = 0
        st.longitudinal[i] = NONE
        st.lateral[i] = NONE
        st.guide[i] = p.entity_guide[i]
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
    st.acting[0] = 0
    st.init_acting[0] = 1
    for e in range(p.element_count[0]):
        st.element_state[e] = STANDBY
        st.element_runs[e] = 0
        st.element_busy[e] = 0
        st.element_started[e] = -1
        st.element_ended[e] = -1
        st.element_stopped[e] = -1
        st.element_skipped[e] = -1
    for c in range(p.condition_count[0]):
        st.condition_before[c] = NONE
    for r in range(p.ring_count[0]):
        st.ring_first[r] = 0
        st.ring_size[r] = 0
        for k in range(DELAY_RECORDS):
            st.ring_time[r * DELAY_RECORDS + k] = 0.0
            st.ring_value[r * DELAY_RECORDS + k] = 0
    for v in range(p.vertex_count[0]):
        st.track_x[v] = 0.0
        st.track_y[v] = 0.0
        st.track_h[v] = 0.0
        st.track_s[v] = 0.0
        st.track_time[v] = 0.0
        st.track_v[v] = 0.0
        st.track_a[v] = 0.0
        st.track_bend[v] = 0.0
        st.track_bend_rate[v] = 0.0
    for k in range(p.action_count[0]):
        st.action_state[k] = STANDBY
        st.action_element[k] = NONE
        st.action_progress[k] = 0.0
        st.action_span[k] = 0.0
        st.action_from[k] = 0.0
        st.action_change[k] = 0.0
        st.action_a[k] = 0.0
        st.action_b[k] = 0.0


@compiled
def reset_takeover(p: Program, st: State) -> None:
    """Put the takeover back to automated driving with nothing seen."""
    st.takeover_state[0] = TAKEOVER_AUTOMATED
    st.cause[0] = 0
    st.requests[0] = 0
    st.quiet[0] = 0
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
    st.pedal[0] = 0.0


@compiled
def reset_run(p: Program, st: State) -> None:
    """Put the clock, the log and the inputs from outside back."""
    st.clock[0] = 0.0
    st.frame[0] = 0
    st.stop[0] = STOP_NONE
    st.flag[0] = FAULT_NONE
    st.flag_at[0] = NONE
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
    st.path_row[0] = NONE
    st.path_piece[0] = 0
    st.path_from[0] = 0.0
    st.path_to[0] = 0.0
    st.even_row[0] = NONE
    st.clear_row[0] = NONE
    st.path_sense[0] = 1
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
def reset_columns(n: RoadTables, p: Program, st: State) -> None:
    """Put every column to t = 0, before the init actions."""
    reset_run(p, st)
    reset_camera(p, st)
    reset_weather(p, st)
    reset_surroundings(st)
    reset_variables(p, st)
    reset_signals(p, st)
    reset_entities(p, st)
    reset_watches(p, st)
    reset_controllers(p, st)
    reset_story(p, st)
    reset_takeover(p, st)
    for k in range(p.entity_count[0]):
        start_entity(n, p, st, k)
        if st.flag[0] != FAULT_NONE:
            return
    if p.traffic_count[0] > 0:
        prepare_traffic(n, p, st)
    reset_positions(n, p, st)
    prepare_boxes(p, st)
    update_boxes(p, st)
