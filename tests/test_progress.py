"""The automation requests before it stops for an obstacle, and 5 s after any other stop without a reason."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from scenario_compiler import Outcome, Recording, judge, open_world, run
from scenario_compiler.batch.variants import with_values
from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.vocabulary.sensors import Perception

CONFLICT = """<scenarios version="1"><scenario name="blocked" map="town_grid" duration="20" control_every="2">
<parameter name="intrusion" type="length" default="1" min="0" max="2"/>
<ego speed="12"><start><spawn_point name="main_street"/></start>
<destination><lane road="1" lane="-1" s="440"/></destination></ego>
<use template="{template}" distance="100" intrusion="$intrusion"/>
<takeover budget="7">{causes}<driver preset="absent"/></takeover>
<criteria><no_collision/><makes_progress/></criteria></scenario></scenarios>"""

WITHOUT_NO_PROGRESS = '<cause kind="path_blocked"/><cause kind="lane_confidence"/>'
NO_PROGRESS_ALONE = '<cause kind="no_progress"/>'
NEVER_ASKS = '<cause kind="controller"/>'

INTRUSIONS = [2.0 * k / 80 for k in range(81)]
TEMPLATES = ("narrowing_road", "work_zone_taper")
PERCEPTIONS = (("ideal", 4), *(pytest.param(name, 1, marks=pytest.mark.slow) for name in ("ideal", "camera")))
"""Perceptions, and every which of the intrusions is driven."""


def compiled(folder: Path, template: str, causes: str, perception: Perception) -> Compilation:
    path = folder / "blocked.xml"
    path.write_text(CONFLICT.format(template=template, causes=causes), encoding="utf-8")
    sink = Diagnostics()
    found = compile_target(str(path), {}, sink, overrides=Overrides(perception=perception))
    assert found is not None, "\n".join(as_text(one) for one in sink)
    return found


def driven(found: Compilation, intrusion: float) -> tuple[Recording, Outcome]:
    plan = with_values(found.plan, {"intrusion": intrusion})
    with open_world("kinematic", plan, found.network) as world:
        recording = run(plan, world)
    return recording, judge(plan, recording)


def slower_from(recording: Recording, speed: float) -> float:
    """Return the time at which the ego was first slower than a speed; infinity if it never was."""
    slow = recording.v[:, 0] < speed
    return float(recording.t[np.argmax(slow)]) if slow.any() else np.inf


def first(recording: Recording, kind: str) -> float:
    return next((event.t for event in recording.events if event.kind == kind), np.inf)


@pytest.mark.parametrize("template", TEMPLATES)
@pytest.mark.parametrize(("perception", "every"), PERCEPTIONS)
def test_the_automation_requests_before_it_slows_down_for_an_obstacle(
    template: str, perception: Perception, every: int, tmp_path: Path
) -> None:
    found = compiled(tmp_path, template, WITHOUT_NO_PROGRESS, perception)
    stopped = 0
    for intrusion in INTRUSIONS[::every]:
        recording, outcome = driven(found, intrusion)
        assert outcome.collision_with is None, intrusion
        if slower_from(recording, 1.0) < np.inf:
            stopped += 1
            assert first(recording, "request") < slower_from(recording, 0.9 * recording.v[0, 0]), intrusion
            assert outcome.resolution == "minimum_risk", intrusion
    assert 40 < stopped * every < 81


@pytest.mark.parametrize("template", TEMPLATES)
@pytest.mark.parametrize(("perception", "every"), PERCEPTIONS)
def test_without_another_cause_the_automation_requests_after_five_seconds_of_standing(
    template: str, perception: Perception, every: int, tmp_path: Path
) -> None:
    found = compiled(tmp_path, template, NO_PROGRESS_ALONE, perception)
    stopped = 0
    for intrusion in INTRUSIONS[::every]:
        recording, outcome = driven(found, intrusion)
        assert outcome.collision_with is None, intrusion
        stands = slower_from(recording, 0.5)
        assert (outcome.cause == "no_progress") == (stands < np.inf), intrusion
        if stands < np.inf:
            stopped += 1
            assert first(recording, "request") == pytest.approx(stands + 5.0, abs=0.1001), intrusion
            assert not next(one for one in outcome.criteria if one.criterion == "makes_progress").passed
    assert 40 < stopped * every < 81


def test_a_stop_without_a_request_has_its_own_resolution_and_fails(tmp_path: Path) -> None:
    recording, outcome = driven(compiled(tmp_path, "narrowing_road", NEVER_ASKS, "ideal"), 1.0)
    assert (outcome.resolution, outcome.result) == ("stopped", "fail")
    assert first(recording, "no_progress") == pytest.approx(slower_from(recording, 0.5) + 5.0, abs=0.1001)
    assert first(recording, "request") == np.inf
