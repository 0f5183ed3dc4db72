"""The parts of a plan that become properties of entities because the standard cannot express them."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.markup.writing import write_word
from scenario_compiler.openscenario.export.places import goal_of
from scenario_compiler.openscenario.spelling import made
from scenario_compiler.plan.model import Entity, Plan
from scenario_compiler.vocabulary.entities import Controller, Dynamic, Ego, Static, Vehicle
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.positions import FreePosition
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.word import Word

_NOWHERE = FreePosition(x=0.0, y=0.0)
_ATTRIBUTES_SAID = ("id", "model", "speed")
"""Attributes of entities that the standard can express."""

SAID = ("parameters", "variables", "signal_controllers", "storyboard")
"""Parts of a plan that the standard can express."""


def entity_kept(plan: Plan, entity: Entity) -> list[etree._Element]:
    """Return the element that keeps an entity's own kind; none for an entity that the standard expresses completely.

    The init expresses the speed of an entity with a start. That of another one, which an action adds, is kept.
    """
    later = entity.start is None
    if later and (entity.kind != "dynamic" or (entity.speed == 0.0 and entity.follow is None)):
        return []
    word: Word = Dynamic(
        id="id", speed=entity.speed, destination=goal_of(plan, entity), follow=entity.follow, path=entity.path
    )
    if entity.kind == "static":
        word = Static(id="id", at=_NOWHERE)
    elif entity.kind == "ego":
        word = Ego(
            desired_speed=entity.desired_speed or None,
            start=_NOWHERE,
            destination=plan.destination,
            camera=plan.camera,
            forward_sensor=plan.forward_sensor,
            odometry=plan.odometry,
            controller=plan.controller or Controller(),
        )
    element = write_word(word)
    for attribute in _ATTRIBUTES_SAID:
        if attribute in element.attrib and not (later and attribute == "speed"):
            del element.attrib[attribute]
    for child in element.findall("start") + element.findall("at"):
        element.remove(child)
    return [element]


def scenario_kept(plan: Plan, scenario: Scenario | None, groups: int) -> list[etree._Element]:
    """Return the element for parts of the whole plan; `groups` is the number of groups of its own stop trigger."""
    element = made("scenario", step=str(plan.step), control_every=str(plan.control_every), duration=str(plan.duration))
    element.set("stop_groups", str(groups))
    if plan.summary:
        element.set("summary", plan.summary)
    words: list[Word] = [] if scenario is None else [*scenario.traffic, *_vehicles_of_traffic(plan, scenario)]
    for rule in grammar_of(Scenario).children:
        if rule.field in Plan.model_fields and rule.field not in SAID:
            value = getattr(plan, rule.field)
            words += value if isinstance(value, tuple) else () if value is None else (value,)
    element.extend([write_word(word) for word in words])
    return [element]


def vehicles_kept(plan: Plan, scenario: Scenario | None) -> list[etree._Element]:
    """Return the element for the vehicles of actions on traffic, in a scenario without automated vehicle."""
    words = [] if scenario is None else _vehicles_of_traffic(plan, scenario)
    return [made("scenario", *(write_word(word) for word in words))] if words else []


def appears_by_action(entity: Entity) -> bool:
    """Return whether an action on traffic lets an entity appear."""
    return entity.kind == "traffic" and entity.start is None


def _vehicles_of_traffic(plan: Plan, scenario: Scenario) -> list[Vehicle]:
    if not scenario.traffic and not any(map(appears_by_action, plan.entities)):
        return []
    said = {one.vehicle.name for one in plan.entities if one.kind not in ("traffic", "walker")}
    return [one for one in scenario.vehicles if one.name not in said]
