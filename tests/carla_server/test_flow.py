"""The optical flow of a known scene against what geometry says for single motions."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.carla_server.sensors.flow import flow, placed
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.labels import FARTHEST_DEPTH, Tag
from scenario_compiler.perception.render import Drawing
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.solids import Box
from scenario_compiler.roads.positions import Pose
from tests.perception.scenery import CLEAR, bend, horizon, two_lanes

CAMERA = Camera(width=192, height=96, fov=math.radians(70.0), windscreen=False)
CENTRE = np.array([CAMERA.width / 2.0, CAMERA.height / 2.0])
STRAIGHT = bend(0.0)
BLOCK = (1.6, 1.6, 1.6)


def looking(camera: Camera, pose: Pose, block: Pose) -> Drawing:
    """Return what a camera sees of a road with a block on it, whose number is 7."""
    box = Box(*block[:4], *BLOCK, kind="prop", instance=7)
    return RoadCamera(two_lanes(STRAIGHT), camera, box_offset=0.0).draw(pose, [box], CLEAR)


def moved_pixels(found: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return a flow in pixels to the right and down."""
    scaled: NDArray[np.float64] = np.multiply(found, CENTRE * np.array([1.0, -1.0]))
    return scaled


def offsets() -> NDArray[np.float64]:
    """Return the place of each pixel relative to the principal point."""
    columns, rows = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    return np.asarray(np.stack([columns, rows], axis=2) - CENTRE, np.float64)


def test_nothing_moves_without_a_motion() -> None:
    pose, block = STRAIGHT.pose(60.0), STRAIGHT.pose(70.0)
    drawing = looking(CAMERA, pose, block)
    assert np.abs(flow(drawing, drawing.view, {7: np.eye(4)})).max() < 1e-6


def test_a_way_ahead_spreads_the_image_by_the_depths() -> None:
    """A point at depth Z was at Z + 1 before a metre's way: it has moved by its place times 1 / (Z + 1)."""
    level = replace(CAMERA, pitch=0.0)
    block = STRAIGHT.pose(70.0)
    before, now = (looking(level, STRAIGHT.pose(s), block) for s in (59.0, 60.0))
    shift = moved_pixels(flow(now, before.view, {7: np.eye(4)}))
    near = now.depth < FARTHEST_DEPTH
    expected = offsets() / (now.depth[..., None].astype(np.float64) + 1.0)
    assert np.abs(shift - expected)[near].max() < 1e-3
    assert np.abs(shift[~near]).max() < 1e-4
    assert (now.instance == 7).sum() > 100


def test_a_turn_moves_the_sky_too() -> None:
    pose, turn = STRAIGHT.pose(60.0), math.radians(2.0)
    before, now = (looking(CAMERA, pose._replace(heading=h), STRAIGHT.pose(50.0)) for h in (0.0, turn))
    shift = moved_pixels(flow(now, before.view, {}))
    column = CAMERA.width // 2
    row = int(horizon(CAMERA)) - 5
    assert now.semantic[row, column] in (Tag.SKY, Tag.VEGETATION)
    assert shift[row, column, 0] == pytest.approx(CAMERA.focal * math.tan(turn), abs=0.05)


def test_what_goes_along_with_the_camera_stands_still_in_its_image() -> None:
    poses = [(STRAIGHT.pose(s), STRAIGHT.pose(s + 10.0)) for s in (59.0, 60.0)]
    before, now = (looking(CAMERA, *pair) for pair in poses)
    back = placed(poses[0][1]) @ np.linalg.inv(placed(poses[1][1]))
    found = flow(now, before.view, {7: back})
    assert np.abs(found[now.instance == 7]).max() < 1e-6
    still = flow(now, before.view, {})
    assert np.abs(still[now.instance == 7]).max() > 0.01


def test_a_thing_that_turns_moves_by_its_own_matrix() -> None:
    """Each pixel of it is where its point was, seen by the same camera before."""
    pose, first = STRAIGHT.pose(60.0), STRAIGHT.pose(68.0)
    second = first._replace(y=first.y + 0.4, heading=first.heading + 0.1)
    now = looking(CAMERA, pose, second)
    back = placed(first) @ np.linalg.inv(placed(second))
    shift = moved_pixels(flow(now, now.view, {7: back}))
    row, column = (int(np.median(one)) for one in np.nonzero(now.instance == 7))
    ray = np.array([*(offsets()[row, column] / CAMERA.focal), 1.0]) * float(now.depth[row, column])
    point = ray @ now.view.rotation + now.view.position
    was = back[:3, :3] @ point + back[:3, 3]
    u, v = now.view.to_image(now.view.to_camera(was))
    assert shift[row, column] == pytest.approx([column - u, row - v], abs=1e-3)
    assert shift[row, column, 0] < -1.0  # to the left is towards smaller columns
    assert np.abs(shift[now.instance != 7]).max() < 1e-4
