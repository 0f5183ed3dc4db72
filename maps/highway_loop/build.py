"""Builds highway_loop.xodr: a closed motorway, clockwise, joined by ramps to a two-way road inside it.

`python maps/highway_loop/build.py [FILE]` rewrites the map (or writes FILE), always the same bytes.
Marks are European (after the German guideline RMS): lines of 0.15 m, wide lines of 0.30 m; dashes of 6 m with
gaps of 12 m on the motorway, of 6 m beside an acceleration lane; 4 m and 8 m on the track.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path as File

sys.path.insert(0, str(File(__file__).resolve().parents[2]))

from maps.intersections import Arm, Intersection, connecting_roads
from maps.paths import Path, Pose, bend, end_of, fitted, start_of, straight
from maps.roads import Junction, Lane, Mark, Neighbour, Road, Section, Wear, opendrive

# --- What the map is

MOTORWAY_SPEED, RAMP_SPEED, TRACK_SPEED = 130.0, 60.0, 80.0

LANE_LINE = Mark("broken", 0.15, 6.0, 12.0)
EDGE_LINE = Mark("solid", 0.30)
RAMP_DIVIDER_SOLID = Mark("solid", 0.30)
RAMP_DIVIDER_BROKEN = Mark("broken", 0.30, 6.0, 6.0)
TRACK_EDGE = Mark("solid", 0.15)
TRACK_CENTRE = Mark("broken", 0.15, 4.0, 8.0)

LANE_WIDTH, SHOULDER_WIDTH, TRACK_WIDTH = 3.75, 2.5, 3.5
RAMP_SHOULDER, RAMP_MARGIN = 1.5, 0.5

MARGIN = Lane("margin", "shoulder", 1.0)
SHOULDER = Lane("shoulder", "shoulder", SHOULDER_WIDTH)
LEFT_LANE = Lane("left_lane", "driving", LANE_WIDTH, LANE_LINE)
RIGHT_LANE = Lane("right_lane", "driving", LANE_WIDTH, EDGE_LINE)


def right_lane(divider: Mark) -> Lane:
    """The right lane beside a ramp lane: `divider` is between the two."""
    return Lane("right_lane", "driving", LANE_WIDTH, divider)


def ramp_lane(width: float | tuple[float, float]) -> Lane:
    """A ramp's lane, and the acceleration or deceleration lane that it becomes on the motorway."""
    return Lane("ramp_lane", "driving", width, EDGE_LINE)


PLAIN = Section((LEFT_LANE, RIGHT_LANE, SHOULDER), (MARGIN,), EDGE_LINE)


def beside_ramp_lane(divider: Mark, width: float | tuple[float, float], length: float | None) -> Section:
    """A motorway section with a third, acceleration or deceleration lane."""
    return Section((LEFT_LANE, right_lane(divider), ramp_lane(width), SHOULDER), (MARGIN,), EDGE_LINE, length)


ENTRY_SECTIONS = (
    beside_ramp_lane(RAMP_DIVIDER_SOLID, LANE_WIDTH, 54.0),
    beside_ramp_lane(RAMP_DIVIDER_BROKEN, LANE_WIDTH, 204.0),
    beside_ramp_lane(RAMP_DIVIDER_BROKEN, (LANE_WIDTH, 0.0), 54.0),
    PLAIN,
)
EXIT_SECTIONS = (
    Section(PLAIN.right, PLAIN.left, PLAIN.centre, 126.0),
    beside_ramp_lane(RAMP_DIVIDER_BROKEN, (0.0, LANE_WIDTH), 54.0),
    beside_ramp_lane(RAMP_DIVIDER_BROKEN, LANE_WIDTH, None),
)
MERGE_THROUGH = (
    Section((LEFT_LANE, RIGHT_LANE, Lane("shoulder", "shoulder", (SHOULDER_WIDTH, 0.0))), (MARGIN,), EDGE_LINE),
)
DIVERGE_THROUGH = (
    Section((LEFT_LANE, RIGHT_LANE, Lane("shoulder", "shoulder", (0.0, SHOULDER_WIDTH))), (MARGIN,), EDGE_LINE),
)


def ramp(shoulder: float | tuple[float, float], margin: float | tuple[float, float]) -> tuple[Section, ...]:
    """A ramp of one lane with its shoulder on the right and a margin on the left."""
    right = (ramp_lane(LANE_WIDTH), Lane("shoulder", "shoulder", shoulder))
    return (Section(right, (Lane("ramp_margin", "shoulder", margin),), EDGE_LINE),)


RAMP = ramp(RAMP_SHOULDER, RAMP_MARGIN)
MERGE_RAMP = ramp((RAMP_SHOULDER, SHOULDER_WIDTH), (RAMP_MARGIN, 0.0))
DIVERGE_RAMP = ramp((SHOULDER_WIDTH, RAMP_SHOULDER), (0.0, RAMP_MARGIN))
RURAL = (
    Section(
        (Lane("forward", "driving", TRACK_WIDTH, TRACK_EDGE), Lane("verge_right", "shoulder", 1.0)),
        (Lane("backward", "driving", TRACK_WIDTH, TRACK_EDGE), Lane("verge_left", "shoulder", 1.0)),
        TRACK_CENTRE,
    ),
)

GONE, COVERED_PERIOD, COVERED_LENGTH = 0.0, 36.0, 18.0
GROWING_WEAR = (Wear(72.0, 198.0, 0.6), Wear(198.0, 324.0, 0.4), Wear(324.0, 450.0, 0.2))
PARTLY_COVERED = tuple(Wear(s, s + COVERED_LENGTH, GONE) for s in (54.0 + COVERED_PERIOD * i for i in range(12)))
MISSING = (Wear(72.0, 450.0, GONE),)
WORN_TRACK = (Wear(120.0, 720.0, 0.3),)

MERGE, DIVERGE = Junction(101, "merge"), Junction(102, "diverge")
ENTRY, EXIT = Junction(103, "entry_intersection"), Junction(104, "exit_intersection")


@dataclass(frozen=True)
class Part:
    """A road of one of the two loops: its reference line, sections, wear, and junction if it is in one."""

    id: int
    name: str
    path: Path
    sections: tuple[Section, ...] = (PLAIN,)
    wear: tuple[Wear, ...] = ()
    junction: int = -1


# In the order of travel, clockwise; the two open straights close the loop.
MOTORWAY_START = Pose(0.0, 0.0, 0.0)
WINDING = bend(10.0, 900.0, 60.0) + bend(-20.0, 900.0, 60.0) + bend(10.0, 900.0, 60.0)
MOTORWAY = (
    Part(1, "north_straight", straight(1008.0)),
    Part(2, "north_east_curve", bend(-90.0, 400.0, 150.0)),
    Part(3, "east_worn", straight(522.0), wear=GROWING_WEAR),
    Part(4, "east_covered", straight(522.0), wear=PARTLY_COVERED),
    Part(5, "east_missing", straight(522.0), wear=MISSING),
    Part(6, "south_east_curve", bend(-90.0, 500.0, 160.0)),
    Part(7, "south_winding", WINDING + straight()),
    Part(8, "south_west_curve", bend(-90.0, 350.0, 140.0)),
    Part(9, "west_approach", straight(450.0)),
    Part(10, "merge_through", straight(72.0), MERGE_THROUGH, junction=MERGE.id),
    Part(11, "west_entry", straight(450.0), ENTRY_SECTIONS),
    Part(12, "west_exit", straight(378.0), EXIT_SECTIONS),
    Part(13, "diverge_through", straight(72.0), DIVERGE_THROUGH, junction=DIVERGE.id),
    Part(14, "west_end", straight()),
    Part(15, "north_west_curve", bend(-90.0, 450.0, 150.0)),
)

# Clockwise too, from the entry ramp's intersection; parts without sections are the room of an intersection.
TRACK_START = Pose(-300.0, -1890.0, math.pi / 2.0)
TRACK_WINDING = bend(25.0, 250.0, 60.0) + bend(-50.0, 250.0, 60.0) + bend(25.0, 250.0, 60.0)
TRACK = (
    Part(21, "track_west", straight(1250.0), RURAL),
    Part(0, "at_exit_ramp", straight(20.0), (), junction=EXIT.id),
    Part(
        22,
        "track_north",
        straight(40.0) + bend(-90.0, 150.0, 60.0) + straight() + bend(-90.0, 180.0, 60.0),
        RURAL,
    ),
    Part(23, "track_east", straight(150.0) + TRACK_WINDING + straight(600.0), RURAL),
    Part(24, "track_south", bend(-90.0, 200.0, 60.0) + straight(900.0), RURAL, WORN_TRACK),
    Part(25, "track_south_west", straight(100.0) + bend(-90.0, 150.0, 60.0) + straight(), RURAL),
    Part(0, "at_entry_ramp", straight(20.0), (), junction=ENTRY.id),
)

# The ramps leave and reach the track at right angles and the motorway at RAMP_ANGLE (degrees).
RAMP_ANGLE, SETBACK = 5.0, 10.0
RAMP_LINE = straight() + bend(RAMP_ANGLE - 90.0, 60.0, 30.0) + straight()
NOSE_RADIUS = 825.0

INTERSECTIONS = (
    Intersection(
        ENTRY,
        (Arm(25, "end"), Arm(21, "start"), Arm(31, "start")),
        41,
        "rural",
        TRACK_SPEED,
        TRACK_EDGE,
        TRACK_CENTRE,
    ),
    Intersection(
        EXIT,
        (Arm(21, "end"), Arm(22, "start"), Arm(32, "end")),
        51,
        "rural",
        TRACK_SPEED,
        TRACK_EDGE,
        TRACK_CENTRE,
    ),
)

# --- How it is built


def closed(start: Pose, parts: Sequence[Part]) -> list[Part]:
    """The parts with their open straights given the lengths that bring the loop back to its start."""
    pieces = iter(fitted(start, tuple(piece for part in parts for piece in part.path), start))
    return [replace(part, path=tuple(next(pieces) for _ in part.path)) for part in parts]


def loop(start: Pose, parts: Sequence[Part], kind: str, speed: float) -> list[Road]:
    """The roads of a closed loop of parts of known length, joined to their neighbours or a junction."""
    roads, pose = [], start
    for index, part in enumerate(parts):
        before, after = parts[index - 1], parts[(index + 1) % len(parts)]
        if part.sections:
            roads.append(
                Road(
                    part.id,
                    part.name,
                    kind,
                    speed,
                    pose,
                    part.path,
                    part.sections,
                    part.wear,
                    neighbour(part, before, "end"),
                    neighbour(part, after, "start"),
                    part.junction,
                )
            )
        pose = end_of(pose, part.path)
    return roads


def neighbour(part: Part, other: Part, contact: str) -> Neighbour:
    """What `part` is joined to where it meets `other`: the road itself, or the junction that it is in."""
    if part.junction == -1 and other.junction != -1:
        return Neighbour(other.junction)
    return Neighbour(other.id, contact)


def ramps(roads: Mapping[int, Road]) -> list[Road]:
    """The two ramps and the connecting roads by which they join and leave the motorway."""
    nose = bend(-RAMP_ANGLE, NOSE_RADIUS)
    beside = -2.0 * LANE_WIDTH
    merged = roads[11].start.moved(0.0, beside)
    merging = start_of(merged, nose)
    entry_start = roads[21].start.moved(-SETBACK, SETBACK).turned(math.pi / 2.0)
    diverging = roads[12].end.moved(0.0, beside)
    exit_start = end_of(diverging, nose)
    exit_end = roads[21].end.moved(SETBACK, SETBACK).turned(-math.pi / 2.0)

    motorway = partial(Road, kind="motorway", speed=RAMP_SPEED)
    return [
        motorway(
            id=31,
            name="entry_ramp",
            start=entry_start,
            path=fitted(entry_start, RAMP_LINE, merging),
            sections=RAMP,
            predecessor=Neighbour(ENTRY.id),
            successor=Neighbour(MERGE.id),
        ),
        motorway(
            id=33,
            name="merge_ramp",
            start=merging,
            path=nose,
            sections=MERGE_RAMP,
            predecessor=Neighbour(31, "end"),
            successor=Neighbour(11, "start"),
            junction=MERGE.id,
        ),
        motorway(
            id=34,
            name="diverge_ramp",
            start=diverging,
            path=nose,
            sections=DIVERGE_RAMP,
            predecessor=Neighbour(12, "end"),
            successor=Neighbour(32, "start"),
            junction=DIVERGE.id,
        ),
        motorway(
            id=32,
            name="exit_ramp",
            start=exit_start,
            path=fitted(exit_start, RAMP_LINE, exit_end),
            sections=RAMP,
            predecessor=Neighbour(DIVERGE.id),
            successor=Neighbour(EXIT.id),
        ),
    ]


def build() -> bytes:
    """The map as an OpenDRIVE document."""
    roads = loop(MOTORWAY_START, closed(MOTORWAY_START, MOTORWAY), "motorway", MOTORWAY_SPEED)
    roads += loop(TRACK_START, closed(TRACK_START, TRACK), "rural", TRACK_SPEED)
    roads += ramps({road.id: road for road in roads})
    by_id = {road.id: road for road in roads}
    for crossing in INTERSECTIONS:
        roads += connecting_roads(crossing, by_id)
    return opendrive("highway_loop", roads, [MERGE, DIVERGE, ENTRY, EXIT])


if __name__ == "__main__":
    target = File(sys.argv[1]) if len(sys.argv) > 1 else File(__file__).with_name("highway_loop.xodr")
    target.write_bytes(build())
