"""Every lane detector keeps its contract: the packaged ones, and the user's own of docs/controllers.md."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenario_compiler.controllers.detectors import detector_maker
from scenario_compiler.perception.calibration.bank import BANK
from scenario_compiler.perception.calibration.collect import look_at_bank
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.confidence import load_confidence
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.degradation import add_noise
from scenario_compiler.perception.detectors import DETECTORS, DetectorName, create_detector
from scenario_compiler.perception.lane_detector import LaneDetector, LaneState
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.trust import Trust, code_name
from tests.pages import code_blocks
from tests.perception.scenery import CLEAR, bend, two_lanes

X = np.array([6.0, 12.0, 18.0])


ROOT = Path(__file__).resolve().parents[2]

Make = Callable[..., LaneDetector]


def shown_on_the_page() -> str:
    """Return the code of the detector that the page on controllers shows."""
    page = (ROOT / "docs" / "controllers.md").read_text(encoding="utf-8")
    (code,) = (one for one in code_blocks(page, "python") if "class Cautious" in one)
    return code


@pytest.fixture(params=[*DETECTORS, "cautious.py:Cautious"])
def make(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Make:
    """What makes a detector for a camera."""
    name, folder = request.param, tmp_path_factory.mktemp("detector")
    if name in DETECTORS:
        return lambda camera=None: create_detector(name, camera)
    (folder / "cautious.py").write_text(shown_on_the_page(), encoding="utf-8")
    code = code_name(f"{folder}/{name}")
    maker = detector_maker(name, code, Trust((str(folder / "cautious.py"),)), "")
    return lambda camera=None: maker(camera or Camera())


def image_of(camera: Camera | None = None, pitch: float = 0.0, quality: float = 1.0) -> np.ndarray:
    reference = bend(0.0)
    pose = reference.pose(40.0)._replace(pitch=pitch)
    return RoadCamera(two_lanes(reference, quality=quality), camera).frame(pose, [], CLEAR, 0.0, 0)


def test_a_painted_lane_is_found_and_trusted(make: Make) -> None:
    found = make().detect(image_of())
    for boundary, y in ((found.left, 1.75), (found.right, -1.75)):
        assert np.abs(boundary.y(X) - y).max() < 0.25
        assert boundary.p > 0.8
        assert min(boundary.p_geom, boundary.p_paint) > 0.8
    assert found.lane_width == pytest.approx(3.5, abs=0.25)
    assert found.p_left == found.left.p * found.sensor_health


def test_without_paint_nothing_is_trusted(make: Make) -> None:
    found = make().detect(image_of(quality=0.0))
    assert max(found.left.p, found.right.p) < 0.3
    assert max(found.left.p_paint, found.right.p_paint) < 0.6


@pytest.mark.parametrize("shade", [0, 128, 255])
def test_an_empty_image_has_no_lane(make: Make, shade: int) -> None:
    found = make().detect(np.full((256, 512, 3), shade, np.uint8))
    assert max(found.left.p, found.right.p) < 0.3
    assert np.isfinite([found.left.y0, found.right.slope, found.lane_width]).all()


def test_detection_depends_on_its_arguments_only(make: Make) -> None:
    detector, image = make(), image_of()
    first = detector.detect(image)
    detector.detect(add_noise(image, 40.0, 1, 1), LaneState().after(first))
    assert detector.detect(image) == first
    assert make().detect(image) == first


def test_noise_takes_the_health_and_with_it_the_confidence(make: Make) -> None:
    found = make().detect(add_noise(image_of(), 60.0, 1, 1))
    assert found.sensor_health < 0.01
    assert max(found.p_left, found.p_right) < 0.01


@pytest.mark.parametrize("degrees", [-1.0, 1.0])
def test_an_unknown_pitch_is_found(make: Make, degrees: float) -> None:
    detector, image = make(), image_of(pitch=math.radians(degrees))
    state = LaneState()
    for _ in range(3):
        found = detector.detect(image, state)
        state = state.after(found)
    assert -math.degrees(found.tilt.pitch) == pytest.approx(degrees, abs=0.35)
    for boundary, y in ((found.left, 1.75), (found.right, -1.75)):
        assert np.abs(boundary.y(X) - y).max() < 0.3


def test_a_given_pitch_is_used(make: Make) -> None:
    found = make().detect(image_of(pitch=-0.015), pitch=0.015)
    assert found.tilt.pitch == 0.015
    assert abs(float(found.left.y(16.0)) - 1.75) < 0.2


@pytest.mark.parametrize("change", [{"z": 1.6}, {"pitch": math.radians(-7.0)}, {"width": 1024, "height": 512}])
def test_other_mountings_are_taken_into_account(make: Make, change: dict[str, float]) -> None:
    camera = replace(Camera(), **change)  # type: ignore[arg-type]
    found = make(camera).detect(image_of(camera))
    for boundary, y in ((found.left, 1.75), (found.right, -1.75)):
        assert np.abs(boundary.y(X) - y).max() < 0.3


prepared = lru_cache(create_detector)
TURNED = RoadCamera(two_lanes(bend(60.0))).frame(bend(60.0).pose(70.0), [], CLEAR, 0.0, 0)


@pytest.mark.parametrize("name", DETECTORS)
@settings(deadline=None, max_examples=30)
@given(
    radius=st.floats(2.0, 60.0),
    side=st.sampled_from([-1.0, 1.0]),
    aside=st.floats(-5.0, 5.0),
    begin=st.floats(-6.0, 15.0),
)
def test_every_route_gives_numbers(name: DetectorName, radius: float, side: float, aside: float, begin: float) -> None:
    angles = np.maximum(np.arange(-3.0, 36.0) - begin, 0.0) / radius
    x = np.minimum(np.arange(-3.0, 36.0), begin) + radius * np.sin(angles)
    y = aside + side * radius * (1.0 - np.cos(angles))
    course, state = Course.along([WayPoint(*one) for one in zip(x.tolist(), y.tolist(), strict=True)]), LaneState()
    detector = prepared(name)
    for way in (None, course, course, None):
        found, rows = detector.look(TURNED, replace(state, way=way))
        state = state.after(found)
        assert all(np.isfinite(row).all() for row in rows)
        for one in (found.left, found.right):
            assert np.isfinite([one.y0, one.slope, one.curvature, one.p_geom, one.p_paint, one.p]).all()
        assert math.isfinite(found.tilt.pitch)
        assert math.isfinite(found.tilt.deviation)


@pytest.mark.parametrize("name", DETECTORS)
def test_the_shipped_confidence_is_for_the_features_there_are(name: DetectorName) -> None:
    detector = create_detector(name)
    shipped = load_confidence(detector.confidence_file, detector.features)
    assert shipped.feature.max() < len(detector.features)
    result, rows = detector.look(image_of())
    said = [[side.p_geom, side.p_paint, side.p] for side in (result.left, result.right)]
    assert shipped(np.stack(rows)).tolist() == said


@pytest.mark.parametrize("name", DETECTORS)
def test_few_boundaries_are_confident_and_wrong_in_bends(name: DetectorName) -> None:
    situation = next(k for k, one in enumerate(BANK) if one.name == "radius 100 m, left")
    looks = look_at_bank(create_detector(name), situation, 9, 6)
    assert ((looks.p[:, 2] > 0.6) & (looks.error > 0.25)).mean() <= 0.2
