"""Checks what the user's controllers and lane detectors return against their interfaces.

Each function returns the answer in the types of the interface, or raises `BadAnswerError` with what is wrong with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from numbers import Complex, Real
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.controllers.data import Control
    from scenario_compiler.perception.lane_detector import LaneResult

COMMANDS = ("throttle", "steer", "brake")
"""Fields of a `Control` that are finite numbers; the engine limits them to their ranges."""

SHARES = ("confidence_left", "confidence_right", "sensor_health")
"""Fields of a `Control` that are probabilities or shares."""


FARTHEST = 1e6
"""Greatest absolute value of a number of a lane boundary; beyond it, points of the boundary have no finite place."""


class BadAnswerError(Exception):
    """An answer is not what the interface requires; the message says what is wrong."""


def control_of(given: object) -> Control:
    """Return a command whose numbers are finite floats and whose probabilities are from 0 to 1."""
    from scenario_compiler.controllers.data import Control

    if not isinstance(given, Control):
        raise BadAnswerError(f"it returned {type(given).__name__}, which is not a Control")
    lanes = None if given.lanes is None else lane_of(given.lanes, "lanes")
    path = _path_of(given.trajectory)
    numbers = {name: _finite(name, getattr(given, name)) for name in COMMANDS}
    numbers |= {name: _share(name, getattr(given, name)) for name in SHARES}
    return Control(**numbers, trajectory=path, lanes=lanes)


def lane_of(given: object, name: str = "") -> LaneResult:
    """Return a lane with finite numbers and with probabilities from 0 to 1; `name` is that of the field that has it."""
    from scenario_compiler.perception.lane_detector import Boundary, LaneResult
    from scenario_compiler.perception.road_plane import Tilt

    if not isinstance(given, LaneResult):
        said = f"{name} is" if name else "it returned"
        raise BadAnswerError(f"{said} {type(given).__name__}, which is not a LaneResult")
    for side, one in (("left", given.left), ("right", given.right)):
        of_side = f"of the {side} boundary"
        if not isinstance(one, Boundary):
            raise BadAnswerError(f"the {side} boundary is {type(one).__name__}, which is not a Boundary")
        for number in ("y0", "slope", "curvature"):
            if abs(_finite(f"{number} {of_side}", getattr(one, number))) > FARTHEST:
                raise BadAnswerError(f"{number} {of_side} is {getattr(one, number)}")
        for share in ("p", "p_geom", "p_paint"):
            _share(f"{share} {of_side}", getattr(one, share))
        _point(f"x_range {of_side}", one.x_range)
    for share in ("p_left", "p_right", "sensor_health"):
        _share(share, getattr(given, share))
    for number in ("sigma_hat", "lane_width"):
        _finite(number, getattr(given, number))
    if not isinstance(given.tilt, Tilt):
        raise BadAnswerError(f"tilt is {type(given.tilt).__name__}, which is not a Tilt")
    for number in ("pitch", "deviation"):
        _finite(f"{number} of tilt", getattr(given.tilt, number))
    return given


def texts_of(given: object) -> list[str]:
    """Return a list of texts."""
    if not isinstance(given, list | tuple) or not all(isinstance(one, str) for one in given):
        raise BadAnswerError(f"it returned {_shown(given)}, which is not a list of texts")
    return list(given)


def labels_of(given: object) -> dict[str, str]:
    """Return texts by label; labels and values of other types are converted."""
    if not isinstance(given, Mapping):
        raise BadAnswerError(f"it returned {_shown(given)}, which is not a dict of texts")
    return {str(label): str(value) for label, value in given.items()}


def truth_of(given: object) -> bool:
    """Return True or False."""
    import numpy as np

    if not isinstance(given, bool | np.bool_):
        raise BadAnswerError(f"it returned {_shown(given)}, which is neither True nor False")
    return bool(given)


def image_of(given: object, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return an image of the same shape and type as `image`."""
    import numpy as np

    if not isinstance(given, np.ndarray):
        raise BadAnswerError(f"it returned {type(given).__name__}, which is not an image")
    if given.shape != image.shape or given.dtype != image.dtype:
        wrong, right = (f"{one.dtype} of shape {one.shape}" for one in (given, image))
        raise BadAnswerError(f"it returned an image of {wrong} in place of {right}")
    return given


def _finite(name: str, value: Any) -> float:
    """Return a number as a float; scalars of numpy and of other libraries for arrays are numbers too."""
    is_text = isinstance(value, str | bytes | bytearray)
    if is_text or (isinstance(value, Complex) and not isinstance(value, Real)):
        raise BadAnswerError(f"{name} is {_shown(value)}, which is not a number")
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        raise BadAnswerError(f"{name} is {_shown(value)}, which is not a number") from None
    if not math.isfinite(number):
        raise BadAnswerError(f"{name} is {number}")
    return number


def _share(name: str, value: object) -> float:
    share = _finite(name, value)
    if not 0.0 <= share <= 1.0:
        raise BadAnswerError(f"{name} is {value}, not from 0 to 1")
    return share


def _point(name: str, value: Any) -> tuple[float, float]:
    try:
        x, y = value
    except (TypeError, ValueError):
        raise BadAnswerError(f"{name} is {_shown(value)}, which is not a pair of numbers") from None
    return _finite(name, x), _finite(name, y)


def _path_of(given: Any) -> tuple[tuple[float, float], ...]:
    try:
        points: tuple[Any, ...] = tuple(given)
    except TypeError:
        raise BadAnswerError(f"trajectory is {_shown(given)}, which is not a list of points") from None
    return tuple(_point(f"point {k} of trajectory", point) for k, point in enumerate(points))


def _shown(value: object) -> str:
    """Return a short text for a value of any type."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:60]}..."
