"""The context for writing OpenSCENARIO: the version, the actors, and what cannot be expressed."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.expressions import Expression, ExpressionError, Value, format_value
from scenario_compiler.vocabulary.word import Word

Version: TypeAlias = tuple[int, int]
"""revMajor and revMinor."""

VERSIONS: tuple[Version, ...] = ((1, 0), (1, 1), (1, 2), (1, 3))
"""Versions that can be written."""

LOST = Code(
    "SC783",
    "lost-in-openscenario",
    "A part of the scenario cannot be expressed in OpenSCENARIO, or not in the written version, so other programs "
    "will not execute it. If possible, the file contains it as a property of the controller `scenario_compiler`, "
    "which this program reads back.\n\n"
    "    scenario-compiler export conflict.xml -o out.xosc --version 1.0     1.0 has no <SpeedProfileAction>\n\n"
    "Export to a newer version, or leave the part out.",
    Severity.WARNING,
)

_SAID = re.compile(r"[ A-Za-z0-9_+\-*/%$().,]*\Z")
_FUNCTION = re.compile(r"([a-z0-9]+)\(")
_FUNCTIONS = frozenset({"ceil", "floor", "pow", "round", "sqrt", "not"})
_NEW_FUNCTIONS = frozenset({"max", "min", "sign"})
"""Functions in the standard's expressions, by the version that introduced them (1.1 and 1.3)."""

_LONGEST = 1000
"""Greatest length of a written expression, characters."""

_PER_DEGREE = "0.017453292519943295"


@dataclass(frozen=True)
class Output:
    """The context for writing words.

    Attributes:
        version: Version of the written file.
        sink: Receives what OpenSCENARIO cannot express.
        values: Values of the scenario's open parameters.
        actor: Id of the acting entity, empty if there is none or several.
    """

    version: Version
    sink: Diagnostics
    values: Mapping[str, Value] = field(default_factory=dict)
    actor: str = ""

    def by(self, actor: str) -> Output:
        """Return the context for the actions of an entity."""
        return replace(self, actor=actor)

    def tell_lost(self, word: Word, message: str) -> None:
        """Report that a part of a word cannot be expressed."""
        self.sink.add(LOST, message, word.origin)

    def dotted(self, version: Version | None = None) -> str:
        """Return a version, by default that of the written file, as text."""
        return "{}.{}".format(*(version or self.version))

    def text(self, value: Expression | float | int | bool | str, word: Word) -> str:
        """Return the text of an attribute's value."""
        if isinstance(value, Expression):
            return self._expression(value, word)
        if isinstance(value, int) and not isinstance(value, bool):
            return str(value)
        return format_value(value)

    def _expression(self, value: Expression, word: Word) -> str:
        text = value.text
        if re.fullmatch(r"\$\w+", text):
            return text
        text = _without_abs(text.replace("radians(", f"({_PER_DEGREE} * "))
        if self._is_said(text):
            return f"${{{text}}}"
        try:
            present = value.number(self.values)
        except ExpressionError:
            present = 0.0
        self.tell_lost(word, f"the expression {value.text} is written as its present value, {present:g}")
        return format_value(present)

    def _is_said(self, text: str) -> bool:
        """Return whether the version can express an expression; the first schema of 1.1 allows no comma."""
        known = _FUNCTIONS | _NEW_FUNCTIONS if self.version >= (1, 3) else _FUNCTIONS
        plain = self.version > (1, 0) and _SAID.match(text) is not None and len(text) <= _LONGEST
        return plain and known.issuperset(_FUNCTION.findall(text)) and (self.version > (1, 1) or "," not in text)


def _without_abs(text: str) -> str:
    """Return an expression with sqrt(x * x), which is identical to the last bit, instead of abs(x)."""
    while (match := re.search(r"\babs\(", text)) is not None:
        depth, close = 1, match.end()
        while depth:
            depth += {"(": 1, ")": -1}.get(text[close], 0)
            close += 1
        inner = text[match.end() : close - 1]
        text = f"{text[: match.start()]}sqrt(({inner} * {inner})){text[close:]}"
    return text
