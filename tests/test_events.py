"""The camera, the weather and the events of a run are those of the scenario, with and without the camera."""

from __future__ import annotations

import math
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler import Outcome, Recording, judge, open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.plan.painted import covered_pieces
from scenario_compiler.recording.events import write_events
from scenario_compiler.runtime.log import NAMED
from scenario_compiler.runtime.loop import Execution
from scenario_compiler.runtime.messages import TEXTS
from scenario_compiler.vocabulary.sensors import FailureKind, Perception
from scenario_compiler.worlds import EgoCommand, EgoState, Snapshot
from scenario_compiler.worlds.kinematic import KinematicWorld, degradation_of
from tests.playing import played_until

FILE = """<scenarios version="1">
  <scenario name="made" map="highway_loop" duration="{duration}" step="0.05" control_every="2">
    {weather}
    <ego speed="{speed}"><start><spawn_point name="straight"/></start>{camera}{whens}</ego>
    {markings}
    <takeover><cause kind="sensor_health"/><driver takeover_time="{answer}"/><message language="de"/></takeover>
    <criteria>{criteria}</criteria>
  </scenario>
</scenarios>"""


def compiled(folder: Path, perception: Perception = "ideal", **parts: object) -> Compilation:
    usual = {
        "duration": 4,
        "speed": 15,
        "answer": 30,
        "weather": "",
        "camera": "",
        "markings": "",
        "whens": "",
        "criteria": "",
    }
    path = folder / "made.xml"
    path.write_text(FILE.format(**{**usual, **parts}), encoding="utf-8")
    sink = Diagnostics()
    compilation = compile_target(str(path), {}, sink, overrides=Overrides(perception=perception))
    assert compilation is not None, "\n".join(as_text(one) for one in sink)
    return compilation


def played(compilation: Compilation) -> tuple[Recording, Outcome]:
    recording = run(compilation.plan, open_world("kinematic", compilation.plan, compilation.network))
    return recording, judge(compilation.plan, recording)


def test_the_stages_of_a_response_have_their_time_since_the_request(tmp_path: Path) -> None:
    recording, outcome = played(
        compiled(tmp_path, answer=2, whens="<when><time after='0.5'/><do><request/></do></when>")
    )
    asked = outcome.measures["request_time"].value
    values = {event.kind: event.value for event in recording.events}
    times = {event.kind: event.t for event in recording.events}
    assert asked is not None
    for kind in ("eyes_on", "hands_on"):
        assert times[kind] > asked
        assert values[kind] == pytest.approx(times[kind] - asked, abs=1e-8)
        assert values[kind] == pytest.approx(outcome.measures[f"{kind}_time"].value)


def times(recording: Recording, kind: str) -> list[float]:
    return [round(event.t, 2) for event in recording.events if event.kind == kind]


SLIGHT = {"noise": 0.1, "dropout": 0.1, "freeze": 0.1, "blackout": 0.4, "blur": 0.12, "dirt": 0.25}


@pytest.mark.parametrize(
    ("kind", "perception"),
    [
        *((kind, "ideal") for kind in SLIGHT),
        *((kind, "camera") for kind in ("dropout", "blackout", "dirt")),
        *(pytest.param(kind, "camera", marks=pytest.mark.slow) for kind in ("noise", "freeze", "blur")),
    ],
)
def test_a_severe_failure_causes_a_request_and_a_slight_one_does_not(
    tmp_path: Path, kind: str, perception: Perception
) -> None:
    for amount, requests in ((1.0, 1), (SLIGHT[kind], 0)):
        failure = f'<camera><failure kind="{kind}" onset="1" amount="{amount}"/></camera>'
        found = compiled(tmp_path, perception, camera=failure, duration=3.5)
        recording = played_until("request", found.plan, found.network)
        assert len(times(recording, "request")) == requests, (kind, amount)
        assert judge(found.plan, recording).cause == ("sensor_health" if requests else "")
        assert times(recording, "failure") == [1.0]


@pytest.mark.parametrize(("severity", "sigma"), [(1, 0.08), (3, 0.18), (5, 0.38)])
def test_a_severity_is_that_of_imagenet_c(tmp_path: Path, severity: int, sigma: float) -> None:
    failure = f'<camera><failure kind="noise" severity="{severity}"/></camera>'
    recording, _ = played(compiled(tmp_path, "ideal", camera=failure, duration=0.2))
    assert recording.sigma[-1] == pytest.approx(255.0 * sigma)


@pytest.mark.parametrize(
    ("weather", "kind", "amount"),
    [
        ("ClearNoon", "noise", 0.4),
        ("ClearNight", "noise", 0.5),
        ("ClearNoon", "blur", 0.4),
        ("ClearNoon", "blur", 0.5),
        ("HardRainNoon", "blackout", 0.9),
        ("ClearNoon", "dirt", 0.4),
        ("ClearNoon", "dirt", 0.85),
        ("ClearNoon", "impulse_noise", 0.19),
        ("ClearNight", "impulse_noise", 0.22),
        ("ClearNoon", "overexposure", 0.6),
        ("ClearNoon", "overexposure", 0.8),
        ("ClearNoon", "dead_rows", 0.7),
        ("ClearNoon", "dead_rows", 0.97),
        ("ClearNoon", "quantisation", 0.7),
        ("ClearNoon", "quantisation", 0.85),
        ("ClearNoon", "quantisation", 0.92),
        ("ClearNoon", "quantisation", 1.0),
    ],
)
def test_without_a_camera_the_health_is_the_one_that_the_camera_measures(
    tmp_path: Path, weather: str, kind: str, amount: float
) -> None:
    parts = {"camera": f'<camera><failure kind="{kind}" amount="{amount}"/></camera>', "duration": 0.6}
    parts["weather"] = f'<weather preset="{weather}"/>'
    ideal, camera = (played(compiled(tmp_path, one, **parts))[0] for one in ("ideal", "camera"))
    assert float(np.mean(ideal.sensor_health[-4:])) == pytest.approx(float(np.mean(camera.sensor_health[-4:])), abs=0.2)


@pytest.mark.parametrize(("onset", "ramp"), [(0, 0), (0.4, 0), (0.4, 1)])
def test_while_late_images_are_awaited_the_camera_is_not_healthy(tmp_path: Path, onset: float, ramp: float) -> None:
    failure = f'<camera><failure kind="latency" amount="0.3" onset="{onset}" ramp="{ramp}"/></camera>'
    ideal, camera = (played(compiled(tmp_path, one, camera=failure, duration=2))[0] for one in ("ideal", "camera"))
    unhealthy = ideal.sensor_health < 0.1
    assert 0.2 <= 0.05 * unhealthy.sum() <= 0.35
    assert np.array_equal(unhealthy, camera.sensor_health < 0.1)


@pytest.mark.parametrize("kind", ["dirt", pytest.param("overexposure", marks=pytest.mark.slow)])
def test_a_failure_that_leaves_the_ground_unchanged_is_noticed_later(tmp_path: Path, kind: str) -> None:
    failure = f'<camera><failure kind="{kind}" amount="0.85" onset="0.5"/></camera>'
    for perception in ("ideal", "camera"):
        recording, _ = played(compiled(tmp_path, perception, camera=failure, duration=4))
        unhealthy = recording.t[recording.sensor_health < 0.3]
        assert unhealthy[0] == pytest.approx({"dirt": 2.2, "overexposure": 2.7}[kind], abs=0.4)


@pytest.mark.parametrize(
    "what",
    [
        "motion_blur",
        'misalignment" yaw="2',
    ],
)
def test_a_failure_that_only_pictures_show_is_ignored_with_ideal_perception_and_reported(
    tmp_path: Path, what: str
) -> None:
    failure = f'<camera><failure kind="{what}" amount="0.5"/></camera>'
    compiled(tmp_path, camera=failure)
    modes: tuple[Perception, ...] = ("ideal", "camera")
    for perception in modes:
        sink = Diagnostics()
        compile_target(str(tmp_path / "made.xml"), {}, sink, overrides=Overrides(perception=perception))
        assert ("SC407" in {one.code.id for one in sink}) is (perception == "ideal")


@pytest.mark.parametrize("kind", ["impulse_noise", "overexposure", "dead_rows"])
def test_such_a_failure_takes_the_lane_from_the_camera(tmp_path: Path, kind: str) -> None:
    """It takes up to a second, because lines that were seen a moment ago are remembered."""
    failure = f'<camera><failure kind="{kind}" onset="0.5"/></camera>'
    recording, _ = played(compiled(tmp_path, "camera", camera=failure, duration=1.5))
    sides = np.fmax(recording.confidence_left, recording.confidence_right)
    assert sides[9] > 0.8
    assert sides[-1] < 0.3


def test_a_long_exposure_smears_while_the_car_moves_and_bends(tmp_path: Path) -> None:
    """The image of a moving car is smeared according to its speed and yaw rate, that of a standing one is not."""
    failure = '<camera><failure kind="motion_blur" severity="5"/></camera>'
    done = compiled(tmp_path, "camera", camera=failure, duration=0.2)
    still = compiled(tmp_path, "camera", duration=0.2)
    with open_world("kinematic", done.plan, done.network) as world:
        moving = Execution(done.plan, world, 1).snapshot()
        assert moving.faults.exposure == pytest.approx(0.1185)
        ego = moving.entities[0]._replace(steering=0.05)
        seen = degradation_of(moving._replace(entities=[ego]), 2.7)
        assert seen.speed == 15.0
        assert seen.yaw_rate == pytest.approx(15.0 * math.tan(0.05) / 2.7)
        sharp = Execution(still.plan, world, 1).snapshot()
        standing = moving._replace(entities=[moving.entities[0]._replace(speed=0.0)])
        images = [np.asarray(world.observe(one).image, int) for one in (sharp, moving, standing)]
    assert np.array_equal(images[0], images[2])
    assert np.abs(images[1] - images[0])[100:].mean() > 2.0


def test_misalignments_add_up_and_the_lane_detector_does_not_know_them(tmp_path: Path) -> None:
    """A camera turned to the left sees the lane too far to the right, and the car drives there with confidence."""
    failures = (
        '<camera><failure kind="misalignment" onset="0.5" ramp="1" yaw="3"/>'
        '<failure kind="misalignment" amount="0.5" yaw="-1" pitch="2" roll="1"/></camera>'
    )
    done = compiled(tmp_path, "camera", camera=failures, duration=4)
    with open_world("kinematic", done.plan, done.network) as world:
        execution, turned = Execution(done.plan, world, 1), {}
        while execution.going:
            execution.advance()
            now = execution.snapshot()
            turned[round(now.t, 2)] = tuple(round(math.degrees(one), 6) for one in now.faults.turned)
        recording = execution.finish()
    assert turned[0.3] == (-0.5, 1.0, 0.5)
    assert turned[1.0] == (1.0, 1.0, 0.5)
    assert turned[3.0] == (2.5, 1.0, 0.5)
    assert recording.off[-1, 0] < -0.3
    assert min(recording.confidence_left[-1], recording.confidence_right[-1]) > 0.5


def test_a_failure_grows_and_declines_in_its_ramp(tmp_path: Path) -> None:
    failure = '<camera><failure kind="noise" onset="1" duration="2" ramp="0.5" amount="0.25"/></camera>'
    recording, _ = played(compiled(tmp_path, camera=failure))
    at = {round(float(t), 2): float(sigma) for t, sigma in zip(recording.t, recording.sigma, strict=True)}
    assert at[0.95] == 0.0
    assert at[1.25] == pytest.approx(10.0)
    assert at[2.0] == pytest.approx(20.0)
    assert at[2.75] == pytest.approx(10.0)
    assert at[3.1] == 0.0
    assert times(recording, "failure_end") == [3.0]


def test_failures_begin_and_end_by_events(tmp_path: Path) -> None:
    whens = (
        '<when name="fog"><time after="1"/><do><failure kind="blur"/></do></when>'
        '<when><event name="fog"/><time after="2"/><do><end_failure kind="blur"/></do></when>'
    )
    recording, _ = played(compiled(tmp_path, whens=whens))
    assert times(recording, "failure")[0] == pytest.approx(1.0, abs=0.06)
    assert times(recording, "failure_end")[0] == pytest.approx(2.0, abs=0.06)


def test_any_and_all(tmp_path: Path) -> None:
    whens = (
        '<when><any><time after="3"/><all><time after="1"/><traveled distance="20"/></all></any>'
        '<do><message text="now" modality="text tone"/></do></when>'
        '<when><any><time after="9"/><all><time after="1"/><traveled distance="900"/></all></any>'
        '<do><message text="never"/></do></when>'
    )
    recording, _ = played(compiled(tmp_path, whens=whens))
    told = [(event.cause, event.message) for event in recording.events if event.kind == "message"]
    assert told == [("text", "now"), ("tone", "now")]
    assert times(recording, "message")[0] == pytest.approx(20.0 / 15.0, abs=0.15)


def test_a_run_is_stopped_by_an_event_once_the_car_stands(tmp_path: Path) -> None:
    whens = '<when><standstill duration="1"/><do><stop/></do></when>'
    recording, _ = played(compiled(tmp_path, speed=0, whens=whens))
    assert recording.stop_reason == "trigger"
    assert float(recording.t[-1]) == pytest.approx(1.0, abs=0.11)


def test_health_and_the_sides_of_the_lane_are_conditions(tmp_path: Path) -> None:
    whens = (
        '<when><sensor_health below="0.5"/><do><message text="health"/></do></when>'
        '<when><lane_confidence below="0.5" side="left"/><do><message text="left"/></do></when>'
        '<when><lane_confidence below="0.5" side="either"/><do><message text="either"/></do></when>'
    )
    failure = '<camera><failure kind="dirt" onset="1" amount="0.8"/></camera>'
    recording, _ = played(compiled(tmp_path, camera=failure, whens=whens, duration=3))
    told = {event.message: event.t for event in recording.events if event.kind == "message" and event.cause == "text"}
    assert {"health", "left", "either"} <= set(told)
    assert told["health"] > 1.0


def test_the_weather_changes_over_time(tmp_path: Path) -> None:
    seen: list[Snapshot] = []

    class Watched(KinematicWorld):
        def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
            seen.append(snapshot)
            return super().step(snapshot, command)

    whens = '<when><time after="1"/><do><weather preset="HardRainNight" over_time="2"/></do></when>'
    compilation = compiled(tmp_path, whens=whens, weather='<weather preset="CloudyNoon" fog_density="20"/>')
    assert compilation.plan.weather.cloudiness == 60.0
    assert compilation.plan.weather.fog_density == 20.0
    run(compilation.plan, Watched(compilation.plan, compilation.network))
    at = {round(one.t, 2): one.weather for one in seen if one.weather is not None}
    assert at[0.5].precipitation == 0.0
    assert at[2.0].precipitation == pytest.approx(50.0, abs=3.0)
    assert at[2.0].sun_altitude_angle == pytest.approx(-22.5, abs=4.0)
    assert at[3.5].fog_density == 100.0


def test_messages_come_in_the_language_of_the_policy(tmp_path: Path) -> None:
    failure = '<camera><failure kind="blackout" onset="0.5"/></camera>'
    recording, _ = played(compiled(tmp_path, camera=failure))
    told = [event.message for event in recording.events if event.kind == "message"]
    assert told[0] == "Bitte übernehmen"


def test_every_language_has_every_text() -> None:
    tables = [(sorted(one.what), sorted(one.why), sorted(one.next)) for one in TEXTS.values()]
    assert all(table == tables[0] for table in tables)


def test_criteria_of_the_takeover(tmp_path: Path) -> None:
    criteria = (
        '<takeover_within time="2"/><requested cause="sensor_health"/><requested/><no_minimum_risk/>'
        '<maximum_lateral_offset at_most="0.5"/>'
    )
    failure = '<camera><failure kind="blackout" onset="0.5"/></camera>'
    _, soon = played(compiled(tmp_path, camera=failure, criteria=criteria, answer=1))
    assert [one.passed for one in soon.criteria] == [True, True, True, False, True, True]
    _, late = played(compiled(tmp_path, camera=failure, criteria=criteria, answer=2.5, duration=6))
    assert [one.passed for one in late.criteria] == [False, True, True, False, True, True]
    _, never = played(compiled(tmp_path, camera=failure, criteria=criteria, duration=14))
    assert [one.passed for one in never.criteria] == [False, True, True, False, True, True]
    _, calm = played(compiled(tmp_path, criteria=criteria))
    assert [one.passed for one in calm.criteria] == [True, False, False, True, True, True]
    other = '<requested cause="path_blocked"/>'
    _, wrong = played(compiled(tmp_path, camera=failure, criteria=other))
    assert not wrong.criteria[0].passed
    assert "sensor_health" in wrong.criteria[0].why


def test_one_mark_is_worn_or_covered(tmp_path: Path) -> None:
    stretch = '<markings road="1" from="0" to="1000" {}/>'
    clean, _ = played(compiled(tmp_path, duration=1))
    worn, _ = played(compiled(tmp_path, duration=1, markings=stretch.format('lane="-1" quality="0.1"')))
    covered, _ = played(compiled(tmp_path, duration=1, markings=stretch.format('coverage="0.5"')))
    sides = [(float(one.confidence_left[-1]), float(one.confidence_right[-1])) for one in (clean, worn, covered)]
    assert sides[1] == pytest.approx((0.1, sides[0][1]), abs=0.001)
    assert sides[2] == pytest.approx(tuple(0.5 * side for side in sides[0]))


def test_covered_pieces_have_the_given_share_and_more_coverage_only_adds_pieces() -> None:
    some, more = (covered_pieces("1", 0.0, 2000.0, share) for share in (0.2, 0.6))
    assert len(some) == pytest.approx(200, rel=0.15)
    assert len(more) == pytest.approx(600, rel=0.1)
    assert set(some) < set(more)
    assert covered_pieces("1", 0.0, 10.0, 1.0) == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert covered_pieces("1", 0.0, 10.0, 0.0) == []


def test_an_event_is_logged_with_its_name_and_actor(tmp_path: Path) -> None:
    whens = '<when name="slower"><time after="0.5"/><do><sensor_noise sigma="1"/></do></when>'
    recording, _ = played(compiled(tmp_path, whens=whens, duration=2))
    logged = [(event.kind, event.message, event.entity) for event in recording.events if event.kind in NAMED]
    assert logged == [("storyboard_start", "slower", "ego"), ("storyboard_end", "slower", "ego")]


FAILS = '<camera><failure kind="blackout" onset="0.5"/></camera>'


def test_hazard_lights_are_logged_until_the_driver_takes_over(tmp_path: Path) -> None:
    unanswered, _ = played(compiled(tmp_path, camera=FAILS, duration=20, answer=60))
    lights = [(event.t, event.value) for event in unanswered.events if event.kind == "hazard_lights"]
    assert lights == [(event.t, 1.0) for event in unanswered.events if event.kind == "minimum_risk"]
    answered, _ = played(compiled(tmp_path, camera=FAILS, duration=20, answer=2))
    values = [event.value for event in answered.events if event.kind == "hazard_lights"]
    assert values == [1.0, 0.0]
    assert times(answered, "hazard_lights")[1] == times(answered, "response")[0]


def test_contacts_of_others_are_named_and_are_not_collisions_of_the_ego(tmp_path: Path) -> None:
    others = (
        '<dynamic id="runs" speed="20"><start><ahead_of entity="ego" distance="20" lanes="1"/></start></dynamic>'
        '<static id="stands"><at><ahead_of entity="ego" distance="60" lanes="1"/></at></static>'
    )
    recording, outcome = played(compiled(tmp_path, markings=others, duration=4, criteria="<no_collision/>"))
    told = [(event.entity, event.message) for event in recording.events if event.kind == "contact"]
    assert told == [("runs", "stands")]
    assert outcome.result == "pass"
    assert times(recording, "collision") == []


def test_a_stop_of_the_driver_is_a_standstill_of_its_own(tmp_path: Path) -> None:
    wall = '<static id="wall"><at><ahead_of entity="ego" distance="70" turn="90"/></at></static>'
    second = '<static id="second"><at><ahead_of entity="ego" distance="70" offset="5" turn="90"/></at></static>'
    third = '<static id="third"><at><ahead_of entity="ego" distance="70" offset="-5" turn="90"/></at></static>'
    recording, outcome = played(
        compiled(tmp_path, camera=FAILS, markings=wall + second + third, duration=20, answer=0.5, speed=8)
    )
    stop = next(event for event in recording.events if event.kind == "standstill")
    assert stop.cause == "driver"
    assert [interval.state for interval in outcome.timeline][-1] == "manual"
    measured = outcome.measures["standstill_time"].value
    assert measured == pytest.approx(stop.t)
    assert recording.v[np.searchsorted(recording.t, stop.t - 1e-6), 0] < 0.05
    assert recording.stop_reason == "standstill"


def test_times_are_written_without_the_rounding_of_the_steps(tmp_path: Path) -> None:
    recording, outcome = played(compiled(tmp_path, camera=FAILS, duration=4))
    write_events(recording.events, tmp_path / "events.csv")
    written = [line.split(",")[0] for line in (tmp_path / "events.csv").read_text(encoding="utf-8").splitlines()[1:]]
    assert written
    assert max(map(len, written)) <= 4
    assert max(len(repr(interval.end)) for interval in outcome.timeline) <= 4


def last_image(compilation: Compilation) -> NDArray[np.uint8]:
    """Return the last image that the camera delivers in a run."""
    with open_world("kinematic", compilation.plan, compilation.network) as world:
        execution = Execution(compilation.plan, world, 1)
        while execution.going:
            execution.advance()
    assert execution.seen is not None
    return execution.seen.image


@pytest.fixture(scope="module")
def clean(tmp_path_factory: pytest.TempPathFactory) -> NDArray[np.uint8]:
    """The last image of a camera without a failure."""
    return last_image(compiled(tmp_path_factory.mktemp("clean"), "camera", duration=0.3))


@pytest.mark.parametrize("kind", get_args(FailureKind))
def test_every_kind_of_failure_changes_the_images(tmp_path: Path, clean: NDArray[np.uint8], kind: str) -> None:
    failure = f'<camera><failure kind="{kind}" yaw="{5 if kind == "misalignment" else 0}"/></camera>'
    assert not np.array_equal(last_image(compiled(tmp_path, "camera", camera=failure, duration=0.3)), clean)


def test_a_lane_change_to_a_missing_lane_is_logged(tmp_path: Path) -> None:
    car = (
        '<dynamic id="car" speed="10"><start><ahead_of entity="ego" distance="90" lanes="1"/></start><when>'
        '<time after="1"/><do><lane_change by="{}" over_time="1"/></do></when></dynamic>'
    )
    for by, lost in ((3, [(1.0, "car")]), (-1, [])):
        recording, _ = played(compiled(tmp_path, markings=car.format(by)))
        assert [(one.t, one.entity) for one in recording.events if one.kind == "no_lane"] == lost
