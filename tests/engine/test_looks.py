"""A look ahead that was just made is not made again: its measurements are those that another look makes."""

from __future__ import annotations

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.ego.sensor import look_ahead
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Simulation

MEASURED = ("seen", "on_way", "near", "far", "low", "high", "along", "across", "border_left", "border_right")


def test_what_was_measured_in_a_control_step_is_still_true_at_its_end() -> None:
    done = compile_target("obstacle_ahead", {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert done is not None
    tables = done.network.tables
    simulation = Simulation(tables, build_program(done.plan, done.network), interpreted=True)
    simulation.reset(make_draws(1, 0))
    program, st = simulation.program, simulation.state
    compared = {op.TAKEOVER_AUTOMATED: 0, op.TAKEOVER_MANUAL: 0}
    while not simulation.over and simulation.begin():
        if st.looked[0] == 1 and (st.frame[0] - 1) % program.control_every[0] == 0:
            before = {name: list(getattr(st, name)) for name in MEASURED}
            st.looked[0] = 0
            look_ahead(tables, program, st, program.ego[0], st.eye_reach[0], st.eye_view[0])
            assert {name: list(getattr(st, name)) for name in MEASURED} == before, st.clock[0]
            compared[st.takeover_state[0]] = compared.get(st.takeover_state[0], 0) + 1
        simulation.move()
        simulation.end()
    assert compared[op.TAKEOVER_AUTOMATED] > 20
    assert compared[op.TAKEOVER_MANUAL] > 20
