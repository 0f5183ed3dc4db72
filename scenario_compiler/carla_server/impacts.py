"""The impacts of bodies that touch: an impulse changes their speeds along their headings and keeps them apart.

A vehicle's wheels do not slip here, so that an impulse changes its speed along its heading only, and its tires hold it
against the rest; a walker gives way in every direction; what no physics moves stands fast.
"""

from __future__ import annotations

from typing import NamedTuple

from scenario_compiler.carla_server.rectangles import ahead, least_overlap

RESTITUTION = 0.1
"""Share of the speed at which bodies meet with which they part again."""

PARTING = 2.0
FASTEST_PARTING = 0.5
"""Speed with which overlapping bodies part, m/s for each metre of the overlap, and the greatest such speed, m/s."""


class Footprint(NamedTuple):
    """A body's box from above, and how it moves. OpenDRIVE axes.

    Attributes:
        x: Middle, m.
        y: Middle, m.
        heading: Direction of its front, rad.
        length: Along the heading, m.
        width: Across it, m.
        speed: Along the heading, m/s.
        inertia: Its mass, kg; infinite for a fixed body.
        rolls: Whether it moves along its heading only.
    """

    x: float
    y: float
    heading: float
    length: float
    width: float
    speed: float
    inertia: float
    rolls: bool


class Impact(NamedTuple):
    """The effect of an impact on two bodies.

    Attributes:
        x, y: Impulse of the second on the first, OpenDRIVE axes, N s.
        speed: Speed of the first afterwards, m/s, signed along its heading.
        other_speed: Speed of the second afterwards, m/s, signed along its heading.
    """

    x: float
    y: float
    speed: float
    other_speed: float


def impact(one: Footprint, other: Footprint) -> Impact:
    """Return the impact of two bodies whose boxes overlap.

    They meet along the direction in which they overlap least (separating axis theorem). The impulse is that of two
    bodies each of which can move as it can only: the speed at which they meet, over the sum of their mobilities.
    """
    x, y, depth = least_overlap(one, other)
    along, across = (c * x + s * y for c, s in (ahead(one), ahead(other)))
    meets = one.speed * along - other.speed * across
    moves = [(at * at if body.rolls else 1.0) / body.inertia for body, at in ((one, along), (other, across))]
    parts = max(RESTITUTION * meets, min(PARTING * depth, FASTEST_PARTING))
    if meets + parts <= 0.0 or sum(moves) < 1e-9:
        return Impact(0.0, 0.0, one.speed, other.speed)
    impulse = (meets + parts) / sum(moves)
    return Impact(
        -impulse * x,
        -impulse * y,
        one.speed - impulse / one.inertia * along,
        other.speed + impulse / other.inertia * across,
    )
