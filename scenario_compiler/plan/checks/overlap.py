"""Checks that no two entities overlap at the start."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import chain, pairwise

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
    """Report every entity whose box overlaps an earlier one's at the start."""
    del network
    Overlaps(plan).report(plan.derived, sink)


class Overlaps:
    """The check of a plan's entities for overlaps, at any start poses. Trailers of actions are not checked."""

    def __init__(self, plan: Plan) -> None:
        """Prepare what does not depend on the poses."""
        self._plan = plan
        self._severity = None if any(entity.kind == "ego" for entity in plan.entities) else Severity.WARNING
        actions = [initial.action for initial in plan.storyboard.init]
        trailers = {action.trailer for action in actions if isinstance(action, ConnectTrailerAction)}
        self._entities = [(one, reach(one)) for one in plan.entities if one.id not in trailers]

    def report(self, poses: Mapping[str, StartPose], sink: Diagnostics) -> None:
        """Report every entity with a pose whose box overlaps an earlier one's."""
        standing = [(one, far, poses[one.id]) for one, far in self._entities if one.id in poses]
        size = 2.0 * max((far for _, far, _ in standing), default=1.0)
        cells: dict[tuple[int, int], list[tuple[Entity, float, StartPose]]] = {}
        for other, far, there in standing:
            column, row = math.floor(there.x / size), math.floor(there.y / size)
            near = [cell for c in NEAR for r in NEAR if (cell := cells.get((column + c, row + r)))]
            for one, its_far, at in chain.from_iterable(near):
                # Boxes whose reference points are further apart than both reach cannot overlap.
                if math.hypot(at.x - there.x, at.y - there.y) > far + its_far:
                    continue
                if overlap_at_start(one, at, other, there):
                    self._add(one, other, sink)
                    break
            cells.setdefault((column, row), []).append((other, far, there))

    def _add(self, hit: Entity, other: Entity, sink: Diagnostics) -> None:
        message = f"'{hit.id}' and '{other.id}' overlap at the start"
        place, there_too = (place_of(self._plan, f"entities/{one.id}") for one in (other, hit))
        related = (Related(f"'{hit.id}' is placed here", there_too),)
        sink.add(OVERLAP, message, place, severity=self._severity, related=related)


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
