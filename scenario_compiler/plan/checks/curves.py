"""Checks that the knots of a NURBS match its control points."""

from __future__ import annotations

from itertools import pairwise

from scenario_compiler.diagnostics import Code, Diagnostics
from scenario_compiler.plan.model import Plan
from scenario_compiler.roads import Network
from scenario_compiler.vocabulary.positions import Nurbs

MALFORMED_NURBS = Code(
    "SC529",
    "malformed-nurbs",
    "The NURBS of a trajectory is invalid. The number of knots must be the number of control points plus the order. "
    "There must be at least as many control points as the order. The knots must not decrease, and must not all be "
    "equal.\n\n"
    '    <nurbs order="3" knots="0 0 1 1">              3 control points and the order 3 need 6 knots\n'
    '    <nurbs order="3" knots="0 0 0 1 1 1">\n\n'
    "Correct the knots or the order.",
)


def check_curves(plan: Plan, network: Network, sink: Diagnostics) -> None:
    """Report each NURBS whose knots, order and control points do not define a curve."""
    del network
    for word in plan.words():
        if isinstance(word, Nurbs):
            fault = _fault_of(word)
            if fault:
                sink.add(MALFORMED_NURBS, fault, word.origin)


def _fault_of(curve: Nurbs) -> str:
    """Return the reason why a NURBS does not define a curve; empty if it does."""
    points, order, knots = len(curve.points), curve.order, curve.knots
    if points < order:
        return f"a NURBS of the order {order} needs at least {order} control points, not {points}"
    if len(knots) != points + order:
        return (
            f"a NURBS of the order {order} with {points} control points needs {points + order} knots, not {len(knots)}"
        )
    if any(later < one for one, later in pairwise(knots)):
        return "the knots of a NURBS must not decrease"
    if knots[order - 1] >= knots[points]:
        return "the knots of a NURBS must not all be equal"
    return ""
