"""The end of the first takeover request of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from scenario_compiler.recording.names import EventKind
from scenario_compiler.recording.recording import Floats

Resolution = Literal["stopped", "no_request", "driver", "minimum_risk", "unanswered", "open"]

MEANINGS: dict[Resolution, str] = {
    "stopped": "none was made, though the automated vehicle stood without a reason",
    "no_request": "none was made",
    "driver": "the driver answered first",
    "minimum_risk": "the minimum-risk manoeuvre began first",
    "unanswered": "neither, though it escalated or the vehicle collided",
    "open": "the run ended before any of that",
}
"""The meaning of each resolution; a run has the first one that applies."""

WITHOUT_REQUEST: frozenset[Resolution] = frozenset(("stopped", "no_request"))
"""Resolutions of runs without a takeover request."""


def resolutions(times: Mapping[EventKind, Floats]) -> list[Resolution]:
    """Return how the first request of each run ended.

    Args:
        times: First time of each kind of event, s, (runs,) or of one run (); NaN if it never occurred.
    """
    request = np.atleast_1d(times["request"])

    def since(kind: EventKind) -> Floats:
        """Return the first time of an event at or after the request; infinite if there is none."""
        return np.where(times[kind] >= request, times[kind], np.inf)

    driver, minimum_risk = since("response"), since("minimum_risk")
    holds = (
        np.isnan(request) & ~np.isnan(np.atleast_1d(times["no_progress"])),
        np.isnan(request),
        np.isfinite(driver) & (driver <= minimum_risk),
        np.isfinite(minimum_risk),
        np.isfinite(np.minimum(since("escalation"), since("collision"))),
    )
    named = tuple(MEANINGS)
    return [named[k] for k in np.select(holds, range(len(holds)), len(holds)).tolist()]
