"""Checks that every failure of the camera begins before the run ends, and reaches its amount."""

from __future__ import annotations

from collections.abc import Mapping

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.expressions import Value
from scenario_compiler.plan.checks.triggers import AFTER_THE_END
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.sensors import SEVERITIES, Failure
from scenario_compiler.vocabulary.word import number_value

CUT_SHORT = Code(
    "SC405",
    "failure-cut-short",
    "A failure ends before it has grown to its `amount`: it grows for the time of its `ramp` and declines for the "
    "same time before its end, and `duration` includes both. With a duration of 0 there is no failure at all. Give it "
    "a longer duration, or a shorter ramp.\n\n"
    '    <failure kind="blur" onset="5" duration="4" ramp="3"/>     3 s of growth and 3 s of decline need 6 s',
    Severity.WARNING,
)

NO_SEVERITY = Code(
    "SC406",
    "no-severity",
    "The severities 1 to 5 are those of ImageNet-C, which defines them for noise, blur, impulse_noise, overexposure "
    "and motion_blur. For other kinds, use `amount`. A failure has either a severity or an amount.\n\n"
    '    <failure kind="dirt" severity="3"/>     <failure kind="dirt" amount="0.5"/>',
)
UNNOTICED = Code(
    "SC407",
    "failure-without-effect",
    "With ideal perception no image is rendered, and a failure affects only the sensor's health, which "
    "motion_blur and misalignment do not change. The failure is ignored; `--perception camera` shows it.\n\n"
    '    <failure kind="motion_blur" amount="0.2"/>     with --perception ideal',
    Severity.WARNING,
)
UNNOTICED_KINDS = ("motion_blur", "misalignment")
"""Kinds of failures that have no effect on ideal perception."""

ANGLES = Code(
    "SC408",
    "misalignment-angles",
    "A failure of the kind misalignment turns the camera on its mount by `yaw`, `pitch` and `roll` times `amount`. It "
    "needs at least one of these angles. Failures of other kinds have no angles.\n\n"
    '    <failure kind="misalignment" yaw="2" pitch="-1"/>',
)


def check_failures(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report failures, from <camera> or actions, that begin too late, end too soon, or are contradictory."""
    del network
    values = parameter_values(plan.parameters)
    for failure in plan.failures:
        _check(failure, plan.duration, values, sink)
        if plan.perception == "ideal" and failure.kind in UNNOTICED_KINDS:
            message = f"with ideal perception a failure of the kind '{failure.kind}' is ignored"
            sink.add(UNNOTICED, message, failure.place_of("kind"), hint="--perception camera shows it")


def _check(failure: Failure, end: float, values: Mapping[str, Value], sink: Diagnostics) -> None:
    if failure.severity is not None:
        if failure.kind not in SEVERITIES:
            message = f"ImageNet-C defines no severities for '{failure.kind}'"
            sink.add(NO_SEVERITY, message, failure.place_of("severity"), hint="use `amount`, from 0 to 1")
        elif "amount" in failure.model_fields_set:
            message = "the failure has both an amount and a severity"
            sink.add(NO_SEVERITY, message, failure.place_of("severity"), hint="leave one of them out")
    angles = {name: getattr(failure, name) for name in ("yaw", "pitch", "roll")}
    turned = [name for name, angle in angles.items() if angle != 0.0]
    if failure.kind == "misalignment" and not turned:
        message = "a misalignment needs an angle"
        sink.add(ANGLES, message, failure.place_of("kind"), hint='give an angle in degrees, such as yaw="2"')
    elif failure.kind != "misalignment" and turned:
        message = f"a failure of the kind '{failure.kind}' has no {turned[0]}"
        sink.add(ANGLES, message, failure.place_of(turned[0]), hint="only misalignment turns the camera")
    onset, ramp = number_value(failure.onset, values), number_value(failure.ramp, values)
    if onset >= end:
        message = f"the failure begins at {onset:g} s, but the run ends at {end:g} s"
        sink.add(AFTER_THE_END, message, failure.place_of("onset"))
    if failure.duration is None:
        return
    duration = number_value(failure.duration, values)
    if duration <= 0.0 or duration < 2.0 * ramp:
        message = f"the failure lasts {duration:g} s, with ramps of {ramp:g} s: it never reaches its amount"
        sink.add(CUT_SHORT, message, failure.place_of("duration"))
