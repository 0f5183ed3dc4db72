"""The interpreted and the compiled engine leave the same bytes, over programs that reach every code and branch."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.columns.trace import trace_width
from scenario_compiler.engine.moves.table import NUMBERS as ACTION
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.engine.story.of_run import FIRST_TRANSITION
from scenario_compiler.engine.story.table import CONDITIONS
from scenario_compiler.engine.story.table import NUMBERS as CONDITION
from scenario_compiler.randomness import uniform
from tests.engine.both import run_both
from tests.engine.make import Draft, bend, highway, lane, network_of, ramp, road

PROGRAMS = 40
VARIANTS = 3
STEPS = 350

WORLD_ACTIONS = tuple(
    ACTION[word]
    for word in (
        *("set_variable", "modify_variable", "traffic_signal_state", "traffic_signal_phase", "environment"),
        *("light", "animation", "command", "activate_controller", "assign_controller", "override_controller"),
        "stop_traffic",
    )
)
CAMERA_ACTIONS = tuple(ACTION[word] for word in ("failure", "end_failure", "weather", "message", "stop"))
REACHED_ACTIONS = {ACTION["speed"], ACTION["lane_change"], ACTION["sensor_noise"], *CAMERA_ACTIONS, *WORLD_ACTIONS}
"""Actions of these programs; the files of words in this folder hold the others."""

STORY_CONDITIONS = (
    *(CONDITION["time"], CONDITION["time_gap"], CONDITION["distance"], CONDITION["time_to_collision"]),
    *(CONDITION["speed"], CONDITION["reached"], CONDITION["traveled"], CONDITION["lane_confidence"]),
    *(CONDITION["takeover_state"], CONDITION["relative_speed"], CONDITION["event"]),
)
"""Conditions of `add_story`; the last watches an event."""

WORLD_CONDITIONS = (
    *(CONDITION["relative_speed"], CONDITION["distance_to_position"], CONDITION["signal_phase"]),
    *(CONDITION["acceleration"], CONDITION["collision"], CONDITION["off_road"], CONDITION["end_of_road"]),
    *(CONDITION["clearance"], CONDITION["angle"], CONDITION["relative_angle"], CONDITION["element_state"]),
    *(CONDITION["time_of_day"], CONDITION["variable"], CONDITION["user_defined_value"], CONDITION["traffic_signal"]),
)
"""Conditions of `add_world_story`."""


class Dice:
    """Draws that depend on the program's number alone."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.count = 0

    def unit(self) -> float:
        """Return a number in (0, 1)."""
        self.count += 1
        return uniform(7, self.number, f"test/{self.count}")

    def between(self, low: float, high: float) -> float:
        """Return a number between two."""
        return low + (high - low) * self.unit()

    def pick(self, *choices: int) -> int:
        """Return one of the choices."""
        return choices[int(self.unit() * len(choices))]


def random_draft(number: int) -> Draft:
    """Return a program of its own kind for each number."""
    dice = Dice(number)
    maps = (
        highway(),
        bend(150.0),
        ramp(),
        network_of(road(1, 2000.0, lane(-1, "solid"), left=lane(1, "solid"))),
        highway(120.0),
    )
    draft = Draft(maps[number % len(maps)])
    p = draft.program
    for slot, low, high in (
        (slots.K_DURATION, 5.0, 25.0),
        (slots.K_NOISE, 0.0, 60.0),
        (slots.K_DRIVER_TIME, 0.0, 14.0),
        (slots.K_BUDGET, 2.0, 9.0),
        (slots.K_SENSOR_RANGE, 20.0, 160.0),
        (slots.K_FIELD_OF_VIEW, 0.2, 6.0),
        (slots.K_HAND_BACK_AFTER, -1.0, 3.0),
        (slots.K_DRIVER_SIGMA, 0.0, 0.5),
        (slots.K_DRIVER_LAPSE, -0.5, 0.5),
    ):
        p.const[slot] = dice.between(low, high)
    p.driver_kind[0] = dice.pick(op.DRIVER_FIXED, op.DRIVER_LOGNORMAL)
    p.perception[0] = dice.pick(op.PERCEPTION_IDEAL, op.PERCEPTION_IDEAL, op.PERCEPTION_CAMERA)
    p.control_every[0] = dice.pick(1, 2, 3)
    right = [-1] if number % 5 in (1, 3) else [-2] if number % 10 == 2 else [-1, -2]
    motion = dice.pick(op.MOTION_BICYCLE, op.MOTION_BICYCLE, op.MOTION_BICYCLE, op.MOTION_SCRIPTED, op.MOTION_POSED)
    draft.entity(motion, draft.position(0, dice.pick(*right), 30.0), dice.between(0.0, 25.0))
    alone = number % 10 in (2, 5)
    if alone:
        draft.parked(900.0)
    if number % 10 == 2:
        p.cause_on, p.cause_order, p.cause_count = [0, 0, 0, 0, 0, 1, 0, 0], [op.CAUSE_LANE_ENDS], [1]
    for _ in range(0 if alone else dice.pick(1, 2, 5)):
        add_other(draft, dice, right)
    p.stretch_road, p.stretch_count, p.stretch_lane = [0], [1], [(op.ALL_MARKS, op.ALL_MARKS, -1)[number % 3]]
    covered = 0.2 * (number % 2)
    p.stretch_const = [
        draft.block(dice.between(0.0, 150.0), dice.between(100.0, 300.0), dice.unit(), dice.unit(), covered)
    ]
    if number % 10 == 5:
        fade(draft, answer=number % 20 == 5)
    elif dice.unit() < 0.5:
        p.destination_road[0], p.destination_lane[0] = 0, -1
        p.const[slots.K_DESTINATION_S] = dice.between(60.0, 400.0)
    add_story(draft, dice)
    add_camera_story(draft, Dice(number + PROGRAMS))
    add_world_story(draft, Dice(number + 2 * PROGRAMS))
    for slot, low, high in (
        (slots.K_DRIVER_MU, 0.0, 1.0),
        (slots.K_BRAKES, 0.0, 0.5),
        (slots.K_STEERS, 0.0, 1.0),
        (slots.K_DRIVER_DECELERATION, 3.0, 8.0),
        (slots.K_DRIVER_LATERAL, 2.0, 6.0),
        (slots.K_SIGHT, 20.0, 400.0),
        (slots.K_REACTION_TIME, 0.0, 1.0),
        (slots.K_SDLP, 0.0, 0.3),
        (slots.K_SDLP_AT_FIRST, 0.0, 0.5),
        (slots.K_SETTLED_AFTER, 0.0, 40.0),
        (slots.K_DRIVER_PERSON, 0.0, 1.0),
        (slots.K_DRIVER_LATE, -0.5, 0.5),
        (slots.K_DRIVER_LATEST, 0.0, 12.0),
        (slots.K_EYES_ON, 0.05, 0.9),
        (slots.K_HANDS_ON, 0.05, 0.9),
        (slots.K_STAGE_SPREAD, 0.0, 1.0),
        (slots.K_EFFECT_REQUEST, -2.0, 2.0),
        (slots.K_EFFECT_REPETITION, -2.0, 0.0),
        (slots.K_EFFECT_BUDGET, -0.5, 0.5),
        (slots.K_REFERENCE_BUDGET, -5.0, 10.0),
        (slots.K_INPUT_STEERING, 0.0, 0.1),
        (slots.K_INPUT_BRAKE, 0.0, 0.3),
        (slots.K_STEERING_RATIO, 8.0, 20.0),
    ):
        p.const[slot] = dice.between(low, high)
    p.const[slots.K_LOOK_BESIDE] = 0.5 * (number % 5)
    if p.driver_kind[0] == op.DRIVER_LOGNORMAL:
        p.driver_kind[0] = dice.pick(op.DRIVER_LOGNORMAL, op.DRIVER_NORMAL, op.DRIVER_SUMO)
    return draft


def fade(draft: Draft, *, answer: bool) -> None:
    """Let the marks fail over a short stretch; the driver answers soon and hands back, or the automation stops."""
    p = draft.program
    stretch = p.stretch_const[0]
    p.const[stretch + slots.M_FROM : stretch + slots.M_COVERAGE + 1] = [60.0, 110.0, 0.0, 0.0, 0.0]
    p.stretch_lane[0] = op.ALL_MARKS
    p.const[slots.K_NOISE], p.const[slots.K_HAND_BACK_AFTER] = 0.0, 1.0
    p.const[slots.K_DRIVER_TIME] = 0.5 if answer else 60.0
    p.const[slots.K_RISK_AFTER + op.CAUSE_LANE_CONFIDENCE] = 10.0 if answer else 0.2
    p.const[p.entity_const[0] + slots.E_SPEED] = p.const[p.entity_const[0] + slots.E_DESIRED_SPEED] = 15.0
    p.driver_kind, p.perception, p.entity_motion[0] = [op.DRIVER_FIXED], [op.PERCEPTION_IDEAL], op.MOTION_BICYCLE
    p.ego[0] = 0
    draft.causes(op.CAUSE_LANE_CONFIDENCE)


def add_other(draft: Draft, dice: Dice, right: list[int]) -> None:
    """Append a standing, following, plain or oncoming vehicle."""
    kind = dice.pick(0, 1, 2, 3)
    s, side = dice.between(0.0, 110.0), dice.pick(*right)
    if kind == 0:
        draft.parked(s, side, dice.between(-2.0, 2.0), dice.between(0.0, 3.0))
    elif kind == 3 and draft.network.road("1").sections[0][1][0] == 1:
        draft.moving(1, s, dice.between(2.0, 15.0))
    elif kind == 2:
        at = draft.ahead_of(0, dice.between(5.0, 60.0), 0, dice.between(-1.0, 1.0), dice.between(-0.2, 0.2))
        draft.entity(op.MOTION_SCRIPTED, at, dice.between(0.0, 15.0))
    else:
        draft.moving(side, s, dice.between(0.0, 20.0), follows=dice.unit() < 0.5)


def add_story(draft: Draft, dice: Dice) -> None:
    """Append events over all kinds of conditions and actions."""
    p = draft.program
    maneuver = draft.maneuver(limit=dice.pick(1, 2), stop=draft.at_time(dice.between(8.0, 30.0)))
    before: list[int] = []
    for _ in range(dice.pick(2, 4, 6)):
        for _ in range(dice.pick(1, 2)):
            add_condition(draft, dice, before)
            if dice.unit() < 0.3:
                draft.close_group()
        actions = [add_action(draft, dice) for _ in range(dice.pick(1, 1, 2))]
        before.append(
            draft.event(
                maneuver,
                draft.trigger(),
                *actions,
                priority=dice.pick(op.PRIORITY_PARALLEL, op.PRIORITY_OVERRIDE, op.PRIORITY_SKIP),
                limit=dice.pick(1, 1, 3),
            )
        )
    if dice.unit() < 0.2:
        p.stop_trigger[0] = draft.at_time(6.0)
    if dice.unit() < 0.5:
        p.init_action, p.init_count = [draft.speed(dice.pick(0, 1), dice.between(0.0, 20.0), 3.0)], [1]


def add_camera_story(draft: Draft, dice: Dice) -> None:
    """Append failures of the camera, weather, and events on what the automation sees."""
    for _ in range(2):
        kind = dice.pick(*range(op.FAILURES))
        draft.failure(kind, dice.between(0.0, 9.0), dice.between(-1.0, 6.0), dice.between(-0.5, 2.0), dice.unit())
    weathers = [draft.weather(*(dice.between(-1.0, 100.0) for _ in range(op.WEATHER_SIZE))) for _ in range(2)]
    waiting = draft.failure(dice.pick(*range(op.FAILURES)), 0.5, 3.0, 1.0, dice.between(0.2, 1.0), waits=True)
    actions = [
        draft.run_action(ACTION["failure"], waiting),
        draft.run_action(ACTION["weather"], dice.pick(*weathers), dice.between(-1.0, 5.0)),
        draft.run_action(ACTION["message"], 0),
        draft.run_action(ACTION["end_failure"], dice.pick(op.NONE, *range(op.FAILURES))),
    ]
    if dice.unit() < 0.1:
        actions.append(draft.run_action(ACTION["stop"]))
    maneuver = draft.maneuver()
    before = draft.event(maneuver, draft.at_time(dice.between(1.0, 6.0)), actions[0], actions[1])
    for action in actions[2:]:
        kind = dice.pick(CONDITION["standstill"], CONDITION["sensor_health"], CONDITION["lane_confidence"])
        other = dice.pick(*range(op.SIDE_BOTH, op.SIDE_EITHER + 1))
        rule = op.RULE_GREATER_OR_EQUAL if kind == CONDITION["standstill"] else op.RULE_LESS
        draft.condition(kind, 0.6, rule=rule, entities=(0,), other=other)
        draft.condition(CONDITION["element_state"], dice.pick(1, 2), other=before)
        draft.event(maneuver, draft.trigger(), action)


def add_world_story(draft: Draft, dice: Dice) -> None:
    """Append variables, signals and events over the conditions and actions that concern more than one entity's way."""
    p = draft.program
    p.watches[0] = dice.pick(0, 1, 12, 31)
    p.variable_const = [draft.block(dice.between(-2.0, 2.0)) for _ in range(2)]
    p.variable_count, p.signal_count, p.controller_count = [2], [2], [2]
    p.controller_reference, p.controller_const = [op.NONE, 0], [draft.block(0.0), draft.block(dice.between(0.0, 3.0))]
    p.phase_first, p.phase_name = [0, 2, 3], [0, 1, 0]
    p.phase_const = [draft.block(dice.pick(0, 1) * dice.between(0.0, 4.0)) for _ in range(3)]
    p.light_first, p.light_signal, p.light_state = [0, 1, 2, 3], [0, 0, 1], [0, 1, 1]
    others = [dice.pick(0, 1) for _ in range(dice.pick(0, 1))]
    p.set_member, p.set_first = [*others, -1, 1], [0, len(others), len(others) + 2]
    maneuver = draft.maneuver()
    before = maneuver
    for k in range(6):
        add_world_condition(draft, dice, WORLD_CONDITIONS[(6 * dice.number + k) % len(WORLD_CONDITIONS)], before)
        kind = WORLD_ACTIONS[(6 * dice.number + k) % len(WORLD_ACTIONS)]
        before = draft.event(maneuver, draft.trigger(), add_world_action(draft, dice, kind), limit=dice.pick(1, 2))


def add_world_condition(draft: Draft, dice: Dice, kind: int, before: int) -> None:
    """Append a condition of a kind; one on elements watches `before`."""
    modes = {
        **dict.fromkeys((CONDITION["distance_to_position"],), 4 * dice.pick(0, 2, 4) + dice.pick(0, 1, 2)),
        **dict.fromkeys((CONDITION["relative_speed"], CONDITION["acceleration"]), dice.pick(0, 1, 2, 3)),
        CONDITION["collision"]: dice.pick(op.KIND_ANY, op.KIND_VEHICLE),
        CONDITION["angle"]: 4 * dice.pick(0, 1, 2, 4) + dice.pick(0, 1, 2),
        CONDITION["relative_angle"]: dice.pick(0, 1, 2),
        CONDITION["element_state"]: FIRST_TRANSITION + dice.pick(0, 1, 2, 3),
    }
    others = {
        CONDITION["collision"]: dice.pick(0, 1),
        CONDITION["clearance"]: 0,
        CONDITION["element_state"]: before,
    }
    draft.condition(
        kind,
        dice.between(-1.0, 3.0),
        rule=dice.pick(*range(op.RULE_LESS, op.RULE_NOT_EQUAL + 1)),
        entities=(0,) if dice.unit() < 0.5 else (0, 1),
        other=others.get(kind, dice.pick(0, 1)),
        mode=modes.get(kind, dice.pick(0, 1)),
        flags=0 if kind == CONDITION["element_state"] else dice.pick(0, 1, 2, 3),
        position=draft.position(0, -1, dice.between(40.0, 110.0))
        if kind == CONDITION["distance_to_position"]
        else op.NONE,
        more=(dice.between(0.0, 30.0), dice.between(0.0, 30.0)),
        owner=draft.program.element_count[0],
        every=dice.unit() < 0.5,
    )


def add_world_action(draft: Draft, dice: Dice, kind: int) -> int:
    """Append an action of a kind; what it holds of the ego it lets go again or holds lightly."""
    k = draft.action(kind, dice.pick(0, 1), target=dice.between(0.0, 0.2), value=dice.between(0.5, 2.0))
    p = draft.program
    p.action_other[k] = 0 if kind == ACTION["stop_traffic"] else dice.pick(0, 1)
    p.action_lanes[k] = p.entity_count[0] if kind == ACTION["stop_traffic"] else 0
    p.action_mode[k] = dice.pick(*range(op.HELD_INPUTS)) if kind == ACTION["override_controller"] else dice.pick(0, 1)
    p.action_flags[k] = dice.pick(*range(8))
    return k


def add_condition(draft: Draft, dice: Dice, before: list[int]) -> None:
    """Append a condition of a random kind; edges and delays too."""
    kind = dice.pick(*(STORY_CONDITIONS if before else STORY_CONDITIONS[:-1]))
    values = {
        CONDITION["time"]: dice.between(0.0, 8.0),
        CONDITION["lane_confidence"]: 0.6,
        CONDITION["reached"]: 30.0,
        CONDITION["traveled"]: dice.between(0.0, 80.0),
    }
    other, position = dice.pick(0, 1), op.NONE
    if kind == CONDITION["reached"]:
        position = draft.position(0, -1, dice.between(40.0, 110.0))
    elif kind == CONDITION["takeover_state"]:
        other = dice.pick(op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING, op.TAKEOVER_REQUEST, op.TAKEOVER_MANUAL)
    elif kind == CONDITION["event"]:
        other = before[-1]
    draft.condition(
        kind,
        values.get(kind, dice.between(0.0, 20.0)),
        rule=dice.pick(*range(op.RULE_LESS, op.RULE_NOT_EQUAL + 1)),
        entities=(0,) if dice.unit() < 0.5 else (0, 1),
        other=other,
        position=position,
        edge=dice.pick(*range(op.EDGE_NONE, op.EDGE_BOTH + 1)),
        delay=dice.between(0.0, 2.0) if dice.unit() < 0.3 else 0.0,
        every=dice.unit() < 0.5,
    )


def add_action(draft: Draft, dice: Dice) -> int:
    """Append an action of a random kind, shape and dimension."""
    shape = dice.pick(op.SHAPE_LINEAR, op.SHAPE_SINUSOIDAL, op.SHAPE_CUBIC, op.SHAPE_STEP)
    dimension = dice.pick(op.DIMENSION_TIME, op.DIMENSION_RATE, op.DIMENSION_DISTANCE)
    entity = dice.pick(0, 1)
    kind = dice.pick(ACTION["speed"], ACTION["lane_change"], ACTION["sensor_noise"])
    return draft.action(
        kind,
        entity,
        target=dice.between(-3.0, 25.0) if kind == ACTION["speed"] else dice.between(0.0, 80.0),
        value=dice.between(-1.0, 5.0) if dimension != op.DIMENSION_DISTANCE else dice.between(0.0, 60.0),
        shape=shape,
        dimension=dimension,
        lanes=dice.pick(-1, 1, 2),
    )


def variants_of(draft: Draft, number: int) -> list[list[float]]:
    """Return the program's numbers, the same scaled, and the same with a number that is none or zero."""
    usual = list(draft.done().const)
    scaled = [value * 1.03125 for value in usual]
    scaled[slots.K_STEP] = usual[slots.K_STEP]
    broken = list(usual)
    where = slots.K_BUDGET + 17 * number % (len(usual) - slots.K_BUDGET)
    if number % 8 == 0:
        where = draft.program.entity_const[0] + slots.E_SPEED
    broken[where] = (math.nan, math.inf, 0.0, -1.0e300)[number % 4]
    return [usual, scaled, broken]


@cache
def both_forms(number: int) -> tuple[list[bytes], list[bytes], NDArray[np.float64], set[int], set[int]]:
    """Return the traces of both forms as bytes, the summaries, and the takeover states and events that were reached."""
    draft = random_draft(number)
    program, tables = draft.done(), draft.network.tables
    rows, draws = variants_of(draft, number), [make_draws(number, k) for k in range(VARIANTS)]
    both = run_both(tables, program, rows, draws, STEPS)
    width = trace_width(program)
    states = {int(state) for trace in both.traces for state in trace[1::width]}
    usual = Simulation(tables, program, interpreted=True)
    usual.sweep(rows[:1], draws[:1], STEPS)
    kinds = {*both.state.log_kind, *usual.state.log_kind}
    return both.interpreted, both.compiled, both.summaries, states, kinds


@pytest.mark.parametrize("number", range(PROGRAMS))
def test_both_forms_leave_the_same_bytes(number: int) -> None:
    interpreted, compiled, _, _, _ = both_forms(number)
    assert [a == b for a, b in zip(interpreted, compiled, strict=True)] == [True] * VARIANTS


def test_the_programs_reach_every_code() -> None:
    drafts = [random_draft(number) for number in range(PROGRAMS)]
    programs = [draft.program for draft in drafts]
    assert {kind for p in programs for kind in p.condition_op} == set(range(len(CONDITIONS)))
    assert {kind for p in programs for kind in p.action_op} == REACHED_ACTIONS
    assert {kind for p in programs for kind in p.failure_kind} == set(range(op.FAILURES))
    assert {kind for p in programs for kind in p.entity_motion} == set(range(op.MOTION_POSED + 1))
    assert {kind for p in programs for kind in p.action_shape} == set(range(op.SHAPE_STEP + 1))
    assert {kind for p in programs for kind in p.condition_edge} == set(range(op.EDGE_BOTH + 1))
    results = [both_forms(number) for number in range(PROGRAMS)]
    states = set().union(*(states for _, _, _, states, _ in results))
    assert states == set(range(op.TAKEOVER_STANDSTILL + 1))
    stops = {int(row[SUMMARY.index("stop")]) for _, _, summaries, _, _ in results for row in summaries}
    assert stops == set(range(op.STOP_NONE, op.STOP_ERROR + 1))
    kinds = set().union(*(kinds for _, _, _, _, kinds in results))
    assert kinds >= {op.EVENT_EVADE, op.EVENT_BRAKE, op.EVENT_MERGE, op.EVENT_COLLISION, op.EVENT_ACTION}
    assert kinds >= {op.EVENT_FAILURE, op.EVENT_FAILURE_END}


def test_a_sweep_does_not_depend_on_the_order_of_its_variants() -> None:
    draft = random_draft(0)
    program, tables = draft.done(), draft.network.tables
    rows, draws = variants_of(draft, 0), [make_draws(0, k) for k in range(VARIANTS)]
    compiled = Simulation(tables, program)
    forward, _ = compiled.sweep(rows, draws, STEPS)
    backward, _ = compiled.sweep(rows[::-1], draws[::-1], STEPS)
    assert forward.tobytes() == backward[::-1].tobytes()
