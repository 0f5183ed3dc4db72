"""What weather puts between the lens and the scene: glare, mirror images, rain, drops."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.scene import Scene
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.weather_look import look_of
from tests.perception.scenery import CLEAR, bend, two_lanes, weather

STRAIGHT = bend(0.0)
HERE = STRAIGHT.pose(20.0)
CAMERA = Camera(width=320, height=160, pitch=0.0)
SUNSET = weather("ClearSunset")


@pytest.fixture(scope="module")
def scene() -> Scene:
    return two_lanes(STRAIGHT)


def test_the_sun_saturates_where_it_stands_and_dazzles_around(scene: Scene) -> None:
    """Also for a camera that is turned, tilted and rolled towards it."""
    sun = look_of(SUNSET)
    altitude = math.radians(sun.sun_altitude)
    direction = np.array([math.cos(altitude), 0.0, math.sin(altitude)])
    for camera in (replace(CAMERA, pitch=0.2), replace(CAMERA, yaw=0.2, pitch=0.15, roll=0.5)):
        towards = HERE._replace(heading=sun.sun_heading)
        image = RoadCamera(scene, camera).frame(towards, [], SUNSET, 0.0, 0)
        x, y, z = camera.rotation @ direction
        u, v = round(160 + camera.focal * x / z), round(80 + camera.focal * y / z)
        assert (image[v, u] == 255).all()
        assert image[v, u].min() > image[min(v + 40, 159), u].min()
        away = RoadCamera(scene, camera).frame(towards._replace(heading=sun.sun_heading + math.pi), [], SUNSET, 0.0, 0)
        assert image.mean() > away.mean() + 10


def test_there_is_no_glare_at_noon(scene: Scene) -> None:
    noon = look_of(CLEAR)
    camera = RoadCamera(scene, replace(CAMERA, pitch=math.radians(45.0)))
    image = camera.frame(HERE._replace(heading=noon.sun_heading), [], CLEAR, 0.0, 0)
    assert image.max() < 255


def test_a_wet_road_mirrors_the_lamps_of_the_car_ahead(scene: Scene) -> None:
    """Below the car, in its column, and not on a dry road; where we look at the road steeply it mirrors little."""
    car = Box(58.0, 0.0, 0.0, 0.0, 4.4, 1.85, 1.45, (40, 40, 40))
    redness = {}
    for name in ("WetNight", "ClearNight"):
        camera = RoadCamera(scene, CAMERA)
        with_car, without = (camera.frame(HERE, boxes, weather(name), 0.0, 0).astype(int) for boxes in ([car], []))
        own = camera.draw(HERE, [car], weather(name)).instance == 1
        rows, columns = np.nonzero(own)
        place = (slice(rows.max() + 2, rows.max() + 9), slice(columns.min(), columns.max() + 1))
        below, before = with_car[place], without[place]
        redness[name] = float(((below[..., 2] - below[..., 1]) - (before[..., 2] - before[..., 1])).max())
    assert redness["WetNight"] > redness["ClearNight"] + 5.0


def test_drops_stay_until_the_wiper_comes_and_streaks_do_not(scene: Scene) -> None:
    """A camera without a windscreen has none; with one, they are where they were an image before."""
    rain = weather("HardRainNoon")
    bare, glazed = (RoadCamera(scene, replace(CAMERA, windscreen=one), seed=5) for one in (False, True))
    drops = []
    for k in (10, 11):
        plain, behind = (camera.frame(HERE, [], rain, 0.0, k).astype(int) for camera in (bare, glazed))
        drops.append((plain != behind).any(axis=2))
    assert 0.002 < drops[0].mean() < 0.1
    assert (drops[0] & drops[1]).sum() > 0.7 * drops[0].sum()
    first, second = (bare.frame(HERE, [], rain, 0.0, k).astype(int) for k in (10, 11))
    assert (first != second).any(axis=2).mean() > 0.2


def test_more_rain_leaves_more_drops(scene: Scene) -> None:
    shares = []
    for name in ("ClearNoon", "SoftRainNoon", "MidRainyNoon", "HardRainNoon"):
        plain, behind = (
            RoadCamera(scene, replace(CAMERA, windscreen=one), seed=5).frame(HERE, [], weather(name), 0.0, 3)
            for one in (False, True)
        )
        shares.append(float((plain != behind).any(axis=2).mean()))
    assert shares == sorted(shares)
    assert shares[0] == 0.0 < shares[1] < shares[3]


def test_fog_hides_what_stands_far_beside_the_road_too(scene: Scene) -> None:
    """The veil is that of the distance, in every direction that a camera looks."""
    fog = CLEAR.model_copy(update={"fog_density": 60.0, "fog_distance": 0.0})
    box = Box(20.0, 60.0, 0.0, 0.0, 4.0, 4.0, 4.0, (0, 0, 255), "prop")
    left = RoadCamera(scene, replace(CAMERA, yaw=math.pi / 2), box_offset=0.0)
    strength = []
    for y in (15.0, 60.0):
        own = left.draw(HERE, [box._replace(y=y)], fog).instance == 1
        image = left.frame(HERE, [box._replace(y=y)], fog, 0.0, 0).astype(int)
        strength.append(float((image[own][:, 2] - image[own][:, 1]).mean()))
    assert strength[0] > 2.0 * strength[1] > 0.0
