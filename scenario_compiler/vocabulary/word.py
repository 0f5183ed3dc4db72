"""The declaration of a word of the language: its fields, units, limits and XML spelling, all in one place.

A word is a record. A field declared with `attribute` is an XML attribute; one declared with `child` is a child
element (or several), always of another word's type. The reader, the XSD, the JSON schema and the help texts are all
derived from these declarations.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple, TypeAlias

from scenario_compiler.diagnostics import FilePlace, Place
from scenario_compiler.document import Origin
from scenario_compiler.expressions import Expression, Value, parse_expression
from scenario_compiler.records import REQUIRED, Field, Record

if sys.version_info >= (3, 11):
    from typing import Self
else:
    from typing_extensions import Self

if TYPE_CHECKING:
    from pydantic_core import CoreSchema


class Quantity(NamedTuple):
    """A quantity: its unit in XML, and the factor to the SI unit used internally."""

    name: str
    unit: str
    factor: float = 1.0


QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("number", ""),
        Quantity("fraction", "1"),
        Quantity("length", "m"),
        Quantity("time", "s"),
        Quantity("speed", "m/s"),
        Quantity("acceleration", "m/s2"),
        Quantity("angle", "deg", 0.017453292519943295),
        Quantity("angle_rate", "deg/s", 0.017453292519943295),
        Quantity("angle_random_walk", "deg/sqrt(s)", 0.017453292519943295),
        Quantity("grey_levels", "grey levels"),
        Quantity("level", "dB"),
    )
}


def _number(value: Any) -> Any:
    if isinstance(value, dict) and set(value) == {"expr"} and isinstance(value["expr"], str):
        return parse_expression(value["expr"])
    return value


def _plain(value: float | Expression) -> float | dict[str, str]:
    return {"expr": value.text} if isinstance(value, Expression) else value


@cache
def _schema_of_numbers() -> CoreSchema:
    """Return pydantic's schema of a number. Hundreds of fields share it, because building it is half of their cost."""
    from pydantic_core import core_schema

    return core_schema.no_info_before_validator_function(
        _number,
        core_schema.union_schema(
            [core_schema.float_schema(allow_inf_nan=False), core_schema.is_instance_schema(Expression)]
        ),
        serialization=core_schema.plain_serializer_function_ser_schema(_plain),
    )


class _NumberSchema:
    """Tells pydantic how a number is checked and written as JSON."""

    def __get_pydantic_core_schema__(self, source: object, handler: object) -> CoreSchema:
        return _schema_of_numbers()

    def __get_pydantic_json_schema__(self, schema: object, handler: object) -> dict[str, Any]:
        return {"anyOf": [{"type": "number"}, {"additionalProperties": {"type": "string"}, "type": "object"}]}


Number = Annotated[float | Expression, _NumberSchema()]
"""A literal, or an expression over the scenario's parameters that stays open until a run binds them. SI unit."""


def number_value(number: float | Expression, values: Mapping[str, Value]) -> float:
    """Return a number at the given parameter values; raises ExpressionError if it has no value."""
    return number.number(values) if isinstance(number, Expression) else float(number)


class Word(Record):
    """A word of the scenario language.

    A subclass that is an XML element declares its tag as the only value of a field `word`. In JSON this field also
    distinguishes the members of a union.
    """

    __slots__ = ("_origin",)

    moved: ClassVar[Mapping[str, str]] = MappingProxyType({})
    """Former attributes that now belong to another word, each with the replacement that the hint shows."""

    @classmethod
    def tag(cls) -> str:
        """Return the name of the word's XML element; empty for words that are not a single element."""
        return str(getattr(cls, "word", ""))

    @property
    def origin(self) -> Place:
        """The place in the file where the author wrote the word; a nameless place for words made by programs."""
        return self._written_at or FilePlace("<python>")

    @property
    def _written_at(self) -> Place | None:
        origin: Place | None = getattr(self, "_origin", None)
        return origin

    def place_of(self, attribute: str) -> Place:
        """Return the place of one of the word's attributes in the file; the attribute is named as in XML."""
        origin = self._written_at
        return origin.of(attribute) if isinstance(origin, Origin) else self.origin

    def written(self, attribute: str) -> str | None:
        """Return the text of one of the word's attributes in the file, named as in XML; None if it is not written."""
        origin = self._written_at
        return origin.element.get(attribute) if isinstance(origin, Origin) else None

    def written_at(self, origin: Place) -> Self:
        """Store the place where the word was written, and return the word."""
        object.__setattr__(self, "_origin", origin)
        return self

    def model_copy(self, *, update: Mapping[str, Any] | None = None) -> Self:
        """Return a copy from the same place, with other values of some fields, which are not checked."""
        copied, origin = super().model_copy(update=update), self._written_at
        return copied if origin is None else copied.written_at(origin)


class AttributeSpelling(NamedTuple):
    """The spelling of a field as an XML attribute.

    Attributes:
        name: The attribute's name in XML; empty if it is the field's own name.
        quantity: Key of QUANTITIES for numbers, empty for everything else.
        minimum: Least value, in the XML unit; None for no limit.
        maximum: Greatest value, in the XML unit; None for no limit.
        exclusive: The least value itself is not allowed.
        names: Kind of thing that the text refers to: "entity", "road", "map", ... or empty.
        defines: Kind of thing that the text gives a name to, or empty.
        expression: The text is an expression over parameters, written without `${}`.
        separated: The text is a space-separated list.
        pattern: Regular expression that the whole text must match, in the syntax common to Python and XML Schema; empty
            for any text.
        retired: Former values and those of other languages, each with its replacement, which the hint shows.
    """

    name: str = ""
    quantity: str = ""
    minimum: float | None = None
    maximum: float | None = None
    exclusive: bool = False
    names: str = ""
    defines: str = ""
    expression: bool = False
    separated: bool = False
    pattern: str = ""
    retired: tuple[tuple[str, str], ...] = ()


class ChildSpelling(NamedTuple):
    """The spelling of a field as a child element.

    Attributes:
        wrapper: Tag of an element that contains the choice (`<start><lane .../></start>`); empty if the words stand
            directly in their parent.
    """

    wrapper: str = ""


@dataclass(frozen=True, slots=True)
class OtherAttributesSpelling:
    """The field collects all attributes whose names are not declared, as name and text."""


Spelling: TypeAlias = AttributeSpelling | ChildSpelling | OtherAttributesSpelling

IDENTIFIER = "[A-Za-z_][A-Za-z0-9_]*"
"""Pattern of the names in expressions."""

LABEL = "[A-Za-z0-9]+"
"""Pattern of a label of BIDS: letters and digits alone."""

ENTITY_ID = "[A-Za-z_][A-Za-z0-9_\\-]*"
"""Pattern of an entity's id in a file. A use of a template prefixes it with the use's name and a point."""


def attribute(
    description: str,
    *,
    default: Any = REQUIRED,
    name: str = "",
    quantity: str = "",
    minimum: float | None = None,
    maximum: float | None = None,
    exclusive: bool = False,
    names: str = "",
    defines: str = "",
    expression: bool = False,
    separated: bool = False,
    pattern: str = "",
    retired: tuple[tuple[str, str], ...] = (),
) -> Any:
    """Declare a field that XML writes as an attribute. Limits are in the XML unit of `quantity`."""
    spelling = AttributeSpelling(
        name, quantity, minimum, maximum, exclusive, names, defines, expression, separated, pattern, retired
    )
    return Field(default, description=description, metadata=(spelling,))


def child(
    description: str,
    *,
    default: Any = REQUIRED,
    default_factory: Callable[[], Any] | None = None,
    wrapper: str = "",
) -> Any:
    """Declare a field that XML writes as a child element; a tuple-typed field takes any number of them."""
    metadata = (ChildSpelling(wrapper),)
    return Field(default, default_factory=default_factory, description=description, metadata=metadata)


def other_attributes(description: str) -> Any:
    """Declare a field of type `dict[str, str]` that takes every attribute that no other field declares."""
    return Field({}, description=description, metadata=(OtherAttributesSpelling(),))


def same_as(word: type[Word], field: str) -> Any:
    """Declare a field as another word does, so that its spelling, default and description are written once."""
    return word.model_fields[field]


def spelling_of(field: Field) -> Spelling | None:
    """Return the XML spelling of a word's field; None for `word` itself."""
    return next((one for one in field.metadata if isinstance(one, Spelling)), None)
