"""Koerber, Gold, Lechner and Bengler 2016: older and younger drivers, and three takeovers one after the other.

"The influence of age on the take-over of vehicle control in highly automated driving", Transportation Research Part F
39, 19-32. Six-lane motorway, an obstacle to evade, no, medium or high traffic; 36 younger and 36 older drivers.

| | the paper (abstract, TRID 1403477) | here | asserted |
|---|---|---|---|
| takeover time, last situation against first | shorter | shorter (Zhang et al. 2019) | the direction |
| minimum time to collision, the same | larger | larger, along the lane | the direction |
| maximum lateral acceleration, the same | smaller | see the table below | nothing |
| older drivers | react as fast | the same law | nothing |
| older drivers | brake more often, more strongly | `brakes` of `<driving>` says so | nothing |
| older drivers | maintain a higher time to collision | larger for who brakes | the direction |

The takeover times and times to collision of the paper were not found.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.recording.recording import Floats
from tests.studies.study import compiled, runs

KOERBER = """<scenarios version="1"><scenario name="koerber" map="motorway" duration="85" control_every="2">
<ego speed="33.333"><start><lane road="1" lane="-2" s="50"/></start><forward_sensor range="300"/></ego>
<for each="distance" in="500 1400 2300"><static id="obstacle">
  <at><ahead_of entity="ego" distance="$distance"/></at>
</static></for>
<takeover budget="7" minimum_risk="false" hand_back_after="4">
  <cause kind="path_blocked"/>
  <driver><driving brakes="{brakes}" steers="{steers}"/></driver>
  <automation after="hold_speed"/>
</takeover>
<criteria><no_collision/></criteria></scenario></scenarios>"""
MEASURES = ("takeover_time", "minimum_lane_time_to_collision", "maximum_lateral_acceleration")


def takeovers(folder: Path, *, brakes: bool = False) -> Sequence[Floats]:
    """Return the measures of each takeover, (20 runs, measures), NaN where missing; brakers stop at the first."""
    text = KOERBER.format(brakes=int(brakes), steers=int(not brakes))
    found: list[list[list[float]]] = [[], [], []]
    for _, outcome in runs(compiled(folder, text), range(1, 21)):
        for place, one in zip(found, outcome.takeovers, strict=False):
            values = (getattr(one, name) for name in MEASURES)
            place.append([np.nan if value is None else value for value in values])
    return [np.array(place) for place in found if place]


@pytest.mark.slow
def test_the_last_takeover_is_faster_and_better_than_the_first(tmp_path: Path) -> None:
    found = takeovers(tmp_path)
    assert len(found) == 3
    first, _, last = (np.nanmedian(one, axis=0) for one in found)
    assert last[0] < first[0]
    assert last[1] > first[1]


def test_drivers_who_brake_keep_a_greater_time_to_collision(tmp_path: Path) -> None:
    steering, braking = (takeovers(tmp_path, brakes=brakes)[0] for brakes in (False, True))
    assert np.nanmedian(braking[:, 1]) > np.nanmedian(steering[:, 1])
