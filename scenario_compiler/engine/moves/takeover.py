"""Actions on the takeover, which take effect at the next control step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import Entry
from scenario_compiler.forms.declaration import codes
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import HandBackAction, RequestAction, WarnAction

REQUEST_CAUSES = {
    "controller": op.CAUSE_CONTROLLER,
    "sensor_health": op.CAUSE_SENSOR_HEALTH,
    "lane_confidence": op.CAUSE_LANE_CONFIDENCE,
    "path_blocked": op.CAUSE_PATH_BLOCKED,
    "lane_ends": op.CAUSE_LANE_ENDS,
    "no_progress": op.CAUSE_NO_PROGRESS,
    "scheduled": op.CAUSE_SCHEDULED,
}
"""Codes of the causes of requests."""


@compiled
def start_request(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Order a request for the action's cause."""
    del n
    st.ordered_request[0] = p.action_other[k]


@compiled
def start_warn(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Order a warning."""
    del n, p, k
    st.ordered_warning[0] = 1


@compiled
def start_hand_back(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Order the hand-back."""
    del n, p, k
    st.ordered_hand_back[0] = 1


def request_row(draft: ProgramDraft, word: RequestAction, actor: int) -> ActionRow:
    """Return the row of a request."""
    del draft, actor
    return ActionRow(other=REQUEST_CAUSES[word.cause])


def plain_row(draft: ProgramDraft, word: WarnAction | HandBackAction, actor: int) -> ActionRow:
    """Return the row of an action without parameters."""
    del draft, word, actor
    return ActionRow()


REQUEST = Entry(("request",), request_row, start_request, whose="ego", refers={"other": codes(op.CAUSES)})
WARN = Entry(("warn",), plain_row, start_warn, whose="ego")
HAND_BACK = Entry(("hand_back",), plain_row, start_hand_back, whose="ego")
