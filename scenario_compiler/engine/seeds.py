"""The seed that draws inside a run depend on."""

from __future__ import annotations

from scenario_compiler.engine.numbers import clip
from scenario_compiler.engine.opcodes import DRAWS_PER_RUN
from scenario_compiler.engine.state import State
from scenario_compiler.marker import compiled


@compiled
def run_seed(st: State, own: int) -> int:
    """Return a seed of the counter hash: one of its own, else the run's."""
    if own >= 0:
        return own
    return int(clip(st.draw[DRAWS_PER_RUN - 1], 0.0, 4294967295.0))
