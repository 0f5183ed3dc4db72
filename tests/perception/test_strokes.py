"""Lines drawn into the world: where they are seen, how broad, and what hides them."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera, View
from scenario_compiler.perception.strokes import Stroke, draw_strokes
from scenario_compiler.roads import Pose

CAMERA = Camera(160, 120, math.radians(90.0), 0.0, 0.0, 1.5, 0.0, 0.0, 0.0)
RED = (0, 0, 255)
BACKGROUND = 90.0
"""Depth of everything behind the strokes, m."""


def view() -> View:
    return CAMERA.view(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def drawn(*strokes: Stroke, depth: float | NDArray[np.float32] = BACKGROUND) -> NDArray[np.bool_]:
    """Return which pixels strokes have coloured."""
    image = np.zeros((CAMERA.height, CAMERA.width, 3), np.uint8)
    behind = np.broadcast_to(np.asarray(depth, np.float32), image.shape[:2])
    draw_strokes(image, behind, view(), strokes)
    assert not image[..., :2].any()
    return np.asarray(image[..., 2] == 255)


@given(x=st.floats(4.0, 80.0), y=st.floats(-3.0, 3.0), z=st.floats(0.0, 3.0), width=st.floats(0.05, 1.0))
def test_the_width_of_a_line_depends_on_its_distance(x: float, y: float, z: float, width: float) -> None:
    seen = drawn(Stroke((x, y - 1.0, z), (x, y + 1.0, z), width, RED))
    ((u, v),) = view().to_image(view().to_camera([[x, y, z]]))
    column = np.flatnonzero(seen[:, round(u)])
    slant = math.hypot(1.0, (z - 1.5) / x)  # its broad side is turned to the lens
    assert len(column) == pytest.approx(CAMERA.focal * width / x * slant, abs=2.1)
    assert column.mean() == pytest.approx(v, abs=1.1)
    length = np.flatnonzero(seen[int(column.mean())])
    assert len(length) == pytest.approx(min(CAMERA.focal * 2.0 / x, CAMERA.width), abs=2.1)


def test_a_point_is_a_square() -> None:
    seen = drawn(Stroke((10.0, 0.0, 1.5), (10.0, 0.0, 1.5), 1.0, RED))
    rows, columns = np.nonzero(seen)
    assert np.ptp(rows) == pytest.approx(CAMERA.focal / 10.0, abs=1.1)
    assert np.ptp(columns) == pytest.approx(CAMERA.focal / 10.0, abs=1.1)


@given(wall=st.floats(5.0, 40.0))
def test_objects_in_front_of_a_line_hide_it(wall: float) -> None:
    away = Stroke((3.0, 0.0, 0.0), (60.0, 0.0, 0.0), 0.3, RED)
    seen = np.flatnonzero(drawn(away, depth=wall).any(axis=1))
    highest = CAMERA.height / 2.0 + CAMERA.focal * 1.5 / wall
    assert seen.min() == pytest.approx(highest, abs=3.0)
    lowest = CAMERA.height / 2.0 + CAMERA.focal * 1.5 / 3.0
    assert seen.max() == pytest.approx(min(lowest, CAMERA.height - 1), abs=2.0)


def test_a_line_on_the_ground_is_not_hidden_by_the_ground() -> None:
    rows = np.arange(CAMERA.height)[:, None] - CAMERA.height / 2.0
    ground = np.where(rows > 0.0, 1.5 * CAMERA.focal / np.maximum(rows, 1e-3), 1000.0).astype(np.float32)
    line = Stroke((4.0, 0.5, 0.0), (50.0, 0.5, 0.0), 0.2, RED)
    on_it = drawn(line, depth=np.broadcast_to(ground, (CAMERA.height, CAMERA.width)))
    assert on_it.sum() > 0.9 * drawn(line).sum()


def test_a_line_that_begins_behind_the_lens_is_seen_from_the_lens_on() -> None:
    seen = drawn(Stroke((-20.0, 0.0, 0.0), (50.0, 0.0, 0.0), 0.2, RED))
    assert seen[-1].any()
    assert not seen[: CAMERA.height // 2].any()
    assert not drawn(Stroke((-20.0, 0.0, 0.0), (-1.0, 0.0, 0.0), 0.2, RED)).any()
    assert not drawn(Stroke((0.0, 0.0, 1.5), (-1.0, 0.0, 1.5), 0.2, RED)).any()
    assert drawn(Stroke((0.0, 0.0, 1.5), (50.0, 0.0, 1.5), 0.2, RED)).any()
