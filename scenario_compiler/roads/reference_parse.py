"""Reads <planView> into the pieces of the reference line and their uniform index over s."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil, cos, inf, sin, sqrt
from operator import itemgetter

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.roads.curve_build import INNER, INNER_WEIGHT, MIDDLE_WEIGHT, OUTER, OUTER_WEIGHT
from scenario_compiler.roads.elements import PlainElement, grandchildren
from scenario_compiler.roads.reading import UNSORTED, Reader
from scenario_compiler.roads.tables import ARC, LINE, POLYNOMIAL, SPIRAL, RoadTables

UNKNOWN_GEOMETRY = Code(
    "SC308",
    "unknown-geometry",
    "A <geometry> has no child line, arc, spiral, poly3 or paramPoly3. It is read as a straight line.\n\n"
    '    <geometry s="0" x="0" y="0" hdg="0" length="50"><curve curvature="0.01"/></geometry>     <arc> is meant\n\n'
    "Add one of the five. A clothoid is a <spiral>.",
    Severity.WARNING,
)
COARSE_SPIRAL = Code(
    "SC309",
    "coarse-spiral",
    "A spiral has so many turns that an exact evaluation would need too many pieces. It is evaluated more "
    "coarsely. No real road has such a spiral, so its curvatures or its length are probably wrong.\n\n"
    '    <geometry ... length="5000"><spiral curvStart="0" curvEnd="20"/></geometry>     7958 turns\n\n'
    "Check the unit of the curvatures: 1/m, not degrees and not a radius.",
    Severity.WARNING,
)

GEOMETRY = ("s", "length", "x", "y", "hdg")
"""The attributes of a <geometry>."""

PARAM_POLY3 = ("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV")
"""The attributes of a <paramPoly3> that are coefficients."""

TURN_LIMIT = 0.1
"""Greatest change of direction in one piece of a spiral, rad. With `RATE_LIMIT` it keeps the error of the three-point
rule, length x (turn^6 + 15 (rate length^2)^3) / 2 016 000, below 1e-9 m for pieces of up to 100 m.
"""

RATE_LIMIT = 0.02
"""Largest product of a spiral piece's curvature rate and its squared length."""

PIECE_LIMIT = 2000
"""Greatest number of pieces of one spiral."""

SHORTEST_SPIRAL = 1e-12
"""Length up to which a spiral has the curvature of its start, m: the rate of a shorter one may overflow."""

ALL_PIECES_LIMIT = 200_000
"""Number of pieces of a network after which spirals are no longer cut; limits the memory, far beyond any real network.
"""

GAUSS = (
    (-OUTER, OUTER_WEIGHT),
    (-INNER, INNER_WEIGHT),
    (0.0, MIDDLE_WEIGHT),
    (INNER, INNER_WEIGHT),
    (OUTER, OUTER_WEIGHT),
)
"""Nodes and weights of the five-point Gauss-Legendre rule on [-1, 1]."""


def read_reference_line(reader: Reader, n: RoadTables, road: PlainElement, length: float) -> bool:
    """Append the pieces of a road's reference line and their index; return False if it has none."""
    elements = grandchildren(road, "planView", "geometry")
    if not elements:
        return False
    geometries = []
    last = -1.0
    for element in elements:
        s, length_of_piece, x, y, h = reader.five(element, GEOMETRY)
        if s < last:
            reader.report(UNSORTED, "s is smaller than that of the geometry before", element, "s")
        last = s
        geometries.append((s, length_of_piece, x, y, h, element))
    geometries.sort(key=itemgetter(0))
    first = len(n.piece_s)
    ends = [*(geometry[0] for geometry in geometries[1:]), inf]
    for (s, length_of_piece, x, y, h, element), end in zip(geometries, ends, strict=True):
        _append_geometry(reader, n, s, length_of_piece, x, y, h, element, end)
    n.road_piece.append(len(n.piece_s))
    _append_index(n, first, length)
    return True


def _append_geometry(
    reader: Reader,
    n: RoadTables,
    s: float,
    length: float,
    x: float,
    y: float,
    h: float,
    element: PlainElement,
    end: float,
) -> None:
    """Append the pieces of a geometry; `end` is where the next one begins, m."""
    for shape in element:
        if shape.tag == "line":
            _append_piece(n, s, x, y, h, 0.0, 0.0, LINE)
        elif shape.tag == "arc":
            k = reader.number(shape, "curvature", 0.0, limit=1e6)
            _append_piece(n, s, x, y, h, k, 0.0, LINE if k == 0.0 else ARC)
        elif shape.tag == "spiral":
            _append_spiral(reader, n, s, x, y, h, length, shape, end)
        elif shape.tag == "poly3":
            a, b, c, d = (reader.number(shape, name, 0.0) for name in "abcd")
            _append_polynomial(n, s, x, y, h, (0.0, 1.0, 0.0, 0.0, a, b, c, d), 0.0, length)
        elif shape.tag == "paramPoly3":
            last = length if shape.get("pRange") == "arcLength" else 1.0
            coefficients = [reader.number(shape, name, 0.0) for name in PARAM_POLY3]
            _append_polynomial(n, s, x, y, h, coefficients, last, length)
        else:
            continue
        return
    reader.report(UNKNOWN_GEOMETRY, "the geometry has no known shape; a line is used", element)
    _append_piece(n, s, x, y, h, 0.0, 0.0, LINE)


def _append_piece(
    n: RoadTables, s: float, x: float, y: float, h: float, k: float, dk: float, kind: int, poly: int = -1
) -> None:
    n.piece_s.append(s)
    n.piece_x.append(x)
    n.piece_y.append(y)
    n.piece_h.append(h)
    n.piece_cos.append(cos(h))
    n.piece_sin.append(sin(h))
    n.piece_k.append(k)
    n.piece_dk.append(dk)
    n.piece_kind.append(kind)
    n.piece_poly.append(poly)


def _append_spiral(
    reader: Reader,
    n: RoadTables,
    s: float,
    x: float,
    y: float,
    h: float,
    length: float,
    shape: PlainElement,
    end: float,
) -> None:
    """Cut a spiral (curvature linear in s) into pieces that are short enough to be evaluated exactly.

    The stated length may reach beyond the `end`, where the next geometry begins: the road is that one from there on.
    """
    k0 = reader.number(shape, "curvStart", 0.0, limit=1e6)
    k1 = reader.number(shape, "curvEnd", 0.0, limit=1e6)
    rate = (k1 - k0) / length if length > SHORTEST_SPIRAL else 0.0
    if rate == 0.0:
        _append_piece(n, s, x, y, h, k0, 0.0, LINE if k0 == 0.0 else ARC)
        return
    by_turn = max(abs(k0), abs(k1)) * length / TURN_LIMIT
    by_rate = length * sqrt(abs(rate) / RATE_LIMIT)
    count = max(1, ceil(max(by_turn, by_rate)))
    most = PIECE_LIMIT if len(n.piece_s) < ALL_PIECES_LIMIT else 1
    if count > most:
        reader.report(COARSE_SPIRAL, f"the spiral needs {count} pieces; {most} are used", shape)
        count = most
    step = length / count
    for i in range(count):
        if i and s + step * i >= end:
            return
        k = k0 + rate * step * i
        _append_piece(n, s + step * i, x, y, h, k, rate, SPIRAL)
        dx, dy = _advance(h, k, rate, step)
        x, y, h = x + dx, y + dy, h + (k + 0.5 * rate * step) * step


def _advance(h: float, k: float, rate: float, step: float) -> tuple[float, float]:
    """Return the displacement over a short piece of a spiral (five-point Gauss-Legendre rule)."""
    dx = dy = 0.0
    for node, weight in GAUSS:
        u = 0.5 * step * (1.0 + node)
        a = h + (k + 0.5 * rate * u) * u
        dx += weight * cos(a)
        dy += weight * sin(a)
    return 0.5 * step * dx, 0.5 * step * dy


def _append_polynomial(
    n: RoadTables,
    s: float,
    x: float,
    y: float,
    h: float,
    coefficients: Sequence[float],
    last: float,
    length: float,
) -> None:
    columns = (n.poly_au, n.poly_bu, n.poly_cu, n.poly_du, n.poly_av, n.poly_bv, n.poly_cv, n.poly_dv)
    for column, value in zip(columns, coefficients, strict=True):
        column.append(value)
    n.poly_last.append(last)
    n.poly_length.append(length)
    _append_piece(n, s, x, y, h, 0.0, 0.0, POLYNOMIAL, len(n.poly_last) - 1)


def _append_index(n: RoadTables, first: int, length: float) -> None:
    """Append the uniform s-index of the road's pieces `first ..`: as many cells as pieces."""
    pieces = len(n.piece_s) - first
    n.road_cell_scale.append(pieces / length)
    at = first
    for c in range(pieces):
        s = c * length / pieces
        while at + 1 < first + pieces and n.piece_s[at + 1] <= s:
            at += 1
        n.cell_piece.append(at)
    n.road_cell.append(len(n.cell_piece))
