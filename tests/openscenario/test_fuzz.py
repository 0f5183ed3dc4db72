"""Damaged OpenSCENARIO files: elements deleted, doubled, swapped, renamed, values swapped and spoilt.

None crashes or hangs.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NoReturn, TypeVar

import pytest
from lxml import etree

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.engine.columns.opcodes import STOP_NONE
from scenario_compiler.engine.columns.state import make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.randomness import random_hash
from scenario_compiler.validation import validate_file
from tests.bounded import bounded

USUAL_CASES = 40
MANY_CASES = 2000
LONGEST = 20
"""Time that reading and running one file may take, s."""

STEPS = 40
FAULTS = 4
"""Most faults in a file."""

SPOILT = (
    "",
    "nan",
    "INF",
    "-1",
    "1e308",
    "-1e308",
    "0",
    "-0.0",
    "2147483648",
    "1e-320",
    "$missing",
    "${1/0}",
    "${",
    "true",
    "step",
    "Ego",
    "::",
    "a::b",
    "9" * 400,
    "\u00e4 \u2028",
)

T = TypeVar("T")


class Draw:
    """Draws that depend on the number of the case alone."""

    def __init__(self, case: int) -> None:
        self.case = case
        self.count = 0

    def below(self, bound: int) -> int:
        """Return a number from 0 to bound - 1."""
        self.count += 1
        return random_hash(self.case, 7, 0, self.count) % bound

    def one(self, of: Sequence[T]) -> T:
        """Return one of several."""
        return of[self.below(len(of))]


def delete(element: etree._Element, draw: Draw) -> None:
    """Delete an element."""
    parent = element.getparent()
    if parent is not None:
        parent.remove(element)


def double(element: etree._Element, draw: Draw) -> None:
    """Write an element twice."""
    parent = element.getparent()
    if parent is not None:
        parent.append(copy.deepcopy(element))


def swap(element: etree._Element, draw: Draw) -> None:
    """Exchange an element with another one from anywhere."""
    other = draw.one(list(element.getroottree().getroot().iter(etree.Element)))
    one, two = copy.deepcopy(element), copy.deepcopy(other)
    parent, elsewhere = element.getparent(), other.getparent()
    if parent is not None and elsewhere is not None:
        parent.append(two)
        elsewhere.append(one)


def spoil(element: etree._Element, draw: Draw) -> None:
    """Give an attribute a value that makes no sense, or delete it."""
    if element.attrib:
        name = draw.one(sorted(map(str, element.attrib)))
        if draw.below(4) == 0:
            del element.attrib[name]
        else:
            element.attrib[name] = draw.one(SPOILT)


def swap_values(element: etree._Element, draw: Draw) -> None:
    """Give an attribute the value of one somewhere else."""
    values = [
        str(value) for one in element.getroottree().getroot().iter(etree.Element) for value in one.attrib.values()
    ]
    if element.attrib and values:
        element.attrib[draw.one(sorted(map(str, element.attrib)))] = draw.one(values)


def rename(element: etree._Element, draw: Draw) -> None:
    """Give an element the tag of one somewhere else."""
    element.tag = draw.one(list(element.getroottree().getroot().iter(etree.Element))).tag


DAMAGES: tuple[Callable[[etree._Element, Draw], None], ...] = (
    *(delete, double, swap, rename, spoil, spoil, swap_values),
)


def damaged(path: Path, draw: Draw) -> bytes:
    """Return a file with some faults."""
    tree = etree.parse(str(path), etree.XMLParser(resolve_entities=False))
    for _ in range(1 + draw.below(FAULTS)):
        draw.one(DAMAGES)(draw.one(list(tree.getroot().iter(etree.Element))), draw)
    return etree.tostring(tree)


def overdue(what: str) -> NoReturn:
    """Fail because something takes longer than LONGEST."""
    pytest.fail(f"{what} takes more than {LONGEST} s")


def surroundings(original: Path, corpus: Path, folder: Path) -> Path:
    """Return a path for a damaged copy, in folders of its own, from which the same maps and catalogs are found."""
    there, here = corpus, folder
    for part in (*original.parent.relative_to(corpus).parts, ""):
        here.mkdir(exist_ok=True)
        for entry in there.iterdir():
            if entry.name != part and entry != original and not (here / entry.name).exists():
                (here / entry.name).symlink_to(entry)
        there, here = there / part, here / part
    return here / original.name


def read_and_run(path: Path) -> None:
    """Validate, compile and, where that goes, run a file for a few steps."""
    validate_file(path, Diagnostics())
    sink = Diagnostics()
    done = compile_target(path, {}, sink, overrides=Overrides(perception="ideal", duration=60.0))
    assert done is not None or sink.has_errors, "a file that is not compiled is told why"
    if done is None:
        return
    program = build_program(done.plan, done.network)
    state = new_state(program)
    state.draw[:] = make_draws(1, 0)
    reset(done.network.tables, program, state)
    for _ in range(STEPS):
        if state.stop[0] != STOP_NONE or step(done.network.tables, program, state) == 0:
            return


def scenarios(corpus: Path) -> list[Path]:
    """Return the corpus' scenarios that can be parsed, small ones: damage is done to the parsed file."""
    found = []
    for path in sorted(corpus.rglob("*.xosc")):
        if "Catalogs" not in path.parts and path.stat().st_size < 60_000:
            try:
                etree.parse(str(path), etree.XMLParser(resolve_entities=False))
            except etree.XMLSyntaxError:
                continue
            found.append(path)
    return found


@pytest.mark.parametrize(
    "cases",
    [range(USUAL_CASES), pytest.param(range(USUAL_CASES, USUAL_CASES + MANY_CASES), marks=pytest.mark.slow)],
    ids=["usual", "many"],
)
def test_a_damaged_file_is_diagnosed_or_runs(corpus: Path, tmp_path: Path, cases: range) -> None:
    paths = scenarios(corpus)
    faults: list[str] = []
    for case in cases:
        draw = Draw(case)
        original = draw.one(paths)
        path = surroundings(original, corpus, tmp_path / str(case))
        with path.open("xb") as file:
            file.write(damaged(original, draw))
        with bounded(LONGEST, partial(overdue, f"case {case}, {original.name}")):
            try:
                read_and_run(path)
            except Exception as fault:
                faults.append(f"case {case}, {original.name}: {type(fault).__name__}: {fault}")
    assert faults == []
