"""Converts an attribute's text to its value by its declaration: literals, expressions, units and limits."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import NoReturn, TypeAlias

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace, Place, did_you_mean
from scenario_compiler.document import Origin
from scenario_compiler.expressions import Expression, ExpressionError, Value, format_value, parse_expression
from scenario_compiler.markup import codes
from scenario_compiler.markup.environment import GivenName, ReadingContext, UndeterminedError, UnknownNameError
from scenario_compiler.markup.names import UNKNOWN_PARAMETER
from scenario_compiler.markup.units import in_unit
from scenario_compiler.vocabulary.grammar import INTEGER, NUMBER, AttributeRule, out_of_limits
from scenario_compiler.vocabulary.word import ENTITY_ID, IDENTIFIER, LABEL, QUANTITIES

Structural: TypeAlias = int | bool | float | str
FieldValue: TypeAlias = Structural | Expression | tuple[Structural, ...]

COMMAND_LINE = FilePlace("--set")
"""The place of diagnostics about arguments."""

SPACE = " \t\r\n"
"""White space in XML."""

PATTERNS = {
    LABEL: "a name of letters from A to Z and digits",
    IDENTIFIER: "a name of letters, digits and _, with no digit first",
    ENTITY_ID: "a name of letters, digits, _ and -, with a letter or _ first",
}
PATTERNS |= {f"({pattern})?": text for pattern, text in PATTERNS.items()}
"""What a text must be, by its pattern."""

MEANT_TRUTHS = {"true": ("true", "yes", "on", "1"), "false": ("false", "no", "off", "0")}
"""What authors write for a truth, in lower case."""

WITH_UNIT = {name for name, one in QUANTITIES.items() if one.unit not in ("", "1")}
"""Quantities that are measured in a unit."""

SCOPED = ("entity", "event", "traffic")
"""What a name may refer to that is local to the use of a template."""

_SPACES = re.compile(f"[{SPACE}]+")
_NUMBER = re.compile(rf"(?:{NUMBER})\Z")
_BRACED = re.compile(rf"\$?[{{(]\$?({IDENTIFIER})[)}}]?\Z")
_GROUPED = re.compile(r"[+-]?[0-9]{1,3}(?:,[0-9]{3})+(?![0-9,])")
_INTEGER = re.compile(rf"(?:{INTEGER})\Z")


class UnreadError(Exception):
    """An attribute has no value; either its fault has been reported or the value is not determined."""


def read_attribute(text: str, rule: AttributeRule, reading: ReadingContext, origin: Origin) -> FieldValue:
    """Return the value of an attribute's text in SI units; report a fault and raise UnreadError if it has none."""
    if rule.kind == "number":
        report_quantity(text, rule.name, rule.spelling.quantity, reading, origin)
    try:
        expression = reading.environment.symbolic(text)
        if rule.kind == "number":
            return _number(text, expression, rule, reading, origin)
        settled = text if expression is None else format_value(reading.environment.settled(expression))
    except UndeterminedError:
        raise UnreadError from None
    except ExpressionError as error:
        report_expression(error, text, reading.sink, origin)
        raise UnreadError from None
    value = _structural(settled, rule, reading, origin)
    scope = reading.environment.scope_of(text) if rule.spelling.names in SCOPED else None
    return value if scope is None else _meant_in(scope, value)


def _meant_in(scope: object, value: FieldValue) -> FieldValue:
    """Return a name or names as they are meant in the scope in which they were written."""
    if isinstance(value, tuple):
        return tuple(GivenName.of(one, scope) if isinstance(one, str) else one for one in value)
    return GivenName.of(value, scope) if isinstance(value, str) else value


def _number(
    text: str, expression: Expression | None, rule: AttributeRule, reading: ReadingContext, origin: Origin
) -> float | Expression:
    quantity = QUANTITIES.get(rule.spelling.quantity)
    factor = quantity.factor if quantity else 1.0
    if expression is None:
        literal = _literal_number(text, rule, reading, origin)
        _check_limits(literal, rule, reading, origin)
        return literal * factor
    if isinstance(expression.evaluate(reading.environment.values), bool):
        raise ExpressionError(f"'{expression.text}' is true or false, not a number; write if(test, a, b)")
    present = expression.number(reading.environment.values)
    _check_limits(present, rule, reading, origin)
    if not expression.names:
        return present * factor
    reading.environment.keep_within(rule.name, expression, rule.spelling)
    return expression if factor == 1.0 else parse_expression(f"radians({expression.text})")


def report_quantity(text: str, name: str, quantity: str, reading: ReadingContext, place: Place) -> None:
    """Report a text that names a parameter of another quantity than a number needs.

    Args:
        text: The text.
        name: Name of the attribute or the parameter that it gives a value to.
        quantity: The needed quantity, a key of `QUANTITIES`; numbers and fractions take any parameter.
        reading: The context.
        place: Place of the text.
    """
    given = reading.environment.quantity_of(text)
    if given != quantity and {given, quantity} <= WITH_UNIT:
        units = [QUANTITIES[one].unit for one in (quantity, given)]
        message = f"{name} is in {units[0]}, but the parameter '{text.strip('${} ')}' is in {units[1]}"
        reading.sink.add(codes.WRONG_QUANTITY, message, place)


def _structural(text: str, rule: AttributeRule, reading: ReadingContext, origin: Origin) -> FieldValue:
    if rule.spelling.separated:
        words = [word for word in _SPACES.split(text) if word]
        if not words:
            _wrong(text, rule, reading, origin)
        if any(word.strip("${}") in reading.environment.bindings for word in words if word.startswith("$")):
            message = f"in '{text}' no parameter is replaced; a list is written out, or one parameter as a whole"
            reading.sink.add(codes.WRONG_VALUE, f"{message} ({rule.name}: {rule.description})", origin)
            raise UnreadError
        return tuple(_single(word, rule, reading, origin) for word in words)
    return _single(text, rule, reading, origin)


def _single(text: str, rule: AttributeRule, reading: ReadingContext, origin: Origin) -> Structural:
    stripped = text.strip(SPACE)
    if rule.kind == "fixed_number":
        number = _literal_number(text, rule, reading, origin)
        _check_limits(number, rule, reading, origin)
        quantity = QUANTITIES.get(rule.spelling.quantity)
        return number * (quantity.factor if quantity else 1.0)
    if rule.kind == "integer":
        if not _INTEGER.match(stripped):
            _wrong(text, rule, reading, origin)
        _check_limits(int(stripped), rule, reading, origin)
        return int(stripped)
    if rule.kind == "boolean":
        if stripped not in ("true", "false"):
            _wrong(text, rule, reading, origin)
        return stripped == "true"
    if rule.kind == "choice":
        if stripped not in rule.choices:
            _wrong(text, rule, reading, origin)
        return stripped
    if rule.spelling.pattern:
        if not re.fullmatch(rule.spelling.pattern, stripped):
            _wrong(text, rule, reading, origin)
        return stripped
    if rule.required and not text:
        _wrong(text, rule, reading, origin)
    return text


def _literal_number(text: str, rule: AttributeRule, reading: ReadingContext, origin: Origin) -> float:
    stripped = text.strip(SPACE)
    if not _NUMBER.match(stripped):
        _wrong(text, rule, reading, origin)
    return float(stripped)


def _wrong(text: str, rule: AttributeRule, reading: ReadingContext, origin: Origin) -> NoReturn:
    expected, hint = _expected(text, rule)
    fault = f"'{text}' is not {expected}" if expected else f"{rule.name} is empty"
    reading.sink.add(codes.WRONG_VALUE, f"{fault} ({rule.name}: {rule.description})", origin, hint=hint)
    raise UnreadError


def _expected(text: str, rule: AttributeRule) -> tuple[str, str]:
    if rule.kind == "choice":
        instead = dict(rule.spelling.retired).get(text)
        if instead is not None:
            return f"one of {', '.join(rule.choices)}", f"write {instead}"
        parts = [part for part in text.split(",") if part]
        if rule.spelling.separated and "," in text and parts and set(parts) <= set(rule.choices):
            return f"one of {', '.join(rule.choices)}", "separate the values by spaces, without commas"
        hint = did_you_mean(text, rule.choices)
        return f"one of {', '.join(rule.choices)}", hint if hint.startswith("did") else ""
    if rule.kind == "boolean":
        return "true or false", truth_hint(text)
    if rule.kind == "integer":
        return "a whole number", ""
    if rule.kind == "text":
        if rule.spelling.pattern:
            return PATTERNS.get(rule.spelling.pattern, f"of the form {rule.spelling.pattern}"), ""
        return "", ""
    quantity = QUANTITIES.get(rule.spelling.quantity)
    unit = f" in {quantity.unit}" if quantity and quantity.unit not in ("", "1") else ""
    return f"a number{unit}", number_hint(text, rule.spelling.quantity)


def truth_hint(text: str) -> str:
    """Return a hint for a text that another program would take for true or false; empty for other texts."""
    return next((f"write {one}" for one, known in MEANT_TRUTHS.items() if text.strip(SPACE).lower() in known), "")


def number_hint(text: str, quantity: str) -> str:
    """Return a hint for a number with a unit, with commas or in a bare expression; empty for other texts.

    A comma before three digits may separate thousands or be a decimal comma: the hint has both readings.
    """
    braced = _BRACED.match(text.strip(SPACE))
    if braced:
        return f"write ${braced[1]} for the value of a parameter"
    if "$" in text:
        return "write the whole expression in ${...}, as in ${2 * $speed}"
    meant = [text.replace(",", "")] if _GROUPED.match(text.strip(SPACE)) else []
    written = []
    for one in (*meant, text.replace(",", ".")):
        converted = in_unit(one, quantity) or (one.strip(SPACE) if _NUMBER.match(one.strip(SPACE)) else "")
        if converted and converted not in written:
            written.append(converted)
    return f"write {' or '.join(written)}" if written else ""


def _check_limits(number: float, rule: AttributeRule, reading: ReadingContext, origin: Origin) -> None:
    fault = out_of_limits(rule.name, number, rule.spelling)
    if fault:
        reading.sink.add(codes.OUT_OF_LIMITS, fault, origin, hint=rule.description)
        raise UnreadError


def report_expression(error: ExpressionError, text: str, sink: Diagnostics, origin: Place) -> None:
    """Report an expression that cannot be read or has no value, at the faulty character."""
    place: Place = origin
    if origin.length == len(text) and "\n" not in text and error.offset:
        place = FilePlace(origin.file, origin.line, origin.column + error.offset, 1, origin.source_line, origin.within)
    code: Code = codes.BAD_EXPRESSION
    hint = ""
    if isinstance(error, UnknownNameError):
        code, hint = UNKNOWN_PARAMETER, error.hint
        if isinstance(place, FilePlace):
            place = replace(place, length=len(error.name))
    sink.add(code, str(error), place, hint=hint)


def bound_value(text: str, reading: ReadingContext, origin: Place) -> Expression | Value | None:
    """Return the value or expression for a text of any type, or the text itself; None if it has a fault."""
    try:
        expression = reading.environment.symbolic(text)
        if expression is None:
            return text
        if expression.names:
            expression.evaluate(reading.environment.values)
            return expression
        return expression.evaluate({})
    except UndeterminedError:
        return None
    except ExpressionError as error:
        report_expression(error, text, reading.sink, origin)
        return None
