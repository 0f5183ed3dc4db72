"""Roads that the learned detector may learn on: valid files, and on some of them every line that OpenDRIVE has."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from lxml import etree

from scenario_compiler import find_map, load_network
from scenario_compiler.perception.calibration.maps import LORRIES_AHEAD, MapRoads
from scenario_compiler.validation import validate_files

TOOLS = Path(__file__).parents[2] / "tools"


def tool(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, TOOLS / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def roads() -> ModuleType:
    return tool("training_roads")


def kinds_of(file: Path) -> set[int]:
    tables = load_network(file).tables
    return set(tables.mark_type)


@pytest.mark.parametrize("kind", ["COUNTRY", "TOWN", "WIDE", "AVENUE"])
def test_made_up_roads_are_valid_and_can_be_driven(kind: str, roads: ModuleType, tmp_path: Path) -> None:
    for seed in range(2):
        file = tmp_path / f"made{seed}.xodr"
        roads.made_up(file, seed, getattr(roads, kind))
        assert [one for found in validate_files([file]) for one in found] == []
        clips = MapRoads(load_network(file), texture=100 + seed).clips(1, range(8))
        seen = [next(views).truth for _, _, views in clips]
        assert len(seen) >= 4
        assert all(np.isfinite(truth.y(0, 6.0)) for truth in seen)


def test_near_crossings_some_lines_end_and_others_go_on(roads: ModuleType, tmp_path: Path) -> None:
    crossings, painted = tool("training_crossings").crossings, []
    for seed in range(4):
        file = tmp_path / f"crossings{seed}.xodr"
        crossings(file, seed)
        roads.repainted(file, file, seed)
        assert [one for found in validate_files([file]) for one in found] == []
        views = [next(views) for _, _, views in MapRoads(load_network(file)).clips(1, range(16))]
        painted += [share for view in views if 0.0 < view.junction < 18.0 for share in view.truth.painted]
    assert any(0.0 < share < 0.6 for share in painted)
    assert any(share == 1.0 for share in painted)


def test_where_a_ramp_meets_a_motorway_its_lines_go_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(TOOLS)
    motorway, painted = tool("training_motorways").motorway, []
    for seed in range(4):
        file = tmp_path / f"motorway{seed}.xodr"
        motorway(file, seed)
        assert [one for found in validate_files([file]) for one in found] == []
        network = load_network(file)
        assert network.tables.road_junction.count(-1) == len(network.road_ids) - 12
        views = [next(views) for _, _, views in MapRoads(network).clips(1, range(16))]
        painted += [share for view in views if 0.0 < view.junction < 18.0 for share in view.truth.painted]
    assert np.mean([share == 1.0 for share in painted]) > 0.5


def test_lorries_are_close_ahead_in_the_clips_that_ask_for_them() -> None:
    network = load_network(find_map("highway_loop"))
    with_lorries = [conditions for _, conditions, _ in MapRoads(network, lorries=1.0).clips(1, range(8))]
    usual = [conditions for _, conditions, _ in MapRoads(network).clips(1, range(8))]
    assert all(LORRIES_AHEAD[0] <= one.leader <= LORRIES_AHEAD[1] for one in with_lorries)
    assert any(np.isinf(one.leader) for one in usual)


def test_the_same_seed_makes_the_same_file_and_another_does_not(roads: ModuleType, tmp_path: Path) -> None:
    files = [tmp_path / name for name in ("a.xodr", "b.xodr", "c.xodr")]
    for file, seed in zip(files, (5, 5, 6), strict=True):
        roads.made_up(file, seed)
    first, second, third = (load_network(file).tables for file in files)
    assert first.lane_type == second.lane_type
    assert list(first.mark_width) == list(second.mark_width)
    assert list(first.mark_width) != list(third.mark_width)


def test_streets_bend_more_sharply_than_country_roads(roads: ModuleType, tmp_path: Path) -> None:
    bends = {}
    for kind in ("COUNTRY", "TOWN"):
        roads.made_up(tmp_path / f"{kind}.xodr", 3, getattr(roads, kind))
        clips = MapRoads(load_network(tmp_path / f"{kind}.xodr")).clips(1, range(40))
        bends[kind] = float(np.median([conditions.curvature for _, conditions, _ in clips]))
    assert bends["TOWN"] > 1 / 40
    assert bends["TOWN"] > 3.0 * bends["COUNTRY"]


def test_wide_streets_have_wider_lanes_than_other_streets(roads: ModuleType, tmp_path: Path) -> None:
    for kind in (roads.TOWN, roads.WIDE):
        roads.made_up(tmp_path / "street.xodr", 3, kind)
        tree = etree.parse(str(tmp_path / "street.xodr"))
        widths = [float(one.attrib["a"]) for one in tree.iterfind(".//lane[@type='driving']/width")]
        assert kind.width[0] - 0.2 <= min(widths) <= max(widths) <= kind.width[1] + 0.2
    assert roads.WIDE.width[0] >= roads.TOWN.width[1]


def test_most_avenues_are_level_and_their_bends_are_of_medium_radius(roads: ModuleType, tmp_path: Path) -> None:
    hilly = []
    for seed in range(8):
        file = tmp_path / f"avenue{seed}.xodr"
        roads.made_up(file, seed, roads.AVENUE)
        tree = etree.parse(str(file))
        radii = [1.0 / abs(float(arc.attrib["curvature"])) for arc in tree.iter("arc")]
        assert radii
        assert roads.AVENUE.radius[0] <= min(radii) <= max(radii) <= roads.AVENUE.radius[1]
        hilly += [any(float(one.attrib["d"]) for one in road.iter("elevation")) for road in tree.iter("road")]
    assert 0 < sum(hilly) < 0.25 * len(hilly)


def test_a_repainted_map_keeps_its_lanes(roads: ModuleType, tmp_path: Path) -> None:
    source = Path(find_map("town_grid"))
    before = load_network(source).tables
    painted = set()
    for seed in range(4):
        file = tmp_path / f"anew{seed}.xodr"
        roads.repainted(source, file, seed)
        after = load_network(file).tables
        assert list(after.lane_id) == list(before.lane_id)
        assert list(after.road_length) == list(before.road_length)
        painted |= kinds_of(file)
    assert len(painted) > len(kinds_of(source)) + 2
