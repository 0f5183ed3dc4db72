"""Converts positions between OpenSCENARIO's <Position> and words."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.openscenario.motion import ON_CURVES
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.points import POINTS, read_point, write_point
from scenario_compiler.openscenario.spelling import Child, Forms, made
from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Word

POSITIONS = Forms((*POINTS.forms, *ON_CURVES.forms))
"""The positions that OpenSCENARIO can express."""

UNSAID = {
    "world": "a plan binds it to a lane; in CARLA's axes it means the middle of the vehicle's box",
    "spawn_point": "a plan binds it to a lane",
    "numbered_spawn_point": "a plan binds it to a lane",
    "random_spawn_point": "OpenSCENARIO has no random positions",
    "random": "OpenSCENARIO has no random positions",
    "ahead_of": "it follows the lane over junctions in the entity's direction of travel",
    "beside": "it is measured from the entity's position in its lane",
}
"""Tags of the positions that OpenSCENARIO cannot express, with the reasons."""


def read_position(node: Node) -> Position | None:
    """Return the position of a <Position> element; report an element that is not a position."""
    inner = node.first()
    if inner is not None and inner.tag in ON_CURVES.by_tag:
        position: Position | None = ON_CURVES.by_tag[inner.tag].read(inner)
        return position
    return read_point(node)


def write_position(word: Word, output: Output, tag: str = "Position") -> etree._Element:
    """Return the <Position> of a position; report one that OpenSCENARIO cannot express, and write the origin."""
    form = ON_CURVES.by_word.get(type(word))
    if form is None or output.version < form.since:
        return write_point(word, output, tag)
    return made(tag, form.write(word, output))


def anywhere(tag: str = "Position") -> Child:
    """Return the part for a child element that is a position, for the field `position`."""
    return Child("position", tag, read_position, lambda word, output: write_position(word, output, tag))
