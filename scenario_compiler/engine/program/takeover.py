"""The takeover policy: its times, causes and driver."""

from __future__ import annotations

from collections.abc import Mapping

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.plan.defaults import CAUSE_DEFAULTS
from scenario_compiler.vocabulary.takeover import Cause, CauseKind, DriverModel

CAUSE_CODES: dict[CauseKind, int] = {
    "controller": op.CAUSE_CONTROLLER,
    "sensor_health": op.CAUSE_SENSOR_HEALTH,
    "lane_confidence": op.CAUSE_LANE_CONFIDENCE,
    "path_blocked": op.CAUSE_PATH_BLOCKED,
    "lane_ends": op.CAUSE_LANE_ENDS,
}
CAUSE_LIMITS: tuple[tuple[CauseKind, str, int], ...] = (
    ("lane_confidence", "warning_below", slot.K_CONFIDENCE_WARNING),
    ("lane_confidence", "request_below", slot.K_CONFIDENCE_REQUEST),
    ("lane_confidence", "count", slot.K_CONFIDENCE_COUNT),
    ("lane_confidence", "of", slot.K_CONFIDENCE_OF),
    ("sensor_health", "warning_below", slot.K_HEALTH_WARNING),
    ("sensor_health", "request_below", slot.K_HEALTH_REQUEST),
    ("sensor_health", "count", slot.K_HEALTH_COUNT),
    ("sensor_health", "of", slot.K_HEALTH_OF),
    ("path_blocked", "margin", slot.K_BLOCKED_MARGIN),
    ("path_blocked", "sensor_range", slot.K_SENSOR_RANGE),
    ("path_blocked", "field_of_view", slot.K_FIELD_OF_VIEW),
    ("path_blocked", "count", slot.K_BLOCKED_COUNT),
    ("path_blocked", "of", slot.K_BLOCKED_OF),
    ("lane_ends", "gap_front", slot.K_GAP_FRONT),
    ("lane_ends", "gap_rear", slot.K_GAP_REAR),
    ("lane_ends", "count", slot.K_LANE_END_COUNT),
    ("lane_ends", "of", slot.K_LANE_END_OF),
)
"""Cause, its field, and the slot of that number."""


def add_takeover(draft: ProgramBuilder) -> None:
    """Write the policy.

    Raises:
        ValueError: The driver is a name of the catalog still.
    """
    takeover, p, k = draft.plan.takeover, draft.program, draft.numbers
    k[slot.K_BUDGET] = takeover.budget
    k[slot.K_ESCALATE_AFTER] = takeover.escalate_after
    k[slot.K_MINIMUM_RISK_AFTER] = takeover.minimum_risk_after
    k[slot.K_MINIMUM_RISK_DECELERATION] = takeover.minimum_risk_deceleration
    p.hazard_lights[0] = 1 if takeover.hazard_lights else 0
    k[slot.K_HAND_BACK_AFTER] = takeover.hand_back_after
    given = {cause.kind: cause for cause in takeover.causes}
    for kind in given or CAUSE_DEFAULTS:
        p.cause_on[CAUSE_CODES[kind]] = 1
        p.cause_order.append(CAUSE_CODES[kind])
    p.cause_count[0] = len(p.cause_order)
    _add_limits(draft, given)
    driver = takeover.driver
    if isinstance(driver, DriverModel) and driver.by_person is not None:
        p.person[0] = 1
        p.driver_kind[0] = op.DRIVER_FIXED
        k[slot.K_DRIVER_TIME] = op.FAR
    elif isinstance(driver, DriverModel) and driver.takeover_time is None:
        p.driver_kind[0] = op.DRIVER_LOGNORMAL
        k[slot.K_DRIVER_MU] = driver.mu
        k[slot.K_DRIVER_SIGMA] = driver.sigma
        k[slot.K_DRIVER_LAPSE] = driver.lapse
    elif driver.takeover_time is not None:
        p.driver_kind[0] = op.DRIVER_FIXED
        k[slot.K_DRIVER_TIME] = driver.takeover_time
    else:
        raise ValueError("the plan's driver is not bound to a driver model")


def _add_limits(draft: ProgramBuilder, given: Mapping[CauseKind, Cause]) -> None:
    for kind, field, place in CAUSE_LIMITS:
        value = getattr(given[kind], field) if kind in given else None
        draft.numbers[place] = CAUSE_DEFAULTS[kind][field] if value is None else value
