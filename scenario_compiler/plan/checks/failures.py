"""Every failure of the camera begins before the run ends, and lasts long enough to come to what it is to be."""

from __future__ import annotations

from collections.abc import Mapping

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.expressions import Value
from scenario_compiler.plan.checks.triggers import AFTER_THE_END
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.sensors import Failure
from scenario_compiler.vocabulary.word import number_value

CUT_SHORT = Code(
    "SC405",
    "failure-cut-short",
    "A failure ends before it has grown to its `amount`: it grows for the time of its `ramp`, goes for as long before "
    "its end, and its `duration` holds both. With a duration of 0 it is not there at all. Give it a longer duration, "
    "or a shorter ramp."
    '\n\n    <failure kind="blur" onset="5" duration="4" ramp="3"/>     3 s to grow and 3 s to go need 6 s',
    Severity.WARNING,
)


def check_failures(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of failures, in the camera or begun by an action, that begin too late or end too soon."""
    del network
    values = parameter_values(plan.parameters)
    begun = [action for _, action in plan.storyboard.actions() if isinstance(action, Failure)]
    for failure in (*plan.camera.failures, *begun):
        _check(failure, plan.duration, values, sink)


def _check(failure: Failure, end: float, values: Mapping[str, Value], sink: Diagnostics) -> None:
    onset, ramp = number_value(failure.onset, values), number_value(failure.ramp, values)
    if onset >= end:
        message = f"the failure begins at {onset:g} s, but the run ends at {end:g} s"
        sink.add(AFTER_THE_END, message, failure.place_of("onset"))
    if failure.duration is None:
        return
    duration = number_value(failure.duration, values)
    if duration <= 0.0 or duration < 2.0 * ramp:
        message = f"the failure lasts {duration:g} s, with ramps of {ramp:g} s: it never comes to its amount"
        sink.add(CUT_SHORT, message, failure.place_of("duration"))
