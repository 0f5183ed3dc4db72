"""Checks that the markings of a scenario are on existing roads, and on lanes with such marks."""

from __future__ import annotations

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.plan.binding import BEYOND_ROAD, UNKNOWN_LANE, Binder
from scenario_compiler.vocabulary.markings import LineBeside, Markings, SecondaryMarkings
from scenario_compiler.vocabulary.scenario import Scenario
from scenario_compiler.vocabulary.word import number_value

EMPTY_STRETCH = Code(
    "SC388",
    "empty-stretch",
    "A stretch of paint ends where it begins, or before. `from` and `to` are measured along the road's reference line, "
    "independent of the direction of its lanes. For a line beside an entity they are measured from the entity in the "
    "direction that it faces.\n\n"
    '    <markings road="1" from="200" to="100" quality="0"/>     write from="100" to="200"',
    Severity.WARNING,
)


def check_paint(binder: Binder, scenario: Scenario) -> None:
    """Report marks on roads and lanes that the map does not have, and warn of stretches outside their road."""
    for stretch in (*scenario.markings, *scenario.secondary_markings):
        begin, end = number_value(stretch.s_from, binder.values), number_value(stretch.s_to, binder.values)
        if end <= begin:
            message = f"the stretch from {begin:g} m to {end:g} m is empty"
            binder.sink.add(EMPTY_STRETCH, message, stretch.place_of("to"))
        if not isinstance(stretch, LineBeside) and binder.on_road(stretch, stretch.road, 0.0):
            _check_on_road(binder, stretch, min(begin, end), max(begin, end))


def _check_on_road(binder: Binder, stretch: Markings | SecondaryMarkings, begin: float, end: float) -> None:
    """Warn of a stretch beyond its road's end, and report marks of a lane that does not exist along the stretch."""
    road = binder.network.road(stretch.road)
    if end > road.length:
        beyond = begin >= road.length
        s, attribute = (begin, "from") if beyond else (end, "to")
        message = f"s = {s:g} m is outside road '{stretch.road}', which is {road.length:.2f} m long"
        hint = "nothing is painted" if beyond else "the road's end is used"
        binder.sink.add(BEYOND_ROAD, message, stretch.place_of(attribute), hint=hint, severity=Severity.WARNING)
        if beyond:
            return
    if isinstance(stretch, Markings) and stretch.lane is not None:
        ends = [*(s for s, _ in road.sections[1:]), road.length]
        there = [lanes for (s, lanes), until in zip(road.sections, ends, strict=True) if s <= end and begin <= until]
        known = sorted({lane for lanes in there for lane in lanes} | {0}, reverse=True)
        if stretch.lane not in known:
            message = f"road '{stretch.road}' has no lane {stretch.lane} between s = {begin:g} m and {end:g} m"
            hint = f"lanes there: {', '.join(map(str, known))}; 0 is the centre line"
            binder.sink.add(UNKNOWN_LANE, message, stretch.place_of("lane"), hint=hint)
