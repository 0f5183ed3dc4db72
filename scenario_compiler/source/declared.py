"""The parameters that a scenario declares: their kinds and limits, read without expanding it."""

from __future__ import annotations

from typing import NamedTuple

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.expressions import Value
from scenario_compiler.markup.environment import Environment
from scenario_compiler.source.conflict import Library
from scenario_compiler.source.parameters import default_value, read_parameters
from scenario_compiler.vocabulary.scenario import Parameter, ParameterKind
from scenario_compiler.vocabulary.word import AttributeSpelling


class Declaration(NamedTuple):
    """The allowed values of a parameter.

    Attributes:
        kind: Its kind.
        limits: The limits of its values, in XML units; those of OpenSCENARIO are not read here.
        summary: Its description, if the scenario has one.
        default: Its default, in XML units; None if there is none, and for OpenSCENARIO.
    """

    kind: ParameterKind
    limits: AttributeSpelling
    summary: str = ""
    default: Value | None = None

    @classmethod
    def of(cls, parameter: Parameter) -> Declaration:
        """Return the declaration of a parameter."""
        return cls(parameter.type, parameter.limits, parameter.summary, default_value(parameter, Diagnostics()))


def declared_in(library: Library, name: str | None) -> dict[str, Declaration]:
    """Return the declarations of a scenario's parameters, by name; empty for an unknown scenario.

    Args:
        library: The file.
        name: Name of the scenario; None for the only one of a file.
    """
    part = library.scenarios.get(next(iter(library.scenarios), "") if name is None else name)
    if part is None:
        return {}
    known = read_parameters(part.element, part.reading(Diagnostics(), Environment())).known
    return {one.name: Declaration.of(one) for one in known.values()}
