"""Lanes that a clearance counts."""

from __future__ import annotations

from math import pi

import pytest

from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.clearance import is_clear
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import SpeedAction
from scenario_compiler.vocabulary.conditions import RelativeClearanceCondition, RelativeLaneRange
from scenario_compiler.vocabulary.positions import LanePositionWord, Position
from scenario_compiler.vocabulary.storyboard import ConditionGroup, Event, StoryAction, Trigger, TriggerCondition
from tests.engine.make import lane, network_of, road
from tests.engine.test_positions import begun, board, planned
from tests.roads.test_lane_end import RENUMBERED


@pytest.mark.parametrize(("lane", "away"), [(-1, 0), (-2, -1)])
@pytest.mark.parametrize("range_of", [-1, 0, 1])
def test_lanes_count_from_the_one_that_continues_the_own_lane(lane: int, away: int, range_of: int) -> None:
    """Lane -2, in which b drives, is lane -1 beyond 100 m, where a drives."""
    place = LanePositionWord(road="1", lane=lane, s=120.0)
    exists = range_of != -1
    found = clear_of(network_of(RENUMBERED), LanePositionWord(road="1", lane=-2, s=80.0), place, range_of)
    assert found == (1 if exists and range_of != away else 0)


def clear_of(network: Network, b: LanePositionWord, a: LanePositionWord, range_of: int) -> int:
    """Return whether a lane beside the one of b is clear of a within 60 m."""
    starts: dict[str, Position | None] = {"b": b, "a": a}
    lanes = (RelativeLaneRange(least=range_of, greatest=range_of),)
    clear = RelativeClearanceCondition(entity="b", of=("a",), forward=60.0, lanes=lanes)
    start = Trigger(groups=(ConditionGroup(conditions=(TriggerCondition(condition=clear),)),))
    event = Event(name="event", actions=(StoryAction(name="action", action=SpeedAction(to=1.0)),), start=start)
    plan, _ = planned(network, starts, board(event), speed=10.0)
    program = build_program(plan, network)
    state, numbers = begun(network, plan)
    return is_clear(network.tables, program, state, 0, numbers["b"])


LINKED = '<{} elementType="{}" elementId="{}" contactPoint="{}"/>'


def turning() -> Network:
    """Return a junction after road 1 that leads straight to road 2, and to the left to road 3.

    Road 3 is drawn towards the junction, so that its lane 1 continues lane -1 of road 1.
    """
    before, after = (LINKED.format(end, "junction", 9, "") for end in ("successor", "predecessor"))
    connecting = [
        LINKED.format("predecessor", "road", 1, "end") + LINKED.format("successor", "road", to, contact)
        for to, contact in ((2, "start"), (3, "end"))
    ]
    onward, crossed = (f'<predecessor id="-1"/><successor id="{lane_id}"/>' for lane_id in (-1, 1))
    drawn = road(3, 100.0, left=lane(1), link=before, x=110.0).replace('y="0" hdg="0"', f'y="110" hdg="{-0.5 * pi}"')
    roads = (
        road(1, 100.0, lane(-1), lane(-2), link=before),
        road(2, 100.0, lane(-1), x=110.0, link=after),
        drawn,
        road(4, 10.0, lane(-1, link=onward), x=100.0, link=connecting[0]).replace('junction="-1"', 'junction="9"'),
        road(5, 5.0 * pi, lane(-1, link=crossed), x=100.0, shape='<arc curvature="0.1"/>', link=connecting[1]).replace(
            'junction="-1"', 'junction="9"'
        ),
    )
    joined = "".join(
        f'<connection id="{way}" incomingRoad="1" connectingRoad="{way}" contactPoint="start"><laneLink from="-1" '
        'to="-1"/></connection>'
        for way in (4, 5)
    )
    return network_of(*roads, f'<junction id="9" name="">{joined}</junction>')


@pytest.mark.parametrize(("other", "lane"), [("2", -1), ("3", 1)])
@pytest.mark.parametrize("range_of", [-1, 0])
def test_beyond_a_junction_lanes_count_from_the_one_to_which_the_turn_leads(
    other: str, lane: int, range_of: int
) -> None:
    s = 20.0 if other == "2" else 80.0
    place = LanePositionWord(road=other, lane=lane, s=s)
    found = clear_of(turning(), LanePositionWord(road="1", lane=-1, s=90.0), place, range_of)
    assert found == (0 if range_of == 0 else 1)
