"""Random rendered frames with the truth about their lane."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.calibration.scenes import Fading, Line, Reference, Strip, make_scene
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.weather_look import look_of
from scenario_compiler.roads.mesh import Material, Paint
from scenario_compiler.roads.positions import Pose
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather, weather_preset

Floats = NDArray[np.float64]

NEAR, FAR = 6.0, 18.0
"""Stretch ahead of the camera on which a boundary has to be right, m."""

CLOSE_ENOUGH = 0.25
"""Lateral error up to which it is right, m."""

SEEN, SEEN_SHARE = 0.15, 0.6
"""Quality times the weather's contrast over which paint counts as there, and the share of the stretch that needs it."""

DASHES = ((0.0, 0.0), (3.0, 9.0), (4.0, 8.0), (6.0, 12.0), (3.0, 4.5), (6.0, 9.0), (3.0, 6.0))
"""Dash and gap, m: solid; US; German motorway and rural, European long, others."""

CLEAR_DAY = weather_preset("ClearNoon") or Weather()


@dataclass(frozen=True)
class Wanted:
    """What is fixed about a frame; the rest is drawn.

    Attributes:
        quality: Paint quality on both sides; drawn when None.
        sigma: Noise, grey levels; drawn when None.
        weather: Weather; drawn among CARLA's presets when None.
        traffic: Whether other cars may be there.
    """

    quality: float | None = None
    sigma: float | None = None
    weather: Weather | None = None
    traffic: bool = True


@dataclass(frozen=True)
class CalibrationFrame:
    """A rendered frame and its truth.

    Attributes:
        image: (height, width, 3) uint8, BGR.
        boundaries: For the left and right boundary y(x), (n,), at x.
        x: (n,) distances ahead of the camera, m, from `NEAR` to `FAR`.
        quality: For both sides the quality of the paint at x times the contrast that the weather leaves, (n,).
        sigma: Noise, grey levels.
        weather: Name of the weather.
    """

    image: NDArray[np.uint8]
    boundaries: tuple[Floats, Floats]
    x: Floats
    quality: tuple[Floats, Floats]
    sigma: float
    weather: str

    def right(self, side: int, y: Floats) -> bool:
        """Whether a detected boundary y(x) of a side is close enough and its paint is there."""
        close = float(np.abs(y - self.boundaries[side]).max()) < CLOSE_ENOUGH
        return close and float((self.quality[side] > SEEN).mean()) > SEEN_SHARE


def random_frame(draw: np.random.Generator, wanted: Wanted, camera: Camera | None = None) -> CalibrationFrame:
    """Return one frame of a random road: radii from 100 m, lanes 2.9 to 4 m wide, one to four of them."""
    reference = _reference(draw)
    width = float(draw.uniform(2.9, 4.0)) if draw.random() < 0.5 else float(draw.choice([3.0, 3.25, 3.5, 3.75]))
    left_lanes, right_lanes = int(draw.integers(0, 2)), int(draw.integers(0, 2))
    here = float(draw.uniform(30.0, reference.length - 60.0))
    qualities = (_quality(draw, wanted, here), _quality(draw, wanted, here))
    lines, strips = _road(draw, width, (left_lanes, right_lanes), qualities)
    sigma = wanted.sigma
    if sigma is None:
        sigma = 0.0 if draw.random() < 0.4 else float(draw.uniform(0.0, 90.0))
    weather = wanted.weather if wanted.weather is not None else _weather(draw)
    offset, turn = float(np.clip(draw.normal(0, 0.22), -0.7, 0.7)), float(np.clip(draw.normal(0, 0.015), -0.05, 0.05))
    pose = reference.pose(here, offset, turn)
    boxes = _traffic(draw, reference, here, width) if wanted.traffic and draw.random() < 0.35 else []
    road_camera = RoadCamera(make_scene(reference, strips, lines), camera, seed=int(draw.integers(2**31)))
    image = road_camera.frame(pose, boxes, weather, sigma, 0)
    return _with_truth(image, road_camera, pose, reference, here, width, qualities, sigma, weather)


def _reference(draw: np.random.Generator) -> Reference:
    pieces: list[tuple[float, float, float]] = []
    before = 0.0
    for _ in range(5):
        after = 0.0 if draw.random() < 0.35 else float(draw.choice([-1.0, 1.0]) / math.exp(draw.uniform(4.6, 7.0)))
        pieces += [(float(draw.uniform(25, 60)), before, after), (float(draw.uniform(10, 60)), after, after)]
        before = after
    return Reference(pieces)


def _quality(draw: np.random.Generator, wanted: Wanted, here: float) -> Fading:
    if wanted.quality is not None:
        return Fading(wanted.quality, wanted.quality)
    kind = draw.random()
    if kind < 0.4:
        return Fading(1.0, 1.0)
    if kind < 0.6:
        return Fading(0.0, 0.0)
    if kind < 0.85:
        level = float(draw.uniform(0.0, 1.0))
        return Fading(level, level)
    begin = here + float(draw.uniform(-15, 30))
    first, last = (1.0, 0.0) if draw.random() < 0.7 else (0.0, 1.0)
    return Fading(first, last, begin, begin + float(draw.uniform(5, 40)))


def _road(
    draw: np.random.Generator, width: float, lanes: tuple[int, int], qualities: tuple[Fading, Fading]
) -> tuple[list[Line], list[Strip]]:
    """Return lines and strips of a road whose middle lane is centred on the reference line."""
    inner, outer = _kind(draw, 0.7), _kind(draw, 0.25)
    left_edge, right_edge = width * (0.5 + lanes[0]), -width * (0.5 + lanes[1])
    paint = Paint.YELLOW if draw.random() < 0.2 else Paint.WHITE
    broad = float(draw.choice([0.1, 0.12, 0.15, 0.2, 0.25]))
    lines = [
        Line(width / 2, *(inner if lanes[0] else outer), width=broad, colour=paint, quality=qualities[0]),
        Line(-width / 2, *(inner if lanes[1] else outer), width=broad, quality=qualities[1]),
    ]
    if lanes[0]:
        lines.append(Line(left_edge, width=broad, colour=paint, quality=_neighbour(draw, qualities[0])))
    if lanes[1]:
        lines.append(Line(right_edge, width=broad, quality=_neighbour(draw, qualities[1])))
    margin = float(draw.choice([0.15, 0.4, 1.0, 2.5]))
    strips = [Strip(40.0, -40.0, Material.VERGE), Strip(left_edge + margin, right_edge - margin)]
    if draw.random() < 0.3:
        kerb = float(draw.uniform(0.12, 0.5))
        strips.append(Strip(left_edge + margin + kerb, left_edge + margin, Material.CONCRETE))
        strips.append(Strip(right_edge - margin, right_edge - margin - kerb, Material.CONCRETE))
    elif draw.random() < 0.3:
        strips.append(Strip(right_edge, right_edge - margin, Material.SHOULDER))
    if draw.random() < 0.3:
        seam = Line(
            float(draw.uniform(right_edge, left_edge)), width=0.06, colour=Paint.BLACK, quality=Fading(0.6, 0.6)
        )
        lines.insert(0, seam)
    return lines, strips


def _kind(draw: np.random.Generator, broken: float) -> tuple[float, float, float]:
    """Return dash, gap and phase of a line that is broken with a probability."""
    dash, gap = DASHES[int(draw.integers(len(DASHES)))] if draw.random() < broken else (0.0, 0.0)
    return dash, gap, float(draw.uniform(0.0, 18.0))


def _neighbour(draw: np.random.Generator, quality: Fading) -> Fading:
    """Return the quality of the next lane's line: most often that of ours."""
    return quality if draw.random() < 0.8 else Fading(1.0, 1.0)


def _weather(draw: np.random.Generator) -> Weather:
    if draw.random() < 0.45:
        return CLEAR_DAY
    return weather_preset(str(int(draw.integers(len(WEATHER_PRESETS))))) or CLEAR_DAY


def _traffic(draw: np.random.Generator, reference: Reference, here: float, width: float) -> list[Box]:
    boxes = []
    for _ in range(int(draw.integers(1, 4))):
        ahead, lane = float(draw.uniform(14, 70)), int(draw.integers(-1, 2))
        if lane == 0:
            ahead = max(ahead, 26.0)
        pose = reference.pose(min(here + ahead, reference.length), lane * width)
        colour = (int(draw.integers(30, 240)), int(draw.integers(30, 240)), int(draw.integers(30, 240)))
        boxes.append(Box(pose.x, pose.y, 0.0, pose.heading, 4.4, 1.85, 1.45, colour))
    return boxes


def _with_truth(
    image: NDArray[np.uint8],
    road_camera: RoadCamera,
    pose: Pose,
    reference: Reference,
    here: float,
    width: float,
    qualities: tuple[Fading, Fading],
    sigma: float,
    weather: Weather,
) -> CalibrationFrame:
    x = np.arange(NEAR, FAR + 0.1, 1.0)
    s = np.arange(here, min(here + 40.0, reference.length), 0.5)
    view = road_camera.view(pose)
    boundaries, seen = [], []
    for side, t in enumerate((width / 2, -width / 2)):
        flat = reference.at(s, t)
        ground = view.world_to_ground(np.concatenate([flat, np.zeros((len(s), 1))], axis=1))
        boundaries.append(np.interp(x, ground[:, 0], ground[:, 1]))
        seen.append(np.interp(x, ground[:, 0], qualities[side](s)) * look_of(weather).contrast)
    return CalibrationFrame(image, (boundaries[0], boundaries[1]), x, (seen[0], seen[1]), sigma, weather.preset)
