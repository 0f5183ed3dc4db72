"""Plots of a sweep: distributions of measures, box plots by condition, scatter plots over parameters, and heat maps."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure

from scenario_compiler.recording.recording import Booleans, Floats, Integers
from scenario_compiler.report.palette import BLUE, INK, LINE, ORANGE, QUIET, SKY, VERMILION
from scenario_compiler.report.plots import STYLE, WIDTH, svg_of
from scenario_compiler.report.wording import with_unit

BINS = 30
CELLS = 12
"""Number of cells of a heat map along an axis with many values."""

FEW = 16
"""Greatest number of values for which an axis has one cell for each value."""

ROW_LETTERS = 44
"""Number of letters that fit beside each other below a panel with boxes."""

MOST_POINTS = 1000
"""Greatest number of runs with a collision, and of others, that are drawn as points in a panel."""

MOST_LINES = 3
"""Greatest number of lines of a label below a box."""

RATES = LinearSegmentedColormap.from_list("rates", ["#f7f7f2", SKY, BLUE, "#06264a"])


ROUNDING = 1e-9
"""Relative difference up to which two values count as equal: sums in another order differ by less."""

Panel = tuple[str, str, Floats]
"""A measure of a picture: its name, its unit, and its values, NaN if missing."""


def levelled(values: Floats) -> Floats:
    """Return values in which those that differ only by rounding are replaced by the least of them; NaN stays."""
    order = np.argsort(values, kind="stable")
    rising = values[order]
    apart = np.abs(np.diff(rising)) > ROUNDING * np.maximum(np.abs(rising[1:]), np.abs(rising[:-1]))
    begins = np.concatenate([[True], apart | np.isnan(rising[1:])])[: len(rising)]
    groups = np.maximum.accumulate(np.where(begins, np.arange(len(rising)), 0))
    even = np.empty_like(values)
    even[order] = rising[groups]
    return even


def _panels(count: int, height: float) -> tuple[Figure, list[Axes]]:
    """Return a figure, and its panels, three in a row."""
    rows = (count + 2) // 3
    figure = Figure(figsize=(WIDTH, 0.3 + height * rows), layout="constrained")
    axes = list(figure.subplots(rows, 3, squeeze=False).flat)
    for axis in axes[count:]:
        axis.set_axis_off()
    for axis in axes[:count]:
        axis.tick_params(labelsize=7.5)
    return figure, axes[:count]


def names_in_lines(names: Sequence[str]) -> list[str] | None:
    """Return the names of conditions in lines that fit below their boxes, None if some does not fit."""
    width = ROW_LETTERS // len(names)
    lines = [textwrap.wrap(name, width, break_long_words=False) for name in names]
    if any(len(one) > MOST_LINES or any(len(line) > width for line in one) for one in lines):
        return None
    return ["\n".join(one) for one in lines]


def boxes_plot(measures: Sequence[Panel], names: Sequence[str], taken: Sequence[str], prefix: str) -> str:
    """Return an SVG with box plots of each measure by condition: median, quartiles, whiskers and outliers.

    Conditions whose names do not fit below the boxes are numbered from 1. Whiskers extend to the farthest value within
    1.5 times the interquartile range (Tukey 1977).

    Args:
        measures: The measures, NaN if a run has no value.
        names: The conditions, in order.
        taken: Each run's condition.
        prefix: Prefix of the ids in the SVG.
    """
    member = np.array([names.index(one) for one in taken])
    below = names_in_lines(names) or range(1, len(names) + 1)
    with mpl.rc_context(STYLE):
        figure, axes = _panels(len(measures), 1.95)
        for axis, (name, unit, values) in zip(axes, measures, strict=True):
            groups = [values[(member == k) & np.isfinite(values)] for k in range(len(names))]
            axis.boxplot(
                groups,
                widths=0.55,
                patch_artist=True,
                boxprops={"facecolor": SKY, "edgecolor": BLUE, "linewidth": 0.6},
                whiskerprops={"color": BLUE, "linewidth": 0.6},
                capprops={"color": BLUE, "linewidth": 0.6},
                medianprops={"color": VERMILION, "linewidth": 1.2},
                flierprops={"marker": ".", "markersize": 2.5, "markeredgecolor": QUIET},
            )
            labels = [f"{label}\nn = {len(group)}" for label, group in zip(below, groups, strict=True)]
            axis.set_xticks(range(1, len(names) + 1), labels, fontsize=6.5)
            axis.set_title(with_unit(name, unit), fontsize=8.5, color=INK)
        return svg_of(figure, prefix)


def evenly_chosen(there: Booleans) -> Integers:
    """Return the indices of at most `MOST_POINTS` of the true elements, the first and the last among them."""
    found = np.flatnonzero(there)
    count = min(len(found), MOST_POINTS)
    return found[np.linspace(0, max(len(found) - 1, 0), count).astype(np.int64)]


def scatter_plot(x: tuple[str, Floats], measures: Sequence[Panel], collided: Floats, prefix: str) -> str:
    """Return an SVG with each measure over a parameter, (label, values); runs with a collision (1) are distinguished.

    A panel shows `evenly_chosen` runs with its measure, separately for those with a collision, so that a rare one is
    seen. The points are one embedded picture, because thousands of shapes would make the file large.
    """
    with mpl.rc_context(STYLE):
        figure, axes = _panels(len(measures), 1.85)
        for axis, (name, unit, values) in zip(axes, measures, strict=True):
            for hit, colour, marker in ((0.0, BLUE, "o"), (1.0, VERMILION, "x")):
                chosen = evenly_chosen((collided == hit) & np.isfinite(values))
                axis.scatter(
                    x[1][chosen],
                    values[chosen],
                    s=7,
                    c=colour,
                    marker=marker,
                    linewidths=0.7 if hit else 0.0,
                    alpha=0.7,
                    rasterized=True,
                )
            axis.set_xlabel(x[0], fontsize=7.5)
            axis.set_title(with_unit(name, unit), fontsize=8.5, color=INK)
        return svg_of(figure, prefix)


def distributions_plot(measures: Sequence[Panel], prefix: str) -> str:
    """Return an SVG with a histogram of each measure that has values, and the number of runs with a value."""
    with mpl.rc_context(STYLE):
        figure, axes = _panels(len(measures), 1.85)
        for axis, (name, unit, values) in zip(axes, measures, strict=True):
            known = values[np.isfinite(values)]
            axis.hist(known, bins=BINS if len(known) > BINS else 10, color=SKY, edgecolor=BLUE, linewidth=0.4)
            axis.axvline(float(np.median(known)), color=VERMILION, linewidth=1.1)
            axis.set_title(with_unit(name, unit), fontsize=8.5, color=INK)
            axis.set_xlabel(f"{len(known)} of {len(values)} runs", fontsize=7, color=QUIET)
        return svg_of(figure, prefix)


def heat_map(x: tuple[str, Floats], y: tuple[str, Floats], values: Floats, label: str, prefix: str) -> str:
    """Return an SVG of the mean of `values` (without NaN) in cells of two parameters: (label, values)."""
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
        many = len(hits) > 2
        figure = Figure(figsize=(WIDTH * (0.95 if many else 0.62), 2.4), layout="constrained")
        axis = figure.subplots()
        for (label, hit), colour in zip(hits, (VERMILION, BLUE, ORANGE, QUIET, INK, SKY), strict=False):
            found, _ = np.histogram(x[1], bins=edges, weights=hit)
            rate = np.where(count > 0, found / np.maximum(count, 1), np.nan)
            axis.plot(middle, rate, color=colour, marker="o", markersize=3, label=label)
        axis.set_ylim(-0.03, 1.03)
        axis.set_xlabel(x[0])
        axis.set_ylabel("rate")
        axis.grid(axis="y")
        if many:
            axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        else:
            axis.legend()
        return svg_of(figure, prefix)


def cell_edges(values: Floats) -> Floats:
    """Return the edges of cells: one cell for each value if there are few, otherwise cells of equal width."""
    distinct = np.unique(values)
    if 1 < len(distinct) <= FEW:
        inner = 0.5 * (distinct[1:] + distinct[:-1])
        return np.concatenate([[2 * distinct[0] - inner[0]], inner, [2 * distinct[-1] - inner[-1]]])
    low, high = float(distinct[0]), float(distinct[-1])
    return np.linspace(low, high if high > low else low + 1.0, CELLS + 1)
