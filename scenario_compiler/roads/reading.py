"""Reads attributes as numbers, with diagnostics; this part of the reader is independent of the elements."""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot, inf, isfinite
from operator import itemgetter
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


LENGTHS = frozenset({"s", "t", "ds", "sOffset", "length"})
"""The numbers of cubics and geometries that are lengths along a road or across it."""

Cubic = tuple[float, float, float, float, float]
"""Start, a, b, c, d."""


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

        A missing attribute is not reported here: whether it is required is a matter of structure. `otherwise` is the
        consequence in the words of the finding; empty if the default is used.
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

    def five(
        self, record: PlainElement, names: tuple[str, str, str, str, str]
    ) -> tuple[float, float, float, float, float]:
        """Return five numbers of a record, each as `number` does, which is only called if one is missing or unusual."""
        first, second, third, fourth, fifth = names
        attributes = record.attrib
        try:
            found = (
                float(attributes[first]),
                float(attributes[second]),
                float(attributes[third]),
                float(attributes[fourth]),
                float(attributes[fifth]),
            )
            if hypot(*found) < LENGTH_LIMIT:  # none of them is larger, infinite or NaN
                return found
        except (KeyError, ValueError):
            pass
        a, b, c, d, e = (
            self.number(record, name, 0.0, limit=LENGTH_LIMIT if name in LENGTHS else NUMBER_LIMIT) for name in names
        )
        return a, b, c, d, e

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

    def cubics(self, n: RoadTables, records: Sequence[PlainElement], station: str, origin: float) -> tuple[int, int]:
        """Append cubics to the pool and return their range, which is empty if all of them are 0 everywhere.

        Args:
            n: The tables.
            records: Elements with the attributes a, b, c, d.
            station: Name of the attribute for a record's start: "s", "t", "sOffset" or "ds".
            origin: Value to which that attribute is relative.
        """
        first, names = len(n.cubic_s), (station, "a", "b", "c", "d")
        last = -inf
        zero = in_order = True
        for record in records:
            s, a, b, c, d = self.five(record, names)
            if s < last:
                in_order = False
                self.report(UNSORTED, f"{station} is smaller than that of the record before", record, station)
            last = s
            if a or b or c or d:
                zero = False
            n.cubic_s.append(origin + s)
            n.cubic_a.append(a)
            n.cubic_b.append(b)
            n.cubic_c.append(c)
            n.cubic_d.append(d)
        if zero:
            _remove_cubics(n, first)
        elif not in_order:
            cubics = sorted(cubics_in(n, first, len(n.cubic_s)), key=itemgetter(0))
            _remove_cubics(n, first)
            append_cubics(n, cubics)
        return first, len(n.cubic_s)


def cubics_in(n: RoadTables, first: int, last: int) -> list[Cubic]:
    """Return a range of the pool of cubics."""
    return [(n.cubic_s[i], n.cubic_a[i], n.cubic_b[i], n.cubic_c[i], n.cubic_d[i]) for i in range(first, last)]


def append_cubics(n: RoadTables, cubics: Sequence[Cubic]) -> tuple[int, int]:
    """Append cubics to the pool and return their range, which is empty if all of them are 0 everywhere."""
    first = len(n.cubic_s)
    if any(any(coefficients) for _, *coefficients in cubics):
        columns = n.cubic_s, n.cubic_a, n.cubic_b, n.cubic_c, n.cubic_d
        for column, values in zip(columns, zip(*cubics, strict=True), strict=True):
            column.extend(values)
    return first, len(n.cubic_s)


def _remove_cubics(n: RoadTables, first: int) -> None:
    """Remove the last cubics from the pool, from `first` on."""
    del n.cubic_s[first:], n.cubic_a[first:], n.cubic_b[first:], n.cubic_c[first:], n.cubic_d[first:]
