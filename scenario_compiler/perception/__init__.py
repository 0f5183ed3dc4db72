"""Images of a camera on the car, and the lanes that detectors find in them.

In: a `roads.network.Network` (as the quads of `roads.mesh`), the pose of the vehicle, boxes for all others, weather,
and sigma of the sensor noise. Out: BGR images (`road_camera.RoadCamera`), lane boundaries, each with a probability
(`lane_detector.LaneDetector`), and the picture in reports (`overlay.compose`). `__init__.pyi` lists the public names.

Imports the packages below it: `stage` imports the plan, and other modules import the engine's laws of haze and noise,
so that pictures and the engine agree. Nothing here keeps state between frames: an image depends only on the scene, the
pose, the weather, the seed and the frame index.
"""

from __future__ import annotations


def __getattr__(name: str) -> object:
    """Return a public name, imported from its module on first use."""
    from scenario_compiler.public import public_object

    return public_object(__name__, name)


def __dir__() -> list[str]:
    """Return the public names."""
    from scenario_compiler.public import public_names

    return sorted(public_names(__name__))
