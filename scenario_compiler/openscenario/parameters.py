"""<ParameterDeclarations> and assignments of values to parameters: the meanings of `$name` below them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import get_args

from scenario_compiler.diagnostics import Place, did_you_mean
from scenario_compiler.expressions import Expression, ExpressionError, format_value
from scenario_compiler.markup import names
from scenario_compiler.markup.values import COMMAND_LINE, report_expression
from scenario_compiler.openscenario.codes import CONSTRAINT, REPEATED_PARAMETER, WRONG_TYPE
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.scope import NUMERIC, Bound, literal_number
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.variables import VariableType, is_value, seconds_of

TYPES = ("boolean", "dateTime", "double", "int", "integer", "string", "unsignedInt", "unsignedShort")
"""Values of ParameterType; 1.0 and 1.1 have `integer`."""

Given = Mapping[str, Bound]
"""Values from outside the file, by the parameter's name."""


def declared_parameters(
    node: Node, given: Given | None = None, settled: Collection[str] | None = None
) -> dict[str, Bound]:
    """Return the parameters that a node's <ParameterDeclarations> declares, with their given or declared values.

    Args:
        node: The element with the declarations.
        given: Values from outside.
        settled: For the scenario's own parameters: those numeric ones that do not stay open; None for other parameters.
    """
    found: dict[str, Bound] = {}
    places: dict[str, Place] = {}
    for group in node.children("ParameterDeclarations"):
        for declaration in group.children("ParameterDeclaration"):
            name = declared_name(declaration)
            if name in found:
                message = f"a parameter '{name}' is already declared here; the later declaration is used"
                declaration.report(REPEATED_PARAMETER, message, "name", related=names.first_at(places[name]))
            places[name] = declaration.place("name")
            one = _declared(declaration.inner(found), name, given or {})
            found[name] = one if settled is None or name in settled else node.scope.opened(name, one)
    return found


def declared_name(declaration: Node) -> str:
    """Return the name in a declaration; drafts before 1.0 write it with a $."""
    declaration.has("name")
    return str(declaration.element.get("name", "")).lstrip("$")


def with_parameters(node: Node, given: Given | None = None) -> Node:
    """Return the node with the parameters that it declares in scope, with their given or declared values."""
    return node if node.opened else node.inner(declared_parameters(node, given), opened=True)


def assigned_parameters(reference: Node) -> dict[str, Bound]:
    """Return the values in the <ParameterAssignments> of a catalog reference, evaluated in the reference's scope."""
    found: dict[str, Bound] = {}
    for group in reference.children("ParameterAssignments"):
        for one in group.children("ParameterAssignment"):
            value = bound("", one, "value")
            if value is not None:
                found[assigned_name(one)] = replace(value, place=one.origin)
    return found


def assigned_name(assignment: Node) -> str:
    """Return the name in a <ParameterAssignment>; some files write it with a $."""
    assignment.has("parameterRef")
    return str(assignment.element.get("parameterRef", "")).lstrip("$")


def stand_in(kind: str) -> Bound:
    """Return a value of a type in place of one that has a fault, so that its uses are not reported too."""
    return Bound(
        kind, "0" if kind in NUMERIC else {"boolean": "false", "dateTime": "2000-01-01T00:00:00"}.get(kind, "")
    )


def bound(kind: str, node: Node, attribute: str) -> Bound | None:
    """Return the meaning of a parameter of a type whose value an attribute gives; None if it has a fault."""
    raw = str(node.element.get(attribute, ""))
    node.has(attribute)
    try:
        found = node.scope.symbolic(raw)
        if isinstance(found, Expression):
            return Bound(kind or "double", format_value(found.evaluate(node.scope.values)), found)
    except ExpressionError as error:
        together = node.scope.joined(raw) if kind in ("string", "") else None
        if together is not None:
            return Bound("string", together)
        report_expression(error, raw, node.reading.sink, node.place(attribute))
        return None
    return Bound(kind or ("string" if literal_number(found) is None else "double"), found)


def _declared(declaration: Node, name: str, given: Given) -> Bound:
    kind = declaration.choice("parameterType", TYPES, "string")
    own = bound(kind, declaration, "value")
    place: Place = declaration.place("value")
    value = own or stand_in(kind)
    if name in given:
        value = replace(given[name], type=kind)
        place = value.place or place
    elif own is None:
        declaration.read_whole()
        return value
    if not fits(value, kind):
        message = f"'{value.text}', the value of '{name}', is not of the type {kind}"
        declaration.reading.sink.add(WRONG_TYPE, message, place)
        return Bound("string", value.text)
    check_constraints(declaration, name, value, place)
    return value


def fits(value: Bound, kind: str) -> bool:
    """Return whether a value has a ParameterType; a number must be one that the file can also use elsewhere."""
    if kind in NUMERIC and literal_number(value.text) is None:
        return False
    return is_value(variable_type(kind), value.text)


def variable_type(kind: str) -> VariableType:
    """Return the type of a variable for a ParameterType; 1.2 and 1.3 call the integers `int`."""
    known: tuple[VariableType, ...] = get_args(VariableType)
    return next((one for one in known if one == kind), "integer" if kind == "int" else "string")


def check_constraints(declaration: Node, name: str, value: Bound, place: Place) -> None:
    """Report a value of a parameter that meets none of the constraint groups of its declaration."""
    groups = declaration.children("ConstraintGroup")
    for group in groups:
        group.read_whole()
    fulfilled = [all(_holds(one, value) for one in group.children("ValueConstraint")) for group in groups]
    if groups and not any(fulfilled):
        wanted = " or ".join(
            " and ".join(f"{one.text('rule')} {one.text('value')}" for one in group.children("ValueConstraint"))
            for group in groups
        )
        message = f"{name} is {value.text}, but must be: {wanted}"
        declaration.reading.sink.add(CONSTRAINT, message, place)


RULES = ("equalTo", "greaterThan", "lessThan", "greaterOrEqual", "lessOrEqual", "notEqualTo")
"""Values of ASAM's Rule."""


def _holds(constraint: Node, value: Bound) -> bool:
    rule = constraint.choice("rule", RULES)
    text = constraint.text("value")
    limit, number = _comparable(text, value.type), _comparable(value.text, value.type)
    if limit is None or number is None:
        if rule in ("equalTo", "notEqualTo"):
            return (text.strip() == value.text.strip()) == (rule == "equalTo")
        return _compared(rule, (value.text > text) - (value.text < text))
    return _compared(rule, (number > limit) - (number < limit))


def _comparable(text: str, kind: str) -> float | None:
    try:
        return seconds_of(text) if kind == "dateTime" else literal_number(text)
    except (ValueError, OverflowError):
        return None


def _compared(rule: str, sign: int) -> bool:
    return {
        "equalTo": sign == 0,
        "notEqualTo": sign != 0,
        "greaterThan": sign > 0,
        "lessThan": sign < 0,
        "greaterOrEqual": sign >= 0,
        "lessOrEqual": sign <= 0,
    }[rule]


def given_parameters(arguments: Mapping[str, str], places: Mapping[str, Place] | None = None) -> dict[str, Bound]:
    """Return the values of `--set name=value`, or of a variation that gives them at places of its file."""
    return {
        name: Bound(
            "string" if literal_number(text) is None else "double", text, place=(places or {}).get(name, COMMAND_LINE)
        )
        for name, text in arguments.items()
    }


def report_unknown(given: Given, declared: Iterable[str], node: Node) -> None:
    """Report values of parameters that the scenario does not declare."""
    known = tuple(declared)
    for name, value in given.items():
        if name not in known:
            message = f"the scenario has no parameter '{name}'"
            node.reading.sink.add(
                names.UNKNOWN_ARGUMENT, message, value.place or COMMAND_LINE, hint=did_you_mean(name, known)
            )


def parameter_word(declaration: Node, value: Bound) -> Parameter:
    """Return an open parameter as a word, with the limits of its constraint group if there is exactly one."""
    low: float | None = None
    high: float | None = None
    groups = declaration.children("ConstraintGroup")
    for one in groups[0].children("ValueConstraint") if len(groups) == 1 else []:
        limit = literal_number(one.text("value"))
        low = limit if one.text("rule") == "greaterOrEqual" else low
        high = limit if one.text("rule") == "lessOrEqual" else high
    name = declared_name(declaration)
    text = format_value(literal_number(value.text) or 0.0)
    found = Parameter.model_construct(name=name, type="number", default=text, min=low, max=high)
    return found.written_at(declaration.origin)
