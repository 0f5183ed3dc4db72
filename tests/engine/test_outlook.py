"""The path that a controller receives: the route in the vehicle's axes, and the distance to the next junction."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns.opcodes import FAR, ROUTE_REACH
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.motion.path import path_ahead, set_path
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Outlook, Simulation
from scenario_compiler.roads import Network
from tests.engine.make import Draft
from tests.roads.make import lane, network, road, section

FILE = """<scenarios version="1"><scenario name="fork" map="made.xodr" duration="1"><ego speed="5">
<start><lane road="1" lane="-1" s="{s}" offset="0.5"/></start>{destination}</ego></scenario></scenarios>"""

LINK = '<link><predecessor id="-1"/><successor id="-1"/></link>'
WIDTH = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>'
LANES = section("", lane(-1, LINK + WIDTH))


def at(x: float, y: float, heading: float, length: float, shape: str = "<line/>") -> str:
    return f'<geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="{length}">{shape}</geometry>'


def linked(kind: str, road_id: str, contact: str) -> str:
    return f'<{kind} elementType="road" elementId="{road_id}" contactPoint="{contact}"/>'


def connecting(number: str, plan: str, length: float, goal: str) -> str:
    ends = linked("predecessor", "1", "end") + linked("successor", goal, "start")
    return road(number, length, plan, LANES, ends, 'junction="J"')


def connection(number: str, to: str) -> str:
    return (
        f'<connection id="{number}" incomingRoad="1" connectingRoad="{to}" contactPoint="start">'
        '<laneLink from="-1" to="-1"/></connection>'
    )


def fork(folder: Path, lanes: str = LANES) -> Network:
    """Return the map with road 1, whose junction goes straight on (2) and to the left (3)."""
    junction = '<{} elementType="junction" elementId="J"/>'
    return network(
        folder,
        road("1", 100.0, at(0, 0, 0, 100), lanes, junction.format("successor")),
        connecting("12", at(100, 0, 0, 20), 20.0, "2"),
        connecting("13", at(100, 0, 0, 15.708, '<arc curvature="0.1"/>'), 15.708, "3"),
        road("2", 10.0, at(120, 0, 0, 10), LANES, junction.format("predecessor")),
        road("3", 50.0, at(110, 10, 1.5707963, 50), LANES, junction.format("predecessor")),
        f'<junction id="J">{connection("0", "13")}{connection("1", "12")}</junction>',
    )


def handed(folder: Path, s: float, destination: str = "") -> Outlook:
    """Return what is handed at the start on road 1."""
    fork(folder)
    path = folder / "fork.xml"
    path.write_text(FILE.format(s=s, destination=destination), encoding="utf-8")
    return outlook_at_the_start(path)


def outlook_at_the_start(path: Path) -> Outlook:
    """Return what the ego's controller receives at the start of a scenario."""
    sink = Diagnostics()
    found = compile_target(path, {}, sink, overrides=Overrides())
    assert found is not None, [as_text(one) for one in sink]
    simulation = Simulation(found.network.tables, build_program(found.plan, found.network))
    simulation.reset(make_draws(1))
    return simulation.look_out()


TO_THE_LEFT = '<destination><lane road="3" lane="-1" s="40"/></destination>'


def test_the_path_follows_the_route_through_the_junction(tmp_path: Path) -> None:
    ahead = handed(tmp_path, 80.0, TO_THE_LEFT)
    assert len(ahead.way) == ROUTE_REACH + 1
    assert ahead.junction == pytest.approx(20.0, abs=1.0)
    assert ahead.way[0] == pytest.approx((0.0, -0.5))
    assert ahead.way[15] == pytest.approx((15.0, -0.5))
    assert ahead.way[-1] == pytest.approx((31.75, 15.54), abs=0.01)


def test_without_a_route_the_path_goes_straight_on_to_the_end_of_the_lanes(tmp_path: Path) -> None:
    ahead = handed(tmp_path, 95.0)
    assert ahead.junction == pytest.approx(5.0, abs=1.0)
    assert all(y == pytest.approx(-0.5) for _, y in ahead.way)
    assert ahead.way[-1][0] == pytest.approx(35.0, abs=1.0)


def test_far_from_it_no_junction_is_in_reach(tmp_path: Path) -> None:
    ahead = handed(tmp_path, 10.0, TO_THE_LEFT)
    assert ahead.junction == FAR
    assert ahead.way[-1] == pytest.approx((float(ROUTE_REACH), -0.5))


def test_the_route_is_taken_from_every_place_of_a_road_with_several_lane_sections(tmp_path: Path) -> None:
    """The distance to the road's end, added up over the sections, was too long by a rounding error for some places.

    From these the path went straight on.
    """
    lanes = "".join(section("", lane(-1, LINK + WIDTH), s) for s in (0.0, 33.3, 71.7))
    draft = Draft(fork(tmp_path, lanes))
    draft.ego(s=0.1)
    draft.program.route_road, draft.program.route_count[0] = [0, 2, 4], 3
    run = draft.start()
    taken = []
    for k in range(300):
        set_path(run.n, run.st, 0, -1, 0.1 + 0.3 * k)
        road, *_ = path_ahead(run.n, run.p, run.st, 105.0 - run.st.path_s[0])
        taken.append(road)
    assert taken == [2] * 300
