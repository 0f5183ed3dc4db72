"""The five conflicts of the library cause their requests, with the camera and, where it adds nothing, without it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Outcome, Plan, Recording, judge, open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.vocabulary.sensors import Perception
from tests.playing import played_until

CONFLICTS = Path(__file__).parent.parent / "library" / "conflicts"


def compiled(
    name: str, perception: Perception = "camera", duration: float | None = None, **arguments: object
) -> Compilation:
    sink = Diagnostics()
    target = str(CONFLICTS / f"{name}.xml")
    settings = {key: str(value) for key, value in arguments.items()}
    compilation = compile_target(target, settings, sink, overrides=Overrides(perception=perception, duration=duration))
    assert compilation is not None, "\n".join(as_text(d) for d in sink)
    return compilation


def played(compilation: Compilation, seed: int = 1) -> tuple[Plan, Recording, Outcome]:
    plan = compilation.plan
    world = open_world("kinematic", plan, compilation.network)
    recording = run(plan, world, seed=seed)
    return plan, recording, judge(plan, recording)


def with_driver(compilation: Compilation, *, takeover_time: float | None = None, lapse: float = 0.0) -> Compilation:
    """Return the same conflict with a driver who responds after a fixed time, or never."""
    driver = compilation.plan.takeover.driver.model_copy(update={"takeover_time": takeover_time, "lapse": lapse})
    takeover = compilation.plan.takeover.model_copy(update={"driver": driver})
    plan = compilation.plan.model_copy(update={"takeover": takeover})
    return Compilation(plan, compilation.network, compilation.scenario)


def first(recording: Recording, kind: str) -> float:
    """Return the time of the first event of a kind, infinity if there is none."""
    return next((event.t for event in recording.events if event.kind == kind), math.inf)


def front(plan: Plan, recording: Recording) -> np.ndarray:
    """Return s of the ego's front at each row, on a straight road that it drives along s."""
    vehicle = plan.ego.vehicle
    return recording.s[:, 0] + vehicle.center + vehicle.length / 2


@pytest.mark.parametrize("perception", ["camera", "ideal"])
def test_fading_paint_causes_a_request_neither_early_nor_late(perception: Perception) -> None:
    begin, over = 100.0, 60.0
    plan, recording, outcome = played(
        compiled("markings_missing", perception, duration=9.0, **{"from": begin, "over": over})
    )
    at = first(recording, "request")
    assert outcome.cause == "lane_confidence"
    s = front(plan, recording)
    assert s[np.searchsorted(recording.t, at)] > begin - 30.0
    gone = recording.t[np.searchsorted(s, begin + over)]
    assert at <= gone + 3.0
    assert first(recording, "warning") <= at


def test_a_failing_camera_causes_a_request_within_a_second() -> None:
    found = compiled("sensor_failure", duration=3.0, onset=1.0, sigma=60)
    recording = played_until("request", found.plan, found.network)
    assert 1.0 <= first(recording, "request") <= 2.0
    assert judge(found.plan, recording).cause in ("sensor_health", "lane_confidence")


FAILING = """<scenarios version="1"><scenario name="failing" map="town_grid" duration="4.5" control_every="2">
<ego speed="12"><start><spawn_point name="main_street"/></start>
<camera sensor_noise="5"><failure kind="{}" onset="2" ramp="1"/></camera></ego>
<takeover budget="7"><driver preset="absent"/></takeover></scenario></scenarios>"""


@pytest.mark.parametrize(
    ("kind", "perception"),
    [
        *((kind, "ideal") for kind in ("noise", "dropout", "freeze", "blackout", "blur", "dirt")),
        *((kind, "camera") for kind in ("noise", "freeze", "blur")),
        *(pytest.param(kind, "camera", marks=pytest.mark.slow) for kind in ("dropout", "blackout", "dirt")),
    ],
)
def test_every_failure_of_a_noisy_camera_causes_a_request(kind: str, perception: Perception, tmp_path: Path) -> None:
    file = tmp_path / "failing.xml"
    file.write_text(FAILING.format(kind), encoding="utf-8")
    compilation = compile_target(file, {}, Diagnostics(), overrides=Overrides(perception=perception))
    assert compilation is not None
    assert 2.0 <= first(played_until("request", compilation.plan, compilation.network), "request") <= 4.2


def test_a_little_noise_causes_no_request() -> None:
    _, recording, _ = played(compiled("sensor_failure", duration=3.0, onset=0.5, sigma=5))
    assert first(recording, "warning") == math.inf
    assert first(recording, "request") == math.inf


@pytest.mark.parametrize("name", ["obstacle_ahead", "road_narrows"])
def test_a_blocked_path_causes_a_request_and_a_driver_within_the_budget_avoids_it(name: str) -> None:
    for takeover_time in (1.5, 3.0):
        _, recording, outcome = played(with_driver(compiled(name, "ideal"), takeover_time=takeover_time))
        assert outcome.cause == "path_blocked"
        assert first(recording, "collision") == math.inf
        assert first(recording, "response") == pytest.approx(first(recording, "request") + takeover_time, abs=0.15)


@pytest.mark.parametrize("name", ["obstacle_ahead", "road_narrows"])
def test_without_an_answer_the_car_stops_before_the_obstacle(name: str) -> None:
    plan, recording, outcome = played(with_driver(compiled(name, "ideal"), lapse=1.0))
    assert outcome.resolution == "minimum_risk"
    assert first(recording, "standstill") < math.inf
    assert first(recording, "collision") == math.inf
    assert recording.v[-1, 0] == 0.0
    assert front(plan, recording)[-1] < recording.s[-1, 1]


@pytest.mark.parametrize("takeover_time", [6.0, 9.0])
def test_a_late_driver_collides_or_stops(takeover_time: float) -> None:
    _, recording, _ = played(with_driver(compiled("obstacle_ahead", "ideal"), takeover_time=takeover_time))
    collided = first(recording, "collision") < math.inf
    stopped = bool(recording.v[:, 0].min() == 0.0)
    assert collided or stopped


def test_the_camera_sees_a_blocked_path_as_the_map_does() -> None:
    found = compiled("obstacle_ahead", "camera", duration=4.0, distance=110)
    recording = played_until("request", found.plan, found.network)
    assert judge(found.plan, recording).cause == "path_blocked"
    assert first(recording, "collision") == math.inf


@pytest.mark.parametrize("spacing", [10, 18, 30, 45, 60, 100])
def test_on_the_ramp_the_car_never_merges_into_an_occupied_gap(spacing: int) -> None:
    plan, recording, outcome = played(with_driver(compiled("ramp_blocked", "ideal", spacing=spacing), lapse=1.0))
    assert first(recording, "collision") == math.inf
    merged = recording.lane[:, 0] == -2
    if merged.any():
        k = int(np.argmax(merged))
        gaps = np.abs(recording.s[k, 1:] - recording.s[k, 0])[recording.road[k, 1:] == recording.road[k, 0]]
        assert gaps.min(initial=math.inf) > plan.ego.vehicle.length
    else:
        assert outcome.cause == "lane_ends"


def test_a_full_lane_beside_the_ramp_causes_a_request() -> None:
    found = compiled("ramp_blocked", "camera", duration=9.0)
    recording = played_until("request", found.plan, found.network)
    assert judge(found.plan, recording).cause == "lane_ends"
    assert first(recording, "request") < 9.0


EXIT_ONLY = """<scenarios version="1"><scenario name="exit" map="highway_loop" duration="24" control_every="2">
<ego speed="25"><start><lane road="12" lane="-3" s="185"/></start>{destination}</ego>{beside}
<takeover budget="4"><cause kind="lane_ends"/><driver preset="absent"/></takeover></scenario></scenarios>"""
STRAIGHT_ON = '<destination><lane road="14" lane="-2" s="250"/></destination>'
OFF = '<destination><lane road="32" lane="-1" s="60"/></destination>'
FULL = """<repeat count="9" as="k"><dynamic id="truck" speed="25">
<start><ahead_of entity="ego" lanes="1" distance="${30 * $k - 120}"/></start></dynamic></repeat>"""


def exit_only(folder: Path, destination: str, beside: str = "") -> tuple[Plan, Recording, Outcome]:
    """Play a car on a deceleration lane of a motorway that nobody but those who exit uses."""
    path = folder / "exit.xml"
    path.write_text(EXIT_ONLY.format(destination=destination, beside=beside), encoding="utf-8")
    sink = Diagnostics()
    found = compile_target(path, {}, sink, overrides=Overrides(perception="ideal"))
    assert found is not None, "\n".join(as_text(d) for d in sink)
    return played(found)


def test_a_lane_that_leaves_the_route_is_left_in_time_if_the_lane_beside_is_free(tmp_path: Path) -> None:
    _, recording, outcome = exit_only(tmp_path, STRAIGHT_ON)
    assert outcome.resolution == "no_request"
    assert outcome.stop_reason == "destination"
    assert first(recording, "merge") < math.inf


def test_a_lane_that_leaves_the_route_beside_a_full_one_causes_a_request(tmp_path: Path) -> None:
    plan, recording, outcome = exit_only(tmp_path, STRAIGHT_ON, FULL)
    assert outcome.cause == "lane_ends"
    asked = int(np.argmin(np.abs(recording.t - first(recording, "request"))))
    road_end = 378.0
    assert recording.s[asked, 0] == pytest.approx(road_end - 4.0 * 25.0 - front(plan, recording)[0] + 185.0, abs=5.0)
    assert recording.v[: asked + 60, 0].min() == pytest.approx(25.0, abs=0.1)  # the lane goes on: nothing to stop for


def test_a_lane_that_leads_to_the_destination_does_not_end_at_the_exit(tmp_path: Path) -> None:
    _, recording, outcome = exit_only(tmp_path, OFF)
    assert outcome.stop_reason == "destination"
    assert first(recording, "warning") == first(recording, "merge") == math.inf
    assert np.isnan(recording.lane_end_distance).all()


def test_the_same_seed_gives_the_same_recording_and_another_does_not() -> None:
    compilation = compiled("markings_missing", "ideal")
    one, again = played(compilation)[1], played(compilation)[1]
    assert one == again
    assert one.trajectory_hash != played(compilation, seed=2)[1].trajectory_hash
