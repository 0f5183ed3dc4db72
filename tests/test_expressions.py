"""Expressions: their values, their faults, and the round trip through their text."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenario_compiler.expressions import (
    FUNCTIONS,
    MAX_LENGTH,
    Expression,
    ExpressionError,
    Value,
    format_value,
    names_in,
    parse_expression,
)

VALUES: dict[str, Value] = {"a": 2.0, "b": 3.0, "flag": True, "name": "car"}


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1 + 2 * 3", 7.0),
        ("(1 + 2) * 3", 9.0),
        ("1.9 * (1 - $a)", -1.9),
        ("a - b - 1", -2.0),
        ("2 ^ 3", 8.0),
        ("-2 ^ 2", -4.0),
        ("7 % 3", 1.0),
        ("-7 % 3", -1.0),
        ("7 % -3", 1.0),
        ("-7.5 % 2", -1.5),
        ("-a + +b", 1.0),
        ("1 < 2 and 2 <= 2", True),
        ("not flag or a > b", False),
        ("a == 2", True),
        ("name == 'car'", True),
        ("name != 'van'", True),
        ("if(a > b, 1, 2)", 2.0),
        ("if(flag, 1, 1 / 0)", 1.0),
        ("min(a, b, 1) + max(4, 5)", 6.0),
        ("min(4) - max(a)", 2.0),
        ("sqrt(16) + abs(-1)", 5.0),
        ("round(2.5)", 3.0),
        ("round(-2.5)", -3.0),
        ("round(-2.4)", -2.0),
        ("round(0.49999999999999994)", 0.0),
        ("floor(-1.5) + ceil(1.2) + sign(-3)", -1.0),
        ("radians(180) / pi", 1.0),
        ("degrees(pi)", 180.0),
        ("pow(2, 0.5) ^ 2", 2.0000000000000004),
        ("1e-3 + .5", 0.501),
        ("true", True),
        ("'text'", "text"),
    ],
)
def test_value(text: str, value: Value) -> None:
    assert parse_expression(text).evaluate(VALUES) == value


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("name + 1", "('car' + 1) has no value: 'car' is a text, not a number"),
        ("name * flag", "('car' * true) has no value: 'car' is a text, not a number"),
        ("'3' ^ 2", "('3' ^ 2) has no value: '3' is a text, not a number"),
        ("name < 1", "('car' < 1) has no value: 'car' is a text, not a number"),
        ("-name", "(-'car') has no value: 'car' is a text, not a number"),
        ("max(name, 1)", "max('car', 1) has no value: 'car' is a text, not a number"),
        ("a / 0", "(2 / 0) has no value: nothing can be divided by 0"),
        ("a % 0", "(2 % 0) has no value: nothing can be divided by 0"),
        ("0 ^ -a", "(0 ^ -2) has no value: 0 has no negative powers"),
        ("(-8) ^ 0.5", "((-8) ^ 0.5) has no value: a negative number has whole powers only"),
        ("2 ^ 5000", "(2 ^ 5000) has no value: the result is too large a number"),
        ("1e300 * 1e300", "(1e+300 * 1e+300) has no value: the result is too large a number"),
        ("exp(9999)", "exp(9999) has no value: the result is too large a number"),
        ("sqrt(-a)", "sqrt(-2) has no value: a negative number has no root"),
        ("log(0)", "log(0) has no value: only a number above 0 has a logarithm"),
        ("acos(a)", "acos(2) has no value: it takes a number from -1 to 1"),
    ],
)
def test_a_missing_value_is_explained_in_the_languages_terms(text: str, reason: str) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text).evaluate(VALUES)
    assert str(caught.value) == reason


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("a = 2", "=="),
        ("a > 1 && a < 3", "and"),
        ("a > 1 || a < 3", "or"),
        ("!(a > 1)", "not"),
        ("a > 1 ? 2 : 3", "if"),
    ],
)
def test_a_sign_of_another_language_is_translated(text: str, meant: str) -> None:
    with pytest.raises(ExpressionError, match=f"is not part of the expression language; write {meant}"):
        parse_expression(text)


def test_the_length_of_texts_is_limited() -> None:
    twice = parse_expression("$x + $x")
    with pytest.raises(ExpressionError, match=f"a text has at most {MAX_LENGTH} characters") as caught:
        twice.evaluate({"x": "x" * MAX_LENGTH})
    assert len(str(caught.value)) < 300


def test_a_negative_value_keeps_its_sign_in_a_power() -> None:
    squared = parse_expression("$x ^ 2").substitute({"x": -2.0})
    assert squared.evaluate({}) == parse_expression(squared.text).evaluate({}) == 4.0


@pytest.mark.parametrize(
    ("text", "offset"),
    [
        ("1 +", 3),
        ("(1", 2),
        ("1 2", 2),
        ("a @ b", 2),
        ("f(1)", 0),
        ("atan2(1)", 0),
        ("1 + * 2", 4),
        ("", 0),
        ("__import__('os')", 0),
        ("a.b()", 0),
        ("[1]", 0),
    ],
)
def test_a_fault_has_its_position(text: str, offset: int) -> None:
    with pytest.raises(ExpressionError) as caught:
        parse_expression(text)
    assert caught.value.offset == offset


@pytest.mark.parametrize(
    "text",
    ["1 / 0", "sqrt(-1)", "log(0)", "10 ^ 400", "(-8) ^ (1 / 3)", "'a' * 'b'", "missing", "-'a'", "1 % 0", "exp(1000)"],
)
def test_a_missing_value_is_an_error(text: str) -> None:
    with pytest.raises(ExpressionError):
        parse_expression(text).evaluate(VALUES)


@pytest.mark.parametrize("text", ["'car'", "1e308 * 10"])
def test_a_number_that_is_not_finite_is_an_error(text: str) -> None:
    with pytest.raises(ExpressionError):
        parse_expression(text).number({})


def test_size_and_depth_are_bounded() -> None:
    for text in ("(" * 1000 + "1" + ")" * 1000, "1+" * MAX_LENGTH + "1", "-" * 500 + "1"):
        with pytest.raises(ExpressionError):
            parse_expression(text)


def test_names() -> None:
    assert parse_expression("$b + sin(a) * pi - b").names == ("a", "b")


def test_substitution() -> None:
    expression = parse_expression("$far * 2").substitute({"far": parse_expression("gap + 1")})
    assert expression.text == "(($gap + 1) * 2)"
    assert expression.number({"gap": 4.0}) == 10.0
    assert expression.substitute({"gap": 4.0}).names == ()


def test_equal_texts_are_equal_expressions() -> None:
    assert parse_expression("1+$a") == parse_expression(" 1 + a ")
    assert hash(parse_expression("1+$a")) == hash(parse_expression(" 1 + a "))


NUMBERS = st.floats(min_value=0, max_value=1e12, allow_subnormal=False).map(format_value)
ATOMS = st.one_of(NUMBERS, st.sampled_from(["a", "$b", "pi", "true"]))
TEXTS = st.recursive(
    ATOMS,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from(["+", "-", "*", "/", "%", "<", "==", "and", "or"]), inner).map(
            lambda parts: f"({parts[0]} {parts[1]} {parts[2]})"
        ),
        inner.map(lambda text: f"-{text}"),
        inner.map(lambda text: f"(not {text})"),
        st.tuples(inner, inner, inner).map(lambda parts: f"if({parts[0]}, {parts[1]}, {parts[2]})"),
        inner.map(lambda text: f"min({text}, 1)"),
    ),
    max_leaves=12,
)


def _outcome(expression: Expression) -> object:
    try:
        value = expression.evaluate(VALUES)
    except ExpressionError:
        return "no value"
    return "not a number" if isinstance(value, float) and math.isnan(value) else value


@given(text=TEXTS)
def test_text_reads_back_as_the_same_expression(text: str) -> None:
    expression = parse_expression(text)
    again = parse_expression(expression.text)
    assert again == expression
    assert again.text == expression.text
    assert _outcome(again) == _outcome(expression)


@given(text=st.text(alphabet="0123456789ab$+-*/%^<>=(),.' eif", max_size=30))
def test_any_text_is_read_or_refused(text: str) -> None:
    try:
        expression = parse_expression(text)
    except ExpressionError as error:
        assert 0 <= error.offset <= len(text)  # noqa: PT017  # a text may be an expression or not
    else:
        _outcome(expression)


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "1"), (0.1, "0.1"), (-2.5, "-2.5"), (1e22, "1e+22"), (True, "true"), ("as is", "as is"), (-0.0, "0")],
)
def test_values_as_xml_writes_them(value: Value, text: str) -> None:
    assert format_value(value) == text


def test_every_function_is_listed_with_its_number_of_arguments() -> None:
    assert all(count == -1 or count > 0 for count, _ in FUNCTIONS.values())


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("$gap", [("gap", 1)]),
        ("2 * (gap + $gap", [("gap", 5), ("gap", 12)]),
        ("min($a, b.c) > 'd e' and not true", [("a", 5), ("b.c", 8)]),
        ("if(x, 1, pi) ~ y", [("x", 3), ("y", 15)]),
        ("   \u20ac  $late", [("late", 7)]),
        ("", []),
        ("1 + ", []),
    ],
)
def test_names_are_found_in_incomplete_expressions(text: str, found: list[tuple[str, int]]) -> None:
    assert names_in(text) == found
    for name, at in found:
        assert text.startswith(name, at)
