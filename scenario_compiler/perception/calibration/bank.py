"""A bank of situations on artificial roads, in which the detector is tested one by one.

Every situation has its own pictures: the lane's width, its marks, the position of the car in the lane and everything
else that the situation leaves open are random. `drawn_situation` makes other situations of this kind for the fit, with
other radii, distances and random numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.scenes import Fading, Line, Reference, Strip, make_scene
from scenario_compiler.perception.calibration.truth import SEEN, Truth
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.scene import Scene
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.textures import GROUND_SEED
from scenario_compiler.perception.weather_look import look_of
from scenario_compiler.roads.mesh import Material
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_preset

HERE = 90.0
"""Position of the car on the road, m, plus or minus 10."""

GRADE_RADIUS = 1000.0
GRADE = math.radians(3.0)
"""Radius of a change of grade, m, and the change of the grade, rad."""

DASHES = ((0.0, 0.0), (3.0, 9.0), (6.0, 12.0), (3.0, 6.0))


@dataclass(frozen=True)
class Situation:
    """A situation.

    Attributes:
        name: Its name in tables.
        radius: Radius of the road, m, positive to the left; 0 for a straight road.
        leader: Distance to a car in the lane, m; 0 for none.
        truck: Side on which a truck drives: 1 left, -1 right, 0 for none.
        sun: Whether a low sun is straight ahead.
        weather: Name of the weather.
        sigma: Noise, grey levels.
        pitch: Pitch of the body, degrees, positive with the nose down.
        grade: 1 if the road bends up ahead or below the car, -1 if it bends down, 0 for neither.
        paint: Quality of the paint.
    """

    name: str
    radius: float = 0.0
    leader: float = 0.0
    truck: int = 0
    sun: bool = False
    weather: str = "ClearNoon"
    sigma: float = 0.0
    pitch: float = 0.0
    grade: int = 0
    paint: float = 1.0

    def light(self, heading: float = 0.0) -> Weather:
        """Return the weather; a low sun is straight ahead of a car with this heading, rad."""
        weather = weather_preset(self.weather) or Weather()
        if not self.sun:
            return weather
        return weather.model_copy(update={"sun_azimuth_angle": -math.degrees(heading), "sun_altitude_angle": 8.0})


def _bank() -> tuple[Situation, ...]:
    found = [Situation("straight")]
    found += [Situation(f"radius {r} m, {side}", radius=sign * r) for r in (400, 150, 100, 60, 40)
              for side, sign in (("left", 1.0), ("right", -1.0))]  # fmt: skip
    found += [Situation(f"leader at {gap} m", leader=gap) for gap in (6, 10, 15, 25)]
    found += [Situation("leader at 10 m, radius 100 m", leader=10, radius=100.0)]
    found += [Situation("truck to the left", truck=1), Situation("truck to the right", truck=-1)]
    found += [Situation("sun ahead", sun=True), Situation("sun ahead, wet road", sun=True, weather="WetSunset")]
    found += [Situation(name, weather=name) for name in ("ClearNight", "HardRainNight", "HardRainNoon",
              "MidRainSunset", "HardRainSunset", "DustStorm")]  # fmt: skip
    found += [Situation(f"noise {sigma}", sigma=sigma) for sigma in (10, 20, 40)]
    found += [Situation(f"pitch {pitch:+d} degrees", pitch=pitch) for pitch in (-2, -1, 1, 2)]
    found += [Situation(f"pitch {pitch:+d} degrees, radius 100 m", pitch=pitch, radius=100.0) for pitch in (-1, 1)]
    found += [Situation(f"pitch {pitch:+d} degrees, night", pitch=pitch, weather="ClearNight") for pitch in (-1, 1)]
    found += [Situation("grade begins, 3 degrees up", grade=1), Situation("grade begins, 3 degrees down", grade=-1)]
    found += [Situation("worn paint", paint=0.3), Situation("no paint", paint=0.0)]
    return tuple(found)


BANK = _bank()


def pictures(situation: Situation, seed: int, count: int) -> Iterator[tuple[NDArray[np.uint8], Truth]]:
    """Yield pictures of a situation of the bank and the truth in each."""
    for number in range(count):
        yield picture(situation, np.random.default_rng([seed, BANK.index(situation), number]))


def drawn_situation(draw: np.random.Generator) -> Situation:
    """Return a random situation that is not in the bank: bends down to 25 m, leaders, pitch, grades, wear."""
    radius = 0.0 if draw.random() < 0.3 else float(draw.choice([-1.0, 1.0]) * math.exp(draw.uniform(3.2, 5.7)))
    weather = "ClearNoon" if draw.random() < 0.7 else list(WEATHER_PRESETS)[int(draw.integers(len(WEATHER_PRESETS)))]
    return Situation(
        "drawn",
        radius=radius,
        leader=float(draw.uniform(5.5, 27.0)) if draw.random() < 0.35 else 0.0,
        truck=int(draw.choice([-1, 1])) if abs(radius) > 80.0 and draw.random() < 0.1 else 0,
        sun=bool(draw.random() < 0.1),
        weather=weather,
        sigma=0.0 if draw.random() < 0.7 else float(draw.uniform(0.0, 50.0)),
        pitch=0.0 if draw.random() < 0.5 else float(draw.uniform(-2.3, 2.3)),
        grade=int(draw.choice([-1, 1])) if draw.random() < 0.15 else 0,
        paint=1.0 if draw.random() < 0.7 else float(draw.uniform(0.0, 1.0)),
    )


def picture(one: Situation, draw: np.random.Generator, texture: int = GROUND_SEED) -> tuple[NDArray[np.uint8], Truth]:
    """Return one picture of a situation and the truth in it; `texture` is the seed of the ground's texture."""
    width = float(draw.choice([3.0, 3.25, 3.5, 3.75]))
    here = HERE + float(draw.uniform(-10.0, 10.0))
    curvature = 1.0 / one.radius if one.radius else 0.0
    reference = Reference(
        [(40.0, 0.0, 0.0), (20.0, 0.0, curvature), (140.0, curvature, curvature)], _profile(one, draw, here)
    )
    scene = _scene(one, draw, reference, width, texture)
    camera = RoadCamera(scene, Camera(), seed=int(draw.integers(2**31)))
    pose = reference.pose(
        here, float(np.clip(draw.normal(0, 0.2), -0.5, 0.5)), float(np.clip(draw.normal(0, 0.01), -0.03, 0.03))
    )
    pose = pose._replace(pitch=pose.pitch + math.radians(one.pitch))
    others = _others(one, draw, reference, here, width)
    image = camera.frame(pose, others, one.light(pose.heading), one.sigma, 0)
    view, s = camera.view(pose), np.arange(here - 5.0, here + 45.0, 0.5)
    left, right = (reference.points(s, t) for t in (0.5 * width, -0.5 * width))
    seen = 1.0 if one.paint * look_of(one.light()).contrast > SEEN else 0.0
    return image, Truth.of(view, left, right, (seen, seen))


def _profile(one: Situation, draw: np.random.Generator, here: float) -> tuple[float, float, float]:
    """Return where the road begins to bend up, its curvature there, and the change of its grade."""
    begin = here + float(draw.uniform(-10.0, 25.0))
    return begin, one.grade / GRADE_RADIUS, GRADE


def _scene(one: Situation, draw: np.random.Generator, reference: Reference, width: float, texture: int) -> Scene:
    quality = Fading(one.paint, one.paint)
    dash, gap = DASHES[int(draw.integers(len(DASHES)))]
    broad, phase = float(draw.choice([0.12, 0.15, 0.2])), float(draw.uniform(0.0, 18.0))
    left = bool(draw.random() < 0.7)
    lines = [
        Line(0.5 * width, dash if left else 0.0, gap if left else 0.0, phase, broad, quality=quality),
        Line(-0.5 * width, width=broad, quality=quality),
        Line(1.5 * width if left else -1.5 * width, width=broad, quality=quality),
    ]
    edges = (1.5, -0.5) if left else (0.5, -1.5)
    strips = [Strip(40.0, -40.0, Material.VERGE), Strip(edges[0] * width + 0.6, edges[1] * width - 0.6)]
    return make_scene(reference, strips, lines, texture)


def _others(one: Situation, draw: np.random.Generator, reference: Reference, here: float, width: float) -> list[Box]:
    boxes = []
    colour = (int(draw.integers(30, 240)), int(draw.integers(30, 240)), int(draw.integers(30, 240)))
    if one.leader:
        pose = reference.pose(here + 3.5 + one.leader + 2.2)
        boxes.append(Box(pose.x, pose.y, pose.z, pose.heading, 4.4, 1.85, 1.45, colour, "car", pose.pitch))
    if one.truck:
        pose = reference.pose(here + float(draw.uniform(4.0, 14.0)), one.truck * width)
        boxes.append(Box(pose.x, pose.y, pose.z, pose.heading, 8.5, 2.5, 3.5, colour, "truck", pose.pitch))
    return boxes
