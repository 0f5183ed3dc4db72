"""Entities: what they are, what they are able to do, trailers, controllers, selections."""

from __future__ import annotations

import math

import pytest

from scenario_compiler.vocabulary.actions import (
    AssignControllerAction,
    ConnectTrailerAction,
    DeleteEntityAction,
    SynchronizeAction,
)
from scenario_compiler.vocabulary.conditions import RelativeClearanceCondition
from scenario_compiler.vocabulary.entities import Vehicle
from scenario_compiler.vocabulary.scenario import Scenario
from tests.openscenario.made import BOX, CAR, EGO, condition, entity, event, expanded, scenario_text, speed, story


def _vehicle(inside: str) -> tuple[Vehicle, list[str]]:
    scenario, codes = expanded(scenario_text(entities=entity(inside=inside)))
    return scenario.vehicles[0], codes


def test_a_vehicle_is_what_its_file_says() -> None:
    vehicle, codes = _vehicle(CAR)
    assert codes == []
    assert (vehicle.length, vehicle.width, vehicle.height, vehicle.center) == (4.5, 1.8, 1.5, 1.4)
    assert (vehicle.wheelbase, vehicle.max_speed, vehicle.max_acceleration, vehicle.max_deceleration) == (2.8, 60, 5, 9)
    assert vehicle.max_steer == pytest.approx(math.degrees(0.5))
    assert vehicle.category == "car"


def test_pedestrians_and_things_have_their_own_box() -> None:
    walker, codes = _vehicle(
        f'<Pedestrian name="p" model="x" mass="70" pedestrianCategory="pedestrian">{BOX}</Pedestrian>'
    )
    assert (walker.category, codes) == ("pedestrian", [])
    thing, codes = _vehicle(f'<MiscObject name="m" mass="1" miscObjectCategory="barrier">{BOX}</MiscObject>')
    assert (thing.category, codes) == ("barrier", [])
    assert thing.max_acceleration == 10.0


@pytest.mark.parametrize(
    ("inside", "codes"),
    [
        ("", ["SC708", "SC757"]),
        ('<ExternalObjectReference name="x"/>', ["SC751"]),
        (CAR.replace('length="4.5" width="1.8"', 'length="0" width="0"'), ["SC756"]),
        (CAR.replace(BOX, ""), ["SC706", "SC756"]),
        (CAR.replace('vehicleCategory="car"', 'vehicleCategory="kar"'), ["SC111"]),
        ('<CatalogReference catalogName="C" entryName="E"/>', ["SC744"]),
    ],
)
def test_missing_parts_are_reported_and_replaced(inside: str, codes: list[str]) -> None:
    vehicle, found = _vehicle(inside)
    assert sorted(found) == codes
    assert min(vehicle.length, vehicle.width, vehicle.height, vehicle.wheelbase) > 0.0


def test_one_name_may_mean_several_vehicles() -> None:
    longer = CAR.replace("4.5", "5.5")
    scenario, codes = expanded(scenario_text(entities=EGO + entity("b", longer) + entity("c")))
    assert codes == []
    assert [actor.model for actor in scenario.actors] == ["car", "car#2", "car"]
    assert [vehicle.length for vehicle in scenario.vehicles] == [4.5, 5.5]


def test_an_entity_is_declared_once() -> None:
    scenario, codes = expanded(scenario_text(entities=EGO + EGO))
    assert codes == ["SC216"]
    assert len(scenario.actors) == 1


def _first(scenario: Scenario) -> list[tuple[str, object]]:
    return [(one.entity, one.action) for one in scenario.storyboard.init]


def test_a_trailer_is_an_entity_that_is_hitched_first() -> None:
    towing = CAR.replace(
        "</Vehicle>",
        '<TrailerHitch dx="-1.2"/><Trailer><Trailer name="wagon">'
        + CAR.replace('name="car"', 'name="cart"').replace("</Vehicle>", '<TrailerCoupler dx="3"/></Vehicle>')
        + "</Trailer></Trailer></Vehicle>",
    )
    scenario, codes = expanded(scenario_text(entities=entity(inside=towing)))
    assert codes == []
    assert [actor.id for actor in scenario.actors] == ["Ego", "wagon"]
    assert _first(scenario) == [("Ego", ConnectTrailerAction(trailer="wagon"))]
    assert [(vehicle.hitch, vehicle.coupler) for vehicle in scenario.vehicles] == [(-1.2, None), (None, 3.0)]


def test_a_trailer_may_be_named_before_its_declaration() -> None:
    towing = CAR.replace("</Vehicle>", '<Trailer><TrailerRef entityRef="wagon"/></Trailer></Vehicle>')
    scenario, codes = expanded(scenario_text(entities=entity(inside=towing) + entity("wagon")))
    assert codes == []
    assert _first(scenario) == [("Ego", ConnectTrailerAction(trailer="wagon"))]


def test_a_controller_is_assigned_first() -> None:
    held = '<ObjectController><Controller name="external"><Properties/></Controller></ObjectController>'
    scenario, _ = expanded(scenario_text(entities=entity(inside=CAR + held)))
    entity_id, action = _first(scenario)[0]
    assert entity_id == "Ego"
    assert isinstance(action, AssignControllerAction)
    assert action.model == "external"
    missing = '<ObjectController><CatalogReference catalogName="C" entryName="E"/></ObjectController>'
    assert expanded(scenario_text(entities=entity(inside=CAR + missing)))[1] == ["SC744"]


def test_selections_stand_for_their_members() -> None:
    selections = """
<EntitySelection name="all"><Members><ByType objectType="vehicle"/></Members></EntitySelection>
<EntitySelection name="both"><Members><EntityRef entityRef="all"/><EntityRef entityRef="b"/></Members></EntitySelection>
"""
    actors = '<Actors selectTriggeringEntities="false"><EntityRef entityRef="both"/></Actors>'
    text = scenario_text(story(event(), actors=actors), entities=EGO + entity("b") + selections)
    scenario, codes = expanded(text)
    assert codes == []
    assert scenario.storyboard.stories[0].acts[0].groups[0].actors == ("Ego", "b")


def test_a_selection_stands_for_its_members_where_entities_are_deleted_and_in_a_clearance() -> None:
    """Both may name a selection ("Entity type constraints", ASAM OpenSCENARIO)."""
    selection = '<EntitySelection name="all"><Members><ByType objectType="vehicle"/></Members></EntitySelection>'
    delete = '<GlobalAction><EntityAction entityRef="all"><DeleteEntityAction/></EntityAction></GlobalAction>'
    clear = """<ByEntityCondition>
<TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="Ego"/></TriggeringEntities>
<EntityCondition><RelativeClearanceCondition oppositeLanes="false" freeSpace="false"><EntityRef entityRef="all"/>
</RelativeClearanceCondition></EntityCondition></ByEntityCondition>"""
    told = story(event(start=condition(clear), action=delete))
    scenario, codes = expanded(scenario_text(told, entities=EGO + entity("b") + selection))
    assert codes == []
    found = scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0]
    assert found.start is not None
    assert [one.action for one in found.actions] == [DeleteEntityAction(entity=name) for name in ("Ego", "b")]
    clearance = found.start.groups[0].conditions[0].condition
    assert isinstance(clearance, RelativeClearanceCondition)
    assert clearance.of == ("Ego", "b")


def test_a_selection_without_members_is_not_an_entity() -> None:
    selection = '<EntitySelection name="walkers"><Members><ByType objectType="pedestrian"/></Members></EntitySelection>'
    near = """<ByEntityCondition>
<TriggeringEntities triggeringEntitiesRule="all"><EntityRef entityRef="Ego"/></TriggeringEntities>
<EntityCondition><RelativeDistanceCondition entityRef="walkers" relativeDistanceType="longitudinal" freespace="true"
rule="lessThan" value="1"/></EntityCondition></ByEntityCondition>"""
    assert expanded(scenario_text(story(event(start=condition(near))), entities=EGO + selection))[1] == ["SC222"]


NOBODY = '<EntitySelection name="nobody"><Members><ByType objectType="pedestrian"/></Members></EntitySelection>'
TRIGGERED = """<ByEntityCondition>
<TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="{}"/></TriggeringEntities>
<EntityCondition>{}</EntityCondition></ByEntityCondition>"""
CLEAR = '<RelativeClearanceCondition oppositeLanes="false" freeSpace="false">{}</RelativeClearanceCondition>'


@pytest.mark.parametrize(
    "near",
    [
        TRIGGERED.format("nobody", '<StandStillCondition duration="0"/>'),
        TRIGGERED.format("Ego", '<CollisionCondition><EntityRef entityRef="nobody"/></CollisionCondition>'),
        TRIGGERED.format("Ego", CLEAR.format('<EntityRef entityRef="nobody"/>')),
    ],
)
def test_a_condition_on_an_empty_selection_is_reported_and_never_true(near: str) -> None:
    """Without any <EntityRef>, a clearance would be that of all entities."""
    scenario, codes = expanded(scenario_text(story(event(start=condition(near))), entities=EGO + entity("b") + NOBODY))
    assert codes == ["SC222"]
    found = scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0]
    assert found.start is not None
    assert found.start.groups == ()


def test_an_empty_selection_is_reported_in_the_init_and_among_actors() -> None:
    actors = '<Actors selectTriggeringEntities="false"><EntityRef entityRef="nobody"/></Actors>'
    init = f'<Private entityRef="nobody">{speed()}</Private>'
    text = scenario_text(story(event(), actors=actors), init=init, entities=EGO + NOBODY)
    assert expanded(text)[1] == ["SC222", "SC222", "SC760"]


def test_a_selection_is_not_a_single_entity() -> None:
    selection = '<EntitySelection name="all"><Members><ByType objectType="vehicle"/></Members></EntitySelection>'
    relative = """<ByEntityCondition>
<TriggeringEntities triggeringEntitiesRule="all"><EntityRef entityRef="all"/></TriggeringEntities>
<EntityCondition><RelativeSpeedCondition entityRef="all" rule="lessThan" value="1"/></EntityCondition>
</ByEntityCondition>"""
    start = (
        f'<ConditionGroup><Condition name="c" delay="0" conditionEdge="none">{relative}</Condition></ConditionGroup>'
    )
    text = scenario_text(story(event(start=start)), entities=EGO + entity("b") + selection)
    scenario, codes = expanded(text)
    assert codes == ["SC753"]
    begin = scenario.storyboard.stories[0].acts[0].groups[0].maneuvers[0].events[0].start
    assert begin is not None
    assert (begin.groups[0].conditions[0].entities, begin.groups[0].conditions[0].every) == (("Ego", "b"), True)


def test_the_master_of_a_relative_final_speed_is_the_first_member_of_a_selection() -> None:
    selection = '<EntitySelection name="all"><Members><ByType objectType="vehicle"/></Members></EntitySelection>'
    place = '<LanePosition roadId="1" laneId="-1" s="300"/>'
    action = f"""<PrivateAction><SynchronizeAction masterEntityRef="all">
<TargetPositionMaster>{place}</TargetPositionMaster><TargetPosition>{place}</TargetPosition>
<FinalSpeed><RelativeSpeedToMaster value="1" speedTargetValueType="delta"/></FinalSpeed>
</SynchronizeAction></PrivateAction>"""
    scenario, codes = expanded(
        scenario_text(story(event(action=action)), entities=EGO + entity("b") + selection),
    )
    assert codes == ["SC753"]
    ((_, found),) = scenario.storyboard.actions()
    assert isinstance(found, SynchronizeAction)
    assert found.final_speed is not None
    assert (found.master, found.final_speed.relative_to) == ("Ego", "Ego")


def test_a_trailer_to_be_connected_must_be_an_entity() -> None:
    action = '<PrivateAction><TrailerAction><ConnectTrailerAction trailerRef="{}"/></TrailerAction></PrivateAction>'
    for name in ("", "nobody"):
        assert expanded(scenario_text(story(event(action=action.format(name)))))[1] == ["SC222"]
