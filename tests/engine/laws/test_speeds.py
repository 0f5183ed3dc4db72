"""Speeds: absolute and relative changes, profiles, synchronised arrivals."""

from __future__ import annotations

from math import atan, cos, pi, sqrt
from pathlib import Path

import pytest

from tests.engine.laws.told import Actor, Event, Played, by, condition, lane_position, play, relative_speed, speed

A = {"A": Actor()}
A_AND_B = {"B": Actor(lane=-2, s=200, speed=8.0), "A": Actor()}


def changed(folder: Path, action: str, **actors: Actor) -> Played:
    """Run a change of A's speed from 10 m/s that begins at 1 s; B drives at 8 m/s."""
    return play(folder, {**A_AND_B, **actors}, [Event("A", action)])


def followed_by(folder: Path, action: str) -> float | None:
    """Return when an event that waits for the end of A's action, which begins at 1 s, shows in A's speed."""
    inner = '<StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="first" state="{}"/>'
    ended = condition(inner.format("completeState"))
    events = [Event("A", action, 1.0, name="first"), Event("A", speed(3.0), ended, name="second")]
    return play(folder, A, events).acts("A", 3.0)


@pytest.mark.law("SpeedAction", "sinusoidal by rate")
def test_a_sinusoidal_rate_is_the_peak(tmp_path: Path) -> None:
    run = changed(tmp_path, speed(20.0, by("sinusoidal", "rate", 2.0)))
    assert run.at("A", 3.0).v == pytest.approx(10.0 + 5.0 * (1.0 - cos(0.8)))


@pytest.mark.law("SpeedAction", "cubic by rate")
def test_a_cubic_rate_is_the_peak(tmp_path: Path) -> None:
    run = changed(tmp_path, speed(20.0, by("cubic", "rate", 2.0)))
    assert run.at("A", 4.75).v == pytest.approx(15.0)
    assert run.acts("A", 20.0) == pytest.approx(8.5)


@pytest.mark.law("SpeedAction", "linear by rate")
def test_the_sign_of_a_rate_is_ignored(tmp_path: Path) -> None:
    run = changed(tmp_path, speed(4.0, by("linear", "rate", -2.0)))
    assert run.at("A", 2.5).v == pytest.approx(7.0)
    assert run.acts("A", 4.0) == pytest.approx(4.0)


@pytest.mark.law("SpeedAction", "linear by distance")
def test_a_change_through_0_covers_distance_forwards_and_backwards(tmp_path: Path) -> None:
    run = changed(tmp_path, speed(-10.0, by("linear", "distance", 20.0)))
    assert run.at("A", 3.0).v == pytest.approx(0.0, abs=1e-9)
    assert run.acts("A", -10.0) == pytest.approx(5.0)


def test_a_change_by_distance_to_the_present_speed_ends_at_once(tmp_path: Path) -> None:
    """Its end starts the next event in the following step."""
    assert followed_by(tmp_path, speed(10.0, by("linear", "distance", 50.0))) == pytest.approx(1.1)


@pytest.mark.law("SpeedAction", "relative, linear by time")
@pytest.mark.law("SpeedAction", "relative, cubic by time")
@pytest.mark.parametrize("shape", ["linear", "cubic"])
def test_a_relative_change_over_a_time(tmp_path: Path, shape: str) -> None:
    run = changed(tmp_path, relative_speed("B", 4.0, by(shape, "time", 4.0)))
    assert run.at("A", 3.0).v == pytest.approx(11.0)
    assert run.acts("A", 12.0) == pytest.approx(5.0)


@pytest.mark.law("SpeedAction", "relative by factor, once")
def test_a_factor_is_of_the_other_speed(tmp_path: Path) -> None:
    run = changed(tmp_path, relative_speed("B", 1.5, by("linear", "time", 2.0), "factor"))
    assert run.at("A", 2.0).v == pytest.approx(11.0)
    assert run.at("A", 9.0).v == pytest.approx(12.0)


@pytest.mark.law("SpeedAction", "relative, linear by distance")
@pytest.mark.law("SpeedAction", "relative, sinusoidal by distance")
@pytest.mark.law("SpeedAction", "relative, cubic by distance")
@pytest.mark.parametrize(
    ("shape", "share"), [("linear", 0.25), ("sinusoidal", (1 - sqrt(0.5)) / 2), ("cubic", 0.15625)]
)
def test_a_relative_change_over_a_distance_has_its_shape_over_time(tmp_path: Path, shape: str, share: float) -> None:
    run = changed(tmp_path, relative_speed("B", 6.0, by(shape, "distance", 48.0)))
    assert run.at("A", 2.0).v == pytest.approx(10.0 + 4.0 * share)
    assert run.at("A", 3.0).v == pytest.approx(12.0)
    assert run.acts("A", 14.0) == pytest.approx(5.0)


@pytest.mark.law("SpeedAction", "relative, sinusoidal by rate")
@pytest.mark.law("SpeedAction", "relative, cubic by rate")
@pytest.mark.parametrize(
    ("shape", "time", "wanted"), [("sinusoidal", 2.0, 10.0 + 3.0 * (1.0 - cos(1.0))), ("cubic", 2.5, 13.0)]
)
def test_a_relative_change_by_rate_peaks_at_it(tmp_path: Path, shape: str, time: float, wanted: float) -> None:
    run = changed(tmp_path, relative_speed("B", 8.0, by(shape, "rate", 3.0)))
    assert run.at("A", time).v == pytest.approx(wanted)


def test_a_rate_is_kept_while_the_target_moves(tmp_path: Path) -> None:
    action = relative_speed("B", 4.0, by("linear", "rate", 2.0))
    run = play(tmp_path, A_AND_B, [Event("B", speed(20.0, by("linear", "rate", 1.0))), Event("A", action)])
    assert run.at("A", 2.0).v == pytest.approx(12.0)
    assert run.at("A", 3.0).v == pytest.approx(14.0)
    assert run.at("A", 5.0).v == pytest.approx(14.0)


def test_a_continuous_target_is_followed(tmp_path: Path) -> None:
    action = relative_speed("B", 0.5, by("linear", "rate", 2.0), "factor", "true")
    run = play(tmp_path, A_AND_B, [Event("B", speed(20.0, by("linear", "rate", 1.0))), Event("A", action)])
    assert [run.at("A", time).v for time in (8.0, 9.0)] == pytest.approx([7.5, 8.0])


def test_a_continuous_target_that_was_reached_is_followed_exactly(tmp_path: Path) -> None:
    """A reaches 20 m/s at 5 m/s2; B then brakes at 8 m/s2 to less than A had at the start."""
    actors = {"B": Actor(lane=-2, s=400.0, speed=20.0), "A": Actor()}
    events = [
        Event("B", speed(4.0, by("linear", "rate", 8.0)), 5.0),
        Event("A", relative_speed("B", 0.0, by("linear", "rate", 5.0), continuous="true")),
    ]
    run = play(tmp_path, actors, events)
    assert [run.at("A", time).v for time in (2.0, 3.0, 6.0, 6.5, 7.0)] == pytest.approx([15.0, 20.0, 12.0, 8.0, 4.0])


def profile(following: str, entries: str, limits: str = "", other: str = "") -> str:
    """Return a profile of speeds; entries as `speed` or `speed@time`."""
    told = ""
    for one in entries.split():
        value, _, time = one.partition("@")
        told += f'<SpeedProfileEntry speed="{value}"' + (f' time="{time}"/>' if time else "/>")
    constraints = f"<DynamicConstraints {limits}/>" if limits else ""
    reference = f' entityRef="{other}"' if other else ""
    return (
        f'<LongitudinalAction><SpeedProfileAction followingMode="{following}"{reference}>{constraints}{told}'
        "</SpeedProfileAction></LongitudinalAction>"
    )


LIMITS = 'maxAcceleration="3" maxDeceleration="2" maxAccelerationRate="3" maxDecelerationRate="3" maxSpeed="50"'


@pytest.mark.law("SpeedProfileAction", "position, an entry without time")
def test_entries_without_times_take_the_limits_as_their_slopes(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", profile("position", "16 12", LIMITS))])
    assert [run.at("A", time).v for time in (2.0, 3.0, 4.0, 5.0, 6.0)] == pytest.approx([13.0, 16.0, 14.0, 12.0, 12.0])


@pytest.mark.law("SpeedProfileAction", "position, times given")
def test_an_entry_that_is_too_steep_shifts_all_later_ones(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", profile("position", "16@1 14@2", LIMITS))])
    assert [run.at("A", time).v for time in (2.0, 3.0, 4.0, 5.0)] == pytest.approx([13.0, 16.0, 15.0, 14.0])


@pytest.mark.law("SpeedProfileAction", "position, a single entry")
def test_a_single_entry_by_position_is_a_line(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", profile("position", "16@3"))])
    assert run.at("A", 2.5).v == pytest.approx(13.0)
    assert run.acts("A", 16.0) == pytest.approx(4.0)


def level(span: float, change: float) -> float:
    """Return the acceleration q of a change with a jerk of 3 m/s3 at both ends: q T - q^2 / 3 is the change."""
    return (span - sqrt(span * span - 4.0 * change / 3.0)) * 1.5


@pytest.mark.law("SpeedProfileAction", "follow, a single entry")
@pytest.mark.parametrize(
    ("entry", "wanted"),
    [
        ("16", {2.0: 11.5, 3.0: 14.5, 4.0: 16.0}),
        ("16@4", {2.0: 10.0 + level(4.0, 6.0) * (1.0 - level(4.0, 6.0) / 6.0), 3.0: 13.0, 5.0: 16.0}),
        ("4@8", {2.0: 10.0 - level(8.0, 6.0) * (1.0 - level(8.0, 6.0) / 6.0), 5.0: 7.0, 9.0: 4.0}),
    ],
)
def test_a_single_entry_that_is_followed_rises_and_falls_by_its_jerk(
    tmp_path: Path, entry: str, wanted: dict[float, float]
) -> None:
    """Without a time the acceleration goes to the limit of 3 m/s2: a second up, a second there, a second down."""
    run = play(tmp_path, A, [Event("A", profile("follow", entry, LIMITS))])
    for time, value in wanted.items():
        assert run.at("A", time).v == pytest.approx(value, abs=1e-9)


@pytest.mark.parametrize("mode", ["position", "follow"])
def test_a_single_entry_at_the_present_speed_lasts_for_its_time(tmp_path: Path, mode: str) -> None:
    """5 s from 1 s on; the next event starts one step after its end."""
    assert followed_by(tmp_path, profile(mode, "10@5", LIMITS)) == pytest.approx(6.05)


@pytest.mark.parametrize("mode", ["position", "follow"])
@pytest.mark.parametrize("entries", ["14@2 10@2", "18", "14@2 14@1 0@1"])
def test_a_profile_without_limits_of_jerk_ends_with_its_last_entry(tmp_path: Path, mode: str, entries: str) -> None:
    """Its corners are sharp: rounding them takes no time that counts."""
    times = {"14@2 10@2": 5.05, "18": 1.85, "14@2 14@1 0@1": 6.05}
    limits = 'maxDeceleration="7"' if entries.endswith("0@1") else ""
    assert followed_by(tmp_path, profile(mode, entries, limits)) == pytest.approx(times[entries])


def test_a_corner_that_cannot_be_rounded_in_time_stays_sharp(tmp_path: Path) -> None:
    sharp = LIMITS.replace('Rate="3"', 'Rate="0.5"')
    run = play(tmp_path, A, [Event("A", profile("follow", "14@2 10@2", sharp))])
    assert [run.at("A", time).v for time in (2.0, 3.0, 4.0, 5.0)] == pytest.approx([12.0, 14.0, 12.0, 10.0])


@pytest.mark.law("SpeedProfileAction", "relative to an entity")
def test_entries_relative_to_an_entity_are_added_to_its_speed(tmp_path: Path) -> None:
    run = play(tmp_path, A_AND_B, [Event("A", profile("position", "0@2 4@2", other="B"))])
    assert run.at("A", 3.0).v == pytest.approx(8.0)
    assert run.at("A", 5.0).v == pytest.approx(12.0)


def test_an_action_allows_no_more_than_its_vehicle(tmp_path: Path) -> None:
    """The vehicle accelerates and brakes by 10 m/s2 at most."""
    limits = 'maxAcceleration="20" maxDeceleration="20" maxSpeed="70"'
    run = play(tmp_path, A, [Event("A", profile("position", "30 20", limits))])
    assert [run.at("A", time).v for time in (2.0, 3.0, 3.5, 4.0)] == pytest.approx([20.0, 30.0, 25.0, 20.0])
    far = (
        '<LongitudinalAction><LongitudinalDistanceAction entityRef="B" distance="20" freespace="false" '
        f'continuous="true" displacement="trailingReferencedEntity"><DynamicConstraints {limits}/>'
        "</LongitudinalDistanceAction></LongitudinalAction>"
    )
    run = play(tmp_path, A_AND_B, [Event("A", far)])
    assert run.at("A", 2.0).v == pytest.approx(20.0)


def test_a_step_needs_no_dimension_and_no_value(tmp_path: Path) -> None:
    run = play(tmp_path, A, [Event("A", speed(4.0, 'dynamicsShape="step"'))])
    assert run.acts("A", 4.0) == pytest.approx(1.05)


def synchronize(final: str, way: float, tolerance: str = "") -> str:
    """Return an arrival of A, which begins at 60 m, after a way, when B, which begins at 208 m, has gone 100 m."""
    return (
        f'<SynchronizeAction masterEntityRef="B"{tolerance}>'
        f"{lane_position(-2, 308.0, tag='TargetPositionMaster')}"
        f"{lane_position(-1, 60.0 + way, tag='TargetPosition')}"
        f"{final}</SynchronizeAction>"
    )


def absolute(value: float, steady: str = "") -> str:
    """Return a final speed."""
    return f'<FinalSpeed><AbsoluteSpeed value="{value}">{steady}</AbsoluteSpeed></FinalSpeed>'


@pytest.mark.law("SynchronizeAction", "to an absolute speed")
@pytest.mark.parametrize(
    ("way", "first"),
    [
        (150.0, 2.0 * (12.0 - 11.0 + sqrt(0.5 * (2.0**2 + 0.0**2))) / 12.5),
        (125.0, 2.0 * (10.0 - 11.0 - sqrt(0.5 * (0.0**2 + 2.0**2))) / 12.5),
    ],
)
def test_the_first_phase_speeds_up_or_slows_down(tmp_path: Path, way: float, first: float) -> None:
    """100 m at 8 m/s take 12.5 s; the means 12 and 10 m/s lie above and below that of 10 and 12 m/s."""
    run = play(tmp_path, A_AND_B, [Event("A", synchronize(absolute(12.0), way))], seconds=15.0)
    assert run.at("A", 1.05).v == pytest.approx(10.0 + 0.05 * first)
    assert run.at("A", 13.5).x == pytest.approx(60.0 + way, abs=0.1)
    assert run.at("A", 13.6).v == pytest.approx(12.0)


@pytest.mark.law("SynchronizeAction", "with a steady time")
def test_a_steady_time_reduces_the_remaining_distance_and_time(tmp_path: Path) -> None:
    steady = '<TargetTimeSteadyState time="2.5"/>'
    run = play(tmp_path, A_AND_B, [Event("A", synchronize(absolute(12.0, steady), 150.0))], seconds=15.0)
    assert run.at("A", 1.05).v == pytest.approx(10.0 + 0.05 * 2.0 * (1.0 + sqrt(2.0)) / 10.0)
    assert [run.at("A", time).v for time in (11.2, 12.0, 13.0, 13.45)] == pytest.approx([12.0] * 4)
    assert run.at("A", 13.5).x == pytest.approx(210.0, abs=0.1)


@pytest.mark.law("SynchronizeAction", "to a speed relative to the master's")
def test_a_final_speed_can_be_relative_to_the_masters(tmp_path: Path) -> None:
    more = '<RelativeSpeedToMaster speedTargetValueType="delta" value="4"></RelativeSpeedToMaster>'
    final = f"<FinalSpeed>{more}</FinalSpeed>"
    run = play(tmp_path, A_AND_B, [Event("A", synchronize(final, 150.0))], seconds=15.0)
    assert run.at("A", 1.05).v == pytest.approx(10.0 + 0.05 * 2.0 * (1.0 + sqrt(2.0)) / 12.5)
    assert run.at("A", 13.6).v == pytest.approx(12.0)


def test_it_stops_within_the_remaining_distance_while_the_master_stands(tmp_path: Path) -> None:
    actors = {"B": Actor(lane=-2, s=200, speed=0.0), "A": Actor(speed=8.0, s=52.0)}
    run = play(tmp_path, actors, [Event("A", synchronize(absolute(10.0), 100.0))], seconds=20.0)
    assert run.at("A", 1.05).v == pytest.approx(8.0 - 0.05 * (8.0**2 + 10.0**2) / 200.0)
    assert run.at("A", 20.0).v == 0.0
    assert run.at("A", 20.0).x < 160.0


def test_a_master_may_arrive_in_reverse(tmp_path: Path) -> None:
    """B reverses at 8 m/s and has 80 m to go at 1 s, so that A has 10 s for its 150 m.

    Without a final speed A accelerates uniformly: 10 t + a t^2 / 2 = 150 gives a = 1.
    """
    actors = {"B": Actor(lane=-2, s=396.0, speed=-8.0), "A": Actor()}
    run = play(tmp_path, actors, [Event("A", synchronize("", 150.0))], seconds=12.0)
    for after in (2.0, 5.0, 9.0):
        assert run.at("A", 1.0 + after).v == pytest.approx(10.0 + after, abs=0.1)
        assert run.at("A", 1.0 + after).x == pytest.approx(60.0 + 10.0 * after + 0.5 * after**2, abs=0.3)
    assert run.at("A", 11.0).x == pytest.approx(210.0, abs=0.5)
    assert run.at("B", 11.0).x == pytest.approx(308.0)


def test_a_master_that_moves_away_in_reverse_ends_the_action(tmp_path: Path) -> None:
    """B reverses away from its position: A keeps its speed."""
    actors = {"B": Actor(lane=-2, s=200.0, speed=-8.0), "A": Actor()}
    run = play(tmp_path, actors, [Event("A", synchronize("", 150.0))], seconds=6.0)
    assert run.at("A", 6.0).v == pytest.approx(run.at("A", 1.2).v)


def test_it_brakes_hard_if_the_distance_to_stop_is_too_short(tmp_path: Path) -> None:
    actors = {"B": Actor(lane=-2, s=200, speed=0.0), "A": Actor(speed=12.0, s=48.0)}
    run = play(tmp_path, actors, [Event("A", synchronize(absolute(10.0), 100.0))], seconds=10.0)
    assert run.at("A", 1.55).v == pytest.approx(12.0 - 8.0 * 0.55)
    assert run.at("A", 3.0).v == 0.0


def test_without_a_final_speed_twice_the_missing_speed_is_commanded(tmp_path: Path) -> None:
    run = play(tmp_path, A_AND_B, [Event("A", synchronize("", 150.0))], seconds=10.0)
    assert run.at("A", 1.05).v == pytest.approx(10.0 + 0.05 * 2.0 * (12.0 - 10.0) / 12.5)


def test_tolerances_shorten_the_distances(tmp_path: Path) -> None:
    tolerance = ' targetTolerance="25" targetToleranceMaster="20"'
    run = play(tmp_path, A_AND_B, [Event("A", synchronize("", 150.0, tolerance=tolerance))], seconds=10.0)
    assert run.at("A", 1.05).v == pytest.approx(10.0 + 0.05 * 2.0 * (12.5 - 10.0) / 10.0)


def test_distances_are_measured_along_the_followed_trajectories(tmp_path: Path) -> None:
    """A's way leads round a corner: 60 m and 80 m, though its end is 100 m away. B needs 12.5 s for its own.

    The trajectory is stepped first, so 0.5 m of the 140 m are gone when the speed is chosen.
    """
    corner = (
        '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape><Polyline>'
        '<Vertex><Position><WorldPosition x="60" y="-1.75"/></Position></Vertex>'
        '<Vertex><Position><WorldPosition x="120" y="-1.75"/></Position></Vertex>'
        '<Vertex><Position><WorldPosition x="120" y="78.25"/></Position></Vertex></Polyline></Shape></Trajectory>'
        '</TrajectoryRef><TimeReference><None/></TimeReference><TrajectoryFollowingMode followingMode="position"/>'
        "</FollowTrajectoryAction></RoutingAction>"
    )
    place = '<TargetPosition><WorldPosition x="120" y="78.25"/></TargetPosition>'
    meet = (
        '<SynchronizeAction masterEntityRef="B">'
        f"{lane_position(-2, 308.0, tag='TargetPositionMaster')}{place}</SynchronizeAction>"
    )
    run = play(tmp_path, A_AND_B, [Event("A", corner), Event("A", meet)], seconds=10.0)
    assert run.at("A", 1.05).v == pytest.approx(10.0 + 0.05 * 2.0 * (139.5 / 12.5 - 10.0) / 12.5)


def test_a_deleted_entity_keeps_its_speed(tmp_path: Path) -> None:
    entity = '<GlobalAction><EntityAction entityRef="A">{}</EntityAction></GlobalAction>'
    gone = entity.format("<DeleteEntityAction/>")
    back = entity.format(f"<AddEntityAction>{lane_position(-1, 300.0)}</AddEntityAction>")
    run = play(tmp_path, A_AND_B, [Event("B", gone, 2.0), Event("B", back, 4.0)])
    assert "A" not in run.rows[round(3.0 / 0.05)]
    assert run.at("A", 5.0).v == pytest.approx(10.0)
    assert run.at("A", 5.0).x - run.at("A", 4.5).x == pytest.approx(5.0)


@pytest.mark.parametrize("deleted", [2.0, 1.0])
def test_a_change_of_speed_ends_when_its_reference_is_deleted(tmp_path: Path, deleted: float) -> None:
    """B is deleted during A's change or before it; then A keeps its speed, and the next event starts."""
    gone = '<GlobalAction><EntityAction entityRef="B"><DeleteEntityAction/></EntityAction></GlobalAction>'
    ended = '<StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="first" state="{}"/>'
    for action in (relative_speed("B", 4.0, by("linear", "time", 4.0)), synchronize(absolute(12.0), 150.0)):
        events = [
            Event("A", gone, deleted),
            Event("A", action, 1.0, name="first"),
            Event("C", speed(3.0), condition(ended.format("completeState"))),
        ]
        run = play(tmp_path, {**A_AND_B, "C": Actor(lane=2, s=900.0)}, events, seconds=5.0)
        assert run.at("A", 5.0).v == run.at("A", deleted).v
        assert run.acts("C", 3.0) == pytest.approx(deleted + 0.1)


def test_a_change_of_speed_of_a_deleted_entity_goes_on(tmp_path: Path) -> None:
    """As in esmini: from 10 m/s at 1 s to 20 m/s at 5 s; A is away from 2 s to 4 s."""
    entity = '<GlobalAction><EntityAction entityRef="A">{}</EntityAction></GlobalAction>'
    gone = entity.format("<DeleteEntityAction/>")
    back = entity.format(f"<AddEntityAction>{lane_position(-1, 300.0)}</AddEntityAction>")
    ramp = Event("A", speed(20.0, by("linear", "time", 4.0)))
    run = play(tmp_path, A_AND_B, [ramp, Event("B", gone, 2.0), Event("B", back, 4.0)])
    assert run.at("A", 4.05).v == pytest.approx(17.625)
    assert run.acts("A", 20.0) == pytest.approx(5.0)


def test_a_peak_rate_above_the_vehicles_limit_takes_longer(tmp_path: Path) -> None:
    run = changed(tmp_path, speed(40.0, by("sinusoidal", "time", 1.0)))
    assert run.acts("A", 40.0) == pytest.approx(1.0 + 30.0 * pi / (2.0 * 10.0), abs=0.05 + 1e-9)


def test_on_a_slope_a_speed_counts_in_the_plane(tmp_path: Path) -> None:
    """As s of OpenDRIVE does, and as in esmini: here the road climbs by 0.1."""
    run = play(tmp_path, {"A": Actor(s=1100.0)}, [])
    first, last = run.at("A", 0.0), run.at("A", 4.0)
    assert last.pitch == pytest.approx(-atan(0.1))
    assert (last.x - first.x, last.v) == pytest.approx((40.0, 10.0))
