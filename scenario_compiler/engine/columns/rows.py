"""The rows of a program that words are lowered to, and the interface for making them.

A row is made by the function that is declared next to the code that executes the word (`moves`, `story.conditions`).
This function receives the word and a `ProgramDraft`, the program under construction; it knows neither files nor models.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, NamedTuple, Protocol, TypeAlias

from scenario_compiler.engine.columns import opcodes as op

if TYPE_CHECKING:
    from scenario_compiler.engine.columns.program import Program
    from scenario_compiler.expressions import Expression
    from scenario_compiler.plan.model import Plan
    from scenario_compiler.vocabulary.actions import Failure, KeepsVehicles, WeatherAction
    from scenario_compiler.vocabulary.actions.dynamics import AtRate, Limits, OverDistance
    from scenario_compiler.vocabulary.positions.routes import RouteWord, Trajectory
    from scenario_compiler.vocabulary.variables import Variable
    from scenario_compiler.vocabulary.word import Word

Slot: TypeAlias = "float | Expression"
"""A number of a plan: a constant, or an expression of the scenario's parameters."""

SHAPES = {
    "linear": op.SHAPE_LINEAR,
    "sinusoidal": op.SHAPE_SINUSOIDAL,
    "cubic": op.SHAPE_CUBIC,
    "step": op.SHAPE_STEP,
}
"""Codes of the shapes of dynamics."""

FRAMES = {
    "entity": op.FRAME_ENTITY,
    "lane": op.FRAME_LANE,
    "road": op.FRAME_ROAD,
    "trajectory": op.FRAME_TRAJECTORY,
    "world": op.FRAME_WORLD,
}
"""Codes of coordinate systems."""


class PositionRow(NamedTuple):
    """A position.

    Attributes:
        kind: POSITION_... code.
        const: Its block of numbers.
        road: Index of its road, or NONE.
        lane: Id of the lane, or a number of lanes.
        entity: Entity that it is relative to, or NONE.
        flags: Switches as bits: POSITION_ABSOLUTE and the following ones.
        guide: Guide of the route on which it lies, or NONE.
        seed: Seed of a random position, or NONE for the run's.
        spans: First stretch from which a random position is drawn, and the one after the last.
    """

    kind: int
    const: tuple[Slot, ...]
    road: int = op.NONE
    lane: int = 0
    entity: int = op.NONE
    flags: int = 0
    guide: int = op.NONE
    seed: int = op.NONE
    spans: tuple[int, int] = (0, 0)


class ActionRow(NamedTuple):
    """An action.

    Attributes:
        const: Its block of numbers.
        shape: SHAPE_... code of its dynamics.
        dimension: DIMENSION_... code of its dynamics.
        lanes: Number of lanes to the left.
        other: What it refers to, or NONE; depends on the action.
        mode: Variant of the action; depends on the action.
        flags: Switches as bits; depends on the action.
        position: Row of its position, or NONE.
        point: First point of its path.
        points: Number of its points.
        drives_on: 1 if the entity continues along the lane at the end of its path.
        pieces: Greatest number of pieces of a plan of speeds.
    """

    const: tuple[Slot, ...] = ()
    shape: int = op.SHAPE_STEP
    dimension: int = op.DIMENSION_TIME
    lanes: int = 0
    other: int = op.NONE
    mode: int = 0
    flags: int = 0
    position: int = op.NONE
    point: int = 0
    points: int = 0
    drives_on: int = 0
    pieces: int = 0


class ConditionRow(NamedTuple):
    """A condition.

    Attributes:
        rule: RULE_... code of the comparison.
        value: The value to compare with.
        entity: Id of the triggering entity that the word names, empty for a condition on the run.
        other: What it refers to, or NONE; depends on the condition.
        mode: What is measured and how; depends on the condition.
        flags: Switches as bits; depends on the condition.
        position: Row of its position, or NONE.
        const: Numbers beside value and delay.
        awaits: Kind and name of the elements whose state it watches; `other` becomes the first of them and `flags` the
            number of those that follow.
    """

    rule: int = op.RULE_LESS
    value: Slot = 0.0
    entity: str = ""
    other: int = op.NONE
    mode: int = 0
    flags: int = 0
    position: int = op.NONE
    const: tuple[Slot, ...] = ()
    awaits: tuple[str, str] = ("", "")


class ProgramDraft(Protocol):
    """A program under construction, as the rows of words need it.

    Attributes:
        plan: The plan that is lowered.
        program: The columns so far.
        numbers: Every number, by its slot.
        entities: Index of each entity, by its id.
        texts: Index of every text that is compared: those that are numbers, in their order, and then the others.
        variables: Index and word of each variable, by its name.
        controllers: Index of each traffic signal controller, by its name.
        messages: Number of messages so far.
    """

    plan: Plan
    program: Program
    numbers: list[Slot]
    entities: Mapping[str, int]
    texts: Mapping[str, int]
    variables: Mapping[str, tuple[int, Variable]]
    controllers: Mapping[str, int]
    messages: int

    def block(self, *numbers: Slot) -> int:
        """Append numbers and return the slot of the first."""
        ...

    def position(self, word: Word) -> int:
        """Append a position; return its row."""
        ...

    def random_position(self) -> int:
        """Append a position for the random placement of traffic; return its row."""
        ...

    def track(self, trajectory: Trajectory) -> int:
        """Append a trajectory; return its index."""
        ...

    def route(self, route: RouteWord) -> int:
        """Append the guide of a route; return its index."""
        ...

    def goal(self, position: Word) -> int:
        """Append the guide to a position; return its index."""
        ...

    def failure(self, failure: Failure) -> int:
        """Append a camera failure that an action begins; return its index."""
        ...

    def weather(self, weather: WeatherAction) -> int:
        """Append a weather; return its index."""
        ...

    def signal(self, name: str) -> int:
        """Return the index of a traffic signal."""
        ...

    def variable_value(self, variable: Variable, text: str) -> float:
        """Return the number that represents a variable's value, given as a text."""
        ...

    def order_of_texts(self, rule: int, text: str) -> tuple[int, float]:
        """Return the RULE_... code and the limit for the number of a variable that is compared with a text by order."""
        ...

    def members(self, values: Iterable[int]) -> int:
        """Append a set of integers; return its row."""
        ...

    def seconds_of(self, date_time: str) -> float:
        """Return a date and time as seconds since 1970."""
        ...

    def traffic_number(self, name: str) -> int:
        """Return the index of a name among those of actions on traffic, from 1; 0 for an empty name."""
        ...

    def vehicles_of(self, word: KeepsVehicles) -> tuple[int, int]:
        """Return the first entity that an action on traffic uses, and the number of its entities."""
        ...


def dynamics_of(over_time: Slot, instead: AtRate | OverDistance | None) -> tuple[Slot, int]:
    """Return the value and the DIMENSION_... code of a change's dynamics."""
    if instead is None:
        return over_time, op.DIMENSION_TIME
    return instead.value, op.DIMENSION_RATE if instead.word == "at_rate" else op.DIMENSION_DISTANCE


def limits_of(limits: Limits | None) -> tuple[Slot, ...]:
    """Return the numbers of a motion's limits, in the order of `slots`; negative for absent limits."""
    if limits is None:
        return (-1.0,) * 5
    given = (limits.acceleration, limits.acceleration_rate, limits.deceleration, limits.deceleration_rate, limits.speed)
    return tuple(-1.0 if limit is None else limit for limit in given)


def flags_of(*flags: tuple[int, bool]) -> int:
    """Return the flags that are set, as bits."""
    return sum(flag for flag, on in flags if on)
