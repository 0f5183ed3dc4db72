"""Checks that the camera takes its images at control steps."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.expressions import format_value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network

UNEVEN_RATE = Code(
    "SC251",
    "uneven-camera-rate",
    "The time between two images of the camera is not a whole number of control steps, so images would fall between "
    "them. Choose a rate that divides the rate of the control steps, or another `step`.\n\n"
    '    <scenario ... step="0.05">  <camera rate="15"/>     20 control steps a second: 20, 10, 5, 4 ... images',
)

SLACK = 1.0e-6
"""Largest difference between a period and a whole number of control steps, as a share of the period."""


def check_camera(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report a rate whose period is not a whole number of control steps."""
    del network
    if plan.camera.rate is None:
        return
    period = plan.step * plan.control_every
    steps = plan.camera.control_steps(period)
    if steps >= 1.0 - SLACK and abs(steps - round(steps)) <= SLACK * steps:
        return
    below = max(int(steps), 1)
    near = [format_value(float(f"{1.0 / (count * period):.6g}")) for count in dict.fromkeys((below, below + 1))]
    message = (
        f"{format_value(plan.camera.rate)} images per second are one in {steps:.4g} control steps of {period:.6g} s"
    )
    sink.add(UNEVEN_RATE, message, plan.camera.place_of("rate"), hint=f"even rates near it: {' and '.join(near)}")
