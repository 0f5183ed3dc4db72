"""Traffic signals: controllers that repeat their phases, and the states of the signals.

A controller begins its first phase with its delay after its reference begins (after the start of the run if it has no
reference); until then it is in none of its phases. An action may set a phase, which then begins again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import SIGNAL, SIGNAL_CONTROLLER, Program
from scenario_compiler.engine.columns.rows import ActionRow, ProgramDraft
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.moves.entry import Entry, Told
from scenario_compiler.forms.declaration import index
from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import RoadTables

if TYPE_CHECKING:
    from scenario_compiler.vocabulary.actions import TrafficSignalControllerAction, TrafficSignalStateAction


@compiled
def enter_phase(p: Program, st: State, c: int, phase: int, since: float) -> None:
    """Begin a phase of a controller, and set the states of its signals."""
    st.phase_now[c] = phase
    st.phase_since[c] = since
    for k in range(p.light_first[phase], p.light_first[phase + 1]):
        st.signal_state[p.light_signal[k]] = p.light_state[k]


@compiled
def begin_of(p: Program, c: int) -> float:
    """Return the time at which a controller begins, s: its delay after the beginning of its reference, and so on."""
    at = c
    begin = 0.0
    for _ in range(p.controller_count[0]):
        begin = begin + p.const[p.controller_const[at]]
        at = p.controller_reference[at]
        if at < 0:
            return begin
    return begin


@compiled
def update_signals(p: Program, st: State) -> None:
    """Advance every controller to the present phase, by at most one round of its phases in a step."""
    for c in range(p.controller_count[0]):
        first = p.phase_first[c]
        last = p.phase_first[c + 1]
        if first == last:
            continue
        if st.phase_now[c] < 0:
            if st.clock[0] < st.phase_since[c] - op.TOLERANCE:
                continue
            enter_phase(p, st, c, first, st.phase_since[c])
        for _ in range(first, last):
            end = st.phase_since[c] + p.const[p.phase_const[st.phase_now[c]]]
            if st.clock[0] < end - op.TOLERANCE:
                break
            after = st.phase_now[c] + 1
            enter_phase(p, st, c, after if after < last else first, end)


@compiled
def reset_signals(p: Program, st: State) -> None:
    """Write when each controller begins."""
    for c in range(p.controller_count[0]):
        st.phase_since[c] = begin_of(p, c)


@compiled
def phase_holds(p: Program, st: State, c: int, name: int) -> int:
    """Return 1 if a controller is in a phase with a given name."""
    phase = st.phase_now[c]
    return 1 if phase >= 0 and p.phase_name[phase] == name else 0


@compiled
def set_phase(p: Program, st: State, c: int, name: int) -> None:
    """Begin a controller's first phase with a given name now."""
    for phase in range(p.phase_first[c], p.phase_first[c + 1]):
        if p.phase_name[phase] == name:
            enter_phase(p, st, c, phase, st.clock[0])
            return


@compiled
def start_signal_state(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set the state of a signal."""
    del n
    st.signal_state[p.action_other[k]] = p.action_mode[k]


@compiled
def start_signal_phase(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Set the phase of a traffic signal controller."""
    del n
    set_phase(p, st, p.action_other[k], p.action_mode[k])


def signal_state_row(draft: ProgramDraft, word: TrafficSignalStateAction, actor: int) -> ActionRow:
    """Return the row of an action that sets a signal's state."""
    del actor
    return ActionRow(other=draft.signal(word.signal), mode=draft.texts[word.state])


def signal_phase_row(draft: ProgramDraft, word: TrafficSignalControllerAction, actor: int) -> ActionRow:
    """Return the row of an action that sets a controller's phase."""
    del actor
    return ActionRow(other=draft.controllers[word.controller], mode=draft.texts[word.phase])


TOLD = "A traffic signal or a controller changes: `cause` is its name, `message` its state or phase."

SIGNAL_STATE = Entry(
    ("traffic_signal_state",),
    signal_state_row,
    start_signal_state,
    whose="run",
    told=Told("signal", TOLD, lambda word: (word.signal, word.state)),
    refers={"other": index(SIGNAL)},
)
SIGNAL_PHASE = Entry(
    ("traffic_signal_phase",),
    signal_phase_row,
    start_signal_phase,
    whose="run",
    told=Told("signal", TOLD, lambda word: (word.controller, word.phase)),
    refers={"other": index(SIGNAL_CONTROLLER)},
)
