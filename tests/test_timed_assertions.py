"""No test asserts a duration, which would fail on a slow or busy machine; work is counted instead (`tests.work`).

A clock may be read to wait until a deadline. Times are compared in `tests/benchmarks` alone, as ratios in one run.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parent
FREE = ("benchmarks", "fuzz")
"""Folders of programs that print times."""

CLOCKS = frozenset(
    {
        "monotonic",
        "monotonic_ns",
        "perf_counter",
        "perf_counter_ns",
        "process_time",
        "process_time_ns",
        "ru_stime",
        "ru_utime",
        "thread_time",
        "thread_time_ns",
        "time.time",
        "time.time_ns",
        "os.times",
        "timeit",
    }
)
"""Functions that read a clock, with their module where the name alone is common; times of `getrusage`."""


def _reads_a_clock(node: ast.AST) -> bool:
    """Return whether a node of the syntax tree is itself a reading of a clock."""
    if isinstance(node, ast.Attribute):
        owner = node.value.id if isinstance(node.value, ast.Name) else ""
        return node.attr in CLOCKS or f"{owner}.{node.attr}" in CLOCKS
    return isinstance(node, ast.Name) and node.id in CLOCKS


def _names(node: ast.AST) -> Iterator[str]:
    """Yield the names that a node uses, those of functions that are called among them."""
    for inner in ast.walk(node):
        if isinstance(inner, ast.Name):
            yield inner.id


def _timed(node: ast.AST, timed: set[str]) -> bool:
    """Return whether an expression depends on a clock, directly or through one of the timed names."""
    return any(map(_reads_a_clock, ast.walk(node))) or not timed.isdisjoint(_names(node))


def _bound(node: ast.AST, timed: set[str]) -> Iterator[str]:
    """Yield the names that one statement makes timed: what is assigned, appended to, or returns a time."""
    if isinstance(node, ast.Assign | ast.AugAssign | ast.AnnAssign | ast.NamedExpr):
        if node.value is not None and _timed(node.value, timed):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                yield from _names(target)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and isinstance(node.func.value, ast.Name):
        if node.func.attr in {"append", "add", "extend"} and any(_timed(one, timed) for one in node.args):
            yield node.func.value.id
    elif isinstance(node, ast.FunctionDef):
        returned = (one.value for one in ast.walk(node) if isinstance(one, ast.Return) and one.value is not None)
        if any(_timed(one, timed) for one in returned):
            yield node.name


def timed_assertions(text: str) -> list[int]:
    """Return the lines of the assertions whose outcome depends on a clock, as far as names tell."""
    tree = ast.parse(text)
    timed: set[str] = set()
    while True:
        more = {name for node in ast.walk(tree) for name in _bound(node, timed)}
        if more <= timed:
            break
        timed |= more
    return [node.lineno for node in ast.walk(tree) if isinstance(node, ast.Assert) and _timed(node.test, timed)]


def texts() -> dict[Path, str]:
    """Return the texts of the tests, by their files."""
    files = [path for path in sorted(TESTS.rglob("*.py")) if path.relative_to(TESTS).parts[0] not in FREE]
    return {path: path.read_text(encoding="utf-8") for path in files}


def test_no_test_asserts_a_time() -> None:
    assert len(texts()) > 100
    timed = {path: text for path, text in texts().items() if any(clock in text for clock in CLOCKS)}
    found = [
        f"{path.relative_to(TESTS.parent)}:{line}" for path, text in timed.items() for line in timed_assertions(text)
    ]
    assert found == []


def test_no_test_gives_a_page_a_time() -> None:
    """A slow machine's page has not done by then what it will do: tests wait for the state that must come."""
    others = {path: text for path, text in texts().items() if path != Path(__file__).resolve()}
    assert [path.name for path, text in others.items() if ".wait_for_timeout(" in text] == []


@pytest.mark.parametrize(
    "text",
    [
        "start = time.perf_counter()\nassert time.perf_counter() - start < 1",
        "before = process_time()\nwork()\nspent = process_time() - before\nassert spent < 1",
        "times = []\ntimes.append(time.time() - start)\nassert min(times) < 1",
        "def spent():\n    used = getrusage(RUSAGE_SELF)\n    return used.ru_utime + used.ru_stime\nassert spent() < 1",
        "taken = timeit.timeit(work)\nslow = taken > 1\nassert not slow",
    ],
)
def test_a_timed_assertion_is_found(text: str) -> None:
    assert timed_assertions(text) == [len(text.splitlines())]


@pytest.mark.parametrize(
    "text",
    [
        "deadline = time.monotonic() + 60\nwhile not done() and time.monotonic() < deadline:\n    pass\nassert done()",
        "before = getrusage(RUSAGE_SELF).ru_maxrss\nassert getrusage(RUSAGE_SELF).ru_maxrss - before < 500",
        "found, lines = counted(work)\nassert lines < 1000",
        "assert recording.time[-1] == 10.0",
    ],
)
def test_deadlines_memory_and_counts_are_allowed(text: str) -> None:
    assert timed_assertions(text) == []
