"""The table of lane detectors by name; a detector's module is imported when the detector is created."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from scenario_compiler.perception.camera import Camera
    from scenario_compiler.perception.confidence import Confidence
    from scenario_compiler.perception.lane_detector import CalibratedDetector

DetectorName = Literal["classical", "learned"]
"""Names of the detectors."""

DETECTORS: dict[DetectorName, str] = {
    "classical": "scenario_compiler.perception.lane_detector:ClassicalLaneDetector",
    "learned": "scenario_compiler.perception.learned_detector:LearnedLaneDetector",
}
"""Class of each detector, by name."""


def detector_class(name: DetectorName) -> type[CalibratedDetector]:
    """Return the class of a detector."""
    module, _, attribute = DETECTORS[name].partition(":")
    found: type[CalibratedDetector] = getattr(importlib.import_module(module), attribute)
    return found


def create_detector(
    name: DetectorName, camera: Camera | None = None, confidence: Confidence | None = None
) -> CalibratedDetector:
    """Return a detector for a camera, by default for the default camera and with the packaged confidence."""
    return detector_class(name)(camera, confidence=confidence)
