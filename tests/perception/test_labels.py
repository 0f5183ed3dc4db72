"""Depth, kinds and numbers of things are those that rays meet, and those of what the picture shows."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.labels import FARTHEST_DEPTH, Tag
from scenario_compiler.perception.models import Kind
from scenario_compiler.perception.render import Drawing
from scenario_compiler.perception.road_camera import RoadCamera, scene_of
from scenario_compiler.perception.scene import Scene
from scenario_compiler.perception.solids import Box
from scenario_compiler.roads.network import Network, load_network
from scenario_compiler.roads.positions import Pose
from tests.perception.ray_cast import cast, quads_of, tags_and_instances
from tests.perception.scenery import CLEAR, bend, two_lanes
from tests.roads.make import network, road

FRONT = Camera(width=192, height=96, fov=math.radians(70.0))
CAMERAS = {
    "front": FRONT,
    "left": replace(FRONT, x=0.0, y=0.9, yaw=math.radians(90.0), pitch=math.radians(-10.0)),
    "rear": replace(FRONT, x=-2.0, yaw=math.pi, pitch=math.radians(-8.0)),
    "behind": replace(FRONT, x=-8.0, z=3.5, pitch=math.radians(-15.0)),
    "from above": replace(FRONT, x=0.0, z=30.0, pitch=math.radians(-90.0)),
    "rolled": replace(FRONT, yaw=math.radians(-25.0), roll=math.radians(25.0), pitch=math.radians(-5.0)),
    "upwards": replace(FRONT, pitch=math.radians(35.0)),
    "wide": replace(FRONT, fov=math.radians(130.0)),
    "upside down": replace(FRONT, roll=math.pi),
    "on its side": replace(FRONT, roll=math.radians(-100.0)),
}
SIGNS = (
    '<objects><object id="1" type="building" s="50" t="14" hdg="0.2" length="12" width="8" height="7"/>'
    '<object id="2" type="tree" s="30" t="-9" height="6"/>'
    '<object id="3" type="barrier" s="0" t="6"><repeat s="10" length="60" distance="0" tStart="6" tEnd="6" '
    'zOffsetStart="0" zOffsetEnd="0" heightStart="0.8" heightEnd="0.8" widthStart="0.2" widthEnd="0.2"/></object>'
    '<object id="4" type="crosswalk" s="34" t="0" length="4" width="7"/></objects>'
    '<signals><signal id="5" type="274" s="38" t="-5" zOffset="2" orientation="+" height="0.8" width="0.8"/>'
    '<signal id="6" type="1000001" dynamic="yes" s="45" t="-5" zOffset="3" orientation="+"/></signals>'
)


TUNNEL = "".join(
    f'<object id="{number}" type="barrier" s="0" t="{t}"><repeat s="0" length="120" distance="0" tStart="{t}" '
    f'tEnd="{t}" zOffsetStart="{z}" zOffsetEnd="{z}" heightStart="{height}" heightEnd="{height}" widthStart="{width}" '
    f'widthEnd="{width}"/></object>'
    for number, t, z, height, width in ((1, 8, 0, 5, 6), (2, -8, 0, 5, 6), (3, 0, 5, 2, 30))
)
"""Two walls beside a road, and a ceiling that lies on both."""


def around(pose: Pose) -> list[Box]:
    """Return things of many kinds about a pose, the vehicle itself among them."""
    kinds: tuple[tuple[Kind, float, float, float, tuple[float, float, float]], ...] = (
        ("car", 11.0, 0.4, 0.0, (4.4, 1.85, 1.45)),
        ("truck", 24.0, 3.6, math.pi, (9.0, 2.5, 3.4)),
        ("bus", 40.0, -0.5, 0.1, (12.0, 2.5, 3.1)),
        ("bicycle", 7.0, -2.6, 0.3, (1.8, 0.6, 1.7)),
        ("pedestrian", 9.0, 3.0, 1.5, (0.5, 0.6, 1.75)),
        ("van", -12.0, 0.2, 0.0, (5.4, 2.0, 2.3)),
        ("cone", 6.0, 2.0, 0.0, (0.4, 0.4, 0.7)),
        ("barrier", 16.0, -3.0, 1.4, (1.8, 0.4, 1.0)),
        ("prop", -7.0, -3.0, 0.8, (1.0, 1.2, 1.1)),
        ("car", 0.0, 0.0, 0.0, (4.4, 1.85, 1.45)),
    )
    cos, sin = math.cos(pose.heading), math.sin(pose.heading)
    return [
        Box(pose.x + ahead * cos - left * sin, pose.y + ahead * sin + left * cos, pose.z, pose.heading + turn, *size,
            kind=kind, instance=number)
        for number, (kind, ahead, left, turn, size) in enumerate(kinds, 7)
    ]  # fmt: skip


@cache
def beside_a_road(folder: Path) -> tuple[Scene, Pose]:
    made = network(folder, road(length=120, more=SIGNS))
    return scene_of(made), made.lane_pose("1", -1, 18.0)


@cache
def hilly(corpus: Path) -> tuple[Scene, Network]:
    town = load_network(corpus / "Scenic/assets/maps/CARLA/Town04.xodr")
    return scene_of(town), town


def agreement(
    scene: Scene, camera: Camera, pose: Pose, boxes: list[Box], every: int = 3
) -> tuple[float, float, float, float]:
    """Return the shares of pixels, away from edges, whose depth, kind and number rays find too; and their share.

    Every so many-th pixel of each row and column is looked at.
    """
    looking = RoadCamera(scene, camera, box_offset=0.0)
    labels = looking.draw(pose, boxes, CLEAR)
    rows, columns = np.mgrid[2 : camera.height - 2 : every, 2 : camera.width - 2 : every]
    rows, columns = rows.ravel(), columns.ravel()
    view = looking.view(pose)
    quads = quads_of(scene, boxes, view)
    hits = cast(view, np.stack([columns, rows], axis=1).astype(float), quads)
    tags, instances = tags_and_instances(quads)
    semantic, depth, instance = (one[rows, columns] for one in (labels.semantic, labels.depth, labels.instance))
    painted = semantic == Tag.ROAD_LINE
    sky = np.isin(semantic, (Tag.SKY, Tag.VEGETATION)) & (depth == FARTHEST_DEPTH)
    right_depth = np.abs(depth - hits.depth) <= np.maximum(0.1, 0.03 * hits.depth)
    right_tag = ((tags == semantic[:, None]) & hits.seen).any(axis=1) | (sky & ~hits.seen.any(axis=1))
    right_tag |= painted & ((tags == Tag.ROAD) & hits.seen).any(axis=1)
    right_instance = ((instances == instance[:, None]) & hits.seen).any(axis=1) | (sky & (instance == 0))
    inner = even(labels)[rows, columns]
    return (
        float(right_depth[inner].mean()),
        float(right_tag[inner].mean()),
        float(right_instance[inner].mean()),
        float(inner.mean()),
    )


def even(labels: Drawing) -> np.ndarray:
    """Return the pixels whose neighbours show the same thing, in one piece."""
    ring = np.ones((3, 3), np.uint8)
    kinds = labels.semantic.astype(np.float32) + 64.0 * labels.instance.astype(np.float32)
    near = np.float32(1.0) / labels.depth
    bent = np.abs(cv2.Laplacian(near, cv2.CV_32F)) > 0.01 * near
    return np.asarray(
        (cv2.dilate(kinds, ring) == cv2.erode(kinds, ring)) & ~cv2.dilate(bent.astype(np.uint8), ring).astype(bool)
    )


@pytest.mark.parametrize("name", CAMERAS)
def test_labels_agree_with_cast_rays(name: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    scene, pose = beside_a_road(tmp_path_factory.getbasetemp())
    depth, tag, instance, share = agreement(scene, CAMERAS[name], pose, around(pose))
    assert share > 0.5
    assert depth > 0.985
    assert tag > 0.99
    assert instance > 0.99


@pytest.mark.parametrize(("z", "pitch", "fov"), [(0.1, 0.0, 120.0), (1.3, -5.0, 170.0), (0.3, -60.0, 90.0)])
def test_a_low_or_very_wide_camera_sees_the_road_below_it(
    z: float, pitch: float, fov: float, tmp_path_factory: pytest.TempPathFactory
) -> None:
    scene, pose = beside_a_road(tmp_path_factory.getbasetemp())
    camera = replace(FRONT, z=z, pitch=math.radians(pitch), fov=math.radians(fov))
    labels = RoadCamera(scene, camera, box_offset=0.0).draw(pose, [], CLEAR)
    assert labels.semantic[-1, camera.width // 2] in (Tag.ROAD, Tag.ROAD_LINE)
    assert labels.depth[-1].max() < 0.3


@pytest.mark.parametrize(
    ("name", "number", "s"),
    [
        pytest.param(
            name,
            number,
            s,
            marks=[]
            if (name, number) in (("front", "34"), ("rolled", "31"), ("upside down", "34"))
            else pytest.mark.slow,
        )
        for name in ("front", "rear", "behind", "rolled", "upside down", "on its side")
        for number, s in (("34", 60.0), ("31", 100.0), ("40", 120.0))
    ],
)
def test_labels_agree_with_cast_rays_among_hills_and_bridges(name: str, number: str, s: float, corpus: Path) -> None:
    scene, town = hilly(corpus)
    lane = next(one.lane for one in town.lanes_at(number, s) if one.type == "driving")
    pose = town.lane_pose(number, lane, s)
    depth, tag, instance, share = agreement(scene, CAMERAS[name], pose, around(pose)[:3], every=6)
    assert share > 0.5
    assert depth > 0.98
    assert tag > 0.98
    assert instance > 0.98


def test_the_walls_of_a_tunnel_hide_its_ceiling(tmp_path: Path) -> None:
    made = network(tmp_path, road(length=120, more=f"<objects>{TUNNEL}</objects>"))
    pose = made.lane_pose("1", -1, 50.0)
    camera = replace(FRONT, pitch=math.radians(15.0), fov=math.radians(90.0))
    depth, tag, instance, share = agreement(scene_of(made), camera, pose, around(pose)[:3])
    assert share > 0.5
    assert min(depth, tag, instance) > 0.99


def steepest(labels: Drawing, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Return how parallel each normal is to that of the plane through the neighbours' points, and which are even."""
    columns, rows = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    across, down = (columns - camera.width / 2.0) / camera.focal, (rows - camera.height / 2.0) / camera.focal
    points = np.stack([across, down, np.ones_like(across)], axis=2) * labels.depth[..., None].astype(np.float64)
    right, below = np.gradient(points, axis=1), np.gradient(points, axis=0)
    normal = np.cross(right, below)
    normal /= np.maximum(np.linalg.norm(normal, axis=2, keepdims=True), 1e-12)
    inner = even(labels) & (labels.depth < 60.0)
    return np.abs((normal @ labels.view.rotation * labels.normals).sum(axis=2)), inner


@pytest.mark.parametrize("name", CAMERAS)
def test_normals_are_those_of_the_planes_that_the_depths_make(
    name: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    scene, pose = beside_a_road(tmp_path_factory.getbasetemp())
    labels = RoadCamera(scene, CAMERAS[name], box_offset=0.0).draw(pose, around(pose), CLEAR)
    parallel, inner = steepest(labels, CAMERAS[name])
    assert (parallel[inner] > 0.98).mean() > 0.98
    length = np.linalg.norm(labels.normals, axis=2)
    sky = np.isin(labels.semantic, (Tag.SKY, Tag.VEGETATION)) & (labels.instance == 0)
    assert np.abs(length[~sky] - 1.0).max() < 1e-5
    assert length[sky].max(initial=0.0) == 0.0


def test_a_road_faces_up_and_a_block_its_viewer() -> None:
    straight = bend(0.0)
    block = Box(70.0, 0.0, 0.0, 0.0, *BLOCK, MAGENTA, "prop", instance=3)
    labels = RoadCamera(two_lanes(straight), FRONT, box_offset=0.0).draw(straight.pose(60.0), [block], CLEAR)
    road, rear = labels.semantic == Tag.ROAD, labels.instance == 3
    assert np.abs(labels.normals[road] - (0.0, 0.0, 1.0)).max() < 1e-6
    assert np.median(labels.normals[rear], axis=0) == pytest.approx([-1.0, 0.0, 0.0], abs=1e-6)


MAGENTA, BLOCK = (255, 0, 255), (1.6, 1.6, 1.6)


@pytest.mark.parametrize("name", CAMERAS)
def test_the_picture_shows_a_thing_where_the_labels_say(name: str) -> None:
    """The colour of a box is seen in all of the pixels that are its own, and in none beyond their rim."""
    straight = bend(0.0)
    pose, scene = straight.pose(60.0), two_lanes(straight)
    places = ((9.0, -1.0), (-14.0, 1.0), (0.5, 6.0), (4.0, -3.0), (1.0, 0.5))
    boxes = [Box(60.0 + x, y, 0.0, 0.3, *BLOCK, MAGENTA, "prop", instance=k) for k, (x, y) in enumerate(places, 1)]
    drawing = RoadCamera(scene, CAMERAS[name], box_offset=0.0).draw(pose, boxes, CLEAR)
    image, labels = drawing.image(1, 0).astype(int), drawing
    coloured = np.minimum(image[..., 0], image[..., 2]) - image[..., 1] > 60
    own = (labels.instance > 0).astype(np.uint8)
    ring = np.ones((3, 3), np.uint8)
    assert coloured[cv2.erode(own, ring) > 0].all()
    assert not coloured[cv2.dilate(own, ring) == 0].any()
    assert ((labels.semantic == Tag.STATIC) == (own > 0)).all()
    assert own.any() == (name != "upwards")


@pytest.mark.parametrize("name", ["front", "left", "rear", "rolled"])
def test_the_picture_shows_paint_where_the_labels_say(name: str) -> None:
    """Against the same road without paint; a line that is thinner than half a pixel is no label, and pale."""
    straight = bend(0.0)
    pose = straight.pose(60.0)
    painted, bare = (
        RoadCamera(two_lanes(straight, quality=quality), CAMERAS[name], box_offset=0.0).draw(pose, [], CLEAR)
        for quality in (1.0, 0.0)
    )
    labels = painted
    brighter = (painted.image(1, 0).astype(int) - bare.image(1, 0)).min(axis=2)
    lines = (labels.semantic == Tag.ROAD_LINE).astype(np.uint8)
    ring = np.ones((3, 3), np.uint8)
    assert (bare.semantic != Tag.ROAD_LINE).all()
    assert brighter[cv2.erode(lines, ring) > 0].min() > 50
    assert brighter[cv2.dilate(lines, ring) == 0].max() < 85


def test_worn_paint_is_not_labelled_as_a_line() -> None:
    straight = bend(0.0)
    for quality, there in ((0.3, True), (0.1, False)):
        camera = RoadCamera(two_lanes(straight, quality=quality), FRONT)
        assert (camera.draw(straight.pose(60.0), [], CLEAR).semantic == Tag.ROAD_LINE).any() == there


def test_the_sky_is_farthest_and_trees_stand_at_the_horizon() -> None:
    straight = bend(0.0)
    labels = RoadCamera(two_lanes(straight), replace(FRONT, width=640, height=320)).draw(
        straight.pose(60.0), [], CLEAR
    )  # fmt: skip
    sky, trees = labels.semantic == Tag.SKY, labels.semantic == Tag.VEGETATION
    assert (labels.depth[sky | trees] == FARTHEST_DEPTH).all()
    assert np.flatnonzero(sky.any(axis=1)).max() < np.flatnonzero(trees.any(axis=1)).max() < 160
    assert trees.any()


def test_things_of_the_map_have_negative_numbers_in_the_order_of_the_file(
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    scene, pose = beside_a_road(tmp_path_factory.getbasetemp())
    camera = RoadCamera(scene, replace(FRONT, width=640, height=320), box_offset=0.0)
    labels = camera.draw(pose, [], CLEAR)
    kinds = {int(one): set(labels.semantic[labels.instance == one].tolist()) for one in np.unique(labels.instance)}
    assert kinds[-1] == {Tag.BUILDING}
    assert kinds[-2] == {Tag.VEGETATION}
    assert kinds[-3] == {Tag.GUARD_RAIL}
    assert kinds[-5] == {Tag.TRAFFIC_SIGN, Tag.POLE}
    assert kinds[-6] == {Tag.TRAFFIC_LIGHT, Tag.POLE}
    assert -4 not in kinds


def test_tags_are_those_of_carla() -> None:
    carla = pytest.importorskip("carla")
    theirs = {
        name.lower().rstrip("s").replace("_", ""): int(value)
        for name, value in carla.CityObjectLabel.names.items()
        if name not in {"NONE", "Any"}
    }
    assert {tag.name.lower().rstrip("s").replace("_", ""): int(tag) for tag in Tag if tag} == theirs
