"""Guides: tables of the next road, made from routes and destinations."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.plan.model import RouteLeg
from scenario_compiler.plan.routes import route_path, stretch_in, stretch_of
from scenario_compiler.roads.ways import Stretch, onward, path_between
from scenario_compiler.vocabulary.positions import RouteWord
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import Word


def add_guide(draft: ProgramBuilder, following: Iterable[tuple[Stretch, int]], last: int) -> int:
    """Append a guide from stretches and the roads that follow them, which ends with the road `last`; return its row."""
    p = draft.program
    roads = len(draft.network.road_ids)
    row = [op.NONE] * (2 * roads)
    for (road, sense), ahead in following:
        at = 2 * road + (1 if sense > 0 else 0)
        if row[at] == op.NONE:
            row[at] = ahead
    p.guide_next.extend(row)
    p.guide_last.append(last)
    return len(p.guide_last) - 1


def add_legs(draft: ProgramBuilder, legs: Sequence[RouteLeg]) -> int:
    """Append the guide of a route over lanes; return its row, NONE for an empty one."""
    if not legs:
        return op.NONE
    path = [stretch_in(draft.network, leg.road, leg.lane, leg.s_from) for leg in legs]
    return add_guide(draft, _steps(path), path[-1][0])


def add_route(draft: ProgramBuilder, route: RouteWord) -> int:
    """Append the guide of a route over waypoints; return its row, NONE if none of them lies on a road."""
    path = route_path(draft.network, parameter_values(draft.plan.parameters), route)
    if not path:
        return op.NONE
    if not route.closed:
        return add_guide(draft, _steps(path), path[-1][0])
    n = draft.network.tables
    back = path_between(n, path[-1], path[0]) or path[-1:]
    return add_guide(draft, _steps([*path[:-1], *back]), op.NONE)


def add_goal(draft: ProgramBuilder, position: Word) -> int:
    """Append the guide to a position from everywhere; return its row, NONE if it does not lie on a road."""
    goal = stretch_of(draft.network, parameter_values(draft.plan.parameters), position)
    if goal is None:
        return op.NONE
    n = draft.network.tables
    steps = onward(n, goal)
    other = onward(n, (goal[0], -goal[1]))
    return add_guide(draft, [(one, to[0]) for one, to in (*steps.items(), *other.items())], goal[0])


def _steps(path: Sequence[Stretch]) -> list[tuple[Stretch, int]]:
    return [(one, to[0]) for one, to in pairwise(path)]
