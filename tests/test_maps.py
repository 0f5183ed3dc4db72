"""The packaged maps: rebuilt to the byte, closed at every joint, linked, described, and loaded by CARLA."""

from __future__ import annotations

import importlib.util
import json
import math
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from lxml import etree
from numpy.typing import NDArray

from scenario_compiler import load_network
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.roads.export_carla import export_for_carla

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MAPS = ("highway_loop", "motorway", "signal_crossing", "town_grid")

# The acceleration lane ends on the road "west_entry", the deceleration lane begins on "west_exit": (map, road,
# lane section, lane). No other driving lane ends or begins anywhere.
LANES_THAT_END = {("highway_loop", "11", 2, -3)}
LANES_THAT_BEGIN = {("highway_loop", "12", 1, -3)}

POSITION_TOLERANCE = 1e-3  # m
HEADING_TOLERANCE = 1e-4  # rad
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


@dataclass(frozen=True)
class Lane:
    """A lane of a section: type, width polynomial (one record), links, and its element."""

    kind: str
    width: tuple[float, float, float, float]
    before: int | None
    after: int | None
    element: etree._Element

    def width_at(self, ds: float) -> float:
        """Width (m) at ds (m) from the section's start."""
        return sum(c * ds**i for i, c in enumerate(self.width))


@dataclass(frozen=True)
class Section:
    """A lane section: extent along the road (m) and its lanes by id, centre excluded."""

    start: float
    end: float
    lanes: dict[int, Lane]

    def lateral(self, lane: int, s: float) -> float:
        """Lateral position t (m) of the lane's centre at s."""
        side = 1 if lane > 0 else -1
        widths = [self.lanes[i].width_at(s - self.start) for i in range(side, lane + side, side)]
        return side * (sum(widths) - 0.5 * widths[-1])


class Road:
    """A road of a map, read with plain arithmetic."""

    def __init__(self, element: etree._Element) -> None:
        self.element = element
        self.id = str(element.get("id"))
        self.name = str(element.get("name"))
        self.length = number(element, "length")
        self.junction = str(element.get("junction"))
        self.geometry = element.findall("planView/geometry")
        found = element.findall("lanes/laneSection")
        starts = [number(section, "s") for section in found]
        ends = [*starts[1:], self.length]
        self.sections = [
            Section(start, end, dict(lanes_of(section)))
            for section, start, end in zip(found, starts, ends, strict=True)
        ]

    def link(self, side: str) -> tuple[str, str, str | None] | None:
        """Element type, id and contact of the road's predecessor or successor."""
        link = self.element.find(f"link/{side}")
        if link is None:
            return None
        return str(link.get("elementType")), str(link.get("elementId")), link.get("contactPoint")

    def contact(self, contact: str) -> tuple[Section, float]:
        """The section at the road's start or end, and its s there."""
        return (self.sections[0], 0.0) if contact == "start" else (self.sections[-1], self.length)

    def at(self, s: float, t: float = 0.0) -> tuple[float, float, float]:
        """Point (m) and heading (rad) at s, t."""
        geometry = [g for g in self.geometry if number(g, "s") <= s + 1e-9][-1]
        x, y, heading = end_of_geometry(geometry, s - number(geometry, "s"))
        return x - t * math.sin(heading), y + t * math.cos(heading), heading


def number(element: etree._Element, name: str) -> float:
    return float(element.get(name, "nan"))


def lanes_of(section: etree._Element) -> Iterator[tuple[int, Lane]]:
    for lane in section.iterfind("*/lane"):
        widths = lane.findall("width")
        if not widths:
            continue
        links = {link.tag: int(number(link, "id")) for link in lane.iterfind("link/*")}
        assert len(widths) == 1
        a, b, c, d = (number(widths[0], name) for name in "abcd")
        kind = str(lane.get("type"))
        yield (
            int(number(lane, "id")),
            Lane(kind, (a, b, c, d), links.get("predecessor"), links.get("successor"), lane),
        )


def end_of_geometry(geometry: etree._Element, length: float) -> tuple[float, float, float]:
    """Point (m) and heading (rad) at `length` along a geometry, by Gauss-Legendre quadrature."""
    shape = geometry[0]
    k0 = number(shape, "curvStart") if shape.tag == "spiral" else float(shape.get("curvature", 0.0))
    k1 = number(shape, "curvEnd") if shape.tag == "spiral" else k0
    rate = (k1 - k0) / number(geometry, "length")
    u = 0.5 * length * (NODES + 1.0)
    heading = number(geometry, "hdg") + k0 * u + 0.5 * rate * u * u
    x = number(geometry, "x") + 0.5 * length * float(WEIGHTS @ np.cos(heading))
    y = number(geometry, "y") + 0.5 * length * float(WEIGHTS @ np.sin(heading))
    return x, y, number(geometry, "hdg") + k0 * length + 0.5 * rate * length * length


def assert_same_pose(
    here: tuple[float, float, float], there: tuple[float, float, float], facing: float, where: str
) -> None:
    assert math.hypot(here[0] - there[0], here[1] - there[1]) < POSITION_TOLERANCE, where
    assert abs(math.remainder(here[2] - there[2] - facing, math.tau)) < HEADING_TOLERANCE, where


class Map:
    """A map folder: its description and its roads by id."""

    def __init__(self, folder: Path) -> None:
        self.name = folder.name
        self.folder = folder
        self.file = folder / f"{folder.name}.xodr"
        self.tree = etree.parse(self.file)
        self.roads = {road.id: road for road in map(Road, self.tree.iterfind("road"))}
        self.description: dict[str, Any] = tomllib.loads((folder / "map.toml").read_text(encoding="utf-8"))

    def road(self, name: str) -> Road:
        """The road of that name."""
        return next(road for road in self.roads.values() if road.name == name)

    def entries(self, junction: str) -> set[tuple[str, int]]:
        """The (road, lane) from which a connection of the junction starts."""
        return {
            (str(connection.get("incomingRoad")), int(number(link, "from")))
            for connection in self.tree.iterfind(f"junction[@id='{junction}']/connection")
            for link in connection.iterfind("laneLink")
        }


@pytest.fixture(scope="module", params=MAPS)
def map_(request: pytest.FixtureRequest, repository: Path) -> Map:
    return Map(repository / "maps" / request.param)


@pytest.fixture(scope="module")
def highway(repository: Path) -> Map:
    return Map(repository / "maps" / "highway_loop")


@pytest.fixture(scope="module")
def town(repository: Path) -> Map:
    return Map(repository / "maps" / "town_grid")


@pytest.mark.skipif(importlib.util.find_spec("scenariogeneration") is None, reason="needs the extra `maps`")
def test_build_writes_the_same_bytes(map_: Map, tmp_path: Path) -> None:
    target = tmp_path / "rebuilt.xodr"
    environment = {**os.environ, "PYTHONHASHSEED": "7"}
    subprocess.run(
        [sys.executable, str(map_.folder / "build.py"), str(target)], check=True, env=environment, cwd=tmp_path
    )
    assert target.read_bytes() == map_.file.read_bytes()


def test_reference_lines_are_closed(map_: Map) -> None:
    for road in map_.roads.values():
        s = 0.0
        for here, following in pairwise(road.geometry):
            s += number(here, "length")
            assert number(following, "s") == pytest.approx(s, abs=1e-5)
            end = end_of_geometry(here, number(here, "length"))
            assert_same_pose(end, end_of_geometry(following, 0.0), 0.0, f"road {road.id} at {s}")
        assert s + number(road.geometry[-1], "length") == pytest.approx(road.length, abs=1e-5)


def test_linked_lanes_meet_at_the_joints_of_sections(map_: Map) -> None:
    for road in map_.roads.values():
        for before, after in pairwise(road.sections):
            s = after.start
            for number_, lane in before.lanes.items():
                if lane.after is None:
                    assert lane.width_at(s - before.start) == pytest.approx(0.0, abs=1e-9)
                    continue
                assert after.lanes[lane.after].before == number_
                assert after.lanes[lane.after].kind == lane.kind
                assert after.lateral(lane.after, s) == pytest.approx(before.lateral(number_, s), abs=1e-6)


def test_linked_lanes_meet_at_the_joints_of_roads(map_: Map) -> None:
    for road in map_.roads.values():
        for side, contact in (("predecessor", "start"), ("successor", "end")):
            link = road.link(side)
            assert link is not None, f"road {road.id} has no {side}"
            kind, other_id, other_contact = link
            if kind == "junction":
                continue
            assert other_contact is not None
            other = map_.roads[other_id]
            section, s = road.contact(contact)
            other_section, other_s = other.contact(other_contact)
            facing = 0.0 if contact != other_contact else math.pi
            for number_, lane in section.lanes.items():
                target = lane.before if side == "predecessor" else lane.after
                if target is None:
                    assert lane.kind != "driving"
                    continue
                where = f"road {road.id} lane {number_} {side}"
                assert other_section.lanes[target].kind == lane.kind, where
                assert_same_pose(
                    road.at(s, section.lateral(number_, s)),
                    other.at(other_s, other_section.lateral(target, other_s)),
                    facing,
                    where,
                )
                width = lane.width_at(s - section.start)
                other_width = other_section.lanes[target].width_at(other_s - other_section.start)
                assert width == pytest.approx(other_width, abs=1e-6), where
                if road.junction == other.junction == "-1":
                    back = other_section.lanes[target]
                    assert (back.before if other_contact == "start" else back.after) == number_, where


def test_only_the_acceleration_lane_ends(map_: Map) -> None:
    ends, begins = set(), set()
    for road in map_.roads.values():
        for index, section in enumerate(road.sections):
            for number_, lane in section.lanes.items():
                if lane.kind != "driving":
                    continue
                place = (map_.name, road.id, index, number_)
                ahead, behind = ("successor", "predecessor") if number_ < 0 else ("predecessor", "successor")
                if not continues(map_, road, index, number_, ahead):
                    ends.add(place)
                if not continues(map_, road, index, number_, behind):
                    begins.add(place)
    assert ends == {place for place in LANES_THAT_END if place[0] == map_.name}
    assert begins == {place for place in LANES_THAT_BEGIN if place[0] == map_.name}


def continues(map_: Map, road: Road, index: int, lane: int, side: str) -> bool:
    """Whether a lane goes on at its section's end towards `side`: by its link, or through a junction."""
    linked = road.sections[index].lanes[lane]
    if (linked.after if side == "successor" else linked.before) is not None:
        return True
    at_the_end = index == (len(road.sections) - 1 if side == "successor" else 0)
    link = road.link(side)
    if not at_the_end or link is None or link[0] != "junction":
        return False
    leaving = (side == "successor") == (lane < 0)
    if leaving:
        return (road.id, lane) in map_.entries(link[1])
    return any(
        other.junction == link[1]
        and (kind_and_id := other.link("successor")) is not None
        and kind_and_id[1] == road.id
        and any(made.after == lane for made in other.sections[-1].lanes.values())
        for other in map_.roads.values()
    )


def test_surfaces_of_junctions_have_no_holes(map_: Map) -> None:
    for junction in map_.tree.iterfind("junction"):
        inside = [road for road in map_.roads.values() if road.junction == junction.get("id")]
        image = raster([polygon for road in inside for polygon in lane_polygons(road)], metres_a_pixel=0.1)
        _, labels, sizes, _ = cv2.connectedComponentsWithStats(255 - image)
        outside = labels[0, 0]
        holes = [int(sizes[i][4]) for i in range(1, len(sizes)) if i != outside]
        assert all(pixels < 6 for pixels in holes), f"{junction.get('name')}: {holes}"


def lane_polygons(road: Road) -> Iterator[NDArray[np.float64]]:
    for section in road.sections:
        stations = np.linspace(section.start, section.end, 2 + int((section.end - section.start) / 0.5))
        for number_, lane in section.lanes.items():
            borders = [
                [
                    road.at(s, section.lateral(number_, s) + side * lane.width_at(s - section.start))[:2]
                    for s in stations
                ]
                for side in (-0.5, 0.5)
            ]
            for i in range(len(stations) - 1):
                quad = (borders[0][i], borders[0][i + 1], borders[1][i + 1], borders[1][i])
                yield np.array(quad)


def raster(polygons: list[NDArray[np.float64]], metres_a_pixel: float) -> NDArray[np.uint8]:
    points = np.concatenate(polygons)
    low = points.min(axis=0) - 1.0
    width, height = ((points.max(axis=0) + 1.0 - low) / metres_a_pixel).astype(int) + 1
    image = np.zeros((int(height), int(width)), np.uint8)
    for polygon in polygons:
        pixels = np.round((polygon - low) / metres_a_pixel * 16.0).astype(np.int32)
        cv2.fillConvexPoly(image, pixels, 255, shift=4)
    return image


def test_description_names_every_road_and_places_spawn_points_on_lanes(map_: Map) -> None:
    described = {road["id"]: road["name"] for road in map_.description["road"]}
    assert described == {road.id: road.name for road in map_.roads.values() if road.junction == "-1"}
    assert map_.description["name"] == map_.name
    assert map_.description["file"] == map_.file.name
    assert map_.description["licence"] == "MIT"
    names = [point["name"] for point in map_.description["spawn_point"]]
    assert len(names) == len(set(names))
    for point in map_.description["spawn_point"]:
        road = map_.roads[point["road"]]
        section = next(section for section in road.sections if section.start <= point["s"] < section.end)
        lane = section.lanes[point["lane"]]
        assert lane.kind == "driving", point["name"]
        assert lane.width_at(point["s"] - section.start) > 3.0, point["name"]


def test_every_road_has_a_speed_limit_and_a_version_that_readers_know(map_: Map) -> None:
    header = map_.tree.find("header")
    assert header is not None
    assert (header.get("revMajor"), header.get("revMinor")) == ("1", "6")
    for road in map_.roads.values():
        speed = road.element.find("type/speed")
        assert speed is not None
        assert speed.get("unit") == "km/h"
        assert 30.0 <= number(speed, "max") <= 130.0


def marks(road: Road, lane: int, section: int = 0) -> list[tuple[float, str, float]]:
    """(sOffset, type, quality) of a lane's marks."""
    element = road.sections[section].lanes[lane].element
    return [
        (
            number(mark, "sOffset"),
            str(mark.get("type")),
            quality(mark),
        )
        for mark in element.iterfind("roadMark")
    ]


def quality(mark: etree._Element) -> float:
    data = mark.find("userData[@code='marking_quality']")
    return 1.0 if data is None else number(data, "value")


def test_paint_of_the_highway(highway: Map) -> None:
    assert highway.road("north_straight").length >= 500.0
    assert marks(highway.road("north_straight"), -2) == [(0.0, "solid", 1.0)]
    worn = marks(highway.road("east_worn"), -1)
    assert [mark[2] for mark in worn] == [1.0, 0.6, 0.4, 0.2, 1.0]
    covered = [kind for _, kind, _ in marks(highway.road("east_covered"), -2)]
    assert covered[::2] == ["solid"] * 13
    assert covered[1::2] == ["none"] * 12
    missing = marks(highway.road("east_missing"), -1)
    assert missing == [(0.0, "broken", 1.0), (72.0, "none", 1.0), (450.0, "broken", 1.0)]


def test_marks_of_the_motorway_are_european(highway: Map) -> None:
    road = highway.road("north_straight")
    lane_line = road.sections[0].lanes[-1].element.find("roadMark/type/line")
    edge_line = road.sections[0].lanes[-2].element.find("roadMark")
    assert lane_line is not None
    assert edge_line is not None
    assert [number(lane_line, name) for name in ("width", "length", "space")] == [0.15, 6.0, 12.0]
    assert number(edge_line, "width") == 0.30


def test_acceleration_lane_ends_while_the_shoulder_continues(highway: Map) -> None:
    solid, broken, taper, after = highway.road("west_entry").sections
    kinds = [marks(highway.road("west_entry"), -2, index)[0][1] for index in range(4)]
    assert kinds == ["solid", "broken", "broken", "solid"]
    assert 190.0 <= broken.end - broken.start <= 220.0
    assert taper.lanes[-3].width_at(taper.end - taper.start) == pytest.approx(0.0, abs=1e-9)
    assert [section.lanes[-4].kind for section in (solid, broken, taper)] == ["shoulder"] * 3
    assert after.lanes[-3].kind == "shoulder"


def test_motorway_has_long_straights_and_wide_curves(highway: Map) -> None:
    motorway = [road for road in highway.roads.values() if int(road.id) < 20]
    curvatures = [
        abs(number(arc, "curvature")) for road in motorway for arc in road.element.iterfind("planView/geometry/arc")
    ]
    assert max(curvatures) <= 1.0 / 300.0
    straights = [
        number(geometry, "length") for geometry in highway.road("north_straight").geometry if geometry[0].tag == "line"
    ]
    assert max(straights) >= 600.0


def test_town_turns_every_way_at_every_junction(town: Map) -> None:
    for junction in town.tree.iterfind("junction"):
        inside = [road for road in town.roads.values() if road.junction == junction.get("id")]
        ways: dict[str, set[str]] = {}
        for road in inside:
            incoming, outgoing = road.link("predecessor"), road.link("successor")
            assert incoming is not None
            assert outgoing is not None
            ways.setdefault(incoming[1], set()).add(outgoing[1])
        assert len(ways) in {3, 4}
        assert all(exits == set(ways) - {arm} for arm, exits in ways.items())


def test_town_has_a_long_street_and_one_with_two_lanes_in_each_direction(town: Map) -> None:
    assert town.road("main_street").length >= 400.0
    assert [geometry[0].tag for geometry in town.road("main_street").geometry] == ["line"]
    lanes = town.road("ring_north").sections[0].lanes
    assert [number_ for number_, lane in lanes.items() if lane.kind == "driving"] == [2, 1, -1, -2]


CARLA_PROBE = """
import json, sys, pathlib, carla
town = carla.Map("probe", pathlib.Path(sys.argv[1]).read_text())
ends = json.loads(sys.argv[2])
waypoints = town.generate_waypoints(2.0)
dead = [(w.road_id, w.section_id, w.lane_id, w.s) for w in waypoints if not w.next(2.0)]
ended = [not town.get_waypoint_xodr(road, lane, s).next(2.0) for road, lane, s in ends]
print(json.dumps({"waypoints": len(waypoints), "dead": dead, "ended": ended}))
"""


@pytest.mark.skipif(importlib.util.find_spec("carla") is None, reason="needs the CARLA client")
def test_carla_loads_the_map_without_dead_ends(map_: Map, tmp_path: Path) -> None:
    """CARLA's own samples stop 1 m or more before the acceleration lane's end, so its end is checked separately.

    The crossing's arms lead back to it, which the client can follow only after `map export --for carla`.
    """
    file = map_.file
    if map_.name == "signal_crossing":
        file = tmp_path / "exported.xodr"
        document = read_document(map_.file, Diagnostics())
        assert document is not None
        file.write_bytes(export_for_carla(document, load_network(map_.file)))
    ends = [
        (int(road), lane, map_.roads[road].sections[section].end - 0.5)
        for name, road, section, lane in LANES_THAT_END
        if name == map_.name
    ]
    done = subprocess.run(
        [sys.executable, "-c", CARLA_PROBE, str(file), json.dumps(ends)],
        check=True,
        capture_output=True,
        text=True,
        timeout=60,
    )
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["waypoints"] > 1000
    known = {(int(road), section, lane) for name, road, section, lane in LANES_THAT_END if name == map_.name}
    assert {tuple(place[:3]) for place in found["dead"]} <= known
    assert all(found["ended"])


def test_the_pictures_of_the_documentation_show_own_maps(repository: Path) -> None:
    own = tuple(f"map_{path.name.partition('_')[0]}" for path in (repository / "maps").iterdir() if path.is_dir())
    pictures = [path.name for path in (repository / "docs" / "images").glob("map_*")]
    assert pictures
    assert [name for name in pictures if not name.startswith(own)] == []
