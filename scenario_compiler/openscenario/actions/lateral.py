"""Actions across the lanes.

Lanes are counted to the left in the direction of travel of the reference entity. Offsets are along the t axis, positive
to the left of s.
"""

from __future__ import annotations

from typing import Any

from lxml import etree

from scenario_compiler.markup import codes
from scenario_compiler.openscenario.actions.dynamics import LIMITS, SHAPES, Transition
from scenario_compiler.openscenario.actions.longitudinal import Kept
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import Fields, Form, boolean, entity, made, regular
from scenario_compiler.vocabulary.actions import (
    LaneChangeAction,
    LaneChangeToAction,
    LateralDistanceAction,
    LimitedLaneOffsetAction,
)

_AROUND = ("PrivateAction", "LateralAction")
_CHANGE = Transition("LaneChangeActionDynamics")
_SIDES = ("any", "leftToReferencedEntity", "rightToReferencedEntity")


def _read_change(node: Node) -> LaneChangeAction | LaneChangeToAction | None:
    fields = _CHANGE.read(node)
    fields["offset"] = node.number("targetLaneOffset", 0.0)
    target = node.required("LaneChangeTarget")
    inner = None if target is None else target.required("RelativeTargetLane", "AbsoluteTargetLane")
    if inner is None:
        return None
    if inner.tag == "AbsoluteTargetLane":
        return LaneChangeToAction.model_construct(lane=inner.integer("value"), **fields).written_at(node.origin)
    of = inner.entity("entityRef")
    return LaneChangeAction.model_construct(by=inner.integer("value"), of=of, **fields).written_at(node.origin)


def _write_change(word: LaneChangeAction, output: Output) -> etree._Element:
    if not word.of and not output.actor:
        output.tell_lost(word, "a lane change of several entities must name the entity from which lanes are counted")
    target = made("RelativeTargetLane", entityRef=word.of or output.actor, value=str(word.by))
    return _change(word, target, output)


def _write_change_to(word: LaneChangeToAction, output: Output) -> etree._Element:
    return _change(word, made("AbsoluteTargetLane", value=str(word.lane)), output)


def _change(word: Any, target: etree._Element, output: Output) -> etree._Element:
    element = made("LaneChangeAction")
    if word.offset != 0.0:
        element.set("targetLaneOffset", output.text(word.offset, word))
    _CHANGE.write(word, element, output)
    element.append(made("LaneChangeTarget", target))
    return element


class _Offset:
    """The target of a lane offset and how it is reached."""

    def read(self, node: Node) -> Fields | None:
        dynamics, target = node.required("LaneOffsetActionDynamics"), node.required("LaneOffsetTarget")
        inner = None if target is None else target.first()
        if inner is None or inner.tag not in ("AbsoluteTargetLaneOffset", "RelativeTargetLaneOffset"):
            node.report(codes.MISSING_ELEMENT, "<LaneOffsetTarget> contains no target")
            return None
        fields: Fields = {"to": inner.number("value")}
        if inner.tag == "RelativeTargetLaneOffset":
            fields["of"] = inner.entity("entityRef")
        if dynamics is not None:
            fields["shape"] = dynamics.choice("dynamicsShape", SHAPES)
            fields["acceleration"] = dynamics.optional_number("maxLateralAcc")
        return fields

    def write(self, word: LimitedLaneOffsetAction, element: etree._Element, output: Output) -> None:
        dynamics = made("LaneOffsetActionDynamics", dynamicsShape=word.shape)
        if word.acceleration is not None:
            dynamics.set("maxLateralAcc", output.text(word.acceleration, word))
        value = output.text(word.to, word)
        target = made("AbsoluteTargetLaneOffset", value=value)
        if word.of:
            target = made("RelativeTargetLaneOffset", entityRef=word.of, value=value)
        element.extend([dynamics, made("LaneOffsetTarget", target)])


class _Aside:
    """The lateral distance: "missing value is interpreted as 0" (LateralDistanceAction)."""

    def read(self, node: Node) -> Fields:
        return {"distance": node.number("distance", 0.0)}

    def write(self, word: LateralDistanceAction, element: etree._Element, output: Output) -> None:
        if word.distance is None:
            output.tell_lost(word, "OpenSCENARIO cannot express the present lateral distance: it is written as 0")
        element.set("distance", output.text(word.distance or 0.0, word))


LATERAL: tuple[Form[Any], ...] = (
    Form("LaneChangeAction", LaneChangeAction, _read_change, _write_change, _AROUND),
    Form("LaneChangeAction", LaneChangeToAction, _read_change, _write_change_to, _AROUND),
    regular("LaneOffsetAction", LimitedLaneOffsetAction, boolean("continuous"), _Offset(), around=_AROUND),
    regular(
        "LateralDistanceAction",
        LateralDistanceAction,
        entity(),
        _Aside(),
        boolean("freespace"),
        boolean("continuous"),
        Kept(_SIDES, "any"),
        LIMITS,
        around=_AROUND,
    ),
)
"""The children of a <LateralAction>."""
