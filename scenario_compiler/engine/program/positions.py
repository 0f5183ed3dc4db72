"""What a position becomes: `POSITIONS`, by the type of its word."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from scenario_compiler.engine import opcodes as op
from scenario_compiler.engine.program.draft import Draft, PositionRow
from scenario_compiler.plan.places import spans_of
from scenario_compiler.vocabulary.positions import (
    AnyOfPosition,
    BesidePosition,
    LanePosition,
    RandomPosition,
    RelativeLanePosition,
)
from scenario_compiler.vocabulary.word import Word

TRAFFIC_MARGINS = (5.0, 25.0)
"""Distances that vehicles of traffic keep at the start from where a road is entered and left, m: enough to stop in."""


def add_position(draft: Draft, word: Word, kind: str = "") -> int:
    """Append a position, of an entity of a kind; return its row.

    Raises:
        ValueError: POSITIONS has no entry for the word.
        KeyError: It names a road or entity that there is not.
    """
    if type(word) not in POSITIONS:
        raise ValueError(f"a program has no row for the position <{word.tag()}>")
    return draft.position(POSITIONS[type(word)](draft, word, kind))


def _lane(draft: Draft, word: LanePosition, kind: str) -> PositionRow:
    del kind
    road = draft.network.road_index(word.road)
    return PositionRow(op.POSITION_LANE, (word.s, word.offset, word.turn), road=road, lane=word.lane)


def _ahead_of(draft: Draft, word: RelativeLanePosition, kind: str) -> PositionRow:
    del kind
    const = (word.distance, word.offset, word.turn)
    return PositionRow(op.POSITION_RELATIVE, const, lane=word.lanes, entity=draft.entities[word.entity])


def _beside(draft: Draft, word: BesidePosition, kind: str) -> PositionRow:
    del kind
    const = (word.ahead, word.distance, word.turn)
    return PositionRow(op.POSITION_BESIDE, const, entity=draft.entities[word.entity])


def _random(draft: Draft, word: RandomPosition, kind: str) -> PositionRow:
    seed = op.NONE if word.seed is None else word.seed
    spans = _spans(draft, word, kind)
    return PositionRow(op.POSITION_RANDOM, (word.clear, word.offset, word.turn), seed=seed, spans=spans)


def _any_of(draft: Draft, word: AnyOfPosition, kind: str) -> PositionRow:
    return PositionRow(op.POSITION_RANDOM, (0.0, 0.0, 0.0), spans=_spans(draft, word, kind))


def _spans(draft: Draft, word: RandomPosition | AnyOfPosition, kind: str) -> tuple[int, int]:
    """Append what a random position is drawn from, once; return its first row and the one after its last."""
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


POSITIONS: dict[type[Word], Callable[[Draft, Any, str], PositionRow]] = {
    LanePosition: _lane,
    RelativeLanePosition: _ahead_of,
    BesidePosition: _beside,
    RandomPosition: _random,
    AnyOfPosition: _any_of,
}
"""By the type of a bound position, its row; the last argument is the kind of the entity that starts there, or empty."""
