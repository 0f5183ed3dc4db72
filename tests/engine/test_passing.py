"""Passing in the lane of oncoming traffic: the prediction, and that no oncoming vehicle is met."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import State, make_draws
from scenario_compiler.engine.ego.passing import MEETING_TIME
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.engine.story.step import watch_standstill
from tests.engine.both import run_both
from tests.engine.make import CAR, Draft, Run, highway, lane, network_of, road

RURAL = (lane(-1, "solid"),)
BLOCK = 260.0
GAPS = [120.0 + 23.0 * k for k in range(16)]
"""From the block to the oncoming vehicle at the start, m."""


def blocked_road(
    speed: float, answer: float, oncoming: list[tuple[float, float]], *, turn: float = 0.0, duration: float = 45.0
) -> Draft:
    """Return a draft of a road with a lane each way: a block 210 m ahead, and (s, speed) of what comes towards it."""
    numbers = {slots.K_DRIVER_TIME: answer, slots.K_DURATION: duration, slots.K_BUDGET: 6.0}
    draft = Draft(network_of(road(1, 3000.0, *RURAL, left=lane(1, "solid"))), numbers)
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=speed)
    draft.parked(BLOCK, offset=-1.4 if turn else 0.0, turn=turn)
    for s, v in oncoming:
        draft.moving(1, s, v)
    return draft


def passed(state: State) -> bool:
    """Return whether the ego is past the block."""
    return state.x[0] > BLOCK + 10.0


def driven(draft: Draft, seed: int = 1) -> tuple[State, float]:
    """Run a draft; return how it ended, and the least time to collision to what came into the ego's way, s."""
    run = Simulation(draft.network.tables, draft.done())
    run.reset(make_draws(seed))
    least = math.inf
    while run.step():
        st = run.state
        for j in range(2, draft.program.entity_count[0]):
            apart = st.x[j] - st.x[0] - (CAR[0] if st.x[j] > st.x[0] else 0.0)
            if apart > 0.0 and abs(st.y[j] - st.y[0]) < CAR[1]:
                least = min(least, apart / (st.v[0] + st.v[j]))
    return run.state, least


@pytest.mark.parametrize("turn", [0.0, math.pi / 2], ids=["along", "across"])
@pytest.mark.parametrize("towards", [8.0, 14.0, 22.0])
@pytest.mark.parametrize("speed", [10.0, 14.0, 20.0])
def test_the_driver_meets_no_oncoming_vehicle_while_passing_a_block(speed: float, towards: float, turn: float) -> None:
    for k, gap in enumerate(GAPS):
        answer = (0.6, 1.8, 3.0, 4.2)[k % 4]
        state, least = driven(blocked_road(speed, answer, [(BLOCK + gap, towards)], turn=turn), seed=k + 1)
        assert state.crashed[0] == 0, gap
        assert passed(state), gap
        assert least >= MEETING_TIME - 0.4, gap


@pytest.mark.parametrize("between", [40.0, 90.0, 160.0])
def test_a_row_of_oncoming_vehicles_is_let_by_or_a_gap_is_taken_that_is_long_enough(between: float) -> None:
    for gap in GAPS[::3]:
        row = [(BLOCK + gap + between * k, 13.0) for k in range(4)]
        state, least = driven(blocked_road(14.0, 2.0, row, duration=80.0))
        assert state.crashed[0] == 0, gap
        assert passed(state), gap
        assert least >= MEETING_TIME - 0.4, gap


def test_without_oncoming_traffic_the_block_is_passed_without_a_stop() -> None:
    run = blocked_road(14.0, 1.0, []).start()
    least = 14.0
    while run.st.stop[0] == op.STOP_NONE and run.st.x[0] < BLOCK + 20.0:
        run.go(run.st.clock[0] + 0.05)
        least = min(least, run.st.v[0])
    assert run.st.x[0] > BLOCK
    assert least > 10.0


def test_the_speed_of_oncoming_traffic_matters_and_not_only_the_egos() -> None:
    started = []
    for towards in (6.0, 9.0, 12.0, 15.0, 18.0):
        run = blocked_road(14.0, 1.0, [(BLOCK + 270.0, towards)]).start().go(30.0)
        started.append(run.time_of(op.EVENT_EVADE))
    assert started[0] == started[1] == started[2] < 11.0
    assert started[3] > started[4] > 13.0


def test_a_lane_of_the_same_direction_is_taken_before_that_of_oncoming_traffic() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0})
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=14.0)
    draft.parked(250.0, turn=math.pi / 2)
    run = draft.start()
    lanes = set()
    while run.st.stop[0] == op.STOP_NONE and run.st.x[0] < 300.0:
        run.go(run.st.clock[0] + 0.05)
        lanes.add(run.st.lane[0])
    assert lanes == {-1, -2}


@pytest.mark.parametrize("towards", [10.0, 20.0])
@pytest.mark.parametrize("gap", [120.0, 180.0, 240.0])
def test_a_slow_vehicle_is_not_evaded_into_oncoming_traffic(gap: float, towards: float) -> None:
    draft = Draft(network_of(road(1, 3000.0, *RURAL, left=lane(1, "solid"))), {slots.K_DRIVER_TIME: 0.0})
    draft.ego(speed=22.0)
    leader = draft.moving(-1, 100.0, 22.0)
    draft.moving(1, 100.0 + 5.0 * 22.0 + gap, towards)
    draft.event(draft.maneuver(), draft.at_time(1.0), draft.run_action(ACTION["request"], op.CAUSE_SCHEDULED))
    draft.event(draft.maneuver(), draft.at_time(3.0), draft.speed(leader, 3.0, 1.0))
    state, _ = driven(draft)
    assert state.takeover_state[0] == op.TAKEOVER_MANUAL
    assert state.crashed[0] == 0


def test_both_forms_pass_alike() -> None:
    for gap in (150.0, 260.0, 390.0):
        draft = blocked_road(14.0, 2.0, [(BLOCK + gap, 12.0), (BLOCK + gap + 110.0, 16.0)])
        program = draft.done()
        found = run_both(draft.network.tables, program, [program.const], [make_draws(3)], 900)
        assert found.interpreted == found.compiled
        assert found.state.time_response[0] > 0.0


@pytest.mark.parametrize("seed", range(1, 9))
def test_a_stop_by_hand_is_logged_once(seed: int) -> None:
    run = blocked_road(14.0, 2.0, [(BLOCK + 100.0 + 60.0 * k, 12.0) for k in range(5)], duration=60.0).start(seed)
    stops: list[float] = []
    fastest = 0.0
    while run.st.stop[0] == op.STOP_NONE:
        before = len([kind for kind, _ in run.events() if kind == op.EVENT_STANDSTILL])
        run.go(run.st.clock[0] + 0.05)
        fastest = max(fastest, run.st.v[0])
        if len([kind for kind, _ in run.events() if kind == op.EVENT_STANDSTILL]) > before:
            assert not stops or fastest > 0.5
            stops.append(run.st.clock[0])
            fastest = 0.0
    assert len(stops) >= 1
    assert run.st.crashed[0] == 0


def test_creeping_on_after_a_stop_is_not_a_second_stop() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 0.0, slots.K_NOISE: 60.0})
    draft.ego(speed=3.0)
    run: Run = draft.start().go(2.0)
    assert run.st.takeover_state[0] == op.TAKEOVER_MANUAL
    for speed in (0.0, 0.06, 0.0, 0.3, 0.0, 0.8, 0.0):
        run.st.v[0] = speed
        run.st.target_speed[0] = 0.0
        watch_standstill(run.n, run.p, run.st)
    assert [kind for kind, _ in run.events()].count(op.EVENT_STANDSTILL) == 2
