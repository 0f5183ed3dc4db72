"""Actions on speeds, lanes and distances have their effects, equally interpreted and compiled."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise
from math import pi, sqrt
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
STEP = 0.05


@cache
def compiled_plan(name: str) -> tuple[Plan, Network, Program]:
    """Return a scenario of moves.xml as plan, map and program."""
    sink = Diagnostics()
    done = compile_target(HERE / f"moves.xml#{name}", {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, list(sink)
    return done.plan, done.network, build_program(done.plan, done.network)


class Trace:
    """An interpreted run: the columns of each entity by step."""

    def __init__(self, name: str) -> None:
        self.plan, self.network, self.program = compiled_plan(name)
        self.numbers = {entity.id: i for i, entity in enumerate(self.plan.entities)}
        st: State = new_state(self.program)
        st.draw[:] = make_draws(1, 0)
        n = self.network.tables
        reset(n, self.program, st)
        self.rows = [self.row(st)]
        while st.stop[0] == STOP_NONE and step(n, self.program, st) == 1:
            self.rows.append(self.row(st))
        assert st.flag[0] == FAULT_NONE
        self.state = st

    @staticmethod
    def row(st: State) -> dict[str, list[float]]:
        """Return what the tests look at."""
        return {"v": st.v[:], "s": st.s[:], "t": st.t[:], "h": st.h[:], "a": st.a[:]}

    def at(self, name: str, time: float, column: str = "v") -> float:
        """Return a value of an entity at a time."""
        return self.rows[round(time / STEP)][column][self.numbers[name]]

    def all(self, name: str, column: str = "v") -> list[float]:
        """Return a value of an entity at all times."""
        return [row[column][self.numbers[name]] for row in self.rows]


@cache
def run_of(name: str) -> Trace:
    """Return the run of a scenario of moves.xml."""
    return Trace(name)


def test_a_rate_is_the_peak_of_the_change() -> None:
    run = run_of("speeds")
    span = 10.0 * pi / (2.0 * 2.5)
    assert max(run.all("lead", "a")) == pytest.approx(2.5, abs=1e-3)
    assert run.at("lead", 1.0 + span - 0.1) < 20.0 - 1e-3
    assert run.at("lead", 1.0 + span + STEP) == 20.0


def test_a_change_over_a_distance_takes_that_distance() -> None:
    run = run_of("speeds")
    done = next(k for k, v in enumerate(run.all("far")) if v == 20.0)
    assert run.rows[done]["s"][run.numbers["far"]] - run.at("far", 1.0, "s") == pytest.approx(120.0, abs=0.5)


def test_a_continuous_relative_speed_follows_the_others() -> None:
    run = run_of("speeds")
    for time in (4.0, 5.0, 10.0):
        assert run.at("half", time) == pytest.approx(0.5 * run.at("lead", time), abs=1e-9)


def test_a_relative_speed_ends_at_the_others_plus_a_delta() -> None:
    run = run_of("speeds")
    most = run.plan.entities[run.numbers["more"]].vehicle.max_acceleration
    span = 1.5 * 13.0 / most
    assert run.at("more", 8.0 + 0.5 * span) == pytest.approx(16.5, abs=most * STEP)
    assert run.at("more", 14.0) == 23.0


def test_a_profile_goes_straight_from_speed_to_speed() -> None:
    run = run_of("speeds")
    assert run.at("series", 3.0) == pytest.approx(12.0)
    assert run.at("series", 5.0) == pytest.approx(14.0)
    slowest = min(run.all("series", "a"))
    assert slowest == pytest.approx(-run.plan.entities[run.numbers["series"]].vehicle.max_deceleration, abs=1e-6)
    assert run.at("series", 6.0) == 12.0


def test_a_smooth_profile_keeps_its_jerk() -> None:
    run = run_of("speeds")
    a = run.all("smooth", "a")
    jerks = [(later - before) / STEP for before, later in pairwise(a)]
    assert max(map(abs, jerks)) < 1.0 + 1e-6
    assert max(map(abs, a)) < 2.0 + 1e-6
    corners = {2.5: 11.125, 4.2: 13.675, 6.7: 14.3, 8.5: 12.5, 9.5: 12.0}
    """Begins and ends of the parabolas: the ramp to a slope of 1.5, about the corner at 5 s, and to a slope of 0."""
    for time, speed in corners.items():
        assert run.at("smooth", time) == pytest.approx(speed)


def test_a_lane_is_reached_with_an_offset() -> None:
    run = run_of("lanes")
    centre = run.at("lead", 0.0, "t")
    assert run.at("to_right", 4.1, "t") == pytest.approx(centre + 0.5)
    assert run.at("to_lead", 4.1, "t") == pytest.approx(centre)
    assert run.at("to_right", 2.5, "h") > pi


def test_a_lane_change_by_rate_is_as_fast_sideways() -> None:
    run = run_of("lanes")
    assert run.at("by_rate", 2.0, "t") - run.at("by_rate", 1.5, "t") == pytest.approx(-0.5)
    ahead = run.at("by_rate", 2.0, "s") - run.at("by_rate", 1.5, "s")
    assert ahead == pytest.approx(5.0 * sqrt(1.0 - 0.01), abs=1e-6)


def test_a_limited_offset_takes_as_long_as_its_acceleration_asks() -> None:
    run = run_of("lanes")
    centre, span = run.at("aside", 0.0, "t"), pi
    assert run.at("aside", 1.0 + STEP, "t") == pytest.approx(centre)
    assert run.at("aside", 1.0 + span - STEP, "t") < centre + 1.0
    assert run.at("aside", 1.0 + span + 2.0 * STEP, "t") == pytest.approx(centre + 1.0)
    assert run.at("aside", 14.0, "t") == pytest.approx(centre - 1.0)
    assert run.at("aside", 14.0, "s") - run.at("aside", 0.0, "s") == pytest.approx(140.0)


def test_a_continuous_offset_follows_the_other() -> None:
    run = run_of("lanes")
    for time in (6.0, 8.0, 14.0):
        assert run.at("beside", time, "t") == pytest.approx(run.at("aside", time, "t"), abs=0.05)


def test_a_distance_is_kept_between_the_boxes_within_the_limits() -> None:
    run = run_of("distances")
    vehicle = run.plan.entities[run.numbers["spring"]].vehicle
    for time in (19.0, 30.0):
        gap = run.at("lead", time, "s") - run.at("spring", time, "s") - vehicle.length
        assert gap == pytest.approx(20.0, abs=0.3)
    assert min(run.all("spring", "a")) > -4.0 - 1e-6
    assert max(run.all("spring", "a")) < 2.0 + 1e-6


def test_without_limits_the_entity_is_put_at_the_distance() -> None:
    run = run_of("distances")
    assert run.at("rigid", 1.0 + STEP, "s") - run.at("lead", 1.0 + STEP, "s") == pytest.approx(20.0)
    assert run.at("rigid", 1.0 + STEP) == 10.0


def test_a_lateral_distance_is_reached_once() -> None:
    run = run_of("distances")
    assert run.at("right", 15.0, "t") - run.at("lead", 15.0, "t") == pytest.approx(-1.0, abs=0.01)


def test_a_lateral_distance_is_kept_within_a_speed() -> None:
    run = run_of("distances")
    t = run.all("left", "t")
    assert max(abs(b - a) for a, b in pairwise(t)) < STEP + 1e-9
    widths = [run.plan.entities[run.numbers[name]].vehicle.width for name in ("left", "lead")]
    assert run.at("left", 20.0, "t") - run.at("lead", 20.0, "t") == pytest.approx(0.5 + 0.5 * sum(widths))


def test_a_lateral_distance_that_holds_already_changes_nothing() -> None:
    run = run_of("distances")
    assert {round(t, 9) for t in run.all("there", "t")} == {round(run.at("there", 0.0, "t"), 9)}


def test_both_arrive_at_once() -> None:
    run = run_of("meeting")
    assert run.at("with_speed", 14.9, "s") == pytest.approx(399.0, abs=1.0)
    assert run.at("with_speed", 14.0) == pytest.approx(12.0, abs=0.05)
    assert run.at("plain", 14.9, "s") == pytest.approx(249.0, abs=1.5)


def test_the_automation_of_the_ego_does_them_too() -> None:
    run = run_of("automation")
    right = run_of("lanes").at("lead", 0.0, "t")
    assert run.at("ego", 8.0) == pytest.approx(12.0, abs=0.1)
    assert run.at("ego", 9.0, "t") == pytest.approx(right, abs=0.4)
    assert run.at("ego", 14.0, "t") == pytest.approx(right + 0.5, abs=0.2)
    assert run.at("ego", 23.0, "t") - run.at("lead", 23.0, "t") == pytest.approx(-3.0, abs=0.2)
    assert run.at("lead", 34.0, "s") - run.at("ego", 34.0, "s") == pytest.approx(60.0, abs=8.0)


@pytest.mark.parametrize(("name", "end"), [("ego_slowly", 10.0), ("ego_over_a_distance", 6.0)])
def test_the_ego_changes_lanes_over_the_given_time_or_distance_like_others(name: str, end: float) -> None:
    run = run_of(name)
    for time in (2.0, 0.5 * (2.0 + end), end, end + 2.0):
        assert run.at("ego", time, "t") == pytest.approx(run.at("lead", time, "t"), abs=0.25)


def rows_of(program: Program) -> list[list[float]]:
    """Return the program's numbers, and the same with one that is none, huge or zero, over all blocks of actions.

    Of each block three of six places, in turns the even and the odd ones.
    """
    usual = list(program.const)
    rows = [usual]
    for k, slot in enumerate(program.action_const):
        for offset in range(k % 2, 6, 2):
            row = list(usual)
            row[min(slot + offset, len(row) - 1)] = (math.nan, math.inf, 0.0, -1.0e300, 1.0e300)[(k + offset) % 5]
            rows.append(row)
    return rows


@pytest.mark.parametrize("name", ["speeds", "lanes", "distances", "meeting", "automation", "ego_slowly"])
def test_both_forms_leave_the_same_bytes(name: str) -> None:
    _, network, program = compiled_plan(name)
    rows = rows_of(program)
    draws = [make_draws(1, k) for k in range(len(rows))]
    both = run_both(network.tables, program, rows, draws, 150)
    assert both.interpreted == both.compiled
