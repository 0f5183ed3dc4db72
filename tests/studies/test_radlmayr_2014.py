"""Radlmayr, Gold, Lorenz, Farid and Bengler 2014: four traffic situations, with and without a task.

"How traffic situations and non-driving related tasks affect the take-over quality in highly automated driving",
Proceedings of the Human Factors and Ergonomics Society 58, 2063-2067. 120 km/h, a request 7 s before an obstacle.

| | the paper | here | asserted |
|---|---|---|---|
| lanes beside full | smaller time to collision (from memory, not verified) | smaller | the direction, at 5 s too |
| collisions | more (from memory, not verified) | see the table below | no fewer |
| takeover time by traffic | longer (from memory, not verified) | not modelled without a coefficient | nothing |
| a visual task | figure not found | 0.29 s longer (Zhang et al. 2019) | nothing |

The four situations here: the lanes beside are free, full on the left, on the right, or on both sides.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.studies.study import Sample, compiled, sample

RADLMAYR = """<scenarios version="1"><scenario name="radlmayr" map="motorway" duration="16" control_every="2">
<parameter name="left" type="integer" default="0"/> <parameter name="right" type="integer" default="0"/>
<ego speed="33.333"><start><lane road="1" lane="-2" s="600"/></start><forward_sensor range="300"/></ego>
<static id="accident"><at><ahead_of entity="ego" distance="360"/></at></static>
<repeat id="beside_left" count="$left" as="k"><dynamic id="car" speed="33.333">
  <start><ahead_of entity="ego" distance="${100 - 28 * $k}" lanes="1"/></start><follow time_gap="0.5"/>
</dynamic></repeat>
<repeat id="beside_right" count="$right" as="k"><dynamic id="car" speed="33.333">
  <start><ahead_of entity="ego" distance="${100 - 28 * $k}" lanes="-1"/></start><follow time_gap="0.5"/>
</dynamic></repeat>
<takeover budget="7"><cause kind="path_blocked"/>
  <driver preset="study_means" task="TASK"/></takeover>
<criteria><no_collision/></criteria></scenario></scenarios>"""
FULL = 14
SITUATIONS = {"free": (0, 0), "left full": (FULL, 0), "right full": (0, FULL), "both full": (FULL, FULL)}


def situation(folder: Path, name: str, task: str = "none", seeds: range = range(1, 21), budget: str = "7") -> Sample:
    """Return what comes of a situation."""
    left, right = SITUATIONS[name]
    text = RADLMAYR.replace("TASK", task).replace('budget="7"', f'budget="{budget}"')
    return sample([compiled(folder, text, left=left, right=right)], seeds)


def test_full_lanes_beside_leave_less_time_to_collision(tmp_path: Path) -> None:
    free, full = (situation(tmp_path, name) for name in ("free", "both full"))
    assert np.median(full.least) < np.median(free.least)
    assert full.crashed >= free.crashed


@pytest.mark.slow
def test_with_five_seconds_too_full_lanes_leave_less_time_until_the_car_has_moved_aside(tmp_path: Path) -> None:
    free, full = (situation(tmp_path, name, budget="5") for name in ("free", "both full"))
    assert np.median(full.along) < np.median(free.along)
    assert full.crashed >= free.crashed
