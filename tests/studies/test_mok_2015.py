"""Mok, Johns, Lee, Miller, Sirkin, Ive and Ju 2015: the automation fails 2 s, 5 s or 8 s before road works.

"Emergency, automation off: unstructured transition timing for distracted drivers of automated vehicles", IEEE 18th
International Conference on Intelligent Transportation Systems. Drivers watched a video; 30 drivers.

| | the paper (abstract) | here | asserted |
|---|---|---|---|
| 2 s | few negotiate the hazard safely | few | fewer than a quarter |
| 5 s and 8 s | the majority does | the majority does | more than half |
| what drivers think of the vehicle | less trustworthy after 2 s | not modelled | nothing |

The hazard here is a lane that works close, 72 km/h, with the lanes beside free: the paper's road and speed were not
found. The automation lets go without a message.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.studies.study import compiled, runs

MOK = """<scenarios version="1"><scenario name="mok" map="motorway" duration="40" control_every="2">
<parameter name="budget" type="time" default="5"/>
<ego speed="20"><start><lane road="1" lane="-2" s="500"/></start><forward_sensor range="300"/></ego>
<work_zone id="works" length="60" taper="30" across="3.75">
  <at><ahead_of entity="ego" distance="250" offset="-1.9"/></at>
</work_zone>
<takeover budget="$budget" minimum_risk="false">
  <cause kind="path_blocked"/>
  <driver task="visual"/>
  <message modality="none"/>
  <automation after="let_go"/>
</takeover>
<criteria><no_collision/><stay_on_road/></criteria></scenario></scenarios>"""
BUDGETS = (2.0, 5.0, 8.0)


def safe(folder: Path, budget: float) -> float:
    """Return the share of 30 runs that have no collision and stay on the road."""
    found = compiled(folder, MOK, budget=budget)
    return float(np.mean([outcome.result == "pass" for _, outcome in runs(found, range(1, 31))]))


def test_few_are_safe_after_two_seconds_and_most_after_five_and_eight(tmp_path: Path) -> None:
    shares = [safe(tmp_path, budget) for budget in BUDGETS]
    assert shares[0] < 0.25
    assert shares[2] >= shares[1] > 0.5
