"""The first-person pictures that a recording keeps."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, get_args

from scenario_compiler.plan.model import Plan
from scenario_compiler.runtime.messages import message_text
from scenario_compiler.vocabulary.takeover import Told

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.controllers.data import CameraMounting, Control, SensorData
    from scenario_compiler.controllers.model import ControllerModel

STATES = {"response": "manual", "collision": "collision"}


def picture_of(
    plan: Plan,
    view: NDArray[np.uint8],
    seen: SensorData,
    controller: ControllerModel,
    control: Control,
    speed: float,
    kind: str,
    cause: str,
) -> bytes:
    """Return the driver's view with the camera's image, the detected lanes, the path and the messages, as a PNG file.

    Args:
        plan: The plan of the run.
        view: The driver's view, BGR.
        seen: The camera's latest image.
        controller: The controller, for its drawing and its texts.
        control: Its latest output.
        speed: Speed of the ego vehicle, m/s.
        kind: Kind of the event.
        cause: Cause of the request, empty without one.
    """
    from scenario_compiler.perception.overlay import Caption, compose, encode_png

    asked = kind in get_args(Told)
    said = [text for text in [message_text(kind, cause, ("what", "why"))] if text]
    notes = [] if control.lanes else [f"{label} {value}" for label, value in controller.display_info().items()]
    caption = Caption(
        time=seen.t,
        speed=speed,
        state=STATES.get(kind, kind),
        notes=notes,
        warnings=((said if kind == "warning" else []) + controller.warning_messages()) if asked else (),
        alarms=(said + controller.critical_messages()[:1]) if asked and kind != "warning" else (),
    )
    inset = controller.overlay_image(seen.image)
    path = camera_path(control, seen.camera, plan.ego.vehicle.center)
    return encode_png(compose(view, inset, control.lanes, path, caption, sensor=seen.camera.camera()))


def camera_path(control: Control, camera: CameraMounting, center: float) -> list[tuple[float, float]] | None:
    """Return the predicted path from the camera's foot point; None if there is none."""
    ahead = center + camera.x
    return [(x - ahead, y - camera.y) for x, y in control.trajectory if math.isfinite(x + y)] or None
