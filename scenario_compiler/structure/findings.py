"""Reports the findings of a file's checks at elements, counted by code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from lxml import etree

from scenario_compiler.diagnostics import MOST_OF_A_KIND, Code, Diagnostics, Severity
from scenario_compiler.document import Document

Mild = Callable[[Code, etree._Element], bool]


class Findings:
    """Reports into a sink what is wrong in one document."""

    def __init__(self, document: Document, sink: Diagnostics, mild: Mild | None = None) -> None:
        """Start with no finding; `mild` tells which findings are warnings here, by code and element."""
        self.document = document
        self._sink = sink
        self._mild = mild
        self._counts: Counter[str] = Counter()

    def report(
        self,
        code: Code,
        message: str,
        element: etree._Element,
        attribute: str | None = None,
        *,
        by_name: bool = False,
        hint: str = "",
        severity: Severity | None = None,
    ) -> None:
        """Report a finding at an element, at the value of one of its attributes, or at the attribute's name."""
        self._counts[code.id] += 1
        if severity is None and self._mild is not None and self._mild(code, element):
            severity = Severity.WARNING
        origin = self.document.origin(element, attribute)
        named = by_name and attribute is not None and self._counts[code.id] <= MOST_OF_A_KIND
        place = origin.name_of(attribute) if named and attribute is not None else origin
        self._sink.add(code, message, place, hint=hint, severity=severity)

    def lists(self, code: Code) -> bool:
        """Tell whether one more finding of a code will be listed; where not, its hint need not be found."""
        return self._counts[code.id] < MOST_OF_A_KIND

    def of(self, code: Code) -> int:
        """Return how many findings of a code were reported, listed or not."""
        return self._counts[code.id]

    @property
    def total(self) -> int:
        """Number of findings, listed or not."""
        return sum(self._counts.values())
