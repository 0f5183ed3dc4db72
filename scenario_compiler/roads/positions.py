"""The results of queries of a network: poses, lane positions, routes, descriptions of lanes and marks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Pose(NamedTuple):
    """A point on the road surface with the orientation of the surface there.

    OpenDRIVE axes: metres; heading counterclockwise from +x in [0, 2 pi), pitch positive nose down, roll positive left
    side up, radians.
    """

    x: float
    y: float
    z: float
    heading: float
    pitch: float
    roll: float


class LanePosition(NamedTuple):
    """A point on a lane; offset is in m from the lane's centre, positive to the left as seen along increasing s."""

    road: str
    lane: int
    s: float
    offset: float = 0.0


class Located(NamedTuple):
    """The result of `Network.locate_many`: columns over all found (point, lane) pairs.

    They are ordered by point, nearest lane centre first.

    Attributes:
        start: Row starts by point, (points + 1,).
        road: Road index.
        lane: Lane id.
        s: m.
        offset: From the lane's centre, m.
    """

    start: NDArray[np.int64]
    road: NDArray[np.int64]
    lane: NDArray[np.int64]
    s: NDArray[np.float64]
    offset: NDArray[np.float64]


class LaneAt(NamedTuple):
    """A lane at one s: its borders are t in m, left and right as seen along s."""

    lane: int
    type: str
    t_left: float
    t_right: float


class Mark(NamedTuple):
    """A road mark at one s: words of the standard, width in m, quality from 0 (gone) to 1 (new)."""

    type: str
    colour: str
    width: float
    quality: float
    lane_change: str


class MarkStretch(NamedTuple):
    """A change of marks from s_from to s_to, m: the quality (0 to 1), linear between two values, and the colour.

    A lane's mark lies on its outer border; lane 0 is the centre line, None stands for every mark of the road. A quality
    or colour of None is not changed; colours are spelled as in `marks.MARK_COLOURS`.
    """

    road: str
    lane: int | None
    s_from: float
    s_to: float
    quality_from: float | None
    quality_to: float | None
    colour: str | None = None


class SecondaryLine(NamedTuple):
    """A line painted beside the marks of the map.

    It lies from s_from to s_to, m, with its centre at t, m to the left of the reference line. The colour is spelled as
    in `marks.MARK_COLOURS`; the width is in m, the quality from 1 (new) to 0 (gone).
    """

    road: str
    s_from: float
    s_to: float
    t: float
    colour: str
    broken: bool
    width: float
    quality: float


class Leg(NamedTuple):
    """A part of a route: one lane of one road from s to s.

    `changes_lane` tells whether it is entered from the neighbouring lane.
    """

    road: str
    lane: int
    s_from: float
    s_to: float
    changes_lane: bool


@dataclass(frozen=True, slots=True)
class Route:
    """The route from one lane position to another: legs in order of travel.

    Attributes:
        legs: Legs; each but the first starts at the end of the previous one, or beside it.
        length: Distance to travel, m.
        lane_changes: Number of lane changes.
    """

    legs: tuple[Leg, ...]
    length: float
    lane_changes: int


@dataclass(frozen=True, slots=True)
class RoadDescription:
    """A road: its place in the network and its lane sections.

    Attributes:
        id: As in the file.
        length: m.
        rule: "RHT" or "LHT".
        junction: Id of its junction, or None.
        predecessor: ("road" or "junction", id), or None.
        successor: Likewise at the end.
        sections: (s, lane ids from left to right, including the centre lane 0) of each lane section.
        type: Road type at s = 0, "unknown" if the file gives none.
    """

    id: str
    length: float
    rule: str
    junction: str | None
    predecessor: tuple[str, str] | None
    successor: tuple[str, str] | None
    sections: tuple[tuple[float, tuple[int, ...]], ...]
    type: str
