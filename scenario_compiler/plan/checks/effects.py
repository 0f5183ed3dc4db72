"""Checks that actions and attributes have an effect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    ActivateControllerAction,
    AtRate,
    ConnectTrailerAction,
    DisconnectTrailerAction,
    EnvironmentAction,
    FollowPathAction,
    FollowTrajectoryAction,
    LaneChangeAction,
    LaneChangeToAction,
    LaneOffsetAction,
    LateralDistanceAction,
    LimitedLaneOffsetAction,
    LongitudinalDistanceAction,
    OverrideControllerAction,
    RelativeSpeedAction,
    SpeedAction,
    SpeedProfileAction,
    SynchronizeAction,
    TrafficSwarmAction,
)
from scenario_compiler.vocabulary.horizon import TOLERANCE
from scenario_compiler.vocabulary.positions import Clothoid, ClothoidSpline, FreePosition, Polyline, Trajectory
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.takeover import Automation
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import number_value

WITHOUT_EFFECT = Code(
    "SC295",
    "without-effect",
    "An action or an attribute has no effect: an <activate_controller> or an <environment> that changes nothing, the "
    "`deceleration` of an automation that does not slow down, a pedal beyond its limit or a speed "
    "above the greatest one of the vehicle (`maxSpeed`), which acts as the limit, a "
    "<timing> of a trajectory without times, a start beyond the end of a trajectory, which acts as its end, a rate of "
    "0, which acts as a step, a swarm whose `inner_radius` "
    "contains its whole ellipse, so that no vehicle appears, one whose directions both have the weight 0, or an action "
    "that would move a trailer which is towed in the whole scenario.\n\n"
    '    <automation after="follow" deceleration="2"/>     only after="slow_down" uses it\n'
    '    <override_controller input="throttle" active="true" value="5"/>     acts as 1, full throttle',
    Severity.WARNING,
)

SHARES = ("throttle", "brake", "clutch", "parking_brake")
"""Inputs with values from 0 to 1."""

CHANGES = (SpeedAction, RelativeSpeedAction, LaneChangeAction, LaneChangeToAction)
"""Actions whose change may be given by its rate."""

DRIVING = (
    SpeedAction, RelativeSpeedAction, SpeedProfileAction, LongitudinalDistanceAction, SynchronizeAction,
    LaneChangeAction, LaneChangeToAction, LaneOffsetAction, LimitedLaneOffsetAction, LateralDistanceAction,
    FollowTrajectoryAction, FollowPathAction,
)  # fmt: skip
"""Actions that say how an entity drives, which a trailer does not while it is towed."""

SWITCHES = ("longitudinal", "lateral", "lighting", "animation")


def check_effects(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of actions and attributes without effect."""
    del network
    values = parameter_values(plan.parameters)
    _check_automation(plan.takeover.automation, sink)
    _check_speeds(plan, values, sink)
    _check_towed(plan, sink)
    for word in walk(plan.storyboard):
        if isinstance(word, ActivateControllerAction):
            if all(getattr(word, name) is None for name in SWITCHES):
                message = "<activate_controller> switches nothing"
                sink.add(WITHOUT_EFFECT, message, word.origin, hint=f"give it one of {', '.join(SWITCHES)}")
        elif isinstance(word, EnvironmentAction):
            if not word.date_time and word.friction is None:
                message = "<environment> sets neither the time of day nor the friction"
                sink.add(WITHOUT_EFFECT, message, word.origin, hint="give it a `date_time` or a `friction`")
        elif isinstance(word, OverrideControllerAction):
            _check_input(word, values, sink)
        elif isinstance(word, TrafficSwarmAction):
            _check_swarm(word, values, sink)
        elif isinstance(word, FollowTrajectoryAction):
            _check_timing(word, sink)
            _check_begin(word, values, sink)
        elif isinstance(word, CHANGES):
            _check_rate(word, values, sink)


def _check_speeds(plan: Plan, values: Mapping[str, Value], sink: Diagnostics) -> None:
    fastest = {one.id: one.vehicle.max_speed for one in plan.entities}
    for actor, action in plan.storyboard.actions():
        if isinstance(action, SpeedAction) and actor in fastest:
            speed = number_value(action.to, values)
            if abs(speed) > fastest[actor] + TOLERANCE:
                message = f"'{actor}' drives at most {fastest[actor]:g} m/s: {speed:g} m/s acts as that"
                sink.add(WITHOUT_EFFECT, message, action.place_of("to"))


def _check_towed(plan: Plan, sink: Diagnostics) -> None:
    """Warn of actions that would move a trailer that is connected in the init and stays so."""
    acting = list(plan.storyboard.story_actions())
    if any(isinstance(action, (ConnectTrailerAction, DisconnectTrailerAction)) for _, action in acting):
        return
    init = plan.storyboard.init
    towing = {one.action.trailer: one.entity for one in init if isinstance(one.action, ConnectTrailerAction)}
    for actor, action in acting:
        if actor in towing and isinstance(action, DRIVING):
            message = f"<{action.tag()}> does not move '{actor}', which '{towing[actor]}' tows in the whole scenario"
            sink.add(WITHOUT_EFFECT, message, action.origin)


def _check_automation(automation: Automation, sink: Diagnostics) -> None:
    varies = "$" in (automation.written("after") or "")
    if automation.after != "slow_down" and not varies and automation.written("deceleration") is not None:
        message = f"the automation does not slow down after a request: its behaviour is {automation.after}"
        sink.add(WITHOUT_EFFECT, message, automation.place_of("deceleration"), hint='only after="slow_down" uses it')


def _check_timing(word: FollowTrajectoryAction, sink: Diagnostics) -> None:
    if word.timing is not None and all(time is None for _, time in word.trajectory.times):
        message = "the trajectory has no times, so the entity follows it at its own speed"
        sink.add(WITHOUT_EFFECT, message, word.timing.origin, hint="give the trajectory times, or leave the timing out")


def _check_begin(word: FollowTrajectoryAction, values: Mapping[str, Value], sink: Diagnostics) -> None:
    length = _length_of(word.trajectory, values)
    begin = number_value(word.begin, values)
    if length is not None and begin > length + TOLERANCE:
        message = f"the trajectory is {length:g} m long: a start after {begin:g} m acts as its end"
        sink.add(WITHOUT_EFFECT, message, word.place_of("begin"))


def _length_of(trajectory: Trajectory, values: Mapping[str, Value]) -> float | None:
    """Return the length of a trajectory, m; None of a closed one, and if only a run knows it."""
    shape = trajectory.shape
    if trajectory.closed:
        return None
    if isinstance(shape, Clothoid):
        return number_value(shape.length, values)
    if isinstance(shape, ClothoidSpline):
        return sum(number_value(one.length, values) for one in shape.segments)
    if not isinstance(shape, Polyline):
        return None
    places = [one.position for one in shape.vertices if isinstance(one.position, FreePosition)]
    if len(places) < len(shape.vertices):
        return None
    points = [(number_value(one.x, values), number_value(one.y, values)) for one in places]
    return sum(math.dist(one, other) for one, other in pairwise(points))


def _check_rate(
    word: SpeedAction | RelativeSpeedAction | LaneChangeAction | LaneChangeToAction,
    values: Mapping[str, Value],
    sink: Diagnostics,
) -> None:
    dynamics = word.dynamics
    if isinstance(dynamics, AtRate) and word.shape != "step" and number_value(dynamics.value, values) == 0.0:
        message = "a rate of 0 acts as a step: the change is made at once"
        sink.add(WITHOUT_EFFECT, message, dynamics.place_of("value"))


def _check_input(word: OverrideControllerAction, values: Mapping[str, Value], sink: Diagnostics) -> None:
    value = number_value(word.value, values)
    if word.active and word.input in SHARES and not 0.0 <= value <= 1.0:
        name = word.input.replace("_", " ")
        message = f"the {name} lies between 0 and 1: {value:g} acts as {0 if value < 0.0 else 1}"
        sink.add(WITHOUT_EFFECT, message, word.place_of("value"))


def _check_swarm(word: TrafficSwarmAction, values: Mapping[str, Value], sink: Diagnostics) -> None:
    inner, along, across, ahead = (
        number_value(one, values) for one in (word.inner_radius, word.semi_major, word.semi_minor, word.offset)
    )
    farthest = farthest_in_ellipse(along, across, abs(ahead))
    if word.vehicles > 0 and inner > farthest:
        message = (
            f"no vehicle of the swarm appears: its ellipse reaches {farthest:.4g} m from '{word.entity}', and the "
            f"`inner_radius` is {inner:g} m"
        )
        sink.add(WITHOUT_EFFECT, message, word.place_of("inner_radius"))
    if word.same <= 0.0 and word.opposite <= 0.0:
        message = f"no direction of travel has a weight above 0: all vehicles come towards '{word.entity}'"
        sink.add(WITHOUT_EFFECT, message, word.place_of("same"))


def farthest_in_ellipse(along: float, across: float, ahead: float) -> float:
    """Return the greatest distance of a point of an ellipse from a point on its first axis, m.

    With the ellipse's points (ahead + along cos u, across sin u), the distance is greatest at cos u = along ahead /
    (across^2 - along^2), or at the end of the first axis if that is not below 1.

    Args:
        along: First semi-axis, m.
        across: Second semi-axis, m.
        ahead: Distance of its centre from the point, m, at least 0.
    """
    wider = across * across - along * along
    cosine = along * ahead / wider if wider > along * ahead else 1.0
    return math.hypot(ahead + along * cosine, across * math.sqrt(1.0 - cosine * cosine))
