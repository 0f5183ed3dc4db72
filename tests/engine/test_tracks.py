"""Trajectories are followed by speed and by time, equally interpreted and compiled."""

from __future__ import annotations

from functools import cache
from math import atan2, cos, hypot, pi, radians, sin
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import FAULT_NONE, STOP_NONE
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from tests.engine.both import run_both

HERE = Path(__file__).parent


@cache
def compiled_plan() -> tuple[Plan, Network, Program]:
    """Return the scenario of tracks.xml as plan, map and program."""
    sink = Diagnostics()
    done = compile_target(HERE / "tracks.xml#tracks", {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, list(sink)
    return done.plan, done.network, build_program(done.plan, done.network)


class Run:
    """An interpreted run that is looked at by time and entity."""

    def __init__(self) -> None:
        self.plan, self.network, self.program = compiled_plan()
        self.numbers = {entity.id: i for i, entity in enumerate(self.plan.entities)}
        self.state: State = new_state(self.program)
        self.state.draw[:] = make_draws(1, 0)
        reset(self.network.tables, self.program, self.state)

    def at(self, time: float, name: str) -> tuple[float, float, float, float]:
        """Go on to a time and return x, y, heading and speed of an entity."""
        st = self.state
        while st.clock[0] < time - 1e-6 and st.stop[0] == STOP_NONE:
            step(self.network.tables, self.program, st)
        assert st.flag[0] == FAULT_NONE
        i = self.numbers[name]
        return st.x[i], st.y[i], st.h[i], st.v[i]


def test_a_polyline_turns_near_its_corners_and_ends_in_a_standstill_off_the_roads() -> None:
    run = Run()
    assert run.at(1.0, "corner") == pytest.approx((405.0, 900.0, 0.0, 5.0))
    assert run.at(2.0, "corner") == pytest.approx((410.0, 900.0, 0.25 * pi, 5.0))
    assert run.at(3.0, "corner") == pytest.approx((410.0, 905.0, 0.5 * pi, 5.0))
    x, y, _, v = run.at(5.0, "corner")
    assert (x, y, v) == pytest.approx((410.0, 910.0, 0.0))


def test_a_closed_trajectory_is_followed_all_round_from_its_entry() -> None:
    run = Run()
    assert run.at(0.0, "round")[:2] == pytest.approx((505.0, 900.0))
    assert run.at(6.5, "round")[:2] == pytest.approx((500.0, 902.5))
    assert run.at(7.5, "round")[:2] == pytest.approx((502.5, 900.0))


def test_times_are_kept_with_even_acceleration_where_it_is_followed() -> None:
    run = Run()
    assert run.at(1.0, "timed")[3] == pytest.approx(5.0)
    assert run.at(3.0, "timed")[::3] == pytest.approx((610.0, 5.0))
    assert run.at(4.0, "timed")[0] == pytest.approx(610.0 + 5.0 + 0.5 * 10.0)
    assert run.at(5.0, "timed")[0] == pytest.approx(640.0)


def test_clothoids_follow_their_curvature() -> None:
    run = Run()
    x, y, h, _ = run.at(1.0, "spiral")
    assert (x, y, h) == pytest.approx((700.0 + 10.0 * sin(0.5), 900.0 + 10.0 * (1.0 - cos(0.5)), 0.5))
    assert run.at(3.9, "spiral")[2] == pytest.approx(1.0 + 0.1 * 9.5 - 0.005 * 9.5**2)


def test_a_nurbs_is_on_its_curve_at_its_times() -> None:
    run = Run()
    pieces = 1 + int(10.0 + hypot(10.0, 10.0))
    u = (pieces // 2) / pieces
    x, y, h, _ = run.at(2.0, "curve")
    assert (x, y) == pytest.approx((800.0 + 20.0 * u, 900.0 + 10.0 * u * u), abs=1e-3)
    assert h == pytest.approx(atan2(20.0 * u, 20.0), abs=1e-3)
    assert run.at(4.0, "curve")[:2] == pytest.approx((820.0, 910.0), abs=1e-3)


def test_a_position_lies_along_a_trajectory_that_counts_from_where_another_is() -> None:
    run = Run()
    run.at(1.0, "placed")
    x, y, h, _ = run.at(1.05, "placed")
    begin_x, begin_y = 405.0, 1000.0
    along = atan2(-begin_y, -begin_x)
    far = hypot(begin_x, begin_y)
    assert x == pytest.approx(begin_x * (1.0 - 15.0 / far) - sin(along), abs=1e-6)
    assert y == pytest.approx(begin_y * (1.0 - 15.0 / far) + cos(along), abs=1e-6)
    assert cos(h - along - radians(90.0)) == pytest.approx(1.0)


def test_both_forms_leave_the_same_bytes() -> None:
    _, network, program = compiled_plan()
    rows, draws = [list(program.const)], [make_draws(1, 0)]
    both = run_both(network.tables, program, rows, draws, 150)
    assert both.interpreted == both.compiled
