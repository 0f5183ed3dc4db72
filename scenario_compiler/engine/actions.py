"""How running actions act, each writing its entity at once, in document order: init actions first, then the story's.

Semi-implicit: a speed action writes the speed of the end of the step, and the entity moves with it. A lane change
moves its entity along the path with the speed of that moment, so what it moves to the side is missing ahead. After
esmini 3.6.
"""

from __future__ import annotations

from scenario_compiler.engine.keeping_aside import step_keep_aside
from scenario_compiler.engine.keeping_distance import step_keep_distance
from scenario_compiler.engine.lane_changes import step_lane_change
from scenario_compiler.engine.lane_offsets import step_limited_offset
from scenario_compiler.engine.opcodes import (
    ACTION_ANIMATION,
    ACTION_ENDS,
    ACTION_FOLLOW_PATH,
    ACTION_FOLLOW_TRAJECTORY,
    ACTION_KEEP_DISTANCE,
    ACTION_KEEP_LATERAL_DISTANCE,
    ACTION_LANE_CHANGE,
    ACTION_LANE_CHANGE_TO,
    ACTION_LANE_OFFSET,
    ACTION_LIMITED_LANE_OFFSET,
    ACTION_RELATIVE_SPEED,
    ACTION_SPEED,
    ACTION_SPEED_PROFILE,
    ACTION_SYNCHRONIZE,
    ACTION_TRAFFIC_SINK,
    ACTION_TRAFFIC_SOURCE,
    ACTION_TRAFFIC_SWARM,
    ELEMENT_ACTION,
    RUNNING,
)
from scenario_compiler.engine.own_path import step_follow_path
from scenario_compiler.engine.sources import step_sink, step_source
from scenario_compiler.engine.speed_profiles import step_profile
from scenario_compiler.engine.speeds import step_speed
from scenario_compiler.engine.state import State
from scenario_compiler.engine.storyboard import action_done
from scenario_compiler.engine.swarms import step_swarm
from scenario_compiler.engine.synchronizing import step_synchronize
from scenario_compiler.engine.tables import Program
from scenario_compiler.engine.trajectories import step_trajectory
from scenario_compiler.engine.world_actions import step_animation
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables


@compiled
def step_traffic(n: RoadTables, p: Program, st: State, k: int) -> int:
    """Step an action on traffic; return 1 when it has been stopped."""
    if st.action_b[k] == ACTION_ENDS:
        return 1
    if p.action_op[k] == ACTION_TRAFFIC_SWARM:
        step_swarm(n, p, st, k)
    elif p.action_op[k] == ACTION_TRAFFIC_SOURCE:
        step_source(n, p, st, k)
    else:
        step_sink(n, p, st, k)
    return 0


@compiled
def step_action(n: RoadTables, p: Program, st: State, k: int, dt: float) -> None:
    """Step one running action and complete it where it is done."""
    op = p.action_op[k]
    done = 1
    if op in (ACTION_SPEED, ACTION_RELATIVE_SPEED):
        done = step_speed(p, st, k, dt)
    elif op in (ACTION_LANE_CHANGE, ACTION_LANE_CHANGE_TO, ACTION_LANE_OFFSET):
        done = step_lane_change(n, p, st, k, dt)
    elif op == ACTION_LIMITED_LANE_OFFSET:
        done = step_limited_offset(n, p, st, k, dt)
    elif op == ACTION_KEEP_DISTANCE:
        done = step_keep_distance(n, p, st, k, dt)
    elif op == ACTION_KEEP_LATERAL_DISTANCE:
        done = step_keep_aside(n, p, st, k, dt)
    elif op == ACTION_SPEED_PROFILE:
        done = step_profile(p, st, k, dt)
    elif op == ACTION_SYNCHRONIZE:
        done = step_synchronize(n, p, st, k, dt)
    elif op == ACTION_ANIMATION:
        done = step_animation(p, st, k, dt)
    elif op == ACTION_FOLLOW_TRAJECTORY:
        done = step_trajectory(n, p, st, k, dt)
    elif op == ACTION_FOLLOW_PATH:
        done = step_follow_path(n, p, st, k, dt)
    elif op >= ACTION_TRAFFIC_SWARM and op <= ACTION_TRAFFIC_SINK:
        done = step_traffic(n, p, st, k)
    if done == 1:
        action_done(p, st, k, 2 * (st.frame[0] + 1))


@compiled
def run_actions(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Step all running actions: the init's, then the story's in document order, below running elements."""
    if st.init_acting[0] == 1:
        st.init_acting[0] = 0
        for c in range(p.init_count[0]):
            if st.action_state[p.init_action[c]] == RUNNING:
                st.init_acting[0] = 1
                step_action(n, p, st, p.init_action[c], dt)
    if st.acting[0] == 0:
        return
    e = 0
    while e < p.element_count[0]:
        if st.element_state[e] != RUNNING:
            e = p.element_end[e]
            continue
        if p.element_kind[e] == ELEMENT_ACTION and p.element_action[e] >= 0:
            step_action(n, p, st, p.element_action[e], dt)
        e = e + 1
