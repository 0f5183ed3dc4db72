"""Every marked function translates, and constructs that the engine's language lacks are reported with their lines."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable
from math import sqrt
from pathlib import Path
from typing import Any

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.forms.language import NotTranslatableError, entries, marked_functions
from scenario_compiler.forms.translation import translated


@pytest.fixture(scope="module")
def engine() -> str:
    """The C of the whole engine."""
    return translated(marked_functions(), entries())


def test_every_marked_function_translates(engine: str) -> None:
    assert engine.count("EXPORT int32_t enter_") == len(entries())


ONLY_STANDARD_LIBRARY = """
import sys
sys.path.insert(0, sys.argv[1])
from scenario_compiler.forms.language import entries, marked_functions
from scenario_compiler.forms.translation import translated
sys.stdout.write(translated(marked_functions(), entries()))
"""


def test_the_standard_library_alone_gives_the_same_text_in_another_process(engine: str, repository: Path) -> None:
    command = [sys.executable, "-I", "-S", "-c", ONLY_STANDARD_LIBRARY, str(repository)]
    done = subprocess.run(command, capture_output=True, encoding="utf-8", check=True)
    assert done.stdout == engine


def takes_constant(st: State) -> float:
    """Take a number of a module by its attribute."""
    return st.v[0] * op.FAR


def test_the_c_is_readable_and_names_its_lines() -> None:
    text = translated([takes_constant], [])
    line = takes_constant.__code__.co_firstlineno + 2
    assert f'#line {line} "tests/forms/test_translation.py"' in text
    assert "return AT(st, v, 0) * 1000000000.0 /* op.FAR */;" in text
    assert "/* Take a number of a module by its attribute. */" in text


def raises(p: Program) -> float:
    if p.const[0] > 0.0:
        raise ValueError
    return 0.0


def uses_power(x: float) -> float:
    return float(x**2)


def calls_hypot(x: float) -> float:
    return math.hypot(x, x)


def divides(x: float, y: float) -> float:
    return x / y


def divides_guarded(x: float, y: float) -> float:
    if y > 0.0:
        return x / y
    return x / 2.0 + x / max(y, 1.0)


def takes_root(x: float) -> float:
    return sqrt(x)


def makes_list(x: float) -> float:
    return [x][0]


def reads_unassigned(st: State) -> float:
    if st.v[0] > 0.0:
        speed = st.v[0]
    return speed


def stores_int(st: State) -> None:
    st.v[0] = 0


def keeps_two_kinds(x: float) -> float:
    y = 1
    y = x  # type: ignore[assignment]
    return 2.0 * y


def writes_program(p: Program) -> None:
    p.ego[0] = 1


def takes_column(st: State) -> float:
    column = st.v
    return column[0]


def reads_no_column(st: State) -> float:
    return st.nonsense[0]  # type: ignore[attr-defined, no-any-return]


def has_default(x: float = 1.0) -> float:
    return x


def wrong_order(st: State, p: Program) -> float:
    return st.v[0] + p.const[0]


def speaks(x: float) -> str:
    return "text" if x > 0.0 else "other"


def calls_unmarked(x: float) -> float:
    return divides(x, 1.0)


def changes(st: State) -> float:
    st.v[0] = 2.0
    return 1.0


def sees_a_change(st: State) -> float:
    return st.v[0] + changes(st)


def mixes(x: float) -> float:
    return max(x, 1)


def forgets_its_result(x: float) -> float:  # type: ignore[return]  # noqa: RET503
    while x > 0.0:
        return x


def decides_by_float(x: float) -> int:
    return 1 if x else 0


@pytest.mark.parametrize(
    ("function", "rule"),
    [
        (raises, "a statement that the engine's language lacks: Raise"),
        (uses_power, "has an operator that the engine's language lacks"),
        (calls_hypot, "calls math.hypot, which is not a plain name"),
        (divides, "divides by y without a guard"),
        (takes_root, "calls sqrt(x) without a guard"),
        (makes_list, "takes an element of [x]"),
        (reads_unassigned, "reads speed, which a path has not assigned"),
        (stores_int, "stores int in st.v[0], which is real"),
        (keeps_two_kinds, "keeps real in y, which is int elsewhere"),
        (writes_program, "writes p.ego"),
        (takes_column, "takes st.v, which is not a number of a module, as a whole"),
        (reads_no_column, "reads st.nonsense, which is not a column"),
        (has_default, "has optional, named or collected arguments"),
        (wrong_order, "does not take p and st first and in this order"),
        (speaks, "annotated as str"),
        (calls_unmarked, "calls divides, which is neither marked nor known to both forms"),
        (sees_a_change, "changes the state in 'changes(st)' beside what may see it"),
        (mixes, "calls max with int and real"),
        (forgets_its_result, "has a path without a result"),
        (decides_by_float, "decides by 'x', which is real"),
    ],
)
def test_constructs_that_the_language_lacks_are_reported(function: Callable[..., Any], rule: str) -> None:
    with pytest.raises(NotTranslatableError) as found:
        translated([function, changes], [])
    assert [rule in str(one) for one in found.value.findings] == [True]
    assert found.value.findings[0].file == "tests/forms/test_translation.py"
    first = function.__code__.co_firstlineno
    assert first <= found.value.findings[0].line <= first + 4


def test_all_findings_are_reported_at_once() -> None:
    with pytest.raises(NotTranslatableError) as found:
        translated([uses_power, stores_int, makes_list], [])
    assert len(found.value.findings) == 3


def test_a_guarded_division_is_not_reported() -> None:
    assert "divides_guarded" in translated([divides_guarded], [])
