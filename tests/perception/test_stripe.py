"""What the picture shows along a line tells where there is paint on it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from scenario_compiler.perception.birds_eye import bright_of
from scenario_compiler.perception.calibration.scenes import Fading
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.stripe import AHEAD, BEYOND, FARTHER, JUDGED, NEARER, Stripe, stripe_along
from tests.perception.scenery import CLEAR, US_DASH, bend, route, two_lanes

RIGHT, BESIDE = -1.75, -0.6
"""Where the lane's right line is, and a place in the lane without one, m to the left of the camera."""


def stripe(t: float, radius: float = 0.0, pitch: float = 0.0, **road: Any) -> Stripe:
    """What the picture of a road shows along a line that keeps its distance from the route.

    Args:
        t: Distance of the line to the left of the route, m.
        radius: Radius of the road, m; 0 is straight.
        pitch: Upward tilt of the camera, which is known, rad.
        road: Its width and its lines (see `two_lanes`).
    """
    reference = bend(radius)
    pose = reference.pose(66.0)
    image = RoadCamera(two_lanes(reference, **road), Camera(pitch=Camera().pitch + pitch)).frame(
        pose, [], CLEAR, 0.0, 0
    )
    course = route(reference, pose) if radius else None
    return stripe_along(bright_of(image), Camera(), np.full(len(AHEAD), t), pitch, course)


def share(shown: np.ndarray) -> float:
    return float(shown.mean())


@pytest.mark.parametrize("radius", [0.0, 60.0, -60.0])
def test_a_solid_line_is_seen_along_all_of_the_stretch_that_is_in_the_picture(radius: float) -> None:
    found = stripe(RIGHT, radius)
    assert share(found.shown[JUDGED]) > 0.95
    assert found.contrast[JUDGED].min() > 20.0


@pytest.mark.parametrize("radius", [0.0, 60.0, -60.0])
def test_bare_ground_shows_nothing(radius: float) -> None:
    assert share(stripe(BESIDE, radius).shown) < 0.1
    assert share(stripe(RIGHT, radius, quality=0.0).shown) < 0.1


def test_a_line_that_is_a_quarter_of_a_metre_away_is_still_on_it_and_one_farther_away_is_not() -> None:
    assert share(stripe(RIGHT + 0.2).shown[JUDGED]) > 0.95
    assert share(stripe(RIGHT + 0.6).shown[JUDGED]) < 0.1


@pytest.mark.parametrize(("dash", "painted"), [((4.0, 8.0), 1 / 3), (US_DASH, 1 / 4)])
def test_dashes_are_seen_with_their_gaps(dash: tuple[float, float], painted: float) -> None:
    """One period of each is judged; a pixel is up to 0.7 m long there, so dashes look longer than they are."""
    assert painted - 0.03 < share(stripe(RIGHT, outer=dash).shown[JUDGED]) < painted + 0.12


def test_it_is_seen_where_paint_ends() -> None:
    """The car is at 66 m, and the line wears away from full to none between 74 and 78 m."""
    found = stripe(RIGHT, quality=Fading(1.0, 0.0, 74.0, 78.0))
    assert share(found.shown[NEARER]) > share(found.shown[FARTHER])
    assert share(found.shown[BEYOND]) < 0.1


def test_a_tilt_that_is_known_moves_nothing() -> None:
    assert share(stripe(RIGHT, pitch=0.02).shown[JUDGED]) > 0.95


def test_what_lies_outside_the_picture_shows_nothing() -> None:
    found = stripe(8.0)
    outside = np.arctan2(8.0, AHEAD) > Camera().fov / 2.0
    assert outside.any()
    assert not found.strength[outside].any()
    assert not found.contrast[outside].any()
