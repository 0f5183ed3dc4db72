"""The speed in bends: v^2 = a / k for a lateral acceleration a and a curvature k, reached by comfortable braking."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from scenario_compiler import compile_scenario, load_network
from scenario_compiler.compiler import Overrides
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.ego.bends import acceleration_for_bends
from scenario_compiler.engine.motion.surroundings import COMFORT_SHARE, SETS_FRICTION
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.program import build_program
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.horizon import TYRES_HOLD
from scenario_compiler.vocabulary.sensors import Perception
from tests.engine.both import run_both
from tests.engine.make import Draft, Run, highway, lane, network_of, road

BEFORE, ALONG = 350.0, 200.0
"""Length of the straight before the bend, and of the bend, m."""

LATERAL, BRAKING = 2.5, 2.0
"""The law's numbers, m/s2: the defaults of `lane_detection`."""

PLAN_VIEW = """<geometry s="0" x="0" y="0" hdg="0" length="{before}"><line/></geometry>
<geometry s="{before}" x="{before}" y="0" hdg="0" length="{along}">{shape}</geometry>
<geometry s="{beyond}" x="{x}" y="{y}" hdg="{turned}" length="600"><line/></geometry>"""


def curve_text(radius: float, *, left: bool = True, spiral: bool = False) -> str:
    """Return a straight road with a bend, and then straight on.

    Args:
        radius: The bend's radius, m; in a spiral, that at its end.
        left: Whether it bends to the left.
        spiral: Whether its curvature grows from 0 on.
    """
    k = 1.0 / radius if left else -1.0 / radius
    turned = 0.5 * k * ALONG if spiral else k * ALONG
    view = PLAN_VIEW.format(
        before=BEFORE,
        along=ALONG,
        beyond=BEFORE + ALONG,
        shape=f'<spiral curvStart="0" curvEnd="{k!r}"/>' if spiral else f'<arc curvature="{k!r}"/>',
        x=BEFORE + math.sin(turned) / k,
        y=(1.0 - math.cos(turned)) / k,
        turned=turned,
    )
    text = road(1, BEFORE + ALONG + 600.0, lane(-1, "solid"), left=lane(1, "solid"))
    begin, end = text.index("<geometry"), text.index("</planView>")
    return text[:begin] + view + text[end:]


def curve(radius: float, *, left: bool = True, spiral: bool = False) -> Network:
    return network_of(curve_text(radius, left=left, spiral=spiral))


def middle(radius: float, *, left: bool = True, side: int = -1) -> float:
    """Return the radius of a lane's centre, m: half a lane of 3.5 m beside the reference line."""
    return radius + (1.75 if left == (side < 0) else -1.75)


def draft_on(network: Network, speed: float, s: float = 50.0, **numbers: float) -> Draft:
    draft = Draft(network, {slots.K_DURATION: 60.0, **{getattr(slots, name): value for name, value in numbers.items()}})
    draft.ego(speed=speed, s=s)
    return draft


def slippery(draft: Draft, friction: float) -> None:
    """Multiply the friction of the road by a factor from the start."""
    k = draft.run_action(ACTION["environment"], value=friction)
    draft.program.action_flags[k] = SETS_FRICTION
    draft.event(draft.maneuver(), draft.at_time(0.0), k)


def requested(draft: Draft, time: float) -> None:
    """Let the scenario request a takeover at a time."""
    draft.event(draft.maneuver(), draft.at_time(time), draft.run_action(ACTION["request"], op.CAUSE_SCHEDULED))


def rows_until(run: Run, s: float) -> list[tuple[float, float, float, float]]:
    """Return (s, speed, acceleration, offset) of the ego in every row up to a place."""
    rows = []
    while run.st.s[0] < s and run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + 0.05)
        rows.append((run.st.s[0], run.st.v[0], run.st.a[0], run.st.path_off[0]))
    return rows


@pytest.mark.parametrize("left", [True, False])
@pytest.mark.parametrize(("radius", "speed"), [(60.0, 25.0), (30.0, 14.0), (15.0, 14.0), (200.0, 33.0), (400.0, 40.0)])
def test_a_bend_is_driven_at_the_speed_of_the_law_in_the_lane_and_without_a_request(
    radius: float, speed: float, left: bool
) -> None:
    run = draft_on(curve(radius, left=left), speed).start()
    rows = rows_until(run, BEFORE + ALONG - 10.0)
    expected = math.sqrt(LATERAL * middle(radius, left=left))
    inside = [v for s, v, _, _ in rows if s > BEFORE + 30.0]
    assert min(inside) == pytest.approx(expected, rel=0.01)
    assert max(inside) == pytest.approx(expected, rel=0.01)
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * expected
    assert max(abs(off) for *_, off in rows) < 0.5
    assert run.time_of(op.EVENT_REQUEST) == -1.0


def polygon(radius: float, step: float, corners: int, straight: float = BEFORE) -> Network:
    """Return a road with a bend to the left that is drawn as straight lines of a length, m, with corners between."""
    x, y, s, heading, turned, views = 0.0, 0.0, 0.0, 0.0, step / radius, []
    for length in (straight, *[step] * (corners - 1), 600.0):
        views.append(
            f'<geometry s="{s!r}" x="{x!r}" y="{y!r}" hdg="{heading!r}" length="{length!r}"><line/></geometry>'
        )
        x, y, s = x + length * math.cos(heading), y + length * math.sin(heading), s + length
        heading += turned
    text = road(1, s, lane(-1, "solid"), left=lane(1, "solid"))
    return network_of(text[: text.index("<geometry")] + "".join(views) + text[text.index("</planView>") :])


@pytest.mark.parametrize(("radius", "step"), [(60.0, 2.0), (60.0, 5.0), (30.0, 4.0), (16.0, 4.5)])
def test_a_bend_drawn_with_corners_is_driven_like_the_arc_through_them(radius: float, step: float) -> None:
    corners = round(ALONG / step) if radius > 20.0 else 10
    run = draft_on(polygon(radius, step, corners), 14.0, BEFORE - 80.0).start()
    rows = rows_until(run, BEFORE + step * corners - 15.0)
    inside = [v for s, v, _, _ in rows if s > BEFORE + 15.0]
    expected = math.sqrt(LATERAL * middle(radius))
    assert min(inside) > 0.75 * expected
    assert max(inside) < 1.15 * expected
    assert max(abs(off) for *_, off in rows) < 0.75
    assert run.time_of(op.EVENT_REQUEST) == -1.0


@pytest.mark.parametrize(("turned", "slows"), [(0.005, False), (0.05, False), (0.3, True)])
def test_a_single_corner_slows_the_car_only_if_it_cannot_be_cut(turned: float, slows: bool) -> None:
    run = draft_on(polygon(1.0 / turned, 1.0, 1), 25.0, BEFORE - 200.0).start()
    rows = rows_until(run, BEFORE + 5.0)
    slowest = min(v for _, v, _, _ in rows)
    assert slowest == pytest.approx(math.sqrt(LATERAL * 8.0 / turned) if slows else 25.0, rel=0.1)


JOINED = """<road id="{id}" length="{length}" junction="-1"><link>{link}</link>
<planView><geometry s="0" x="{x}" y="{y}" hdg="{hdg}" length="{length}"><line/></geometry></planView>
<lanes><laneSection s="0"><left>{left}</left><center><lane id="0" type="none" level="false"/></center>
<right>{right}</right></laneSection></lanes></road>"""


def joined(turned: float, *, against: bool = False, between: float = 0.0) -> Network:
    """Return two straight roads that meet with an angle.

    Args:
        turned: Heading of the second road, rad.
        against: Whether the second road is drawn towards the joint, so that the car leaves it at its start.
        between: Length of a third road between them, with their mean heading, m.
    """
    at = (BEFORE + between * math.cos(0.5 * turned), between * math.sin(0.5 * turned))
    far = (at[0] + 600.0 * math.cos(turned), at[1] + 600.0 * math.sin(turned))
    second, contact = ("2", "end" if against else "start")
    end = '<successor elementType="road" elementId="{}" contactPoint="{}"/>'
    begin = end.replace("successor", "predecessor")
    onward = lane(-1, "solid", link=f'<successor id="{1 if against and not between else -1}"/>')
    middle = lane(-1, "solid", link=f'<predecessor id="-1"/><successor id="{1 if against else -1}"/>')
    first = JOINED.format(
        id=1,
        length=BEFORE,
        x=0.0,
        y=0.0,
        hdg=0.0,
        left="",
        right=onward,
        link=end.format("3", "start") if between else end.format(second, contact),
    )
    third = JOINED.format(
        id=3,
        length=between,
        x=BEFORE,
        y=0.0,
        hdg=0.5 * turned,
        left="",
        right=middle,
        link=begin.format("1", "end") + end.format(second, contact),
    )
    last = JOINED.format(
        id=2,
        length=600.0,
        x=far[0] if against else at[0],
        y=far[1] if against else at[1],
        hdg=turned + math.pi if against else turned,
        left=lane(1, "solid", link='<successor id="-1"/>') if against else "",
        right="" if against else lane(-1, "solid", link='<predecessor id="-1"/>'),
        link=(end if against else begin).format("3" if between else "1", "end"),
    )
    return network_of(first, *([third] if between else []), last)


@pytest.mark.parametrize(("turned", "slows"), [(0.005, False), (0.05, False), (0.3, True), (-0.3, True)])
@pytest.mark.parametrize("against", [False, True])
@pytest.mark.parametrize("between", [0.0, 1.5])
def test_a_corner_at_the_joint_of_two_roads_slows_the_car_like_one_within_a_road(
    turned: float, slows: bool, against: bool, between: float
) -> None:
    run = draft_on(joined(turned, against=against, between=between), 25.0, BEFORE - 200.0).start()
    while run.st.path_road[0] == 0:
        run.go(run.st.clock[0] + 0.05)
    assert run.st.path_s[0] == pytest.approx(600.0 if against and not between else 0.0, abs=2.0)
    assert run.st.v[0] == pytest.approx(math.sqrt(LATERAL * 8.0 / abs(turned)) if slows else 25.0, rel=0.12)
    assert run.time_of(op.EVENT_REQUEST) == -1.0


def test_a_ring_of_one_road_has_the_same_corner_at_its_joint_as_within_it() -> None:
    sides = "".join(
        f'<geometry s="{100 * k}" x="{x}" y="{y}" hdg="{0.5 * math.pi * k!r}" length="100"><line/></geometry>'
        for k, (x, y) in enumerate([(0, 0), (100, 0), (100, 100), (0, 100)])
    )
    link = '<{} elementType="road" elementId="1" contactPoint="{}"/>'
    lanes = lane(-1, "solid", link='<predecessor id="-1"/><successor id="-1"/>')
    text = road(1, 400.0, lanes, link=link.format("predecessor", "end") + link.format("successor", "start"))
    ring = network_of(text[: text.index("<geometry")] + sides + text[text.index("</planView>") :])
    slowest = [min(v for _, v, _, _ in rows_until(draft_on(ring, 10.0, s).start(), s + 29.0)) for s in (71.0, 270.5)]
    run = draft_on(ring, 10.0, 370.5).start()
    across_joint = [run.go(0.05 * k).st.v[0] for k in range(200)]
    assert slowest == pytest.approx([min(across_joint)] * 2, rel=0.02)


def test_a_corner_at_a_joint_is_the_same_in_both_forms() -> None:
    draft = draft_on(joined(0.3), 25.0, BEFORE - 200.0)
    program = draft.done()
    both = run_both(draft.network.tables, program, [list(program.const)], [make_draws(1)], 400)
    assert both.interpreted == both.compiled


@pytest.mark.parametrize(("radius", "speed"), [(60.0, 25.0), (200.0, 33.0), (400.0, 40.0)])
def test_before_a_bend_the_car_brakes_comfortably_however_fast_it_is(radius: float, speed: float) -> None:
    rows = rows_until(draft_on(curve(radius), speed).start(), BEFORE + ALONG)
    assert min(a for _, _, a, _ in rows) > -1.5 * BRAKING
    distance = (speed**2 - LATERAL * middle(radius)) / (2.0 * BRAKING)
    begins = next(s for s, v, _, _ in rows if v < speed - 0.1)
    assert begins == pytest.approx(BEFORE - distance, abs=2.0 * speed)


CURVE = """<scenarios version="1"><scenario name="curve" map="curve.xodr" duration="40">
  <ego speed="{speed}"><start><lane road="1" lane="-1" s="50"/></start>{controller}</ego>
  <takeover><cause kind="path_blocked"/></takeover>
</scenario></scenarios>"""


def compiled_in(folder: Path, perception: Perception, radius: float, speed: float, controller: str = "") -> Simulation:
    """Return a run from 300 m before a bend, which the scenario language describes."""
    header = '<header revMajor="1" revMinor="4" name="" version="1" date="2026"/>'
    (folder / "curve.xodr").write_text(f"<OpenDRIVE>{header}{curve_text(radius)}</OpenDRIVE>", encoding="utf-8")
    path = folder / "curve.xml"
    path.write_text(CURVE.format(speed=speed, controller=controller), encoding="utf-8")
    plan = compile_scenario(path, overrides=Overrides(perception=perception))
    network = load_network(plan.map.file)
    simulation = Simulation(network.tables, build_program(plan, network))
    simulation.reset(make_draws(1))
    return simulation


@pytest.mark.parametrize("perception", ["ideal", "surrogate"])
@pytest.mark.parametrize(("radius", "speed"), [(60.0, 25.0), (35.0, 20.0), (200.0, 33.0)])
def test_every_perception_brakes_comfortably_before_a_bend(
    tmp_path: Path, perception: Perception, radius: float, speed: float
) -> None:
    """Surrogate perception, like the camera's controller, knew only 36 m of its route, and braked with up to 8 m/s2."""
    run = compiled_in(tmp_path, perception, radius, speed)
    st, hardest, inside = run.state, 0.0, []
    while run.step() and st.s[0] < BEFORE + 60.0:
        hardest = min(hardest, st.a[0])
        if st.s[0] >= BEFORE:
            inside.append(st.v[0])
    assert hardest > -1.75 * BRAKING
    assert max(inside) < 1.05 * math.sqrt(LATERAL * middle(radius))


@pytest.mark.parametrize(
    ("controller", "lateral", "braking"),
    [
        ("", LATERAL, BRAKING),
        ('<controller><property name="lateral_acceleration" value="1.5"/></controller>', 1.5, BRAKING),
        (
            '<controller model="mine.py:Mine"><property name="following_deceleration" value="1"/>'
            '<property name="lateral_acceleration" value="much"/></controller>',
            LATERAL,
            1.0,
        ),
    ],
)
def test_a_controller_is_given_the_speed_for_the_bends_of_its_route(
    tmp_path: Path, controller: str, lateral: float, braking: float
) -> None:
    run = compiled_in(tmp_path, "camera", 60.0, 25.0, controller)
    distance = BEFORE - run.state.s[0] - 4.0
    in_bend = lateral * middle(60.0)
    assert run.look_out().bend_speed == pytest.approx(math.sqrt(in_bend + 2.0 * braking * distance), rel=0.02)


def test_without_a_bend_a_controller_is_given_no_speed_for_bends(tmp_path: Path) -> None:
    assert compiled_in(tmp_path, "camera", 1.0e6, 25.0).look_out().bend_speed == op.FAR


def test_after_the_bend_the_car_takes_up_its_speed_again() -> None:
    rows = rows_until(draft_on(curve(60.0), 20.0).start(), BEFORE + ALONG + 350.0)
    assert rows[-1][1] == pytest.approx(20.0, abs=1.0)


def test_a_bend_that_the_speed_fits_changes_nothing() -> None:
    rows = rows_until(draft_on(curve(60.0), 12.0).start(), BEFORE + ALONG)
    assert {v for _, v, _, _ in rows} == {12.0}


def test_a_car_that_meets_a_bend_too_fast_brakes_hard() -> None:
    rows = rows_until(draft_on(curve(60.0), 25.0, s=BEFORE - 60.0).start(), BEFORE + ALONG)
    assert min(a for _, _, a, _ in rows) < -2.0 * BRAKING
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(LATERAL * middle(60.0))


def test_the_lane_against_s_has_its_own_radius() -> None:
    draft = Draft(curve(60.0), {slots.K_DURATION: 60.0})
    draft.entity(op.MOTION_BICYCLE, draft.position(0, 1, 1000.0), 20.0)
    run = draft.start()
    slowest = 20.0
    while run.st.s[0] > BEFORE:
        run.go(run.st.clock[0] + 0.05)
        slowest = min(slowest, run.st.v[0])
    assert slowest == pytest.approx(math.sqrt(LATERAL * middle(60.0, side=1)), rel=0.01)


def test_the_parameters_of_lane_detection_hold() -> None:
    rows = rows_until(draft_on(curve(60.0), 20.0, K_LATERAL=1.5, K_DECELERATION=1.0).start(), BEFORE + ALONG)
    inside = [v for s, v, _, _ in rows if BEFORE + 30.0 < s < BEFORE + ALONG - 10.0]
    assert max(inside) == pytest.approx(math.sqrt(1.5 * middle(60.0)), rel=0.01)
    assert min(a for _, _, a, _ in rows) > -1.7


def test_a_spiral_is_driven_faster_where_it_bends_less() -> None:
    """The curvature grows from 0 to 1 / 60 m along the bend."""
    rows = rows_until(draft_on(curve(60.0, spiral=True), 25.0).start(), BEFORE + ALONG - 10.0)
    for s, v, _, off in rows:
        k = max(s - BEFORE, 0.0) / ALONG / 60.0
        assert v * v * k / (1.0 + 1.75 * k) < 1.1 * LATERAL
        assert abs(off) < 0.5
    assert rows[-1][1] == pytest.approx(math.sqrt(LATERAL * middle(60.0)), rel=0.05)


def test_a_curve_given_as_polynomials_is_a_bend_too() -> None:
    """A polynomial of u^2 / 120 has the radius 60 m where it begins, and bends less later."""
    run = draft_on(
        network_of(road(1, 200.0, lane(-1), shape=f'<poly3 a="0" b="0" c="{1.0 / 120.0!r}" d="0"/>')), 12.0, s=5.0
    )
    rows = rows_until(run.start(), 150.0)
    assert rows[0][2] < 0.0 or rows[0][1] < 12.1
    assert max(abs(off) for *_, off in rows) < 0.5


@pytest.mark.parametrize("reference", [op.REFERENCE_NONE, op.REFERENCE_CAREFUL, op.REFERENCE_RSS, op.REFERENCE_FUZZY])
def test_a_driver_who_has_taken_over_slows_down_for_a_bend(reference: int) -> None:
    draft = draft_on(curve(60.0), 25.0, K_DRIVER_TIME=0.5)
    draft.program.driver_reference[0] = reference
    requested(draft, 0.5)
    run = draft.start()
    rows = rows_until(run, BEFORE + ALONG - 10.0)
    assert run.time_of(op.EVENT_RESPONSE) > 0.0
    assert run.st.takeover_state[0] == op.TAKEOVER_MANUAL
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(LATERAL * middle(60.0))
    assert max(abs(off) for *_, off in rows) < 0.85
    assert run.st.on_road[0] == 1


def test_a_reference_driver_in_place_of_the_automation_slows_down_for_a_bend() -> None:
    draft = draft_on(curve(60.0), 25.0)
    draft.program.replaced_by[0] = op.REFERENCE_CAREFUL
    rows = rows_until(draft.start(), BEFORE + ALONG - 10.0)
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(LATERAL * middle(60.0))


def test_a_gentle_minimum_risk_manoeuvre_does_not_enter_a_bend_too_fast() -> None:
    draft = draft_on(curve(60.0), 25.0, s=150.0, K_DRIVER_TIME=1.0e6, K_MINIMUM_RISK_DECELERATION=0.5)
    for cause in range(op.CAUSES):
        draft.program.const[slots.K_RISK_AFTER + cause] = 0.5
    requested(draft, 0.5)
    run = draft.start()
    rows = rows_until(run, BEFORE + 100.0)
    assert run.time_of(op.EVENT_MINIMUM_RISK) > 0.0
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(LATERAL * middle(60.0))


def test_after_the_hand_back_the_automation_slows_down_for_a_bend() -> None:
    draft = draft_on(curve(60.0), 25.0, K_DRIVER_TIME=0.5, K_HAND_BACK_AFTER=2.0)
    requested(draft, 0.2)
    run = draft.start()
    rows = rows_until(run, BEFORE + ALONG - 10.0)
    assert 0.0 < run.time_of(op.EVENT_HAND_BACK) < BEFORE / 25.0
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(LATERAL * middle(60.0))


def test_who_brakes_more_gently_searches_again_and_begins_earlier() -> None:
    """250 m before the bend a driver who brakes by 2 m/s2 is free; an automation with 0.2 m/s2 must already brake."""
    run = draft_on(curve(60.0), 17.0, s=BEFORE - 250.0).start().go(0.05)
    for _ in range(2):
        assert acceleration_for_bends(run.n, run.p, run.st, 0, LATERAL, 2.0) > 10.0
        assert acceleration_for_bends(run.n, run.p, run.st, 0, LATERAL, 0.2) < 0.0


def test_on_a_straight_road_bends_are_searched_seldom() -> None:
    """Not in the first 500 m of 2000 m, of which the car must know 160 m at 25 m/s."""
    run = draft_on(highway(), 25.0).start()
    looks = set()
    while run.st.s[0] < 550.0:
        run.go(run.st.clock[0] + 0.05)
        looks.add(run.st.slow_until[0])
    assert len(looks) <= 3


def test_a_car_that_has_become_faster_on_a_straight_sees_the_bend_in_time() -> None:
    """The road was searched at 5 m/s, when only 6 m were of interest."""
    draft = draft_on(curve(30.0), 5.0)
    draft.event(draft.maneuver(), draft.at_time(0.5), draft.speed(0, 25.0, 0.1))
    rows = rows_until(draft.start(), BEFORE + ALONG - 10.0)
    assert max(v for _, v, _, _ in rows) > 15.0
    assert min(a for _, _, a, _ in rows) > -1.5 * BRAKING
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(LATERAL * middle(30.0))


@pytest.mark.parametrize("friction", [0.8, 0.4, 0.2])
@pytest.mark.parametrize("driven_by", ["automation", "driver", "reference", "minimum risk"])
def test_a_bend_of_a_slippery_road_is_driven_with_half_of_what_the_tyres_hold(driven_by: str, friction: float) -> None:
    """Before, at a friction of 0.2, where the tyres hold 1.7 m/s2, 2.5 m/s2 were aimed for, and the lane was left."""
    draft = draft_on(curve(60.0), 17.0, s=20.0, K_DRIVER_TIME=0.5 if driven_by == "driver" else 1.0e6)
    slippery(draft, friction)
    if driven_by == "reference":
        draft.program.replaced_by[0] = op.REFERENCE_CAREFUL
    if driven_by in ("driver", "minimum risk"):
        requested(draft, 0.5)
    if driven_by == "minimum risk":
        draft.program.const[slots.K_MINIMUM_RISK_DECELERATION] = 0.3
        for cause in range(op.CAUSES):
            draft.program.const[slots.K_RISK_AFTER + cause] = 0.5
    run = draft.start()
    rows = rows_until(run, BEFORE + 60.0)
    held = min(LATERAL, COMFORT_SHARE * TYRES_HOLD * friction)
    assert max(v for s, v, _, _ in rows if s >= BEFORE) < 1.05 * math.sqrt(held * middle(60.0))
    assert min(a for s, _, a, _ in rows if s < BEFORE - 20.0) > -1.6 * min(BRAKING, COMFORT_SHARE * 8.0 * friction)
    assert max(abs(off) for *_, off in rows) < 0.85


def test_a_lateral_acceleration_above_the_share_stays_what_the_scenario_says_on_a_dry_road() -> None:
    run = draft_on(curve(60.0), 25.0, K_LATERAL=6.0).start()
    rows = rows_until(run, BEFORE + ALONG - 10.0)
    assert max(v for s, v, _, _ in rows if s > BEFORE + 30.0) == pytest.approx(math.sqrt(6.0 * middle(60.0)), rel=0.01)


@pytest.mark.parametrize("friction", [1.0, 0.3, 0.0])
@pytest.mark.parametrize("radius", [15.0, 60.0, 400.0])
@pytest.mark.parametrize("answers", [0.5, 1.0e6])
def test_both_forms_drive_a_bend_equally(radius: float, answers: float, friction: float) -> None:
    draft = draft_on(curve(radius), 30.0, K_DRIVER_TIME=answers, K_DURATION=20.0)
    slippery(draft, friction)
    requested(draft, 5.0)
    program = draft.done()
    both = run_both(draft.network.tables, program, [list(program.const)], [make_draws(1)], 400)
    assert both.interpreted == both.compiled


TURNS = """<scenarios version="1"><scenario name="turns" map="town_grid" weather="ClearNoon" duration="60">
  <ego speed="13.9">
    <start><lane road="{begin}" lane="-1" s="30"/></start>
    <destination><lane road="{end}" lane="-1" s="30"/></destination>
    <controller><property name="lateral_acceleration" value="{lateral}"/></controller>
  </ego>
  <takeover><cause kind="path_blocked"/></takeover>
</scenario></scenarios>"""


@pytest.mark.parametrize("lateral", [1.5, 2.5])
@pytest.mark.parametrize(("begin", "end"), [("1", "10"), ("4", "1"), ("7", "11")])
def test_turns_at_junctions_are_driven_at_the_lateral_acceleration_of_the_scenario(
    tmp_path: Path, begin: str, end: str, lateral: float
) -> None:
    path = tmp_path / "turns.xml"
    path.write_text(TURNS.format(begin=begin, end=end, lateral=lateral), encoding="utf-8")
    plan = compile_scenario(path, overrides=Overrides(perception="ideal"))
    network = load_network(plan.map.file)
    simulation = Simulation(network.tables, build_program(plan, network))
    simulation.reset(make_draws(1))
    greatest, slowest, st = 0.0, 13.9, simulation.state
    while simulation.step():
        bend = math.tan(st.steer[0]) / simulation.program.const[simulation.program.entity_const[0] + slots.E_WHEELBASE]
        greatest = max(greatest, st.v[0] ** 2 * abs(bend))
        slowest = min(slowest, st.v[0])
        assert st.on_road[0] == 1
    assert slowest < 9.0
    assert greatest < 1.4 * lateral
