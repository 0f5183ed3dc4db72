"""Recordings: made, told of, played, and kept below the served folder."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from tests.carla_server.conftest import Served

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

Spawn = Callable[..., Any]


def record(server: Served, world: Any, spawn: Spawn, name: str) -> tuple[Any, list[Any]]:
    """Record a car that runs into another; return it and where it was."""
    import carla

    client = server.client()
    car = spawn("vehicle.audi.tt", role_name="hero")
    world.tick()
    at = car.get_transform()
    way = at.get_forward_vector()
    place = carla.Transform(at.location + carla.Location(way.x * 12.0, way.y * 12.0, 0.2), at.rotation)
    spawn("vehicle.tesla.model3", place)
    assert name in client.start_recorder(name)
    car.set_target_velocity(carla.Vector3D(way.x * 8.0, way.y * 8.0, 0.0))
    where = []
    for _ in range(40):
        world.tick()
        where.append(car.get_transform())
    client.stop_recorder()
    client.get_server_version()  # nobody waits for the answer to the call before; this client's calls are in order
    world.tick()
    return car, where


def test_a_recording_tells_who_was_there_and_who_met(server: Served, world: Any, spawn: Spawn) -> None:
    car, _ = record(server, world, spawn, "met.log")
    client = server.client()
    told = client.show_recorder_file_info("met.log", False)
    assert "Map: town_grid" in told
    assert f"Create {car.id}: vehicle.audi.tt" in told
    assert "role_name = hero" in told
    frames = int(told.partition("Frames: ")[2].split()[0])
    assert frames in (40, 41)  # nobody waits for the answer to the call that ends it
    step = world.get_settings().fixed_delta_seconds
    assert "\nFrame 1 at 0 seconds\n" in told
    assert float(told.partition("Duration: ")[2].split()[0]) == pytest.approx((frames - 1) * step, abs=1e-3)
    met = client.show_recorder_collisions("met.log", "h", "v")
    assert "vehicle.audi.tt" in met
    assert "vehicle.tesla.model3" in met
    assert "vehicle" not in client.show_recorder_collisions("met.log", "w", "a")
    assert "vehicle.tesla.model3" in client.show_recorder_actors_blocked("met.log", 0.5, 10.0)


def test_a_recording_is_played_where_it_was(server: Served, world: Any, spawn: Spawn) -> None:
    car, where = record(server, world, spawn, "played.log")
    for actor in world.get_actors().filter("vehicle.*"):
        actor.destroy()
    world.tick()
    client = server.client()
    assert "Replaying" in client.replay_file("played.log", 0.0, 0.0, 0)
    for k in range(10):
        world.tick()
        played = world.get_actors().filter("vehicle.audi.tt")[0]
        assert played.get_transform().location.distance(where[k + 1].location) < 0.05
    client.stop_replayer(False)
    client.get_server_version()  # this client's calls are in order
    world.tick()
    assert len(world.get_actors().filter("vehicle.*")) == 2  # the recording destroys neither
    del car


def replayed(server: Served, world: Any, name: str, follow: int = 0) -> Any:
    """Play a recording from its beginning; return the client, whose calls are in order."""
    client = server.client()
    assert "Replaying" in client.replay_file(name, 0.0, 0.0, follow)
    return client


def test_a_body_that_is_played_has_its_id_and_a_spectator_follows_it(server: Served, world: Any, spawn: Spawn) -> None:
    car, where = record(server, world, spawn, "same.log")
    number = car.id
    for actor in world.get_actors().filter("vehicle.*"):
        actor.destroy()
    world.tick()
    client = replayed(server, world, "same.log", number)
    for _ in range(10):
        world.tick()
    played = world.get_actor(number)
    assert played.get_location().distance(where[10].location) < 0.05
    away = world.get_spectator().get_transform()
    behind = played.get_transform()
    way = behind.get_forward_vector()
    assert away.location.x - behind.location.x == pytest.approx(-10.0 * way.x, abs=0.1)
    assert away.location.y - behind.location.y == pytest.approx(-10.0 * way.y, abs=0.1)
    assert away.location.z - behind.location.z == pytest.approx(5.0, abs=0.1)
    client.stop_replayer(True)
    client.get_server_version()


def test_bodies_that_are_still_there_are_played_and_driven_again_afterwards(
    server: Served, world: Any, spawn: Spawn
) -> None:
    import carla

    car, where = record(server, world, spawn, "there.log")
    numbers = {actor.id for actor in world.get_actors().filter("vehicle.*")}
    replayed(server, world, "there.log")
    for _ in range(5):
        world.tick()
    assert {actor.id for actor in world.get_actors().filter("vehicle.*")} == numbers
    assert car.get_location().distance(where[5].location) < 0.05
    for _ in range(60):
        world.tick()
    assert car.get_velocity().length() == pytest.approx(0.0, abs=0.01)
    begin = car.get_location()
    car.apply_control(carla.VehicleControl(throttle=1.0, reverse=True))
    for _ in range(20):
        world.tick()
    assert car.get_location().distance(begin) > 0.5


def test_pace_and_hero_are_set_before_a_recording_is_played(server: Served, world: Any, spawn: Spawn) -> None:
    """As CARLA's start_replaying.py does."""
    car, where = record(server, world, spawn, "pace.log")
    client = server.client()
    client.set_replayer_time_factor(2.0)
    client.replay_file("pace.log", 0.0, 0.0, 0)
    for _ in range(5):
        world.tick()
    assert car.get_location().distance(where[10].location) < 0.05
    client.set_replayer_time_factor(1.0)
    client.set_replayer_ignore_hero(True)
    before = car.get_location()
    client.replay_file("pace.log", 0.0, 0.0, 0)
    for _ in range(5):
        world.tick()
    assert car.get_location().distance(before) < 0.5
    client.set_replayer_ignore_hero(False)
    client.stop_replayer(True)
    client.get_server_version()


@pytest.mark.parametrize("name", ["/etc/passwd", "../away.log", "a/../../away.log", ""])
def test_nothing_is_written_or_read_outside_the_served_folder(server: Served, name: str) -> None:
    client = server.client()
    refused = r"not below the served folder|has no name"
    with pytest.raises(RuntimeError, match=refused):
        client.start_recorder(name)
    with pytest.raises(RuntimeError, match=refused):
        client.show_recorder_file_info(name, False)
    with pytest.raises(RuntimeError, match=refused):
        client.replay_file(name, 0.0, 0.0, 0)
    assert not (server.files.parent / "away.log").exists()


def test_a_file_that_is_not_a_recording_is_refused(server: Served) -> None:
    (server.files / "text.log").write_text("nothing of ours", encoding="utf-8")
    with pytest.raises(RuntimeError, match="is not a recording of this server"):
        server.client().show_recorder_file_info("text.log", False)


def test_of_a_file_that_is_not_there_a_text_tells(server: Served) -> None:
    """As in CARLA: no error."""
    client = server.client()
    told = (
        client.show_recorder_file_info("absent.log", True),
        client.show_recorder_collisions("absent.log", "a", "a"),
        client.show_recorder_actors_blocked("absent.log", 1.0, 1.0),
        client.replay_file("absent.log", 0.0, 0.0, 0),
    )
    assert set(told) == {"File absent.log not found on server\n"}


def test_a_recording_is_kept_when_another_map_is_loaded(server: Served, world: Any, spawn: Spawn) -> None:
    client = server.client()
    spawn("vehicle.audi.tt")
    client.start_recorder("before.log")
    for _ in range(5):
        world.tick()
    client.reload_world(False)
    assert "vehicle.audi.tt" in client.show_recorder_file_info("before.log", False)


def test_where_nothing_can_be_written_no_recording_begins(server: Served, world: Any) -> None:
    (server.files / "text").write_text("no folder")
    client = server.client()
    with pytest.raises(RuntimeError, match="cannot be written"):
        client.start_recorder("text/within.log")
    world.tick()
