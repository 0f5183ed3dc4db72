"""Checks that events with many executions have a trigger."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.plan.checks.triggers import events_of
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network

RESTARTS = Code(
    "SC285",
    "restarts-at-once",
    "An event may run many times but has no trigger, so it starts again as soon as it has ended. If its actions take "
    "no time, this happens in every step. It fills the event log, and may control its entity's speed or lane "
    "permanently.\n\n"
    '    <Event name="again" priority="parallel" maximumExecutionCount="10000"> <Action .../> </Event>\n\n'
    "Give it a trigger, or fewer executions.",
    Severity.WARNING,
)

MANY = 100
"""Number of executions without a trigger up to which there is no warning."""


def check_restarts(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of events without a trigger that may be executed more than MANY times."""
    del network
    for event in events_of(plan).values():
        free = event.start is None or not event.start.groups
        if free and event.maximum_execution_count > MANY:
            message = f"'{event.name}' has no trigger and may run {event.maximum_execution_count} times"
            sink.add(RESTARTS, message, event.origin)
