"""Faults and events of a run. A fault is a value: the first one is kept and stops the run, in both forms alike."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled


@compiled
def fault(st: State, code: int, at: int) -> None:
    """Store a fault with its subject (an index), and stop the run."""
    if st.flag[0] == op.FAULT_NONE:
        st.flag[0] = code
        st.flag_at[0] = at
    st.stop[0] = op.STOP_ERROR


@compiled
def log_event(st: State, kind: int, value: float) -> None:
    """Write an event to the log, in place of the oldest one when the log is full."""
    at = st.log_count[0] % max(len(st.log_kind), 1)
    st.log_time[at] = st.clock[0]
    st.log_kind[at] = kind
    st.log_value[at] = value
    st.log_count[0] += 1
