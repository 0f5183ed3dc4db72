"""The kinds of parameters that a scenario declares, read without expanding it."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.conflict import Library
from scenario_compiler.source.environment import Environment
from scenario_compiler.source.openscenario.held import OpenScenario
from scenario_compiler.source.parameters import read_parameters
from scenario_compiler.vocabulary.scenario import ParameterKind

KINDS: dict[str, ParameterKind] = {
    "double": "number",
    "integer": "integer",
    "int": "integer",
    "unsignedInt": "integer",
    "unsignedShort": "integer",
}
"""What OpenSCENARIO's types are here; the others are texts, also a boolean, which may be written as 0 or 1."""


def declared_kinds(source: Library | AisaConfig | OpenScenario, name: str | None) -> dict[str, ParameterKind]:
    """Return the kinds of the parameters that a scenario declares, by name; none for a scenario that is not there.

    Args:
        source: The file.
        name: Name of the scenario; None for a file's only one.
    """
    if isinstance(source, OpenScenario):
        return _of_openscenario(source.document.root)
    if isinstance(source, AisaConfig):
        return {}
    part = source.scenarios.get(next(iter(source.scenarios), "") if name is None else name)
    if part is None:
        return {}
    known = read_parameters(part.element, part.reading(Diagnostics(), Environment())).known
    return {one.name: one.type for one in known.values()}


def _of_openscenario(root: etree._Element) -> dict[str, ParameterKind]:
    declared = root.findall("{*}ParameterDeclarations/{*}ParameterDeclaration")
    return {
        one.get("name", "").lstrip("$"): KINDS.get(one.get("parameterType", "").strip(), "text") for one in declared
    }
