"""Lanes that a clearance counts."""

from __future__ import annotations

import pytest

from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.clearance import is_clear
from scenario_compiler.vocabulary.actions import SpeedAction
from scenario_compiler.vocabulary.conditions import RelativeClearanceCondition, RelativeLaneRange
from scenario_compiler.vocabulary.positions import LanePositionWord, Position
from scenario_compiler.vocabulary.storyboard import ConditionGroup, Event, StoryAction, Trigger, TriggerCondition
from tests.engine.make import network_of
from tests.engine.test_positions import begun, board, planned
from tests.roads.test_lane_end import RENUMBERED


@pytest.mark.parametrize(("lane", "away"), [(-1, 0), (-2, -1)])
@pytest.mark.parametrize("range_of", [-1, 0, 1])
def test_lanes_count_from_the_one_that_continues_the_own_lane(lane: int, away: int, range_of: int) -> None:
    """Lane -2, in which b drives, is lane -1 beyond 100 m, where a drives."""
    network = network_of(RENUMBERED)
    starts: dict[str, Position | None] = {
        "b": LanePositionWord(road="1", lane=-2, s=80.0),
        "a": LanePositionWord(road="1", lane=lane, s=120.0),
    }
    lanes = (RelativeLaneRange(least=range_of, greatest=range_of),)
    clear = RelativeClearanceCondition(entity="b", of=("a",), forward=60.0, lanes=lanes)
    start = Trigger(groups=(ConditionGroup(conditions=(TriggerCondition(condition=clear),)),))
    event = Event(name="event", actions=(StoryAction(name="action", action=SpeedAction(to=1.0)),), start=start)
    plan, _ = planned(network, starts, board(event), speed=10.0)
    program = build_program(plan, network)
    state, numbers = begun(network, plan)
    exists = range_of != -1
    assert is_clear(network.tables, program, state, 0, numbers["b"]) == (1 if exists and range_of != away else 0)
