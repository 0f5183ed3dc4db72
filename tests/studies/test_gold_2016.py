"""Gold, Koerber, Lechner and Bengler 2016: 0, 10 and 20 vehicles per kilometre.

"Taking over control from highly automated vehicles in complex traffic situations: the role of traffic density",
Human Factors 58, 642-652. 120 km/h, a request 7 s before an obstacle.

| | the paper | here | asserted |
|---|---|---|---|
| least time to collision | shorter in traffic (abstract) | gaps are looked and waited for | the direction |
| collisions | more in traffic (abstract) | rare | no fewer with traffic |
| takeover time by traffic | longer (abstract) | not modelled without a coefficient | longer with one |
| a verbal task | no influence on takeover time (abstract) | a task that is not looked at has no effect | nothing |
| from 10 to 20 vehicles per km | a small step (from memory, not verified) | see the table below | nothing |

72 participants, three lanes. The abstract is that of doi 10.1177/0018720816634226, as libraries quote it; the figures
were not found.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from tests.studies.study import Sample, compiled, runs, sample

GOLD_2016 = """<scenarios version="1"><scenario name="gold_2016" map="motorway" duration="16" control_every="2">
<parameter name="density" type="number" default="10" min="1" max="40"/>
<parameter name="phase" type="fraction" default="0"/> <parameter name="count" type="integer" default="0"/>
<ego speed="33.333"><start><lane road="1" lane="-2" s="900"/></start><forward_sensor range="300"/></ego>
<static id="accident"><at><ahead_of entity="ego" distance="360"/></at></static>
<repeat id="left" count="$count" as="k"><dynamic id="car" speed="33.333">
  <start><ahead_of entity="ego" distance="${400 - 2000 / $density * ($k + $phase)}" lanes="1"/></start>
  <follow time_gap="1"/>
</dynamic></repeat>
<repeat id="right" count="$count" as="k"><dynamic id="car" speed="33.333">
  <start><ahead_of entity="ego" distance="${363 - 2000 / $density * ($k + $phase)}" lanes="-1"/></start>
  <follow time_gap="1"/>
</dynamic></repeat>
<takeover budget="7"><cause kind="path_blocked"/><driver preset="study_means"/></takeover>
<criteria><no_collision/></criteria></scenario></scenarios>"""
EFFECT = '<driver preset="study_means"><effect of="traffic_density" by="0.03" source="Made up."/></driver>'
"""A coefficient for the density that is counted at the request, s for each vehicle per km."""

PHASES = (0.1, 0.35, 0.6, 0.85)


def with_density(folder: Path, density: int) -> Sample:
    """Return what comes of a density in vehicles per km: half in the lane on the left, half in that on the right."""
    if density == 0:
        found = [compiled(folder, GOLD_2016)] * len(PHASES)
    else:
        count = density // 2
        found = [compiled(folder, GOLD_2016, density=density, count=count, phase=phase) for phase in PHASES]
    return sample(found, range(1, 9))


def test_with_a_coefficient_the_traffic_that_is_counted_makes_answers_later(tmp_path: Path) -> None:
    text = GOLD_2016.replace('<driver preset="study_means"/>', EFFECT)
    medians = []
    for density in (0, 10, 20):
        found = compiled(tmp_path, text, density=max(density, 1), count=density // 2, phase=0.35)
        outcomes = [outcome for _, outcome in runs(found, range(1, 9))]
        counted = {outcome.measures["traffic_density"].value for outcome in outcomes}
        assert all(value is not None and abs(value - density) <= 2.0 for value in counted)
        medians.append(float(np.median([outcome.takeovers[0].takeover_time or np.nan for outcome in outcomes])))
    assert medians[0] < medians[1] < medians[2]


def test_traffic_leaves_less_time_to_collision(tmp_path: Path) -> None:
    none, some = (with_density(tmp_path, density) for density in (0, 20))
    assert np.median(some.least) < 0.9 * np.median(none.least)
    assert np.median(some.along) < 0.9 * np.median(none.along)
    assert some.crashed >= none.crashed
