"""The kinds of attribute values, and the literals of XML Schema on which most of them are based.

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
    """Return whether a text is an xs:double."""
    return _NUMBER.fullmatch(text) is not None


def is_integer(text: str) -> bool:
    """Return whether a text is an xs:integer."""
    return _INTEGER.fullmatch(text) is not None


def is_integer_within(text: str, low: int, high: int) -> bool:
    """Return whether a text is an xs:integer from `low` to `high`."""
    if not is_integer(text):
        return False
    digits = text.lstrip("+-").lstrip("0") or "0"
    return len(digits) <= 20 and low <= (-int(digits) if text.startswith("-") else int(digits)) <= high


_DATE_TIME = re.compile(
    r"-?(?P<year>[1-9]\d{4,}|\d{4})-(?P<month>\d\d)-(?P<day>\d\d)"
    r"T(?P<hour>\d\d):(?P<minute>\d\d):(?P<second>\d\d)(?P<fraction>\.\d+)?"
    r"(?:Z|[+-](?P<zone>\d\d:\d\d))?",
    re.ASCII,
)
_DAYS = (31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31)


def is_date_time(text: str) -> bool:
    """Return whether a text is an xs:dateTime, a day of the calendar and a time of the day."""
    match = _DATE_TIME.fullmatch(text)
    if match is None or match["year"] == "0000":
        return False
    month, day = int(match["month"]), int(match["day"])
    leap = month == 2 and _is_leap(match["year"][-4:])
    time = (match["hour"], match["minute"], match["second"])
    midnight = time == ("24", "00", "00") and not (match["fraction"] or "").strip(".0")
    return (
        1 <= month <= 12
        and 1 <= day <= _DAYS[month - 1] + leap
        and (midnight or (time[0] < "24" and time[1] < "60" and time[2] < "60"))
        and ((match["zone"] or "") <= "14:00" and (match["zone"] or "")[3:] < "60")
    )


def _is_leap(last_digits: str) -> bool:
    year = int(last_digits)
    return year % 4 == 0 and (year % 100 != 0 or year % 400 == 0)
