"""Failures of the camera: how severe each is now, and which images do not arrive.

The severity of a failure rises linearly over its ramp from its onset, stays, and falls over the same ramp before its
end. If several of a kind overlap, the most severe counts; noise adds to the camera's own as a sum of variances. The
counter hash decides for each image whether it is missing or repeated. While a late image is awaited, the one before is
repeated as well.
"""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import SAME_TIME, clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.camera_health import (
    BLUR_AT_ONE,
    IMPULSES_AT_ONE,
    MOVING,
    NOISE_AT_ONE,
    SEEN_ENOUGH,
    WHITE,
    blur_health,
    dirt_health,
    impulses_health,
    measured_blur,
    measured_dirt,
    measured_impulses,
    measured_noise,
    noise_health,
    still_by_dead_rows,
    still_by_quantisation,
    still_by_white,
    tones_health,
)
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_unit

MOST = 1.6
"""Largest amount: severity 5 of ImageNet-C's blur corresponds to an amount of 1.52."""

NOTICED_DARK = 17.0
NOTICED_WHITE = 22.0
"""Numbers of images after which the detector notices that the ground no longer changes, by day: of dark ground, and of
white ground, to which the last change was greater.
"""


@compiled
def severity_of(p: Program, st: State, f: int) -> float:
    """Return how severe a failure is now, from 0 to its amount."""
    return severity_at(p, st, f, st.clock[0])


@compiled
def severity_at(p: Program, st: State, f: int, clock: float) -> float:
    """Return how severe a failure is at a time, from 0 to its amount."""
    since = st.failure_since[f]
    if since < 0.0:
        return 0.0
    base = p.failure_const[f]
    t = clock - since - p.const[base + slot.F_ONSET]
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
def noticed_severity(p: Program, st: State, f: int, severity: float) -> float:
    """Return the part of a failure's present severity that the detector has noticed, where it needs time for this.

    What does not change while the car moves is noticed after the images that the running mean of its change needs to
    fall; what was there in the first image, after the images before which no change is reported.
    """
    images = 0.0
    if p.failure_kind[f] == op.FAILURE_OVEREXPOSURE:
        images = NOTICED_WHITE
    elif p.failure_kind[f] in (op.FAILURE_DIRT, op.FAILURE_DEAD_ROWS, op.FAILURE_QUANTISATION):
        images = NOTICED_DARK
    if severity <= 0.0 or images <= 0.0:
        return severity
    period = p.image_every[0] * p.const[slot.K_STEP]
    before = severity_at(p, st, f, st.clock[0] - images * period)
    if st.clock[0] >= SEEN_ENOUGH * period - SAME_TIME:
        before = max(before, severity_at(p, st, f, 0.0))
    return min(severity, before)


@compiled
def update_camera(p: Program, st: State) -> None:
    """Compute the camera's present failures, and log those that begin and end."""
    changed = 0
    for f in range(p.failure_count[0]):
        severity = severity_of(p, st, f)
        noticed = noticed_severity(p, st, f, severity)
        if severity == st.failure_severity[f] and noticed == st.failure_noticed[f]:
            continue
        st.failure_severity[f] = severity
        st.failure_noticed[f] = noticed
        changed = 1
        active = 1 if severity > 0.0 else 0
        if active != st.failure_active[f]:
            st.failure_active[f] = active
            log_event(st, op.EVENT_FAILURE if active == 1 else op.EVENT_FAILURE_END, 1.0 * p.failure_kind[f])
    if changed == 1:
        for kind in range(op.FAILURES):
            st.failure_now[kind] = 0.0
            st.failure_lately[kind] = 0.0
        for f in range(p.failure_count[0]):
            kind = p.failure_kind[f]
            st.failure_now[kind] = max(st.failure_now[kind], st.failure_severity[f])
            st.failure_lately[kind] = max(st.failure_lately[kind], st.failure_noticed[f])
    more = NOISE_AT_ONE * st.failure_now[op.FAILURE_NOISE]
    sigma = st.noise[0]
    if more > 0.0:
        sigma = safe_sqrt(st.noise[0] * st.noise[0] + more * more)
    if changed == 1 or sigma != st.sigma[0]:
        st.sigma[0] = sigma
        note_image(st)
    if p.failure_count[0] > 0:
        st.missing[0] = image_fails(st, op.FAILURE_DROPOUT)
        st.frozen[0] = image_fails(st, op.FAILURE_FREEZE)


@compiled
def image_fails(st: State, kind: int) -> int:
    """Return 1 if the image of this frame is affected by a kind of failure that affects a share of the images."""
    share = st.failure_now[kind]
    if share <= 0.0:
        return 0
    seed = int(clip(st.draw[op.DRAW_SEED], 0.0, 4294967295.0))
    return 1 if random_unit(seed, op.STREAM_FAILURE, kind, st.frame[0]) < share else 0


@compiled
def take_image(p: Program, st: State) -> None:
    """Note whether a newer image than the last one arrives at this frame; it does not while a late one is awaited."""
    if st.frame[0] % max(p.image_every[0], 1) != 0:
        return
    period = max(p.image_every[0] * p.const[slot.K_STEP], 1.0e-3)
    since = st.clock[0] - st.failure_now[op.FAILURE_LATENCY]
    taken = int(clip((since + SAME_TIME) / period, 0.0, 1.0e9))
    st.awaited[0] = 1 if taken <= st.image_taken[0] else 0
    st.image_taken[0] = max(taken, st.image_taken[0])


@compiled
def shows_nothing(st: State) -> int:
    """Return 1 if dirt, white or dead rows fill the whole image without noise, so that all images are equal."""
    if st.failure_now[op.FAILURE_DEAD_ROWS] >= 1.0:
        return 1
    if st.sigma[0] > 0.0 or st.failure_now[op.FAILURE_IMPULSE_NOISE] > 0.0:
        return 0
    filled = max(st.failure_now[op.FAILURE_DIRT], st.failure_now[op.FAILURE_OVEREXPOSURE])
    return 1 if filled >= 1.0 else 0


@compiled
def health_of_camera(p: Program, st: State) -> float:
    """Return the camera's health at an image as the engine knows it, 0 to 1 (see the module `camera_health`)."""
    if st.missing[0] == 1:
        return 0.0
    ego = p.ego[0]
    repeated = st.frozen[0] == 1 or st.awaited[0] == 1 or shows_nothing(st) == 1
    if repeated and ego >= 0 and st.v[ego] * p.image_every[0] * p.const[slot.K_STEP] >= MOVING:
        return 0.0
    return st.image_health[0]


@compiled
def note_image(st: State) -> None:
    """Write the health of an image that arrives and is new, and how much of the lines it shows.

    What covers the ground hides the lines at once, while its effect on the health is noticed later.
    """
    lit = 1.0 - st.failure_now[op.FAILURE_BLACKOUT]
    more = st.failure_now[op.FAILURE_OVEREXPOSURE]
    sky = min(lit * st.sky_level[0] + WHITE * more, WHITE)
    ground = min(lit * st.ground_level[0] + WHITE * more, WHITE)
    health = noise_health(measured_noise(st.sigma[0], sky, ground))
    impulses = IMPULSES_AT_ONE * st.failure_now[op.FAILURE_IMPULSE_NOISE]
    health = health * impulses_health(measured_impulses(impulses, ground))
    health = health * blur_health(measured_blur(BLUR_AT_ONE * st.failure_now[op.FAILURE_BLUR]))
    health = health * tones_health(min(lit * st.brightest[0] + WHITE * more, WHITE))
    white = lit * st.ground_level[0] if st.tinted[0] == 0 else 0.0
    now = uncovered(st.failure_now[op.FAILURE_DIRT], st.failure_now[op.FAILURE_DEAD_ROWS], more, white)
    lately = uncovered(
        st.failure_lately[op.FAILURE_DIRT],
        st.failure_lately[op.FAILURE_DEAD_ROWS],
        st.failure_lately[op.FAILURE_OVEREXPOSURE],
        white,
    )
    coarse = st.failure_lately[op.FAILURE_QUANTISATION]
    if coarse > 0.0:
        lately = lately * (1.0 - still_by_quantisation(coarse, ground, 1 - st.lamps_on[0]))
    st.image_health[0] = health * dirt_health(1.0 - lately)
    st.lines_left[0] = dirt_health(1.0 - now)


@compiled
def uncovered(dirt: float, dead_rows: float, overexposure: float, white: float) -> float:
    """Return the share of the ground that neither dirt, dead rows nor white covers.

    Args:
        dirt: Severity of dirt, 0-1.
        dead_rows: Severity of dead rows.
        overexposure: Severity of overexposure.
        white: Brightness of the ground that overexposure can make white, grey levels.
    """
    if dirt <= 0.0 and dead_rows <= 0.0 and overexposure <= 0.0:
        return 1.0
    left = (1.0 - measured_dirt(dirt)) * (1.0 - still_by_dead_rows(dead_rows))
    return left * (1.0 - still_by_white(overexposure, white)) if overexposure > 0.0 else left


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
    note_image(st)
    update_camera(p, st)
