"""The parameters that a scenario declares: their kinds and limits, read without expanding it."""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.markup.environment import Environment
from scenario_compiler.source.conflict import Library
from scenario_compiler.source.parameters import read_parameters
from scenario_compiler.vocabulary.scenario import Parameter, ParameterKind
from scenario_compiler.vocabulary.word import AttributeSpelling


@dataclass(frozen=True)
class Declaration:
    """What a parameter may be.

    Attributes:
        kind: Its kind.
        limits: The limits of its values, in XML units; OpenSCENARIO's have none here.
        summary: What it does, where the scenario says so.
    """

    kind: ParameterKind
    limits: AttributeSpelling
    summary: str = ""

    @classmethod
    def of(cls, parameter: Parameter) -> Declaration:
        """Return what a parameter may be."""
        return cls(parameter.type, parameter.limits, parameter.summary)


def declared_in(library: Library, name: str | None) -> dict[str, Declaration]:
    """Return what the parameters of a scenario may be, by name; none for a scenario that is not there.

    Args:
        library: The file.
        name: Name of the scenario; None for a file's only one.
    """
    part = library.scenarios.get(next(iter(library.scenarios), "") if name is None else name)
    if part is None:
        return {}
    known = read_parameters(part.element, part.reading(Diagnostics(), Environment())).known
    return {one.name: Declaration.of(one) for one in known.values()}
