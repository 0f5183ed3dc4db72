"""Damaged files: whatever is deleted, doubled, swapped or renamed in a real file, it is compiled or diagnosed."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import pytest
from lxml import etree

from scenario_compiler.compiler import Overrides, compile_expanded
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.document import parse_document, read_document
from scenario_compiler.languages import expand, parse
from scenario_compiler.randomness import uniform

TEXTS = (
    *("", "-1", "0", "1e308", "-1e308", "NaN", "INF", "$x", "${1/0}", "${", "Ego", "true", "::", "a::b", "-0.0"),
    *("99999999999999999999", "1e-320", "2147483648", "step", "\u00e9"),
)
"""Values that are put in place of others."""


Thing = TypeVar("Thing")


@dataclass
class Draws:
    """Draws that a seed decides, one after the other."""

    seed: int
    count: int = 0

    def below(self, limit: int) -> int:
        """Return a whole number from 0 to one below the limit."""
        self.count += 1
        return int(uniform(self.seed, self.count, "damage") * limit)

    def choice(self, some: Sequence[Thing]) -> Thing:
        """Return one of some things."""
        return some[self.below(len(some))]


def _damage(root: etree._Element, draw: Draws) -> None:
    """Do one thing to a file that its author did not mean."""
    elements = list(root.iter(etree.Element))
    element, other = draw.choice(elements[1:] or elements), draw.choice(elements)
    parent = element.getparent()
    kind = draw.below(7)
    if kind == 0 and parent is not None:
        parent.remove(element)
    elif kind == 1 and parent is not None:
        parent.insert(parent.index(element), copy.deepcopy(element))
    elif kind == 2 and element.attrib:
        element.set(draw.choice(list(element.attrib)), draw.choice(TEXTS))
    elif kind == 3 and element.attrib:
        del element.attrib[draw.choice(list(element.attrib))]
    elif kind == 4 and element.attrib and other.attrib:
        element.set(draw.choice(list(element.attrib)), str(draw.choice(list(other.attrib.values()))))
    elif kind == 5 and parent is not None:
        parent.append(copy.deepcopy(other))
    elif kind == 6:
        element.tag = other.tag


def _compile(raw: bytes, path: Path) -> Diagnostics:
    sink = Diagnostics()
    document = parse_document(raw, str(path), sink)
    source = None if document is None else parse(document, sink)
    for name in () if source is None else source.scenarios:
        assert source is not None
        scenario = expand(source, name, {}, sink)
        if scenario is not None:
            compile_expanded(scenario, source.document, sink, (), Overrides())
    return sink


def _try(corpus: Path, seed: int, cases: int) -> None:
    draw = Draws(seed)
    files = [file for file in sorted(corpus.rglob("*.xosc")) if "Catalogs" not in file.parts]
    for case in range(cases):
        path = draw.choice(files)
        whole = read_document(path, Diagnostics())
        if whole is None:
            continue
        root = copy.deepcopy(whole.root)
        for _ in range(draw.choice((1, 1, 1, 2, 3, 5))):
            _damage(root, draw)
        try:
            list(_compile(etree.tostring(root), path))
        except Exception as fault:
            pytest.fail(f"case {case} of seed {seed}, made from {path}: {type(fault).__name__}: {fault}")


def test_damaged_files_are_diagnosed(corpus: Path) -> None:
    _try(corpus, seed=1, cases=80)


@pytest.mark.slow
def test_many_damaged_files_are_diagnosed(corpus: Path) -> None:
    _try(corpus, seed=2, cases=2000)
