"""The storyboard: init, stories down to events, triggers, and names of its elements in conditions."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenario_compiler.vocabulary.actions import OverrideControllerAction, WeatherAction
from scenario_compiler.vocabulary.conditions import ElementStateCondition, SimulationTimeCondition
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.storyboard import Event, TriggerCondition
from tests.openscenario.made import EGO, condition, entity, event, expanded, found, scenario_text, speed, story


def _events(scenario: Scenario) -> tuple[Event, ...]:
    return scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events


def _conditions(one: Event) -> list[TriggerCondition]:
    return [] if one.start is None else [each for group in one.start.groups for each in group.conditions]


def _state(kind: str, name: str) -> str:
    return condition(
        f'<ByValueCondition><StoryboardElementStateCondition storyboardElementType="{kind}" '
        f'storyboardElementRef="{name}" state="completeState"/></ByValueCondition>'
    )


@pytest.mark.parametrize(
    ("written", "meaning"),
    [("override", "override"), ("overwrite", "override"), ("skip", "skip"), ("parallel", "parallel")],
)
def test_priorities_have_their_names_in_all_versions(written: str, meaning: str) -> None:
    scenario, _ = expanded(scenario_text(story(event(priority=written))))
    assert _events(scenario)[0].priority == meaning


def test_an_event_knows_how_often_it_runs() -> None:
    assert _events(expanded(scenario_text(story(event(maximumExecutionCount="7"))))[0])[0].maximum_execution_count == 7
    assert _events(expanded(scenario_text(story(event(maximumExecutionCount="0"))))[0])[0].maximum_execution_count == 1


def test_without_a_condition_an_event_starts_with_its_act() -> None:
    scenario, _ = expanded(scenario_text(story(event().replace(condition(), ""))))
    assert _events(scenario)[0].start is None
    assert scenario.storyboard.stories[0].acts[0].start is None


def test_a_condition_has_edge_and_delay() -> None:
    start = condition(conditionEdge="rising", delay="2")
    found = _conditions(_events(expanded(scenario_text(story(event(start=start))))[0])[0])[0]
    assert (found.name, found.edge, found.delay) == ("when", "rising", 2.0)
    assert isinstance(found.condition, SimulationTimeCondition)


@pytest.mark.parametrize(
    ("attribute", "value", "edge", "delay"),
    [
        ("conditionEdge", "any", "risingOrFalling", 0.0),
        ("conditionEdge", "sideways", "none", 0.0),
        ("delay", "-1", "none", 0.0),
    ],
)
def test_odd_edges_and_delays_are_read(attribute: str, value: str, edge: str, delay: float) -> None:
    start = condition(**{attribute: value})
    found = _conditions(_events(expanded(scenario_text(story(event(start=start))))[0])[0])[0]
    assert (found.edge, found.delay) == (edge, delay)


def test_a_group_with_an_unreadable_condition_never_comes_true() -> None:
    start = condition("<ByValueCondition><NoSuchCondition/></ByValueCondition>") + condition()
    scenario, codes = expanded(scenario_text(story(event(start=start))))
    begin = _events(scenario)[0].start
    assert begin is not None
    assert len(begin.groups) == 1
    assert codes != []
    scenario, _ = expanded(scenario_text(story(event(start=condition("<ByValueCondition/>")))))
    never = _events(scenario)[0].start
    assert never is not None
    assert never.groups == ()


def test_init_actions_keep_their_order() -> None:
    init = f'<Private entityRef="b">{speed("1")}</Private><Private entityRef="Ego">{speed("2")}{speed("3")}</Private>'
    scenario, codes = expanded(scenario_text(init=init, entities=EGO + entity("b")))
    assert codes == []
    assert [one.entity for one in scenario.storyboard.init] == ["b", "Ego", "Ego"]


def test_without_a_stop_the_plan_says_when_a_run_ends() -> None:
    assert expanded(scenario_text())[0].duration is None
    stopping = expanded(scenario_text(stop=condition()))[0]
    assert stopping.duration is not None
    assert stopping.storyboard.stop is not None


@pytest.mark.parametrize(
    "name", ["brake", "maneuver::brake", "story::brake", "story::act::group::maneuver::brake", "group::brake"]
)
def test_conditions_name_elements_in_full(name: str) -> None:
    scenario, codes = expanded(scenario_text(story(event(), event("again", start=_state("event", name)))))
    assert codes == []
    found = _conditions(_events(scenario)[1])[0].condition
    assert isinstance(found, ElementStateCondition)
    assert found.element == "story::act::group::maneuver::brake"


@pytest.mark.parametrize(
    ("kind", "name", "hint"),
    [("event", "brak", "did you mean 'brake'?"), ("act", "brake", "an event"), ("event", "other::brake", "")],
)
def test_unknown_elements_are_reported(kind: str, name: str, hint: str) -> None:
    _, sink = found(scenario_text(story(event(), event("again", start=_state(kind, name)))), Path("made.xosc"), {})
    (one,) = sink
    assert one.code.id == "SC747"
    assert hint in one.hint


def test_the_nearest_of_several_elements_is_meant() -> None:
    second = story(event(), event("again", start=_state("event", "brake"))).replace('name="story"', 'name="other"')
    scenario, codes = expanded(scenario_text(story(event()), second))
    assert codes == ["SC748"]
    found = _conditions(scenario.storyboard.stories[1].acts[0].groups[0].maneuvers[0].events[1])[0].condition
    assert isinstance(found, ElementStateCondition)
    assert found.element == "other::act::group::maneuver::brake"


def test_elements_side_by_side_get_names_of_their_own() -> None:
    scenario, codes = expanded(scenario_text(story(event(), event())))
    assert codes == ["SC749"]
    assert [one.name for one in _events(scenario)] == ["brake", "brake#2"]


FASTER = """<ByEntityCondition>
<TriggeringEntities triggeringEntitiesRule="{}">{}</TriggeringEntities>
<EntityCondition><SpeedCondition rule="greaterThan" value="1"/></EntityCondition>
</ByEntityCondition>"""


def _faster(rule: str, *names: str) -> str:
    return condition(FASTER.format(rule, "".join(f'<EntityRef entityRef="{name}"/>' for name in names)))


@pytest.mark.parametrize(
    ("start", "actors", "codes"),
    [
        (_faster("any", "b"), ("b",), []),
        (_faster("all", "b", "Ego"), ("b", "Ego"), []),
        (_faster("any", "b", "Ego"), ("b", "Ego"), ["SC752"]),
        (_faster("any", "b") + condition(), ("b",), ["SC752"]),
        (condition(), (), ["SC760"]),
    ],
)
def test_the_entities_that_trigger_an_act_are_its_actors_if_they_are_selected(
    start: str, actors: tuple[str, ...], codes: list[str]
) -> None:
    """The entities of the event's own trigger are not added to them."""
    selected = '<Actors selectTriggeringEntities="true"/>'
    told = story(event(start=_faster("any", "Ego")), actors=selected)
    told = told.replace("<StartTrigger/>", f"<StartTrigger>{start}</StartTrigger>")
    scenario, found_codes = expanded(scenario_text(told, entities=EGO + entity("b")))
    assert (scenario.storyboard.stories[0].acts[0].groups[0].actors, found_codes) == (actors, codes)


@pytest.mark.parametrize(
    ("inside", "codes"),
    [
        ('<RelativeTargetSpeed entityRef="" value="1" speedTargetValueType="delta" continuous="false"/>', ["SC222"]),
        ('<AbsoluteTargetSpeed value=""/>', ["SC107", "SC704"]),
        (
            '<RelativeTargetSpeed entityRef="Ego" value="1" speedTargetValueType="" continuous=""/>',
            ["SC107", "SC704", "SC107", "SC704"],
        ),
    ],
)
def test_an_empty_reference_or_value_is_reported(inside: str, codes: list[str]) -> None:
    action = speed().replace('<AbsoluteTargetSpeed value="0"/>', inside)
    assert sorted(expanded(scenario_text(story(event(action=action))))[1]) == sorted(codes)


def test_an_empty_lane_or_entity_in_the_init_is_reported() -> None:
    """An empty lane was the lane 0, and the actions of an empty entity were left out."""
    teleport = '<TeleportAction><Position><LanePosition roadId="1" laneId="" s="1"/></Position></TeleportAction>'
    init = f'<Private entityRef=""><PrivateAction>{teleport}</PrivateAction></Private>'
    assert sorted(expanded(scenario_text(init=init))[1]) == ["SC107", "SC222"]


@pytest.mark.parametrize(
    ("brake", "codes", "held"),
    [
        ('active="true"><BrakePercent value="0.5"/>', [], [0.5]),
        ('active="true"><BrakeForce value="4000"/>', ["SC750"], []),
        ('active="false"><BrakeForce value="4000"/>', [], [0.0]),
    ],
)
def test_a_brake_is_held_by_a_share_not_by_a_force(brake: str, codes: list[str], held: list[float]) -> None:
    """The force is in N (Brake, ASAM OpenSCENARIO); it was read as a share, so that 1 N was full braking."""
    action = (
        "<PrivateAction><ControllerAction><OverrideControllerValueAction>"
        f"<Brake {brake}</Brake></OverrideControllerValueAction></ControllerAction></PrivateAction>"
    )
    scenario, found = expanded(scenario_text(story(event(action=action))))
    assert found == codes
    actions = _events(scenario)[0].actions
    assert [one.action.value for one in actions if isinstance(one.action, OverrideControllerAction)] == held


@pytest.mark.parametrize(
    ("azimuth", "elevation", "wanted"),
    [(0.0, 0.5, (270.0, 0.5)), (0.0, math.pi - 0.5, (90.0, 0.5)), (3.0, -2.0, (261.887, 2.0 - math.pi))],
)
def test_a_sun_beyond_the_zenith_is_on_the_other_side(
    azimuth: float, elevation: float, wanted: tuple[float, float]
) -> None:
    """Elevations reach from -pi to pi (Sun, ASAM OpenSCENARIO); beyond pi/2, altitudes were above 90 degrees."""
    sun = f'<Sun azimuth="{azimuth}" elevation="{elevation}" illuminance="1"/>'
    action = f'<EnvironmentAction><Environment name="e"><Weather>{sun}</Weather></Environment></EnvironmentAction>'
    scenario, _ = expanded(scenario_text(init=f"<GlobalAction>{action}</GlobalAction>"))
    weather = scenario.storyboard.init[0].action
    assert isinstance(weather, WeatherAction)
    angles = (weather.sun_azimuth_angle, math.radians(weather.sun_altitude_angle))
    assert angles == pytest.approx(wanted, abs=1e-3)
