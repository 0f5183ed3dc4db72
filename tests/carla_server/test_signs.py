"""Stop and yield signs of a map: what they let vehicles see, and how CARLA's own Traffic Manager waits at them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from scenario_compiler.carla_server.areas import Box
from scenario_compiler.carla_server.signals import Signals
from scenario_compiler.carla_server.signs import SignRules, signs_of
from scenario_compiler.carla_server.traffic_lights import GREEN, RED, groups_of
from scenario_compiler.roads import Network, load_network
from tests.carla_server.conftest import STEP, Served, free_port, served_map
from tests.work import counted

pytestmark = pytest.mark.apart

MAPS = Path(__file__).parents[2] / "maps"
STOP, YIELD = "12", "22"
"""Signals of signal_crossing that become signs: on the northern arm and on the southern one."""


def refer(root: etree._Element, road: str, number: str) -> None:
    """Add references to a sign to the roads of the junction that begin at the end of its road."""
    for way in root.iterfind("road"):
        before = way.find("link/predecessor")
        if way.get("junction") == "-1" or before is None:
            continue
        if (before.get("elementId"), before.get("contactPoint")) == (road, "end"):
            signals = etree.SubElement(way, "signals")
            reference = etree.SubElement(signals, "signalReference", s="0", t="-5", id=number, orientation="+")
            etree.SubElement(reference, "validity", fromLane="-1", toLane="-1")


def signed_crossing() -> bytes:
    """Return signal_crossing with a stop sign in the north and a yield sign in the south, both for the junction."""
    root = etree.parse(MAPS / "signal_crossing" / "signal_crossing.xodr").getroot()
    for one in (root, *root.iterfind("junction")):
        for controller in list(one.iterfind("controller")):
            one.remove(controller)
    for road in root.iterfind("road"):
        for signals in road.iterfind("signals"):
            for one in list(signals):
                number = str(one.get("id"))
                if number not in (STOP, YIELD):
                    signals.remove(one)
                    continue
                one.set("type", "206" if number == STOP else "205")
                one.set("dynamic", "no")
                refer(root, str(road.get("id")), number)
    limited = next(root.iterfind("road"))
    objects = limited.find("objects")
    objects = etree.SubElement(limited, "objects") if objects is None else objects
    etree.SubElement(
        objects, "object", id="90", name="Speed_60", s="100", t="-6", zOffset="0.1", hdg="0.2", orientation="+"
    )  # fmt: skip
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8"))


@pytest.fixture(scope="module")
def network(tmp_path_factory: pytest.TempPathFactory) -> Network:
    path = tmp_path_factory.mktemp("signs") / "signed_crossing.xodr"
    path.write_bytes(signed_crossing())
    return load_network(path, cache=False)


def car(network: Network, road: str, lane: int, s: float) -> Box:
    """Return the box of a car whose middle is on a lane."""
    pose = network.lane_pose(road, lane, s)
    return Box(pose.x, pose.y, pose.z, pose.heading, 4.2, 2.0, 1.4)


def ends(network: Network, road: str, before: float) -> tuple[str, int, float]:
    return road, -1, network.road(road).length - before


def rules_of(network: Network) -> SignRules:
    signals = Signals(network)
    return SignRules(signals, signs_of(signals))


def seen(rules: SignRules, cars: dict[int, Box], times: list[float]) -> dict[int, list[int]]:
    """Return what each car has seen last at some times, GREEN before any sign; a step takes 0.1 s."""
    shown: dict[int, int] = dict.fromkeys(cars, GREEN)
    found: dict[int, list[int]] = {number: [] for number in cars}
    for k in range(round(times[-1] * 10) + 1):
        shown.update(rules.step(k / 10, cars.items()))
        if k / 10 in times:
            for number, state in shown.items():
                found[number].append(state)
    return found


@pytest.mark.parametrize(("road", "shown"), [("1", [RED, RED, GREEN]), ("2", [GREEN, GREEN, GREEN])])
def test_a_stop_sign_shows_red_for_two_seconds_and_a_yield_sign_nothing(
    network: Network, road: str, shown: list[int]
) -> None:
    cars = {1: car(network, *ends(network, road, 5.0))}
    assert seen(rules_of(network), cars, [0.0, 1.9, 2.0]) == {1: shown}


@pytest.mark.parametrize("before", [1.0, 9.0])
def test_a_vehicle_is_at_a_sign_only_where_its_box_touches_the_area_before_the_line(
    network: Network, before: float
) -> None:
    """The area reaches from 4.5 m to 1.5 m before the line, so the middle of a car of 4.2 m from 6.6 m on."""
    found = seen(rules_of(network), {1: car(network, *ends(network, "1", before))}, [0.5])
    assert found == {1: [RED if before < 6.6 else GREEN]}


@pytest.mark.parametrize("road", ["1", "2"])
def test_signs_show_red_while_another_vehicle_crosses(network: Network, road: str) -> None:
    """From east to west, in the middle of the junction, which both signs' ways cross."""
    across = next(one for one in network.road_ids if one.startswith("10") and crosses(network, one))
    cars = {1: car(network, *ends(network, road, 5.0)), 2: car(network, across, -1, 12.0)}
    rules = rules_of(network)
    assert seen(rules, cars, [0.0, 2.5, 5.0])[1] == [RED, RED, RED]
    del cars[2]
    free = seen(rules, cars, [0.0, 0.4, 5.6])[1]
    assert free[-1] == GREEN


def crosses(network: Network, road: str) -> bool:
    """Return whether a road of the junction runs straight from the eastern arm to the western one."""
    first, last = network.lane_pose(road, -1, 0.0), network.lane_pose(road, -1, network.road(road).length)
    return math.cos(first.heading) < -0.99 and math.cos(last.heading) < -0.99


def test_a_vehicle_far_from_the_junction_has_no_right_of_way_over_one_at_a_sign(network: Network) -> None:
    cars = {1: car(network, *ends(network, "1", 5.0)), 2: car(network, "1", 1, 40.0)}
    assert seen(rules_of(network), cars, [2.0])[1] == [GREEN]


def test_a_sign_painted_on_the_road_is_no_actor(network: Network, tmp_path: Path) -> None:
    path = tmp_path / "painted.xodr"
    path.write_bytes(signed_crossing().replace(b'name="light_12"', b'name="Stencil_STOP"'))
    assert "traffic.stop" not in [one.kind for one in signs_of(Signals(load_network(path, cache=False)))]


def test_signs_beyond_the_end_of_their_road_stand_at_its_end(tmp_path: Path) -> None:
    path = tmp_path / "beyond.xodr"
    path.write_bytes(signed_crossing().replace(b's="844.103425"', b's="900"').replace(b's="100"', b's="-5"'))
    network = load_network(path, cache=False)
    at = {one.signal: one.transform for one in signs_of(Signals(network))}
    for number, road, s in ((STOP, "1", network.road("1").length), ("90", "1", 0.0)):
        pose = network.road_pose(road, s, 0.0)
        assert math.hypot(at[number].x - pose.x, -at[number].y - pose.y) < 7.0
    rules_of(network)


def test_twice_as_many_signs_take_twice_the_work(tmp_path: Path) -> None:
    def work(signs: int) -> int:
        root = etree.fromstring(signed_crossing())
        objects = next(root.iterfind("road/objects"))
        for number in range(signs):
            etree.SubElement(objects, "object", id=f"9{number}", name="Speed_60", s=f"{number}", t="-6", zOffset="0")
        path = tmp_path / f"{signs}_signs.xodr"
        path.write_bytes(etree.tostring(root))
        network = load_network(path, cache=False)
        network.model()
        found, lines = counted(lambda: signs_of(Signals(network)))
        assert len(found) == signs + 3
        return lines

    assert work(400) < 3 * work(200)


def test_lights_stand_where_the_clients_map_has_them() -> None:
    carla = pytest.importorskip("carla", reason="the CARLA client has no wheel for this Python")
    path = MAPS / "signal_crossing" / "signal_crossing.xodr"
    network = load_network(path, cache=False)
    marks = {one.id: one.transform.location for one in carla.Map("crossing", path.read_text()).get_all_landmarks()}
    lights = [light for group in groups_of(Signals(network)) for light in group.lights]
    assert len(lights) == 4
    for light in lights:
        mark = marks[light.signal]
        assert math.dist(light.transform[:3], (mark.x, mark.y, mark.z)) < 1e-4


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, client_version: str) -> Iterator[Served]:
    with served_map(tmp_path_factory.mktemp("signed"), "signed_crossing", signed_crossing(), client_version) as running:
        yield running


def test_each_landmark_has_its_sign(world: Any) -> None:
    """Also a speed limit that the file has as an object, as CARLA's towns do."""
    world.tick()
    found = {one.id: world.get_traffic_sign(one) for one in world.get_map().get_all_landmarks()}
    assert {number: sign.type_id for number, sign in found.items()} == {
        STOP: "traffic.stop",
        YIELD: "traffic.yield",
        "90": "traffic.speed_limit.60",
    }
    for one in world.get_map().get_all_landmarks():
        at = found[one.id].get_transform()
        assert at.location.distance(one.transform.location) < 1e-3
        assert (at.rotation.yaw - one.transform.rotation.yaw) % 360.0 == pytest.approx(90.0, abs=0.01)


def test_signs_have_boxes_about_their_boards(world: Any) -> None:
    import carla

    boxes = world.get_level_bbs(carla.CityObjectLabel.TrafficSigns)
    signs = [one for kind in ("traffic.stop", "traffic.yield") for one in world.get_actors().filter(kind)]
    assert len(boxes) == len(signs) == 2
    for sign in signs:
        at = sign.get_transform()
        (box,) = [
            one for one in boxes if math.hypot(one.location.x - at.location.x, one.location.y - at.location.y) < 0.3
        ]
        thick, wide = sorted((box.extent.x, box.extent.y))
        assert thick < 0.02
        assert 0.1 < wide < 1.0
        assert box.extent.z < 1.0
        along = math.cos(math.radians(box.rotation.yaw - at.rotation.yaw)) ** 2  # a board lies along or across its sign
        assert min(along, 1.0 - along) < 0.01


def test_the_trigger_volume_of_a_sign_lies_before_its_stop_line(world: Any) -> None:
    """As ScenarioRunner's criterion reads it: middle in the sign's axes, half extents along the world's."""
    (sign,) = world.get_actors().filter("traffic.stop")
    box, at = sign.trigger_volume, sign.get_transform()
    middle = at.transform(sign.trigger_volume.location)  # which the client turns into the result
    lane = world.get_map().get_waypoint(middle)
    assert math.hypot(lane.transform.location.x - middle.x, lane.transform.location.y - middle.y) < 0.05
    assert not lane.next(3.5)[0].is_junction  # the sign stands 1 m before the junction
    assert lane.next(4.5)[0].is_junction
    way = lane.transform.get_forward_vector()
    assert abs(way.x * box.extent.x + way.y * box.extent.y) == pytest.approx(1.5, abs=0.01)
    corners = box.get_world_vertices(at)
    assert max(abs(corner.x - middle.x) for corner in corners) == pytest.approx(box.extent.x, abs=0.01)
    assert max(abs(corner.y - middle.y) for corner in corners) == pytest.approx(box.extent.y, abs=0.01)


@pytest.mark.parametrize("ignored", [0, pytest.param(100, marks=pytest.mark.slow)])
def test_the_traffic_manager_stops_at_a_stop_sign_unless_it_ignores_signs(
    server: Served, world: Any, ignored: int
) -> None:
    import carla

    port = free_port()
    manager = server.client().get_trafficmanager(port)
    manager.set_synchronous_mode(True)
    manager.set_random_device_seed(1)
    town = world.get_map()
    road = next(one for one in world.get_actors().filter("traffic.stop"))
    line = town.get_waypoint(road.get_transform().transform(road.trigger_volume.location))
    start = line.previous(40.0)[0].transform
    start.location.z += 0.3
    driven = world.spawn_actor(world.get_blueprint_library().find("vehicle.tesla.model3"), start)
    world.tick()
    driven.set_autopilot(True, port)
    manager.ignore_signs_percentage(driven, ignored)
    speeds, red, crossed = [], False, False
    for _ in range(round(30.0 / STEP)):
        world.tick()
        at = town.get_waypoint(driven.get_location())
        red = red or driven.get_traffic_light_state() == carla.TrafficLightState.Red
        assert not driven.is_at_traffic_light()
        if not crossed and at.transform.location.distance(line.transform.location) < 8.0:
            speeds.append(driven.get_velocity().length())
        crossed = crossed or at.is_junction
        if crossed and not at.is_junction:
            break
    manager.set_synchronous_mode(False)
    manager.shut_down()
    assert crossed
    assert red
    assert (min(speeds) < 0.01) is (ignored == 0)
