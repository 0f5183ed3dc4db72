"""Parameters: their types, limits and units."""

from __future__ import annotations

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.expressions import Value
from scenario_compiler.languages import expand
from scenario_compiler.markup.values import COMMAND_LINE
from scenario_compiler.source.parameters import Declared, bind_arguments, default_value, typed
from scenario_compiler.vocabulary.scenario import Parameter, ParameterKind
from tests.source.made import library_text, parsed


def _typed(kind: ParameterKind, text: str) -> tuple[Value | None, list[str]]:
    sink = Diagnostics()
    value = typed(text, Parameter(name="p", type=kind, min=-5.0, max=5.0), COMMAND_LINE, sink)
    return value, [one.code.id for one in sink]


@pytest.mark.parametrize(
    ("kind", "text", "value"),
    [
        ("length", "2.5", 2.5),
        ("length", " -1e0 ", -1.0),
        ("angle", "5", 5.0),
        ("integer", "+3", 3.0),
        ("boolean", "true", True),
        ("boolean", " false ", False),
        ("text", " as it is ", " as it is "),
    ],
)
def test_texts_that_fit(kind: ParameterKind, text: str, value: Value) -> None:
    assert _typed(kind, text) == (value, [])


@pytest.mark.parametrize(
    ("kind", "text", "code"),
    [
        ("length", "far", "SC111"),
        ("length", "1,5", "SC111"),
        ("length", "inf", "SC111"),
        ("length", "5.1", "SC112"),
        ("integer", "2.0", "SC111"),
        ("integer", "9", "SC112"),
        ("boolean", "yes", "SC111"),
        ("speed", "", "SC111"),
    ],
)
def test_texts_that_do_not_fit(kind: ParameterKind, text: str, code: str) -> None:
    assert _typed(kind, text) == (None, [code])


@pytest.mark.parametrize(
    ("kind", "text", "hint"),
    [
        ("length", "50 m", "write 50"),
        ("speed", "50 km/h", "write 13.89"),
        ("length", "1,5", "write 1.5"),
        ("length", "1,200", "write 1200 or 1.200"),
        ("length", "1,200 m", "write 1200 or 1.2"),
        ("length", "1,200,000", "write 1200000"),
        ("boolean", "yes", "write true"),
        ("boolean", "0", "write false"),
        ("boolean", "maybe", "What p means."),
    ],
)
def test_a_text_that_is_nearly_right_is_put_right(kind: ParameterKind, text: str, hint: str) -> None:
    sink = Diagnostics()
    typed(text, Parameter(name="p", type=kind, summary="What p means."), COMMAND_LINE, sink)
    assert [one.hint for one in sink] == [hint]


def test_limits_that_leave_no_value_are_reported_at_the_declaration() -> None:
    template = '<template name="t">\n<parameter name="p" type="length" min="3" max="2"/></template>'
    sink = Diagnostics()
    expand(parsed(library_text('<use template="t" p="3"/>', head=template), sink), None, {}, sink)
    assert [(one.code.id, one.place.line) for one in sink] == [("SC112", 2), ("SC112", 2)]
    assert sink.found[0].message == "no value of 'p' is at least 3 and at most 2"


def test_a_fraction_lies_between_zero_and_one() -> None:
    found = Parameter(name="p", type="fraction").limits
    assert (found.minimum, found.maximum) == (0.0, 1.0)
    narrower = Parameter(name="p", type="fraction", min=0.5).limits
    assert (narrower.minimum, narrower.maximum) == (0.5, 1.0)


def test_arguments_come_before_defaults() -> None:
    parameters = {name: Parameter(name=name, type="number", default="1") for name in ("a", "b")}
    sink = Diagnostics()
    assert bind_arguments(Declared(parameters), {"b": "2"}, sink) == {"a": 1.0, "b": 2.0}
    assert list(sink) == []


def test_a_default_at_fault_is_reported_at_its_declaration() -> None:
    sink = Diagnostics()
    assert default_value(Parameter(name="p", type="number", default="x"), sink) is None
    assert [one.code.id for one in sink] == ["SC111"]
    assert default_value(Parameter(name="p", type="number"), sink) is None
