"""What stands on the road, in the picture: order, shadows, lamps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.models import Lamp
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.solids import REACH, Box, place
from tests.perception.scenery import CLEAR, bend, two_lanes, weather

STRAIGHT = bend(0.0)
HERE = STRAIGHT.pose(20.0)
CAR = Box(40.0, 0.0, 0.0, 0.0, 4.4, 1.85, 1.45, (30, 30, 210))
NIGHT = weather("ClearNight")


@pytest.fixture(scope="module")
def camera() -> RoadCamera:
    return RoadCamera(two_lanes(STRAIGHT), Camera(width=320, height=160))


def mean(image: np.ndarray, mask: np.ndarray) -> float:
    return float(image[mask].mean())


def test_only_boxes_before_the_camera_are_placed_the_farthest_first() -> None:
    boxes = [CAR._replace(x=x, instance=k) for k, x in enumerate((35.0, -10.0, 120.0, 20.0 + 1.5 * REACH, 60.0))]
    placed = place(Camera().view(HERE), boxes, REACH)
    assert [box.instance for box in placed.boxes] == [2, 4, 0]
    assert (np.diff(placed.level_distance) < 0.0).all()
    assert place(Camera(yaw=math.pi).view(HERE), boxes).boxes == [boxes[1]]
    assert place(Camera().view(HERE), []).boxes == []


def test_a_near_thing_hides_a_far_one_whatever_the_order(camera: RoadCamera) -> None:
    near, far = CAR._replace(instance=1), CAR._replace(x=55.0, height=3.0, kind="van", instance=2)
    for boxes in ([near, far], [far, near]):
        labels = camera.draw(HERE, boxes, CLEAR)
        alone = camera.draw(HERE, [near], CLEAR)
        assert ((labels.instance == 1) == (alone.instance == 1)).all()
        assert (labels.instance == 2).any()


def test_a_cab_hides_its_load_from_the_front_and_not_from_behind(camera: RoadCamera) -> None:
    truck = CAR._replace(length=9.0, width=2.5, height=3.4, kind="truck", colour=(20, 20, 200))
    for heading, shown in ((0.0, True), (math.pi, False)):
        image = camera.frame(HERE, [truck._replace(heading=heading)], CLEAR, 0.0, 0).astype(int)
        labels = camera.draw(HERE, [truck._replace(heading=heading)], CLEAR)
        own = labels.semantic == Tag.TRUCK
        glass = own & (np.abs(image - image.mean(axis=2, keepdims=True)).max(axis=2) < 25)
        rows = np.nonzero(own.any(axis=1))[0]
        middle = slice(rows[0] + (rows[-1] - rows[0]) * 3 // 10, rows[0] + (rows[-1] - rows[0]) // 2)
        assert (glass[middle].sum() > 40) == (not shown)


def test_a_thing_that_leans_is_drawn_leaning(camera: RoadCamera) -> None:
    level, leaning = (camera.draw(HERE, [CAR._replace(x=30.0, roll=roll)], CLEAR).instance > 0 for roll in (0.0, 0.3))
    left, right = slice(0, 160), slice(160, 320)
    assert np.argmax(leaning[:, left].any(axis=1)) < np.argmax(level[:, left].any(axis=1))
    assert np.argmax(leaning[:, right].any(axis=1)) >= np.argmax(leaning[:, left].any(axis=1))


def test_the_road_below_a_car_lies_in_its_shadow(camera: RoadCamera) -> None:
    """Paint does too; under clouds the shadow is weaker."""
    car = CAR._replace(x=30.0)
    for name in ("ClearNoon", "CloudyNoon"):
        sky = weather(name)
        empty, full = (camera.frame(HERE, boxes, sky, 0.0, 0).astype(int) for boxes in ([], [car]))
        shade = (camera.draw(HERE, [car], sky).instance == 0) & (full != empty).any(axis=2)
        assert shade.sum() > 30
        if name == "ClearNoon":
            clear = mean(full, shade) / mean(empty, shade)
    assert clear < 0.8
    assert clear < mean(full, shade) / mean(empty, shade) < 1.0


def test_lamps_are_on_by_default_in_the_dark_and_in_rain(camera: RoadCamera) -> None:
    car = CAR._replace(x=34.0)

    def red(name: str, lamps: Lamp) -> int:
        image = camera.frame(HERE, [car._replace(lamps=lamps, colour=(60, 60, 60))], weather(name), 0.0, 0).astype(int)
        return int((image[..., 2] - np.maximum(image[..., 0], image[..., 1])).max())

    assert red("ClearNight", Lamp.AUTOMATIC) > red("ClearNight", Lamp.NONE) + 100
    assert red("HardRainNoon", Lamp.AUTOMATIC) > red("HardRainNoon", Lamp.NONE) + 50
    assert red("ClearNoon", Lamp.AUTOMATIC) == red("ClearNoon", Lamp.NONE)
    assert red("ClearNoon", Lamp.AUTOMATIC | Lamp.BRAKE) > red("ClearNoon", Lamp.NONE) + 40


def test_things_come_into_sight_by_their_size_in_pixels() -> None:
    """At 320 pixels and 45 degrees, 2 pixels are a truck's height at 400 m and more, and a cone's at 135 m."""
    view = Camera(width=320, height=160).view(HERE)
    for kind, size, last in (
        ("truck", (9.0, 2.5, 3.4), 400.0),
        ("car", (4.4, 1.85, 1.45), 357.0),
        ("cone", (0.4, 0.4, 0.7), 200.0),
    ):
        there = [Box(HERE.x + away, HERE.y, 0.0, 0.0, *size, kind=kind) for away in (last - 5.0, last + 5.0)]  # type: ignore[arg-type]
        assert [box.x for box in place(view, there).boxes] == [there[0].x]


@pytest.mark.parametrize("away", [8.0, 15.0, 34.0, 60.0])
def test_a_motorbike_has_a_tail_lamp_above_its_rear_wheel_and_a_headlamp(camera: RoadCamera, away: float) -> None:
    bike = Box(HERE.x + away, HERE.y, 0.0, 0.0, 2.2, 0.8, 1.5, (60, 60, 60), "motorbike")
    lit, dark = (
        camera.frame(HERE, [bike._replace(lamps=lamps)], NIGHT, 0.0, 0).astype(int)
        for lamps in (Lamp.AUTOMATIC, Lamp.NONE)
    )
    own = camera.draw(HERE, [bike], NIGHT).instance == 1
    shines = ((lit - dark)[..., 2] > 60) & own
    assert shines.any()
    rows, columns = np.nonzero(shines)
    u, v = camera.view(HERE).to_image(camera.view(HERE).to_camera((bike.x - 1.0, bike.y, 0.7)))
    assert abs(rows.mean() - v) < 1.5
    assert abs(columns.mean() - u) < 1.5
    ahead = camera.frame(HERE, [bike._replace(heading=math.pi)], NIGHT, 0.0, 0).astype(int)
    assert ahead[own].max() > 200


def test_headlights_light_the_road(camera: RoadCamera) -> None:
    """Our own ahead of us and not beside us, and those of a car that comes towards us."""
    image = camera.frame(HERE, [], NIGHT, 0.0, 0).astype(float)
    u, v = camera.camera.project_ground([12.0, 12.0], [0.0, 9.0])
    ahead, beside = (image[round(y), min(max(round(x), 0), 319)].mean() for x, y in zip(u, v, strict=True))
    assert ahead > 2.0 * beside
    oncoming = CAR._replace(x=40.0, y=3.5, heading=math.pi)
    u, v = camera.camera.project_ground(13.0, 3.0)
    lit, dark = (
        camera.frame(HERE, [oncoming._replace(lamps=lamps)], NIGHT, 0.0, 0)[round(float(v)), round(float(u))].mean()
        for lamps in (Lamp.LOW_BEAM, Lamp.NONE)
    )
    assert lit > dark + 15.0


def test_oncoming_lamps_dazzle(camera: RoadCamera) -> None:
    """By day only the lamps themselves are brighter; in the dark what is about them too."""
    oncoming = CAR._replace(x=40.0, y=3.5, heading=math.pi)
    changed = {}
    for sky in (CLEAR, NIGHT):
        lit, dark = (
            camera.frame(HERE, [oncoming._replace(lamps=lamps)], sky, 0.0, 0).astype(int)
            for lamps in (Lamp.LOW_BEAM, Lamp.NONE)
        )
        own = camera.draw(HERE, [oncoming], sky).instance == 1
        changed[sky.preset] = int(((lit - dark).max(axis=2)[own] > 10).sum())
        assert lit[own].max() > 240
    assert changed["ClearNight"] > 1.3 * changed["ClearNoon"] > 0


def test_the_ego_is_seen_from_behind_and_hides_nothing_from_within() -> None:
    own = Box(HERE.x + 1.4, HERE.y, 0.0, 0.0, 4.4, 1.85, 1.45)
    scene, behind = two_lanes(STRAIGHT), Camera(width=320, height=160, x=-7.0, z=3.0, pitch=math.radians(-12.0))
    assert (RoadCamera(scene, behind).draw(HERE, [own], CLEAR).instance == 1).mean() > 0.05
    within = replace(behind, x=0.3, z=1.2, pitch=0.0)
    labels = RoadCamera(scene, within).draw(HERE, [own], CLEAR)
    assert (labels.instance[:90] == 0).all()
