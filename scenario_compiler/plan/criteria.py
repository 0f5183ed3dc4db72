"""Checks that every criterion can be met."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.vocabulary.criteria import ReachDestination, Requested
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.takeover import Takeover

UNFULFILLABLE = Code(
    "SC404",
    "criterion-never-met",
    "A criterion can never be met, so every run fails: the ego vehicle must reach a destination but has none, or a "
    "request must have a cause that the takeover policy does not enable.\n\n"
    '    <ego speed="10"> <start>...</start> </ego>     <destination>...</destination> is missing inside\n'
    "    <criteria><reach_destination/></criteria>",
    Severity.WARNING,
)


def check_criteria(scenario: Scenario, takeover: Takeover, sink: Diagnostics) -> None:
    """Warn of criteria on a missing destination or a missing cause of requests; `takeover` has the causes."""
    causes = {"scheduled", *(one.kind for one in takeover.causes)}
    for criterion in scenario.criteria:
        if isinstance(criterion, ReachDestination) and (scenario.ego is None or scenario.ego.destination is None):
            message = "the ego vehicle has no <destination> to reach"
            sink.add(UNFULFILLABLE, message, criterion.origin)
        elif isinstance(criterion, Requested) and criterion.cause is not None and criterion.cause not in causes:
            message = f"no request has the cause '{criterion.cause}': <takeover> does not enable this <cause>"
            sink.add(UNFULFILLABLE, message, criterion.place_of("cause"))
