"""Variables and monitors, and parameters that a run reads or changes."""

from __future__ import annotations

import pytest

from scenario_compiler.vocabulary.actions import SetVariableAction
from scenario_compiler.vocabulary.conditions import VariableCondition
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.variables import Variable
from tests.openscenario.made import condition, declarations, event, expanded, scenario_text, story


def _reads(element: str, reference: str, name: str) -> str:
    inside = f'<{element} {reference}="{name}" rule="equalTo" value="3"/>'
    return event(start=condition(f"<ByValueCondition>{inside}</ByValueCondition>"))


def _variables(kind: str, value: str) -> str:
    declaration = f'<VariableDeclaration name="n" variableType="{kind}" value="{value}"/>'
    return f"<VariableDeclarations>{declaration}</VariableDeclarations>"


@pytest.mark.parametrize(
    ("kind", "value", "variable"),
    [
        ("int", "3", Variable(name="n", type="integer", value="3")),
        ("double", "${1 + 1}", Variable(name="n", type="double", value="2")),
        ("boolean", "true", Variable(name="n", type="boolean", value="true")),
        ("double", "x", Variable(name="n", type="string", value="x")),
    ],
)
def test_variables_have_a_type_and_a_first_value(kind: str, value: str, variable: Variable) -> None:
    scenario, codes = expanded(scenario_text(declared=_variables(kind, value)))
    assert scenario.variables == (variable,)
    assert ("SC743" in codes) == (value == "x")


def test_monitors_are_true_or_false() -> None:
    declared = '<MonitorDeclarations><MonitorDeclaration name="m" value="false"/></MonitorDeclarations>'
    assert expanded(scenario_text(declared=declared))[0].variables == (
        Variable(name="m", type="boolean", value="false"),
    )


def test_a_parameter_that_a_condition_reads_is_a_variable_and_decides_structure() -> None:
    text = scenario_text(story(_reads("ParameterCondition", "parameterRef", "p")), declared=declarations("p:double=2"))
    scenario, codes = expanded(text, p="3")
    assert codes == []
    assert scenario.variables == (Variable(name="p", type="double", value="3"),)
    assert scenario.parameters == ()


@pytest.mark.parametrize(
    ("element", "reference"), [("VariableCondition", "variableRef"), ("ParameterCondition", "parameterRef")]
)
def test_unknown_names_stand_for_an_empty_text(element: str, reference: str) -> None:
    scenario, codes = expanded(scenario_text(story(_reads(element, reference, "nobody"))))
    assert codes == ["SC758"]
    assert scenario.variables == (Variable(name="nobody", type="string", value=""),)


def test_a_variable_is_declared_once() -> None:
    assert expanded(scenario_text(declared=_variables("int", "3") + _variables("int", "4")))[1].count("SC216") == 1


def test_a_parameter_is_known_where_it_is_declared_and_below() -> None:
    """The scenario, the story and one of its maneuvers declare a parameter of the same name."""
    set_p = '<GlobalAction><ParameterAction parameterRef="p"><SetAction value="8"/></ParameterAction></GlobalAction>'
    reads = '<ParameterCondition parameterRef="p" rule="equalTo" value="3"/>'
    start = condition(f"<ByValueCondition>{reads}</ByValueCondition>")
    maneuvers = (
        f'<Maneuver name="inner">{declarations("p:double=${$p + 1}")}{event(start=start, action=set_p)}</Maneuver>'
        f'<Maneuver name="outer">{event(start=start, action=set_p)}</Maneuver>'
    )
    inside = story(maneuver=maneuvers, declared=declarations("p:double=3"))
    outside = story(event(start=start, action=set_p)).replace('name="story"', 'name="other"')
    scenario, codes = expanded(scenario_text(inside, outside, declared=declarations("p:double=1")))
    assert codes == []
    values = {one.name: one.value for one in scenario.variables}
    named = [
        [one.variable for one in walk(event) if isinstance(one, SetVariableAction | VariableCondition)]
        for story in scenario.storyboard.stories
        for maneuver in story.acts[0].groups[0].maneuvers
        for event in maneuver.events
    ]
    assert [[values[name] for name in names] for names in named] == [["4", "4"], ["3", "3"], ["1", "1"]]
