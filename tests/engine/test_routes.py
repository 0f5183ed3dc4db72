"""Routes, goals and random ways decide at junctions, interpreted and compiled alike."""

from __future__ import annotations

from functools import cache, partial
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import FAULT_NONE, STOP_NONE
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.routes import cost_of_stretch
from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.ways import path_between, travel_time
from tests.engine.both import run_both
from tests.roads.make import lane, network, road, section

HERE = Path(__file__).parent


@cache
def compiled_plan() -> tuple[Plan, Network, Program]:
    """Return the scenario of routes.xml as plan, map and program."""
    sink = Diagnostics()
    done = compile_target(HERE / "routes.xml#routes", {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, list(sink)
    return done.plan, done.network, build_program(done.plan, done.network)


def ways(seed: int) -> tuple[dict[str, list[str]], State]:
    """Return the roads outside junctions that entities come over in a run, and its last state."""
    plan, network, program = compiled_plan()
    state = new_state(program)
    state.draw[:] = make_draws(seed, 0)
    reset(network.tables, program, state)
    came: dict[str, list[str]] = {entity.id: [] for entity in plan.entities}
    while state.stop[0] == STOP_NONE:
        for i, entity in enumerate(plan.entities):
            road = state.road[i]
            known = came[entity.id]
            if road >= 0 and network.tables.road_junction[road] < 0 and network.road_ids[road] not in known[-1:]:
                known.append(network.road_ids[road])
        step(network.tables, program, state)
    assert state.flag[0] == FAULT_NONE
    return came, state


def test_entities_follow_their_destination_or_route_and_otherwise_go_straight_on() -> None:
    came, _ = ways(1)
    assert came["plain"] == ["1", "3"]
    assert came["goal"] == ["1", "6"]
    assert came["route"] == ["1", "7"]
    assert came["chance"][1] in ("3", "6", "7")


def test_a_place_on_a_route_is_counted_from_its_first_waypoint() -> None:
    came, state = ways(1)
    placed = list(came).index("placed")
    assert came["placed"] == ["5", "1"]
    assert state.s[placed] == pytest.approx(430.0)


def test_both_forms_leave_the_same_bytes() -> None:
    _, network, program = compiled_plan()
    rows, draws = [list(program.const)], [make_draws(1, 0)]
    both = run_both(network.tables, program, rows, draws, 240)
    assert both.interpreted == both.compiled


def test_the_travel_time_of_a_road_is_that_at_its_limits(tmp_path: Path) -> None:
    """Of 400 m, 100 m have no type, 100 m are in a zone of 30 km/h, and 200 m have a limit of 20 m/s."""
    types = '<type s="100" type="lowSpeed"/><type s="200" type="town"><speed max="20" unit="m/s"/></type>'
    made = network(tmp_path, road("1", 400.0).replace("<planView>", f"{types}<planView>"), road("2", 139.0))
    assert travel_time(made.tables, (0, 1)) == pytest.approx(100.0 / 13.9 + 100.0 / 8.3 + 200.0 / 20.0)
    assert travel_time(made.tables, (1, 1)) == pytest.approx(10.0)


def test_the_travel_time_of_a_road_is_that_of_its_fastest_lane_in_the_direction(tmp_path: Path) -> None:
    """To the right, 100 m have limits of 10 and 20 m/s, and 100 m those of 10 m/s and of the road, 25 m/s."""
    width, limit = '<width sOffset="0" a="3" b="0" c="0" d="0"/>', '<speed sOffset="{}" max="{}"/>'
    slow, fast = width + limit.format(0, 10), width + limit.format(0, 20) + limit.format(100, "undefined")
    right = lane(-1, fast) + lane(-2, slow) + lane(-3, width + limit.format(0, 30), "sidewalk")
    text = road("1", 200.0, lanes=section(lane(1, slow), right))
    kind = '<type s="0" type="rural"><speed max="25" unit="m/s"/></type>'
    made = network(tmp_path, text.replace("<planView>", f"{kind}<planView>"))
    assert travel_time(made.tables, (0, 1)) == pytest.approx(100.0 / 20.0 + 100.0 / 25.0)
    assert travel_time(made.tables, (0, -1)) == pytest.approx(200.0 / 10.0)


@pytest.mark.parametrize(
    ("strategy", "roads"),
    [
        ("shortest", ["1", "100", "2", "200", "3", "301", "6"]),
        ("random", ["1", "100", "2", "200", "3", "301", "6"]),
        ("fastest", ["1", "100", "2", "201", "4", "302", "6"]),
    ],
)
def test_the_fastest_way_leads_over_the_motorway(corpus: Path, strategy: str, roads: list[str]) -> None:
    """From road 2 on, road 3 is a zone of 30 km/h with 240 m, road 4 a motorway with 403 m."""
    map_of = load_network(corpus / "esmini/EnvironmentSimulator/Unittest/xodr/route_strategy_test_road.xodr")
    assert map_of is not None
    n = map_of.tables
    start, goal = ((map_of.road_index(name), 1) for name in ("1", "6"))
    path = path_between(n, start, goal, partial(cost_of_stretch, n, strategy))
    assert path is not None
    assert [map_of.road_ids[one] for one, _ in path] == roads
