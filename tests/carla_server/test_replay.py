"""Recordings and their replays, without a client: what is recorded is shown, and what a recording tells."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from scenario_compiler.carla_server.actors import Car, Walker
from scenario_compiler.carla_server.recorder import Played, Recorder, Recording, Replay
from scenario_compiler.carla_server.spawning import new_body
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import load_town
from scenario_compiler.carla_server.traffic_lights import GREEN, YELLOW
from scenario_compiler.frames import CarlaTransform

VERSION = "0.9.16"
STEP = 0.1
FRAMES = 20
"""Length of a time step, s, and frames of a recording, in the middle of which a car is destroyed."""

LOW_BEAM = 2


def add(stage: Stage, name: str, at: CarlaTransform, *attributes: list[Any]) -> Any:
    return stage.add_body(new_body(VERSION, [0, name, list(attributes)], at))


@pytest.fixture
def stage() -> Stage:
    return Stage(load_town("signal_crossing", ()), VERSION)


@pytest.fixture
def recorded(stage: Stage, tmp_path: Path) -> tuple[Recording, list[int]]:
    """A recording of a car that drives, one that is destroyed and a walker, which are all removed; and their ids."""
    points = stage.town.spawn_points
    car, gone = add(stage, "vehicle.audi.tt", points[0]), add(stage, "vehicle.tesla.model3", points[3])
    walker = add(stage, "walker.pedestrian.0005", points[4]._replace(z=points[4].z + 1.0))
    walker.control = [[0.0, 1.0, 0.0], 1.5, False]
    stage.driving.walk(walker)
    recorder = Recorder(tmp_path / "made.log", stage.town.name)
    light = stage.groups[0].lights[0]
    for k in range(FRAMES):
        if k == FRAMES // 2:
            stage.destroy(gone.id)
            light.state, light.elapsed, light.frozen = YELLOW, 1.5, True
            car.control, car.lights = [0.6, 0.2, 0.0, False, False, False, 0], LOW_BEAM
            stage.driving.command(car)
        stage.step(STEP)
        recorder.note(stage, STEP)
    recorder.write()
    for body in list(stage.bodies()):
        stage.destroy(body.id)
    light.state, light.frozen = GREEN, False
    return Recording.read(tmp_path, "made.log"), [car.id, gone.id, walker.id]


def played(stage: Stage, replay: Replay, frames: int) -> None:
    """Play some frames."""
    for _ in range(frames):
        assert replay.play(stage, STEP, Played())
        stage.step(STEP, switches=False)


def replayed(recording: Recording, begin: float = -STEP) -> Replay:
    return Replay(recording, 0, begin, recording.frames[-1][1])


def test_a_replay_shows_controls_and_lights_of_vehicles_and_traffic_lights(
    stage: Stage, recorded: tuple[Recording, list[int]]
) -> None:
    recording, (number, _, walking) = recorded
    replay = replayed(recording)
    played(stage, replay, FRAMES // 2)
    light = stage.groups[0].lights[0]
    assert light.state == GREEN
    played(stage, replay, FRAMES // 2)
    assert (light.state, light.elapsed, light.frozen) == (YELLOW, 1.5, True)
    car, walker = stage.actors[number], stage.actors[walking]
    assert isinstance(car, Car)
    assert car.control == [0.6, 0.2, 0.0, False, False, False, 1]
    assert car.lights == LOW_BEAM
    assert isinstance(walker, Walker)
    assert walker.control == [[0.0, 1.0, 0.0], 1.5, False]
    for actor in (car, walker):
        shown = [at for one, at, *_ in recording.frames[-1][3] if one == actor.id]
        assert list(stage.transform_of(actor)) == pytest.approx(shown[0], abs=1e-6)
    replay.finish(stage)
    stage.step(STEP)
    assert car.control == [0.0, 0.0, 0.0, False, False, False, 0]
    assert walker.control[1] == 0.0


@pytest.mark.parametrize("begin", [-STEP, 1.2])
def test_a_replay_removes_what_was_destroyed_in_the_recording(
    stage: Stage, recorded: tuple[Recording, list[int]], begin: float
) -> None:
    """Also if it begins after that, and the body is there: CARLA goes through the events before."""
    recording, (number, gone, walking) = recorded
    stage.add_body(new_body(VERSION, recording.actors[gone][0], stage.town.spawn_points[3]), gone)
    replay = replayed(recording, begin)
    played(stage, replay, round((1.4 - begin) / STEP))
    assert {body.id for body in stage.bodies()} == {number, walking}


def test_bodies_stay_after_a_replay_unless_their_destruction_is_recorded(
    stage: Stage, recorded: tuple[Recording, list[int]]
) -> None:
    recording, (number, _, walking) = recorded
    replay = replayed(recording)
    played(stage, replay, 3)
    replay.stop(stage, Played())
    assert {body.id for body in stage.bodies()} == {number, walking}
    assert all(body.simulates for body in stage.bodies())


def test_a_replay_leaves_a_hero_alone_if_it_is_to(stage: Stage, recorded: tuple[Recording, list[int]]) -> None:
    recording, (number, gone, walking) = recorded
    (_, name, _), kind = recording.actors[gone]
    recording.actors[gone] = [[0, name, [["role_name", 3, "hero"]]], kind]
    replay = replayed(recording)
    assert replay.play(stage, STEP, Played(without_hero=True))
    assert {body.id for body in stage.bodies()} == {number, walking}


def test_what_is_attached_is_carried_in_a_replay(stage: Stage, tmp_path: Path) -> None:
    car = add(stage, "vehicle.audi.tt", stage.town.spawn_points[0])
    load = new_body(VERSION, [0, "static.prop.box01", []], car.transform._replace(z=3.0))
    load.parent, load.relative = car.id, CarlaTransform(0.0, 0.0, 2.5, 0.0, 0.0, 0.0)
    stage.add_body(load)
    recorder = Recorder(tmp_path / "made.log", stage.town.name)
    for _ in range(5):
        stage.step(STEP)
        recorder.note(stage, STEP)
    before = stage.transform_of(load)
    recorder.write()
    played(stage, replayed(Recording.read(tmp_path, "made.log")), 4)
    assert list(stage.transform_of(load)) == pytest.approx(list(before), abs=1e-6)


def moved(*places: float) -> Recording:
    """Return a recording of one body, at a place in each frame, m."""
    frames = [
        [k + 1, k * STEP, STEP, [[7, [x, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0, [], 0]], [], []] for k, x in enumerate(places)
    ]
    return Recording("made", "town_grid", {7: [[0, "static.prop.box01", []], "other"]}, frames)


def test_each_stop_is_reported_with_its_start_the_longest_first() -> None:
    places = [0.0] * 11 + [2.0, 4.0, 6.0] + [8.0] * 31 + [10.0, 12.0]
    told = moved(*places).blocked(0.5, 100.0).splitlines()
    rows = [line.split() for line in told if " 7 " in line]
    assert [(float(row[0]), float(row[-1])) for row in rows] == [(1.5, 3.0), (0.1, 1.0)]
    assert told[-2:] == ["Frames: 47", "Duration: 4.6 seconds"]


def test_a_stop_that_lasts_to_the_end_is_reported_and_a_short_one_is_not() -> None:
    told = moved(*[0.0] * 3, *[5.0] * 8).blocked(0.5, 100.0)
    rows = [line.split() for line in told.splitlines() if " 7 " in line]
    assert [(float(row[0]), float(row[-1])) for row in rows] == [(0.4, 0.7)]


def test_a_recording_tells_who_was_destroyed(recorded: tuple[Recording, list[int]]) -> None:
    recording, (_, gone, _) = recorded
    told = recording.info(False)
    assert told.count("Destroy") == 1
    assert f"Frame {FRAMES // 2 + 1} at {FRAMES // 2 * STEP:g} seconds\n Destroy {gone}\n" in told
