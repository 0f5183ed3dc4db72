"""Parameters: their declarations, and binding them to the values of a command line or a use of a template."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place, did_you_mean
from scenario_compiler.document import Origin
from scenario_compiler.expressions import RESERVED, Expression, ExpressionError, Value, format_value
from scenario_compiler.markup import codes, names
from scenario_compiler.markup.environment import Binding, Environment, ReadingContext
from scenario_compiler.markup.reading import misspelt, read_word
from scenario_compiler.markup.values import COMMAND_LINE, bound_value, number_hint, report_quantity, truth_hint
from scenario_compiler.vocabulary.grammar import INTEGER, NUMBER, limits_text, out_of_limits
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.word import QUANTITIES, Word

STRUCTURAL_KINDS = ("integer", "text", "boolean")
"""Kinds of parameters that are always replaced by their values; others may stay open in a plan."""


class Declared(NamedTuple):
    """The parameters that a scenario or template declares.

    Attributes:
        known: By name, in the order of the declarations.
        all_read: Whether all declarations are correct; otherwise an unknown parameter is not reported.
    """

    known: Mapping[str, Parameter]
    all_read: bool = True

    @property
    def quantities(self) -> dict[str, str]:
        """The type of each parameter by its name."""
        return {name: one.type for name, one in self.known.items()}


def read_parameters(element: etree._Element, reading: ReadingContext) -> Declared:
    """Return the parameters that an element declares; report a name that is declared twice."""
    read: list[Parameter] = []
    sink, before = reading.sink, reading.sink.reported
    declaring = reading._replace(environment=replace(reading.environment, declares=True))
    for child in element.iterchildren(Parameter.tag()):
        faults = sink.reported
        parameter = read_word(child, Parameter, declaring)
        if parameter is not None and sink.reported == faults:
            read.append(parameter)
    known = parameters_by_name(read, sink)
    return Declared(known, sink.reported == before and not misspelt(element, [Parameter.tag()]))


def parameters_by_name(parameters: Iterable[Parameter], sink: Diagnostics) -> dict[str, Parameter]:
    """Return declared parameters by their names; report faulty names and limits that no value meets."""
    known: dict[str, Parameter] = {}
    for parameter in parameters:
        if parameter.name in known:
            sink.add(
                names.DUPLICATE_NAME,
                f"the parameter '{parameter.name}' is declared twice",
                parameter.place_of("name"),
                related=names.first_at(known[parameter.name].place_of("name")),
            )
        if parameter.name in RESERVED:
            report_reserved(parameter.name, parameter.place_of("name"), sink)
        known.setdefault(parameter.name, parameter)
        least, greatest = parameter.limits.minimum, parameter.limits.maximum
        if least is not None and greatest is not None and least > greatest:
            message = f"no value of '{parameter.name}' is at least {least:g} and at most {greatest:g}"
            sink.add(codes.OUT_OF_LIMITS, message, parameter.place_of("min" if parameter.min is not None else "max"))
    return known


def report_reserved(name: str, place: Place, sink: Diagnostics) -> None:
    """Report a name of a parameter or a loop's variable that means something else in expressions."""
    sink.add(names.RESERVED_NAME, f"'{name}' means something else in expressions; choose another name", place)


def bind_arguments(declared: Declared, arguments: Mapping[str, str], sink: Diagnostics) -> dict[str, Value]:
    """Return the value of every parameter of a scenario: the argument's, or else the default."""
    parameters = declared.known
    if declared.all_read:
        report_unknown_arguments(arguments, parameters, sink)
    values: dict[str, Value] = {}
    for name, parameter in parameters.items():
        if name in arguments:
            value = typed(arguments[name], parameter, COMMAND_LINE, sink)
        elif parameter.default is None:
            sink.add(
                names.MISSING_PARAMETER,
                f"the parameter '{name}' has neither a default nor a value",
                parameter.origin,
                hint=f"--set {name}=...",
            )
            continue
        else:
            value = default_value(parameter, sink)
        if value is not None:
            values[name] = value
    return values


def report_unknown_arguments(arguments: Iterable[str], known: Collection[str], sink: Diagnostics) -> None:
    """Report arguments of unknown parameters."""
    for name in arguments:
        if name not in known:
            hint = did_you_mean(name, known) if known else "the scenario declares no parameters"
            sink.add(names.UNKNOWN_ARGUMENT, f"there is no parameter '{name}' to set", COMMAND_LINE, hint=hint)


def default_value(parameter: Parameter, sink: Diagnostics) -> Value | None:
    """Return the value of a parameter's default; None if it has none or a wrong one."""
    if parameter.default is None:
        return None
    return typed(parameter.default, parameter, parameter.place_of("default"), sink)


def bind_use(
    declared: Declared, given: Mapping[str, str], reading: ReadingContext, use: Word, scope: object
) -> Environment:
    """Return the meanings of a template's parameters in one use of it.

    Args:
        declared: The template's parameters.
        given: The attributes of the use, as written.
        reading: The context of the use; its environment resolves `$name` in `given`.
        use: The word that uses it.
        scope: The names that are known at the use.
    """
    sink, parameters = reading.sink, declared.known
    bindings: dict[str, Binding] = {}
    undetermined: set[str] = set()
    for name in given:
        if name not in parameters and declared.all_read:
            sink.add(
                codes.UNKNOWN_ATTRIBUTE,
                f"the template has no parameter '{name}'",
                use.origin.name_of(name) if isinstance(use.origin, Origin) else use.origin,
                hint=did_you_mean(name, set(parameters) - set(given)),
            )
    for name, parameter in parameters.items():
        value: Binding | None = None
        if name in given:
            place = use.place_of(name)
            report_quantity(given[name], name, parameter.type, reading, place)
            bound = bound_value(given[name], reading, place)
            if bound is not None:
                value = _typed_binding(bound, parameter, place, reading)
        elif parameter.default is not None:
            value = default_value(parameter, sink)
        else:
            sink.add(
                names.MISSING_PARAMETER,
                f"the template needs the parameter '{name}'",
                use.origin,
                hint=f"{name}: {parameter.summary or parameter.type}",
            )
        if value is None:
            undetermined.add(name)
        else:
            bindings[name] = value
    outer = reading.environment
    return Environment(
        bindings,
        outer.values,
        frozenset(undetermined),
        not declared.all_read,
        outer.structural,
        outer.limits,
        declared.quantities,
        {name: outer.scope_of(text) or scope for name, text in given.items()},
    )


def _typed_binding(bound: Binding, parameter: Parameter, place: Place, reading: ReadingContext) -> Binding | None:
    if not isinstance(bound, Expression):
        return typed(format_value(bound), parameter, place, reading.sink)
    values = reading.environment.values
    try:
        present = reading.environment.settled(bound) if parameter.type in STRUCTURAL_KINDS else bound.evaluate(values)
    except ExpressionError as error:
        reading.sink.add(codes.BAD_EXPRESSION, str(error), place)
        return None
    value = typed(format_value(present), parameter, place, reading.sink)
    if value is None or parameter.type in STRUCTURAL_KINDS:
        return value
    reading.environment.keep_within(parameter.name, bound, parameter.limits)
    return bound


def typed(text: str, parameter: Parameter, place: Place, sink: Diagnostics) -> Value | None:
    """Return the value of a text for a parameter, in XML units; report one that does not fit, and return None."""
    kind = parameter.type
    if kind == "text":
        return text
    stripped = text.strip(" \t\r\n")
    if kind == "boolean":
        if stripped in ("true", "false"):
            return stripped == "true"
        return _misfit(text, parameter, "true or false", truth_hint(text), place, sink)
    if kind == "integer":
        if not re.fullmatch(INTEGER, stripped):
            return _misfit(text, parameter, "a whole number", "", place, sink)
    elif not re.fullmatch(NUMBER, stripped):
        unit = QUANTITIES[kind].unit
        expected = f"a number in {unit}" if unit not in ("", "1") else "a number"
        return _misfit(text, parameter, expected, number_hint(stripped, kind), place, sink)
    number = float(stripped)
    fault = out_of_limits(parameter.name, number, parameter.limits)
    if fault:
        sink.add(codes.OUT_OF_LIMITS, fault, place, hint=parameter.summary)
        return None
    return number


def parameter_kind(parameter: Parameter) -> str:
    """Return a readable description of a parameter's values: kind, unit and limits."""
    quantity = QUANTITIES.get(parameter.type)
    unit = f" in {quantity.unit}" if quantity is not None and quantity.unit not in ("", "1") else ""
    return ", ".join(part for part in (f"{parameter.type}{unit}", limits_text(parameter.limits)) if part)


def _misfit(text: str, parameter: Parameter, expected: str, hint: str, place: Place, sink: Diagnostics) -> Value | None:
    message = f"'{text}' is not {expected}, which the parameter '{parameter.name}' holds"
    sink.add(codes.WRONG_VALUE, message, place, hint=hint or parameter.summary)
    return None
