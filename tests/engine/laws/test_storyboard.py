"""The storyboard: priorities, repetitions, edges, delays, and the states that conditions wait for."""

from __future__ import annotations

from math import sqrt
from pathlib import Path

import pytest

from tests.engine.laws.told import (
    Actor,
    Event,
    after,
    by,
    condition,
    document,
    lane_change,
    lane_offset,
    of_entity,
    play,
    play_text,
    relative_speed,
    speed,
)

A = {"A": Actor()}
W = Actor(lane=2, s=1500.0, speed=1.0)
RAMP = speed(20.0, by("linear", "time", 4.0))
"""From 10 m/s to 20 m/s in 4 s: begun at 1 s it ends in the row of 5 s."""


def state(element: str, name: str, wanted: str, edge: str = "none", delay: float = 0.0) -> str:
    """Return the condition that an element of the storyboard has a state."""
    inner = (
        f'<StoryboardElementStateCondition storyboardElementType="{element}" storyboardElementRef="{name}" '
        f'state="{wanted}"/>'
    )
    return condition(inner, edge, delay)


@pytest.mark.law("Storyboard", "priority skip")
def test_an_event_that_is_skipped_starts_a_step_after_its_sibling_ends(tmp_path: Path) -> None:
    events = [
        Event("A", RAMP, name="ramp", maneuver="one"),
        Event("A", speed(3.0), 2.0, name="stop", maneuver="one", priority="skip"),
    ]
    run = play(tmp_path, A, events)
    assert (run.at("A", 4.0).v, run.at("A", 5.0).v, run.at("A", 5.05).v) == pytest.approx((17.5, 20.0, 3.0))


@pytest.mark.law("Storyboard", "priority overwrite")
def test_an_event_that_overwrites_ends_its_siblings_whatever_they_act_on(tmp_path: Path) -> None:
    change = lane_change('<AbsoluteTargetLane value="-2"/>', by("linear", "time", 2.0))
    events = [
        Event("A", RAMP, maneuver="one", name="ramp"),
        Event("A", change, 2.0, maneuver="one", name="change", priority="overwrite"),
    ]
    run = play(tmp_path, A, events)
    assert run.at("A", 6.0).v == pytest.approx(12.5)
    apart = [Event("A", RAMP), Event("A", change, 2.0, priority="overwrite")]
    assert play(tmp_path, A, apart).at("A", 6.0).v == pytest.approx(20.0)


@pytest.mark.law("Storyboard", "priority parallel")
def test_a_parallel_event_takes_over_the_domain_that_it_acts_on(tmp_path: Path) -> None:
    events = [
        Event("A", RAMP, maneuver="one", name="ramp"),
        Event("A", speed(4.0, by("linear", "time", 1.0)), 2.0, maneuver="one", name="stop"),
    ]
    run = play(tmp_path, A, events)
    assert [run.at("A", time).v for time in (2.0, 2.5, 3.0, 6.0)] == pytest.approx([12.5, 8.25, 4.0, 4.0])


def followed(timing: str) -> str:
    """Return that a straight line of 60 m in lane -1 is followed, whose times are 0 s and 4 s, at them or not."""
    vertices = "".join(
        f'<Vertex time="{time}"><Position><WorldPosition x="{x}" y="-1.75"/></Position></Vertex>'
        for time, x in ((0, 60), (4, 120))
    )
    return (
        '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="line" closed="false"><Shape><Polyline>'
        f"{vertices}</Polyline></Shape></Trajectory></TrajectoryRef><TimeReference>{timing}</TimeReference>"
        '<TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction>'
    )


TIMED = followed('<Timing domainAbsoluteRelative="relative" scale="1" offset="0"/>')
UNTIMED = followed("<None/>")


@pytest.mark.parametrize(("line", "wanted"), [(TIMED, [15.0, 15.0, 15.0]), (UNTIMED, [15.0, 17.5, 20.0])])
def test_a_trajectory_with_times_takes_over_the_speed(tmp_path: Path, line: str, wanted: list[float]) -> None:
    """A gains 2.5 m/s2 from 1 s to 5 s. From 3 s on it follows 60 m, by their times at 15 m/s until 7 s."""
    run = play(tmp_path, A, [Event("A", RAMP), Event("A", line, 3.0)])
    assert [run.at("A", time).v for time in (3.0, 4.0, 8.0)] == pytest.approx(wanted)


@pytest.mark.parametrize(("line", "wanted"), [(TIMED, 60.0 + 15.0 + 5.0), (UNTIMED, 60.0 + 10.0 + 5.0)])
def test_a_change_of_speed_ends_a_trajectory_with_times(tmp_path: Path, line: str, wanted: float) -> None:
    """It begins 1 s after the trajectory, and A then drives on at 5 m/s in its lane."""
    run = play(tmp_path, A, [Event("A", line), Event("A", speed(5.0), 2.0)])
    assert (run.at("A", 3.0).v, run.at("A", 3.0).x) == pytest.approx((5.0, wanted))


def test_a_trajectory_without_times_leaves_the_speed_to_other_actions(tmp_path: Path) -> None:
    """Its timing has no effect: 10 m at 10 m/s and 20 m at 20 m/s lie on the diagonal that it follows."""
    diagonal = TIMED.replace(' time="0"', "").replace(' time="4"', "").replace('x="120" y="-1.75"', 'x="120" y="58.25"')
    seen = play(tmp_path, A, [Event("A", diagonal), Event("A", speed(20.0), 2.0)]).at("A", 3.0)
    assert (seen.x, seen.y) == pytest.approx((60.0 + 30.0 * sqrt(0.5), -1.75 + 30.0 * sqrt(0.5)))


def test_the_init_may_give_a_speed_beside_a_trajectory_with_times(tmp_path: Path) -> None:
    """All actions of the init make one state: none of them ends another one on other domains."""
    run = play(tmp_path, {"A": Actor(action=TIMED, speed=3.0)}, [])
    assert [run.at("A", time).x for time in (1.0, 4.0)] == pytest.approx([75.0, 120.0])


@pytest.mark.law("StoryboardElementStateCondition", "stopTransition")
@pytest.mark.parametrize("transition", ["stopTransition", "endTransition"])
def test_an_action_that_another_one_replaces_is_stopped_and_at_its_end(tmp_path: Path, transition: str) -> None:
    events = [
        Event("A", RAMP, name="ramp"),
        Event("A", speed(5.0), 2.0),
        Event("W", speed(3.0), state("action", "of ramp", transition)),
    ]
    assert play(tmp_path, {**A, "W": W}, events).acts("W", 3.0) == pytest.approx(2.05)


@pytest.mark.law("Storyboard", "an event executed again")
@pytest.mark.parametrize(("count", "wanted"), [(1, 12.0), (2, 14.0), (3, 16.0)])
def test_an_event_is_executed_as_often_as_its_maximum_allows(tmp_path: Path, count: int, wanted: float) -> None:
    """Each execution of 1 s adds 2 m/s to A's own speed."""
    more = relative_speed("A", 2.0, by("linear", "time", 1.0))
    run = play(tmp_path, A, [Event("A", more, count=count)])
    assert run.at("A", 9.0).v == pytest.approx(wanted)


@pytest.mark.law("Storyboard", "an event executed again")
@pytest.mark.law("Storyboard", "delay")
def test_an_execution_does_not_depend_on_earlier_delays(tmp_path: Path) -> None:
    """The first execution is begun after the delay of 1 s, at 1 s; it ends in the row of 2 s.

    From the next frame, at 2 s, the delay counts again: the second is begun at 3 s.
    """
    events = [
        Event("A", speed(20.0, by("linear", "time", 1.0)), after(0.0, delay=1.0), count=2, maneuver="one", name="up"),
        Event("W", speed(3.0), state("event", "up", "startTransition") + after(1.5)),
    ]
    run = play(tmp_path, {**A, "W": W}, events)
    assert run.acts("A", 20.0) == pytest.approx(2.0)
    assert run.acts("W", 3.0) == pytest.approx(3.05)


@pytest.mark.law("StoryboardElementStateCondition", "skipTransition")
def test_a_skipped_event_is_seen(tmp_path: Path) -> None:
    events = [
        Event("A", RAMP, name="ramp", maneuver="one"),
        Event("A", speed(5.0), 2.0, name="stop", maneuver="one", priority="skip"),
        Event("W", speed(3.0), state("event", "stop", "skipTransition")),
    ]
    assert play(tmp_path, {**A, "W": W}, events).acts("W", 3.0) == pytest.approx(2.05)


@pytest.mark.law("StoryboardElementStateCondition", "stopTransition")
def test_an_overwritten_event_is_stopped(tmp_path: Path) -> None:
    events = [
        Event("A", RAMP, name="ramp", maneuver="one"),
        Event("A", speed(5.0), 2.0, name="stop", maneuver="one", priority="overwrite"),
        Event("W", speed(3.0), state("event", "ramp", "stopTransition")),
    ]
    assert play(tmp_path, {**A, "W": W}, events).acts("W", 3.0) == pytest.approx(2.05)


@pytest.mark.law("StoryboardElementStateCondition", "standbyState")
def test_an_event_waits_in_standby(tmp_path: Path) -> None:
    waiting = state("event", "ramp", "standbyState")
    events = [Event("A", RAMP, name="ramp"), Event("W", speed(3.0), waiting)]
    assert play(tmp_path, {**A, "W": W}, events).acts("W", 3.0) == pytest.approx(0.0)


@pytest.mark.law("LaneOffsetAction", "continuous")
@pytest.mark.parametrize(("continuous", "wanted"), [("false", 3.35), ("true", None)])
def test_a_continuous_offset_never_ends_by_itself(tmp_path: Path, continuous: str, wanted: float | None) -> None:
    """0.5 m within 0.5 m/s2 take pi sqrt(0.5) s = 2.22 s; it begins one step late, so it ends in the row of 3.3 s."""
    move = lane_offset('<AbsoluteTargetLaneOffset value="0.5"/>', "sinusoidal", 0.5, continuous)
    done = state("event", "aside", "completeState")
    run = play(tmp_path, {**A, "W": W}, [Event("A", move, name="aside"), Event("W", speed(3.0), done)])
    assert run.acts("W", 3.0) == (None if wanted is None else pytest.approx(wanted))


@pytest.mark.law("Storyboard", "edge rising")
@pytest.mark.law("Storyboard", "edge falling")
@pytest.mark.law("Storyboard", "edge risingOrFalling")
@pytest.mark.parametrize(("edge", "wanted"), [("rising", 2.05), ("falling", 4.05), ("risingOrFalling", 2.05)])
def test_an_edge_is_a_change_between_two_evaluations(tmp_path: Path, edge: str, wanted: float) -> None:
    """A gains 2.5 m/s2 from 1 s on, so it is over 12.4 m/s in the row of 2 s.

    At 4 s it steps down, which the condition behind it in the file sees in the same frame.
    """
    over = of_entity("A", '<SpeedCondition value="12.4" rule="greaterThan"/>', edge=edge)
    events = [Event("A", RAMP), Event("A", speed(5.0), 4.0), Event("W", speed(3.0), over)]
    assert play(tmp_path, {**A, "W": W}, events).acts("W", 3.0) == pytest.approx(wanted)


def test_an_edge_needs_an_evaluation_before(tmp_path: Path) -> None:
    true_from_the_start = of_entity("A", '<SpeedCondition value="9" rule="greaterThan"/>', edge="rising")
    assert play(tmp_path, {**A, "W": W}, [Event("W", speed(3.0), true_from_the_start)]).acts("W", 3.0) is None


@pytest.mark.law("Storyboard", "delay")
def test_a_delay_shifts_the_record_of_the_edge(tmp_path: Path) -> None:
    pulse = of_entity("A", '<SpeedCondition value="12.4" rule="greaterThan"/>', edge="rising", delay=1.5)
    run = play(tmp_path, {**A, "W": W}, [Event("A", RAMP), Event("W", speed(3.0), pulse)])
    assert run.acts("W", 3.0) == pytest.approx(3.55)


@pytest.mark.law("Storyboard", "several groups")
@pytest.mark.law("Storyboard", "several conditions in a group")
def test_groups_are_alternatives_of_conditions_that_all_hold(tmp_path: Path) -> None:
    first = f"<ConditionGroup>{after(1.0)}{after(5.0)}</ConditionGroup>"
    second = f"<ConditionGroup>{after(3.0)}</ConditionGroup>"
    run = play(tmp_path, {"W": W}, [Event("W", speed(3.0), first + second)])
    assert run.acts("W", 3.0) == pytest.approx(3.05)


@pytest.mark.law("AnimationAction", "used")
@pytest.mark.parametrize(
    ("duration", "loop", "wanted"), [(2.0, "false", 3.05), (0.5, "false", 1.55), (0.5, "true", None)]
)
def test_an_animation_ends_after_its_duration_unless_it_is_repeated(
    tmp_path: Path, duration: float, loop: str, wanted: float | None
) -> None:
    """It begins at 1 s and ends in the row a duration later; the next frame sees that."""
    door = (
        f'<AppearanceAction><AnimationAction animationDuration="{duration}" loop="{loop}"><AnimationType>'
        '<ComponentAnimation><VehicleComponent vehicleComponentType="doorFrontRight"/></ComponentAnimation>'
        '</AnimationType><AnimationState state="1"/></AnimationAction></AppearanceAction>'
    )
    done = state("event", "door", "completeState")
    run = play(tmp_path, {**A, "W": W}, [Event("A", door, name="door"), Event("W", speed(3.0), done)])
    assert run.acts("W", 3.0) == (None if wanted is None else pytest.approx(wanted))


def actors_of(event: Event) -> str:
    """Return the <Actors> of an event: its actor, or the triggering entities if it names none."""
    if not event.actor:
        return '<Actors selectTriggeringEntities="true"/>'
    return f'<Actors selectTriggeringEntities="false"><EntityRef entityRef="{event.actor}"/></Actors>'


def acts_of(*acts: str, **actors: Actor) -> str:
    """Return the file of told.py with other acts in its story."""
    text = document({**A, **actors, "W": W}, [], 8.0)
    start, end = text.index('<Act name="act">'), text.index("</Story>")
    return text[:start] + "".join(acts) + text[end:]


def act(name: str, event: Event, start: str = "", stop: str = "") -> str:
    """Return an act of one event; its start and stop are conditions."""
    triggers = "".join(
        f"<{tag}><ConditionGroup>{inner}</ConditionGroup></{tag}>"
        for tag, inner in (("StartTrigger", start), ("StopTrigger", stop))
        if inner
    )
    return (
        f'<Act name="{name}"><ManeuverGroup name="g" maximumExecutionCount="1">{actors_of(event)}<Maneuver name="m">'
        f"{event.text()}</Maneuver></ManeuverGroup>{triggers}</Act>"
    )


@pytest.mark.parametrize("element", ["act", "event"])
def test_a_stop_trigger_stops_what_is_in_standby(tmp_path: Path, element: str) -> None:
    """At 2 s the act waits for its start at 4 s, or runs while its event waits; neither ever starts."""
    start = after(4.0) if element == "act" else ""
    later = act("waits", Event("A", speed(20.0), 5.0), start, after(2.0))
    name = "waits" if element == "act" else "event"
    seen = act("watches", Event("W", speed(3.0), state(element, name, "stopTransition"), name="witness"))
    run = play_text(tmp_path, acts_of(later, seen), 8.0)
    assert run.acts("A", 20.0) is None
    assert run.acts("W", 3.0) == pytest.approx(2.05)


@pytest.mark.parametrize(("more", "wanted"), [(False, 1.05), (True, 5.05)])
def test_a_group_without_maneuvers_is_complete_as_soon_as_it_runs(tmp_path: Path, more: bool, wanted: float) -> None:
    """With a ramp of 4 s in another group, the act is complete after that."""
    nobody = '<Actors selectTriggeringEntities="false"/>'
    empty = f'<ManeuverGroup name="empty" maximumExecutionCount="2">{nobody}</ManeuverGroup>'
    ramped = act("one", Event("A", RAMP, 0.0), after(1.0))
    only = f'<Act name="one">{empty}<StartTrigger><ConditionGroup>{after(1.0)}</ConditionGroup></StartTrigger></Act>'
    one = ramped.replace('<Act name="one">', f'<Act name="one">{empty}') if more else only
    seen = act("watches", Event("W", speed(3.0), state("act", "one", "completeState"), name="witness"))
    found = play_text(tmp_path, acts_of(one, seen), 8.0).acts("W", 3.0)
    assert found == pytest.approx(wanted + (0.0 if more else 0.05))


def test_an_event_of_an_act_that_never_ran_is_not_stopped(tmp_path: Path) -> None:
    later = act("waits", Event("A", speed(20.0), 5.0), after(4.0), after(2.0))
    seen = act("watches", Event("W", speed(3.0), state("event", "event", "stopTransition"), name="witness"))
    assert play_text(tmp_path, acts_of(later, seen), 8.0).acts("W", 3.0) is None


@pytest.mark.law("Storyboard", "triggering entities as actors")
def test_the_entities_that_trigger_an_act_are_its_actors(tmp_path: Path) -> None:
    """B is over 11 m/s from 2 s on; A, which the act's trigger does not name, goes on."""
    over = of_entity("B", '<SpeedCondition value="11" rule="greaterOrEqual"/>')
    faster = act("faster", Event("B", speed(20.0, by("linear", "rate", 1.0))))
    slower = act("slower", Event("", speed(3.0), 0.0), over)
    run = play_text(tmp_path, acts_of(faster, slower, B=Actor(lane=-2)), 8.0)
    assert run.acts("B", 3.0) == pytest.approx(2.05)
    assert run.acts("A", 3.0) is None
