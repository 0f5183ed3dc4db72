"""Checks that classifications name situations of the taxonomies whose tables are known."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Severity, did_you_mean
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.taxonomies import TAXONOMIES

UNKNOWN_SITUATION = Code(
    "SC294",
    "unknown-situation",
    "A <classification> names a situation that the taxonomy does not have, or its scheme differs from a known one only "
    "in upper and lower case. Reports and `scenario-compiler library` then count it as a situation of its own.\n\n"
    '    <classification scheme="r157" situation="4.2_9"/>     4.2_1 to 4.2_4 are blocked lanes',
    Severity.WARNING,
)


def check_classifications(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of situations that a taxonomy with a complete table lacks, and of schemes in the wrong case."""
    del network
    for one in plan.classifications:
        taxonomy = TAXONOMIES.get(one.scheme)
        if taxonomy is None:
            if one.scheme.lower() in TAXONOMIES:
                hint = f"did you mean '{one.scheme.lower()}'?"
                sink.add(UNKNOWN_SITUATION, f"there is no taxonomy '{one.scheme}'", one.place_of("scheme"), hint=hint)
        elif taxonomy.whole and one.place and one.place not in taxonomy.situations:
            message = f"{taxonomy.title} has no situation '{one.place}'"
            place = one.place_of("situation" if one.situation else "number")
            sink.add(UNKNOWN_SITUATION, message, place, hint=did_you_mean(one.place, taxonomy.situations))
