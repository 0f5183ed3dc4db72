"""CARLA's axes and ours: conversions agree with CARLA's own client."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.frames import (
    Placement,
    carla_attached,
    carla_from_pose,
    carla_rows,
    heading_from_carla,
    pose_from_carla,
    vector_from_carla,
    yaw_from_heading,
)
from scenario_compiler.perception.camera import vehicle_axes
from scenario_compiler.roads import Pose

placements = st.builds(
    Pose,
    *(st.floats(-1e4, 1e4) for _ in range(3)),
    st.floats(0.0, 2 * math.pi, exclude_max=True),
    *(st.floats(-1.0, 1.0) for _ in range(2)),
)


@given(placements, st.floats(-3, 3), st.floats(0, 2))
def test_a_pose_comes_back_from_carla(pose: Pose, center: float, up: float) -> None:
    back = pose_from_carla(carla_from_pose(pose, center, up), center, up)
    assert np.allclose(back[:3], pose[:3], atol=1e-8)
    assert np.allclose([math.remainder(a - b, math.tau) for a, b in zip(back[3:], pose[3:], strict=True)], 0, atol=1e-9)


@given(placements)
def test_carlas_client_turns_as_we_do(pose: Pose) -> None:
    carla = pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")
    there = carla_from_pose(pose)
    transform = carla.Transform(carla.Location(*there[:3]), carla.Rotation(*there[3:]))
    ours = vehicle_axes(pose)  # columns: ahead, left, up
    for vector, axis, sign in (
        (transform.get_forward_vector(), 0, 1.0),
        (transform.get_right_vector(), 1, -1.0),
        (transform.get_up_vector(), 2, 1.0),
    ):
        assert np.allclose(vector_from_carla(vector.x, vector.y, vector.z), sign * ours[:, axis], atol=2e-5)


@given(placements, st.floats(-3, 3), st.floats(0, 2))
def test_carlas_client_finds_the_boxs_centre_where_we_do(pose: Pose, center: float, up: float) -> None:
    carla = pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")
    pose = pose._replace(x=pose.x / 100, y=pose.y / 100, z=pose.z / 100)  # its numbers have 32 bits
    axle = carla_from_pose(pose)
    moved = carla.Transform(carla.Location(*axle[:3]), carla.Rotation(*axle[3:])).transform(
        carla.Location(center, 0.0, up)
    )
    assert np.allclose(carla_from_pose(pose, center, up)[:3], (moved.x, moved.y, moved.z), atol=1e-3)


@given(st.floats(0.0, 2 * math.pi, exclude_max=True))
def test_yaw_is_the_heading_the_other_way_round(heading: float) -> None:
    yaw = yaw_from_heading(heading)
    assert -180.0 <= yaw <= 180.0
    assert math.isclose(math.cos(heading_from_carla(yaw)), math.cos(heading), abs_tol=1e-9)
    assert math.isclose(math.sin(heading_from_carla(yaw)), math.sin(heading), abs_tol=1e-9)


def test_an_uphill_road_is_a_positive_pitch_in_carla() -> None:
    assert carla_from_pose(Placement(0, 0, 0, math.pi / 2, -0.1, 0.0)) == pytest.approx(
        (0, 0, 0, 5.7296, -90.0, 0.0), abs=1e-3
    )


@given(st.lists(placements, min_size=1, max_size=5), st.floats(-3, 3), st.floats(0, 2))
def test_many_poses_are_converted_like_a_single_one(poses: list[Pose], center: float, up: float) -> None:
    columns = np.array(poses, np.float64).T
    count = len(poses)
    rows = carla_rows(columns, np.full(count, center), np.full(count, up))
    assert np.allclose(rows, [carla_from_pose(pose, center, up) for pose in poses], atol=1e-9)


transforms = st.tuples(*(st.floats(-50, 50) for _ in range(3)), *(st.floats(-80, 80) for _ in range(3)))


@given(transforms, transforms, st.tuples(*(st.floats(-5, 5) for _ in range(3))))
def test_an_attached_object_is_where_carlas_client_puts_it(
    parent: tuple[float, ...], relative: tuple[float, ...], point: tuple[float, ...]
) -> None:
    carla = pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")

    def made(one: tuple[float, ...]) -> Any:
        return carla.Transform(carla.Location(*one[:3]), carla.Rotation(*one[3:]))

    expected = made(parent).transform(made(relative).transform(carla.Location(*point)))
    found = made(carla_attached(parent, relative)).transform(carla.Location(*point))
    assert np.allclose((found.x, found.y, found.z), (expected.x, expected.y, expected.z), atol=1e-3)
