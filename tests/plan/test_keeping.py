"""Actions on traffic create vehicles: their number, kinds and names."""

from __future__ import annotations

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.keeping import MOST_OF_SOURCE, MOST_OF_SWARM, kept_entities, vehicles_of
from scenario_compiler.vocabulary.actions import TrafficKind, TrafficSourceAction, TrafficSwarmAction
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.vocabulary.positions import LanePositionWord
from scenario_compiler.vocabulary.storyboard import InitAction, Storyboard

CAR = Vehicle(name="car", length=4.5, width=1.8, height=1.5, wheelbase=2.7, center=1.4)
TRUCK = CAR.model_copy(update={"name": "truck", "category": "truck"})
TRAILER = TRUCK.model_copy(update={"name": "trailer", "coupler": 6.0})
PLACE = LanePositionWord(road="1", lane=-1, s=5.0)


def swarm(vehicles: int, **more: object) -> TrafficSwarmAction:
    """Return a swarm."""
    fields = {"entity": "ego", "vehicles": vehicles, "semi_major": 100.0, "semi_minor": 50.0, **more}
    return TrafficSwarmAction.model_validate(fields)


def told(*actions: TrafficSwarmAction | TrafficSourceAction) -> tuple[list[str], list[str], set[str]]:
    """Return the ids of the vehicles of some actions, their models, and the codes that are reported."""
    sink = Diagnostics()
    storyboard = Storyboard(init=tuple(InitAction(action=one) for one in actions))
    found = list(kept_entities(storyboard, [CAR, TRUCK, TRAILER], [], 60.0, sink))
    return [one.id for one in found], [one.vehicle.name for one in found], {one.code.id for one in sink}


@pytest.mark.parametrize(
    ("rate", "duration", "count"), [(0.5, 60.0, 30), (0.01, 10.0, 1), (10.0, 600.0, MOST_OF_SOURCE), (0.0, 60.0, 0)]
)
def test_a_source_has_the_vehicles_that_its_rate_requires(rate: float, duration: float, count: int) -> None:
    assert vehicles_of(TrafficSourceAction(rate=rate, position=PLACE), duration) == count


def test_several_actions_of_one_name_have_vehicles_of_their_own() -> None:
    ids, _, codes = told(swarm(2), swarm(1, traffic="traffic"), swarm(1, traffic="other"))
    assert ids == ["traffic.1", "traffic.2", "traffic#2.1", "other.1"]
    assert codes == set()


def test_trailers_are_not_vehicles_of_traffic() -> None:
    _, models, _ = told(swarm(30, kinds=(TrafficKind(category="truck"), TrafficKind(category="car", weight=0.0))))
    assert set(models) == {"truck"}


def test_a_category_without_vehicles_is_reported() -> None:
    assert told(swarm(3, kinds=(TrafficKind(category="bus"),))) == ([], [], {"SC288"})


def test_too_many_or_too_few_vehicles_are_reported() -> None:
    ids, _, codes = told(swarm(MOST_OF_SWARM + 1))
    assert len(ids) == MOST_OF_SWARM
    assert codes == {"SC289"}
    assert told(TrafficSourceAction(rate=0.0, position=PLACE))[2] == {"SC289"}
