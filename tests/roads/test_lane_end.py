"""Lanes that end although their road continues."""

from __future__ import annotations

from scenario_compiler.roads.lane_end import lane_after_end
from tests.engine.make import lane, network_of, road

SECTIONS = road(1, 200.0, lane(-1), lane(-2), left=lane(1)).replace(
    "</laneSection>",
    '</laneSection><laneSection s="100"><left><lane id="1" type="driving" level="false">'
    '<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left><center><lane id="0" type="none" level="false"/>'
    '</center><right><lane id="-1" type="driving" level="false">'
    '<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection>',
)

RENUMBERED = road(1, 200.0, lane(-1), lane(-2, link='<successor id="-1"/>')).replace(
    "</laneSection>",
    '</laneSection><laneSection s="100"><center><lane id="0" type="none" level="false"/></center><right>'
    + lane(-1, link='<predecessor id="-2"/>')
    + lane(-2)
    + "</right></laneSection>",
)
"""Lane -1 ends at 100 m, and lane -2 becomes lane -1."""


def test_the_adjacent_lane_continues() -> None:
    n = network_of(SECTIONS).tables
    beside, s = lane_after_end(n, 0, -2, 100.0, 0.0, 1)
    assert (beside, round(s, 4)) == (-1, 100.0)


def test_the_same_number_in_the_next_section_is_another_lane() -> None:
    n = network_of(RENUMBERED).tables
    assert lane_after_end(n, 0, -1, 100.0, 0.0, 1)[0] == -1
    assert lane_after_end(n, 0, -1, 100.0, -3.0, 1)[0] == -2


def test_only_lanes_of_the_same_direction_continue() -> None:
    n = network_of(road(1, 200.0, lane(-1), left=lane(1))).tables
    assert lane_after_end(n, 0, -1, 200.0, 0.0, 1)[0] == 0


def test_at_the_end_of_the_road_a_lane_needs_a_successor() -> None:
    first = road(
        1,
        100.0,
        lane(-1, link='<successor id="-1"/>'),
        lane(-2),
        link='<successor elementType="road" elementId="2" contactPoint="start"/>',
    )
    second = road(
        2,
        100.0,
        lane(-1, link='<predecessor id="-1"/>'),
        x=100.0,
        link='<predecessor elementType="road" elementId="1" contactPoint="end"/>',
    )
    n = network_of(first, second).tables
    assert lane_after_end(n, 0, -2, 100.0, 0.0, 1) == (-1, 100.0)
    assert lane_after_end(n, 1, -1, 100.0, 0.0, 1)[0] == 0


def test_a_lane_that_is_reversed_from_there_on_does_not_continue() -> None:
    before, _, lane_inside = SECTIONS.rpartition("<lane ")
    turned = f'{before}<lane direction="reversed" {lane_inside}'
    n = network_of(turned).tables
    assert lane_after_end(n, 0, -1, 100.0, 0.0, 1)[0] == 0
