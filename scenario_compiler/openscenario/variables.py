"""Variables and monitors, whose values change in a run, and parameters that actions or conditions use."""

from __future__ import annotations

from collections.abc import Mapping

from scenario_compiler.diagnostics import Place, did_you_mean
from scenario_compiler.document import Origin
from scenario_compiler.markup import names
from scenario_compiler.openscenario.codes import UNKNOWN_VARIABLE, WRONG_TYPE
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.parameters import TYPES, bound, fits, stand_in, variable_type
from scenario_compiler.openscenario.scope import Bound
from scenario_compiler.vocabulary.actions import ModifyVariableAction, SetVariableAction
from scenario_compiler.vocabulary.conditions import VariableCondition
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.variables import Variable
from scenario_compiler.vocabulary.word import Word

_ATTRIBUTES = ("variableRef", "parameterRef", "monitorRef")


def read_variables(root: Node) -> dict[str, Variable]:
    """Return the declared variables and monitors by name; a monitor is a boolean."""
    found: dict[str, Variable] = {}
    for group in root.children("VariableDeclarations", "MonitorDeclarations"):
        for node in group.children("VariableDeclaration", "MonitorDeclaration"):
            name = node.text("name")
            if name in found:
                first = names.first_at(found[name].origin)
                node.report(
                    names.DUPLICATE_NAME, f"a variable '{name}' is already declared here", "name", related=first
                )
            monitor = node.tag == "MonitorDeclaration"
            kind = "boolean" if monitor else node.choice("variableType", TYPES, "string")
            value = bound(kind, node, "value") or stand_in(kind)
            if not fits(value, kind):
                node.report(WRONG_TYPE, f"'{value.text}', the value of '{name}', is not of the type {kind}", "value")
                kind = "string"
            found.setdefault(name, _variable(name, kind, value).written_at(node.origin))
    return found


def _variable(name: str, kind: str, value: Bound) -> Variable:
    return Variable.model_validate({"name": name, "type": variable_type(kind), "value": value.text})


def variable_of_parameter(node: Node) -> str:
    """Return the name of the variable for the parameter that an action or condition names.

    A parameter is known in the element that declares it and below. The variable of one that a story or a maneuver
    declares gets a number, so that it differs from others of the same name.
    """
    name = node.text("parameterRef")
    known = node.reading.known
    one = node.scope.bound.get(name)
    if one is None or one is known.parameters.get(name):
        return name
    number = 2
    while known.inner.setdefault(f"{name}#{number}", one) is not one:
        number += 1
    return f"{name}#{number}"


def used_variables(storyboard: Storyboard, declared: Mapping[str, Variable], root: Node) -> tuple[Variable, ...]:
    """Return the variables, and the parameters that actions change or conditions read; report other names.

    A parameter that is used in this way is structural: its value is the one with which the run starts. An unknown name
    becomes a text that is empty until an action changes it.
    """
    found = dict(declared)
    scope = root.scope.inner(root.reading.known.inner)
    for word in walk(storyboard):
        name = _named(word)
        if name is None or name in found:
            continue
        parameter = scope.bound.get(name)
        if parameter is None:
            hint = did_you_mean(name, [*found, *root.scope.bound])
            root.reading.sink.add(
                UNKNOWN_VARIABLE, f"there is no variable, monitor or parameter '{name}'", _place(word), hint=hint
            )
            found[name] = Variable.model_construct(name=name, type="string").written_at(word.origin)
            continue
        if parameter.expression is not None:
            scope.structural.update(parameter.expression.names)
        found[name] = _variable(name, parameter.type, parameter)
    return tuple(found.values())


def _place(word: Word) -> Place:
    origin = word.origin
    if not isinstance(origin, Origin):
        return origin
    return next((origin.of(one) for one in _ATTRIBUTES if origin.element.get(one) is not None), origin)


def _named(word: Word) -> str | None:
    return word.variable if isinstance(word, SetVariableAction | ModifyVariableAction | VariableCondition) else None
