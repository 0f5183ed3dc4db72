"""Templates: scopes of ids, uses inside templates, and chains from a template's line to the use's."""

from __future__ import annotations

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.expressions import Expression
from scenario_compiler.languages import check_source, expand
from scenario_compiler.source.templates import TemplateScope
from scenario_compiler.vocabulary.actions import StopTrafficAction, TrafficSourceAction
from scenario_compiler.vocabulary.conditions import EventCondition, RelativeClearanceCondition
from scenario_compiler.vocabulary.entities import Dynamic, Static
from scenario_compiler.vocabulary.positions import RelativeLanePosition
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.traversal import walk
from tests.source.made import codes_of, expanded, library_text, parsed

PAIR = """<template name="pair">
  <parameter name="far" type="length" default="50" min="1" max="100"/>
  <static id="a"><at><ahead_of entity="ego" distance="$far"/></at></static>
  <static id="b"><at><ahead_of entity="a" distance="${2 * $far}"/></at></static>
</template>"""

ROW = f"""{PAIR}<template name="row">
  <parameter name="step" type="length" default="10"/>
  <use template="pair" id="front" far="${{$step * 2}}"/>
  <use template="pair" far="$step"/>
  <static id="last"><at><ahead_of entity="front.b" distance="5"/></at></static>
</template>"""


def _behind(actor: Static | Dynamic) -> RelativeLanePosition:
    assert isinstance(actor, Static)
    assert isinstance(actor.at, RelativeLanePosition)
    return actor.at


def test_ids_are_prefixed_by_the_use_and_references_stay_inside() -> None:
    scenario = expanded(
        library_text('<use template="pair"/><use template="pair" id="x"/><use template="pair"/>', head=PAIR)
    )
    assert [actor.id for actor in scenario.actors] == ["pair1.a", "pair1.b", "x.a", "x.b", "pair2.a", "pair2.b"]
    assert [_behind(actor).entity for actor in scenario.actors] == ["ego", "pair1.a", "ego", "x.a", "ego", "pair2.a"]


def test_a_name_inside_hides_the_same_name_outside() -> None:
    outside = '<static id="a"><at><lane road="1" lane="-1" s="99"/></at></static>'
    scenario = expanded(library_text(f'{outside}<use template="pair"/>', head=PAIR))
    assert _behind(scenario.actors[2]).entity == "pair1.a"


FOLLOWER = """<template name="follower">
  <parameter name="behind" type="text" default="a"/>
  <parameter name="after" type="text" default="stops"/>
  <parameter name="flow" type="text" default="cars"/>
  <static id="a"><at><ahead_of entity="ego" distance="9"/></at></static>
  <static id="b"><at><ahead_of entity="$behind" distance="${2 * 5}"/></at></static>
  <traffic id="cars" vehicles="1"/>
  <when name="stops" entity="$behind"><clearance of="$behind" forward="5"/><do><stop/></do></when>
  <when><event name="$after"/><do><stop_traffic traffic="$flow"/></do></when>
</template>"""


def _names_in(scenario: Scenario) -> list[str]:
    (clear,) = (word for word in walk(scenario.storyboard) if isinstance(word, RelativeClearanceCondition))
    (event,) = (word for word in walk(scenario.storyboard) if isinstance(word, EventCondition))
    (stop,) = (word for word in walk(scenario.storyboard) if isinstance(word, StopTrafficAction))
    moved = [actor for group in scenario.storyboard.stories[0].acts[0].groups for actor in group.actors]
    return [_behind(scenario.actors[-1]).entity, *clear.of, event.name, stop.traffic, *moved]


def test_a_name_that_a_use_gives_is_the_name_where_the_use_is_written() -> None:
    outside = (
        '<static id="a"><at><lane road="1" lane="-1" s="99"/></at></static><traffic id="cars" vehicles="1"/>'
        '<when name="stops"><time after="1"/><do><stop/></do></when>'
    )
    given = '<use template="follower" behind="a" after="stops" flow="cars"/>'
    direct = expanded(library_text(outside + given, head=FOLLOWER))
    assert _names_in(direct) == ["a", "a", "stops", "cars", "ego", "a"]
    around = (
        '<template name="around"><parameter name="lead" type="text"/>'
        '<static id="a"><at><ahead_of entity="ego" distance="50"/></at></static>'
        '<use template="follower" behind="{}" after="stops" flow="${{\'cars\'}}"/></template>'
    )
    passed_on = expanded(
        library_text(outside + '<use template="around" lead="a"/>', head=FOLLOWER + around.format("$lead"))
    )
    assert _names_in(passed_on)[:4] == ["a", "a", "stops", "cars"]
    nested = expanded(library_text(outside + '<use template="around" lead="a"/>', head=FOLLOWER + around.format("a")))
    assert _names_in(nested)[:4] == ["around1.a", "around1.a", "stops", "cars"]


def test_a_name_that_a_parameter_has_by_default_is_the_templates_own() -> None:
    scenario = expanded(library_text('<use template="follower"/>', head=FOLLOWER))
    inside = "follower1.a"
    assert _names_in(scenario) == [inside, inside, "follower1.stops", "follower1.cars", "ego", inside]


def test_a_name_that_a_use_gives_does_not_find_names_inside_the_template() -> None:
    assert codes_of(library_text('<use template="follower" behind="b"/>', head=FOLLOWER)) == ["SC222"] * 3


def test_a_loops_values_are_names_outside_of_its_rounds() -> None:
    loop = (
        '<static id="a"><at><lane road="1" lane="-1" s="99"/></at></static>'
        '<for each="who" in="a ego"><static id="a"><at><ahead_of entity="$who" distance="9"/></at></static></for>'
    )
    scenario = expanded(library_text(loop))
    assert [(one.id, _behind(one).entity) for one in scenario.actors[1:]] == [("for1.1.a", "a"), ("for1.2.a", "ego")]


def test_templates_use_templates() -> None:
    scenario = expanded(library_text('<use template="row"/>', head=ROW))
    ids = [actor.id for actor in scenario.actors]
    assert ids == ["row1.front.a", "row1.front.b", "row1.pair1.a", "row1.pair1.b", "row1.last"]
    assert _behind(scenario.actors[4]).entity == "row1.front.b"
    assert [_behind(actor).distance for actor in scenario.actors] == [20.0, 40.0, 10.0, 20.0, 5.0]


def test_parameters_are_passed_on_symbolically() -> None:
    parameter = '<parameter name="gap" type="length" default="7"/>'
    text = library_text('<use template="row" step="${$gap + 1}"/>', head=ROW, parameters=parameter)
    scenario = expanded(text)
    distance = _behind(scenario.actors[1]).distance
    assert isinstance(distance, Expression)
    assert distance.number({"gap": 7.0}) == 32.0
    assert [one.name for one in scenario.parameters] == ["gap"]


def test_outside_a_template_its_actors_are_known_by_the_use() -> None:
    items = '<use template="pair"/><static id="c"><at><ahead_of entity="pair1.b" distance="9"/></at></static>'
    scenario = expanded(library_text(items, head=PAIR))
    assert _behind(scenario.actors[2]).entity == "pair1.b"
    assert codes_of(library_text(items.replace("pair1.b", "b"), head=PAIR)) == ["SC222"]


def test_a_scenarios_own_template_comes_before_the_librarys() -> None:
    head = (
        '<template name="blocked_lane"><static id="mine"><at><lane road="1" lane="-1" s="9"/></at></static></template>'
    )
    assert [a.id for a in expanded(library_text('<use template="blocked_lane"/>', head=head)).actors] == [
        "blocked_lane1.mine"
    ]
    assert [a.id for a in expanded(library_text('<use template="blocked_lane"/>')).actors] == ["blocked_lane1.blocker"]


def test_an_event_in_a_template_may_be_the_egos() -> None:
    scenario = expanded(library_text('<use template="sensor_failure" onset="3"/>'))
    (group,) = scenario.storyboard.stories[0].acts[0].groups
    assert group.actors == ("ego",)


def test_an_event_in_a_template_may_be_its_actors() -> None:
    head = (
        '<template name="mover"><dynamic id="it"><start><lane road="1" lane="1" s="9"/></start></dynamic>'
        '<when entity="it"><distance to="ego" below="9"/><do><speed to="3"/></do></when></template>'
    )
    scenario = expanded(library_text('<use template="mover" id="m"/>', head=head))
    (group,) = scenario.storyboard.stories[0].acts[0].groups
    assert (group.actors, group.maneuvers[0].events[0].name) == (("m.it",), "m.it.when1")


FLOW = """<template name="flow"><traffic id="cars" vehicles="2"/>
  <when><time after="0"/><do>
    <traffic_source traffic="ramp" rate="1"><lane road="1" lane="-1" s="300"/></traffic_source>
    <stop_traffic traffic="cars"/><stop_traffic traffic="ramp"/><stop_traffic/>
  </do></when></template>"""


def test_traffic_of_a_template_is_local_to_each_use() -> None:
    outside = '<when><time after="3"/><do><stop_traffic traffic="b.ramp"/></do></when>'
    scenario = expanded(library_text(f'<use template="flow" id="a"/><use template="flow" id="b"/>{outside}', head=FLOW))
    actions = [action for _, action in scenario.storyboard.actions()]
    named = [one.traffic for one in actions if isinstance(one, TrafficSourceAction | StopTrafficAction)]
    assert named == ["a.ramp", "a.cars", "a.ramp", "", "b.ramp", "b.cars", "b.ramp", "", "b.ramp"]
    assert [one.id for one in scenario.traffic] == ["a.cars", "b.cars"]


def test_a_clearance_lists_entities_of_its_template() -> None:
    clear = '<when><clearance of="a b ego" forward="50"/><do><stop/></do></when>'
    head = PAIR.replace("</template>", f"{clear}</template>")
    scenario = expanded(library_text('<use template="pair" id="x"/>', head=head))
    (found,) = (word for word in walk(scenario.storyboard) if isinstance(word, RelativeClearanceCondition))
    assert found.of == ("x.a", "x.b", "ego")
    assert codes_of(library_text('<use template="pair"/>', head=head.replace("a b ego", "a bb"))) == ["SC222"]


def test_numbers_of_uses_skip_names_that_are_taken() -> None:
    scenario = expanded(library_text('<use template="pair" id="pair1"/><use template="pair"/>', head=PAIR))
    assert [actor.id for actor in scenario.actors] == ["pair1.a", "pair1.b", "pair2.a", "pair2.b"]


def test_a_fault_names_the_templates_line_and_every_use() -> None:
    text = library_text("\n\n<use template='row' step='90'/>", head=ROW)
    sink = Diagnostics()
    expand(parsed(text, sink), None, {}, sink)
    (fault,) = sink
    assert (fault.code.id, fault.place.line) == ("SC112", 7)
    assert [place.line for place in fault.chain()] == [12]


@pytest.mark.parametrize(
    ("use", "code"),
    [
        ('<use template="pair" far="0"/>', "SC112"),
        ('<use template="pair" far="near"/>', "SC111"),
        ('<use template="pair" near="1"/>', "SC106"),
        ('<use template="pear"/>', "SC213"),
        ('<use template="pair" far="$gap"/>', "SC210"),
        ('<use template="pair" far="${1 +}"/>', "SC113"),
        ('<use template="pair" id="a b"/>', "SC111"),
    ],
)
def test_faults_of_a_use(use: str, code: str) -> None:
    assert codes_of(library_text(use, head=PAIR)) == [code]


def test_a_template_without_defaults_is_checked_on_its_own() -> None:
    head = (
        '<template name="bare"><parameter name="far" type="length"/><parameter name="what" type="text"/>'
        '<static id="a" model="$what"><at><ahead_of entity="ego" distance="${$far + 1}" turn="x"/></at></static>'
        '<use template="pair" far="$far"/></template>'
    )
    sink = Diagnostics()
    check_source(parsed(library_text(head=PAIR + head), sink), sink)
    assert [(one.code.id, one.message[:3]) for one in sink] == [("SC111", "'x'")]


def test_scopes_resolve_from_the_inside_out() -> None:
    root = TemplateScope()
    root.declare("ego")
    inner = TemplateScope("use", root)
    innermost = TemplateScope("deep", inner)
    assert innermost.declare("car") == "use.deep.car"
    assert (innermost.resolve("car"), inner.resolve("deep.car")) == ("use.deep.car", "use.deep.car")
    assert (innermost.resolve("ego"), inner.resolve("car")) == ("ego", None)
    assert innermost.known() == {"car", "deep.car", "use.deep.car", "ego"}
