"""Worlds with physics of their own, with events of their own, and a world that is lost."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Plan, Recording, compile_scenario, judge, load_network, open_world, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.recording.outcome import OtherPlanError
from scenario_compiler.recording.store import read_recording, write_recording
from scenario_compiler.roads import Network, Pose
from scenario_compiler.vocabulary.conditions.by_entity import CollisionCondition
from scenario_compiler.vocabulary.storyboard import ConditionGroup, Trigger, TriggerCondition
from scenario_compiler.worlds import EgoCommand, EgoState, Snapshot, WorldError, WorldEvent
from scenario_compiler.worlds.kinematic import KinematicWorld

STEER_RATE = 0.7
"""Greatest rate of the front wheels' angle, rad/s, as the built-in vehicle has it."""

MOST_SPEED = 1.0e3
"""Far above what any vehicle of these runs reaches, m/s."""


class OwnPhysics(KinematicWorld):
    """The kinematic bicycle about the rear axle once more, in a world of its own."""

    moves_ego = True

    def __init__(self, plan: Plan, network: Network) -> None:
        super().__init__(plan, network)
        self.state: EgoState | None = None

    def reset(self, snapshot: Snapshot, seed: int) -> None:
        """Take over the ego where it starts."""
        ego = snapshot.entities[0]
        self.state = EgoState(ego.pose, ego.speed, 0.0, 0.0, 0.0)
        super().reset(snapshot, seed)

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Move the ego."""
        assert self.state is not None
        vehicle, dt, before = self.plan.ego.vehicle, self.plan.step, self.state
        throttle, brake = min(max(command.throttle, 0.0), 1.0), min(max(command.brake, 0.0), 1.0)
        gain = throttle * vehicle.max_acceleration - brake * vehicle.max_deceleration
        speed = min(max(before.speed + gain * dt, 0.0), MOST_SPEED)
        wanted = min(max(command.steer, -1.0), 1.0) * math.radians(vehicle.max_steer)
        turned = min(max(wanted - before.steering, -STEER_RATE * dt), STEER_RATE * dt)
        steering = before.steering + turned
        swing = speed * math.tan(steering) / vehicle.wheelbase * dt
        middle = before.pose.heading + 0.5 * swing
        x = before.pose.x + speed * dt * math.cos(middle)
        y = before.pose.y + speed * dt * math.sin(middle)
        pose = Pose(x, y, 0.0, (before.pose.heading + swing) % math.tau, 0.01, -0.02)
        self.state = EgoState(pose, speed, steering, throttle, brake)
        return self.state


class LostWorld(OwnPhysics):
    """A world whose server ends after a while."""

    ends = 2.0

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Move the ego, as long as there is a server."""
        if snapshot.t > self.ends:
            raise WorldError("the server at localhost:2000 does not answer")
        return super().step(snapshot, command)


class WatchfulWorld(KinematicWorld):
    """A world with sensors of its own."""

    def events(self) -> Sequence[WorldEvent]:
        """Notice the same things at every step."""
        return (WorldEvent("lane_invasion", 1.0, message="solid"), WorldEvent("world_collision", 1.5, "blocker", ""))


@pytest.fixture(scope="module")
def plan() -> Plan:
    """A blocked lane, 35 s long, on a flat road."""
    conflict = Path(__file__).parents[2] / "library" / "conflicts" / "obstacle_ahead.xml"
    return compile_scenario(conflict, overrides=Overrides(perception="ideal"))


def recorded(plan: Plan, world: Callable[[Plan, Network], KinematicWorld]) -> Recording:
    """Return a run in a world."""
    with world(plan, load_network(plan.map.file)) as opened:
        return run(plan, opened)


def test_a_world_with_the_same_physics_leaves_the_same_run(plan: Plan) -> None:
    with open_world("kinematic", plan, load_network(plan.map.file)) as built_in:
        usual = run(plan, built_in)
    own = recorded(plan, OwnPhysics)
    assert len(own.t) == len(usual.t) > 200
    assert np.abs(own.x - usual.x).max() < 1e-9
    assert np.abs(own.y - usual.y).max() < 1e-9
    assert np.array_equal(own.takeover_state, usual.takeover_state)
    assert [event.kind for event in own.events] == [event.kind for event in usual.events]
    assert judge(plan, own).result == judge(plan, usual).result


def test_the_egos_state_from_the_world_is_recorded(plan: Plan) -> None:
    own = recorded(plan, OwnPhysics)
    assert own.brake[:, 0].max() > 0.1
    assert np.abs(own.steer[:, 0]).max() > 0.0
    assert np.allclose(own.pitch[1:, 0], 0.01)
    assert np.allclose(own.roll[1:, 0], -0.02)


def test_a_lost_world_keeps_the_recording_so_far(plan: Plan, tmp_path: Path) -> None:
    recording = recorded(plan, LostWorld)
    assert recording.stop_reason == "world_lost"
    assert recording.t[-1] == pytest.approx(2.0, abs=0.06)
    broken = recording.events[-2]
    assert (broken.kind, broken.cause) == ("broken_off", "SC520")
    assert broken.message == "the server at localhost:2000 does not answer"
    assert judge(plan, recording).result == "error"
    write_recording(recording, tmp_path / "recording.parquet")
    assert read_recording(tmp_path / "recording.parquet") == recording


def test_what_the_engine_logged_in_the_step_of_the_failure_is_recorded(plan: Plan) -> None:
    usual = recorded(plan, OwnPhysics)
    asked = next(event for event in usual.events if event.kind == "request")

    class LostAtTheRequest(LostWorld):
        ends = asked.t + 0.5 * plan.step

    recording = recorded(plan, LostAtTheRequest)
    assert recording.events[:-2] == tuple(one for one in usual.events if one.t <= asked.t)
    assert [one.kind for one in recording.events[-2:]] == ["broken_off", "stop"]
    assert judge(plan, recording).cause == asked.cause


def test_a_world_that_is_lost_at_once_leaves_the_first_row(plan: Plan) -> None:
    class NeverThere(KinematicWorld):
        def reset(self, snapshot: Snapshot, seed: int) -> None:
            raise WorldError("nobody listens")

    recording = recorded(plan, NeverThere)
    assert (recording.stop_reason, list(recording.t)) == ("world_lost", [0.0])


class WorldWithPole(KinematicWorld):
    """A world in which the ego touches something at 2 s and 2.1 s that its boxes do not show."""

    touched = ("", "static.pole")

    def __init__(self, plan: Plan, network: Network) -> None:
        super().__init__(plan, network)
        self.clock = 0.0

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Note the time."""
        self.clock = snapshot.t
        return super().step(snapshot, command)

    def events(self) -> Sequence[WorldEvent]:
        """Report the contact."""
        touches = any(abs(self.clock - t) < 1e-6 for t in (2.0, 2.1))
        return [WorldEvent("world_collision", self.clock, *self.touched)] if touches else []


def test_a_collision_that_only_the_world_finds_is_judged_as_one(plan: Plan) -> None:
    recording = recorded(plan, WorldWithPole)
    outcome = judge(plan, recording)
    (criterion,) = (one for one in outcome.criteria if one.criterion == "no_collision")
    assert (criterion.passed, criterion.when) == (False, 2.0)
    assert criterion.why == "collision with static.pole at 2.00 s"
    assert (outcome.result, outcome.stop_reason, outcome.collision_with) == ("fail", "collision", "")
    assert outcome.measures["collision_time"].value == 2.0
    assert recording.v[-1, 0] == 0.0
    crashes = [(event.t, event.entity) for event in recording.events if event.kind == "collision"]
    assert crashes == [(2.0, "")]
    assert "request" not in {event.kind for event in recording.events}


def test_a_collision_that_the_world_finds_with_an_entity_names_it(plan: Plan) -> None:
    world = type("WithBlocker", (WorldWithPole,), {"touched": (plan.entities[1].id, "vehicle.audi.tt")})
    touched = TriggerCondition(condition=CollisionCondition(entity="ego", with_entities=(plan.entities[1].id,)))
    trigger = Trigger(groups=(ConditionGroup(conditions=(touched,)),))
    stopping = plan.model_copy(update={"storyboard": plan.storyboard.model_copy(update={"stop": trigger})})
    recording = recorded(stopping, world)
    assert judge(plan, recording).collision_with == plan.entities[1].id
    assert recording.stop_reason == "trigger"
    assert recording.t[-1] == pytest.approx(2.0)


def test_events_of_a_world_are_recorded(plan: Plan) -> None:
    events = recorded(plan, WatchfulWorld).events
    invasion = next(event for event in events if event.kind == "lane_invasion")
    collision = next(event for event in events if event.kind == "world_collision")
    assert (invasion.t, invasion.message) == (1.0, "solid")
    assert (collision.t, collision.entity) == (1.5, "blocker")


class BrokenPhysics(OwnPhysics):
    """A world whose numbers are lost after half a second."""

    lost: EgoState

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Move the ego, then return what cannot be."""
        moved = super().step(snapshot, command)
        return moved if snapshot.t < 0.5 else self.lost


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("lost", "said"),
    [
        (EgoState(Pose(math.nan, 0.0, 0.0, 0.0, 0.0, 0.0), 10.0, 0.0, 0.0, 0.0), "'ego' has the x nan m at 0.5 s"),
        (EgoState(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), math.inf, 0.0, 0.0, 0.0), "'ego' has the speed inf m/s at 0.5 s"),
        (EgoState(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 1e308, 0.0, 0.0, 0.0), "the speed 1e+308 m/s at 0.5 s"),
        (EgoState(Pose(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 10.0, math.nan, 0.0, 0.0), "the steering angle nan rad at 0.5 s"),
    ],
)
def test_a_state_without_a_number_ends_the_run_with_its_name(plan: Plan, lost: EgoState, said: str) -> None:
    world = type("Lost", (BrokenPhysics,), {"lost": lost})
    recording = recorded(plan, world)
    assert recording.stop_reason == "error"
    assert said in next(event.message for event in recording.events if event.kind == "broken_off")
    assert judge(plan, recording).result == "error"


class Unmoved(OwnPhysics):
    """A world that says that it moves the ego, and does not."""

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Leave the ego alone."""
        return None


class Secret(OwnPhysics):
    """A world that moves the ego without saying so."""

    moves_ego = False


@pytest.mark.parametrize(
    ("world", "said"),
    [(Unmoved, "no state of the ego, but its moves_ego is True"), (Secret, "a state of the ego, but its moves_ego is")],
)
def test_a_world_moves_the_ego_if_it_says_so(plan: Plan, world: type[OwnPhysics], said: str) -> None:
    with pytest.raises(TypeError, match=said):
        recorded(plan, world)


def test_without_an_automated_vehicle_a_world_moves_nothing() -> None:
    scripted = compile_scenario(Path(__file__).parents[1] / "benchmarks" / "scripted.xosc")
    with pytest.raises(TypeError, match="a state of the ego, but the plan has no automated vehicle"):
        recorded(scripted, OwnPhysics)


def test_a_world_on_another_map_is_refused(plan: Plan) -> None:
    other = Path(__file__).parents[2] / "maps" / "motorway" / "motorway.xodr"
    with (
        open_world("kinematic", plan, load_network(other)) as world,
        pytest.raises(ValueError, match="is not the plan's"),
    ):
        run(plan, world)


def test_a_recording_of_other_entities_is_not_judged(plan: Plan) -> None:
    fewer = plan.model_copy(update={"entities": plan.entities[:1]})
    recording = recorded(plan.model_copy(update={"duration": 0.2}), OwnPhysics)
    with pytest.raises(OtherPlanError, match="has other entities than 'obstacle_ahead'"):
        judge(fewer, recording)
