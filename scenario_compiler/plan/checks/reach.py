"""Checks that the conflict can occur within the run, and that the budget suffices for the minimum-risk manoeuvre."""

from __future__ import annotations

import math
from typing import NamedTuple

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import number_value

OUT_OF_REACH = Code(
    "SC403",
    "out-of-reach",
    "The ego vehicle does not reach any obstacle before the run ends, and nothing else happens in the scenario, so "
    "there is no conflict:\n\n"
    '    <scenario ... duration="10"> <ego speed="10">...</ego>\n'
    '      <static id="wreck"><at><ahead_of entity="ego" distance="400"/></at></static>     the ego drives 100 m\n\n'
    "Give the scenario a longer `duration`, or put the obstacle nearer.",
    Severity.WARNING,
)
SHORT_BUDGET = Code(
    "SC505",
    "short-budget",
    "The time budget is too short for the minimum-risk manoeuvre. The automation requests a takeover `budget` seconds "
    "before a limit ahead, at the distance budget x v; braking with the deceleration d takes v^2 / (2 d). So the "
    "budget must be at least v / (2 d), or the car cannot stop before the limit even if it brakes at once:\n\n"
    '    <ego speed="30" ...>  <takeover budget="3" minimum_risk_deceleration="4"/>     30 / (2 * 4) = 3.75 s\n\n'
    "Give a longer `budget`, a greater `minimum_risk_deceleration`, or a lower speed.",
    Severity.WARNING,
)
BLIND_BUDGET = Code(
    "SC508",
    "blind-budget",
    "The forward sensor does not see as far as the car drives in the time budget, so the request for a limit ahead "
    "comes later than the budget: as soon as the sensor detects the limit. The range must be at least budget x v:\n\n"
    '    <ego speed="33.3" ...> <takeover budget="7"> ...     7 * 33.3 = 233 m, but a range of 150 m\n\n'
    'Give `<forward_sensor range="..."/>` of <ego> a longer range, or the takeover a shorter `budget`, or the car a '
    "lower speed.",
    Severity.WARNING,
)


class ObstacleBudget(NamedTuple):
    """The time budget before an obstacle.

    Attributes:
        time: Time budget, s.
        speed: The ego's desired speed, m/s.
        place: Place in the file where the budget is written.
    """

    time: float
    speed: float
    place: Place


def obstacle_budget(plan: Plan) -> ObstacleBudget | None:
    """Return the budget before an obstacle; None if obstacles do not cause a takeover request."""
    cause = next((one for one in plan.takeover.causes if one.kind == "path_blocked"), None)
    if plan.controller is None or cause is None:
        return None
    values = parameter_values(plan.parameters)
    speed = number_value(plan.ego.desired_speed, values)
    if cause.budget is None:
        return ObstacleBudget(number_value(plan.takeover.budget, values), speed, plan.takeover.place_of("budget"))
    return ObstacleBudget(number_value(cause.budget, values), speed, cause.place_of("budget"))


def check_range(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn if the forward sensor's range is shorter than the distance driven in the budget at the desired speed."""
    del network
    asked = obstacle_budget(plan)
    if asked is None:
        return
    reach = number_value(plan.forward_sensor.range, parameter_values(plan.parameters))
    if reach < asked.time * asked.speed:
        message = (
            f"a budget of {asked.time:g} s at {asked.speed:g} m/s is {asked.time * asked.speed:.0f} m, but the forward "
            f"sensor sees {reach:g} m in clear air: the request comes at most {reach / asked.speed:.1f} s before the "
            "limit"
        )
        sink.add(BLIND_BUDGET, message, asked.place)


def check_budget(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn if a minimum-risk manoeuvre cannot stop the ego within the budget before an obstacle."""
    del network
    takeover = plan.takeover
    asked = obstacle_budget(plan)
    if asked is None or not takeover.minimum_risk or takeover.automation.after == "let_go":
        return
    deceleration = number_value(takeover.minimum_risk_deceleration, parameter_values(plan.parameters))
    needed = asked.speed / (2.0 * deceleration)
    if asked.time < needed:
        message = (
            f"a budget of {asked.time:g} s leaves no room to stop from {asked.speed:g} m/s, which needs {needed:.2f} s"
        )
        sink.add(SHORT_BUDGET, message, asked.place)


def check_reach(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn if a scenario's only conflict is with objects on the road and all of these are out of reach."""
    del network
    if plan.controller is None:
        return
    others = plan.entities[1:]
    something_else = any((plan.storyboard.stories, plan.markings, plan.secondary_markings, plan.camera.failures))
    start = plan.derived.get(plan.ego.id)
    if something_else or start is None or not others or any(one.kind != "static" for one in others):
        return
    values = parameter_values(plan.parameters)
    speed = max(number_value(plan.ego.speed, values), number_value(plan.ego.desired_speed, values))
    placed = [(one, plan.derived[one.id]) for one in others if one.id in plan.derived]
    away = {one.id: math.hypot(pose.x - start.x, pose.y - start.y) - one.vehicle.length for one, pose in placed}
    if len(away) < len(others) or min(away.values()) <= speed * plan.duration:
        return
    nearest = min(away, key=lambda name: away[name])
    message = f"'{nearest}' is {away[nearest]:.0f} m away, but {speed * plan.duration:.0f} m are driven during the run"
    sink.add(OUT_OF_REACH, message, place_of(plan, f"entities/{nearest}"))
