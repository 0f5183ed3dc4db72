"""The snapshot for a world: every entity as it was at that instant, whenever it is read."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from scenario_compiler import Plan, compile_scenario, load_network, run
from scenario_compiler.engine.columns.state import new_state
from scenario_compiler.engine.program.stage import build_stage
from scenario_compiler.roads import Network, Pose
from scenario_compiler.runtime.snapshot import entities_of
from scenario_compiler.worlds import EgoCommand, EgoState, Entities, EntityState, Snapshot
from scenario_compiler.worlds.kinematic import KinematicWorld

CONFLICT = """<scenarios version="1"><scenario name="lit" map="highway_loop" duration="4">
  <ego model="vehicle.audi.tt" speed="20"><start><lane road="1" lane="-2" s="50"/></start></ego>
  <dynamic id="other" model="vehicle.audi.tt" speed="15">
    <start><ahead_of entity="ego" distance="60"/></start>
    <when><time after="1"/><do><light type="indicatorLeft" mode="flashing"/><light type="own" mode="on"/></do></when>
    <when><time after="2"/><do><lane_change by="1" over_time="3"/></do></when>
    <when><time after="3"/><do><light type="indicatorLeft" mode="off"/></do></when>
  </dynamic>
  <takeover budget="7"/>
</scenario></scenarios>"""


class Watching(KinematicWorld):
    """The built-in world, which keeps all snapshots."""

    def __init__(self, plan: Plan, network: Network) -> None:
        super().__init__(plan, network)
        self.told: list[Snapshot] = []

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Keep it."""
        self.told.append(snapshot)
        return super().step(snapshot, command)


@pytest.fixture(scope="module")
def told(tmp_path_factory: pytest.TempPathFactory) -> list[Snapshot]:
    path = tmp_path_factory.mktemp("lit") / "lit.xml"
    path.write_text(CONFLICT, encoding="utf-8")
    plan = compile_scenario(path).model_copy(update={"perception": "ideal"})
    world = Watching(plan, load_network(plan.map.file))
    run(plan, world)
    return world.told


def test_a_state_is_built_once_when_it_is_first_read() -> None:
    built = []

    def state_of(i: int) -> EntityState:
        built.append(i)
        return EntityState(True, True, Pose(i, 0.0, 0.0, 0.0, 0.0, 0.0))

    entities = Entities(3, state_of)
    assert (len(entities), built) == (3, [])
    assert entities[-1].pose.x == 2
    assert [one.pose.x for one in entities] == [0, 1, 2]
    assert built == [2, 0, 1]
    assert isinstance(entities, Sequence)
    assert entities[1:] == (entities[1], entities[2])
    assert entities == Entities(3, state_of)
    with pytest.raises(IndexError):
        entities[3]


def test_a_snapshot_does_not_change_while_the_run_continues(told: list[Snapshot]) -> None:
    where = [one.entities[1].pose.x for one in told]
    assert len(set(where)) == len(where)


def test_velocities_are_how_the_entities_moved(told: list[Snapshot]) -> None:
    for before, after in pairwise(told[5:]):
        for one, two in zip(before.entities, after.entities, strict=True):
            moved = np.subtract(two.pose[:3], one.pose[:3]) / (after.t - before.t)
            assert np.allclose(two.velocity, moved, atol=1e-6)


def test_the_body_of_a_braking_car_tilts_and_its_velocity_does_not() -> None:
    """After a leap the velocity follows from speed and heading, and its slope is that of the road alone."""
    state = new_state(build_stage(1, 1, 0.05))
    state.present[0], state.v[0], state.h[0] = 1, 20.0, 0.0
    state.x[0], state.pitch[0], state.body_pitch[0] = 500.0, 0.02, 0.02
    assert entities_of(state, 0.05)[0].velocity == pytest.approx((20.0, 0.0, 0.0))
    state.pitch[0] = 0.12
    assert entities_of(state, 0.05)[0].velocity == pytest.approx((20.0, 0.0, -20.0 * np.tan(0.1)))


def test_a_lane_change_moves_across_the_heading(told: list[Snapshot]) -> None:
    changing = told[-1].entities[1]
    level = np.hypot(*changing.velocity[:2])
    assert level > 1.0
    across = changing.velocity[1] * np.cos(changing.pose.heading) - changing.velocity[0] * np.sin(changing.pose.heading)
    assert abs(across) < level


def test_lights_are_those_that_the_scenario_switched_on(told: list[Snapshot]) -> None:
    lit = {round(one.t, 2): one.entities[1].lights for one in told}
    assert lit[0.5] == frozenset()
    assert lit[1.5] == {"indicatorLeft"}
    assert lit[3.5] == frozenset()
    assert told[-1].entities[0].lights == frozenset()
