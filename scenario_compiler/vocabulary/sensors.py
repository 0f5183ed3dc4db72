"""Sensors of the ego vehicle."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute


class Camera(Word):
    """The forward camera that the lane detector sees through. Defaults are the AISA toolkit's, at half its size."""

    word: Literal["camera"] = "camera"

    width: int = attribute("Width of the image, pixels.", default=512, minimum=64, maximum=4096)
    height: int = attribute("Height of the image, pixels.", default=256, minimum=32, maximum=4096)
    fov: float = attribute("Horizontal field of view, degrees.", default=45.0, minimum=5, maximum=170)
    x: float = attribute("Distance ahead of the centre of the vehicle's box, m.", default=0.5)
    z: float = attribute("Height above the ground, m.", default=1.3, minimum=0.1)
    pitch: float = attribute("Pitch, degrees; negative looks down.", default=-5.0, minimum=-60, maximum=60)
    sensor_noise: Number = attribute(
        "Standard deviation of the Gaussian noise (mean 0) on every channel of every pixel, grey levels.",
        default=0.0,
        quantity="grey_levels",
        minimum=0,
        maximum=255,
    )
