"""Actions on the places of entities have their effects, equally interpreted and compiled."""

from __future__ import annotations

from functools import cache
from math import cos, pi, radians, sin
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import FAULT_NONE, SEEN_BY_SENSORS, STOP_NONE
from scenario_compiler.engine.columns.presence import there_for
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.ego.sensor import open_eye, sees
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from tests.engine.both import run_both

HERE = Path(__file__).parent
STEP = 0.05


@cache
def compiled_plan(name: str) -> tuple[Plan, Network, Program]:
    """Return a scenario of places.xml as plan, map and program."""
    sink = Diagnostics()
    done = compile_target(HERE / f"places.xml#{name}", {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, list(sink)
    return done.plan, done.network, build_program(done.plan, done.network)


class Run:
    """An interpreted run that is looked at by time and entity."""

    def __init__(self, name: str) -> None:
        self.plan, self.network, self.program = compiled_plan(name)
        self.numbers = {entity.id: i for i, entity in enumerate(self.plan.entities)}
        self.state: State = new_state(self.program)
        self.state.draw[:] = make_draws(1, 0)
        reset(self.network.tables, self.program, self.state)

    def until(self, time: float) -> State:
        """Go on to a time and return the state."""
        while self.state.clock[0] < time - 1e-6 and self.state.stop[0] == STOP_NONE:
            step(self.network.tables, self.program, self.state)
        assert self.state.flag[0] == FAULT_NONE
        return self.state

    def place(self, name: str) -> tuple[float, float, int]:
        """Return s, the offset to the left of the reference line and the lane of an entity now."""
        i = self.numbers[name]
        return self.state.s[i], self.state.t[i], self.state.lane[i]


def test_teleports_count_from_where_others_are_then() -> None:
    run = Run("places")
    st = run.until(0.0)
    width = 2.0 * abs(run.place("base")[1])
    assert run.place("road") == pytest.approx((140.0, -0.5 * width - 3.0, -2))
    free = run.numbers["free"]
    assert (st.x[free], st.y[free], st.road[free]) == pytest.approx((400.0, 900.0, -1))
    st = run.until(1.05)
    base = 200.0 + 10.0 * 1.0
    assert run.place("lanes") == pytest.approx((base + 20.0, -1.5 * width + 0.5, -2))
    assert run.place("road") == pytest.approx((base + 30.0, -0.5 * width - 2.0, -2))
    assert cos(st.h[run.numbers["road"]] - st.h[run.numbers["base"]]) == pytest.approx(-1.0)
    thing, other = run.numbers["object"], run.numbers["base"]
    assert st.road[thing] == -1
    assert cos(st.h[thing] - st.h[other] - 0.5 * pi) == pytest.approx(1.0)
    assert run.place("lanes")[2] == -2
    st = run.until(2.05)
    assert run.place("lanes")[0] == pytest.approx(base + 20.0 + 9.5 - 40.0)
    assert cos(st.h[run.numbers["lanes"]]) == pytest.approx(1.0)
    assert (st.x[thing] - st.x[other], st.y[thing] - st.y[other]) == pytest.approx((69.5, -2.0), abs=0.05)


def test_off_every_road_an_entity_goes_straight_on() -> None:
    run = Run("places")
    st = run.until(1.0)
    i = run.numbers["free"]
    assert st.x[i] == pytest.approx(400.0 + 10.0 * cos(radians(30.0)))
    assert st.y[i] == pytest.approx(900.0 + 10.0 * sin(radians(30.0)))
    assert st.v[i] == 10.0


def test_entities_come_hide_tow_and_go() -> None:
    run = Run("coming")
    truck, trailer, late = (run.numbers[name] for name in ("truck", "trailer", "late"))
    st = run.until(0.5)
    assert (st.present[late], st.v[trailer]) == (0, 0.0)
    open_eye(run.program, st, 0, 300.0, 2.0 * pi)
    assert sees(run.program, st, 0, truck) == 1
    st = run.until(1.5)
    assert st.present[late] == 1
    assert run.place("late")[0] == pytest.approx(200.0 + 5.0 * 1.0 + 30.0 + 3.0 * 0.5)
    assert there_for(st, truck, SEEN_BY_SENSORS) == 0
    assert sees(run.program, st, 0, truck) == 0
    assert st.v[trailer] == 5.0
    gap = run.place("truck")[0] - run.place("trailer")[0]
    st = run.until(2.0)
    assert run.place("truck")[0] - run.place("trailer")[0] == pytest.approx(gap)
    st = run.until(2.5)
    assert st.v[trailer] == 0.0
    st = run.until(3.5)
    assert st.present[late] == 0


@pytest.mark.parametrize("name", ["places", "coming"])
def test_both_forms_leave_the_same_bytes(name: str) -> None:
    _, network, program = compiled_plan(name)
    rows, draws = [list(program.const)], [make_draws(1, 0)]
    both = run_both(network.tables, program, rows, draws, 100)
    assert both.interpreted == both.compiled
