"""Restores a scenario that this program has exported, with the parts that OpenSCENARIO cannot express.

The elements of the file take precedence: a kept word replaces its element only if the element has not been changed.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from lxml import etree

from scenario_compiler.document import Document
from scenario_compiler.markup.environment import Environment, ReadingContext
from scenario_compiler.markup.reading import read_word
from scenario_compiler.markup.values import UnreadError, read_attribute
from scenario_compiler.openscenario.element_names import BETWEEN
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.own import OWN, fingerprint, gathered
from scenario_compiler.vocabulary.actions import AssignControllerAction, SpeedAction, TeleportAction
from scenario_compiler.vocabulary.entities import Dynamic, Ego, Static, Vehicle
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.positions import FreePosition, Position
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.storyboard import (
    Act,
    Do,
    Event,
    InitAction,
    Maneuver,
    ManeuverGroup,
    Story,
    Storyboard,
    Trigger,
    When,
)
from scenario_compiler.vocabulary.word import Number, Word

_ATTRIBUTES = ("step", "control_every", "duration", "summary")
"""Attributes of a scenario that are kept."""

_WORDS: Mapping[str, type[Word]] = {tag: word for rule in grammar_of(Do).children for tag, word in rule.words.items()}
_CONDITIONS: Mapping[str, type[Word]] = {
    tag: word for rule in grammar_of(When).children[:1] for tag, word in rule.words.items()
}


def restored(scenario: Scenario, root: Node) -> Scenario:
    """Return the scenario with what the properties of its own controllers keep; unchanged if there are none."""
    own = {
        init.entity: gathered(init.action.properties, root.reading.sink)
        for init in scenario.storyboard.init
        if isinstance(init.action, AssignControllerAction) and _is_own(init)
    }
    return _Restoration(scenario, own, root).scenario() if own else scenario


@dataclass
class _Kept:
    """A word that replaces an element, or None to remove it, if the element has not been changed."""

    word: Word | None
    entity: str
    instead_of: str | None
    triggering: dict[str, Any]

    def fits(self, word: Word) -> bool:
        return self.instead_of is None or self.instead_of == fingerprint(word)


class _Restoration:
    def __init__(self, scenario: Scenario, own: Mapping[str, etree._Element], root: Node) -> None:
        self.read = scenario
        self.own = own
        bindings = {
            name: one.value if one.expression is None else one.expression for name, one in root.scope.bound.items()
        }
        self.environment = Environment(bindings, root.scope.values)
        self.path = root.reading.document.path
        self.sink = root.reading.sink
        self.kept: dict[tuple[str, ...], _Kept] = {}
        for tree in own.values():
            for element in tree.findall("exact"):
                self._keep(element, self.reading(tree))

    def reading(self, tree: etree._Element) -> ReadingContext:
        return ReadingContext(Document(self.path, "", tree), self.sink, self.environment)

    def _keep(self, element: etree._Element, reading: ReadingContext) -> None:
        of = element.get("of", "")
        names = {"init": ("number",), "action": ("element",)}.get(of, ("element", "group", "condition"))
        key = (of, *(element.get(name, "") for name in names))
        word: Word | None = None
        known = _CONDITIONS if of in ("start", "stop") else _WORDS
        for child in element:
            if str(child.tag) in known:
                word = read_word(child, known[str(child.tag)], reading)
        triggering = tuple(one.get("entity", "") for one in element.findall("by"))
        more = {"entities": triggering, "every": element.get("every") == "true"} if triggering else {}
        self.kept[key] = _Kept(word, element.get("entity", ""), element.get("instead_of"), more)

    def scenario(self) -> Scenario:
        changes = self._of_scenario()
        storyboard = self._storyboard(changes.pop("stop_groups", None))
        init = list(storyboard.init)
        ego: Ego | None = None
        actors: list[Dynamic | Static] = []
        vehicles = {one.name: one for one in (*self.read.vehicles, *changes.pop("vehicles", ()))}
        for actor in self.read.actors:
            tree = self.own.get(actor.id)
            if tree is not None and isinstance(actor, Dynamic):
                self._restore_vehicle(vehicles, actor.model, tree)
                entity = self._entity(actor, tree, init)
                if isinstance(entity, Ego):
                    ego = entity
                    continue
                actor = entity
            actors.append(actor)
        return self.read.model_copy(
            update={
                **changes,
                "ego": ego,
                "actors": tuple(actors),
                "vehicles": tuple(vehicles.values()),
                "storyboard": storyboard.model_copy(update={"init": tuple(init)}),
            }
        )

    def _of_scenario(self) -> dict[str, Any]:
        """Return the kept fields of the scenario."""
        tree = next((one for one in self.own.values() if one.find("scenario") is not None), None)
        element = None if tree is None else tree.find("scenario")
        if tree is None or element is None:
            return {}
        reading = self.reading(tree)
        changes: dict[str, Any] = {}
        grammar = grammar_of(Scenario)
        for name in _ATTRIBUTES:
            if name in element.attrib:
                try:
                    text, origin = str(element.get(name)), reading.origin(element, name)
                    changes[name] = read_attribute(text, grammar.attributes[name], reading, origin)
                except UnreadError:
                    continue
        for rule in grammar.children:
            words = [read_word(one, rule.words[str(one.tag)], reading) for one in element if str(one.tag) in rule.words]
            found = tuple(one for one in words if one is not None)
            if found:
                changes[rule.field] = found if rule.many else found[0]
        groups = element.get("stop_groups", "")
        return {**changes, "stop_groups": int(groups)} if groups.isdecimal() and len(groups) < 6 else changes

    def _restore_vehicle(self, vehicles: dict[str, Vehicle], name: str, tree: etree._Element) -> None:
        """Restore the parts of a vehicle that its element cannot express."""
        element = tree.find("vehicle")
        if element is None or name not in vehicles:
            return
        reading = self.reading(tree)
        grammar = grammar_of(Vehicle)
        changes: dict[str, Any] = {}
        for attribute in map(str, element.attrib):
            if attribute in grammar.attributes:
                rule = grammar.attributes[attribute]
                try:
                    text, origin = str(element.get(attribute)), reading.origin(element, attribute)
                    changes[rule.field] = read_attribute(text, rule, reading, origin)
                except UnreadError:
                    continue
        vehicles[name] = vehicles[name].model_copy(update=changes)

    def _entity(self, actor: Dynamic, tree: etree._Element, init: list[InitAction]) -> Ego | Dynamic | Static:
        """Return an entity with its original kind, starting where the init's actions put it."""
        element = next((one for one in tree if str(one.tag) in ("ego", "static", "dynamic")), None)
        if element is None:
            return actor
        start, speed = _taken_start(actor.id, init)
        if element.tag == "static":
            at = start or FreePosition(x=0.0, y=0.0)
            return Static(id=actor.id, model=actor.model, at=at).written_at(actor.origin)
        said: dict[str, Any] = {"id": actor.id, "model": actor.model, "speed": speed}
        if element.tag == "dynamic":
            element.set("id", "actor")
            moving = read_word(element, Dynamic, self.reading(tree)) or actor
            if start is None:
                del said["speed"]
            return moving.model_copy(update={**said, "start": start}).written_at(actor.origin)
        place = etree.SubElement(element, "start")
        etree.SubElement(place, "free", x="0", y="0")
        element.insert(0, place)
        ego = read_word(element, Ego, self.reading(tree))
        said["start"] = start or FreePosition(x=0.0, y=0.0)
        return actor if ego is None else ego.model_copy(update=said).written_at(actor.origin)

    def _storyboard(self, groups: int | None) -> Storyboard:
        written = self.read.storyboard
        stop = None if written.stop is None else self._trigger(written.stop, "stop", "")
        if stop is not None and groups is not None:
            stop = stop.model_copy(update={"groups": stop.groups[:groups]}) if groups else None
        stories = tuple(self._story(one) for one in written.stories)
        return written.model_copy(update={"init": tuple(self._init(written.init)), "stories": stories, "stop": stop})

    def _init(self, written: Iterable[InitAction]) -> Iterable[InitAction]:
        for number, one in enumerate(one for one in written if not _is_own(one)):
            kept = self.kept.get(("init", str(number)))
            if kept is None or not kept.fits(one.action):
                yield one
            elif kept.word is not None:
                said = {"entity": kept.entity, "action": kept.word.written_at(one.action.origin)}
                yield one.model_copy(update=said).written_at(one.origin)

    def _story(self, story: Story) -> Story:
        acts = tuple(self._act(one, (story.name, one.name)) for one in story.acts)
        return story.model_copy(update={"acts": acts})

    def _act(self, act: Act, path: tuple[str, ...]) -> Act:
        name = BETWEEN.join(path)
        return act.model_copy(
            update={
                "start": None if act.start is None else self._trigger(act.start, "start", name),
                "stop": None if act.stop is None else self._trigger(act.stop, "stop", name),
                "groups": tuple(self._group(one, (*path, one.name)) for one in act.groups),
            }
        )

    def _group(self, group: ManeuverGroup, path: tuple[str, ...]) -> ManeuverGroup:
        return group.model_copy(
            update={"maneuvers": tuple(self._maneuver(one, (*path, one.name)) for one in group.maneuvers)}
        )

    def _maneuver(self, maneuver: Maneuver, path: tuple[str, ...]) -> Maneuver:
        events = tuple(self._event(one, (*path, one.name)) for one in maneuver.events)
        return maneuver.model_copy(update={"events": events})

    def _event(self, event: Event, path: tuple[str, ...]) -> Event:
        actions = []
        for one in event.actions:
            kept = self.kept.get(("action", BETWEEN.join((*path, one.name))))
            if kept is not None and kept.word is not None and kept.fits(one.action):
                one = one.model_copy(update={"action": kept.word.written_at(one.action.origin)})
            actions.append(one)
        start = None if event.start is None else self._trigger(event.start, "start", BETWEEN.join(path))
        return event.model_copy(update={"actions": tuple(actions), "start": start})

    def _trigger(self, trigger: Trigger, of: str, name: str) -> Trigger:
        groups = []
        for number, group in enumerate(trigger.groups, 1):
            conditions = []
            for place, one in enumerate(group.conditions, 1):
                kept = self.kept.get((of, name, str(number), str(place)))
                if kept is not None and kept.word is not None and kept.fits(one.condition):
                    said = {"condition": kept.word.written_at(one.condition.origin), **kept.triggering}
                    one = one.model_copy(update=said)
                conditions.append(one)
            groups.append(group.model_copy(update={"conditions": tuple(conditions)}))
        return trigger.model_copy(update={"groups": tuple(groups)})


def _is_own(init: InitAction) -> bool:
    return isinstance(init.action, AssignControllerAction) and init.action.name == OWN


def _taken_start(entity: str, init: list[InitAction]) -> tuple[Position | None, Number]:
    """Remove an entity's first teleport and first change of speed from the init; return its start and speed."""
    start: Position | None = None
    speed: Number = 0.0
    for kind in (TeleportAction, SpeedAction):
        found = next((one for one in init if one.entity == entity and isinstance(one.action, kind)), None)
        if found is None:
            continue
        init.remove(found)
        if isinstance(found.action, TeleportAction):
            start = found.action.position
        elif isinstance(found.action, SpeedAction):
            speed = found.action.to
    return start, speed
