"""The parameters on which a route or the shape of a curve depends: with another value, there is another plan."""

from __future__ import annotations

from scenario_compiler.expressions import Expression
from scenario_compiler.vocabulary.actions import AcquirePositionAction
from scenario_compiler.vocabulary.entities import Dynamic, Ego
from scenario_compiler.vocabulary.positions import Clothoid, ControlPoint, FreePosition, RoutePosition, RouteWord
from scenario_compiler.vocabulary.traversal import parameters_in, walk
from scenario_compiler.vocabulary.word import Word


def structural_parameters(word: Word) -> set[str]:
    """Return the parameters of numbers in a word, or in words below it, from which a plan's program is built.

    These are the numbers of a destination, of a route and of a place on it, the curvatures and the length of a
    clothoid, and the weights of a NURBS. All other numbers are slots, which a program evaluates for each variant.
    """
    found: set[str] = set()
    for inner in walk(word):
        if isinstance(inner, Ego | Dynamic) and inner.destination is not None:
            found |= parameters_in(inner.destination)
        elif isinstance(inner, RouteWord):
            found |= parameters_in(inner)
        elif isinstance(inner, RoutePosition):
            found |= parameters_in(inner.place)
        elif isinstance(inner, AcquirePositionAction) and isinstance(inner.position, FreePosition):
            found |= parameters_in(inner.position)
        elif isinstance(inner, Clothoid | ControlPoint):
            found |= _names(inner, ("curvature", "curvature_rate", "length", "weight"))
    return found


def _names(word: Word, fields: tuple[str, ...]) -> set[str]:
    numbers = [getattr(word, name, None) for name in fields]
    return {name for number in numbers if isinstance(number, Expression) for name in number.names}
