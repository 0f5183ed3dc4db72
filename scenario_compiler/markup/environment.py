"""The environment for reading a part of a file: the meanings of names, the values of parameters, the sink."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics, Place, did_you_mean
from scenario_compiler.document import Document, Origin
from scenario_compiler.expressions import Expression, ExpressionError, Value, parse_expression
from scenario_compiler.vocabulary.word import AttributeSpelling, Word

_PARAMETER = re.compile(r"\$([A-Za-z_][A-Za-z0-9_.]*)\Z")
_EXPRESSION = re.compile(r"\$\{([ \t\r\n]*[^{} \t\r\n][^{}]*)\}\Z")

Binding: TypeAlias = Expression | Value


class UnknownNameError(ExpressionError):
    """An expression uses a name that is not defined."""

    def __init__(self, name: str, offset: int, hint: str) -> None:
        """Set the name, its offset and a hint."""
        super().__init__(f"there is no parameter '{name}' here", offset)
        self.name = name
        self.hint = hint


class GivenName(str):
    """A name that was written in the surroundings of the element that uses it, such as in the use of a template.

    Attributes:
        scope: The names that are known where it was written.
    """

    scope: Any

    @classmethod
    def of(cls, name: str, scope: object) -> GivenName:
        """Return a name as it is meant in a scope."""
        given = cls(name)
        given.scope = scope
        return given


class UndeterminedError(Exception):
    """The value depends on a parameter without a value; this is not a fault, as in a template without a use."""


@dataclass
class Environment:
    """The parameters that a part of a file may use.

    Attributes:
        bindings: The meaning of each name: a value, or an expression over the scenario's open parameters.
        values: Values of the scenario's open parameters, in XML units.
        undetermined: Names without a value: in a template that is read without a use, or with a faulty declaration.
        lenient: Whether a declaration could not be read, so that unknown names are not reported.
        structural: Open parameters on which something other than a number depends; filled while reading.
        limits: Limits of numbers that depend on open parameters, each once, in the order of reading.
        quantities: Quantities of the parameters that the part declares itself.
        scopes: The names that are known where the value of a parameter was written, if that is outside of the part.
        declares: Whether declarations of parameters are read, which cannot depend on other parameters.
    """

    bindings: Mapping[str, Binding] = field(default_factory=dict)
    values: Mapping[str, Value] = field(default_factory=dict)
    undetermined: frozenset[str] = frozenset()
    lenient: bool = False
    structural: set[str] = field(default_factory=set)
    limits: dict[tuple[str, str, AttributeSpelling], Expression] = field(default_factory=dict)
    quantities: Mapping[str, str] = field(default_factory=dict)
    scopes: Mapping[str, object] = field(default_factory=dict)
    declares: bool = False

    def with_value(self, name: str, value: Value, scope: object) -> Environment:
        """Return the environment with the value of one more name, which hides another of the same name.

        Args:
            name: The name.
            value: Its value.
            scope: The names that are known where the value is written.
        """
        return replace(
            self,
            bindings={**self.bindings, name: value},
            undetermined=self.undetermined - {name},
            quantities={one: quantity for one, quantity in self.quantities.items() if one != name},
            scopes={**self.scopes, name: scope},
        )

    def quantity_of(self, text: str) -> str:
        """Return the quantity of the parameter to which a text refers without calculating; empty for another text."""
        return self.quantities.get(_alone(text), "")

    def scope_of(self, text: str) -> object:
        """Return the names that are known where the value of the parameter to which a text refers was written.

        None if the text does not refer to a parameter without calculating, or if its value is the part's own.
        """
        return self.scopes.get(_alone(text))

    def undecided(self, more: Iterable[str] = ()) -> Environment:
        """Return the environment in which the same names and `more` are known but have no values."""
        return Environment(undetermined=frozenset({*self.bindings, *self.undetermined, *more}), lenient=self.lenient)

    def symbolic(self, text: str) -> Expression | None:
        """Return the expression for `$name` or `${expression}` over the scenario's open parameters; None for a literal.

        Raises:
            ExpressionError: The expression is malformed or uses an unknown name; the offset is into `text`.
            UndeterminedError: It depends on a parameter without a value.
        """
        inner, start = _inner(text)
        if inner is None:
            return None
        try:
            expression = parse_expression(inner)
        except ExpressionError as error:
            raise ExpressionError(str(error), error.offset + start) from None
        for name in expression.names:
            if name in self.undetermined or (self.lenient and name not in self.bindings):
                raise UndeterminedError(name)
            if name not in self.bindings:
                raise UnknownNameError(name, start + _find(name, inner), self._hint_about(name))
        meant = expression.substitute(self.bindings)
        if meant.names and not meant.bounded:
            raise ExpressionError("the expression becomes too long when its names are replaced by their values", start)
        return meant

    def _hint_about(self, unknown: str) -> str:
        if self.declares:
            return "a declaration cannot depend on other parameters; write a value here, and calculate where it is used"
        return did_you_mean(unknown, self.bindings) or "declare it with <parameter name=... type=... default=.../>"

    def keep_within(self, holder: str, expression: Expression, limits: AttributeSpelling) -> None:
        """Store the limits of a number that stays open, by the name of the attribute or parameter that has it."""
        if expression.names:
            self.limits.setdefault((holder, expression.text, limits), expression)

    def settled(self, expression: Expression) -> Value:
        """Return the present value of an expression that determines structure, and store its parameters."""
        self.structural.update(expression.names)
        return expression.evaluate(self.values)


class ReadingContext(NamedTuple):
    """The context in which a word is read.

    Attributes:
        document: Its document.
        sink: Receives the diagnostics.
        environment: The parameters that it may use.
        within: The use that inserted it.
        unread: Values by field that words of these types get for required parts that cannot be read; words of other
            types are left out if such a part cannot be read.
    """

    document: Document
    sink: Diagnostics
    environment: Environment
    within: Place | None = None
    unread: Mapping[type[Word], Mapping[str, object]] = MappingProxyType({})

    def origin(self, element: etree._Element, attribute: str | None = None) -> Origin:
        """Return the place of an element or attribute."""
        return self.document.origin(element, attribute, self.within)


def _inner(text: str) -> tuple[str | None, int]:
    """Return the expression inside an attribute's text and the offset at which it starts."""
    if "$" not in text:
        return None, 0
    stripped = text.strip(" \t\r\n")
    lead = text.find(stripped)
    for pattern in (_PARAMETER, _EXPRESSION):
        match = pattern.match(stripped)
        if match:
            return match.group(1), lead + match.start(1)
    return None, 0


def _alone(text: str) -> str:
    """Return the name of the parameter to which a text refers without calculating; empty for another text."""
    return (_inner(text)[0] or "").strip().removeprefix("$")


def _find(name: str, text: str) -> int:
    match = re.search(rf"(?<![A-Za-z0-9_.]){re.escape(name)}(?![A-Za-z0-9_.])", text)
    return match.start() if match else 0
