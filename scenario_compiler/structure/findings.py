"""Where the checks of a file report: findings at elements, with a bound on how many of one code are listed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

from lxml import etree

from scenario_compiler.diagnostics import Code, Diagnostics, FilePlace, Severity
from scenario_compiler.document import Document

MANY_FINDINGS = Code(
    "SC307",
    "many-findings",
    "The file has so many faults of one kind that the rest of them is counted and not listed: 100 of each kind are "
    "shown."
    '\n\n    <lane id="-1" typ="driving">...</lane>     in each of 2000 lanes: 1900 are counted'
    "\n\nSo many equal faults mostly have one cause, in the program that wrote the file or in the version that its "
    "header names. Mend that, and check the file again.",
    Severity.WARNING,
)

SHOWN_OF_A_CODE = 100
"""Most findings of one code that are listed of one file; the rest is counted."""


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
        if self._counts[code.id] <= SHOWN_OF_A_CODE:
            origin = self.document.origin(element, attribute)
            place = origin.name_of(attribute) if by_name and attribute is not None else origin
            self._sink.add(code, message, place, hint=hint, severity=severity)

    def lists(self, code: Code) -> bool:
        """Tell whether one more finding of a code will be listed; where not, its hint need not be found."""
        return self._counts[code.id] < SHOWN_OF_A_CODE

    def close(self) -> None:
        """Say how many findings are not listed."""
        for code, count in sorted(self._counts.items()):
            if count > SHOWN_OF_A_CODE:
                message = f"{count - SHOWN_OF_A_CODE} more findings of {code} are not listed"
                self._sink.add(MANY_FINDINGS, message, FilePlace(self.document.path))

    def of(self, code: Code) -> int:
        """Return how many findings of a code were reported, listed or not."""
        return self._counts[code.id]

    @property
    def total(self) -> int:
        """Number of findings, listed or not."""
        return sum(self._counts.values())
