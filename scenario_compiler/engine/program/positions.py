"""The rows of positions: `POSITIONS`, by the type of their word."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.rows import PositionRow, Slot
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.engine.program.guides import add_route
from scenario_compiler.engine.program.tracks import add_track
from scenario_compiler.plan.places import spans_of
from scenario_compiler.plan.routes import place_on_route
from scenario_compiler.vocabulary.positions import (
    AnyOfPosition,
    BesidePosition,
    FreePosition,
    InRouteEntity,
    LanePositionWord,
    LanesAwayPosition,
    RandomPosition,
    RelativeLanePosition,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
    RoutePosition,
    TrajectoryPosition,
)
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.word import Word

TRAFFIC_MARGINS = (5.0, 25.0)
"""Distances of traffic vehicles at the start from where a road is entered and left, m: enough to stop there."""


Turning = (
    LanePositionWord
    | LanesAwayPosition
    | RelativeRoadPosition
    | RelativeObjectPosition
    | RelativeWorldPosition
    | RoutePosition
    | TrajectoryPosition
)
"""Positions with a heading that is relative to them or absolute."""


def add_position(draft: ProgramBuilder, word: Word, kind: str = "") -> int:
    """Append a position, for an entity of a kind; return its row.

    Raises:
        ValueError: POSITIONS has no entry for the word.
        KeyError: It names a road or entity that does not exist.
    """
    if type(word) not in POSITIONS:
        raise ValueError(f"a program has no row for the position <{word.tag()}>")
    return draft.add_position(POSITIONS[type(word)](draft, word, kind))


def _lane(draft: ProgramBuilder, word: LanePositionWord, kind: str) -> PositionRow:
    del kind
    road = draft.network.road_index(word.road)
    heading, absolute = _heading(word)
    return PositionRow(op.POSITION_LANE, (word.s, word.offset, heading), road=road, lane=word.lane, flags=absolute)


def _heading(word: Turning) -> tuple[Slot, int]:
    """Return the number of a position's heading, and the flag for an absolute one."""
    return (word.turn, 0) if word.heading is None else (word.heading, op.POSITION_ABSOLUTE)


def _ahead_of(draft: ProgramBuilder, word: RelativeLanePosition, kind: str) -> PositionRow:
    del kind
    const = (word.distance, word.offset, word.turn)
    return PositionRow(op.POSITION_RELATIVE, const, lane=word.lanes, entity=draft.entities[word.entity])


def _beside(draft: ProgramBuilder, word: BesidePosition, kind: str) -> PositionRow:
    del kind
    const = (word.ahead, word.distance, word.turn)
    return PositionRow(op.POSITION_BESIDE, const, entity=draft.entities[word.entity])


def _random(draft: ProgramBuilder, word: RandomPosition, kind: str) -> PositionRow:
    seed = op.NONE if word.seed is None else word.seed
    spans = _spans(draft, word, kind)
    return PositionRow(op.POSITION_RANDOM, (word.clear, word.offset, word.turn), seed=seed, spans=spans)


def _any_of(draft: ProgramBuilder, word: AnyOfPosition, kind: str) -> PositionRow:
    return PositionRow(op.POSITION_RANDOM, (word.clear, 0.0, 0.0), spans=_spans(draft, word, kind))


def _free(draft: ProgramBuilder, word: FreePosition, kind: str) -> PositionRow:
    del draft, kind
    z, flags = (0.0, 0) if word.z is None else (word.z, op.POSITION_WITH_HEIGHT)
    heading = 0.0 if word.heading is None else word.heading
    return PositionRow(op.POSITION_FREE, (word.x, word.y, heading, z), flags=flags)


def _lanes_away(draft: ProgramBuilder, word: LanesAwayPosition, kind: str) -> PositionRow:
    del kind
    heading, flags = _heading(word)
    if word.along == "lane":
        flags |= op.POSITION_ALONG_LANE
    const = (word.distance, word.offset, heading)
    entity = draft.entities[word.entity]
    return PositionRow(op.POSITION_LANES_AWAY, const, lane=word.lanes, entity=entity, flags=flags)


def _relative_road(draft: ProgramBuilder, word: RelativeRoadPosition, kind: str) -> PositionRow:
    del kind
    heading, flags = _heading(word)
    const = (word.ds, word.dt, heading)
    return PositionRow(op.POSITION_RELATIVE_ROAD, const, entity=draft.entities[word.entity], flags=flags)


def _relative_point(
    draft: ProgramBuilder, word: RelativeObjectPosition | RelativeWorldPosition, kind: str
) -> PositionRow:
    del kind
    in_own_axes = isinstance(word, RelativeObjectPosition)
    heading, flags = _heading(word)
    return PositionRow(
        op.POSITION_RELATIVE_OBJECT if in_own_axes else op.POSITION_RELATIVE_WORLD,
        (word.dx, word.dy, heading, word.dz),
        entity=draft.entities[word.entity],
        flags=flags,
    )


def _on_route(draft: ProgramBuilder, word: RoutePosition, kind: str) -> PositionRow:
    del kind
    heading, flags = _heading(word)
    guide = add_route(draft, word.route)
    if isinstance(word.place, InRouteEntity):
        entity = draft.entities[word.place.entity]
        flags |= op.POSITION_ALONG_LANE
        return PositionRow(op.POSITION_LANES_AWAY, (0.0, 0.0, heading), entity=entity, flags=flags, guide=guide)
    values = parameter_values(draft.plan.parameters)
    road, lane, s, offset = place_on_route(draft.network, values, word)
    return PositionRow(op.POSITION_LANE, (s, offset, heading), road=road, lane=lane, flags=flags, guide=guide)


def _on_trajectory(draft: ProgramBuilder, word: TrajectoryPosition, kind: str) -> PositionRow:
    del kind
    heading, flags = _heading(word)
    track = add_track(draft, word.trajectory, add_position)
    return PositionRow(op.POSITION_ON_TRAJECTORY, (word.s, word.t, heading), lane=track, flags=flags)


def _spans(draft: ProgramBuilder, word: RandomPosition | AnyOfPosition, kind: str) -> tuple[int, int]:
    """Append the stretches of a random position, once; return the first row and the one after the last."""
    p, network = draft.program, draft.network
    if (word, kind) not in draft.spans:
        first = p.span_count[0]
        if isinstance(word, AnyOfPosition):
            for one in word.places:
                p.span_road.append(network.road_index(one.road))
                p.span_lane.append(one.lane)
                p.span_const.append(draft.block(one.s, one.s))
        else:
            behind, before = TRAFFIC_MARGINS if kind == "traffic" else (0.0, 0.0)
            for span in spans_of(network, word, behind=behind, before=before):
                p.span_road.append(span.road)
                p.span_lane.append(span.lane)
                p.span_const.append(draft.block(span.s_from, span.s_to))
        p.span_count[0] = len(p.span_road)
        draft.spans[word, kind] = (first, p.span_count[0])
    return draft.spans[word, kind]


POSITIONS: dict[type[Word], Callable[[ProgramBuilder, Any, str], PositionRow]] = {
    LanePositionWord: _lane,
    RelativeLanePosition: _ahead_of,
    BesidePosition: _beside,
    RandomPosition: _random,
    AnyOfPosition: _any_of,
    FreePosition: _free,
    LanesAwayPosition: _lanes_away,
    RelativeRoadPosition: _relative_road,
    RelativeObjectPosition: _relative_point,
    RelativeWorldPosition: _relative_point,
    RoutePosition: _on_route,
    TrajectoryPosition: _on_trajectory,
}
"""Makes the row of a bound position, by its type; the last argument is the kind of the entity that starts there, or
empty.
"""
