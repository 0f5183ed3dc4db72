"""Rectangles seen from above, and the overlap of two of them. OpenDRIVE axes, m and rad."""

from __future__ import annotations

import math
from typing import Protocol


class Rectangle(Protocol):
    """A box seen from above: its middle, its direction, its length along this, and its width across it."""

    @property
    def x(self) -> float:
        """Middle, m."""

    @property
    def y(self) -> float:
        """Middle, m."""

    @property
    def heading(self) -> float:
        """Direction of its front, rad."""

    @property
    def length(self) -> float:
        """Along the heading, m."""

    @property
    def width(self) -> float:
        """Across it, m."""


def ahead(one: Rectangle) -> tuple[float, float]:
    """Return the direction of a rectangle's front."""
    return math.cos(one.heading), math.sin(one.heading)


def half_along(one: Rectangle, x: float, y: float) -> float:
    """Return half of a rectangle's extent along a direction, m."""
    c, s = ahead(one)
    return 0.5 * (one.length * abs(c * x + s * y) + one.width * abs(c * y - s * x))


def least_overlap(one: Rectangle, other: Rectangle) -> tuple[float, float, float]:
    """Return the direction from one to the other in which they overlap least, and by how much they do, m.

    They do not overlap if this is negative (separating axis theorem).
    """
    dx, dy = other.x - one.x, other.y - one.y
    least = (1.0, 0.0, math.inf)
    for c, s in (ahead(one), ahead(other)):
        for x, y in ((c, s), (-s, c)):
            away = dx * x + dy * y
            depth = half_along(one, x, y) + half_along(other, x, y) - abs(away)
            if depth < least[2]:
                least = (x, y, depth) if away >= 0.0 else (-x, -y, depth)
    return least
