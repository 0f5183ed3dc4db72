"""Reports the findings of a file's checks at elements, counted by code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from lxml import etree

from scenario_compiler.diagnostics import MOST_OF_A_KIND, Code, Diagnostics, Place, Severity
from scenario_compiler.document import Document

Mild = Callable[[Code, etree._Element], bool]


class Findings:
    """Reports the faults of one document to a sink."""

    def __init__(self, document: Document, sink: Diagnostics, mild: Mild | None = None) -> None:
        """Set the document and the sink; `mild` gives the codes and elements whose findings are warnings."""
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
        text: str = "",
        hint: str = "",
        severity: Severity | None = None,
    ) -> None:
        """Report a finding at an element, at the value of an attribute, at the attribute's name, or at a text."""
        self._counts[code.id] += 1
        if severity is None and self._mild is not None and self._mild(code, element):
            severity = Severity.WARNING
        place: Place = self.document.origin(element, attribute)
        if self._counts[code.id] <= MOST_OF_A_KIND:
            if by_name and attribute is not None:
                place = self.document.origin(element).name_of(attribute)
            elif text:
                place = self.document.text_place(element, text)
        self._sink.add(code, message, place, hint=hint, severity=severity)

    def lists(self, code: Code) -> bool:
        """Return whether one more finding of a code will be listed; if not, its hint need not be determined."""
        return self._counts[code.id] < MOST_OF_A_KIND

    def of(self, code: Code) -> int:
        """Return how many findings of a code were reported, listed or not."""
        return self._counts[code.id]

    @property
    def total(self) -> int:
        """Number of findings, listed or not."""
        return sum(self._counts.values())
