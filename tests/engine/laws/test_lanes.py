"""Lanes: changes of lane, offsets in them, the lane that an entity belongs to, trajectories."""

from __future__ import annotations

from math import atan, atan2, cos, pi, remainder, sin, sqrt
from pathlib import Path

import pytest

from tests.engine.laws.told import (
    STEPWISE,
    Actor,
    Event,
    by,
    condition,
    lane_change,
    lane_offset,
    lane_position,
    play,
    speed,
)

A = {"A": Actor()}
"""A begins at x = 50 with 10 m/s in lane -1, whose centre is at y = -1.75; at 1 s it is at x = 60."""

RIGHT = '<AbsoluteTargetLane value="-2"/>'


def offset(value: float) -> str:
    """Return an absolute target of an offset."""
    return f'<AbsoluteTargetLaneOffset value="{value}"/>'


@pytest.mark.law("LaneChangeAction", "linear by rate")
def test_the_speed_of_a_change_by_rate_is_that_along_its_path(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", lane_change(RIGHT, by("linear", "rate", 1.0)))])
    assert run.at("A", 3.0).y == pytest.approx(-1.75 - 2.0)
    assert run.at("A", 3.0).x == pytest.approx(60.0 + 2.0 * sqrt(100.0 - 1.0))
    assert run.at("A", 4.5).y == pytest.approx(-5.25)


@pytest.mark.law("LaneChangeAction", "cubic by rate")
def test_a_rate_is_the_peak_of_a_cubic_change(tmp_path: Path) -> None:
    """The peak of 1.05 m/s makes 3.5 m take 1.5 * 3.5 / 1.05 = 5 s."""
    run = play(tmp_path, A, [Event("A", lane_change(RIGHT, by("cubic", "rate", 1.05)))])
    assert run.at("A", 3.5).y == pytest.approx(-3.5)
    assert run.at("A", 5.9).y > -5.25 + 1e-4
    assert run.at("A", 6.0).y == pytest.approx(-5.25)


@pytest.mark.law("LaneChangeAction", "linear by distance")
def test_a_change_by_distance_takes_that_distance_along_the_road(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", lane_change(RIGHT, by("linear", "distance", 40.0)))])
    ahead = 20.0 / sqrt(1.0 + (3.5 / 40.0) ** 2)
    assert run.at("A", 3.0).x == pytest.approx(60.0 + ahead)
    assert run.at("A", 3.0).y == pytest.approx(-1.75 - 3.5 * ahead / 40.0)


@pytest.mark.parametrize(("order", "x"), [(1, 60.5), (-1, 60.505)])
def test_a_step_moves_ahead_by_the_speed_that_earlier_actions_have_set(tmp_path: Path, order: int, x: float) -> None:
    change = Event("A", lane_change('<AbsoluteTargetLane value="-2"/>', STEPWISE))
    faster = Event("A", speed(20.0, by("linear", "rate", 2.0)))
    run = play(tmp_path, {"A": Actor()}, [change, faster][::order], seconds=2.0)
    assert (run.at("A", 1.05).x, run.at("A", 1.05).y) == pytest.approx((x, -5.25))


@pytest.mark.law("LaneChangeAction", "step")
def test_a_step_is_made_at_once(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", lane_change(RIGHT, STEPWISE))])
    assert (run.at("A", 1.0).y, run.at("A", 1.05).y) == pytest.approx((-1.75, -5.25))
    assert run.at("A", 1.05).x == pytest.approx(60.5)


@pytest.mark.law("LaneChangeAction", "to an offset in the lane")
def test_a_change_ends_at_an_offset_of_the_new_lane(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", lane_change(RIGHT, by("linear", "time", 2.0), offset=0.5))])
    assert run.at("A", 2.0).y == pytest.approx(-1.75 - 0.5 * 3.0)
    assert run.at("A", 5.0).y == pytest.approx(-4.75)


def test_lanes_are_counted_to_the_left_of_an_oncoming_reference(tmp_path: Path) -> None:
    actors = {"B": Actor(lane=1, s=500), "A": Actor(lane=-2)}
    target = '<RelativeTargetLane entityRef="B" value="1"/>'
    run = play(tmp_path, actors, [Event("A", lane_change(target, by("linear", "time", 2.0)))])
    assert run.at("A", 5.0).y == pytest.approx(-1.75)


def test_an_oncoming_entity_changes_to_its_own_left(tmp_path: Path) -> None:
    actors = {"B": Actor(lane=2, s=500)}
    target = '<RelativeTargetLane entityRef="B" value="1"/>'
    run = play(tmp_path, actors, [Event("B", lane_change(target, by("linear", "time", 2.0)))])
    assert run.at("B", 1.5).h == pytest.approx(pi + atan2(1.75, sqrt(100.0 - 1.75**2)))
    assert run.at("B", 5.0).y == pytest.approx(1.75)


@pytest.mark.parametrize("dynamics", [by("linear", "time", 3.5), by("linear", "distance", 3.5 * sqrt(99.0))])
def test_backwards_an_entity_changes_lanes_along_its_heading(tmp_path: Path, dynamics: str) -> None:
    """At 1 m/s to its right and 10 m/s along its path, with its rear ahead: its front points to the left."""
    run = play(tmp_path, {"A": Actor(s=200.0, speed=-10.0)}, [Event("A", lane_change(RIGHT, dynamics))])
    before, after = run.at("A", 2.0), run.at("A", 2.05)
    assert (after.x - before.x, after.y - before.y) == pytest.approx((-0.05 * sqrt(99.0), -0.05), abs=1e-4)
    assert after.h == pytest.approx(atan2(0.05, 0.05 * sqrt(99.0)), abs=1e-4)


@pytest.mark.parametrize("limits", ["", '<DynamicConstraints maxSpeed="1"/>'])
def test_backwards_an_entity_keeps_its_lateral_distance_along_its_heading(tmp_path: Path, limits: str) -> None:
    beside = (
        '<LateralAction><LateralDistanceAction entityRef="B" distance="5" freespace="false" continuous="true" '
        f'coordinateSystem="road" displacement="leftToReferencedEntity">{limits}</LateralDistanceAction>'
        "</LateralAction>"
    )
    actors = {"A": Actor(s=200.0, speed=-10.0), "B": Actor(lane=-2, s=200.0, speed=-10.0)}
    run = play(tmp_path, actors, [Event("A", beside)])
    moved = run.at("A", 1.1).y - run.at("A", 1.05).y
    assert moved > 0.0
    assert cos(run.at("A", 1.1).h) > 0.0
    assert sin(run.at("A", 1.1).h) < 0.0


@pytest.mark.law("LaneOffsetAction", "beyond the lane's border")
@pytest.mark.parametrize(
    ("lane", "far", "there", "back"),
    [(-1, 3.2, 1.45, -1.25), (-2, -3.2, -8.45, -4.75), (1, 3.2, 4.95, 2.25), (2, -3.2, 2.05, 5.75)],
)
def test_a_second_offset_counts_from_the_lane_to_which_the_entity_belongs(
    tmp_path: Path, lane: int, far: float, there: float, back: float
) -> None:
    actors = {"A": Actor(lane=lane, s=500.0)}
    run = play(tmp_path, actors, [Event("A", lane_offset(offset(far))), Event("A", lane_offset(offset(0.5)), 6.0)])
    assert run.at("A", 5.5).y == pytest.approx(there)
    assert run.at("A", 10.0).y == pytest.approx(back)


def test_a_relative_change_counts_from_the_lane_to_which_the_entity_belongs(tmp_path: Path) -> None:
    right = lane_change('<RelativeTargetLane entityRef="A" value="-1"/>', by("linear", "time", 2.0))
    run = play(tmp_path, A, [Event("A", lane_offset(offset(3.2))), Event("A", right, 6.0)])
    assert run.at("A", 9.0).y == pytest.approx(-5.25)


def test_a_change_relative_to_another_entity_counts_from_the_lane_to_which_that_belongs(tmp_path: Path) -> None:
    actors = {"A": Actor(), "B": Actor(s=20.0)}
    beside = lane_change('<RelativeTargetLane entityRef="A" value="-1"/>', by("linear", "time", 2.0))
    run = play(tmp_path, actors, [Event("A", lane_offset(offset(3.2))), Event("B", beside, 6.0)])
    assert run.at("B", 9.0).y == pytest.approx(-5.25)


def test_a_lane_change_gives_a_new_lane(tmp_path: Path) -> None:
    change = lane_change(RIGHT, by("linear", "time", 2.0))
    run = play(tmp_path, A, [Event("A", change), Event("A", lane_offset(offset(0.5)), 5.0)])
    assert run.at("A", 10.0).y == pytest.approx(-4.75)


@pytest.mark.parametrize(("interrupted", "wanted"), [(2.0, -1.75), (4.0, -5.25)])
def test_an_interrupted_lane_change_leaves_the_lane_of_the_point(
    tmp_path: Path, interrupted: float, wanted: float
) -> None:
    """The change of 3.5 m in 4 s is over the border at 3 s."""
    change = lane_change(RIGHT, by("linear", "time", 4.0))
    run = play(tmp_path, A, [Event("A", change), Event("A", lane_offset(offset(0.0)), interrupted)])
    assert run.at("A", 10.0).y == pytest.approx(wanted)


def test_a_teleport_gives_a_new_lane(tmp_path: Path) -> None:
    leap = f"<TeleportAction>{lane_position(-2, 300.0)}</TeleportAction>"
    events = [Event("A", lane_offset(offset(3.2))), Event("A", leap, 5.0), Event("A", lane_offset(offset(0.5)), 6.0)]
    run = play(tmp_path, A, events)
    assert run.at("A", 5.05).y == pytest.approx(-5.25)
    assert run.at("A", 10.0).y == pytest.approx(-4.75)


@pytest.mark.parametrize("interrupted", [2.0, 4.0])
def test_a_teleport_ends_the_change_of_lane_and_of_speed(tmp_path: Path, interrupted: float) -> None:
    """Of the change of 3.5 m and 10 m/s in 4 s, begun at 1 s, only the speed that was reached remains."""
    change = lane_change(RIGHT, by("linear", "time", 4.0))
    leap = f"<TeleportAction>{lane_position(-1, 300.0, 0.4)}</TeleportAction>"
    events = [Event("A", change), Event("A", speed(20.0, by("linear", "time", 4.0))), Event("A", leap, interrupted)]
    run = play(tmp_path, A, events)
    assert [run.at("A", time).y for time in (interrupted + 0.05, 10.0)] == pytest.approx([-1.35, -1.35])
    assert run.at("A", interrupted + 0.05).x == pytest.approx(300.0)
    assert run.at("A", 10.0).v == pytest.approx(10.0 + 2.5 * (interrupted - 1.0))


def test_an_entity_appears_where_it_is_added_whatever_it_did_before(tmp_path: Path) -> None:
    """A is taken away during its change of lane and comes back at another place."""
    change = lane_change(RIGHT, by("linear", "time", 4.0))
    away = '<GlobalAction><EntityAction entityRef="A"><DeleteEntityAction/></EntityAction></GlobalAction>'
    place = f"<AddEntityAction>{lane_position(-1, 300.0, 0.4)}</AddEntityAction>"
    back = f'<GlobalAction><EntityAction entityRef="A">{place}</EntityAction></GlobalAction>'
    run = play(tmp_path, A, [Event("A", change), Event("A", away, 2.0), Event("A", back, 3.0)])
    assert [run.at("A", time).y for time in (3.05, 10.0)] == pytest.approx([-1.35, -1.35])


@pytest.mark.law("LaneOffsetAction", "continuous")
@pytest.mark.parametrize("continuous", ["false", "true"])
def test_an_offset_stays_on_its_side_where_the_direction_of_s_changes(tmp_path: Path, continuous: str) -> None:
    """A, 1 m to the left of its lane's centre, comes from road 1 to road 2, whose t points to the other side."""
    aside = lane_offset(offset(1.0), continuous=continuous)
    run = play(tmp_path, {"A": Actor(s=200.0, speed=20.0)}, [Event("A", aside)], road="against")
    assert [run.at("A", time).y for time in (4.9, 5.1, 8.0)] == pytest.approx([-0.75, -0.75, -0.75])


@pytest.mark.law("LaneOffsetAction", "relative to an entity")
@pytest.mark.parametrize(
    ("lane", "aside", "value", "wanted"), [(1, 0.4, 0.9, 1.25), (-2, 0.4, 0.9, -3.95), (2, 0.0, -1.0, 6.25)]
)
def test_a_relative_offset_counts_to_the_references_own_left(
    tmp_path: Path, lane: int, aside: float, value: float, wanted: float
) -> None:
    actors = {"B": Actor(lane=lane, s=700.0, offset=aside, speed=0.0), "A": Actor()}
    action = lane_offset(f'<RelativeTargetLaneOffset entityRef="B" value="{value}"/>', "cubic")
    assert play(tmp_path, actors, [Event("A", action)]).at("A", 9.0).y == pytest.approx(wanted)


@pytest.mark.law("LaneOffsetAction", "continuous")
def test_a_continuous_offset_is_kept_beside_a_reference_that_moves_aside(tmp_path: Path) -> None:
    actors = {"B": Actor(s=100.0), "A": Actor()}
    kept = lane_offset('<RelativeTargetLaneOffset entityRef="B" value="0.5"/>', "step", continuous="true")
    run = play(tmp_path, actors, [Event("A", kept), Event("B", lane_offset(offset(1.0)), 3.0)])
    assert run.at("A", 2.0).y == pytest.approx(-1.25)
    assert run.at("A", 8.0).y == pytest.approx(-0.25)


@pytest.mark.law("Road network", "a lane that narrows to nothing")
@pytest.mark.parametrize("aside", [0.0, 0.5])
def test_where_a_lane_narrows_to_nothing_its_traffic_continues_in_the_next_lane(tmp_path: Path, aside: float) -> None:
    run = play(tmp_path, {"A": Actor(lane=-3, s=690.0, offset=aside)}, [])
    assert run.at("A", 3.5).y == pytest.approx(-7.0 - 0.5 * (3.5 - 0.07 * 25.0) + aside)
    assert (run.at("A", 7.0).y, run.at("A", 7.0).lane) == pytest.approx((-5.25, -2))


@pytest.mark.law("LanePosition", "in lane 0")
def test_lane_0_is_the_centre_lane(tmp_path: Path) -> None:
    run = play(tmp_path, {"A": Actor(lane=0, s=100.0, offset=0.0)}, [], seconds=2.0)
    assert (run.at("A", 1.0).x, run.at("A", 1.0).y, run.at("A", 1.0).h) == pytest.approx((110.0, 0.0, 0.0))


def follow(trajectory: str, timing: str = "<None/>", following: str = "position", begin: float = 0.0) -> str:
    """Return a trajectory that is followed."""
    return (
        f'<RoutingAction><FollowTrajectoryAction initialDistanceOffset="{begin}"><TrajectoryRef>{trajectory}'
        f"</TrajectoryRef><TimeReference>{timing}</TimeReference>"
        f'<TrajectoryFollowingMode followingMode="{following}"/></FollowTrajectoryAction></RoutingAction>'
    )


def polyline(*points: str, closed: str = "false") -> str:
    """Return a polyline of points `x y` or `x y time`."""
    vertices = ""
    for one in points:
        x, y, *time = one.split()
        when = f' time="{time[0]}"' if time else ""
        vertices += f'<Vertex{when}><Position><WorldPosition x="{x}" y="{y}"/></Position></Vertex>'
    return f'<Trajectory name="t" closed="{closed}"><Shape><Polyline>{vertices}</Polyline></Shape></Trajectory>'


@pytest.mark.law("FollowTrajectoryAction", "closed")
def test_a_closed_trajectory_continues_at_its_start(tmp_path: Path) -> None:
    square = polyline("60 -1.75", "70 -1.75", "70 -6.75", "60 -6.75", closed="true")
    run = play(tmp_path, A, [Event("A", follow(square))])
    assert (run.at("A", 1.5).x, run.at("A", 1.5).y) == pytest.approx((65.0, -1.75))
    assert (run.at("A", 4.5).x, run.at("A", 4.5).y) == pytest.approx((65.0, -1.75))


@pytest.mark.law("FollowTrajectoryAction", "times scaled or shifted")
@pytest.mark.parametrize(
    ("scale", "shift", "times"), [(2.0, 0.0, (3.0, 5.0)), (0.5, 0.0, (1.5, 2.0)), (1.0, 2.0, (4.0, 5.0))]
)
def test_times_are_scaled_and_shifted(tmp_path: Path, scale: float, shift: float, times: tuple[float, float]) -> None:
    """A relative time of 1 s is met `scale + shift` after the start at 1 s, one of 2 s `2 scale + shift` after it."""
    line = polyline("60 -1.75 0", "70 -1.75 1", "80 -1.75 2")
    timing = f'<Timing domainAbsoluteRelative="relative" scale="{scale}" offset="{shift}"/>'
    run = play(tmp_path, A, [Event("A", follow(line, timing))])
    assert [run.at("A", time).x for time in times] == pytest.approx([70.0, 80.0])


@pytest.mark.parametrize(
    ("domain", "times", "row", "x"),
    [
        ("relative", "0 10", 2.0, 130.0),
        ("absolute", "0 10", 2.0, 140.0),
        ("absolute", "5 15", 4.0, 120.0),
        ("absolute", "5 15", 7.0, 140.0),
    ],
)
def test_times_begin_at_the_initial_distance(tmp_path: Path, domain: str, times: str, row: float, x: float) -> None:
    """The times are 10 m/s; the 2 s to the initial 20 m are deducted from all of them. Before, A waits there."""
    line = polyline(*(f"{at} -1.75 {time}" for at, time in zip((100, 200), times.split(), strict=True)))
    timing = f'<Timing domainAbsoluteRelative="{domain}" scale="1" offset="0"/>'
    run = play(tmp_path, A, [Event("A", follow(line, timing, begin=20.0))], seconds=8.0)
    assert run.at("A", row).x == pytest.approx(x)


@pytest.mark.parametrize("mode", ["position", "follow"])
def test_a_vertex_that_is_given_twice_counts_once(tmp_path: Path, mode: str) -> None:
    line = polyline("60 -1.75 0", "80 -1.75 2", "80 -1.75 2", "110 -1.75 5")
    timing = '<Timing domainAbsoluteRelative="relative" scale="1" offset="0"/>'
    run = play(tmp_path, A, [Event("A", follow(line, timing, mode))])
    assert [run.at("A", time).x for time in (2.0, 4.0, 5.0, 8.0)] == pytest.approx([70.0, 90.0, 100.0, 130.0])


@pytest.mark.law("FollowTrajectoryAction", "with heights")
def test_a_trajectory_with_heights_has_pitch(tmp_path: Path) -> None:
    points = "".join(
        f'<Vertex><Position><WorldPosition x="{x}" y="-1.75" z="{z}"/></Position></Vertex>'
        for x, z in ((60, 0), (80, 4), (100, 4))
    )
    line = f'<Trajectory name="t" closed="false"><Shape><Polyline>{points}</Polyline></Shape></Trajectory>'
    run = play(tmp_path, A, [Event("A", follow(line))])
    assert run.at("A", 2.0).pitch == pytest.approx(-atan2(4.0, 20.0))
    assert run.at("A", 3.0).pitch == pytest.approx(-0.5 * atan2(4.0, 20.0))
    assert run.at("A", 4.0).pitch == pytest.approx(0.0)


def test_a_speed_action_acts_on_an_entity_on_a_trajectory_without_times(tmp_path: Path) -> None:
    events = [Event("A", follow(polyline("60 -1.75", "160 -1.75"))), Event("A", speed(5.0), 2.0)]
    run = play(tmp_path, A, events)
    assert run.at("A", 4.0).x == pytest.approx(60.0 + 10.0 + 10.0)


@pytest.mark.law("FollowTrajectoryAction", "ClothoidSpline, without times")
def test_a_clothoid_spline_is_followed_at_the_entitys_speed(tmp_path: Path) -> None:
    """10 m straight on, then 10 m of a circle of 10 m to the left, from where A is at 1 s."""
    spline = (
        '<Trajectory name="t" closed="false"><Shape><ClothoidSpline>'
        '<ClothoidSplineSegment curvatureStart="0" curvatureEnd="0" length="10"><PositionStart>'
        '<WorldPosition x="60" y="-1.75" h="0"/></PositionStart></ClothoidSplineSegment>'
        '<ClothoidSplineSegment curvatureStart="0.1" curvatureEnd="0.1" length="10"/>'
        "</ClothoidSpline></Shape></Trajectory>"
    )
    run = play(tmp_path, A, [Event("A", follow(spline))], seconds=4.0)
    assert (run.at("A", 1.5).x, run.at("A", 1.5).y) == pytest.approx((65.0, -1.75))
    at = run.at("A", 2.5)
    assert (at.x, at.y, at.h) == pytest.approx((70.0 + 10.0 * sin(0.5), -1.75 + 10.0 * (1.0 - cos(0.5)), 0.5), abs=1e-3)


def distance(inner: str, limits: str = "") -> str:
    """Return a distance to B that is to be kept."""
    constraints = f"<DynamicConstraints {limits}/>" if limits else ""
    action = f'<LongitudinalDistanceAction entityRef="B" {inner}>{constraints}</LongitudinalDistanceAction>'
    return f"<LongitudinalAction>{action}</LongitudinalAction>"


@pytest.mark.law("LongitudinalDistanceAction", "displacement trailing")
@pytest.mark.law("LongitudinalDistanceAction", "displacement leading")
@pytest.mark.law("LongitudinalDistanceAction", "without limits")
@pytest.mark.parametrize(("side", "sign"), [("trailing", -1.0), ("leading", 1.0)])
def test_without_limits_an_entity_is_put_at_its_distance(tmp_path: Path, side: str, sign: float) -> None:
    actors = {"B": Actor(lane=-2, s=200.0, speed=8.0), "A": Actor()}
    told = f'distance="20" freespace="false" continuous="true" displacement="{side}ReferencedEntity"'
    run = play(tmp_path, actors, [Event("A", distance(told))], seconds=4.0)
    assert run.at("A", 3.0).v == pytest.approx(8.0)
    assert run.at("A", 3.0).x - run.at("B", 3.0).x == pytest.approx(sign * 20.0)


@pytest.mark.parametrize(("lane", "inner"), [(-2, 54.25), (2, 43.75)])
def test_along_a_bend_a_gap_is_between_the_places_of_corners(tmp_path: Path, lane: int, inner: float) -> None:
    """The inner corners are nearest: A's 4 m ahead of its reference point, B's 1 m behind its own."""
    actors = {"B": Actor(lane=lane, s=150.0, speed=0.0), "A": Actor(lane=lane, s=150.0 + 10.0 * lane)}
    keep = distance('distance="10" freespace="true" continuous="true" coordinateSystem="road"')
    run = play(tmp_path, actors, [Event("A", keep)], seconds=4.0, road="bend")
    one, other = (atan2(seen.x, 50.0 - seen.y) for seen in (run.at("A", 3.0), run.at("B", 3.0)))
    between = 50.0 * abs(remainder(other - one, 2.0 * pi))
    assert between == pytest.approx(10.0 + 50.0 * (atan(4.0 / inner) + atan(1.0 / inner)), abs=1e-6)


@pytest.mark.parametrize("freespace", ["false", "true"])
def test_a_distance_is_kept_along_the_trajectory_that_is_followed(tmp_path: Path, freespace: str) -> None:
    """B stands off every road, 180 m along A's trajectory, which turns to the left after 100 m.

    A stops 30 m before it; between the boxes, B's width and A's front are 1 m and 4 m of that.
    """
    b = Actor(position='<Position><WorldPosition x="150" y="78.25" h="0"/></Position>', speed=0.0)
    path = follow(polyline("50 -1.75", "150 -1.75", "150 98.25"))
    told = f'distance="30" freespace="{freespace}" continuous="true" coordinateSystem="trajectory"'
    keep = distance(told, 'maxAcceleration="10" maxDeceleration="10" maxSpeed="10"')
    run = play(tmp_path, {"A": Actor(action=path), "B": b}, [Event("A", keep)], seconds=40.0)
    assert run.at("A", 40.0).x == pytest.approx(150.0)
    assert run.at("A", 40.0).y == pytest.approx(48.25 - (5.0 if freespace == "true" else 0.0), abs=0.05)


def test_a_distance_without_limits_moves_an_entity_along_its_trajectory(tmp_path: Path) -> None:
    """The trajectory leads to y = -5.25 at x = 160; A is put there, 20 m behind B, from x = 70."""
    path = follow(polyline("60 -1.75", "160 -5.25", "900 -5.25"))
    keep = distance('distance="20" freespace="false" continuous="true"')
    run = play(tmp_path, {"B": Actor(s=300.0, speed=10.0), "A": Actor()}, [Event("A", path), Event("A", keep, 2.0)])
    assert [run.at("A", time).y for time in (3.0, 9.0)] == pytest.approx([-5.25, -5.25])
    assert [run.at("B", time).x - run.at("A", time).x for time in (3.0, 9.0)] == pytest.approx([20.0, 20.0])


@pytest.mark.parametrize("limits", ["", 'maxAcceleration="5" maxDeceleration="5" maxSpeed="40"'])
@pytest.mark.parametrize("mover", ["change", "trajectory"])
@pytest.mark.parametrize("order", [1, -1])
@pytest.mark.parametrize("who", ["A", "B"])
def test_a_kept_distance_does_not_depend_on_the_order_of_the_actions(
    tmp_path: Path, who: str, order: int, mover: str, limits: str
) -> None:
    """A begins 20 m behind B; one of them changes lane or follows a trajectory from 1 s on."""
    keep = Event("A", distance('distance="20" freespace="false" continuous="true"', limits))
    lane_by_lane = lane_change(RIGHT, by("linear", "time", 100.0))
    moved = lane_by_lane if mover == "change" else follow(polyline(f"{60 if who == 'A' else 80} -1.75", "900 -1.75"))
    actors = {"B": Actor(s=70.0), "A": Actor()}
    run = play(tmp_path, actors, [keep, Event(who, moved)][::order], seconds=8.0)
    assert run.at("B", 8.0).x - run.at("A", 8.0).x == pytest.approx(20.0, abs=1e-3)


@pytest.mark.parametrize("limits", ["", '<DynamicConstraints maxAcceleration="5" maxDeceleration="5" maxSpeed="40"/>'])
def test_a_distance_is_no_longer_kept_when_its_reference_is_deleted(tmp_path: Path, limits: str) -> None:
    gone = '<GlobalAction><EntityAction entityRef="B"><DeleteEntityAction/></EntityAction></GlobalAction>'
    told = 'entityRef="B" freespace="false" continuous="true" coordinateSystem="road" distance="3"'
    ahead = f"<LongitudinalAction><LongitudinalDistanceAction {told}>{limits}</LongitudinalDistanceAction>"
    aside = f"<LateralAction><LateralDistanceAction {told}>{limits}</LateralDistanceAction></LateralAction>"
    events = [Event("A", f"{ahead}</LongitudinalAction>"), Event("A", aside), Event("A", gone, 2.0)]
    run = play(tmp_path, {"B": Actor(lane=-2, s=70.0), "A": Actor()}, events)
    for start in (2.05, 6.0):
        assert run.at("A", start + 2.0).v == run.at("A", start).v
        assert run.at("A", start + 2.0).x - run.at("A", start).x == pytest.approx(2.0 * run.at("A", start).v)
        assert run.at("A", start + 2.0).y == run.at("A", start).y


def test_an_action_without_its_reference_ends_at_once(tmp_path: Path) -> None:
    """B is deleted before A's actions begin, and while A keeps an offset from it."""
    gone = '<GlobalAction><EntityAction entityRef="B"><DeleteEntityAction/></EntityAction></GlobalAction>'
    beside = '<RelativeTargetLane entityRef="B" value="0"/>'
    aside = lane_offset('<RelativeTargetLaneOffset entityRef="B" value="0.5"/>', "step", continuous="true")
    element = 'storyboardElementType="event" storyboardElementRef="it"'
    ended = condition(f'<StoryboardElementStateCondition {element} state="completeState"/>')
    for action, begin, y in ((lane_change(beside, STEPWISE), 3.0, -1.75), (aside, 3.0, -1.75), (aside, 1.0, -4.75)):
        events = [Event("A", gone, 2.0), Event("A", action, begin, name="it"), Event("A", speed(3.0), ended)]
        run = play(tmp_path, {"B": Actor(lane=-2, s=70.0), "A": Actor()}, events, seconds=5.0)
        assert run.at("A", 5.0).y == pytest.approx(y)
        assert run.acts("A", 3.0) == pytest.approx(max(begin, 2.0) + 0.1)


def test_a_lateral_distance_that_is_not_given_is_0(tmp_path: Path) -> None:
    """A drives in the lane beside B's and is put into line with it: "missing value is interpreted as 0"."""
    beside = (
        '<LateralAction><LateralDistanceAction entityRef="B" freespace="false" continuous="true" '
        'coordinateSystem="lane"/></LateralAction>'
    )
    run = play(tmp_path, {"B": Actor(lane=-2, s=100.0), "A": Actor()}, [Event("A", beside)], seconds=3.0)
    assert run.at("A", 3.0).y == pytest.approx(-5.25)


@pytest.mark.law("LateralDistanceAction", "with limits of jerk")
def test_a_limited_jerk_lets_the_motion_aside_grow_with_the_cube_of_time(tmp_path: Path) -> None:
    """A wants to be 3 m to the left of B, with which it begins; 0.6 m/s3 for 1 s, in 20 steps, are 0.1155 m.

    Without that limit the acceleration of 2 m/s2 is there at once. Either way A comes to its distance.
    """
    moved = []
    for rate in ('maxAccelerationRate="0.6" maxDecelerationRate="0.6"', ""):
        limits = f'<DynamicConstraints maxAcceleration="2" maxDeceleration="2" maxSpeed="3" {rate}/>'
        aside = (
            '<LateralAction><LateralDistanceAction entityRef="B" distance="3" freespace="false" continuous="true" '
            f'coordinateSystem="road" displacement="leftToReferencedEntity">{limits}</LateralDistanceAction>'
            "</LateralAction>"
        )
        run = play(tmp_path, {"B": Actor(lane=-2), "A": Actor(lane=-2)}, [Event("A", aside)], seconds=20.0)
        moved.append(run.at("A", 2.05).y - run.at("A", 1.05).y)
        assert run.at("A", 20.0).y == pytest.approx(-5.25 + 3.0, abs=0.1)
    assert moved[0] == pytest.approx(0.6 * 0.05**3 * 20 * 21 * 22 / 6)
    assert moved[1] > 0.5
