"""Reference line, elevation and lateral profile: from (road, s, t) to a pose.

A line and an arc are evaluated in closed form; a spiral is stored as short pieces (`parse` cuts them) over which the
three-point Gauss-Legendre rule is exact to 1e-9 m; poly3 and paramPoly3 are evaluated at the parameter that belongs to
the arc length s, to 1 mm (`curve_build`). If the stated length of a paramPoly3 is not its arc length, s runs evenly
from its start to its end, as in esmini.

The cross-section is rolled by superelevation about the reference line (`lateral_axis`).
Pitch and roll follow ISO 8855: pitch is positive nose down, roll is positive with the
left side up.
"""

from math import atan, atan2, cos, pi, sin, sqrt, tau

from scenario_compiler.marker import compiled
from scenario_compiler.roads.tables import ARC, LINE, POLYNOMIAL, RoadTables

GAUSS_NODE = sqrt(0.6)
GAUSS_OUTER = 5.0 / 18.0
GAUSS_INNER = 8.0 / 18.0
SMALL_ANGLE = 1e-9
MIN_SPEED = 1e-12

CORNER = 0.01
"""Change of heading between two pieces of a reference line from which it has a corner there, rad; less is imprecision.
"""


@compiled
def wrap_heading(h: float) -> float:
    """Return an angle in [0, 2 pi); nearly all are there already."""
    if h >= 0.0 and h < tau:
        return h + 0.0  # -0.0 becomes 0.0, as by the modulo
    w = h % tau
    if w >= tau:
        w = 0.0
    return w


@compiled
def wrap_angle(a: float) -> float:
    """Return an angle in [-pi, pi)."""
    return (a + pi) % tau - pi


@compiled
def road_piece_at(n: RoadTables, road: int, s: float) -> int:
    """Return the row of the piece that contains s: the last that starts at or before it."""
    first = n.road_cell[road]
    cells = n.road_cell[road + 1] - first
    c = 0
    if cells > 1 and s > 0.0:
        at = s * n.road_cell_scale[road]
        c = cells - 1
        if at < c:
            c = int(at)
    low = n.cell_piece[first + c]
    high = n.road_piece[road + 1] - 1
    if c + 1 < cells:
        high = n.cell_piece[first + c + 1]
    while low < high:
        middle = (low + high + 1) // 2
        if n.piece_s[middle] <= s:
            low = middle
        else:
            high = middle - 1
    return low


@compiled
def piece_point(n: RoadTables, piece: int, s: float) -> tuple[float, float, float, float, float]:
    """Return (x, y, heading, curvature, speed) at s on a piece.

    Speed is the length of d(x, y)/ds: 1, on polynomials nearly so, unless their stated length is wrong.
    """
    d = s - n.piece_s[piece]
    kind = n.piece_kind[piece]
    h = n.piece_h[piece]
    if kind == LINE:
        return n.piece_x[piece] + d * n.piece_cos[piece], n.piece_y[piece] + d * n.piece_sin[piece], h, 0.0, 1.0
    if kind == POLYNOMIAL:
        return polynomial_point(n, piece, d)
    k = n.piece_k[piece]
    if kind == ARC:
        half = 0.5 * k * d
        chord = d
        if half > SMALL_ANGLE or half < -SMALL_ANGLE:
            chord = d * sin(half) / half
        a = h + half
        return n.piece_x[piece] + chord * cos(a), n.piece_y[piece] + chord * sin(a), h + k * d, k, 1.0
    half_rate = 0.5 * n.piece_dk[piece]
    u0 = 0.5 * (1.0 - GAUSS_NODE) * d
    u1 = 0.5 * d
    u2 = 0.5 * (1.0 + GAUSS_NODE) * d
    a0 = h + (k + half_rate * u0) * u0
    a1 = h + (k + half_rate * u1) * u1
    a2 = h + (k + half_rate * u2) * u2
    x = n.piece_x[piece] + d * (GAUSS_OUTER * (cos(a0) + cos(a2)) + GAUSS_INNER * cos(a1))
    y = n.piece_y[piece] + d * (GAUSS_OUTER * (sin(a0) + sin(a2)) + GAUSS_INNER * sin(a1))
    return x, y, h + (k + half_rate * d) * d, k + 2.0 * half_rate * d, 1.0


@compiled
def polynomial_derivatives(n: RoadTables, q: int, at: float) -> tuple[float, float]:
    """Return (du/dp, dv/dp) of a parametric polynomial at a parameter."""
    u = n.poly_bu[q] + at * (2.0 * n.poly_cu[q] + 3.0 * at * n.poly_du[q])
    v = n.poly_bv[q] + at * (2.0 * n.poly_cv[q] + 3.0 * at * n.poly_dv[q])
    return u, v


@compiled
def polynomial_parameter(n: RoadTables, q: int, d: float) -> tuple[float, float]:
    """Return (p, dp/ds) of a parametric polynomial at the distance d from its start; beyond its ends p is linear."""
    first = n.poly_knot[q]
    last = n.poly_knot[q + 1] - 2
    at = d * n.poly_scale[q]
    k = first
    if at > 0.0:
        k = last
        if at < last - first:
            k = first + int(at)
    x = at - (k - first)
    inside = x
    if inside < 0.0:
        inside = 0.0
    if inside > 1.0:
        inside = 1.0
    slope = n.knot_slope[k]
    rise = n.knot_p[k + 1] - n.knot_p[k]
    b = 3.0 * rise - 2.0 * slope - n.knot_slope[k + 1]
    c = slope + n.knot_slope[k + 1] - 2.0 * rise
    p = n.knot_p[k] + inside * (slope + inside * (b + inside * c))
    rate = slope + inside * (2.0 * b + 3.0 * inside * c)
    return p + (x - inside) * rate, rate * n.poly_scale[q]


@compiled
def polynomial_point(n: RoadTables, piece: int, d: float) -> tuple[float, float, float, float, float]:
    """Return the same as `piece_point`, for a parametric polynomial at the distance d from the piece's start."""
    q = n.piece_poly[piece]
    p, rate = polynomial_parameter(n, q, d)
    u = n.poly_au[q] + p * (n.poly_bu[q] + p * (n.poly_cu[q] + p * n.poly_du[q]))
    v = n.poly_av[q] + p * (n.poly_bv[q] + p * (n.poly_cv[q] + p * n.poly_dv[q]))
    u1, v1 = polynomial_derivatives(n, q, p)
    u2 = 2.0 * n.poly_cu[q] + 6.0 * p * n.poly_du[q]
    v2 = 2.0 * n.poly_cv[q] + 6.0 * p * n.poly_dv[q]
    h = n.piece_h[piece]
    c = cos(h)
    w = sin(h)
    speed = sqrt(u1 * u1 + v1 * v1)
    turn = 0.0
    curvature = 0.0
    if speed > MIN_SPEED:
        turn = atan2(v1, u1)
        curvature = (u1 * v2 - v1 * u2) / (speed * speed * speed)
    x = n.piece_x[piece] + u * c - v * w
    y = n.piece_y[piece] + u * w + v * c
    return x, y, h + turn, curvature, speed * rate


@compiled
def road_reference(n: RoadTables, road: int, s: float) -> tuple[float, float, float, float]:
    """Return (x, y, heading, curvature) of the reference line; the heading is not wrapped."""
    x, y, h, k, _ = piece_point(n, road_piece_at(n, road, s), s)
    return x, y, h, k


@compiled
def piece_curvature(n: RoadTables, piece: int, s: float) -> float:
    """Return the curvature of a piece at s, 1/m, positive to the left."""
    if n.piece_kind[piece] == POLYNOMIAL:
        _, _, _, curvature, _ = polynomial_point(n, piece, s - n.piece_s[piece])
        return curvature
    return n.piece_k[piece] + n.piece_dk[piece] * (s - n.piece_s[piece])


@compiled
def piece_heading(n: RoadTables, piece: int, s: float) -> float:
    """Return the heading of a piece at s, not wrapped."""
    d = s - n.piece_s[piece]
    if n.piece_kind[piece] == POLYNOMIAL:
        _, _, h, _, _ = polynomial_point(n, piece, d)
        return h
    return n.piece_h[piece] + (n.piece_k[piece] + 0.5 * n.piece_dk[piece] * d) * d


@compiled
def road_heading(n: RoadTables, road: int, s: float) -> float:
    """Return the heading of the reference line at s, not wrapped."""
    return piece_heading(n, road_piece_at(n, road, s), s)


@compiled
def road_curvature(n: RoadTables, road: int, s: float) -> float:
    """Return the curvature of the reference line, 1/m, positive to the left."""
    return piece_curvature(n, road_piece_at(n, road, s), s)


@compiled
def corners_near(n: RoadTables, road: int, s: float, within: float) -> float:
    """Return by how much the reference line turns at the corners within a distance of s, rad, positive to the left."""
    first = n.road_piece[road]
    last = n.road_piece[road + 1]
    piece = road_piece_at(n, road, s)
    turned = 0.0
    before = piece
    while before > first and s - n.piece_s[before] < within:
        turned = turned + corner_at(n, before)
        before = before - 1
    beyond = piece + 1
    while beyond < last and n.piece_s[beyond] - s < within:
        turned = turned + corner_at(n, beyond)
        beyond = beyond + 1
    return turned


@compiled
def corner_at(n: RoadTables, piece: int) -> float:
    """Return by how much the reference line turns where a piece follows another one, rad; 0 if that is no corner."""
    turned = wrap_angle(n.piece_h[piece] - piece_heading(n, piece - 1, n.piece_s[piece]))
    return turned if abs(turned) > CORNER else 0.0


@compiled
def cubic_row(n: RoadTables, first: int, last: int, s: float) -> int:
    """Return the last cubic of a non-empty range that starts at or before s, or else the first one."""
    low = first
    high = last - 1
    while low < high:
        middle = (low + high + 1) // 2
        if n.cubic_s[middle] <= s:
            low = middle
        else:
            high = middle - 1
    return low


@compiled
def cubic_value(n: RoadTables, first: int, last: int, s: float) -> float:
    """Return the value of a range of cubics at s; 0 for an empty range, constant before the first."""
    if first >= last:
        return 0.0
    c = first
    if last - first > 1:
        c = cubic_row(n, first, last, s)
    d = s - n.cubic_s[c]
    if d < 0.0:
        d = 0.0
    return n.cubic_a[c] + d * (n.cubic_b[c] + d * (n.cubic_c[c] + d * n.cubic_d[c]))


@compiled
def cubic_slope(n: RoadTables, first: int, last: int, s: float) -> float:
    """Return the derivative of a range of cubics at s."""
    if first >= last:
        return 0.0
    c = first
    if last - first > 1:
        c = cubic_row(n, first, last, s)
    d = s - n.cubic_s[c]
    if d < 0.0:
        return 0.0
    return n.cubic_b[c] + d * (2.0 * n.cubic_c[c] + 3.0 * d * n.cubic_d[c])


@compiled
def road_elevation(n: RoadTables, road: int, s: float) -> float:
    """Return z of the reference line, m."""
    return cubic_value(n, n.road_elevation_first[road], n.road_elevation_last[road], s)


@compiled
def road_grade(n: RoadTables, road: int, s: float) -> float:
    """Return dz/ds of the reference line, positive uphill along s."""
    return cubic_slope(n, n.road_elevation_first[road], n.road_elevation_last[road], s)


@compiled
def road_superelevation(n: RoadTables, road: int, s: float) -> float:
    """Return the roll of the road about its reference line, rad, positive with the left side up."""
    return cubic_value(n, n.road_superelevation_first[road], n.road_superelevation_last[road], s)


@compiled
def shape_station(n: RoadTables, road: int, s: float) -> int:
    """Return the last station of a road's lateral shape at or before s; the road must have one."""
    low = n.road_shape[road]
    high = n.road_shape[road + 1] - 1
    while low < high:
        middle = (low + high + 1) // 2
        if n.shape_s[middle] <= s:
            low = middle
        else:
            high = middle - 1
    return low


@compiled
def lateral_shape(n: RoadTables, road: int, s: float, t: float) -> tuple[float, float]:
    """Return (height, slope dz/dt) that shape and crossfall add at t.

    Shapes are interpolated linearly between their stations.
    """
    z = 0.0
    slope = 0.0
    if n.road_shape[road] < n.road_shape[road + 1]:
        a = shape_station(n, road, s)
        z = cubic_value(n, n.shape_first[a], n.shape_last[a], t)
        slope = cubic_slope(n, n.shape_first[a], n.shape_last[a], t)
        b = a + 1
        if b < n.road_shape[road + 1] and s > n.shape_s[a] and n.shape_s[b] > n.shape_s[a]:
            share = (s - n.shape_s[a]) / (n.shape_s[b] - n.shape_s[a])
            z = z + share * (cubic_value(n, n.shape_first[b], n.shape_last[b], t) - z)
            slope = slope + share * (cubic_slope(n, n.shape_first[b], n.shape_last[b], t) - slope)
    fall = 0.0
    if t > 0.0:
        fall = -cubic_value(n, n.road_crossfall_left_first[road], n.road_crossfall_left_last[road], s)
    if t < 0.0:
        fall = cubic_value(n, n.road_crossfall_right_first[road], n.road_crossfall_right_last[road], s)
    if fall != 0.0:
        z = z + t * sin(fall)
        slope = slope + sin(fall)
    return z, slope


@compiled
def lateral_axis(n: RoadTables, road: int, s: float) -> tuple[float, float, float]:
    """Return the axis of t as (along, across, up) the reference line in the plane; a unit vector.

    The road's frame is turned by its heading, then pitched, then rolled, so on a slope the rolled cross-section also
    leans along the line, as in esmini. Before the road's start the axis is that of its start. The axis is
    (sin pitch sin roll, cos roll, cos pitch sin roll).
    """
    if n.road_superelevation_first[road] >= n.road_superelevation_last[road]:
        return 0.0, 1.0, 0.0
    at = s
    if at < 0.0:
        at = 0.0
    roll = road_superelevation(n, road, at)
    grade = road_grade(n, road, at)
    cos_pitch = 1.0 / sqrt(1.0 + grade * grade)
    sin_roll = sin(roll)
    return -grade * cos_pitch * sin_roll, cos(roll), cos_pitch * sin_roll


@compiled
def road_frame(n: RoadTables, road: int, s: float, t: float) -> tuple[float, float, float, float, float]:
    """Return (along, across, z, pitch, roll) of the road surface at (s, t).

    Along and across are the displacement in the plane from the reference line at s, in its direction and to its left,
    m.
    """
    if n.road_flat[road] == 1:
        return 0.0, t, 0.0, 0.0, 0.0
    along, across, up = lateral_axis(n, road, s)
    rise, slope = lateral_shape(n, road, s, t)
    z = road_elevation(n, road, s) + t * up + rise
    pitch = -atan(road_grade(n, road, s))
    return t * along, t * across, z, pitch, road_superelevation(n, road, s) + atan(slope)


@compiled
def road_pose(n: RoadTables, road: int, s: float, t: float) -> tuple[float, float, float, float, float, float]:
    """Return (x, y, z, heading along s, pitch, roll) of the point (s, t) on the road surface."""
    piece = road_piece_at(n, road, s)
    x, y, h, _, _ = piece_point(n, piece, s)
    along, across, z, pitch, roll = road_frame(n, road, s, t)
    c = n.piece_cos[piece]
    w = n.piece_sin[piece]
    if h != n.piece_h[piece]:
        c = cos(h)
        w = sin(h)
    return x + along * c - across * w, y + along * w + across * c, z, wrap_heading(h), pitch, roll
