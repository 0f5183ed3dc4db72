"""Failures of the camera: how severe each is now, and which images do not arrive.

The severity of a failure rises linearly over its ramp from its onset, stays, and falls over the same ramp before its
end. If several of a kind overlap, the most severe counts; noise adds to the camera's own as a sum of variances. The
counter hash decides for each image whether it is missing or repeated.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.camera_health import (
    BLUR_AT_ONE,
    NOISE_AT_ONE,
    TONES_AT_NOON,
    blur_health,
    dirt_health,
    noise_health,
    tones_health,
)
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_unit

MOST = 1.6
"""Largest amount: severity 5 of ImageNet-C's blur corresponds to an amount of 1.52."""

CREEPING = 0.5
"""Speed below which a repeated image does not indicate a fault, m/s."""


@compiled
def severity_of(p: Program, st: State, f: int) -> float:
    """Return how severe a failure is now, from 0 to its amount."""
    since = st.failure_since[f]
    if since < 0.0:
        return 0.0
    base = p.failure_const[f]
    t = st.clock[0] - since - p.const[base + slot.F_ONSET]
    ramp = p.const[base + slot.F_RAMP]
    share = 1.0 if t >= -1.0e-9 else 0.0
    if ramp > 1.0e-9:
        share = clip(t / ramp, 0.0, 1.0)
    duration = p.const[base + slot.F_DURATION]
    if duration >= 0.0:
        rest = duration - t
        if rest <= 1.0e-9:
            share = 0.0
        elif ramp > 1.0e-9:
            share = min(share, clip(rest / ramp, 0.0, 1.0))
    return clip(p.const[base + slot.F_AMOUNT], 0.0, MOST) * share


@compiled
def update_camera(p: Program, st: State) -> None:
    """Compute the camera's present failures, and log those that begin and end."""
    if p.failure_count[0] == 0:
        if st.sigma[0] != st.noise[0]:
            st.sigma[0] = st.noise[0]
            st.image_health[0] = health_of_image(st)
        return
    for kind in range(op.FAILURES):
        st.failure_now[kind] = 0.0
    for f in range(p.failure_count[0]):
        kind = p.failure_kind[f]
        severity = severity_of(p, st, f)
        st.failure_now[kind] = max(st.failure_now[kind], severity)
        active = 1 if severity > 0.0 else 0
        if active != st.failure_active[f]:
            st.failure_active[f] = active
            log_event(st, op.EVENT_FAILURE if active == 1 else op.EVENT_FAILURE_END, 1.0 * kind)
    more = NOISE_AT_ONE * st.failure_now[op.FAILURE_NOISE]
    st.sigma[0] = st.noise[0]
    if more > 0.0:
        st.sigma[0] = safe_sqrt(st.noise[0] * st.noise[0] + more * more)
    st.missing[0] = image_fails(st, op.FAILURE_DROPOUT)
    st.frozen[0] = image_fails(st, op.FAILURE_FREEZE)
    st.image_health[0] = health_of_image(st)


@compiled
def image_fails(st: State, kind: int) -> int:
    """Return 1 if the image of this frame is affected by a kind of failure that affects a share of the images."""
    share = st.failure_now[kind]
    if share <= 0.0:
        return 0
    seed = int(clip(st.draw[op.DRAW_SEED], 0.0, 4294967295.0))
    return 1 if random_unit(seed, op.STREAM_FAILURE, kind, st.frame[0]) < share else 0


@compiled
def health_of_camera(p: Program, st: State) -> float:
    """Return the camera's health as the engine knows it, 0 to 1 (see the module `camera_health`)."""
    if st.missing[0] == 1:
        return 0.0
    ego = p.ego[0]
    if st.frozen[0] == 1 and ego >= 0 and st.v[ego] > CREEPING:
        return 0.0
    return st.image_health[0]


@compiled
def health_of_image(st: State) -> float:
    """Return the health of an image that arrives and is new, under the present failures."""
    dark = TONES_AT_NOON * (1.0 - st.failure_now[op.FAILURE_BLACKOUT])
    blur = BLUR_AT_ONE * st.failure_now[op.FAILURE_BLUR]
    dirt = st.failure_now[op.FAILURE_DIRT]
    return noise_health(st.sigma[0]) * tones_health(dark) * blur_health(blur) * dirt_health(dirt)


@compiled
def begin_failure(st: State, f: int) -> None:
    """Begin a failure now."""
    st.failure_since[f] = st.clock[0]


@compiled
def end_failures(p: Program, st: State, kind: int) -> None:
    """End the failures of a kind, or all (NONE); ending noise also removes the camera's own."""
    for f in range(p.failure_count[0]):
        if kind == op.NONE or p.failure_kind[f] == kind:
            st.failure_since[f] = -1.0
    if kind in (op.NONE, op.FAILURE_NOISE):
        st.noise[0] = 0.0


@compiled
def reset_camera(p: Program, st: State) -> None:
    """Reset the camera to its state at the start; failures that no action begins count from there."""
    st.noise[0] = p.const[slot.K_NOISE]
    for f in range(p.failure_count[0]):
        st.failure_since[f] = -1.0 if p.failure_waits[f] == 1 else 0.0
    st.sigma[0] = st.noise[0]
    st.image_health[0] = health_of_image(st)
    update_camera(p, st)
