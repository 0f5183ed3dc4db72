"""Draws a plan before it runs: the starts of the entities, the route, and the times of the events.

Equal plans give equal bytes with one version of matplotlib.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.frames import center_from_reference
from scenario_compiler.legible import legible
from scenario_compiler.plan.binding import Binder
from scenario_compiler.plan.model import Entity, Plan, RouteLeg, StartPose
from scenario_compiler.plan.painted import lines_beside, secondary_lines
from scenario_compiler.plan.standing import Standing, stands_at
from scenario_compiler.report.happenings import Happening, happenings_of, last_known_time
from scenario_compiler.report.lettering import LETTERING
from scenario_compiler.report.map_plot import draw_map, extent_of, save_picture
from scenario_compiler.report.palette import BLUE, GREY, ORANGE, VERMILION
from scenario_compiler.report.surroundings import Window
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.positions import LanePosition, Pose, SecondaryLine
from scenario_compiler.vocabulary.scenario import parameter_values

WIDTH = 11.0
"""Width of a picture, inches."""

DPI = 110.0
"""Pixels per inch of a PNG."""

SPACING = 4.0
"""Distance between two points of the route ahead, m."""

MARGIN = 30.0
"""Width of the surroundings that are shown, m."""

INSET = 1.0e-6
"""Distance of the first and last point of a leg of the route from the leg's ends, m."""

REACH = 400.0
"""Length of the route ahead that is drawn without a destination, m."""

MORE = 1.15
"""Length of the time axis relative to the last known time."""

AWAY = 12.6
"""Distance of an entity's label from its centre, points."""

COLOURS = {"ego": BLUE, "static": VERMILION, "dynamic": ORANGE}


def draw_preview(plan: Plan, network: Network, path: Path) -> None:
    """Draw a plan into a PNG or SVG file: the part of the map with actors and route, and the triggers over time.

    Raises:
        ValueError: The suffix is neither .png nor .svg.
        OSError: The file cannot be written.
    """
    happenings = list(happenings_of(plan))
    rows = max(1, len(happenings))
    window = section_of(plan, network)
    share = (window.y_max - window.y_min) / (window.x_max - window.x_min)
    map_height = min(max(share, 0.28), 0.8) * WIDTH
    height = map_height + 0.34 * rows + 1.5
    with _style():
        figure = Figure(figsize=(WIDTH, height), dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        top = 0.45 / height
        axes = figure.add_axes((0.01, 1.0 - top - map_height / height, 0.98, map_height / height))
        draw_section(axes, plan, network, window)
        title = f"{plan.name}: {plan.summary}" if plan.summary else plan.name
        axes.set_title(_shortened(title, 160), fontsize=11, loc="left")
        below = figure.add_axes((0.36, 0.5 / height, 0.62, 0.34 * rows / height))
        _draw_times(below, plan, happenings)
        save_picture(figure, path)


def draw_route(plan: Plan, network: Network, path: Path) -> None:
    """Draw the ego's route on the map into a PNG or SVG file.

    Raises:
        ValueError: The suffix is neither .png nor .svg.
        OSError: The file cannot be written.
    """
    window = _around(way_ahead(plan, network)) or extent_of(network)
    share = (window.y_max - window.y_min) / (window.x_max - window.x_min)
    with _style():
        figure = Figure(figsize=(WIDTH, min(max(share, 0.3), 1.0) * WIDTH + 0.6), dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        axes = figure.add_axes((0.01, 0.02, 0.98, 0.9))
        draw_section(axes, plan, network, window)
        length = sum(abs(leg.s_to - leg.s_from) for leg in plan.route)
        told = f"route of {length:.0f} m to the destination" if plan.route else "no destination: the way straight on"
        axes.set_title(_shortened(f"{plan.name}: {told}", 160), fontsize=11, loc="left")
        save_picture(figure, path)


def section_of(plan: Plan, network: Network) -> Window:
    """Return the part of the map with every start and the route to the farthest actor ahead, or else all of it."""
    starts = [(pose.x, pose.y) for pose in plan.derived.values()]
    ego = start_of(plan)
    if ego is None:
        return extent_of(network)
    reach = max([60.0, *(math.hypot(x - ego.x, y - ego.y) + 20.0 for x, y in starts)])
    ahead = [point for point in way_ahead(plan, network) if math.hypot(point[0] - ego.x, point[1] - ego.y) <= reach]
    return _around([*starts, *ahead]) or extent_of(network)


def start_of(plan: Plan) -> StartPose | None:
    """Return the start of the first entity with a start position; None if there is none."""
    return next((plan.derived[one.id] for one in plan.entities if one.id in plan.derived), None)


def _around(points: list[tuple[float, float]]) -> Window | None:
    if not points:
        return None
    xs, ys = [x for x, _ in points], [y for _, y in points]
    return Window(min(xs) - MARGIN, min(ys) - MARGIN, max(xs) + MARGIN, max(ys) + MARGIN)


def way_ahead(plan: Plan, network: Network) -> list[tuple[float, float]]:
    """Return points (x, y), m, along the first vehicle's route, or along its lane if it has no route.

    The list is empty if the vehicle's start is unknown, and has the start alone if that is on no lane.
    """
    if plan.route:
        # A later leg without length changes the lane at once: its neighbours show that.
        legs = [leg for k, leg in enumerate(plan.route) if k == 0 or leg.s_from != leg.s_to]
        return [point for leg in legs for point in _leg_points(network, leg)]
    pose = start_of(plan)
    if pose is None:
        return []
    place: LanePosition | None = next(iter(network.locate(pose.x, pose.y)), None)
    points = [(pose.x, pose.y)]
    for _ in range(int(REACH / SPACING)):
        place = None if place is None else network.next(place, SPACING)
        if place is None:
            break
        points.append(network.lane_pose(place.road, place.lane, place.s)[:2])
    return points


def _leg_points(network: Network, leg: RouteLeg) -> Iterator[tuple[float, float]]:
    """Yield points along a leg, slightly within its ends, because beyond its section another lane may have its id."""
    length = leg.s_to - leg.s_from
    inset = math.copysign(min(INSET, 0.5 * abs(length)), length)
    count = max(1, math.ceil(abs(length) / SPACING))
    for k in range(count + 1):
        s = leg.s_from + inset + (length - 2.0 * inset) * k / count
        yield network.lane_pose(leg.road, leg.lane, s)[:2]


def draw_section(axes: Axes, plan: Plan, network: Network, window: Window) -> None:
    """Draw a part of the map into axes, the route ahead, and the starts of entities with their paths and labels."""
    shown = tuple(one for one in plan.entities if one.id in plan.derived)
    draw_map(axes, network, window, secondary=_lines_added(plan, network, shown))
    way = way_ahead(plan, network)
    axes.plot([x for x, _ in way], [y for _, y in way], color=BLUE, linewidth=2.2, alpha=0.55, zorder=6)
    wide = axes.get_xlim()[1] - axes.get_xlim()[0]
    labels = labels_of(one.id for one in shown)
    taken = [text.get_window_extent() for text in axes.texts]
    for entity in shown:
        along = own_path(plan, network, entity)
        axes.plot([x for x, _ in along], [y for _, y in along], color=COLOURS[entity.kind], linewidth=1.4, zorder=7)
        taken.append(_draw_entity(axes, plan, entity, wide))
    for number, entity in enumerate(one for one in shown if one.id in labels):
        _write_label(axes, plan, entity, labels[entity.id], 1 if number % 2 == 0 else -1, taken)


def _lines_added(plan: Plan, network: Network, shown: tuple[Entity, ...]) -> list[SecondaryLine]:
    """Return the lines that the plan adds to the map's marks, also beside the starts of the shown entities."""
    starts = [plan.derived[one.id] for one in shown]
    poses = [Pose(one.x, one.y, one.z, one.heading, 0.0, 0.0) for one in starts]
    return [*secondary_lines(plan), *lines_beside(plan.model_copy(update={"entities": shown}), network, poses)]


def own_path(plan: Plan, network: Network, entity: Entity) -> list[tuple[float, float]]:
    """Return the corners of an entity's path from its start, (x, y) in m; none if it has none.

    Points relative to an entity without a start position are left out.
    """
    if entity.path is None:
        return []
    binder = Binder(network, parameter_values(plan.parameters), Diagnostics())
    standings = {
        name: Standing(pose, next(iter(network.locate(pose.x, pose.y)), None)) for name, pose in plan.derived.items()
    }
    found = [stands_at(binder, point.position, standings) for point in entity.path.points]
    poses = [plan.derived[entity.id], *(one.pose for one in found if one is not None)]
    return [(pose.x, pose.y) for pose in poses]


def labels_of(names: Iterable[str]) -> dict[str, str]:
    """Return the labels of entities; of a row or a repetition only the first has one, without its number."""
    labels: dict[str, str] = {}
    for name in names:
        label = re.sub(r"\.\d+(?=\.|$)", "", name)
        if label not in labels.values():
            labels[name] = label
    return labels


def _draw_entity(axes: Axes, plan: Plan, entity: Entity, wide: float) -> Bbox:
    """Draw an entity, enlarged if it would be too small to see, and return the area that it covers, pixels."""
    pose, vehicle = plan.derived[entity.id], entity.vehicle
    x, y = center_from_reference(pose.x, pose.y, pose.heading, vehicle.center)
    grown = max(1.0, wide * 0.011 / max(vehicle.length, 1.2))
    length, width = 0.5 * vehicle.length * grown, 0.5 * vehicle.width * grown
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    outline = ((length, 0.0), (0.6 * length, width), (-length, width), (-length, -width), (0.6 * length, -width))
    corners = [(x + u * c - v * s, y + u * s + v * c) for u, v in outline]
    colour = COLOURS[entity.kind]
    axes.fill(*zip(*corners, strict=True), facecolor=colour, edgecolor="white", linewidth=0.8, zorder=8)
    pixels = axes.transData.transform(corners)
    return Bbox([pixels.min(axis=0), pixels.max(axis=0)])


def _write_label(axes: Axes, plan: Plan, entity: Entity, label: str, side: int, taken: list[Bbox]) -> None:
    """Write a label on a side of an entity (1 left, -1 right), on the other side, above or below.

    It is at the first of these places where it is complete and covers nothing that is `taken`, or nowhere.
    """
    pose, vehicle = plan.derived[entity.id], entity.vehicle
    left, up = (-math.sin(pose.heading), math.cos(pose.heading)), (0.0, 1.0)
    for (x, y), away in ((left, side * AWAY), (left, -side * AWAY), (up, AWAY), (up, -AWAY)):
        text = axes.annotate(
            legible(label),
            center_from_reference(pose.x, pose.y, pose.heading, vehicle.center),
            xytext=(x * away, y * away),
            textcoords="offset points",
            fontsize=7,
            color="#10161c",
            ha="center" if abs(y) > abs(x) else "left" if x * away > 0.0 else "right",
            va="center",
            zorder=9,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )
        extent = text.get_window_extent()
        whole = axes.bbox.containsx(extent.x0) and axes.bbox.containsx(extent.x1)
        if whole and not any(extent.overlaps(one) for one in taken):
            taken.append(extent)
            return
        text.remove()


def _draw_times(axes: Axes, plan: Plan, happenings: list[Happening]) -> None:
    """Draw a row for each event: a mark at its time, or its trigger over the whole time axis.

    The axis ends after the last known time; if no time is known, it has no labels.
    """
    last = last_known_time(plan)
    end = min(plan.duration, MORE * last) if last else plan.duration
    axes.set_xlim(0.0, end)
    axes.set_ylim(-0.5, max(1, len(happenings)) - 0.5)
    axes.invert_yaxis()
    axes.set_yticks(range(len(happenings)), [_shortened(one.label, 62) for one in happenings], fontsize=7.5)
    axes.tick_params(axis="x", labelsize=8)
    axes.set_xlabel("time, s" if last else "time", fontsize=8)
    if not last:
        axes.set_xticks([])
    for row, one in enumerate(happenings):
        if one.time is None:
            axes.barh(row, end, height=0.6, color=GREY, alpha=0.18)
            axes.text(0.01 * end, row, _shortened(f"when {one.trigger}", 116), va="center", fontsize=7.5)
            continue
        axes.plot([one.time], [row], marker="D", color=VERMILION, markersize=6, clip_on=False)
        late = one.time > 0.7 * end
        shift = -0.015 if late else 0.015
        axes.text(
            one.time + shift * end, row, f"{one.time:g} s", va="center", ha="right" if late else "left", fontsize=7.5
        )
    if not happenings:
        axes.text(0.5 * end, 0, "nothing is triggered", ha="center", va="center", fontsize=8, color=GREY)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _shortened(text: str, most: int) -> str:
    shown = legible(text)
    return shown if len(shown) <= most else f"{shown[: most - 1]}…"


def _style() -> AbstractContextManager[None]:
    return mpl.rc_context({"svg.hashsalt": "scenario-compiler", "font.family": "DejaVu Sans", **LETTERING})
