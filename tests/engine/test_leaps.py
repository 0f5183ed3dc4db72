"""An entity that jumps onto a trajectory, in the init or at an event, covers no distance by it."""

from __future__ import annotations

import pytest

from scenario_compiler.engine.columns.opcodes import FAULT_NONE
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.vocabulary.actions import FollowTrajectoryAction, TeleportAction
from scenario_compiler.vocabulary.actions.motion import TrajectoryTiming
from scenario_compiler.vocabulary.positions import FreePosition, Polyline, Trajectory, Vertex
from scenario_compiler.vocabulary.storyboard import InitAction, Storyboard
from tests.engine.both import run_both
from tests.engine.make import highway
from tests.engine.test_positions import EGO, at_time, board, planned

SPEED = 10.0

FAR_AWAY = Trajectory(
    shape=Polyline(
        vertices=tuple(Vertex(time=t, position=FreePosition(x=300.0 + SPEED * t, y=900.0)) for t in (0.0, 20.0))
    )
)
"""A trajectory at the entity's speed, far from where it starts."""

TIMINGS = (None, TrajectoryTiming(domain="relative"), TrajectoryTiming(domain="absolute"))


def follow(timing: TrajectoryTiming | None, begin: float = 0.0) -> FollowTrajectoryAction:
    """Return the action of following the trajectory."""
    return FollowTrajectoryAction(timing=timing, trajectory=FAR_AWAY, begin=begin)


def states(storyboard: Storyboard, start: bool = True) -> list[tuple[float, float, float]]:
    """Return (x, distance covered, speed) of an entity for one second, row by row."""
    network = highway()
    plan, _ = planned(network, {"b": EGO if start else None}, storyboard, speed=SPEED)
    program = build_program(plan, network)
    state: State = new_state(program)
    state.draw[:] = make_draws(1)
    reset(network.tables, program, state)
    rows = [(state.x[0], state.odometer[0], state.v[0])]
    for _ in range(20):
        step(network.tables, program, state)
        rows.append((state.x[0], state.odometer[0], state.v[0]))
    assert state.flag[0] == FAULT_NONE
    return rows


@pytest.mark.parametrize("timing", TIMINGS)
@pytest.mark.parametrize("teleported", [False, True])
def test_the_init_puts_an_entity_on_its_trajectory(timing: TrajectoryTiming | None, teleported: bool) -> None:
    there = (InitAction(entity="b", action=TeleportAction(position=EGO)),) if teleported else ()
    rows = states(board(init=(*there, InitAction(entity="b", action=follow(timing)))), start=False)
    assert rows[0] == (300.0, 0.0, SPEED)
    assert rows[-1] == pytest.approx((310.0, SPEED, SPEED))


@pytest.mark.parametrize("timing", TIMINGS)
@pytest.mark.parametrize("begin", [0.0, 15.0])
def test_an_event_puts_an_entity_on_its_trajectory(timing: TrajectoryTiming | None, begin: float) -> None:
    rows = states(board(at_time(0.5, 0, follow(timing, begin))))
    assert [distance for _, distance, _ in rows] == pytest.approx([0.05 * SPEED * k for k in range(21)])
    assert [speed for _, _, speed in rows] == pytest.approx([SPEED] * 21)
    gone = 1.0 if timing is not None and timing.domain == "absolute" else 0.5
    assert rows[-1][0] == pytest.approx(300.0 + SPEED * gone + begin)


@pytest.mark.parametrize("timing", TIMINGS)
def test_both_forms_leave_the_same_bytes(timing: TrajectoryTiming | None) -> None:
    network = highway()
    plan, _ = planned(network, {"b": EGO}, board(at_time(0.5, 0, follow(timing, 15.0))), speed=SPEED)
    program = build_program(plan, network)
    both = run_both(network.tables, program, [list(program.const)], [make_draws(1)], 40)
    assert both.interpreted == both.compiled
