"""TTC and DRAC of ten recordings, PET of ten others, against commonroad-crime (the extra `criticality`).

Where the two count differently, the test says how. commonroad-crime rounds times and decelerations to two decimals,
and takes the deceleration as none on a lane whose direction is exactly 0: the lane here is turned by 0.0001 rad.
Its post-encroachment time is from the first step in which the one is outside the conflict area to the last one before
the other enters it; ours is between the moments: up to two steps more. Its conflict area is where two lanes cross,
which are as wide as the cars here, so that it is where the cars' ways cross.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from scenario_compiler.recording.recording import Floats
from tests.recording.made import CAR, STEP, Row, record
from tests.recording.test_measures import value

pytest.importorskip("commonroad_crime", reason="needs the extra `criticality`: pip install commonroad-crime")

pytestmark = pytest.mark.filterwarnings("ignore")  # of their libraries

EGO, OTHER = 10, 11
Way = tuple[Floats, Floats, float, float]
"""x and y of the box's middle in each step, heading, speed."""

ALMOST_STRAIGHT = 1.0e-4
ROWS = 160


def car(number: int, way: Way) -> Any:
    """Return a car of theirs that drives a way; positions are those of the box's middle."""
    from commonroad.geometry.shape import Rectangle
    from commonroad.prediction.prediction import TrajectoryPrediction
    from commonroad.scenario.obstacle import DynamicObstacle, ObstacleType
    from commonroad.scenario.state import CustomState, InitialState
    from commonroad.scenario.trajectory import Trajectory

    x, y, heading, speed = way
    moving = {"orientation": heading, "velocity": speed, "acceleration": 0.0}
    states = [
        CustomState(time_step=k, position=np.array(at), velocity_y=0.0, acceleration_y=0.0, **moving)
        for k, at in enumerate(zip(x, y, strict=True))
    ]
    first = InitialState(time_step=0, position=states[0].position, yaw_rate=0.0, slip_angle=0.0, **moving)
    shape = Rectangle(CAR.length, CAR.width)
    driven = TrajectoryPrediction(Trajectory(1, states[1:]), shape)
    return DynamicObstacle(number, ObstacleType.CAR, shape, first, driven)


def lanelet(number: int, begin: Sequence[float], end: Sequence[float], width: float, **more: Any) -> Any:
    """Return a straight lane of theirs."""
    from commonroad.scenario.lanelet import Lanelet

    a, b = np.array(begin, dtype=float), np.array(end, dtype=float)
    along = (b - a) / np.linalg.norm(b - a)
    aside = 0.5 * width * np.array([-along[1], along[0]])
    middle = np.linspace(a, b, 101)
    return Lanelet(middle + aside, middle, middle - aside, number, **more)


def configured(ways: Sequence[Way], parts: Sequence[Any], *, crossing: bool) -> Any:
    """Return their configuration of a scenario with the ego and another car on some lanes."""
    from commonroad.scenario.scenario import Scenario, ScenarioID, Tag
    from commonroad_crime.data_structure.configuration import CriMeConfiguration

    scenario = Scenario(STEP, ScenarioID(), tags={Tag.INTERSECTION} if crossing else set())
    for part in parts:
        scenario.add_objects(part)
    for number, way in zip((EGO, OTHER), ways, strict=True):
        scenario.add_objects(car(number, way))
    scenario.assign_obstacles_to_lanelets()
    configuration = CriMeConfiguration()
    configuration.update(ego_id=EGO, sce=scenario)
    configuration.acceleration.acceleration_mode = 1
    return configuration


def ours(name: str, ways: Sequence[Way]) -> float:
    """Return our measure of the same two cars, whose reference points are behind the middles of their boxes."""

    def row(t: float) -> Row:
        k = round(t / STEP)
        return {
            "x": [float(x[k] - CAR.center * math.cos(h)) for x, _, h, _ in ways],
            "y": [float(y[k] - CAR.center * math.sin(h)) for _, y, h, _ in ways],
            "h": [h for _, _, h, _ in ways],
            "v": [v for _, _, _, v in ways],
        }

    return value(name, record(("ego", "other"), len(ways[0][0]), row))


def following(gap: float, ego: float, lead: float, rows: int) -> list[Way]:
    """Return two cars, one behind the other along x, a gap apart at first."""
    t = np.arange(rows, dtype=np.float64) * np.float64(STEP)
    return [
        (ego * t, np.zeros(rows), 0.0, ego),
        (gap + CAR.length + lead * t, np.zeros(rows), 0.0, lead),
    ]


@pytest.mark.parametrize(
    ("gap", "ego", "lead", "rows"),
    [
        (80.0, 20.0, 12.0, 40),
        (60.0, 33.3, 22.2, 30),
        (40.0, 13.9, 0.5, 20),
        (25.0, 10.0, 5.0, 25),
        (150.0, 30.0, 8.0, 45),
        (50.0, 25.0, 18.0, 60),
        (30.0, 8.0, 1.5, 30),
        (220.0, 36.1, 10.0, 60),
        (15.0, 20.0, 17.0, 20),
        (70.0, 27.8, 18.0, 50),
    ],
)
def test_time_to_collision_and_deceleration_are_those_of_the_last_step(
    gap: float, ego: float, lead: float, rows: int
) -> None:
    from commonroad_crime.measure import TTC, ALongReq

    ways = following(gap, ego, lead, rows)
    lane = lanelet(1, (-50.0, 0.0), (600.0, 650.0 * ALMOST_STRAIGHT), 3.5)
    theirs = configured(ways, [lane], crossing=False)
    last = rows - 1
    time = TTC(theirs).compute(OTHER, last, verbose=False)
    assert ours("minimum_time_to_collision", ways) == pytest.approx(time, rel=0.01)
    deceleration = -ALongReq(theirs).compute(OTHER, last, verbose=False)
    assert deceleration > 0.2
    assert ours("maximum_drac", ways) == pytest.approx(deceleration, rel=0.01)


def crossing_lanes() -> list[Any]:
    """Return two lanes as wide as the cars that cross at the origin, and the intersection."""
    from commonroad.scenario.intersection import Intersection, IntersectionIncomingElement
    from commonroad.scenario.lanelet import LaneletType

    half, inside = 0.5 * CAR.width, {"lanelet_type": {LaneletType.INTERSECTION}}
    lanes = []
    for first, (dx, dy) in ((1, (1.0, 0.0)), (4, (0.0, 1.0))):
        ends = [(a * dx, a * dy) for a in (-200.0, -half, half, 200.0)]
        lanes += [
            lanelet(first, ends[0], ends[1], CAR.width, successor=[first + 1]),
            lanelet(first + 1, ends[1], ends[2], CAR.width, predecessor=[first], successor=[first + 2], **inside),
            lanelet(first + 2, ends[2], ends[3], CAR.width, predecessor=[first + 1]),
        ]
    incoming = [
        IntersectionIncomingElement(21, {1}, successors_straight={2}),
        IntersectionIncomingElement(22, {4}, successors_straight={5}),
    ]
    return [*lanes, Intersection(20, incoming)]


@pytest.mark.parametrize(
    ("late", "speed"),
    [
        *((1.02, 10.0), (2.53, 8.0), (4.01, 12.0), (-3.04, 10.0), (-5.02, 7.0)),
        *((1.51, 14.0), (3.02, 6.0), (4.52, 9.0), (-2.03, 13.0), (-4.04, 8.0)),
    ],
)
def test_post_encroachment_time_is_up_to_two_steps_more(late: float, speed: float) -> None:
    """The ego crosses at 10 m/s; the other comes to its way `late` s after the ego has left it, or before."""
    from commonroad_crime.measure import PET

    t = np.arange(ROWS, dtype=np.float64) * np.float64(STEP)
    zero = np.zeros(ROWS)
    ways = [
        (-80.0 + 10.0 * t, zero, 0.0, 10.0),
        (zero, -0.5 * (CAR.length + CAR.width) + speed * (t - 8.3 - late), 0.5 * math.pi, speed),
    ]
    theirs = PET(configured(ways, crossing_lanes(), crossing=True)).compute(OTHER, 1, verbose=False)
    time = ours("minimum_post_encroachment_time", ways)
    assert theirs - 1e-6 <= time <= theirs + 2 * STEP + 1e-6
    across = CAR.length + CAR.width
    assert time == pytest.approx(late if late > 0.0 else -late - across / 10.0 - across / speed, abs=1e-6)
