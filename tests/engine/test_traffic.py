"""Background traffic drives: it follows, turns, changes lanes and yields, without contact and without a jam."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest

from scenario_compiler.compiler import Compilation, Overrides, compile_target
from scenario_compiler.diagnostics import Diagnostics, as_text
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.columns.trace import TRACE_FIELDS, TRACE_HEAD, trace_width
from scenario_compiler.engine.motion.collision import overlap
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.story.step import reset, step
from scenario_compiler.engine.traffic.driving import thinks_now
from tests.engine.both import run_both
from tests.engine.make import lane, road

TOWN = """<scenarios version="1"><scenario name="town" map="town_grid" duration="120">
  <ego speed="0" desired_speed="1"><start><road road="1" s="20" t="-30"/></start></ego>
  <traffic vehicles="30" pedestrians="5"/>
  <takeover><cause kind="controller"/></takeover>
</scenario></scenarios>"""

MIXED = """<scenarios version="1"><scenario name="mixed" map="town_grid" duration="25">
  <ego speed="10"><start><random_spawn_point/></start></ego>
  <static id="barrel" model="static.prop.barrel"><at><random on="sidewalk" clear="4"/></at></static>
  <static id="box" model="static.prop.box01"><at><beside entity="barrel" distance="0.8" ahead="1"/></at></static>
  <dynamic id="walker" model="walker.pedestrian.0001">
    <start><road road="1" s="150" t="-6"/></start>
    <when><time after="2"/><do>
      <follow_path speed="1.5">
        <point><road road="1" s="150" t="0"/></point><point><road road="1" s="152" t="7"/></point>
      </follow_path>
    </do></when>
  </dynamic>
  <dynamic id="timed" speed="5">
    <start><lane road="2" lane="-1" s="20"/></start>
    <path then="drive">
      <point time="2"><lane road="2" lane="-1" s="40"/></point><point time="4"><lane road="2" lane="-1" s="50"/></point>
    </path>
    <when><time after="6"/><do><lane_offset to="-0.5" over_time="2"/></do></when>
  </dynamic>
  <dynamic id="bound" speed="10">
    <start><lane road="2" lane="-1" s="90"/></start>
    <destination><lane road="4" lane="1" s="20"/></destination>
  </dynamic>
  <traffic vehicles="14" pedestrians="3" types="car motorbike van"/>
</scenario></scenarios>"""


def compiled_text(folder: Path, text: str) -> Compilation:
    """Return the plan of the one scenario in a text, with ideal perception."""
    path = folder / "traffic.xml"
    path.write_text(text, encoding="utf-8")
    sink = Diagnostics()
    done = compile_target(path, {}, sink, overrides=Overrides(perception="ideal"))
    assert done is not None, [as_text(one) for one in sink]
    return done


def started(done: Compilation, seed: int) -> tuple[Program, State]:
    """Return a program and its state at t = 0."""
    program = build_program(done.plan, done.network)
    state = new_state(program)
    state.draw[:] = make_draws(seed)
    reset(done.network.tables, program, state)
    return program, state


@pytest.mark.parametrize(("step", "frames"), [(0.1, 5), (0.05, 10), (0.02, 25), (0.005, 100)])
def test_a_driver_decides_twice_a_second_at_any_step(tmp_path: Path, step: float, frames: int) -> None:
    done = compiled_text(tmp_path, TOWN)
    program = build_program(done.plan.model_copy(update={"step": step}), done.network)
    state = new_state(program)
    for vehicle in (3, 17):
        decides = []
        for frame in range(1, 4 * frames + 1):
            state.frame[0] = frame
            if thinks_now(program, state, vehicle) == 1:
                decides.append(frame)
        assert [later - earlier for earlier, later in pairwise(decides)] == [frames] * 3


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 3])
def test_thirty_vehicles_drive_for_two_minutes(tmp_path: Path, seed: int) -> None:
    done = compiled_text(tmp_path, TOWN)
    p, st = started(done, seed)
    vehicles = [i for i in range(p.entity_count[0]) if p.entity_motion[i] == op.MOTION_TRAFFIC]
    assert len(vehicles) == 30
    still = dict.fromkeys(vehicles, 0.0)
    longest, changes = 0.0, 0
    while st.stop[0] == op.STOP_NONE:
        lanes = [st.kept_lane[i] for i in vehicles]
        roads = [st.road[i] for i in vehicles]
        step(done.network.tables, p, st)
        for k, i in enumerate(vehicles):
            still[i] = still[i] + 0.05 if st.v[i] < 0.1 else 0.0
            longest = max(longest, still[i])
            changes += roads[k] == st.road[i] and lanes[k] != st.kept_lane[i]
        if st.frame[0] % 5 == 0:
            assert not any(overlap(p, st, i, j) for i in range(p.entity_count[0]) for j in range(i))
    assert st.flag[0] == op.FAULT_NONE
    assert st.clock[0] >= 119.9
    assert longest < 30.0
    assert changes > 0
    assert min(st.odometer[i] for i in vehicles) > 300.0
    assert sum(st.turns[i] for i in vehicles) > 60


def test_both_forms_leave_the_same_bytes_with_all_kinds_of_actors(tmp_path: Path) -> None:
    done = compiled_text(tmp_path, MIXED)
    program, tables = build_program(done.plan, done.network), done.network.tables
    rows, draws = [list(program.const)] * 3, [make_draws(7, k) for k in range(3)]
    both = run_both(tables, program, rows, draws, 500)
    assert both.interpreted == both.compiled
    width = trace_width(program)
    starts = [tuple(trace[:width][TRACE_HEAD::TRACE_FIELDS]) for trace in both.traces]
    assert len(set(starts)) == 3


def test_starts_depend_only_on_the_seed_and_keep_their_distance(tmp_path: Path) -> None:
    done = compiled_text(tmp_path, TOWN)
    (p, one), (_, again), (_, other) = (started(done, seed) for seed in (4, 4, 5))
    assert (one.x, one.y) == (again.x, again.y)
    assert one.x != other.x
    vehicles = [i for i in range(p.entity_count[0]) if p.entity_motion[i] == op.MOTION_TRAFFIC]
    apart = [(one.x[i] - one.x[j]) ** 2 + (one.y[i] - one.y[j]) ** 2 for i in vehicles for j in vehicles if i < j]
    assert min(apart) >= 20.0**2


def test_a_seed_of_its_own_fixes_the_traffic(tmp_path: Path) -> None:
    done = compiled_text(tmp_path, TOWN.replace("<traffic ", '<traffic seed="9" '))
    (_, one), (_, other) = (started(done, seed) for seed in (4, 5))
    assert (one.x, one.y) == (other.x, other.y)


def test_traffic_without_room_is_a_fault(tmp_path: Path) -> None:
    done = compiled_text(tmp_path, TOWN.replace("<traffic ", '<traffic roads="4" '))
    p, st = started(done, 1)
    assert st.flag[0] == op.FAULT_NO_ROOM
    assert p.entity_motion[st.flag_at[0]] == op.MOTION_TRAFFIC


def test_lanes_may_have_any_id(tmp_path: Path) -> None:
    made = tmp_path / "made.xodr"
    text = road(1, 1000.0, lane(-1), lane(-1500))
    made.write_text(f'<OpenDRIVE><header revMajor="1" revMinor="7"/>{text}</OpenDRIVE>', encoding="utf-8")
    scenario = '<scenario name="a" map="made.xodr"><ego speed="9"><start><lane road="1" lane="-1" s="9"/></start></ego>'
    run = compiled_text(tmp_path, f'<scenarios version="1">{scenario}<traffic vehicles="20"/></scenario></scenarios>')
    program = build_program(run.plan, run.network)
    state = new_state(program)
    state.draw[:] = make_draws(1)
    reset(run.network.tables, program, state)
    assert set(state.lane) == {-1, -1500}


def test_density_counts_per_kilometre_of_lane(tmp_path: Path) -> None:
    done = compiled_text(tmp_path, TOWN.replace('vehicles="30" pedestrians="5"', 'density="2" roads="1"'))
    assert sum(entity.kind == "traffic" for entity in done.plan.entities) == 2
