"""The controller that a scenario names: finds its class, makes a new one, and reports its faults.

A user's own controller or lane detector is named `package.module:Class` or `file.py:Class`; it is imported only if
`Trust` allows it. The base class of controllers is imported, with pydantic, when a controller's class is needed.
"""

from __future__ import annotations

import importlib
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, get_args

from scenario_compiler.controllers.detectors import (
    IDLE_DETECTOR,
    UNKNOWN_DETECTOR,
    DetectorMaker,
    detector_maker,
)
from scenario_compiler.controllers.foreign import (
    UNKNOWN_CONTROLLER,
    ControllerError,
    blamed,
    load_class,
)
from scenario_compiler.diagnostics import Code, Diagnostics, Place, Related, Severity, did_you_mean
from scenario_compiler.perception.detectors import DETECTORS
from scenario_compiler.plan.model import Plan
from scenario_compiler.trust import CodeName, Trust, code_name
from scenario_compiler.vocabulary.entities import Controller, Detector, Property
from scenario_compiler.vocabulary.sensors import MOUNTING, Camera

if TYPE_CHECKING:
    from scenario_compiler.controllers.model import ControllerModel, ControllerParams

CONTROLLERS: dict[str, str] = {
    "lane_detection": "scenario_compiler.controllers.lane_detection:LaneDetectionController",
}
"""Name of a controller to its class; the modules are imported only when a controller is made."""

BAD_PROPERTY = Code(
    "SC504",
    "bad-controller-property",
    "A <property> of the controller is not one of its parameters, or has an invalid value. The controller's `Params` "
    "model defines the parameters.\n\n"
    '    <controller model="lane_detection"><property name="look_ahed" value="9"/></controller>',
)
UNTRUSTED_CONTROLLER = Code(
    "SC507",
    "untrusted-controller",
    "The scenario names custom code as its controller or lane detector. Reading a file never runs code that it names. "
    "`validate`, `compile`, `export`, `preview` and `list` therefore check only the form of the name, not the "
    "controller's properties; `run` and `sweep` refuse to run it. Read the code. To trust it once, name the class, "
    "the module, the Python file or the scenario's file with --trust. To trust it permanently, add the class, the "
    "module or the absolute path of the Python file to the list `trust` of your configuration file, "
    "`~/.config/scenario-compiler/config.toml` (see docs/commands.md).\n\n"
    "    scenario-compiler run conflict.xml --trust our_lab.steering:Mine\n"
    '    trust = ["our_lab.steering:Mine"]     in config.toml',
    Severity.WARNING,
)


def controller_class(name: str, trust: Trust | None = None, named_in: str = "") -> type[ControllerModel]:
    """Return the class of a controller by its name, by `package.module:Class` or by `file.py:Class`.

    Args:
        name: The controller's name.
        trust: Code that the user trusts, in addition to the list in the user's configuration file.
        named_in: Path of the file that names it.

    Raises:
        ControllerError: There is no such controller, it is not trusted, or importing it fails.
        ConfigurationError: The user's configuration file cannot be read.
    """
    if name in CONTROLLERS:
        module, _, attribute = CONTROLLERS[name].partition(":")
        ours: type[ControllerModel] = getattr(importlib.import_module(module), attribute)
        return ours
    code = code_name(name)
    if code is None:
        raise ControllerError(f"there is no controller '{name}'")
    trust = trust or Trust()
    if not trust.allows(code, named_in):
        raise ControllerError(_untrusted(name), UNTRUSTED_CONTROLLER)
    loaded: type[ControllerModel] = load_class(name, code, trust, named_in)
    return loaded


def _untrusted(name: str, unchecked: str = ": its properties were not checked") -> str:
    return f"the scenario names custom code, '{name}', which is not trusted{unchecked}"


def _maker_of(detector: Detector, trust: Trust | None) -> DetectorMaker:
    """Return the factory of the detector that a scenario names.

    Raises:
        ControllerError: There is no such detector, it is not trusted, or importing it fails.
        ConfigurationError: The user's configuration file cannot be read.
    """
    named_in, code, trust = detector.place_of("model").file, None, trust or Trust()
    if detector.model not in DETECTORS:
        code = code_name(detector.model)
        if code is not None and not trust.allows(code, named_in):
            raise ControllerError(_untrusted(detector.model, ""), UNTRUSTED_CONTROLLER)
    return detector_maker(detector.model, code, trust, named_in)


def create_controller(controller: Controller, trust: Trust | None = None) -> ControllerModel:
    """Return a new controller as the scenario describes it.

    Raises:
        ControllerError: There is no such controller, it is not trusted, or it cannot be made.
        ConfigurationError: The user's configuration file cannot be read.
        pydantic.ValidationError: A property is wrong; `check_controller` reports that when compiling.
    """
    named_in = controller.place_of("model").file
    found = controller_class(controller.model, trust, named_in)
    params = _params(controller, found, named_in, trust)
    maker = None if controller.detector is None else _maker_of(controller.detector, trust)

    def make() -> ControllerModel:
        made = found(params)
        if maker is not None:
            made.make_detector = maker
        return made

    if controller.model in CONTROLLERS:
        return make()
    from scenario_compiler.controllers.foreign_controller import ForeignController

    return ForeignController(controller.model, found, make)


def _params(
    controller: Controller, found: type[ControllerModel], named_in: str, trust: Trust | None
) -> ControllerParams:
    """Return the controller's parameters from its properties.

    Raises:
        pydantic.ValidationError: A property is wrong.
        ControllerError: A validator of the user's failed.
    """
    from pydantic import ValidationError

    with blamed(controller.model, let_pass=(ValidationError,), code=found.Params):
        return found.Params.model_validate(_values(controller, found, named_in, trust))


def _values(controller: Controller, found: type[ControllerModel], named_in: str, trust: Trust | None) -> dict[str, str]:
    """Return the properties by name; a path that the parameters declare as one starts from the scenario's folder."""
    folder = Path(named_in).parent
    if trust is not None and trust.beside is not None and not Path(named_in).is_file():
        folder = trust.beside
    fields = found.Params.model_fields
    return {
        one.name: str((folder / one.value).resolve())
        if one.name in fields and _is_path(fields[one.name].annotation)
        else one.value
        for one in controller.properties
    }


def _is_path(annotation: Any) -> bool:
    """Return whether a parameter is declared as a path, or as a path or None."""
    if isinstance(annotation, type) and issubclass(annotation, PurePath):
        return True
    return any(_is_path(one) for one in get_args(annotation))


def _is_mounted_otherwise(camera: Camera) -> bool:
    """Return whether a camera does not have the default mounting, which sees the lane."""
    default = Camera.model_construct()
    return any(getattr(camera, name) != getattr(default, name) for name in MOUNTING)


def check_controller(plan: Plan, sink: Diagnostics, trust: Trust | None = None) -> None:
    """Report a controller or a detector that does not exist or sees no lane, and properties that nobody takes.

    Of code that is not trusted only the spelling is checked, which a warning reports. A built-in controller without
    properties is not imported, because its parameters have defaults.

    Raises:
        ConfigurationError: The user's configuration file cannot be read.
    """
    controller = plan.controller
    if controller is None:
        return
    if plan.perception == "camera" and _is_mounted_otherwise(plan.camera):
        from scenario_compiler.controllers.camera_view import check_camera_view  # loads NumPy

        check_camera_view(plan, sink)
    if controller.detector is not None:
        _check_detector(controller.detector, sink, trust)
    if controller.model in CONTROLLERS and not controller.properties and controller.detector is None:
        return
    place = controller.place_of("model")
    try:
        found = controller_class(controller.model, trust, place.file)
    except ControllerError as error:
        report_controller(controller.model, error, place, sink)
        return
    if controller.detector is not None and not found.uses_detector:
        message = f"the controller '{controller.model}' uses no lane detector: '{controller.detector.model}' is ignored"
        sink.add(IDLE_DETECTOR, message, controller.detector.place_of("model"))
    from pydantic import ValidationError

    words = {p.name: p for p in controller.properties}
    try:
        _params(controller, found, place.file, trust)
    except ControllerError as error:
        report_controller(controller.model, error, place, sink)
    except ValidationError as error:
        for fault in error.errors(include_url=False):
            name = str(fault["loc"][0]) if fault["loc"] else ""
            at = words[name].place_of("value") if name in words else place
            hint, message = "", f"property '{name}' of '{controller.model}': {fault['msg']}"
            if fault["type"] == "missing":
                message = f"'{controller.model}' needs the property '{name}'"
                hint = f'write <property name="{name}" value="..."/> in <controller>'
            elif fault["type"] == "extra_forbidden":
                hint, message = _meant(words[name], found), f"'{controller.model}' has no property '{name}'"
            sink.add(BAD_PROPERTY, message, at, hint=hint)


def _meant(written: Property, found: type[ControllerModel]) -> str:
    """Return the hint for a property that does not exist."""
    if written.name == Detector.tag() and found.uses_detector:
        return f'the detector is an element of the controller: <detector model="{written.value}"/>'
    return did_you_mean(written.name, found.Params.model_fields)


def _check_detector(detector: Detector, sink: Diagnostics, trust: Trust | None) -> None:
    try:
        _maker_of(detector, trust)
    except ControllerError as error:
        report_controller(detector.model, error, detector.place_of("model"), sink)


def refuse_untrusted(plan: Plan, sink: Diagnostics, trust: Trust | None = None) -> None:
    """Report an error if a run of the plan would import code that is not trusted; nothing is imported.

    A run with ideal perception calls no controller, so it is not refused.

    Raises:
        ConfigurationError: The user's configuration file cannot be read.
    """
    controller = plan.controller
    if controller is None or plan.perception != "camera":
        return
    named: list[tuple[Controller | Detector, str]] = []
    if controller.model not in CONTROLLERS:
        named.append((controller, _untrusted(controller.model)))
    if controller.detector is not None and controller.detector.model not in DETECTORS:
        named.append((controller.detector, _untrusted(controller.detector.model, "")))
    for word, message in named:
        place, code = word.place_of("model"), code_name(word.model)
        if code is not None and not (trust or Trust()).allows(code, place.file):
            sink.add(UNTRUSTED_CONTROLLER, message, place, hint=_how_to_trust(code), severity=Severity.ERROR)


def report_controller(name: str, error: ControllerError, named_at: Place, sink: Diagnostics) -> None:
    """Report why a controller or detector cannot be used: at the line of its code if known, otherwise at its name."""
    hint = ""
    code = code_name(name)
    if error.code is UNTRUSTED_CONTROLLER and code is not None:
        hint = _how_to_trust(code)
    elif error.code is UNKNOWN_CONTROLLER and code is None:
        hint = did_you_mean(name, CONTROLLERS)
    elif error.code is UNKNOWN_DETECTOR and code is None:
        hint = did_you_mean(name, DETECTORS)
    if error.place.file:
        sink.add(error.code, str(error), error.place, related=(Related("it is named here", named_at),))
    else:
        sink.add(error.code, str(error), named_at, hint=hint)


def _how_to_trust(code: CodeName) -> str:
    return f"read the code; if you trust it, add --trust {code.source}:{code.attribute}"
