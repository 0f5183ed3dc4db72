"""Poses, locations and topology against what CARLA's own map library and esmini answered."""

from __future__ import annotations

import csv
import gzip
import math
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from scenario_compiler.roads import Network, load_network

MAPS = "Scenic/assets/maps/CARLA"
TOWNS = ("Town01", "Town04")


@pytest.fixture(scope="module", params=TOWNS)
def town(request: pytest.FixtureRequest, corpus: Path) -> Network:
    return load_network(corpus / MAPS / f"{request.param}.xodr", cache=False)


def rows(path: Path) -> Iterator[dict[str, str]]:
    with gzip.open(path, "rt", encoding="utf-8") as file:
        yield from csv.DictReader(file)


def degrees_apart(a: float, b: float) -> float:
    return abs((a - b + 180.0) % 360.0 - 180.0)


def test_poses_equal_carla(town: Network, golden: Path) -> None:
    for row in rows(golden / "carla" / f"{town.name}_xodr.csv.gz"):
        lane = int(row["lane_id"])
        pose = town.lane_pose(row["road_id"], lane, float(row["s"]))
        assert math.hypot(pose.x - float(row["x"]), pose.y + float(row["y"])) < 1e-3
        assert abs(pose.z - float(row["z"])) < 1e-3
        yaw = -math.degrees(pose.heading) + (180.0 if lane > 0 else 0.0)
        assert degrees_apart(yaw, float(row["yaw"])) < 0.01
        assert town.lane_width(row["road_id"], lane, float(row["s"])) == pytest.approx(
            float(row["lane_width"]), abs=1e-4
        )


def test_locate_contains_carlas_answer(town: Network, golden: Path) -> None:
    """CARLA searches straight chords, so its s may be decimetres off; ours is never further from the point."""
    inside = found = 0
    for row in rows(golden / "carla" / f"{town.name}_waypoints.csv.gz"):
        if not row["inside_driving"]:
            continue
        inside += 1
        x, y = float(row["qx"]), -float(row["qy"])
        lane = int(row["inside_driving"])
        same = [p for p in town.locate(x, y) if (p.road, p.lane) == (row["road_id"], lane)]
        if not same:
            continue
        found += 1
        theirs = town.lane_pose(row["road_id"], lane, float(row["s"]))
        assert math.hypot(theirs.x - float(row["x"]), theirs.y + float(row["y"])) < 0.05
        ours = town.lane_pose(same[0].road, same[0].lane, same[0].s)
        carla_gap = math.hypot(x - float(row["x"]), y + float(row["y"]))
        assert math.hypot(x - ours.x, y - ours.y) < carla_gap + 0.05
    assert inside > 500
    assert found >= 0.99 * inside


def test_topology_equals_carla(town: Network, golden: Path) -> None:
    theirs = Counter(
        (r["road_a"], r["lane_a"], round(float(r["s_a"]), 2), r["road_b"], r["lane_b"], round(float(r["s_b"]), 2))
        for r in rows(golden / "carla" / f"{town.name}_topology.csv.gz")
    )
    ours = Counter((a.road, str(a.lane), round(a.s, 2), b.road, str(b.lane), round(b.s, 2)) for a, b in town.topology())
    assert ours == theirs


@pytest.mark.parametrize(
    ("recorded", "road_file"),
    [
        ("ut__two_pitched_and_rolled_roads", "two_pitched_and_rolled_roads"),
        ("ut__positioning_slope_up_leaning_right", "slope_up_leaning_right"),
        ("ut__pitch_by_super_elevation", "pitch_by_super_elevation"),
    ],
)
def test_lane_positions_on_rolled_slopes_equal_esmini(
    corpus: Path, golden: Path, recorded: str, road_file: str
) -> None:
    files = list((corpus / "esmini").rglob(f"{road_file}.xodr"))
    if not files:
        pytest.skip(f"the corpus has no {road_file}.xodr")
    network = load_network(files[0], cache=False)
    for row in rows(golden / "esmini" / f"{recorded}.csv.gz"):
        pose = network.lane_pose(row["road"], int(row["lane"]), float(row["s"]), float(row["off"]))
        assert math.hypot(pose.x - float(row["x"]), pose.y - float(row["y"])) < 3e-3
