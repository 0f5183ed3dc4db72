"""Variables and traffic signals: what a scenario names becomes numbers of the program."""

from __future__ import annotations

from collections.abc import Iterator

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
from scenario_compiler.vocabulary.variables import Variable, number_of


def add_world(draft: ProgramBuilder) -> None:
    """Append the variables, and the controllers of traffic signals with their phases."""
    plan, p = draft.plan, draft.program
    draft.texts = {text: k for k, text in enumerate(sorted(set(_texts(plan))))}
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
            for state in phase.states:
                p.light_signal.append(draft.signal(state.signal))
                p.light_state.append(draft.texts[state.state])
            p.light_first.append(len(p.light_signal))
        p.phase_first.append(len(p.phase_name))
    p.controller_count[0] = len(p.controller_const)


def variable_value(draft: ProgramBuilder, variable: Variable, text: str) -> float:
    """Return a value of a variable as the engine has it: of a text its place among all texts, which are sorted.

    Raises:
        ValueError: The text is no value of the variable's type.
    """
    if variable.type == "string":
        return float(draft.texts[text])
    number = number_of(variable.type, text or ("false" if variable.type == "boolean" else "0"))
    if number is None:
        raise ValueError(f"'{text}' is no value of the variable '{variable.name}'")
    return number


def _texts(plan: Plan) -> Iterator[str]:
    """Yield every text that is compared with another while the scenario runs."""
    for variable in plan.variables:
        yield variable.value
    for controller in plan.signal_controllers:
        for phase in controller.phases:
            yield phase.name
            yield from (state.state for state in phase.states)
    for word in walk(plan.storyboard):
        if isinstance(word, SetVariableAction | VariableCondition):
            yield word.value
        elif isinstance(word, TrafficSignalStateAction | TrafficSignalCondition):
            yield word.state
        elif isinstance(word, TrafficSignalControllerAction | TrafficSignalControllerCondition):
            yield word.phase
