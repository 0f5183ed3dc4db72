"""Reports the parts of a file that were not read, so that nothing is ignored silently."""

from __future__ import annotations

from collections.abc import Iterator

from lxml import etree

from scenario_compiler.openscenario.codes import NOT_READ
from scenario_compiler.openscenario.node import Node
from scenario_compiler.structure.walk import local_name

DESCRIPTIONS = ("FileHeader", "License", "Properties", "File")
"""Elements that only describe; they are not meant to have an effect."""

MOST_FINDINGS = 50
"""Greatest number of findings for a file, because a file of another kind would have very many."""


def report_unread(node: Node) -> None:
    """Report the outermost elements below a node that were never read, and attributes that were never read."""
    for _, (element, attribute) in zip(range(MOST_FINDINGS), _unread(node), strict=False):
        what = f"{local_name(element)}/{attribute}" if attribute else f"<{local_name(element)}>"
        place = node.reading.origin(element, attribute or None)
        node.reading.sink.add(NOT_READ, f"{what} has no effect on the run", place)


def _unread(node: Node) -> Iterator[tuple[etree._Element, str]]:
    used = node.reading.used
    open_elements = [node.element]
    while open_elements:
        element = open_elements.pop()
        if local_name(element) in DESCRIPTIONS:
            continue
        if element not in used:
            yield element, ""
            continue
        for name in element.attrib:
            if str(name) not in used[element] and not str(name).startswith("{"):
                yield element, str(name)
        open_elements.extend(reversed(list(element.iterchildren(etree.Element))))
