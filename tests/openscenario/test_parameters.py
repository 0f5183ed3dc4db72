"""Declarations of parameters: types, constraints, nesting, values from the command line."""

from __future__ import annotations

import pytest

from scenario_compiler.expressions import Expression
from scenario_compiler.vocabulary.actions import SpeedAction
from scenario_compiler.vocabulary.scenario import Scenario
from tests.openscenario.made import declarations, entity, event, expanded, scenario_text, speed, story


def _speed(scenario: Scenario) -> float | Expression:
    action = scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0].actions[0].action
    assert isinstance(action, SpeedAction)
    return action.to


def _declared(*parameters: str, constraint: str = "") -> str:
    return declarations(*parameters).replace("/></P", f">{constraint}</ParameterDeclaration></P", 1)


def test_numbers_stay_open_for_sweeps() -> None:
    text = scenario_text(
        story(event(action=speed("${$kph / 3.6}"))), declared=declarations("kph:double=36", "lane:integer=-1")
    )
    scenario, codes = expanded(text)
    assert codes == []
    assert [(one.name, one.default) for one in scenario.parameters] == [("kph", "36")]
    target = _speed(scenario)
    assert isinstance(target, Expression)
    assert target.number({"kph": 36.0}) == pytest.approx(10.0)


def test_structural_parameters_are_replaced_by_their_values_everywhere() -> None:
    text = scenario_text(
        story(event(action=speed("$n"), maximumExecutionCount="$n")), declared=declarations("n:integer=3")
    )
    scenario, codes = expanded(text)
    assert codes == []
    assert scenario.parameters == ()
    assert _speed(scenario) == 3.0


def test_parameters_build_on_one_another() -> None:
    text = scenario_text(story(event(action=speed("$b"))), declared=declarations("a:double=2", "b:double=${$a * 3}"))
    target = _speed(expanded(text)[0])
    assert isinstance(target, Expression)
    assert target.names == ("a",)
    assert expanded(text, b="1")[0].parameters[0].name == "b"


@pytest.mark.parametrize(
    ("declared", "code"), [("v:double=${$later * 3}", "SC210"), ("v:double=${1 / 0}", "SC113"), ("v:int=$no", "SC210")]
)
def test_a_value_that_cannot_be_computed_is_reported_once(declared: str, code: str) -> None:
    """Its type and its uses were at fault too: '' is not a number."""
    limits = '<ConstraintGroup><ValueConstraint rule="greaterThan" value="5"/></ConstraintGroup>'
    text = scenario_text(story(event(action=speed("$v"))), declared=_declared(declared, constraint=limits))
    assert expanded(text)[1] == [code]


def test_values_come_from_the_command_line() -> None:
    text = scenario_text(story(event(action=speed("$v"))), declared=declarations("v:double=2"))
    assert expanded(text, v="5")[0].parameters[0].default == "5"
    assert expanded(text, w="5")[1] == ["SC211"]


def test_a_story_hides_the_scenarios_parameters() -> None:
    inner = declarations("v:double=9")
    text = scenario_text(story(event(action=speed("$v")), declared=inner), declared=declarations("v:double=2"))
    assert _speed(expanded(text)[0]) == 9.0


@pytest.mark.parametrize(
    ("kind", "value", "fits"),
    [
        *[("double", "1.5", True), ("integer", "1.5", False), ("unsignedInt", "-1", False), ("boolean", "1", True)],
        *[("boolean", "yes", False), ("string", "yes", True), ("int", "${2 * 2}", True)],
        *[("dateTime", "2026-02-30T00:00:00", False), ("dateTime", "2026-02-28T00:00:00Z", True)],
        *[("unsignedShort", "65535", True), ("unsignedShort", "65536", False), ("int", "2147483648", False)],
        *[("int", "-2147483648", True), ("unsignedInt", "4294967295", True), ("double", "NaN", False)],
    ],
)
def test_values_are_of_their_type(kind: str, value: str, fits: bool) -> None:
    codes = expanded(scenario_text(declared=declarations(f"p:{kind}={value}")))[1]
    assert ("SC743" not in codes) == fits


@pytest.mark.parametrize(
    ("kind", "value", "rule", "limit", "holds"),
    [
        ("double", "5", "lessThan", "5", False),
        ("double", "5", "lessOrEqual", "5", True),
        ("string", "a", "notEqualTo", "a", False),
        ("dateTime", "2026-01-01T11:00:00+01:00", "equalTo", "2026-01-01T10:00:00+00:00", True),
        ("boolean", "true", "equalTo", "true", True),
    ],
)
def test_constraints_hold_or_are_reported(kind: str, value: str, rule: str, limit: str, holds: bool) -> None:
    group = f'<ConstraintGroup><ValueConstraint rule="{rule}" value="{limit}"/></ConstraintGroup>'
    codes = expanded(scenario_text(declared=_declared(f"p:{kind}={value}", constraint=group)))[1]
    assert ("SC742" not in codes) == holds


def test_one_constraint_group_suffices_and_gives_limits() -> None:
    groups = (
        '<ConstraintGroup><ValueConstraint rule="greaterOrEqual" value="1"/>'
        '<ValueConstraint rule="lessOrEqual" value="9"/></ConstraintGroup>'
    )
    text = scenario_text(story(event(action=speed("$v"))), declared=_declared("v:double=2", constraint=groups))
    parameter = expanded(text)[0].parameters[0]
    assert (parameter.min, parameter.max) == (1.0, 9.0)
    other = '<ConstraintGroup><ValueConstraint rule="equalTo" value="2"/></ConstraintGroup>'
    two = _declared("v:double=2", constraint=groups.replace('"1"', '"5"') + other)
    assert expanded(scenario_text(declared=two))[1] == []


def test_unknown_names_are_reported_at_their_places() -> None:
    codes = expanded(scenario_text(entities=entity("$nobody")))[1]
    assert codes == ["SC210"]
