"""Intersections at grade: a connecting road for every movement from one arm to another."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from maps.paths import Pose, corner, length_of
from maps.roads import Junction, Lane, Mark, Neighbour, Road, Section

STRAIGHT_ON = math.radians(30.0)


@dataclass(frozen=True)
class Arm:
    """The end of a road at an intersection: road id and its contact, "start" or "end"."""

    road: int
    contact: str


@dataclass(frozen=True)
class Intersection:
    """A junction of arms; `edge` is painted along its kerbs, `through` as centre line by its uncut kerb."""

    junction: Junction
    arms: tuple[Arm, ...]
    first_road: int
    kind: str
    speed: float
    edge: Mark | None = None
    through: Mark | None = None


@dataclass(frozen=True)
class _Slot:
    """A lane as traffic meets it at an arm: id, width (m), distance (m) of its inner border off centre."""

    id: int
    lane: Lane
    width: float
    inner: float


@dataclass(frozen=True)
class _Side:
    """One direction of travel at an arm: pose on the reference line, lanes from the centre outwards."""

    arm: Arm
    pose: Pose
    slots: tuple[_Slot, ...]

    @property
    def driving(self) -> tuple[_Slot, ...]:
        return tuple(slot for slot in self.slots if slot.lane.kind == "driving")


def connecting_roads(crossing: Intersection, roads: Mapping[int, Road]) -> list[Road]:
    """The intersection's connecting roads: straight on, left and right from every arm, with their lane links.

    From several lanes the innermost turns left, the outermost turns right, and all go straight on. The
    movement to the next arm on the right runs along the kerb and carries the lanes outside of it too.
    """
    made: list[Road] = []
    entries = [_side(arm, roads[arm.road], entering=True) for arm in crossing.arms]
    exits = [_side(arm, roads[arm.road], entering=False) for arm in crossing.arms]
    for entry in entries:
        kerb_arm = _next_on_the_right(entry, exits)
        for leave in exits:
            if leave.arm == entry.arm or not entry.driving or not leave.driving:
                continue
            made.append(_movement(crossing, crossing.first_road + len(made), entry, leave, leave.arm == kerb_arm))
    return made


def _side(arm: Arm, road: Road, entering: bool) -> _Side:
    along = (arm.contact == "end") == entering
    pose = road.start if arm.contact == "start" else road.end
    lanes = road.section_at(arm.contact).lanes()
    ids = sorted((n for n in lanes if (n < 0) == along), key=abs)
    slots, inner = [], 0.0
    for number in ids:
        width = lanes[number].widths[0 if arm.contact == "start" else 1]
        slots.append(_Slot(number, lanes[number], width, inner))
        inner += width
    return _Side(arm, pose if along else pose.turned(math.pi), tuple(slots))


def _turn(entry: _Side, leave: _Side) -> float:
    return math.remainder(leave.pose.heading - entry.pose.heading, math.tau)


def _next_on_the_right(entry: _Side, exits: Sequence[_Side]) -> Arm:
    others = [leave for leave in exits if leave.arm != entry.arm]
    return min(others, key=lambda leave: _turn(entry, leave)).arm


def _movement(crossing: Intersection, number: int, entry: _Side, leave: _Side, kerb: bool) -> Road:
    turn = _turn(entry, leave)
    pairs = _pairs(entry.driving, leave.driving, turn)
    if kerb:
        pairs += list(zip(_outside(entry), _outside(leave), strict=False))
    start = entry.pose.moved(0.0, -pairs[0][0].inner)
    path = corner(start, leave.pose.moved(0.0, -pairs[0][1].inner))
    lanes = []
    for here, there in pairs:
        outermost_driving = kerb and here == entry.driving[-1]
        mark = crossing.edge if outermost_driving else None
        width = here.width if here.width == there.width else (here.width, there.width)
        lanes.append(Lane(here.lane.name, here.lane.kind, width, mark, here.id, there.id))
    uncut = kerb and abs(turn) < STRAIGHT_ON
    word = "straight" if abs(turn) < STRAIGHT_ON else "left" if turn > 0.0 else "right"
    return Road(
        number,
        f"{crossing.junction.name}_{entry.arm.road}_{word}_{leave.arm.road}",
        crossing.kind,
        crossing.speed,
        start,
        path,
        (Section(tuple(lanes), centre=crossing.through if uncut else None, length=length_of(path)),),
        predecessor=Neighbour(entry.arm.road, entry.arm.contact),
        successor=Neighbour(leave.arm.road, leave.arm.contact),
        junction=crossing.junction.id,
    )


def _pairs(entry: Sequence[_Slot], leave: Sequence[_Slot], turn: float) -> list[tuple[_Slot, _Slot]]:
    if abs(turn) < STRAIGHT_ON:
        return list(zip(entry, leave, strict=False))
    index = 0 if turn > 0.0 else -1
    return [(entry[index], leave[index])]


def _outside(side: _Side) -> list[_Slot]:
    return list(side.slots[side.slots.index(side.driving[-1]) + 1 :])
