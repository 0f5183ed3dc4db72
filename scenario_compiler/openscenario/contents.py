"""The contents of an OpenSCENARIO file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

from lxml import etree

from scenario_compiler.diagnostics import Place
from scenario_compiler.document import Document
from scenario_compiler.vocabulary.scenario import ParameterKind
from scenario_compiler.vocabulary.variation import Vary

KINDS: dict[str, ParameterKind] = {
    "double": "number",
    "integer": "integer",
    "int": "integer",
    "unsignedInt": "integer",
    "unsignedShort": "integer",
}
"""Kinds of parameters by OpenSCENARIO's types; all others are texts, also a boolean, which may be written as 0 or 1."""


class Variation(NamedTuple):
    """A <ParameterValueDistribution>: the values that the parameters of another file take.

    Attributes:
        vary: How a sweep varies them.
        first: The first value of each parameter that has a list or range.
        sets: Values of several parameters at once, by the name of the parameter that counts the sets from 0.
        places: Where the values of each parameter are.
    """

    vary: Vary
    first: Mapping[str, str] = MappingProxyType({})
    sets: Mapping[str, Sequence[Mapping[str, str]]] = MappingProxyType({})
    places: Mapping[str, Place] = MappingProxyType({})


class OpenScenario(NamedTuple):
    """An OpenSCENARIO file: a scenario, values for the parameters of one, or a catalog, which has no scenario.

    Attributes:
        document: The file of the scenario or of the catalog.
        scenarios: The scenario, by the name of the requested file.
        variation: The values of its parameters, if the requested file gives some.
    """

    document: Document
    scenarios: Mapping[str, etree._Element]
    variation: Variation | None = None


def parameter_types(document: Document) -> dict[str, str]:
    """Return the ParameterType of each parameter that a file declares, by its name."""
    declared = document.root.findall("{*}ParameterDeclarations/{*}ParameterDeclaration")
    return {one.get("name", "").lstrip("$"): one.get("parameterType", "").strip() for one in declared}


def parameter_kinds(held: OpenScenario) -> dict[str, ParameterKind]:
    """Return the kind of each parameter that a file declares, by its name."""
    return {name: KINDS.get(kind, "text") for name, kind in parameter_types(held.document).items()}
