"""Main streets with crossings, for fits of a detector's confidence.

`tools/training_roads.py` writes them. Near a crossing a line ends, or goes on, within the stretch on which a boundary
is judged. Road files of towns have many crossings, and there are few such files.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from maps.intersections import Arm, Intersection, connecting_roads
from maps.paths import Pose, straight
from maps.roads import Junction, Lane, Mark, Neighbour, Road, Section, opendrive

CROSSINGS, ARM = 6, 90.0
"""Number of crossings of the main street, and the length of the streets that end at one, m."""

BETWEEN, SETBACK = (70.0, 140.0), (2.5, 6.0)
"""Least and greatest length of the main street between two crossings, and distance of a street's end from the kerb of
the wider street that it meets, m.
"""

SKEW = (math.radians(70.0), math.radians(110.0))
"""Least and greatest angle at which the streets meet, rad."""

LANES, WIDTH = (1, 1, 2, 2, 3), (2.9, 3.8)
"""Numbers of lanes in each direction, of which one is drawn, and their least and greatest width, m."""

WITH_EDGE, WITH_CENTRE, BROKEN_CENTRE, WITH_KERB_LINE, FOURTH_ARM = 0.65, 0.9, 0.6, 0.5, 0.6
"""Probabilities that a street has lines at its edges, that it has one in the middle, that this is broken on a street
of two lanes, that the line at the edge goes on round the corners of a crossing, and that a crossing has four arms.
"""

SOLID, BROKEN = Mark("solid", 0.15), Mark("broken", 0.15, 3.0, 6.0)

BESIDE: tuple[tuple[Lane, ...], ...] = (
    (),
    (Lane("gutter", "shoulder", 0.5), Lane("pavement", "sidewalk", 2.0)),
    (Lane("pavement", "sidewalk", 2.0),),
    (Lane("verge", "shoulder", 1.5),),
)
"""What lies beside a street's driving lanes, of which one is drawn."""

SEED, SPEED, TURN_SPEED = 77, 50.0, 30.0


def crossings(target: Path, seed: int) -> None:
    """Write a road file with a straight main street and `CROSSINGS` streets that cross it or end at it."""
    draw = np.random.default_rng([SEED, seed])
    main, reach = _street(draw)
    roads: list[Road] = []
    arms: list[list[Arm]] = []
    junctions, x = [], 0.0
    for number in range(CROSSINGS + 1):
        here, last = Neighbour(100 + number), number == CROSSINGS
        length = float(draw.uniform(*BETWEEN)) if number > 0 and not last else ARM
        before, after = (Neighbour(99 + number) if number else None), (None if last else here)
        roads.append(_road(1 + number, Pose(x, 0.0, 0.0), length, main, before, after))
        if number:
            arms[-1].append(Arm(1 + number, "start"))
        if last:
            break
        across, other = _street(draw)
        setback = max(reach, other) + float(draw.uniform(*SETBACK))
        middle, angle = x + length + setback, float(draw.uniform(*SKEW))
        arms.append([Arm(1 + number, "end")])
        for side in range(2 if draw.random() < FOURTH_ARM else 1):
            start = Pose(middle, 0.0, angle + side * math.pi).moved(setback, 0.0)
            arm = Arm(20 + 2 * number + side, "start")
            roads.append(_road(arm.road, start, ARM, across, here, None))
            arms[-1].append(arm)
        junctions.append(Junction(here.id, f"crossing_{number}"))
        x = middle + setback
    by_id = {road.id: road for road in roads}
    for junction, meeting in zip(junctions, arms, strict=True):
        edge = SOLID if draw.random() < WITH_KERB_LINE else None
        crossing = Intersection(junction, tuple(meeting), 30 * junction.id, "town", TURN_SPEED, edge)
        roads += connecting_roads(crossing, by_id)
    target.write_bytes(opendrive(target.stem, roads, junctions))


def _street(draw: np.random.Generator) -> tuple[Section, float]:
    """Return a street's cross-section, and the distance of its kerbs from its middle, m."""
    lanes, width = int(draw.choice(LANES)), float(draw.uniform(*WIDTH))
    edge = SOLID if draw.random() < WITH_EDGE else None
    broken = lanes == 1 and draw.random() < BROKEN_CENTRE
    centre = (BROKEN if broken else SOLID) if draw.random() < WITH_CENTRE else None
    side = (
        *(Lane(f"lane_{number}", "driving", width, BROKEN) for number in range(1, lanes)),
        Lane(f"lane_{lanes}", "driving", width, edge),
        *BESIDE[int(draw.integers(len(BESIDE)))],
    )
    return Section(side, side, centre), lanes * width


def _road(
    number: int, start: Pose, length: float, section: Section, before: Neighbour | None, after: Neighbour | None
) -> Road:
    return Road(
        number,
        f"street_{number}",
        "town",
        SPEED,
        start,
        straight(length),
        (section,),
        predecessor=before,
        successor=after,
    )
