"""Drives lane detection over given maps at a clear noon, and counts takeover requests without a reason.

    python tests/benchmarks/clear_kilometre.py [--metres 1000] [--jobs 2] [--detector learned] MAP...

For each map: how many km of its lanes are painted on both sides, how far was driven on such, and the requests there,
outside junctions (with none within 25 m ahead) and near them. Bends are driven at their own speed, and a drive begins
at the speed that the bends behind its start allow.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import tempfile
from pathlib import Path
from typing import NamedTuple

import cv2

from scenario_compiler import compile_scenario, load_network, open_world, run
from scenario_compiler.perception.detectors import DETECTORS, DetectorName
from scenario_compiler.roads import LanePosition, Network
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_curvature, lane_row, lane_width
from scenario_compiler.vocabulary.lane_keeping import LANE_KEEPING

STEP, AHEAD, LONGEST, SPEED = 5.0, 25, 300.0, 13.9
"""Distance between places that are looked at, how far ahead of a request paint has to be, the longest drive, m, and the
speed where no bend is, m/s."""

LATERAL, BRAKING = LANE_KEEPING["lateral_acceleration"], LANE_KEEPING["following_deceleration"]
"""Lateral acceleration in bends and comfortable braking before them, m/s2."""

NEAR = 60
"""Distance behind a start within which bends limit the speed there, m: braking from `SPEED` takes 48 m."""

EVERY = 15
"""Steps after which it is looked again whether the way is clear."""

SCENARIO = """<scenarios version="1"><scenario name="clear" map="{map}" weather="ClearNoon" duration="{duration}"
  summary="A clear drive" step="0.0333333333" control_every="2">
  <ego speed="{begin}"><start><lane road="{road}" lane="{lane}" s="{s}"/></start>
    <controller model="lane_detection"><detector model="{detector}"/></controller></ego>
  <takeover budget="7"><cause kind="lane_confidence"/><driver takeover_time="30"/></takeover>
</scenario></scenarios>"""


class Driven(NamedTuple):
    """What was found on one map: km painted, m driven, requests outside junctions and near them, and their places."""

    painted: float
    metres: float
    outside: int
    near: int
    places: list[str]


def painted(network: Network, place: LanePosition) -> bool:
    """Return whether a lane has a mark on both borders here."""
    marks = network.marks(place.road, place.lane, place.s)
    return all(mark is not None and mark.type != "none" and mark.quality > 0.15 for mark in marks)


def stretches(network: Network) -> tuple[float, list[LanePosition]]:
    """Return the m of lanes that are painted on both sides, and places at which such begin, in order of travel."""
    n, metres, starts = network.tables, 0.0, []
    for row, lane in enumerate(n.lane_id):
        section = n.lane_section[row]
        if lane == 0 or not is_drivable(n.lane_type[row]) or n.road_junction[n.section_road[section]] >= 0:
            continue
        road = n.section_road[section]
        low, high = n.section_s[section], n.section_end[section]
        count = max(math.ceil((high - low) / STEP), 1)
        places = [
            LanePosition(network.road_ids[road], lane, low + (k + 0.5) * (high - low) / count) for k in range(count)
        ]
        if n.lane_sense[row] < 0:
            places.reverse()
        good = [painted(network, one) and lane_width(n, road, lane, one.s) > 2.5 for one in places]
        metres += sum(good) * (high - low) / count
        if good[0] and high - low > 30.0:
            starts.append(places[0])
    return metres, starts


def allowed(network: Network, start: LanePosition) -> float:
    """Return the greatest speed, m/s, from which comfortable braking suffices for the bends behind a start."""
    n, at, square = network.tables, start, SPEED * SPEED
    for k in range(NEAR):
        road = network.road_index(at.road)
        bend = abs(lane_curvature(n, road, at.lane, lane_row(n, road, at.lane, at.s), at.s))
        square = min(square, LATERAL / max(bend, 1e-4) + 2.0 * BRAKING * k)
        following = network.next(at, 1.0)
        if following is None:
            break
        at = following
    return math.sqrt(square)


def counts(network: Network, place: LanePosition) -> tuple[bool, bool]:
    """Return whether the lane is painted on both sides for 25 m from a place on, and whether a junction is there."""
    n, clear, near = network.tables, True, False
    at: LanePosition | None = place
    for _ in range(AHEAD + 1):
        if at is None:
            return False, near
        clear = clear and painted(network, at)
        near = near or n.road_junction[network.road_index(at.road)] >= 0
        at = network.next(at, 1.0)
    return clear, near


def drive(path: str, metres: float, detector: DetectorName) -> Driven:
    """Drive on a map."""
    cv2.setNumThreads(1)
    network = load_network(path)
    total, starts = stretches(network)
    driven, outside, near, places = 0.0, 0, 0, []
    for start in starts[:: max(len(starts) // 24, 1)]:
        if driven >= metres:
            break
        text = SCENARIO.format(
            map=path, duration=LONGEST / SPEED, begin=allowed(network, start), road=start.road, lane=start.lane,
            s=start.s, detector=detector,
        )  # fmt: skip
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "clear.xml"
            file.write_text(text, encoding="utf-8")
            plan = compile_scenario(file)
        with open_world("kinematic", plan, network) as world:
            recording = run(plan, world, seed=1)
        requests = [one.t for one in recording.events if one.kind == "request"]
        last = requests[0] if requests else recording.t[-1]
        x, y, road, lane, along = (getattr(recording, one)[:, 0] for one in ("x", "y", "road", "lane", "s"))
        clear = junction = False
        for k in range(1, len(recording.t)):
            if recording.t[k] > last:
                break
            if road[k] >= 0:
                place = LanePosition(recording.roads[road[k]], int(lane[k]), float(along[k]))
                if k % EVERY == 1:
                    clear, junction = counts(network, place)
                driven += 0.0 if junction or not clear else math.hypot(x[k] - x[k - 1], y[k] - y[k - 1])
        if requests:
            k = min(int(requests[0] / plan.step), len(recording.t) - 1)
            if road[k] >= 0:
                place = LanePosition(recording.roads[road[k]], int(lane[k]), float(along[k]))
                clear, junction = counts(network, place)
                if clear:
                    outside, near = outside + (not junction), near + junction
                    places.append(f"{place.road}/{place.lane}/{place.s:.0f} at {requests[0]:.1f} s")
    return Driven(total / 1000.0, driven, outside, near, places)


def _drive(job: tuple[str, float, DetectorName]) -> tuple[str, Driven]:
    return job[0], drive(*job)


def main() -> None:
    """Print a row for each map."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--metres", type=float, default=1000.0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--detector", choices=list(DETECTORS), default="classical")
    parser.add_argument("maps", nargs="+")
    options = parser.parse_args()
    jobs = [(str(Path(one).resolve()), options.metres, options.detector) for one in options.maps]
    with multiprocessing.get_context("spawn").Pool(options.jobs) as pool:
        print("| map | painted on both sides, km | driven there, m | requests outside junctions | near them |")
        print("|---|---:|---:|---:|---:|")
        for path, found in pool.imap_unordered(_drive, jobs):
            row = (Path(path).stem, f"{found.painted:.1f}", f"{found.metres:.0f}", str(found.outside), str(found.near))
            print("| " + " | ".join(row) + " |", *found.places, flush=True)


if __name__ == "__main__":
    main()
