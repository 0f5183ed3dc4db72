"""The faults of a camera at one instant, which a world gives to its camera in addition to the noise."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class CameraFaults:
    """The faults of the camera other than its noise.

    Attributes:
        dark: Share of the light that is lost, 0-1.
        blur: Radius of the blur, 1/512 of the image's width.
        dirt: Share of the image that dirt covers, 0-1.
        missing: Whether the image does not arrive; a black one is delivered.
        frozen: Whether the previous image is delivered again.
        impulses: Share of the values of channels that are 0 or 255, 0-1.
        brighter: Amount that is added to the brightness, a share of white.
        dead_rows: Share of the rows that are black, 0-1.
        coarse: Coarseness of the grey levels: 0 for 8 bits, 1 for one.
        late: Delay of an image, s.
        exposure: Exposure time, s, during which motion smears the image.
        turned: Yaw, pitch and roll by which the camera is turned relative to its mounting, rad; positive yaw to the
            left, pitch up, roll with the right side down, as a `Camera`'s own.
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
"""A camera without faults."""
