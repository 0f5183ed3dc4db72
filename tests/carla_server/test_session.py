"""CARLA's own client talks to the server: versions, maps, settings, ticks, weather."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from tests.carla_server.conftest import STEP, Served, served

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

MAPS = Path(__file__).parents[2] / "maps"


def test_both_have_the_same_version(server: Served, client_version: str) -> None:
    assert server.client().get_server_version() == client_version


def test_it_serves_the_maps_that_there_are(server: Served) -> None:
    names = server.client().get_available_maps()
    assert "/Game/Carla/Maps/town_grid" in names
    assert "/Game/Carla/Maps/highway_loop" in names


def test_the_map_is_ours_with_every_lane(world: Any) -> None:
    map_ = world.get_map()
    assert map_.name == "Carla/Maps/town_grid"
    assert len(map_.get_topology()) > 50
    for point in map_.get_spawn_points():
        way = map_.get_waypoint(point.location, project_to_road=False)
        assert way is not None
        turned = (way.transform.rotation.yaw - point.rotation.yaw + 180.0) % 360.0 - 180.0
        assert abs(turned) < 1.0


def test_the_longest_vehicles_fit_on_all_spawn_points(server: Served, world: Any) -> None:
    import carla

    longest = world.get_blueprint_library().find("vehicle.mitsubishi.fusorosa")
    points = world.get_map().get_spawn_points()
    answers = server.client().apply_batch_sync([carla.command.SpawnActor(longest, point) for point in points], True)
    assert len(points) > 100
    assert {one.error for one in answers} == {""}


def test_ticks_have_the_step_that_is_set(world: Any) -> None:
    frames = []
    for _ in range(5):
        frame = world.tick()
        snapshot = world.get_snapshot()
        assert snapshot.frame == frame
        assert snapshot.delta_seconds == pytest.approx(STEP)
        frames.append((frame, snapshot.elapsed_seconds))
    assert [one[0] for one in frames] == list(range(frames[0][0], frames[0][0] + 5))
    assert frames[-1][1] - frames[0][1] == pytest.approx(4 * STEP)


def test_in_asynchronous_mode_it_ticks_by_itself(server: Served) -> None:
    world = server.client().get_world()
    first, second = world.wait_for_tick(), world.wait_for_tick()
    assert second.frame > first.frame
    settings = world.get_settings()
    settings.fixed_delta_seconds = 0.02
    world.apply_settings(settings)
    assert world.wait_for_tick().delta_seconds == pytest.approx(0.02)
    settings.fixed_delta_seconds = None
    world.apply_settings(settings)


def test_a_step_of_nothing_does_not_stop_the_clock(server: Served) -> None:
    world = server.client().get_world()
    settings = world.get_settings()
    settings.fixed_delta_seconds = 0.0
    world.apply_settings(settings)
    assert world.wait_for_tick().delta_seconds > 0.0


def test_settings_come_back(world: Any) -> None:
    settings = world.get_settings()
    assert settings.synchronous_mode
    assert settings.fixed_delta_seconds == pytest.approx(STEP)
    settings.no_rendering_mode = True
    world.apply_settings(settings)
    assert world.get_settings().no_rendering_mode
    settings.no_rendering_mode = False
    world.apply_settings(settings)


def test_the_weather_comes_back(world: Any) -> None:
    import carla

    world.set_weather(carla.WeatherParameters.HardRainSunset)
    assert world.get_weather() == carla.WeatherParameters.HardRainSunset
    world.set_weather(carla.WeatherParameters.ClearNoon)


def test_a_map_is_loaded_and_begins_without_anybody(server: Served, spawn: Any) -> None:
    spawn("vehicle.audi.tt")
    client = server.client()
    world = client.load_world("highway_loop")
    assert world.get_map().name == "Carla/Maps/highway_loop"
    assert not world.get_settings().synchronous_mode
    assert list(world.get_actors().filter("vehicle.*")) == []
    assert client.load_world("town_grid_Opt").get_map().name == "Carla/Maps/town_grid_Opt"
    assert client.load_world("town_grid").get_map().name == "Carla/Maps/town_grid"


def test_a_new_episode_does_not_use_ids_again(server: Served, world: Any, spawn: Any) -> None:
    """A client keeps what it knows of an id: it would take an actor for the one that had its id before."""
    car = spawn("vehicle.audi.tt")
    world.tick()
    before = {actor.id for actor in world.get_actors()}
    assert car.id in before
    assert not before & {actor.id for actor in server.client().reload_world(False).get_actors()}


def test_maps_are_loaded_again_and_again(server: Served) -> None:
    """The client's process used to end here, one time in six."""
    client = server.client()
    for name in ("highway_loop", "town_grid") * 5:
        world = client.load_world(name)
        settings = world.get_settings()
        settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
        world.apply_settings(settings)
        assert world.tick() < world.tick()
    settings.synchronous_mode, settings.fixed_delta_seconds = False, None
    world.apply_settings(settings)


def test_maps_that_cannot_be_driven_on_are_not_listed(server: Served) -> None:
    client = server.client()
    assert not any("open_ground" in name for name in client.get_available_maps())
    assert client.load_world("open_ground").get_map().name == "Carla/Maps/open_ground"
    client.load_world("town_grid")


def test_a_reloaded_world_can_keep_its_settings(server: Served, world: Any) -> None:
    again = server.client().reload_world(False)
    assert again.id != world.id
    assert again.get_settings().synchronous_mode
    assert again.get_settings().fixed_delta_seconds == pytest.approx(STEP)


def test_a_map_that_is_not_there_is_refused_by_name(server: Served) -> None:
    with pytest.raises(RuntimeError, match=r"map 'Atlantis' not found; there are .*town_grid"):
        server.client().load_world("Atlantis")
    with pytest.raises(RuntimeError, match="not found"):
        server.client().load_world("../../../etc/passwd")


def test_a_world_is_generated_from_a_clients_own_map(server: Served) -> None:
    client = server.client()
    text = (MAPS / "highway_loop" / "highway_loop.xodr").read_text(encoding="utf-8")
    world = client.generate_opendrive_world(text)
    assert world.get_map().name == "Carla/Maps/OpenDriveMap"
    assert len(world.get_map().get_spawn_points()) > 5
    with pytest.raises(RuntimeError, match="OpenDriveMap"):
        client.generate_opendrive_world("<OpenDRIVE><road/></OpenDRIVE>")
    assert client.load_world("town_grid").get_map().name == "Carla/Maps/town_grid"


CREST = """<?xml version="1.0"?><OpenDRIVE><header revMajor="1" revMinor="4" name="crest"/>
<road name="" length="200" id="1" junction="-1"><link/>
<planView><geometry s="0" x="0" y="0" hdg="0" length="200"><line/></geometry></planView>
<elevationProfile><elevation s="0" a="0" b="0.2" c="-0.001" d="0"/></elevationProfile>
<lanes><laneSection s="0"><center><lane id="0" type="none" level="false"/></center>
<right><lane id="-1" type="driving" level="false"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right>
</laneSection></lanes></road></OpenDRIVE>"""
"""A road over a hilltop: under a car it leans otherwise than under the axle behind its middle."""


def test_cars_lean_as_their_spawn_points_until_they_stand_on_the_road(server: Served) -> None:
    import carla

    client = server.client()
    world = client.generate_opendrive_world(CREST)
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
    world.apply_settings(settings)
    model, points = world.get_blueprint_library().find("vehicle.tesla.model3"), world.get_map().get_spawn_points()
    assert max(point.rotation.pitch for point in points) > 5.0 > -5.0 > min(point.rotation.pitch for point in points)
    ids = [
        one.actor_id
        for one in client.apply_batch_sync([carla.command.SpawnActor(model, point) for point in points], True)
    ]
    sensor = world.get_blueprint_library().find("sensor.other.imu")
    carried = [
        one.actor_id
        for one in client.apply_batch_sync(
            [carla.command.SpawnActor(sensor, carla.Transform(), number) for number in ids], True
        )
    ]

    def sensors_lean_with_their_cars() -> bool:
        snapshot = world.get_snapshot()
        pitches = [[snapshot.find(one).get_transform().rotation.pitch for one in group] for group in (ids, carried)]
        return all(abs(car - on_it) < 0.001 for car, on_it in zip(*pitches, strict=True))

    def away() -> float:
        snapshot = world.get_snapshot()
        found = 0.0
        for number, point in zip(ids, points, strict=True):
            at = snapshot.find(number).get_transform()
            found = max(found, abs(at.rotation.pitch - point.rotation.pitch), abs(at.location.x - point.location.x))
        return found

    world.tick()
    assert away() < 0.005
    assert sensors_lean_with_their_cars()
    for _ in range(10):
        world.tick()
        assert sensors_lean_with_their_cars()
    assert 0.05 < away() < 0.5
    settings.synchronous_mode, settings.fixed_delta_seconds = False, None
    world.apply_settings(settings)
    client.load_world("town_grid")


def test_it_says_what_it_cannot_be_started_with(tmp_path: Path) -> None:
    import subprocess
    import sys

    def run(*arguments: str) -> tuple[int, str]:
        command = [sys.executable, "-m", "scenario_compiler", "serve-carla", *arguments]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        return done.returncode, done.stderr

    code, told = run("--map", "town_gird")
    assert (code, "did you mean 'town_grid'" in told.lower() or "town_grid" in told) == (2, True)
    assert run("--port", "70000")[0] == 2
    with served(tmp_path) as running:
        code, told = run("--port", str(running.port))
        assert code == 2
        assert "cannot listen" in told
