"""Parameters in scope: the meanings of `$name` and `${expression}` at a place of an OpenSCENARIO file.

A numeric parameter of the scenario remains open where a number uses it, so that a sweep varies it in one plan. Anything
else uses the parameter's present value, and the parameter is recorded as structural.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from scenario_compiler.diagnostics import Place, did_you_mean
from scenario_compiler.expressions import Expression, ExpressionError, Value, format_value, parse_expression
from scenario_compiler.markup.environment import UnknownNameError

NUMERIC = ("double", "integer", "int", "unsignedInt", "unsignedShort")
"""Types of numeric parameters; 1.0 has `integer`."""

_NAME = re.compile(r"\$([^\s${}]+)\Z")
_EXPRESSION = re.compile(r"\$\{(.*)\}\Z", re.DOTALL)
_INSIDE = re.compile(r"(?<!\\)\$([A-Za-z_][A-Za-z0-9_]*)")
_OPEN_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*\Z")


@dataclass(frozen=True)
class Bound:
    """The meaning of a parameter.

    Attributes:
        type: Its ParameterType.
        text: Its present value, as it would be written in an attribute.
        expression: Its value as an expression of the scenario's open parameters, for a number that depends on some.
        place: The place of its value, if that is not the declaration.
    """

    type: str
    text: str
    expression: Expression | None = None
    place: Place | None = None

    @property
    def value(self) -> Value:
        """The present value: a boolean, a number (also if a text contains one), or a text."""
        if self.type == "boolean":
            return self.text in ("true", "1")
        number = literal_number(self.text)
        return self.text if number is None else number


@dataclass(frozen=True)
class Scope:
    """The parameters that an element may use.

    Attributes:
        bound: By name.
        values: Present values of the scenario's open parameters; filled as they are declared.
        structural: Open parameters on which something other than a number depends; filled while reading.
    """

    bound: Mapping[str, Bound] = field(default_factory=dict)
    values: dict[str, Value] = field(default_factory=dict)
    structural: set[str] = field(default_factory=set)

    def inner(self, more: Mapping[str, Bound]) -> Scope:
        """Return the scope with more parameters, which hide others of the same names."""
        return Scope({**self.bound, **more}, self.values, self.structural) if more else self

    def symbolic(self, text: str) -> Expression | str:
        """Return the meaning of a text: itself, a parameter's text, or an expression of open parameters.

        An expression that exceeds the limits of length or depth is replaced by its present value.

        Raises:
            ExpressionError: An expression is malformed, or a name is unknown; the offset is into `text`.
        """
        stripped = text.strip()
        lead = text.find(stripped)
        name = _NAME.match(stripped)
        if name is not None:
            one = self._find(name.group(1), lead + 1)
            return one.text if one.expression is None else one.expression
        inner = _EXPRESSION.match(stripped)
        if inner is None:
            return text.replace("\\$", "$")
        start = lead + inner.start(1)
        try:
            expression = parse_expression(inner.group(1))
        except ExpressionError as error:
            raise ExpressionError(str(error), error.offset + start) from None
        replacements: dict[str, Expression | Value] = {}
        for used in expression.names:
            one = self._find(used, start + max(0, inner.group(1).find(used)))
            replacements[used] = one.value if one.expression is None else one.expression
        expression = expression.substitute(replacements)
        if expression.names and expression.bounded:
            return expression
        self.structural.update(expression.names)
        return format_value(expression.evaluate(self.values))

    def text(self, text: str) -> str:
        """Return the present text; open parameters that it depends on become structural. Raises as `symbolic` does."""
        found = self.symbolic(text)
        if isinstance(found, str):
            return found
        self.structural.update(found.names)
        return format_value(found.evaluate(self.values))

    def joined(self, text: str) -> str | None:
        """Return the concatenated texts and parameters of `${a + b}`, because real files combine names in this way.

        None for other texts, and if a parameter is unknown.
        """
        inner = _EXPRESSION.match(text.strip())
        parts = [part.strip() for part in inner.group(1).split("+")] if inner else []
        if not parts or any("$" in part and part[1:] not in self.bound for part in parts):
            return None
        return "".join(self.bound[part[1:]].text if part.startswith("$") else part for part in parts)

    def inside(self, text: str) -> str:
        """Return the first parameter whose name is a part of a longer text, where it is not replaced; '' if none is."""
        if _EXPRESSION.match(text.strip()):
            return ""
        names = (found.group(1) for found in _INSIDE.finditer(text.strip()) if found.group() != text.strip())
        return next((name for name in names if name in self.bound), "")

    def opened(self, name: str, one: Bound) -> Bound:
        """Return the scenario's parameter as an open one, if it is a number and its name is possible in expressions."""
        value = one.value
        if one.expression is not None or one.type not in NUMERIC or not _OPEN_NAME.match(name):
            return one
        self.values[name] = value
        return Bound(one.type, one.text, parse_expression(f"${name}"))

    def _find(self, name: str, offset: int) -> Bound:
        if name not in self.bound:
            part = self.inside(f"${name}")
            whole = f"'${part}' is replaced only if it is the whole value" if part else ""
            hint = whole or did_you_mean(name, self.bound) or "declare it in <ParameterDeclarations>"
            raise UnknownNameError(name, offset, hint)
        return self.bound[name]


def literal_number(text: str) -> float | None:
    """Return the finite number in a text, 1e10 for XML Schema's INF; None if there is none."""
    stripped = text.strip()
    if stripped in ("INF", "+INF", "-INF", "inf", "-inf"):
        return -LARGE if stripped.startswith("-") else LARGE
    if not _NUMBER.match(stripped):
        return None
    number = float(stripped)
    return number if abs(number) <= MOST else None


def described_number(text: str) -> str:
    """Return in words what is expected in place of a text in which `literal_number` finds no number.

    That is a smaller number if the text is one, otherwise a number.
    """
    return f"a number of at most {MOST:g}" if _NUMBER.match(text.strip()) else "a number"


LARGE = 1.0e10
"""Value for an infinite limit."""

MOST = 1.0e300
"""Largest number that is accepted: sums and products of a few of them stay finite where it matters."""

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?\Z")
