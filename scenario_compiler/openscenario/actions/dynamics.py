"""Common parts of actions: the timing and shape of a change, and the limits of a motion."""

from __future__ import annotations

from typing import Any, get_args

from lxml import etree

from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.spelling import Child, Fields, made, number, regular
from scenario_compiler.vocabulary.actions import AtRate, Limits, OverDistance
from scenario_compiler.vocabulary.actions.dynamics import Shape

SHAPES: tuple[str, ...] = get_args(Shape)


class Transition:
    """A child of the type TransitionDynamics: the fields `shape`, `over_time` and `dynamics`."""

    def __init__(self, tag: str) -> None:
        """Set the tag of the child."""
        self.tag = tag

    def read(self, node: Node) -> Fields:
        """Return the fields; without the child, the change is a step, which needs no dimension and no value."""
        inner = node.required(self.tag)
        if inner is None:
            return {"shape": "step"}
        shape = inner.choice("dynamicsShape", SHAPES)
        usual, least = ("time", 0.0) if shape == "step" else (None, None)
        dimension = inner.choice("dynamicsDimension", ("time", "rate", "distance"), usual)
        inner.text("followingMode", "")
        value = inner.number("value", least)
        if dimension == "time":
            return {"shape": shape, "over_time": value}
        kind: type[AtRate | OverDistance] = AtRate if dimension == "rate" else OverDistance
        return {"shape": shape, "dynamics": kind.model_construct(value=value)}

    def write(self, word: Any, element: etree._Element, output: Output) -> None:
        """Add the child."""
        dynamics = word.dynamics
        dimension, value = "time", word.over_time
        if dynamics is not None:
            dimension, value = ("rate" if isinstance(dynamics, AtRate) else "distance"), dynamics.value
        number = output.text(value, word)
        element.append(made(self.tag, dynamicsShape=word.shape, value=number, dynamicsDimension=dimension))


_LIMITS = regular(
    "DynamicConstraints",
    Limits,
    number("acceleration", "maxAcceleration", None),
    number("acceleration_rate", "maxAccelerationRate", None, (1, 2)),
    number("deceleration", "maxDeceleration", None),
    number("deceleration_rate", "maxDecelerationRate", None, (1, 2)),
    number("speed", "maxSpeed", None),
)

LIMITS = Child("limits", "DynamicConstraints", _LIMITS.read, _LIMITS.write, required=False)
"""The limits of a motion."""
