"""Sensors of the ego vehicle, and their failures."""

from math import radians
from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child

Perception = Literal["camera", "ideal", "surrogate"]
"""Source of the lane confidence: the camera's image, the map's marks, or a function that was fitted to the output of
the camera's detector."""

FailureKind = Literal[
    "noise",
    "dropout",
    "freeze",
    "blackout",
    "blur",
    "dirt",
    "impulse_noise",
    "overexposure",
    "dead_rows",
    "quantisation",
    "latency",
    "motion_blur",
    "misalignment",
]
"""Kinds of camera failures. Secci and Ceccarelli (arXiv 2008.05938) describe most of them: blackout is their "black",
overexposure their "brightness" and, at full amount, "white", dead_rows are their lines of "dead pixels", and noise is
their "no noise reduction". They describe blur and dirt under the same names.
"""

EXPOSURE_AT_ONE = 0.1
"""Exposure of motion blur of the amount 1, s."""

SEVERITIES: dict[FailureKind, tuple[float, float, float, float, float]] = {
    "noise": (0.255, 0.3825, 0.57375, 0.82875, 1.21125),
    "blur": (0.254, 0.508, 0.762, 1.016, 1.524),
    "impulse_noise": (0.06, 0.12, 0.18, 0.34, 0.54),
    "overexposure": (0.1, 0.2, 0.3, 0.4, 0.5),
    "motion_blur": (0.256, 0.42, 0.665, 0.932, 1.185),
}
"""Amounts of ImageNet-C's severities 1 to 5, from its make_imagenet_c.py: Gaussian noise of 0.08 to 0.38 of 255 grey
levels, a Gaussian blur of 1 to 6 of 224 pixels, 3 to 27 % of the values of all channels, 0.1 to 0.5 more brightness.
ImageNet-C's kernels of motion blur are halves of Gaussians of 3 to 15 of 224 pixels. The exposure stated here moves the
road as far as an even smear with their standard deviation, as the mean over the road's pixels of the default camera at
100 km/h straight on.
"""


class Failure(Word):
    """A failure of the camera: in `<camera>` from the start of the run, in `<do>` from that moment on.

    An `amount` of 1 means, by kind. noise: 80 grey levels in addition to the camera's own noise. dropout: every image
    is black. freeze: every image repeats the one before. blackout: no light. blur: a radius of 9/512 of the image's
    width. dirt: the whole lens is covered. impulse_noise: half of all values of the blue, green and red channels are 0
    or 255. overexposure: the image is white; the amount is added to the brightness. dead_rows: every row is black, the
    same rows in every image. quantisation: 2 instead of 256 grey levels, 1 bit instead of 8. latency: images are 1 s
    late. motion_blur: an exposure of 0.1 s, in which the vehicle's own speed and yaw rate smear the road; there is no
    smear at a standstill. misalignment: the camera is turned on its mount by the whole `yaw`, `pitch` and `roll`,
    without the lane detector's knowledge; several misalignments add up.

    With `--perception ideal` the sensor's health is the one that the lane detector would measure in such images. At a
    clear noon it is one half for noise of 30 grey levels, for a blackout of 0.94, a blur of 0.37, dirt of 0.64, impulse
    noise of 0.22, overexposure of 0.73 and dead rows of 0.89. It is 0 for a missing or repeated image, and while a late
    image is awaited. Motion blur and misalignment do not change it.
    """

    word: Literal["failure"] = "failure"

    kind: FailureKind = attribute("Kind of the failure.")
    onset: Number = attribute(
        "Start of the failure, s after the start of the run or after the action.",
        default=0.0,
        quantity="time",
        minimum=0,
    )
    duration: Number | None = attribute(
        "Duration of the failure, ramps included, s; until the end of the run if left out.",
        default=None,
        quantity="time",
        minimum=0,
    )
    ramp: Number = attribute(
        "Time in which the failure grows to its amount, and in which it declines before its end, s.",
        default=0.0,
        quantity="time",
        minimum=0,
    )
    amount: Number = attribute(
        "Severity of the failure; for dropout and freeze the share of affected images.",
        default=1.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    severity: int | None = attribute(
        "Severity of ImageNet-C (Hendrycks and Dietterich 2019), instead of `amount`, for noise, blur, impulse_noise, "
        "overexposure and motion_blur.",
        default=None,
        minimum=1,
        maximum=5,
    )
    yaw: Number = attribute(
        "misalignment: turn of the camera's axis to the left, beyond its mounting, degrees.",
        default=0.0,
        quantity="angle",
        minimum=-30,
        maximum=30,
    )
    pitch: Number = attribute(
        "misalignment: its turn upwards, degrees; negative looks down.",
        default=0.0,
        quantity="angle",
        minimum=-30,
        maximum=30,
    )
    roll: Number = attribute(
        "misalignment: its turn about the axis, degrees; positive lowers its right side.",
        default=0.0,
        quantity="angle",
        minimum=-30,
        maximum=30,
    )

    @property
    def strength(self) -> Number:
        """The amount; from the severity if one is given."""
        if self.severity is None or self.kind not in SEVERITIES:
            return self.amount
        return SEVERITIES[self.kind][self.severity - 1]


MOUNTING = ("width", "height", "fov", "x", "y", "z", "yaw", "pitch", "roll")
"""Names of the properties that determine which points of the vehicle's surroundings a camera sees in which pixels."""


class Camera(Word):
    """The forward camera of the lane detector. The defaults are the AISA toolkit's, at half its image size."""

    word: Literal["camera"] = "camera"

    width: int = attribute("Width of the image, pixels.", default=512, minimum=64, maximum=4096)
    height: int = attribute("Height of the image, pixels.", default=256, minimum=32, maximum=4096)
    fov: float = attribute("Horizontal field of view, degrees.", default=45.0, minimum=5, maximum=170)
    x: float = attribute("Distance ahead of the centre of the vehicle's box, m.", default=0.5)
    y: float = attribute("Distance to the left of that centre, m.", default=0.0)
    z: float = attribute("Height above the ground, m.", default=1.3, minimum=0.1)
    yaw: float = attribute(
        "Rotation of the camera's axis to the left, degrees.", default=0.0, minimum=-180, maximum=180
    )
    pitch: float = attribute("Pitch, degrees; negative values look down.", default=-5.0, minimum=-60, maximum=60)
    roll: float = attribute(
        "Rotation about the camera's axis, degrees; positive values lower its right side.",
        default=0.0,
        minimum=-180,
        maximum=180,
    )
    rate: float | None = attribute(
        "Images per second. The period must be a whole number of control steps; between two images the last detection "
        "is kept. If left out, there is one image per control step.",
        default=None,
        minimum=0.01,
        maximum=1000,
    )
    sensor_noise: Number = attribute(
        "Standard deviation of the Gaussian noise (mean 0) on every channel of every pixel, grey levels.",
        default=0.0,
        quantity="grey_levels",
        minimum=0,
        maximum=255,
    )
    failures: tuple[Failure, ...] = child("Failures of the camera.", default=())

    def control_steps(self, period: float) -> float:
        """Return the number of control steps between two images, for a control period in s; 1 without a rate."""
        return 1.0 if self.rate is None else 1.0 / (self.rate * period)


SensorKind = Literal["camera", "radar", "lidar"]
"""Kind of the forward sensor."""


class ForwardSensor(Word):
    """The sensor with which the automation detects vehicles, pedestrians and objects ahead.

    It is in the middle of the front bumper. Rain, fog, dust and night reduce the range of a camera; rain, fog and dust
    that of a lidar. A radar is hardly affected: of 150 m the thickest fog takes 3 %, and a cloudburst (50 mm/h) 22 %.
    The range follows changes of the weather. A forward camera is the one of `<camera>`: the noise and failures of that
    camera affect it. docs/takeover.md lists the formulas and their sources.
    """

    word: Literal["forward_sensor"] = "forward_sensor"

    kind: SensorKind = attribute("Kind of the sensor.", default="camera")
    range: Number = attribute(
        "Range in clear air, for a camera by day, m.", default=150.0, quantity="length", minimum=1
    )
    field_of_view: Number = attribute(
        "Full horizontal field of view, degrees.", default=radians(60.0), quantity="angle", minimum=1, maximum=360
    )
    headlights: Number | None = attribute(
        "camera: distance at which the vehicle's headlights still give 5 lux at night, m; 100 if left out, the value "
        "of a good low beam.",
        default=None,
        quantity="length",
        minimum=1,
    )
    noise: Number | None = attribute(
        "radar, lidar: receiver noise above the level for which `range` holds, dB; 0 if left out. 12 dB halve the "
        "range.",
        default=None,
        quantity="level",
    )


class Odometry(Word):
    """Errors of the vehicle's own motion estimate while it does not see its lane.

    Each number is the standard deviation of an error with mean 0, which is drawn from the run's seed when the lane is
    lost. The defaults are our own choice: they correspond to the remaining bias of a gyroscope that was compared with
    the lane while the lane was visible, and to wheels whose radius is known to one percent.
    """

    word: Literal["odometry"] = "odometry"

    place_error: Number = attribute(
        "Error of the remembered lateral position in the lane, m.", default=0.05, quantity="length", minimum=0
    )
    heading_error: Number = attribute(
        "Error of the remembered heading relative to the lane, degrees.",
        default=radians(0.05),
        quantity="angle",
        minimum=0,
    )
    gyro_bias: Number = attribute(
        "Bias of the gyroscope, degrees per second.", default=radians(0.01), quantity="angle_rate", minimum=0
    )
    gyro_noise: Number = attribute(
        "Angular random walk of the gyroscope, degrees per square root of a second.",
        default=radians(0.01),
        quantity="angle_random_walk",
        minimum=0,
    )
    distance_error: Number = attribute(
        "Error of the distance measured by the wheels, as a share of it.",
        default=0.01,
        quantity="fraction",
        minimum=0,
    )
