"""Converts conditions between OpenSCENARIO's elements and words, by entity and by value."""

from __future__ import annotations

from typing import Any, get_args

from lxml import etree

from scenario_compiler.diagnostics import Severity, did_you_mean
from scenario_compiler.expressions import Expression
from scenario_compiler.markup import codes
from scenario_compiler.markup.names import UNKNOWN_ENTITY
from scenario_compiler.openscenario.motion import anywhere, read_position, write_position
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output, Version
from scenario_compiler.openscenario.spelling import (
    Children,
    Fields,
    Form,
    Forms,
    Part,
    boolean,
    choice,
    entity,
    integer,
    made,
    number,
    regular,
    text,
)
from scenario_compiler.openscenario.variables import variable_of_parameter
from scenario_compiler.vocabulary.conditions import (
    AccelerationCondition,
    AngleCondition,
    CollisionCondition,
    Condition,
    DistanceCondition,
    ElementStateCondition,
    EndOfRoadCondition,
    EventCondition,
    LaneConfidenceCondition,
    OffroadCondition,
    PositionDistanceCondition,
    ReachPositionCondition,
    RelativeAngleCondition,
    RelativeClearanceCondition,
    RelativeLaneRange,
    RelativeSpeedCondition,
    Rule,
    SensorHealthCondition,
    SimulationTimeCondition,
    SpeedCondition,
    StandstillCondition,
    TakeoverStateCondition,
    TimeHeadwayCondition,
    TimeOfDayCondition,
    TimeToCollisionCondition,
    TrafficSignalCondition,
    TrafficSignalControllerCondition,
    TraveledDistanceCondition,
    UserDefinedValueCondition,
    VariableCondition,
)
from scenario_compiler.vocabulary.conditions.measuring import COORDINATE_SYSTEMS
from scenario_compiler.vocabulary.word import Word

_RULES: tuple[Rule, ...] = get_args(Rule)
_STRICT = {"lessOrEqual": ("lessThan", 2.0e-6), "greaterOrEqual": ("greaterThan", -2.0e-6)}
"""1.0 has no <= and >=: the rule that is written instead, and the amount added to the value. Comparisons tolerate 1e-6.
"""


class _Compared:
    """A value and the rule of its comparison."""

    def __init__(self, value: str) -> None:
        self.value = value

    def read(self, node: Node) -> Fields:
        return {self.value: node.number("value"), "rule": node.choice("rule", _RULES)}

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        rule, value = word.rule, getattr(word, self.value)
        if output.version == (1, 0) and rule in _STRICT and not isinstance(value, Expression):
            rule, more = _STRICT[rule]
            value = value + more
        _write_rule(rule, word, element, output)
        element.set("value", output.text(value, word))


class _ComparedText:
    """A text and the rule of its comparison."""

    def __init__(self, value: str) -> None:
        self.value = value

    def read(self, node: Node) -> Fields:
        return {self.value: node.text(_attribute(self.value)), "rule": node.choice("rule", _RULES)}

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        _write_rule(word.rule, word, element, output)
        element.set(_attribute(self.value), getattr(word, self.value))


def _attribute(field: str) -> str:
    return "dateTime" if field == "date_time" else field


def _write_rule(rule: str, word: Word, element: etree._Element, output: Output) -> None:
    if output.version == (1, 0) and rule not in ("lessThan", "greaterThan", "equalTo"):
        output.tell_lost(word, f"the rule {rule} is not known before 1.1")
        rule = {"lessOrEqual": "lessThan", "greaterOrEqual": "greaterThan"}.get(rule, "equalTo")
    element.set("rule", rule)


_DISTANCES = ("euclidianDistance", "longitudinal", "lateral", "cartesianDistance")


class _Measured:
    """The coordinate system and the kind of a distance; `alongRoute`, from 1.0, stands for both if neither is given."""

    def __init__(self, *, kind_needed: bool = False) -> None:
        """Set whether the kind of distance is required, in which case there is no `alongRoute`."""
        self.kind_needed = kind_needed

    def read(self, node: Node) -> Fields:
        chosen = node.has("coordinateSystem") or node.has("relativeDistanceType")
        along = not self.kind_needed and node.boolean("alongRoute", False) and not chosen
        system = node.choice("coordinateSystem", COORDINATE_SYSTEMS, "road" if along else "entity")
        usual = None if self.kind_needed else "longitudinal" if along else "euclidianDistance"
        kind = node.choice("relativeDistanceType", _DISTANCES, usual)
        return {
            "coordinates": system,
            "distance": "euclidianDistance" if kind == "cartesianDistance" else kind,
            "freespace": node.boolean("freespace"),
        }

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        element.set("freespace", output.text(word.freespace, word))
        if output.version == (1, 0):
            self._write_old(word, element, output)
            return
        element.set("coordinateSystem", word.coordinates)
        element.set("relativeDistanceType", word.distance)

    def _write_old(self, word: Any, element: etree._Element, output: Output) -> None:
        along = word.coordinates != "entity"
        if self.kind_needed:
            known = word.coordinates == "entity"
            kind = "cartesianDistance" if word.distance == "euclidianDistance" else word.distance
            element.set("relativeDistanceType", kind)
        else:
            known = (word.coordinates, word.distance) in (("road", "longitudinal"), ("entity", "euclidianDistance"))
            element.set("alongRoute", output.text(along, word))
        if not known:
            output.tell_lost(
                word, f"1.0 cannot measure a {word.distance} distance in the coordinate system '{word.coordinates}'"
            )


class _Target:
    """The target of a time to collision: an entity or a position."""

    def read(self, node: Node) -> Fields | None:
        target = node.required("TimeToCollisionConditionTarget")
        inner = None if target is None else target.required("EntityRef", "Position")
        if inner is None:
            return None
        if inner.tag == "EntityRef":
            return {"to": inner.entity("entityRef")}
        position = read_position(inner)
        return None if position is None else {"position": position}

    def write(self, word: TimeToCollisionCondition, element: etree._Element, output: Output) -> None:
        inner = made("EntityRef", entityRef=word.to)
        if word.position is not None:
            inner = write_position(word.position, output)
        element.append(made("TimeToCollisionConditionTarget", inner))


class _Other:
    """The other party of a collision: an entity, any member of a selection, or any entity of a type.

    The entities of the type `external` are those that the file does not describe.
    """

    def read(self, node: Node) -> Fields | None:
        inner = node.child("EntityRef", "ByType")
        if inner is None:
            return {}
        if inner.tag == "EntityRef":
            others = inner.entities("entityRef")
            return {"with_entities": others} if others else None
        kind = inner.choice("type", ("vehicle", "pedestrian", "miscellaneous", "external"))
        if kind != "external":
            return {"with_type": kind}
        outside = tuple(one for one, its in node.reading.known.entities.items() if its == "external")
        if not outside:
            message = "no entity is an ExternalObjectReference, so this is never true"
            inner.report(UNKNOWN_ENTITY, message, "type", severity=Severity.WARNING)
            return None
        return {"with_entities": outside}

    def write(self, word: CollisionCondition, element: etree._Element, output: Output) -> None:
        if word.with_entities:
            if len(word.with_entities) > 1:
                output.tell_lost(word, "OpenSCENARIO allows one touched entity; only the first one is kept")
            element.append(made("EntityRef", entityRef=word.with_entities[0]))
        elif word.with_type:
            element.append(made("ByType", type=word.with_type))
        else:
            output.tell_lost(
                word, "OpenSCENARIO requires the touched entity or its type; this condition accepts any entity"
            )
            element.append(made("ByType", type="vehicle"))


class _Others:
    """The other entities of a clearance, or the members of selections; any entity if none is given."""

    def read(self, node: Node) -> Fields | None:
        given = node.children("EntityRef")
        others = tuple(entity for one in given for entity in one.entities("entityRef"))
        return None if given and not others else {"of": others}

    def write(self, word: RelativeClearanceCondition, element: etree._Element, output: Output) -> None:
        del output
        element.extend([made("EntityRef", entityRef=one) for one in word.of])


def _direction(word: type[Word]) -> Part:
    return choice(word, "direction", default="total", since=(1, 2))


_LANES = regular(
    "RelativeLaneRange", RelativeLaneRange, integer("least", "from", None), integer("greatest", "to", None)
)

BY_ENTITY = Forms(
    (
        regular("EndOfRoadCondition", EndOfRoadCondition, number("duration")),
        regular("CollisionCondition", CollisionCondition, _Other()),
        regular("OffroadCondition", OffroadCondition, number("duration")),
        regular("TimeHeadwayCondition", TimeHeadwayCondition, entity(), _Compared("below"), _Measured()),
        regular("TimeToCollisionCondition", TimeToCollisionCondition, _Compared("below"), _Measured(), _Target()),
        regular("AccelerationCondition", AccelerationCondition, _Compared("value"), _direction(AccelerationCondition)),
        regular("StandStillCondition", StandstillCondition, number("duration")),
        regular("SpeedCondition", SpeedCondition, _Compared("value"), _direction(SpeedCondition)),
        regular(
            "RelativeSpeedCondition",
            RelativeSpeedCondition,
            entity(),
            _Compared("value"),
            _direction(RelativeSpeedCondition),
        ),
        regular("TraveledDistanceCondition", TraveledDistanceCondition, number("distance", "value")),
        regular("ReachPositionCondition", ReachPositionCondition, number("tolerance"), anywhere()),
        regular("DistanceCondition", PositionDistanceCondition, _Compared("below"), _Measured(), anywhere()),
        regular(
            "RelativeDistanceCondition",
            DistanceCondition,
            entity(),
            _Compared("below"),
            _Measured(kind_needed=True),
        ),
        regular(
            "RelativeClearanceCondition",
            RelativeClearanceCondition,
            boolean("opposite_lanes", "oppositeLanes"),
            number("forward", "distanceForward", 0.0),
            number("backward", "distanceBackward", 0.0),
            boolean("freespace", "freeSpace"),
            Children("lanes", _LANES),
            _Others(),
            since=(1, 2),
        ),
        regular(
            "AngleCondition",
            AngleCondition,
            choice(AngleCondition, "kind", "angleType"),
            number("value", "angle"),
            number("tolerance", "angleTolerance"),
            choice(AngleCondition, "coordinates", "coordinateSystem", "world"),
            since=(1, 3),
        ),
        regular(
            "RelativeAngleCondition",
            RelativeAngleCondition,
            entity(),
            choice(RelativeAngleCondition, "kind", "angleType"),
            number("value", "angle"),
            number("tolerance", "angleTolerance"),
            since=(1, 3),
        ),
    )
)
"""Conditions by entity: the child of an <EntityCondition>."""


def _variable_tag(version: Version) -> str:
    return "VariableCondition" if version >= (1, 2) else "ParameterCondition"


def _read_variable(node: Node) -> VariableCondition:
    name = node.text("variableRef") if node.tag == "VariableCondition" else variable_of_parameter(node)
    return VariableCondition.model_construct(
        variable=name, rule=node.choice("rule", _RULES), value=node.text("value")
    ).written_at(node.origin)


def _write_variable(word: VariableCondition, output: Output) -> etree._Element:
    tag = _variable_tag(output.version)
    named = "variableRef" if tag == "VariableCondition" else "parameterRef"
    element = made(tag, **{named: word.variable})
    _write_rule(word.rule, word, element, output)
    element.set("value", word.value)
    return element


BY_VALUE = Forms(
    (
        regular("SimulationTimeCondition", SimulationTimeCondition, _Compared("after")),
        regular(
            "StoryboardElementStateCondition",
            ElementStateCondition,
            choice(ElementStateCondition, "kind", "storyboardElementType"),
            text("element", "storyboardElementRef"),
            choice(ElementStateCondition, "state"),
        ),
        regular("TimeOfDayCondition", TimeOfDayCondition, _ComparedText("date_time")),
        Form("VariableCondition", VariableCondition, _read_variable, _write_variable),
        Form("ParameterCondition", VariableCondition, _read_variable, _write_variable),
        regular("UserDefinedValueCondition", UserDefinedValueCondition, text("name"), _ComparedText("value")),
        regular("TrafficSignalCondition", TrafficSignalCondition, text("signal", "name"), text("state")),
        regular(
            "TrafficSignalControllerCondition",
            TrafficSignalControllerCondition,
            text("controller", "trafficSignalControllerRef"),
            text("phase"),
        ),
    )
)
"""Conditions by value: the child of a <ByValueCondition>."""

OWN = {
    LaneConfidenceCondition: ("lane_confidence", "below"),
    SensorHealthCondition: ("sensor_health", "below"),
    TakeoverStateCondition: ("takeover_state", "state"),
    EventCondition: ("event", "state"),
}
"""Conditions that are written as a user-defined value: the value's name, and the field to which it is compared."""


def read_condition(node: Node) -> Condition | None:
    """Return the condition of a child of <EntityCondition> or <ByValueCondition>; report an unknown element."""
    form = BY_ENTITY.by_tag.get(node.tag) or BY_VALUE.by_tag.get(node.tag)
    if form is None:
        node.read_whole()
        known = [*BY_ENTITY.by_tag, *BY_VALUE.by_tag]
        node.report(codes.UNKNOWN_ELEMENT, f"<{node.tag}> is not a condition", hint=did_you_mean(node.tag, known))
        return None
    condition: Condition | None = form.read(node)
    return condition


def write_condition(word: Word, output: Output) -> etree._Element | None:
    """Return the element of a condition for <EntityCondition> or <ByValueCondition>; report it if there is none."""
    form = BY_ENTITY.by_word.get(type(word)) or BY_VALUE.by_word.get(type(word))
    if form is not None and output.version >= form.since:
        return form.write(word, output)
    if type(word) in OWN:
        return _write_own(word, output)
    before = "" if form is None else f" before {output.dotted(form.since)}"
    output.tell_lost(word, f"the condition <{word.tag()}> cannot be written{before}")
    return None


def _write_own(word: Word, output: Output) -> etree._Element:
    name, field = OWN[type(word)]
    if isinstance(word, EventCondition):
        name = f"{name}.{word.name}"
    rule = "lessThan" if field == "below" else "equalTo"
    output.tell_lost(
        word, f"<{word.tag()}> is written as the user-defined value '{name}', which another program must supply"
    )
    return made("UserDefinedValueCondition", name=name, rule=rule, value=output.text(getattr(word, field), word))


def is_by_entity(word: Word) -> bool:
    """Return whether a condition belongs into an <EntityCondition>."""
    return type(word) in BY_ENTITY.by_word
