"""UN R157: cut-ins that are to be avoided, over the speed and the gap of the car that cuts in.

The regulation's 5.2.5.2 calls a cut-in avoidable where the time to collision, once the car is 0.3 m inside the lane, is
more than v_rel / (2 x 6 m/s2) + 0.35 s; its annex has the careful and competent driver, who avoids fewer.

| | the regulation | here | asserted |
|---|---|---|---|
| what the careful and competent driver avoids | is avoided | the automation, with an absent driver | at every point of the grid |
| what is avoidable by 5.2.5.2 | is avoided | the automation | no collision from a time of 1 s above the line on |
| what is not | may end in a collision | | nothing |
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from tests.studies.study import compiled, runs

CUT_IN = """<scenarios version="1"><scenario name="cut_in" map="motorway" duration="14" step="0.02" control_every="1">
<parameter name="v" type="speed" default="16.67"/> <parameter name="lead" type="speed" default="5.6"/>
<parameter name="gap" type="length" default="20"/>
<ego speed="$v"><start><lane road="1" lane="-2" s="600"/></start><forward_sensor range="300"/></ego>
<dynamic id="car" speed="$lead">
  <start><ahead_of entity="ego" distance="${$gap + 4.5 + 0.5 * ($v - $lead)}" lanes="1"/></start>
  <when><time after="0.5"/><do><lane_change by="-1" over_time="3"/></do></when>
</dynamic>
<takeover budget="7"><cause kind="path_blocked"/><driver preset="absent"/></takeover>
<criteria><no_avoidable_collision by="careful_and_competent"/></criteria></scenario></scenarios>"""
LANE_WIDTH = 3.75
"""Of the map, m."""

INSIDE = 0.3
"""How far inside the lane the car counts as intruding, m."""

SPEEDS = (11.1, 16.67, 22.2)
LEADS = (2.8, 5.6, 8.3, 11.1)
GAPS = (5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0)
POINTS = tuple((v, lead, gap) for v in SPEEDS for lead in LEADS if lead < v for gap in GAPS)


@dataclass(frozen=True)
class Verdict:
    """What comes of a cut-in.

    Attributes:
        intrusion: Time to collision when the car is 0.3 m inside the lane, s.
        limit: What 5.2.5.2 asks for at least, s.
        crashed: Whether there was a collision.
        avoidable: Whether the careful and competent driver has none in its place.
    """

    intrusion: float
    limit: float
    crashed: bool
    avoidable: bool


@cache
def verdict(folder: Path, v: float, lead: float, gap: float) -> Verdict:
    """Run a cut-in."""
    found = compiled(folder, CUT_IN, v=v, lead=lead, gap=gap)
    recording, outcome = next(runs(found, range(1, 2)))
    ego, car = (entity.vehicle for entity in found.plan.entities)
    along = np.abs(recording.s[:, 1] - recording.s[:, 0])
    apart = np.hypot(recording.x[:, 1] - recording.x[:, 0], recording.y[:, 1] - recording.y[:, 0])
    across = np.sqrt(np.maximum(apart**2 - along**2, 0.0))
    row = int(np.argmax(across - 0.5 * car.width < 0.5 * LANE_WIDTH - INSIDE))
    ahead = float(along[row]) + car.center - ego.center - 0.5 * (ego.length + car.length)
    closing = max(float(recording.v[row, 0]) - lead, 0.01)
    avoidable = recording.header.avoided["careful_and_competent"]
    return Verdict(ahead / closing, (v - lead) / 12.0 + 0.35, outcome.collision_with is not None, avoidable)


def test_what_the_careful_and_competent_driver_avoids_is_avoided(tmp_path: Path) -> None:
    found = [verdict(tmp_path, *point) for point in POINTS]
    assert any(one.avoidable for one in found)
    assert any(not one.avoidable for one in found)
    for point, one in zip(POINTS, found, strict=True):
        assert not (one.avoidable and one.crashed), point
        assert not (one.intrusion > one.limit + 1.0 and one.crashed), point
