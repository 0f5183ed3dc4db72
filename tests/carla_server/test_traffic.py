"""Traffic lights of a map, and CARLA's own Traffic Manager, which drives through the server."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from tests.carla_server.conftest import STEP, Served, free_port, served_map

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

MAPS = Path(__file__).parents[2] / "maps"


def lit_town() -> bytes:
    """Return town_grid with a light for each arm of each junction of four arms, each arm a controller of its own."""
    root = etree.parse(MAPS / "town_grid" / "town_grid.xodr").getroot()
    roads = {str(road.get("id")): road for road in root.iterfind("road")}
    first = next(root.iterfind("junction"))
    numbers = iter(range(9000, 9999))
    for junction in root.iterfind("junction"):
        arms = sorted({str(connection.get("incomingRoad")) for connection in junction.iterfind("connection")})
        if len(arms) != 4:
            continue
        for arm in arms:
            road, number = roads[arm], str(next(numbers))
            after = road.find("link/successor")
            ends = after is not None and after.get("elementId") == junction.get("id")
            s, side = (float(str(road.get("length"))) - 1.0, -1) if ends else (1.0, 1)
            signals = road.find("signals")
            signals = etree.SubElement(road, "signals") if signals is None else signals
            signal = etree.SubElement(
                signals, "signal", id=number, name="light", s=str(s), t=str(4.0 * side), dynamic="yes",
                orientation="+" if ends else "-", zOffset="3", country="OpenDRIVE", type="1000001", subtype="-1",
                value="-1", hOffset="0", pitch="0", roll="0", height="1", width="0.5",
            )  # fmt: skip
            etree.SubElement(signal, "validity", fromLane=str(side), toLane=str(side))
            controller = etree.Element("controller", id=f"1{number}", name=f"arm {arm}", sequence="0")
            etree.SubElement(controller, "control", signalId=number, type="0")
            first.addprevious(controller)
            etree.SubElement(junction, "controller", id=f"1{number}", type="0")
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8"))


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, client_version: str) -> Iterator[Served]:
    with served_map(tmp_path_factory.mktemp("lit"), "lit_town", lit_town(), client_version) as running:
        yield running


@pytest.fixture
def lights(world: Any) -> Iterator[list[Any]]:
    """All lights of the map; afterwards they have the times that they had, and begin again."""
    lights = list(world.get_actors().filter("traffic.traffic_light"))
    times = [(light.get_green_time(), light.get_yellow_time(), light.get_red_time()) for light in lights]
    yield lights
    for light, (green, yellow, red) in zip(lights, times, strict=True):
        light.set_green_time(green)
        light.set_yellow_time(yellow)
        light.set_red_time(red)
    world.freeze_all_traffic_lights(False)
    world.reset_all_traffic_lights()


def test_each_traffic_light_has_a_box_about_its_lamps(world: Any) -> None:
    """The file has 3 m above the road for the lower edge of its lamps, and 1 m for their height."""
    import carla

    lights = world.get_actors().filter("traffic.traffic_light")
    assert len(world.get_level_bbs(carla.CityObjectLabel.TrafficLight)) == len(lights) > 0
    for light in lights:
        (box,) = light.get_light_boxes()
        at = light.get_transform().location
        assert math.hypot(box.location.x - at.x, box.location.y - at.y) < 0.5
        low, high = box.location.z - box.extent.z, box.location.z + box.extent.z
        assert high - low == pytest.approx(1.0, abs=0.05)
        assert low == pytest.approx(at.z, abs=0.01)


def test_lights_stand_in_groups_and_switch_by_their_times(world: Any, lights: list[Any]) -> None:
    import carla

    assert len(lights) == 8
    one = lights[0]
    group = one.get_group_traffic_lights()
    assert len(group) == 4
    assert {light.get_opendrive_id() for light in lights} == {str(9000 + k) for k in range(8)}
    for light in lights:
        light.set_green_time(1.0)
        light.set_yellow_time(0.5)
        light.set_red_time(0.5)
    world.reset_all_traffic_lights()
    shown = []
    for _ in range(4 * 40):
        world.tick()
        shown.append(tuple(light.state for light in group))
    greens = [sum(state == carla.TrafficLightState.Green for state in states) for states in shown]
    assert max(greens) == 1
    assert {k for states in shown for k, state in enumerate(states) if state == carla.TrafficLightState.Green} == {
        0, 1, 2, 3
    }  # fmt: skip
    assert greens.count(1) == pytest.approx(80, abs=4)


def test_a_light_can_be_set_and_frozen(world: Any, lights: list[Any]) -> None:
    import carla

    one = lights[0]
    world.freeze_all_traffic_lights(True)
    one.set_state(carla.TrafficLightState.Yellow)
    for _ in range(100):
        world.tick()
    assert one.state == carla.TrafficLightState.Yellow
    assert one.is_frozen()


def test_a_car_before_a_light_is_at_it(world: Any, spawn: Any, lights: list[Any]) -> None:
    import carla

    one = lights[0]
    way = one.get_stop_waypoints()[0].previous(6.0)[0].transform
    car = spawn("vehicle.audi.tt", carla.Transform(way.location + carla.Location(z=0.3), way.rotation))
    world.freeze_all_traffic_lights(True)
    one.set_state(carla.TrafficLightState.Red)
    world.tick()
    world.tick()
    assert car.is_at_traffic_light()
    assert car.get_traffic_light().id == one.id
    assert car.get_traffic_light_state() == carla.TrafficLightState.Red
    assert car.get_speed_limit() == pytest.approx(50.0)


@pytest.mark.parametrize(("before", "at"), [(3.0, True), (6.4, True), (7.0, False), (16.0, False)])
def test_a_car_is_at_a_light_where_its_box_touches_the_area_before_the_line(
    world: Any, spawn: Any, lights: list[Any], before: float, at: bool
) -> None:
    """The area reaches from 4.5 m to 1.5 m before the line, as CARLA's does; a car of 4.18 m begins 2.09 m further."""
    import carla

    way = lights[0].get_stop_waypoints()[0].previous(before)[0].transform
    ahead = way.get_forward_vector()
    line = lights[0].get_stop_waypoints()[0].transform.location
    gone = (line.x - way.location.x) * ahead.x + (line.y - way.location.y) * ahead.y
    assert gone == pytest.approx(before, abs=0.05)
    car = spawn("vehicle.audi.tt", carla.Transform(way.location + carla.Location(z=0.3), way.rotation))
    world.tick()
    assert car.is_at_traffic_light() is at


def crossed(one: Any, before: Any, now: Any) -> bool:
    """Return whether a car's middle has gone over the stop line of a light in a step."""
    for stop in one.get_stop_waypoints():
        at, ahead = stop.transform.location, stop.transform.get_forward_vector()
        along = [(p.x - at.x) * ahead.x + (p.y - at.y) * ahead.y for p in (before, now)]
        if along[0] < 0.0 <= along[1] and now.distance(at) < 2.5:
            return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("cars", [20])
def test_the_traffic_manager_drives_for_a_minute(server: Served, world: Any, lights: list[Any], cars: int) -> None:
    import carla

    client, port = server.client(), free_port()
    manager = client.get_trafficmanager(port)
    manager.set_synchronous_mode(True)
    manager.set_random_device_seed(7)
    library, points = world.get_blueprint_library(), world.get_map().get_spawn_points()
    command = carla.command
    autopilot = command.SetAutopilot(command.FutureActor, True, port)
    spawning = [
        command.SpawnActor(library.find("vehicle.tesla.model3"), points[k * len(points) // cars]).then(autopilot)
        for k in range(cars)
    ]
    ids = [one.actor_id for one in client.apply_batch_sync(spawning, True)]
    assert all(ids)
    driven, off, ran = dict.fromkeys(ids, 0.0), 0, []
    before: dict[int, Any] = {}
    red = {light.id: False for light in lights}
    for tick in range(int(60.0 / STEP)):
        world.tick()
        snapshot = world.get_snapshot()
        for number in ids:
            at = snapshot.find(number).get_transform().location
            if number in before:
                driven[number] += at.distance(before[number])
                ran += [number for light in lights if red[light.id] and crossed(light, before[number], at)]
            before[number] = at
            if tick % 20 == 0:
                off += world.get_map().get_waypoint(at, project_to_road=False) is None
        red = {light.id: light.state == carla.TrafficLightState.Red for light in lights}
    manager.set_synchronous_mode(False)
    manager.shut_down()
    assert sum(driven.values()) / cars > 100.0
    assert off == 0
    assert ran == []


def test_cars_stand_as_their_spawn_points_do(server: Served, world: Any) -> None:
    import carla

    points = world.get_map().get_spawn_points()
    model = world.get_blueprint_library().find("vehicle.tesla.model3")
    answers = server.client().apply_batch_sync([carla.command.SpawnActor(model, one) for one in points], True)
    snapshot = world.get_snapshot()
    for answer, point in zip(answers, points, strict=True):
        at = snapshot.find(answer.actor_id).get_transform()
        for axis in ("x", "y"):
            assert getattr(at.location, axis) == pytest.approx(getattr(point.location, axis), abs=0.01)
        for angle in ("pitch", "yaw", "roll"):
            assert getattr(at.rotation, angle) == pytest.approx(getattr(point.rotation, angle), abs=0.01)


def test_managed_cars_heed_the_lights_of_a_crossing_that_its_arms_come_back_to(server: Served) -> None:
    """The client follows such arms in the map as it is served, and no junction of the file names its controllers."""
    import carla

    client, port = server.client(), free_port()
    world = client.load_world("signal_crossing")
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, STEP
    world.apply_settings(settings)
    manager = client.get_trafficmanager(port)
    manager.set_synchronous_mode(True)
    manager.set_random_device_seed(3)
    points, model = world.get_map().get_spawn_points(), world.get_blueprint_library().find("vehicle.tesla.model3")
    cars = [world.spawn_actor(model, point) for point in points[::17]]
    world.tick()
    for car in cars:
        car.set_autopilot(True, port)
    town, shown, stopped, entered = world.get_map(), dict[int, Any](), 0, 0
    for _ in range(1200):
        world.tick()
        for car in cars:
            at, speed = car.get_location(), car.get_velocity().length()
            before, now = shown.get(car.id), car.get_traffic_light_state() if car.is_at_traffic_light() else None
            stopped += now == carla.TrafficLightState.Red and speed < 0.1
            entered += before is not None and now is None
            assert not (before == carla.TrafficLightState.Red and now is None and speed > 1.0), "a red light was run"
            shown[car.id] = now
            lane = town.get_waypoint(at).transform.location
            assert math.hypot(lane.x - at.x, lane.y - at.y) < 1.6, "a car has left its lane"
    assert stopped > 50
    assert entered > 3
    manager.set_synchronous_mode(False)
    manager.shut_down()
    client.load_world("lit_town")
