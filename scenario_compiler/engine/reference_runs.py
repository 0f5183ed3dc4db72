"""Whether a reference driver would have avoided a collision: the same run with that driver from the start."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.program.takeover import REFERENCES
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.vocabulary.driver import ReferenceName

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


def avoided_by(
    name: ReferenceName,
    tables: RoadTables,
    program: Program,
    rows: Sequence[Sequence[float]] | NDArray[np.float64],
    draws: Sequence[Sequence[float]],
    limit: int,
    *,
    interpreted: bool = False,
) -> list[bool]:
    """Return for each variant whether there is no collision if the reference driver drives from the start.

    Args:
        name: The reference driver.
        tables: The roads.
        program: The program, in which the engine moves the ego.
        rows: The numbers of each variant.
        draws: The draws of each variant.
        limit: Greatest number of steps of a run.
        interpreted: Whether the engine runs interpreted.
    """
    replaced = Program(**{name: list(getattr(program, name)) for name in columns_of(Program)})
    replaced.replaced_by[0] = REFERENCES[name]
    summaries, _ = Simulation(tables, replaced, interpreted=interpreted).sweep(rows, draws, limit)
    return [bool(time < 0.0) for time in summaries[:, SUMMARY.index("time_collision")]]
