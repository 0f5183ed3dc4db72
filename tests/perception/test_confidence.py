import json
import math

import numpy as np
import pytest

from scenario_compiler.engine.ego.camera_health import noise_health
from scenario_compiler.perception.calibration.bank import BANK
from scenario_compiler.perception.calibration.collect import look_at_bank
from scenario_compiler.perception.calibration.fit import fit_confidence, largest_by_chance, reliability
from scenario_compiler.perception.calibration.scenes import Fading
from scenario_compiler.perception.confidence import (
    FEATURES,
    NEWEST,
    Confidence,
    Tree,
    confidence_text,
    continued,
    in_order,
    load_confidence,
    longest_gap,
    noise_of,
)
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.degradation import add_noise
from scenario_compiler.perception.lane_detector import ClassicalLaneDetector, LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.route_ahead import WayPoint
from tests.perception.scenery import CLEAR, bend, two_lanes


def situation(name: str) -> int:
    return next(number for number, one in enumerate(BANK) if one.name == name)


def test_the_shipped_confidence_is_for_the_features_there_are() -> None:
    shipped = load_confidence("lane_confidence.json", FEATURES)
    assert shipped.feature.max() < len(FEATURES)
    p = shipped(np.random.default_rng(1).normal(1.0, 1.0, (600, len(FEATURES))))
    assert p.shape == (600, 3)
    assert ((p > 0.0) & (p < 1.0)).all()


def test_a_tree_goes_to_the_second_node_from_its_threshold_on() -> None:
    first = Tree([0, -1, 1, -1, -1], [0.5, 2.0], [[1.0, 0.0, -1.0], [2.0, 0.0, -2.0], [4.0, 0.0, -4.0]])
    second = Tree([-1], [], [[0.5, 0.0, 0.0]])
    found = Confidence.of([0.0, -1.0, 0.0], [first, second])(np.array([[0.4, 9.0], [0.5, 1.9], [0.5, 2.0]]))
    logits = np.array([[1.5, -1.0, -1.0], [2.5, -1.0, -2.0], [4.5, -1.0, -4.0]])
    assert found == pytest.approx(1.0 / (1.0 + np.exp(-logits)))


def test_a_confidence_is_read_as_it_was_written() -> None:
    shipped = load_confidence("lane_confidence.json", FEATURES)
    data = json.loads(confidence_text(shipped, FEATURES))
    again = Confidence.of(data["start"], [Tree(**one) for one in data["trees"]])
    rows = np.random.default_rng(2).normal(1.0, 1.0, (40, len(FEATURES)))
    assert np.array_equal(shipped(rows), again(rows))


@pytest.mark.parametrize(
    ("shown", "metres", "last"),
    [("############", 0.0, 0), ("............", 3.0, 11), ("##...###....", 1.0, 11), ("#....###.##.", 1.0, 4)],
)
def test_the_longest_gap_is_measured_and_placed(shown: str, metres: float, last: int) -> None:
    """A character is 0.25 m of the stretch."""
    assert longest_gap(np.array([one == "#" for one in shown])) == {"gap": 0.25 * metres, "gap_at": last / 12}


@pytest.mark.parametrize(
    ("before", "after", "beyond", "ends", "resumes"),
    [("####", "####", 1.0, 0.0, 0.0), ("##..", "..##", 0.5, 0.5, 0.5), ("....", "#...", 0.25, 1.0, 0.0)],
)
def test_it_is_measured_where_a_line_ends_and_resumes(
    before: str, after: str, beyond: float, ends: float, resumes: float
) -> None:
    found = continued(*(np.array([one == "#" for one in part]) for part in (before, after)))
    assert found == pytest.approx({"beyond": beyond, "ends": 0.1 * ends, "resumes": 0.1 * resumes})


def test_features_are_ordered_by_their_names() -> None:
    assert in_order(("a", "b"), {"b": 2.0, "a": 1.0}).tolist() == [1.0, 2.0]
    with pytest.raises(RuntimeError, match=r"\['a', 'c'\]"):
        in_order(("a", "b"), {"b": 2.0, "c": 1.0})


@pytest.mark.parametrize(
    "name", ["straight", "radius 100 m, left", "pitch +1 degrees", "pitch -1 degrees", "grade begins, 3 degrees down"]
)
def test_in_situations_of_the_bank_boundaries_are_right_and_trusted(name: str) -> None:
    looks = look_at_bank(ClassicalLaneDetector(), situation(name), 3, 8)
    assert (looks.error < 0.25).mean() >= 0.85
    assert looks.p[:, 2].mean() > 0.85


@pytest.mark.parametrize("name", ["no paint", "leader at 6 m", "radius 60 m, right"])
def test_in_situations_of_the_bank_few_are_confident_and_wrong(name: str) -> None:
    looks = look_at_bank(ClassicalLaneDetector(), situation(name), 3, 10)
    assert ((looks.p[:, 2] > 0.6) & (looks.error > 0.25)).mean() <= 0.2


def test_paint_and_geometry_have_separate_probabilities() -> None:
    """On a straight road without paint the width tells little of where the lane is, and the paint's probability all."""
    looks = look_at_bank(ClassicalLaneDetector(), situation("no paint"), 4, 8)
    assert looks.p[:, 1].mean() < 0.3
    painted = look_at_bank(ClassicalLaneDetector(), situation("straight"), 4, 4)
    assert painted.p[:, 1].mean() > 0.9


def test_what_shows_paint_is_averaged_over_the_images_that_were_seen() -> None:
    detector, place = ClassicalLaneDetector(), bend(200.0).pose(60.0)
    image = RoadCamera(two_lanes(bend(200.0), quality=Fading(1.0, 1.0))).frame(place, [], CLEAR, 0.0, 0)
    state, rows = LaneState(), []
    for number in range(6):
        dimmed = np.asarray(image * (1.0 - 0.1 * number), np.uint8)
        found, (left, _) = detector.look(dimmed, state)
        state = state.after(found)
        rows.append(left)
    now, lately = FEATURES.index("prominence"), FEATURES.index("prominence_lately")
    seen = [row[now] for row in rows]
    assert rows[0][lately] == seen[0]
    assert rows[2][lately] == pytest.approx(np.mean(seen[:3]))
    assert rows[5][lately] == pytest.approx(rows[4][lately] + NEWEST * (seen[5] - rows[4][lately]))


def test_a_tilt_that_is_not_known_leaves_the_boundary_open() -> None:
    detector, place = ClassicalLaneDetector(), bend(0.0).pose(60.0)
    image = RoadCamera(two_lanes(bend(0.0))).frame(place, [], CLEAR, 0.0, 0)
    at = FEATURES.index("deviation_tilt")
    _, (told, _) = detector.look(image, pitch=0.0)
    _, (found, _) = detector.look(image)
    assert told[at] < found[at]


def test_measured_noise_is_the_noise_that_was_added() -> None:
    scene, place = two_lanes(bend(200.0), quality=Fading(1.0, 1.0)), bend(200.0).pose(60.0)
    image = RoadCamera(scene).frame(place, [], CLEAR, 0.0, 0)
    assert noise_of(image) < 2.0
    for sigma in (5.0, 15.0, 25.0):
        assert noise_of(add_noise(image, sigma, 1, 0)) == pytest.approx(sigma, rel=0.08)


def test_health_falls_through_one_half_at_thirty_grey_levels() -> None:
    assert noise_health(30.0) == 0.5
    assert noise_health(5.0) > 0.99
    assert noise_health(60.0) < 0.001
    assert noise_health(1e9) >= 0.0


def test_the_fit_finds_probabilities_that_come_true() -> None:
    draw = np.random.default_rng(1)
    rows = draw.normal(size=(14000, 10))
    truth = 1 / (1 + np.exp(-(1.5 * rows[:, 0] - 2.0 * rows[:, 1] * rows[:, 2])))
    labels = np.stack([draw.random(14000) < truth, rows[:, 0] > 0.0, rows[:, 1] > 0.0], axis=1).astype(float)
    fitted = fit_confidence(rows[:12000], labels[:12000])(rows[12000:])
    assert np.abs(fitted[:, 0] - truth[12000:]).mean() < 0.08
    found = reliability(fitted[:, 0], labels[12000:, 0])
    assert found.expected_error < 0.04
    assert found.area > 0.8
    assert reliability(fitted[:, 1], labels[12000:, 1]).area > 0.99


def test_figures_of_made_up_probabilities() -> None:
    p = np.repeat([0.25, 0.75], 200)
    outcomes = np.concatenate([np.arange(200) % 4 == 0, np.arange(200) % 4 != 0]).astype(float)
    found = reliability(p, outcomes)
    assert found.expected_error == pytest.approx(0.0)
    assert found.largest_error == pytest.approx(0.0)
    assert found.brier == pytest.approx(0.1875)
    assert found.area == pytest.approx(0.75)
    flipped = reliability(1.0 - p, outcomes)
    assert flipped.expected_error == pytest.approx(0.5)
    assert flipped.area == pytest.approx(0.25)


@pytest.mark.parametrize("of_a_clip", [1, 10])
def test_a_flawless_confidence_errs_by_chance_and_more_so_if_clips_repeat_themselves(of_a_clip: int) -> None:
    """The stated error is compared with the largest errors of other draws from the same confidence."""
    draw = np.random.default_rng(5)

    def measured() -> tuple[np.ndarray, np.ndarray]:
        p = draw.random(4000 // of_a_clip)
        right = draw.random(len(p)) < p
        return np.repeat(p, of_a_clip), np.repeat(right, of_a_clip).astype(float)

    clips = np.repeat(np.arange(4000 // of_a_clip), of_a_clip)
    largest = [reliability(*measured()).largest_error for _ in range(300)]
    stated = np.mean([largest_by_chance(*measured(), clips) for _ in range(20)])
    assert stated == pytest.approx(np.quantile(largest, 0.9), rel=0.15)


def test_an_error_of_the_confidence_is_not_taken_for_chance() -> None:
    p = np.repeat([0.25, 0.75], 500)
    outcomes = np.tile([0.0, 1.0], 500)
    assert reliability(p, outcomes).largest_error == pytest.approx(0.25)
    assert largest_by_chance(p, outcomes, np.arange(1000)) < 0.06


@pytest.mark.parametrize(
    ("ends", "beyond", "resumes"),
    [(math.inf, (0.15, 0.6), (0.0, 0.9)), (35.0, (0.0, 0.05), (1.0, 1.3))],
    ids=["goes on", "ends 18 m ahead"],
)
def test_a_broken_line_that_goes_on_differs_from_one_that_ends(
    ends: float, beyond: tuple[float, float], resumes: tuple[float, float]
) -> None:
    """The features about the 12 m beyond the stretch on which a boundary has to be right."""
    road = bend(0.0)
    paint = Fading(1.0, 1.0) if math.isinf(ends) else Fading(1.0, 0.0, ends, ends + 0.1)
    image = RoadCamera(two_lanes(road, quality=paint)).frame(road.pose(14.0), [], CLEAR, 0.0, 0)
    left = dict(zip(FEATURES, ClassicalLaneDetector().look(image)[1][0].tolist(), strict=True))
    assert beyond[0] <= left["beyond"] <= beyond[1]
    assert resumes[0] <= left["resumes"] <= resumes[1]


@pytest.mark.parametrize(("junction", "feature"), [(math.inf, 2.5), (12.0, 1.2), (0.0, 0.0), (None, -0.5)])
def test_the_distance_to_the_junction_is_a_feature_where_the_route_is_known(
    junction: float | None, feature: float
) -> None:
    road = bend(0.0)
    image = RoadCamera(two_lanes(road)).frame(road.pose(20.0), [], CLEAR, 0.0, 0)
    way = None if junction is None else Course.along([WayPoint(float(x), 0.0) for x in range(-3, 41)], junction)
    _, rows = ClassicalLaneDetector().look(image, LaneState(way=way))
    assert [row[FEATURES.index("junction")] for row in rows] == pytest.approx([feature, feature])
