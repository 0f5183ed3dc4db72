"""Converts actions between OpenSCENARIO's elements and words, with one module for each family."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import did_you_mean
from scenario_compiler.markup import codes
from scenario_compiler.openscenario.actions.appearance import APPEARANCE
from scenario_compiler.openscenario.actions.control import CONTROL, read_overrides
from scenario_compiler.openscenario.actions.environment import ENVIRONMENT, read_environment
from scenario_compiler.openscenario.actions.lateral import LATERAL
from scenario_compiler.openscenario.actions.longitudinal import LONGITUDINAL
from scenario_compiler.openscenario.actions.routing import ROUTING
from scenario_compiler.openscenario.actions.traffic import NO_MEANING_IN_TRAFFIC, TRAFFIC
from scenario_compiler.openscenario.actions.world import WORLD, read_entity_actions
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import Forms, nested
from scenario_compiler.vocabulary.actions import Action
from scenario_compiler.vocabulary.word import Word

ACTIONS = Forms((*LONGITUDINAL, *LATERAL, *ROUTING, *CONTROL, *APPEARANCE, *WORLD, *TRAFFIC, *ENVIRONMENT))
"""The actions that OpenSCENARIO can express."""

UNSAID = {
    "lane_offset": "OpenSCENARIO limits the lateral acceleration, not the duration",
    "follow_path": "OpenSCENARIO's trajectories start at a fixed position, not at the entity",
    "sensor_noise": "OpenSCENARIO has no sensor failures",
    "failure": "OpenSCENARIO has no sensor failures",
    "end_failure": "OpenSCENARIO has no sensor failures",
    "message": "OpenSCENARIO has no messages to the driver",
    **dict.fromkeys(("request", "warn", "hand_back"), "OpenSCENARIO has no takeover"),
    "stop": "OpenSCENARIO ends a run only by a stop trigger",
}
"""Tags of the actions that OpenSCENARIO cannot express, with the reasons."""

_GROUPS = (
    "PrivateAction",
    "GlobalAction",
    "UserDefinedAction",
    "LongitudinalAction",
    "LateralAction",
    "RoutingAction",
    "AppearanceAction",
    "TrailerAction",
    "ControllerAction",
    "InfrastructureAction",
    "TrafficSignalAction",
    "TrafficAction",
)
"""Elements that contain actions."""

_AREA = "TrafficAreaAction"


def read_actions(node: Node) -> list[Action]:
    """Return the actions of a <PrivateAction>, <GlobalAction> or <UserDefinedAction>; report another element."""
    if node.tag in _GROUPS:
        inner = node.elements()
        if not inner:
            node.report(codes.MISSING_ELEMENT, f"<{node.tag}> contains no action")
        return [action for one in inner for action in read_actions(one)]
    if node.tag == "EnvironmentAction":
        return list(read_environment(node))
    if node.tag == "OverrideControllerValueAction":
        return list(read_overrides(node))
    if node.tag == "EntityAction":
        return list(read_entity_actions(node))
    form = ACTIONS.by_tag.get(node.tag)
    if form is None:
        _report_unread(node)
        return []
    action: Action | None = form.read(node)
    return [] if action is None else [action]


def _report_unread(node: Node) -> None:
    node.read_whole()
    if node.tag == _AREA:
        node.report(NO_MEANING_IN_TRAFFIC, f"<{node.tag}> has no effect here")
        return
    known = [*ACTIONS.by_tag, *_GROUPS, _AREA]
    node.report(codes.UNKNOWN_ELEMENT, f"<{node.tag}> is not an action", hint=did_you_mean(node.tag, known))


def write_action(word: Word, output: Output) -> etree._Element | None:
    """Return the <PrivateAction>, <GlobalAction> or <UserDefinedAction> of an action; report it if there is none."""
    form = ACTIONS.by_word.get(type(word))
    if form is None or output.version < form.since:
        why = UNSAID.get(word.tag(), "") if form is None else f"earlier versions have no <{form.tag}>"
        before = "" if form is None else f" before {output.dotted(form.since)}"
        output.tell_lost(word, f"the action <{word.tag()}> cannot be written{before}: {why}")
        return None
    around = form.around
    if form.tag == "ActivateControllerAction" and output.version > (1, 0):
        around = ("PrivateAction", "ControllerAction")
    return nested(around, form.write(word, output))
