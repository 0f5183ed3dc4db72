"""What can be wrong with a camera at one instant: what a world tells its camera, beside the noise."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CameraFaults:
    """What is wrong with the camera beside its noise.

    Attributes:
        dark: Share of the light that is lost, 0-1.
        blur: Radius of the blur, 1/512 of the image's width.
        dirt: Share of the image that dirt covers, 0-1.
        missing: The image does not arrive: what is delivered is black.
        frozen: The image before is delivered again.
        impulses: Share of the pixels that are black or white, 0-1.
        brighter: What is added to the brightness, a share of white.
        dead_rows: Share of the rows that are black, 0-1.
        coarse: How coarse the grey levels are: 0 for 8 bits, 1 for one.
        late: How late an image arrives, s.
        exposure: How long the sensor is exposed, s: what moves in that time is smeared.
        turned: Yaw, pitch and roll by which the camera is turned beyond its mounting, rad; positive yaw to the left,
            pitch up, roll with the right side down, as a `Camera`'s own.
    """

    dark: float = 0.0
    blur: float = 0.0
    dirt: float = 0.0
    missing: bool = False
    frozen: bool = False
    impulses: float = 0.0
    brighter: float = 0.0
    dead_rows: float = 0.0
    coarse: float = 0.0
    late: float = 0.0
    exposure: float = 0.0
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0)


FAULTLESS = CameraFaults()
"""A camera with nothing wrong."""
