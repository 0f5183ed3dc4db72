"""Sensors of the ego vehicle, and how they fail."""

from math import radians
from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, child

Perception = Literal["camera", "ideal", "surrogate"]
"""What the lane confidence comes from: the camera's image, the map's marks, or a function that was fitted to what the
camera's detector says."""

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
"""How a camera fails. Secci and Ceccarelli (arXiv 2008.05938) call blackout "black", overexposure "brightness" and, in
full, "white", dead rows lines of "dead pixels", and noise "no noise reduction"; blur and dirt are theirs too."""

EXPOSURE_AT_ONE = 0.1
"""Exposure of motion blur of the amount 1, s."""

SEVERITIES: dict[FailureKind, tuple[float, float, float, float, float]] = {
    "noise": (0.255, 0.3825, 0.57375, 0.82875, 1.21125),
    "blur": (0.254, 0.508, 0.762, 1.016, 1.524),
    "impulse_noise": (0.06, 0.12, 0.18, 0.34, 0.54),
    "overexposure": (0.1, 0.2, 0.3, 0.4, 0.5),
    "motion_blur": (0.256, 0.42, 0.665, 0.932, 1.185),
}
"""Amounts of the severities 1 to 5 of ImageNet-C, as its make_imagenet_c.py has them: Gaussian noise of 0.08 to 0.38 of
255 grey levels, a Gaussian blur of 1 to 6 of 224 pixels, 3 to 27 % of the pixels, 0.1 to 0.5 more brightness. Motion
blur: the exposure in which the road, in the mean over its pixels of the default camera at 100 km/h straight on, moves
as far as an even smear with the standard deviation of its kernels, halves of Gaussians of 3 to 15 of 224 pixels."""


class Failure(Word):
    """A failure of the camera: in `<camera>` from the start of the run, in `<do>` from that moment on.

    What `amount` 1 means: noise of 80 grey levels beside the camera's own; every image missing (dropout: black images)
    or repeated (freeze); no light (blackout); a blur with a radius of 9/512 of the image's width; all of the lens
    behind dirt; half of all pixels black or white (impulse_noise); an image that is white (overexposure: what is added
    to the brightness); every row black (dead_rows, the same rows in every image); 2 in place of 256 grey levels
    (quantisation: 1 bit of 8); images that are 1 s late (latency); an exposure of 0.1 s, in which the road is smeared
    by the vehicle's own speed and yaw rate (motion_blur: nothing at a standstill); a camera that is turned on its mount
    by the whole `yaw`, `pitch` and `roll`, which nobody tells the lane detector (misalignment: several of them add up).
    With `--perception ideal` the sensor's health falls by the same curves that the lane detector applies to its images:
    noise is one half at 30 grey levels, blackout at 0.94, blur at 0.5, dirt at 0.5; a missing or repeated image has no
    health. Of the last seven ideal perception knows nothing: pictures alone show them.
    """

    word: Literal["failure"] = "failure"

    kind: FailureKind = attribute("What goes wrong.")
    onset: Number = attribute(
        "When it begins, s after the start of the run or after the action.", default=0.0, quantity="time", minimum=0
    )
    duration: Number | None = attribute(
        "How long it lasts, ramps included, s; for good when left out.", default=None, quantity="time", minimum=0
    )
    ramp: Number = attribute(
        "Time in which it grows to its amount, and goes before its end, s.", default=0.0, quantity="time", minimum=0
    )
    amount: Number = attribute(
        "How severe it is; for dropout and freeze the share of the images.",
        default=1.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    severity: int | None = attribute(
        "In place of `amount`: the severity of ImageNet-C (Hendrycks and Dietterich 2019), of noise, blur, "
        "impulse_noise, overexposure and motion_blur.",
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
        """The amount, by the severity where one is given."""
        if self.severity is None or self.kind not in SEVERITIES:
            return self.amount
        return SEVERITIES[self.kind][self.severity - 1]


class Camera(Word):
    """The forward camera that the lane detector sees through. Defaults are the AISA toolkit's, at half its size."""

    word: Literal["camera"] = "camera"

    width: int = attribute("Width of the image, pixels.", default=512, minimum=64, maximum=4096)
    height: int = attribute("Height of the image, pixels.", default=256, minimum=32, maximum=4096)
    fov: float = attribute("Horizontal field of view, degrees.", default=45.0, minimum=5, maximum=170)
    x: float = attribute("Distance ahead of the centre of the vehicle's box, m.", default=0.5)
    y: float = attribute("Distance to the left of that centre, m.", default=0.0)
    z: float = attribute("Height above the ground, m.", default=1.3, minimum=0.1)
    yaw: float = attribute("Turn of its axis to the left, degrees.", default=0.0, minimum=-180, maximum=180)
    pitch: float = attribute("Pitch, degrees; negative looks down.", default=-5.0, minimum=-60, maximum=60)
    roll: float = attribute(
        "Turn about its axis, degrees; positive lowers its right side.", default=0.0, minimum=-180, maximum=180
    )
    rate: float | None = attribute(
        "Images per second: their period is a number of control steps. Between two images the detection in the last "
        "one stays. One image at each control step when left out.",
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
    failures: tuple[Failure, ...] = child("How it fails.", default=())

    def control_steps(self, period: float) -> float:
        """Return how many control steps of a period, s, lie between two images: 1 when there is no rate."""
        return 1.0 if self.rate is None else 1.0 / (self.rate * period)


SensorKind = Literal["camera", "radar", "lidar"]
"""What the forward sensor is."""


class ForwardSensor(Word):
    """What the automation sees vehicles, people and things ahead with, from the middle of its front bumper.

    Rain, fog, dust and night shorten what a camera sees, rain, fog and dust what a lidar sees; a radar is hardly
    touched: of 150 m the thickest fog takes 3 %, and a cloudburst (50 mm/h) 22 %. It follows the weather while
    that changes. A camera is the one of `<camera>`: its noise and its failures count. docs/takeover.md has the formulas
    and their sources.
    """

    word: Literal["forward_sensor"] = "forward_sensor"

    kind: SensorKind = attribute("What it is.", default="camera")
    range: Number = attribute(
        "How far it sees in clear air, by day for a camera, m.", default=150.0, quantity="length", minimum=1
    )
    field_of_view: Number = attribute(
        "Its full angle, degrees.", default=radians(60.0), quantity="angle", minimum=1, maximum=360
    )
    headlights: Number | None = attribute(
        "camera: how far the vehicle's headlights reach at night, to 5 lux, m; 100 when left out, a good low beam.",
        default=None,
        quantity="length",
        minimum=1,
    )
    noise: Number | None = attribute(
        "radar, lidar: noise at the receiver above that for which `range` holds, dB; 0 when left out. 12 dB halve the "
        "range.",
        default=None,
        quantity="level",
    )


class Odometry(Word):
    """What the vehicle knows of its own motion while it does not see its lane, and how wrong that is.

    Each number is the standard deviation of an error with mean 0, drawn by the run's seed when the lane is lost. The
    defaults are chosen: what is left of a gyroscope's bias when it has been compared with the lane for as long as that
    was seen, and of wheels whose radius is known to a percent.
    """

    word: Literal["odometry"] = "odometry"

    place_error: Number = attribute(
        "Error of the place in the lane that is remembered, m.", default=0.05, quantity="length", minimum=0
    )
    heading_error: Number = attribute(
        "Error of the heading in the lane that is remembered, degrees.",
        default=radians(0.05),
        quantity="angle",
        minimum=0,
    )
    gyro_bias: Number = attribute(
        "Bias of the gyroscope, degrees a second.", default=radians(0.01), quantity="angle_rate", minimum=0
    )
    gyro_noise: Number = attribute(
        "Random walk of its angle, degrees by the square root of a second.",
        default=radians(0.01),
        quantity="angle_random_walk",
        minimum=0,
    )
    distance_error: Number = attribute(
        "Error of the distance that the wheels measure, as a share of it.",
        default=0.01,
        quantity="fraction",
        minimum=0,
    )
