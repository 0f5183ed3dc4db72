"""Decides who drives the ego at a control step, and how the automation drives until somebody responds."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.around import note_lane_time
from scenario_compiler.engine.ego.bends import acceleration_for_bends
from scenario_compiler.engine.ego.driver import drive_by_hand, look_with_eyes
from scenario_compiler.engine.ego.foresight import LIFT_OFF, notice
from scenario_compiler.engine.ego.lane_confidence import ideal_confidence
from scenario_compiler.engine.ego.lane_memory import remember_lane, remembered_angle, steers_by_memory
from scenario_compiler.engine.ego.limits import behaviour, request_distance
from scenario_compiler.engine.ego.merging import consider_merge
from scenario_compiler.engine.ego.objects_ahead import find_block, gap_to_keep, judge_objects, minds_limit
from scenario_compiler.engine.ego.person import heed_person
from scenario_compiler.engine.ego.progress import watch_progress
from scenario_compiler.engine.ego.reach import look_with_sensor
from scenario_compiler.engine.ego.reference import drive_by_reference
from scenario_compiler.engine.ego.sensor import find_lane_end, lane_closes
from scenario_compiler.engine.ego.surrogate import drive_as_seen, seen_angle, surrogate_confidence
from scenario_compiler.engine.ego.takeover import step_takeover
from scenario_compiler.engine.ego.warning import warning_distance
from scenario_compiler.engine.motion.following import idm_acceleration
from scenario_compiler.engine.motion.path import take_present_lane
from scenario_compiler.engine.motion.signals_ahead import red_ahead
from scenario_compiler.engine.motion.steering import come_to_rest, command_acceleration, command_angle, pursuit_angle
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

MERGES_FROM = 150.0
"""Distance before the end of the lane from which a driver looks for a gap in the neighbouring lane, m; chosen."""

AUTOMATION_ACCELERATION = 4.0
"""Greatest lateral acceleration that the automation steers for, m/s2."""


@compiled
def driven_by_hand(st: State) -> int:
    """Return 1 while the driver drives, including the control step of the hand-back."""
    state = st.takeover_state[0]
    return 1 if state in (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK) else 0


@compiled
def sense(n: RoadTables, p: Program, st: State, i: int) -> int:
    """Look ahead, with the forward sensor or the driving driver's eyes, and return the entity that blocks the path."""
    if driven_by_hand(st) == 1:
        look_with_eyes(n, p, st, i)
    else:
        look_with_sensor(n, p, st, i)
    st.red_line[0] = red_ahead(n, p, st, i) if p.head_count[0] > 0 else op.FAR
    note_lane_time(p, st, i)
    judge_objects(p, st, i)
    return find_block(p, st, i)


@compiled
def steer_automated(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Steer by memory if the lane is lost; otherwise by the map, by the surrogate's lane, or as the controller says."""
    if steers_by_memory(p, st) == 1:
        command_angle(p, st, i, remembered_angle(n, p, st, i, AUTOMATION_ACCELERATION))
    elif p.perception[0] == op.PERCEPTION_IDEAL or st.merging[0] == 1:
        command_angle(p, st, i, pursuit_angle(n, p, st, i, AUTOMATION_ACCELERATION))
    elif p.perception[0] == op.PERCEPTION_SURROGATE:
        command_angle(p, st, i, seen_angle(n, p, st, i))
    else:
        st.command_steer[i] = st.auto_steer[0]


@compiled
def drive_automated(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Keep lane and distance by the map, or apply the controller's commands; slow down if the takeover policy says so.

    An automation that has let go keeps the wheel straight and applies no pedal.
    """
    if behaviour(p, st) == op.BEHAVIOUR_LET_GO:
        st.command_steer[i] = 0.0
        command_acceleration(p, st, i, come_to_rest(st.v[i], -LIFT_OFF))
        return
    steer_automated(n, p, st, i)
    if p.perception[0] == op.PERCEPTION_IDEAL:
        gap, lead = gap_to_keep(p, st, i)
        wanted = idm_acceleration(p, i, st.v[i], st.target_speed[0], gap, lead)
        rest = lane_closes(st)
        if rest < op.FAR and st.merging[0] == 0 and minds_limit(p, st, op.CAUSE_LANE_ENDS) == 1:
            wanted = min(wanted, idm_acceleration(p, i, st.v[i], st.target_speed[0], rest, 0.0))
        in_bends = acceleration_for_bends(n, p, st, i, p.const[slot.K_LATERAL], p.const[slot.K_DECELERATION])
        wanted = min(wanted, in_bends)
        command_acceleration(p, st, i, come_to_rest(st.v[i], wanted))
    elif p.perception[0] == op.PERCEPTION_SURROGATE:
        drive_as_seen(n, p, st, i)
    else:
        st.command_throttle[i] = st.auto_throttle[0]
        st.command_brake[i] = st.auto_brake[0]
    if behaviour(p, st) == op.BEHAVIOUR_SLOW_DOWN:
        brake = st.command_brake[i]
        command_acceleration(p, st, i, -p.const[slot.K_SLOW_DOWN])
        st.command_brake[i] = max(brake, st.command_brake[i])


@compiled
def drive_to_stop(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Steer as before, and brake with the deceleration of the minimum-risk manoeuvre, or harder before a bend."""
    steer_automated(n, p, st, i)
    in_bends = acceleration_for_bends(n, p, st, i, p.const[slot.K_LATERAL], p.const[slot.K_DECELERATION])
    command_acceleration(p, st, i, min(-p.const[slot.K_MINIMUM_RISK_DECELERATION], in_bends))


@compiled
def merge_if_due(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Let the automation merge within its time budget if lane ends are a cause, or the driver within MERGES_FROM."""
    st.gap_free[0] = 1
    if st.through_lane[0] == 0 and st.merging[0] == 0:
        return
    state = st.takeover_state[0]
    if driven_by_hand(st) == 1:
        if p.person[0] == 0 and st.manoeuvre[0] != op.MANOEUVRE_EVADE:
            consider_merge(n, p, st, i, MERGES_FROM, MERGES_FROM)
    elif state not in (op.TAKEOVER_MINIMUM_RISK, op.TAKEOVER_STANDSTILL) and p.cause_on[op.CAUSE_LANE_ENDS] == 1:
        within = request_distance(p, st.v[i], slot.K_LANE_END_BUDGET, slot.K_LANE_END_COUNT)
        look = max(warning_distance(p, st.v[i], slot.K_LANE_END_WARNING, slot.K_LANE_END_BUDGET), within)
        consider_merge(n, p, st, i, within, look)


@compiled
def control_ego(n: RoadTables, p: Program, st: State, i: int) -> None:
    """Do one control step of the ego: sense, merge if it is due, advance the takeover, drive."""
    st.looked[0] = 0
    if p.replaced_by[0] != op.REFERENCE_NONE:
        look_with_eyes(n, p, st, i)
        note_lane_time(p, st, i)
        drive_by_reference(n, p, st, i, p.replaced_by[0])
        return
    ideal = p.perception[0] == op.PERCEPTION_IDEAL
    if p.perception[0] != op.PERCEPTION_CAMERA and (st.frame[0] - 1) % max(p.image_every[0], 1) == 0:
        if ideal:
            ideal_confidence(n, p, st)
        else:
            surrogate_confidence(n, p, st)
    remember_lane(p, st, i)
    if not ideal and steers_by_memory(p, st) == 0 and driven_by_hand(st) == 0 and st.merging[0] == 0:
        take_present_lane(n, st, i)
    find_lane_end(n, p, st, i)
    merge_if_due(n, p, st, i)
    blocker = sense(n, p, st, i)
    watch_progress(p, st, i)
    notice(p, st, i, blocker)
    if p.person[0] == 1 and st.crashed[0] == 0:
        heed_person(p, st)
    automated = 1 - driven_by_hand(st)
    if st.crashed[0] == 0:
        step_takeover(n, p, st, i)
    if automated == 1 and driven_by_hand(st) == 1:
        blocker = sense(n, p, st, i)
    state = st.takeover_state[0]
    if st.crashed[0] == 1 or state == op.TAKEOVER_STANDSTILL:
        st.command_steer[i] = 0.0
        st.command_throttle[i] = 0.0
        st.command_brake[i] = 1.0
    elif driven_by_hand(st) == 1:
        if p.person[0] == 0 and p.driver_reference[0] != op.REFERENCE_NONE:
            drive_by_reference(n, p, st, i, p.driver_reference[0])
        elif p.person[0] == 0:
            drive_by_hand(n, p, st, i, blocker)
    elif state == op.TAKEOVER_MINIMUM_RISK:
        drive_to_stop(n, p, st, i)
    else:
        drive_automated(n, p, st, i)
