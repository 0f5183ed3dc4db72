"""Surrogate perception: equal in both forms, constant at a place, with the features that it was fitted to."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler import compile_scenario, load_network, open_world, run
from scenario_compiler.compiler import Overrides
from scenario_compiler.controllers.lane_detection import LaneDetectionParams
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.ego import surrogate
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.program.surrogate import load_surrogate, read_surrogate, surrogate_text
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.perception.calibration.probes import PROBES, probes
from scenario_compiler.plan.model import Plan
from scenario_compiler.resources import library_folder
from scenario_compiler.vocabulary.entities import Controller, Property
from scenario_compiler.vocabulary.lane_keeping import LANE_KEEPING
from tests.engine.both import Both, run_both

CONFLICTS = ("markings_missing", "obstacle_ahead", "ramp_blocked", "road_narrows", "sensor_failure")


def planned(name: str, **arguments: Any) -> Plan:
    return compile_scenario(
        library_folder() / "conflicts" / f"{name}.xml", overrides=Overrides(perception="surrogate"), **arguments
    )


def driven(plan: Plan, variants: int = 1) -> Both:
    network = load_network(plan.map.file)
    program = build_program(plan, network)
    limit = plan.step_limit
    return run_both(
        network.tables, program, [list(program.const)] * variants, [make_draws(k) for k in range(variants)], limit
    )


@pytest.mark.parametrize("name", CONFLICTS)
def test_both_forms_leave_the_same_bytes(name: str) -> None:
    both = driven(planned(name))
    assert both.interpreted == both.compiled


def test_fading_paint_causes_a_request_while_it_fades() -> None:
    both = driven(planned("markings_missing", **{"from": 200.0, "over": 50.0}))
    request = both.summaries[0, SUMMARY.index("time_request")]
    assert 200.0 / 25.0 - 1.0 < request < 250.0 / 25.0 + 1.0


def test_with_paint_everywhere_it_keeps_the_lane_without_a_request() -> None:
    both = driven(planned("sensor_failure", sigma=0.0))
    assert both.summaries[0, SUMMARY.index("time_request")] < 0.0
    assert both.summaries[0, SUMMARY.index("greatest_offset")] < 0.3


def test_every_seed_sees_the_same() -> None:
    both = driven(planned("markings_missing"), variants=3)
    times = both.summaries[:, SUMMARY.index("time_request")]
    assert len(set(times.tolist())) == 1


def noise_along(side: int, order: Iterable[int] = range(8000)) -> list[float]:
    """Return the noise on a lane every 0.25 m, looked up in an order of the places."""
    plan = planned("sensor_failure")
    network = load_network(plan.map.file)
    state = Simulation(network.tables, build_program(plan, network), interpreted=True).state
    found = {k: surrogate.noise_at(state, 3, -1, side, 0.25 * k, 10.0) for k in order}
    return [found[k] for k in sorted(found)]


def test_the_noise_belongs_to_the_place_and_has_no_steps() -> None:
    noise = noise_along(0)
    assert max(abs(a - b) for a, b in pairwise(noise)) < 0.5
    assert abs(np.mean(noise)) < 0.2
    assert 0.8 < np.std(noise) < 1.2
    assert noise == noise_along(0, reversed(range(8000)))
    assert noise != noise_along(1)


def logits(view: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the network's logits of both sides for a view (2, VIEW_SIZE), worked out apart from the engine."""
    fitted = load_surrogate()
    first, second = np.array(fitted.first), np.array(fitted.second)
    inner = np.clip(view, fitted.low, fitted.high) @ first[:-1] + first[-1]
    units, outputs = inner[:, : at.HIDDEN], inner[:, at.HIDDEN :]
    return np.asarray((outputs + units / (1.0 + np.abs(units)) @ second)[:, 0])


def test_results_kept_between_looks_are_close_to_those_of_a_new_look() -> None:
    plan = planned("road_narrows")
    simulation = Simulation(load_network(plan.map.file).tables, build_program(plan, load_network(plan.map.file)))
    simulation.reset(make_draws(1))
    compared = 0
    while simulation.step():
        said = simulation.column("seen_logit").copy()
        fresh = simulation.state.frame[0] % 2 == 0
        written = simulation.look_at_view()
        if fresh and written is not None and simulation.state.takeover_state[0] == op.TAKEOVER_AUTOMATED:
            assert np.abs(logits(written) - said).max() < 1.0
            compared += 1
    assert compared > 20


def looks_of(plan: Plan) -> tuple[int, int]:
    """Return how often a run looked at the view, and how many images it had."""
    network = load_network(plan.map.file)
    program = build_program(plan, network)
    simulation = Simulation(network.tables, program)
    simulation.reset(make_draws(1))
    images = 0
    while simulation.step():
        images += 1 if simulation.state.frame[0] % program.image_every[0] == 0 else 0
    return simulation.state.view_looks[0], images


@pytest.mark.parametrize(
    ("name", "arguments", "most"),
    [("sensor_failure", {"sigma": 0.0}, 0.3), ("markings_missing", {"from": 100.0, "over": 1.0}, 0.5)],
    ids=["along broken lines", "along worn ones"],
)
def test_a_view_is_kept_along_lines_that_stay_as_they_are(name: str, arguments: dict[str, float], most: float) -> None:
    looks, images = looks_of(planned(name, **arguments))
    assert 0 < looks < most * images


def test_the_right_side_is_the_mirrored_left_side() -> None:
    plan = planned("sensor_failure")
    simulation = Simulation(load_network(plan.map.file).tables, build_program(plan, load_network(plan.map.file)))
    simulation.reset(make_draws(1))
    simulation.step()
    view = simulation.look_at_view()
    assert view is not None
    left, right = view
    assert left[: at.SIDE_SIZE].tolist() == right[at.SIDE_SIZE : at.V_BOTH].tolist()
    assert left[at.V_BOTH :].tolist() == right[at.V_BOTH :].tolist()
    assert left[at.S_OFFSET] == -right[at.S_OFFSET]


def test_outside_the_domain_it_is_noted_once() -> None:
    inside = driven(planned("sensor_failure", sigma=20.0)).summaries[0, SUMMARY.index("time_outside_domain")]
    outside = driven(planned("sensor_failure", sigma=200.0, onset=4.0)).summaries[
        0, SUMMARY.index("time_outside_domain")
    ]
    assert inside < 0.0
    assert outside == pytest.approx(4.0, abs=0.2)


def test_the_automation_drives_by_the_controllers_parameters() -> None:
    assert LaneDetectionParams().model_dump() == LANE_KEEPING
    controller = Controller(properties=(Property(name="time_gap", value="2.5"),))
    plan = planned("sensor_failure").model_copy(update={"controller": controller})
    program = build_program(plan, load_network(plan.map.file))
    numbers = program.const[slots.K_LOOK_AHEAD_TIME : slots.K_DECELERATION + 1]
    assert dict(zip(LANE_KEEPING, numbers, strict=True)) == {**LANE_KEEPING, "time_gap": 2.5}


def test_the_coefficients_are_read_as_they_were_written() -> None:
    assert read_surrogate(surrogate_text(load_surrogate())) == load_surrogate()
    with pytest.raises(RuntimeError, match="other features"):
        read_surrogate(surrogate_text(load_surrogate()).replace("darkness", "gloom"))


def changed_probes(before: Sequence[Sequence[float]], now: Sequence[Sequence[float]]) -> list[str]:
    """Return the situations whose confidences, or positions of trusted boundaries, m, differ by more than 0.05.

    The position of a boundary whose confidence is below 0.5 is arbitrary.
    """
    found = []
    for name, old, new in zip(PROBES, before, now, strict=True):
        places = [(old[2 + k], new[2 + k]) for k in range(2) if min(old[k], new[k]) >= 0.5]
        pairs = [(old[0], new[0]), (old[1], new[1]), *places]
        if any(abs(a - b) > 0.05 for a, b in pairs):
            found.append(name)
    return found


def test_the_coefficients_are_of_this_detector_and_this_renderer() -> None:
    """Where this fails the pictures or the detector say something else: fit again, as tools/fit_surrogate.py says."""
    assert changed_probes(load_surrogate().probes, probes("classical")) == []


BY_HAND = """<scenarios version="1"><scenario name="by_hand" map="highway_loop" weather="ClearNoon" duration="40">
  <ego speed="20"><start><spawn_point name="straight"/></start></ego>
  <when><time after="2"/><do><request/></do></when>
  <takeover budget="7" hand_back_after="{after}"><driver takeover_time="1.5"/></takeover>
</scenario></scenarios>"""


@pytest.mark.parametrize("after", [0.0, 12.0])
def test_every_fifth_image_is_looked_at_by_hand_until_a_hand_back_is_near(tmp_path: Path, after: float) -> None:
    file = tmp_path / "by_hand.xml"
    file.write_text(BY_HAND.format(after=after), encoding="utf-8")
    plan = compile_scenario(file, overrides=Overrides(perception="surrogate"))
    network = load_network(plan.map.file)
    recording = run(plan, open_world("kinematic", plan, network), seed=1)
    response = next(event.t for event in recording.events if event.kind == "response")
    changes = recording.t[1:][np.diff(recording.confidence_left) != 0.0]
    soon, later = (
        np.diff(changes[(changes > response + since) & (changes < response + until)]) / plan.step
        for since, until in ((0.5, 7.0), (8.5, 11.5))
    )
    assert soon == pytest.approx(5.0)
    assert later == pytest.approx(1.0 if after else 5.0)
