"""What drives the ego vehicle from Python between steps, and the table of its names.

In: camera images, speed and the vehicle's state. Out: throttle, steer and brake. Imports perception, the plan and the
hall. A controller of one's own is named `package.module:Class`.
"""

from __future__ import annotations

import importlib

from pydantic import ValidationError

from scenario_compiler.controllers.model import (
    CameraMounting,
    Control,
    ControllerModel,
    ControllerParams,
    SensorData,
    VehicleState,
)
from scenario_compiler.diagnostics import Code, Diagnostics, did_you_mean
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.vocabulary.entities import Controller

CONTROLLERS: dict[str, str] = {
    "lane_detection": "scenario_compiler.controllers.lane_detection:LaneDetectionController",
}
"""Name of a controller to its class; the modules are imported only when a controller is made."""

UNKNOWN_CONTROLLER = Code(
    "SC503",
    "unknown-controller",
    "The scenario names a controller that is neither one of ours nor a class that can be imported as "
    "`package.module:Class` and derives from ControllerModel. A class of your own must be importable where the command "
    "runs (set PYTHONPATH)."
    '\n\n    <controller model="lane_detecton"/>     lane_detection, or package.module:Class',
)
BAD_PROPERTY = Code(
    "SC504",
    "bad-controller-property",
    "A <property> of the controller is not one of its parameters, or its value is not one the parameter takes. The "
    "controller's `Params` model says which there are."
    '\n\n    <controller model="lane_detection"><property name="look_ahed" value="9"/></controller>',
)


class UnknownControllerError(LookupError):
    """No controller of that name can be made; the message says why."""


def controller_class(name: str) -> type[ControllerModel]:
    """Return the class of a controller by its name or by `package.module:Class`.

    Raises:
        UnknownControllerError: There is no such controller.
    """
    target = CONTROLLERS.get(name, name)
    module, colon, attribute = target.partition(":")
    if not colon:
        raise UnknownControllerError(f"there is no controller '{name}'")
    try:
        found = getattr(importlib.import_module(module), attribute)
    except (ImportError, AttributeError, ValueError) as error:
        raise UnknownControllerError(f"cannot import the controller '{name}': {error}") from error
    if not (isinstance(found, type) and issubclass(found, ControllerModel)):
        raise UnknownControllerError(f"'{name}' does not derive from ControllerModel")
    return found


def create_controller(controller: Controller) -> ControllerModel:
    """Return a new controller as the scenario describes it.

    Raises:
        UnknownControllerError: There is no such controller.
        pydantic.ValidationError: A property is wrong; `check_controller` reports that when compiling.
    """
    found = controller_class(controller.model)
    return found(found.Params.model_validate({p.name: p.value for p in controller.properties}))


def check_controller(plan: Plan, sink: Diagnostics) -> None:
    """Report a controller that does not exist and properties that it does not take.

    One of ours without properties is not even imported: its parameters have defaults.
    """
    controller = plan.controller
    if controller is None or (controller.model in CONTROLLERS and not controller.properties):
        return
    try:
        found = controller_class(controller.model)
    except UnknownControllerError as error:
        hint = did_you_mean(controller.model, CONTROLLERS)
        sink.add(UNKNOWN_CONTROLLER, str(error), controller.place_of("model"), hint=hint)
        return
    words = {p.name: p for p in controller.properties}
    try:
        found.Params.model_validate({name: word.value for name, word in words.items()})
    except ValidationError as error:
        for fault in error.errors(include_url=False):
            name = str(fault["loc"][0]) if fault["loc"] else ""
            place = words[name].place_of("value") if name in words else place_of(plan, "controller")
            hint = did_you_mean(name, found.Params.model_fields) if fault["type"] == "extra_forbidden" else ""
            sink.add(BAD_PROPERTY, f"property '{name}' of '{controller.model}': {fault['msg']}", place, hint=hint)


__all__ = [
    "CONTROLLERS",
    "CameraMounting",
    "Control",
    "ControllerModel",
    "ControllerParams",
    "SensorData",
    "UnknownControllerError",
    "VehicleState",
    "check_controller",
    "controller_class",
    "create_controller",
]
