"""The coefficients of surrogate perception: their file, place in a program, and range of validity."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.engine.columns.view import HIDDEN, VIEW_NAMES, VIEW_SIZE
from scenario_compiler.engine.ego.surrogate import COEFFICIENTS
from scenario_compiler.engine.program.builder import ProgramBuilder
from scenario_compiler.plan.model import Plan
from scenario_compiler.vocabulary.entities import Controller
from scenario_compiler.vocabulary.sensors import MOUNTING, FailureKind

FILE = "surrogate.json"

UNFITTED: tuple[FailureKind, ...] = ("motion_blur", "misalignment")
"""Failures of the camera that were not part of the fit."""

NO_SURROGATE = Code(
    "SC514",
    "no-surrogate",
    "Surrogate perception was fitted to one controller, `lane_detection`, with the classical detector and the "
    "default camera mounting. It is not valid for another controller, detector or mounting:\n\n"
    '    <controller><detector model="learned"/></controller>     with --perception surrogate\n\n'
    "Run such a scenario with `--perception camera`. `python tools/fit_surrogate.py` fits the coefficients again.",
)


class Surrogate(NamedTuple):
    """The fit of surrogate perception: its conditions and its coefficients.

    Attributes:
        detector: The lane detector that it replaces.
        camera: The camera that must be the same as in the fit, by the names of `MOUNTING`.
        runs: Number of runs that it was fitted to.
        probes: The detector's output for pictures that the renderer draws for this purpose
            (`perception.calibration.probes`). If it has changed, the coefficients are those of another detector or
            renderer.
        low: (VIEW_SIZE,) least value of each feature in the domain.
        high: (VIEW_SIZE,) greatest value.
        first: (VIEW_SIZE + 1, UNITS) weights of each feature, and last the bias, for hidden units and outputs.
        second: (HIDDEN, OUTPUTS) weights of each hidden unit for the outputs.
        noise: Size and cell length, m, of the logit's noise; the same of the path's, m.
    """

    detector: str
    camera: dict[str, float]
    runs: int
    probes: tuple[tuple[float, ...], ...]
    low: tuple[float, ...]
    high: tuple[float, ...]
    first: tuple[tuple[float, ...], ...]
    second: tuple[tuple[float, ...], ...]
    noise: tuple[float, ...]

    @property
    def numbers(self) -> tuple[float, ...]:
        """The coefficients in the order of `ego.surrogate`."""
        rows = [number for row in (*self.first, *self.second) for number in row]
        return (*self.low, *self.high, *rows, *self.noise)


def read_surrogate(text: str) -> Surrogate:
    """Return the coefficients in the text of a file.

    Raises:
        RuntimeError: It was made for other features, or for a network of another size.
    """
    data: dict[str, Any] = json.loads(text)
    if tuple(data.pop("features")) != VIEW_NAMES:
        raise RuntimeError(f"{FILE} was made for other features; run `python tools/fit_surrogate.py`")
    found = Surrogate(**{name: _frozen(value) for name, value in data.items()})
    if len(found.first) != VIEW_SIZE + 1 or len(found.second) != HIDDEN or len(found.low) != VIEW_SIZE:
        raise RuntimeError(f"{FILE} was made for a network of another size; run `python tools/fit_surrogate.py`")
    return found


def surrogate_text(surrogate: Surrogate) -> str:
    """Return the text of the file for coefficients."""
    data = {"features": VIEW_NAMES, **surrogate._asdict()}
    return json.dumps(data, separators=(",", ":")).replace("],", "],\n") + "\n"


@lru_cache(maxsize=1)
def load_surrogate() -> Surrogate:
    """Return the packaged coefficients."""
    return read_surrogate(Path(__file__).with_name(FILE).read_text("utf-8"))


def add_surrogate(draft: ProgramBuilder) -> None:
    """Append the coefficients."""
    numbers = load_surrogate().numbers
    if len(numbers) != COEFFICIENTS:
        raise RuntimeError(f"{len(numbers)} numbers of surrogate perception in place of {COEFFICIENTS}")
    draft.program.surrogate_const[0] = draft.block(*numbers)


def check_surrogate(plan: Plan, sink: Diagnostics) -> None:
    """Report a controller, a detector, a camera or a camera failure that the coefficients were not fitted for."""
    controller = plan.controller
    if controller is None:
        return
    fitted = load_surrogate()
    hint = "--perception camera runs it"
    if controller.model != Controller.model_construct().model:
        message = f"surrogate perception cannot replace the controller '{controller.model}'"
        sink.add(NO_SURROGATE, message, controller.place_of("model"), hint=hint)
    detector = controller.detector
    if detector is not None and detector.model != fitted.detector:
        message = f"surrogate perception was fitted to the detector '{fitted.detector}', not '{detector.model}'"
        sink.add(NO_SURROGATE, message, detector.place_of("model"), hint=hint)
    for failure in plan.failures:
        if failure.kind in UNFITTED:
            message = f"surrogate perception was not fitted to failures of the kind '{failure.kind}'"
            sink.add(NO_SURROGATE, message, failure.place_of("kind"), hint=hint)
    for name in MOUNTING:
        value = getattr(plan.camera, name)
        if value != fitted.camera[name]:
            message = (
                f"surrogate perception was fitted to a camera whose {name} is {fitted.camera[name]:g}, not {value:g}"
            )
            sink.add(NO_SURROGATE, message, plan.camera.place_of(name), hint=hint)


def _frozen(value: Any) -> Any:
    """Return a JSON value with tuples instead of lists."""
    return tuple(_frozen(one) for one in value) if isinstance(value, list) else value
