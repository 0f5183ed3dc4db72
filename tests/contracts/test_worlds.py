"""Every world keeps its contract: it opens for a plan, takes images, repeats a run equally, and closes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Plan, compile_scenario, load_network, open_world, run
from scenario_compiler.roads import Pose
from scenario_compiler.worlds import WORLDS, EntityState, Snapshot, World
from tests.carla_server.conftest import installed_version, served

CONFLICT = Path(__file__).parent.parent.parent / "library" / "conflicts" / "obstacle_ahead.xml"


@pytest.fixture(scope="module")
def plan() -> Plan:
    return compile_scenario(CONFLICT, distance=60).model_copy(update={"duration": 1.0})


MARKS = {"carla": (pytest.mark.slow, pytest.mark.apart)}
"""What marks the tests of some worlds: CARLA's are run by `make test-carla`."""


@pytest.fixture(scope="module", params=[pytest.param(name, marks=MARKS.get(name, ())) for name in sorted(WORLDS)])
def given(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[tuple[str, dict[str, int]]]:
    """A world's name, and the options that open it: for CARLA, where our server is."""
    if request.param != "carla":
        yield request.param, {}
        return
    with served(tmp_path_factory.mktemp("carla"), "--carla-version", installed_version()) as running:
        yield "carla", {"port": running.port}


@pytest.fixture
def world(given: tuple[str, dict[str, int]], plan: Plan) -> Iterator[World]:
    name, options = given
    with open_world(name, plan, load_network(plan.map.file), **options) as opened:
        yield opened


def snapshot_of(plan: Plan, frame: int = 0, sigma: float = 0.0) -> Snapshot:
    starts = [plan.derived[entity.id] for entity in plan.entities]
    poses = tuple(Pose(at.x, at.y, at.z, at.heading, 0.0, 0.0) for at in starts)
    return Snapshot(frame * plan.step, frame, tuple(EntityState(True, True, pose) for pose in poses), sigma)


def test_it_is_called_by_its_name(world: World) -> None:
    assert world.name in WORLDS


def test_the_camera_delivers_the_images_that_the_plan_requires(world: World, plan: Plan) -> None:
    world.reset(snapshot_of(plan), 1)
    seen = world.observe(snapshot_of(plan))
    assert seen.image.shape == (plan.camera.height, plan.camera.width, 3)
    assert seen.image.dtype == np.uint8
    assert (seen.camera.width, seen.camera.height) == (plan.camera.width, plan.camera.height)
    assert seen.image.std() > 5.0


def test_looking_twice_shows_the_same(world: World, plan: Plan) -> None:
    world.reset(snapshot_of(plan), 1)
    one, two = (world.observe(snapshot_of(plan, 3, 20.0)).image for _ in range(2))
    assert np.array_equal(one, two)


def test_noise_and_the_seed_make_a_difference(world: World, plan: Plan) -> None:
    world.reset(snapshot_of(plan), 1)
    clear, noisy = (world.observe(snapshot_of(plan, 3, sigma)).image for sigma in (0.0, 60.0))
    world.reset(snapshot_of(plan), 2)
    other = world.observe(snapshot_of(plan, 3, 60.0)).image
    assert not np.array_equal(clear, noisy)
    assert not np.array_equal(noisy, other)


def test_it_shows_the_entities(world: World, plan: Plan) -> None:
    world.reset(snapshot_of(plan), 1)
    there = snapshot_of(plan)
    far = EntityState(True, True, Pose(1e5, 1e5, 0, 0, 0, 0))
    away = Snapshot(there.t, there.frame, (there.entities[0], far, far))
    seen = world.observe(there).image.copy()
    world.reset(away, 1)
    assert not np.array_equal(seen, world.observe(away).image)


def test_the_drivers_view_is_a_picture(world: World, plan: Plan) -> None:
    world.reset(snapshot_of(plan), 1)
    picture = world.picture(snapshot_of(plan))
    assert picture.ndim == 3
    assert picture.dtype == np.uint8


def test_it_can_be_run_in_again(world: World, plan: Plan) -> None:
    assert run(plan, world, seed=4) == run(plan, world, seed=4)
