"""Actors: paths, trajectories, offsets, routes to a destination, and oncoming traffic."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from tests.engine.test_traffic import compiled_text

HEAD = """<scenarios version="1"><scenario name="actors" map="town_grid" duration="40">
  <ego speed="0" desired_speed="1"><start><road road="1" s="20" t="-30"/></start></ego>"""
TAIL = '<takeover><cause kind="controller"/></takeover></scenario></scenarios>'


class Play:
    """A run of one actor, number 1."""

    def __init__(self, folder: Path, actor: str) -> None:
        self.done = compiled_text(folder, HEAD + actor + TAIL)
        self.n = self.done.network.tables
        self.p = build_program(self.done.plan, self.done.network)
        self.st: State = new_state(self.p)
        self.st.draw[:] = make_draws(1)
        reset(self.n, self.p, self.st)

    def until(self, time: float) -> Play:
        """Step until a time; return itself."""
        while self.st.clock[0] < time - 1e-6:
            assert step(self.n, self.p, self.st) == 1
        assert self.st.flag[0] == 0
        return self

    @property
    def road(self) -> str:
        """Id of the actor's road."""
        return self.done.network.road_ids[self.st.road[1]]


CROSSING = """<dynamic id="walker" model="walker.pedestrian.0001">
  <start><road road="1" s="150" t="-6"/></start>
  <when><time after="2"/><do><follow_path speed="1.5">
    <point><road road="1" s="150" t="0"/></point><point><road road="1" s="150" t="6"/></point>
  </follow_path></do></when></dynamic>"""


def test_a_pedestrian_waits_crosses_and_stops(tmp_path: Path) -> None:
    play = Play(tmp_path, CROSSING).until(2.0)
    assert play.st.v[1] == 0.0
    assert play.st.t[1] == pytest.approx(-6.0)
    play.until(6.0)
    assert play.st.v[1] == 1.5
    assert play.st.t[1] == pytest.approx(0.0, abs=0.2)
    assert play.st.h[1] == pytest.approx(1.5708, abs=1e-3)
    play.until(11.0)
    assert play.st.v[1] == 0.0
    assert play.st.t[1] == pytest.approx(6.0, abs=1e-6)


FAR_AHEAD = "<vertex><free x='0' y='40'/></vertex><vertex><free x='500' y='40'/></vertex>"


@pytest.mark.parametrize(
    ("goal", "x", "y"),
    [
        ('<free x="330" y="190"/>', 330.0, 190.0),
        ('<relative_object entity="walker" dx="0" dy="4"/>', 342.0, 168.0),
        ('<relative_world entity="walker" dx="-3" dy="0"/>', 339.0, 164.0),
        ('<relative_road entity="walker" ds="2" dt="-1"/>', 344.0, 163.0),
        ('<relative_lane entity="walker" distance="5"/>', 347.0, 165.0),
        (
            f'<on_trajectory s="340"><trajectory><polyline>{FAR_AHEAD}</polyline></trajectory></on_trajectory>',
            340.0,
            40.0,
        ),
    ],
    ids=lambda goal: goal[1:13] if isinstance(goal, str) else "",
)
@pytest.mark.parametrize("as_action", [False, True], ids=["path", "follow_path"])
def test_a_path_leads_to_any_kind_of_position(tmp_path: Path, goal: str, x: float, y: float, as_action: bool) -> None:
    """Positions relative to the walker, who stands at (342, 164), are those at the start of the path."""
    points = f'speed="50"><point>{goal}</point>'
    path = f"<path {points}</path>"
    if as_action:
        path = f'<when><time after="0"/><do><follow_path {points}</follow_path></do></when>'
    start = '<start><road road="1" s="150" t="-6"/></start>'
    play = Play(tmp_path, f'<dynamic id="walker" model="walker.pedestrian.0001">{start}{path}</dynamic>').until(4.0)
    assert (play.st.x[1], play.st.y[1]) == pytest.approx((x, y), abs=1e-6)
    assert play.st.v[1] == 0.0


def test_a_trajectory_keeps_its_times_and_then_drives_on(tmp_path: Path) -> None:
    play = Play(
        tmp_path,
        """<dynamic id="car" speed="5"><start><lane road="1" lane="-1" s="100"/></start><path then="drive">
        <point time="2"><lane road="1" lane="-1" s="120"/></point>
        <point time="4"><lane road="1" lane="-1" s="130" offset="0.5"/></point></path></dynamic>""",
    )
    assert play.until(1.0).st.s[1] == pytest.approx(110.0, abs=0.6)
    assert play.st.v[1] == pytest.approx(10.0)
    assert play.until(3.0).st.s[1] == pytest.approx(125.0, abs=0.6)
    play.until(6.0)
    assert play.st.s[1] == pytest.approx(130.0 + 2.0 * play.st.v[1], abs=0.6)
    assert play.st.off[1] == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(("lane", "s", "left"), [(-1, 100, 1.0), (1, 350, -1.0)])
def test_an_offset_is_to_the_left_of_the_travel(tmp_path: Path, lane: int, s: int, left: float) -> None:
    actor = f"""<dynamic id="car" speed="10"><start><lane road="1" lane="{lane}" s="{s}"/></start>
      <when><time after="1"/><do><lane_offset to="0.8" over_time="2"/></do></when></dynamic>"""
    play = Play(tmp_path, actor).until(4.0)
    assert play.st.off[1] == pytest.approx(0.8 * left)


def test_an_actor_takes_the_route_to_its_destination(tmp_path: Path) -> None:
    actor = """<dynamic id="car" speed="10"><start><lane road="2" lane="-1" s="120"/></start>
      <destination><lane road="{road}" lane="{lane}" s="60"/></destination></dynamic>"""
    for road, lane in (("4", "1"), ("1", "-1"), ("5", "-1")):
        assert Play(tmp_path, actor.format(road=road, lane=lane)).until(9.0).road == road


def test_oncoming_traffic_comes_towards_the_ego(tmp_path: Path) -> None:
    play = Play(tmp_path, '<dynamic id="car" speed="10"><start><lane road="1" lane="1" s="400"/></start></dynamic>')
    assert play.st.h[1] == pytest.approx(3.14159, abs=1e-3)
    play.until(10.0)
    assert play.st.s[1] == pytest.approx(300.0, abs=0.1)
    assert (play.st.v[1], play.st.lane[1]) == (10.0, 1)
