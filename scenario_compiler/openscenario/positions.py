"""Converts positions between OpenSCENARIO's <Position> and words."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.openscenario.motion import ON_CURVES
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.points import POINTS, read_point, write_as, write_point
from scenario_compiler.openscenario.spelling import Child, Forms
from scenario_compiler.vocabulary.positions import Position
from scenario_compiler.vocabulary.word import Word

POSITIONS = Forms((*POINTS.forms, *ON_CURVES.forms))
"""The positions that OpenSCENARIO can express."""


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
    return write_point(word, output, tag) if form is None else write_as(form, word, output, tag)


def anywhere(tag: str = "Position") -> Child:
    """Return the part for a child element that is a position, for the field `position`."""
    return Child("position", tag, read_position, lambda word, output: write_position(word, output, tag))
