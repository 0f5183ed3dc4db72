"""The versions of OpenSCENARIO that have each element and attribute, for tables and for writing files."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from scenario_compiler.openscenario.structure.grammar import FIRST_MINOR, LAST_MINOR, OPENSCENARIO


@dataclass(frozen=True, slots=True)
class Element:
    """A type of element in the standard.

    Attributes:
        name: The type's name in the standard, which may differ from its tags.
        tags: The tags of its elements, in the order of the tables.
        since: First minor version of OpenSCENARIO 1 with the element.
        until: Last one.
        attributes: First and last minor version of each attribute.
        children: First and last minor version of each child, by its tag.
    """

    name: str
    tags: tuple[str, ...]
    since: int
    until: int
    attributes: dict[str, tuple[int, int]]
    children: dict[str, tuple[int, int]]


@cache
def elements() -> dict[str, Element]:
    """Return all elements of OpenSCENARIO 1.0 to 1.3 by name, in the order of the tables."""
    minors = range(FIRST_MINOR, LAST_MINOR + 1)
    reached = {minor: OPENSCENARIO.reachable(minor) for minor in minors}
    tags = _tags(minors)
    found = {}
    for name in OPENSCENARIO.declarations(LAST_MINOR):
        having = [minor for minor in minors if name in reached[minor]]
        attributes: dict[str, list[int]] = {}
        children: dict[str, list[int]] = {}
        for minor in having:
            declaration = OPENSCENARIO.declaration(name, minor)
            for attribute in declaration.attributes:
                attributes.setdefault(attribute, []).append(minor)
            for tag in declaration.content.tags():
                children.setdefault(tag, []).append(minor)
        found[name] = Element(name, tags[name], having[0], having[-1], _ends(attributes), _ends(children))
    return found


def _tags(minors: range) -> dict[str, tuple[str, ...]]:
    found: dict[str, dict[str, None]] = {OPENSCENARIO.root: {OPENSCENARIO.root: None}}
    for minor in minors:
        for declaration in OPENSCENARIO.declarations(minor).values():
            for child in declaration.content.names[1:]:
                found.setdefault(child.declaration, {})[child.tag] = None
    return {name: tuple(tags) for name, tags in found.items()}


def _ends(versions: dict[str, list[int]]) -> dict[str, tuple[int, int]]:
    return {name: (minors[0], minors[-1]) for name, minors in versions.items()}
