"""Loading and locating against CARLA's C++ map library, CPU time, in one run, and the cost on larger networks."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.roads import load_network
from scenario_compiler.roads.geometry import road_pose
from tests.roads.make import road

TOWN04 = "Scenic/assets/maps/CARLA/Town04.xodr"
REPEATS = 7

pytestmark = pytest.mark.slow


def cpu(work: Callable[[], object]) -> float:
    started = time.process_time()
    work()
    return time.process_time() - started


def test_loading_takes_at_most_five_times_carlas_time(
    corpus: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    carla = pytest.importorskip("carla")
    monkeypatch.setenv("SCENARIO_COMPILER_CACHE", str(tmp_path))
    text = (corpus / TOWN04).read_text(encoding="utf-8")
    load_network(corpus / TOWN04)
    rounds = [
        (
            cpu(lambda: load_network(corpus / TOWN04, cache=False)),
            cpu(lambda: load_network(corpus / TOWN04)),
            cpu(lambda: carla.Map("Town04", text)),
        )
        for _ in range(REPEATS)
    ]
    ours, cached, theirs = (float(np.median(column)) for column in zip(*rounds, strict=True))
    sys.stdout.write(
        f"Town04: {ours:.3f} s, cached {cached:.4f} s, carla.Map {theirs:.3f} s, ratio {ours / theirs:.2f}" + "\n"
    )
    assert ours <= 5.0 * theirs
    assert cached <= 0.05


def test_batch_location_is_five_times_as_fast_as_carla(corpus: Path) -> None:
    """Points beside the reference lines, where several roads are candidates: the costly case for both."""
    carla = pytest.importorskip("carla")
    made = load_network(corpus / TOWN04, cache=False)
    n, draw = made.tables, np.random.default_rng(2)
    roads = draw.integers(len(n.road_length), size=100_000)
    places = [
        road_pose(n, int(i), share * n.road_length[i], t)
        for i, share, t in zip(roads, draw.random(len(roads)), draw.uniform(-8.0, 8.0, len(roads)), strict=True)
    ]
    xs, ys = np.array([p[0] for p in places]), np.array([p[1] for p in places])
    theirs_map = carla.Map("Town04", (corpus / TOWN04).read_text(encoding="utf-8"))
    locations = [carla.Location(float(x), -float(y), 0.0) for x, y in zip(xs[:3000], ys[:3000], strict=True)]
    made.locate_many(xs[:10], ys[:10])
    ratios = []
    for _ in range(REPEATS):
        ours = cpu(lambda: made.locate_many(xs, ys)) / len(xs)
        theirs = cpu(lambda: [theirs_map.get_waypoint(at) for at in locations]) / len(locations)
        ratios.append(theirs / ours)
    sys.stdout.write(f"batch location: {float(np.median(ratios)):.1f} times carla.Map.get_waypoint's rate" + "\n")
    assert float(np.median(ratios)) >= 5.0


def test_cost_grows_with_points_and_not_with_the_map(tmp_path: Path) -> None:
    """From 250 km to 1 000 km: loading is linear (within a factor of 2), a batch query costs the same (within 3)."""
    loads, queries = [], []
    for roads in (1000, 4000):
        rows = []
        for i in range(roads):
            x, y = 300 * (i % 40), 40 * (i // 40)
            plan = f'<geometry s="0" x="{x}" y="{y}" hdg="0" length="250"><line/></geometry>'
            rows.append(road(str(i), length=250.0, plan=plan))
        path = tmp_path / f"{roads}.xodr"
        path.write_text("<OpenDRIVE><header/>" + "".join(rows) + "</OpenDRIVE>", encoding="utf-8")
        loads.append(cpu(lambda path=path: load_network(path, cache=False)) / roads)
        made = load_network(path, cache=False)
        k = np.random.default_rng(1).integers(roads, size=20_000)
        xs, ys = 300.0 * (k % 40) + 20.0, 40.0 * (k // 40) + 1.0
        made.locate_many(xs[:10], ys[:10])
        queries.append(min(cpu(lambda made=made, xs=xs, ys=ys: made.locate_many(xs, ys)) for _ in range(3)))
    assert loads[1] <= 2.0 * loads[0]
    assert queries[1] <= 3.0 * queries[0]
