"""Builds motorway.xodr: a closed carriageway of three lanes, driven clockwise, with two straights of 3 km.

`python maps/motorway/build.py [FILE]` rewrites the map (or writes FILE), always the same bytes.
Marks are European (after the German guideline RMS): lines of 0.15 m, edge lines of 0.30 m, dashes of 6 m with gaps of
12 m.
"""

from __future__ import annotations

import sys
from pathlib import Path as File

sys.path.insert(0, str(File(__file__).resolve().parents[2]))

from maps.paths import Pose, bend, end_of, straight
from maps.roads import Lane, Mark, Neighbour, Road, Section, opendrive

SPEED = 130.0
STRAIGHT, RADIUS, SPIRAL = 3000.0, 800.0, 250.0
LANE_WIDTH = 3.75

LANE_LINE = Mark("broken", 0.15, 6.0, 12.0)
EDGE_LINE = Mark("solid", 0.30)
LANES = (
    Lane("left_lane", "driving", LANE_WIDTH, LANE_LINE),
    Lane("middle_lane", "driving", LANE_WIDTH, LANE_LINE),
    Lane("right_lane", "driving", LANE_WIDTH, EDGE_LINE),
    Lane("shoulder", "shoulder", 3.0),
)
CARRIAGEWAY = (Section(LANES, (Lane("margin", "shoulder", 1.0),), EDGE_LINE),)


def build() -> bytes:
    """The map as an OpenDRIVE document: straight, half circle, straight, half circle, each a road of its own."""
    names = ("north_straight", "east_curve", "south_straight", "west_curve")
    paths = (straight(STRAIGHT), bend(-180.0, RADIUS, SPIRAL)) * 2
    pose, roads = Pose(0.0, 0.0, 0.0), []
    for index, (name, path) in enumerate(zip(names, paths, strict=True)):
        before, after = Neighbour((index - 1) % 4 + 1, "end"), Neighbour((index + 1) % 4 + 1, "start")
        roads.append(
            Road(index + 1, name, "motorway", SPEED, pose, path, CARRIAGEWAY, predecessor=before, successor=after)
        )
        pose = end_of(pose, path)
    return opendrive("motorway", roads, [])


if __name__ == "__main__":
    target = File(sys.argv[1]) if len(sys.argv) > 1 else File(__file__).with_name("motorway.xodr")
    target.write_bytes(build())
