"""The takeover policy: its times, causes and driver."""

from __future__ import annotations

from collections.abc import Mapping
from statistics import NormalDist

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.moves.takeover import REQUEST_CAUSES
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.plan.defaults import CAUSE_DEFAULTS
from scenario_compiler.vocabulary.driver import Driver, DriverModel, EffectKind, Law, ReferenceName, Task
from scenario_compiler.vocabulary.takeover import Cause, CauseKind, Modality

BEHAVIOURS = {
    "follow": op.BEHAVIOUR_FOLLOW,
    "hold_speed": op.BEHAVIOUR_HOLD_SPEED,
    "slow_down": op.BEHAVIOUR_SLOW_DOWN,
    "let_go": op.BEHAVIOUR_LET_GO,
}
BUDGETS: tuple[tuple[CauseKind, str, int], ...] = (
    ("path_blocked", "budget", slot.K_BLOCKED_BUDGET),
    ("path_blocked", "warning_budget", slot.K_BLOCKED_WARNING),
    ("lane_ends", "budget", slot.K_LANE_END_BUDGET),
    ("lane_ends", "warning_budget", slot.K_LANE_END_WARNING),
)
"""Cause, its field, and the slot of the budget, which is negative if the cause has none of its own."""

CAUSE_LIMITS: tuple[tuple[CauseKind, str, int], ...] = (
    ("lane_confidence", "warning_below", slot.K_CONFIDENCE_WARNING),
    ("lane_confidence", "warning_over", slot.K_CONFIDENCE_OVER),
    ("lane_confidence", "request_below", slot.K_CONFIDENCE_REQUEST),
    ("lane_confidence", "count", slot.K_CONFIDENCE_COUNT),
    ("lane_confidence", "of", slot.K_CONFIDENCE_OF),
    ("sensor_health", "warning_below", slot.K_HEALTH_WARNING),
    ("sensor_health", "warning_over", slot.K_HEALTH_OVER),
    ("sensor_health", "request_below", slot.K_HEALTH_REQUEST),
    ("sensor_health", "count", slot.K_HEALTH_COUNT),
    ("sensor_health", "of", slot.K_HEALTH_OF),
    ("path_blocked", "margin", slot.K_BLOCKED_MARGIN),
    ("path_blocked", "count", slot.K_BLOCKED_COUNT),
    ("path_blocked", "of", slot.K_BLOCKED_OF),
    ("lane_ends", "gap_front", slot.K_GAP_FRONT),
    ("lane_ends", "gap_rear", slot.K_GAP_REAR),
    ("lane_ends", "count", slot.K_LANE_END_COUNT),
    ("lane_ends", "of", slot.K_LANE_END_OF),
    ("no_progress", "after", slot.K_NO_PROGRESS_AFTER),
)
"""Cause, its field, and the slot of the number."""


LAWS: dict[Law, int] = {
    "lognormal": op.DRIVER_LOGNORMAL,
    "normal": op.DRIVER_NORMAL,
    "sumo": op.DRIVER_SUMO,
}
REFERENCES: dict[ReferenceName, int] = {
    "careful_and_competent": op.REFERENCE_CAREFUL,
    "careful_by_way": op.REFERENCE_CAREFUL_WAY,
    "careful_by_overlap": op.REFERENCE_CAREFUL_OVERLAP,
    "rss": op.REFERENCE_RSS,
    "fuzzy_safety_model": op.REFERENCE_FUZZY,
}
"""Codes of the reference drivers."""
TASK_EFFECTS: dict[Task, EffectKind] = {"visual": "visual_task", "handheld": "handheld_task"}
SEEN_ONLY: frozenset[Modality] = frozenset({"text", "icon", "overlay"})
"""Modalities of messages that are neither heard nor felt."""


def add_takeover(draft: ProgramBuilder) -> None:
    """Write the policy.

    Raises:
        ValueError: The driver is still a name of the catalog.
    """
    takeover, p, k = draft.plan.takeover, draft.program, draft.numbers
    k[slot.K_BUDGET] = takeover.budget
    k[slot.K_ESCALATE_AFTER] = takeover.escalate_after
    k[slot.K_MINIMUM_RISK_DECELERATION] = takeover.minimum_risk_deceleration
    p.minimum_risk[0] = 1 if takeover.minimum_risk else 0
    p.hazard_lights[0] = 1 if takeover.hazard_lights else 0
    k[slot.K_HAND_BACK_AFTER] = takeover.hand_back_after
    given: dict[str, Cause] = {cause.kind: cause for cause in takeover.causes}
    for kind, code in REQUEST_CAUSES.items():
        own = given[kind].minimum_risk_after if kind in given else None
        k[slot.K_RISK_AFTER + code] = takeover.minimum_risk_after if own is None else own
    k[slot.K_WARNING_LEAD] = takeover.warning_lead
    k[slot.K_WARNING_AFTER] = takeover.warning_after
    k[slot.K_WARNING_LEAST] = takeover.warning_least
    k[slot.K_WARNING_CLEAR] = takeover.warning_clear
    for kind, field, place in BUDGETS:
        value = getattr(given[kind], field) if kind in given else None
        k[place] = -1.0 if value is None else value
    p.before_request[0] = BEHAVIOURS[takeover.automation.before]
    p.after_request[0] = BEHAVIOURS[takeover.automation.after]
    k[slot.K_SLOW_DOWN] = takeover.automation.deceleration
    for kind in sorted(given or CAUSE_DEFAULTS, key=lambda kind: kind != "sensor_health"):
        p.cause_on[REQUEST_CAUSES[kind]] = 1
        p.cause_order.append(REQUEST_CAUSES[kind])
    p.cause_count[0] = len(p.cause_order)
    _add_limits(draft, given)
    _add_driver(draft)
    k[slot.K_INPUT_STEERING] = takeover.inputs.steering
    k[slot.K_INPUT_BRAKE] = takeover.inputs.brake
    k[slot.K_STEERING_RATIO] = takeover.inputs.steering_ratio


def _add_driver(draft: ProgramBuilder) -> None:
    """Write the driver who responds."""
    driver, k = draft.plan.takeover.driver, draft.numbers
    if isinstance(driver, Driver) and driver.takeover_time is not None:
        driver = DriverModel(name=driver.preset, takeover_time=driver.takeover_time)
    if not isinstance(driver, DriverModel):
        raise ValueError("the plan's driver is not bound to a driver model")
    draft.program.driver_kind[0] = LAWS[driver.law]
    if driver.takeover_time is not None:
        draft.program.driver_kind[0] = op.DRIVER_FIXED
        k[slot.K_DRIVER_TIME] = driver.takeover_time
    if driver.by_person is not None:  # who answers when they like, and is never drawn
        draft.program.person[0] = 1
        draft.program.driver_kind[0] = op.DRIVER_FIXED
        k[slot.K_DRIVER_TIME] = op.FAR
    k[slot.K_DRIVER_MU] = driver.mu
    k[slot.K_DRIVER_SIGMA] = driver.sigma if driver.law != "sumo" else 1.0 / NormalDist().inv_cdf(1.0 - driver.missed)
    k[slot.K_DRIVER_LAPSE] = driver.lapse
    k[slot.K_DRIVER_PERSON] = driver.person
    k[slot.K_DRIVER_LATE] = driver.late
    k[slot.K_DRIVER_LATEST] = driver.latest
    k[slot.K_EYES_ON] = driver.eyes_on
    k[slot.K_HANDS_ON] = driver.hands_on
    k[slot.K_STAGE_SPREAD] = driver.stage_spread
    if driver.drives_as is not None:
        draft.program.driver_reference[0] = REFERENCES[driver.drives_as]
    how = driver.driving
    k[slot.K_BRAKES] = how.brakes
    k[slot.K_STEERS] = how.steers
    k[slot.K_DRIVER_DECELERATION] = how.deceleration
    k[slot.K_DRIVER_LATERAL] = how.lateral_acceleration
    k[slot.K_SIGHT] = how.sight
    k[slot.K_LOOK_BESIDE] = how.look_beside
    k[slot.K_PERCEPTION_TIME] = how.perception
    k[slot.K_REACTION_TIME] = how.reaction
    k[slot.K_SDLP] = how.sdlp
    k[slot.K_SDLP_AT_FIRST] = how.sdlp_at_first
    k[slot.K_SETTLED_AFTER] = how.settled_after
    _add_effects(draft, driver)


def _add_effects(draft: ProgramBuilder, driver: DriverModel) -> None:
    """Write the effects: those of the budget, traffic and repetition always, others if they apply."""
    k = draft.numbers
    by = {one.of: one.by for one in driver.effects}
    k[slot.K_EFFECT_REPETITION] = by.get("repetition", 0.0)
    k[slot.K_EFFECT_DENSITY] = by.get("traffic_density", 0.0)
    k[slot.K_DENSITY] = -1.0 if driver.traffic_density is None else driver.traffic_density
    if driver.reference_budget is not None:
        k[slot.K_EFFECT_BUDGET] = by.get("time_budget", 0.0)
        k[slot.K_REFERENCE_BUDGET] = driver.reference_budget
    if driver.task is not None:
        k[slot.K_EFFECT_TASK] = by.get(TASK_EFFECTS[driver.task], 0.0) if driver.task != "none" else 0.0
        measured = driver.measured_task
        k[slot.K_EFFECT_MEASURED_TASK] = by.get(TASK_EFFECTS[measured], 0.0) if measured != "none" else 0.0
    if driver.eyes_closed:
        k[slot.K_EFFECT_EYES_CLOSED] = by.get("eyes_closed", 0.0)
    shown = {modality for message in draft.plan.takeover.messages for modality in message.modality} - {"none"}
    if draft.plan.takeover.messages and not shown:
        k[slot.K_EFFECT_REQUEST] = by.get("no_request", 0.0)
    elif shown and shown <= SEEN_ONLY:
        k[slot.K_EFFECT_REQUEST] = by.get("visual_request", 0.0)


def _add_limits(draft: ProgramBuilder, given: Mapping[str, Cause]) -> None:
    for kind, field, place in CAUSE_LIMITS:
        value = getattr(given[kind], field) if kind in given else None
        draft.numbers[place] = CAUSE_DEFAULTS[kind][field] if value is None else value
