"""Where the author wrote a part of a plan, for diagnostics that arise after lowering."""

from __future__ import annotations

from scenario_compiler.diagnostics import FilePlace
from scenario_compiler.plan.model import Plan


def place_of(plan: Plan, part: str) -> FilePlace:
    """Return where a part ("entities/<id>", "controller", "takeover", "scenario") was written."""
    origin = plan.origins.get(part)
    return FilePlace(plan.name) if origin is None else FilePlace(origin.file, origin.line, origin.column)
