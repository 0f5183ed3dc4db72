"""Finds the lane detector that a scenario names: a built-in one, or a trusted class of the user's."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from scenario_compiler.controllers.foreign import ControllerError, Kind, blamed, load_class
from scenario_compiler.diagnostics import Code, FilePlace, Severity
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
    lambda found: isinstance(found, type) and callable(getattr(found, "detect", None)),
    "have a method `detect`",
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
    """A detector of the user's; its exceptions become a ControllerError."""

    def __init__(self, name: str, made_by: Callable[[Camera], LaneDetector], camera: Camera) -> None:
        """Make the detector for a camera.

        Raises:
            ControllerError: It cannot be made.
        """
        self.name = name
        with blamed(name, DETECTOR):
            self._inner = made_by(camera)

    def detect(self, image: Image, prior: LaneState | None = None, pitch: float | None = None) -> LaneResult:
        """See `LaneDetector`. A result that is not a lane of finite numbers and probabilities is also an error.

        Raises:
            ControllerError: It failed.
        """
        from scenario_compiler.perception.lane_detector import LaneResult

        with blamed(self.name, DETECTOR):
            found: object = self._inner.detect(image, prior, pitch)
        if not isinstance(found, LaneResult):
            raise self._misbehaved(f"it returned {type(found).__name__}, which is not a LaneResult")
        for side, one in (("left", found.left), ("right", found.right)):
            for number in ("y0", "slope", "curvature"):
                if not math.isfinite(getattr(one, number)):
                    raise self._misbehaved(f"{number} of the {side} boundary is {getattr(one, number)}")
            for share in ("p", "p_geom", "p_paint"):
                if not 0.0 <= getattr(one, share) <= 1.0:
                    raise self._misbehaved(f"{share} of the {side} boundary is {getattr(one, share)}, not from 0 to 1")
        return found

    def _misbehaved(self, what: str) -> ControllerError:
        code = getattr(inspect.unwrap(type(self._inner).detect), "__code__", None)
        place = FilePlace("") if code is None else FilePlace(code.co_filename, code.co_firstlineno)
        return ControllerError.at(self.name, place, what, DETECTOR)
