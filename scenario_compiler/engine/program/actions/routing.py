"""Actions on which way entities go at junctions."""

from __future__ import annotations

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.actions.family import Family
from scenario_compiler.engine.program.draft import ActionRow, Draft
from scenario_compiler.engine.program.guides import add_goal, add_route
from scenario_compiler.vocabulary.actions import AcquirePositionAction, AssignRouteAction, RandomRouteAction


def _assign_route(draft: Draft, word: AssignRouteAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_ASSIGN_ROUTE, other=add_route(draft, word.route))


def _acquire(draft: Draft, word: AcquirePositionAction, actor: int) -> ActionRow:
    del actor
    return ActionRow(op.ACTION_ASSIGN_ROUTE, other=add_goal(draft, word.position))


def _random_route(draft: Draft, word: RandomRouteAction, actor: int) -> ActionRow:
    del draft, word, actor
    return ActionRow(op.ACTION_RANDOM_ROUTE, other=op.RANDOM_GUIDE)


ACTIONS: Family = {
    AssignRouteAction: _assign_route,
    AcquirePositionAction: _acquire,
    RandomRouteAction: _random_route,
}
