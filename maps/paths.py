"""Reference lines: pieces of straight, arc and clothoid laid end to end, and lengths that make them meet.

Coordinates are OpenDRIVE's, in metres: x to the east, y to the north, headings in radians from x to y.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

LENGTH_DECIMALS = 6
SIMPSON_STEPS = 400


@dataclass(frozen=True)
class Pose:
    """A point (m) and a heading (rad)."""

    x: float
    y: float
    heading: float

    def moved(self, forward: float, left: float) -> Pose:
        """The pose `forward` metres ahead and `left` metres to the left, same heading."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        return Pose(self.x + forward * cos - left * sin, self.y + forward * sin + left * cos, self.heading)

    def turned(self, angle: float) -> Pose:
        """The same point with its heading turned by `angle` (rad, left positive)."""
        return Pose(self.x, self.y, self.heading + angle)


@dataclass(frozen=True)
class Piece:
    """A stretch whose curvature (1/m, left positive) runs linearly; a length of None is found by `fitted`."""

    length: float | None
    curvature_start: float = 0.0
    curvature_end: float = 0.0

    @property
    def known_length(self) -> float:
        """The length (m), 0 while it is not known."""
        return 0.0 if self.length is None else self.length


Path = tuple[Piece, ...]


def straight(length: float | None = None) -> Path:
    """A straight of `length` metres, or one whose length follows from where the path has to arrive."""
    return (Piece(length if length is None else round(length, LENGTH_DECIMALS)),)


def bend(degrees: float, radius: float, spiral: float = 0.0) -> Path:
    """A turn by `degrees` (left positive) at `radius` (m), a clothoid of `spiral` metres at either end."""
    curvature = math.copysign(1.0 / radius, degrees)
    arc = Piece(round(math.radians(abs(degrees)) * radius - spiral, LENGTH_DECIMALS), curvature, curvature)
    if arc.known_length <= 0.0:
        raise ValueError(f"a bend of {degrees} degrees at {radius} m has no room for spirals of {spiral} m")
    if spiral == 0.0:
        return (arc,)
    return (Piece(spiral, 0.0, curvature), arc, Piece(spiral, curvature, 0.0))


def length_of(path: Path) -> float:
    """Length (m) of a path whose pieces are all known."""
    return round(sum(piece.known_length for piece in path), LENGTH_DECIMALS)


def end_of(start: Pose, path: Iterable[Piece]) -> Pose:
    """Where a path ends that begins at `start`; unknown lengths count as 0."""
    pose = start
    for piece in path:
        pose = _end_of_piece(pose, piece)
    return pose


def start_of(end: Pose, path: Path) -> Pose:
    """Where a path begins that ends at `end`."""
    back = (replace(p, curvature_start=-p.curvature_end, curvature_end=-p.curvature_start) for p in reversed(path))
    return end_of(end.turned(math.pi), back).turned(math.pi)


def _end_of_piece(start: Pose, piece: Piece) -> Pose:
    length, k0, k1 = piece.known_length, piece.curvature_start, piece.curvature_end
    if k0 == k1 == 0.0:
        return start.moved(length, 0.0)
    if k0 == k1:
        angle = k0 * length
        return start.moved(math.sin(angle) / k0, (1.0 - math.cos(angle)) / k0).turned(angle)
    forward, left = _clothoid(length, k0, k1)
    return start.moved(forward, left).turned(0.5 * (k0 + k1) * length)


def _clothoid(length: float, k0: float, k1: float) -> tuple[float, float]:
    """End of a clothoid in its own start frame (m), by Simpson's rule (error below 1e-9 m at road sizes)."""
    step = length / SIMPSON_STEPS
    forward, left = 0.0, 0.0
    for i in range(SIMPSON_STEPS + 1):
        s = i * step
        angle = k0 * s + 0.5 * (k1 - k0) * s * s / length
        weight = 1.0 if i in {0, SIMPSON_STEPS} else 4.0 if i % 2 else 2.0
        forward += weight * math.cos(angle)
        left += weight * math.sin(angle)
    return forward * step / 3.0, left * step / 3.0


def fitted(start: Pose, path: Path, goal: Pose) -> Path:
    """The path with its two open straights given the lengths that let it end at `goal`.

    Raises:
        ValueError: Not two straights are open, the headings differ at the goal, or a length is not positive.
    """
    free = [i for i, piece in enumerate(path) if piece.length is None]
    end = end_of(start, path)
    if len(free) != 2:
        raise ValueError(f"two straights must be open, not {len(free)}")
    if abs(math.remainder(end.heading - goal.heading, math.tau)) > 1e-7:
        raise ValueError("the path arrives with another heading than the goal's")
    first, second = (end_of(start, path[:i]).heading for i in free)
    dx, dy = goal.x - end.x, goal.y - end.y
    determinant = math.sin(second - first)
    lengths = (
        (dx * math.sin(second) - dy * math.cos(second)) / determinant,
        (dy * math.cos(first) - dx * math.sin(first)) / determinant,
    )
    if min(lengths) <= 0.0:
        raise ValueError(f"the open straights would be {lengths[0]:.1f} m and {lengths[1]:.1f} m long")
    pieces = list(path)
    for i, length in zip(free, lengths, strict=True):
        pieces[i] = replace(path[i], length=round(length, LENGTH_DECIMALS))
    return tuple(pieces)


def arriving(start: Pose, path: Path, goal: Pose) -> Path:
    """The path with a straight behind it that ends at `goal`.

    Raises:
        ValueError: The goal does not lie straight ahead of the path's end.
    """
    end = end_of(start, path)
    dx, dy = goal.x - end.x, goal.y - end.y
    ahead = dx * math.cos(end.heading) + dy * math.sin(end.heading)
    aside = dy * math.cos(end.heading) - dx * math.sin(end.heading)
    turn = math.remainder(goal.heading - end.heading, math.tau)
    if ahead <= 0.0 or abs(aside) > 1e-4 or abs(turn) > 1e-7:
        raise ValueError(f"the goal lies {ahead:.1f} m ahead and {aside:.4f} m aside, turned by {turn:.6f} rad")
    return path + straight(ahead)


def corner(start: Pose, goal: Pose) -> Path:
    """Straight, arc, straight (those that are needed) from pose to pose, with the widest arc that fits."""
    turn = math.remainder(goal.heading - start.heading, math.tau)
    dx, dy = goal.x - start.x, goal.y - start.y
    if abs(turn) < 1e-7:
        return straight(math.hypot(dx, dy))
    before = (dx * math.sin(goal.heading) - dy * math.cos(goal.heading)) / math.sin(turn)
    after = (dy * math.cos(start.heading) - dx * math.sin(start.heading)) / math.sin(turn)
    tangent = min(before, after)
    arc = bend(math.degrees(turn), tangent / math.tan(0.5 * abs(turn)))
    legs = (straight(before - tangent), arc, straight(after - tangent))
    return tuple(piece for leg in legs for piece in leg if piece.known_length > 1e-6)
