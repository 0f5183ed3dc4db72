"""A person at the wheel takes over with or without a request, hands back, leaves; inputs repeat the run bit for bit."""

from __future__ import annotations

import shlex
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.controllers.person import PersonInput, RecordedPerson
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.recording.names import SOURCES, WISHES, Wish
from scenario_compiler.recording.outcome import judge
from scenario_compiler.recording.recording import Recording
from scenario_compiler.recording.store import read_recording, write_recording
from scenario_compiler.report.folder import write_run_folder
from scenario_compiler.report.run import Run
from scenario_compiler.report.wording import command
from scenario_compiler.runtime import open_world
from scenario_compiler.runtime.loop import Execution, run
from tests.command import call

SOURCE = {name: code for code, name in SOURCES.items()}

CONFLICT = """\
<scenarios version="1">
  <scenario name="it" map="town_grid" duration="20">
    <ego speed="13.9"><start><lane road="3" lane="-1" s="20"/></start></ego>
    <static id="blocker" model="vehicle.audi.tt"><at><ahead_of entity="ego" distance="160"/></at></static>
    <takeover><driver><person/></driver></takeover>
    <criteria><no_collision/></criteria>
  </scenario>
</scenarios>
"""


REAR_END = """\
<scenarios version="1">
  <scenario name="it" map="town_grid" duration="10">
    <ego speed="10"><start><lane road="1" lane="-1" s="80"/></start></ego>
    <dynamic id="behind" model="vehicle.audi.tt" speed="20">
      <start><lane road="1" lane="-1" s="60"/></start>
    </dynamic>
    <takeover><driver><person/></driver></takeover>
  </scenario>
</scenarios>
"""


class Scripted:
    """A person who does what a function of time and state says."""

    def __init__(self, does: Callable[[float, str], PersonInput]) -> None:
        self.act = does


@pytest.fixture(scope="module")
def conflict(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("person") / "it.xml"
    file.write_text(CONFLICT, encoding="utf-8")
    return file


@pytest.fixture(scope="module")
def compiled(conflict: Path) -> Compilation:
    done = compile_target(conflict, {}, Diagnostics(), overrides=Overrides(perception="ideal", step=0.02))
    assert done is not None
    return done


def driven(compiled: Compilation, does: Callable[[float, str], PersonInput], *, interpreted: bool = False) -> Recording:
    with open_world("kinematic", compiled.plan, compiled.network) as world:
        return run(compiled.plan, world, person=Scripted(does), interpreted=interpreted)


def test_a_person_who_takes_over_between_two_control_steps_does_so_at_once(compiled: Compilation) -> None:
    """The response is timed to the step, however rarely the automation looks."""
    plan = compiled.plan.model_copy(update={"control_every": 50})
    with open_world("kinematic", plan, compiled.network) as world:
        recording = run(plan, world, person=Scripted(lambda t, _: PersonInput(wish="take_over" if t > 0.29 else "")))
    assert first(recording, "override") == pytest.approx(0.3)
    assert set(recording.control[recording.t > 0.31]) == {SOURCE["person"]}


def brakes_when_asked(t: float, state: str) -> PersonInput:
    del t
    if state in ("automated", "warning"):
        return PersonInput()
    return PersonInput(brake=0.5, steer=0.01, wish="" if state == "manual" else "take_over")


def first(recording: Recording, kind: str) -> float:
    return next(event.t for event in recording.events if event.kind == kind)


def test_a_person_answers_and_stops_by_their_own_brake(compiled: Compilation) -> None:
    recording = driven(compiled, brakes_when_asked)
    kinds = [event.kind for event in recording.events]
    assert "request" in kinds
    assert first(recording, "response") - first(recording, "request") <= 0.1
    after = recording.t > first(recording, "response") + 0.05
    assert set(recording.control[after]) == {SOURCE["person"]}
    assert (recording.brake[after, 0] == 0.5).all()
    assert recording.v[-1, 0] == pytest.approx(0.0, abs=0.01)
    assert "collision" not in kinds
    stop = next(event for event in recording.events if event.kind == "standstill")
    assert (stop.cause, stop.message) == ("driver", "across_edge")
    assert stop.t == recording.t[np.argmax((recording.v[:, 0] == 0.0) & after)]
    assert recording.stop_reason == "duration"


@pytest.mark.parametrize(("throttle", "deceleration"), [(0.0, 0.4), (0.02, 0.4 * 0.98 - 0.02 * 3.5), (1.0, -3.5)])
def test_a_car_that_a_person_drives_slows_down_without_pedals(
    compiled: Compilation, throttle: float, deceleration: float
) -> None:
    recording = driven(compiled, lambda t, state: PersonInput(throttle, wish="take_over" if t == 0.0 else ""))
    over = (recording.t > 0.5) & (recording.t < 2.0)
    assert recording.a[over, 0] == pytest.approx(-deceleration)
    assert (recording.brake[over, 0] == 0.0).all()


def test_a_person_takes_over_without_being_asked_and_hands_back(compiled: Compilation) -> None:
    def does(t: float, state: str) -> PersonInput:
        if t < 0.5 and state == "automated":
            return PersonInput(wish="take_over", throttle=0.3)
        return PersonInput(throttle=0.3, wish="hand_back" if t > 1.0 and state == "manual" else "")

    recording = driven(compiled, does)
    assert first(recording, "override") < 0.1
    assert first(recording, "hand_back") == pytest.approx(1.0, abs=0.11)
    assert first(recording, "activation") >= first(recording, "hand_back")
    sources = recording.control[np.flatnonzero(np.diff(recording.control, prepend=-1))]
    assert list(sources[:3]) == [SOURCE["automation"], SOURCE["person"], SOURCE["automation"]]
    assert recording.throttle[(recording.t > 0.2) & (recording.t < 1.0), 0] == pytest.approx(0.3)


def test_control_is_not_handed_back_while_there_is_a_cause(compiled: Compilation) -> None:
    def does(t: float, state: str) -> PersonInput:
        del t
        return PersonInput(
            throttle=0.1, wish="hand_back" if state == "manual" else "take_over" if state == "request" else ""
        )

    recording = driven(compiled, does)
    asks = recording.blocked_distance <= 7.0 * recording.v[:, 0]
    by_hand = (recording.t > first(recording, "response")) & (recording.t < first(recording, "hand_back"))
    assert asks[by_hand][:-10].mean() > 0.9
    assert not asks[recording.t >= first(recording, "hand_back") - 1e-6][0]


def test_the_vehicle_stops_where_a_person_leaves(compiled: Compilation) -> None:
    def does(t: float, state: str) -> PersonInput:
        return PersonInput(wish="leave" if t > 1.0 else "take_over" if state == "automated" else "")

    recording = driven(compiled, does)
    assert first(recording, "minimum_risk") == pytest.approx(1.0, abs=0.11)
    assert recording.stop_reason == "standstill"
    assert recording.control[-1] == SOURCE["minimum-risk manoeuvre"]


def test_a_vehicle_whose_person_leaves_flashes_and_does_not_blame_an_answered_request(compiled: Compilation) -> None:
    def does(t: float, state: str) -> PersonInput:
        return PersonInput(wish="leave" if t > 6.0 else "take_over" if state == "request" else "")

    recording = driven(compiled, does)
    assert next(event.cause for event in recording.events if event.kind == "request") == "path_blocked"
    begun = next(event for event in recording.events if event.kind == "minimum_risk")
    assert begun.t == pytest.approx(6.0, abs=0.11)
    assert begun.cause == ""
    assert [(event.t, event.value) for event in recording.events if event.kind == "hazard_lights"] == [(begun.t, 1.0)]


def when_due(wishes: list[tuple[float | str, Wish]], throttle: float = 0.1) -> Callable[[float, str], PersonInput]:
    """Return a person who wishes one thing after another, each from a time, s, or in a state of the takeover."""
    left = list(wishes)

    def does(t: float, state: str) -> PersonInput:
        due = bool(left) and (state == left[0][0] if isinstance(left[0][0], str) else t >= left[0][0])
        return PersonInput(throttle=0.1, wish=left.pop(0)[1] if due else "")

    return does


LEAVES_AND_RETURNS: list[tuple[float | str, Wish]] = [
    (0.5, "take_over"),
    (1.0, "leave"),
    (1.5, "take_over"),
    (2.0, "hand_back"),
]


def test_a_person_who_returns_without_a_request_does_not_answer_one(compiled: Compilation) -> None:
    recording = driven(compiled, when_due([*LEAVES_AND_RETURNS, ("request", "take_over")]))
    kinds = ("override", "minimum_risk", "hazard_lights", "hand_back", "request", "response")
    happened = [event for event in recording.events if event.kind in kinds]
    assert [event.kind for event in happened] == [
        *("override", "minimum_risk", "hazard_lights", "override", "hazard_lights", "hand_back"),
        *("request", "response"),
    ]
    assert [event.value for event in happened if event.kind == "hazard_lights"] == [1.0, 0.0]
    outcome = judge(compiled.plan, recording)
    assert outcome.resolution == "driver"
    assert outcome.measures["takeover_time"].value == pytest.approx(0.02)
    assert outcome.takeovers[0].takeover_time == outcome.measures["takeover_time"].value


def test_a_persons_leaving_before_a_request_does_not_hide_how_that_ended(compiled: Compilation) -> None:
    outcome = judge(compiled.plan, driven(compiled, when_due(LEAVES_AND_RETURNS)))
    assert outcome.resolution == outcome.takeovers[0].resolution == "minimum_risk"
    assert outcome.measures["takeover_time"].value is None


@pytest.mark.parametrize(
    ("before", "wish"),
    [([], "take_over"), ([], "request"), ([(0.1, "take_over")], "leave"), ([(0.1, "take_over")], "hand_back")],
)
def test_nobody_has_wishes_after_a_collision(
    tmp_path: Path, before: list[tuple[float | str, Wish]], wish: Wish
) -> None:
    """A car drives into the car from behind."""
    file = tmp_path / "it.xml"
    file.write_text(REAR_END, encoding="utf-8")
    done = compile_target(file, {}, Diagnostics(), overrides=Overrides(perception="ideal", step=0.02))
    assert done is not None
    without = driven(done, when_due(before))
    crash = first(without, "collision")
    assert without.t[-1] > crash + 0.2
    assert driven(done, when_due([*before, (crash + 0.1, wish)])).events == without.events


def test_nobody_answers_for_a_person(compiled: Compilation) -> None:
    recording = driven(compiled, lambda t, state: PersonInput())
    kinds = [event.kind for event in recording.events]
    assert "response" not in kinds
    assert "minimum_risk" in kinds


def test_both_forms_of_the_engine_agree(compiled: Compilation) -> None:
    one, other = (driven(compiled, brakes_when_asked, interpreted=form) for form in (False, True))
    assert one.trajectory_hash == other.trajectory_hash
    assert one == other


def test_a_run_is_repeated_bit_for_bit_from_its_inputs(compiled: Compilation, tmp_path: Path) -> None:
    def wanders(t: float, state: str) -> PersonInput:
        steer = 0.02 * np.sin(3.0 * t).item()
        return PersonInput(0.2 + 0.1 * steer, 0.0, steer, "take_over" if state in ("automated", "request") else "")

    recorded = driven(compiled, wanders)
    write_recording(recorded, tmp_path / "recording.parquet")
    kept = read_recording(tmp_path / "recording.parquet")
    assert kept == recorded
    assert {WISHES[code] for code in kept.person_wish} == {"", "take_over"}
    with open_world("kinematic", compiled.plan, compiled.network) as world:
        again = run(compiled.plan, world, person=RecordedPerson(kept))
    assert again == recorded


def test_a_command_repeats_a_persons_run_and_a_model_stands_in(
    conflict: Path, compiled: Compilation, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = ("run", conflict, "--perception", "ideal", "--dt", "0.02")
    assert call(*target) == 2
    assert "has a person at the wheel" in capsys.readouterr().err
    assert call(*target, "--pilot", "-o", tmp_path / "pilot") == 0
    pilot = read_recording(tmp_path / "pilot" / "recording.parquet")
    assert SOURCE["driver model"] in pilot.control
    assert SOURCE["person"] not in pilot.control
    (tmp_path / "by_hand").mkdir()
    write_recording(driven(compiled, brakes_when_asked), tmp_path / "by_hand" / "recording.parquet")
    assert call(*target, "--inputs", tmp_path / "by_hand", "-o", tmp_path / "again") == 0
    assert call("compare", tmp_path / "by_hand" / "recording.parquet", tmp_path / "again" / "recording.parquet") == 0


def test_inputs_that_would_have_no_effect_or_another_one_are_refused(
    conflict: Path, compiled: Compilation, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ideal = ("run", conflict, "--perception", "ideal")
    assert call(*ideal, "--pilot", "-o", tmp_path / "pilot") == 0
    (tmp_path / "by_hand").mkdir()
    write_recording(driven(compiled, brakes_when_asked), tmp_path / "by_hand" / "recording.parquet")
    capsys.readouterr()
    for options, reason in {
        ("--inputs", tmp_path / "pilot"): "there is no person at the wheel of the run in",
        ("--inputs", tmp_path / "by_hand"): "belong to other time steps: 0.02 s, the plan's 0.05 s",
        ("--inputs", tmp_path / "by_hand", "--pilot"): "--inputs has no effect: there is no person at the wheel",
    }.items():
        assert call(*ideal, *options) == 2
        assert reason in capsys.readouterr().err


def test_the_command_in_a_persons_report_repeats_the_run_with_its_seed(
    compiled: Compilation, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with open_world("kinematic", compiled.plan, compiled.network) as world:
        recording = run(compiled.plan, world, seed=7, person=Scripted(brakes_when_asked))
    finished = Run(compiled.plan, compiled.network, recording, judge(compiled.plan, recording))
    write_run_folder(finished, tmp_path / "by_hand")
    monkeypatch.chdir(tmp_path / "by_hand")
    assert call(*shlex.split(command(finished))[1:]) == 0
    assert read_recording(Path("again/recording.parquet")) == recording
    assert call("run", "plan.json", "--inputs", ".", "-o", "without_seed") == 0
    assert read_recording(Path("without_seed/recording.parquet")).header.seed == 7


def test_a_run_that_its_user_ended_ends_there_again(compiled: Compilation) -> None:
    with open_world("kinematic", compiled.plan, compiled.network) as world:
        execution = Execution(compiled.plan, world, 1, 0, person=Scripted(brakes_when_asked))
        while execution.state.clock[0] < 5.0:
            execution.advance()
        recording = execution.finish("user")
        again = run(compiled.plan, world, person=RecordedPerson(recording))
    assert recording.stop_reason == "user"
    assert again == recording


def test_an_observer_lets_the_automation_request(compiled: Compilation) -> None:
    """A request of nobody but the experimenter is scheduled; it comes again from the recorded inputs."""

    def asked(t: float, state: str) -> PersonInput:
        return PersonInput(wish="request" if t >= 0.5 and state == "automated" else "")

    recording = driven(compiled, asked)
    request = next(event for event in recording.events if event.kind == "request")
    assert request.cause == "scheduled"
    assert 0.5 <= request.t < 0.7
    with open_world("kinematic", compiled.plan, compiled.network) as world:
        again = run(compiled.plan, world, person=RecordedPerson(recording))
    assert again.trajectory_hash == recording.trajectory_hash
    assert [event.kind for event in again.events] == [event.kind for event in recording.events]
