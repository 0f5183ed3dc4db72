"""Checks that no two entities overlap at the start."""

from __future__ import annotations

import math
from itertools import pairwise

from scenario_compiler.diagnostics import Code, Diagnostics, Related, Severity
from scenario_compiler.frames import center_from_reference
from scenario_compiler.plan.model import Entity, Plan, StartPose
from scenario_compiler.plan.places import reach
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import ConnectTrailerAction

OVERLAP = Code(
    "SC381",
    "entities-overlap",
    "The boxes of two entities overlap at the start: the run would begin with a collision. Move one of them. Without "
    "an automated vehicle this is only a warning, and the file can run.\n\n"
    '    <static id="a"><at><ahead_of entity="ego" distance="3"/></at></static>     both cars are longer than 3 m',
)


NEAR = (-1, 0, 1)
"""Offsets in columns and rows from a cell to the cells whose entities can overlap with its own."""


def check_overlap(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report every entity whose box overlaps an earlier one's at the start. Trailers of actions are not checked."""
    del network
    severity = None if any(entity.kind == "ego" for entity in plan.entities) else Severity.WARNING
    actions = [initial.action for initial in plan.storyboard.init]
    trailers = {action.trailer for action in actions if isinstance(action, ConnectTrailerAction)}
    standing = [one for one in plan.entities if one.id in plan.derived and one.id not in trailers]
    size = 2.0 * max(map(reach, standing), default=1.0)
    cells: dict[tuple[int, int], list[Entity]] = {}
    for other in standing:
        there = plan.derived[other.id]
        column, row = math.floor(there.x / size), math.floor(there.y / size)
        near = [one for c in NEAR for r in NEAR for one in cells.get((column + c, row + r), ())]
        hit = next((one for one in near if overlap_at_start(one, plan.derived[one.id], other, there)), None)
        if hit is not None:
            message = f"'{hit.id}' and '{other.id}' overlap at the start"
            place, there_too = (place_of(plan, f"entities/{one.id}") for one in (other, hit))
            related = (Related(f"'{hit.id}' is placed here", there_too),)
            sink.add(OVERLAP, message, place, severity=severity, related=related)
        cells.setdefault((column, row), []).append(other)


def overlap_at_start(one: Entity, at: StartPose, other: Entity, there: StartPose) -> bool:
    """Return whether the boxes of two entities overlap; entities on levels 2 m or more apart do not."""
    if abs(at.z - there.z) >= 2.0:
        return False
    return boxes_overlap(corners(one, at), corners(other, there))


def corners(entity: Entity, pose: StartPose) -> list[tuple[float, float]]:
    """Return the corners of an entity's box on the ground, counter-clockwise, m."""
    x, y = center_from_reference(pose.x, pose.y, pose.heading, entity.vehicle.center)
    c, s = math.cos(pose.heading), math.sin(pose.heading)
    a, b = entity.vehicle.length / 2, entity.vehicle.width / 2
    return [(x + c * u - s * v, y + s * u + c * v) for u, v in ((a, b), (-a, b), (-a, -b), (a, -b))]


def boxes_overlap(one: list[tuple[float, float]], other: list[tuple[float, float]]) -> bool:
    """Return whether two rectangles overlap, by the separating axis theorem."""
    for box in (one, other):
        for (ax, ay), (bx, by) in pairwise(box):
            nx, ny = by - ay, ax - bx
            first = [nx * x + ny * y for x, y in one]
            second = [nx * x + ny * y for x, y in other]
            if max(first) <= min(second) or max(second) <= min(first):
                return False
    return True
