"""Actions on the control of an entity.

A controller is recognised by the class that files for esmini name, or by its own name. A controller without a
counterpart here is reported, and its entity is then driven only by the storyboard.
"""

from __future__ import annotations

from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.openscenario.catalogs import given
from scenario_compiler.openscenario.codes import NOT_READ
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.own import OWN
from scenario_compiler.openscenario.parameters import with_parameters
from scenario_compiler.openscenario.spelling import Fields, Form, made, regular
from scenario_compiler.vocabulary.actions import (
    ActivateControllerAction,
    AssignControllerAction,
    ControllerProperty,
    OverrideControllerAction,
)

UNKNOWN_CONTROLLER = Code(
    "SC782",
    "controller-of-others",
    "A file names a controller of another program that has no counterpart here, so the storyboard alone drives the "
    "entity:\n\n"
    '    <Controller name="sumoController">\n'
    '        <Properties><Property name="esminiController" value="SumoController"/></Properties>\n'
    "    </Controller>\n\n"
    "Known are ACCController, ALKS_R157SM, ECE_ALKS_RefDriver, ExternalController, FollowRouteController, "
    "HIDController, InteractiveController and UDPDriverController. Trajectories will differ from a run with the "
    "other program.",
    Severity.WARNING,
)

MODELS = {
    "default": "default",
    "defaultcontroller": "default",
    "acc": "acc",
    "acccontroller": "acc",
    "external": "external",
    "externalcontroller": "external",
    "hidcontroller": "external",
    "interactivecontroller": "external",
    "udpdrivercontroller": "external",
    "followroute": "follow_route",
    "followroutecontroller": "follow_route",
    "alkscontroller": "alks",
    "alksr157sm": "alks",
    "alksr157smcontroller": "alks",
    "controlleralksr157sm": "alks",
    "ecealksrefdriver": "alks",
    "ecealksrefdrivercontroller": "alks",
    "controllerecealksrefdriver": "alks",
}
"""Models of controllers by their names in lower case, without other characters than letters and digits."""

CLASS = "esminiController"
"""The property for a controller's class in files for esmini."""

_ACTIVATION = {"longitudinal": "activateLongitudinal", "lateral": "activateLateral"}


def read_controller(node: Node) -> AssignControllerAction:
    """Return the controller that a <Controller> describes; report one without a counterpart here."""
    node = with_parameters(node)
    name = node.text("name", "")
    node.text("controllerType", "")
    properties = _properties(node, as_written=name == OWN)
    if name == OWN:
        return AssignControllerAction.model_construct(name=name, properties=properties).written_at(node.origin)
    named = next((one.value for one in properties if one.name == CLASS), "")
    model = _model(named) or ("" if named else _model(name))
    if not model:
        message = f"the controller '{named or name}' has no counterpart here: the storyboard alone drives the entity"
        node.report(UNKNOWN_CONTROLLER, message, "name")
    found = AssignControllerAction.model_construct(name=name, model=model or "default", properties=properties)
    return found.written_at(node.origin)


def read_held(held: Node, controller: Node) -> AssignControllerAction:
    """Return the controller of an <ObjectController>, which may give it a name of its own since 1.3."""
    found = read_controller(controller)
    name = held.text("name", "") if held.tag == "ObjectController" else ""
    return found.model_copy(update={"name": name}) if name and found.name != OWN else found


def _model(name: str) -> str:
    return MODELS.get("".join(letter for letter in name.lower() if letter.isalnum()), "")


def _properties(node: Node, *, as_written: bool) -> tuple[ControllerProperty, ...]:
    found = [one for group in node.children("Properties") for one in group.children("Property")]
    return tuple(_property(one, as_written=as_written) for one in found)


def _property(node: Node, *, as_written: bool) -> ControllerProperty:
    value = _value(node, as_written=as_written)
    return ControllerProperty.model_construct(name=node.text("name"), value=value).written_at(node.origin)


def _value(node: Node, *, as_written: bool) -> str:
    """Return a property's value; with `as_written` verbatim, as it may contain expressions of the conflict language."""
    node.has("value")
    return str(node.element.get("value", "")) if as_written else node.text("value")


def _read_assign(node: Node) -> AssignControllerAction | None:
    held = node.child("ObjectController") or node
    controller = given(held, "Controller")
    if controller is None:
        if held.child("CatalogReference") is None:
            held.required("Controller", "CatalogReference")
        return None
    found = read_held(held, controller)
    activated = {field: _optional(node, name) for field, name in _ACTIVATION.items()}
    return found.model_copy(update=activated).written_at(node.origin)


def _optional(node: Node, attribute: str) -> bool | None:
    return node.boolean(attribute) if node.has(attribute) else None


def _write_assign(word: AssignControllerAction, output: Output) -> etree._Element:
    controller = controller_element(word, output)
    if output.version == (1, 3):
        controller = made("ObjectController", controller)
    element = made("AssignControllerAction", controller)
    for field, name in _ACTIVATION.items():
        if getattr(word, field) is not None:
            element.set(name, output.text(getattr(word, field), word))
    return element


def controller_element(word: AssignControllerAction, output: Output) -> etree._Element:
    """Return the <Controller> of a controller."""
    del output
    properties = [made("Property", name=one.name, value=one.value) for one in word.properties]
    if word.model not in ("default", _model(word.name)) and all(one.name != CLASS for one in word.properties):
        properties.insert(0, made("Property", name=CLASS, value=word.model))
    return made("Controller", made("Properties", *properties), name=word.name)


_INPUTS = {
    "Throttle": "throttle",
    "Brake": "brake",
    "Clutch": "clutch",
    "ParkingBrake": "parking_brake",
    "SteeringWheel": "steering_wheel",
    "Gear": "gear",
}
_GEARS = {"p": 0.0, "r": -1.0, "n": 0.0, "d": 1.0}


def read_overrides(node: Node) -> list[OverrideControllerAction]:
    """Return the actions of an <OverrideControllerValueAction>, one for each input.

    A brake held by a force is reported and left out: vehicles have no mass here.
    """
    found = []
    for one in node.children(*_INPUTS):
        active, force = one.boolean("active"), one.child("BrakeForce")
        if force is not None:
            force.read_whole()
        if active and force is not None:
            message = "<BrakeForce> has no effect on the run: it is a force, and vehicles have no mass here"
            force.report(NOT_READ, message, hint="<BrakePercent> is a share of the greatest deceleration")
            continue
        found.append(
            OverrideControllerAction.model_construct(
                input=_INPUTS[one.tag], active=active, **_input_value(one)
            ).written_at(one.origin)
        )
    return found


def _input_value(node: Node) -> Fields:
    automatic = node.child("AutomaticGear")
    if automatic is not None:
        return {"value": _GEARS[automatic.choice("gear", ("p", "r", "n", "d"))]}
    inner = node.child("ManualGear", "BrakePercent") or node
    named = "number" if inner.has("number") or inner.tag in ("ManualGear", "Gear") else "value"
    return {"value": inner.number(named, 0.0)}


def _read_override(node: Node) -> OverrideControllerAction | None:
    found = read_overrides(node)
    return found[0] if found else None


def _write_override(word: OverrideControllerAction, output: Output) -> etree._Element:
    tag = next(tag for tag, name in _INPUTS.items() if name == word.input)
    value, active = output.text(word.value, word), output.text(word.active, word)
    element = made(tag, active=active)
    if output.version >= (1, 2) and word.input in ("brake", "parking_brake"):
        element.append(made("BrakePercent", value=value))
    elif output.version >= (1, 2) and word.input == "gear":
        whole = isinstance(word.value, float) and word.value == int(word.value)
        if not whole:
            output.tell_lost(word, "since 1.2 a gear is a whole number")
        element.append(made("ManualGear", number=value if whole else "0"))
    else:
        element.set("number" if word.input == "gear" else "value", value)
    return made("OverrideControllerValueAction", element)


_AROUND = ("PrivateAction", "ControllerAction")


class _Switched:
    """The domains of a controller that are switched on or off."""

    def read(self, node: Node) -> Fields:
        return {name: _optional(node, name) for name in ("longitudinal", "lateral", "lighting", "animation")}

    def write(self, word: ActivateControllerAction, element: etree._Element, output: Output) -> None:
        for name in ("longitudinal", "lateral", "lighting", "animation"):
            value = getattr(word, name)
            if value is None:
                continue
            if name in ("lighting", "animation") and output.version < (1, 2):
                output.tell_lost(word, f"ActivateControllerAction/{name} is not known before 1.2")
            else:
                element.set(name, output.text(value, word))


class _Named:
    """The name of the controller: `controllerRef`, or `objectControllerRef` from 1.3 on."""

    def read(self, node: Node) -> Fields:
        return {"controller": node.text("objectControllerRef", "") or node.text("controllerRef", "")}

    def write(self, word: ActivateControllerAction, element: etree._Element, output: Output) -> None:
        if not word.controller:
            return
        if output.version < (1, 2):
            output.tell_lost(word, "ActivateControllerAction/controllerRef is not known before 1.2")
        else:
            element.set("objectControllerRef" if output.version == (1, 3) else "controllerRef", word.controller)


CONTROL: tuple[Form[Any], ...] = (
    Form("AssignControllerAction", AssignControllerAction, _read_assign, _write_assign, _AROUND, (1, 1)),
    Form("OverrideControllerValueAction", OverrideControllerAction, _read_override, _write_override, _AROUND, (1, 1)),
    regular("ActivateControllerAction", ActivateControllerAction, _Named(), _Switched(), around=("PrivateAction",)),
)
"""The children of a <ControllerAction>, and <ActivateControllerAction>, which may also be its sibling."""
