"""The parameters that a scenario declares: their kinds and limits, read without expanding it."""

from __future__ import annotations

from dataclasses import dataclass

from lxml import etree

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.source.aisa_file import AisaConfig
from scenario_compiler.source.conflict import Library
from scenario_compiler.source.environment import Environment
from scenario_compiler.source.openscenario.held import OpenScenario
from scenario_compiler.source.parameters import limits, read_parameters
from scenario_compiler.vocabulary.scenario import Parameter, ParameterKind
from scenario_compiler.vocabulary.word import AttributeSpelling

KINDS: dict[str, ParameterKind] = {
    "double": "number",
    "integer": "integer",
    "int": "integer",
    "unsignedInt": "integer",
    "unsignedShort": "integer",
}
"""What OpenSCENARIO's types are here; the others are texts, also a boolean, which may be written as 0 or 1."""


@dataclass(frozen=True)
class Declaration:
    """What a parameter may be.

    Attributes:
        kind: Its kind.
        limits: The limits of its values, in XML units; OpenSCENARIO's have none here.
    """

    kind: ParameterKind
    limits: AttributeSpelling

    @classmethod
    def of(cls, parameter: Parameter) -> Declaration:
        """Return what a parameter may be."""
        return cls(parameter.type, limits(parameter))


def declarations(source: Library | AisaConfig | OpenScenario, name: str | None) -> dict[str, Declaration]:
    """Return what the parameters of a scenario may be, by name; none for a scenario that is not there.

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
    return {one.name: Declaration.of(one) for one in known.values()}


def _of_openscenario(root: etree._Element) -> dict[str, Declaration]:
    declared = root.findall("{*}ParameterDeclarations/{*}ParameterDeclaration")
    return {
        one.get("name", "").lstrip("$"): Declaration(
            KINDS.get(one.get("parameterType", "").strip(), "text"), AttributeSpelling()
        )
        for one in declared
    }
