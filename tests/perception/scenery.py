"""Roads that the tests of perception drive on."""

import math

import numpy as np

from scenario_compiler.perception.calibration.scenes import Fading, Line, Reference, Strip, make_scene
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.course import Course
from scenario_compiler.perception.route_ahead import WayPoint
from scenario_compiler.perception.scene import Scene, joined_marks
from scenario_compiler.roads.mesh import Material
from scenario_compiler.roads.positions import Pose
from scenario_compiler.vocabulary.weather import Weather, weather_preset

EU_DASH, US_DASH, SOLID = (6.0, 12.0), (3.0, 9.0), (0.0, 0.0)


def weather(name: str) -> Weather:
    preset = weather_preset(name)
    assert preset is not None
    return preset


CLEAR = weather("ClearNoon")


def horizon(camera: Camera) -> float:
    """Image row at which the ground plane vanishes in the middle column of a camera, pixels."""
    return camera.height / 2.0 + camera.focal * math.tan(camera.pitch) / math.cos(camera.roll)


def bend(radius: float, length: float = 150.0) -> Reference:
    """A road that turns left with a radius (right when negative); 0 is straight."""
    curvature = 1.0 / radius if radius else 0.0
    return Reference([(30.0, 0.0, 0.0), (30.0, 0.0, curvature), (length, curvature, curvature)])


def two_lanes(
    reference: Reference,
    width: float = 3.5,
    dash: tuple[float, float] = US_DASH,
    quality: float | Fading = 1.0,
    outer: tuple[float, float] = SOLID,
) -> Scene:
    """Our lane is centred on the reference line, another one lies to its left."""
    fading = quality if isinstance(quality, Fading) else Fading(quality, quality)
    lines = [
        Line(1.5 * width, quality=fading),
        Line(0.5 * width, *dash, quality=fading),
        Line(-0.5 * width, *outer, quality=fading),
    ]
    strips = [Strip(30.0, -30.0, Material.VERGE), Strip(1.5 * width + 0.6, -0.5 * width - 0.6)]
    return make_scene(reference, strips, lines)


def in_ground(points: np.ndarray, pose: Pose) -> np.ndarray:
    """Points (n, 2) of a level world in the ground frame of the default camera of a car at a pose."""
    flat = np.concatenate([points, np.zeros((len(points), 1))], axis=1)
    return Camera().view(pose, 1.4).world_to_ground(flat)


def route(reference: Reference, pose: Pose) -> Course | None:
    """The planned route from there along a reference line."""
    begin, _ = reference.offset(pose.x, pose.y)
    ground = in_ground(reference.at(begin + np.arange(40.0)), pose)
    return Course.along([WayPoint(float(x), float(y)) for x, y in ground])


def fork(*branches: Reference) -> Scene:
    """Lanes with a solid line on either side, each centred on its reference line; they begin as one."""
    strips = [Strip(30.0, -30.0, Material.VERGE), Strip(12.0, -12.0)]
    first, *others = (make_scene(branch, strips, [Line(1.75), Line(-1.75)]) for branch in branches)
    marks = first.marks
    for other in others:
        marks = joined_marks(marks, other.marks)
    return Scene(first.surface, marks)
