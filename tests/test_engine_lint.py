"""The rules of compiled functions hold for every marked function, and the lint finds what breaks them."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pytest

from scenario_compiler.engine.build import engine_text, layout_of_containers
from scenario_compiler.engine.lint import lint
from scenario_compiler.engine.source import module_text
from scenario_compiler.engine.state import State
from scenario_compiler.engine.tables import Program
from scenario_compiler.marker import REGISTRY

ALLOWED = {
    ("scenario_compiler.roads.locate.project_on_piece", "divides by k without a guard"),
    ("scenario_compiler.roads.locate.project_on_piece", "divides by turn without a guard"),
}
"""An arc's curvature is not 0: pieces without curvature are stored as lines."""


def test_every_marked_function_keeps_the_rules() -> None:
    found = [finding for function in REGISTRY for finding in lint(function)]
    assert [str(one) for one in found if (one.function, one.rule) not in ALLOWED] == []


def test_all_marked_functions_fit_in_one_module() -> None:
    compile(engine_text(), "engine", "exec")


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
    from math import sqrt

    return sqrt(x)


def makes_list(x: float) -> float:
    return [x][0]


def reads_unassigned(st: State) -> float:
    if st.v[0] > 0.0:
        speed = st.v[0]
    return speed


def stores_int(st: State) -> None:
    st.v[0] = 0


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


@pytest.mark.parametrize(
    ("function", "rule"),
    [
        (raises, "raises"),
        (uses_power, "uses **"),
        (calls_hypot, "bare name"),
        (divides, "divides by y"),
        (takes_root, "calls sqrt(x)"),
        (makes_list, "makes a list"),
        (reads_unassigned, "reads speed, which a path"),
        (stores_int, "stores 0 in st.v"),
        (writes_program, "writes p.ego"),
        (takes_column, "takes the column st.v whole"),
        (reads_no_column, "no column"),
        (has_default, "optional"),
        (wrong_order, "in this order"),
        (speaks, "has the constant 'text'"),
    ],
)
def test_a_broken_rule_is_found(function: Callable[..., Any], rule: str) -> None:
    assert any(rule in finding.rule for finding in lint(function))


def test_a_guarded_division_is_no_finding() -> None:
    assert lint(divides_guarded) == []


def test_the_generator_refuses_what_is_not_marked_and_double_names() -> None:
    layout = layout_of_containers(checked=False)
    with pytest.raises(TypeError, match="uses divides, which is a function"):
        module_text([calls_unmarked], layout)
    with pytest.raises(TypeError, match="two compiled functions are called divides"):
        module_text([divides, divides], layout)


def calls_unmarked(x: float) -> float:
    return divides(x, 1.0)
