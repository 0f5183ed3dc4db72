"""Triggers, priorities, executions and stops of the storyboard."""

from __future__ import annotations

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.motion.watching import WATCH_MOTION
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.story.of_run import FIRST_TRANSITION
from scenario_compiler.engine.story.table import NUMBERS as CONDITION
from tests.engine.make import Draft, Run, highway

DT = 0.05


def with_car() -> tuple[Draft, int]:
    """Return a draft with one scripted car at 20 m/s."""
    draft = Draft(highway(), {slots.K_DURATION: 10.0})
    return draft, draft.moving(-2, 100.0, 20.0)


def speeds(run: Run) -> dict[float, float]:
    """Return the first entity's speed by time."""
    found = {0.0: run.st.v[0]}
    while run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + DT)
        found[round(run.st.clock[0], 3)] = run.st.v[0]
    return found


def test_a_condition_true_at_a_time_shows_one_step_later() -> None:
    draft, car = with_car()
    draft.event(draft.maneuver(), draft.at_time(1.0), draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP))
    v = speeds(draft.start())
    assert (v[1.0], v[1.05]) == (20.0, 10.0)


def test_a_condition_true_at_0_acts_in_the_first_row() -> None:
    draft, car = with_car()
    draft.event(draft.maneuver(), draft.at_time(0.0), draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP))
    assert speeds(draft.start())[0.0] == 10.0


def test_an_event_without_trigger_starts_with_its_act() -> None:
    draft, car = with_car()
    draft.event(draft.maneuver(), op.NONE, draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP))
    assert speeds(draft.start())[0.0] == 10.0


def test_a_trigger_without_groups_never_fires() -> None:
    draft, car = with_car()
    draft.event(draft.maneuver(), draft.trigger(), draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP))
    assert set(speeds(draft.start()).values()) == {20.0}


def test_groups_are_alternatives_and_conditions_of_a_group_all_hold() -> None:
    draft, car = with_car()
    draft.condition(CONDITION["time"], 1.0)
    draft.condition(CONDITION["speed"], 100.0, entities=(car,))
    draft.close_group()
    draft.condition(CONDITION["time"], 2.0)
    draft.event(draft.maneuver(), draft.trigger(), draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP))
    v = speeds(draft.start())
    assert (v[1.5], v[2.0], v[2.05]) == (20.0, 20.0, 10.0)


@pytest.mark.parametrize(("limit", "last"), [(1, 1), (3, 3)])
def test_an_event_runs_as_often_as_its_maximum_allows(limit: int, last: int) -> None:
    draft, car = with_car()
    maneuver = draft.maneuver()
    event = draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 10.0, 1.0), limit=limit)
    run = draft.start().go(8.0)
    assert run.st.element_runs[event] == last
    assert run.st.element_state[event] == op.COMPLETE
    assert run.st.element_state[0] == op.COMPLETE


def test_a_stop_trigger_ends_its_act_and_what_runs_in_it() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver(stop=draft.at_time(2.0))
    draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 30.0, 5.0))
    run = draft.start().go(6.0)
    assert run.st.v[0] == pytest.approx(22.0)
    assert run.st.element_stopped[maneuver] > 0


def test_the_run_ends_on_its_stop_trigger_without_another_row() -> None:
    draft, _ = with_car()
    draft.program.stop_trigger[0] = draft.at_time(3.0)
    run = draft.start().go()
    assert run.st.stop[0] == op.STOP_TRIGGER
    assert run.st.clock[0] == pytest.approx(3.0)


def test_a_duration_ends_the_run_with_the_row_that_reaches_it() -> None:
    draft, _ = with_car()
    run = draft.start().go()
    assert run.st.stop[0] == op.STOP_DURATION
    assert run.st.clock[0] == pytest.approx(10.0)


def test_a_later_action_takes_over_the_domain_of_an_earlier_one() -> None:
    draft, car = with_car()
    first = draft.event(draft.maneuver(), draft.at_time(1.0), draft.speed(car, 30.0, 5.0))
    draft.event(draft.maneuver(), draft.at_time(3.0), draft.speed(car, 10.0, 5.0))
    run = draft.start().go(3.1)
    assert run.st.element_state[first] == op.COMPLETE
    assert run.st.v[0] < 24.1


def test_a_delay_keeps_pulses() -> None:
    draft, car = with_car()
    draft.event(
        draft.maneuver(),
        draft.at_time(1.0, edge=op.EDGE_RISING, delay=2.0),
        draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP),
    )
    v = speeds(draft.start())
    assert (v[3.0], v[3.05]) == (20.0, 10.0)


@pytest.mark.parametrize(
    ("kind", "value", "rule", "expected"),
    [
        (CONDITION["distance"], 30.0, op.RULE_LESS, 2.0),
        (CONDITION["time_gap"], 1.5, op.RULE_LESS, 2.0),
        (CONDITION["time_to_collision"], 3.0, op.RULE_LESS, 2.0),
    ],
)
def test_conditions_between_entities(kind: int, value: float, rule: int, expected: float) -> None:
    draft, car = with_car()
    draft.program.watches[0] = WATCH_MOTION
    lead = draft.moving(-2, 150.05, 10.0)
    draft.condition(kind, value, rule=rule, entities=(car,), other=lead)
    event = draft.event(draft.maneuver(), draft.trigger(), draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP))
    run = draft.start().go(9.0)
    assert run.st.element_started[event] // 2 * DT == pytest.approx(expected + DT, abs=DT + 1e-6)


def test_reached_and_traveled_and_any_or_all_entities() -> None:
    draft, car = with_car()
    other = draft.moving(-1, 100.0, 10.0)
    place = draft.position(0, -2, 140.0)
    draft.condition(CONDITION["reached"], 5.0, rule=op.RULE_LESS, entities=(car,), position=place)
    reached = draft.event(draft.maneuver(), draft.trigger(), draft.action(ACTION["sensor_noise"], car))
    draft.condition(CONDITION["traveled"], 40.0, entities=(car, other), every=True)
    both = draft.event(draft.maneuver(), draft.trigger(), draft.action(ACTION["sensor_noise"], car))
    draft.condition(CONDITION["traveled"], 40.0, entities=(car, other))
    either = draft.event(draft.maneuver(), draft.trigger(), draft.action(ACTION["sensor_noise"], car))
    run = draft.start().go(9.0)
    times = [run.st.element_started[event] // 2 * DT for event in (reached, both, either)]
    assert times == pytest.approx([1.8, 4.0, 2.0], abs=0.11)


def test_an_overflowing_delay_is_a_fault_not_a_wrong_result() -> None:
    draft, car = with_car()
    draft.program.const[slots.K_DURATION] = 60.0
    draft.condition(CONDITION["speed"], 20.0, rule=op.RULE_NOT_EQUAL, entities=(car,), delay=1000.0)
    draft.event(draft.maneuver(), draft.trigger(), draft.speed(car, 5.0, 0.0))
    run = draft.start()
    for k in range(600):
        if run.st.stop[0] != op.STOP_NONE:
            break
        run.st.v[0] = 20.0 + k % 2
        run.go(run.st.clock[0] + DT)
    assert run.st.flag[0] == op.FAULT_DELAY_OVERFLOW


def watching(draft: Draft, element: int, transition: int, owner: int) -> int:
    """Return a trigger on a transition of an element, for an event in the place of `owner`."""
    mode = FIRST_TRANSITION + transition
    draft.condition(CONDITION["element_state"], 0.0, other=element, mode=mode, owner=owner)
    return draft.trigger()


def started_at(run: Run, event: int) -> float:
    """Return when an event was started last, s."""
    return run.st.element_started[event] // 2 * DT


def test_a_start_is_seen_at_once_behind_it_and_in_the_next_frame_before_it() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver()
    watched = maneuver + 3
    trigger = watching(draft, watched, op.TRANSITION_START, maneuver + 1)
    before = draft.event(maneuver, trigger, draft.action(ACTION["command"], car))
    assert draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 10.0, 2.0)) == watched
    trigger = watching(draft, watched, op.TRANSITION_START, watched + 2)
    behind = draft.event(maneuver, trigger, draft.action(ACTION["command"], car), limit=5)
    run = draft.start().go(8.0)
    times = [started_at(run, event) for event in (before, watched, behind)]
    assert times == pytest.approx([times[1] + DT, times[1], times[1]])
    assert run.st.element_runs[behind] == 1


def test_an_end_is_seen_in_the_next_frame_wherever_it_is_watched() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver()
    watched = maneuver + 3
    trigger = watching(draft, watched, op.TRANSITION_END, maneuver + 1)
    before = draft.event(maneuver, trigger, draft.action(ACTION["command"], car))
    draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 10.0, 2.0))
    trigger = watching(draft, watched, op.TRANSITION_END, watched + 2)
    behind = draft.event(maneuver, trigger, draft.action(ACTION["command"], car))
    draft.program.stop_trigger[0] = watching(draft, watched, op.TRANSITION_END, op.NONE)
    run = draft.start().go()
    assert run.st.stop[0] == op.STOP_TRIGGER
    assert run.st.clock[0] == pytest.approx(3.0)
    assert (run.st.element_runs[before], run.st.element_runs[behind]) == (0, 0)


def test_a_skipped_event_is_seen_and_starts_when_its_sibling_is_done() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver()
    first = draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 10.0, 2.0))
    skipped = draft.event(maneuver, draft.at_time(2.0), draft.action(ACTION["command"], car), priority=op.PRIORITY_SKIP)
    other = draft.maneuver()
    trigger = watching(draft, skipped, op.TRANSITION_SKIP, other + 1)
    seen = draft.event(other, trigger, draft.action(ACTION["command"], car))
    run = draft.start().go(8.0)
    assert [started_at(run, event) for event in (first, skipped, seen)] == pytest.approx([1.05, 3.05, 2.05], abs=DT)
    assert run.st.element_runs[seen] == 1


def test_an_overridden_event_loses_its_executions() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver()
    long = draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 10.0, 6.0), limit=3)
    draft.event(maneuver, draft.at_time(2.0), draft.action(ACTION["command"], car), priority=op.PRIORITY_OVERRIDE)
    run = draft.start().go(8.0)
    assert (run.st.element_state[long], run.st.element_runs[long]) == (op.COMPLETE, 1)
    assert run.st.element_stopped[long] > 0
    assert run.st.element_ended[long] < 0
    assert run.st.element_state[0] == op.COMPLETE


def test_an_act_that_is_stopped_completes_its_story() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver(stop=draft.at_time(2.0))
    draft.event(maneuver, draft.at_time(1.0), draft.speed(car, 10.0, 6.0))
    run = draft.start().go(3.0)
    assert run.st.element_state[:6] == [op.COMPLETE] * 6
    assert run.st.element_ended[0] > 0


def test_ten_thousand_events_that_override_each_other_are_soon_done() -> None:
    draft, car = with_car()
    draft.program.const[slots.K_DURATION] = 1.0
    maneuver = draft.maneuver()
    trigger = draft.at_time(0.0)
    for _ in range(10_000):
        action = draft.speed(car, 10.0, 0.0, shape=op.SHAPE_STEP)
        draft.event(maneuver, trigger, action, priority=op.PRIORITY_OVERRIDE)
    run = draft.start().go()
    assert (run.st.stop[0], run.st.flag[0]) == (op.STOP_DURATION, op.FAULT_NONE)
    assert len(run.events()) > 10_000
    assert run.st.element_state[0] == op.COMPLETE


def test_events_that_start_each_other_go_on_once_a_frame() -> None:
    draft, car = with_car()
    maneuver = draft.maneuver()
    draft.condition(CONDITION["element_state"], 1.0 * op.STANDBY, rule=op.RULE_EQUAL, other=maneuver + 3)
    one = draft.event(maneuver, draft.trigger(), draft.action(ACTION["command"], car), limit=1_000_000)
    draft.condition(CONDITION["element_state"], 1.0 * op.STANDBY, rule=op.RULE_EQUAL, other=one)
    other = draft.event(maneuver, draft.trigger(), draft.action(ACTION["command"], car), limit=1_000_000)
    run = draft.start().go()
    assert (run.st.stop[0], run.st.flag[0]) == (op.STOP_DURATION, op.FAULT_NONE)
    assert max(run.st.element_runs[one], run.st.element_runs[other]) <= run.st.frame[0] + 1
