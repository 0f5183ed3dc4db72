"""Actions on the ego vehicle's sensors."""

from typing import Literal

from scenario_compiler.vocabulary.sensors import FailureKind
from scenario_compiler.vocabulary.word import Number, Word, attribute


class SensorNoiseAction(Word):
    """Set the camera's noise from now on, for example when a sensor failure begins or ends."""

    word: Literal["sensor_noise"] = "sensor_noise"

    sigma: Number = attribute(
        "Standard deviation of the Gaussian noise (mean 0) on every channel of every pixel, grey levels.",
        quantity="grey_levels",
        minimum=0,
        maximum=255,
    )


class EndFailureAction(Word):
    """End the camera's active failures. To end `noise` also ends the camera's own noise."""

    word: Literal["end_failure"] = "end_failure"

    kind: FailureKind | None = attribute("Kind of failures to end; all if left out.", default=None)
