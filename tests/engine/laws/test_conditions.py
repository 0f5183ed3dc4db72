"""Conditions: the row in which their effect appears."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import hypot, pi
from pathlib import Path

import pytest

from tests.engine.laws.told import (
    Actor,
    Event,
    Played,
    after,
    by,
    condition,
    document,
    lane_change,
    lane_offset,
    lane_position,
    of_entity,
    play,
    play_text,
    speed,
)

DONE = 3.0
"""Speed that the witness W takes when a condition holds, m/s; no other is it."""

W = Actor(lane=2, s=1500.0, speed=1.0)


def seen(folder: Path, inner: str, *events: Event, **actors: Actor) -> float | None:
    """Return the first row in which W acts on a condition of A, None if it never does."""
    told = {"A": Actor(), **actors, "W": W}
    run = play(folder, told, [*events, Event("W", speed(DONE), of_entity("A", inner))], 8.0)
    return run.acts("W", DONE)


def gap(word: str, more: str, value: float, rule: str = "lessThan", where: str = "") -> str:
    """Return a condition that measures a gap to B, or to a position."""
    to = "" if where or word == "TimeToCollisionCondition" else ' entityRef="B"'
    name = "freespace=" if "freespace" not in more else ""
    free = f' {name}"false"' if name else ""
    return f'<{word}{to} value="{value}" rule="{rule}" {more}{free}>{where}</{word}>'


SYSTEMS = ("entity", "lane", "road", "world")
B_AHEAD: dict[str, Actor] = {"B": Actor(s=100.0, speed=0.0)}
"""B stands 50 m ahead of where A begins: 30 m are left after 2 s, so less than that in the row of 2.05 s."""


@pytest.mark.law("TimeHeadwayCondition", "system lane")
@pytest.mark.law("TimeHeadwayCondition", "system world")
@pytest.mark.parametrize("system", SYSTEMS)
def test_a_headway_is_the_distance_over_the_speed(tmp_path: Path, system: str) -> None:
    more = f'coordinateSystem="{system}" relativeDistanceType="longitudinal"'
    assert seen(tmp_path, gap("TimeHeadwayCondition", more, 3.0), **B_AHEAD) == pytest.approx(2.1)


@pytest.mark.law("TimeHeadwayCondition", "euclidianDistance")
@pytest.mark.law("TimeHeadwayCondition", "cartesianDistance")
@pytest.mark.parametrize("kind", ["euclidianDistance", "cartesianDistance"])
def test_a_straight_headway(tmp_path: Path, kind: str) -> None:
    """Beside each other 14 m apart, and 48 m ahead: the straight distance is 50 m, 5 s."""
    actors = {"B": Actor(lane=2, s=1.0 + 98.0, speed=0.0), "A": Actor(lane=-2, s=50.0)}
    more = f'coordinateSystem="entity" relativeDistanceType="{kind}"'
    found = seen(tmp_path, gap("TimeHeadwayCondition", more, 3.0), **actors)
    across = 3.5 + 7.0
    ahead = (900.0 - across**2) ** 0.5
    assert found == pytest.approx(0.05 * int((49.0 - ahead) / 10.0 / 0.05 + 1.0) + 0.05)


@pytest.mark.law("TimeHeadwayCondition", "lateral")
def test_a_headway_across(tmp_path: Path) -> None:
    """B is 3.5 m to the left of A, 0.35 s at 10 m/s; to the right it would be behind, so undefined."""
    more = 'coordinateSystem="road" relativeDistanceType="lateral"'
    left, right = {"B": Actor(lane=-1, speed=0.0)}, {"B": Actor(lane=-3, speed=0.0)}
    assert seen(tmp_path, gap("TimeHeadwayCondition", more, 0.4), A=Actor(lane=-2), **left) == pytest.approx(0.0)
    assert seen(tmp_path, gap("TimeHeadwayCondition", more, 0.4), A=Actor(lane=-2), **right) is None


def test_a_headway_to_an_entity_behind_is_undefined(tmp_path: Path) -> None:
    more = 'coordinateSystem="road" relativeDistanceType="longitudinal"'
    for rule in ("lessThan", "greaterThan"):
        told = gap("TimeHeadwayCondition", more, 3.0, rule)
        assert seen(tmp_path, told, B=Actor(s=20.0, speed=0.0)) is None


@pytest.mark.law("TimeToCollisionCondition", "system lane")
@pytest.mark.law("TimeToCollisionCondition", "system world")
@pytest.mark.parametrize("system", SYSTEMS)
def test_a_time_to_collision_is_the_distance_over_the_closing_speed(tmp_path: Path, system: str) -> None:
    """B drives at 4 m/s, so 50 m close at 6 m/s: 30 m, 5 s, are left after 20/6 s."""
    target = '<TimeToCollisionConditionTarget><EntityRef entityRef="B"/></TimeToCollisionConditionTarget>'
    more = f'coordinateSystem="{system}" relativeDistanceType="longitudinal"'
    told = gap("TimeToCollisionCondition", more, 5.0, where=target)
    assert seen(tmp_path, told, B=Actor(s=100.0, speed=4.0)) == pytest.approx(3.4)


@pytest.mark.law("TimeToCollisionCondition", "euclidianDistance")
@pytest.mark.law("TimeToCollisionCondition", "cartesianDistance")
@pytest.mark.parametrize("kind", ["euclidianDistance", "cartesianDistance"])
def test_a_time_to_collision_with_a_position(tmp_path: Path, kind: str) -> None:
    target = f"<TimeToCollisionConditionTarget>{lane_position(-1, 100.0)}</TimeToCollisionConditionTarget>"
    more = f'coordinateSystem="entity" relativeDistanceType="{kind}"'
    assert seen(tmp_path, gap("TimeToCollisionCondition", more, 3.0, where=target)) == pytest.approx(2.1)


@pytest.mark.law("DistanceCondition", "system entity")
@pytest.mark.law("DistanceCondition", "system lane")
@pytest.mark.law("DistanceCondition", "system road")
@pytest.mark.law("DistanceCondition", "system world")
@pytest.mark.law("DistanceCondition", "longitudinal")
@pytest.mark.law("DistanceCondition", "euclidianDistance")
@pytest.mark.law("DistanceCondition", "cartesianDistance")
@pytest.mark.law("DistanceCondition", "between reference points")
@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("kind", ["longitudinal", "euclidianDistance", "cartesianDistance"])
def test_a_distance_to_a_position(tmp_path: Path, system: str, kind: str) -> None:
    more = f'coordinateSystem="{system}" relativeDistanceType="{kind}"'
    told = gap("DistanceCondition", more, 30.0, where=lane_position(-1, 100.0))
    assert seen(tmp_path, told) == pytest.approx(2.1)


@pytest.mark.law("DistanceCondition", "lateral")
def test_a_distance_to_a_position_across(tmp_path: Path) -> None:
    """A moves from lane -2 by 1 m/s to the left; 3.5 m are less than 2 m after 1.5 s."""
    more = 'coordinateSystem="road" relativeDistanceType="lateral"'
    told = gap("DistanceCondition", more, 2.0, where=lane_position(-1, 100.0))
    left = lane_change('<AbsoluteTargetLane value="-1"/>', by("linear", "rate", 1.0))
    assert seen(tmp_path, told, Event("A", left), A=Actor(lane=-2)) == pytest.approx(2.6)


@pytest.mark.law("DistanceCondition", "between boxes")
def test_a_distance_between_a_box_and_a_position(tmp_path: Path) -> None:
    """A's front is 4 m ahead of its reference point: 30 m are left after 1.6 s."""
    more = 'coordinateSystem="road" relativeDistanceType="longitudinal" freespace="true"'
    told = gap("DistanceCondition", more, 30.0, where=lane_position(-1, 100.0))
    assert seen(tmp_path, told) == pytest.approx(1.7)


@pytest.mark.law("RelativeDistanceCondition", "system lane")
@pytest.mark.law("RelativeDistanceCondition", "system world")
@pytest.mark.law("RelativeDistanceCondition", "euclidianDistance")
@pytest.mark.law("RelativeDistanceCondition", "cartesianDistance")
@pytest.mark.parametrize("system", SYSTEMS)
@pytest.mark.parametrize("kind", ["longitudinal", "euclidianDistance", "cartesianDistance"])
def test_a_distance_to_an_entity(tmp_path: Path, system: str, kind: str) -> None:
    more = f'coordinateSystem="{system}" relativeDistanceType="{kind}"'
    assert seen(tmp_path, gap("RelativeDistanceCondition", more, 30.0), **B_AHEAD) == pytest.approx(2.1)


@pytest.mark.parametrize("word", ["RelativeDistanceCondition", "DistanceCondition"])
def test_a_straight_distance_includes_the_height(tmp_path: Path, word: str) -> None:
    """The road climbs by 0.1: 200 m are 199.007 m along x, which are left after 1.0993 s."""
    where = lane_position(-1, 1300.0) if word == "DistanceCondition" else ""
    told = gap(word, 'coordinateSystem="entity" relativeDistanceType="euclidianDistance"', 200.0, where=where)
    actors = {"A": Actor(s=1090.0), "B": Actor(s=1300.0, speed=0.0)}
    assert seen(tmp_path, told, **actors) == pytest.approx(1.15)


def test_a_distance_between_boxes(tmp_path: Path) -> None:
    """A's front is 4 m ahead of its reference point, B's rear 1 m behind its own: 30 m are left after 1.5 s."""
    more = 'coordinateSystem="road" relativeDistanceType="longitudinal" freespace="true"'
    assert seen(tmp_path, gap("RelativeDistanceCondition", more, 30.0), **B_AHEAD) == pytest.approx(1.6)


@pytest.mark.parametrize(("lane", "centre"), [(-2, 55.25), (-1, 51.75)])
def test_across_a_bend_a_gap_is_between_the_places_of_corners(tmp_path: Path, lane: int, centre: float) -> None:
    """Farthest out is the corner at A's front, 4 m ahead; least far out is the one at B's rear, 1 m behind."""
    more = 'coordinateSystem="road" relativeDistanceType="lateral" freespace="true"'
    left = hypot(centre + 9.0, 1.0) - hypot(centre + 1.0, 4.0)
    place = f'<Position><RoadPosition roadId="1" s="100" t="{50.0 - centre - 10.0}"/></Position>'
    actors = {"A": Actor(lane=lane), "B": Actor(position=place, speed=0.0), "W": Actor(lane=2)}
    for value, wanted in ((left + 1e-3, True), (left - 1e-3, False)):
        told = of_entity("A", gap("RelativeDistanceCondition", more, value))
        run = play(tmp_path, actors, [Event("W", speed(DONE), told)], 1.0, road="bend")
        assert (run.acts("W", DONE) is not None) == wanted


@pytest.mark.law("SpeedCondition", "vertical")
def test_a_speed_upwards(tmp_path: Path) -> None:
    """The road climbs by 0.1 from x = 1000 on, where A is at 1 s: the row of 1.05 s is 0.05 m higher, 1 m/s."""
    told = '<SpeedCondition value="0.9" rule="greaterThan" direction="vertical"/>'
    assert seen(tmp_path, told, A=Actor(s=990.0)) == pytest.approx(1.1)


@pytest.mark.law("AccelerationCondition", "longitudinal")
@pytest.mark.law("AccelerationCondition", "as a whole")
@pytest.mark.parametrize("direction", ['direction="longitudinal" ', ""])
def test_an_acceleration(tmp_path: Path, direction: str) -> None:
    told = f'<AccelerationCondition value="1.9" rule="greaterThan" {direction}/>'
    assert seen(tmp_path, told, Event("A", speed(20.0, by("linear", "rate", 2.0)))) == pytest.approx(1.1)


def test_a_constant_speed_on_a_slope_is_no_acceleration(tmp_path: Path) -> None:
    """Also in the first step, before which no two rows show how the entity moves."""
    told = '<AccelerationCondition value="0.01" rule="greaterThan"/>'
    assert seen(tmp_path, told, A=Actor(s=1100.0)) is None


@pytest.mark.law("AccelerationCondition", "longitudinal")
def test_a_deceleration_is_negative(tmp_path: Path) -> None:
    told = '<AccelerationCondition value="-1.9" rule="lessThan" direction="longitudinal"/>'
    assert seen(tmp_path, told, Event("A", speed(2.0, by("linear", "rate", 2.0)))) == pytest.approx(1.1)


@pytest.mark.law("StandStillCondition", "used")
def test_standing_counts_from_the_first_row_at_rest_and_must_last_longer(tmp_path: Path) -> None:
    """A stands in the row of 1.05 s. At 2.05 s it has stood for 1 s, at 2.1 s for longer."""
    assert seen(tmp_path, '<StandStillCondition duration="1"/>', Event("A", speed(0.0))) == pytest.approx(2.15)


@pytest.mark.law("CollisionCondition", "with a kind")
def test_a_collision_with_any_vehicle(tmp_path: Path) -> None:
    """A's front, 4 m ahead of 50.2 m, comes to B's rear at 99 m after 4.48 s."""
    told = '<CollisionCondition><ByType type="vehicle"/></CollisionCondition>'
    assert seen(tmp_path, told, A=Actor(s=50.2), **B_AHEAD) == pytest.approx(4.55)
    told = '<CollisionCondition><ByType type="pedestrian"/></CollisionCondition>'
    assert seen(tmp_path, told, A=Actor(s=50.2), **B_AHEAD) is None


EXTERNAL = '<ScenarioObject name="B"><ExternalObjectReference name="hero"/></ScenarioObject>'


def test_a_collision_with_an_external_object(tmp_path: Path) -> None:
    """B is described elsewhere, so it is of the type external; C, which A touches first, is not.

    The car that stands in for B has its rear 1.1 m behind its reference point: A touches it after 4.47 s.
    """
    told = of_entity("A", '<CollisionCondition><ByType type="external"/></CollisionCondition>')
    actors = {"A": Actor(s=50.2), "C": Actor(s=80.0, speed=0.0), **B_AHEAD, "W": W}
    text = document(actors, [Event("W", speed(DONE), told)], 8.0)
    start = text.index('<ScenarioObject name="B">')
    end = text.index("</ScenarioObject>", start) + len("</ScenarioObject>")
    run = play_text(tmp_path, text[:start] + EXTERNAL + text[end:], 8.0)
    assert run.acts("W", DONE) == pytest.approx(4.55)


def test_a_collision_with_any_member_of_a_selection(tmp_path: Path) -> None:
    """A touches C, the second member, after 2.48 s; its rear is at 79 m."""
    told = of_entity("A", '<CollisionCondition><EntityRef entityRef="both"/></CollisionCondition>')
    actors = {"A": Actor(s=50.2), "C": Actor(s=80.0, speed=0.0), **B_AHEAD, "W": W}
    members = '<Members><EntityRef entityRef="B"/><EntityRef entityRef="C"/></Members>'
    text = document(actors, [Event("W", speed(DONE), told)], 8.0)
    text = text.replace("</Entities>", f'<EntitySelection name="both">{members}</EntitySelection></Entities>')
    assert play_text(tmp_path, text, 8.0).acts("W", DONE) == pytest.approx(2.55)


@pytest.mark.parametrize(("other", "moment"), [("B", 4.55), ("trailer", 3.55)])
def test_free_space_is_that_to_the_entity_itself_not_to_its_trailer(tmp_path: Path, other: str, moment: float) -> None:
    """B, whose rear is at 119 m, tows a trailer with its rear at 109 m; A's front is at 54.2 m and drives at 10 m/s.

    20 m are left to B after 4.48 s, and to the trailer after 3.48 s.
    """
    more = 'coordinateSystem="entity" relativeDistanceType="longitudinal" freespace="true"'
    told = f'<RelativeDistanceCondition entityRef="{other}" value="20" rule="lessThan" {more}/>'
    actors = {"A": Actor(s=50.2), "B": Actor(s=120.0, speed=0.0), "trailer": Actor(s=110.0, speed=0.0), "W": W}
    text = document(actors, [Event("W", speed(DONE), of_entity("A", told))], 8.0)
    for name, part in (("B", '<TrailerHitch dx="-5"/>'), ("trailer", '<TrailerCoupler dx="5"/>')):
        end = text.index("<Properties/></Vehicle>", text.index(f'<ScenarioObject name="{name}">'))
        text = f"{text[:end]}<Properties/>{part}{text[end + len('<Properties/>') :]}"
    connect = '<TrailerAction><ConnectTrailerAction trailerRef="trailer"/></TrailerAction>'
    text = text.replace(
        "</Private></Actions>",
        f'</Private><Private entityRef="B"><PrivateAction>{connect}</PrivateAction></Private></Actions>',
    )
    run = play_text(tmp_path, text, 8.0)
    assert run.at("trailer", 0.0).x == pytest.approx(110.0)
    assert run.acts("W", DONE) == pytest.approx(moment)


def test_an_entity_does_not_collide_with_itself(tmp_path: Path) -> None:
    """B is a triggering entity too, but only A can touch it."""
    told = of_entity("A B", '<CollisionCondition><EntityRef entityRef="B"/></CollisionCondition>')
    actors = {"A": Actor(s=50.2), **B_AHEAD, "W": W}
    assert play(tmp_path, actors, [Event("W", speed(DONE), told)], 8.0).acts("W", DONE) == pytest.approx(4.55)


def angle(kind: str, value: float, system: str) -> str:
    """Return a condition on an angle."""
    return f'<AngleCondition angleType="{kind}" angle="{value}" angleTolerance="0.01" coordinateSystem="{system}"/>'


CLIMB = -0.09966865249116204
"""Pitch of a road that climbs by 0.1: up is negative."""


@pytest.mark.law("AngleCondition", "pitch, system road")
@pytest.mark.law("AngleCondition", "pitch, system lane")
@pytest.mark.law("AngleCondition", "pitch, system world")
def test_a_pitch_is_against_the_world_or_the_road(tmp_path: Path) -> None:
    """A is on the climb from the row of 1.05 s on."""
    told = angle("pitch", CLIMB, "world")
    assert seen(tmp_path, told, A=Actor(s=989.8)) == pytest.approx(1.1)
    for system in ("road", "lane"):
        assert seen(tmp_path, angle("pitch", CLIMB, system), A=Actor(s=989.8)) is None
        assert seen(tmp_path, angle("pitch", 0.0, system), A=Actor(s=1100.0)) == pytest.approx(0.0)


@pytest.mark.law("AngleCondition", "pitch, system trajectory")
@pytest.mark.law("AngleCondition", "roll, system trajectory")
@pytest.mark.law("AngleCondition", "heading, system trajectory")
@pytest.mark.parametrize("kind", ["heading", "pitch", "roll"])
def test_an_angle_relative_to_a_trajectory_is_defined_only_while_one_is_followed(tmp_path: Path, kind: str) -> None:
    """The trajectory of 20 m is begun at 1 s, where W stands later in the file, and ends at 3 s."""
    line = (
        '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape><Polyline>'
        '<Vertex><Position><WorldPosition x="60" y="-1.75"/></Position></Vertex>'
        '<Vertex><Position><WorldPosition x="80" y="-1.75"/></Position></Vertex></Polyline></Shape></Trajectory>'
        '</TrajectoryRef><TimeReference><None/></TimeReference><TrajectoryFollowingMode followingMode="position"/>'
        "</FollowTrajectoryAction></RoutingAction>"
    )
    told = angle(kind, 0.0, "trajectory")
    assert seen(tmp_path, told, Event("A", line)) == pytest.approx(1.05)
    assert seen(tmp_path, told) is None
    late = [Event("A", line), Event("W", speed(DONE), of_entity("A", told, edge="falling"))]
    run = play(tmp_path, {"A": Actor(), "W": W}, late)
    assert run.acts("W", DONE) == pytest.approx(3.05)


@pytest.mark.law("AngleCondition", "roll, system world")
@pytest.mark.law("AngleCondition", "roll, system road")
@pytest.mark.law("AngleCondition", "roll, system lane")
@pytest.mark.parametrize("system", ["world", "road", "lane"])
def test_nothing_rolls_on_a_road_without_superelevation(tmp_path: Path, system: str) -> None:
    assert seen(tmp_path, angle("roll", 0.0, system)) == pytest.approx(0.0)
    assert seen(tmp_path, angle("roll", 0.1, system)) is None


@pytest.mark.law("RelativeAngleCondition", "heading")
@pytest.mark.law("RelativeAngleCondition", "pitch")
@pytest.mark.law("RelativeAngleCondition", "roll")
@pytest.mark.parametrize(("kind", "value"), [("heading", pi), ("pitch", CLIMB), ("roll", 0.0)])
def test_an_angle_to_another_entity(tmp_path: Path, kind: str, value: float) -> None:
    """B comes towards A; for the pitch it is on the climb in A's direction."""
    actors = {"B": Actor(lane=1, s=300.0, speed=0.0)}
    if kind == "pitch":
        actors = {"B": Actor(s=1100.0, speed=0.0)}
    told = f'<RelativeAngleCondition entityRef="B" angleType="{kind}" angle="{value}" angleTolerance="0.01"/>'
    assert seen(tmp_path, told, **actors) == pytest.approx(0.0)
    wrong = told.replace(f'angle="{value}"', f'angle="{value + 0.1}"')
    assert seen(tmp_path, wrong, **actors) is None


@pytest.mark.law("ReachPositionCondition", "turned")
def test_a_position_is_reached_whatever_the_heading(tmp_path: Path) -> None:
    """A comes within 5 m of x = 100 after 4.5 s; strictly nearer is the row of 4.55 s."""
    for turn in ("", '<Orientation h="1.5" type="relative"/>'):
        place = lane_position(-1, 100.0).replace("/></Position>", f">{turn}</LanePosition></Position>")
        told = f'<ReachPositionCondition tolerance="5">{place}</ReachPositionCondition>'
        assert seen(tmp_path, told) == pytest.approx(4.6)


@pytest.mark.law("Storyboard", "any triggering entity")
@pytest.mark.parametrize(("rule", "wanted"), [("any", 2.05), ("all", 4.05)])
def test_any_or_all_triggering_entities(tmp_path: Path, rule: str, wanted: float) -> None:
    """A is faster than 11 m/s from 2 s on, B from 4 s on."""
    faster = '<SpeedCondition value="11" rule="greaterOrEqual"/>'
    events = [
        Event("A", speed(20.0, by("linear", "rate", 1.0))),
        Event("B", speed(20.0, by("linear", "rate", 1.0)), 3.0),
        Event("W", speed(DONE), of_entity("A B", faster, rule)),
    ]
    run = play(tmp_path, {"A": Actor(), "B": Actor(lane=-2), "W": W}, events)
    assert run.acts("W", DONE) == pytest.approx(wanted)


def test_an_offset_that_is_drifted_to_does_not_change_distances_along_the_road(tmp_path: Path) -> None:
    more = 'coordinateSystem="road" relativeDistanceType="longitudinal"'
    drift = Event("A", lane_offset('<AbsoluteTargetLaneOffset value="3.2"/>', "step"), 0.5)
    assert seen(tmp_path, gap("RelativeDistanceCondition", more, 30.0), drift, **B_AHEAD) == pytest.approx(2.1)


def clear(folder: Path, attributes: str, other: Actor, lanes: str = 'from="0" to="0"') -> bool:
    """Return whether the lanes beside A, which stands in lane -2 at x = 200 m, are clear of another car.

    The box of a car goes from 1 m behind its reference point to 4 m ahead of it, and is 2 m wide.
    """
    word = f"<RelativeClearanceCondition {attributes}><RelativeLaneRange {lanes}/></RelativeClearanceCondition>"
    actors = {"A": Actor(lane=-2, s=200.0, speed=0.0), "B": replace(other, speed=0.0), "W": W}
    run = play(folder, actors, [Event("W", speed(DONE), of_entity("A", word))], 1.0)
    return run.acts("W", DONE) == 0.0


BOXES = 'freeSpace="true" oppositeLanes="false" distanceForward="20" distanceBackward="20"'
POINTS = BOXES.replace("true", "false", 1)


@pytest.mark.law("RelativeClearanceCondition", "of boxes")
@pytest.mark.parametrize(
    ("s", "of_points", "of_boxes"),
    [
        (222.0, True, True),
        (220.5, True, False),
        (219.5, False, False),
        (180.5, False, False),
        (179.0, True, False),
        (176.5, True, False),
        (175.5, True, True),
    ],
)
def test_a_clearance_begins_at_the_reference_point_and_ends_at_points_or_boxes(
    tmp_path: Path, s: float, of_points: bool, of_boxes: bool
) -> None:
    other = Actor(lane=-2, s=s)
    assert (clear(tmp_path, POINTS, other), clear(tmp_path, BOXES, other)) == (of_points, of_boxes)


@pytest.mark.law("RelativeClearanceCondition", "of boxes")
@pytest.mark.parametrize(
    ("lane", "offset", "opposite", "away", "of_points", "of_boxes"),
    [
        (-1, -0.5, False, 0, True, True),
        (-1, -1.0, False, 0, True, False),
        (-1, -1.0, False, 1, False, False),
        (-1, -1.0, False, -1, True, True),
        (-1, 1.0, True, 2, True, False),
        (1, -1.0, False, 1, True, False),
        (1, 0.5, False, 1, True, True),
    ],
)
def test_a_box_counts_in_every_lane_into_which_it_reaches(
    tmp_path: Path, lane: int, offset: float, opposite: bool, away: int, of_points: bool, of_boxes: bool
) -> None:
    """Lanes are 3.5 m wide: a car 1 m beside the centre of its lane reaches 0.25 m into the next one."""
    other, lanes = Actor(lane=lane, s=210.0, offset=offset), f'from="{away}" to="{away}"'
    ways = (one.replace('oppositeLanes="false"', f'oppositeLanes="{str(opposite).lower()}"') for one in (POINTS, BOXES))
    assert tuple(clear(tmp_path, one, other, lanes) for one in ways) == (of_points, of_boxes)


def test_a_time_that_has_come(tmp_path: Path) -> None:
    for rule, wanted in (("greaterOrEqual", 1.05), ("greaterThan", 1.1), ("equalTo", 1.05), ("notEqualTo", 0.0)):
        told = condition(f'<SimulationTimeCondition value="1" rule="{rule}"/>')
        run = play(tmp_path, {"W": W}, [Event("W", speed(DONE), told)], seconds=3.0)
        assert run.acts("W", DONE) == pytest.approx(wanted)


def play_with_variable(folder: Path, kind: str, value: str, events: Sequence[Event], seconds: float) -> Played:
    """Return what W does in a story with a variable `it` of a type and a value."""
    declared = f'<VariableDeclaration name="it" variableType="{kind}" value="{value}"/>'
    text = document({"W": W}, events, seconds)
    text = text.replace("<CatalogL", f"<VariableDeclarations>{declared}</VariableDeclarations><CatalogL")
    return play_text(folder, text, seconds)


@pytest.mark.law("VariableCondition", "used")
@pytest.mark.parametrize(
    ("kind", "value", "rule", "limit", "wanted"),
    [
        ("integer", "10", "greaterThan", "9", True),
        ("dateTime", "2026-01-01T01:00:00+01:00", "lessThan", "2026-01-01T00:30:00Z", True),
        ("boolean", "true", "notEqualTo", "0", True),
        ("string", "10", "greaterThan", "9", True),
        ("string", "9", "lessThan", "10", True),
        ("string", "5", "lessOrEqual", "5.0", True),
        ("string", "5", "lessThan", "5.0", False),
        ("string", "5", "equalTo", "5.0", False),
        ("string", "a", "lessThan", "b", False),
        ("string", "a", "greaterOrEqual", "a", False),
        ("string", "a", "greaterThan", "5", False),
        ("string", "", "lessThan", "5", False),
        ("string", "-5", "lessThan", "x", False),
    ],
)
def test_a_variable_is_compared_by_its_type_and_a_text_by_the_number_that_it_is(
    tmp_path: Path, kind: str, value: str, rule: str, limit: str, wanted: bool
) -> None:
    """Texts have no order of their own.

    "Less and greater operator will only be supported if the value given as string can unambiguously be converted into
    a scalar value" (ParameterCondition, ASAM OpenSCENARIO).
    """
    told = condition(f'<VariableCondition variableRef="it" rule="{rule}" value="{limit}"/>')
    run = play_with_variable(tmp_path, kind, value, [Event("W", speed(DONE), told)], 1.0)
    assert (run.acts("W", DONE) == 0.0) == wanted


def test_a_text_that_becomes_a_number_is_compared_as_one(tmp_path: Path) -> None:
    changes = [
        Event(
            "",
            f'<GlobalAction><VariableAction variableRef="it"><SetAction value="{value}"/></VariableAction>'
            "</GlobalAction>",
            time,
        )
        for time, value in ((1.0, "1e1"), (2.0, "word"), (3.0, "-0.5"))
    ]
    told = condition('<VariableCondition variableRef="it" rule="lessThan" value="9"/>')
    run = play_with_variable(tmp_path, "string", "none", [*changes, Event("W", speed(DONE), told)], 4.0)
    assert run.acts("W", DONE) == pytest.approx(3.05)


def test_only_present_entities_count_as_triggering_entities(tmp_path: Path) -> None:
    """B, which is never fast, is deleted at 3 s; A is faster than 11 m/s from 2 s on."""
    gone = '<GlobalAction><EntityAction entityRef="B"><DeleteEntityAction/></EntityAction></GlobalAction>'
    faster = '<SpeedCondition value="11" rule="greaterOrEqual"/>'
    events = [
        Event("A", speed(20.0, by("linear", "rate", 1.0))),
        Event("A", gone, 3.0),
        Event("W", speed(DONE), of_entity("A B", faster, "all")),
    ]
    run = play(tmp_path, {"A": Actor(), "B": Actor(lane=-2), "W": W}, events)
    assert run.acts("W", DONE) == pytest.approx(3.05)
    slow = of_entity("B", '<SpeedCondition value="50" rule="lessThan"/>', "all")
    none = [Event("A", gone, 0.5), Event("W", speed(DONE), slow + after(1.0))]
    assert play(tmp_path, {"A": Actor(), "B": Actor(lane=-2), "W": W}, none).acts("W", DONE) is None


CORNER = (
    '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape><Polyline>'
    '<Vertex><Position><WorldPosition x="60" y="-1.75"/></Position></Vertex>'
    '<Vertex><Position><WorldPosition x="90" y="-1.75"/></Position></Vertex>'
    '<Vertex><Position><WorldPosition x="90" y="48.25"/></Position></Vertex></Polyline></Shape></Trajectory>'
    '</TrajectoryRef><TimeReference><None/></TimeReference><TrajectoryFollowingMode followingMode="position"/>'
    "</FollowTrajectoryAction></RoutingAction>"
)
"""A trajectory of 30 m ahead, then 50 m to the left, begun at 1 s."""

BESIDE = '<Position><WorldPosition x="88" y="28.25"/></Position>'
"""A place 2 m to the left of it, 60 m from its begin."""


@pytest.mark.law("DistanceCondition", "system trajectory")
@pytest.mark.law("RelativeDistanceCondition", "system trajectory")
@pytest.mark.law("TimeHeadwayCondition", "system trajectory")
@pytest.mark.law("TimeToCollisionCondition", "system trajectory")
def test_a_distance_along_the_trajectory_that_is_followed(tmp_path: Path) -> None:
    """60 m at the start are less than 35 m in the row of 3.55 s; before 1 s A follows none, and the road counts."""
    more = 'coordinateSystem="trajectory" relativeDistanceType="longitudinal"'
    begin = Event("A", CORNER)
    there = {"B": Actor(position=BESIDE, speed=0.0)}
    words = {
        "DistanceCondition": gap("DistanceCondition", more, 35.0, where=BESIDE),
        "RelativeDistanceCondition": gap("RelativeDistanceCondition", more, 35.0),
        "TimeHeadwayCondition": gap("TimeHeadwayCondition", more, 3.5),
        "TimeToCollisionCondition": gap(
            "TimeToCollisionCondition",
            more,
            3.5,
            where=f"<TimeToCollisionConditionTarget>{BESIDE}</TimeToCollisionConditionTarget>",
        ),
    }
    for told in words.values():
        events = [begin, Event("W", speed(DONE), of_entity("A", told) + after(1.2))]
        assert play(tmp_path, {"A": Actor(), **there, "W": W}, events).acts("W", DONE) == pytest.approx(3.6)


@pytest.mark.law("DistanceCondition", "lateral")
def test_a_distance_across_the_trajectory_that_is_followed(tmp_path: Path) -> None:
    more = 'coordinateSystem="trajectory" relativeDistanceType="lateral"'
    for value, wanted in ((2.1, 1.25), (1.9, None)):
        told = of_entity("A", gap("DistanceCondition", more, value, where=BESIDE)) + after(1.2)
        events = [Event("A", CORNER), Event("W", speed(DONE), told)]
        found = play(tmp_path, {"A": Actor(), "W": W}, events, seconds=4.0).acts("W", DONE)
        assert found == (None if wanted is None else pytest.approx(wanted))


@pytest.mark.law("SpeedCondition", "lateral")
def test_a_speed_to_the_side(tmp_path: Path) -> None:
    """A step of 1 m to the side in 0.05 s is 20 m/s in the row of 1.05 s."""
    told = '<SpeedCondition value="19.9" rule="greaterThan" direction="lateral"/>'
    step = lane_offset('<AbsoluteTargetLaneOffset value="1"/>', "step")
    assert seen(tmp_path, told, Event("A", step)) == pytest.approx(1.1)


@pytest.mark.law("AccelerationCondition", "vertical")
def test_an_acceleration_upwards(tmp_path: Path) -> None:
    """Where the climb begins the speed upwards goes from 0 to 1 m/s in 0.05 s."""
    told = '<AccelerationCondition value="19.9" rule="greaterThan" direction="vertical"/>'
    assert seen(tmp_path, told, A=Actor(s=990.0)) == pytest.approx(1.1)


@pytest.mark.law("TimeOfDayCondition", "used")
def test_the_time_of_day_runs(tmp_path: Path) -> None:
    noon = (
        '<GlobalAction><EnvironmentAction><Environment name="noon"><TimeOfDay animation="true" '
        'dateTime="2026-01-01T12:00:00"/></Environment></EnvironmentAction></GlobalAction>'
    )
    told = condition('<TimeOfDayCondition dateTime="2026-01-01T12:00:02" rule="greaterOrEqual"/>')
    run = play(tmp_path, {"W": W}, [Event("W", noon, 0.0), Event("W", speed(DONE), told)], seconds=4.0)
    assert run.acts("W", DONE) == pytest.approx(2.05)


@pytest.mark.law("TrafficSignalStateAction", "used")
@pytest.mark.law("TrafficSignalCondition", "used")
def test_the_state_of_a_signal_is_seen_from_when_it_is_set_on(tmp_path: Path) -> None:
    state = (
        '<GlobalAction><InfrastructureAction><TrafficSignalAction><TrafficSignalStateAction name="s1" state="green"/>'
        "</TrafficSignalAction></InfrastructureAction></GlobalAction>"
    )
    told = condition('<TrafficSignalCondition name="s1" state="green"/>')
    run = play(tmp_path, {"W": W}, [Event("W", state, 1.0), Event("W", speed(DONE), told)], seconds=3.0)
    assert run.acts("W", DONE) == pytest.approx(1.05)


CROSSING = (
    '<TrafficSignals><TrafficSignalController name="crossing">'
    '<Phase name="go" duration="2"><TrafficSignalState trafficSignalId="s1" state="green"/></Phase>'
    '<Phase name="stop" duration="3"><TrafficSignalState trafficSignalId="s1" state="red"/></Phase>'
    "</TrafficSignalController></TrafficSignals>"
)


@pytest.mark.law("TrafficSignalControllerCondition", "used")
@pytest.mark.parametrize(("phase", "state", "wanted"), [("stop", "red", 2.05), ("go", "green", 5.05)])
def test_the_phases_of_a_controller_follow_each_other_in_a_circle(
    tmp_path: Path, phase: str, state: str, wanted: float
) -> None:
    """Go lasts from 0 to 2 s, stop from 2 to 5 s; a condition from 1 s on waits for go until it comes again."""
    in_phase = condition(
        f'<TrafficSignalControllerCondition trafficSignalControllerRef="crossing" phase="{phase}"/>', "rising"
    )
    in_state = condition(f'<TrafficSignalCondition name="s1" state="{state}"/>', "rising")
    for told in (in_phase, in_state):
        run = play(tmp_path, {"W": W}, [Event("W", speed(DONE), told)], seconds=7.0, signals=CROSSING)
        assert run.acts("W", DONE) == pytest.approx(wanted)


@pytest.mark.law("TrafficSignalControllerAction", "used")
def test_a_controller_continues_from_the_phase_to_which_it_is_set(tmp_path: Path) -> None:
    """Stop is set at 1 s and lasts 3 s."""
    stop = (
        '<GlobalAction><InfrastructureAction><TrafficSignalAction><TrafficSignalControllerAction phase="stop" '
        'trafficSignalControllerRef="crossing"/></TrafficSignalAction></InfrastructureAction></GlobalAction>'
    )
    for phase, wanted in (("stop", 1.05), ("go", 4.05)):
        told = f'<TrafficSignalControllerCondition trafficSignalControllerRef="crossing" phase="{phase}"/>'
        events = [Event("W", stop), Event("W", speed(DONE), condition(told, "rising"))]
        run = play(tmp_path, {"W": W}, events, seconds=7.0, signals=CROSSING)
        assert run.acts("W", DONE) == pytest.approx(wanted)


TO_B = '<TimeToCollisionConditionTarget><EntityRef entityRef="B"/></TimeToCollisionConditionTarget>'


@pytest.mark.law("TimeToCollisionCondition", "lateral")
def test_a_time_to_collision_across(tmp_path: Path) -> None:
    """Distance and speed are those across: 3.5 m to the left of A, which moves there at 1 m/s from 1 s on.

    Less than 2 s are left after 2.5 s. While A drives straight on there is no relative speed across, so no time.
    """
    told = gap("TimeToCollisionCondition", 'coordinateSystem="road" relativeDistanceType="lateral"', 2.0, where=TO_B)
    actors = {"A": Actor(lane=-2), "B": Actor(s=200.0, speed=0.0)}
    left = lane_change('<AbsoluteTargetLane value="-1"/>', by("linear", "rate", 1.0))
    assert seen(tmp_path, told, Event("A", left), **actors) == pytest.approx(2.6)
    assert seen(tmp_path, told, **actors) is None


CROSSING_PATH = (
    '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape><Polyline>'
    '<Vertex><Position><WorldPosition x="100" y="-30"/></Position></Vertex><Vertex><Position><WorldPosition x="100" '
    'y="30"/></Position></Vertex></Polyline></Shape></Trajectory></TrajectoryRef><TimeReference><None/></TimeReference>'
    '<TrajectoryFollowingMode followingMode="position"/></FollowTrajectoryAction></RoutingAction>'
)
CROSSES = Actor(
    position='<Position><WorldPosition x="100" y="-30" h="1.5707963267948966"/></Position>', action=CROSSING_PATH
)
"""Walks to the left over A's way, 50 m ahead of where A begins, off every road until it reaches y = -10.5."""


@pytest.mark.parametrize(("system", "kind"), [(one, "longitudinal") for one in SYSTEMS] + [("road", "lateral")])
def test_a_time_to_collision_with_someone_who_crosses(tmp_path: Path, system: str, kind: str) -> None:
    """Along, A closes the 50 m at its own 10 m/s: less than 3 s are left after 2 s.

    Across, B closes 28.25 m at its 5 m/s: less than 3 s are left after 2.65 s.
    """
    more = f'coordinateSystem="{system}" relativeDistanceType="{kind}"'
    told = gap("TimeToCollisionCondition", more, 3.0, where=TO_B)
    found = seen(tmp_path, told, B=replace(CROSSES, speed=5.0))
    assert found == pytest.approx(2.1 if kind == "longitudinal" else 2.75)


@pytest.mark.parametrize("kind", ["longitudinal", "euclidianDistance"])
def test_a_time_to_collision_with_what_moves_away_is_undefined(tmp_path: Path, kind: str) -> None:
    for rule in ("lessThan", "greaterThan"):
        told = gap("TimeToCollisionCondition", f'relativeDistanceType="{kind}"', 3.0, rule, TO_B)
        assert seen(tmp_path, told, B=Actor(s=100.0, speed=12.0)) is None


@pytest.mark.parametrize("freespace", ["false", "true"])
@pytest.mark.parametrize("names", ["A B", "B A"])
def test_a_distance_along_the_road_to_someone_beside_it(tmp_path: Path, names: str, freespace: str) -> None:
    """B stands off every road at x = 100, across it: its box begins 1 m before that, A's front is 4 m ahead of A."""
    one, other = names.split()
    inner = (
        f'<RelativeDistanceCondition entityRef="{other}" value="30" rule="lessThan" coordinateSystem="road" '
        f'relativeDistanceType="longitudinal" freespace="{freespace}"/>'
    )
    actors = {"A": Actor(), "B": replace(CROSSES, speed=0.0, action=""), "W": W}
    run = play(tmp_path, actors, [Event("W", speed(DONE), of_entity(one, inner))], 8.0)
    assert run.acts("W", DONE) == pytest.approx(1.6 if freespace == "true" else 2.1)


@pytest.mark.parametrize(
    ("more", "wanted"),
    [
        ("", 2.1),
        ('relativeDistanceType="longitudinal"', 1.65),
        ('coordinateSystem="entity"', 2.1),
        ('coordinateSystem="entity" relativeDistanceType="longitudinal"', 1.65),
    ],
)
def test_along_route_is_ignored_beside_what_replaces_it(tmp_path: Path, more: str, wanted: float) -> None:
    """A is turned by 0.5 rad: 30 m along its own axis are 30 / cos 0.5 = 34.2 m along the road, and 30 m straight."""
    turned = Actor(position='<Position><WorldPosition x="50" y="-1.75" h="0.5"/></Position>')
    told = gap("DistanceCondition", f'alongRoute="true" {more}', 30.0, where=lane_position(-1, 100.0))
    assert seen(tmp_path, told, A=turned) == pytest.approx(wanted)


def test_in_an_entitys_own_axes_every_angle_is_0(tmp_path: Path) -> None:
    turned = Actor(position='<Position><WorldPosition x="50" y="-1.75" h="0.5"/></Position>')
    for angle, wanted in ((0.0, 0.0), (0.5, None)):
        inner = f'<AngleCondition angleType="heading" angle="{angle}" angleTolerance="0.1" coordinateSystem="entity"/>'
        assert seen(tmp_path, inner, A=turned) == wanted


@pytest.mark.law("UserDefinedValueCondition", "used")
def test_a_value_that_no_program_supplies_meets_no_condition(tmp_path: Path) -> None:
    """The value is defined outside of the file; where nobody defines it, the condition is false whatever the rule."""
    for rule in ("equalTo", "notEqualTo", "lessThan"):
        told = condition(f'<UserDefinedValueCondition name="outside" value="1" rule="{rule}"/>')
        run = play(tmp_path, {"W": W}, [Event("W", speed(DONE), told)], seconds=1.0)
        assert run.acts("W", DONE) is None
