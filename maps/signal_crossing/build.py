"""Builds signal_crossing.xodr: a crossing of four arms with traffic lights, whose arms lead back to it in two loops.

`python maps/signal_crossing/build.py [FILE]` rewrites the map (or writes FILE), always the same bytes.
Marks are European (after the German guideline RMS): lines of 0.15 m, dashes of 3 m with gaps of 6 m.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path as File

sys.path.insert(0, str(File(__file__).resolve().parents[2]))

from maps.intersections import Arm, Intersection, connecting_roads
from maps.paths import Pose, bend, fitted, straight
from maps.roads import Controller, Junction, Lane, Mark, Neighbour, Road, Section, Signal, opendrive

SPEED, TURN_SPEED = 50.0, 30.0
SETBACK = 12.0
ARM = 180.0
RADIUS, SPIRAL = 30.0, 10.0
LIGHT_BEFORE = 1.0

EDGE = Mark("solid", 0.15)
DASHED = Mark("broken", 0.15, 3.0, 6.0)
SIDE = (Lane("lane_1", "driving", 3.5, EDGE), Lane("gutter", "shoulder", 0.5), Lane("pavement", "sidewalk", 2.0))
STREET = (Section(SIDE, SIDE, DASHED),)
BESIDE = 5.0
"""How far from the middle of the street a light stands, m."""

CROSSING = 100


def loop(number: int, name: str, leaves: float, arrives: float) -> Road:
    """A street from one arm of the crossing round three left turns to the arm on its left; headings in degrees."""
    start = Pose(0.0, 0.0, math.radians(leaves)).moved(SETBACK, 0.0)
    goal = Pose(0.0, 0.0, math.radians(arrives)).moved(-SETBACK, 0.0)
    turn = bend(90.0, RADIUS, SPIRAL)
    path = fitted(start, straight(ARM) + turn + straight() + turn + straight() + turn + straight(ARM), goal)
    length = sum(piece.known_length for piece in path)
    lights = (
        Signal(f"{number}1", LIGHT_BEFORE, BESIDE, "-", (1, 1)),
        Signal(f"{number}2", round(length - LIGHT_BEFORE, 6), -BESIDE, "+", (-1, -1)),
    )
    ends = Neighbour(CROSSING)
    return Road(number, name, "town", SPEED, start, path, STREET, predecessor=ends, successor=ends, signals=lights)


def build() -> bytes:
    """The map as an OpenDRIVE document."""
    roads = [loop(1, "north_east_loop", 0.0, 270.0), loop(2, "south_west_loop", 180.0, 90.0)]
    by_id = {made.id: made for made in roads}
    arms = tuple(Arm(road, contact) for road in by_id for contact in ("start", "end"))
    crossing = Intersection(Junction(CROSSING, "crossing"), arms, 1001, "town", TURN_SPEED, EDGE)
    roads += connecting_roads(crossing, by_id)
    controllers = (Controller("1", "east_west", ("11", "21")), Controller("2", "north_south", ("12", "22")))
    return opendrive("signal_crossing", roads, [crossing.junction], controllers)


if __name__ == "__main__":
    target = File(sys.argv[1]) if len(sys.argv) > 1 else File(__file__).with_name("signal_crossing.xodr")
    target.write_bytes(build())
