"""Finds what nothing uses: templates of a file with scenarios, and parameters of a scenario or a template."""

from __future__ import annotations

import re
from collections.abc import Iterator

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.markup import names
from scenario_compiler.source.conflict import Library, Part, ScenarioElement, Use
from scenario_compiler.source.parameters import Declared

_USE = re.compile(r"\$(\w+)|\$\{([^}]*)\}")
"""A use of one parameter, or an expression, which may contain names of parameters with and without a dollar sign."""


def report_unused_templates(library: Library, sink: Diagnostics) -> None:
    """Warn of a file's own templates that none of its scenarios uses; nothing is reported if a name is computed."""
    if not library.scenarios:
        return
    reached: set[str] = set()
    scenarios = library.document.root.iterchildren(ScenarioElement.tag())
    waiting = [name for element in scenarios for name in _used_by(element)]
    while waiting:
        name = waiting.pop()
        if "$" in name:
            return
        if name not in reached:
            reached.add(name)
            waiting += _used_by(library.templates[name].element) if name in library.templates else []
    for name in library.own_templates:
        if name and name not in reached:
            part = library.templates[name]
            place = part.document.origin(part.element, "name", part.within)
            sink.add(names.UNUSED_TEMPLATE, f"no scenario of this file uses the template '{name}'", place)


def _used_by(element: etree._Element) -> list[str]:
    return [str(use.get("template", "")) for use in element.iter(Use.tag())]


def report_unused_parameters(part: Part, declared: Declared, sink: Diagnostics) -> None:
    """Warn of the parameters of a scenario or a template that no value in it uses; an axis of <vary> is not a use."""
    used = set(_names_used(part.element))
    for name, parameter in declared.known.items():
        if name not in used:
            message = f"nothing uses the parameter '{name}', so its value has no effect"
            hint = f"write ${name} where its value belongs"
            sink.add(names.UNUSED_PARAMETER, message, parameter.place_of("name"), hint=hint)


def _names_used(element: etree._Element) -> Iterator[str]:
    """Yield the names in the expressions of the attributes of an element and of everything in it."""
    for one in element.iter(etree.Element):
        for text in one.attrib.values():
            for name, expression in _USE.findall(str(text)):
                yield from (name,) if name else re.findall(r"\w+", expression)
