"""Checks that every trigger can fire at the default parameters, before the run ends."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Severity
from scenario_compiler.expressions import Value
from scenario_compiler.plan.binding import is_bound
from scenario_compiler.plan.checks.ranges import beyond
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import EnvironmentAction
from scenario_compiler.vocabulary.conditions import (
    Condition,
    ElementStateCondition,
    EventCondition,
    ReachPositionCondition,
    SimulationTimeCondition,
    StandstillCondition,
    TakeoverStateCondition,
    TimeHeadwayCondition,
    TimeOfDayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.horizon import TOLERANCE
from scenario_compiler.vocabulary.positions import LanePositionWord
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.storyboard import Event, Trigger, TriggerCondition
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import number_value

NEVER_FIRES = Code(
    "SC401",
    "never-fires",
    "A condition can never be true at the parameters' values, so its actions never start: a distance or a time gap "
    "below 0, a speed that the vehicle cannot drive, a place that the ego vehicle cannot reach, a distance from an "
    "entity to itself, events that wait for each other. Or it never changes as its edge needs: a condition that is "
    "true from the start does not rise, and the time does not fall below a limit again.\n\n"
    '    <when><distance to="ego" below="0"/> <do>...</do></when>     a distance is never below 0\n'
    '    <Condition conditionEdge="rising" ...> ... <SimulationTimeCondition value="0" rule="greaterOrEqual"/>     '
    'write conditionEdge="none"\n\n'
    'Correct the number. If the condition can be true at other values of a parameter, write <allow code="SC401"/> at '
    "the start of the file.",
    Severity.WARNING,
)
AFTER_THE_END = Code(
    "SC402",
    "after-the-end",
    "An event or failure begins after the end of the run, so it never happens: an event whose time, or a sensor's "
    "failure whose onset, is not before the scenario's duration:\n\n"
    '    <scenario ... duration="30"> ... <when><time after="40"/> <do>...</do></when>\n\n'
    "Give the scenario a longer `duration`, or let it begin earlier.",
    Severity.WARNING,
)


AFTER_A_START = frozenset({"runningState", "completeState", "startTransition", "endTransition"})
"""States and transitions that an event reaches by starting."""


class Never(NamedTuple):
    """The reason why a condition is never true: the diagnostic's code, its text, and the attribute at fault."""

    code: Code
    reason: str
    attribute: str = ""


def check_triggers(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report events that never start."""
    values = parameter_values(plan.parameters)
    events = events_of(plan)
    faults = {
        (id(event), at): fault
        for event in events.values()
        for at, condition in enumerate(conditions_of(event.start))
        if (fault := never(condition, plan, network, values))
    }
    impossible = _impossible(events, faults)
    for path, event in events.items():
        if path in impossible:
            _report(path, event, impossible, faults, sink)


def events_of(plan: Plan) -> dict[str, Event]:
    """Return the storyboard's events by full name, in document order; the first of several with the same name."""
    found: dict[str, Event] = {}
    for story in plan.storyboard.stories:
        for act in story.acts:
            for group in act.groups:
                for maneuver in group.maneuvers:
                    for event in maneuver.events:
                        names = (story.name, act.name, group.name, maneuver.name, event.name)
                        found.setdefault("::".join(names), event)
    return found


def _impossible(events: Mapping[str, Event], faults: Mapping[tuple[int, int], Never]) -> set[str]:
    """Return the full names and last parts of names of the events that can never start.

    An event is checked again only when an event for which it waits turns out to be impossible, so that a chain of
    events takes linear time.
    """
    left = Counter(name for path in events for name in _names(path))
    waiting: dict[str, list[str]] = {}
    for path, event in events.items():
        for one in conditions_of(event.start):
            waiting.setdefault(_awaited(one.condition), []).append(path)
    never_happen: set[str] = set()
    open_paths = list(events)
    impossible: set[str] = set()
    while open_paths:
        path = open_paths.pop()
        if path in never_happen or _can_fire(path, events[path], impossible, faults):
            continue
        never_happen.add(path)
        for name in _names(path):
            left[name] -= 1
            if left[name] == 0:
                impossible.add(name)
                open_paths.extend(waiting.get(name, ()))
    return impossible


def _names(path: str) -> set[str]:
    """Return the names by which conditions refer to an event: the full one and its last part."""
    return {path, path.rpartition("::")[2]}


def _awaited(condition: Condition) -> str:
    """Return the name of the event for which a condition waits; empty for conditions of other kinds."""
    if isinstance(condition, ElementStateCondition):
        return condition.element if condition.kind == "event" else ""
    return condition.name if isinstance(condition, EventCondition) else ""


def conditions_of(trigger: Trigger | None) -> list[TriggerCondition]:
    """Return the conditions of all groups of a trigger."""
    return [] if trigger is None else [one for group in trigger.groups for one in group.conditions]


def _can_fire(path: str, event: Event, impossible: set[str], faults: Mapping[tuple[int, int], Never]) -> bool:
    """Return whether the event's trigger has a group in which no condition is known to be never true."""
    if event.start is None or not event.start.groups:
        return True
    at = 0
    for group in event.start.groups:
        numbered = list(enumerate(group.conditions, start=at))
        at += len(numbered)
        if all((id(event), k) not in faults and _waits_well(one.condition, path, impossible) for k, one in numbered):
            return True
    return False


def _waits_well(condition: Condition, path: str, impossible: set[str]) -> bool:
    """Return false if a condition waits for an event that can never start, or for the condition's own event.

    Another check reports events that do not exist.
    """
    if isinstance(condition, ElementStateCondition):
        starts = condition.kind == "event" and condition.state in AFTER_A_START
        return not starts or (condition.element not in impossible and condition.element != path)
    if not isinstance(condition, EventCondition):
        return True
    return condition.name not in impossible and condition.name != path.rpartition("::")[2]


def _report(
    path: str, event: Event, impossible: set[str], faults: Mapping[tuple[int, int], Never], sink: Diagnostics
) -> None:
    """Report each condition that keeps an event from starting, once."""
    for at, one in enumerate(conditions_of(event.start)):
        fault = faults.get((id(event), at))
        condition = one.condition
        if fault is None and not _waits_well(condition, path, impossible):
            attribute = "element" if isinstance(condition, ElementStateCondition) else "name"
            fault = Never(NEVER_FIRES, "the event that it waits for never happens", attribute)
        if fault is not None:
            place: Place = condition.place_of(fault.attribute) if fault.attribute else condition.origin
            sink.add(fault.code, f"'{event.name}' never happens: {fault.reason}", place)


def never(one: TriggerCondition, plan: Plan, network: Network, values: Mapping[str, Value]) -> Never | None:
    """Return why a condition never triggers before the run ends; None if it may.

    If one of several triggering entities is enough, it never triggers only if none of them can meet it.
    """
    if isinstance(one.condition, SimulationTimeCondition):
        return _never_at_a_time(one, one.condition, plan, values)
    each = [one.condition.model_copy(update={"entity": entity}) for entity in one.entities] or [one.condition]
    faults = [_never_true(condition, plan, network, values) for condition in each]
    if not one.every and None in faults:
        return None
    return next((fault for fault in faults if fault is not None), None)


def _never_at_a_time(
    one: TriggerCondition, condition: SimulationTimeCondition, plan: Plan, values: Mapping[str, Value]
) -> Never | None:
    """Return why a condition on the time never triggers before the run ends; None if it may."""
    limit = number_value(condition.after, values)
    missed = beyond(condition, plan, values)
    if missed is not None:
        return Never(NEVER_FIRES, *missed)
    if condition.rule == "equalTo" and abs(limit - round(limit / plan.step) * plan.step) > TOLERANCE:
        between = f"the run has steps of {plan.step:g} s, and {limit:g} s is between two of them"
        return Never(NEVER_FIRES, between, "after")
    begins = condition.rule.startswith("greater")
    begin = limit + number_value(one.delay, values)
    if begins and begin >= plan.duration:
        return Never(AFTER_THE_END, f"the run ends at {plan.duration:g} s, before {begin:g} s", "after")
    from_start = begins and (limit < 0.0 or (limit == 0.0 and condition.rule == "greaterOrEqual"))
    if from_start and one.edge != "none":
        return Never(NEVER_FIRES, "the condition is true from the start, so that it never becomes true", "after")
    if one.edge == "falling" and begins:
        return Never(NEVER_FIRES, "the time passes its limit once, so that the condition never becomes false", "after")
    if one.edge == "rising" and condition.rule.startswith("less"):
        return Never(NEVER_FIRES, "the time passes its limit once, so that the condition never becomes true", "after")
    return None


def _never_true(condition: Condition, plan: Plan, network: Network, values: Mapping[str, Value]) -> Never | None:
    """Return why a condition is never true before the run ends; None if it may be true.

    A quantity is compared with its range, a travelled distance with the greatest possible one, and a position with the
    straight distance from the start.
    """
    if isinstance(condition, TimeOfDayCondition) and not _sets_the_time_of_day(plan):
        return Never(NEVER_FIRES, "no environment action sets the time of day")
    if isinstance(condition, TakeoverStateCondition) and condition.state == "minimum_risk":
        without = "the vehicle has no minimum-risk manoeuvre"
        return None if plan.takeover.minimum_risk else Never(NEVER_FIRES, without, "is")
    between = TimeHeadwayCondition | TimeToCollisionCondition
    if isinstance(condition, between) and condition.to and condition.to == condition.entity:
        return Never(NEVER_FIRES, f"'{condition.to}' cannot be ahead of itself", "to")
    missed = beyond(condition, plan, values)
    if missed is not None:
        return Never(NEVER_FIRES, *missed)
    if isinstance(condition, StandstillCondition):
        begin = number_value(condition.duration, values)
        late = f"the run lasts {plan.duration:g} s, not {begin:g} s"
        return Never(AFTER_THE_END, late, "duration") if begin >= plan.duration else None
    if isinstance(condition, TraveledDistanceCondition):
        way, reach = number_value(condition.distance, values), _top_speed(plan, condition.entity) * plan.duration
        far = f"at most {reach:.0f} m are driven before the run ends"
        return Never(NEVER_FIRES, far, "distance") if way > reach else None
    return _never_so_far(condition, plan, network, values) if isinstance(condition, ReachPositionCondition) else None


def _sets_the_time_of_day(plan: Plan) -> bool:
    return any(isinstance(word, EnvironmentAction) and word.date_time for word in walk(plan.storyboard))


def _top_speed(plan: Plan, entity: str) -> float:
    return next((one.vehicle.max_speed for one in plan.entities if one.id == entity), math.inf)


def _never_so_far(
    condition: ReachPositionCondition, plan: Plan, network: Network, values: Mapping[str, Value]
) -> Never | None:
    """Return why the ego, if its start is known, cannot get near a position on a lane; None if it may."""
    start, goal = plan.derived.get(condition.entity), condition.position
    if (
        plan.controller is None
        or condition.entity != plan.ego.id
        or start is None
        or not isinstance(goal, LanePositionWord)
    ):
        return None
    s = number_value(goal.s, values)
    if not is_bound(network, goal, s):
        return None
    pose = network.lane_pose(goal.road, goal.lane, s, number_value(goal.offset, values))
    away = math.hypot(pose.x - start.x, pose.y - start.y) - number_value(condition.tolerance, values)
    reach = plan.ego.vehicle.max_speed * plan.duration
    reason = f"it is {away:.0f} m away, but at most {reach:.0f} m are driven before the run ends"
    return Never(NEVER_FIRES, reason) if away > reach else None
