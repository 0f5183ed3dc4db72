"""Converts numbers that an author wrote with a unit to the unit of the attribute, for a hint."""

from __future__ import annotations

import math
import re

from scenario_compiler.vocabulary.grammar import NUMBER

_WITH_UNIT = re.compile(rf"\s*(?P<number>{NUMBER}|[+-]?[0-9]+,[0-9]+)\s*(?P<unit>[^\s0-9.,]\S*(?:\s?\S+)?)\s*")

FACTORS: dict[str, dict[str, float]] = {
    "speed": {
        "m/s": 1.0,
        "mps": 1.0,
        "km/h": 1 / 3.6,
        "kmh": 1 / 3.6,
        "kph": 1 / 3.6,
        "mph": 0.44704,
        "kn": 1852 / 3600,
    },
    "time": {"s": 1.0, "sec": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "length": {"m": 1.0, "km": 1e3, "cm": 1e-2, "mm": 1e-3, "ft": 0.3048, "mi": 1609.344},
    "acceleration": {"m/s2": 1.0, "m/s²": 1.0, "m/s^2": 1.0, "g": 9.80665},
    "angle": {"deg": 1.0, "°": 1.0, "rad": 180.0 / math.pi},
    "fraction": {"%": 1e-2},
}
"""Factor from a unit to that of an attribute, by the attribute's quantity."""


def in_unit(text: str, quantity: str) -> str:
    """Return a number followed by a unit in the unit of a quantity, to four digits; empty if it has no unit."""
    match = _WITH_UNIT.fullmatch(text)
    factor = None if match is None else FACTORS.get(quantity, {}).get(match["unit"].replace(" ", "").lower())
    if match is None or factor is None:
        return ""
    return f"{float(match['number'].replace(',', '.')) * factor:.4g}"
