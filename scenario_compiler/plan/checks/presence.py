"""Checks that the automated vehicle is not added, removed or towed, and that no entity tows itself."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import AddEntityAction, ConnectTrailerAction, DeleteEntityAction

EGO_STAYS = Code(
    "SC386",
    "automated-vehicle-stays",
    "An action adds, removes or tows the automated vehicle. The automated vehicle is the subject of a run: it is "
    "present from start to end and moves by its own controls.\n\n"
    '    <do><delete_entity entity="ego"/></do>     another entity, or <stop/> to end the run',
)
OWN_TRAILER = Code(
    "SC387",
    "trailer-of-itself",
    "An action connects an entity to itself as its own trailer. Name another entity.\n\n"
    '    <dynamic id="truck"> ... <do><connect_trailer trailer="semitrailer"/></do>',
)


def check_presence(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report actions that add, remove or tow the automated vehicle, and entities that tow themselves."""
    del network
    ego = "" if plan.controller is None else plan.ego.id
    for actor, action in plan.storyboard.actions():
        named = ""
        if isinstance(action, AddEntityAction | DeleteEntityAction):
            named = "entity"
        elif isinstance(action, ConnectTrailerAction):
            named = "trailer"
            if action.trailer == actor:
                sink.add(OWN_TRAILER, f"'{actor}' cannot tow itself", action.place_of(named))
                continue
        if named and ego and getattr(action, named) == ego:
            message = f"<{action.tag()}> names '{ego}', the automated vehicle"
            sink.add(EGO_STAYS, message, action.place_of(named))
