"""Whether a reference driver would have avoided a collision: the same run, driven by him from the start."""

from __future__ import annotations

from collections.abc import Sequence

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.program.takeover import REFERENCES
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.vocabulary.driver import ReferenceName


def avoided_by(
    name: ReferenceName,
    tables: RoadTables,
    program: Program,
    rows: Sequence[Sequence[float]],
    draws: Sequence[Sequence[float]],
    limit: int,
    *,
    interpreted: bool = False,
) -> list[bool]:
    """Return for each variant whether the reference driver has no collision where he drives from the start.

    Args:
        name: Which one.
        tables: The roads.
        program: The program, in which the engine moves the ego vehicle.
        rows: The numbers of each variant.
        draws: The draws of each.
        limit: Steps that a run has at most.
        interpreted: Whether the engine runs interpreted.
    """
    replaced = Program(**{name: list(getattr(program, name)) for name in columns_of(Program)})
    replaced.replaced_by[0] = REFERENCES[name]
    summaries, _ = Simulation(tables, replaced, interpreted=interpreted).sweep(rows, draws, limit)
    return [bool(time < 0.0) for time in summaries[:, SUMMARY.index("time_collision")]]
