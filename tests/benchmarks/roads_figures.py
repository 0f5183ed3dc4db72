"""Prints a table of the speed of reading roads and locating points: `python tests/benchmarks/roads_figures.py`.

Every figure is the median of several rounds, in CPU time (user and system); ours and `carla.Map`'s are measured in the
same round where the client is installed. Town04 is taken from the corpus (SCENARIO_COMPILER_CORPUS); the large networks
are generated: straight roads of 250 m side by side.
"""

from __future__ import annotations

import argparse
import importlib
import os
import statistics
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.geometry import road_pose

TOWN04 = "Scenic/assets/maps/CARLA/Town04.xodr"
POINTS, POINTS_OF_CARLA = 100_000, 3_000
SMALL, LARGE = 1_000, 4_000
"""Roads of the generated networks, 250 m each: 250 km and 1 000 km."""

ROAD = (
    '<road id="{i}" length="250" junction="-1"><planView><geometry s="0" x="{x}" y="{y}" hdg="0" length="250"><line/>'
    '</geometry></planView><lanes><laneSection s="0"><left>{left}</left><center><lane id="0" type="none"/></center>'
    "<right>{right}</right></laneSection></lanes></road>"
)
REPEATS = 3
"""Measurements of each generated network."""

LANE = '<lane id="{}" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>'


@dataclass(frozen=True)
class Loading:
    """CPU seconds to load Town04 from its file, from the cache, and as a `carla.Map` (None without the client)."""

    file: float
    cached: float
    carla: float | None


@dataclass(frozen=True)
class Locating:
    """Points located in a CPU second: by `locate_many`, and by `carla.Map.get_waypoint` (None without the client)."""

    ours: float
    carla: float | None


@dataclass(frozen=True)
class Growth:
    """A generated network: CPU seconds to load it, and to locate 20 000 points on it."""

    roads: int
    load: float
    query: float


def cpu(work: Callable[[], object]) -> float:
    """Return the CPU time that some work in this process takes, s."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def carla_client() -> Any | None:
    """Return the module of CARLA's client, None if it is not installed."""
    try:
        return importlib.import_module("carla")
    except ImportError:
        return None


def loading(town: Path, runs: int) -> Loading:
    """Measure how long a town takes to load; the cache folder is that of SCENARIO_COMPILER_CACHE."""
    carla, text = carla_client(), town.read_text(encoding="utf-8")
    load_network(town)
    file, cached, theirs = [], [], []
    for _ in range(runs):
        file.append(cpu(lambda: load_network(town, cache=False)))
        cached.append(cpu(lambda: load_network(town)))
        if carla is not None:
            theirs.append(cpu(lambda: carla.Map(town.stem, text)))
    carlas = statistics.median(theirs) if theirs else None
    return Loading(statistics.median(file), statistics.median(cached), carlas)


def points_beside(network: Network, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return points within 8 m of reference lines, where several roads are candidates: the costly case for both."""
    n, draw = network.tables, np.random.default_rng(2)
    roads = draw.integers(len(n.road_length), size=count)
    places = [
        road_pose(n, int(i), share * n.road_length[i], t)
        for i, share, t in zip(roads, draw.random(count), draw.uniform(-8.0, 8.0, count), strict=True)
    ]
    return np.array([p[0] for p in places]), np.array([p[1] for p in places])


def locating(town: Path, runs: int, points: int = POINTS) -> Locating:
    """Measure how many points are located in a CPU second."""
    network, carla = load_network(town, cache=False), carla_client()
    xs, ys = points_beside(network, points)
    network.locate_many(xs[:10], ys[:10])
    ours, theirs = [], []
    asked: list[Any] = []
    if carla is not None:
        other = carla.Map(town.stem, town.read_text(encoding="utf-8"))
        few = slice(min(POINTS_OF_CARLA, points))
        asked = [carla.Location(float(x), -float(y), 0.0) for x, y in zip(xs[few], ys[few], strict=True)]
    for _ in range(runs):
        ours.append(len(xs) / cpu(lambda: network.locate_many(xs, ys)))
        if asked:
            theirs.append(len(asked) / cpu(lambda: [other.get_waypoint(at) for at in asked]))
    return Locating(statistics.median(ours), statistics.median(theirs) if theirs else None)


def growth(folder: Path, roads: int) -> Growth:
    """Measure a generated network of `roads` roads, 250 m each."""
    left, right = LANE.format(1), LANE.format(-1)
    body = "".join(ROAD.format(i=i, x=300 * (i % 40), y=40 * (i // 40), left=left, right=right) for i in range(roads))
    path = folder / f"{roads}.xodr"
    path.write_text(f"<OpenDRIVE><header/>{body}</OpenDRIVE>", encoding="utf-8")
    load = statistics.median(cpu(lambda: load_network(path, cache=False)) for _ in range(REPEATS))
    network = load_network(path, cache=False)
    k = np.random.default_rng(1).integers(roads, size=20_000)
    xs, ys = 300.0 * (k % 40) + 20.0, 40.0 * (k // 40) + 1.0
    network.locate_many(xs[:10], ys[:10])
    return Growth(roads, load, min(cpu(lambda: network.locate_many(xs, ys)) for _ in range(REPEATS)))


def table(town: Path, folder: Path, runs: int, *, short: bool) -> Table:
    """Measure everything; `short` takes small networks and few points, to show that it runs."""
    load, rate = loading(town, runs), locating(town, runs, 2_000 if short else POINTS)
    small, large = (growth(folder, roads // 20 if short else roads) for roads in (SMALL, LARGE))
    found = Table("figure", "measured", "carla.Map", "ratio", "held to", title=f"CPU time, median of {runs}")

    def line(what: str, ours: str, theirs: str | None, ratio: float | None, held: str) -> None:
        found.add_row(what, ours, theirs or "-", "-" if ratio is None else f"{ratio:.2f}x", held)

    theirs = None if load.carla is None else f"{load.carla:.3f} s"
    line("load Town04", f"{load.file:.3f} s", theirs, load.carla and load.file / load.carla, "at most 2x")
    line(
        "load it from the cache",
        f"{load.cached:.4f} s",
        theirs,
        load.carla and load.cached / load.carla,
        "a fifth of a load",
    )
    points = None if rate.carla is None else f"{rate.carla:,.0f} points/s"
    ratio = rate.carla and rate.ours / rate.carla
    line("locate_many, get_waypoint", f"{rate.ours:,.0f} points/s", points, ratio, "at least 5x")
    km = f"{large.roads // 4:,} km against {small.roads // 4:,} km"
    each = (large.load / large.roads) / (small.load / small.roads)
    line(f"load, {km}", f"{large.load:.2f} s, {small.load:.2f} s", None, each, "a road: at most 2x")
    both = f"{large.query:.3f} s, {small.query:.3f} s"
    line(f"locate 20 000 points, {km}", both, None, large.query / small.query, "at most 3x")
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Print how fast road files are read and points located.")
    parser.add_argument("--runs", type=int, default=7, help="measurements of each figure; the median is printed")
    parser.add_argument("--short", action="store_true", help="only show that everything runs")
    options = parser.parse_args()
    corpus = os.environ.get("SCENARIO_COMPILER_CORPUS")
    if not corpus:
        raise SystemExit("SCENARIO_COMPILER_CORPUS must name the corpus: Town04 is taken from it")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["SCENARIO_COMPILER_CACHE"] = folder
        Console(width=130).print(table(Path(corpus) / TOWN04, Path(folder), options.runs, short=options.short))


if __name__ == "__main__":
    main()
