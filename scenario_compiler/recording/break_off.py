"""Why a run broke off, in words: which entity, which quantity, what value, and when."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from pydantic import BaseModel, ConfigDict, Field

from scenario_compiler.diagnostics import Code
from scenario_compiler.engine.numbers import LARGEST
from scenario_compiler.engine.opcodes import FAULT_NO_ROOM, FAULT_NOT_FINITE, FAULT_OFF_ROAD_START
from scenario_compiler.recording.names import FAULTS

BROKE_OFF = Code(
    "SC602",
    "run-broke-off",
    "The run could not go on, and ended before its time: a position, a heading or a speed became infinite, no number, "
    "or so large that nothing more can be computed from it; or a place that is known only while the scenario runs lies "
    "on no lane. The message says of which entity, which quantity and what value. The rows before are kept.\n\n"
    "    'lead' has the speed inf m/s at 3.05 s\n\n"
    "Look at what acts on that entity at that time: a speed, an acceleration or a position that depends on a parameter "
    "or on another entity.",
)

QUANTITIES = {
    "x": ("x", "m"),
    "y": ("y", "m"),
    "h": ("heading", "rad"),
    "v": ("speed", "m/s"),
    "steer": ("steering angle", "rad"),
}
"""Columns that the engine keeps finite, in the order in which they are looked at: what each is called, and its unit."""

OF_ENTITIES = (FAULT_NOT_FINITE, FAULT_OFF_ROAD_START, FAULT_NO_ROOM)
"""Fault codes that are about an entity."""


class BreakOff(BaseModel):
    """Why a run broke off."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    code: str = Field(description="Code that `scenario-compiler explain` explains.")
    message: str = Field(description="What happened, to which entity, when.")
    file: str = Field(default="", description="File of the code that is at fault; empty where none is.")
    line: int = Field(default=0, description="Line in that file; 0 where none is known.")


def engine_break_off(
    code: int, at: int, entities: Sequence[str], columns: Mapping[str, Sequence[float]], t: float
) -> BreakOff | None:
    """Return why the engine ended a run; None for a run that it did not end.

    Args:
        code: The engine's fault code; 0 for none.
        at: What the fault is about: for the codes OF_ENTITIES, the number of the entity.
        entities: The entities' ids.
        columns: The columns of QUANTITIES, with one value an entity, at the end.
        t: Time of the end, s.
    """
    if code == 0:
        return None
    what = FAULTS.get(code, f"fault {code} of the engine")
    if code not in OF_ENTITIES or not 0 <= at < len(entities):
        return BreakOff(code=BROKE_OFF.id, message=f"{what}, at {t:.6g} s")
    for name, (quantity, unit) in QUANTITIES.items():
        value = columns[name][at] if name in columns else 0.0
        if not math.isfinite(value) or abs(value) >= LARGEST:
            return BreakOff(
                code=BROKE_OFF.id, message=f"'{entities[at]}' has the {quantity} {value:g} {unit} at {t:.6g} s"
            )
    return BreakOff(code=BROKE_OFF.id, message=f"'{entities[at]}' at {t:.6g} s: {what}")
