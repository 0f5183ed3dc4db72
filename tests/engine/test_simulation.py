"""A simulation without a story: vehicles that come and go, each driven by commands of its own, in both forms alike."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenario_compiler.engine.columns.state import State, make_draws
from scenario_compiler.engine.program.stage import build_stage
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.forms.declaration import columns_of
from scenario_compiler.roads import Network, Pose, load_network
from scenario_compiler.vocabulary.entities import Vehicle
from tests.engine.make import bend, highway

CAR = Vehicle(name="car", length=4.5, width=1.8, height=1.5, wheelbase=2.7, center=1.4)
VAN = CAR.model_copy(update={"name": "van", "length": 6.0, "width": 2.2})
STEP = 0.05


def staged(network: Network, *, interpreted: bool = False) -> Simulation:
    made = Simulation(network.tables, build_stage(4, len(network.road_ids), STEP), interpreted=interpreted)
    made.reset(make_draws(1))
    return made


def columns(simulation: Simulation) -> dict[str, bytes]:
    return {name: simulation.column(name).astype(float).tobytes() for name in columns_of(State)}


@pytest.fixture(params=[False, True], ids=["compiled", "interpreted"])
def simulation(request: pytest.FixtureRequest) -> Simulation:
    return staged(highway(), interpreted=request.param)


def test_each_vehicle_obeys_its_own_commands(simulation: Simulation) -> None:
    simulation.spawn(0, CAR, Pose(10.0, -1.75, 0.0, 0.0, 0.0, 0.0))
    simulation.spawn(2, VAN, Pose(40.0, -5.25, 0.0, 0.0, 0.0, 0.0), 10.0)
    simulation.command(0, 1.0, 0.0, 0.0)
    simulation.command(2, 0.0, 0.0, 0.5)
    for _ in range(20):
        assert simulation.step()
    v, lane = simulation.column("v"), simulation.column("lane")
    assert v[0] == pytest.approx(3.5)
    assert v[2] == pytest.approx(10.0 - 4.0)
    assert (lane[0], lane[2]) == (-1, -2)
    assert list(simulation.column("present")) == [1, 0, 1, 0]


def test_reverse_gear_drives_backwards_and_the_brake_stops(simulation: Simulation) -> None:
    simulation.spawn(1, CAR, Pose(100.0, -1.75, 0.0, 0.0, 0.0, 0.0), 1.0)
    simulation.command(1, 0.5, 0.0, 0.0, reverse=True)
    for _ in range(40):
        simulation.step()
    assert simulation.column("v")[1] == pytest.approx(1.0 - 0.5 * 3.5 * 2.0)
    simulation.command(1, 0.0, 0.0, 1.0, reverse=True)
    for _ in range(20):
        simulation.step()
    assert simulation.column("v")[1] == 0.0


def test_a_posed_vehicle_goes_where_it_is_put(simulation: Simulation) -> None:
    simulation.spawn(0, CAR, Pose(10.0, -1.75, 0.0, 0.0, 0.0, 0.0), 5.0, posed=True)
    simulation.step()
    assert simulation.column("x")[0] == 10.0
    simulation.begin()
    simulation.move()
    simulation.pose(0, Pose(300.0, -8.0, 0.1, 0.0, 0.01, 0.0), 3.0)
    simulation.end()
    assert (simulation.column("x")[0], simulation.column("lane")[0]) == (300.0, -3)
    assert simulation.column("s")[0] == pytest.approx(300.0)


def test_a_removed_vehicle_leaves_nothing_to_the_next_in_its_place(simulation: Simulation) -> None:
    simulation.spawn(0, CAR, Pose(10.0, -1.75, 0.0, 0.0, 0.0, 0.0), 20.0)
    simulation.command(0, 1.0, 1.0, 0.0)
    for _ in range(10):
        simulation.step()
    simulation.remove(0)
    assert list(simulation.column("present")) == [0] * 4
    simulation.spawn(0, VAN, Pose(50.0, -1.75, 0.0, 0.0, 0.0, 0.0))
    simulation.step()
    assert [simulation.column(name)[0] for name in ("v", "steer", "x")] == [0.0, 0.0, 50.0]


def test_boxes_that_overlap_are_in_contact(simulation: Simulation) -> None:
    for k, x in enumerate((10.0, 14.4, 30.0)):
        simulation.spawn(k, CAR, Pose(x, -1.75, 0.0, 0.0, 0.0, 0.0))
    simulation.step()
    assert simulation.contacts() == [(0, 1)]
    simulation.remove(1)
    simulation.step()
    assert simulation.contacts() == []


def test_a_vehicle_stands_on_the_slope_below_it(town: Network) -> None:
    steep = max(
        ((road, s) for road in town.road_ids for s in (10.0, 30.0) if s < town.road(road).length),
        key=lambda at: abs(town.grade(*at)),
    )
    lane = next(one.lane for one in town.lanes_at(*steep) if one.type == "driving")
    pose = town.lane_pose(steep[0], lane, steep[1])
    made = staged(town)
    made.spawn(0, CAR, Pose(pose.x, pose.y, pose.z + 0.5, pose.heading, 0.0, 0.0))
    made.step()
    assert made.column("z")[0] == pytest.approx(pose.z, abs=1e-6)
    assert made.column("pitch")[0] == pytest.approx(pose.pitch, abs=1e-6)


@pytest.fixture(scope="module")
def town() -> Network:
    return load_network(Path(__file__).parents[2] / "maps" / "town_grid" / "town_grid.xodr")


commands = st.tuples(
    st.integers(0, 3), st.floats(0, 1), st.floats(-1, 1), st.floats(0, 1), st.booleans(), st.sampled_from("csrc")
)


@settings(max_examples=25, deadline=None)
@given(st.lists(commands, max_size=20))
def test_both_forms_leave_the_same_bytes(orders: list[tuple[int, float, float, float, bool, str]]) -> None:
    network = bend(80.0)
    slow, fast = staged(network, interpreted=True), staged(network)
    assert fast.form.name == "compiled"
    for entity, throttle, steer, brake, reverse, what in orders:
        for one in (slow, fast):
            if what == "s":
                at = network.lane_pose("1", -1, 20.0 + 20.0 * throttle)
                one.spawn(entity, VAN if reverse else CAR, at, 20.0 * brake)
            elif what == "r":
                one.remove(entity)
            else:
                one.command(entity, throttle, steer, brake, reverse=reverse)
            for _ in range(5):
                one.step()
        assert columns(slow) == columns(fast)
        assert slow.contacts() == fast.contacts()


def test_what_is_read_cannot_be_written(simulation: Simulation) -> None:
    with pytest.raises(ValueError, match="read-only"):
        simulation.column("x")[0] = 1.0
    assert math.isfinite(float(np.sum(simulation.column("x"))))


@pytest.mark.parametrize("entity", [-1, 4, 10**7])
def test_an_entity_that_the_program_does_not_have_is_refused(simulation: Simulation, entity: int) -> None:
    before = columns(simulation)
    here = Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    uses: tuple[Callable[[], object], ...] = (
        lambda: simulation.spawn(entity, CAR, here),
        lambda: simulation.let_pose(entity, posed=True),
        lambda: simulation.remove(entity),
        lambda: simulation.command(entity, 1.0, 0.0, 0.0),
        lambda: simulation.pose(entity, here, 1.0),
        lambda: simulation.touched(entity),
    )
    for use in uses:
        with pytest.raises(IndexError, match=f"there is no entity {entity}: the program has 4"):
            use()
    assert columns(simulation) == before


@pytest.mark.parametrize("count", [0, 1, 10**4])
def test_a_reset_needs_all_draws_of_a_run(simulation: Simulation, count: int) -> None:
    with pytest.raises(ValueError, match="draws"):
        simulation.reset([0.5] * count)
