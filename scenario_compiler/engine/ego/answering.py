"""The time of the driver's response: its distribution, the person of a run, effects, and stages.

Each run draws one standard normal number for the person, and each request another, so that the requests of a run are
correlated (`person` is the correlation of their normal numbers) while each of them follows the distribution. An effect
adds seconds to the distribution's mean. The whole time is then scaled by the ratio of the new mean to the old, because
the standard deviation of takeover times grows with their mean: r = 0.82 over the studies quoted in Zhang et al. 2019.
"""

from __future__ import annotations

from math import cos, exp, log, tau

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.log import log_event
from scenario_compiler.engine.columns.numbers import clip, logistic, ratio, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.seeds import run_seed
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.limits import budget_of_cause
from scenario_compiler.marker import compiled
from scenario_compiler.randomness import random_unit

LEAST_SHARE = 0.2
"""Share of the takeover time that remains however much the effects reduce it; chosen."""

LEAST_BUDGET = 4.0
GREATEST_BUDGET = 10.0
"""Time budgets outside this range are clipped to it for the effect of the budget, s; chosen from those of studies."""

REDRAWS = 32
"""How often a normal distribution is drawn again for a positive time; chosen. Even if half of the distribution is
negative, the probability that no draw is positive is below 10^-9.
"""

# Purposes of a request's random numbers, as positions of the counter hash; a normal number takes two positions.
DRAW_REQUEST = 0
DRAW_LAPSE = 2
DRAW_LATE = 3
DRAW_LATENESS = 4
DRAW_EYES = 5
DRAW_HANDS = 7
DRAW_STYLE = 9
DRAW_AGAIN = 16


@compiled
def drawn_unit(st: State, what: int) -> float:
    """Return the present request's random number in (0, 1) for a purpose (`DRAW_...`)."""
    return random_unit(run_seed(st, -1), op.STREAM_DRIVER, what, st.requests[0])


@compiled
def drawn_normal(st: State, what: int) -> float:
    """Return the present request's standard normal number for a purpose (`DRAW_...`; Box and Muller 1958)."""
    return safe_sqrt(-2.0 * log(max(drawn_unit(st, what), 1.0e-12))) * cos(tau * drawn_unit(st, what + 1))


@compiled
def person_and_request(p: Program, st: State) -> float:
    """Return the standard normal number of this person at this request."""
    share = clip(p.const[slot.K_DRIVER_PERSON], 0.0, 1.0)
    return safe_sqrt(share) * st.draw[op.DRAW_PERSON] + safe_sqrt(1.0 - share) * drawn_normal(st, DRAW_REQUEST)


@compiled
def law_mean(p: Program, st: State) -> float:
    """Return the mean takeover time without effects, s; for a normal distribution before it is cut at 0."""
    kind = p.driver_kind[0]
    if kind == op.DRIVER_SUMO:
        budget = max(budget_of_cause(p, st.cause[0]), 0.0)
        return min(2.0 * safe_sqrt(budget), 0.7 * budget)
    mu = p.const[slot.K_DRIVER_MU]
    if kind == op.DRIVER_NORMAL:
        return mu
    sigma = p.const[slot.K_DRIVER_SIGMA]
    body = exp(clip(mu + 0.5 * sigma * sigma, -20.0, 20.0))
    late = p.const[slot.K_DRIVER_LATE]
    stretch = late_stretch(p)
    if late <= 0.0 or stretch <= 0.0:
        return body
    median = exp(clip(mu, -20.0, 20.0))
    return (1.0 - late) * body + late * ratio(median * (exp(min(stretch, 20.0)) - 1.0), stretch, median)


@compiled
def late_stretch(p: Program) -> float:
    """Return the logarithm of the ratio of the longest late time to the median, or 0 if it is not longer."""
    latest = p.const[slot.K_DRIVER_LATEST]
    if latest <= 0.0:
        return 0.0
    return max(log(latest) - clip(p.const[slot.K_DRIVER_MU], -20.0, 20.0), 0.0)


@compiled
def drawn_positive(p: Program, st: State, mean: float, deviation: float) -> float:
    """Return a draw of a normal distribution, repeated until it is positive, s; 0.01 if all draws are negative."""
    time = mean + deviation * person_and_request(p, st)
    for k in range(REDRAWS):
        if time <= 0.0:
            time = mean + deviation * drawn_normal(st, DRAW_AGAIN + 2 * k)
    return max(time, 0.01)


@compiled
def drawn_time(p: Program, st: State, mean: float) -> float:
    """Return a takeover time without effects from the distribution with the given mean, s."""
    kind = p.driver_kind[0]
    if kind == op.DRIVER_SUMO:
        spread = (budget_of_cause(p, st.cause[0]) - mean) * p.const[slot.K_DRIVER_SIGMA]
        return drawn_positive(p, st, mean, max(spread, 0.0))
    if kind == op.DRIVER_NORMAL:
        return drawn_positive(p, st, mean, p.const[slot.K_DRIVER_SIGMA])
    mu = p.const[slot.K_DRIVER_MU]
    if drawn_unit(st, DRAW_LATE) < p.const[slot.K_DRIVER_LATE]:
        return exp(clip(mu + late_stretch(p) * drawn_unit(st, DRAW_LATENESS), -20.0, 20.0))
    return exp(clip(mu + p.const[slot.K_DRIVER_SIGMA] * person_and_request(p, st), -20.0, 20.0))


@compiled
def added_time(p: Program, st: State) -> float:
    """Return the sum of the effects on the mean takeover time at the present request, s."""
    added = p.const[slot.K_EFFECT_TASK] - p.const[slot.K_EFFECT_MEASURED_TASK]
    added += p.const[slot.K_EFFECT_EYES_CLOSED] + p.const[slot.K_EFFECT_REQUEST]
    density = p.const[slot.K_DENSITY] if p.const[slot.K_DENSITY] >= 0.0 else st.traffic_density[0]
    added += p.const[slot.K_EFFECT_DENSITY] * density
    if st.requests[0] > 1:
        added += p.const[slot.K_EFFECT_REPETITION]
    if p.const[slot.K_REFERENCE_BUDGET] > 0.0:
        budget = clip(budget_of_cause(p, st.cause[0]), LEAST_BUDGET, GREATEST_BUDGET)
        added += p.const[slot.K_EFFECT_BUDGET] * (budget - p.const[slot.K_REFERENCE_BUDGET])
    return added


@compiled
def takeover_time(p: Program, st: State) -> float:
    """Return the driver's takeover time for the present request, s; FAR if the driver does not respond."""
    if p.driver_kind[0] == op.DRIVER_FIXED:
        return max(p.const[slot.K_DRIVER_TIME], 0.0)
    if drawn_unit(st, DRAW_LAPSE) < p.const[slot.K_DRIVER_LAPSE]:
        return op.FAR
    mean = law_mean(p, st)
    share = max(ratio(mean + added_time(p, st), mean, 1.0), LEAST_SHARE)
    return share * drawn_time(p, st, mean)


@compiled
def drawn_share(p: Program, st: State, median: float, what: int) -> float:
    """Return a share whose logit is normally distributed around that of the median."""
    middle = clip(median, 0.01, 0.99)
    logit = (
        log(max(middle, 0.01)) - log(max(1.0 - middle, 0.01)) + p.const[slot.K_STAGE_SPREAD] * drawn_normal(st, what)
    )
    return logistic(logit)


@compiled
def plan_answer(p: Program, st: State) -> None:
    """Plan when the driver looks at the road, has the hands on the wheel and takes over, and the style of evasion."""
    now = st.clock[0]
    time = takeover_time(p, st)
    style = drawn_unit(st, DRAW_STYLE)
    st.style[0] = op.STYLE_BOTH
    if style < p.const[slot.K_BRAKES]:
        st.style[0] = op.STYLE_BRAKES
    elif style < p.const[slot.K_BRAKES] + p.const[slot.K_STEERS]:
        st.style[0] = op.STYLE_STEERS
    st.eyes_on_at[0] = op.FAR
    st.hands_on_at[0] = op.FAR
    st.answer_at[0] = now + time
    if time >= op.FAR:
        return
    eyes = time * drawn_share(p, st, p.const[slot.K_EYES_ON], DRAW_EYES)
    st.eyes_on_at[0] = now + eyes
    st.hands_on_at[0] = now + eyes + (time - eyes) * drawn_share(p, st, p.const[slot.K_HANDS_ON], DRAW_HANDS)


@compiled
def note_stages(st: State) -> None:
    """Log once that the eyes are on the road, and once that the hands are on the wheel."""
    now = st.clock[0]
    if now >= st.eyes_on_at[0] - op.TOLERANCE:
        st.eyes_on_at[0] = op.FAR
        st.looking[0] = 1
        if st.time_eyes_on[0] < 0.0:
            st.time_eyes_on[0] = now
        log_event(st, op.EVENT_EYES_ON, now - st.request_at[0])
    if now >= st.hands_on_at[0] - op.TOLERANCE:
        st.hands_on_at[0] = op.FAR
        if st.time_hands_on[0] < 0.0:
            st.time_hands_on[0] = now
        log_event(st, op.EVENT_HANDS_ON, now - st.request_at[0])
