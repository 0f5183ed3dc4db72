"""The engine's state as worlds, pictures and reports see it: entities, and what is wrong with the camera."""

from __future__ import annotations

import math

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.camera_health import BLUR_AT_ONE, IMPULSES_AT_ONE
from scenario_compiler.engine.ego.failures import severity_of
from scenario_compiler.engine.motion.watching import farthest_without_leap, heads_at_speed
from scenario_compiler.engine.moves.appearance import LIGHTS
from scenario_compiler.perception.faults import FAULTLESS, CameraFaults
from scenario_compiler.roads import Pose
from scenario_compiler.vocabulary.sensors import EXPOSURE_AT_ONE
from scenario_compiler.worlds import Entities, EntityState

BRAKE_LIGHTS = 1.3
"""Deceleration from which the brake lights are on for a vehicle that is not driven by commands, m/s2: the value of UN
R13-H (5.2.22.4) for braking without the driver's pedal.
"""


def entities_of(state: State, step: float) -> Entities:
    """Return the present entities: the columns are copied, and the state of an entity is built when it is read.

    Args:
        state: The engine's state.
        step: Time that they have moved since the end of the last step, s; 0 at the end of a step.
    """
    present, visible, lights = list(state.present), list(state.visible), list(state.lights)
    poses = [list(column) for column in (state.x, state.y, state.z, state.h, state.pitch, state.roll)]
    speed, steering, throttle, brake = (list(one) for one in (state.v, state.steer, state.throttle, state.brake))
    gains, body_pitch = list(state.a), list(state.body_pitch)
    velocities = [list(column) for column in (state.velocity_x, state.velocity_y, state.velocity_z)]
    before = [list(column) for column in (state.before_x, state.before_y, state.before_z)]

    def velocity_of(i: int, pose: Pose) -> tuple[float, float, float]:
        if step <= 0.0:
            return velocities[0][i], velocities[1][i], velocities[2][i]
        x, y, z = pose.x - before[0][i], pose.y - before[1][i], pose.z - before[2][i]
        if math.hypot(x, y) <= farthest_without_leap(speed[i], step):
            return x / step, y / step, z / step
        return heads_at_speed(speed[i], pose.heading, pose.pitch - body_pitch[i])

    def state_of(i: int) -> EntityState:
        pose = Pose(*(column[i] for column in poses))
        return EntityState(
            there=present[i] == 1,
            shown=present[i] == 1 and visible[i] & op.SEEN_IN_PICTURES != 0,
            pose=pose,
            speed=speed[i],
            steering=steering[i],
            throttle=throttle[i],
            brake=brake[i],
            braking=brake[i] > 0.0 or gains[i] < -BRAKE_LIGHTS,
            velocity=velocity_of(i, pose),
            lights=frozenset(name for bit, name in enumerate(LIGHTS) if lights[i] >> bit & 1),
        )

    return Entities(len(present), state_of)


def faults_of(program: Program, state: State) -> CameraFaults:
    """Return the camera's failures, without its noise, from the engine's state."""
    if program.failure_count[0] == 0:
        return FAULTLESS
    now = state.failure_now
    return CameraFaults(
        dark=now[op.FAILURE_BLACKOUT],
        blur=BLUR_AT_ONE * now[op.FAILURE_BLUR],
        dirt=now[op.FAILURE_DIRT],
        impulses=IMPULSES_AT_ONE * now[op.FAILURE_IMPULSE_NOISE],
        brighter=now[op.FAILURE_OVEREXPOSURE],
        dead_rows=now[op.FAILURE_DEAD_ROWS],
        coarse=now[op.FAILURE_QUANTISATION],
        late=now[op.FAILURE_LATENCY],
        exposure=EXPOSURE_AT_ONE * now[op.FAILURE_MOTION_BLUR],
        turned=turned_of(program, state),
        missing=state.missing[0] == 1,
        frozen=state.frozen[0] == 1,
    )


def turned_of(program: Program, state: State) -> tuple[float, float, float]:
    """Return yaw, pitch and roll by which all failures together turn the camera now, rad."""
    yaw = pitch = roll = 0.0
    if state.failure_now[op.FAILURE_MISALIGNMENT] > 0.0:
        for f in range(program.failure_count[0]):
            if program.failure_kind[f] == op.FAILURE_MISALIGNMENT:
                severity, base = severity_of(program, state, f), program.failure_const[f]
                yaw += severity * program.const[base + slot.F_YAW]
                pitch += severity * program.const[base + slot.F_PITCH]
                roll += severity * program.const[base + slot.F_ROLL]
    return yaw, pitch, roll
