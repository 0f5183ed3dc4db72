"""Conditions, and actions on the run as a whole, have their effects, equally interpreted and compiled."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import EVENT_STORYBOARD_START, FAULT_NONE, STOP_NONE
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.program import Program, build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.runtime import open_world, run
from scenario_compiler.runtime.log import named_events
from tests.engine.both import run_both
from tests.engine.test_traffic import compiled_text

HERE = Path(__file__).parent
STEP = 0.05
SCENARIOS = ("gaps", "motions", "values", "drivers")


@cache
def prepared(name: str) -> tuple[Plan, Network, Program]:
    """Return a scenario of world.xml as plan, map and program."""
    sink = Diagnostics()
    done = compile_target(HERE / f"world.xml#{name}", {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, list(sink)
    return done.plan, done.network, build_program(done.plan, done.network)


@cache
def started(name: str) -> tuple[dict[str, float], list[list[float]]]:
    """Return when each event of a scenario starts, and the entities' speeds by step."""
    plan, network, program = prepared(name)
    state = new_state(program)
    state.draw[:] = make_draws(1, 0)
    reset(network.tables, program, state)
    speeds = [state.v[:]]
    while state.stop[0] == STOP_NONE and step(network.tables, program, state) == 1:
        speeds.append(state.v[:])
    assert state.flag[0] == FAULT_NONE
    names = named_events(plan, program)
    log = zip(state.log_kind, state.log_time, state.log_value, strict=True)
    return {names[int(value)][0]: time for kind, time, value in log if kind == EVENT_STORYBOARD_START}, speeds


@pytest.mark.parametrize(
    ("name", "times"),
    [
        (
            "gaps",
            {
                **{"across": 0.0, "faster": 0.0, "far_across": 1.0, "boxes": 3.55, "headway": 4.05},
                **{"closing_place": 4.05, "closing": 5.05, "front": 7.35, "place": 7.55, "clear": 8.05, "behind": 10.0},
            },
        ),
        (
            "motions",
            {
                **{"lateral": 0.0, "turned": 1.4, "turned_away": 1.4, "brakes": 2.05, "slower": 4.05, "off": 2.85},
                **{"hits": 3.6, "hits_a_thing": 3.6, "stands": 7.05},
            },
        ),
        (
            "values",
            {
                **{"tick": 1.0, "tock": 1.0, "green": 1.0, "more": 2.0, "noon": 6.0, "side_red": 2.5},
                **{"caution": 3.0, "red": 4.0, "again": 5.0, "caution_again": 8.0, "dark": 6.0, "is_dark": 6.0},
                **{"door": 1.0, "opening": 1.0, "opened": 3.0},
            },
        ),
    ],
)
def test_events_start_when_their_conditions_say(name: str, times: dict[str, float]) -> None:
    found, _ = started(name)
    named = {event: time for event, time in found.items() if ".when" not in event}
    assert named == pytest.approx(times, abs=1e-6)


def test_an_assigned_controller_follows_until_it_is_switched_off() -> None:
    _, speeds = started("drivers")
    tailing = [row[1] for row in speeds]
    assert tailing[20] == 20.0
    assert min(tailing) == pytest.approx(10.0, abs=0.01)
    assert tailing[-1] == pytest.approx(12.0)


def test_a_held_brake_stops_the_ego_as_hard_as_the_road_lets_it() -> None:
    plan, _, _ = prepared("drivers")
    _, speeds = started("drivers")
    lost = (speeds[50][0] - speeds[60][0]) / (10 * STEP)
    assert lost == pytest.approx(0.5 * plan.ego.vehicle.max_deceleration, rel=1e-6)
    assert speeds[-1][0] > speeds[61][0]


def test_traffic_is_removed() -> None:
    plan, network, program = prepared("drivers")
    state = new_state(program)
    state.draw[:] = make_draws(1, 0)
    reset(network.tables, program, state)
    assert state.present == [1] * len(plan.entities)
    while state.clock[0] < 21.0:
        step(network.tables, program, state)
    assert state.present == [1, 1, 1, 0, 0, 0]


def test_the_log_says_what_was_done() -> None:
    plan, network, _ = prepared("values")
    recording = run(plan, open_world("kinematic", plan, network))
    told = [(event.kind, event.cause, event.message) for event in recording.events]
    assert ("command", "tock", "now") in told
    assert ("light", "fog", "on") in told
    assert ("light", "door", "to 1") in told
    assert ("signal", "main", "go") in told
    assert ("signal", "9", "off") in told


@pytest.mark.parametrize("name", SCENARIOS)
def test_both_forms_leave_the_same_bytes(name: str) -> None:
    _, network, program = prepared(name)
    rows, draws = [list(program.const)], [make_draws(1, 0)]
    both = run_both(network.tables, program, rows, draws, 700)
    assert both.interpreted == both.compiled


@pytest.mark.parametrize("kind", ["double", "integer", "boolean", "dateTime"])
def test_a_variable_without_a_value_begins_with_0(tmp_path: Path, kind: str) -> None:
    ego = '<ego speed="5"><start><lane road="1" lane="-1" s="20"/></start></ego>'
    done = compiled_text(
        tmp_path,
        f'<scenarios version="1"><scenario name="clock" map="town_grid" duration="1">{ego}'
        f'<variable name="one" type="{kind}"/></scenario></scenarios>',
    )
    program = build_program(done.plan, done.network)
    assert program.const[program.variable_const[0]] == 0.0
