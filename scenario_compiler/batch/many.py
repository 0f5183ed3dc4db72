"""Runs of one plan with many seeds from Python, as a table of results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from scenario_compiler.diagnostics import CompileError, Diagnostics
from scenario_compiler.plan.maps import open_plan_map
from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.outcome import Outcome, judge
from scenario_compiler.roads.network import Network
from scenario_compiler.runtime import open_world, run
from scenario_compiler.trust import Trust

if TYPE_CHECKING:
    import pandas as pd

SHOWN = 20
"""Number of rows that a notebook shows."""


@dataclass(frozen=True, slots=True, repr=False)
class Runs:
    """A table of runs with one row for each seed.

    Attributes:
        columns: One value for each run, by the column's name: seed, result, resolution, cause, collision_with,
            stop_reason, duration in s, trajectory_hash, and every measure in its SI unit. None if there is no value.
        units: Unit of each measure.
    """

    columns: Mapping[str, Sequence[Any]]
    units: Mapping[str, str]

    def __len__(self) -> int:
        return len(self.columns["seed"])

    def __repr__(self) -> str:
        return f"<Runs: {len(self)} runs, {len(self.columns)} columns; see to_pandas()>"

    def to_pandas(self) -> pd.DataFrame:
        """Return the table as a pandas DataFrame; measures without a value are NaN."""
        import pandas as pd

        return pd.DataFrame(self.columns)

    def _repr_html_(self) -> str:
        """Return the first rows as an HTML table, as notebooks show them."""
        head = "".join(f"<th>{escape(name)}</th>" for name in self.columns)
        rows = [
            "".join(f"<td>{escape(_cell(values[row]))}</td>" for values in self.columns.values())
            for row in range(min(len(self), SHOWN))
        ]
        more = f"<p>and {len(self) - SHOWN} more runs</p>" if len(self) > SHOWN else ""
        body = "".join(f"<tr>{row}</tr>" for row in rows)
        return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{more}"


def run_many(
    plan: Plan,
    seeds: Iterable[int],
    *,
    network: Network | None = None,
    world: str = "kinematic",
    maps: Sequence[str | Path] = (),
    trust: Trust | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Runs:
    """Run a plan once with each seed and judge every run.

    Args:
        plan: The plan.
        seeds: The seeds; there is one run for each.
        network: The plan's map; None looks for it.
        world: Name of the world.
        maps: Folders in which the map is looked for first.
        trust: Trusted code that the plan may name as its controller.
        progress: Called after each run with the number of finished runs and the total.

    Raises:
        CompileError: The map cannot be found or read.
        WorldError: The world cannot be opened.
    """
    wanted = list(seeds)
    if network is None:
        sink = Diagnostics()
        network = open_plan_map(plan, sink, [Path(one) for one in maps], Path())
        if network is None:
            raise CompileError(sink)
    rows: list[dict[str, Any]] = []
    units: dict[str, str] = {}
    with open_world(world, plan, network) as opened:
        for seed in wanted:
            outcome = judge(plan, run(plan, opened, seed, trust=trust))
            units |= {name: measure.unit for name, measure in outcome.measures.items()}
            rows.append(_row(outcome))
            if progress is not None:
                progress(len(rows), len(wanted))
    names = list(dict.fromkeys(name for row in rows for name in row)) or ["seed"]
    return Runs({name: [row.get(name) for row in rows] for name in names}, units)


def _row(outcome: Outcome) -> dict[str, Any]:
    plain = ("seed", "result", "resolution", "cause", "collision_with", "stop_reason", "duration", "trajectory_hash")
    measures = {name: measure.value for name, measure in outcome.measures.items()}
    return {name: getattr(outcome, name) for name in plain} | measures


def _cell(value: Any) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
