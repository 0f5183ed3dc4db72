"""One time step, split at the point where a world may move the ego.

`reset` makes the row of t = 0, with a frame of duration 0 that ends the init. `step` then does the following at the
time t_k: the stop trigger, the triggers of the storyboard, the actions; at control steps, and when a person takes over,
the ego's sensing, the takeover and the driving. Then it advances time and all entities by one step and takes stock. So
a condition that is true at t_k has an effect in the row of t_k + dt. A world that moves the ego itself does so between
`move_step`, after which all others are at their new places, and `end_step`, which takes stock of the ego too.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.numbers import length_of
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.automation import control_ego, driven_by_hand
from scenario_compiler.engine.ego.controllers import hold_inputs
from scenario_compiler.engine.ego.driver import waits_for_gap
from scenario_compiler.engine.ego.failures import take_image, update_camera
from scenario_compiler.engine.ego.person import drive_by_person, takes_over
from scenario_compiler.engine.ego.progress import CREEPING, waits_in_queue
from scenario_compiler.engine.ego.standing import log_standstill
from scenario_compiler.engine.ego.weather import update_weather
from scenario_compiler.engine.motion.collision import check_collisions, may_overlap, update_boxes
from scenario_compiler.engine.motion.entities import move_entities, take_stock
from scenario_compiler.engine.motion.trailers import draw_trailers
from scenario_compiler.engine.motion.watching import begin_watches
from scenario_compiler.engine.moves.signals import update_signals
from scenario_compiler.engine.story.acting import start_action
from scenario_compiler.engine.story.reset import reset_columns
from scenario_compiler.engine.story.running import run_actions
from scenario_compiler.engine.story.storyboard import displace, run_triggers, trigger_fires
from scenario_compiler.engine.traffic.driving import move_traffic
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

ARRIVED = 5.0
"""Distance to the destination at which a run ends, m."""

STANDING_TIME = 3.0
"""Time at standstill, after the minimum-risk manoeuvre, a stop by the driver or a collision, that ends a run, s."""


@compiled
def drives_ego(p: Program) -> int:
    """Return 1 if the ego is driven by commands, and can therefore have a takeover."""
    ego = p.ego[0]
    if ego < 0:
        return 0
    return 1 if p.entity_motion[ego] == op.MOTION_BICYCLE or p.entity_motion[ego] == op.MOTION_POSED else 0


@compiled
def play_story(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Run the triggers and then the actions of one frame."""
    run_triggers(n, p, st)
    run_actions(n, p, st, dt)


@compiled
def finish_frame(n: RoadTables, p: Program, st: State, dt: float) -> None:
    """Update positions, camera, weather, signals and collisions after all have moved."""
    take_stock(n, p, st, dt)
    if p.failure_count[0] > 0:
        update_camera(p, st)
        take_image(p, st)
    if st.weather_to[0] >= 0:
        update_weather(p, st)
    if p.controller_count[0] > 0:
        update_signals(p, st)
    if st.flag[0] != op.FAULT_NONE:
        return
    if update_boxes(p, st) == 1 or st.crashed[0] == 1:
        check_collisions(p, st)


@compiled
def reset(n: RoadTables, p: Program, st: State) -> None:
    """Set the state to the row of t = 0: start poses, init actions in order, and a frame of duration 0."""
    reset_columns(n, p, st)
    if st.flag[0] != op.FAULT_NONE:
        return
    for c in range(p.init_count[0]):
        displace(p, st, p.init_action[c], 0)
        start_action(n, p, st, p.init_action[c], -1)
    update_boxes(p, st)
    st.start_tight[0] = may_overlap(p, st)
    begin_watches(p, st)
    update_signals(p, st)
    play_story(n, p, st, 0.0)
    if st.trains[0] > 0:
        draw_trailers(n, p, st)
    finish_frame(n, p, st, 0.0)


@compiled
def begin_step(n: RoadTables, p: Program, st: State) -> int:
    """Do a step up to the ego's commands; return 0, with `stop` set, if the run is over and no row follows."""
    if st.stop[0] != op.STOP_NONE:
        return 0
    if p.stop_trigger[0] >= 0 and trigger_fires(n, p, st, p.stop_trigger[0]) == 1:
        st.stop[0] = op.STOP_TRIGGER
        return 0
    st.frame[0] += 1
    play_story(n, p, st, p.const[slot.K_STEP])
    if drives_ego(p) == 1:
        if (st.frame[0] - 1) % max(p.control_every[0], 1) == 0 or takes_over(p, st) == 1:
            control_ego(n, p, st, p.ego[0])
        st.drag[p.ego[0]] = 0.0
        if p.person[0] == 1 and driven_by_hand(st) == 1 and st.crashed[0] == 0:
            drive_by_person(st, p.ego[0])
        hold_inputs(p, st, p.ego[0])
    if st.flag[0] != op.FAULT_NONE:
        return 0
    return 1


@compiled
def watch_standstill(n: RoadTables, p: Program, st: State) -> None:
    """Log where a driver stops, and end a run whose ego has stood for a while after a stop that ends the conflict.

    A person's stop does not end it. A driver model that waits before a red signal, in a moving queue or for a gap in
    the traffic drives on later. An ego that creeps on from where it stopped is not logged as stopping again.
    """
    ego = p.ego[0]
    state = st.takeover_state[0]
    ended = st.crashed[0] == 1 or state in (op.TAKEOVER_STANDSTILL, op.TAKEOVER_MANUAL)
    if st.v[ego] >= CREEPING or not ended:
        st.still_noted[0] = 0
    if st.v[ego] >= op.STANDING or not ended:
        st.still_since[0] = -1.0
        return
    driven = state == op.TAKEOVER_MANUAL and st.crashed[0] == 0
    if st.still_since[0] < 0.0:
        st.still_since[0] = st.clock[0]
        if driven and st.still_noted[0] == 0:
            st.still_noted[0] = 1
            log_standstill(n, p, st, ego, 1)
    if driven and (p.person[0] == 1 or waits_in_queue(p, st, ego) == 1 or waits_for_gap(st) == 1):
        st.still_since[0] = st.clock[0]
    if st.clock[0] - st.still_since[0] >= STANDING_TIME - op.TOLERANCE:
        st.stop[0] = op.STOP_COLLISION if st.crashed[0] == 1 else op.STOP_STANDSTILL


@compiled
def at_destination(p: Program, st: State) -> int:
    """Return 1 if the ego is near its destination; a car that has collided does not arrive."""
    if p.destination_road[0] < 0 or st.crashed[0] == 1:
        return 0
    ego = p.ego[0]
    return 1 if length_of(st.destination_x[0] - st.x[ego], st.destination_y[0] - st.y[ego]) <= ARRIVED else 0


@compiled
def move_step(n: RoadTables, p: Program, st: State) -> None:
    """Advance time, and move all entities that the engine moves."""
    dt = p.const[slot.K_STEP]
    st.steps[0] += 1
    st.clock[0] = st.steps[0] * dt
    move_entities(n, p, st, dt)
    if p.traffic_count[0] > 0:
        move_traffic(n, p, st, dt)
    if st.trains[0] > 0:
        draw_trailers(n, p, st)


@compiled
def end_step(n: RoadTables, p: Program, st: State) -> None:
    """Take stock after all have moved; set `stop` if this row is the last."""
    finish_frame(n, p, st, p.const[slot.K_STEP])
    if st.flag[0] != op.FAULT_NONE:
        return
    if drives_ego(p) == 1:
        watch_standstill(n, p, st)
        if st.stop[0] == op.STOP_NONE and at_destination(p, st) == 1:
            st.stop[0] = op.STOP_DESTINATION
    if st.stop[0] == op.STOP_NONE and st.clock[0] >= p.const[slot.K_DURATION] - op.TOLERANCE:
        st.stop[0] = op.STOP_DURATION


@compiled
def step(n: RoadTables, p: Program, st: State) -> int:
    """Do one step; return 1 if it made a new row, 0 if the run was over before.

    `stop` may be set in both cases; a new row is then the last one.
    """
    if begin_step(n, p, st) == 0:
        return 0
    move_step(n, p, st)
    end_step(n, p, st)
    return 1
