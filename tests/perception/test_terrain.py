"""Rays meet the ground where it is: on slopes, banked roads, crests and bridges."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler import load_network
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.terrain import Terrain, Window
from scenario_compiler.roads import Network
from scenario_compiler.roads.mesh import road_surface

Floats = NDArray[np.float64]

REACH = 60.0
LANE = '<lane id="{id}" type="{kind}"><width sOffset="0" a="{width}" b="0" c="0" d="0"/></lane>'


def road(number: int, place: str, elevation: str = "", bank: str = "", width: float = 30.0) -> str:
    """Return a straight road of 200 m with a driving lane a side; the shape is easy to say as a plane."""
    left, right = (LANE.format(id=one, kind="driving", width=width) for one in ("1", "-1"))
    return (
        f'<road id="{number}" junction="-1" length="200"><planView><geometry s="0" {place} length="200"><line/>'
        f"</geometry></planView><elevationProfile>{elevation}</elevationProfile><lateralProfile>{bank}</lateralProfile>"
        f'<lanes><laneSection s="0"><left>{left}</left><center><lane id="0" type="none"/></center>'
        f"<right>{right}</right></laneSection></lanes></road>"
    )


def world_of(*roads: str) -> str:
    return '<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="6"/>' + "".join(roads) + "</OpenDRIVE>"


ALONG = 'x="0" y="0" hdg="0"'
SLOPES = [(0.0, 0.0), (0.08, 0.0), (-0.12, 0.0), (0.0, 0.06), (0.0, -0.1), (0.05, 0.05)]
"""Grades along the road and banks across it, rad."""


def tilted(grade: float, bank: float) -> str:
    profile = f'<elevation s="0" a="0" b="{grade!r}" c="0" d="0"/>' if grade else ""
    banked = f'<superelevation s="0" a="{bank!r}" b="0" c="0" d="0"/>' if bank else ""
    return world_of(road(1, ALONG, profile, banked))


def read(folder: Path, text: str) -> tuple[Network, Terrain]:
    path = folder / "ground.xodr"
    path.write_text(text, encoding="utf-8")
    network = load_network(path, cache=False)
    return network, Terrain(road_surface(network))


def rays(count: int, lowest: float, highest: float) -> Floats:
    """Return directions all around, between two elevations, degrees."""
    drawn = np.random.default_rng(7)
    around, up = drawn.uniform(0.0, math.tau, count), np.radians(drawn.uniform(lowest, highest, count))
    return np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up)], axis=1)


def normal_of(network: Network) -> Floats:
    """Return the normal (a, b, 1) of the plane through three points of the road."""
    one, other, third = (np.array(network.lane_pose("1", -1, s, t)[:3]) for s, t in ((50, 0), (150, 0), (50, 15)))
    normal = np.cross(other - one, third - one)
    return np.asarray(normal / normal[2])


@pytest.mark.parametrize(("grade", "bank"), SLOPES)
def test_the_distance_to_a_tilted_plane(tmp_path: Path, grade: float, bank: float) -> None:
    network, terrain = read(tmp_path, tilted(grade, bank))
    middle = network.lane_pose("1", -1, 100.0, 15.0)
    normal = normal_of(network)
    if 0.0 in (grade, bank):
        assert normal == pytest.approx([-grade, -math.tan(bank), 1.0], abs=1e-9)
    origin = np.array([middle.x, middle.y, middle.z + 1.8])
    directions = rays(4000, -40.0, 15.0)
    falls = -(directions @ normal)
    expected = np.where(falls > 0.0, 1.8 / np.where(falls > 0.0, falls, 1.0), np.inf)
    beyond = np.abs(origin[:2] + directions[:, :2] * np.minimum(expected, REACH)[:, None] - (100.0, 0.0)) > (95.0, 29.0)
    on_road = ~beyond.any(axis=1) & (np.abs(expected - REACH) > 0.1)
    found, normals = terrain.window(float(origin[0]), float(origin[1]), REACH).meet(origin, directions, REACH)
    expected[expected > REACH] = np.inf
    met = on_road & np.isfinite(expected)
    assert met.sum() > 1500
    assert (np.isfinite(found) == np.isfinite(expected))[on_road].all()
    assert np.abs(found[met] - expected[met]).max() < 1e-4  # corners are single precision
    assert np.abs(normals[met] - normal / np.linalg.norm(normal)).max() < 1e-5
    assert terrain.level == (grade == bank == 0.0)


def height_along(window: Window, origin: Floats, direction: Floats, t: Floats) -> Floats:
    """Return how far points of a ray are over the ground, found by rays straight down."""
    points = origin + t[:, None] * direction
    over = [window.meet(np.array([x, y, 500.0]), np.array([[0.0, 0.0, -1.0]]), 600.0)[0][0] for x, y, _ in points]
    return np.asarray(points[:, 2] - (500.0 - np.array(over)))


def test_a_crest_hides_the_valley_behind_it(tmp_path: Path) -> None:
    """Up by 10 %, rounded over 40 m, down by 10 %: a ray meets the first ground on its way."""
    hill = (
        '<elevation s="0" a="0" b="0.1" c="0" d="0"/><elevation s="80" a="8" b="0.1" c="-0.0025" d="0"/>'
        '<elevation s="120" a="8" b="-0.1" c="0" d="0"/>'
    )
    network, terrain = read(tmp_path, world_of(road(1, ALONG, hill)))
    at = network.lane_pose("1", -1, 60.0, 15.0)
    window = terrain.window(at.x, at.y, 200.0)
    origin = np.array([at.x, at.y, at.z + 1.8])
    directions = np.array([[math.cos(up), 0.0, math.sin(up)] for up in np.radians(np.linspace(-20.0, 8.0, 57))])
    found, _ = window.meet(origin, directions, 200.0)
    assert np.isfinite(found).sum() > 40
    assert np.isinf(found).sum() > 3
    for direction, distance in zip(directions, found.tolist(), strict=True):
        t = np.linspace(0.5, min(distance, 130.0) - 0.4, 60)
        assert height_along(window, origin, direction, t).min() > -0.03
        if math.isfinite(distance):
            point = origin + distance * direction
            place = network.locate(point[0], point[1])[0]
            surface = network.lane_pose(place.road, place.lane, place.s, place.offset)
            assert point[2] == pytest.approx(surface.z, abs=0.03)  # straight pieces of the rounded crest


def test_a_level_ray_meets_the_hill_before_it(tmp_path: Path) -> None:
    """From 1.8 m above the 60th metre of a grade of 10 %, it is 18 m to the ground."""
    _, terrain = read(tmp_path, world_of(road(1, ALONG, '<elevation s="0" a="0" b="0.1" c="0" d="0"/>')))
    ways = np.array([[1.0, 0.0, 0.0], [1.0, 0.0, -0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    found, _ = terrain.window(60.0, -15.0, REACH).meet(np.array([60.0, -15.0, 7.8]), ways, REACH)
    assert found == pytest.approx([18.0, 18.0, math.inf, math.inf], abs=1e-3)


def test_a_bridge_is_met_from_above_and_from_below(tmp_path: Path) -> None:
    over = '<elevation s="0" a="6" b="0" c="0" d="0"/>'
    crossing = road(2, f'x="100" y="-100" hdg="{math.pi / 2!r}"', over, width=5.0)
    _, terrain = read(tmp_path, world_of(road(1, ALONG, width=5.0), crossing))
    window = terrain.window(100.0, 0.0, REACH)
    up, down = np.array([[0.0, 0.0, 1.0]]), np.array([[0.0, 0.0, -1.0]])
    below, above = np.array([100.0, 0.0, 2.0]), np.array([100.0, 0.0, 8.0])
    assert window.meet(below, up, REACH)[0] == pytest.approx([4.0])
    assert window.meet(below, down, REACH)[0] == pytest.approx([2.0])
    assert window.meet(above, down, REACH)[0] == pytest.approx([2.0])
    aside = np.array([70.0, 0.0, 2.0])
    assert np.isinf(window.meet(aside, up, REACH)[0]).all()


def test_ground_beside_the_road_is_as_high_as_the_road(tmp_path: Path) -> None:
    _, terrain = read(tmp_path, world_of(road(1, ALONG, '<elevation s="0" a="4" b="0" c="0" d="0"/>', width=4.0)))
    window = terrain.window(100.0, 0.0, REACH)
    assert set(window.tags(np.array([[100.0, 2.0], [100.0, 50.0]])).tolist()) == {Tag.ROAD, Tag.TERRAIN}
