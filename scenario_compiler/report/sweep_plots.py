"""Pictures of a sweep: distributions of measures and heat maps over two parameters."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from scenario_compiler.recording.recording import Floats
from scenario_compiler.report.palette import BLUE, INK, LINE, ORANGE, QUIET, SKY, VERMILION
from scenario_compiler.report.plots import STYLE, WIDTH, svg_of
from scenario_compiler.report.wording import with_unit

BINS = 30
CELLS = 12
"""Cells of a heat map along an axis whose values are not few."""

FEW = 16
"""Values up to which an axis has one cell a value."""

RATES = LinearSegmentedColormap.from_list("rates", ["#f7f7f2", SKY, BLUE, "#06264a"])


def distributions_plot(measures: Sequence[tuple[str, str, Floats]], prefix: str) -> str:
    """Return an SVG with a histogram of each measure: (name, unit, its defined values)."""
    rows = (len(measures) + 2) // 3
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 0.3 + 1.75 * rows), layout="constrained")
        axes = figure.subplots(rows, 3, squeeze=False)
        for axis in axes.flat[len(measures) :]:
            axis.set_axis_off()
        for axis, (name, unit, values) in zip(axes.flat, measures, strict=False):
            axis.hist(values, bins=BINS if len(values) > BINS else 10, color=SKY, edgecolor=BLUE, linewidth=0.4)
            middle = float(np.median(values))
            axis.axvline(middle, color=VERMILION, linewidth=1.1)
            axis.set_title(with_unit(name, unit), fontsize=8.5, color=INK)
            axis.tick_params(labelsize=7.5)
        return svg_of(figure, prefix)


def heat_map(x: tuple[str, Floats], y: tuple[str, Floats], values: Floats, label: str, prefix: str) -> str:
    """Return an SVG of the mean of `values` (NaN left out) in cells of two parameters: (label, values)."""
    x_edges, y_edges = cell_edges(x[1]), cell_edges(y[1])
    good = ~np.isnan(values)
    count, _, _ = np.histogram2d(x[1][good], y[1][good], bins=(x_edges, y_edges))
    total, _, _ = np.histogram2d(x[1][good], y[1][good], bins=(x_edges, y_edges), weights=values[good])
    mean = np.where(count > 0, total / np.maximum(count, 1), np.nan)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH * 0.62, 3.3), layout="constrained")
        axis = figure.subplots()
        drawn = axis.pcolormesh(x_edges, y_edges, mean.T, cmap=RATES, edgecolors=LINE, linewidth=0.2)
        axis.set_xlabel(x[0])
        axis.set_ylabel(y[0])
        bar = figure.colorbar(drawn, ax=axis, pad=0.02)
        bar.set_label(label)
        bar.outline.set_visible(False)
        return svg_of(figure, prefix)


def rate_plot(x: tuple[str, Floats], hits: Sequence[tuple[str, Floats]], prefix: str) -> str:
    """Return an SVG of rates along a parameter, (label, values): (label, 0 or 1 of each run)."""
    edges = cell_edges(x[1])
    middle = 0.5 * (edges[1:] + edges[:-1])
    count, _ = np.histogram(x[1], bins=edges)
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH * 0.62, 2.4), layout="constrained")
        axis = figure.subplots()
        for (label, hit), colour in zip(hits, (VERMILION, BLUE, ORANGE, QUIET, INK, SKY), strict=False):
            found, _ = np.histogram(x[1], bins=edges, weights=hit)
            rate = np.where(count > 0, found / np.maximum(count, 1), np.nan)
            axis.plot(middle, rate, color=colour, marker="o", markersize=3, label=label)
        axis.set_ylim(-0.03, 1.03)
        axis.set_xlabel(x[0])
        axis.set_ylabel("rate")
        axis.grid(axis="y")
        axis.legend()
        return svg_of(figure, prefix)


def cell_edges(values: Floats) -> Floats:
    """Return the edges of cells over values: one cell a value where they are few, else cells of equal width."""
    distinct = np.unique(values)
    if 1 < len(distinct) <= FEW:
        inner = 0.5 * (distinct[1:] + distinct[:-1])
        return np.concatenate([[2 * distinct[0] - inner[0]], inner, [2 * distinct[-1] - inner[-1]]])
    low, high = float(distinct[0]), float(distinct[-1])
    return np.linspace(low, high if high > low else low + 1.0, CELLS + 1)
