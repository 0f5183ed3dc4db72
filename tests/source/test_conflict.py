"""The conflict language: from a file to a scenario."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics, Severity
from scenario_compiler.expressions import Expression
from scenario_compiler.languages import ScenarioNameNeededError, check_source, expand
from scenario_compiler.vocabulary.conditions import TimeHeadwayCondition
from scenario_compiler.vocabulary.driver import DriverModel
from scenario_compiler.vocabulary.entities import Dynamic, Static
from scenario_compiler.vocabulary.positions import LanePositionWord, RelativeLanePosition
from tests.source.made import EGO, codes_of, expanded, library_text, parsed

DESIGN = """<scenarios version="1" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
           xsi:noNamespaceSchemaLocation="../../schemas/conflict.xsd">
  <template name="blocked_lane" summary="A stopped vehicle blocks part of the lane ahead">
    <parameter name="distance" type="length" default="120" min="20" max="500"/>
    <parameter name="overlap" type="fraction" default="1.0" min="0.1" max="1"/>
    <static id="blocker" model="vehicle.audi.tt">
      <at><ahead_of entity="ego" distance="$distance" offset="${1.9 * (1 - $overlap)}" turn="90"/></at>
    </static>
  </template>

  <scenario name="obstacle_ahead" map="town_grid" weather="ClearNoon">
    <classification scheme="gold2018" number="9" urgency="3" response="1-3"/>
    <ego model="vehicle.audi.tt" speed="13.9">
      <start><lane road="3" lane="-1" s="20"/></start>
      <destination><lane road="7" lane="-1" s="80"/></destination>
      <camera sensor_noise="0"/>                        <!-- sigma, grey levels, Gaussian, mean 0 -->
      <controller model="lane_detection"/>
    </ego>
    <use template="blocked_lane" distance="150"/>
    <dynamic id="oncoming" model="vehicle.tesla.model3" speed="11">
      <start><lane road="3" lane="1" s="400"/></start>
      <when><time_gap to="ego" below="4"/><do><lane_change by="1" over_time="3"/></do></when>
    </dynamic>
    <takeover budget="7" escalate_after="4" minimum_risk_after="10">
      <cause kind="lane_confidence" warning_below="0.6" request_below="0.3"/> <cause kind="path_blocked"/>
      <driver preset="study_means"/>
      <message modality="text tone" content="what why"/>
    </takeover>
    <criteria><no_collision/><stay_on_road/></criteria>
  </scenario>
</scenarios>
"""


def test_a_whole_conflict() -> None:
    scenario = expanded(DESIGN)
    assert (scenario.name, scenario.map, scenario.weather.preset) == ("obstacle_ahead", "town_grid", "ClearNoon")
    (classification,) = scenario.classifications
    assert (classification.number, classification.criticality) == (9, "")
    assert scenario.ego is not None
    assert scenario.ego.start == LanePositionWord(road="3", lane=-1, s=20.0)
    blocker, oncoming = scenario.actors
    assert isinstance(blocker, Static)
    assert (blocker.id, oncoming.id) == ("blocked_lane1.blocker", "oncoming")
    assert blocker.at == RelativeLanePosition(entity="ego", distance=150.0, offset=0.0, turn=math.pi / 2)
    assert [vehicle.name for vehicle in scenario.vehicles] == ["vehicle.audi.tt", "vehicle.tesla.model3"]
    assert scenario.takeover.messages[0].modality == ("text", "tone")
    assert [cause.kind for cause in scenario.takeover.causes] == ["lane_confidence", "path_blocked"]
    assert [criterion.word for criterion in scenario.criteria] == ["no_collision", "stay_on_road"]
    assert scenario.parameters == ()


def test_when_becomes_an_event_of_its_actor() -> None:
    storyboard = expanded(DESIGN).storyboard
    group = storyboard.stories[0].acts[0].groups[0]
    event = group.maneuvers[0].events[0]
    assert (group.actors, event.name, event.priority) == (("oncoming",), "oncoming.when1", "parallel")
    assert event.maximum_execution_count == 1
    assert event.start is not None
    (condition,) = event.start.groups[0].conditions
    assert (condition.edge, condition.delay) == ("none", 0.0)
    assert condition.condition == TimeHeadwayCondition(entity="oncoming", to="ego", below=4.0)
    assert event.actions[0].name == "oncoming.when1.lane_change1"
    assert condition.origin.line == 22


def test_actions_of_actors_are_only_in_the_storyboard() -> None:
    scenario = expanded(DESIGN)
    assert all(not actor.whens for actor in scenario.actors if isinstance(actor, Dynamic))


def test_events_are_numbered_by_actor_in_document_order() -> None:
    noise = "<do><sensor_noise sigma='1'/></do>"
    ego = EGO.replace("</ego>", f"<when><time after='1'/>{noise}</when></ego>")
    scenario = expanded(library_text(f"<when><time after='2'/>{noise}</when>", ego=ego))
    (group,) = scenario.storyboard.stories[0].acts[0].groups
    assert [event.name for event in group.maneuvers[0].events] == ["ego.when1", "ego.when2"]


def test_a_scenario_without_events_has_no_story() -> None:
    assert expanded(library_text()).storyboard.stories == ()


def test_driver_comes_from_the_catalog() -> None:
    driver = expanded(DESIGN).takeover.driver
    assert isinstance(driver, DriverModel)
    assert (driver.name, driver.mu, driver.takeover_time) == ("study_means", 0.877, None)
    fixed = expanded(library_text('<takeover><driver preset="absent" takeover_time="9"/></takeover>')).takeover.driver
    assert isinstance(fixed, DriverModel)
    assert (fixed.lapse, fixed.takeover_time) == (1.0, 9.0)


def test_takeover_may_be_left_out() -> None:
    takeover = expanded(library_text()).takeover
    assert takeover.budget == 7.0
    assert isinstance(takeover.driver, DriverModel)
    assert takeover.origin.line == 1


PARAMETER = '<parameter name="far" type="length" default="80" min="10" max="200"/>'


def test_a_parameter_that_fills_numbers_stays_open() -> None:
    text = library_text(
        '<static id="a"><at><ahead_of entity="ego" distance="${$far + 5}"/></at></static>', parameters=PARAMETER
    )
    scenario = expanded(text, far="90")
    (actor,) = scenario.actors
    assert isinstance(actor, Static)
    assert isinstance(actor.at, RelativeLanePosition)
    assert isinstance(actor.at.distance, Expression)
    assert actor.at.distance.number({"far": 90.0}) == 95.0
    assert [(one.name, one.default) for one in scenario.parameters] == [("far", "90")]


def test_an_open_angle_is_turned_to_radians_when_it_is_evaluated() -> None:
    parameter = '<parameter name="bend" type="angle" default="10"/>'
    ego = '<ego><start><lane road="1" lane="-1" s="20" turn="$bend"/></start></ego>'
    automated = expanded(library_text(parameters=parameter, ego=ego)).ego
    assert automated is not None
    start = automated.start
    assert isinstance(start, LanePositionWord)
    assert isinstance(start.turn, Expression)
    assert start.turn.number({"bend": 90.0}) == math.pi / 2


def test_a_parameter_that_decides_structure_is_settled_everywhere() -> None:
    parameter = '<parameter name="n" type="number" default="1"/>'
    items = '<static id="a"><at><lane road="1" lane="${-$n}" s="${100 * $n}"/></at></static>'
    scenario = expanded(library_text(items, parameters=parameter))
    assert scenario.actors[0] == Static(id="a", at=LanePositionWord(road="1", lane=-1, s=100.0))
    assert scenario.parameters == ()


def test_a_parameter_may_name_the_map_and_the_weather() -> None:
    parameters = '<parameter name="sky" type="text" default="1"/><parameter name="loud" type="boolean" default="true"/>'
    text = library_text(parameters=parameters).replace('duration="10"', 'weather="$sky" duration="${if($loud, 5, 9)}"')
    assert expanded(text).weather.preset == "ClearNoon"
    assert expanded(text).duration == 5.0
    assert expanded(text, sky="HardRainSunset", loud="false").weather.preset == "HardRainSunset"
    assert expanded(text, loud="false").duration == 9.0


@pytest.mark.parametrize(
    ("arguments", "code"),
    [({"far": "5"}, "SC112"), ({"far": "near"}, "SC111"), ({"fra": "80"}, "SC211"), ({"far": ""}, "SC111")],
)
def test_arguments_are_checked(arguments: dict[str, str], code: str) -> None:
    assert codes_of(library_text(parameters=PARAMETER), **arguments) == [code]


def test_a_parameter_without_a_default_must_be_given() -> None:
    car = '<static id="car"><at><ahead_of entity="ego" distance="$far"/></at></static>'
    text = library_text(car, parameters=PARAMETER.replace('default="80" ', ""))
    assert codes_of(text) == ["SC214"]
    assert codes_of(text, far="50") == []


def test_several_scenarios_need_a_name() -> None:
    text = DESIGN.replace("</scenarios>", '<scenario name="other" map="town_grid"/></scenarios>')
    sink = Diagnostics()
    source = parsed(text, sink)
    with pytest.raises(ScenarioNameNeededError, match="obstacle_ahead, other") as caught:
        expand(source, None, {}, sink)
    assert caught.value.names == ("obstacle_ahead", "other")
    assert expanded(text, name="obstacle_ahead").name == "obstacle_ahead"


def test_all_faults_of_a_file_come_in_one_pass() -> None:
    items = (
        '<static id="a"><at><lane road="1" lane="x" s="-1"/></at></static>'
        '<dynamic id="b" speed="fast"><start><lane road="1" lane="1" s="10"/></start></dynamic>'
        '<takeover budgt="7"><driver preset="urgend"/></takeover><criteria><no_colision/></criteria>'
    )
    text = library_text(items, attributes='weather="Clear"')
    assert sorted(codes_of(text)) == ["SC105", "SC106", "SC111", "SC111", "SC112", "SC218", "SC219"]


def test_a_fault_in_an_actor_is_not_reported_where_it_is_named() -> None:
    items = (
        '<static id="a"><at><lane road="1" lane="x" s="1"/></at></static>'
        '<static id="b"><at><ahead_of entity="a" distance="10"/></at></static>'
        '<when entity="a"><time after="1"/><do><speed to="1"/></do></when>'
        '<when><distance to="b" below="1"/><do><sensor_noise sigma="1"/></do></when>'
    )
    assert codes_of(library_text(items)) == ["SC111"]


def test_expansion_goes_on_after_a_fault_so_that_later_stages_find_more() -> None:
    sink = Diagnostics()
    text = library_text(ego=EGO.replace('speed="10"', 'speed="fast"'), attributes='weather="Clear"')
    scenario = expand(parsed(text, sink), None, {}, sink)
    assert scenario is not None
    assert scenario.ego is not None
    assert (scenario.ego.speed, sink.has_errors) == (0.0, True)


def test_an_include_brings_templates_and_catalogs(tmp_path: Path) -> None:
    shared = tmp_path / "shared"
    shared.mkdir()
    (shared / "parts.xml").write_text(
        '<scenarios version="1"><include file="fleet.xml"/><template name="parked">'
        '<static id="it" model="our.van"><at><ahead_of entity="ego" distance="30"/></at></static></template>'
        "</scenarios>",
        encoding="utf-8",
    )
    (shared / "fleet.xml").write_text(
        '<catalog version="1">'
        '<vehicle name="our.van" length="5" width="2" height="2" wheelbase="3" center="1.5"/></catalog>',
        encoding="utf-8",
    )
    text = library_text('<use template="parked"/>', head='<include file="shared/parts.xml"/>')
    scenario = expanded(text, tmp_path / "made.xml")
    assert [actor.id for actor in scenario.actors] == ["parked1.it"]
    assert scenario.vehicles[1].name == "our.van"
    place = scenario.actors[0].origin
    assert Path(place.file).name == "parts.xml"
    assert place.within is not None


ONLY_A_SCENARIO = '<scenarios version="1"><scenario name="other" map="town_grid"/></scenarios>'


@pytest.mark.parametrize("content", ["<scenarios", "<OpenSCENARIO/>", ONLY_A_SCENARIO, None])
def test_an_include_that_cannot_be_used(tmp_path: Path, content: str | None) -> None:
    if content is not None:
        (tmp_path / "parts.xml").write_text(content, encoding="utf-8")
    text = library_text(head='<include file="parts.xml"/>')
    assert codes_of(text, tmp_path / "made.xml") == ["SC220"]


def test_includes_in_a_circle_are_read_once(tmp_path: Path) -> None:
    text = library_text(head='<include file="other.xml"/>')
    (tmp_path / "other.xml").write_text(
        '<scenarios version="1"><include file="made.xml"/></scenarios>', encoding="utf-8"
    )
    (tmp_path / "made.xml").write_text(text, encoding="utf-8")
    assert codes_of(text, tmp_path / "made.xml") == []


def test_a_template_that_two_includes_have_is_that_of_the_first(tmp_path: Path) -> None:
    for name, width in (("one", 1), ("two", 2)):
        static = f'<row id="cones" count="{width}"><at><ahead_of entity="ego" distance="50"/></at></row>'
        text = f'<scenarios version="1">\n<template name="cones">{static}</template></scenarios>'
        (tmp_path / f"{name}.xml").write_text(text, encoding="utf-8")
    head = '<include file="one.xml"/><include file="two.xml"/>'
    sink = Diagnostics()
    scenario = expand(
        parsed(library_text('<use template="cones"/>', head=head), sink, str(tmp_path / "made.xml")), None, {}, sink
    )
    assert scenario is not None
    assert len(scenario.actors) == 1
    (found,) = sink
    assert (found.code.id, found.severity) == ("SC216", Severity.WARNING)
    assert (Path(found.place.file).name, found.place.line) == ("two.xml", 2)
    assert [Path(one.place.file).name for one in found.related] == ["one.xml"]


@pytest.mark.parametrize(
    ("part", "message"),
    [
        ('<allow code="unused"/>', "'unused' is not of the form SC[0-9]{3} (code: "),
        ('<include file=""/>', "file is empty (file: "),
    ],
)
def test_a_text_of_another_form_is_reported_with_the_form(part: str, message: str) -> None:
    sink = Diagnostics()
    parsed(library_text(head=part), sink)
    assert [one.message[: len(message)] for one in sink] == [message]


def test_a_default_that_refers_to_a_parameter_is_refused_with_the_reason() -> None:
    sink = Diagnostics()
    two = '<parameter name="gap" type="length" default="1"/><parameter name="far" type="length" default="$gap"/>'
    expand(parsed(library_text(parameters=two), sink), None, {}, sink)
    (found,) = sink
    assert found.hint.startswith("a declaration cannot depend on other parameters")


@pytest.mark.parametrize(
    ("item", "told"),
    [
        ('<static id="1a"><at>{}</at></static>', "a name of letters, digits, _ and -, with a letter or _ first"),
        (
            '<static id="a"><at><lane road="1" lane="-1" s="2 * $gap"/></at></static>',
            "write the whole expression in ${",
        ),
        ('<static id="a"><at><lane road="1" lane="-1" s="{gap}"/></at></static>', "write $gap for"),
        ('<for each="k" in="1 $gap"/>', "a list is written out, or one parameter as a whole"),
        ('<for each="2k" in="1"/>', "a name of letters, digits and _, with no digit first"),
    ],
)
def test_what_is_nearly_a_name_an_expression_or_a_list_is_put_right(item: str, told: str) -> None:
    sink = Diagnostics()
    gap = '<parameter name="gap" type="length" default="1"/>'
    text = library_text(item.replace("{}", '<lane road="1" lane="-1" s="9"/>'), parameters=gap)
    expand(parsed(text, sink), None, {}, sink)
    (found,) = sink
    assert told in f"{found.message} {found.hint}"


def test_checking_a_file_expands_every_scenario_and_template() -> None:
    text = DESIGN.replace("</scenarios>", "<scenario name='other' map='town_grid'/></scenarios>")
    text = text.replace("<static id=", "<static idd=", 1)
    sink = Diagnostics()
    scenarios = check_source(parsed(text, sink), sink)
    assert [one.scenario.name for one in scenarios] == ["obstacle_ahead"]
    assert sorted(one.code.id for one in sink) == ["SC106", "SC107", "SC108"]


def test_the_same_text_gives_the_same_scenario() -> None:
    assert expanded(DESIGN).model_dump_json() == expanded(DESIGN).model_dump_json()


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        ('<when><simulation_time after="5"/><do><weather preset="ClearNoon"/></do></when>', "did you mean 'time'?"),
        (
            '<when><simulationTimeCondition after="5"/><do><weather preset="ClearNoon"/></do></when>',
            "did you mean 'time'?",
        ),
        ('<static id="a"><lane road="1" lane="-1" s="9"/></static>', "put <lane> into a <at> in <static>"),
        ("<zebra/>", "known: parameter, "),
    ],
    ids=["the_standards_term", "the_standards_element", "wrapper_left_out", "nothing_similar"],
)
def test_an_unknown_element_is_reported_with_the_probable_name(content: str, hint: str) -> None:
    text = library_text(content)
    sink = Diagnostics()
    expand(parsed(text, sink), None, {}, sink)
    (found,) = sink
    assert found.code.id == "SC105"
    assert found.hint.startswith(hint)
