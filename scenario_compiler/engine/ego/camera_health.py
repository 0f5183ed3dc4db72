"""The loss of a camera's health by each kind of fault: one curve for each, used by the engine and the lane detector.

With `--perception camera`, the detector estimates each quantity from the image and applies these curves; with
`--perception ideal`, the engine applies them to the faults that the scenario states. The health is the product of the
curves, and it multiplies the confidence in both sides of the lane.

    kind        quantity                                       amount 1 means            health is one half at
    noise       standard deviation, grey levels                80                        30
    blackout    brightest tones of the image, grey levels      0                         14
    blur        radius of a blurred point, 1/512 of the width  9                         4.5
    dirt        share of the image that is covered             1                         0.5
    impulses    share of the pixels that are black or white    0.5                       0.112
    dropout     the image is missing                           every image               missing: health 0
    freeze      the image before is repeated while moving      every image               repeated: health 0

The detector does not measure exactly these quantities. The functions `measured_...` and `still_by_...` state what it
measures of a fault, so that ideal perception has the health that the camera would have. Their numbers were measured in
rendered pictures of four maps in eight weathers (docs/camera-failures.md compares both healths):

    noise         noise is clipped at black and at white, so that less of it is seen in a dark picture. The standard
                  deviation of a normal variable that is clipped at 0, with a mean of x times its own standard
                  deviation, is 1 - 0.416 exp(-0.805 x - 0.334 x^2) of that (within 0.004). Half of the picture is sky
    blur          0.6 + 1.17 r: a sharp picture has edges of 0.6 already, and lines that are thinner than the blur lose
                  more of their slope than of the picture's largest steps
    dirt          the rims of blotches do change: 0.6 d (1 - d) of the image counts as clean
    dead rows     a block of 8 x 8 pixels does not change if all of its rows are dead, d^8 of the blocks; nor does a
                  quarter of the blocks with one row left, 8 d^7 (1 - d)
    overexposure  ground that is white does not change, and counts as covered. In coloured light, one channel stays
                  below white
    quantisation  asphalt does not change where its brightness is farther from the next boundary between two grey levels
                  than its grains differ: half of it at 0.36 of the brightness. Under headlights the brightness differs
                  too much from place to place, and only two grey levels count
    impulses      the detector has no estimator of its own for them. It takes them for noise as soon as the median of
                  the second differences is changed, at 0.112 of the pixels by day; in the dark only the white half of
                  them stands out, and up to 0.145 are needed
    latency       while an image is awaited, the one before is repeated

The other numbers are policy, not measurement: they define from where on a camera counts as failing.
"""

from __future__ import annotations

from math import exp

from scenario_compiler.engine.columns.numbers import clip, logistic, safe_sqrt
from scenario_compiler.marker import compiled

WHITE = 255.0
"""The greatest grey level."""

MOVING = 0.15
"""Distance between two images from which the road must have changed, m."""

SEEN_ENOUGH = 6
"""Number of images in motion before dirt is reported."""

NOISE_AT_ONE = 80.0
NOISE_MIDDLE = 30.0
NOISE_WIDTH = 4.0

TONES_MIDDLE = 14.0
TONES_WIDTH = 2.0

BLUR_AT_ONE = 9.0
BLUR_MIDDLE = 4.5
BLUR_WIDTH = 0.5

IMPULSES_AT_ONE = 0.5
"""Share of the values of all channels that impulse noise of amount 1 changes."""

IMPULSES_MIDDLE = 0.112
IMPULSES_WIDTH = 0.01
MORE_IN_THE_DARK = 0.033
BRIGHT_GROUND = 80.0
"""How many more impulses are needed on black ground, as a share of the pixels, and the brightness, grey levels, from
which on the ground counts as bright.
"""

DIRT_MIDDLE = 0.5
DIRT_WIDTH = 0.05

SHARP = 0.6
BLUR_GAIN = 1.17
"""Radius that is measured of a sharp picture, 1/512 of its width, and how much more of each unit of blur."""

RIM = 0.6
"""Share of the product of covered and clean parts that the rims of blotches take."""

DARKEST_GRAINS = 0.85
WHITE_WIDTH = 4.0
"""Brightness of the darkest grains of asphalt as a share of its mean, and the width of the curve, grey levels."""

LEVEL_MIDDLE = 0.36
LEVEL_WIDTH = 0.07
"""Distance of the ground's brightness from the next boundary between grey levels, as a share of the brightness, at
which half of it does not change, and the width of the curve.
"""

LN_2 = 0.6931471805599453


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


@compiled
def clipped_share(mean: float) -> float:
    """Return the standard deviation of a clipped normal variable, as a share of that without clipping.

    Args:
        mean: Distance of its mean from the bound at which it is clipped, in standard deviations.
    """
    return 1.0 - 0.416 * exp(clip(-0.805 * mean - 0.334 * mean * mean, -50.0, 0.0))


@compiled
def measured_noise(sigma: float, sky: float, ground: float) -> float:
    """Return the noise that the detector measures, grey levels.

    Args:
        sigma: Standard deviation of the noise before clipping, grey levels.
        sky: Brightness of the upper half of the picture, grey levels.
        ground: Brightness of the lower half.
    """
    if sigma <= 0.0:
        return 0.0
    above = clipped_share(sky / sigma) * clipped_share((WHITE - sky) / sigma)
    below = clipped_share(ground / sigma) * clipped_share((WHITE - ground) / sigma)
    return sigma * safe_sqrt(above * below)


@compiled
def measured_blur(radius: float) -> float:
    """Return the radius that the detector measures of a Gaussian blur, 1/512 of the image's width."""
    return SHARP + BLUR_GAIN * radius


@compiled
def measured_dirt(share: float) -> float:
    """Return the share of the ground that the detector takes for covered if dirt covers the share `share`."""
    inside = clip(share, 0.0, 1.0)
    return inside - RIM * inside * (1.0 - inside)


@compiled
def measured_impulses(share: float, ground: float) -> float:
    """Return the share of impulses by day that disturbs the image as much as the share `share` does.

    Args:
        share: Share of the pixels that is black or white.
        ground: Brightness of the ground, grey levels.
    """
    dark = clip(1.0 - ground / BRIGHT_GROUND, 0.0, 1.0)
    return share * IMPULSES_MIDDLE / (IMPULSES_MIDDLE + MORE_IN_THE_DARK * dark)


@compiled
def still_by_dead_rows(share: float) -> float:
    """Return the share of blocks that do not change if the share `share` of all rows is dead."""
    dead = clip(share, 0.0, 1.0)
    three = dead * dead * dead
    return three * three * dead * (2.0 - dead)


@compiled
def still_by_white(amount: float, ground: float) -> float:
    """Return the share of the ground that overexposure by `amount` makes white, by its brightness, grey levels."""
    return falling(WHITE * (1.0 - amount), DARKEST_GRAINS * ground, WHITE_WIDTH)


@compiled
def still_by_quantisation(amount: float, ground: float, even: int) -> float:
    """Return the share of the ground that stays within one of the grey levels that quantisation by `amount` leaves.

    Args:
        amount: 0 for 256 grey levels, 1 for two.
        ground: Brightness of the ground, grey levels.
        even: 1 if the ground is lit evenly, 0 if headlights light a part of it.
    """
    bits = clip(8.0 - 7.0 * amount, 1.0, 8.0)
    levels = int(clip(exp(clip(LN_2 * bits, 0.0, 6.0)) + 0.5, 2.0, 256.0))
    if even == 0 and levels > 2:
        return 0.0
    step = WHITE / max(levels - 1, 1)
    below = int(clip(ground / max(step, 0.5), 0.0, 255.0))
    away = abs(ground - (below + 0.5) * step)
    return 1.0 - falling(away / max(ground, 1.0), LEVEL_MIDDLE, LEVEL_WIDTH)
