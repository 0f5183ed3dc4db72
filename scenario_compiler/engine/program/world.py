"""Variables and traffic signals: indices and numbers for their names and texts."""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Mapping

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.plan.model import Plan
from scenario_compiler.vocabulary.actions import (
    SetVariableAction,
    TrafficSignalControllerAction,
    TrafficSignalStateAction,
)
from scenario_compiler.vocabulary.conditions import (
    TrafficSignalCondition,
    TrafficSignalControllerCondition,
    VariableCondition,
)
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.variables import Variable, VariableType, number_in, number_of

LAMPS = ("red", "yellow", "green")
"""Lamps of a signal head from the top."""

COLOURS = {"red": "red", "stop": "red", "yellow": "yellow", "amber": "yellow", "green": "green", "go": "green"}
"""Words in states that stand for a colour."""

SENSES = {"+": 1, "-": -1}
ALL_LANES = (-1000, 1000)


def add_world(draft: ProgramBuilder) -> None:
    """Append the variables, and the traffic signal controllers with their phases."""
    plan, p = draft.plan, draft.program
    draft.texts = {text: k for k, text in enumerate(sorted(set(_texts(plan)), key=_numbers_first))}
    draft.variables = {one.name: (k, one) for k, one in enumerate(plan.variables)}
    for one in plan.variables:
        p.variable_const.append(draft.block(variable_value(draft, one, one.value)))
    p.variable_count[0] = len(p.variable_const)
    draft.controllers = {one.name: k for k, one in enumerate(plan.signal_controllers)}
    for controller in plan.signal_controllers:
        p.controller_reference.append(draft.controllers.get(controller.reference, op.NONE))
        p.controller_const.append(draft.block(controller.delay))
        for phase in controller.phases:
            p.phase_name.append(draft.texts[phase.name])
            p.phase_const.append(draft.block(phase.duration))
            for signal in draft.network.model().signals_of(controller.name) if phase.state else ():
                p.light_signal.append(draft.signal(signal))
                p.light_state.append(draft.texts[phase.state])
            for state in phase.states:
                p.light_signal.append(draft.signal(state.signal))
                p.light_state.append(draft.texts[state.state])
            p.light_first.append(len(p.light_signal))
        p.phase_first.append(len(p.phase_name))
    p.controller_count[0] = len(p.controller_const)


def add_heads(draft: ProgramBuilder) -> None:
    """Append the positions on the roads of the signals that the plan names, after all of it has been lowered."""
    p = draft.program
    p.text_aspect = [aspect_of(text) for text in draft.texts]
    if not draft.signals:
        return
    for signal in draft.network.model().signals:
        if signal.id not in draft.signals:
            continue
        for first, last in signal.lanes or (ALL_LANES,):
            p.head_signal.append(draft.signals[signal.id])
            p.head_road.append(draft.network.road_index(signal.road))
            p.head_const.append(draft.block(signal.s))
            p.head_sense.append(SENSES.get(signal.orientation, 0))
            p.head_from.append(min(first, last))
            p.head_to.append(max(first, last))
    p.head_count[0] = len(p.head_road)


def aspect_of(state: str) -> int:
    """Return the meaning of a signal's state, ASPECT_...

    A state is a text of the scenario: colours, or `on` and `off` for the lamps from the top (red, yellow, green),
    separated by `;`, `,`, `|`, `+`, `-`, `_`, `:` or blanks. Red means stop, also together with yellow; yellow alone
    means caution; everything else has no meaning.
    """
    words = [word for word in re.split(r"[;,|+\-_:\s]+", state.casefold()) if word]
    lit = {colour for colour, word in zip(LAMPS, words, strict=False) if word in ("on", "flashing")}
    named = {COLOURS[word] for word in words if word in COLOURS}
    colours = named | (lit if len(words) == len(LAMPS) and not named else set())
    if "red" in colours:
        return op.ASPECT_STOP
    return op.ASPECT_CAUTION if "yellow" in colours else op.ASPECT_NONE


LEFT_OUT: Mapping[VariableType, str] = {"boolean": "false", "dateTime": "1970-01-01T00:00:00"}
"""Values at the start of variables without one, by their type; those of all others are 0."""


def variable_value(draft: ProgramBuilder, variable: Variable, text: str) -> float:
    """Return the number that represents a variable's value.

    It is the index among all texts for a text that is a number, and -1 minus its index for any other text.

    Raises:
        ValueError: The text is not a value of the variable's type.
    """
    if variable.type == "string":
        return float(draft.texts[text] if number_in(text) is not None else -1 - draft.texts[text])
    number = number_of(variable.type, text or LEFT_OUT.get(variable.type, "0"))
    if number is None:
        raise ValueError(f"'{text}' is not a value of the variable '{variable.name}'")
    return number


def order_of_texts(draft: ProgramBuilder, rule: int, text: str) -> tuple[int, float]:
    """Return the RULE_... code and the limit for the number of a variable that is compared with a text by order.

    Texts are compared as numbers. With a text that is not a number, the comparison is never true.
    """
    numbers = [number for number in map(number_in, draft.texts) if number is not None]
    limit = number_in(text)
    if limit is None:
        return op.RULE_GREATER_OR_EQUAL, 1.0 * len(numbers)
    beside = bisect_left if rule in (op.RULE_LESS, op.RULE_GREATER_OR_EQUAL) else bisect_right
    less = rule in (op.RULE_LESS, op.RULE_LESS_OR_EQUAL)
    return op.RULE_LESS if less else op.RULE_GREATER_OR_EQUAL, 1.0 * beside(numbers, limit)


def _numbers_first(text: str) -> tuple[bool, float, str]:
    """Return a key that sorts the texts that are numbers by these, before all others."""
    number = number_in(text)
    return number is None, number or 0.0, text


def _texts(plan: Plan) -> Iterator[str]:
    """Yield every text that is compared with another one while the scenario runs."""
    for variable in plan.variables:
        yield variable.value
    for controller in plan.signal_controllers:
        for phase in controller.phases:
            yield phase.name
            yield phase.state
            yield from (state.state for state in phase.states)
    for word in walk(plan.storyboard):
        if isinstance(word, SetVariableAction | VariableCondition):
            yield word.value
        elif isinstance(word, TrafficSignalStateAction | TrafficSignalCondition):
            yield word.state
        elif isinstance(word, TrafficSignalControllerAction | TrafficSignalControllerCondition):
            yield word.phase
