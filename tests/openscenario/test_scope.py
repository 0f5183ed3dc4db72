"""What `$name` and `${expression}` stand for."""

from __future__ import annotations

import pytest

from scenario_compiler.expressions import Expression, ExpressionError
from scenario_compiler.markup.environment import UnknownNameError
from scenario_compiler.openscenario.scope import LARGE, Bound, Scope, described_number, literal_number


@pytest.fixture
def scope() -> Scope:
    known = Scope({"who": Bound("string", "Ego"), "on": Bound("boolean", "true"), "count": Bound("string", "3")})
    return known.inner({name: known.opened(name, Bound("double", text)) for name, text in (("v", "7"), ("w", "2"))})


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("plain", "plain"),
        ("$who", "Ego"),
        (" $who ", "Ego"),
        ("${3 * 4}", "12"),
        ("${round(2.5) + floor(2.9) + ceil(2.1) + sign(-3) + pow(2, 3)}", "15"),
        ("${not $on or 1 < 2 and 7 % 4 == 3}", "true"),
        ("${$who}", "Ego"),
        ("${$count * 2}", "6"),
        (r"5 \$", "5 $"),
        ("$v", "7"),
        ("${$v / $w}", "3.5"),
    ],
)
def test_texts_take_the_present_value(scope: Scope, text: str, meaning: str) -> None:
    assert scope.text(text) == meaning


@pytest.mark.parametrize(
    ("text", "name"),
    [("Car$who", "who"), ("$who_2 $who", "who"), (r"Car\$who", ""), ("$who", ""), ("${$v + 1}", ""), ("Car$one", "")],
)
def test_a_parameter_inside_a_longer_text_is_not_replaced(scope: Scope, text: str, name: str) -> None:
    assert scope.inside(text) == name


def test_an_unknown_name_that_begins_with_a_parameter_explains_itself(scope: Scope) -> None:
    with pytest.raises(UnknownNameError) as unknown:
        scope.text("$who/and/more")
    assert unknown.value.hint == "'$who' is replaced only if it is the whole value"


def test_numbers_stay_open_and_texts_settle(scope: Scope) -> None:
    found = scope.symbolic("${$v / 2}")
    assert isinstance(found, Expression)
    assert found.names == ("v",)
    assert scope.structural == set()
    scope.text("${$v / $w}")
    assert scope.structural == {"v", "w"}


@pytest.mark.parametrize(
    "text", ["$nobody", "${$nobody + 1}", "${1 +}", "${1 / 0}", "${1e999}", "${" + "1+" * 500 + "1}"]
)
def test_faults_have_a_reason(scope: Scope, text: str) -> None:
    with pytest.raises(ExpressionError):
        scope.text(text)


def test_names_are_put_together(scope: Scope) -> None:
    assert scope.joined("${brake_ + $who + _ + $v}") == "brake_Ego_7"
    assert scope.joined("${$nobody + x}") is None
    assert scope.joined("plain") is None


@pytest.mark.parametrize(
    ("text", "number"),
    [
        *[("1", 1.0), ("-.5", -0.5), ("1e3", 1000.0), ("INF", LARGE), ("-INF", -LARGE), ("NaN", None), ("1,5", None)],
        *[("", None), ("1e999", None), ("0x10", None), ("1_0", None)],
    ],
)
def test_numbers_are_the_standards(text: str, number: float | None) -> None:
    assert literal_number(text) == number


@pytest.mark.parametrize(
    ("text", "expected"),
    [("1e308", "a number of at most 1e+300"), ("-1e400", "a number of at most 1e+300"), ("ten", "a number")],
)
def test_a_number_that_is_too_large_is_not_called_another_thing(text: str, expected: str) -> None:
    assert literal_number(text) is None
    assert described_number(text) == expected
