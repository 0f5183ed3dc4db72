"""Checks that every limit of a cause or of the forward sensor applies to its kind, and that limits are consistent."""

from __future__ import annotations

from collections.abc import Mapping

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.expressions import Value
from scenario_compiler.plan.defaults import CAUSE_DEFAULTS
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.takeover import Cause
from scenario_compiler.vocabulary.word import AttributeSpelling, Number, number_value, spelling_of

FOREIGN_LIMIT = Code(
    "SC501",
    "foreign-limit",
    "A <cause> or <forward_sensor> has an attribute of another kind, which would have no effect. For causes, the "
    "thresholds belong to lane_confidence and sensor_health, `margin` to path_blocked, the gaps to lane_ends, and "
    "`after` to no_progress, which has no `count`. For sensors, `headlights` belongs to a camera, and `noise` to a "
    "radar or lidar; the noise of a camera is set in <camera>.\n\n"
    '    <cause kind="lane_ends" request_below="0.3"/>     lane_ends has gaps, but no confidence',
)
IMPOSSIBLE_COUNT = Code(
    "SC502",
    "impossible-count",
    "A <cause> requires more control steps (`count`) than it considers (`of`), so it can never take effect.\n\n"
    '    <cause kind="path_blocked" count="9" of="3"/>     9 of 3 control steps are impossible',
)


CROSSED_THRESHOLDS = Code(
    "SC516",
    "crossed-thresholds",
    "A warning of a <cause> ends at a lower value than it begins (`warning_over` is less than `warning_below`), so "
    "that between the two it would end and begin again in turn. Or it begins after the request: its threshold is less "
    "than that of the request, or its budget is. `warning_below` may be 0, for a cause without a warning. Or the "
    "escalation of a request comes later than the minimum-risk manoeuvre, after which there is none.\n\n"
    '    <cause kind="lane_confidence" warning_below="0.6" warning_over="0.5"/>     warning_over="0.7"\n'
    '    <cause kind="path_blocked" budget="7" warning_budget="5"/>     warning_budget="9"\n'
    '    <takeover escalate_after="12" minimum_risk_after="10">     escalate_after="5"',
)


def check_causes(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report attributes of other kinds of causes or sensors, counts that are never reached, and crossed thresholds."""
    del network
    sensor = plan.forward_sensor
    for name in ("noise",) if sensor.kind == "camera" else ("headlights",):
        if getattr(sensor, name) is not None:
            sink.add(FOREIGN_LIMIT, f"a {sensor.kind} has no '{name}'", sensor.place_of(name))
    values = parameter_values(plan.parameters)
    for cause in plan.takeover.causes:
        counted = set() if cause.kind == "no_progress" else {"count", "of"}
        budgets = {"budget", "warning_budget"} if cause.kind in ("path_blocked", "lane_ends") else set()
        allowed = {"word", "kind", "minimum_risk_after", *counted, *budgets, *CAUSE_DEFAULTS[cause.kind]}
        for name, field in Cause.model_fields.items():
            spelling = spelling_of(field)
            if getattr(cause, name) is not None and name not in allowed and isinstance(spelling, AttributeSpelling):
                attribute = spelling.name or name
                message = f"'{attribute}' is not a limit of the cause '{cause.kind}'"
                sink.add(FOREIGN_LIMIT, message, cause.place_of(attribute))
        if cause.count is not None and cause.of is not None and cause.count > cause.of:
            message = f"{cause.count} of {cause.of} control steps are impossible: the cause never takes effect"
            sink.add(IMPOSSIBLE_COUNT, message, cause.place_of("count"))
        if cause.warning_below is not None and cause.warning_over is not None:
            begins, ends = (number_value(one, values) for one in (cause.warning_below, cause.warning_over))
            if ends < begins:
                message = f"the warning begins below {begins:g} and would end over {ends:g}"
                sink.add(CROSSED_THRESHOLDS, message, cause.place_of("warning_over"))
        _check_order(cause, plan.takeover.budget, values, sink)
    _check_escalation(plan, values, sink)


def _check_escalation(plan: Plan, values: Mapping[str, Value], sink: Diagnostics) -> None:
    """Warn of an escalation within the run that comes after the minimum-risk manoeuvre for every cause."""
    takeover = plan.takeover
    waits = (takeover.minimum_risk_after, *(one.minimum_risk_after for one in takeover.causes))
    latest = max(number_value(one, values) for one in waits if one is not None)
    escalates = number_value(takeover.escalate_after, values)
    written = takeover.written("escalate_after") is not None
    if written and takeover.minimum_risk and latest < escalates < plan.duration:
        message = (
            f"the request escalates after {escalates:g} s, but the minimum-risk manoeuvre begins after {latest:g} s"
        )
        sink.add(CROSSED_THRESHOLDS, message, takeover.place_of("escalate_after"), severity=Severity.WARNING)


def _check_order(cause: Cause, budget: Number, values: Mapping[str, Value], sink: Diagnostics) -> None:
    """Warn of a warning that begins after the request for its cause; `budget` is that of the policy, s."""
    if cause.warning_below is not None and cause.request_below is not None:
        warns, requests = (number_value(one, values) for one in (cause.warning_below, cause.request_below))
        if 0.0 < warns < requests:
            written = "request_below" if cause.written("warning_below") is None else "warning_below"
            message = f"the warning begins below {warns:g}, after the request, which comes below {requests:g}"
            sink.add(CROSSED_THRESHOLDS, message, cause.place_of(written), severity=Severity.WARNING)
    if cause.warning_budget is not None:
        own = budget if cause.budget is None else cause.budget
        warns, requests = (number_value(one, values) for one in (cause.warning_budget, own))
        if warns < requests:
            message = (
                f"the warning begins {warns:g} s before the limit, after the request, which comes {requests:g} s before"
            )
            sink.add(CROSSED_THRESHOLDS, message, cause.place_of("warning_budget"), severity=Severity.WARNING)
