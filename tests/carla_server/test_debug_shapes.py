"""What clients draw for debugging: cameras for colours see it, for as long as it lasts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.debug_shapes import DebugShapes
from tests.carla_server.conftest import STEP
from tests.carla_server.test_sensors import Listening, Spawn, pixels

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

MAGENTA = (255, 0, 255)
UP = 40.0
"""Height of a camera that looks down, m."""


def shown(image: Any) -> NDArray[np.bool_]:
    """Return which pixels of a picture are magenta."""
    return np.asarray((pixels(image)[..., :3] == MAGENTA).all(axis=2))


@pytest.fixture
def above(world: Any, spawn: Spawn) -> Any:
    """A place and a camera for colours that looks down on it: 8 pixels are a metre."""
    carla = pytest.importorskip("carla")
    place = world.get_map().get_spawn_points()[0].location
    mounted = carla.Transform(place + carla.Location(z=UP), carla.Rotation(pitch=-90.0))
    camera = Listening(spawn("sensor.camera.rgb", mounted, image_size_x=640, image_size_y=640, fov=90.0))
    yield carla, place, camera
    camera.sensor.stop()
    if hasattr(world.debug, "clear_debug_shape"):
        world.debug.clear_debug_shape()


def span(seen: NDArray[np.bool_]) -> tuple[int, int]:
    """Return over how many rows and columns pixels reach."""
    rows, columns = np.nonzero(seen)
    return int(np.ptp(rows)) + 1, int(np.ptp(columns)) + 1


def test_a_line_is_seen_for_its_life_time_where_it_is(world: Any, above: Any) -> None:
    carla, place, camera = above
    colour = carla.Color(255, 0, 255)
    begin, end = place + carla.Location(x=10.0, z=0.5), place + carla.Location(x=-10.0, z=0.5)
    world.debug.draw_line(begin, end, 0.5, colour, 2.5 * STEP)
    counts = []
    for _ in range(4):
        world.tick()
        counts.append(shown(camera.next()))
    assert [bool(one.any()) for one in counts] == [True, True, False, False]
    metre = 320.0 / (UP - 0.5)
    assert sorted(span(counts[0])) == pytest.approx(sorted((0.5 * metre, 20.0 * metre)), abs=2.1)


def test_one_of_a_steps_length_is_in_one_picture(world: Any, above: Any) -> None:
    carla, place, camera = above
    for _ in range(3):
        world.debug.draw_point(place + carla.Location(z=1.0), 2.0, carla.Color(255, 0, 255), STEP)
        world.tick()
        assert span(shown(camera.next())) == pytest.approx((2.0 * 320.0 / 39.0,) * 2, abs=2.1)
    world.tick()
    assert not shown(camera.next()).any()


def test_arrows_and_boxes_are_made_of_lines(world: Any, above: Any) -> None:
    carla, place, camera = above
    colour = carla.Color(255, 0, 255)
    tip = place + carla.Location(x=8.0, z=1.0)
    world.debug.draw_arrow(place + carla.Location(x=-8.0, z=1.0), tip, 0.2, 2.0, colour, STEP)
    world.tick()
    shaft, head = 16.0 * 320.0 / (UP - 1.0), 4.0 * 320.0 / (UP - 3.0)  # the upper barbs begin 2 m higher
    assert sorted(span(shown(camera.next()))) == pytest.approx(sorted((shaft, head)), abs=4.0)
    box = carla.BoundingBox(place + carla.Location(z=2.0), carla.Vector3D(6.0, 3.0, 1.0))
    world.debug.draw_box(box, carla.Rotation(yaw=90.0), 0.2, colour, STEP)
    world.tick()
    seen = shown(camera.next())
    metre = 320.0 / (UP - 3.0)
    assert span(seen) == pytest.approx((6.0 * metre, 12.0 * metre), rel=0.07)  # up in the picture is along x
    assert not seen[310:330, 310:330].any()


def test_nobody_sees_strings_and_depth_knows_no_line(world: Any, spawn: Spawn, above: Any) -> None:
    carla, place, camera = above
    mounted = camera.sensor.get_transform()
    depth = Listening(spawn("sensor.camera.depth", mounted, image_size_x=64, image_size_y=64))
    world.tick()
    before = pixels(depth.next()).copy()
    camera.next()
    world.debug.draw_string(place, "here", True, carla.Color(255, 0, 255), 10.0)
    world.tick()
    assert not shown(camera.next()).any()
    world.debug.draw_point(place + carla.Location(z=1.0), 4.0, carla.Color(255, 0, 255), STEP)
    depth.next()
    world.tick()
    assert shown(camera.next()).any()
    assert (pixels(depth.next()) == before).all()
    depth.sensor.stop()


def test_a_car_hides_what_is_below_it(world: Any, spawn: Spawn, above: Any) -> None:
    carla, place, camera = above
    car = spawn("vehicle.tesla.model3", 0)
    beside = place + carla.Location(y=4.0, z=0.1)
    line = (carla.Location(x=place.x, y=place.y, z=0.1), beside, 0.2, carla.Color(255, 0, 255), STEP)
    world.debug.draw_line(*line)
    world.tick()
    hidden = int(shown(camera.next()).sum())
    car.destroy()
    world.debug.draw_line(*line)
    world.tick()
    whole = int(shown(camera.next()).sum())
    assert 0 < hidden < 0.85 * whole


def test_what_is_permanent_lasts_until_it_is_cleared(world: Any, above: Any) -> None:
    carla, place, camera = above
    if not hasattr(world.debug, "clear_debug_shape"):
        return  # clients of 0.9.15 cannot clear
    for lasts in (0.0, -1.0):
        world.debug.draw_point(place + carla.Location(z=1.0), 2.0, carla.Color(255, 0, 255), lasts)
        for _ in range(5):
            world.tick()
            assert shown(camera.next()).any()
        world.debug.clear_debug_shape()
        world.tick()
        assert not shown(camera.next()).any()
    world.debug.draw_hud_point(place + carla.Location(z=1.0), 2.0, carla.Color(255, 0, 255), 1.0)
    world.tick()
    assert not shown(camera.next()).any()


def test_too_many_and_too_large_shapes_are_left_out() -> None:
    shapes = DebugShapes()
    box = [[3, [[[0.0] * 3, [1.0] * 3, [0.0] * 3, 0], [0.0] * 3, 0.1]], [1, 2, 3], 5.0, True]
    for _ in range(6000):
        shapes.add(box, 0.0)
    assert len(shapes.at(0.0)) == 60_000
    assert {one.colour for one in shapes.at(5.0)} == {(3, 2, 1)}
    assert shapes.at(5.1) == []
    with pytest.raises(CallError, match="out of bounds"):
        shapes.add([[0, [[0.0, 0.0, 1e30], 0.1]], [1, 2, 3], 5.0, True], 0.0)


def test_a_box_is_drawn_whatever_the_number_of_its_actor_is() -> None:
    """CARLA's client leaves it as it was in memory."""
    shapes = DebugShapes()
    shapes.add([[3, [[[0.0] * 3, [1.0] * 3, [0.0] * 3, 4_294_967_295], [0.0] * 3, 0.1]], [1, 2, 3], 5.0, True], 0.0)
    assert len(shapes.at(0.0)) == 12
