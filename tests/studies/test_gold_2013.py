"""Gold, Damboeck, Lorenz and Bengler 2013: requests at a time to collision of 5 s and of 7 s.

"Take over! How long does it take to get the driver back into the loop?", Proceedings of the Human Factors and
Ergonomics Society 57, 1938-1942. Three lanes, 120 km/h, an obstacle in the own lane.

| | the paper | here | asserted |
|---|---|---|---|
| time to collision at the request | 5 s and 7 s (the design) | within a control step | within a control step |
| speed at the request | 120 km/h (the design) | 33.3 m/s | within 1 % |
| shorter budget | worse takeovers (abstract) | smaller minimum time to collision | medians, the direction |

The medians of the paper's takeover times were not found and are not asserted.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.studies.study import compiled, row_at, runs, time_of

GOLD = """<scenarios version="1"><scenario name="gold" map="motorway" duration="30" control_every="2">
<parameter name="budget" type="time" default="7" min="1" max="20"/>
<ego speed="33.333"><start><spawn_point name="right_lane"/></start><forward_sensor range="300"/></ego>
<static id="accident" model="vehicle.audi.tt">
  <at><ahead_of entity="ego" distance="500"/></at>
</static>
<takeover budget="$budget">
  <cause kind="path_blocked"/>
  <driver preset="study_means"/>
  <automation before="{before}"/>
</takeover>
<criteria><no_collision/></criteria></scenario></scenarios>"""
SEEDS = range(1, 31)


@pytest.mark.parametrize("before", ["follow", "hold_speed"])
@pytest.mark.parametrize("budget", [5.0, 7.0])
def test_the_request_comes_at_its_time_to_collision_and_at_full_speed(
    budget: float, before: str, tmp_path: Path
) -> None:
    found = compiled(tmp_path, GOLD.format(before=before), budget=budget)
    recording, outcome = next(runs(found, range(1, 2)))
    row = row_at(recording, time_of(recording, "request"))
    period = found.plan.step * found.plan.control_every
    assert outcome.cause == "path_blocked"
    assert recording.v[row, 0] == pytest.approx(33.333, rel=0.01)
    assert outcome.measures["time_budget"].value == pytest.approx(budget, abs=period + 1e-6)
    assert time_of(recording, "request") - time_of(recording, "warning") >= 1.0 - 1e-6


def test_the_shorter_budget_has_the_smaller_minimum_time_to_collision(tmp_path: Path) -> None:
    medians = []
    for budget in (5.0, 7.0):
        found = compiled(tmp_path, GOLD.format(before="follow"), budget=budget)
        least = [outcome.measures["minimum_time_to_collision"].value for _, outcome in runs(found, SEEDS)]
        medians.append(float(np.median([0.0 if value is None else value for value in least])))
    assert medians[0] < medians[1]
