"""A whole plan to a program, and the rows of its variants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from scenario_compiler.engine.program.draft import Draft
from scenario_compiler.engine.program.entities import add_entities
from scenario_compiler.engine.program.run import add_markings, add_run
from scenario_compiler.engine.program.storyboard import add_init, add_storyboard
from scenario_compiler.engine.program.takeover import add_takeover
from scenario_compiler.engine.program.world import add_world
from scenario_compiler.engine.tables import Program, validate
from scenario_compiler.expressions import Value
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads.network import Network
from scenario_compiler.vocabulary.scenario import parameter_values


def build_program(plan: Plan, network: Network, *, posed: bool = False) -> Program:
    """Lower a plan, with its parameters at their defaults; `posed` leaves the ego's motion to another program.

    Raises:
        KeyError: The plan names a road or entity that there is not; a plan that was made for another map.
        ValueError: The plan holds a word that has no row.
        ExpressionError: A parameter without default leaves a number open.
    """
    draft = _drafted(plan, network, posed=posed)
    draft.program.const = draft.row(parameter_values(plan.parameters))
    draft.program.road_count[0] = len(network.road_ids)
    validate(draft.program, len(network.road_ids))
    return draft.program


def rows(plan: Plan, network: Network, samples: Sequence[Mapping[str, Value]]) -> list[list[float]]:
    """Return a row of `Program.const` for each sample of the parameters; what a sample leaves out is at its default."""
    draft = _drafted(plan, network, posed=False)
    usual = parameter_values(plan.parameters)
    return [draft.row({**usual, **sample}) for sample in samples]


def _drafted(plan: Plan, network: Network, *, posed: bool) -> Draft:
    draft = Draft(plan, network)
    add_run(draft)
    if plan.controller is not None:
        add_takeover(draft)
    add_world(draft)
    add_entities(draft, posed=posed)
    add_markings(draft)
    add_init(draft)
    add_storyboard(draft)
    return draft
