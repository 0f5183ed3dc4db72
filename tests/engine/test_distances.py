"""Distances between entities: along roads and turns, between boxes, in each system."""

from __future__ import annotations

from itertools import pairwise
from math import atan, hypot, pi, sqrt
from pathlib import Path

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.motion.collision import update_boxes
from scenario_compiler.engine.motion.distances import (
    box_distance,
    distance_between,
    distance_to,
    distance_to_box,
    road_distance_between,
)
from scenario_compiler.roads import LanePosition, Network, load_network
from tests.engine.make import CAR, Draft, Run, bend, highway

LENGTH, WIDTH, HEIGHT, _, CENTER = CAR[:5]


@pytest.fixture(scope="module")
def town(repository: Path) -> Network:
    """The map of a town with crossings."""
    return load_network(repository / "maps" / "town_grid" / "town_grid.xodr")


def two(dx: float, dy: float, turn: float, network: Network | None = None) -> Run:
    """Return a run with a car whose box is at the origin, along x, and another's box at (dx, dy), turned."""
    draft = Draft(network or highway())
    draft.moving(-2, 100.0, 0.0)
    draft.moving(-2, 200.0, 0.0)
    run = draft.start()
    run.st.x[:], run.st.y[:], run.st.h[:] = [-CENTER, dx], [0.0, dy], [0.0, turn]
    run.p.const[run.p.entity_const[1] + 4] = 0.0
    update_boxes(run.p, run.st)
    return run


def mode(frame: int, measure: int) -> int:
    """Return the mode of a condition."""
    return 4 * frame + measure


@pytest.mark.parametrize(("road", "lane"), [("3", -1), ("6", 1), ("7", -1), ("12", -1), ("13", -1)])
def test_along_the_roads_a_turn_is_taken_where_straight_on_does_not_lead_there(
    town: Network, road: str, lane: int
) -> None:
    draft = Draft(town)
    car = draft.entity(op.MOTION_SCRIPTED, draft.position(town.road_index("1"), -1, 400.0), 0.0)
    other = draft.entity(op.MOTION_SCRIPTED, draft.position(town.road_index(road), lane, 20.0), 0.0)
    run = draft.start()
    route = town.route(LanePosition("1", -1, 400.0, 0.0), LanePosition(road, lane, 20.0, 0.0))
    assert route is not None
    way = sum(abs(leg.s_to - leg.s_from) for leg in route.legs)
    assert road_distance_between(run.n, run.p, run.st, car, other, op.FRAME_ROAD, op.MEASURE_ALONG, 0) == pytest.approx(
        way
    )


def covered_in_bend(radius: float) -> float:
    """Return what two boxes cover of a bend of 50 m, m; both are in a lane of a radius, their inner corners nearest."""
    inner = radius - WIDTH / 2
    return 50.0 * (atan((LENGTH / 2 + CENTER) / inner) + atan((LENGTH / 2 - CENTER) / inner))


@pytest.mark.parametrize(("lane", "radius"), [(-1, 51.75), (1, 48.25)])
@pytest.mark.parametrize("at", [140.0, 60.0])
@pytest.mark.parametrize("freespace", [0, 1])
def test_in_a_lanes_system_the_centre_line_of_the_lane_counts(
    lane: int, radius: float, at: float, freespace: int
) -> None:
    """In a left-hand bend of 50 m the lanes are circles; traffic in lane 1 goes against s.

    A lane counts as straight beside a box.
    """
    draft = Draft(bend(50.0))
    one, other = draft.moving(lane, 100.0, 0.0), draft.moving(lane, at, 0.0)
    run = draft.start()
    ahead = -lane * (at - 100.0)
    sign = freespace * (1.0 if ahead > 0.0 else -1.0)
    for frame, length, covered in (
        (op.FRAME_LANE, ahead * radius / 50.0, LENGTH),
        (op.FRAME_ROAD, ahead, covered_in_bend(radius)),
    ):
        found = distance_between(run.n, run.p, run.st, one, other, mode(frame, op.MEASURE_ALONG), freespace)
        assert found == pytest.approx(length - sign * covered, abs=1e-6)


def test_in_a_lanes_system_the_way_is_followed_over_a_turn(town: Network) -> None:
    """The turn from road 1 to road 12 has the length of its lane's centre line, which the poses along it give."""
    draft = Draft(town)
    start, goal = LanePosition("1", -1, 400.0, 0.0), LanePosition("12", -1, 20.0, 0.0)
    car, other = (
        draft.entity(op.MOTION_SCRIPTED, draft.position(town.road_index(one.road), one.lane, one.s), 0.0)
        for one in (start, goal)
    )
    run = draft.start()
    route = town.route(start, goal)
    assert route is not None
    length = 0.0
    for leg in route.legs:
        steps = [leg.s_from + (leg.s_to - leg.s_from) * k / 200 for k in range(201)]
        poses = [town.lane_pose(leg.road, leg.lane, s, 0.0) for s in steps]
        length += sum(hypot(b.x - a.x, b.y - a.y) for a, b in pairwise(poses))
    found = distance_between(run.n, run.p, run.st, car, other, mode(op.FRAME_LANE, op.MEASURE_ALONG), 0)
    assert found == pytest.approx(length, abs=0.05)


def test_between_entities_off_every_road_the_distance_along_roads_is_FAR() -> None:
    draft = Draft(highway())
    one, other = (draft.entity(op.MOTION_SCRIPTED, op.NONE, 0.0) for _ in range(2))
    run = draft.start()
    assert distance_between(run.n, run.p, run.st, one, other, mode(op.FRAME_ROAD, op.MEASURE_ALONG), 1) == op.FAR


@pytest.mark.parametrize(
    ("dx", "dy", "turn", "expected"),
    [
        (10.0, 0.0, 0.0, 10.0 - LENGTH),
        (10.0, 0.0, pi / 2, 10.0 - LENGTH / 2 - WIDTH / 2),
        (0.0, 5.0, 0.0, 5.0 - WIDTH),
        (10.0, 5.0, 0.0, hypot(10.0 - LENGTH, 5.0 - WIDTH)),
        (10.0, 0.5, pi / 4, 10.0 - LENGTH / 2 - (LENGTH + WIDTH) / 2 / sqrt(2.0)),
        (3.0, 0.5, 0.3, 0.0),
    ],
)
def test_between_boxes_the_nearest_points_count(dx: float, dy: float, turn: float, expected: float) -> None:
    run = two(dx, dy, turn)
    assert box_distance(run.p, run.st, 0, 1) == pytest.approx(expected)
    assert box_distance(run.p, run.st, 1, 0) == pytest.approx(expected)


@pytest.mark.parametrize("up", [6.0, -6.0])
def test_a_straight_distance_includes_the_height(up: float) -> None:
    """As between a car on a bridge and one below it; boxes are as far apart as their heights leave."""
    run = two(10.0, 0.0, 0.0)
    run.st.z[:] = [0.0, up]
    straight = mode(op.FRAME_ENTITY, op.MEASURE_STRAIGHT)
    assert distance_between(run.n, run.p, run.st, 0, 1, straight, 0) == pytest.approx(hypot(10.0 + CENTER, 6.0))
    assert distance_between(run.n, run.p, run.st, 0, 1, straight, 1) == pytest.approx(
        hypot(10.0 - LENGTH, 6.0 - HEIGHT)
    )
    run = two(1.0, 0.0, 0.0)
    run.st.z[:] = [0.0, up]
    assert distance_between(run.n, run.p, run.st, 0, 1, straight, 1) == pytest.approx(6.0 - HEIGHT)


@pytest.mark.parametrize(
    ("frame", "measure", "freespace", "expected"),
    [
        (op.FRAME_ENTITY, op.MEASURE_STRAIGHT, 0, hypot(10.0 + CENTER, 6.0)),
        (op.FRAME_ENTITY, op.MEASURE_ALONG, 0, 10.0 + CENTER),
        (op.FRAME_ENTITY, op.MEASURE_ALONG, 1, 10.0 - LENGTH / 2 - WIDTH / 2),
        (op.FRAME_ENTITY, op.MEASURE_ACROSS, 0, -6.0),
        (op.FRAME_ENTITY, op.MEASURE_ACROSS, 1, -6.0 + WIDTH / 2 + LENGTH / 2),
        (op.FRAME_WORLD, op.MEASURE_ACROSS, 1, -6.0 + WIDTH / 2 + LENGTH / 2),
    ],
)
def test_each_system_has_its_axes(frame: int, measure: int, freespace: int, expected: float) -> None:
    run = two(10.0, -6.0, pi / 2)
    found = distance_between(run.n, run.p, run.st, 0, 1, mode(frame, measure), freespace)
    assert found == pytest.approx(expected)


def test_behind_counts_negative() -> None:
    run = two(-20.0, 0.0, 0.0)
    for measure in (op.MEASURE_STRAIGHT, op.MEASURE_ALONG):
        found = distance_between(run.n, run.p, run.st, 0, 1, mode(op.FRAME_ENTITY, measure), 0)
        assert found == pytest.approx(-20.0 + CENTER)


def test_in_a_bend_the_road_is_measured_not_the_chord() -> None:
    draft = Draft(bend(50.0))
    car, other = draft.moving(-1, 10.0, 0.0), draft.moving(-1, 60.0, 0.0)
    run = draft.start()
    along = mode(op.FRAME_ROAD, op.MEASURE_ALONG)
    assert distance_between(run.n, run.p, run.st, car, other, along, 0) == pytest.approx(50.0)
    free = distance_between(run.n, run.p, run.st, car, other, along, 1)
    assert free == pytest.approx(50.0 - covered_in_bend(51.75))
    assert distance_between(run.n, run.p, run.st, car, other, mode(op.FRAME_ENTITY, op.MEASURE_STRAIGHT), 0) < 50.0
    across = mode(op.FRAME_LANE, op.MEASURE_ACROSS)
    assert distance_between(run.n, run.p, run.st, car, other, across, 0) == pytest.approx(0.0)


def test_a_place_is_measured_like_an_entity() -> None:
    draft = Draft(highway())
    car = draft.moving(-2, 100.0, 0.0)
    place = draft.position(0, -1, 150.0)
    run = draft.start()
    st = run.st
    along = distance_to(run.n, run.p, st, car, place, mode(op.FRAME_ROAD, op.MEASURE_ALONG), 0)
    free = distance_to(run.n, run.p, st, car, place, mode(op.FRAME_ROAD, op.MEASURE_ALONG), 1)
    across = distance_to(run.n, run.p, st, car, place, mode(op.FRAME_ROAD, op.MEASURE_ACROSS), 0)
    straight = distance_to(run.n, run.p, st, car, place, mode(op.FRAME_ENTITY, op.MEASURE_STRAIGHT), 1)
    assert (along, free, across) == pytest.approx((50.0, 50.0 - CENTER - LENGTH / 2, 3.5))
    assert straight == pytest.approx(distance_to_box(run.p, st, car, st.position_x[place], st.position_y[place]))
