"""The marks that ideal perception remembers between steps agree with a new search at each place."""

from __future__ import annotations

import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import State, new_state
from scenario_compiler.engine.ego.lane_confidence import ideal_confidence, looked_at_sides
from scenario_compiler.engine.ego.sensor import LANE_END_HORIZON, find_lane_end
from scenario_compiler.engine.motion.path import advance_routed, set_path
from scenario_compiler.randomness import uniform
from scenario_compiler.resources import find_map
from scenario_compiler.roads import Network, load_network
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_direction
from scenario_compiler.roads.positions import MarkStretch
from scenario_compiler.roads.travel import distance_to_lane_end
from tests.engine.make import Draft

PLACES = 40
STEPS = 80


def between(low: float, high: float, number: int, what: str) -> float:
    """Return a number between two that depends on the others alone."""
    return low + (high - low) * uniform(11, number, what)


def network(name: str) -> Network:
    """Return a map of ours whose marks are worn in places, evenly or more and more."""
    found = load_network(find_map(name))
    assert found is not None
    worn = []
    for number in range(30):
        road = int(between(0, len(found.road_ids), number, "road"))
        length = found.tables.road_length[road]
        begin = between(0.0, 0.9 * length, number, "begin")
        end = min(begin + between(1.0, 60.0, number, "length"), length)
        first, last = between(0.0, 1.0, number, "first"), between(0.0, 1.0, number, "last")
        worn.append(MarkStretch(found.road_ids[road], None, begin, end, first, first if number % 2 else last))
    return found.with_mark_quality(worn)


@pytest.fixture(scope="module", params=["town_grid", "highway_loop"])
def draft(request: pytest.FixtureRequest) -> Draft:
    """Return a program on such a map, whose plan covers marks too."""
    draft = Draft(network(request.param))
    draft.ego()
    p = draft.program
    p.stretch_road = [int(between(0, len(draft.network.road_ids), number, "covered")) for number in range(20)]
    p.stretch_lane = [op.ALL_MARKS if number % 2 else -1 for number in range(20)]
    qualities = ((-1.0, -1.0), (0.6, 0.6), (0.2, 0.8))
    p.stretch_const = [
        draft.block(40.0 * (n % 3), 40.0 * (n % 3) + 25.0, *qualities[n // 3 % 3], 0.5) for n in range(20)
    ]
    p.stretch_count = [20]
    return draft


def places(draft: Draft) -> list[tuple[int, int, float]]:
    """Return places in lanes that may be driven on: (road, lane, s)."""
    n = draft.network.tables
    rows = [row for row, kind in enumerate(n.lane_type) if is_drivable(kind) == 1]
    found = []
    for number in range(PLACES):
        row = rows[int(between(0, len(rows), number, "row"))]
        section = n.lane_section[row]
        s = between(n.section_s[section], n.section_end[section], number, "s")
        found.append((n.section_road[section], n.lane_id[row], s))
    return found


def drive(draft: Draft, st: State, place: tuple[int, int, float]) -> list[tuple[int, int, float]]:
    """Return the places that follow each other every 1.7 m on the way from a place."""
    way = [place]
    for _ in range(STEPS):
        road, lane, s, rest = advance_routed(draft.network.tables, draft.program, st, *way[-1], 1.7)
        if rest > 0.0:
            break
        way.append((road, lane, s))
    return way


def move_path(draft: Draft, st: State, place: tuple[int, int, float]) -> None:
    """Move the path on as `follow_path` does: within a lane section its row stays."""
    n = draft.network.tables
    section = n.lane_section[max(st.path_row[0], 0)]
    same = st.path_road[0] == place[0] and st.path_lane[0] == place[1]
    if same and n.section_s[section] <= place[2] < n.section_end[section]:
        st.path_s[0] = place[2]
    else:
        set_path(n, st, *place)


def test_kept_marks_are_those_of_a_look_at_each_place(draft: Draft) -> None:
    n, p = draft.network.tables, draft.program
    st = new_state(p)
    st.path_found[0], st.path_road[0], st.even_row[0] = 1, op.NONE, op.NONE
    st.image_health[0] = st.paint_seen[0] = 1.0
    kept = 0
    for begin in places(draft):
        for place in drive(draft, st, begin):
            move_path(draft, st, place)
            ideal_confidence(n, p, st)
            kept += st.even_row[0] == st.path_row[0]
            assert (st.conf_left[0], st.conf_right[0]) == pytest.approx(looked_at_sides(n, p, st), abs=1e-12)
    assert kept > PLACES * STEPS / 3


def test_the_remembered_end_of_the_lane_agrees_with_a_new_search(draft: Draft) -> None:
    n, p = draft.network.tables, draft.program
    st = new_state(p)
    st.path_road[0], st.clear_row[0] = op.NONE, op.NONE
    ended = 0
    for begin in places(draft):
        for road, lane, s in drive(draft, st, begin):
            move_path(draft, st, (road, lane, s))
            find_lane_end(n, p, st, 0)
            rest = distance_to_lane_end(n, road, lane, s, LANE_END_HORIZON, op.NONE)
            ended += rest < LANE_END_HORIZON
            assert (st.lane_end_distance[0] < op.FAR) == (rest < LANE_END_HORIZON)
            assert st.path_sense[0] == lane_direction(n, road, lane, s)
    assert (ended > 0) == ("highway" in str(draft.network.path))
