"""What happens where two boxes touch: momentum, what stands fast, and no way through."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.carla_server.impacts import FASTEST_PARTING, RESTITUTION, Footprint, impact

CAR = Footprint(0.0, 0.0, 0.0, 4.0, 2.0, 10.0, 1500.0, rolls=True)
"""It drives along x; another one is put so that both touch, without a noticeable overlap."""


def other(x: float, y: float, heading: float, speed: float = 0.0, inertia: float = 1500.0) -> Footprint:
    return CAR._replace(x=x, y=y, heading=heading, speed=speed, inertia=inertia)


@pytest.mark.parametrize("inertia", [300.0, 1500.0, 30_000.0])
@pytest.mark.parametrize("speed", [-5.0, 0.0, 4.0])
def test_cars_in_a_line_keep_their_momentum(speed: float, inertia: float) -> None:
    front = other(4.0, 0.0, 0.0, speed, inertia)
    found = impact(CAR, front)
    before = CAR.inertia * CAR.speed + inertia * speed
    assert CAR.inertia * found.speed + inertia * found.other_speed == pytest.approx(before)
    assert found.other_speed - found.speed == pytest.approx(RESTITUTION * (CAR.speed - speed))
    assert found.x == pytest.approx(CAR.inertia * (found.speed - CAR.speed))
    assert found.y == pytest.approx(0.0)


def test_it_does_not_matter_who_is_the_first() -> None:
    front = other(4.0, 0.3, 0.2, 3.0, 900.0)
    one, two = impact(CAR, front), impact(front, CAR)
    assert (one.speed, one.other_speed) == pytest.approx((two.other_speed, two.speed))
    assert (one.x, one.y) == pytest.approx((-two.x, -two.y))


def test_what_stands_fast_turns_a_car_back() -> None:
    found = impact(CAR, other(4.0, 0.9, 0.0, inertia=math.inf))
    assert (found.speed, found.other_speed) == pytest.approx((-RESTITUTION * CAR.speed, 0.0))


def test_a_car_does_not_drive_through_one_that_stands_across() -> None:
    """The wheels of the other one hold it: they do not slip here."""
    found = impact(CAR, other(3.0, 0.0, 0.5 * math.pi))
    assert found.speed == pytest.approx(-RESTITUTION * CAR.speed)
    assert found.other_speed == pytest.approx(0.0, abs=1e-9)


def test_a_walker_gives_way_wherever_it_faces() -> None:
    person = Footprint(2.2, 0.0, 0.5 * math.pi, 0.4, 0.4, 0.0, 80.0, rolls=False)
    found = impact(CAR, person)
    assert 8.5 < found.speed < CAR.speed


def test_bodies_that_part_are_left_alone() -> None:
    front = other(4.0, 0.0, 0.0, speed=12.0)
    assert impact(CAR, front) == (0.0, 0.0, CAR.speed, 12.0)


def test_bodies_that_overlap_part_slowly() -> None:
    """A car that pushes against a wall does not creep into it."""
    for depth in (0.1, 1.0):
        found = impact(CAR._replace(speed=0.0), other(4.0 - depth, 0.0, 0.0, inertia=math.inf))
        assert found.speed == pytest.approx(-min(2.0 * depth, FASTEST_PARTING))


def test_two_that_stand_fast_stay() -> None:
    wall = CAR._replace(inertia=math.inf, speed=0.0)
    assert impact(wall, wall._replace(x=1.0)) == (0.0, 0.0, 0.0, 0.0)
