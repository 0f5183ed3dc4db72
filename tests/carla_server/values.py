"""Values of the layouts on the wire, by their names."""

from __future__ import annotations

from typing import Any

VECTOR = [0.0, 0.0, 0.0]
TRANSFORM = [VECTOR, VECTOR]
DESCRIPTION = [1, "vehicle.audi.tt", [["role_name", 3, "hero"]]]
WHEEL = [3.5, 0.25, 70.0, 30.0, 1500.0, 0.0, 2.0, 17.0, 1000.0, VECTOR]

KNOWN: dict[str, Any] = {
    "u8": 1,
    "i8": 97,
    "u16": 8000,
    "u32": 999,
    "u64": 1,
    "real": 1.0,
    "bool": False,
    "text": "town_grid",
    "long text": "<OpenDRIVE/>",
    "bytes": b"",
    "anything": 0,
    "vector": VECTOR,
    "transform": TRANSFORM,
    "actor description": DESCRIPTION,
    "episode settings": [True, False, [True, 0.05], True, 0.01, 10, 0.0, True, 3000.0, 2000.0, True],
    "weather": [0.0] * 14,
    "vehicle control": [0.0, 0.0, 0.0, False, False, False, 0],
    "Ackermann control": [0.0] * 5,
    "Ackermann controller settings": [0.0] * 6,
    "walker control": [VECTOR, 0.0, False],
    "bones": [[["root", TRANSFORM]]],
    "vehicle physics control": [
        *([[0.0, 500.0]], 5000.0, 1.0, 0.15, 2.0, 0.35, True, 0.5, 10.0, 4.0, [[5.0, 0.5, 0.65]], 1000.0, 0.3, VECTOR),
        *([[0.0, 1.0]], [WHEEL] * 4, False),
    ],
    "vehicle light state": [1],
    "OpenDRIVE generation parameters": [2.0, 50.0, 1.0, 0.6, True, True, True],
    "address of a Traffic Manager": ["127.0.0.1", 8000],
    "debug shape": [[0, [VECTOR, 0.1]], [255, 0, 0], 1.0, False],
}


def value_of(layout: str) -> Any:
    """Return a value of the layout of a name."""
    return [] if layout.startswith("array of") else KNOWN[layout]
