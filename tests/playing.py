"""Runs that end at the event that a test needs."""

from __future__ import annotations

from scenario_compiler import Plan, Recording, open_world
from scenario_compiler.roads import Network
from scenario_compiler.runtime.loop import Execution


def played_until(kind: str, plan: Plan, network: Network) -> Recording:
    """Return the run with seed 1 up to its first event of a kind; the whole run if there is none."""
    with open_world("kinematic", plan, network) as world:
        execution = Execution(plan, world, 1)
        while execution.going and kind not in {event.kind for event in execution.builder.events_since(0)}:
            execution.advance()
        return execution.finish()
