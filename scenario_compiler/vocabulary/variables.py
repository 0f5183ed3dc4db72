"""Variables: typed, named values that actions change and conditions read during a run."""

import re
from datetime import datetime, timezone
from math import isnan
from typing import Literal

from scenario_compiler.vocabulary.grammar import NUMBER
from scenario_compiler.vocabulary.word import Word, attribute

VariableType = Literal["double", "integer", "unsignedInt", "unsignedShort", "boolean", "string", "dateTime"]
"""ASAM's types of parameters and variables."""

NUMBERS: tuple[VariableType, ...] = ("double", "integer", "unsignedInt", "unsignedShort")
"""The types that support addition and multiplication."""

WHOLE: dict[VariableType, tuple[int, int]] = {
    "integer": (-(2**31), 2**31 - 1),
    "unsignedInt": (0, 2**32 - 1),
    "unsignedShort": (0, 2**16 - 1),
}
"""The types of whole numbers, with their least and greatest values (XML Schema)."""


class Variable(Word):
    """A variable, or a parameter that actions change, with its value at the start."""

    word: Literal["variable"] = "variable"

    name: str = attribute("Name used by actions and conditions.", defines="variable")
    type: VariableType = attribute("Type of the value.", default="double")
    value: str = attribute(
        "Its value at the start. If left out, it is 0, false, an empty text or the beginning of 1970.", default=""
    )


def seconds_of(text: str) -> float:
    """Return an ISO 8601 date and time as seconds since 1970. Without a time zone it is interpreted as UTC.

    Raises:
        ValueError: The text is not a value of that type.
    """
    text = text.strip()
    if text.endswith(("Z", "z")):
        text = text[:-1] + "+00:00"
    if len(text) > 5 and text[-5] in "+-" and text[-4:].isdigit():
        text = f"{text[:-2]}:{text[-2:]}"
    head, point, tail = text.partition(".")
    if point:
        digits = len(tail) - len(tail.lstrip("0123456789"))
        text = f"{head}.{(tail[:digits] + '000000')[:6]}{tail[digits:]}"
    moment = datetime.fromisoformat(text)
    if moment.tzinfo is None:
        moment = moment.replace(tzinfo=timezone.utc)
    return moment.timestamp()


def number_of(kind: VariableType, text: str) -> float | None:
    """Return a variable's value as a number: 0 or 1 for booleans, seconds for dates, None for any other text or NaN."""
    try:
        if kind == "boolean":
            return {"true": 1.0, "1": 1.0, "false": 0.0, "0": 0.0}[text.strip()]
        number = seconds_of(text) if kind == "dateTime" else float(text)
    except (ValueError, KeyError, OverflowError):
        return None
    return None if isnan(number) else number


def number_in(text: str) -> float | None:
    """Return the number that a text is; None for any other text.

    Texts that are numbers are compared as numbers: "less and greater operator will only be supported if the value given
    as string can unambiguously be converted into a scalar value" (ParameterCondition, ASAM OpenSCENARIO).
    """
    return float(text) if re.fullmatch(NUMBER, text.strip()) else None


def is_value(kind: VariableType, text: str) -> bool:
    """Return whether a text is a value of a type; one of whole numbers has limits."""
    if kind == "string":
        return True
    number = number_of(kind, text)
    if number is None or kind not in WHOLE:
        return number is not None
    least, greatest = WHOLE[kind]
    return number % 1.0 == 0.0 and least <= number <= greatest
