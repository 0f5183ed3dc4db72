"""The place in the author's file of a part of a plan, for diagnostics after lowering."""

from __future__ import annotations

from scenario_compiler.diagnostics import FilePlace, Place
from scenario_compiler.plan.model import Plan, PlanOrigin

LONGEST_LINE = 2000
"""Greatest length of a line whose text a plan keeps, characters; a file may be one line of many megabytes."""


def origin_at(place: Place) -> PlanOrigin:
    """Return a place for storage in a plan, with the text of its line and the places of the uses around it."""
    return PlanOrigin.model_construct(
        file=place.file,
        line=place.line,
        column=place.column,
        length=place.length,
        source_line=place.source_line if len(place.source_line) <= LONGEST_LINE else "",
        within=None if place.within is None else origin_at(place.within),
    )


def place_of(plan: Plan, part: str) -> FilePlace:
    """Return where a part ("entities/<id>", "controller", "takeover", "weather", "scenario") was written."""
    origin = plan.origins.get(part)
    return FilePlace(plan.name) if origin is None else _place(origin)


def _place(origin: PlanOrigin) -> FilePlace:
    within = None if origin.within is None else _place(origin.within)
    return FilePlace(origin.file, origin.line, origin.column, origin.length, origin.source_line, within)
