"""Actions on an entity's speed, and on its distance to another along the road."""

from __future__ import annotations

from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.openscenario.actions.dynamics import LIMITS, Transition
from scenario_compiler.openscenario.codes import CONTINUOUS_OVER_TIME
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import (
    Children,
    Fields,
    Form,
    boolean,
    choice,
    entity,
    made,
    number,
    regular,
)
from scenario_compiler.vocabulary.actions import (
    AtRate,
    LongitudinalDistanceAction,
    RelativeSpeedAction,
    SpeedAction,
    SpeedEntry,
    SpeedProfileAction,
)
from scenario_compiler.vocabulary.conditions.measuring import COORDINATE_SYSTEMS, OwnSystem

WORLD_AXES = Code(
    "SC787",
    "distance-along-world-axes",
    "An action keeps a distance to another entity in the coordinate system `world`, which exists since 1.3:\n\n"
    '    <LongitudinalDistanceAction entityRef="Ego" distance="20" coordinateSystem="world" .../>\n\n'
    "A vehicle moves along its own axes: one that drives along y cannot change its distance along x. The distance is "
    "kept along the entity's own axes (`entity`) instead. Conditions measure along the world's axes.",
    Severity.WARNING,
)

_AROUND = ("PrivateAction", "LongitudinalAction")
_SPEED = Transition("SpeedActionDynamics")
_DISPLACEMENTS = ("any", "trailingReferencedEntity", "leadingReferencedEntity")


def _read_speed(node: Node) -> SpeedAction | RelativeSpeedAction | None:
    fields = _SPEED.read(node)
    target = node.required("SpeedActionTarget")
    inner = None if target is None else target.required("AbsoluteTargetSpeed", "RelativeTargetSpeed")
    if inner is None:
        return None
    if inner.tag == "AbsoluteTargetSpeed":
        return SpeedAction.model_construct(to=inner.number("value"), **fields).written_at(node.origin)
    continuous = inner.boolean("continuous")
    if continuous and fields["shape"] != "step" and not isinstance(fields.get("dynamics"), AtRate):
        message = "a relative speed that is kept (continuous) is reached at a rate, not over a time or a distance"
        inner.report(CONTINUOUS_OVER_TIME, message, "continuous")
    return RelativeSpeedAction.model_construct(
        to=inner.entity("entityRef"),
        value=inner.number("value"),
        kind=inner.choice("speedTargetValueType", ("delta", "factor")),
        continuous=continuous,
        **fields,
    ).written_at(node.origin)


def _write_speed(word: SpeedAction, output: Output) -> etree._Element:
    target = made("AbsoluteTargetSpeed", value=output.text(word.to, word))
    return _speed_action(word, target, output)


def _write_relative_speed(word: RelativeSpeedAction, output: Output) -> etree._Element:
    target = made(
        "RelativeTargetSpeed",
        entityRef=word.to,
        value=output.text(word.value, word),
        speedTargetValueType=word.kind,
        continuous=output.text(word.continuous, word),
    )
    return _speed_action(word, target, output)


def _speed_action(word: Any, target: etree._Element, output: Output) -> etree._Element:
    element = made("SpeedAction")
    _SPEED.write(word, element, output)
    element.append(made("SpeedActionTarget", target))
    return element


class _Distance:
    """A distance, or a time gap instead."""

    def read(self, node: Node) -> Fields:
        return {"distance": node.optional_number("distance"), "time_gap": node.optional_number("timeGap")}

    def write(self, word: LongitudinalDistanceAction, element: etree._Element, output: Output) -> None:
        if word.distance is not None:
            element.set("distance", output.text(word.distance, word))
        if word.time_gap is not None:
            element.set("timeGap", output.text(word.time_gap, word))


class Kept:
    """The coordinate system and the side of a kept distance; 1.0 has neither: the entity's axes, and any side."""

    def __init__(self, displacements: tuple[str, ...], usual: str) -> None:
        """Set the sides, and the default side since 1.1."""
        self.displacements = displacements
        self.usual = usual

    def read(self, node: Node) -> Fields:
        """Return the fields."""
        usual = "any" if node.reading.version == (1, 0) else self.usual
        return {
            "coordinates": self._system(node),
            "displacement": node.choice("displacement", self.displacements, usual),
        }

    def _system(self, node: Node) -> OwnSystem:
        system = node.choice("coordinateSystem", COORDINATE_SYSTEMS, "entity")
        if system == "world":
            node.report(
                WORLD_AXES, "no distance is kept along the world's axes; the entity's own are used", "coordinateSystem"
            )
            return "entity"
        return system

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        """Add the attributes that the version has."""
        if output.version > (1, 0):
            element.set("coordinateSystem", word.coordinates)
            element.set("displacement", word.displacement)
        elif (word.coordinates, word.displacement) != ("entity", "any"):
            output.tell_lost(word, f"{element.tag}/coordinateSystem and displacement are not known before 1.1")


_ENTRY = regular("SpeedProfileEntry", SpeedEntry, number("speed"), number("time", default=None))

LONGITUDINAL: tuple[Form[Any], ...] = (
    Form("SpeedAction", SpeedAction, _read_speed, _write_speed, _AROUND),
    Form("SpeedAction", RelativeSpeedAction, _read_speed, _write_relative_speed, _AROUND),
    regular(
        "LongitudinalDistanceAction",
        LongitudinalDistanceAction,
        entity(),
        _Distance(),
        boolean("freespace"),
        boolean("continuous"),
        Kept(_DISPLACEMENTS, "trailingReferencedEntity"),
        LIMITS,
        around=_AROUND,
    ),
    regular(
        "SpeedProfileAction",
        SpeedProfileAction,
        entity(default=""),
        choice(SpeedProfileAction, "following", "followingMode"),
        LIMITS,
        Children("entries", _ENTRY, least=1),
        around=_AROUND,
        since=(1, 2),
    ),
)
"""The children of a <LongitudinalAction>."""
