"""Swarms, sources and sinks have their effects, equally interpreted and compiled, and their vehicles do not touch."""

from __future__ import annotations

from collections import Counter
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.motion.collision import overlap
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.engine.traffic.swarms import extent_at
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.word import number_value
from tests.engine.both import run_both

HERE = Path(__file__).parent
MIDDLE = 1
"""Number of the entity that both swarms are around."""


@cache
def prepared(name: str) -> tuple[Plan, Network, Program]:
    """Return a scenario of traffic_actions.xml as plan, map and program."""
    sink = Diagnostics()
    target = HERE / f"traffic_actions.xml#{name}"
    done = compile_target(target, {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, list(sink)
    return done.plan, done.network, build_program(done.plan, done.network)


class Watch:
    """A run, and what is seen of its traffic: who appears and disappears when and where, and who touches whom."""

    def __init__(self, name: str, seed: int = 1) -> None:
        self.plan, network, self.program = prepared(name)
        self.state = st = new_state(self.program)
        st.draw[:] = make_draws(seed)
        reset(network.tables, self.program, st)
        self.came: list[tuple[float, str, float, float]] = []
        self.went: list[tuple[float, str, float, float]] = []
        self.touched: set[tuple[int, int]] = set()
        self.before = [0] * self.program.entity_count[0]
        while True:
            self._look()
            if st.stop[0] != op.STOP_NONE or step(network.tables, self.program, st) == 0:
                break

    def _look(self) -> None:
        st, now = self.state, self.state.clock[0]
        for i, is_there in enumerate(st.present):
            if is_there != self.before[i]:
                seen = self.came if is_there else self.went
                seen.append((now, self.plan.entities[i].id, st.x[i], st.y[i]))
        self.before = list(st.present)
        there = [i for i, one in enumerate(st.present) if one]
        if st.frame[0] % 5 == 0:
            self.touched.update((i, j) for i in there for j in there if i < j and overlap(self.program, st, i, j))

    def of(self, seen: list[tuple[float, str, float, float]], name: str) -> list[tuple[float, float, float]]:
        """Return when and where vehicles of an action were seen to come or go."""
        return [(t, x, y) for t, one, x, y in seen if one.startswith(f"{name}.")]


@cache
def watched(name: str) -> Watch:
    """Return a run of a scenario."""
    return Watch(name)


@pytest.mark.parametrize("name", ["swarm", "highway"])
def test_vehicles_of_traffic_do_not_touch(name: str) -> None:
    run = watched(name)
    assert run.state.flag[0] == op.FAULT_NONE
    assert {pair for pair in run.touched if MIDDLE not in pair} == set()


def test_a_swarm_appears_when_it_begins_and_comes_back_until_it_is_stopped() -> None:
    run = watched("swarm")
    times = [t for t, _, _ in run.of(run.came, "swarm")]
    assert min(times) == pytest.approx(1.05, abs=0.06)
    assert sum(t < 1.2 for t in times) >= 10
    assert sum(t > 1.2 for t in times) >= 4
    assert max(times) < 25.1
    assert all(t < 25.1 for t, _, _ in run.of(run.went, "swarm"))
    assert sum(run.state.present[2:]) >= 8


def test_a_swarm_stays_in_its_ellipse() -> None:
    plan, network, p = prepared("swarm")
    k = p.action_op.index(ACTION["traffic_swarm"])
    st = new_state(p)
    st.draw[:] = make_draws(2)
    reset(network.tables, p, st)
    vehicles = range(MIDDLE + 1, p.entity_count[0])
    apart: list[float] = []
    while st.clock[0] < 24.0:
        there = [i for i in vehicles if st.present[i]]
        step(network.tables, p, st)
        inside = [extent_at(p, st, k, st.x[i], st.y[i]) for i in there if st.present[i]]
        assert max(inside, default=0.0) < 1.05
        new = [i for i in vehicles if st.present[i] and i not in there]
        apart += [((st.x[i] - st.x[MIDDLE]) ** 2 + (st.y[i] - st.y[MIDDLE]) ** 2) ** 0.5 for i in new]
    assert min(apart) > 24.0
    assert len(plan.entities) == 18


def test_kinds_are_drawn_by_their_weights() -> None:
    plan, _, _ = prepared("swarm")
    kinds = Counter(one.vehicle.category for one in plan.entities if one.kind == "traffic")
    assert set(kinds) == {"car", "van"}
    assert kinds["car"] > kinds["van"]


def test_a_swarm_drives_in_the_given_direction_at_speeds_of_the_range() -> None:
    plan, _, p = prepared("highway")
    run = watched("highway")
    st = run.state
    vehicles = [i for i, one in enumerate(plan.entities) if one.id.startswith("around.")]
    speeds = [one.speed for one in plan.entities if one.id.startswith("around.")]
    assert all(18.0 <= number_value(speed, {}) <= 24.0 for speed in speeds)
    assert len(set(speeds)) == len(vehicles)
    assert any(st.present[i] for i in vehicles)
    assert p.action_op.count(ACTION["traffic_swarm"]) == 1


def test_a_source_keeps_its_rate_and_a_sink_removes_every_vehicle() -> None:
    run = watched("highway")
    times = [t for t, _, _ in run.of(run.came, "flow")]
    assert times[0] == pytest.approx(0.0, abs=0.06)
    assert all(b - a > 3.9 for a, b in pairwise(times))
    assert 6 <= len(times) <= 8
    assert max(times) < 30.1
    taken = run.of(run.went, "flow")
    assert taken
    assert all(t < 30.1 for t, _, _ in taken)


def test_runs_of_one_seed_are_the_same_and_of_another_differ() -> None:
    one, again, other = watched("highway"), Watch("highway"), Watch("highway", seed=5)
    assert one.came == again.came
    assert one.came != other.came


@pytest.mark.parametrize("name", ["swarm", "highway"])
def test_both_forms_leave_the_same_bytes(name: str) -> None:
    _, network, program = prepared(name)
    broken = list(program.const)
    k = next(k for k, kind in enumerate(program.action_op) if kind == ACTION["traffic_swarm"])
    broken[program.action_const[k] + 1] = float("nan")
    rows, draws = [list(program.const), list(program.const), broken], [make_draws(7, k) for k in range(3)]
    limit = 401
    both = run_both(network.tables, program, rows, draws, limit - 1)
    assert both.interpreted == both.compiled
    assert both.interpreted[0] != both.interpreted[1]
