"""The driver's inputs after the response: the times of the first steering and the first braking."""

from __future__ import annotations

from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.totals import Totals
from scenario_compiler.engine.measures.takeover import since
from scenario_compiler.marker import compiled


@compiled
def add_inputs(p: Program, m: Totals) -> None:
    """Add the last row; the steering is relative to the angle in the first row after the response.

    Commands of the automation, before the response or after the hand-back, are not inputs of the driver.
    """
    if m.row_present[0] == 0 or since(m, m.time_response[0]) == 0:
        return
    if m.response_seen[0] == 0:
        m.response_seen[0] = 1
        m.response_steer[0] = m.row_steer[0]
    turned = abs(m.row_steer[0] - m.response_steer[0]) * p.const[slot.K_STEERING_RATIO]
    if m.driving[0] != 1:
        return
    if m.time_steered[0] < 0.0 and turned > p.const[slot.K_INPUT_STEERING]:
        m.time_steered[0] = m.row_time[0]
    if m.time_braked[0] < 0.0 and m.row_brake[0] > p.const[slot.K_INPUT_BRAKE]:
        m.time_braked[0] = m.row_time[0]
