"""Draws the reliability diagram of the lane confidence: stated probabilities against observed shares."""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from scenario_compiler.perception.calibration.figures import OUTPUTS, Figures
from scenario_compiler.perception.calibration.fit import COUNTED
from scenario_compiler.report.palette import BLUE, GREY, VERMILION

TITLES = ("geometry right", "paint there", "confidence: both")


def write_reliability_plot(figures: Figures, path: Path) -> None:
    """Write a PNG with a panel for each output; circles are bins with at least `COUNTED` observations."""
    with mpl.rc_context({"font.size": 9.0, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(10.0, 3.6), layout="constrained")
        panels = figure.subplots(1, len(OUTPUTS), sharex=True, sharey=True)
        sets = ((figures.single[-1], "single images", VERMILION), (figures.driving[-1], "driving", BLUE))
        for k, (axes, title) in enumerate(zip(panels, TITLES, strict=True)):
            axes.plot([0, 1], [0, 1], color=GREY, linewidth=0.8)
            for worth, name, colour in sets:
                one = worth.outputs[k]
                said = [mean for _, _, _, mean, _ in one.bins]
                seen = [frequency for _, _, _, _, frequency in one.bins]
                label = f"{name}: error {one.expected_error:.3f}, area {one.area:.3f}"
                axes.plot(said, seen, color=colour, linewidth=1.2, label=label)
                full = [(a, b) for (_, _, count, a, b) in one.bins if count >= COUNTED]
                axes.plot([a for a, _ in full], [b for _, b in full], "o", color=colour, markersize=4)
            axes.set_title(title, fontsize=10)
            axes.set_xlabel("probability that was stated")
            axes.legend(loc="upper left", frameon=False, fontsize=7.5)
        panels[0].set_ylabel("share that came true")
        FigureCanvasAgg(figure)
        figure.savefig(path, dpi=100, metadata={"Software": None})
