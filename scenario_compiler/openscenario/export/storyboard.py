"""The storyboard: each word as the standard's element, and also as properties if it would be read differently."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document
from scenario_compiler.expressions import parse_expression
from scenario_compiler.markup.writing import write_word
from scenario_compiler.openscenario.actions import read_actions, write_action
from scenario_compiler.openscenario.conditions import is_by_entity, read_condition, write_condition
from scenario_compiler.openscenario.element_names import BETWEEN
from scenario_compiler.openscenario.node import FileContext, Known, Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.own import fingerprint, of_nobody, veiled
from scenario_compiler.openscenario.scope import Bound, Scope
from scenario_compiler.openscenario.spelling import made, nested
from scenario_compiler.openscenario.storyboard import ACTIONS
from scenario_compiler.vocabulary.conditions import SimulationTimeCondition
from scenario_compiler.vocabulary.storyboard import (
    Act,
    ConditionGroup,
    Event,
    Maneuver,
    ManeuverGroup,
    Story,
    Storyboard,
    Trigger,
    TriggerCondition,
)
from scenario_compiler.vocabulary.word import Word

_BEGIN = TriggerCondition(name="at once", condition=SimulationTimeCondition(after=0.0))

ALWAYS = Trigger(groups=(ConditionGroup(conditions=(_BEGIN,)),))
"""A trigger that fires at once, for versions that require a trigger."""

_NEVER = SimulationTimeCondition(after=-1.0, rule="lessThan")


@dataclass
class StoryboardWriter:
    """Writes a storyboard and collects the words that must be kept verbatim.

    Attributes:
        output: The context for writing words.
        entities: Ids of all entities.
        kept: The <exact> elements, filled while writing.
        init: Actions of the init: entity, element, number of words that are read from it, and the element to keep.
    """

    output: Output
    entities: Sequence[str]
    kept: list[etree._Element] = field(default_factory=list)
    init: list[tuple[str, etree._Element, int, etree._Element | None]] = field(default_factory=list)

    def stories(self, storyboard: Storyboard) -> list[etree._Element]:
        """Return the <Story> elements; an empty one if there is none and the version requires one."""
        found = [self._story(one) for one in storyboard.stories]
        written = [one for one in found if len(one)]
        return written if written or self.output.version > (1, 1) else [_empty_story()]

    def add_init(self, word: Word, entity: str = "", *, said: Word | None = None, for_others: bool = False) -> None:
        """Add an action to the init.

        Args:
            word: The action.
            entity: The acting entity; empty for actions on the run as a whole.
            said: The word that is written in its place.
            for_others: Whether it is only meant for other programs, and is removed when the file is read back.
        """
        output = self.output.by(entity)
        element = write_action(said or word, output)
        element = _command(word) if element is None else element
        read = self._read(element, output)
        keep: etree._Element | None = None
        if for_others or read != [word]:
            keep = made("exact", of="init", entity=entity)
            self._keep(keep, None if for_others else word, read[0] if len(read) == 1 else None)
        self.init.append((entity, element, len(read), keep))

    def init_actions(self) -> list[etree._Element]:
        """Return the children of <Actions>: actions without an entity first, as the schema requires, then others."""
        order = {"GlobalAction": 0, "UserDefinedAction": 1}
        found: list[etree._Element] = []
        number = 0
        for entity, one, words, keep in sorted(self.init, key=lambda item: order.get(str(item[1].tag), 2)):
            if keep is not None:
                keep.set("number", str(number))
            number += words
            if str(one.tag) in order:
                found.append(one)
                continue
            if not found or found[-1].get("entityRef") != entity:
                found.append(made("Private", entityRef=entity))
            found[-1].append(one)
        return found

    def trigger(self, trigger: Trigger, tag: str, of: str, element: str) -> etree._Element:
        """Return the element of a trigger; `of` and `element` identify it in the properties that keep exact numbers."""
        groups = trigger.groups or (ConditionGroup(conditions=(TriggerCondition(condition=_NEVER),)),)
        return made(tag, *(self._group(one, of, element, number) for number, one in enumerate(groups, 1)))

    def _group(self, group: ConditionGroup, of: str, element: str, number: int) -> etree._Element:
        written = made("ConditionGroup")
        for place, one in enumerate(group.conditions, 1):
            keep = made("exact", of=of, element=element, group=str(number), condition=str(place))
            written.append(self._condition(one, f"{number}.{place}", keep))
        return written

    def _condition(self, one: TriggerCondition, name: str, keep: etree._Element) -> etree._Element:
        inner = write_condition(one.condition, self.output)
        if inner is None:
            inner = made("UserDefinedValueCondition", name=one.condition.tag(), rule="equalTo", value="true")
            keep.extend([made("by", entity=name) for name in one.entities])
            keep.set("every", "true" if one.every else "false")
        self._compare(inner, one.condition, keep, self.output)
        delay = self.output.text(one.delay, one)
        return made(
            "Condition",
            self._around(one, inner),
            name=one.name or name,
            delay=delay,
            conditionEdge=one.edge,
        )

    def _around(self, one: TriggerCondition, inner: etree._Element) -> etree._Element:
        if not is_by_entity(one.condition) or inner.tag == "UserDefinedValueCondition":
            return made("ByValueCondition", inner)
        own = str(getattr(one.condition, "entity", ""))
        names = one.entities or ((own,) if own else ())
        entities = [made("EntityRef", entityRef=name) for name in names]
        triggering = made("TriggeringEntities", *entities, triggeringEntitiesRule="all" if one.every else "any")
        return made("ByEntityCondition", triggering, made("EntityCondition", inner))

    def _story(self, story: Story) -> etree._Element:
        acts = [self._act(one, (story.name, one.name)) for one in story.acts]
        return made("Story", *(one for one in acts if one.tag and len(one.findall("ManeuverGroup"))), name=story.name)

    def _act(self, act: Act, path: Sequence[str]) -> etree._Element:
        element = made("Act", *(self._maneuvers(one, (*path, one.name)) for one in act.groups), name=act.name)
        place = BETWEEN.join(path)
        start = act.start
        if start is None and self.output.version < (1, 3):
            start = ALWAYS
        if start is not None:
            element.append(self.trigger(start, "StartTrigger", "start", place))
        if act.stop is not None:
            element.append(self.trigger(act.stop, "StopTrigger", "stop", place))
        return element

    def _maneuvers(self, group: ManeuverGroup, path: Sequence[str]) -> etree._Element:
        actors = made("Actors", *(made("EntityRef", entityRef=one) for one in group.actors))
        actors.set("selectTriggeringEntities", "false")
        output = self.output.by(group.actors[0] if len(group.actors) == 1 else "")
        maneuvers = [self._maneuver(one, (*path, one.name), output) for one in group.maneuvers]
        return made(
            "ManeuverGroup",
            actors,
            *(one for one in maneuvers if len(one)),
            name=group.name,
            maximumExecutionCount=str(group.maximum_execution_count),
        )

    def _maneuver(self, maneuver: Maneuver, path: Sequence[str], output: Output) -> etree._Element:
        events = (self._event(one, (*path, one.name), output) for one in maneuver.events if one.actions)
        return made("Maneuver", *events, name=maneuver.name)

    def _event(self, event: Event, path: Sequence[str], output: Output) -> etree._Element:
        priority = event.priority
        named = "overwrite" if priority == "override" and output.version < (1, 2) else priority
        element = made("Event", name=event.name, priority=named)
        element.set("maximumExecutionCount", str(event.maximum_execution_count))
        for one in event.actions:
            written = write_action(one.action, output)
            written = _command(one.action) if written is None else written
            keep = made("exact", of="action", element=BETWEEN.join((*path, one.name)))
            self._compare(written, one.action, keep, output)
            element.append(made("Action", written, name=one.name))
        start = event.start
        if start is None and output.version == (1, 0):
            start = ALWAYS
        if start is not None:
            element.append(self.trigger(start, "StartTrigger", "start", BETWEEN.join(path)))
        return element

    def _compare(self, element: etree._Element, word: Word, keep: etree._Element, output: Output) -> None:
        """Keep a word that its element does not express exactly."""
        read = self._read(element, output)
        same = len(read) == 1 and read[0] == of_nobody(word)
        if not same:
            self._keep(keep, word, read[0] if len(read) == 1 else None)

    def _keep(self, keep: etree._Element, word: Word | None, instead_of: Word | None) -> None:
        if instead_of is not None:
            keep.set("instead_of", fingerprint(instead_of))
        if word is not None:
            keep.append(write_word(word))
        self.kept.append(keep)

    def _read(self, element: etree._Element, output: Output) -> list[Word]:
        text = etree.tostring(element)
        document = Document("", "", etree.fromstring(text))
        known = Known(entities={name: "vehicle" for name in self.entities})
        bound = {
            name: Bound("double", str(value), parse_expression(f"${name}")) for name, value in output.values.items()
        }
        reading = FileContext(document, Diagnostics(), output.version, known)
        node = Node(document.root, reading, Scope(bound, dict(output.values)))
        if node.tag in ACTIONS:
            return list(read_actions(node))
        found = read_condition(node)
        return [] if found is None else [found]


def _command(word: Word) -> etree._Element:
    """Return the element for an action that the standard cannot express; its text is only informative."""
    command = made("CustomCommandAction", type=word.tag())
    command.text = veiled(fingerprint(word))
    return nested(["UserDefinedAction"], command)


def _empty_story() -> etree._Element:
    group = made("ManeuverGroup", made("Actors", selectTriggeringEntities="false"), name="nobody")
    group.set("maximumExecutionCount", "1")
    return made("Story", made("Act", group, made("StartTrigger"), name="nothing"), name="nothing")
