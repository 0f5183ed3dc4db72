"""The driver after taking over: the reaction to new risks, braking and evading, and lane keeping."""

from __future__ import annotations

import ast
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.recording.recording import Floats
from tests.engine.make import Draft, Run, highway, lane, network_of, road
from tests.studies.study import compiled, row_at, runs, time_of

SLOW_CAR = 30.0 / 3.6
REACTION = 1.15
"""Perception and reaction of the careful and competent driver after UN R157, s."""


@cache
def offsets(seed: int, settled: float = 0.2, first: float = 0.35, after: float = 37.5) -> tuple[Floats, Floats]:
    """Return the times since the response and the offsets of a driver who keeps a straight lane at 25 m/s."""
    numbers = {
        slots.K_DRIVER_TIME: 0.0,
        slots.K_NOISE: 60.0,
        slots.K_DURATION: 110.0,
        slots.K_SDLP: settled,
        slots.K_SDLP_AT_FIRST: first,
        slots.K_SETTLED_AFTER: after,
    }
    draft = Draft(network_of(road(1, 4000.0, lane(-1), lane(-2))), numbers)
    draft.ego(speed=25.0)
    run = Simulation(draft.network.tables, draft.done())
    run.reset(make_draws(seed))
    rows = []
    while run.step():
        rows.append((run.state.clock[0] - run.state.time_response[0], run.state.off[0]))
    times, off = np.array(rows).T
    return times, off


def deviation(seed: int, begin: float, end: float, **how: float) -> float:
    """Return the standard deviation of the lateral position in a window after the response, m."""
    times, off = offsets(seed, **how)
    return float(off[(times >= begin) & (times < end)].std(ddof=1))


def test_the_lateral_position_varies_as_in_an_on_road_test_once_settled_and_more_at_first() -> None:
    settled = [deviation(seed, 40.0, 100.0) for seed in range(20)]
    assert all(0.15 <= one <= 0.25 for one in settled)
    assert np.mean(settled) == pytest.approx(0.2, abs=0.01)
    windows = [np.mean([deviation(seed, t, t + 10.0) for seed in range(20)]) for t in (0.0, 20.0, 40.0, 60.0)]
    assert windows[0] > 1.3 * windows[2]
    assert windows[0] > windows[1] > windows[2]
    assert windows[3] == pytest.approx(windows[2], rel=0.15)


def test_how_steady_a_driver_is_can_be_set() -> None:
    steady = [deviation(seed, 40.0, 100.0, settled=0.1, first=0.1) for seed in range(10)]
    assert np.mean(steady) == pytest.approx(0.1, abs=0.01)
    late, early = (
        np.mean([deviation(seed, 20.0, 40.0, first=0.5, after=after) for seed in range(10)]) for after in (60.0, 10.0)
    )
    assert late > 1.3 * early


def cut_in(gap: float, speed: float, *, over: float = 3.0, numbers: dict[int, float] | None = None, full: bool) -> Run:
    """Return a run in which a car at 30 km/h begins to cut in from the left 3 s after the start, `gap` ahead.

    A driver drives by then. `full`: cars drive in both lanes beside, as fast as the ego and just behind it.
    """
    usual = {slots.K_DRIVER_TIME: 0.0, slots.K_NOISE: 60.0, slots.K_DURATION: 25.0, **(numbers or {})}
    draft = Draft(highway(), usual)
    draft.ego(lane=-2, s=100.0, speed=speed)
    car = draft.moving(-1, 105.0 + gap + 3.0 * (speed - SLOW_CAR), SLOW_CAR)
    draft.event(draft.maneuver(), draft.at_time(3.0), draft.lane_change(car, -1, over))
    if full:
        for side in (-1, -3):
            for s in (75.0, 85.0, 95.0):
                draft.moving(side, s, speed)
    return draft.start()


@pytest.mark.parametrize(
    "over", [pytest.param(2.0, marks=pytest.mark.slow), 3.0, pytest.param(4.0, marks=pytest.mark.slow)]
)
def test_a_slow_cut_in_is_avoided_if_there_is_room_to_pass(over: float) -> None:
    gaps = [65.0 + 30.0 * k / 9.0 for k in range(10)]
    at_100 = [cut_in(gap, 100.0 / 3.6, over=over, full=False).go().st.crashed[0] for gap in gaps]
    at_120 = [cut_in(gap, 120.0 / 3.6, over=over, full=False).go() for gap in gaps]
    assert at_100 == [0] * 10
    assert sum(run.st.crashed[0] for run in at_120) <= 3
    evaded = [run for run in at_120 if run.time_of(op.EVENT_EVADE) > 0.0 and run.st.crashed[0] == 0]
    assert evaded
    for run in evaded:
        assert run.st.lane[0] == -2
        assert run.st.x[0] > run.st.x[1] + 5.0


def test_with_full_adjacent_lanes_only_braking_is_left() -> None:
    speed = 120.0 / 3.6
    evaded = 0
    for gap in (68.0, 72.0, 76.0, 80.0):
        empty, full = (cut_in(gap, speed, full=full).go() for full in (False, True))
        evaded += empty.time_of(op.EVENT_EVADE) > 0.0
        assert full.time_of(op.EVENT_EVADE) == -1.0
        assert full.time_of(op.EVENT_BRAKE) > 0.0
        assert full.st.crashed[0] >= empty.st.crashed[0]
    assert evaded >= 2


def test_brakers_brake_and_strength_counts() -> None:
    speed = 120.0 / 3.6
    brakes = {slots.K_BRAKES: 1.0, slots.K_STEERS: 0.0}
    run = cut_in(80.0, speed, numbers=brakes, full=False).go()
    assert run.time_of(op.EVENT_EVADE) == -1.0
    hardest = []
    for strength in (4.0, 6.0):
        run = cut_in(95.0, 100.0 / 3.6, numbers={**brakes, slots.K_DRIVER_DECELERATION: strength}, full=False)
        least = 0.0
        while run.st.stop[0] == op.STOP_NONE and run.st.crashed[0] == 0:
            run.go(run.st.clock[0] + 0.05)
            least = min(least, run.st.a[0])
        hardest.append(-least)
    assert hardest == pytest.approx([4.0, 6.0], abs=0.1)


def test_a_driver_who_steers_and_brakes_slows_down_while_passing() -> None:
    speeds = []
    for steers in (1.0, 0.0):
        draft = Draft(highway(), {slots.K_DRIVER_TIME: 1.0, slots.K_STEERS: steers})
        draft.causes(op.CAUSE_PATH_BLOCKED)
        draft.ego(speed=14.0)
        draft.parked(250.0, turn=np.pi / 2)
        run = draft.start()
        while run.st.x[0] < 235.0 and run.st.stop[0] == op.STOP_NONE:
            run.go(run.st.clock[0] + 0.05)
        assert run.time_of(op.EVENT_EVADE) > 0.0
        speeds.append(run.st.v[0])
    assert speeds[1] < speeds[0] - 1.0


WORKS = """<scenarios version="1"><scenario name="works" map="motorway" duration="45" control_every="2">
<parameter name="speed" type="speed" default="20"/> <parameter name="beside" type="integer" default="0"/>
<ego speed="$speed"><start><lane road="1" lane="-2" s="100"/></start><forward_sensor range="300"/></ego>
<work_zone id="works" length="60" taper="30" across="3.75">
  <at><ahead_of entity="ego" distance="250" offset="-1.9"/></at></work_zone>
<for each="side" in="-1 1"><repeat id="row" count="$beside" as="k"><dynamic id="car" speed="$speed">
  <start><ahead_of entity="ego" distance="${150 - 16 * $k}" lanes="$side"/></start><follow time_gap="0.3"/>
</dynamic></repeat></for>
<takeover budget="6" minimum_risk="false"><cause kind="path_blocked"/><driver takeover_time="2"/>
<automation after="hold_speed"/></takeover></scenario></scenarios>"""


@pytest.mark.parametrize("speed", [12.0, 20.0, 30.0])
def test_a_closed_lane_is_passed_completely_in_the_adjacent_lane(speed: float, tmp_path: Path) -> None:
    recording, outcome = next(runs(compiled(tmp_path, WORKS, speed=speed), range(1, 2)))
    s = recording.s[:, 0]
    closed = (s > 100.0 + 250.0 + 15.0) & (s < 100.0 + 250.0 + 90.0)
    assert outcome.collision_with is None
    assert closed.any()
    assert -2 not in recording.lane[closed, 0]
    assert time_of(recording, "brake") == np.inf
    assert recording.lane[-1, 0] == -2
    assert recording.v[:, 0].min() > 0.9 * speed


def test_between_full_lanes_a_driver_stops_before_a_closed_lane_and_not_within_it(tmp_path: Path) -> None:
    recording, outcome = next(runs(compiled(tmp_path, WORKS, speed=20.0, beside=18), range(1, 2)))
    assert outcome.collision_with is None
    slowest = int(np.argmin(recording.v[:, 0]))
    assert recording.s[slowest, 0] < 100.0 + 250.0


@pytest.mark.parametrize(("beside", "passes"), [(-1, -3), (-3, -1)])
def test_an_object_between_the_ego_and_the_adjacent_lane_is_not_hit(beside: int, passes: int, tmp_path: Path) -> None:
    text = f"""<scenarios version="1"><scenario name="staggered" map="motorway" duration="20" control_every="2">
    <ego speed="20"><start><lane road="1" lane="-2" s="100"/></start></ego>
    <static id="before"><at><lane road="1" lane="{beside}" s="275"/></at></static>
    <static id="block"><at><lane road="1" lane="-2" s="305"/></at></static>
    <takeover minimum_risk="false"><cause kind="path_blocked"/><driver takeover_time="1.5"/>
    <automation after="hold_speed"/></takeover></scenario></scenarios>"""
    recording, outcome = next(runs(compiled(tmp_path, text), range(1, 2)))
    assert outcome.collision_with is None
    assert recording.lane[int(np.searchsorted(recording.s[:, 0], 305.0)), 0] == passes


@pytest.mark.parametrize("lane", [-1, -2, -3])
@pytest.mark.parametrize("speed", [8.0, 15.0, 25.0, 35.0])
def test_a_vehicle_that_comes_in_the_drivers_own_lane_is_evaded(speed: float, lane: int, tmp_path: Path) -> None:
    text = f"""<scenarios version="1"><scenario name="wrong_way" map="motorway" duration="30" control_every="2">
    <ego speed="33"><start><lane road="1" lane="{lane}" s="100"/></start>
    <forward_sensor kind="radar" range="300"/></ego>
    <dynamic id="ghost" speed="{speed}"><start><ahead_of entity="ego" distance="600" turn="180"/></start></dynamic>
    <takeover budget="5"><cause kind="path_blocked"/><driver takeover_time="1"/></takeover></scenario></scenarios>"""
    for recording, outcome in runs(compiled(tmp_path, text), range(1, 4)):
        assert time_of(recording, "evade") < np.inf
        assert (outcome.measures["minimum_distance"].value or 0.0) > 1.0
        assert recording.v[:, 0].min() > 0.0


@pytest.mark.parametrize("side", [-1, 1])
def test_wandering_keeps_the_drivers_clearance_from_what_stands_beside_the_lane(side: int, tmp_path: Path) -> None:
    place = side * (0.997 + 0.45 + 0.478 / 2.0)
    text = f"""<scenarios version="1"><scenario name="cones" map="motorway" duration="30" control_every="2">
    <ego speed="25"><start><spawn_point name="middle_lane"/></start></ego>
    <repeat id="row" count="60" as="k"><static id="cone" model="static.prop.constructioncone"><at>
      <ahead_of entity="ego" distance="${{100 + 8 * $k}}" offset="{place}"/></at></static></repeat>
    <when><time after="1"/><do><request/></do></when>
    <takeover minimum_risk="false"><cause kind="controller"/><driver takeover_time="1"/></takeover>
    </scenario></scenarios>"""
    for recording, outcome in runs(compiled(tmp_path, text), range(1, 11)):
        beside = (recording.s[:, 0] > 150.0) & (recording.s[:, 0] < 150.0 + 8 * 60)
        towards = side * recording.off[beside, 0]
        assert outcome.collision_with is None
        assert towards.max() < 0.45 - 0.2
        assert towards.min() < -0.1


@pytest.mark.parametrize("deceleration", [2.0, 4.0, 6.0])
def test_a_leader_that_stops_is_followed_to_its_standstill(deceleration: float, tmp_path: Path) -> None:
    text = """<scenarios version="1"><scenario name="leader" map="motorway" duration="30" control_every="2">
    <parameter name="over" type="time" default="5"/>
    <ego speed="25"><start><spawn_point name="middle_lane"/></start></ego>
    <dynamic id="lead" speed="25"><start><ahead_of entity="ego" distance="60"/></start>
      <when><time after="6"/><do><speed to="0" over_time="$over"/></do></when></dynamic>
    <when><time after="1"/><do><request/></do></when>
    <takeover minimum_risk="false"><cause kind="controller"/><driver takeover_time="2"/></takeover>
    </scenario></scenarios>"""
    recording, outcome = next(runs(compiled(tmp_path, text, over=25.0 / deceleration), range(1, 2)))
    until = row_at(recording, min(6.0 + 25.0 / deceleration + 4.0, float(recording.t[-1])))
    assert outcome.collision_with is None
    assert time_of(recording, "evade") > recording.t[until]
    assert recording.v[until, 0] < 4.0
    assert -recording.a[:, 0].min() == pytest.approx(deceleration, rel=0.3)
    assert (outcome.measures["minimum_lane_time_to_collision"].value or 0.0) > 1.5


@pytest.mark.parametrize("deceleration", [1.5, 4.0])
def test_a_brake_of_the_automation_is_no_braking_of_a_driver_who_does_not_want_it(
    deceleration: float, tmp_path: Path
) -> None:
    text = f"""<scenarios version="1"><scenario name="slows" map="motorway" duration="8" control_every="2">
    <ego speed="25"><start><spawn_point name="middle_lane"/></start></ego>
    <when><time after="1"/><do><request/></do></when>
    <takeover minimum_risk="false"><cause kind="controller"/><driver takeover_time="2"/>
    <automation after="slow_down" deceleration="{deceleration}"/></takeover></scenario></scenarios>"""
    recording, outcome = next(runs(compiled(tmp_path, text), range(1, 2)))
    answered = row_at(recording, time_of(recording, "response"))
    assert recording.brake[answered, 0] > 0.1
    assert not recording.brake[answered + 1 :, 0].any()
    assert outcome.measures["braking_time"].value is None
    assert outcome.measures["first_brake_time"].value is None


@pytest.mark.parametrize(("perception", "reaction"), [(0.4, 0.75), (0.2, 0.3)])
def test_a_new_risk_is_acted_on_after_perception_and_reaction(perception: float, reaction: float) -> None:
    numbers = {slots.K_PERCEPTION_TIME: perception, slots.K_REACTION_TIME: reaction}
    usual = {slots.K_DRIVER_TIME: 0.0, slots.K_NOISE: 60.0, slots.K_DURATION: 14.0, **numbers}
    draft = Draft(highway(), usual)
    draft.ego(lane=-2, s=50.0, speed=20.0)
    leader = draft.moving(-2, 95.0, 20.0)
    draft.event(draft.maneuver(), draft.at_time(6.0), draft.speed(leader, 5.0, 1.5))
    run = draft.start().go(6.0)
    called = braked = -1.0
    while braked < 0.0 and run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + 0.05)
        if called < 0.0 and run.st.noticed_at[leader] >= 0.0:
            called = run.st.noticed_at[leader]
        if run.st.a[0] < -1.0:
            braked = run.st.clock[0]
    assert called > 6.0
    assert perception + reaction <= braked - called + 1e-6 <= perception + reaction + 0.25


def response_to_what_stands_far_ahead(folder: Path, weather: str, sight: float) -> tuple[float, float]:
    """Return when a driver who drives at 30 m/s acts, s, and how far what stands in his lane is ahead then, m."""
    text = f"""<scenarios version="1"><scenario name="far" map="motorway" weather="{weather}" duration="25"
    control_every="2"><ego speed="30"><start><spawn_point name="middle_lane"/></start></ego>
    <static id="parked"><at><ahead_of entity="ego" distance="500"/></at></static>
    <when><time after="0.5"/><do><request/></do></when><takeover><cause kind="controller"/>
    <driver takeover_time="1"><driving sight="{sight}"/></driver></takeover></scenario></scenarios>"""
    recording, _ = next(runs(compiled(folder, text), range(1, 2)))
    acted = min(time_of(recording, "evade"), time_of(recording, "brake"))
    row = row_at(recording, acted)
    return acted, float(recording.x[row, 1] - recording.x[row, 0])


def test_a_driver_acts_on_a_standing_object_from_the_distance_of_sight_on(tmp_path: Path) -> None:
    for sight in (100.0, 200.0, 300.0):
        _, away = response_to_what_stands_far_ahead(tmp_path, "ClearNoon", sight)
        assert sight - 30.0 * (REACTION + 0.35) - 10.0 < abs(away) < sight


def test_weather_and_night_shorten_how_far_the_driver_sees(tmp_path: Path) -> None:
    days = ("ClearNoon", "HardRainNoon", "ClearNight")
    times = [response_to_what_stands_far_ahead(tmp_path, weather, 300.0)[0] for weather in days]
    assert times == sorted(times)
    assert times[-1] > times[0] + 3.0
    assert times[1] > times[0] + 1.0


def test_the_less_time_there_is_the_faster_an_evasion_and_all_the_less_is_left(tmp_path: Path) -> None:
    text = """<scenarios version="1"><scenario name="gap" map="motorway" duration="35" control_every="2">
    <parameter name="budget" type="time" default="5"/>
    <ego speed="33.3"><start><spawn_point name="middle_lane"/></start><forward_sensor range="750"/></ego>
    <static id="parked"><at><ahead_of entity="ego" distance="700"/></at></static>
    <takeover budget="$budget" minimum_risk="false"><driver takeover_time="1"/>
    <automation after="hold_speed"/></takeover></scenario></scenarios>"""
    lateral: list[float] = []
    least: list[float] = []
    for budget in (4.0, 5.0, 6.0, 8.0, 10.0, 20.0):
        outcomes = [outcome for _, outcome in runs(compiled(tmp_path, text, budget=budget), range(1, 9))]
        assert all(one.collision_with is None for one in outcomes)
        assert all((one.measures["final_speed"].value or 0.0) > 30.0 for one in outcomes)
        for medians, measure in ((lateral, "maximum_lateral_acceleration"), (least, "minimum_time_to_collision")):
            values = [one.measures[measure].value for one in outcomes]
            medians.append(float(np.median([np.nan if value is None else value for value in values])))
    assert lateral[0] > lateral[1] > max(lateral[2:])
    assert least[:-1] == sorted(least[:-1])
    assert least[-1] > 0.9 * least[-2]


def test_nothing_is_acted_on_at_once_however_soon_the_driver_answers() -> None:
    draft = Draft(highway(), {slots.K_DRIVER_TIME: 0.0, slots.K_BUDGET: 3.0})
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=14.0)
    draft.parked(250.0, turn=np.pi / 2)
    run = draft.start().go()
    acted = min(time for time in (run.time_of(op.EVENT_EVADE), run.time_of(op.EVENT_BRAKE)) if time > 0.0)
    assert acted - run.time_of(op.EVENT_RESPONSE) >= REACTION - 1e-6


def test_every_constant_has_a_source_or_is_called_chosen(repository: Path) -> None:
    engine = repository / "scenario_compiler" / "engine"
    source = re.compile(r"chosen|Chosen|UN R157|SUMO|Measured|deviation|\b(19|20)\d\d\b|m in 1 s")
    for name in ("answering", "driver", "foresight", "merging", "minimum_risk", "passing"):
        body = ast.parse((engine / "ego" / f"{name}.py").read_text(encoding="utf-8")).body
        for at, node in enumerate(body):
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant | ast.UnaryOp):
                label = ast.unparse(node.targets[0])
                if label.startswith("DRAW_"):
                    continue
                said = next((one for one in body[at:] if isinstance(one, ast.Expr)), None)
                assert said is not None, label
                assert source.search(ast.unparse(said)), f"{name}.{label}"


def test_a_driver_moves_into_the_lane_beside_only_where_it_is() -> None:
    """A car stands 10 m behind the start of a second lane: before that, a way past the car leaves the road."""
    after = '<successor elementType="road" elementId="2" contactPoint="start"/>'
    before = '<predecessor elementType="road" elementId="1" contactPoint="end"/>'
    one = road(1, 220.0, lane(-1, link='<successor id="-1"/>'), link=after)
    two = road(2, 800.0, lane(-1, link='<predecessor id="-1"/>'), lane(-2), x=220.0, link=before)
    draft = Draft(network_of(one, two), {slots.K_DRIVER_TIME: 2.0})
    draft.causes(op.CAUSE_PATH_BLOCKED)
    draft.ego(speed=14.0)
    draft.entity(op.MOTION_STATIC, draft.position(1, -1, 10.0), 0.0)
    run = draft.start()
    while run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + 0.05)
        assert run.st.on_road[0] == 1, run.st.x[0]
    assert run.time_of(op.EVENT_RESPONSE) > 0.0
    assert run.st.crashed[0] == 0
