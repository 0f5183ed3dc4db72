"""Random positions, and the places of spawn points, groups and positions beside an entity."""

from __future__ import annotations

import math
from itertools import combinations
from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, Severity, as_text
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset
from scenario_compiler.expressions import Expression
from scenario_compiler.plan.checks.overlap import boxes_overlap, corners
from scenario_compiler.plan.model import StartPose
from scenario_compiler.plan.places import spans_of
from scenario_compiler.resources import find_map
from scenario_compiler.roads import load_network
from scenario_compiler.vocabulary.positions import AnyOfPosition, LanePositionWord, RandomPosition

EGO = '<ego speed="5"><start><lane road="1" lane="-1" s="20"/></start></ego>'


def compiled(folder: Path, body: str, ego: str = EGO, before: str = "") -> Compilation:
    """Return the plan of a scenario with a body."""
    path = folder / "place.xml"
    head = '<scenarios version="1"><scenario name="place" map="town_grid" duration="5">'
    path.write_text(f"{head}{before}{ego}{body}</scenario></scenarios>", encoding="utf-8")
    sink = Diagnostics()
    done = compile_target(path, {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, [as_text(one) for one in sink]
    return done


def at_start(done: Compilation, seed: int = 1) -> tuple[State, dict[str, int]]:
    """Return the state at t = 0 and the entities' numbers."""
    state = new_state(program := build_program(done.plan, done.network))
    state.draw[:] = make_draws(seed)
    reset(done.network.tables, program, state)
    assert state.flag[0] == 0
    return state, {entity.id: i for i, entity in enumerate(done.plan.entities)}


def test_stretches_have_the_requested_kind_and_roads() -> None:
    network = load_network(find_map("town_grid"))
    spans = spans_of(network, RandomPosition(on="sidewalk", roads=("4",), s_from=10.0, s_to=60.0))
    assert [(network.road_ids[one.road], one.lane, one.s_from, one.s_to) for one in spans] == [
        ("4", 3, 10.0, 60.0),
        ("4", -3, 10.0, 60.0),
    ]
    assert not spans_of(network, RandomPosition(on="biking"))
    everywhere = spans_of(network, RandomPosition())
    assert all(network.tables.road_junction[one.road] < 0 for one in everywhere)


def test_margins_are_kept_in_the_direction_of_travel() -> None:
    network = load_network(find_map("town_grid"))
    spans = {one.lane: one for one in spans_of(network, RandomPosition(roads=("1",)), behind=5.0, before=25.0)}
    length = network.road("1").length
    assert (spans[-1].s_from, spans[-1].s_to) == (5.0, length - 25.0)
    assert (spans[1].s_from, spans[1].s_to) == (25.0, length - 5.0)


POINTS = """<spawn_points>
  <point name="first"><lane road="2" lane="-1" s="30"/></point>
  <point name="second"><lane road="3" lane="-1" s="40"/></point>
</spawn_points>"""


@pytest.mark.parametrize(
    ("start", "road"),
    [
        ('<spawn_point name="second"/>', "3"),
        ('<spawn_point name="main_street"/>', "1"),
        ('<numbered_spawn_point index="0"/>', "2"),
    ],
)
def test_spawn_points_are_the_scenarios_own_or_the_maps(tmp_path: Path, start: str, road: str) -> None:
    ego = f'<ego speed="5"><start>{start}</start></ego>'
    placed = compiled(tmp_path, "", ego, POINTS).plan.ego.start
    assert isinstance(placed, LanePositionWord)
    assert placed.road == road


def test_a_spawn_point_by_seed_is_fixed_and_without_one_drawn_in_each_run(tmp_path: Path) -> None:
    for k in range(3):
        seeded = compiled(tmp_path, "", f'<ego><start><random_spawn_point seed="{k}"/></start></ego>', POINTS)
        assert isinstance(seeded.plan.ego.start, LanePositionWord)
    done = compiled(tmp_path, "", "<ego><start><random_spawn_point/></start></ego>", POINTS)
    assert isinstance(done.plan.ego.start, AnyOfPosition)
    roads = {done.network.road_ids[at_start(done, seed)[0].road[0]] for seed in range(12)}
    assert roads == {"2", "3"}


def test_a_random_place_keeps_clear_and_what_is_beside_it_follows(tmp_path: Path) -> None:
    body = """<static id="barrel" model="static.prop.barrel"><at><random roads="1" lane="-1" clear="30"/></at></static>
      <static id="box" model="static.prop.box01"><at><beside entity="barrel" distance="1" ahead="2"/></at></static>"""
    done = compiled(tmp_path, body)
    for seed in range(8):
        st, number = at_start(done, seed)
        ego, barrel, box = (number[name] for name in ("ego", "barrel", "box"))
        assert math.dist((st.x[ego], st.y[ego]), (st.x[barrel], st.y[barrel])) >= 30.0
        assert math.dist((st.x[box], st.y[box]), (st.x[barrel], st.y[barrel])) == pytest.approx(math.hypot(1, 2))
        assert st.t[box] - st.t[barrel] == pytest.approx(1.0)


def test_a_row_stands_along_its_lane(tmp_path: Path) -> None:
    place = '<at><lane road="1" lane="-1" s="200" offset="-1"/></at>'
    row = f'<row id="cones" count="4" spacing="6" across="1.5">{place}</row>'
    st, number = at_start(compiled(tmp_path, row))
    found = [(st.s[number[f"cones.{k}"]], st.off[number[f"cones.{k}"]]) for k in range(1, 5)]
    assert found == [pytest.approx(pair) for pair in ((200, -1), (206, -0.5), (212, 0), (218, 0.5))]


def test_a_work_zone_closes_its_lane(tmp_path: Path) -> None:
    zone = '<work_zone id="works"><at><ahead_of entity="ego" distance="120" offset="-1.6"/></at></work_zone>'
    done = compiled(tmp_path, zone)
    st, number = at_start(done)
    barriers = [number[name] for name in number if name.startswith("works.barrier")]
    covered = sorted(st.off[i] for i in barriers)
    assert [done.plan.entities[i].vehicle.category for i in barriers] == ["barrier"] * len(barriers)
    assert covered[0] < -0.7
    assert covered[-1] > 0.7
    assert st.s[number["works.sign"]] == pytest.approx(110.0)
    assert st.t[number["works.sign"]] < -4.0
    assert max(st.s[i] for name, i in number.items() if name.startswith("works.cones")) == pytest.approx(190.0)


def overlapping(done: Compilation, seed: int) -> list[tuple[str, str]]:
    """Return the pairs of entities whose boxes overlap at the start of a run."""
    st, number = at_start(done, seed)
    boxes = {}
    for one in done.plan.entities:
        i = number[one.id]
        pose = StartPose.model_construct(x=st.x[i], y=st.y[i], z=st.z[i], heading=st.h[i])
        boxes[one.id] = corners(one, pose)
    return [(one, other) for one, other in combinations(boxes, 2) if boxes_overlap(boxes[one], boxes[other])]


MANY_POINTS = "".join(f'<point name="p{k}"><lane road="1" lane="-1" s="{60 + 6 * k}"/></point>' for k in range(30))
CLOSE = '<random roads="1 2" clear="0"/>'
SEEDED = '<random roads="1" clear="0" seed="3"/>'
RANDOM_PLACES = {
    "static, close together": "".join(
        f'<static id="a{k}"><at><random roads="1" clear="1"/></at></static>' for k in range(8)
    ),
    "of very different sizes": f"""
      <static id="bus" model="vehicle.mitsubishi.fusorosa"><at>{CLOSE}</at></static>
      <static id="cone" model="static.prop.constructioncone"><at>{CLOSE}</at></static>
      <dynamic id="bike" model="vehicle.bh.crossbike" speed="3"><start>{CLOSE}</start></dynamic>""",
    "dynamic, at spawn points": "".join(
        f'<dynamic id="a{k}" speed="3"><start><random_spawn_point/></start></dynamic>' for k in range(5)
    ),
    "static and dynamic, with one seed": f"""
      <static id="a"><at>{SEEDED}</at></static>
      <dynamic id="b" speed="2"><start>{SEEDED}</start></dynamic>""",
    "rows and work zones": """
      <static id="fixed"><at><lane road="1" lane="-1" s="220"/></at></static>
      <row id="cones" count="8" spacing="6"><at><random roads="1" lane="-1"/></at></row>
      <work_zone id="works" length="10"><at><random roads="1" lane="1"/></at></work_zone>
      <static id="last"><at><random roads="1"/></at></static>""",
}


@pytest.mark.parametrize("body", RANDOM_PLACES.values(), ids=list(RANDOM_PLACES))
def test_an_entity_placed_at_random_overlaps_no_other(tmp_path: Path, body: str) -> None:
    done = compiled(tmp_path, body, before=f"<spawn_points>{MANY_POINTS}</spawn_points>")
    drawn = [one.id for one in done.plan.entities if isinstance(one.start, RandomPosition | AnyOfPosition)]
    places = set()
    for seed in range(40):
        assert overlapping(done, seed) == []
        st, number = at_start(done, seed)
        places.add(tuple(st.x[number[name]] for name in drawn))
    assert drawn
    assert len(places) == 1 if SEEDED in body else len(places) > 30


def test_the_requested_clearance_is_kept(tmp_path: Path) -> None:
    parameter = '<parameter name="gap" type="length" default="40" min="0" max="100"/>'
    places = "".join(f'<static id="a{k}"><at><random roads="1" clear="$gap"/></at></static>' for k in range(3))
    done = compiled(tmp_path, places, before=parameter)
    for seed in range(10):
        st, number = at_start(done, seed)
        points = [(st.x[number[f"a{k}"]], st.y[number[f"a{k}"]]) for k in range(3)]
        assert min(math.dist(one, other) for one, other in combinations(points, 2)) >= 40.0
    start = next(one.start for one in done.plan.entities if one.id == "a0")
    assert isinstance(start, RandomPosition)
    assert isinstance(start.clear, Expression)
    assert start.clear.number({"gap": 0.0}) > 4.0


ROUTE = """<on_route><route><waypoint>{}</waypoint><waypoint><lane road="1" lane="-1" s="300"/></waypoint></route>
  <route_lane s="40" lane="-1"/></on_route>"""
CURVE = """<on_trajectory s="40"><trajectory><polyline>
  <vertex>{}</vertex><vertex><lane road="1" lane="-1" s="300"/></vertex></polyline></trajectory></on_trajectory>"""
CORNERS = {
    "road": '<road road="1" s="100" t="-1.75"/>',
    "world": '<world x="292" y="168.25"/>',
    "own spawn point": '<spawn_point name="own"/>',
    "numbered spawn point": '<numbered_spawn_point index="0"/>',
    "seeded spawn point": '<random_spawn_point seed="1"/>',
}
OWN = '<spawn_points><point name="own"><lane road="1" lane="-1" s="100"/></point></spawn_points>'


@pytest.mark.parametrize("way", [ROUTE, CURVE], ids=["route", "trajectory"])
@pytest.mark.parametrize("corner", CORNERS)
def test_a_start_on_a_way_binds_the_ways_own_positions(tmp_path: Path, way: str, corner: str) -> None:
    static = f'<static id="box"><at>{way.format(CORNERS[corner])}</at></static>'
    state, numbers = at_start(compiled(tmp_path, static, before=OWN))
    at = numbers["box"]
    assert (state.x[at], state.y[at]) == pytest.approx((332.0, 168.25))


@pytest.mark.parametrize(
    ("corner", "code"),
    [
        ('<lane road="77" lane="-1" s="5"/>', "SC371"),
        ('<lane road="1" lane="-9" s="5"/>', "SC372"),
        ('<lane road="1" lane="-1" s="5000"/>', "SC373"),
        ('<spawn_point name="nowhere"/>', "SC376"),
        ("<random_spawn_point/>", "SC383"),
        ('<geographic latitude="0" longitude="0"/>', "SC385"),
    ],
)
@pytest.mark.parametrize("way", [ROUTE, CURVE], ids=["route", "trajectory"])
@pytest.mark.parametrize("where", ["start", "destination"])
def test_a_fault_of_a_way_is_reported_where_an_entity_starts_or_ends_on_it(
    tmp_path: Path, where: str, way: str, corner: str, code: str
) -> None:
    places = {"start": '<lane road="1" lane="-1" s="60"/>', "destination": '<lane road="1" lane="-1" s="90"/>'}
    places[where] = way.format(corner)
    body = "".join(f"<{name}>{place}</{name}>" for name, place in places.items())
    path = tmp_path / "place.xml"
    head = '<scenarios version="1"><scenario name="place" map="town_grid" duration="5">'
    path.write_text(f'{head}{EGO}<dynamic id="car">{body}</dynamic></scenario></scenarios>', encoding="utf-8")
    sink = Diagnostics()
    compile_target(path, {}, sink, overrides=Overrides(perception="ideal"))
    assert {one.code.id for one in sink if one.severity is Severity.ERROR} == {code}


def test_a_route_begins_at_its_first_waypoint_that_is_a_place_on_the_map(tmp_path: Path) -> None:
    """A waypoint relative to an entity is left out: SC389 says so."""
    first = '<relative_lane entity="ego" distance="9"/></waypoint><waypoint><lane road="1" lane="-1" s="200"/>'
    done = compiled(tmp_path, f'<static id="box"><at>{ROUTE.format(first)}</at></static>')
    state, numbers = at_start(done)
    assert state.x[numbers["box"]] == pytest.approx(192.0 + 240.0)


@pytest.mark.parametrize(
    ("place", "x", "y", "heading"),
    [
        ('<route_road s="20" t="1.5"/>', 272.0, 171.5, math.pi),
        ('<route_road s="20" t="-1.5"/>', 272.0, 168.5, 0.0),
        ('<route_lane s="20" lane="1"/>', 272.0, 171.75, math.pi),
        ('<route_lane s="20" lane="-1"/>', 272.0, 168.25, 0.0),
        ('<route_entity entity="ego"/>', 212.0, 168.25, 0.0),
    ],
)
def test_a_place_on_a_route_against_the_road_faces_as_its_lane(
    tmp_path: Path, place: str, x: float, y: float, heading: float
) -> None:
    """On a route against s, s counts along the route, but t to the left along the road's s."""
    corners = "".join(f'<waypoint><lane road="1" lane="1" s="{s}"/></waypoint>' for s in (100, 10))
    static = f'<static id="box"><at><on_route><route>{corners}</route>{place}</on_route></at></static>'
    state, numbers = at_start(compiled(tmp_path, static))
    at = numbers["box"]
    assert (state.x[at], state.y[at]) == pytest.approx((x, y))
    assert state.h[at] == pytest.approx(heading)
