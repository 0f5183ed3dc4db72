"""docs/conformance.md and its chart: every variant of every feature, and every recorded run of esmini beside ours.

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
    RecordedRun,
    Row,
    compare,
    recorded,
    recorded_runs,
    simulated,
)
from tests.conformance.explained import EXPLAINED
from tests.conformance.matrix import Backing, backings

VERDICTS = ("agrees", "differs by decision", "not recorded, law stated", "not recorded")
"""What the page says of variants, best first."""

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


Compared = Sequence[tuple[RecordedRun, Comparison]]
"""Recorded runs and how ours compare with them."""


def text_of(compared: Compared) -> str:
    """Return the page."""
    found = backings(compared)
    return "\n".join([*_begin(compared, found), *matrix_lines(found), *_runs(compared)]) + "\n"


def _begin(compared: Compared, found: Sequence[Backing]) -> list[str]:
    features = [one for run, one in compared if run.of_a_feature]
    others = [one for run, one in compared if not run.of_a_feature]
    counts = {verdict: sum(one.verdict == verdict for one in found) for verdict in dict.fromkeys(VERDICTS)}
    return [
        "# Agreement with esmini",
        "",
        "<!-- written by python -m tests.conformance.page -->",
        "",
        f"{sum(one.agrees for one in others)} of {len(others)} runs of the scenarios that come with esmini, and "
        f"{sum(one.agrees for one in features)} of {len(features)} runs of scenarios with one variant of one feature "
        f"each, agree with those that esmini 3.6 recorded at a step of {STEP:g} s: every entity within "
        f"{FAR_APART:g} m and {TOO_FAST:g} m/s at every step, and the end within two steps. Runs that use esmini's own "
        "controllers are left out.",
        "",
        "![Distance of the ten runs that are furthest from the recorded ones](conformance.svg)",
        "",
        "## Variants of features",
        "",
        "A variant *agrees* if a recorded run that uses it agrees. It *differs by decision* if esmini contradicts the "
        "standard, or if the standard leaves the result to chance. *Law stated* marks a variant without a recorded run "
        "for which a test has numbers worked out by hand. Nothing is claimed for the other variants.",
        "",
        "| " + " | ".join(counts) + " |",
        "|" + "---|" * len(counts),
        "| " + " | ".join(map(str, counts.values())) + " |",
        "",
    ]


def matrix_lines(found: Sequence[Backing]) -> list[str]:
    """Return the lines of the table of variants."""
    lines = ["| feature | variant | verdict | runs that agree | reason, or the test |", "|---|---|---|---|---|"]
    for one in found:
        runs = f"{one.agreeing} of {one.runs}" if one.runs else ""
        why = one.decision or ", ".join(one.laws)
        lines.append(f"| {one.variant.feature} | {one.variant.name} | {one.verdict} | {runs} | {_cell(why)} |")
    return [*lines, ""]


def _runs(compared: Compared) -> list[str]:
    lines = [
        "## Recorded runs",
        "",
        "| scenario | agrees | position, m | speed, m/s | heading, rad | end, steps | reason if not |",
        "|---|---|---|---|---|---|---|",
    ]
    for run, one in sorted(compared, key=lambda each: (each[1].agrees, each[0].of_a_feature, each[0].name)):
        why = "" if one.agrees else EXPLAINED.get(run.name, one.error or "not explained yet")
        sizes = " | ".join(f"{worst.size:.2g}" for worst in (one.position, one.speed, one.heading))
        name = run.scenario.stem
        lines.append(f"| {name} | {'yes' if one.agrees else 'no'} | {sizes} | {one.steps:+d} | {_cell(why)} |")
    return lines


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


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
    compared: list[tuple[RecordedRun, Comparison]] = []
    apart: list[tuple[str, Difference]] = []
    for run in recorded_runs(Path(os.environ["SCENARIO_COMPILER_CORPUS"])):
        ours, theirs = simulated(run.scenario, run.maps), recorded(run.rows)
        compared.append((run, compare(run.name, ours, theirs)))
        if not isinstance(ours, str):
            apart.append((run.scenario.stem, difference(ours, theirs)))
    apart.sort(key=lambda one: -max(d for _, d in one[1]))
    docs = Path(__file__).resolve().parents[2] / "docs"
    (docs / "conformance.md").write_text(text_of(compared), encoding="utf-8")
    draw(apart[:CHARTED], docs / "conformance.svg")


if __name__ == "__main__":
    main()
