"""Traffic signals: controllers that repeat their phases, and the states of the signals.

A controller begins its first phase as much later than its reference as its delay says (one without reference, than the
run); until then it is in none of its phases. An action may put it into a phase, which then begins again.
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
    """Let a controller's phase begin, and give its signals their states."""
    st.phase_now[c] = phase
    st.phase_since[c] = since
    for k in range(p.light_first[phase], p.light_first[phase + 1]):
        st.signal_state[p.light_signal[k]] = p.light_state[k]


@compiled
def begin_of(p: Program, c: int) -> float:
    """Return when a controller begins: its delay after the one that it refers to, and so on."""
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
    """Bring every controller to the phase of now; of phases shorter than a step no more pass than it has."""
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
    """Note when each controller begins."""
    for c in range(p.controller_count[0]):
        st.phase_since[c] = begin_of(p, c)


@compiled
def phase_holds(p: Program, st: State, c: int, name: int) -> int:
    """Return 1 where a controller is in a phase of a name."""
    phase = st.phase_now[c]
    return 1 if phase >= 0 and p.phase_name[phase] == name else 0


@compiled
def set_phase(p: Program, st: State, c: int, name: int) -> None:
    """Put a controller into its first phase of a name, from now on."""
    for phase in range(p.phase_first[c], p.phase_first[c + 1]):
        if p.phase_name[phase] == name:
            enter_phase(p, st, c, phase, st.clock[0])
            return


@compiled
def start_signal_state(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Give a signal a state."""
    del n
    st.signal_state[p.action_other[k]] = p.action_mode[k]


@compiled
def start_signal_phase(n: RoadTables, p: Program, st: State, k: int) -> None:
    """Put a controller of signals into a phase."""
    del n
    set_phase(p, st, p.action_other[k], p.action_mode[k])


def signal_state_row(draft: ProgramDraft, word: TrafficSignalStateAction, actor: int) -> ActionRow:
    """Return the row of a signal that gets a state."""
    del actor
    return ActionRow(other=draft.signal(word.signal), mode=draft.texts[word.state])


def signal_phase_row(draft: ProgramDraft, word: TrafficSignalControllerAction, actor: int) -> ActionRow:
    """Return the row of a controller of signals that gets into a phase."""
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
