"""Finds the parameter of each polynomial curve from its arc length, and stores it at evenly spaced knots.

The standard's s is the arc length of the reference line. The parameter p of a paramPoly3 (and u of a poly3) is not, and
has no closed form. Between two knots p is the cubic of s with the right values and slopes at both; a curve has so many
knots that its speed along s is 1 within `SPEED_TOLERANCE` everywhere.
"""

from math import sqrt

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import MIN_SPEED, polynomial_derivatives
from scenario_compiler.roads.tables import RoadTables

SPEED_TOLERANCE = 5e-4
"""Greatest deviation of the speed along s from 1."""

PLACE_TOLERANCE = 1e-3
"""Greatest product of that deviation and the distance of two knots, m. Places err by about a third of it."""

STEPS_LIMIT = 512
"""Greatest number of steps of one curve; it is reached where a curve stands still or is far longer than roads are."""

KNOTS_LIMIT = 1_000_000
"""Number of knots of a network after which curves have one step; limits the memory, far beyond any real network."""

SHORTEST = 1e-9
"""Length below which a curve is a point, m."""

LONGEST = 1e300
"""Length of a curve that is too long for numbers, m."""

PANELS_LIMIT = 256
"""Greatest number of parts of a curve for its length."""

LENGTH_TOLERANCE = 1e-8
"""Relative change of a curve's length, between two numbers of parts, at which it is exact to far less."""

STEP_TOLERANCE = 1e-5
"""Relative error of a step's length after which Newton's method has less than its square left."""

SEARCH_LIMIT = 40
"""Greatest number of steps of the search for a parameter."""

OUTER = 0.9061798459386640
INNER = 0.5384693101056831
OUTER_WEIGHT = 0.2369268850561891
INNER_WEIGHT = 0.4786286704993665
MIDDLE_WEIGHT = 0.5688888888888889
"""Nodes and weights of the five-point Gauss-Legendre rule on [-1, 1] (Abramowitz and Stegun, table 25.4)."""


@compiled
def curve_speed(n: RoadTables, q: int, at: float) -> float:
    """Return the length of d(u, v)/dp of a polynomial at a parameter."""
    u, v = polynomial_derivatives(n, q, at)
    return sqrt(u * u + v * v)


@compiled
def arc_length(n: RoadTables, q: int, low: float, high: float) -> float:
    """Return the length of a short part of a polynomial, m."""
    half = 0.5 * (high - low)
    middle = 0.5 * (low + high)
    outer = curve_speed(n, q, middle - half * OUTER) + curve_speed(n, q, middle + half * OUTER)
    inner = curve_speed(n, q, middle - half * INNER) + curve_speed(n, q, middle + half * INNER)
    return half * (OUTER_WEIGHT * outer + INNER_WEIGHT * inner + MIDDLE_WEIGHT * curve_speed(n, q, middle))


@compiled
def curve_length(n: RoadTables, q: int) -> float:
    """Return the length of a curve, m; 0 if it cannot be followed. A poly3 has the stated length."""
    if not (n.poly_length[q] > SHORTEST):
        return 0.0
    last = n.poly_last[q]
    if last == 0.0:
        return n.poly_length[q]
    before = -1.0
    length = arc_length(n, q, 0.0, last)
    panels = 1
    while panels < PANELS_LIMIT and abs(length - before) > LENGTH_TOLERANCE * length:
        before = length
        panels = 2 * panels
        length = 0.0
        for i in range(panels):
            length = length + arc_length(n, q, last * i / max(panels, 1), last * (i + 1) / max(panels, 1))
    if length > SHORTEST and length < LONGEST:
        return length
    return 0.0


@compiled
def next_knot(n: RoadTables, q: int, start: float, step: float) -> float:
    """Return the parameter at an arc length of `step` after that of another one, m; at most the curve's end."""
    low = start
    high = n.poly_last[q]
    if high == 0.0:
        high = start + step
    half = 0.5 * step / max(curve_speed(n, q, start), MIN_SPEED)
    at = start + step / max(curve_speed(n, q, start + half), MIN_SPEED)
    for _ in range(SEARCH_LIMIT):
        if not (at > low and at < high):
            at = 0.5 * (low + high)
        rest = step - arc_length(n, q, start, at)
        if rest > 0.0:
            low = at
        else:
            high = at
        at = at + rest / max(curve_speed(n, q, at), MIN_SPEED)
        if abs(rest) <= STEP_TOLERANCE * step:
            break
    return max(low, min(at, high))


@compiled
def step_is_even(n: RoadTables, q: int, low: float, high: float, step: float) -> int:
    """Return 1 if the cubic between two knots, `step` metres apart, has the speed 1 along s.

    It is checked near the places where the leading terms of its deviation are greatest; at both knots that is 0.
    """
    first = step / max(curve_speed(n, q, low), MIN_SPEED)
    final = step / max(curve_speed(n, q, high), MIN_SPEED)
    rise = high - low
    c = 3.0 * rise - 2.0 * first - final
    d = first + final - 2.0 * rise
    worst = min(SPEED_TOLERANCE * step, PLACE_TOLERANCE)
    for i in range(1, 6):
        x = i / 6.0
        slope = first + x * (2.0 * c + 3.0 * x * d)
        if not (abs(curve_speed(n, q, low + x * (first + x * (c + x * d))) * slope - step) < worst):
            return 0
    return 1


@compiled
def steps_are_even(n: RoadTables, q: int, length: float, steps: int) -> int:
    """Return 1 if a number of steps suffices for a curve of a length, m."""
    step = length / max(steps, 1)
    low = 0.0
    for i in range(steps):
        high = n.poly_last[q]
        if i + 1 < steps or high == 0.0:
            high = next_knot(n, q, low, step)
        if step_is_even(n, q, low, high, step) == 0:
            return 0
        low = high
    return 1


@compiled
def count_knots(n: RoadTables) -> int:
    """Fill the row starts of the knots; return the number of knots."""
    knots = 0
    for q in range(len(n.poly_last)):
        steps = 1
        length = curve_length(n, q)
        if length > 0.0 and knots < KNOTS_LIMIT:
            while steps < STEPS_LIMIT and steps_are_even(n, q, length, steps) == 0:
                steps = min(steps + steps // 4 + 1, STEPS_LIMIT)
        knots = knots + steps + 1
        n.poly_knot[q + 1] = knots
    return knots


@compiled
def store_curve(n: RoadTables, q: int) -> None:
    """Fill the knots of a curve."""
    first = n.poly_knot[q]
    final = n.poly_knot[q + 1] - 1
    steps = final - first
    length = curve_length(n, q)
    stated = 1.0
    if n.poly_length[q] > SHORTEST:
        stated = n.poly_length[q]
    n.poly_scale[q] = steps / max(stated, SHORTEST)
    n.knot_p[first] = 0.0
    if length == 0.0:
        n.knot_p[final] = 1.0
        if n.poly_length[q] > SHORTEST:
            n.knot_p[final] = n.poly_last[q]
        n.knot_slope[first] = n.knot_p[final]
        n.knot_slope[final] = n.knot_p[final]
        return
    step = length / max(steps, 1)
    for k in range(first + 1, final + 1):
        n.knot_p[k] = n.poly_last[q]
        if k < final or n.poly_last[q] == 0.0:
            n.knot_p[k] = next_knot(n, q, n.knot_p[k - 1], step)
    for k in range(first, final + 1):
        slope = step / max(curve_speed(n, q, n.knot_p[k]), MIN_SPEED)
        if k > first:
            slope = min(slope, 3.0 * (n.knot_p[k] - n.knot_p[k - 1]))
        if k < final:
            slope = min(slope, 3.0 * (n.knot_p[k + 1] - n.knot_p[k]))
        n.knot_slope[k] = slope


@compiled
def store_knots(n: RoadTables) -> None:
    """Fill the columns of knots. Slopes are limited where a curve stands still, so that p never decreases."""
    for q in range(len(n.poly_last)):
        store_curve(n, q)
