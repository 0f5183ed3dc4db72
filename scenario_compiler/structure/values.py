"""The kinds of values that attributes may have, and the literals of XML Schema that most kinds are made of.

Source: W3C, XML Schema Part 2: Datatypes, section 3.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

Test = Callable[[str, int], bool]
"""Tells whether a text, without blanks around it, is fine in a minor version."""


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of value.

    Attributes:
        described: What such a value is called in a message: "a number".
        test: Tells which texts are such values.
        blanks: Whether blanks around a value belong to it, so that the test sees them.
    """

    described: str
    test: Test
    blanks: bool = False


_NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?|-?INF|NaN", re.ASCII)
_INTEGER = re.compile(r"[+-]?\d+", re.ASCII)


def is_number(text: str) -> bool:
    """Tell whether a text is an xs:double."""
    return _NUMBER.fullmatch(text) is not None


def is_integer(text: str) -> bool:
    """Tell whether a text is an xs:integer."""
    return _INTEGER.fullmatch(text) is not None
