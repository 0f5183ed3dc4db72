"""Naujoks, Mai and Neukum 2014: requests to see and to hear, where the lines of a motorway end.

"The effect of urgency of take-over requests during highly automated driving under distraction conditions", Proceedings
of the 5th International Conference on Applied Human Factors and Ergonomics. Lines that end on a straight road (easy),
temporary lines of road works (moderate), lines that are lost in a bend (difficult); a secondary task, 16 drivers.

| | the paper (abstract, doi 10.54941/ahfe100646) | here | asserted |
|---|---|---|---|
| hands on the wheel | sooner if the request is heard too | sooner (Zhang et al. 2019) | the direction |
| lateral control | better if the request is heard too | nearer to the lane's centre in the bend | the direction |
| difficult situations | the difference is more pronounced | none on the straight road | the direction |

The automation lets go with its request. Two of the three situations are here, the easy and the difficult one, without
congested traffic. The figures of the paper were not found.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.studies.study import compiled, runs

NAUJOKS = """<scenarios version="1"><scenario name="naujoks" map="motorway" duration="20" control_every="2">
<ego speed="27.8"><start><lane road="{road}" lane="-2" s="{start}"/></start></ego>
<markings road="{road}" from="{ends}" to="{until}" quality="0"/>
<takeover minimum_risk="false">
  <cause kind="lane_confidence"/>
  <driver task="visual"/>
  <message modality="{modality}"/>
  <automation after="let_go"/>
</takeover>
<criteria><stay_on_road/></criteria></scenario></scenarios>"""
SITUATIONS = {"straight": ("1", 600.0), "bend": ("2", 100.0)}
MODALITIES = {"seen": "icon", "seen and heard": "icon tone"}


@dataclass(frozen=True)
class Condition:
    """Medians of a condition: s and m."""

    hands: float
    offset: float


def condition(folder: Path, situation: str, modality: str, seeds: range = range(1, 21)) -> Condition:
    """Return what comes of a situation and a modality; the offset is the greatest from the centre of the own lane."""
    road, start = SITUATIONS[situation]
    text = NAUJOKS.format(
        road=road, start=start, ends=start + 100.0, until=start + 1200.0, modality=MODALITIES[modality]
    )
    outcomes = [outcome for _, outcome in runs(compiled(folder, text), seeds)]
    medians = []
    for name in ("hands_on_time", "maximum_lateral_offset"):
        values = [outcome.measures[name].value for outcome in outcomes]
        medians.append(float(np.nanmedian([np.nan if value is None else value for value in values])))
    return Condition(*medians)


def test_a_request_that_is_heard_brings_the_hands_back_sooner_and_counts_in_a_bend(tmp_path: Path) -> None:
    found = {(s, m): condition(tmp_path, s, m) for s in SITUATIONS for m in MODALITIES}
    apart = {}
    for situation in SITUATIONS:
        seen, heard = found[situation, "seen"], found[situation, "seen and heard"]
        assert heard.hands < seen.hands
        apart[situation] = seen.offset - heard.offset
    assert apart["bend"] > max(apart["straight"], 0.5)
