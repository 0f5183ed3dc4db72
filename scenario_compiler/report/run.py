"""`Run`: one run with everything that a report uses."""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.names import MOMENTS, EventKind
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.recording.recording import Recording
from scenario_compiler.roads.network import Network

HEALTHY = 0.98
"""Health of the sensor from which curves do not show it."""


@dataclass(frozen=True, slots=True)
class Run:
    """A run: the plan, its map, the recording and the outcome."""

    plan: Plan
    network: Network
    recording: Recording
    outcome: Outcome

    def __repr__(self) -> str:
        """Return one line: a notebook would display the plan and all arrays otherwise."""
        about = f"{self.plan.name}, seed {self.recording.header.seed}: {self.outcome.result}"
        return f"<Run of {about}; Report([run]) shows it>"

    @property
    def moments(self) -> tuple[tuple[EventKind, float], ...]:
        """The first event of each of `MOMENTS` that occurred, ordered by time: (kind, s)."""
        first: dict[EventKind, float] = {}
        for event in self.recording.events:
            if event.kind in MOMENTS:
                first.setdefault(event.kind, event.t)
        return tuple(first.items())

    @property
    def focus(self) -> tuple[str, float]:
        """The moment of the close-up as (words, s): the request, or the collision, or the end of the run."""
        moments = dict(self.moments)
        for kind in ("request", "collision"):
            if kind in moments:
                return kind, moments[kind]
        return "end of the run", float(self.recording.t[-1])
