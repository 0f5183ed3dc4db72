"""The conflict lies within the run, and the budget leaves room for the minimum-risk manoeuvre."""

from __future__ import annotations

import math

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
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


def obstacle_budget(plan: Plan) -> tuple[float, float] | None:
    """Return the time budget before an obstacle, s, and the desired speed, m/s; None where nobody asks for it."""
    cause = next((one for one in plan.takeover.causes if one.kind == "path_blocked"), None)
    if plan.controller is None or cause is None:
        return None
    values = parameter_values(plan.parameters)
    budget = plan.takeover.budget if cause.budget is None else cause.budget
    return number_value(budget, values), number_value(plan.ego.desired_speed, values)


def check_range(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn when the forward sensor's range is shorter than what is driven in the budget at the desired speed."""
    del network
    asked = obstacle_budget(plan)
    if asked is None:
        return
    budget, speed = asked
    reach = number_value(plan.forward_sensor.range, parameter_values(plan.parameters))
    if reach < budget * speed:
        message = (
            f"a budget of {budget:g} s at {speed:g} m/s is {budget * speed:.0f} m, but the forward sensor sees "
            f"{reach:g} m: the request comes {reach / speed:.1f} s before the limit"
        )
        sink.add(BLIND_BUDGET, message, plan.takeover.place_of("budget"))


def check_budget(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn when the car cannot stop within the budget at the speed that it aims for."""
    del network
    if plan.controller is None:
        return
    values = parameter_values(plan.parameters)
    takeover = plan.takeover
    speed = number_value(plan.ego.desired_speed, values)
    budget = number_value(takeover.budget, values)
    needed = speed / (2.0 * number_value(takeover.minimum_risk_deceleration, values))
    if budget < needed:
        message = f"a budget of {budget:g} s leaves no room to stop from {speed:g} m/s, which needs {needed:.2f} s"
        sink.add(SHORT_BUDGET, message, takeover.place_of("budget"))


def check_reach(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn when a scenario's only conflict is what stands on the road, and all of it is out of reach."""
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
    message = f"'{nearest}' is {away[nearest]:.0f} m away, but {speed * plan.duration:.0f} m are driven in the run"
    sink.add(OUT_OF_REACH, message, place_of(plan, f"entities/{nearest}"))
