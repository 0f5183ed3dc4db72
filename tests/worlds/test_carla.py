"""The world `carla`, with CARLA's own client against our server: the same conflicts come to the same."""

from __future__ import annotations

import queue
import signal
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from scenario_compiler import Plan, Recording, compile_scenario, judge, load_network, open_world, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.recording.store import read_recording
from scenario_compiler.vocabulary.sensors import Failure
from scenario_compiler.worlds import WorldError
from scenario_compiler.worlds.carla import ASIDE
from scenario_compiler.worlds.carla_lines import PURPLE, YELLOW
from tests.carla_server.conftest import PATIENCE, Served, client_version, served
from tests.engine.laws.told import Actor, Event, by, document, lane_change, lane_position

pytestmark = [pytest.mark.slow, pytest.mark.apart]
"""Run by `make test-carla`."""

__all__ = ["client_version"]

CONFLICTS = Path(__file__).parents[2] / "library" / "conflicts"
FLAGSHIPS = ("obstacle_ahead", "markings_missing", "ramp_blocked", "road_narrows", "sensor_failure")
NEAR = 0.05
"""How far mirrored actors may be from where the engine has them, m."""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory, client_version: str) -> Iterator[Served]:
    with served(tmp_path_factory.mktemp("carla"), "--carla-version", client_version) as running:
        yield running


def ideal(name: str, **arguments: Any) -> Plan:
    return compile_scenario(CONFLICTS / f"{name}.xml", overrides=Overrides(perception="ideal"), **arguments)


def recorded(plan: Plan, server: Served, **options: object) -> Recording:
    with open_world("carla", plan, load_network(plan.map.file), port=server.port, **options) as world:
        return run(plan, world)


def built_in(plan: Plan) -> Recording:
    with open_world("kinematic", plan, load_network(plan.map.file)) as world:
        return run(plan, world)


def course(recording: Recording) -> list[tuple[str, str]]:
    """Return the takeover's states and causes in their order."""
    states = recording.takeover_state
    changes = [int(states[0]), *(int(b) for a, b in pairwise(states) if a != b)]
    causes = [(one.kind, one.cause) for one in recording.events if one.cause and one.kind != "light"]
    return [*(("state", str(one)) for one in changes), *causes]


@pytest.mark.slow
@pytest.mark.parametrize("name", FLAGSHIPS)
def test_a_flagship_has_the_same_result_in_carla(server: Served, name: str) -> None:
    plan = ideal(name)
    ours, theirs = built_in(plan), recorded(plan, server)
    assert theirs.header.world == "carla"
    assert course(theirs) == course(ours)
    there, here = judge(plan, theirs), judge(plan, ours)
    assert (there.resolution, there.cause, there.result) == (here.resolution, here.cause, here.result)
    for measure, most in (("request_time", 1.0), ("takeover_time", 0.2)):
        one, two = there.measures[measure].value, here.measures[measure].value
        assert (one is None) == (two is None)
        assert one is None or two is None or abs(one - two) <= most
    rows = min(len(ours.t), len(theirs.t))
    scripted = [k for k, entity in enumerate(plan.entities) if entity.kind == "static"]
    for column in ("x", "y"):
        apart = np.abs(getattr(theirs, column)[:rows, scripted] - getattr(ours, column)[:rows, scripted])
        assert apart.max(initial=0.0) < NEAR


def test_obstacle_ahead_has_the_same_result_in_carla(server: Served) -> None:
    plan = ideal("obstacle_ahead", distance=90)
    ours, theirs = built_in(plan), recorded(plan, server)
    assert course(theirs) == course(ours)
    rows = min(len(ours.t), len(theirs.t))
    assert abs(len(ours.t) - len(theirs.t)) <= 2
    assert np.hypot(theirs.x[:rows] - ours.x[:rows], theirs.y[:rows] - ours.y[:rows]).max() < NEAR
    assert theirs.header.versions["carla_server"] == theirs.header.versions["carla_client"]


def test_a_kinematic_ego_drives_as_it_does_in_the_built_in_world(server: Served) -> None:
    plan = ideal("obstacle_ahead", distance=90).model_copy(update={"duration": 8.0})
    ours, theirs = built_in(plan), recorded(plan, server, ego="kinematic")
    assert theirs.header.choices == {"ego": "kinematic"}
    assert len(ours.t) == len(theirs.t)
    assert np.abs(theirs.x - ours.x).max() < 1e-6
    assert np.abs(theirs.y - ours.y).max() < 1e-6


def test_a_scenario_without_an_automated_vehicle_is_shown(server: Served) -> None:
    scripted = Path(__file__).parents[1] / "benchmarks" / "scripted.xosc"
    plan = compile_scenario(scripted, overrides=Overrides(duration=2.0))
    ours, theirs = built_in(plan), recorded(plan, server)
    assert (plan.controller, theirs.stop_reason) == (None, "duration")
    assert np.array_equal(theirs.x, ours.x, equal_nan=True)


TELEPORTED = """\
<scenarios version="1">
  <scenario name="teleported" map="town_grid" duration="2" control_every="2">
    <ego speed="10"><start><lane road="1" lane="-1" s="30"/></start></ego>
    <when><time after="1"/><do><teleport><lane road="1" lane="-1" s="200"/></teleport></do></when>
    <takeover budget="7"><cause kind="path_blocked"/></takeover>
  </scenario>
</scenarios>
"""


def written(folder: Path, text: str) -> Plan:
    file = folder / "it.xml"
    file.write_text(text, encoding="utf-8")
    return compile_scenario(file, overrides=Overrides(perception="ideal"))


def of_the_run(there: Any) -> list[Any]:
    """Return the actors of a run in a world: vehicles and sensors."""
    return [one for one in there.get_actors() if one.type_id.startswith(("vehicle", "sensor"))]


def test_the_first_entity_is_far_away_while_it_is_absent(server: Served, tmp_path: Path) -> None:
    entity = '<GlobalAction><EntityAction entityRef="A">{}</EntityAction></GlobalAction>'
    gone = Event("A", entity.format("<DeleteEntityAction/>"), 0.5)
    back = Event("A", entity.format(f"<AddEntityAction>{lane_position(-1, 300.0)}</AddEntityAction>"), 1.0)
    file = tmp_path / "told.xosc"
    file.write_text(document({"A": Actor()}, [gone, back], 1.5), encoding="utf-8")
    plan, client = compile_scenario(file, overrides=Overrides(step=0.05, duration=1.5)), server.client()
    places: list[tuple[float, float]] = []

    def note(t: float) -> None:
        (car,) = client.get_world().get_actors().filter("vehicle.*")
        places.append((t, car.get_transform().location.x))

    with open_world("carla", plan, load_network(plan.map.file), port=server.port) as world:
        run(plan, world, progress=note)
    absent = [t for t, x in places if x > 4000.0]
    assert len(places) == 30
    assert (absent[0], absent[-1]) == pytest.approx((0.55, 1.0), abs=0.051)
    assert len(absent) == 10


def test_a_lane_without_road_marks_can_be_crossed(server: Served, tmp_path: Path) -> None:
    """CARLA's client dies of a lane without a mark."""
    target = '<RelativeTargetLane entityRef="A" value="-1"/>'
    change = Event("A", lane_change(target, by("linear", "time", 2.0)), 0.5)
    file = tmp_path / "told.xosc"
    file.write_text(document({"A": Actor()}, [change], 3.0), encoding="utf-8")
    plan = compile_scenario(file, overrides=Overrides(step=0.05, duration=3.0))
    ours, theirs = built_in(plan), recorded(plan, server)
    assert {*theirs.lane[:, 0]} == {-1, -2}
    assert np.array_equal(theirs.y, ours.y)


def test_an_action_teleports_the_ego_in_carla_too(server: Served, tmp_path: Path) -> None:
    plan = written(tmp_path, TELEPORTED)
    ours, theirs = built_in(plan), recorded(plan, server)
    assert np.abs(np.diff(ours.x[:, 0])).max() > 100.0
    assert np.abs(theirs.x[:, 0] - ours.x[:, 0]).max() < NEAR
    assert np.abs(theirs.v[:, 0] - ours.v[:, 0]).max() < 0.1


def test_a_sensor_that_another_client_destroys_leaves_no_actor_behind(server: Served) -> None:
    carla = pytest.importorskip("carla")
    plan, client = ideal("obstacle_ahead").model_copy(update={"duration": 0.5}), server.client()

    def destroy(t: float) -> None:
        sensors = client.get_world().get_actors().filter("sensor.*") if t > 0.2 else ()
        client.apply_batch_sync([carla.command.DestroyActor(one) for one in sensors], False)

    with open_world("carla", plan, load_network(plan.map.file), port=server.port) as world:
        assert run(plan, world, progress=destroy).stop_reason == "duration"
    there = client.get_world()
    there.wait_for_tick()
    assert of_the_run(there) == []


def test_a_place_that_is_taken_leaves_no_actor_behind(server: Served) -> None:
    carla = pytest.importorskip("carla")
    plan, client = ideal("obstacle_ahead").model_copy(update={"duration": 0.5}), server.client()
    with open_world("carla", plan, load_network(plan.map.file), port=server.port) as world:
        there = client.get_world()
        taken = carla.Transform(carla.Location(ASIDE + 30.0, ASIDE, 1.0))
        blocking = there.spawn_actor(there.get_blueprint_library().find("vehicle.audi.tt"), taken)
        lost = run(plan, world)
        blocking.destroy()
    assert lost.stop_reason == "world_lost"
    assert "cannot spawn 'blocked_lane1.blocker'" in next(
        one.message for one in lost.events if one.kind == "broken_off"
    )
    there.wait_for_tick()
    assert of_the_run(there) == []


def test_a_clock_that_another_client_moves_loses_the_world(server: Served) -> None:
    plan, client = ideal("obstacle_ahead").model_copy(update={"duration": 2.0}), server.client()
    with open_world("carla", plan, load_network(plan.map.file), port=server.port) as world:
        lost = run(plan, world, progress=lambda t: client.get_world().tick() if t > 1.0 else None)
    assert lost.stop_reason == "world_lost"
    assert "another client moves its clock" in next(one.message for one in lost.events if one.kind == "broken_off")


def test_a_scenario_without_entities_is_refused(server: Served) -> None:
    plan = ideal("obstacle_ahead").model_copy(update={"entities": ()})
    with pytest.raises(WorldError, match="has no entity") as refused:
        open_world("carla", plan, load_network(plan.map.file), port=server.port)
    assert refused.value.code.id == "SC524"


def test_carlas_camera_sees_and_asks(server: Served) -> None:
    plan = compile_scenario(CONFLICTS / "obstacle_ahead.xml", distance=60).model_copy(update={"duration": 2.5})
    camera = plan.camera.model_copy(update={"width": 512, "height": 256})
    plan = plan.model_copy(update={"camera": camera})
    theirs = recorded(plan, server, camera="carla")
    assert theirs.stop_reason == "duration"
    assert np.median(theirs.confidence_left[20:]) > 0.5
    assert np.abs(theirs.off[:, 0]).max() < 0.6
    assert any(one.kind == "request" for one in theirs.events)


def from_behind(server: Served, plan: Plan, camera: str) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Run a plan for a second and return what a camera of another client has seen of the ego at the end, BGR."""
    carla = pytest.importorskip("carla")
    client, images = server.client(), queue.Queue[Any]()
    kept: list[Any] = []

    def attach(t: float) -> None:
        there = client.get_world()
        if t < 0.5 or kept:
            return
        hero = next(one for one in there.get_actors() if one.attributes.get("role_name") == "hero")
        mounted = carla.Transform(carla.Location(x=-10.0, z=8.0), carla.Rotation(pitch=-20.0))
        blueprint = there.get_blueprint_library().find("sensor.camera.rgb")
        blueprint.set_attribute("image_size_x", "400")
        blueprint.set_attribute("image_size_y", "300")
        kept.append(there.spawn_actor(blueprint, mounted, attach_to=hero))
        kept[0].listen(images.put)

    with open_world("carla", plan, load_network(plan.map.file), port=server.port, camera=camera) as world:
        run(plan, world, progress=attach)
        kept[0].stop()
        kept[0].destroy()
    pixels = np.empty(0, np.uint8)
    while not images.empty():
        image = images.get_nowait()
        pixels = np.frombuffer(image.raw_data, np.uint8).reshape(image.height, image.width, 4)[..., :3]
    return pixels


@pytest.mark.parametrize("camera", ["built-in", "carla"])
def test_route_and_path_are_drawn_where_the_automation_does_not_see_them(server: Served, camera: str) -> None:
    plan = compile_scenario(CONFLICTS / "obstacle_ahead.xml", distance=200).model_copy(update={"duration": 1.0})
    seen = from_behind(server, plan, camera)
    assert seen.shape == (300, 400, 3)
    counts = [int((seen == colour[::-1]).all(axis=2).sum()) for colour in (YELLOW, PURPLE)]
    if camera == "carla":
        assert counts == [0, 0]
    else:
        assert min(counts) > 20


def test_changed_paint_takes_the_built_in_camera_unless_told_otherwise(server: Served) -> None:
    plan = compile_scenario(CONFLICTS / "markings_missing.xml")
    network = load_network(plan.map.file)
    with open_world("carla", plan, network, port=server.port) as world:
        assert [(one.code.id, one.part) for one in world.findings] == [("SC526", "scenario")]
    with open_world("carla", plan, network, port=server.port, camera="built-in") as world:
        assert list(world.findings) == []


def test_a_camera_that_is_turned_on_its_mount_is_the_built_in_one(server: Served) -> None:
    plan = compile_scenario(CONFLICTS / "obstacle_ahead.xml", distance=60)
    camera = plan.camera.model_copy(update={"failures": (Failure(kind="misalignment", yaw=0.02),)})
    plan = plan.model_copy(update={"camera": camera, "perception": "camera"})
    with open_world("carla", plan, load_network(plan.map.file), port=server.port) as world:
        assert [(one.code.id, one.part) for one in world.findings] == [("SC526", "scenario")]
        assert "turns the camera on its mount" in world.findings[0].message


def test_an_entity_without_a_blueprint_gets_another_one_with_a_warning(server: Served) -> None:
    plan = ideal("obstacle_ahead").model_copy(update={"duration": 0.2})
    blocker = plan.entities[1]
    strange = blocker.model_copy(update={"vehicle": blocker.vehicle.model_copy(update={"name": "vehicle.our.own"})})
    plan = plan.model_copy(update={"entities": (plan.entities[0], strange, *plan.entities[2:])})
    with open_world("carla", plan, load_network(plan.map.file), port=server.port) as world:
        run(plan, world)
        (found,) = world.findings
    assert (found.code.id, found.part) == ("SC525", f"entities/{blocker.id}")
    assert "'vehicle.our.own'" in found.message


def test_it_leaves_the_server_as_it_found_it(server: Served) -> None:
    plan = ideal("obstacle_ahead").model_copy(update={"duration": 0.5})
    network = load_network(plan.map.file)

    def interrupt(t: float) -> None:
        if t > 0.2:
            raise KeyboardInterrupt

    with open_world("carla", plan, network, port=server.port) as world, pytest.raises(KeyboardInterrupt):
        run(plan, world, progress=interrupt)
    there = server.client().get_world()
    there.wait_for_tick()
    assert not there.get_settings().synchronous_mode
    assert [one for one in there.get_actors() if one.type_id.startswith(("vehicle", "sensor"))] == []


def test_a_server_that_ends_loses_the_world_and_keeps_the_recording(tmp_path: Path, client_version: str) -> None:
    plan = ideal("obstacle_ahead").model_copy(update={"duration": 20.0})
    with served(tmp_path, "--carla-version", client_version) as dying:
        with open_world("carla", plan, load_network(plan.map.file), port=dying.port) as world:
            killed = run(plan, world, progress=lambda t: dying.process.send_signal(signal.SIGINT) if t > 1.0 else None)
        assert killed.stop_reason == "world_lost"
        assert killed.t[-1] > 1.0
        broken = next(one for one in killed.events if one.kind == "broken_off")
        assert broken.cause == "SC520"
        assert f"127.0.0.1:{dying.port}" in broken.message
        dying.process.wait(PATIENCE)


def test_a_server_that_hung_has_its_settings_again_when_it_goes_on(tmp_path: Path, client_version: str) -> None:
    plan = ideal("obstacle_ahead").model_copy(update={"duration": 20.0})
    with served(tmp_path, "--carla-version", client_version) as server:
        there = server.client().get_world()

        def hang(t: float) -> None:
            if t > 1.0:
                server.process.send_signal(signal.SIGSTOP)

        with open_world("carla", plan, load_network(plan.map.file), port=server.port, timeout=2.0) as world:
            hung = run(plan, world, progress=hang)
        server.process.send_signal(signal.SIGCONT)
        assert hung.stop_reason == "world_lost"
        there.wait_for_tick(PATIENCE)
        assert not there.get_settings().synchronous_mode
        assert [one for one in there.get_actors() if one.type_id.startswith(("vehicle", "sensor"))] == []


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_is_kept(tmp_path: Path, client_version: str, number: signal.Signals) -> None:
    with served(tmp_path, "--carla-version", client_version) as server:
        watching = server.client().get_world()
        command = [sys.executable, "-m", "scenario_compiler", "run", "obstacle_ahead", "--perception", "ideal"]
        command += ["--world", "carla", "--carla-port", str(server.port), "-o", str(tmp_path / "out")]
        running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        for _ in range(2000):
            watching.wait_for_tick(60.0)
            if any(one.attributes.get("role_name") == "hero" for one in watching.get_actors().filter("vehicle.*")):
                break
        running.send_signal(number)
        _, told = running.communicate(timeout=60)
        assert running.returncode == 130
        assert told.splitlines()[-1] == "scenario-compiler: interrupted"
        kept = read_recording(tmp_path / "out" / "recording.parquet")
        assert kept.stop_reason == "user"
        assert len(kept.t) >= 1
        assert (tmp_path / "out" / "report.html").is_file()
        assert not watching.get_settings().synchronous_mode


def test_another_version_is_refused_with_both_numbers(tmp_path: Path, client_version: str) -> None:
    other = "0.9.15" if client_version == "0.9.16" else "0.9.16"
    plan = ideal("obstacle_ahead")
    with served(tmp_path, "--carla-version", other) as running:
        with pytest.raises(WorldError, match=f"the client is CARLA {client_version}, the server .* is {other}") as told:
            open_world("carla", plan, load_network(plan.map.file), port=running.port)
        assert told.value.code.id == "SC524"


def test_where_nobody_answers_the_command_says_so(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "scenario_compiler", "run", "obstacle_ahead", "--perception", "ideal"]
    carla = [*command, "--world", "carla", "--carla-port", "2"]
    done = subprocess.run(carla, capture_output=True, text=True, timeout=120, check=False, cwd=tmp_path)
    assert done.returncode == 1
    assert "SC524" in done.stderr
    assert "Traceback" not in done.stderr
    wrong = subprocess.run([*command, "--carla-port", "2"], capture_output=True, text=True, timeout=60, check=False)
    assert wrong.returncode == 2
    assert "--carla-port: only with --world carla" in wrong.stderr
