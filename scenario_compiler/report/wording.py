"""Texts of a report: a run in one line, its conditions, and the command that repeats it."""

from __future__ import annotations

import math
import shlex
from collections.abc import Callable
from typing import NamedTuple

from scenario_compiler.recording.criteria import Where
from scenario_compiler.recording.names import StandingPlace
from scenario_compiler.recording.outcome import Outcome
from scenario_compiler.report.palette import words_of
from scenario_compiler.report.run import Run
from scenario_compiler.vocabulary.driver import Driver
from scenario_compiler.vocabulary.markings import LineBeside, SecondaryMarkings
from scenario_compiler.vocabulary.scenario import Classification
from scenario_compiler.vocabulary.takeover import Cause
from scenario_compiler.vocabulary.taxonomies import TAXONOMIES
from scenario_compiler.vocabulary.word import QUANTITIES, Number, number_value

STANDS: dict[StandingPlace, str] = {
    "own_lane": "stopped safely in its lane",
    "other_lane": "stopped in another lane",
    "shoulder": "stopped safely on the shoulder",
    "across_edge": "stopped across the edge of its lane",
    "off_road": "stopped off the road",
}
"""Words for the place of a stop without a collision; a stop is safe within the ego's own lane or on a shoulder."""

OUTCOMES: dict[str, str] = {
    "no_request": "no takeover request",
    "stopped": "stopped without a request",
    "driver": "driver took over",
    "minimum_risk": "minimum-risk manoeuvre",
    "minimum_risk_then_driver": "minimum-risk manoeuvre, then driver took over",
    "unanswered": "request unanswered",
    "open": "request still open",
    "collision": "collision",
    "broke_off": "run broke off",
    "destination": "destination reached",
    "no_collision": "no collision",
    **{str(place): text for place, text in STANDS.items()},
}
"""Words for the resolution of takeovers and the end of runs."""


class Summary(NamedTuple):
    """A run in one row of a table, as texts, with a dash for what does not apply.

    Attributes:
        name: Name of the conflict.
        number: Its number in the taxonomy.
        urgency: Its rated urgency.
        cause: Cause of the request.
        request_time: Time of the request, s.
        takeover_time: Time from the request to the driver's response, s.
        minimum_ttc: Least time to collision, s.
        outcome: The outcome in words.
        result: pass, fail or error; "not judged" for a run without criteria.
    """

    name: str
    number: str
    urgency: str
    cause: str
    request_time: str
    takeover_time: str
    minimum_ttc: str
    outcome: str
    result: str


def summary_of(run: Run) -> Summary:
    """Return a run in one row."""
    outcome = run.outcome
    rated = next((one for one in run.plan.classifications if one.place), None)
    return Summary(
        name=outcome.name,
        number="–" if rated is None else rated.place,
        urgency=(rated.urgency if rated else "") or "–",
        cause=words_of(outcome.cause) if outcome.cause else "–",
        request_time=measured(outcome, "request_time"),
        takeover_time=measured(outcome, "takeover_time"),
        minimum_ttc=measured(outcome, "minimum_time_to_collision"),
        outcome=outcome_words(outcome, automated=run.plan.controller is not None),
        result=outcome.result if outcome.criteria or outcome.result == "error" else "not judged",
    )


def outcome_keys(outcome: Outcome) -> tuple[str, str]:
    """Return how the first request was resolved, and how the run ended, as keys of tables of words."""
    resolved: str = outcome.resolution
    first = next(iter(outcome.takeovers), None)
    if resolved == "minimum_risk" and first is not None and first.response_time is not None:
        resolved = "minimum_risk_then_driver"
    if outcome.collision_with is not None:
        return resolved, "collision"
    if outcome.result == "error":
        return resolved, "broke_off"
    ended = "destination" if outcome.stop_reason == "destination" else "no_collision"
    return resolved, outcome.stands if outcome.stands in STANDS else ended


def outcome_words(outcome: Outcome, *, automated: bool = True) -> str:
    """Return the outcome of a run in a few words; without an automated vehicle they do not mention takeovers."""
    took_over, ended = (OUTCOMES[key] for key in outcome_keys(outcome))
    if outcome.collision_with:
        ended += f" with {outcome.collision_with}"
    return f"{took_over}, {ended}" if automated else ended


def place_words(where: Where) -> str:
    """Return a place in words."""
    if where.road is None or where.s is None:
        return f"off every road, x {fixed(where.x)} m, y {fixed(where.y)} m"
    return f"road {where.road}, lane {where.lane}, s {fixed(where.s)} m"


def broken_criteria(outcome: Outcome) -> list[tuple[str, str]]:
    """Return each criterion that failed, with a sentence on when, where and why."""
    found = []
    for one in outcome.criteria:
        if not one.passed:
            when = "" if one.when is None else f"at {fixed(one.when)} s"
            place = "" if one.where is None else place_words(one.where)
            found.append((one.criterion, f"{', '.join(part for part in (when, place) if part)}: {one.why}"))
    return found


def measured(outcome: Outcome, name: str) -> str:
    """Return a measure as text; a dash if it has no value."""
    measure = outcome.measures.get(name)
    return "–" if measure is None or measure.value is None else fixed(measure.value)


def fixed(value: float) -> str:
    """Return a number with two decimals, for numeric columns."""
    text = f"{value:.2f}"
    return "0.00" if text == "-0.00" else text.replace("-", "−")


def decimal(value: float) -> str:
    """Return a number with up to two decimals, or with up to two digits below 0.1, without trailing zeros."""
    if 0.0 < abs(value) < 0.1:
        return f"{value:.2g}".replace("-", "−")
    return fixed(value).rstrip("0").rstrip(".")


def percent(share: float, digits: int = 0) -> str:
    """Return a share as a percentage with a number of decimals; a dash if it is NaN."""
    return "–" if math.isnan(share) else f"{100 * share:.{digits}f} %"


def unit_words(unit: str) -> str:
    """Return a readable unit; empty for numbers without a unit."""
    return {"1": "", "deg": "°", "m/s2": "m/s²"}.get(unit, unit)


def with_unit(name: str, unit: str) -> str:
    """Return the title of a column or an axis: its name, and its unit if it has one."""
    words = unit_words(unit)
    return f"{name} ({words})" if words else name


CONFIDENCE_FROM = {
    "camera": "the camera image",
    "ideal": "the map's marks (ideal)",
    "surrogate": "surrogate perception",
}


def conditions(run: Run) -> list[tuple[str, str]]:
    """Return the conditions of the run as (what, value)."""
    plan, header = run.plan, run.recording.header
    policy = plan.takeover

    def number(value: Number, unit: str) -> str:
        return f"{decimal(number_value(value, header.parameters))} {unit}".rstrip()

    stop = [
        ("Minimum-risk manoeuvre after", number(policy.minimum_risk_after, "s")),
        ("Its deceleration", number(policy.minimum_risk_deceleration, "m/s²")),
    ]
    if not policy.minimum_risk or policy.automation.after == "let_go":
        stop = [("Minimum-risk manoeuvre", "none")]
    rows = [
        ("Map", plan.map.name),
        ("Weather", plan.weather.preset),
        *[("Vehicle", one.vehicle.name) for one in plan.entities[:1]],
        *[("Speed at the start", f"{decimal(speed)} m/s") for speed in _first_speed(run)],
        ("Other actors", ", ".join(f"{e.id} ({e.vehicle.name})" for e in plan.entities[1:]) or "none"),
        ("Markings changed", ", ".join(f"road {m.road}" for m in plan.markings) or "none"),
        ("Markings added", ", ".join(map(_line, plan.secondary_markings)) or "none"),
        ("World", header.world),
        ("Step, control", f"{decimal(plan.step)} s, {_every(plan.control_every)}"),
        ("Duration at most", f"{decimal(plan.duration)} s"),
    ]
    if plan.controller is not None:
        rows += [
            ("Desired speed", number(plan.ego.desired_speed, "m/s")),
            ("Controller", plan.controller.model),
            ("Lane confidence from", CONFIDENCE_FROM[header.perception]),
            ("Forward sensor", f"{plan.forward_sensor.kind}, {number(plan.forward_sensor.range, 'm')}"),
            ("Camera noise at the start", "σ = " + number(plan.camera.sensor_noise, "grey levels")),
            ("Time budget", number(policy.budget, "s")),
            ("Escalation after", number(policy.escalate_after, "s")),
            *stop,
            ("Causes", "; ".join(_cause(cause, number) for cause in policy.causes) or "all"),
            ("Driver", _driver(run)),
        ]
    units = {one.name: unit_words(QUANTITIES[one.type].unit) for one in plan.parameters if one.type in QUANTITIES}
    rows += [
        (f"${name}", f"{_plain(value)} {units.get(name, '')}".rstrip())
        for name, value in sorted(header.parameters.items())
    ]
    return rows


def _first_speed(run: Run) -> list[float]:
    """Return the first vehicle's speed in the first row with it, m/s; an empty list if there is none."""
    recording = run.recording
    return [float(speed) for speed in recording.v[:, :1][recording.present[:, :1]][:1]]


def _every(steps: int) -> str:
    return {1: "every step", 2: "every second step"}.get(steps, f"every {steps} steps")


def _line(line: SecondaryMarkings | LineBeside) -> str:
    where = f"on road {line.road}" if isinstance(line, SecondaryMarkings) else f"beside {line.entity}"
    return f"{line.colour} {where}"


def _cause(cause: Cause, number: Callable[[Number, str], str]) -> str:
    words = {
        "budget": ("time budget", "s"),
        "warning_budget": ("warning budget", "s"),
        "warning_below": ("warning below", ""),
        "warning_over": ("warning ends over", ""),
        "request_below": ("request below", ""),
        "margin": ("margin", "m"),
        "gap_front": ("gap ahead", "s"),
        "gap_rear": ("gap behind", "s"),
        "after": ("after", "s"),
        "minimum_risk_after": ("minimum-risk manoeuvre after", "s"),
    }
    given = {field: getattr(cause, field) for field in words}
    parts = [
        f"{words[field][0]} {number(value, words[field][1])}" for field, value in given.items() if value is not None
    ]
    if cause.count is not None and cause.of is not None:
        parts.append(f"{cause.count} of {cause.of} control steps")
    return words_of(cause.kind) + (f" ({', '.join(parts)})" if parts else "")


def _driver(run: Run) -> str:
    driver = run.plan.takeover.driver
    if driver.by_person is not None:
        return "a person at the wheel"
    if isinstance(driver, Driver):
        if driver.takeover_time is not None:
            return f"answers after {decimal(number_value(driver.takeover_time, run.recording.header.parameters))} s"
        return driver.preset
    values = run.recording.header.parameters
    if driver.takeover_time is not None:
        return f"{driver.name}: answers after {decimal(number_value(driver.takeover_time, values))} s"
    mu, sigma = number_value(driver.mu, values), number_value(driver.sigma, values)
    laws = {
        "lognormal": f"lognormal takeover time, median {decimal(math.exp(min(mu, 20.0)))} s, σ {decimal(sigma)}",
        "normal": f"normal takeover time, mean {decimal(mu)} s, σ {decimal(sigma)} s",
        "sumo": f"takeover time of SUMO's device, {percent(driver.missed)} after the budget",
    }
    late = f", {percent(driver.late, 1)} late" if driver.late > 0 else ""
    return f"{driver.name}: {laws[driver.law]}{late}, {percent(driver.lapse)} no answer"


def _plain(value: float | bool | str) -> str:
    return decimal(value) if isinstance(value, float | int) and not isinstance(value, bool) else str(value)


def classification(run: Run) -> str:
    """Return the conflict's classifications in words; missing ratings are left out, and there may be none."""
    return "; ".join(map(_placed, run.plan.classifications))


def _placed(rated: Classification) -> str:
    known = TAXONOMIES.get(rated.scheme)
    parts = [rated.scheme if known is None else known.title]
    parts += [f"situation {rated.place}"] if rated.place else []
    for word in ("urgency", "response", "predictability", "criticality"):
        if value := getattr(rated, word):
            parts.append(f"{word} {value}")
    return ", ".join(parts)


def command(run: Run) -> str:
    """Return the command that repeats the run, started in the run's folder."""
    header = run.recording.header
    world = "" if header.world == "kinematic" else f" --world {header.world}"
    world += "".join(f" --{name} {shlex.quote(value)}" for name, value in header.choices.items())
    variant = f" --variant {header.variant}" if header.variant else ""
    inputs = "" if run.plan.takeover.driver.by_person is None else " --inputs ."
    controller = run.plan.controller
    named = (
        [] if controller is None else [controller.model, *([controller.detector.model] if controller.detector else [])]
    )
    trust = "".join(f" --trust {shlex.quote(one)}" for one in named if ":" in one)
    return f"scenario-compiler run plan.json{world} --seed {header.seed}{variant}{inputs}{trust} -o again"
