"""Actions on an entity's lights and moving parts. Before 1.3 the schemas require both of them together."""

from __future__ import annotations

from typing import Any

from lxml import etree

from scenario_compiler.markup import codes
from scenario_compiler.openscenario.codes import NOT_READ
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import Fields, Form, made, nested, number, regular
from scenario_compiler.vocabulary.actions import AnimationAction, LightAction

_AROUND = ("PrivateAction", "AppearanceAction")

_LIGHTS = frozenset(
    {
        "daytimeRunningLights", "lowBeam", "highBeam", "fogLights", "fogLightsFront", "fogLightsRear", "brakeLights",
        "warningLights", "indicatorLeft", "indicatorRight", "reversingLights", "licensePlateIllumination",
        "specialPurposeLights"
    }
)  # fmt: skip
_COMPONENTS = frozenset(
    {
        "hood", "trunk", "doorFrontRight", "doorFrontLeft", "doorRearRight", "doorRearLeft", "windowFrontRight",
        "windowFrontLeft", "windowRearRight", "windowRearLeft", "sideMirrors", "sideMirrorRight", "sideMirrorLeft"
    }
)  # fmt: skip
_MOTIONS = frozenset(
    {
        "standing", "sitting", "lying", "squatting", "walking", "running", "reeling", "crawling", "cycling",
        "jumping", "ducking", "bendingDown"
    }
)  # fmt: skip


class _Light:
    """The light and its state."""

    def read(self, node: Node) -> Fields | None:
        if node.float("transitionTime", 0.0) != 0.0:
            node.report(NOT_READ, "LightStateAction/transitionTime has no effect on the run", "transitionTime")
        kind, state = node.required("LightType"), node.required("LightState")
        inner = None if kind is None else kind.required("VehicleLight", "UserDefinedLight")
        if inner is None or state is None:
            return None
        named = "vehicleLightType" if inner.tag == "VehicleLight" else "userDefinedLightType"
        return {"type": inner.text(named), "mode": state.choice("mode", ("off", "on", "flashing"))}

    def write(self, word: LightAction, element: etree._Element, output: Output) -> None:
        del output
        light = made("UserDefinedLight", userDefinedLightType=word.type)
        if word.type in _LIGHTS:
            light = made("VehicleLight", vehicleLightType=word.type)
        element.extend([made("LightType", light), made("LightState", mode=word.mode)])


_ANIMATIONS = {
    "VehicleComponent": "vehicleComponentType",
    "UserDefinedComponent": "userDefinedComponentType",
    "UserDefinedAnimation": "userDefinedAnimationType",
}


class _Animation:
    """The animated part, its state, and whether it is repeated: then it has "no regular ending" (Action tables)."""

    def read(self, node: Node) -> Fields | None:
        kind = node.required("AnimationType")
        inner = None if kind is None else kind.first()
        found = None if inner is None else _animation_type(inner)
        if found is None:
            node.report(codes.MISSING_ELEMENT, "<AnimationType> names no animation")
            return None
        state = node.child("AnimationState")
        repeated = node.boolean("loop", False)
        return {
            "type": found,
            "continuous": repeated,
            **({} if state is None else {"state": state.number("state")}),
        }

    def write(self, word: AnimationAction, element: etree._Element, output: Output) -> None:
        if word.type in _COMPONENTS:
            inner = nested(["ComponentAnimation"], made("VehicleComponent", vehicleComponentType=word.type))
        elif word.type in _MOTIONS:
            inner = made("PedestrianAnimation", motion=word.type)
        else:
            inner = made("UserDefinedAnimation", userDefinedAnimationType=word.type)
        element.append(made("AnimationType", inner))
        if word.continuous:
            element.set("loop", "true")
        if word.state != 1.0:
            element.append(made("AnimationState", state=output.text(word.state, word)))


def _animation_type(inner: Node) -> str | None:
    if inner.tag == "PedestrianAnimation":
        return inner.text("motion", "") or inner.text("userDefinedPedestrianAnimation", "") or "pedestrian"
    if inner.tag == "AnimationFile":
        file = inner.required("File")
        return None if file is None else file.text("filepath")
    if inner.tag == "ComponentAnimation":
        component = inner.first()
        return None if component is None else _animation_type(component)
    return inner.text(_ANIMATIONS[inner.tag]) if inner.tag in _ANIMATIONS else None


APPEARANCE: tuple[Form[Any], ...] = (
    regular("LightStateAction", LightAction, _Light(), around=_AROUND, since=(1, 3)),
    regular(
        "AnimationAction",
        AnimationAction,
        number("duration", "animationDuration", None),
        _Animation(),
        around=_AROUND,
        since=(1, 3),
    ),
)
"""The children of an <AppearanceAction>."""
