"""The draft of a program: columns under construction, numbers that are still expressions, and rows that are appended.

What a row holds is decided by the tables of words (`positions`, `actions`, `conditions`); here it gets its place.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from scenario_compiler.engine import slots
from scenario_compiler.engine.opcodes import (
    DIMENSION_TIME,
    NONE,
    PRIORITY_PARALLEL,
    RULE_LESS,
    SHAPE_STEP,
)
from scenario_compiler.engine.tables import Program
from scenario_compiler.expressions import Expression, Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads.network import Network
from scenario_compiler.vocabulary.variables import Variable
from scenario_compiler.vocabulary.word import Word, number_value

Slot = float | Expression
"""A number of a plan."""


@dataclass(frozen=True, slots=True)
class PositionRow:
    """A position.

    Attributes:
        op: POSITION_... code.
        const: Its block of numbers.
        road: Index of its road, or NONE.
        lane: Id of the lane, or a number of lanes.
        entity: Entity that it is relative to, or NONE.
        flags: Switches as bits: POSITION_ABSOLUTE and those after it.
        guide: Guide of the route that it lies on, or NONE.
        seed: Seed of a random position, or NONE for the run's.
        spans: First stretch that a random position is drawn from, and the one after its last.
    """

    op: int
    const: tuple[Slot, ...]
    road: int = NONE
    lane: int = 0
    entity: int = NONE
    flags: int = 0
    guide: int = NONE
    seed: int = NONE
    spans: tuple[int, int] = (0, 0)


@dataclass(frozen=True, slots=True)
class ActionRow:
    """An action.

    Attributes:
        op: ACTION_... code.
        const: Its block of numbers.
        shape: SHAPE_... code of its dynamics.
        dimension: DIMENSION_... code of its dynamics.
        lanes: Number of lanes to the left.
        other: What it refers to, or NONE; by kind.
        mode: A choice between ways to do it; by kind.
        flags: Switches as bits; by kind.
        position: Row of its position, or NONE.
        point: First point of its path.
        points: Number of its points.
        drives_on: 1 where the entity goes on along the lane at the end of its path.
    """

    op: int
    const: tuple[Slot, ...] = ()
    shape: int = SHAPE_STEP
    dimension: int = DIMENSION_TIME
    lanes: int = 0
    other: int = NONE
    mode: int = 0
    flags: int = 0
    position: int = NONE
    point: int = 0
    points: int = 0
    drives_on: int = 0


@dataclass(frozen=True, slots=True)
class ConditionRow:
    """A condition.

    Attributes:
        op: CONDITION_... code.
        rule: RULE_... code of the comparison.
        value: What is compared with.
        entity: Id of the triggering entity that the word names, empty for a condition on the run.
        other: What it refers to, or NONE; by kind.
        mode: A choice between ways to measure; by kind.
        flags: Switches as bits; by kind.
        position: Row of its position, or NONE.
        const: Numbers beside value and delay.
        awaits: Kind and name of the elements whose state it watches; `other` becomes the first of them and `flags` how
            many follow.
    """

    op: int
    rule: int = RULE_LESS
    value: Slot = 0.0
    entity: str = ""
    other: int = NONE
    mode: int = 0
    flags: int = 0
    position: int = NONE
    const: tuple[Slot, ...] = ()
    awaits: tuple[str, str] = ("", "")


class Draft:
    """Collects a program's columns; numbers stay expressions until a row is asked for.

    Attributes:
        plan: What is lowered.
        network: Its map.
        program: The columns so far; `const` stays empty.
        numbers: Every number, by its slot.
        entities: Number of each entity, by its id.
        elements: The storyboard's elements, by their kind and name; see `note`.
        texts: Place of every text that is compared, in the order of the texts.
        variables: Number and word of each variable, by its name.
        signals: Number of each traffic signal, by its id.
        controllers: Number of each controller of traffic signals, by its name.
        messages: Number of messages so far.
        traffic: Number of actions so far that have vehicles of traffic, by their name.
        spans: Stretches of random positions that stand in the program already, by position and kind of entity.
    """

    def __init__(self, plan: Plan, network: Network) -> None:
        """Begin a program without rows."""
        self.plan = plan
        self.network = network
        self.program = Program()
        self.numbers: list[Slot] = [0.0] * slots.K_ENTITIES
        self.entities = {entity.id: i for i, entity in enumerate(plan.entities)}
        self.elements: dict[tuple[str, str], list[int]] = {}
        self.texts: dict[str, int] = {}
        self.variables: dict[str, tuple[int, Variable]] = {}
        self.signals: dict[str, int] = {}
        self.controllers: dict[str, int] = {}
        self.messages = 0
        self.traffic: Counter[str] = Counter()
        self.spans: dict[tuple[Word, str], tuple[int, int]] = {}
        self._awaited: list[tuple[int, tuple[str, str]]] = []

    def row(self, values: Mapping[str, Value]) -> list[float]:
        """Evaluate all numbers."""
        return [number_value(number, values) for number in self.numbers]

    def block(self, *numbers: Slot) -> int:
        """Append numbers and return the slot of the first."""
        self.numbers.extend(numbers)
        return len(self.numbers) - len(numbers)

    def position(self, row: PositionRow) -> int:
        """Append a position; return its row."""
        p = self.program
        p.position_op.append(row.op)
        p.position_road.append(row.road)
        p.position_lane.append(row.lane)
        p.position_entity.append(row.entity)
        p.position_const.append(self.block(*row.const))
        p.position_flags.append(row.flags)
        p.position_guide.append(row.guide)
        p.position_seed.append(row.seed)
        p.position_first.append(row.spans[0])
        p.position_last.append(row.spans[1])
        p.position_count[0] += 1
        return p.position_count[0] - 1

    def action(self, row: ActionRow, actor: int) -> int:
        """Append an action of an entity, or of none (NONE); return its row."""
        p = self.program
        p.action_op.append(row.op)
        p.action_entity.append(actor)
        p.action_shape.append(row.shape)
        p.action_dimension.append(row.dimension)
        p.action_lanes.append(row.lanes)
        p.action_other.append(row.other)
        p.action_mode.append(row.mode)
        p.action_flags.append(row.flags)
        p.action_position.append(row.position)
        p.action_const.append(self.block(*row.const))
        p.action_point.append(row.point)
        p.action_points.append(row.points)
        p.action_drives_on.append(row.drives_on)
        p.action_count[0] = len(p.action_op)
        return p.action_count[0] - 1

    def signal(self, name: str) -> int:
        """Return the number of a traffic signal, a new one for an id that has none yet."""
        number = self.signals.setdefault(name, len(self.signals))
        self.program.signal_count[0] = len(self.signals)
        return number

    def members(self, values: Iterable[int]) -> int:
        """Append a set of integers; return its row."""
        p = self.program
        p.set_member.extend(values)
        p.set_first.append(len(p.set_member))
        return len(p.set_first) - 2

    def condition(
        self, row: ConditionRow, entities: list[int], every: bool, edge: int, delay: Slot, owner: int
    ) -> None:
        """Append a condition to the group under construction.

        Args:
            row: The condition.
            entities: Triggering entities, none for a condition on the run.
            every: Whether all of them must fulfil it, not any.
            edge: EDGE_... code.
            delay: How much later its value counts, s.
            owner: Element whose trigger it stands in, NONE for the stop trigger of the storyboard.
        """
        p = self.program
        p.condition_owner.append(owner)
        if row.awaits[0]:
            self._awaited.append((p.condition_count[0], row.awaits))
        delayed = isinstance(delay, Expression) or delay > 0.0
        p.condition_op.append(row.op)
        p.condition_rule.append(row.rule)
        p.condition_edge.append(edge)
        p.condition_other.append(row.other)
        p.condition_mode.append(row.mode)
        p.condition_flags.append(row.flags)
        p.condition_position.append(row.position)
        p.condition_all.append(1 if every else 0)
        p.condition_ring.append(p.ring_count[0] if delayed else NONE)
        p.ring_count[0] += 1 if delayed else 0
        p.condition_const.append(self.block(row.value, delay, *row.const))
        p.condition_entity.extend(entities)
        p.condition_first.append(len(p.condition_entity))
        p.condition_count[0] = len(p.condition_op)

    def element(
        self,
        kind: int,
        parent: int,
        *,
        start: int = NONE,
        stop: int = NONE,
        limit: int = 1,
        priority: int = PRIORITY_PARALLEL,
        action: int = NONE,
    ) -> int:
        """Append an element as the last child of `parent`, whose subtree and its parents' grow by it."""
        p = self.program
        at = p.element_count[0]
        p.element_kind.append(kind)
        p.element_parent.append(parent)
        p.element_end.append(at + 1)
        p.element_start.append(start)
        p.element_stop.append(stop)
        p.element_limit.append(limit)
        p.element_priority.append(priority)
        p.element_action.append(action)
        p.element_count[0] = at + 1
        while parent >= 0:
            p.element_end[parent] = at + 1
            parent = p.element_parent[parent]
        return at

    def find_awaited(self) -> None:
        """Give the conditions that watch elements these, once all are there.

        Raises:
            KeyError: There is no element of that name.
        """
        for condition, name in self._awaited:
            found = self.elements[name]
            self.program.condition_other[condition] = found[0]
            self.program.condition_flags[condition] = found[-1] - found[0]

    def note(self, kind: str, name: str, element: int) -> None:
        """Remember an element by its name; of several the first, and those that follow it at once."""
        known = self.elements.setdefault((kind, name), [element])
        if element == known[-1] + 1:
            known.append(element)
