"""Motorways with entries and exits, for fits of a detector's confidence.

`tools/training_roads.py` writes them. Where a ramp joins or leaves a motorway is a junction, as a crossing is, but the
lines of its lanes go on.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from training_roads import DASHES, WIDTHS

from maps.paths import Path as Line
from maps.paths import Pose, bend, end_of, start_of, straight
from maps.roads import Junction, Lane, Mark, Neighbour, Road, Section, opendrive

JUNCTIONS = 6
"""Number of junctions, in turn with a ramp that joins and one that leaves."""

LANES, WIDTH = (1, 2, 2, 3, 4), (3.0, 3.9)
"""Numbers of lanes in each direction, of which one is drawn, and their least and greatest width, m."""

SHOULDER, MARGIN, MEDIAN = (0.5, 3.0), (0.3, 1.5), (0.5, 3.0)
"""Least and greatest width of the shoulder, of the margin left of a single carriageway, and of the median between two,
m.
"""

TWO_CARRIAGEWAYS, WITH_WEAVING_LANE, WITH_EDGE = 0.4, 0.5, 0.9
"""Probabilities that the road has both directions, that a lane leads from a ramp that joins to the next that leaves,
and that there are lines at the edges.
"""

RADIUS, ANGLE, BEFORE = (80.0, 600.0), (8.0, 35.0), (20.0, 60.0)
"""Least and greatest radius of a bend, m, on a logarithmic scale, its angle, degrees, and the straights before and
after it, m.
"""

THROUGH, APART, RAMP_RADIUS, RAMP = (30.0, 70.0), (5.0, 14.0), (60.0, 250.0), 60.0
"""Least and greatest length of a junction, m, and of the angle at which a ramp leaves, degrees, radius of the ramp
behind it, m, and the ramp's length, m.
"""

SEED, SPEED = 78, 110.0

RAMPS, JOINS, CONNECTED, MET = 20, 40, 60, 100
"""What is added to the number of a junction for the ids of its ramp, of the ramp's and of the motorway's connecting
road, and its own.
"""


class _Paint(NamedTuple):
    """The lines: between lanes, at the edges, and between the motorway and a ramp or the lane that leads to one."""

    between: Mark
    edge: Mark | None
    beside_ramp: Mark | None


def motorway(target: Path, seed: int) -> None:
    """Write a road file with a motorway that `JUNCTIONS` ramps join and leave."""
    draw = np.random.default_rng([SEED, seed])
    paint = _paint(draw)
    lanes, width, shoulder = int(draw.choice(LANES)), float(draw.uniform(*WIDTH)), float(draw.uniform(*SHOULDER))
    left = _left(draw, lanes, width, shoulder, paint)
    plain = _carriageway(lanes, width, paint, paint.edge, (), shoulder)
    weaving = bool(draw.random() < WITH_WEAVING_LANE)
    more = (Lane("ramp_lane", "driving", width, paint.edge),)
    between = _carriageway(lanes, width, paint, paint.beside_ramp, more, shoulder) if weaving else plain
    through = _carriageway(lanes, width, paint, paint.beside_ramp, (), shoulder)
    roads: list[Road] = []
    pose, junctions = Pose(0.0, 0.0, 0.0), []
    for number in range(JUNCTIONS + 1):
        before = Neighbour(MET + number - 1) if number else None
        after = Neighbour(MET + number) if number < JUNCTIONS else None
        right, line = (between if number % 2 else plain), _bend(draw, 1.0 if number % 2 == 0 else -1.0)
        sections = (Section(right, left, paint.edge),)
        roads.append(_road(1 + number, "motorway", pose, line, sections, before, after))
        pose = end_of(pose, line)
        if after is None:
            break
        length, joins = round(float(draw.uniform(*THROUGH)), 3), number % 2 == 0
        ends = Neighbour(1 + number, "end"), Neighbour(2 + number, "start")
        sections = (Section(through, left, paint.edge),)
        roads.append(_road(CONNECTED + number, "through", pose, straight(length), sections, *ends, junction=after.id))
        begin, pose = pose, pose.moved(length, 0.0)
        outer = lanes + 1 if weaving else lanes
        meeting = (pose if joins else begin).moved(0.0, (1 - outer) * width)
        roads += _ramp(draw, number, joins, meeting, -outer, length, width, paint)
        junctions.append(Junction(after.id, "entry" if joins else "exit"))
    target.write_bytes(opendrive(target.stem, roads, junctions))


def _paint(draw: np.random.Generator) -> _Paint:
    dash, gap = DASHES[int(draw.integers(len(DASHES)))]
    thin, wide = float(draw.choice(WIDTHS)), float(draw.choice(WIDTHS))
    edge = Mark("solid", wide) if draw.random() < WITH_EDGE else None
    beside = (Mark("broken", wide, dash / 2.0, dash / 2.0), Mark("solid", wide), None)
    return _Paint(Mark("broken", thin, dash, gap), edge, beside[int(draw.choice(3, p=(0.6, 0.2, 0.2)))])


def _left(draw: np.random.Generator, lanes: int, width: float, shoulder: float, paint: _Paint) -> tuple[Lane, ...]:
    """Return what lies left of a carriageway."""
    if draw.random() >= TWO_CARRIAGEWAYS:
        return (Lane("margin", "shoulder", float(draw.uniform(*MARGIN))),)
    median = Lane("median", "median", float(draw.uniform(*MEDIAN)), paint.edge)
    towards = (Lane(f"back_{k}", "driving", width, paint.between) for k in range(1, lanes))
    return (median, *towards, Lane(f"back_{lanes}", "driving", width, paint.edge), Lane("far", "shoulder", shoulder))


def _carriageway(
    lanes: int, width: float, paint: _Paint, outer: Mark | None, more: tuple[Lane, ...], shoulder: float
) -> tuple[Lane, ...]:
    """Return the lanes of a carriageway, with the line right of them and the lanes between it and the shoulder."""
    inner = (Lane(f"lane_{k}", "driving", width, paint.between) for k in range(1, lanes))
    return (*inner, Lane(f"lane_{lanes}", "driving", width, outer), *more, Lane("shoulder", "shoulder", shoulder))


def _bend(draw: np.random.Generator, side: float) -> Line:
    """Return a bend to one side, positive to the left, between two straights.

    It leads to the left where there are ramps, and so away from them.
    """
    radius = math.exp(float(draw.uniform(*np.log(RADIUS))))
    angle = float(draw.uniform(*ANGLE))
    spiral = round(0.4 * math.radians(angle) * radius, 3)
    ends = (straight(float(draw.uniform(*BEFORE))) for _ in range(2))
    return (*next(ends), *bend(side * angle, radius, spiral), *next(ends))


def _ramp(
    draw: np.random.Generator,
    number: int,
    joins: bool,
    meeting: Pose,
    outer: int,
    length: float,
    width: float,
    paint: _Paint,
) -> list[Road]:
    """Return a ramp and its connecting road.

    Args:
        draw: Source of the random numbers.
        number: Number of the junction.
        joins: Whether it joins the motorway.
        meeting: Where the inner border of its lane is when it meets the motorway.
        outer: Id of the motorway's lane that it meets.
        length: Length of the connecting road, m.
        width: Width of its lane, m.
        paint: The lines.
    """
    angle, radius = float(draw.uniform(*APART)), float(draw.uniform(*RAMP_RADIUS))
    beside, behind = bend(-angle, length / math.radians(angle)), bend(-math.degrees(RAMP / radius), radius)
    lane = Lane("ramp", "driving", width, paint.edge)
    met = replace(lane, after=outer) if joins else replace(lane, before=outer)
    verge, junction = Lane("verge", "shoulder", 1.0), Neighbour(MET + number)
    of_ramp, of_joint = (Section((lane, verge), (), paint.edge),), (Section((met, verge)),)
    ramp, joint = RAMPS + number, JOINS + number
    if joins:
        start = start_of(meeting, beside)
        return [
            _road(ramp, "ramp", start_of(start, behind), behind, of_ramp, None, junction),
            _road(joint, "joint", start, beside, of_joint, Neighbour(ramp, "end"), Neighbour(2 + number, "start"),
                  junction.id),
        ]  # fmt: skip
    return [
        _road(joint, "joint", meeting, beside, of_joint, Neighbour(1 + number, "end"), Neighbour(ramp, "start"),
              junction.id),
        _road(ramp, "ramp", end_of(meeting, beside), behind, of_ramp, junction, None),
    ]  # fmt: skip


def _road(
    number: int,
    name: str,
    start: Pose,
    line: Line,
    sections: tuple[Section, ...],
    before: Neighbour | None,
    after: Neighbour | None,
    junction: int = -1,
) -> Road:
    return Road(
        number,
        f"{name}_{number}",
        "motorway",
        SPEED,
        start,
        line,
        sections,
        predecessor=before,
        successor=after,
        junction=junction,
    )
