"""Expands groups of static things to the single things."""

from __future__ import annotations

import math

from scenario_compiler.vocabulary.entities import Row, Static, WorkZone
from scenario_compiler.vocabulary.markings import LineBeside
from scenario_compiler.vocabulary.positions import BesidePosition
from scenario_compiler.vocabulary.word import Number

CONE = "static.prop.constructioncone"
BARRIER = "static.prop.streetbarrier"
SIGN = "static.prop.warningconstruction"

BARRIER_SPACING = 1.4
"""Distance between barriers that close a lane, m: each is 1.2 m long."""

SIGN_ASIDE = 1.0
"""Distance of the sign outside the first cone, m."""

ACROSS = math.pi / 2
"""Heading of barriers that close a lane, relative to the lane, rad."""


def members(group: Row | WorkZone) -> list[Static]:
    """Return the members of a group; all but the first are positioned relative to the first."""
    return _row(group) if isinstance(group, Row) else _work_zone(group)


LINE_ASIDE = 0.4
"""Distance of the temporary line from the cones of the closed stretch, on the open side, m."""


def lines(group: Row | WorkZone) -> list[LineBeside]:
    """Return the lines that a group paints: along the closed stretch of a work zone, if it has one."""
    if isinstance(group, Row) or not group.line:
        return []
    across = group.across + math.copysign(LINE_ASIDE, group.across)
    first = f"{group.id}.taper.1"
    line = LineBeside(entity=first, s_from=group.taper, s_to=group.taper + group.length, across=across)
    return [line.written_at(group.origin)]


def _row(row: Row) -> list[Static]:
    first = Static(id=f"{row.id}.1", model=row.model, at=row.at).written_at(row.origin)
    turn = getattr(row.at, "turn", 0.0)
    rest = [
        _beside(row, f"{row.id}.{k + 1}", row.model, first, k * row.spacing, row.across * k / (row.count - 1), turn)
        for k in range(1, row.count)
    ]
    return [first, *rest]


def _work_zone(zone: WorkZone) -> list[Static]:
    first = Static(id=f"{zone.id}.taper.1", model=CONE, at=zone.at).written_at(zone.origin)
    parts = [first]
    tapered = math.ceil(zone.taper / zone.spacing)
    for k in range(1, tapered + 1):
        share = k / tapered
        parts.append(_beside(zone, f"{zone.id}.taper.{k + 1}", CONE, first, share * zone.taper, share * zone.across))
    barriers = max(1, math.floor(abs(zone.across) / BARRIER_SPACING))
    for k in range(barriers):
        share = (k + 0.5) / barriers
        name = f"{zone.id}.barrier.{k + 1}"
        parts.append(_beside(zone, name, BARRIER, first, zone.taper + 2.0, share * zone.across, ACROSS))
    along = math.ceil(zone.length / zone.spacing)
    for k in range(1, along + 1):
        ahead = zone.taper + zone.length * k / along
        parts.append(_beside(zone, f"{zone.id}.cones.{k}", CONE, first, ahead, zone.across))
    if zone.sign_before > 0.0:
        outside = -math.copysign(SIGN_ASIDE, zone.across)
        parts.append(_beside(zone, f"{zone.id}.sign", SIGN, first, -zone.sign_before, outside))
    return parts


def _beside(
    group: Row | WorkZone, name: str, model: str, first: Static, ahead: float, across: float, turn: Number = 0.0
) -> Static:
    place = BesidePosition(entity=first.id, distance=across, ahead=ahead, turn=turn).written_at(group.origin)
    return Static(id=name, model=model, at=place).written_at(group.origin)
