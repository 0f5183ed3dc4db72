"""The reference drivers against a second implementation, written here only from the published formulas.

The grid: 5 speeds of the ego vehicle, 4 of the car that cuts in, 5 gaps at the start of its change of lane and 2
durations of that, 200 cut-ins from the left lane into the middle of the ego vehicle's, both lanes 3.5 m wide and both
cars 4.5 m by 1.8 m, with a step of 0.01 s.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from itertools import product

import numpy as np
import pytest

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots
from scenario_compiler.engine.columns.state import make_draws
from scenario_compiler.engine.columns.totals import SUMMARY
from scenario_compiler.engine.simulation import Simulation
from tests.engine.make import Draft, highway

KMH = 1.0 / 3.6
STEP = 0.01
BEGIN = 0.5
"""Time at which the change of lane begins, s."""
LENGTH, WIDTH, CENTRE, LANE = 4.5, 1.8, 1.4, 3.5
GRID = [
    (v * KMH, lead * KMH, gap, over)
    for v, lead, gap, over in product(
        (60.0, 80.0, 100.0, 120.0, 130.0), (20.0, 40.0, 50.0, 70.0), (8.0, 18.0, 30.0, 45.0, 65.0), (2.5, 4.5)
    )
]
MODELS = {
    "careful, 0.375 m and 0.4 s": op.REFERENCE_CAREFUL,
    "careful, 0.375 m and 0.72 m": op.REFERENCE_CAREFUL_WAY,
    "careful, sides overlap": op.REFERENCE_CAREFUL_OVERLAP,
    "rss": op.REFERENCE_RSS,
    "fsm": op.REFERENCE_FUZZY,
}


@dataclass
class Scene:
    """What a follower knows at a time, SI units."""

    t: float
    u: float
    lead: float
    gap: float
    room: float
    moved: float
    aside: float
    a: float


@dataclass
class Follower:
    """A model: whether it is in danger, and how hard it brakes 0.75 s later."""

    name: str
    seen: float = math.inf
    alarm: float = math.inf
    held: bool = False
    a: float = 0.0
    rules: dict[str, Callable[[Scene], float]] = field(default_factory=dict)

    def drive(self, now: Scene) -> float:
        """Return the acceleration of this step."""
        wish = self.careful(now) if self.name.startswith("careful") else self.rules[self.name](now)
        if now.u <= now.lead or (wish == 0.0 and self.name == "fsm"):
            self.alarm = math.inf
        elif wish > 0.0:
            self.alarm = min(self.alarm, now.t)
        waiting = now.t - self.alarm
        if waiting >= 0.75 - 1e-9:
            goal = -min(wish if self.name == "fsm" else 7.59, 7.59)
            self.a = max(goal, min(self.a, 0.0) - 12.65 * STEP)
        elif waiting >= 0.0:
            self.a = -0.4 if self.name.startswith("careful") else 0.0
        else:
            self.a = min(0.0, self.a + 12.65 * STEP)
        return self.a

    def careful(self, now: Scene) -> float:
        """UN R157: perception by one of three readings, then a time to collision below 2 s."""
        way = {"careful, 0.375 m and 0.4 s": 0.375, "careful, 0.375 m and 0.72 m": 0.375 + 0.72}.get(self.name, 9.0)
        if now.room <= 0.0 or now.moved >= way:
            self.seen = min(self.seen, now.t)
        evaluated = now.t >= self.seen + (0.4 if self.name.endswith("0.4 s") else 0.0) - 1e-9
        return 7.59 if evaluated and now.u > now.lead and now.gap < 2.0 * (now.u - now.lead) else 0.0


def rss(now: Scene) -> float:
    """Shalev-Shwartz et al. 2017 with the JRC's values."""
    rho, a, b, mu, side = 0.75, 3.0, 6.0, 0.3, 1.0
    along = now.u * rho + a * rho**2 / 2 + (now.u + rho * a) ** 2 / (2 * b) - now.lead**2 / (2 * b)
    across = mu + abs(2 * now.aside + side * rho) * rho / 2 + (now.aside + side * rho) ** 2 / (2 * side)
    return 7.59 if now.u > now.lead and now.gap < along and (now.room <= 0.0 or now.room < across) else 0.0


def fsm(now: Scene) -> float:
    """Mattas et al. 2020 with the JRC's values; the lateral condition as in esmini."""
    if now.u <= now.lead:
        return 0.0
    if now.room > 0.0 and (now.aside <= 0.0 or now.room / now.aside > now.gap / (now.u - now.lead) + 0.1):
        return 0.0
    rt = 0.75
    arf = max(now.a, -4.0)
    later = now.u + rt * arf
    if later < now.lead:
        cfs = 1.0 if now.gap < (now.u - now.lead) ** 2 / (2 * abs(now.a)) else 0.0
    else:
        first = (now.u + arf * rt / 2 - now.lead) * rt
        safe, unsafe = (first + (later - now.lead) ** 2 / (2 * b) for b in (4.0, 6.0))
        cfs = float(np.clip((now.gap - safe) / (unsafe - safe), 0.0, 1.0))
    if cfs > 0.0:
        return 4.0 + cfs * 2.0
    reach = now.u * rt - now.lead**2 / (2 * 7.0)
    d_safe, d_unsafe = reach + now.u**2 / 8.0 + 2.0, reach + now.u**2 / 12.0
    return 4.0 * float(np.clip((now.gap - 2.0 - d_safe) / (d_unsafe - d_safe), 0.0, 1.0))


def avoids(name: str, u: float, lead: float, gap: float, over: float) -> bool:
    """Return whether a model avoids a cut-in that begins `gap` ahead."""
    one = Follower(name, rules={"rss": rss, "fsm": fsm})
    ego, car = 0.0, gap + LENGTH + BEGIN * (u - lead)
    start, a = u, 0.0
    for k in range(int(14.0 / STEP)):
        t = k * STEP
        part = min(max((t - BEGIN) / over, 0.0), 1.0)
        y = LANE * 0.5 * (1.0 + math.cos(math.pi * part))
        down = LANE * 0.5 * math.pi / over * math.sin(math.pi * part) if 0.0 < part < 1.0 else 0.0
        turn = math.asin(min(down / lead, 1.0))
        half_wide = 0.5 * (LENGTH * math.sin(turn) + WIDTH * math.cos(turn))
        half_long = 0.5 * (LENGTH * math.cos(turn) + WIDTH * math.sin(turn))
        middle = y - CENTRE * math.sin(turn)
        along = lead * math.cos(turn)
        ahead = car + CENTRE * math.cos(turn) - half_long - (ego + CENTRE + 0.5 * LENGTH)
        room = middle - half_wide - 0.5 * WIDTH
        if room < 0.0 and -(LENGTH + 2.0 * half_long) < ahead < 0.0:
            return False
        if ahead > 0.0:
            a = one.drive(Scene(t, u, along, ahead, room, LANE - middle, down, a))
            if a == 0.0 and u < start:
                a = 0.0
        u_next = max(u + a * STEP, 0.0)
        ego += 0.5 * (u + u_next) * STEP
        u = u_next
        car += along * STEP
    return True


@cache
def verdicts(name: str, more: float = 0.0) -> tuple[bool, ...]:
    """Return the second implementation's verdicts on the grid, with this added to every gap."""
    return tuple(avoids(name, v, lead, gap + more, over) for v, lead, gap, over in GRID)


def in_the_engine(kind: int, u: float, lead: float, gap: float, over: float) -> bool:
    """Return whether the engine's reference driver avoids the same cut-in."""
    draft = Draft(highway(3000.0), {slots.K_STEP: STEP, slots.K_DURATION: 14.0})
    draft.program.replaced_by[0] = kind
    draft.program.control_every[0] = 1
    draft.ego(lane=-2, s=50.0, speed=u)
    car = draft.moving(-1, 50.0 + LENGTH + gap + BEGIN * (u - lead), lead)
    draft.event(draft.maneuver(), draft.at_time(BEGIN), draft.lane_change(car, -1, over))
    simulation = Simulation(draft.network.tables, draft.done())
    summaries, _ = simulation.sweep([list(draft.program.const)], [make_draws(1)], 2000)
    return bool(summaries[0][SUMMARY.index("time_collision")] < 0.0)


def differing(name: str, every: int) -> list[tuple[float, float, float, float]]:
    """Return the cut-ins with other verdicts, of those that keep theirs with half a metre more or less."""
    found = []
    for case in GRID[::every]:
        u, lead, gap, over = case
        verdict = avoids(name, u, lead, gap, over)
        if verdict == avoids(name, u, lead, gap - 0.5, over) == avoids(name, u, lead, gap + 0.5, over):
            found += [case] * (in_the_engine(MODELS[name], *case) != verdict)
    return found


@pytest.mark.parametrize("name", MODELS)
def test_verdicts_on_some_cut_ins_are_those_of_a_second_implementation(name: str) -> None:
    assert differing(name, 23) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", MODELS)
def test_verdicts_on_200_cut_ins_are_those_of_a_second_implementation(name: str) -> None:
    assert len(GRID) == 200
    assert differing(name, 1) == []
    firm = [k for k in range(200) if verdicts(name, -0.5)[k] == verdicts(name)[k] == verdicts(name, 0.5)[k]]
    assert len(firm) >= 170
    assert 20 < sum(verdicts(name)) < 190


@pytest.mark.slow
def test_the_models_differ() -> None:
    avoided = {name: sum(verdicts(name)) for name in MODELS}
    assert avoided["rss"] > avoided["fsm"] > max(avoided[name] for name in MODELS if name.startswith("careful"))


@pytest.mark.parametrize("kind", MODELS.values())
def test_each_answers_a_request_and_brakes_for_a_slow_car_ahead(kind: int) -> None:
    numbers = {slots.K_DRIVER_TIME: 1.0, slots.K_NOISE: 60.0, slots.K_DURATION: 20.0}
    draft = Draft(highway(), numbers)
    draft.program.driver_reference[0] = kind
    draft.ego(speed=25.0)
    draft.moving(-1, 190.0, 12.0)
    run = draft.start()
    fastest = []
    while run.st.stop[0] == op.STOP_NONE:
        run.go(run.st.clock[0] + 0.05)
        if run.st.takeover_state[0] == op.TAKEOVER_MANUAL:
            fastest.append(run.st.v[0])
    assert run.time_of(op.EVENT_RESPONSE) > 0.0
    assert run.st.crashed[0] == 0
    assert fastest[0] > 20.0
    assert 9.0 < fastest[-1] <= 12.5
    assert abs(run.st.off[0]) < 0.05
