"""Reads attributes as numbers, with diagnostics; this part of the reader is independent of the elements."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from math import hypot, inf, isfinite
from operator import attrgetter, itemgetter
from typing import Any, Protocol

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.document import Origin
from scenario_compiler.roads.elements import Element, PlainElement
from scenario_compiler.roads.tables import NO_SPEED, RoadTables

BAD_NUMBER = Code(
    "SC305",
    "bad-road-number",
    "A number in the road file is missing, not a number, NaN, infinite, or larger than any real road needs. The "
    "default (mostly 0) is used, or the record is left out.\n\n"
    '    <geometry s="0" x="nan" y="0" hdg="0" length="50">     x is not a finite number\n\n'
    "Correct the number. If many numbers are wrong, check the program that wrote the file.",
    Severity.WARNING,
)
UNSORTED = Code(
    "SC306",
    "unsorted-records",
    "Records along a road (geometries, elevations, lane sections, widths, marks) should stand in ascending order "
    "of s. They are sorted before they are used.\n\n"
    '    <width sOffset="20" a="3.5" .../>\n'
    '    <width sOffset="0" a="3.0" .../>     must come before the other\n\n'
    "Put them in order; check whether one of them has a wrong s.",
    Severity.WARNING,
)

LENGTH_LIMIT = 1e7
"""Longest road, largest s, m; 10 000 km."""

NUMBER_LIMIT = 1e12
"""Largest absolute value of any other number: with d below `LENGTH_LIMIT` no cubic overflows."""

SPEED_UNITS = {"m/s": 1.0, "km/h": 1.0 / 3.6, "mph": 0.44704}
"""Factor to m/s of each unit of speed (OpenDRIVE e_unitSpeed)."""


class Numbers:
    """The attributes of a kind of record that are numbers, 0 if they are missing: two or more.

    Attributes:
        limits: Their names, with the largest absolute value of each.
        texts: Returns their texts from an element's attributes.
    """

    def __init__(self, lengths: Sequence[str], others: Sequence[str]) -> None:
        """Take the names of those with the limit `LENGTH_LIMIT`, and of those with `NUMBER_LIMIT`."""
        self.limits = (*((name, LENGTH_LIMIT) for name in lengths), *((name, NUMBER_LIMIT) for name in others))
        self.texts = itemgetter(*lengths, *others)


CUBICS = {station: Numbers((station,), "abcd") for station in ("s", "t", "sOffset", "ds")}
"""The numbers of a cubic by the attribute for its start."""

ATTRIBUTES = attrgetter("attrib")
"""Returns an element's attributes."""

BY_COLUMN = itemgetter(*(slice(i, None, 5) for i in range(5)))
"""Divides the numbers of several cubics into those of the start, a, b, c and d."""


class Places(Protocol):
    """What knows the places of elements: a `Document` or a `RoadFile`."""

    def origin(self, element: Any, attribute: str | None = None) -> Origin:
        """Return the place of an element's start tag, or of one of its attributes."""
        ...


class Reader:
    """Reads attributes of one document and reports into one sink."""

    def __init__(self, document: Places, sink: Diagnostics) -> None:
        """Start with no finding."""
        self.document = document
        self.sink = sink

    def report(self, code: Code, message: str, element: Element, attribute: str | None = None) -> None:
        """Report a finding at an element or at one of its attributes."""
        self.sink.add(code, message, self.document.origin(element, attribute))

    def number(
        self, element: Element, name: str, default: float, *, limit: float = NUMBER_LIMIT, otherwise: str = ""
    ) -> float:
        """Return an attribute as a finite number within +-limit, or the default (with a finding) for any other text.

        A missing attribute is not reported here: whether it is required is a matter of structure. `otherwise` is what
        the finding says of the consequence, if it is not that the default is used.
        """
        text = element.get(name)
        if text is None:
            return default
        try:
            value = float(text)
        except ValueError:
            found = f"'{text[:40]}', not a number"
        else:
            if -limit <= value <= limit:
                return value
            found = (
                f"{value:g}, beyond the limit of {limit:g}" if isfinite(value) else f"{value:g}, not a finite number"
            )
        self.report(BAD_NUMBER, f"{name} is {found}; {otherwise or f'{default:g} is used'}", element, name)
        return default

    def numbers(self, record: PlainElement, read: Numbers) -> tuple[float, ...]:
        """Return several attributes of a record; see `number`."""
        try:
            found = tuple(map(float, read.texts(record.attrib)))
            if hypot(*found) < LENGTH_LIMIT:  # none of them is larger, infinite or NaN
                return found
        except (KeyError, ValueError):
            pass
        return tuple(self.number(record, name, 0.0, limit=limit) for name, limit in read.limits)

    def integer(self, element: Element, name: str) -> int | None:
        """Return an attribute as an integer, or None (with a finding) for any other text."""
        text = element.get(name)
        try:
            if text is not None and len(text) < 16:
                return int(text)
        except ValueError:
            pass
        found = "is missing" if text is None else f"is '{text[:40]}', not an integer"
        self.report(BAD_NUMBER, f"{name} {found}", element, None if text is None else name)
        return None

    def speed(self, element: Element) -> float:
        """Return the `max` of a speed element in m/s, `inf` for "no limit", `NO_SPEED` if it is not usable."""
        text = element.get("max", "undefined")
        if text == "no limit":
            return inf
        if text == "undefined":
            return NO_SPEED
        value = self.number(element, "max", NO_SPEED)
        if value < 0.0:
            return NO_SPEED
        return value * SPEED_UNITS.get(element.get("unit", "m/s"), 1.0)

    def stations(self, records: Sequence[PlainElement], name: str, origin: float) -> list[float]:
        """Return an attribute of records, a length that is 0 where it is missing, plus an origin; see `number`."""
        try:
            found = [origin + float(one.get(name, 0.0)) for one in records]
            if hypot(origin, *found) < 0.5 * LENGTH_LIMIT:  # none of the lengths is larger than the limit, or NaN
                return found
        except ValueError:
            pass
        return [origin + self.number(one, name, 0.0, limit=LENGTH_LIMIT) for one in records]

    def cubics(self, n: RoadTables, records: Sequence[PlainElement], station: str, origin: float) -> tuple[int, int]:
        """Append cubics to the pool and return their range, which is empty if all of them are 0 everywhere.

        Args:
            n: The tables.
            records: Elements with the attributes a, b, c, d.
            station: Name of the attribute for a record's start: "s", "t", "sOffset" or "ds".
            origin: Value to which that attribute is relative.
        """
        first = len(n.cubic_s)
        if len(records) == 1:
            s, a, b, c, d = self.numbers(records[0], CUBICS[station])
            if a or b or c or d:
                n.cubic_s.append(origin + s)
                n.cubic_a.append(a)
                n.cubic_b.append(b)
                n.cubic_c.append(c)
                n.cubic_d.append(d)
        elif records:
            found = self._cubics_at_once(records, station, origin) or self._cubics_one_by_one(records, station, origin)
            append_cubics(n, *found)
        return first, len(n.cubic_s)

    def _cubics_at_once(
        self, records: Sequence[PlainElement], station: str, origin: float
    ) -> tuple[list[float], ...] | None:
        """Return the columns of cubics, None if a number is wrong or missing or a record is not in order."""
        try:
            texts = map(CUBICS[station].texts, map(ATTRIBUTES, records))
            found = list(map(float, chain.from_iterable(texts)))
        except (KeyError, ValueError):
            return None
        s, a, b, c, d = BY_COLUMN(found)
        if hypot(*found) < NUMBER_LIMIT and s == sorted(s) and -LENGTH_LIMIT <= s[0] <= s[-1] <= LENGTH_LIMIT:
            return [origin + one for one in s], a, b, c, d
        return None

    def _cubics_one_by_one(
        self, records: Sequence[PlainElement], station: str, origin: float
    ) -> tuple[tuple[float, ...], ...]:
        """Return the columns of cubics, sorted, and report wrong numbers and records that are not in order."""
        rows: list[Cubic] = []
        last = -inf
        for record in records:
            s, a, b, c, d = self.numbers(record, CUBICS[station])
            if s < last:
                self.report(UNSORTED, f"{station} is smaller than that of the record before", record, station)
            last = s
            rows.append((origin + s, a, b, c, d))
        rows.sort(key=itemgetter(0))
        return tuple(zip(*rows, strict=True))


Cubic = tuple[float, float, float, float, float]
"""Start, a, b, c, d."""


def append_cubics(
    n: RoadTables, s: Sequence[float], a: Sequence[float], b: Sequence[float], c: Sequence[float], d: Sequence[float]
) -> tuple[int, int]:
    """Append cubics to the pool and return their range, which is empty if all of them are 0 everywhere."""
    first = len(n.cubic_s)
    if any(a) or any(b) or any(c) or any(d):
        n.cubic_s.extend(s)
        n.cubic_a.extend(a)
        n.cubic_b.extend(b)
        n.cubic_c.extend(c)
        n.cubic_d.extend(d)
    return first, len(n.cubic_s)
