"""The contents of an AISA toolkit file: its scenario elements by name. `aisa` makes scenarios of them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import Document
from scenario_compiler.markup import names


class AisaConfig(NamedTuple):
    """A file of the AISA toolkit: its scenario elements by name."""

    document: Document
    scenarios: Mapping[str, etree._Element]


def read_aisa(document: Document, sink: Diagnostics) -> AisaConfig:
    """Return the scenarios of a `<config>` file; report repeated names."""
    scenarios: dict[str, etree._Element] = {}
    for element in document.root.iterfind("scenarios/scenario"):
        name = str(element.get("name", ""))
        if name in scenarios:
            place = document.origin(element, "name")
            first = names.first_at(document.origin(scenarios[name], "name"))
            sink.add(names.DUPLICATE_NAME, f"this file already has a scenario named '{name}'", place, related=first)
        scenarios.setdefault(name, element)
    return AisaConfig(document, scenarios)
