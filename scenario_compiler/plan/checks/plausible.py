"""Checks that numbers have a plausible size: speeds of vehicles, time budgets, takeover times of drivers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from scenario_compiler.diagnostics import Code, Diagnostics, Place, Severity
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.provenance import place_of
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary import conditions
from scenario_compiler.vocabulary.driver import DriverModel
from scenario_compiler.vocabulary.grammar import grammar_of
from scenario_compiler.vocabulary.scenario import parameter_values
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.word import Number, Word, number_value

IMPLAUSIBLE = Code(
    "SC509",
    "implausible-number",
    "A number has an implausible size: a speed above 100 m/s (360 km/h), a time budget of more than a minute, or a "
    "driver's median takeover time above 19.79 s, the greatest mean of 129 studies (Zhang et al. 2019). Usually its "
    "unit is not that of the attribute: speeds are in m/s, times in s. A speed above 1e6 m/s is an error, because "
    "nothing can be computed from it.\n\n"
    '    <ego speed="120">              120 km/h are 33.33 m/s\n'
    '    <takeover budget="500">        500 ms are 0.5 s\n'
    '    <driver_model name="ours" mu="3" sigma="0.5"/>     mu is a logarithm: for a median of 3 s it is ln 3 = 1.0986',
    Severity.WARNING,
)

FASTEST = 100.0
"""Greatest speed that is plausible on a road, m/s: 360 km/h."""

USABLE = 1.0e6
"""Greatest usable speed, m/s: after an hour at this speed, positions still have a resolution of a millimetre."""

LONGEST_BUDGET = 60.0
"""Longest plausible time budget, s: that of a scheduled exit in studies (doi 10.1177/21695067231192422)."""

LONGEST_MEDIAN = 19.79
"""Longest plausible median of a driver's takeover times, s: the greatest of 520 mean times, Zhang et al. 2019."""

GREATEST_LOGARITHM = 700.0
"""Greatest logarithm of which the exponential function is a number."""


def check_plausible(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report implausible speeds, time budgets and takeover times, at the present values of the parameters."""
    del network
    values = parameter_values(plan.parameters)
    for name, number, place in _speeds(plan):
        speed = abs(number_value(number, values))
        if speed > FASTEST:
            usable = speed <= USABLE
            hint = f"{speed:g} km/h are {speed / 3.6:.4g} m/s" if usable else ""
            message = f"{name} is {speed:g} m/s, which is {speed * 3.6:.4g} km/h"
            sink.add(IMPLAUSIBLE, message, place, hint=hint, severity=None if usable else Severity.ERROR)
    budget = number_value(plan.takeover.budget, values)
    if plan.controller is not None and budget > LONGEST_BUDGET:
        message = f"a time budget of {budget:g} s is implausibly long"
        sink.add(IMPLAUSIBLE, message, plan.takeover.place_of("budget"), hint=f"{budget:g} ms are {budget / 1000:g} s")
    driver = plan.takeover.driver
    if plan.controller is not None and isinstance(driver, DriverModel) and driver.takeover_time is None:
        _check_median(driver, number_value(driver.mu, values), sink)


def _check_median(driver: DriverModel, mu: float, sink: Diagnostics) -> None:
    """Report an implausible median of a driver's takeover times; `mu` is a logarithm unless the law is normal."""
    if driver.law == "normal" and mu > LONGEST_MEDIAN:
        message = f"a mean takeover time of {mu:g} s is implausibly long"
        sink.add(IMPLAUSIBLE, message, driver.place_of("mu"), hint=f"{mu:g} ms are {mu / 1000:g} s")
    elif driver.law == "lognormal" and mu > math.log(LONGEST_MEDIAN):
        median = f"{math.exp(mu):.4g} s" if mu < GREATEST_LOGARITHM else f"e^{mu:g} s"
        message = f"with mu = {mu:g} the median takeover time is {median}, which is implausibly long"
        hint = f"mu is the logarithm of a time in s: for a median of 3 s it is {math.log(3.0):.4f}"
        sink.add(IMPLAUSIBLE, message, driver.place_of("mu"), hint=hint)


def _speeds(plan: Plan) -> Iterator[tuple[str, Number, Place]]:
    """Yield each commanded speed as its name, its number and its place in the file.

    Speeds in conditions are not included, because `triggers` reports comparisons that are never true.
    """
    for entity in plan.entities:
        place = place_of(plan, f"entities/{entity.id}")
        yield f"the speed of '{entity.id}'", entity.speed, place
        if entity.desired_speed != entity.speed:
            yield f"the desired speed of '{entity.id}'", entity.desired_speed, place
    for word in walk(plan.storyboard):
        if type(word).__module__.startswith(conditions.__name__):
            continue
        for name, rule in grammar_of(type(word)).attributes.items():
            if rule.spelling.quantity == "speed" and rule.kind == "number":
                number = getattr(word, rule.field)
                if number is not None:
                    yield f"{name} of <{_tag(word)}>", number, word.place_of(name)


def _tag(word: Word) -> str:
    return word.tag() or type(word).__name__
