"""Checks that the actions of the init do not depend on each other in a circle."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics, Related, Severity
from scenario_compiler.plan.init_order import circular, placed_before, unplaced
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import TeleportAction

CIRCLE = Code(
    "SC291",
    "circle-in-init",
    "Actions of the init depend on each other in a circle: each places its entity relative to an entity that the next "
    "one places, or sets a speed relative to one that the next one sets. One of them must be executed first. It finds "
    "the other entity at the world's origin, off every road, or standing still. An entity that gets its first "
    "position relative to itself is such a circle, too.\n\n"
    '    <Private entityRef="car"> ... <RelativeLanePosition entityRef="van" .../>\n'
    '    <Private entityRef="van"> ... <RelativeLanePosition entityRef="car" .../>\n\n'
    "Give one of the entities a position or a speed that does not depend on the others.",
    Severity.WARNING,
)


def check_initial(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Warn of actions of the init that need a position or a speed that only they themselves or a later action set."""
    del network
    before = placed_before(plan.entities)
    for initial in unplaced(plan.storyboard.init, before):
        sink.add(
            CIRCLE,
            f"'{initial.entity}' gets its first position relative to itself",
            initial.action.origin,
            hint=f"'{initial.entity}' still stands at the origin",
        )
    for initial, needed in circular(plan.storyboard.init, before):
        what = "position" if isinstance(needed.action, TeleportAction) else "speed"
        sink.add(
            CIRCLE,
            f"'{initial.entity}' gets its {what} relative to '{needed.entity}', which gets its own relative to others "
            f"that depend on '{initial.entity}'",
            initial.action.origin,
            hint=f"'{needed.entity}' still stands at the origin" if what == "position" else "its speed counts as 0",
            related=(Related(f"'{needed.entity}' gets its {what} here", needed.action.origin),),
        )
