"""Calculations of the engine's language are the same in both forms, failures included."""

from __future__ import annotations

import math
import struct
from array import array
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import new_state
from scenario_compiler.forms.compiled import Compiled
from scenario_compiler.forms.failure import KINDS, EngineError, of_exception
from scenario_compiler.forms.language import FunctionSource
from scenario_compiler.forms.machine_code import MachineCode
from scenario_compiler.forms.making import build, version
from scenario_compiler.forms.translation import translated
from tests.forms import samples

ENTRIES = {function.__name__: function for function in samples.ENTRIES}
REALS = (
    st.floats() | st.floats(-1.0e3, 1.0e3) | st.sampled_from([0.0, -0.0, 1.0, -1.0, 0.5, float("inf"), float("nan")])
)
INTS = st.integers(-(2**40), 2**40) | st.integers(-5, 5)
STATE = new_state(Program(entity_count=[3]))


class Small:
    """A library of the samples, and how its entries are called."""

    def __init__(self, folder: Path, *flags: str) -> None:
        library = folder / "samples.so"
        build(translated(samples.FUNCTIONS, samples.ENTRIES), library, *flags)
        kinds = {}
        for function in samples.ENTRIES:
            signature = FunctionSource.of(function).signature
            kinds[function.__name__] = [str(kind) for kind in (*signature.arguments.values(), signature.result)]
        self.enter = Compiled(MachineCode(library, kinds, version()), st=STATE).enter

    def __call__(self, entry: str, *arguments: Any) -> Any:
        """Call an entry; EngineError where it fails."""
        return self.enter(entry, *arguments)


@pytest.fixture(scope="module")
def small(tmp_path_factory: pytest.TempPathFactory) -> Small:
    """The library as it is built for users."""
    return Small(tmp_path_factory.mktemp("small"))


@pytest.fixture(scope="module")
def checked(tmp_path_factory: pytest.TempPathFactory) -> Small:
    """The library that also checks indices and overflows."""
    return Small(tmp_path_factory.mktemp("checked"), "-DENGINE_CHECKED")


def outcome(function: Callable[..., Any], *arguments: Any) -> tuple[object, bytes]:
    """Return a call's result, or its failure as text, and the bytes of what it wrote; every NaN is the same."""
    out = array("d", [0.5] * 8)
    given = [out if one is None else one for one in arguments]
    try:
        result = function(*given)
    except EngineError as failure:
        return str(failure), b""
    except (ArithmeticError, ValueError, IndexError) as error:
        return str(of_exception(error)), b""
    kept = struct.pack("<d", result) if isinstance(result, float) else result
    if isinstance(result, float) and math.isnan(result):
        kept = "NaN"
    return kept, array("d", [float("nan") if math.isnan(value) else value for value in out]).tobytes()


def agrees(small: Small, entry: str, *arguments: Any) -> bool:
    """Return whether both forms do the same."""
    return outcome(ENTRIES[entry], *arguments) == outcome(lambda *given: small(entry, *given), *arguments)


@given(REALS, REALS)
def test_floats(small: Small, a: float, b: float) -> None:
    assert agrees(small, "real_arithmetic", a, b, None)


@given(INTS, INTS)
def test_ints(small: Small, i: int, j: int) -> None:
    assert agrees(small, "int_arithmetic", i, j, None)


@pytest.mark.parametrize("entry", ["divides", "remainder"])
@given(REALS, REALS)
@example(1.0, 0.0)
@example(-0.0, 5.0)
@example(-7.5, float("inf"))
def test_division_of_floats(small: Small, entry: str, a: float, b: float) -> None:
    assert agrees(small, entry, a, b)


@pytest.mark.parametrize("entry", ["int_quotient", "int_remainder"])
@given(INTS, INTS)
@example(7, 0)
@example(-7, 2)
@example(7, -1)
def test_division_of_ints(small: Small, entry: str, i: int, j: int) -> None:
    assert agrees(small, entry, i, j)


@pytest.mark.parametrize("entry", ["root", "logarithm", "power_of_e", "sine", "arc_cosine", "whole"])
@given(REALS)
@example(800.0)
@example(1.0e19)
@example(9223372036854775808.0)
@example(-9223372036854775808.0)
def test_functions_that_are_not_defined_everywhere(small: Small, entry: str, a: float) -> None:
    if entry == "whole" and abs(a) > 2.0e18 and abs(a) < 9.3e18:
        return  # the sum of three leaves 64 bits, which Python's ints do not
    mine, theirs = outcome(ENTRIES[entry], a), outcome(lambda given: small(entry, given), a)
    too_large = entry == "whole" and abs(a) > 9.3e18
    assert mine == theirs or (too_large and KINDS[2] in str(theirs[0]))


@given(st.integers(-3, 40))
def test_loops(small: Small, count: int) -> None:
    assert agrees(small, "loops", count, None)


@given(REALS, INTS)
def test_several_results(small: Small, a: float, i: int) -> None:
    assert agrees(small, "takes_apart", a, i, None)


@pytest.mark.parametrize("which", [0, 1])
def test_tables(small: Small, which: int) -> None:
    assert agrees(small, "dispatches", which, 3.5, None)


@pytest.mark.parametrize("which", [2, 100])
def test_a_place_beyond_a_table_fails(small: Small, checked: Small, which: int) -> None:
    assert agrees(checked, "dispatches", which, 3.5, None) is False  # the dispatch has no line in the Python file
    for library in (small, checked):
        with pytest.raises(EngineError, match="an index outside its column"):
            library("dispatches", which, 3.5, array("d", [0.0] * 8))


@pytest.mark.parametrize("i", [-4, -3, -1, 0, 2, 3, 2**40])
def test_an_index_outside_its_column_fails_in_the_checked_build(checked: Small, i: int) -> None:
    assert outcome(lambda k: samples.element(STATE, k), i) == outcome(lambda k: checked("element", k), i)


def test_an_overflow_fails_in_the_checked_build(checked: Small) -> None:
    with pytest.raises(EngineError, match="a number too large"):
        checked("int_arithmetic", 2**63 - 1, 2, array("d", [0.0] * 8))
