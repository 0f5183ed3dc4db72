"""Positions at the moment of their use, teleports, entities that come and go, and trailers, on scenarios of words."""

from __future__ import annotations

from itertools import pairwise
from math import atan2, cos, hypot, pi, sin
from typing import Literal

import pytest

from scenario_compiler.diagnostics import Diagnostics, Severity, as_text
from scenario_compiler.engine.columns.opcodes import FAULT_OFF_ROAD_START
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.motion.ahead import point_on_way, walk
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.plan.lower import lower
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.actions import (
    AcquirePositionAction,
    Action,
    AddEntityAction,
    ConnectTrailerAction,
    DeleteEntityAction,
    DisconnectTrailerAction,
    LaneChangeToAction,
    TeleportAction,
    VisibilityAction,
)
from scenario_compiler.vocabulary.conditions import SimulationTimeCondition
from scenario_compiler.vocabulary.entities import Dynamic, Vehicle
from scenario_compiler.vocabulary.positions import (
    FreePosition,
    LanePositionWord,
    LanesAwayPosition,
    Position,
    RelativeObjectPosition,
    RelativeRoadPosition,
    RelativeWorldPosition,
    RoadPosition,
)
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.storyboard import (
    Act,
    ConditionGroup,
    Event,
    InitAction,
    Maneuver,
    ManeuverGroup,
    Story,
    StoryAction,
    Storyboard,
    Trigger,
    TriggerCondition,
)
from scenario_compiler.vocabulary.weather import Weather
from tests.engine.both import run_both
from tests.engine.make import bend, highway, lane, network_of, road
from tests.roads.test_lane_end import RENUMBERED, SECTIONS

CAR = Vehicle(
    name="car", length=4.5, width=1.8, height=1.5, wheelbase=2.7, center=1.4, hitch=-1.0, coupler=3.0, max_speed=80.0
)
EGO = LanePositionWord(road="1", lane=-1, s=100.0)
ONCOMING = LanePositionWord(road="1", lane=1, s=100.0)


def at_time(time: float, number: int, *actions: Action) -> Event:
    """Return an event that does actions from a time on, in its own words' place in the manoeuvre."""
    begin = TriggerCondition(condition=SimulationTimeCondition(after=time))
    return Event(
        name=f"event{number}",
        actions=tuple(StoryAction(name=f"action{number}.{k}", action=one) for k, one in enumerate(actions)),
        start=Trigger(groups=(ConditionGroup(conditions=(begin,)),)),
    )


def board(*events: Event, init: tuple[InitAction, ...] = (), actor: str = "b") -> Storyboard:
    """Return a storyboard whose events are those of one actor."""
    group = ManeuverGroup(name="group", actors=(actor,), maneuvers=(Maneuver(name="maneuver", events=events),))
    story = Story(name="story", acts=(Act(name="act", groups=(group,)),))
    return Storyboard(init=init, stories=(story,) if events else ())


def planned(
    network: Network, starts: dict[str, Position | None], storyboard: Storyboard, speed: float = 0.0
) -> tuple[Plan, Diagnostics]:
    """Return the plan of dynamic actors without an automated vehicle."""
    actors = tuple(Dynamic(id=name, model="car", start=start, speed=speed) for name, start in starts.items())
    scenario = Scenario(
        name="test", map="map", weather=Weather(), duration=10.0, actors=actors, vehicles=(CAR,), storyboard=storyboard
    )
    sink = Diagnostics()
    plan = lower(scenario, network, sink, values={}, perception="ideal")
    assert plan is not None, [as_text(one) for one in sink]
    return plan, sink


def begun(network: Network, plan: Plan) -> tuple[State, dict[str, int]]:
    """Return the state at t = 0 and the entities' numbers."""
    program = build_program(plan, network)
    state = new_state(program)
    state.draw[:] = make_draws(1)
    reset(network.tables, program, state)
    return state, {entity.id: i for i, entity in enumerate(plan.entities)}


def teleported(network: Network, other: Position, position: Position) -> tuple[State, Plan]:
    """Return the state at t = 0 with entity 0 at `other` and entity 1 put at a position by the init."""
    init = (InitAction(entity="b", action=TeleportAction(position=position)),)
    plan, _ = planned(network, {"a": other, "b": None}, board(init=init))
    state, _ = begun(network, plan)
    assert state.flag[0] == 0
    return state, plan


@pytest.mark.parametrize(
    ("other", "position", "x", "y", "heading"),
    [
        (EGO, LanesAwayPosition(entity="a", distance=20.0), 120.0, -1.75, 0.0),
        (EGO, LanesAwayPosition(entity="a", distance=-20.0, lanes=-1, offset=0.5), 80.0, -4.75, 0.0),
        (EGO, LanesAwayPosition(entity="a", distance=5.0, lanes=1, along="lane"), 105.0, 1.75, pi),
        (EGO, LanesAwayPosition(entity="a", distance=5.0, lanes=1), 105.0, 1.75, 0.0),
        (ONCOMING, LanesAwayPosition(entity="a", distance=30.0, along="lane"), 70.0, 1.75, pi),
        (ONCOMING, LanesAwayPosition(entity="a", distance=30.0), 130.0, 1.75, 0.0),
        (ONCOMING, LanesAwayPosition(entity="a", distance=3.0, lanes=1, offset=0.2, along="lane"), 97.0, -1.95, 0.0),
        (ONCOMING, LanesAwayPosition(entity="a", distance=1.0, heading=1.0), 101.0, 1.75, 1.0),
        (EGO, LanesAwayPosition(entity="a", distance=0.0, lanes=-7), 100.0, -8.75, 0.0),
        (EGO, LanesAwayPosition(entity="a", distance=9999.0), 2000.0, -1.75, 0.0),
        (EGO, RelativeRoadPosition(entity="a", ds=10.0, dt=-3.0), 110.0, -4.75, 0.0),
        (ONCOMING, RelativeRoadPosition(entity="a", ds=10.0, dt=-3.5, turn=pi), 110.0, -1.75, pi),
        (ONCOMING, RelativeObjectPosition(entity="a", dx=5.0, dy=1.0), 95.0, 0.75, pi),
        (ONCOMING, RelativeObjectPosition(entity="a", dx=5.0, dy=1.0, turn=-pi), 95.0, 0.75, 0.0),
        (ONCOMING, RelativeWorldPosition(entity="a", dx=5.0, dy=1.0), 105.0, 2.75, pi),
        (ONCOMING, RelativeWorldPosition(entity="a", dx=5.0, dy=100.0, heading=0.3), 105.0, 101.75, 0.3),
        (EGO, FreePosition(x=50.0, y=-5.0, heading=0.2), 50.0, -5.0, 0.2),
        (EGO, FreePosition(x=50.0, y=50.0, heading=4.0), 50.0, 50.0, 4.0),
        (EGO, LanePositionWord(road="1", lane=1, s=60.0, heading=0.5), 60.0, 1.75, 0.5),
        (EGO, RoadPosition(road="1", s=60.0, t=1.75), 60.0, 1.75, 0.0),
        (EGO, RoadPosition(road="1", s=60.0, t=1.75, heading=0.5), 60.0, 1.75, 0.5),
        (
            FreePosition(x=0.0, y=90.0, heading=0.5),
            RelativeObjectPosition(entity="a", dx=2.0, dy=0.0),
            1.7552,
            90.9589,
            0.5,
        ),
    ],
)
def test_positions_lie_where_they_say(other: Position, position: Position, x: float, y: float, heading: float) -> None:
    state, plan = teleported(highway(), other, position)
    assert (state.x[1], state.y[1]) == pytest.approx((x, y), abs=1e-4)
    assert cos(state.h[1] - heading) == pytest.approx(1.0, abs=1e-9)
    known = plan.derived["b"]
    assert (known.x, known.y) == pytest.approx((x, y), abs=1e-4)
    assert cos(known.heading - heading) == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(("lane", "radius"), [(-1, 51.75), (1, 48.25)])
@pytest.mark.parametrize("distance", [40.0, -40.0])
def test_a_distance_along_a_lane_is_that_of_its_centre_line(lane: int, radius: float, distance: float) -> None:
    """In a left-hand bend of 50 m the lanes are circles of 51.75 m and 48.25 m; along the road, s counts."""
    at = LanePositionWord(road="1", lane=lane, s=100.0)
    forward = -lane
    for along, angle in (("lane", forward * distance / radius), ("road", distance / 50.0)):
        place = LanesAwayPosition.model_validate({"entity": "a", "distance": distance, "along": along})
        state, plan = teleported(bend(50.0), at, place)
        turned = 2.0 + angle
        assert (state.x[1], state.y[1]) == pytest.approx((radius * sin(turned), 50.0 - radius * cos(turned)), abs=1e-3)
        assert (plan.derived["b"].x, plan.derived["b"].y) == pytest.approx((state.x[1], state.y[1]))


def test_a_point_on_a_road_is_led_by_its_lane_with_its_heading() -> None:
    network = highway()
    init = (InitAction(entity="b", action=TeleportAction(position=FreePosition(x=50.0, y=-5.0, heading=0.1))),)
    plan, _ = planned(network, {"b": None}, board(init=init), speed=10.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    assert (state.road[0], state.lane[0]) == (0, -2)
    for _ in range(20):
        step(network.tables, program, state)
    assert (state.x[0], state.y[0], state.h[0]) == pytest.approx((60.0, -5.0, 0.1), abs=1e-6)


def test_an_entity_off_every_road_goes_straight_on() -> None:
    network = highway()
    start = FreePosition(x=50.0, y=50.0, heading=2.0)
    plan, _ = planned(network, {"b": start}, Storyboard(), speed=10.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    assert state.road[0] == -1
    for _ in range(20):
        step(network.tables, program, state)
    assert (state.x[0], state.y[0]) == pytest.approx((50.0 + 10.0 * cos(2.0), 50.0 + 10.0 * sin(2.0)), abs=1e-9)


def test_an_entity_that_faces_against_its_lane_drives_against_it() -> None:
    network = highway()
    init = (InitAction(entity="b", action=TeleportAction(position=FreePosition(x=50.0, y=-1.75, heading=pi))),)
    plan, _ = planned(network, {"b": None}, board(init=init), speed=10.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    for _ in range(20):
        step(network.tables, program, state)
    assert state.x[0] == pytest.approx(40.0, abs=1e-6)
    assert state.lane[0] == -1


def test_a_bridge_is_chosen_by_height() -> None:
    above = '<elevationProfile><elevation s="0" a="8" b="0" c="0" d="0"/></elevationProfile>'
    upper = road(2, 100.0, lane(-1), left=lane(1)).replace("<lanes>", above + "<lanes>")
    network = network_of(road(1, 100.0, lane(-1), left=lane(1)), upper)
    for z, index in ((0.3, 0), (7.0, 1)):
        state, _ = teleported(network, EGO.model_copy(update={"s": 10.0}), FreePosition(x=50.0, y=-2.0, z=z))
        assert state.road[1] == index
        assert state.z[1] == pytest.approx(8.0 * index)


def test_without_an_automated_vehicle_positions_beyond_the_road_are_corrected() -> None:
    starts: dict[str, Position | None] = {
        "far": LanePositionWord(road="1", lane=-1, s=9000.0),
        "wide": LanePositionWord(road="1", lane=-9, s=20.0),
        "there": RoadPosition(road="1", s=-3.0, t=1.0),
    }
    plan, sink = planned(highway(), starts, Storyboard())
    found = {(one.code.id, one.severity) for one in sink}
    assert found == {("SC372", Severity.WARNING), ("SC373", Severity.WARNING)}
    assert [(round(pose.x), round(pose.y, 2)) for pose in plan.derived.values()] == [
        (2000, -1.75),
        (20, -8.75),
        (0, 1.0),
    ]


def test_a_position_beside_an_entity_off_the_road_is_a_fault() -> None:
    network = highway()
    init = (InitAction(entity="b", action=TeleportAction(position=LanesAwayPosition(entity="a", distance=1.0))),)
    plan, _ = planned(network, {"a": FreePosition(x=0.0, y=99.0), "b": None}, board(init=init))
    state, _ = begun(network, plan)
    assert state.flag[0] == FAULT_OFF_ROAD_START
    assert "b" not in plan.derived


def test_a_teleport_keeps_the_speed_and_covers_no_distance() -> None:
    network = highway()
    event = at_time(0.2, 0, TeleportAction(position=LanePositionWord(road="1", lane=-2, s=500.0)))
    plan, _ = planned(network, {"b": EGO}, board(event), speed=10.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    for _ in range(10):
        step(network.tables, program, state)
    assert state.v[0] == 10.0
    assert (state.x[0], state.y[0]) == pytest.approx((500.0 + 5 * 0.05 * 10.0, -5.25), abs=1e-6)
    assert state.odometer[0] == pytest.approx(4.5, abs=1e-6)


def test_entities_appear_and_disappear() -> None:
    network = highway()
    events = (
        at_time(0.1, 0, AddEntityAction(entity="late", position=LanesAwayPosition(entity="b", distance=30.0))),
        at_time(0.3, 1, DeleteEntityAction(entity="late")),
        at_time(0.3, 2, VisibilityAction(graphics=True, sensors=False, traffic=True)),
    )
    plan, _ = planned(network, {"b": EGO, "late": None}, board(*events))
    program = build_program(plan, network)
    state, number = begun(network, plan)
    late = number["late"]
    there = [state.present[late]]
    while state.clock[0] < 0.49:
        step(network.tables, program, state)
        there.append(state.present[late])
    assert there == [0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0]
    assert state.x[late] == pytest.approx(130.0)
    assert state.visible[number["b"]] == 5


def test_trailers_follow_their_hitch_until_they_are_let_go() -> None:
    network = highway()
    init = (
        InitAction(entity="b", action=ConnectTrailerAction(trailer="trailer")),
        InitAction(entity="trailer", action=ConnectTrailerAction(trailer="last")),
        InitAction(entity="b", action=TeleportAction(position=FreePosition(x=0.0, y=50.0, heading=0.0))),
    )
    turn = TeleportAction(position=FreePosition(x=0.0, y=50.0, heading=0.5))
    events = (at_time(0.2, 0, DisconnectTrailerAction()), at_time(0.4, 1, turn))
    plan, _ = planned(network, {"b": None, "trailer": None, "last": None}, board(*events, init=init), speed=4.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    assert state.x[:3] == pytest.approx([0.0, -4.0, -8.0])
    for _ in range(4):
        step(network.tables, program, state)
    assert state.x[:3] == pytest.approx([0.8, -3.2, -7.2])
    for _ in range(10):
        step(network.tables, program, state)
    assert state.x[1:3] == pytest.approx([-3.2, -7.2])
    assert state.v[1] == 0.0


def test_a_trailer_that_is_connected_later_swings_to_its_hitch() -> None:
    network = highway()
    starts: dict[str, Position | None] = {
        "b": FreePosition(x=0.0, y=50.0, heading=0.5),
        "trailer": FreePosition(x=-6.0, y=49.0),
    }
    plan, _ = planned(network, starts, board(at_time(0.0, 0, ConnectTrailerAction(trailer="trailer"))))
    state, _ = begun(network, plan)
    hitch_x, hitch_y = -cos(0.5), 50.0 - sin(0.5)
    assert state.h[1] == pytest.approx(atan2(hitch_y - 49.0, hitch_x + 6.0))
    assert hypot(state.x[1] - hitch_x, state.y[1] - hitch_y) == pytest.approx(3.0)


def test_where_a_lane_ends_its_traffic_continues_in_the_nearest_one() -> None:
    network = network_of(SECTIONS)
    plan, _ = planned(network, {"b": LanePositionWord(road="1", lane=-2, s=95.0)}, Storyboard(), speed=20.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    for _ in range(8):
        step(network.tables, program, state)
    assert (state.x[0], state.y[0]) == pytest.approx((103.0, -1.75), abs=1e-5)
    assert (state.lane[0], state.ended[0]) == (-1, 0)


CIRCLE = 200.0
"""Length of a road that is its own successor, m."""


def circle() -> Network:
    """Return a road in a circle with a lane each way."""
    own = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    own += '<successor elementType="road" elementId="1" contactPoint="start"/>'
    lanes = [lane(k, link=f'<predecessor id="{k}"/><successor id="{k}"/>') for k in (-1, 1)]
    return network_of(
        road(1, CIRCLE, lanes[0], left=lanes[1], shape=f'<arc curvature="{2.0 * pi / CIRCLE!r}"/>', link=own)
    )


@pytest.mark.parametrize("along", ["road", "lane"])
def test_a_position_ahead_goes_on_over_the_start_of_a_circle(along: Literal["road", "lane"]) -> None:
    """It ended where the road ends, which is the same road's start."""
    start = LanePositionWord(road="1", lane=-1, s=190.0)
    ahead = LanesAwayPosition(entity="a", lanes=0, distance=30.0, along=along)
    state, _ = teleported(circle(), start, ahead)
    stretch = 1.0 if along == "road" else 1.0 + 1.75 * 2.0 * pi / CIRCLE
    assert state.s[1] == pytest.approx(190.0 + 30.0 / stretch - CIRCLE, abs=0.01)
    state, _ = teleported(circle(), start, RelativeRoadPosition(entity="a", ds=30.0, dt=0.0))
    assert state.s[1] == pytest.approx(20.0, abs=0.01)


def test_a_position_ahead_follows_a_route_to_a_road_that_begins_inside_another_one() -> None:
    """Road 2 leaves road 1 at 40 m; the position lay on road 1, past the branch."""
    inside = '<predecessor elementType="road" elementId="1" elementS="40" elementDir="+"/>'
    network = network_of(road(1, 100.0, lane(-1)), road(2, 60.0, lane(-1), x=40.0, link=inside))
    init = (
        InitAction(entity="a", action=AcquirePositionAction(position=LanePositionWord(road="2", lane=-1, s=50.0))),
        InitAction(entity="b", action=TeleportAction(position=LanesAwayPosition(entity="a", lanes=0, distance=30.0))),
    )
    plan, _ = planned(network, {"a": LanePositionWord(road="1", lane=-1, s=20.0), "b": None}, board(init=init))
    state, _ = begun(network, plan)
    assert network.road_ids[state.road[1]] == "2"
    assert state.s[1] == pytest.approx(10.0)


def test_the_way_ahead_goes_on_over_the_start_of_a_circle() -> None:
    network = circle()
    plan, _ = planned(network, {"b": LanePositionWord(road="1", lane=-1, s=190.0)}, Storyboard(), speed=1.0)
    state, _ = begun(network, plan)
    walk(network.tables, state, 0, -1, 190.0, 1, 100.0, -1)
    assert state.way_count[0] == 2
    found, s, _, distance = point_on_way(network.tables, state, 0, 20.0, -1.75, 0.0, 0.0)
    assert (found, s, distance) == pytest.approx((1, 20.0, 30.0), abs=0.01)


def test_a_lane_change_keeps_its_place_where_its_lane_is_renumbered() -> None:
    network = network_of(RENUMBERED)
    change = at_time(0.0, 0, LaneChangeToAction(lane=-1, over_time=3.0, shape="linear"))
    starts: dict[str, Position | None] = {"b": LanePositionWord(road="1", lane=-2, s=72.0)}
    plan, _ = planned(network, starts, board(change), speed=20.0)
    program = build_program(plan, network)
    state, _ = begun(network, plan)
    places = [(state.x[0], state.y[0])]
    for _ in range(50):
        step(network.tables, program, state)
        places.append((state.x[0], state.y[0]))
    ways = [hypot(x - before_x, y - before_y) for (before_x, before_y), (x, y) in pairwise(places)]
    assert ways[1:] == pytest.approx([1.0] * 49)


def test_both_forms_leave_the_same_bytes_at_a_lanes_end() -> None:
    network = network_of(SECTIONS)
    starts: dict[str, Position | None] = {
        "right": LanePositionWord(road="1", lane=-2, s=95.0),
        "left": LanePositionWord(road="1", lane=1, s=10.0),
        "free": FreePosition(x=100.0, y=-1.0, z=0.5, heading=2.0),
    }
    late = at_time(0.5, 0, TeleportAction(position=RelativeRoadPosition(entity="left", ds=5.0, dt=-9.0, turn=1.0)))
    plan, _ = planned(network, starts, board(late, actor="free"), speed=20.0)
    program = build_program(plan, network)
    both = run_both(network.tables, program, [list(program.const)], [make_draws(1, 0)], 60)
    assert both.interpreted == both.compiled
