"""Actions on the ego's camera: its noise and its failures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import FAILURE, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.failures import begin_failure, end_failures, update_camera
from scenario_compiler.engine.moves.entry import Entry, Told
from scenario_compiler.forms.declaration import codes, index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import EndFailureAction, Failure, SensorNoiseAction
    from scenario_compiler.vocabulary.sensors import FailureKind

FAILURE_CODES: dict[FailureKind, int] = {
    "noise": op.FAILURE_NOISE,
    "dropout": op.FAILURE_DROPOUT,
    "freeze": op.FAILURE_FREEZE,
    "blackout": op.FAILURE_BLACKOUT,
    "blur": op.FAILURE_BLUR,
    "dirt": op.FAILURE_DIRT,
    "impulse_noise": op.FAILURE_IMPULSE_NOISE,
    "overexposure": op.FAILURE_OVEREXPOSURE,
    "dead_rows": op.FAILURE_DEAD_ROWS,
    "quantisation": op.FAILURE_QUANTISATION,
    "latency": op.FAILURE_LATENCY,
    "motion_blur": op.FAILURE_MOTION_BLUR,
    "misalignment": op.FAILURE_MISALIGNMENT,
}
"""Codes of the kinds of failures."""


@compiled
def start_noise(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set the camera's noise."""
    del n
    st.noise[0] = p.const[p.action_const[k] + slot.A_TARGET]
    update_camera(p, st)


@compiled
def start_failure(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Begin a failure of the camera."""
    del n
    begin_failure(st, p.action_other[k])
    update_camera(p, st)


@compiled
def start_end_failure(n: RoadTables, p: Program, st: State, k: int) -> None:
    """End failures of the camera."""
    del n
    end_failures(p, st, p.action_other[k])
    update_camera(p, st)


def noise_row(draft: ProgramDraft, word: SensorNoiseAction, actor: int) -> ActionRow:
    """Return the row of a change of the camera's noise."""
    del draft, actor
    return ActionRow((word.sigma, 0.0))


def failure_row(draft: ProgramDraft, word: Failure, actor: int) -> ActionRow:
    """Return the row of a failure that begins."""
    del actor
    return ActionRow(other=draft.failure(word))


def end_failure_row(draft: ProgramDraft, word: EndFailureAction, actor: int) -> ActionRow:
    """Return the row of the end of failures of a kind, or of all."""
    del draft, actor
    return ActionRow(other=op.NONE if word.kind is None else FAILURE_CODES[word.kind])


SENSOR_NOISE = Entry(
    ("sensor_noise",),
    noise_row,
    start_noise,
    whose="ego",
    told=Told("sensor_noise", "The camera's noise changes."),
)
BEGIN_FAILURE = Entry(("failure",), failure_row, start_failure, whose="ego", refers={"other": index(FAILURE)})
END_FAILURE = Entry(
    ("end_failure",),
    end_failure_row,
    start_end_failure,
    whose="ego",
    refers={"other": codes(op.FAILURES, least=op.NONE)},
)
