"""What ends a run before its end, beside a lost world: the codes, and the place in a controller that failed."""

from __future__ import annotations

import inspect
import traceback
from pathlib import Path

from scenario_compiler.controllers import ControllerModel
from scenario_compiler.diagnostics import Code
from scenario_compiler.vocabulary.entities import Controller

CONTROLLER_FAILED = Code(
    "SC521",
    "controller-failed",
    "The controller of the ego vehicle raised an exception, or ended the program, while it was made or while it drove. "
    "The message has its file and line. What was recorded until then is kept, and the run's stop reason is "
    "`controller_failed`."
    "\n\n    scenario-compiler run conflict.xml --controller my_controller.py:Mine --seed 7     repeats the run",
)
ENGINE_BROKE_OFF = Code(
    "SC522",
    "engine-broke-off",
    "The engine's arithmetic had no result, such as a division by zero: a fault of the program, not of the scenario. "
    "What was recorded until then is kept. Please report it with the scenario and the seed."
    "\n\n    scenario-compiler run conflict.xml --seed 7 --interpreted     gives the same with Python's own debugger",
)


class ControllerError(Exception):
    """A controller failed; the message names it, its file and its line."""

    @classmethod
    def of(cls, named: Controller | None, model: ControllerModel | None, error: BaseException) -> ControllerError:
        """Return the failure of a controller.

        Args:
            named: How the plan names it.
            model: The controller, None while it is being made.
            error: What it raised.
        """
        name = "" if named is None else named.model
        frames = traceback.extract_tb(error.__traceback__)
        own = "" if model is None else inspect.getfile(type(model))
        place = next((frame for frame in reversed(frames) if frame.filename == own), frames[-1])
        what = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
        return cls(f"controller '{name}', {Path(place.filename).name}:{place.lineno}: {what}")
