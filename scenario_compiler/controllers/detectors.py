"""Finds the lane detector that a scenario names: a built-in one, or a trusted class of the user's."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from scenario_compiler.controllers.answers import lane_of
from scenario_compiler.controllers.foreign import ControllerError, ForeignCode, Kind, load_class
from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.perception.detectors import DETECTORS, create_detector
from scenario_compiler.trust import CodeName, Trust

if TYPE_CHECKING:
    from scenario_compiler.perception.camera import Camera
    from scenario_compiler.perception.lane_detector import Image, LaneDetector, LaneResult, LaneState

DetectorMaker: TypeAlias = "Callable[[Camera], LaneDetector]"
"""A function that makes a detector for a camera."""

UNKNOWN_DETECTOR = Code(
    "SC527",
    "unknown-detector",
    "The scenario names a lane detector that is neither a built-in one nor a class with a method `detect` that can be "
    "found as `package.module:Class` or `file.py:Class`. The search for modules and files is the same as for "
    "controllers (SC503).\n\n"
    '    <controller><detector model="clasical"/></controller>     classical, learned, package.module:Class or '
    "file.py:Class",
)
IDLE_DETECTOR = Code(
    "SC528",
    "idle-detector",
    "The controller does not use a lane detector, so the detector is ignored. `lane_detection` uses one, as do your "
    "own controllers that derive from it or set `uses_detector`.\n\n"
    '    <controller model="mine.py:Straight"><detector model="learned"/></controller>',
    Severity.WARNING,
)
DETECTOR = Kind(
    "lane detector",
    UNKNOWN_DETECTOR,
    lambda found: (
        ""
        if isinstance(found, type) and callable(getattr(found, "detect", None))
        else "is not a class with a method `detect`"
    ),
)


def detector_maker(name: str, code: CodeName | None, trust: Trust, named_in: str) -> DetectorMaker:
    """Return the factory of the detectors with a name; user code is imported, which the caller has allowed.

    Args:
        name: The name of a built-in detector, or of code.
        code: The code for the name; None if the detector is built in.
        trust: The code that the user trusts.
        named_in: Path of the file that names it.

    Raises:
        ControllerError: There is no such detector, or importing it fails.
    """
    if name in DETECTORS:
        return partial(create_detector, name)
    if code is None:
        raise ControllerError(f"there is no lane detector '{name}'", UNKNOWN_DETECTOR)
    found = load_class(name, code, trust, named_in, DETECTOR)
    return lambda camera: ForeignDetector(name, found, camera)


class ForeignDetector:
    """A detector of the user's; its exceptions and wrong answers become a ControllerError."""

    def __init__(self, name: str, made_by: Callable[[Camera], LaneDetector], camera: Camera) -> None:
        """Make the detector for a camera.

        Raises:
            ControllerError: It cannot be made.
        """
        self._code = ForeignCode(name, DETECTOR, made_by, partial(made_by, camera))

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """See `LaneDetector`. A result that is not a lane of finite numbers and probabilities is also an error.

        Raises:
            ControllerError: It failed.
        """
        return self._code.ask("detect", lane_of, image, prior, pitch)
