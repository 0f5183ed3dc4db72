"""Checks whether a stored plan can be run: it may combine things that `compile` never combines."""

from __future__ import annotations

from scenario_compiler.diagnostics import Diagnostics, FilePlace
from scenario_compiler.engine.program import build_program
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.store import BAD_PLAN
from scenario_compiler.roads import Network

INCONSISTENT = (ArithmeticError, AttributeError, LookupError, RecursionError, TypeError, ValueError)
"""Exceptions that a contradictory plan can cause when a program is made from it."""


def check_runnable(plan: Plan, network: Network, file: str, sink: Diagnostics) -> None:
    """Report a plan from which no program can be made, at the file from which it was read."""
    try:
        build_program(plan, network)
    except INCONSISTENT as fault:
        sink.add(BAD_PLAN, f"the plan cannot be run: {fault}", FilePlace(file))
