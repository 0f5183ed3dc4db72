"""The default numbers of the takeover policy, by kind of cause.

A warning below 0.6 and a request below 0.3 are the AISA toolkit's. The other defaults are ours: 5 of 8 control steps;
gaps of a second either way; and 5 s without progress, which is longer than any pause of a vehicle that only follows.
A warning that begins below a value above 0.7 ends at that value, so that it does not come and go.
The minimum-risk manoeuvre begins at once when the camera fails: a severe failure after UN R157 (5.4.4, not verified).
"""

from __future__ import annotations

from scenario_compiler.expressions import Expression, parse_expression
from scenario_compiler.vocabulary.takeover import Cause, CauseKind, Takeover
from scenario_compiler.vocabulary.word import Number

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
"""Defaults in SI units. Their order is that of `Takeover.causes` if none is written."""


def complete_takeover(written: Takeover) -> Takeover:
    """Return the policy with every number filled in, and with all causes if none is written."""
    causes = written.causes or tuple(Cause.model_construct(kind=kind) for kind in CAUSE_DEFAULTS)
    return written.model_copy(update={"causes": tuple(_complete(cause) for cause in causes)})


def _complete(cause: Cause) -> Cause:
    missing: dict[str, Number] = {
        name: value for name, value in CAUSE_DEFAULTS[cause.kind].items() if getattr(cause, name) is None
    }
    if "warning_over" in missing and cause.warning_below is not None:
        missing["warning_over"] = _at_least(cause.warning_below, CAUSE_DEFAULTS[cause.kind]["warning_over"])
    return cause.model_copy(update=missing)


def _at_least(number: Number, least: float) -> Number:
    """Return the greater of two numbers, of which the first may be an expression."""
    if isinstance(number, Expression):
        return parse_expression(f"max({number.text}, {least})")
    return max(number, least)
