"""Draws the pictures of a report with matplotlib as SVG, in the colours of the page.

Equal runs give equal text: ids are hashed with a fixed salt, and there is no date.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from scenario_compiler.plan.painted import mark_stretches
from scenario_compiler.recording.boxes import corners
from scenario_compiler.recording.recording import Floats
from scenario_compiler.recording.traces import traces_of
from scenario_compiler.report.lettering import LETTERING, lettered
from scenario_compiler.report.palette import (
    ASPHALT,
    BLUE,
    EGO,
    INK,
    LINE,
    MOMENT_COLOURS,
    ORANGE,
    PAINT,
    PAPER,
    PAVEMENT,
    PURPLE,
    QUIET,
    STATE_COLOURS,
    THEME,
    VERGE,
    VERMILION,
    WORDS,
)
from scenario_compiler.report.run import HEALTHY, Run
from scenario_compiler.report.surroundings import PAVED, Surroundings, Window, surroundings
from scenario_compiler.vocabulary.word import number_value

STYLE: Any = {
    **LETTERING,
    "svg.hashsalt": "scenario-compiler",
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 9.0,
    "axes.edgecolor": LINE,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "xtick.color": QUIET,
    "ytick.color": QUIET,
    "text.color": INK,
    "grid.color": LINE,
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
}

WIDTH = 9.0
"""Width of every picture, inches; the page scales it."""

CLOSE_UP = 50.0
"""Least distance ahead of the request that a close-up shows, m; at most three times as much."""

HIGHEST = 7.0
"""Greatest height of a map, inches; a higher one is narrower than `WIDTH`."""

FURNITURE = 30.0
"""Height of the strip below a map with its scale and its axes, points."""

ARROW = 11.0
"""Length of the arrows that show the axes, points."""

NEAR = 60.0
"""Distance from the ego's path within which other entities extend a map, m."""


def timeline_plot(run: Run, prefix: str) -> str:
    """Return an SVG of the takeover's states, lane confidence, speed and distance to the limit over time.

    Without an automated vehicle it contains only the speed.
    """
    if run.plan.controller is None:
        return _speed_plot(run, prefix)
    recording, outcome = run.recording, run.outcome
    limit = np.fmin(recording.blocked_distance, recording.lane_end_distance)
    panels = ["confidence", "speed", *(["limit"] if np.isfinite(limit).any() else [])]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 1.1 + 1.75 * len(panels)), layout="constrained")
        ratios = [0.32, *([1.75] * len(panels))]
        axes = figure.subplots(len(ratios), 1, sharex=True, gridspec_kw={"height_ratios": ratios})
        _state_bar(axes[0], run)
        for axis in axes[1:]:
            for interval in outcome.timeline:
                if interval.state != "automated":
                    colour = STATE_COLOURS[interval.state]
                    axis.axvspan(interval.begin, interval.end, color=colour, alpha=0.16, linewidth=0)
            for kind, t in run.moments:
                axis.axvline(t, color=MOMENT_COLOURS[kind] if kind != "collision" else INK, linewidth=1.0)
            axis.grid(axis="y")
        _confidence_panel(axes[1], run)
        _speed_panel(axes[2], run)
        if len(panels) == 3:
            axes[3].plot(recording.t, limit, color=EGO)
            axes[3].set_ylabel("distance to\nthe limit (m)")
            axes[3].set_ylim(bottom=0)
        _time_axis(axes[-1], run)
        return svg_of(figure, prefix)


def _speed_plot(run: Run, prefix: str) -> str:
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, 2.1), layout="constrained")
        axis = figure.subplots()
        for kind, t in run.moments:
            axis.axvline(t, color=MOMENT_COLOURS[kind], linewidth=1.0)
        axis.grid(axis="y")
        _speed_panel(axis, run)
        _time_axis(axis, run)
        return svg_of(figure, prefix)


def _time_axis(axis: Axes, run: Run) -> None:
    t = run.recording.t
    axis.set_xlabel("time (s)")
    axis.set_xlim(float(t[0]), max(float(t[-1]), float(t[0]) + 1e-3))


def _state_bar(axis: Axes, run: Run) -> None:
    for interval in run.outcome.timeline:
        colour = STATE_COLOURS[interval.state]
        axis.barh(
            0,
            interval.end - interval.begin,
            left=interval.begin,
            color=colour,
            edgecolor=PAPER,
            linewidth=0.4,
            height=1,
        )
    states = dict.fromkeys(interval.state for interval in run.outcome.timeline)
    patches = [Patch(facecolor=STATE_COLOURS[state], label=WORDS[state]) for state in states]
    axis.legend(handles=patches, loc="lower left", bbox_to_anchor=(0, 1), ncols=len(patches), handlelength=1)
    axis.set_ylim(-0.5, 0.5)
    axis.set_yticks([])
    for spine in axis.spines.values():
        spine.set_visible(False)
    axis.tick_params(bottom=False)


def _confidence_panel(axis: Axes, run: Run) -> None:
    recording = run.recording
    axis.plot(recording.t, recording.confidence_left, color=EGO, label="left")
    axis.plot(recording.t, recording.confidence_right, color=VERMILION, linestyle=(0, (4, 2)), label="right")
    if (recording.sensor_health < HEALTHY).any():
        axis.plot(recording.t, recording.sensor_health, color=PURPLE, linestyle=(0, (1, 1)), label="sensor health")
    axis.set_ylim(-0.03, 1.05)
    axis.set_ylabel("lane confidence")
    cause = next((c for c in run.plan.takeover.causes if c.kind == "lane_confidence"), None)
    for name in ("warning_below", "request_below"):
        level = getattr(cause, name, None)
        if level is not None:
            value = number_value(level, recording.header.parameters)
            axis.axhline(value, color=QUIET, linewidth=0.9, linestyle=(0, (1, 2)))
            axis.annotate(
                name.replace("_", " "), (1, value), xycoords=("axes fraction", "data"), fontsize=7.5, color=QUIET,
                xytext=(-3, 1), textcoords="offset points", ha="right", va="bottom",
            )  # fmt: skip
    axis.legend(loc="lower left", ncols=3)


def _speed_panel(axis: Axes, run: Run) -> None:
    recording = run.recording
    axis.plot(recording.t, recording.v[:, 0], color=EGO)
    axis.set_ylabel("speed (m/s)")
    axis.set_ylim(bottom=min(0.0, float(np.fmin.reduce(recording.v[:, 0], initial=0.0))))
    kilometres = axis.secondary_yaxis("right", functions=(_kilometres_per_hour, _metres_per_second))
    kilometres.set_ylabel("km/h", color=QUIET)
    kilometres.spines["right"].set_visible(False)


def _kilometres_per_hour(speed: Any) -> Any:
    return 3.6 * speed


def _metres_per_second(speed: Any) -> Any:
    return speed / 3.6


def overview_map(run: Run, prefix: str) -> str:
    """Return an SVG map of the whole run, rotated so that the ego's path runs to the right."""
    there = run.recording.present[:, 0]
    x, y = run.recording.x[there, 0], run.recording.y[there, 0]
    turn = _principal_direction(x, y) if len(x) > 1 else float(run.recording.h[there, 0][0])
    way = _turned(np.stack([x, y], axis=-1), -turn)
    frame = np.concatenate([way, _others_near(run, way, turn, _row_at(run.recording.t, run.focus[1]))])
    return _map(run, prefix, turn, frame, margin=(30.0, 22.0))


def close_up_map(run: Run, prefix: str) -> str:
    """Return an SVG map of the surroundings of the run's focus, at the scale of vehicles."""
    recording = run.recording
    row = _row_at(recording.t, run.focus[1])
    there = np.nonzero(recording.present[:, 0])[0]
    row = int(there[np.argmin(np.abs(there - row))])
    turn = float(recording.h[row, 0])
    there = there[there >= row]
    way = _turned(np.stack([recording.x[there, 0], recording.y[there, 0]], axis=-1), -turn)
    here = way[0]
    near = way[np.abs(way - here).max(axis=-1) < 3 * CLOSE_UP]
    others = _others_near(run, near, turn, row)
    others = others[np.abs(others - here).max(axis=-1) < 3 * CLOSE_UP]
    frame = np.concatenate([here + np.array([[-0.3 * CLOSE_UP, 0.0], [CLOSE_UP, 0.0]]), near, others])
    return _map(run, prefix, turn, frame, margin=(8.0, 10.0))


def _others_near(run: Run, way: Floats, turn: float, row: int) -> Floats:
    """Return the positions of other entities near a path in a row, in axes turned by `-turn`, (k, 2)."""
    recording = run.recording
    there = recording.present[row, 1:]
    places = np.stack([recording.x[row, 1:][there], recording.y[row, 1:][there]], axis=-1)
    others = _turned(places, -turn)
    apart = np.abs(others[:, None] - way[None]).max(axis=-1).min(axis=-1, initial=np.inf)
    return np.asarray(others[apart < NEAR])


def _map(run: Run, prefix: str, turn: float, frame: Floats, margin: tuple[float, float]) -> str:
    """Draw the area of the points `frame`, in axes turned by `-turn`, with a margin along and across."""
    low, high = frame.min(axis=0) - margin, frame.max(axis=0) + margin
    across = max(high[1] - low[1], 0.07 * (high[0] - low[0]))
    middle = 0.5 * (low[1] + high[1])
    low[1], high[1] = middle - 0.5 * across, middle + 0.5 * across
    outline = np.array([low, (high[0], low[1]), high, (low[0], high[1])])
    box = _turned(outline, turn)
    window = Window(*box.min(axis=0).tolist(), *box.max(axis=0).tolist())
    painted = run.network.with_mark_quality(mark_stretches(run.plan))
    around = surroundings(painted, window, spacing=max(1.0, float((high - low).max()) / 250))
    low[1], high[1] = _without_empty_bands(around, turn, frame, low, high)
    size = high - low
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, HIGHEST))
        points_per_metre = 72 * min(WIDTH / float(size[0]), HIGHEST / float(size[1]))
        axis, strip = figure.add_axes((0, 0, 1, 1)), figure.add_axes((0, 0, 1, 1))
        _draw_roads(axis, around, turn, points_per_metre)
        _draw_traffic(axis, run, turn, points_per_metre)
        axis.set_xlim(low[0], high[0])
        axis.set_ylim(low[1], high[1])
        axis.set_aspect("equal")
        axis.set_axis_off()
        _draw_scale(strip, turn, points_per_metre)
        parts = points_per_metre * float(size[1]), FURNITURE, _draw_legend(figure, axis)
        figure.set_size_inches(WIDTH, sum(parts) / 72)
        axis.set_position((0, 1 - parts[0] / sum(parts), 1, parts[0] / sum(parts)))
        strip.set_position((0, parts[2] / sum(parts), 1, parts[1] / sum(parts)))
        return svg_of(figure, prefix)


def _without_empty_bands(
    around: Surroundings, turn: float, frame: Floats, low: Floats, high: Floats
) -> tuple[float, float]:
    """Return the range across a map with roads or points of its frame, with room for a line of text."""
    points = np.concatenate([frame, *(_turned(strip.outline, -turn) for strip in around.strips)])
    across = points[((points >= low) & (points <= high)).all(axis=-1), 1]
    text = 14.0 / 72 / WIDTH * float(high[0] - low[0])
    return max(float(low[1]), float(across.min()) - text), min(float(high[1]), float(across.max()) + text)


def _draw_legend(figure: Figure, axis: Axes) -> float:
    """Draw a legend at the bottom of a figure in as few rows as possible, and return its height, points."""
    handles, labels = axis.get_legend_handles_labels()
    for rows in range(1, len(handles) + 1):
        legend = figure.legend(
            handles, labels, loc="lower center", ncols=math.ceil(len(handles) / rows), handlelength=1.2, numpoints=1
        )
        extent = legend.get_window_extent()
        if extent.width <= figure.bbox.width or rows == len(handles):
            return float(extent.height) * 72 / figure.dpi
        legend.remove()
    return 0.0


def _draw_roads(axis: Axes, around: Surroundings, turn: float, points_per_metre: float) -> None:
    for strips, colour, order in (
        ([s for s in around.strips if not s.drivable and s.type not in PAVED], VERGE, 1),
        ([s for s in around.strips if s.type in PAVED], PAVEMENT, 2),
        ([s for s in around.strips if s.drivable], ASPHALT, 3),
    ):
        outlines = [_turned(strip.outline, -turn) for strip in strips]
        axis.add_collection(PolyCollection(outlines, facecolor=colour, edgecolor=colour, linewidth=0.3, zorder=order))
    colours = {"yellow": ORANGE, "blue": BLUE, "red": VERMILION, "orange": ORANGE}
    width = float(np.clip(0.16 * points_per_metre, 0.35, 1.8))
    dash = float(np.clip(3.0 * points_per_metre, 1.5, 14.0)) / width
    for broken in (False, True):
        lines = [mark for mark in around.marks if ("broken" in mark.type) == broken and mark.quality > 0]
        collection = LineCollection(
            [_turned(mark.points, -turn) for mark in lines],
            colors=[colours.get(mark.colour, PAINT) for mark in lines],
            linewidths=width,
            linestyles=[(0, (dash, dash))] if broken else "solid",
            alpha=[mark.quality for mark in lines] or None,
            zorder=4,
        )
        axis.add_collection(collection)


def _draw_traffic(axis: Axes, run: Run, turn: float, points_per_metre: float) -> None:
    recording = run.recording
    names = recording.header.entities
    x, y = corners(traces_of(run.plan, recording))
    moments = run.moments
    rows = [_row_at(recording.t, t) for _, t in moments]
    focus, time = run.focus
    seen = _row_at(recording.t, time)
    labelled: list[Floats] = []
    moving = [i for i in range(1, len(names)) if np.any(np.abs(recording.v[:, i]) > 0.0)]
    for i in moving:
        label = "ways of others" if i == moving[0] else ""
        _draw_way(axis, recording.x[:, i], recording.y[:, i], turn, QUIET, label=label)
    there = [i for i in range(1, len(names)) if recording.present[seen, i]]
    boxes = [_turned(np.stack([x[seen, i], y[seen, i]], axis=-1), -turn) for i in there]
    for i, box in zip(there, boxes, strict=True):
        others = "_" if labelled else f"others, at the {focus}"
        axis.fill(*box.T, facecolor=PAPER, edgecolor=INK, linewidth=0.9, zorder=7, label=others)
        name = names[i].rpartition(".")[2]
        apart = np.array([5.5 * len(name), 10.0]) / points_per_metre
        above = _free_above(box, boxes, apart)
        place = np.array([box[:, 0].mean(), box[:, 1].max() if above else box[:, 1].min()])
        if all((np.abs(place - other) > apart).any() for other in labelled):
            labelled.append(place)
            axis.annotate(
                name, _point(place), (0, 2 if above else -2), textcoords="offset points", fontsize=7.5, ha="center",
                va="bottom" if above else "top", zorder=9, annotation_clip=True,
                bbox={"facecolor": PAPER, "edgecolor": "none", "alpha": 0.7, "pad": 0.6},
            )  # fmt: skip
    _draw_way(axis, recording.x[:, 0], recording.y[:, 0], turn, EGO, label=names[0])
    marker = float(np.clip(1.2 * points_per_metre, 4.0, 7.0))
    for row, (kind, t) in zip(rows, moments, strict=True):
        box = _turned(np.stack([x[row, 0], y[row, 0]], axis=-1), -turn)
        colour = MOMENT_COLOURS[kind]
        axis.fill(*box.T, facecolor=colour, edgecolor=PAPER, linewidth=0.5, alpha=0.9, zorder=8)
        style: dict[str, Any] = {
            "color": colour,
            "markeredgecolor": PAPER,
            "markersize": marker,
            "markeredgewidth": 0.7,
        }
        label = f"{WORDS[kind]}, {t:.2f} s"
        axis.plot(*box.mean(axis=0)[:, None], "X" if kind == "collision" else "o", zorder=9, label=label, **style)
    if len(recording.t) and recording.present[-1, 0]:
        last = _turned(np.stack([x[-1, 0], y[-1, 0]], axis=-1), -turn)
        axis.fill(*last.T, facecolor=EGO, edgecolor=PAPER, linewidth=0.7, zorder=7)


def _free_above(box: Floats, boxes: Sequence[Floats], apart: Floats) -> bool:
    """Return whether a name of the size `apart` (2,) has room between a box (4, 2) and the one above it, if any."""
    middle, top = box[:, 0].mean(), box[:, 1].max()
    return not any(
        other[:, 0].min() < middle + apart[0] / 2
        and other[:, 0].max() > middle - apart[0] / 2
        and box[:, 1].mean() < other[:, 1].mean()
        and other[:, 1].min() < top + 1.5 * apart[1]
        for other in boxes
    )


def _draw_way(axis: Axes, x: Floats, y: Floats, turn: float, colour: str, label: str = "") -> None:
    way = _turned(np.stack([x, y], axis=-1), -turn)
    axis.plot(way[:, 0], way[:, 1], color=colour, linewidth=1.4, zorder=6, label=label or "_")


def _draw_scale(strip: Axes, turn: float, points_per_metre: float) -> None:
    """Draw a bar of a round length and the directions of OpenDRIVE's axes, in axes whose unit is set to a point."""
    width = WIDTH * 72
    strip.set_xlim(0.0, width)
    strip.set_ylim(0.0, FURNITURE)
    strip.set_axis_off()
    length = _round_length(0.15 * width / points_per_metre)
    left, right = 10.0, 10.0 + length * points_per_metre
    strip.plot([left, right], [6.0, 6.0], color=INK, linewidth=2.2, solid_capstyle="butt")
    strip.text(0.5 * (left + right), 9.0, f"{length:g} m", fontsize=8, ha="center", va="bottom")
    ways = [ARROW * np.array([math.cos(angle), math.sin(angle)]) for angle in (-turn, 0.5 * math.pi - turn)]
    foot = np.array([width - 26.0, 0.5 * FURNITURE]) - 0.5 * (ways[0] + ways[1])
    for name, way in zip("xy", ways, strict=True):
        arrow = {"arrowstyle": "-|>", "color": QUIET, "linewidth": 1, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 7}
        strip.annotate("", _point(foot + way), _point(foot), arrowprops=arrow)
        strip.text(*_point(foot + 1.45 * way), name, color=QUIET, fontsize=7, ha="center", va="center")


def _point(point: Floats) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _round_length(wanted: float) -> float:
    power = 10.0 ** math.floor(math.log10(max(wanted, 1e-3)))
    return max(step * power for step in (1.0, 2.0, 5.0) if step * power <= max(wanted, power))


def _principal_direction(x: Floats, y: Floats) -> float:
    """Return the direction of the greatest variance of points, from the first to the last, rad."""
    centred = np.stack([x - x.mean(), y - y.mean()])
    _, vectors = np.linalg.eigh(centred @ centred.T)
    direction = vectors[:, -1]
    if direction @ np.array([x[-1] - x[0], y[-1] - y[0]]) < 0:
        direction = -direction
    return float(math.atan2(direction[1], direction[0]))


def _turned(points: Floats, angle: float) -> Floats:
    c, s = math.cos(angle), math.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]))


def _row_at(t: Floats, time: float) -> int:
    return min(int(np.searchsorted(t, time - 1e-6)), len(t) - 1)


def svg_of(figure: Figure, prefix: str) -> str:
    """Return the figure as an SVG element whose ids begin with `prefix`, for a page with several pictures.

    Its description is on the enclosing element. Matplotlib names clip paths by addresses in memory; here they are
    numbered, so that equal figures give equal text.
    """
    text = io.StringIO()
    FigureCanvasSVG(figure)
    with lettered(figure):
        layout = figure.get_layout_engine()
        if layout is not None:  # with an engine of its own, matplotlib draws the figure twice
            layout.execute(figure)
            figure.set_layout_engine(None)
        figure.savefig(text, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    svg = text.getvalue()
    svg = svg[svg.index("<svg") :]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, flags=re.DOTALL)
    for number, name in enumerate(re.findall(r'<clipPath id="(\w+)">', svg)):
        svg = svg.replace(name, f"clip{number}")
    svg = re.sub(r'(?<=[ #"(])id="', f'id="{prefix}-', svg)
    svg = re.sub(r'(href="#|url\(#)', rf"\g<1>{prefix}-", svg)
    svg = re.sub(r'^<svg[^>]*?viewBox="([^"]+)"[^>]*>', rf'<svg viewBox="\1" {_SVG_ATTRIBUTES}>', svg)
    for colour, variable in THEME.items():
        svg = svg.replace(colour, variable)
    return "\n".join(line.rstrip() for line in svg.splitlines())


_SVG_ATTRIBUTES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" version="1.1"'
