"""What a camera on the car sees of the road, and what a lane detector makes of it.

In: a `roads.network.Network` (as the quads of `roads.mesh`), the pose of the vehicle, boxes for everybody else,
weather, and sigma of the sensor noise. Out: BGR images (`road_camera.RoadCamera`), lane boundaries with a probability
each (`lane_detector.LaneDetector`) and the picture that a report shows (`overlay.compose`). `__init__.pyi` lists what
programs import from here.

May import `roads`, the hall, numpy and OpenCV; knows no plan, no engine, no controller. Nothing here keeps state
between frames: an image depends on the scene, the pose, the weather, the seed and the frame index alone.
"""

from __future__ import annotations


def __getattr__(name: str) -> object:
    """Return a public name, imported from its home on first use."""
    from scenario_compiler.public import public_object

    return public_object(__name__, name)


def __dir__() -> list[str]:
    """Return the public names."""
    from scenario_compiler.public import public_names

    return sorted(public_names(__name__))
