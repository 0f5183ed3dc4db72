"""docs/conformance.md and its chart: every recorded run of esmini beside ours.

`python -m tests.conformance.page` writes both, from the corpus that SCENARIO_COMPILER_CORPUS names.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from pathlib import Path

from tests.conformance.esmini import (
    FAR_APART,
    STEP,
    TOO_FAST,
    Comparison,
    Row,
    compare,
    map_folders,
    recorded,
    runs_without_controllers,
    simulated,
)
from tests.conformance.explained import EXPLAINED

CHARTED = 10
"""Number of runs in the chart: those that are furthest from the recorded ones."""

Difference = list[tuple[float, float]]
"""Time and greatest distance between the two runs over all entities."""


def difference(ours: Sequence[dict[str, Row]], theirs: Sequence[dict[str, Row]]) -> Difference:
    """Return the greatest distance of any entity at each step, m."""
    return [
        (
            at * STEP,
            max((math.dist(mine[name][:2], other[name][:2]) for name in mine.keys() & other.keys()), default=0.0),
        )
        for at, (mine, other) in enumerate(zip(ours, theirs, strict=False))
    ]


def text_of(comparisons: Sequence[Comparison]) -> str:
    """Return the page."""
    agreeing = sum(one.agrees for one in comparisons)
    lines = [
        "# Agreement with esmini",
        "",
        "<!-- written by python -m tests.conformance.page -->",
        "",
        f"{agreeing} of {len(comparisons)} runs agree with those that esmini 3.6 recorded at a step of {STEP:g} s: "
        f"every entity within {FAR_APART:g} m and {TOO_FAST:g} m/s at every step, and the end within two steps. Runs "
        "in which controllers of esmini's own drive are left out.",
        "",
        "![Distance of the ten runs that are furthest from the recorded ones](conformance.svg)",
        "",
        "| scenario | agrees | position, m | speed, m/s | heading, rad | end, steps | why not |",
        "|---|---|---|---|---|---|---|",
    ]
    for one in sorted(comparisons, key=lambda each: (each.agrees, each.scenario)):
        name = one.scenario.rpartition("/")[2].removesuffix(".xosc")
        why = "" if one.agrees else EXPLAINED.get(one.scenario, one.error or "not explained yet").replace("|", "\\|")
        sizes = " | ".join(f"{worst.size:.2g}" for worst in (one.position, one.speed, one.heading))
        lines.append(f"| {name} | {'yes' if one.agrees else 'no'} | {sizes} | {one.steps:+d} | {why} |")
    return "\n".join(lines) + "\n"


def draw(worst: Sequence[tuple[str, Difference]], path: Path) -> None:
    """Draw how far apart the two runs of each scenario are, over time."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "conformance"
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(figsize=(9, 5), layout="constrained")
    for name, points in worst:
        axes.plot([t for t, _ in points], [max(d, 1e-4) for _, d in points], label=name, linewidth=1.2)
    axes.axhline(FAR_APART, color="black", linestyle=":", linewidth=1)
    axes.text(0.0, FAR_APART * 1.15, f"bound, {FAR_APART:g} m", fontsize=8)
    axes.set_yscale("log")
    axes.set_xlabel("time, s")
    axes.set_ylabel("greatest distance of an entity, m")
    axes.set_title("The ten runs that are furthest from the recorded ones")
    axes.legend(fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    axes.grid(alpha=0.3)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def main() -> None:
    """Write the page and the chart."""
    corpus = Path(os.environ["SCENARIO_COMPILER_CORPUS"])
    golden = corpus.parent / "golden" / "esmini"
    comparisons: list[Comparison] = []
    apart: list[tuple[str, Difference]] = []
    for scenario, file in runs_without_controllers(golden):
        ours, theirs = simulated(corpus / scenario, map_folders(corpus)), recorded(golden / file)
        comparisons.append(compare(scenario, ours, theirs))
        if not isinstance(ours, str):
            apart.append((scenario.rpartition("/")[2].removesuffix(".xosc"), difference(ours, theirs)))
    apart.sort(key=lambda one: -max(d for _, d in one[1]))
    docs = Path(__file__).resolve().parents[2] / "docs"
    (docs / "conformance.md").write_text(text_of(comparisons), encoding="utf-8")
    draw(apart[:CHARTED], docs / "conformance.svg")


if __name__ == "__main__":
    main()
