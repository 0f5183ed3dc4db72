"""Finds templates in a file with scenarios that none of them uses."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.markup import names
from scenario_compiler.source.conflict import Library, ScenarioElement, Use


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
