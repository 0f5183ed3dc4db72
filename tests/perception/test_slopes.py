"""Ground that leaves the plane below the vehicle is drawn as far away as it is."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.lens import Lens
from scenario_compiler.perception.render import Drawing
from scenario_compiler.perception.road_camera import RoadCamera, scene_of
from scenario_compiler.perception.solids import Box
from scenario_compiler.roads.network import Network
from tests.perception.scenery import CLEAR, weather
from tests.roads.make import lane, network, road, section

FOG = CLEAR.model_copy(update={"fog_density": 30.0, "fog_distance": 0.0, "fog_falloff": 0.2})
NIGHT = weather("ClearNight")
WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
SOLID = '<roadMark sOffset="0" type="solid" weight="standard" color="white" width="0.3"/>'
FLAT = '<elevation s="0" a="0" b="0" c="0" d="0"/>'
UPHILL = (
    '<elevation s="0" a="0" b="0" c="0" d="0"/><elevation s="30" a="0" b="0" c="0.002" d="0"/>'
    '<elevation s="60" a="1.8" b="0.12" c="0" d="0"/>'
)
CREST = (
    '<elevation s="0" a="0" b="0.08" c="0" d="0"/><elevation s="60" a="4.8" b="0.08" c="-0.002" d="0"/>'
    '<elevation s="100" a="4.8" b="-0.08" c="0" d="0"/>'
)
HERE = 15.0

Made = Callable[[str], Network]
Image = np.ndarray


@pytest.fixture
def made(tmp_path: Path) -> Made:
    """A straight road with solid lines on both sides and in the middle."""

    def make(elevation: str) -> Network:
        lanes = section(lane(1, WIDTH + SOLID), lane(-1, WIDTH + SOLID), centre=SOLID)
        profile = f"<elevationProfile>{elevation}</elevationProfile>"
        return network(tmp_path, road(length=400.0, lanes=lanes, more=profile))

    return make


def drawn(roads: Network, sky: object = CLEAR, s: float = HERE, camera: Camera | None = None, *boxes: Box) -> Drawing:
    return RoadCamera(scene_of(roads), camera).draw(roads.lane_pose("1", -1, s), boxes, sky)  # type: ignore[arg-type]


def grey(drawing: Drawing) -> Image:
    return np.asarray(drawing.image(1, 0).mean(axis=2))


def above(camera: Camera) -> int:
    """First row of the image that shows the plane below the vehicle."""
    return Lens(camera).top


def tone(drawing: Drawing, kind: Tag, near: float, far: float) -> float:
    """Return the mean brightness of a kind of ground between two depths, m, not next to another kind."""
    there = (drawing.semantic == kind) & (drawing.depth > near) & (drawing.depth < far)
    if kind is not Tag.ROAD_LINE:
        there = cv2.erode(there.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    assert there.sum() > 10
    return float(grey(drawing)[there].mean())


@pytest.mark.parametrize("size", [(512, 256), (1024, 512)])
def test_paint_is_drawn_where_the_road_climbs(made: Made, size: tuple[int, int]) -> None:
    camera = Camera(width=size[0], height=size[1])
    drawing = drawn(made(UPHILL), camera=camera)
    rows = slice(None, above(camera))
    line, asphalt = (drawing.semantic[rows] == tag for tag in (Tag.ROAD_LINE, Tag.ROAD))
    assert line.sum() > 100
    brightness = grey(drawing)[rows]
    assert brightness[line].mean() > brightness[asphalt].mean() + 60.0


@pytest.mark.parametrize("near", [30.0, 35.0, 50.0])
def test_fog_hides_a_road_uphill_by_its_own_distance(made: Made, near: float) -> None:
    level, uphill = (tone(drawn(made(hill), FOG), Tag.ROAD, near, near + 8.0) for hill in (FLAT, UPHILL))
    assert uphill == pytest.approx(level, abs=3.0)


def test_headlights_light_a_road_uphill_by_its_own_distance(made: Made) -> None:
    drawing = drawn(made(UPHILL), NIGHT)
    assert tone(drawing, Tag.ROAD, 45.0, 55.0) > tone(drawing, Tag.ROAD, 70.0, 90.0) + 1.0
    for near in (25.0, 45.0):
        level = tone(drawn(made(FLAT), NIGHT), Tag.ROAD, near, near + 10.0)
        assert tone(drawing, Tag.ROAD, near, near + 10.0) == pytest.approx(level, rel=0.25, abs=1.0)


def test_a_meadow_uphill_is_not_of_one_colour(made: Made) -> None:
    camera = Camera()
    drawing = drawn(made(UPHILL), camera=camera)
    there = (drawing.semantic == Tag.TERRAIN) & (drawing.depth < 60.0)
    there[above(camera) :] = False
    assert there.sum() > 500
    assert grey(drawing)[there].std() > 2.0


def test_a_road_uphill_is_wet_too(made: Made) -> None:
    camera = Camera()
    dry, wet = (drawn(made(UPHILL), sky, camera=camera) for sky in (CLEAR, weather("WetNoon")))
    there = dry.semantic == Tag.ROAD
    there[above(camera) :] = False
    there &= dry.depth > 60.0
    blue, red = (wet.image(1, 0)[there][:, k].astype(float).mean() for k in (0, 2))
    assert blue > red + 3.0  # it reflects the sky


def behind(roads: Network, s: float) -> Box:
    pose = roads.lane_pose("1", -1, s)
    return Box(pose.x, pose.y, pose.z, pose.heading, 4.4, 1.85, 1.45, pitch=pose.pitch)


@pytest.mark.parametrize("sky", ["ClearNoon", "ClearNight"])
def test_a_car_behind_a_crest_leaves_neither_shadow_nor_light_before_it(made: Made, sky: str) -> None:
    roads = made(CREST)
    alone, followed = (
        drawn(roads, weather(sky), 50.0, None, *boxes).image(1, 0) for boxes in ((), (behind(roads, 160.0),))
    )
    assert (alone == followed).all()


@pytest.mark.parametrize("s", [50.0, 60.0, 70.0])
def test_the_far_side_of_a_crest_does_not_show_through_the_near_one(made: Made, s: float) -> None:
    drawing = drawn(made(CREST), s=s)
    for column in (230, 300):
        road = np.isin(drawing.semantic[:, column], (Tag.ROAD, Tag.ROAD_LINE))
        assert road[int(np.flatnonzero(road)[0]) :].all()


def test_a_car_uphill_has_a_shadow(made: Made) -> None:
    roads, camera = made(UPHILL), Camera()
    alone, car = (drawn(roads, CLEAR, HERE, camera, *boxes) for boxes in ((), (behind(roads, 75.0),)))
    darker = grey(alone) - grey(car) > 8.0
    assert (darker & (car.instance == 0))[: above(camera)].sum() > 5


def test_the_texture_is_fixed_to_the_road_uphill(made: Made) -> None:
    """The same place of the meadow looks alike from two places of the road, where it leaves the vehicle's plane."""
    roads = made(UPHILL)
    near, far = (drawn(roads, CLEAR, s) for s in (40.0, 38.0))
    rows, columns = np.nonzero((near.semantic == Tag.TERRAIN) & (near.depth > 14.0) & (near.depth < 22.0))
    camera, view = near.view.camera, near.view
    rays = np.stack([(columns - camera.width / 2.0) / camera.focal, (rows - camera.height / 2.0) / camera.focal])
    ways = np.concatenate([rays, np.ones((1, len(rows)))]) * near.depth[rows, columns]
    there = far.view.to_image(far.view.to_camera(ways.T @ view.rotation + view.position))
    seen = cv2.remap(grey(far).astype(np.float32), there.astype(np.float32)[None], None, cv2.INTER_LINEAR)[0]  # type: ignore[call-overload]
    inside = (there > 1.0).all(axis=1) & (there[:, 0] < camera.width - 2) & (there[:, 1] < camera.height - 2)
    assert np.corrcoef(grey(near)[rows, columns][inside], seen[inside])[0, 1] > 0.7


@pytest.mark.parametrize("size", [(512, 256), (1024, 511), (901, 300)])
@pytest.mark.parametrize("sky", ["WetNoon", "MidRainyNight"])
def test_pictures_of_hills_are_equal_for_any_number_of_threads(made: Made, size: tuple[int, int], sky: str) -> None:
    roads, camera = made(UPHILL), Camera(width=size[0], height=size[1], roll=math.radians(3.0))
    before = cv2.getNumThreads()
    pictures = []
    try:
        for threads in (1, 2, 5):
            cv2.setNumThreads(threads)
            pictures.append(drawn(roads, weather(sky), HERE, camera, behind(roads, 50.0)).image(1, 0))
    finally:
        cv2.setNumThreads(before)
    assert all((pictures[0] == other).all() for other in pictures[1:])
