import math
from pathlib import Path
from typing import get_args

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.scenes import Reference, Strip, make_scene
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.models import Kind
from scenario_compiler.perception.road_camera import RoadCamera, scene_of
from scenario_compiler.perception.scene import SURFACE_DISTANCE, Scene
from scenario_compiler.perception.solids import Box
from scenario_compiler.roads.mesh import Marks, Material, Surface
from scenario_compiler.roads.network import load_network
from scenario_compiler.roads.positions import Pose
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather
from tests.perception.scenery import CLEAR, bend, horizon, two_lanes, weather
from tests.roads.make import shifted

Image = NDArray[np.uint8]
STRAIGHT = bend(0.0)
HERE = STRAIGHT.pose(20.0)
CAR = Box(50.0, 0.0, 0.0, 0.0, 4.4, 1.85, 1.45, (20, 20, 220))


@pytest.fixture(scope="module")
def road_camera() -> RoadCamera:
    return RoadCamera(two_lanes(STRAIGHT))


def shot(camera: RoadCamera, pose: Pose = HERE, sky: Weather = CLEAR, *boxes: Box, frame: int = 0) -> Image:
    return camera.frame(pose, boxes, sky, 0.0, frame)


def paint_pixels(image: Image) -> int:
    """Count the bright, colourless pixels below the horizon."""
    ground = image[90:].astype(int)
    return int(((ground.min(axis=2) > 150) & (np.ptp(ground, axis=2) < 25)).sum())


def test_equal_arguments_give_equal_bytes_whatever_was_drawn_before() -> None:
    scene, rain = two_lanes(bend(200.0)), weather("HardRainSunset")
    first = RoadCamera(scene, seed=3).frame(HERE, [CAR], rain, 12.0, 41)
    other = RoadCamera(scene, seed=3)
    other.frame(STRAIGHT.pose(60.0), [], CLEAR, 0.0, 3)
    assert np.array_equal(first, other.frame(HERE, [CAR], rain, 12.0, 41))
    assert not np.array_equal(first, RoadCamera(scene, seed=4).frame(HERE, [CAR], rain, 12.0, 41))


@pytest.mark.parametrize("name", [pytest.param("ClearNoon", marks=pytest.mark.slow), "HardRainSunset", "WetNight"])
@pytest.mark.parametrize("camera", [Camera(), Camera(width=640, height=360, yaw=0.4, roll=0.1)])
def test_pictures_are_equal_for_any_number_of_threads(name: str, camera: Camera) -> None:
    """Two pictures of a row, so that one that was computed otherwise would reach the next."""
    boxes = [CAR, CAR._replace(x=34.0, y=3.5, heading=math.pi, kind="truck", length=9.0, height=3.4)]
    threads, found = cv2.getNumThreads(), []
    try:
        for count in (1, 2, 5):
            cv2.setNumThreads(count)
            drawn = RoadCamera(two_lanes(bend(200.0)), camera, seed=3)
            images = [drawn.frame(HERE, boxes, weather(name), 5.0, k) for k in (7, 8)]
            drawing = drawn.draw(HERE, boxes, weather(name))
            seen = [one.tobytes() for one in (drawing.depth, drawing.semantic, drawing.instance)]
            found.append(b"".join([*(image.tobytes() for image in images), *seen]))
    finally:
        cv2.setNumThreads(threads)
    assert found[0] == found[1] == found[2]


def test_drawings_of_one_camera_do_not_disturb_each_other(road_camera: RoadCamera) -> None:
    """Working memory is used again: an image that was returned stays as it is."""
    first = road_camera.draw(HERE, [CAR], CLEAR)
    image = first.image(1, 0)
    kept, depth = image.copy(), first.depth.copy()
    road_camera.draw(STRAIGHT.pose(60.0), [], weather("HardRainSunset")).image(1, 4)
    assert np.array_equal(image, kept)
    assert np.array_equal(first.depth, depth)


@pytest.mark.parametrize("name", WEATHER_PRESETS)
def test_every_preset_can_be_drawn(road_camera: RoadCamera, name: str) -> None:
    image = shot(road_camera, HERE, weather(name), CAR)
    assert image.shape == (256, 512, 3)
    assert image.dtype == np.uint8
    assert image.std() > 1.0


def test_lines_lie_where_the_camera_says(road_camera: RoadCamera) -> None:
    image = shot(road_camera)
    u, v = road_camera.camera.project_ground([8.0, 12.0], [-1.75, -1.75])
    for column, row in zip(np.round(u).astype(int), np.round(v).astype(int), strict=True):
        assert image[row, column].min() > 150
        assert image[row, column - 12].max() < 130


def test_paint_wears_away_with_quality() -> None:
    left = [paint_pixels(shot(RoadCamera(two_lanes(STRAIGHT, quality=q)))) for q in (1.0, 0.6, 0.3, 0.0)]
    assert left[0] > left[1] > left[2] >= left[3]
    assert left[3] == 0


def test_weather_weakens_paint_in_the_published_order(road_camera: RoadCamera) -> None:
    u, v = road_camera.camera.project_ground(9.0, -1.75)
    column, row = round(float(u)), round(float(v))

    def contrast(name: str) -> float:
        image = shot(road_camera, HERE, weather(name))[:, :, 1].astype(float)
        return float(image[row, column - 2 : column + 3].max() - np.median(image[row, column - 30 : column - 10]))

    assert contrast("ClearNoon") > contrast("SoftRainNoon") > contrast("HardRainNoon") > contrast("HardRainSunset")
    assert contrast("HardRainSunset") < 25.0


def test_nights_are_dark(road_camera: RoadCamera) -> None:
    assert shot(road_camera, HERE, weather("ClearNight")).mean() < 0.5 * shot(road_camera).mean()


@pytest.mark.parametrize("falloff", [-1.0, 0.0, 0.2, 1.0])
def test_the_thickest_fog_hides_what_is_50_m_ahead_and_not_what_is_near(
    road_camera: RoadCamera, falloff: float
) -> None:
    """Also a fog that grows thinner with height: it lies on the road."""
    fog = CLEAR.model_copy(update={"fog_density": 100.0, "fog_distance": 0.0, "fog_falloff": falloff})

    def seen(car: Box) -> float:
        clear, veiled = (np.abs(shot(road_camera, HERE, sky, car).astype(int) - shot(road_camera, HERE, sky)).max()
                         for sky in (CLEAR, fog))  # fmt: skip
        return float(veiled / clear)

    assert seen(CAR._replace(x=HERE.x + 1.9 + 50.0 + CAR.length / 2.0)) < 0.1
    assert seen(CAR._replace(x=HERE.x + 12.0)) > 0.3


def test_a_car_ahead_covers_the_road(road_camera: RoadCamera) -> None:
    empty, full = shot(road_camera), shot(road_camera, HERE, CLEAR, CAR)
    changed = np.argwhere(np.any(empty != full, axis=2))
    assert len(changed) > 30
    assert 200 < changed[:, 1].mean() < 312
    near = shot(road_camera, HERE, CLEAR, CAR._replace(x=35.0))
    assert np.any(empty != near, axis=2).sum() > 2 * len(changed)


def test_boxes_are_drawn_by_distance_and_not_by_order(road_camera: RoadCamera) -> None:
    van, person = CAR._replace(x=70.0, height=2.5), Box(45.0, -1.0, 0.0, 0.0, 0.5, 0.5, 1.75, kind="pedestrian")
    assert np.array_equal(
        shot(road_camera, HERE, CLEAR, CAR, van, person), shot(road_camera, HERE, CLEAR, person, van, CAR)
    )


def test_a_box_behind_or_around_the_camera_does_no_harm(road_camera: RoadCamera) -> None:
    assert np.array_equal(shot(road_camera, HERE, CLEAR, CAR._replace(x=-30.0)), shot(road_camera))
    assert shot(road_camera, HERE, CLEAR, CAR._replace(x=HERE.x + 1.9)).shape == (256, 512, 3)


def test_the_texture_is_fixed_to_the_world(road_camera: RoadCamera) -> None:
    """What is seen 12 m ahead is seen 2 m nearer after driving 2 m."""
    camera = road_camera.camera
    before, after = shot(road_camera), shot(road_camera, STRAIGHT.pose(22.0))
    y = np.linspace(-1.2, 1.2, 60)
    (u0, v0), (u1, v1) = camera.project_ground(np.full(60, 9.0), y), camera.project_ground(np.full(60, 7.0), y)
    first = before[np.round(v0).astype(int), np.round(u0).astype(int), 1].astype(float)
    second = after[np.round(v1).astype(int), np.round(u1).astype(int), 1].astype(float)
    assert np.corrcoef(first, second)[0, 1] > 0.4


def test_an_empty_scene_and_a_camera_that_sees_no_ground_can_be_drawn() -> None:
    nothing = Scene(
        Surface(
            np.empty((0, 4, 3), np.float32), np.empty(0, np.uint8), np.empty(0, np.uint8),
            np.empty(0, np.int32), np.empty(0, np.int32), np.empty((0, 2)),
        ),
        Marks(
            np.empty((0, 4, 3), np.float32), np.empty(0, np.uint8), np.empty(0, np.float32),
            np.empty(0, np.float32), np.empty(0, np.int32), np.empty(0, np.int32), np.empty((0, 2)),
        ),
    )  # fmt: skip
    assert shot(RoadCamera(nothing)).shape == (256, 512, 3)
    assert shot(RoadCamera(nothing, Camera(pitch=math.radians(40.0)))).shape == (256, 512, 3)
    assert shot(RoadCamera(nothing, Camera(pitch=math.radians(-60.0))), HERE, weather("HardRainNoon")).any()


def crossing(height: float) -> Scene:
    """A road along x and one across it 40 m ahead, at a height."""
    along = make_scene(Reference([(200.0, 0.0, 0.0)]), [Strip(4.0, -4.0)], [])
    quad = np.array([[[66, 60, height], [66, -60, height], [56, -60, height], [56, 60, height]]], np.float32)
    flat = along.surface.quads
    count = len(flat) + 1
    surface = Surface(
        np.concatenate([flat, quad]),
        np.full(count, Material.ASPHALT, np.uint8),
        np.zeros(count, np.uint8),
        np.zeros(count, np.int32),
        np.zeros(count, np.int32),
        np.zeros((count, 2)),
    )
    return Scene(surface, along.marks)


def test_a_bridge_is_seen_from_below_and_a_road_below_is_hidden() -> None:
    level = shot(RoadCamera(crossing(0.0)))
    over = shot(RoadCamera(crossing(6.0)))
    row = round(horizon(Camera()))
    assert np.any(over[: row - 5] != level[: row - 5])
    assert np.array_equal(over[row + 40 :], level[row + 40 :])


def test_a_town_costs_no_more_than_what_is_near(corpus: Path) -> None:
    network = load_network(corpus / "Scenic/assets/maps/CARLA/Town04.xodr")
    assert network is not None
    scene = scene_of(network)
    camera = Camera()
    for road in network.road_ids[::60]:
        pose = network.road_pose(road, network.road(road).length / 2, 0.0)
        view = camera.view(pose)
        assert len(scene.grid.near(view, SURFACE_DISTANCE)) < 0.2 * len(scene.grid.order)
        assert RoadCamera(scene, camera).frame(pose, [], CLEAR, 0.0, 0).std() > 5.0


def test_a_map_far_out_looks_the_same(repository: Path, tmp_path: Path) -> None:
    """Where a map of southern Germany lies in UTM coordinates; single precision resolves 0.5 m there."""
    path = repository / "maps/town_grid/town_grid.xodr"
    (tmp_path / "far.xodr").write_text(
        shifted(path.read_text(encoding="utf-8"), 500_000.0, 5_400_000.0), encoding="utf-8"
    )
    here, there = load_network(path), load_network(tmp_path / "far.xodr", cache=False)
    assert here is not None
    assert there is not None
    for road in here.road_ids[:3]:
        near, far = (
            shot(RoadCamera(network), network.lane_pose(road, -1, 8.0)).astype(int) for network in (here, there)
        )
        assert (np.abs(near - far).max(axis=2) <= 1).mean() > 0.999
        assert near.std() > 5.0


def test_each_kind_of_box_is_drawn_differently(road_camera: RoadCamera) -> None:
    kinds: tuple[Kind, ...] = get_args(Kind)
    box = Box(32.0, 0.0, 0.0, 0.0, 2.0, 1.0, 1.5, (20, 20, 220))
    shots = {kind: shot(road_camera, HERE, CLEAR, box._replace(kind=kind)).tobytes() for kind in kinds}
    assert len(set(shots.values())) == len(kinds)
    assert shot(road_camera).tobytes() not in shots.values()
