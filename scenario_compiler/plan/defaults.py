"""The numbers of the takeover policy that an author may leave out, by kind of cause.

Warning below 0.6 and request below 0.3 are the AISA toolkit's; 5 of 8 control steps, the gaps and the time without
progress are ours: the gaps are a second either way, and 5 s is longer than any pause of a vehicle that only follows.
The minimum-risk manoeuvre begins at once when the camera fails: a severe failure after UN R157 (5.4.4, not verified).
"""

from __future__ import annotations

from scenario_compiler.vocabulary.takeover import Cause, CauseKind, Takeover

CAUSE_DEFAULTS: dict[CauseKind, dict[str, float | int]] = {
    "sensor_health": {
        "warning_below": 0.6,
        "warning_over": 0.7,
        "request_below": 0.3,
        "count": 5,
        "of": 8,
        "minimum_risk_after": 0.0,
    },
    "lane_confidence": {"warning_below": 0.6, "warning_over": 0.7, "request_below": 0.3, "count": 5, "of": 8},
    "path_blocked": {"count": 2, "of": 3, "margin": 0.5},
    "lane_ends": {"count": 2, "of": 3, "gap_front": 1.0, "gap_rear": 2.0},
    "no_progress": {"after": 5.0},
    "controller": {"count": 1, "of": 1},
}
"""Defaults in SI units. The order is that of `Takeover.causes` when none is given: the first to ask is named."""


def complete_takeover(written: Takeover) -> Takeover:
    """Return the policy with all causes switched on when none is given, and every number filled in."""
    causes = written.causes or tuple(Cause.model_construct(kind=kind) for kind in CAUSE_DEFAULTS)
    return written.model_copy(update={"causes": tuple(_complete(cause) for cause in causes)})


def _complete(cause: Cause) -> Cause:
    missing = {name: value for name, value in CAUSE_DEFAULTS[cause.kind].items() if getattr(cause, name) is None}
    return cause.model_copy(update=missing)
