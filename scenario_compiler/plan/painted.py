"""The road marks that a plan changes on its map: worn, coloured or covered stretches, and additional lines."""

from __future__ import annotations

import math
import zlib
from collections.abc import Sequence

from scenario_compiler.plan.model import Plan
from scenario_compiler.randomness import random_unit
from scenario_compiler.roads import MarkStretch, Network, Pose, SecondaryLine
from scenario_compiler.roads.lanes import lane_centre
from scenario_compiler.vocabulary.markings import LineBeside, SecondaryMarkings
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import number_value

PIECE = 2.0
"""Length of the pieces of a mark that are covered or not as a whole, m."""


def mark_stretches(plan: Plan) -> list[MarkStretch]:
    """Return the plan's changes of marks as stretches of the network's marks, at the parameters' values."""
    values = parameter_values(plan.parameters)
    stretches: list[MarkStretch] = []
    for stretch in plan.markings:
        s_from, s_to = number_value(stretch.s_from, values), number_value(stretch.s_to, values)
        quality = end = None
        if stretch.quality is not None:
            quality = end = number_value(stretch.quality, values)
            if stretch.quality_to is not None:
                end = number_value(stretch.quality_to, values)
        if quality is not None or stretch.colour is not None:
            stretches.append(MarkStretch(stretch.road, stretch.lane, s_from, s_to, quality, end, stretch.colour))
        coverage = number_value(stretch.coverage, values)
        stretches += [
            MarkStretch(stretch.road, stretch.lane, begin, min(begin + PIECE, s_to), 0.0, 0.0)
            for begin in covered_pieces(stretch.road, s_from, s_to, coverage)
        ]
    return stretches


def secondary_lines(plan: Plan) -> list[SecondaryLine]:
    """Return the lines that the plan adds to the network's marks, at the parameters' values."""
    values = parameter_values(plan.parameters)
    return [
        SecondaryLine(
            line.road,
            number_value(line.s_from, values),
            number_value(line.s_to, values),
            number_value(line.t, values),
            line.colour,
            line.type == "broken",
            number_value(line.width, values),
            number_value(line.quality, values),
        )
        for line in plan.secondary_markings
        if isinstance(line, SecondaryMarkings)
    ]


def lines_beside(plan: Plan, network: Network, poses: Sequence[Pose]) -> list[SecondaryLine]:
    """Return the lines that the plan adds beside its entities; there are none beside one that is not on a road.

    Args:
        plan: The plan.
        network: Its map.
        poses: Start pose of each entity, in the plan's order.
    """
    values = parameter_values(plan.parameters)
    starts = {entity.id: pose for entity, pose in zip(plan.entities, poses, strict=True)}
    found = []
    for line in plan.secondary_markings:
        if not isinstance(line, LineBeside) or line.entity not in starts:
            continue
        pose = starts[line.entity]
        for place in network.locate(pose.x, pose.y, nearest=True)[:1]:
            row = network.road_index(place.road)
            centre, _ = lane_centre(network.tables, row, place.lane, place.s)
            along = network.road_pose(place.road, place.s, 0.0).heading
            facing = 1.0 if math.cos(pose.heading - along) > 0.0 else -1.0
            ends = [place.s + facing * number_value(one, values) for one in (line.s_from, line.s_to)]
            t = centre + place.offset + facing * number_value(line.across, values)
            width, quality = number_value(line.width, values), number_value(line.quality, values)
            broken = line.type == "broken"
            found.append(SecondaryLine(place.road, min(ends), max(ends), t, line.colour, broken, width, quality))
    return found


def covered_pieces(road: str, s_from: float, s_to: float, coverage: float) -> list[float]:
    """Return the s at which each covered piece of a stretch begins, m; they are the same in every run."""
    if coverage <= 0.0:
        return []
    seed = zlib.crc32(road.encode())
    pieces = range(max(math.ceil((s_to - s_from) / PIECE), 0))
    return [s_from + PIECE * k for k in pieces if random_unit(seed, 0, 0, k) < coverage]
