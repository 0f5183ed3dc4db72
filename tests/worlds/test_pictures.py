"""The built-in world's pictures show the scenario, and the versions on which they depend are recorded."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler import open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.perception.machine import CHOOSING
from scenario_compiler.perception.stage import Stage
from scenario_compiler.roads import Pose
from scenario_compiler.vocabulary.sensors import Perception
from scenario_compiler.worlds import EntityState, Snapshot
from scenario_compiler.worlds.kinematic import KinematicWorld
from tests.roads.make import network as network_of
from tests.roads.make import road

SCENARIO = """<scenarios version="1"><scenario name="seen" map="{map}" duration="0.2">
<ego speed="5"><start><lane road="1" lane="-1" s="20"/></start><camera {camera}/></ego>
<static id="car"><at><lane road="1" lane="-1" s="36"/></at></static></scenario></scenarios>"""
LIGHT = '<signals><signal id="5" type="1000001" dynamic="yes" s="56" t="3" zOffset="2.5" orientation="+"/></signals>'


def compiled(folder: Path, camera: str = "", perception: Perception | None = None) -> Compilation:
    network_of(folder, road(length=200.0, more=LIGHT))
    path = folder / "seen.xml"
    path.write_text(SCENARIO.format(map=next(folder.glob("*.xodr")).name, camera=camera), encoding="utf-8")
    done = compile_target(path, {}, Diagnostics(), overrides=Overrides(perception=perception))
    assert done is not None
    return done


def seen(done: Compilation, *, braking: bool = False, signals: tuple[tuple[str, str], ...] = ()) -> NDArray[np.int64]:
    """Return the image at the start."""
    poses = [done.network.lane_pose("1", -1, s) for s in (20.0, 36.0)]
    states = tuple(EntityState(there=True, shown=True, pose=pose, braking=braking) for pose in poses)
    with KinematicWorld(done.plan, done.network) as world:
        snapshot = Snapshot(t=0.0, frame=0, entities=states, signals=signals)
        world.reset(snapshot, 1)
        return world.observe(snapshot).image.astype(np.int64)


def test_the_camera_is_mounted_as_the_scenario_says(tmp_path: Path) -> None:
    """Turned left, the car ahead moves to the right; rolled, the horizon tilts; moved left, near marks move right."""
    car = {}
    for camera in ("", 'yaw="8"', 'y="0.6"'):
        image = seen(compiled(tmp_path, camera))
        empty = seen(compiled(tmp_path, camera), braking=True)
        columns = np.nonzero((image != empty).any(axis=(0, 2)))[0]
        car[camera] = float(columns.mean())
    focal = 256.0 / math.tan(math.radians(22.5))
    assert car['yaw="8"'] - car[""] == pytest.approx(focal * math.tan(math.radians(8.0)), abs=12.0)
    assert car['y="0.6"'] > car[""] + 15.0
    rolled = seen(compiled(tmp_path, 'roll="10"'))
    green = (rolled[..., 1] - rolled[..., 0]) > 15
    assert np.argmax(green[:, 30]) != np.argmax(green[:, 480])


def test_a_braking_car_shows_it(tmp_path: Path) -> None:
    done = compiled(tmp_path)
    off, on = seen(done), seen(done, braking=True)
    brighter = (on - off).max(axis=2) > 60
    assert 20 < brighter.sum() < 2000
    assert not (on != off)[~cv2.dilate(brighter.astype(np.uint8), np.ones((9, 9), np.uint8)).astype(bool)].any()


def test_traffic_lights_show_the_state_that_the_scenario_gives_them(tmp_path: Path) -> None:
    done = compiled(tmp_path)
    dark, red, green = (seen(done, signals=(("5", state),) if state else ()) for state in ("", "red", "green"))
    rows = {}
    for name, image, channel in (("red", red, 2), ("green", green, 1)):
        lit = (image - dark)[..., channel] > 80
        assert lit.any()
        rows[name] = float(np.nonzero(lit)[0].mean())
    assert rows["red"] < rows["green"]


def test_the_versions_on_which_pictures_depend_are_recorded_only_with_a_camera(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in CHOOSING:
        monkeypatch.delenv(name, raising=False)
    opencv = set()
    for perception, names in (("camera", {"processor"}), ("ideal", set())):
        done = compiled(tmp_path, perception=perception)  # type: ignore[arg-type]
        with open_world("kinematic", done.plan, done.network) as world:
            assert set(world.versions) == names
            versions = run(done.plan, world).header.versions
        assert ("processor" in versions) == (perception == "camera")
        opencv.add(versions["opencv"])
    assert len(opencv) == 1


def test_objects_follow_the_slope_on_which_they_stand(tmp_path: Path) -> None:
    """A box is placed and turned with its whole pose, not with its heading alone."""
    done = compiled(tmp_path)
    (box,) = Stage(done.plan, done.network).boxes([(1, Pose(40.0, -1.75, 0.0, 0.0, 0.1, 0.2), False)])
    center = done.plan.entities[1].vehicle.center
    assert (box.pitch, box.roll) == (0.1, 0.2)
    assert (box.x, box.z) == pytest.approx((40.0 + center * math.cos(0.1), -center * math.sin(0.1)))
