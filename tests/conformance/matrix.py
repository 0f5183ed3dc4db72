"""Every variant of every feature with its evidence: a recorded run, a law stated by a test, a decision, or none."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from tests.conformance.esmini import Comparison, RecordedRun
from tests.conformance.explained import DECISIONS
from tests.conformance.variants import VARIANTS, Variant

LAWS = Path(__file__).resolve().parents[1] / "engine" / "laws"
"""Folder of the tests that state laws."""


@dataclass(frozen=True)
class Backing:
    """What backs a variant.

    Attributes:
        variant: The variant.
        agreeing: Number of recorded runs of it that agree.
        runs: Number of recorded runs of it.
        decision: Why it differs by decision; empty where it does not.
        laws: Names of the tests that state its law.
    """

    variant: Variant
    agreeing: int
    runs: int
    decision: str
    laws: tuple[str, ...]

    @property
    def verdict(self) -> str:
        """What the page says of the variant."""
        if self.decision:
            return "differs by decision"
        if self.agreeing:
            return "agrees"
        if self.laws:
            return "not recorded, law stated"
        return "not recorded"

    @property
    def backed(self) -> bool:
        """Whether a recorded run or a stated law says that it is right."""
        return not self.decision and (self.agreeing > 0 or len(self.laws) > 0)


def laws_stated() -> dict[tuple[str, str], list[str]]:
    """Return the tests that state the law of each variant: those marked `law(feature, variant)`."""
    found: dict[tuple[str, str], list[str]] = {}
    for file in sorted(LAWS.glob("test_*.py")):
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                for key in _marks(node):
                    found.setdefault(key, []).append(node.name)
    return found


def _marks(test: ast.FunctionDef) -> Iterator[tuple[str, str]]:
    for mark in test.decorator_list:
        if isinstance(mark, ast.Call) and ast.unparse(mark.func) == "pytest.mark.law":
            feature, variant = (ast.literal_eval(one) for one in mark.args)
            yield feature, variant


def backings(compared: Sequence[tuple[RecordedRun, Comparison]]) -> list[Backing]:
    """Return what backs each variant, given every recorded run and how it compares."""
    files = [(etree.parse(str(run.scenario)).getroot(), comparison.agrees) for run, comparison in compared]
    laws = laws_stated()
    return [_backing(variant, files, laws) for variant in VARIANTS]


def _backing(
    variant: Variant, files: Sequence[tuple[etree._Element, bool]], laws: Mapping[tuple[str, str], list[str]]
) -> Backing:
    key = variant.feature, variant.name
    runs = [agrees for root, agrees in files if root.xpath(variant.path)]
    return Backing(variant, sum(runs), len(runs), DECISIONS.get(key, ""), tuple(laws.get(key, ())))
