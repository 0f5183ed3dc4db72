"""Scenarios without an automated vehicle: plan, run, judgement and pictures of scripted vehicles only."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.lower import lower
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import read_plan, sealed, write_plan
from scenario_compiler.recording.outcome import Outcome, judge
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.trajectory import write_trajectory
from scenario_compiler.report.folder import write_run_folder
from scenario_compiler.report.gallery import start_picture
from scenario_compiler.report.preview import draw_preview
from scenario_compiler.report.run import Run
from scenario_compiler.roads import Network
from scenario_compiler.runtime import open_world, run
from scenario_compiler.vocabulary.actions import MessageAction, SpeedAction, WeatherAction
from scenario_compiler.vocabulary.criteria import NoCollision
from scenario_compiler.vocabulary.entities import Dynamic, Vehicle
from scenario_compiler.vocabulary.positions import LanePositionWord
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.storyboard import InitAction, Storyboard
from scenario_compiler.vocabulary.weather import Weather
from tests.engine.make import highway

CAR = Vehicle(name="car", length=4.5, width=1.8, height=1.5, wheelbase=2.7, center=1.4)
BOTH = (
    Dynamic(id="first", model="car", start=LanePositionWord(road="1", lane=-1, s=50.0)),
    Dynamic(id="second", model="car", start=LanePositionWord(road="1", lane=-1, s=80.0)),
)
NOWHERE = Dynamic(id="nowhere", model="car", speed=2.0)
INIT = (
    InitAction(entity="first", action=SpeedAction(to=5.0)),
    InitAction(entity="first", action=SpeedAction(to=10.0)),
    InitAction(action=MessageAction(text="go")),
    InitAction(action=WeatherAction(precipitation=30.0)),
)


def planned(network: Network, *actors: Dynamic, init: tuple[InitAction, ...] = ()) -> Plan:
    sink = Diagnostics()
    scenario = Scenario(
        name="scripted",
        map="highway",
        duration=4.0,
        weather=Weather(),
        actors=actors,
        vehicles=(CAR,),
        storyboard=Storyboard(init=init),
        criteria=(NoCollision(),) if actors else (),
    )
    plan = lower(scenario, network, sink, values={})
    assert not sink.found
    assert plan is not None
    return plan


def ran(plan: Plan, network: Network) -> tuple[Recording, Outcome]:
    recording = run(plan, open_world("kinematic", plan, network))
    return recording, judge(plan, recording)


def test_init_actions_start_in_order_and_the_first_entity_is_reported() -> None:
    network = highway()
    plan = planned(network, *BOTH, init=INIT)
    assert (plan.controller, plan.perception, plan.ego.id, plan.ego.kind) == (None, "ideal", "first", "dynamic")
    recording, outcome = ran(plan, network)
    assert recording.v[0].tolist() == [10.0, 0.0]
    assert np.isnan(recording.confidence_left).all()
    assert [event.message for event in recording.events if event.kind == "message"] == ["go"]
    assert (outcome.result, outcome.collision_with, outcome.timeline) == ("fail", "second", ())
    assert sorted(outcome.measures) == [
        "collision_speed",
        "collision_time",
        "final_speed",
        "maximum_drac",
        "minimum_distance",
        "minimum_post_encroachment_time",
        "minimum_time_headway",
        "minimum_time_to_collision",
        "time_off_lanes",
    ]
    assert outcome.measures["collision_speed"].value == 10.0


def test_the_plan_can_be_written_and_read(tmp_path: Path) -> None:
    plan = sealed(planned(highway(), *BOTH, NOWHERE, init=INIT))
    write_plan(plan, tmp_path / "plan.json")
    assert read_plan(tmp_path / "plan.json", Diagnostics()) == plan


def test_an_entity_without_a_start_moves_straight_on_beside_the_roads(tmp_path: Path) -> None:
    network = highway()
    plan = planned(network, NOWHERE, *BOTH, init=(InitAction(entity="nowhere", action=SpeedAction(to=2.0)),))
    assert list(plan.derived) == ["first", "second"]
    recording, _ = ran(plan, network)
    assert recording.x[0, 0] == 0.0
    assert recording.x[-1, 0] == pytest.approx(8.0)
    assert set(recording.road[:, 0].tolist()) == {-1}
    write_trajectory(recording, tmp_path / "t.csv")
    assert (tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()[1] == "0,nowhere,0,0,0,2,-1,0,0,0"


@pytest.mark.parametrize("actors", [(), (NOWHERE,), BOTH])
def test_the_report_says_nothing_of_takeovers(tmp_path: Path, actors: tuple[Dynamic, ...]) -> None:
    network = highway()
    plan = planned(network, *actors)
    recording, outcome = ran(plan, network)
    assert outcome.duration == pytest.approx(4.0)
    write_run_folder(Run(plan, network, recording, outcome), tmp_path / "run")
    page = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert "akeover" not in page.partition("<body")[2].replace("Request: time", "")
    draw_preview(plan, network, tmp_path / "preview.svg")


def test_a_picture_of_the_start_needs_a_start() -> None:
    network = highway()
    assert start_picture(planned(network, NOWHERE, *BOTH), network)[1:4] == b"PNG"
    with pytest.raises(ValueError, match="has a place"):
        start_picture(planned(network, NOWHERE), network)
