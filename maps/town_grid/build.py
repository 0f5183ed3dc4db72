"""Builds town_grid.xodr: a ring road of two lanes a direction round a long main street and two cross streets.

`python maps/town_grid/build.py [FILE]` rewrites the map (or writes FILE), always the same bytes.
Marks are European (after the German guideline RMS): lines of 0.15 m, dashes of 3 m with gaps of 6 m.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path as File

sys.path.insert(0, str(File(__file__).resolve().parents[2]))

from maps.intersections import Arm, Intersection, connecting_roads
from maps.paths import Path, Pose, arriving, bend, fitted, straight
from maps.roads import Junction, Lane, Mark, Neighbour, Road, Section, opendrive

# --- What the map is

SPEED, TURN_SPEED = 50.0, 30.0

EDGE = Mark("solid", 0.15)
DASHED = Mark("broken", 0.15, 3.0, 6.0)
DIVIDER = Mark("solid", 0.15)


def street(lane_width: float, lanes: int = 1) -> tuple[Section, ...]:
    """A street with `lanes` lanes a direction, each `lane_width` metres wide, a gutter and a pavement."""
    inner = tuple(Lane(f"lane_{i + 1}", "driving", lane_width, DASHED) for i in range(lanes - 1))
    side = (
        *inner,
        Lane(f"lane_{lanes}", "driving", lane_width, EDGE),
        Lane("gutter", "shoulder", 0.5),
        Lane("pavement", "sidewalk", 2.0),
    )
    return (Section(side, side, DASHED if lanes == 1 else DIVIDER),)


NARROW, WIDE, RING = street(3.25), street(3.5), street(3.25, lanes=2)


@dataclass(frozen=True)
class Node:
    """An intersection: where it is (m), how far from it its streets end (m), and its junction id."""

    x: float
    y: float
    setback: float
    id: int


# West to east and south to north; the corners of the town are bends, not intersections.
NODES = {
    "south_west": Node(180.0, 0.0, 12.5, 101),
    "south_east": Node(660.0, 0.0, 12.5, 102),
    "west": Node(0.0, 170.0, 13.0, 103),
    "centre_west": Node(180.0, 170.0, 12.0, 104),
    "centre_east": Node(660.0, 170.0, 12.0, 105),
    "east": Node(840.0, 170.0, 13.0, 106),
    "north_west": Node(180.0, 350.0, 12.5, 107),
    "north_east": Node(660.0, 350.0, 12.5, 108),
}


@dataclass(frozen=True)
class Street:
    """A street from node to node: headings (degrees) at its start and end, and its line if not straight."""

    id: int
    name: str
    start: str
    end: str
    leaves: float
    arrives: float
    sections: tuple[Section, ...] = NARROW
    line: Path | None = None


EAST, NORTH, WEST = 0.0, 90.0, 180.0
WINDING = straight(60.0) + bend(20.0, 120.0, 25.0) + bend(-40.0, 120.0, 25.0) + bend(20.0, 120.0, 25.0)
ROUND_LEFT, ROUND_RIGHT = bend(90.0, 30.0, 10.0), bend(-90.0, 30.0, 10.0)

STREETS = (
    Street(1, "main_street", "centre_west", "centre_east", EAST, EAST, WIDE),
    Street(2, "main_street_west", "west", "centre_west", EAST, EAST, WIDE),
    Street(3, "main_street_east", "centre_east", "east", EAST, EAST, WIDE),
    Street(4, "church_street_south", "south_west", "centre_west", NORTH, NORTH),
    Street(5, "church_street_north", "centre_west", "north_west", NORTH, NORTH),
    Street(6, "school_street_south", "south_east", "centre_east", NORTH, NORTH),
    Street(7, "school_street_north", "centre_east", "north_east", NORTH, NORTH),
    Street(8, "ring_south", "south_west", "south_east", EAST, EAST, RING, WINDING),
    Street(9, "ring_north", "north_west", "north_east", EAST, EAST, RING),
    Street(10, "ring_south_west", "south_west", "west", WEST, NORTH, RING, ROUND_RIGHT),
    Street(11, "ring_north_west", "west", "north_west", NORTH, EAST, RING, ROUND_RIGHT),
    Street(12, "ring_south_east", "south_east", "east", EAST, NORTH, RING, ROUND_LEFT),
    Street(13, "ring_north_east", "east", "north_east", NORTH, WEST, RING, ROUND_LEFT),
)

# --- How it is built


def road(plan: Street) -> Road:
    """The road of a street, from the edge of its first intersection to the edge of its last."""
    first, last = NODES[plan.start], NODES[plan.end]
    start = Pose(first.x, first.y, math.radians(plan.leaves)).moved(first.setback, 0.0)
    goal = Pose(last.x, last.y, math.radians(plan.arrives)).moved(-last.setback, 0.0)
    return Road(
        plan.id,
        plan.name,
        "town",
        SPEED,
        start,
        line(plan, start, goal),
        plan.sections,
        predecessor=Neighbour(first.id),
        successor=Neighbour(last.id),
    )


def line(plan: Street, start: Pose, goal: Pose) -> Path:
    """The street's reference line between two poses.

    A corner has an open straight before and after its bend; any other line has one at its end.
    """
    if plan.leaves != plan.arrives and plan.line is not None:
        return fitted(start, straight() + plan.line + straight(), goal)
    return arriving(start, plan.line or (), goal)


def intersections() -> list[Intersection]:
    """The town's intersections, each with the ends of the streets that name it."""
    made = []
    for index, (name, node) in enumerate(NODES.items()):
        arms = tuple(
            Arm(plan.id, contact)
            for plan in STREETS
            for contact, at in (("start", plan.start), ("end", plan.end))
            if at == name
        )
        first_road = 1001 + 20 * index
        made.append(Intersection(Junction(node.id, name), arms, first_road, "town", TURN_SPEED, EDGE))
    return made


def build() -> bytes:
    """The map as an OpenDRIVE document."""
    roads = [road(plan) for plan in STREETS]
    by_id = {made.id: made for made in roads}
    crossings = intersections()
    for crossing in crossings:
        roads += connecting_roads(crossing, by_id)
    return opendrive("town_grid", roads, [crossing.junction for crossing in crossings])


if __name__ == "__main__":
    target = File(sys.argv[1]) if len(sys.argv) > 1 else File(__file__).with_name("town_grid.xodr")
    target.write_bytes(build())
