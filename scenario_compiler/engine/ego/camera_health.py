"""The loss of a camera's health by each kind of fault: one curve for each, used by the engine and the lane detector.

With `--perception camera`, the detector estimates each quantity from the image and applies these curves; with
`--perception ideal`, the engine applies them to the faults that the scenario states. The health is the product of the
curves, and it multiplies the confidence in both sides of the lane.

    kind        quantity                                       amount 1 means            health is one half at
    noise       standard deviation, grey levels                80                        30
    blackout    brightest tones of the image, grey levels      0 (220 at amount 0)       14
    blur        radius of a blurred point, 1/512 of the width  9                         4.5
    dirt        share of the image that is covered             1                         0.5
    impulses    share of the pixels that are black or white    0.5                       0.12
    dropout     the image is missing                           every image               missing: health 0
    freeze      the image before is repeated while moving      every image               repeated: health 0

The detector has no estimator of impulse noise. It takes impulse noise for noise as soon as the median of the second
differences is changed: in images of eight situations by day and night its health was one half at 0.11 to 0.14 of the
pixels, at least 0.9 at 0.09, and at most 0.12 at 0.15 (docs/camera-failures.md has the table of a drive).

Overexposure, dead rows and coarse grey levels have no curve. The detector's estimators recognise only strong cases of
them, as noise, blur or dirt; ideal perception does not recognise them.

The other numbers are policy, not measurement: they define from where on a camera counts as failing. 220 grey levels are
white paint at a clear noon; a darker scene counts as black sooner in the image than in the engine.
"""

from __future__ import annotations

from scenario_compiler.engine.columns.numbers import logistic
from scenario_compiler.marker import compiled

NOISE_AT_ONE = 80.0
NOISE_MIDDLE = 30.0
NOISE_WIDTH = 4.0

TONES_AT_NOON = 220.0
TONES_MIDDLE = 14.0
TONES_WIDTH = 2.0

BLUR_AT_ONE = 9.0
BLUR_MIDDLE = 4.5
BLUR_WIDTH = 0.5

IMPULSES_AT_ONE = 0.5
"""Share of the pixels that impulse noise of amount 1 changes."""

IMPULSES_MIDDLE = 0.12
IMPULSES_WIDTH = 0.012

DIRT_MIDDLE = 0.5
DIRT_WIDTH = 0.05


@compiled
def falling(value: float, middle: float, width: float) -> float:
    """Return the logistic curve that falls from 1 to 0 and is one half at `middle`."""
    return logistic((middle - value) / max(width, 1.0e-9))


@compiled
def noise_health(sigma: float) -> float:
    """Return the health under noise with the standard deviation `sigma`, grey levels."""
    return falling(sigma, NOISE_MIDDLE, NOISE_WIDTH)


@compiled
def tones_health(level: float) -> float:
    """Return the health of an image whose brightest tones are at `level`, grey levels."""
    return 1.0 - falling(level, TONES_MIDDLE, TONES_WIDTH)


@compiled
def blur_health(radius: float) -> float:
    """Return the health of an image blurred by a Gaussian of `radius`, in 1/512 of its width."""
    return falling(radius, BLUR_MIDDLE, BLUR_WIDTH)


@compiled
def dirt_health(share: float) -> float:
    """Return the health of an image of which the share `share` is covered."""
    return falling(share, DIRT_MIDDLE, DIRT_WIDTH)


@compiled
def impulses_health(share: float) -> float:
    """Return the health of an image in which the share `share` of the pixels is black or white."""
    return falling(share, IMPULSES_MIDDLE, IMPULSES_WIDTH)
