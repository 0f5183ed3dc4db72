"""Eriksson and Stanton 2017, "Takeover Time in Highly Automated Vehicles": no hazard, no hurry.

Human Factors 59, 689-705. Drivers were asked to take over with nothing ahead of them and in their own time, without and
with a secondary task.

| | the paper | here | asserted |
|---|---|---|---|
| median without a task | 4.567 s | the driver `unhurried` is fitted to it | within a fifth, over 60 seeds |
| median with a task | 6.061 s | the driver `unhurried_with_task` is fitted to it | within a fifth, and longer |

The medians are as a later paper quotes them; the original was not read.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.studies.study import compiled, runs, time_of

ERIKSSON = """<scenarios version="1"><scenario name="eriksson" map="motorway" duration="45" control_every="2">
<ego speed="31.3"><start><spawn_point name="middle_lane"/></start></ego>
<when><time after="5"/><do><request/></do></when>
<takeover minimum_risk_after="60"><driver preset="{driver}"/></takeover></scenario></scenarios>"""
SEEDS = range(1, 61)


def times(folder: Path, driver: str) -> list[float]:
    """Return the takeover times of the drivers who answered, s."""
    found = compiled(folder, ERIKSSON.format(driver=driver).replace('duration="45"', 'duration="25"'))
    taken = []
    for recording, outcome in runs(found, SEEDS):
        assert outcome.cause == "scheduled"
        assert time_of(recording, "request") == pytest.approx(5.0, abs=0.1001)
        assert outcome.collision_with is None
        value = outcome.measures["takeover_time"].value
        if value is not None:
            taken.append(value)
    return taken


def test_a_request_without_a_hazard_is_answered_in_the_drivers_own_time(tmp_path: Path) -> None:
    without, busy = (float(np.median(times(tmp_path, name))) for name in ("unhurried", "unhurried_with_task"))
    assert without == pytest.approx(4.567, rel=0.2)
    assert busy == pytest.approx(6.061, rel=0.2)
    assert without < busy
