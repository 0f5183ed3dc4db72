"""Draws a map for readers: lanes by type, marks, directions, ids, junctions, spawn points; as PNG or SVG.

`plot_map` writes a picture of its own; `draw_map` draws into the axes of another plot. Equal input gives equal bytes
with one version of matplotlib. The colours are tints of the set by Okabe and Ito, which colour-blind people can tell
apart; lane types also differ in lightness.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from scenario_compiler.legible import legible
from scenario_compiler.outputs import write_whole
from scenario_compiler.report.lettering import LETTERING, lettered
from scenario_compiler.report.map_shapes import (
    LaneShape,
    Points,
    arrow_outline,
    holds,
    junction_hulls,
    lane_shapes,
    mark_lines,
    travel_arrows,
    turning_paths,
)
from scenario_compiler.report.surroundings import Window
from scenario_compiler.roads import SecondaryLine, geometry, mesh
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.spawn_points import NamedPosition

POINTS_PER_INCH = 72.0

CLOSE_VIEW = 0.15
"""Scale below which the roads in junctions have paths, arrows and ids, metres per point."""


@dataclass(frozen=True)
class LaneLook:
    """How lanes of some types are drawn, and their name in the legend."""

    label: str
    colour: str
    types: tuple[str, ...]


LOOKS = (
    LaneLook("driving", "#8d949c", ("driving", "bidirectional", "shared", "slipLane", "noOvertakeTrucks")),
    LaneLook(
        "entry, exit, ramp",
        "#5b87a6",
        ("entry", "exit", "onRamp", "offRamp", "connectingRamp", "mwyEntry", "mwyExit"),
    ),
    LaneLook("bus, taxi, high occupancy", "#c98a3a", ("bus", "taxi", "HOV")),
    LaneLook("shoulder, border, stop", "#cfd2d6", ("shoulder", "border", "stop", "restricted", "roadWorks")),
    LaneLook("parking", "#d9a9c6", ("parking",)),
    LaneLook("biking", "#d97f4f", ("biking",)),
    LaneLook("sidewalk, curb", "#efe3a4", ("sidewalk", "walking", "curb")),
    LaneLook("median", "#8cc5a8", ("median",)),
    LaneLook("tram, rail", "#a08bb5", ("tram", "rail")),
    LaneLook("other", "#eceded", ("none", "special1", "special2", "special3")),
)
_LOOK_OF_TYPE = {kind: look for look in LOOKS for kind in look.types}

_MARK_COLOURS = {
    mesh.Paint.WHITE: "#ffffff",
    mesh.Paint.YELLOW: "#ffd400",
    mesh.Paint.BLUE: "#0072b2",
    mesh.Paint.GREEN: "#009e73",
    mesh.Paint.RED: "#b22222",
    mesh.Paint.ORANGE: "#e08a00",
    mesh.Paint.VIOLET: "#7b4b94",
    mesh.Paint.BLACK: "#101010",
}
SIZE = 11.0
"""Longer side of a picture, inches."""

DPI = 130.0
"""Pixels per inch of a PNG."""

_JUNCTION = "#cc5f9b"
_SPAWN = "#d55e00"
_ARROW = "#20303c"


def plot_map(
    network: Network,
    path: str | Path,
    *,
    window: Window | None = None,
    spawn_points: Mapping[str, NamedPosition] | None = None,
) -> None:
    """Write a picture of a network, or of a window of it.

    Args:
        network: The roads.
        path: Path of the picture; its suffix (.png or .svg) determines the format.
        window: The part to show; None for everything.
        spawn_points: Named places to mark (`roads.spawn_points.read_spawn_points`).

    Raises:
        ValueError: The suffix is neither .png nor .svg.
        OSError: The file cannot be written.
    """
    shown = window if window is not None else extent_of(network)
    width, height = _figure_size(shown)
    with mpl.rc_context(
        {"svg.hashsalt": "scenario-compiler", "font.family": "DejaVu Sans", "path.simplify": True, **LETTERING}
    ):
        figure = Figure(figsize=(width, height), dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        below = 0.62 / height
        axes = figure.add_axes((0.15 / width, below, 1.0 - 0.3 / width, 1.0 - below - 0.38 / height))
        handles = draw_map(axes, network, shown, spawn_points=spawn_points)
        axes.set_title(legible(_title(network)), fontsize=10, loc="left", pad=5)
        columns = max(1, min(len(handles), int(width / 1.75)))
        figure.legend(handles=handles, loc="lower center", ncols=columns, fontsize=7, frameon=False, borderpad=0.2)
        save_picture(figure, path)


def save_picture(figure: Figure, path: str | Path) -> None:
    """Write a figure as a PNG or SVG file; equal figures give equal bytes.

    Raises:
        ValueError: The suffix is neither .png nor .svg.
        OSError: The file cannot be written.
    """
    ending = Path(path).suffix.lower()
    if ending not in (".png", ".svg"):
        raise ValueError(f"a picture is drawn as .png or .svg, not as '{Path(path).suffix}'")
    metadata = {"Software": None} if ending == ".png" else {"Date": None, "Creator": None}
    picture = io.BytesIO()
    with lettered(figure):
        figure.savefig(picture, format=ending[1:], metadata=metadata)
    write_whole(path, picture.getvalue())


def draw_map(
    axes: Axes,
    network: Network,
    window: Window | None = None,
    *,
    spawn_points: Mapping[str, NamedPosition] | None = None,
    labels: bool = True,
    secondary: Sequence[SecondaryLine] = (),
) -> list[Patch | Line2D]:
    """Draw a network into axes, with the window as limits, equal scales and a scale bar.

    Args:
        axes: Axes of a figure whose size is set, because the readability of texts depends on it.
        network: The roads.
        window: The least part to show; None for everything.
        spawn_points: Named places to mark.
        labels: Whether to write the ids of roads and junctions and the names of spawn points.
        secondary: Lines beside the map's marks.

    Returns:
        The entries of a legend.
    """
    figure = axes.get_figure(root=True)
    box = axes.get_window_extent()
    shown = _fitted(window if window is not None else extent_of(network), box.width, box.height)
    axes.set_xlim(shown.x_min, shown.x_max)
    axes.set_ylim(shown.y_min, shown.y_max)
    axes.set_aspect("equal", adjustable="box")
    dots = figure.dpi if figure is not None else POINTS_PER_INCH
    scale = (shown.x_max - shown.x_min) * dots / (box.width * POINTS_PER_INCH)
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color("#b0b4b8")
    shapes = lane_shapes(network, shown)
    _draw_lanes(axes, shapes)
    paints = _draw_marks(axes, network, shown, scale, secondary)
    hulls = junction_hulls(network, shapes, shown)
    _draw_junctions(axes, hulls)
    close = scale < CLOSE_VIEW
    if close:
        paths = turning_paths(network, shapes)
        axes.add_collection(LineCollection(paths, colors=[_ARROW], linewidths=0.6, alpha=0.6, zorder=5))
    arrows = [arrow_outline(one) for one in travel_arrows(network, shown, 6.0 * scale, 60.0 * scale, close)]
    axes.add_collection(PolyCollection(arrows, facecolors=_ARROW, edgecolors="none", zorder=5))
    placed = _Labels(axes, scale)
    placed.keep_free(_draw_scale_bar(axes, shown, scale))
    if labels:
        _write_junctions(hulls, placed, scale)
    points = (spawn_points or {}).items()
    drawn = [_draw_spawn_point(axes, network, *point, shown, placed if labels else None) for point in points]
    if labels:
        _write_roads(network, shown, placed, scale)
    return _legend({shape.type for shape in shapes}, paints, bool(hulls), any(drawn))


def extent_of(network: Network) -> Window:
    """Return the part of the plane that contains all roads."""
    x0, y0, x1, y1 = network.bounds()
    margin = max(5.0, 0.03 * max(x1 - x0, y1 - y0))
    return Window(x0 - margin, y0 - margin, x1 + margin, y1 + margin)


def _fitted(window: Window, width: float, height: float) -> Window:
    """Return a window extended around its centre to the proportions of a box."""
    wide = max(window.x_max - window.x_min, 1.0)
    high = max(window.y_max - window.y_min, 1.0)
    wide, high = max(wide, high * width / height), max(high, wide * height / width)
    x, y = (window.x_min + window.x_max) / 2.0, (window.y_min + window.y_max) / 2.0
    return Window(x - wide / 2.0, y - high / 2.0, x + wide / 2.0, y + high / 2.0)


def _figure_size(window: Window) -> tuple[float, float]:
    """Return width and height in inches, with the window's proportions limited to 1:3 and 1:1."""
    wide = window.x_max - window.x_min
    ratio = (window.y_max - window.y_min) / wide if wide > 0.0 else 1.0
    if ratio <= 1.0:
        return SIZE, max(ratio, 1.0 / 3.0) * SIZE + 1.0
    return max(1.0 / ratio, 0.55) * SIZE, SIZE + 1.0


def _title(network: Network) -> str:
    n = network.tables
    kilometres = sum(length for length, j in zip(n.road_length, n.road_junction, strict=True) if j < 0) / 1000.0
    counts = sum(j < 0 for j in n.road_junction), len(network.junction_ids)
    roads, junctions = (
        f"{k} {word}{'' if k == 1 else 's'}" for k, word in zip(counts, ("road", "junction"), strict=True)
    )
    return f"{network.name}: {roads}, {kilometres:.2f} km, {junctions}"


def _draw_lanes(axes: Axes, shapes: list[LaneShape]) -> None:
    for order, look in enumerate(reversed(LOOKS)):
        outlines = [shape.outline for shape in shapes if _LOOK_OF_TYPE[shape.type] is look]
        axes.add_collection(
            PolyCollection(
                outlines, facecolors=look.colour, edgecolors=look.colour, linewidths=0.15, zorder=1 + order / 50
            )
        )


def _draw_marks(
    axes: Axes, network: Network, window: Window, scale: float, secondary: Sequence[SecondaryLine]
) -> list[mesh.Paint]:
    """Draw every mark; return the used colours."""
    marks = mesh.road_marks(network, secondary=secondary)
    kept, lines = mark_lines(marks, window)
    colours = np.array([mpl.colors.to_rgba(_MARK_COLOURS[paint]) for paint in mesh.Paint])[marks.colour[kept]]
    colours[:, 3] = 0.12 + 0.88 * np.clip(marks.quality[kept], 0.0, 1.0)
    widths = np.maximum(marks.width[kept] / scale, min(0.7, 0.35 / scale + 0.25))
    axes.add_collection(
        LineCollection(list(lines), colors=list(colours), linewidths=list(widths), capstyle="butt", zorder=3)
    )
    return [paint for paint in mesh.Paint if (marks.colour[kept] == paint).any()]


def _draw_junctions(axes: Axes, hulls: dict[str, Points]) -> None:
    outlines = list(hulls.values())
    axes.add_collection(
        PolyCollection(
            outlines, facecolors=(*mpl.colors.to_rgb(_JUNCTION), 0.13), edgecolors=_JUNCTION, linewidths=0.7, zorder=4
        )
    )


class _Labels:
    """Places texts so that they do not cover each other."""

    def __init__(self, axes: Axes, scale: float) -> None:
        self._axes = axes
        self._scale = scale
        self.step = 8.0 * scale
        self._taken: list[tuple[float, float, float, float]] = []

    def place(self, text: str, spots: list[tuple[float, float]], size: float, colour: str, force: bool = False) -> bool:
        """Write a text at the first free place; with `force`, at the first place if none is free."""
        w, h = (0.64 * len(text) + 0.7) * size * self._scale / 2.0, 1.5 * size * self._scale / 2.0
        (left, right), (bottom, top) = self._axes.get_xlim(), self._axes.get_ylim()
        for x, y in spots:
            inside = left + w <= x <= right - w and bottom + h <= y <= top - h
            covers = any(abs(x - a) < w + c and abs(y - b) < h + d for a, b, c, d in self._taken)
            if inside and not covers:
                self._write(text, x, y, w, h, size, colour)
                return True
        if force and spots:
            self._write(text, *spots[0], w, h, size, colour)
        return force

    def keep_free(self, window: Window) -> None:
        """Reserve a part of the plane, so that only forced texts cover it."""
        x, y = (window.x_min + window.x_max) / 2.0, (window.y_min + window.y_max) / 2.0
        self._taken.append((x, y, window.x_max - x, window.y_max - y))

    def _write(self, text: str, x: float, y: float, w: float, h: float, size: float, colour: str) -> None:
        self._taken.append((x, y, w, h))
        frame = {
            "boxstyle": "round,pad=0.18",
            "facecolor": "white",
            "edgecolor": colour,
            "linewidth": 0.5,
            "alpha": 0.92,
        }
        self._axes.text(
            x, y, text, fontsize=size, color=colour, ha="center", va="center", bbox=frame, zorder=8, clip_on=True
        )


def _write_junctions(hulls: dict[str, Points], placed: _Labels, scale: float) -> None:
    for name, hull in hulls.items():
        x, y = hull.mean(axis=0).tolist()
        beside = [(x + a * 16.0 * scale, y + b * 12.0 * scale) for a, b in _AROUND]
        placed.place(f"J {name}", [(x, y), *(0.5 * (hull + np.array([x, y]))).tolist(), *beside], 6.5, "#8e2f68")


def _write_roads(network: Network, window: Window, placed: _Labels, scale: float) -> None:
    """Write the ids of roads, the longest first; those of connecting roads only in close views."""
    n = network.tables
    order = sorted(range(len(n.road_length)), key=lambda road: (n.road_junction[road] >= 0, -n.road_length[road], road))
    for road in order:
        if n.road_junction[road] < 0 or scale < CLOSE_VIEW:
            spots = [_beside(network, road, share, side, scale) for side in (0.0, 1.0, -1.0) for share in _SHARES]
            seen = [(x, y) for x, y in spots if holds(window, x, y)]
            placed.place(network.road_ids[road], seen, 6.5, "#1d2a33")


_SHARES = tuple(0.5 + side * k / 40.0 for k in range(0, 20, 2) for side in (1.0, -1.0))[1:]


def _beside(network: Network, road: int, share: float, side: float, scale: float) -> tuple[float, float]:
    """Return a point at the centre of a road's lanes, or beside them."""
    n = network.tables
    s = share * n.road_length[road]
    x, y, h, _ = geometry.road_reference(n, road, s)
    found = [(lane.t_left, lane.t_right) for lane in network.lanes_at(network.road_ids[road], s)]
    high, low = max((t for t, _ in found), default=0.0), min((t for _, t in found), default=0.0)
    t = 0.5 * (high + low) + side * (0.5 * (high - low) + 9.0 * scale)
    return x - t * math.sin(h), y + t * math.cos(h)


def _draw_spawn_point(
    axes: Axes, network: Network, name: str, point: NamedPosition, window: Window, placed: _Labels | None
) -> bool:
    """Draw a disc at a spawn point, and its name; return False if it is not on the network or not in the window."""
    try:
        pose = network.lane_pose(point.road, point.lane, point.s)
    except ValueError:
        return False
    if not holds(window, pose.x, pose.y):
        return False
    axes.plot(
        [pose.x], [pose.y], "o", markersize=6, color=_SPAWN, markeredgecolor="white", markeredgewidth=0.9, zorder=7
    )
    if placed is not None:
        step = placed.step
        spots = [(pose.x + a * step * (1 + len(name) / 4), pose.y + b * step) for a, b in _AROUND]
        placed.place(name, spots, 6.5, "#8a3d00", force=True)
    return True


_AROUND = ((0, 2), (0, -2), (1, 1), (-1, 1), (1, -1), (-1, -1), (0, 4), (0, -4), (2, 0), (-2, 0))


def _draw_scale_bar(axes: Axes, window: Window, scale: float) -> Window:
    """Draw a bar of a round length, about a sixth of the width, at the lower left; return the area that it covers."""
    about = (window.x_max - window.x_min) / 6.0
    power = 10.0 ** math.floor(math.log10(about))
    length = max(step for step in (power, 2.0 * power, 5.0 * power) if step <= about)
    x, y = window.x_min + 14.0 * scale, window.y_min + 12.0 * scale
    for width, colour in ((4.0, "white"), (2.0, "#1d2a33")):
        axes.plot([x, x + length], [y, y], color=colour, linewidth=width, solid_capstyle="butt", zorder=9)
    text = f"{length / 1000:g} km" if length >= 1000.0 else f"{length:g} m"
    frame = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.85}
    axes.text(x + length / 2, y + 5 * scale, text, fontsize=7, ha="center", va="bottom", bbox=frame, zorder=9)
    return Window(x, y, x + length, y + 14 * scale)


def _legend(types: set[str], paints: list[mesh.Paint], junctions: bool, spawns: bool) -> list[Patch | Line2D]:
    present = {_LOOK_OF_TYPE[kind].label for kind in types}
    handles: list[Patch | Line2D] = [
        Patch(facecolor=look.colour, edgecolor="#80858a", linewidth=0.3, label=look.label)
        for look in LOOKS
        if look.label in present
    ]
    for paint in paints:
        name = f"{paint.name.lower()} mark (paler: worn)" if paint == mesh.Paint.WHITE else f"{paint.name.lower()} mark"
        handles.append(Patch(facecolor=_MARK_COLOURS[paint], edgecolor="#404548", linewidth=0.6, label=name))
    handles.append(_symbol(">", _ARROW, "direction of travel"))
    if junctions:
        tint = (*mpl.colors.to_rgb(_JUNCTION), 0.13)
        handles.append(Patch(facecolor=tint, edgecolor=_JUNCTION, linewidth=0.7, label="junction (J id)"))
    if spawns:
        handles.append(_symbol("o", _SPAWN, "spawn point"))
    return handles


def _symbol(marker: str, colour: str, label: str) -> Line2D:
    return Line2D([], [], linestyle="", marker=marker, markersize=5, color=colour, markeredgecolor="white", label=label)
