"""Entities that are absent, and entities beside all roads."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.ego.sensor import look_ahead
from scenario_compiler.engine.motion.distances import road_distance_between
from tests.engine.make import CAR, Draft, highway


def test_absent_entities_do_not_move_collide_or_hide_others() -> None:
    draft = Draft(highway())
    draft.ego(speed=14.0)
    draft.parked(70.0)
    draft.moving(-1, 90.0, 2.0)
    run = draft.start()
    run.st.present[1] = 0
    look_ahead(run.n, run.p, run.st, 0, 100.0, 1.0)
    assert run.st.seen == [0, 0, 1]
    assert run.st.on_way == [0, 0, 1]
    run.st.present[2] = 0
    run.go(8.0)
    assert run.st.x[0] > 120.0
    assert run.st.x[2] == 90.0
    assert run.st.crashed == [0]
    assert run.time_of(op.EVENT_REQUEST) < 0.0


def test_without_an_ego_the_first_entity_is_the_one_that_collides() -> None:
    draft = Draft(highway())
    draft.moving(-1, 50.0, 10.0)
    draft.parked(80.0)
    run = draft.start().go(5.0)
    assert run.p.ego == [op.NONE]
    assert [kind for kind, _ in run.events()].count(op.EVENT_COLLISION) == 1
    assert run.time_of(op.EVENT_COLLISION) == pytest.approx(2.55)
    assert run.st.clock[0] == pytest.approx(5.0)


def test_beside_all_roads_an_entity_keeps_its_heading() -> None:
    draft = Draft(highway())
    draft.moving(-1, 50.0, 0.0)
    lost = draft.entity(op.MOTION_SCRIPTED, op.NONE, 3.0, follows=True, car=CAR)
    maneuver = draft.maneuver()
    draft.event(maneuver, draft.at_time(1.0), draft.lane_change(lost, 1, 2.0), draft.speed(lost, 6.0, 0.0))
    run = draft.start()
    run.st.h[lost] = 0.5 * math.pi
    run.go(2.0)
    assert (run.st.road[lost], run.st.flag[0]) == (-1, op.FAULT_NONE)
    assert run.st.x[lost] == pytest.approx(0.0)
    assert run.st.y[lost] == pytest.approx(1.0 * 3.0 + 1.0 * 6.0)
    assert road_distance_between(run.n, run.p, run.st, 0, lost, op.FRAME_ROAD, op.MEASURE_ALONG, 0) == pytest.approx(
        -50.0
    )


def test_a_program_without_entities_runs_to_its_end() -> None:
    run = Draft(highway()).start().go()
    assert (run.st.stop[0], run.st.flag[0]) == (op.STOP_DURATION, op.FAULT_NONE)
