"""Checks that actions on controllers and lights concern entities that have them, and that they can be executed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from scenario_compiler.diagnostics import Code, Diagnostics, Severity, did_you_mean
from scenario_compiler.plan.model import Entity, Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    AcquirePositionAction,
    ActivateControllerAction,
    AssignControllerAction,
    AssignRouteAction,
    FollowPathAction,
    FollowTrajectoryAction,
    LaneChangeAction,
    LaneChangeToAction,
    LaneOffsetAction,
    LateralDistanceAction,
    LimitedLaneOffsetAction,
    LongitudinalDistanceAction,
    OverrideControllerAction,
    RandomRouteAction,
    RelativeSpeedAction,
    SpeedAction,
    SpeedProfileAction,
    SynchronizeAction,
)
from scenario_compiler.vocabulary.entities import Controller

IDLE_CONTROLLER = Code(
    "SC282",
    "idle-controller",
    "A controller that is assigned to an entity, or switched, has no effect here: only the storyboard moves the "
    "entity. The only controllers that drive actors are those for car following (acc, alks). The ego vehicle keeps "
    "its own controller, which the takeover switches. A controller can be switched by its name only on an entity to "
    "which one of this name is assigned.\n\n"
    '    <assign_controller name="remote" model="external" longitudinal="true"/>',
    Severity.WARNING,
)
NO_PEDALS = Code(
    "SC283",
    "no-pedals",
    "An action holds a pedal, the steering wheel or the gear of an actor that the storyboard moves. The action is "
    "executed without effect: only the ego vehicle has pedals.\n\n"
    '    <dynamic id="lead">\n'
    '      <when><time after="3"/> <do><override_controller input="brake" active="true"/></do></when>',
    Severity.WARNING,
)
NOT_ASKED = Code(
    "SC506",
    "controller-not-asked",
    "The ego vehicle has a controller of your own, but runs with ideal perception. No images are rendered then, the "
    "automation keeps the lane from the map, and the controller is never called. Run it with the camera:\n\n"
    "    scenario-compiler run conflict.xml --controller our_lab:Steering --perception camera",
    Severity.WARNING,
)
STAYS_IN_LANE = Code(
    "SC530",
    "lane-change-without-effect",
    "With camera or surrogate perception, the automation of the ego vehicle follows the lane that it sees, whatever "
    "lane an action names; it changes lanes only where its lane ends. With ideal perception it follows the lane of the "
    "map, and changes to the lane that the action names.\n\n"
    '    <ego speed="20"> ... <when><time after="3"/><do><lane_change by="1" over_time="4"/></do></when></ego>',
    Severity.WARNING,
)
NOT_MOVED = Code(
    "SC531",
    "not-moved-by-actions",
    "An action gives the automated vehicle a path, a trajectory or a route, or moves a <static>. It is executed "
    "without effect: the automation follows its lane, and at junctions the route to its destination; a <static> "
    "stands still, although it can be teleported and deleted.\n\n"
    '    <ego> ... <do><acquire_position><lane road="3" lane="-1" s="90"/></acquire_position></do>\n'
    '    <ego> ... <destination><lane road="3" lane="-1" s="90"/></destination>',
    Severity.WARNING,
)
BAD_PROPERTY = Code(
    "SC284",
    "follow-property",
    "A property of a car-following controller is not a number of a plausible size: the time gap in seconds, the gap "
    "at a standstill in metres, the desired speed in m/s.\n\n"
    '    <assign_controller name="acc" model="acc"> <property name="timeGap" value="long"/> </assign_controller>',
)

DRIVING = ("acc", "alks", "default", "follow_route")
"""Controller models that drive an actor here, or that leave it to the storyboard as they should."""

ROUTING = AssignRouteAction | AcquirePositionAction | RandomRouteAction
STEERING = ROUTING | FollowPathAction | FollowTrajectoryAction
"""Actions that say where their actor drives; the automated vehicle decides this itself."""

MOVING = (
    STEERING
    | SpeedAction
    | RelativeSpeedAction
    | SpeedProfileAction
    | LongitudinalDistanceAction
    | LateralDistanceAction
    | LaneChangeAction
    | LaneChangeToAction
    | LaneOffsetAction
    | LimitedLaneOffsetAction
    | SynchronizeAction
)
"""Actions that only what moves can execute."""

FOLLOWING = ("acc", "alks")
LEAST = {"timeGap": 0.1, "time_gap": 0.1, "minimum_gap": 0.1, "setSpeed": 0.0, "speed": 0.0}
"""Properties that are used in car following, and the least value of each."""


def check_controllers(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report unused controllers, actions on controllers without effect, and properties that are not numbers.

    With ideal perception the automation drives without a controller; this is not reported if the scenario names none.
    """
    del network
    own = plan.controller
    if own is not None and plan.perception == "ideal" and own.model != Controller.model_construct().model:
        message = f"'{own.model}' is not called with ideal perception: the automation keeps the lane from the map"
        sink.add(NOT_ASKED, message, own.place_of("model"), hint="--perception camera runs it")
    keeps_lane = plan.perception != "ideal" and own is not None and own.model == Controller.model_construct().model
    entities = {entity.id: entity for entity in plan.entities}
    for actor, word in plan.storyboard.actions():
        entity = entities.get(actor)
        if isinstance(word, AssignControllerAction):
            _check_assigned(word, entity, sink)
        elif isinstance(word, ActivateControllerAction) and entity is not None:
            names = [one.name for one in _assigned(plan, actor)]
            _check_switched(word, entity, names, sink)
        elif isinstance(word, OverrideControllerAction) and word.active and entity is not None and entity.kind != "ego":
            sink.add(NO_PEDALS, f"'{actor}' has no {word.input.replace('_', ' ')} to hold", word.origin)
        elif isinstance(word, LaneChangeAction | LaneChangeToAction) and keeps_lane and entity and entity.kind == "ego":
            message = f"with {plan.perception} perception '{actor}' stays in the lane that it sees"
            sink.add(STAYS_IN_LANE, message, word.origin, hint="--perception ideal changes the lane")
        elif isinstance(word, STEERING) and entity is not None and entity.kind == "ego":
            message = f"'{actor}' is steered by its automation, so <{word.tag()}> has no effect"
            hint = "give it a <destination>" if isinstance(word, ROUTING) else ""
            sink.add(NOT_MOVED, message, word.origin, hint=hint)
        elif isinstance(word, MOVING) and entity is not None and entity.kind == "static":
            message = f"'{actor}' is a <static>, so <{word.tag()}> has no effect"
            sink.add(NOT_MOVED, message, word.origin, hint="a <dynamic> with the speed 0 can be moved")


def _assigned(plan: Plan, actor: str) -> Iterator[AssignControllerAction]:
    for who, word in plan.storyboard.actions():
        if who == actor and isinstance(word, AssignControllerAction):
            yield word


def _check_switched(word: ActivateControllerAction, entity: Entity, assigned: Sequence[str], sink: Diagnostics) -> None:
    if entity.kind == "ego":
        if word.longitudinal is False or word.lateral is False:
            message = f"the controller of '{entity.id}' is switched by the takeover, not by actions"
            sink.add(IDLE_CONTROLLER, message, word.origin)
    elif word.controller and word.controller not in assigned:
        message = f"no controller '{word.controller}' is assigned to '{entity.id}'"
        hint = did_you_mean(word.controller, assigned)
        sink.add(IDLE_CONTROLLER, message, word.place_of("controller"), hint=hint)


def _check_assigned(word: AssignControllerAction, entity: Entity | None, sink: Diagnostics) -> None:
    if entity is not None and entity.kind == "ego":
        if word.model != "default":
            sink.add(IDLE_CONTROLLER, f"'{entity.id}' keeps its own controller", word.place_of("model"))
        return
    if word.model not in DRIVING:
        name = "" if entity is None else f" of '{entity.id}'"
        sink.add(IDLE_CONTROLLER, f"the controller '{word.model}'{name} has no effect here", word.place_of("model"))
    if word.model not in FOLLOWING:
        return
    for one in word.properties:
        if one.name in LEAST and not _fits(one.value, LEAST[one.name]):
            message = f"'{one.value}' is not a valid {one.name}: it must be a number of at least {LEAST[one.name]:g}"
            sink.add(BAD_PROPERTY, message, one.place_of("value"))


def _fits(text: str, least: float) -> bool:
    try:
        return least <= float(text) < 1000.0
    except ValueError:
        return False
