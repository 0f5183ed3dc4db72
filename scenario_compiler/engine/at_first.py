"""Checks whether the weather or the sensors' noise alone causes a request at the start of a run.

A scenario in HardRainSunset requests as soon as it begins, because the camera does not see the paint, and the conflict
200 m ahead is never reached. The engine itself finds this out: the same plan is run in clear weather, with a camera
without faults, and the first requests of both runs are compared. Both runs use ideal perception, whose curves were
measured with the rendered camera.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Severity
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns import slots as slot
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State, make_draws, new_state
from scenario_compiler.engine.ego.failures import reset_camera
from scenario_compiler.engine.ego.reach import sensor_reach
from scenario_compiler.engine.ego.weather import reset_weather
from scenario_compiler.engine.program.build import build_program
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.plan.checks.reach import obstacle_budget
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads.network import Network
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.sensors import Failure
from scenario_compiler.vocabulary.weather import weather_preset
from scenario_compiler.vocabulary.word import number_value

ASKS_AT_FIRST = Code(
    "SC512",
    "asks-at-first",
    "The weather or the camera's noise alone causes a request at the start of the run, before the conflict. In "
    "clear weather and without noise there would be no such request:\n\n"
    '    <scenario ... weather="HardRainSunset">     a request at 1.3 s, before the conflict at 200 m\n\n'
    "Choose another weather or less noise, let it begin later (`rain_front` of the library's templates, or the "
    "action <weather>), or disable the cause: if <takeover> names causes, it has no others. If the weather is the "
    'conflict, write <allow code="SC512"/> in the file.',
    Severity.WARNING,
)
SHORT_SIGHT = Code(
    "SC513",
    "short-sight",
    "The scenario's weather, its noise or the camera's failures shorten the range of the forward sensor below the "
    "distance driven in the time budget: the request for a limit ahead comes as soon as the sensor detects it, which "
    "is later than the budget. The message names the causes:\n\n"
    '    <scenario ... weather="HardRainNoon">  <ego speed="22">     7 s are 154 m, but the camera sees 96 m\n\n'
    "This may be intended. Otherwise choose another weather, less noise, a later failure, another sensor "
    '(<forward_sensor kind="radar"/>), a longer range, a shorter `budget` or a lower speed.',
    Severity.WARNING,
)

LATER = 0.5
"""Time by which weather, noise or failures must delay a request that comes later than its budget anyway, s; chosen."""


@dataclass(frozen=True, slots=True)
class FirstRequest:
    """The first request of a run: its time, s, cause (CAUSE_...), and distance of its limit from the start, m."""

    time: float
    cause: int
    place: float


@dataclass(frozen=True, slots=True)
class Obscuring:
    """One cause of a shorter range of the forward sensor.

    Attributes:
        name: Its name in a message.
        only: The plan with this cause alone, in clear weather otherwise.
        place: Where it is written.
    """

    name: str
    only: Plan
    place: Place


def check_at_first(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report what weather and noise alone cause from the start: a short sensor range, or a cause that holds."""
    ideal = plan.model_copy(update={"perception": "ideal"})
    program, state = _at_start(ideal, network)
    _check_sight(plan, network, _lasting_reach(program, state), sink)
    values = program.const
    health = _lasting_health(state)
    causes = (
        (op.CAUSE_SENSOR_HEALTH, health < values[slot.K_HEALTH_REQUEST]),
        (op.CAUSE_LANE_CONFIDENCE, health * state.paint_seen[0] < values[slot.K_CONFIDENCE_REQUEST]),
    )
    if any(holds and program.cause_on[cause] == 1 for cause, holds in causes):
        _check_request(plan, ideal, network, state, values[slot.K_CONFIDENCE_REQUEST], sink)


def _lasting_health(state: State) -> float:
    """Return the camera's health by its failures at the start, with what it notices a few images later."""
    return state.image_health[0] * state.lines_left[0]


def _at_start(plan: Plan, network: Network) -> tuple[Program, State]:
    """Return the program of a plan, and its state with the weather and the camera of the start."""
    program = build_program(plan, network)
    state = new_state(program)
    reset_weather(program, state)
    reset_camera(program, state)
    return program, state


def _lasting_reach(program: Program, state: State) -> float:
    """Return how far the forward sensor sees, m; a dropout counts only if it affects all images."""
    state.missing[0] = 1 if state.failure_now[op.FAILURE_DROPOUT] >= 1.0 else 0
    return sensor_reach(program, state)


def _check_sight(plan: Plan, network: Network, reach: float, sink: Diagnostics) -> None:
    """Warn if weather, noise or failures let a request come later than the budget and the range in clear air do.

    If the range in clear air does not cover the budget either (`BLIND_BUDGET`), this counts from LATER on.
    """
    asked = obstacle_budget(plan)
    if asked is None:
        return
    needed = asked.time * asked.speed
    clear = number_value(plan.forward_sensor.range, parameter_values(plan.parameters))
    enough = needed if needed <= clear else clear - LATER * asked.speed
    if reach >= enough:
        return
    causes = [(cause, _lasting_reach(*_at_start(cause.only, network))) for cause in _obscuring(plan)]
    shortening = [cause for cause, seen in causes if seen < clear]
    blamed = [cause for cause, seen in causes if seen < enough] or shortening
    names = " and ".join(cause.name for cause in blamed)
    message = (
        f"a budget of {asked.time:g} s at {asked.speed:g} m/s is {needed:.0f} m, but because of {names} the "
        f"{plan.forward_sensor.kind} sees {reach:.0f} m: the request comes {reach / asked.speed:.1f} s before the limit"
    )
    sink.add(SHORT_SIGHT, message, blamed[0].place)


def _obscuring(plan: Plan) -> Iterator[Obscuring]:
    """Yield what may shorten the forward sensor's range: weather, noise, and each kind of the camera's failures."""
    sensor = plan.forward_sensor.model_copy(update={"noise": None})
    clear = _in_clear_weather(plan).model_copy(update={"forward_sensor": sensor, "perception": "ideal"})
    yield Obscuring(_weather_of(plan), clear.model_copy(update={"weather": plan.weather}), place_of(plan, "weather"))
    noisy = {"forward_sensor": plan.forward_sensor}
    yield Obscuring("the sensor's noise", clear.model_copy(update=noisy), plan.forward_sensor.place_of("noise"))
    noise = clear.camera.model_copy(update={"sensor_noise": plan.camera.sensor_noise})
    place = plan.camera.place_of("sensor_noise")
    yield Obscuring("the camera's noise", clear.model_copy(update={"camera": noise}), place)
    by_kind: dict[str, list[Failure]] = {}
    for failure in plan.camera.failures:
        by_kind.setdefault(failure.kind, []).append(failure)
    for kind, failures in by_kind.items():
        failing = clear.camera.model_copy(update={"failures": tuple(failures)})
        name = f"the camera's failure '{kind}'"
        yield Obscuring(name, clear.model_copy(update={"camera": failing}), failures[0].place_of("kind"))


def _weather_of(plan: Plan) -> str:
    return "the weather" if plan.weather.preset == "custom" else plan.weather.preset


def _check_request(plan: Plan, ideal: Plan, network: Network, state: State, enough: float, sink: Diagnostics) -> None:
    """Warn if the weather or the camera's noise causes the first request, and not a limit ahead."""
    asked = first_request(ideal, network, plan.duration)
    if asked is None or asked.cause not in (op.CAUSE_SENSOR_HEALTH, op.CAUSE_LANE_CONFIDENCE):
        return
    clear = first_request(_in_clear_weather(ideal), network, plan.duration)
    if clear is not None and clear.time <= asked.time:
        return
    by_weather = asked.cause == op.CAUSE_LANE_CONFIDENCE and state.paint_seen[0] < enough
    by_camera = asked.cause == op.CAUSE_SENSOR_HEALTH or _lasting_health(state) < enough
    reasons = [_weather_of(plan)] if by_weather or not by_camera else []
    reasons += ["the camera's noise or failures"] if by_camera or not by_weather else []
    otherwise = "without this there is no request" if clear is None else f"before the conflict at {clear.place:.0f} m"
    message = f"a request at {asked.time:.1f} s because of {' and '.join(reasons)}, {otherwise}"
    place = plan.camera.place_of("sensor_noise") if by_camera and not by_weather else place_of(plan, "weather")
    sink.add(ASKS_AT_FIRST, message, place)


def first_request(plan: Plan, network: Network, until: float) -> FirstRequest | None:
    """Return the first request of a plan that the engine drives; None if there is none until the time `until`, s."""
    simulation = Simulation(network.tables, build_program(plan, network))
    simulation.reset(make_draws(1))
    st, ego = simulation.state, simulation.program.ego[0]
    start = st.odometer[ego]
    while st.requests[0] == 0:
        if st.clock[0] > until or not simulation.step():
            return None
    ahead = {op.CAUSE_PATH_BLOCKED: st.blocked_distance[0], op.CAUSE_LANE_ENDS: st.lane_end_distance[0]}
    cause = int(st.cause[0])
    return FirstRequest(st.request_at[0], cause, st.odometer[ego] - start + ahead.get(cause, 0.0))


def _in_clear_weather(plan: Plan) -> Plan:
    """Return the plan in clear weather, with a camera without noise and faults."""
    camera = plan.camera.model_copy(update={"sensor_noise": 0.0, "failures": ()})
    return plan.model_copy(update={"weather": weather_preset("ClearNoon"), "camera": camera})
