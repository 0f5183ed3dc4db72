"""Places to which no roads lead, as waypoints of a route and as positions to acquire."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.compiler import Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.routes import place_on_route
from scenario_compiler.vocabulary.positions import InRouteLane, LanePositionWord, RoutePosition, RouteWord, Waypoint
from tests.engine.make import lane, road
from tests.roads.make import network
from tests.roads.test_attachments import attached

APART = road(1, 200.0, lane(-1), left=lane(1)) + road(2, 200.0, lane(-1), left=lane(1), x=500.0)
"""Two roads without a connection."""

HERE, THERE = '<lane road="1" lane="-1" s="150"/>', '<lane road="2" lane="-1" s="50"/>'


def reported(folder: Path, do: str, more: str = "") -> list[tuple[str, str, str]]:
    """Return the code, severity and message of each finding of an actor that starts on road 1."""
    header = '<header revMajor="1" revMinor="4" name="" version="1" date="2026"/>'
    (folder / "apart.xodr").write_text(f"<OpenDRIVE>{header}{APART}</OpenDRIVE>", encoding="utf-8")
    path = folder / "apart.xml"
    path.write_text(
        '<scenarios version="1"><scenario name="apart" map="apart.xodr" duration="5">'
        '<ego speed="5"><start><lane road="1" lane="-1" s="20"/></start></ego>'
        '<dynamic id="car" speed="5"><start><lane road="1" lane="-1" s="60"/></start>'
        f'<when><time after="1"/><do>{do}</do></when>{more}</dynamic></scenario></scenarios>',
        encoding="utf-8",
    )
    sink = Diagnostics()
    assert compile_target(path, {}, sink, overrides=Overrides(perception="ideal")) is not None
    return [(one.code.id, one.severity.name.lower(), one.message) for one in sink if one.code.id == "SC379"]


def route(*waypoints: str) -> str:
    """Return an action that assigns a route."""
    return f"<assign_route><route>{''.join(f'<waypoint>{one}</waypoint>' for one in waypoints)}</route></assign_route>"


def test_a_waypoint_to_which_no_roads_lead_is_reported(tmp_path: Path) -> None:
    """The route has left it out, in silence."""
    message = "no roads lead from the waypoint before to this one, so the route leaves it out"
    assert reported(tmp_path, route(HERE, THERE)) == [("SC379", "warning", message)]
    assert reported(tmp_path, route(HERE, HERE)) == []


def test_a_position_to_which_no_roads_lead_is_reported(tmp_path: Path) -> None:
    message = "no roads lead from the start of 'car' to this position, so it has no effect"
    assert reported(tmp_path, f"<acquire_position>{THERE}</acquire_position>") == [("SC379", "warning", message)]
    assert reported(tmp_path, f"<acquire_position>{HERE}</acquire_position>") == []


@pytest.mark.parametrize("lane", ["-1", "1"])
def test_an_entity_that_leaps_to_another_road_may_acquire_a_position_there(tmp_path: Path, lane: str) -> None:
    leap = f'<teleport><lane road="2" lane="{lane}" s="20"/></teleport>'
    more = f'<when><time after="0.5"/><do>{leap}</do></when>'
    assert reported(tmp_path, f"<acquire_position>{THERE}</acquire_position>", more) == []


def test_a_place_on_a_route_lies_behind_the_joint_of_a_branch(tmp_path: Path) -> None:
    """The branch leaves road 1 at 40 m, 20 m after the start of the route; the whole road was counted."""
    made = network(tmp_path, *attached("+", "predecessor"))
    corners = (LanePositionWord(road="1", lane=-1, s=20.0), LanePositionWord(road="2", lane=-1, s=25.0))
    word = RouteWord(waypoints=tuple(Waypoint(position=one) for one in corners))
    for s, road_id, at in ((15.0, "1", 35.0), (30.0, "2", 10.0)):
        place = RoutePosition(route=word, place=InRouteLane(s=s, lane=-1))
        index, lane_id, found, offset = place_on_route(made, {}, place)
        assert (made.road_ids[index], lane_id) == (road_id, -1)
        assert (found, offset) == pytest.approx((at, 0.0))
