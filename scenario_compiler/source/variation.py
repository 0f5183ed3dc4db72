"""Checks a scenario's `<vary>`: its parameters are declared, and its values are within their limits."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, did_you_mean
from scenario_compiler.expressions import ExpressionError, format_value, parse_expression
from scenario_compiler.markup import codes, names
from scenario_compiler.source.parameters import Declared, typed
from scenario_compiler.vocabulary.grammar import outside
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.variation import Axis, Choice, Constraint, Grid, Poisson, Vary

BAD_VARIATION = Code(
    "SC250",
    "bad-variation",
    "A <vary> contains an invalid distribution, gives a parameter values of the wrong type or outside its limits, or "
    "varies a parameter twice:\n\n"
    '    <parameter name="gap" type="time" default="2" min="1" max="4"/>\n'
    '    <vary><uniform parameter="gap" least="0.5" greatest="3"/></vary>     0.5 is below the least value, 1\n\n'
    "Correct the numbers, or widen the parameter's limits. An integer needs whole numbers; a text or a boolean needs "
    "a <choice>.",
)


def check_variation(vary: Vary, declared: Declared, sink: Diagnostics) -> None:
    """Report the faults of a scenario's variation."""
    varied: set[str] = set()
    for axis in vary.axes:
        parameter = declared.known.get(axis.parameter)
        attribute, fault = axis.fault()
        if fault:
            sink.add(BAD_VARIATION, fault, axis.place_of(attribute))
        elif axis.parameter in varied:
            message = f"'{axis.parameter}' is varied twice"
            sink.add(BAD_VARIATION, message, axis.place_of("parameter"))
        elif parameter is not None:
            _check_values(axis, parameter, sink)
        elif declared.all_read:
            message = f"there is no parameter '{axis.parameter}' here"
            hint = did_you_mean(axis.parameter, declared.known)
            sink.add(names.UNKNOWN_PARAMETER, message, axis.place_of("parameter"), hint=hint)
        varied.add(axis.parameter)
    for constraint in vary.constraints:
        _check_constraint(constraint, declared, sink)


def _check_values(axis: Axis, parameter: Parameter, sink: Diagnostics) -> None:
    """Report values that the parameter cannot have."""
    if isinstance(axis, Choice):
        for text in axis.of:
            if typed(text, parameter, axis.place_of("of"), sink) is None:
                return
    elif parameter.type == "integer" and not (isinstance(axis, Poisson) or _counts(axis)):
        message = f"'{parameter.name}' is an integer, which needs whole numbers: a list, <poisson>, or steps of <grid>"
        sink.add(BAD_VARIATION, message, axis.place_of("parameter"))
    elif parameter.type in ("text", "boolean"):
        message = f"'{parameter.name}' is a {parameter.type}, which only <choice>, <values> and <weighted> vary"
        sink.add(BAD_VARIATION, message, axis.place_of("parameter"))
    for value in axis.extent():
        fault = outside(value, parameter.limits)
        if fault:
            message = f"{parameter.name} may become {format_value(value)}, but must be {fault}"
            sink.add(BAD_VARIATION, message, axis.origin)
            return


def _counts(axis: Axis) -> bool:
    """Return whether an axis is a grid of integers."""
    return isinstance(axis, Grid) and axis.first % 1.0 == 0.0 == (axis.last - axis.first) % max(axis.count - 1, 1)


def _check_constraint(constraint: Constraint, declared: Declared, sink: Diagnostics) -> None:
    """Report a constraint that cannot be read or names parameters that are not declared."""
    place = constraint.place_of("holds")
    try:
        expression = parse_expression(constraint.holds)
    except ExpressionError as error:
        sink.add(codes.BAD_EXPRESSION, str(error), place)
        return
    for name in expression.names:
        if name not in declared.known and declared.all_read:
            hint = did_you_mean(name, declared.known)
            sink.add(names.UNKNOWN_PARAMETER, f"there is no parameter '{name}' here", place, hint=hint)
