"""A plan is lowered to a program, variants are rows of its numbers, and faults of a program are found."""

from __future__ import annotations

from typing import get_args

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY, SUMMARY_SIZE
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.program import Numbers, build_program
from scenario_compiler.engine.program.checking import check_program
from scenario_compiler.engine.program.plan_builder import PlanBuilder
from scenario_compiler.engine.program.positions import POSITIONS, add_position
from scenario_compiler.engine.program.storyboard import add_action
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.engine.story.table import NUMBERS as CONDITION
from scenario_compiler.expressions import parse_expression
from scenario_compiler.plan.model import Entity, MapReference, Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import Action, LaneChangeAction, SensorNoiseAction, SpeedAction
from scenario_compiler.vocabulary.conditions import (
    Condition,
    DistanceCondition,
    LaneConfidenceCondition,
    ReachPositionCondition,
    SimulationTimeCondition,
    SpeedCondition,
    TakeoverStateCondition,
    TimeHeadwayCondition,
    TimeToCollisionCondition,
    TraveledDistanceCondition,
)
from scenario_compiler.vocabulary.driver import DriverModel
from scenario_compiler.vocabulary.entities import Controller, Follow, Vehicle
from scenario_compiler.vocabulary.markings import Markings
from scenario_compiler.vocabulary.positions import (
    BoundPosition,
    LanePositionWord,
    RelativeLanePosition,
    RoadPosition,
)
from scenario_compiler.vocabulary.scenario import Parameter
from scenario_compiler.vocabulary.sensors import Camera
from scenario_compiler.vocabulary.storyboard import (
    Act,
    ConditionGroup,
    Event,
    Maneuver,
    ManeuverGroup,
    Story,
    StoryAction,
    Storyboard,
    Trigger,
    TriggerCondition,
)
from scenario_compiler.vocabulary.takeover import Cause, CauseKind, Takeover
from scenario_compiler.vocabulary.weather import Weather
from tests.engine.make import Draft, highway

CAR = Vehicle(name="car", length=4.5, width=1.8, height=1.5, wheelbase=2.7, center=1.4)
CONDITIONS: tuple[Condition, ...] = (
    SimulationTimeCondition(after=1.0),
    TimeHeadwayCondition(entity="other", to="ego", below=2.0),
    DistanceCondition(entity="other", to="ego", below=50.0),
    TimeToCollisionCondition(entity="other", to="ego", below=4.0),
    SpeedCondition(entity="ego", rule="greaterThan", value=5.0),
    ReachPositionCondition(entity="ego", position=LanePositionWord(road="1", lane=-1, s=150.0)),
    TraveledDistanceCondition(entity="ego", distance=20.0),
    LaneConfidenceCondition(below=0.5),
    TakeoverStateCondition(state="request"),
)


def plan_on(network: Network) -> Plan:
    """Return a plan with an open parameter and one of every word."""
    triggers = [TriggerCondition(condition=condition, delay=0.5 * k) for k, condition in enumerate(CONDITIONS)]
    actions = (
        StoryAction(name="slower", action=SpeedAction(to=5.0, over_time=2.0)),
        StoryAction(name="over", action=LaneChangeAction(by=-1, over_time=3.0)),
        StoryAction(name="noise", action=SensorNoiseAction(sigma=60.0)),
    )
    event = Event(
        name="event",
        start=Trigger(groups=tuple(ConditionGroup(conditions=(one,)) for one in triggers)),
        actions=actions,
    )
    group = ManeuverGroup(name="group", actors=("other",), maneuvers=(Maneuver(name="m", events=(event,)),))
    board = Storyboard(stories=(Story(name="story", acts=(Act(name="act", groups=(group,)),)),))
    speed = parse_expression("v * 2")
    return Plan(
        name="plan",
        map=MapReference(name="map", file=network.path, sha256=network.sha256),
        step=0.05,
        control_every=2,
        duration=10.0,
        parameters=(Parameter(name="v", type="number", default="7"),),
        weather=Weather(),
        entities=(
            Entity(
                id="ego",
                kind="ego",
                vehicle=CAR,
                start=LanePositionWord(road="1", lane=-1, s=50.0),
                speed=speed,
                desired_speed=speed,
            ),
            Entity(
                id="other",
                kind="dynamic",
                vehicle=CAR,
                start=RelativeLanePosition(entity="blocker", distance=-60.0),
                speed=10.0,
                desired_speed=10.0,
                follow=Follow(),
            ),
            Entity(
                id="blocker",
                kind="static",
                vehicle=CAR,
                start=LanePositionWord(road="1", lane=-1, s=300.0, turn=1.5),
                speed=0.0,
                desired_speed=0.0,
            ),
        ),
        camera=Camera(),
        controller=Controller(),
        perception="ideal",
        destination=LanePositionWord(road="1", lane=-1, s=900.0),
        markings=(Markings(road="1", s_from=100.0, s_to=200.0, quality=0.5),),
        storyboard=board,
        takeover=Takeover(
            causes=(Cause(kind="path_blocked", margin=0.7),),
            driver=DriverModel(name="study_means", mu=0.876, sigma=0.5),
        ),
    )


def test_every_number_of_a_plan_has_its_slot() -> None:
    network = highway()
    p = build_program(plan_on(network), network)
    ego = p.entity_const[0]
    assert p.const[ego + slots.E_SPEED] == 14.0
    assert p.const[slots.K_BLOCKED_MARGIN] == 0.7
    assert p.const[slots.K_DRIVER_MU] == 0.876
    assert p.cause_order == [op.CAUSE_PATH_BLOCKED]
    assert sorted(p.condition_op) == sorted(
        (
            *(CONDITION["time"], CONDITION["time_gap"], CONDITION["distance"], CONDITION["time_to_collision"]),
            *(CONDITION["speed"], CONDITION["reached"], CONDITION["traveled"]),
            *(CONDITION["lane_confidence"], CONDITION["takeover_state"]),
        )
    )
    assert p.action_op == [ACTION["speed"], ACTION["lane_change"], ACTION["sensor_noise"]]
    assert p.action_entity == [1, 1, 0]
    assert p.entity_order == [0, 2, 1]
    assert p.element_end == [8, 8, 8, 8, 8, 6, 7, 8]
    assert p.ring_count == [len(CONDITIONS) - 1]


@pytest.mark.parametrize(
    "written",
    [("lane_confidence", "path_blocked", "sensor_health"), ("sensor_health", "lane_confidence", "path_blocked")],
)
def test_a_failed_camera_is_the_first_cause_wherever_it_is_written(written: tuple[CauseKind, ...]) -> None:
    network = highway()
    takeover = Takeover(causes=tuple(Cause(kind=kind) for kind in written), driver=DriverModel(name="one"))
    p = build_program(plan_on(network).model_copy(update={"takeover": takeover}), network)
    assert p.cause_order == [op.CAUSE_SENSOR_HEALTH, op.CAUSE_LANE_CONFIDENCE, op.CAUSE_PATH_BLOCKED]


def test_a_variant_differs_only_in_numbers_that_depend_on_its_parameters() -> None:
    network = highway()
    plan = plan_on(network)
    usual, fast = Numbers(plan, network).rows([{}, {"v": 10.0}]).tolist()
    p = build_program(plan, network)
    ego = p.entity_const[0]
    assert usual == p.const
    changed = [k for k, (a, b) in enumerate(zip(usual, fast, strict=True)) if a != b]
    assert changed == [ego + slots.E_SPEED, ego + slots.E_DESIRED_SPEED]
    assert fast[ego + slots.E_SPEED] == 20.0


def test_a_sweep_over_a_plan_runs_every_row() -> None:
    network = highway()
    plan = plan_on(network)
    samples = Numbers(plan, network).rows([{"v": v} for v in (5.0, 7.0, 9.0)])
    p = build_program(plan, network)
    engine = Simulation(network.tables, p, interpreted=True)
    draws = [make_draws(1, k) for k in range(3)]
    summaries, traces = engine.sweep(samples, draws, 400)
    assert [len(row) for row in summaries] == [SUMMARY_SIZE] * 3
    assert traces.shape == (3, 0)
    assert all(row[SUMMARY.index("flag")] == op.FAULT_NONE for row in summaries)
    _, traces = engine.sweep(samples, draws, 400, 401)
    assert len({tuple(trace) for trace in traces}) == 3


def test_a_posed_ego_is_left_to_another_program() -> None:
    network = highway()
    assert build_program(plan_on(network), network, posed=True).entity_motion[0] == op.MOTION_POSED


def test_a_plan_for_another_map_is_refused() -> None:
    network = highway()
    plan = plan_on(network).model_copy(update={"destination": LanePositionWord(road="9", lane=-1, s=1.0)})
    with pytest.raises(KeyError):
        build_program(plan, network)


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("condition_op", 99),
        ("action_entity", 5),
        ("entity_motion", -1),
        ("element_action", 7),
        ("position_road", 4),
        ("cause_order", 0),
        ("control_every", 0),
    ],
)
def test_an_index_outside_its_column_is_found(column: str, value: int) -> None:
    draft = Draft(highway())
    draft.ego()
    draft.event(draft.maneuver(), draft.at_time(1.0), draft.speed(0, 1.0, 1.0))
    draft.program.road_count[0] = 1
    getattr(draft.program, column)[-1] = value
    with pytest.raises(ValueError, match=column):
        check_program(draft.program)


def test_an_int_among_the_numbers_is_found() -> None:
    draft = Draft(highway())
    draft.ego()
    draft.program.road_count[0] = 1
    draft.program.const[0] = 1
    with pytest.raises(ValueError, match="const"):
        check_program(draft.program)


@pytest.mark.parametrize(("words", "numbers"), [(Action, ACTION), (Condition, CONDITION)])
def test_a_word_of_the_storyboard_has_an_entry(words: object, numbers: dict[str, int]) -> None:
    assert [word for word in get_args(words) if word.tag() not in numbers] == []


def test_a_position_has_a_row() -> None:
    assert [word for word in get_args(BoundPosition) if word not in POSITIONS] == []


def test_every_entry_is_of_a_word() -> None:
    assert set(ACTION) == {word.tag() for word in get_args(Action)} | {"path"}
    assert set(CONDITION) == {word.tag() for word in get_args(Condition)}


def test_a_word_without_a_row_is_named() -> None:
    network = highway()
    draft = PlanBuilder(plan_on(network), network)
    with pytest.raises(ValueError, match="position <road>"):
        add_position(draft, RoadPosition(road="1", s=1.0, t=0.0))
    with pytest.raises(ValueError, match="no action for <road>"):
        add_action(draft, RoadPosition(road="1", s=1.0, t=0.0), 0)
