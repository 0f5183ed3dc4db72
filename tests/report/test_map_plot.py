"""Plots of maps: whole and windowed, as PNG and SVG, equal for equal maps, with what a reader looks for in them."""

from __future__ import annotations

import math
import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.report.map_plot import LOOKS, draw_map, plot_map
from scenario_compiler.report.map_shapes import (
    Points,
    arrow_outline,
    convex_hull,
    junction_hulls,
    lane_shapes,
    travel_arrows,
)
from scenario_compiler.report.surroundings import Window
from scenario_compiler.roads.lane_types import LANE_TYPES
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.roads.spawn_points import NamedPosition, read_spawn_points

EVERYTHING = Window(-1e4, -1e4, 1e4, 1e4)


@pytest.fixture(scope="module")
def town(repository: Path) -> Network:
    network = load_network(repository / "maps/town_grid/town_grid.xodr", cache=False)
    assert network is not None
    return network


def texts(svg: str) -> list[str]:
    """The texts of an SVG whose letters are outlines: matplotlib writes each text as a comment."""
    return re.findall(r"<!-- (.*?) -->", svg)


def test_equal_maps_give_equal_bytes(town: Network, tmp_path: Path) -> None:
    for ending in ("png", "svg"):
        for name in ("one", "other"):
            plot_map(town, tmp_path / f"{name}.{ending}")
        assert (tmp_path / f"one.{ending}").read_bytes() == (tmp_path / f"other.{ending}").read_bytes()


def test_a_map_names_its_roads_junctions_and_spawn_points(town: Network, tmp_path: Path) -> None:
    points = read_spawn_points(town.path, Diagnostics())
    plot_map(town, tmp_path / "town.svg", spawn_points=points)
    found = texts((tmp_path / "town.svg").read_text(encoding="utf-8"))
    roads = [name for name in town.road_ids if town.road(name).junction is None]
    assert set(roads) <= set(found)
    assert {f"J {name}" for name in town.junction_ids} <= set(found)
    assert set(points) <= set(found)
    assert {"100 m", "driving", "sidewalk, curb", "direction of travel", "spawn point"} <= set(found)
    assert any(text.startswith("town_grid: 13 roads, ") for text in found)


def test_a_window_shows_what_lies_in_it(town: Network, tmp_path: Path) -> None:
    pose = town.lane_pose("1", -1, 200.0)
    plot_map(town, tmp_path / "part.svg", window=Window(pose.x - 40, pose.y - 20, pose.x + 40, pose.y + 20))
    found = texts((tmp_path / "part.svg").read_text(encoding="utf-8"))
    assert "1" in found
    assert not {"9", "J 101"} & set(found)


def test_driving_lanes_have_their_colour_where_they_lie(town: Network, tmp_path: Path) -> None:
    pose = town.lane_pose("1", -1, 203.0)
    plot_map(town, tmp_path / "part.png", window=Window(pose.x - 6, pose.y - 4, pose.x + 6, pose.y + 4))
    image = cv2.imread(str(tmp_path / "part.png"))
    assert image is not None
    wanted = np.array([int(LOOKS[0].colour[k : k + 2], 16) for k in (5, 3, 1)])
    share = (np.abs(image.astype(int) - wanted).max(axis=2) < 3).mean()
    assert share > 0.3


def test_every_lane_type_has_one_style() -> None:
    types = [kind for look in LOOKS for kind in look.types]
    assert sorted(types) == sorted(LANE_TYPES)


def area(outline: Points) -> float:
    x, y = outline.T
    return abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))) / 2.0


def test_lane_outlines_cover_what_the_lanes_do(town: Network) -> None:
    """On straight roads, where the area of the lanes is the integral of their widths."""
    drawn = lane_shapes(town, EVERYTHING)
    straight = 0
    for index, name in enumerate(town.road_ids):
        length = town.road(name).length
        begin, end = (town.road_pose(name, s, 0.0) for s in (0.0, length))
        if abs(math.dist(begin[:2], end[:2]) - length) > 1e-6:
            continue
        straight += 1
        places = (np.arange(2000) + 0.5) * length / 2000
        widths = [sum(lane.t_left - lane.t_right for lane in town.lanes_at(name, s)) for s in places]
        covered = sum(area(shape.outline) for shape in drawn if shape.road == index)
        assert covered == pytest.approx(np.mean(widths) * length, rel=1e-3), name
    assert straight >= 8


def test_arrows_point_where_traffic_goes(town: Network) -> None:
    arrows = list(travel_arrows(town, EVERYTHING, 2.0, 40.0, junctions=False))
    assert len(arrows) > 100
    for arrow in arrows:
        place = town.locate(arrow.x, arrow.y)[0]
        pose = town.lane_pose(place.road, place.lane, place.s)
        towards = 1.0 if place.lane < 0 else -1.0
        assert np.cos(arrow.heading - pose.heading) * towards > 0.99
        tip = arrow_outline(arrow)[0] - (arrow.x, arrow.y)
        assert tip @ (np.cos(arrow.heading), np.sin(arrow.heading)) == pytest.approx(0.5 * arrow.length)


def test_direct_junctions_have_outlines_too(corpus: Path) -> None:
    network = load_network(corpus / "aisa-toolkit/custommap/HRI_custommap.xodr", cache=False)
    assert network is not None
    hulls = junction_hulls(network, lane_shapes(network, EVERYTHING), EVERYTHING)
    assert set(hulls) == set(network.junction_ids)


def test_hull_of_a_square_with_points_inside() -> None:
    points = np.array([[0, 0], [2, 0], [2, 2], [0, 2], [1, 1], [1, 0]], float)
    assert convex_hull(points).tolist() == [[0, 0], [2, 0], [2, 2], [0, 2]]


def test_axes_of_another_plot_take_the_map(town: Network) -> None:
    figure = Figure(figsize=(4.0, 3.0))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    entries = draw_map(axes, town, Window(0.0, 0.0, 200.0, 50.0), labels=False)
    assert axes.get_xlim() == pytest.approx((0.0, 200.0))
    assert np.diff(axes.get_ylim()) == pytest.approx(150.0)
    assert str(entries[0].get_label()) == "driving"
    figure.canvas.draw()


def test_a_spawn_point_off_the_map_is_left_out(town: Network, tmp_path: Path) -> None:
    plot_map(town, tmp_path / "town.svg", spawn_points={"nowhere": NamedPosition("1", -1, 1e6, "")})
    assert "nowhere" not in texts((tmp_path / "town.svg").read_text(encoding="utf-8"))


def test_an_unknown_ending_is_refused(town: Network, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"not as '\.pdf'"):
        plot_map(town, tmp_path / "town.pdf")
