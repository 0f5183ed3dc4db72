"""The data of a run in a page: complete, rounded to a known step, and small."""

from __future__ import annotations

import base64
import gzip
import json
import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Floats
from scenario_compiler.report.blocked import blocks_of
from scenario_compiler.report.html import render
from scenario_compiler.report.replay import ENTITY_STEPS, FLATNESS, packed, replay_of, simplified
from scenario_compiler.report.run import Run
from scenario_compiler.roads.network import Network
from tests.recording.made import Row, record
from tests.report import made


def unpacked(text: str) -> Any:
    return json.loads(gzip.decompress(base64.b64decode(text)))


def numbers(differences: list[int | None], step: float) -> Floats:
    """Read a column as the page does."""
    out, total = np.full(len(differences), np.nan), 0
    for at, change in enumerate(differences):
        if change is not None:
            total += change
            out[at] = total * step
    return out


def test_columns_come_back_within_half_a_step(finished: Run) -> None:
    data = unpacked(packed(replay_of(finished, "it", pictured=False)))
    recording = finished.recording
    for name, step in ENTITY_STEPS.items():
        shift = {"x": data["origin"][0], "y": data["origin"][1]}.get(name, 0.0)
        for i, column in enumerate(data["columns"][name]["data"]):
            error = numbers(column, step) + shift - getattr(recording, name)[:, i]
            if name == "h":
                error = np.mod(error + math.pi, 2 * math.pi) - math.pi
            assert np.abs(error).max() <= 0.5 * step + 1e-9, name
    assert np.abs(numbers(data["t"]["data"], data["t"]["step"]) - recording.t).max() < 1e-4


def test_what_is_absent_stays_absent(finished: Run) -> None:
    blocked = replay_of(finished, "it", pictured=False)["columns"]["blocked_distance"]
    shown = numbers(blocked["data"][0], blocked["step"])
    assert np.array_equal(np.isnan(shown), np.isnan(finished.recording.blocked_distance))
    assert np.isnan(shown).any()


def test_equal_runs_are_packed_equally(finished: Run, network: Network) -> None:
    again = made.run(network)
    assert packed(replay_of(finished, "it", pictured=True)) == packed(replay_of(again, "it", pictured=True))


def test_the_blocking_object_is_found_at_its_place(finished: Run) -> None:
    blocks, recording = blocks_of(finished), finished.recording
    marked = np.isfinite(blocks.x)
    assert np.array_equal(marked, np.isfinite(recording.blocked_distance))
    assert set(blocks.by[marked]) == {recording.header.entities.index("parked")}
    rear = finished.plan.entities[1].vehicle.length / 2 - finished.plan.entities[1].vehicle.center
    away = np.hypot(blocks.x - recording.x[:, 1], blocks.y - recording.y[:, 1])[marked]
    assert np.abs(away - rear).max() < 1.0


def test_a_minute_of_twenty_vehicles_is_less_than_a_megabyte_and_a_half(network: Network) -> None:
    """At 0.02 s, the step of `drive`; each vehicle keeps another speed and wanders in its lane."""
    ids = ("ego", *(f"car{k}" for k in range(19)))

    def row(t: float) -> Row:
        poses = [
            network.lane_pose("1", -1 if k % 2 else 1, (31.7 * k + (6 + 0.3 * k) * t) % 390, 0.2 * math.sin(t + k))
            for k in range(20)
        ]
        return {
            "x": [pose.x for pose in poses],
            "y": [pose.y for pose in poses],
            "h": [pose.heading + 0.02 * math.cos(t + k) for k, pose in enumerate(poses)],
            "v": [6 + 0.3 * k + 0.5 * math.sin(0.7 * t + k) for k in range(20)],
            "a": [0.35 * math.cos(0.7 * t + k) for k in range(20)],
            "road": [0] * 20,
            "lane": [-1] * 20,
            "s": [(31.7 * k + 10 * t) % 390 for k in range(20)],
        }

    plan = made.plan()
    entities = tuple(plan.entities[0].model_copy(update={"id": name}) for name in ids)
    plan = plan.model_copy(update={"entities": entities, "step": 0.02})
    recording = record(ids, 3001, row)
    page = render([Run(plan, network, recording, judge(plan, recording))])
    assert len(page.encode()) < 1_500_000


@given(st.lists(st.tuples(st.floats(-500, 500), st.floats(-500, 500)), min_size=2, max_size=40))
def test_a_simplified_line_stays_beside_what_it_was(given_points: list[tuple[float, float]]) -> None:
    line = np.array(given_points)
    kept = simplified(line)
    assert np.array_equal(kept[[0, -1]], line[[0, -1]])
    for point in line:
        assert min(_away(point, a, b) for a, b in pairwise(kept)) <= FLATNESS + 1e-6


def _away(point: Floats, a: Floats, b: Floats) -> float:
    """Return the distance of a point from a stretch of line."""
    along = b - a
    size = float(along @ along)
    share = 0.0 if size == 0.0 else float(np.clip((point - a) @ along / size, 0.0, 1.0))
    return float(np.hypot(*(point - a - share * along)))


def test_the_plotting_library_comes_with_its_licence(repository: Path) -> None:
    vendor = repository / "scenario_compiler" / "report" / "pages" / "vendor"
    assert "MIT" in (vendor / "uPlot.LICENSE").read_text(encoding="utf-8")
    assert "uPlot" in (vendor / "uPlot.iife.min.js").read_text(encoding="utf-8")[:60]
