"""The automation and the traffic stop at a red signal of their lane, wait without a request, and go at green."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Outcome, Recording, judge, open_world, run
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.program.world import aspect_of
from scenario_compiler.roads import load_network
from scenario_compiler.vocabulary.sensors import Perception

CONFLICT = """<scenarios version="1">
<scenario name="lights" map="signal_crossing" duration="{duration}" control_every="2">
<ego speed="12"><start><lane road="2" lane="-1" s="{s}"/></start>
<destination><lane road="1" lane="1" s="700"/></destination></ego>{others}
<signal_controller name="north_south">{first}<phase name="green" duration="60" state="green"/></signal_controller>
<signal_controller name="east_west"><phase name="red" duration="90" state="red"/></signal_controller>
<takeover budget="7"><cause kind="path_blocked"/><cause kind="no_progress"/>
<driver preset="absent"/></takeover>
<criteria><no_collision/><makes_progress/></criteria></scenario></scenarios>"""

RED = '<phase name="red" duration="20" state="red"/>'
LINE = 844.1 - 1.0
"""s of the light at the end of road 2, m."""


def played(
    folder: Path,
    perception: Perception = "ideal",
    *,
    first: str = RED,
    s: float = 740.0,
    duration: float = 30.0,
    others: str = "",
) -> tuple[Compilation, Recording, Outcome]:
    path = folder / "lights.xml"
    path.write_text(CONFLICT.format(first=first, s=s, duration=duration, others=others), encoding="utf-8")
    sink = Diagnostics()
    found = compile_target(str(path), {}, sink, overrides=Overrides(perception=perception))
    assert found is not None, "\n".join(as_text(one) for one in sink)
    with open_world("kinematic", found.plan, found.network) as world:
        recording = run(found.plan, world)
    return found, recording, judge(found.plan, recording)


def fronts(found: Compilation, recording: Recording, entity: int = 0) -> np.ndarray:
    """Return s of an entity's front on road 2, NaN on other roads."""
    vehicle = found.plan.entities[entity].vehicle
    assert vehicle is not None
    at = recording.s[:, entity] + vehicle.center + vehicle.length / 2
    road = recording.roads.index("2")
    return np.where(recording.road[:, entity] == road, at, np.nan)


@pytest.mark.parametrize("perception", ["ideal", pytest.param("camera", marks=pytest.mark.slow)])
def test_the_automation_waits_at_red_without_a_request_and_goes_at_green(
    perception: Perception, tmp_path: Path
) -> None:
    found, recording, outcome = played(tmp_path, perception)
    at_red = recording.t < 20.0
    assert LINE - 5.0 < np.nanmax(fronts(found, recording)[at_red]) < LINE
    assert recording.v[at_red, 0].min() < 0.05
    assert recording.road[-1, 0] != recording.roads.index("2")
    assert not [event for event in recording.events if event.kind in ("request", "no_progress")]
    assert outcome.result == "pass"


def test_a_light_that_turns_yellow_too_late_is_driven_through(tmp_path: Path) -> None:
    first = '<phase name="green" duration="{}" state="green"/><phase name="yellow" duration="60" state="yellow"/>'
    _, late, _ = played(tmp_path, first=first.format(7.2), duration=16.0)
    _, early, _ = played(tmp_path, first=first.format(4.0), duration=16.0)
    assert late.v[:, 0].min() > 11.0
    assert early.v[-1, 0] < 0.05


def test_a_car_queues_behind_one_that_waits_at_red(tmp_path: Path) -> None:
    waiting = f'<dynamic id="waiting" speed="0"><start><lane road="2" lane="-1" s="{LINE - 5.0}"/></start></dynamic>'
    _, recording, outcome = played(tmp_path, others=waiting, duration=19.9)
    assert outcome.collision_with is None
    assert not [event for event in recording.events if event.kind in ("request", "no_progress")]
    assert recording.v[-1, 0] < 0.05


def test_a_signal_of_another_lane_or_direction_stops_nobody(tmp_path: Path) -> None:
    _, recording, _ = played(tmp_path, first='<phase name="green" duration="60" state="green"/>', duration=14.0)
    assert recording.v[:, 0].min() > 11.0


def test_traffic_waits_at_red_and_goes_at_green(tmp_path: Path) -> None:
    _, recording, _ = played(tmp_path, duration=40.0, others='<traffic vehicles="14" seed="4"/>')
    inside = [k for k, road in enumerate(recording.roads) if int(road) > 1000]
    entered = np.isin(recording.road[1:], inside) & ~np.isin(recording.road[:-1], inside)
    s = recording.s[:-1]
    from_ns = entered & (s > 400.0)
    from_ew = entered & (s < 400.0)
    t = recording.t[1:, None]
    assert not (from_ns & (t < 20.0)).any()
    assert (from_ns & (t > 20.0)).sum() >= 2
    assert not from_ew.any()


def test_a_driver_who_waits_at_red_goes_at_green(tmp_path: Path) -> None:
    others = '<when><time after="1"/><do><request/></do></when>'
    driven = CONFLICT.replace('preset="absent"', 'takeover_time="1"')
    path = tmp_path / "driven.xml"
    path.write_text(driven.format(first=RED, s=740.0, duration=40.0, others=others), encoding="utf-8")
    found = compile_target(str(path), {}, Diagnostics(), overrides=Overrides(perception="ideal"))
    assert found is not None
    with open_world("kinematic", found.plan, found.network) as world:
        recording = run(found.plan, world)
    assert recording.v[recording.t < 20.0, 0].min() < 0.05
    assert recording.stop_reason == "destination"


def test_both_forms_of_the_engine_wait_equally(tmp_path: Path) -> None:
    found, compiled, _ = played(tmp_path, duration=8.0, others='<traffic vehicles="8" seed="4"/>')
    with open_world("kinematic", found.plan, found.network) as world:
        interpreted = run(found.plan, world, interpreted=True)
    assert interpreted.trajectory_hash == compiled.trajectory_hash


@pytest.mark.parametrize(
    ("state", "aspect"),
    [
        ("red", op.ASPECT_STOP),
        ("Red;Yellow", op.ASPECT_STOP),
        ("on;off;off", op.ASPECT_STOP),
        ("ON;ON;OFF", op.ASPECT_STOP),
        ("stop", op.ASPECT_STOP),
        ("yellow", op.ASPECT_CAUTION),
        ("off;on;off", op.ASPECT_CAUTION),
        ("amber", op.ASPECT_CAUTION),
        ("green", op.ASPECT_NONE),
        ("off;off;on", op.ASPECT_NONE),
        ("off;off;off", op.ASPECT_NONE),
        ("go", op.ASPECT_NONE),
        ("", op.ASPECT_NONE),
        ("reduced", op.ASPECT_NONE),
    ],
)
def test_the_state_of_a_signal_determines_whether_traffic_stops(state: str, aspect: int) -> None:
    assert aspect_of(state) == aspect


def test_a_controller_of_the_map_is_named_by_its_name_or_its_id(repository: Path) -> None:
    network = load_network(repository / "maps" / "signal_crossing" / "signal_crossing.xodr")
    assert network is not None
    assert network.model().signals_of("north_south") == network.model().signals_of("2") == ("12", "22")
    assert network.model().signals_of("nobody") == ()
