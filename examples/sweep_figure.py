"""Draws one figure of a sweep's report from its table: how often runs collide along a parameter, with intervals.

python examples/sweep_figure.py [FOLDER [PARAMETER]]          (the folder of a finished sweep; `sweep`, `distance`)
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from scenario_compiler import wilson_interval


def main() -> None:
    """Read the table, count by cells of the parameter, and draw."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "sweep")
    name = sys.argv[2] if len(sys.argv) > 2 else "distance"
    table = pd.read_parquet(folder / "results.parquet")
    table = table[table["result"] != "error"]
    cells = pd.cut(table[f"parameter.{name}"], 12)
    figure = Figure(figsize=(6, 3), layout="constrained")
    axes = figure.subplots()
    for label, happened in (
        ("collision", table["collision_time"].notna()),
        ("takeover request", table["resolution"] != "no_request"),
    ):
        counted = happened.groupby(cells, observed=True).agg(["sum", "count"])
        middle = [cell.mid for cell in counted.index]
        rate = counted["sum"] / counted["count"]
        ends = np.array([wilson_interval(int(row["sum"]), int(row["count"])) for _, row in counted.iterrows()])
        errors = np.abs(ends.T - rate.to_numpy())
        axes.errorbar(middle, rate, yerr=errors, marker="o", markersize=3, capsize=2, label=label)
    axes.set_xlabel(name)
    axes.set_ylabel("rate")
    axes.set_ylim(-0.03, 1.03)
    axes.legend()
    figure.savefig(folder / f"rates_{name}.png", dpi=150)
    print(folder / f"rates_{name}.png")


if __name__ == "__main__":
    main()
