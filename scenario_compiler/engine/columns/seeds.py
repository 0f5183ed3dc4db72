"""The seed of all random numbers inside a run."""

from __future__ import annotations

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.numbers import clip
from scenario_compiler.engine.columns.state import State
from scenario_compiler.marker import compiled


@compiled
def run_seed(st: State, own: int) -> int:
    """Return the seed `own` of the counter hash, or the run's if it is negative."""
    if own >= 0:
        return own
    return int(clip(st.draw[op.DRAW_SEED], 0.0, 4294967295.0))
