"""`calibrate` measures on maps, and writes a page with the results."""

from __future__ import annotations

import hashlib
import json
import math
import sys
from dataclasses import replace
from importlib import resources
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.cli import main
from scenario_compiler.perception.calibration.collect import CONDITIONS, Looks
from scenario_compiler.perception.calibration.cross_fit import parts_of
from scenario_compiler.perception.calibration.figures import Asked, Figures, fitted, judged, worth
from scenario_compiler.perception.calibration.gather import Gathered, gather_maps, seed_of
from scenario_compiler.perception.calibration.maps import IMAGES, MapRoads
from scenario_compiler.perception.calibration.truth import Truth
from scenario_compiler.perception.confidence import FEATURES, Confidence, Tree, confidence_text
from scenario_compiler.perception.detectors import DetectorName, detector_class
from scenario_compiler.perception.lane_detector import Boundary
from scenario_compiler.report.perception_page import INTRODUCTIONS, LIMITS, PAGES, Measured, write_perception_page
from scenario_compiler.resources import find_map
from scenario_compiler.roads import load_network


def test_a_clip_depends_only_on_its_number() -> None:
    roads = MapRoads(load_network(find_map("town_grid")))
    first = {number: [view.image for view in views] for number, _, views in roads.clips(1, range(2), per_scene=2)}
    again = {number: [view.image for view in views] for number, _, views in roads.clips(1, range(2), per_scene=2)}
    assert first.keys() == again.keys()
    for number, images in first.items():
        assert len(images) == IMAGES
        assert all(np.array_equal(a, b) for a, b in zip(images, again[number], strict=True))


def test_the_truth_of_a_clip_is_a_lane() -> None:
    roads = MapRoads(load_network(find_map("highway_loop")))
    for _, conditions, views in roads.clips(2, range(3)):
        for view in views:
            left, right = (view.truth.y(side, 6.0) for side in (0, 1))
            assert conditions.curvature < 0.05
            assert 2.5 < left - right < 4.5
            assert left > 0.5
            assert right < -0.5


def test_a_clip_knows_how_far_the_next_junction_is() -> None:
    clips = MapRoads(load_network(find_map("town_grid"))).clips(1, range(12, 18))
    ahead = {number: [view.junction for view in views] for number, _, views in clips}
    assert ahead[13] == [0.0] * IMAGES  # in a junction
    assert ahead[12] == [math.inf] * IMAGES
    assert all(0.5 < before - after < 1.2 for before, after in pairwise(ahead[16]))


def test_an_error_is_a_distance_from_the_true_boundary() -> None:
    ahead = np.linspace(-20.0, 40.0, 61)
    slanting, turning = np.stack([ahead, ahead], axis=1), np.stack([np.minimum(ahead, 10.0), ahead], axis=1)
    truth = Truth((slanting, slanting - [0.0, 3.5]), (1.0, 1.0))
    beside = Boundary(0.3, 1.0, 0.0, 0.9, 0.9, 0.9, (5.0, 25.0))
    assert truth.error(0, beside) == pytest.approx(0.3 / math.sqrt(2.0))
    assert truth.error(1, beside) == pytest.approx(3.8 / math.sqrt(2.0))
    assert truth.y(0, 6.5) == pytest.approx(6.5)
    assert math.isinf(Truth((turning, turning), (1.0, 1.0)).y(0, 12.0))


@pytest.mark.parametrize("radius", [16.0, -16.0])
def test_a_boundary_is_judged_as_far_as_18_m_ahead_along_the_lane(radius: float) -> None:
    angles = np.arange(-4.0, 30.0, 0.5) / abs(radius)
    arcs = [(abs(radius) - t) * np.sin(angles) for t in (1.75, -1.75)]
    side = math.copysign(1.0, radius)
    left, right = (np.stack([x, radius - side * (abs(radius) - t) * np.cos(angles)], axis=1)
                   for x, t in zip(arcs, (1.75, -1.75), strict=True))  # fmt: skip
    judged = (angles * abs(radius) > 5.5) & (angles * abs(radius) < 18.5)
    x, y = left[judged].T
    half, slope, y0 = np.polyfit(x, y, 2, w=np.cos(angles[judged])).tolist()
    truth, straight = Truth((left, right), (1.0, 1.0)), Boundary(1.75, 0.0, 0.0, 0.9, 0.9, 0.9, (5.0, 25.0))
    assert x.max() < 17.0
    assert truth.error(0, replace(straight, y0=y0, slope=slope, curvature=2.0 * half)) < 0.25
    assert truth.error(0, straight) > 4.0


def test_a_boundary_that_leaves_the_planned_route_counts_as_the_automation_takes_it() -> None:
    on_route = looks_of([0.9, 0.9], [0.1, 3.0])
    leaving = replace(on_route, worth=np.array([1.0, 0.0]))
    constant = Confidence.of([1.0, 1.0, 1.0], [Tree([-1], [], [[0.0, 0.0, 0.0]])])
    geometry, paint, both = judged(leaving, constant).p.T
    assert geometry.tolist() == both.tolist() == [paint[0], 0.0]
    assert paint[0] == paint[1] > 0.5


def test_a_fit_uses_the_clips_that_are_for_fits_alone() -> None:
    draw = np.random.default_rng(1)
    few = replace(looks_of([0.5] * 40, draw.random(40).tolist()), rows=draw.normal(size=(40, len(FEATURES))))
    more = Looks.joined([few, replace(few, error=1.0 - few.error, clip=few.clip + 40)])
    fits = [fitted(Gathered({"made up": looks}, (), few, 40)) for looks in (few, more)]
    assert confidence_text(fits[0], FEATURES) == confidence_text(fits[1], FEATURES)


def test_a_copy_of_a_map_is_in_its_part_and_a_map_that_is_left_out_alone() -> None:
    names = ["a", "b", "c", "d", "e", "f", "repainted_a", "repainted_e"]
    parts = [sorted(part) for part in parts_of(names, ["a", "c"])]
    assert parts == [["a", "repainted_a"], ["c"], ["b"], ["d"], ["e", "repainted_e"], ["f"]]
    assert parts_of(names, ["repainted_a", "c"]) == parts_of(names, ["a", "c"])
    assert parts_of(["a"], ["a"]) == [{"a"}]


def test_clips_are_seen_with_the_confidence_for_their_map() -> None:
    constant = Confidence.of([1.0, 1.0, 1.0], [Tree([-1], [], [[0.0, 0.0, 0.0]])])
    maps = [find_map("highway_loop"), find_map("motorway")]
    seen = gather_maps("classical", maps, 1, 1, {"motorway": constant})
    assert set(seen["motorway"].p[:, 1]) == {1.0 / (1.0 + math.exp(-1.0))}
    assert len(set(seen["highway_loop"].p[:, 1])) > 6


def test_the_clips_of_two_maps_share_neither_weather_nor_noise() -> None:
    """One road under two names: were their clips alike, a fit to many maps would learn a few conditions by heart."""
    roads = MapRoads(load_network(find_map("highway_loop")))
    drawn = [[conditions for _, conditions, _ in roads.clips(seed_of(name), range(12))] for name in ("one", "other")]
    noise = [{conditions.sigma for conditions in of_map if conditions.sigma > 0.0} for of_map in drawn]
    assert all(noise)
    assert not noise[0] & noise[1]


def test_a_map_without_a_lane_to_drive_on_has_no_clips() -> None:
    assert list(MapRoads(load_network(find_map("open_ground"))).clips(1, range(4))) == []


def looks_of(p: list[float], error: list[float]) -> Looks:
    count = len(p)
    said = np.repeat(np.array(p)[:, None], 3, axis=1)
    conditions = np.zeros((count, len(CONDITIONS)))
    ones = np.ones(count)
    return Looks(np.zeros((count, len(FEATURES))), said, np.array(error), ones, ones, np.arange(count), conditions)


def test_confident_and_wrong_boundaries_are_counted() -> None:
    found = worth("made up", looks_of([0.9, 0.9, 0.9, 0.9, 0.1], [0.1, 0.3, 2.0, 0.2, 5.0]))
    assert found.sure == pytest.approx(0.8)
    assert found.wrong == pytest.approx(0.5)
    assert found.far_off == pytest.approx(0.25)
    assert found.outputs[0].area == pytest.approx(0.5 + 0.5 / 3.0)


def test_a_share_has_a_unit_and_a_number_that_does_not_exist_is_a_dash(tmp_path: Path) -> None:
    rain = worth("rain", looks_of([0.05, 0.06], [1.0, 2.0]))
    sun = worth("sun", looks_of([0.9, 0.1], [0.1, 1.0]))
    figures = Figures((sun,), (sun,), (rain,), (Asked("straight", 0.5, 0.25, 0.125),), ())
    measured = Measured("classical", "calibrate", 1.0, 2, "one clip of a made-up map", pictures=1)
    write_perception_page(figures, measured, tmp_path)
    lines = (tmp_path / "perception.md").read_text(encoding="utf-8").splitlines()
    assert [line for line in lines if line.startswith("| rain")] == [
        "| rain | 2 | – | 0.003 | 0.055 | 0.000 | 0.000 | – | 0.055 | – | 0.945 | 0 % | – | – |"
    ]
    assert [line.split(" | ")[-3:] for line in lines if line.startswith("| sun")] == [["50 %", "0.0 %", "0.0 % |"]] * 2
    assert "| straight | 50 % | 0.25 | 12 % |" in lines
    assert any("at most 4 % wrong and 0.5 % by over 1 m" in line for line in lines)


def test_a_file_that_is_not_a_map_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "no.xodr").write_text("<OpenDRIVE", encoding="utf-8")
    arguments = [str(tmp_path / "no.xodr"), "-o", str(tmp_path / "out"), "--clips", "1", "--pictures", "1"]
    assert main(["calibrate", *arguments, "--workers", "1"]) == 1
    assert "no.xodr:1:11: error[SC102]: not well-formed XML" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_fit_without_xgboost_names_the_extra_that_installs_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xgboost", None)
    assert main(["calibrate", "-o", str(tmp_path / "out"), "--fit"]) == 2
    assert "this needs xgboost: pip install 'scenario-compiler[fit]'" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.slow
def test_the_page_of_a_map(tmp_path: Path) -> None:
    road = find_map("highway_loop")
    other = find_map("town_grid")
    arguments = ["calibrate", str(road), str(other), "-o", str(tmp_path), "--clips", "30", "--pictures", "2"]
    assert main([*arguments, "--fit", "--leave-out", "highway_loop", "--workers", "2"]) == 0
    page = (tmp_path / "perception.md").read_text(encoding="utf-8")
    assert "The tables show highway_loop: each judged by a fit to all other maps." in page
    assert (tmp_path / "images" / "perception_reliability.png").stat().st_size > 10_000
    assert json.loads((tmp_path / "lane_confidence.json").read_text("utf-8"))["features"] == list(FEATURES)


@pytest.mark.parametrize(
    ("detector", "digest"),
    [
        ("classical", "58db07c3965fe35860762c664fbf9cbd7a3851c6eee2895e2d5f6d5d8f967e86"),
        ("learned", "2e1d48f5537ae1eb54d15d1275d372cdcfc9cb413538396ff28ff9c6d9f0beb5"),
    ],
)
def test_the_pages_are_about_the_packaged_confidence(detector: DetectorName, digest: str) -> None:
    """Whoever changes a confidence or what is written about it measures and writes its page again."""
    page = (Path(__file__).parents[1] / "docs" / PAGES[detector]).read_text(encoding="utf-8")
    assert page.startswith(INTRODUCTIONS[detector])
    assert page.endswith(LIMITS)
    file = resources.files("scenario_compiler.perception").joinpath(detector_class(detector).confidence_file)
    assert hashlib.sha256(file.read_bytes()).hexdigest() == digest


def test_wrong_use_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["calibrate", str(tmp_path / "nowhere"), "-o", str(tmp_path / "out")]) == 2
    assert "nowhere" in capsys.readouterr().err
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").touch()
    assert main(["calibrate", "-o", str(tmp_path / "full")]) == 2
    out = ["-o", str(tmp_path / "out")]
    (tmp_path / "nothing").mkdir()
    assert main(["calibrate", str(tmp_path / "nothing"), *out]) == 2
    assert "there is no road file (.xodr) in" in capsys.readouterr().err
    town = str(find_map("town_grid"))
    assert main(["calibrate", town, *out, "--leave-out", "town_gird"]) == 2
    assert "--leave-out town_gird: there is no such map; did you mean 'town_grid'?" in capsys.readouterr().err
    assert main(["calibrate", town, *out, "--leave-out", "town_grid"]) == 2
    assert "there is no other map to which the confidence could be fitted" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
