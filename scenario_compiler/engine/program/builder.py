"""A program under construction: columns, numbers that are still expressions, and appended rows.

The entry of a word (`moves`, `story`) or a table (`positions`) makes its row; this module appends it.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ConditionRow, PositionRow, Slot
from scenario_compiler.expressions import Expression, Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads.network import Network
from scenario_compiler.vocabulary.variables import Variable
from scenario_compiler.vocabulary.word import Word, number_value


class ProgramBuilder:
    """Collects a program's columns; numbers remain expressions until a row of values is requested.

    Attributes:
        plan: The plan that is lowered.
        network: Its map.
        program: The columns so far; `const` stays empty.
        numbers: Every number, by its slot.
        entities: Index of each entity, by its id.
        elements: The storyboard's elements, by their kind and name; see `note`.
        texts: Index of every text that is compared: those that are numbers, in their order, and then the others.
        variables: Index and word of each variable, by its name.
        signals: Index of each traffic signal, by its id.
        controllers: Index of each traffic signal controller, by its name.
        messages: Number of messages so far.
        traffic: Number of actions so far that have traffic vehicles, by their name.
        spans: Stretches of random positions that are already in the program, by position and kind of entity.
    """

    def __init__(self, plan: Plan, network: Network) -> None:
        """Begin a program without rows."""
        self.plan = plan
        self.network = network
        self.program = Program()
        self.numbers: list[Slot] = [0.0] * slot.K_ENTITIES
        self.entities: Mapping[str, int] = {entity.id: i for i, entity in enumerate(plan.entities)}
        self.elements: dict[tuple[str, str], list[int]] = {}
        self.texts: Mapping[str, int] = {}
        self.variables: Mapping[str, tuple[int, Variable]] = {}
        self.signals: dict[str, int] = {}
        self.controllers: Mapping[str, int] = {}
        self.messages = 0
        self.traffic: Counter[str] = Counter()
        self.spans: dict[tuple[Word, str], tuple[int, int]] = {}
        self._awaited: list[tuple[int, tuple[str, str]]] = []

    def row(self, values: Mapping[str, Value]) -> list[float]:
        """Evaluate all numbers with the values of the parameters."""
        return [number_value(number, values) for number in self.numbers]

    def block(self, *numbers: Slot) -> int:
        """Append numbers and return the slot of the first."""
        self.numbers.extend(numbers)
        return len(self.numbers) - len(numbers)

    def add_position(self, row: PositionRow) -> int:
        """Append a position; return its row."""
        p = self.program
        p.position_op.append(row.kind)
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

    def add_action(self, number: int, row: ActionRow, actor: int) -> int:
        """Append an action by its opcode, for an entity or for none (NONE); return its row."""
        p = self.program
        p.action_op.append(number)
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
        p.piece_count[0] += row.pieces
        p.action_piece.append(p.piece_count[0])
        p.action_count[0] = len(p.action_op)
        return p.action_count[0] - 1

    def signal(self, name: str) -> int:
        """Return the index of a traffic signal; an unknown id gets a new one."""
        number = self.signals.setdefault(name, len(self.signals))
        self.program.signal_count[0] = len(self.signals)
        return number

    def members(self, values: Iterable[int]) -> int:
        """Append a set of integers; return its row."""
        p = self.program
        p.set_member.extend(values)
        p.set_first.append(len(p.set_member))
        return len(p.set_first) - 2

    def add_condition(
        self, number: int, row: ConditionRow, entities: list[int], every: bool, edge: int, delay: Slot, owner: int
    ) -> None:
        """Append a condition to the group under construction.

        Args:
            number: The opcode of the condition.
            row: Its row.
            entities: Triggering entities, none for a condition on the run.
            every: Whether all of them must fulfil it; otherwise any suffices.
            edge: EDGE_... code.
            delay: Time by which its value is delayed, s.
            owner: Element to whose trigger it belongs, NONE for the stop trigger of the storyboard.
        """
        p = self.program
        p.condition_owner.append(owner)
        if row.awaits[0]:
            self._awaited.append((p.condition_count[0], row.awaits))
        delayed = isinstance(delay, Expression) or delay > 0.0
        p.condition_op.append(number)
        p.condition_rule.append(row.rule)
        p.condition_edge.append(edge)
        p.condition_other.append(row.other)
        p.condition_mode.append(row.mode)
        p.condition_flags.append(row.flags)
        p.condition_position.append(row.position)
        p.condition_all.append(1 if every else 0)
        p.condition_ring.append(p.ring_count[0] if delayed else op.NONE)
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
        start: int = op.NONE,
        stop: int = op.NONE,
        limit: int = 1,
        priority: int = op.PRIORITY_PARALLEL,
        action: int = op.NONE,
    ) -> int:
        """Append an element as the last child of `parent`; the subtrees of all its parents grow by one."""
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
        """Set the elements of the conditions that watch elements, after all elements have been added.

        Raises:
            KeyError: There is no element with that name.
        """
        for condition, name in self._awaited:
            found = self.elements[name]
            self.program.condition_other[condition] = found[0]
            self.program.condition_flags[condition] = found[-1] - found[0]

    def note(self, kind: str, name: str, element: int) -> None:
        """Register an element by its name; for equal names the first one, and those that directly follow it."""
        known = self.elements.setdefault((kind, name), [element])
        if element == known[-1] + 1:
            known.append(element)
