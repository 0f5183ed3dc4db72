"""The XML element of a word, derived once from its declaration for both the reader and the XSD.

An element has attributes in any order, and children in the order of the word's fields. Where a field accepts several
kinds of words, or any number of them, these may be mixed.
"""

import re
import types
from collections.abc import Iterator, Mapping
from functools import cache
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from scenario_compiler.expressions import Expression, ExpressionError, Value, format_value
from scenario_compiler.records import Field
from scenario_compiler.vocabulary.word import (
    QUANTITIES,
    AttributeSpelling,
    ChildSpelling,
    OtherAttributesSpelling,
    Word,
    spelling_of,
)

NUMBER = r"[+\-]?([0-9]{1,30}(\.[0-9]{1,30})?|\.[0-9]{1,30})([eE][+\-]?[0-9]{1,2})?"
"""A number as written in XML: always finite, not hexadecimal, with a digit after the point."""

INTEGER = r"[+\-]?[0-9]{1,9}"
"""A whole number as written in XML."""

EXPRESSION = r"[$][A-Za-z_][A-Za-z0-9_.]*|[$]\{[ \t\r\n]*[^{} \t\r\n][^{}]*\}"
"""A parameter, `$name`, or an expression over parameters, `${...}`, instead of a literal; `${}` is not an expression.

The schema accepts any expression for any value, because its value is not a matter of form; the reader checks the value.
"""

AttributeKind = Literal["number", "fixed_number", "integer", "boolean", "choice", "text"]
"""Kinds of attribute values. A `number` may stay open in a plan; the other kinds determine structure."""


class AttributeRule(NamedTuple):
    """An attribute that an element may have.

    Attributes:
        name: Its name in XML.
        field: The word's field with its value.
        kind: Kind of its value.
        spelling: What the declaration says about it: the quantity, the limits in the XML unit, and more.
        description: What it means, with its unit.
        required: It must be given.
        default: The field's value if it is not given, in the internal unit; None if it is required.
        choices: The allowed words of a `choice`; empty for the other kinds.
    """

    name: str
    field: str
    kind: AttributeKind
    spelling: AttributeSpelling
    description: str
    required: bool
    default: Any
    choices: tuple[str, ...] = ()


class ChildRule(NamedTuple):
    """The children that an element may have at one place of its order.

    Attributes:
        field: The word's field that contains them.
        wrapper: Tag of the element around them; empty if they stand directly in the parent.
        words: Tag to word type, in the order of the declaration.
        description: What they mean.
        required: At least one is required.
        many: Any number is allowed.
    """

    field: str
    wrapper: str
    words: Mapping[str, type[Word]]
    description: str
    required: bool
    many: bool

    @property
    def tags(self) -> tuple[str, ...]:
        """The tags that are allowed in the parent."""
        return (self.wrapper,) if self.wrapper else tuple(self.words)


class Grammar(NamedTuple):
    """The XML element of a word.

    Attributes:
        attributes: By name, in the order of the declaration.
        children: In the order required in a file.
        others: Field that collects attributes with any other name; empty if none are allowed.
    """

    attributes: Mapping[str, AttributeRule]
    children: tuple[ChildRule, ...]
    others: str = ""

    def attribute_of(self, field: str) -> AttributeRule:
        """Return the attribute that belongs to a field of the word."""
        return next(rule for rule in self.attributes.values() if rule.field == field)


@cache
def grammar_of(word: type[Word]) -> Grammar:
    """Return the XML element of a word."""
    attributes: dict[str, AttributeRule] = {}
    children: list[ChildRule] = []
    others = ""
    for field, info in word.model_fields.items():
        spelling = spelling_of(info)
        if isinstance(spelling, AttributeSpelling):
            rule = _attribute_rule(field, info, spelling)
            attributes[rule.name] = rule
        elif isinstance(spelling, ChildSpelling):
            children.append(_child_rule(field, info, spelling))
        elif isinstance(spelling, OtherAttributesSpelling):
            others = field
    return Grammar(attributes, tuple(children), others)


def _attribute_rule(field: str, info: Field, spelling: AttributeSpelling) -> AttributeRule:
    kind, choices = _attribute_kind(info.annotation)
    return AttributeRule(
        name=spelling.name or field,
        field=field,
        kind=kind,
        spelling=spelling,
        description=info.description,
        required=info.is_required(),
        default=None if info.is_required() else info.default,
        choices=choices,
    )


def _attribute_kind(annotation: object) -> tuple[AttributeKind, tuple[str, ...]]:
    members = _members(annotation)
    if Expression in members:
        return "number", ()
    kinds: dict[Any, AttributeKind] = {float: "fixed_number", int: "integer", bool: "boolean", str: "text"}
    member = members[0]
    if get_origin(member) is Literal:
        return "choice", tuple(str(value) for value in get_args(member))
    return kinds[member], ()


def _child_rule(field: str, info: Field, spelling: ChildSpelling) -> ChildRule:
    members = _members(info.annotation)
    return ChildRule(
        field=field,
        wrapper=spelling.wrapper,
        words={member.tag(): member for member in members},
        description=info.description,
        required=info.is_required(),
        many=get_origin(info.annotation) is tuple,
    )


def _members(annotation: object) -> list[Any]:
    """Return the types that an annotation allows, without None, tuples and Annotated."""
    origin = get_origin(annotation)
    if origin in (Union, types.UnionType):
        return [member for part in get_args(annotation) for member in _members(part)]
    if origin is tuple:
        return _members(get_args(annotation)[0])
    if origin is Annotated:
        return _members(get_args(annotation)[0])
    return [] if annotation is type(None) else [annotation]


def limits_text(spelling: AttributeSpelling) -> str:
    """Return the limits of a number in words, in the XML unit; empty without limits."""
    parts = []
    if spelling.minimum is not None:
        parts.append(f"{'above' if spelling.exclusive else 'from'} {format_value(float(spelling.minimum))}")
    if spelling.maximum is not None:
        parts.append(f"to {format_value(float(spelling.maximum))}")
    return " ".join(parts)


def outside(number: float, limits: AttributeSpelling) -> str:
    """Return the limit that a number violates, in words, in the XML unit; empty if it violates none."""
    low, high = limits.minimum, limits.maximum
    if low is not None and (number < low or (limits.exclusive and number == low)):
        return f"{'greater than' if limits.exclusive else 'at least'} {format_value(float(low))}"
    if high is not None and number > high:
        return f"at most {format_value(float(high))}"
    return ""


def out_of_limits(name: str, number: float, limits: AttributeSpelling) -> str:
    """Return a sentence on the limit that a number violates, in the XML unit; empty if it violates none."""
    broken = outside(number, limits)
    return f"{name} is {format_value(float(number))}, but must be {broken}" if broken else ""


def empty_texts(word: Word) -> Iterator[str]:
    """Yield the fields of a word that a program made whose text is empty, although the element needs one."""
    for rule in grammar_of(type(word)).attributes.values():
        pattern = rule.spelling.pattern
        needed = re.fullmatch(pattern, "") is None if pattern else rule.required
        if needed and rule.kind == "text" and getattr(word, rule.field) == "":
            yield rule.field


def limits_broken(word: Word, values: Mapping[str, Value]) -> Iterator[str]:
    """Yield a sentence for each number of a word that violates its limits; numbers and limits are in SI units.

    A word that is read from XML is checked while it is read; this is for one that a program or a JSON file made.
    Default values and expressions without a value are not checked.

    Args:
        word: The word.
        values: The values of the parameters in expressions.
    """
    for rule in grammar_of(type(word)).attributes.values():
        number = _number_of(getattr(word, rule.field), values)
        if number is not None and number != rule.default:
            broken = out_of_limits(rule.field, number, _in_si(rule.spelling))
            if broken:
                yield broken


def _number_of(value: object, values: Mapping[str, Value]) -> float | None:
    if isinstance(value, Expression):
        try:
            return value.number(values)
        except ExpressionError:
            return None
    return value if isinstance(value, int | float) and not isinstance(value, bool) else None


def _in_si(limits: AttributeSpelling) -> AttributeSpelling:
    """Return the limits of a number in the unit of a word's field."""
    factor = QUANTITIES[limits.quantity].factor if limits.quantity in QUANTITIES else 1.0
    low, high = limits.minimum, limits.maximum
    return limits._replace(
        minimum=None if low is None else low * factor, maximum=None if high is None else high * factor
    )
