"""How strongly the lines of the lane ahead stand out for a camera, piece by piece.

What is seen of a line depends on its paint, on the light and the air (`air_ahead`), on the field of view, and on what
stands before it. Dashes count with the share of the line that they paint in the long run: the detector's running means
and the time that a request takes cover several of them.
"""

from __future__ import annotations

from math import log

from scenario_compiler.engine.columns import view as at
from scenario_compiler.engine.columns.numbers import clip, safe_sqrt
from scenario_compiler.engine.columns.program import Program
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.ego.air_ahead import AHEAD_FROM, AHEAD_STEP, note_lasting
from scenario_compiler.engine.ego.lane_confidence import visibility_of
from scenario_compiler.engine.motion.path import path_ahead
from scenario_compiler.marker import compiled
from scenario_compiler.roads.lanes import lane_direction, lane_inside, row_width
from scenario_compiler.roads.marks import MARK_COLOUR_CODES, border_mark, evenly_painted, row_mark, usual_share
from scenario_compiler.roads.tables import RoadTables

CAMERA_AT = 1.9
"""Distance of the camera ahead of the reference point of a usual car, m."""

HALF_PIECE = 0.5 * AHEAD_STEP

EDGE_OF_VIEW = 0.414
WITHIN_VIEW = 0.15
"""Tangent of half the angle of view, and how far inside it a line has to lie to be seen with its sides, m."""

IN_VIEW = 1
HIDDEN = 2
"""Whether a piece of a line is in the field of view and whether something stands before it; both are added."""

ENOUGH = 3.0
STRONGEST = 8.0
SHOWN = 1.0
SHOWN_SHARE = 0.2
"""Strength from which a piece counts no more in a vote, and on its own; strength and share of a piece that is seen."""

LEAST_STRENGTH = 0.1

WHITE = 227.0
"""Brightness of white paint, grey levels of the brighter of green and red."""

YELLOW = MARK_COLOUR_CODES["yellow"]
BLUE = MARK_COLOUR_CODES["blue"]
GREEN = MARK_COLOUR_CODES["green"]
RED = MARK_COLOUR_CODES["red"]
VIOLET = MARK_COLOUR_CODES["violet"]
BLACK = MARK_COLOUR_CODES["black"]

WHOLE_WIDTH = 0.14
NARROWEST = 0.3
"""Width from which a line has its full contrast, m, and the share that the narrowest has."""

NEWEST = 0.3
"""Weight of the newest image in the running mean of the votes, as in `perception.confidence`."""

NEAR_PIECES = 7
BUT_ONE = NEAR_PIECES - 1
FAR_PIECES = 6
"""Pieces up to 18 m, which the detector's confidence is about, those but for the first, and those beyond."""


@compiled
def brightness_of(colour: int) -> float:
    """Return the brightness of paint, grey levels, as the detector sees it."""
    if colour == YELLOW:
        return 209.0
    if colour == BLUE:
        return 110.0
    if colour == GREEN:
        return 160.0
    if colour == RED:
        return 190.0
    if colour == VIOLET:
        return 150.0
    if colour == BLACK:
        return 40.0
    return WHITE


@compiled
def left_of_paint(quality: float) -> float:
    """Return the share of paint's contrast that wear leaves."""
    return min(1.12 * quality, 1.0) * (0.45 + 0.55 * quality)


@compiled
def note_clutter(st: State, pavement_left: float, pavement_right: float) -> None:
    """Note how rough the ground looks in each piece, by how far the pavement reaches to both sides, m."""
    for k in range(at.SAMPLES):
        x = AHEAD_FROM + AHEAD_STEP * k
        half = max(min(EDGE_OF_VIEW * x, 8.0), 1.0)
        left = clip((half - pavement_left) / half, 0.0, 1.0)
        right = clip((half - pavement_right) / half, 0.0, 1.0)
        meadow = 0.5 * (left + right)
        rough = st.air_hard[k] * (1.0 - meadow) + st.air_soft[k] * meadow
        clutter = 2.0 + rough + 0.8 * st.sigma[0] + st.air_streaks[0]
        stands_out = 2.0 * st.air_lit[k] / max(clutter, 1.0)
        if st.stands_out[k] != stands_out:
            st.stands_out[k] = stands_out
            st.summed[0] = 0
        if k == 2:
            note_lasting(st, at.V_MEADOW_NEAR, meadow)
        if k == 3:
            note_lasting(st, at.V_CLUTTER, log(max(clutter, 1.0)))
        if k == 6:
            note_lasting(st, at.V_MEADOW_FAR, meadow)


@compiled
def window_of(k: int) -> int:
    """Return the window of a piece: two of 4 m, then three of 6 m."""
    return k // 2 if k < 4 else 2 + (k - 4) // 3


@compiled
def window_share(k: int) -> float:
    """Return the share of a piece in its window."""
    return 0.5 if k < 4 else 1.0 / 3.0


@compiled
def see_side(st: State, base: int) -> None:
    """Write what is seen of the line of a side, whose paint and place are known in each piece.

    The sums over the pieces stay as they are where neither paint and air have changed, which `summed` says, nor the
    pieces that are in view and not hidden.
    """
    pieces = at.SAMPLES if base > 0 else 0
    stay = st.summed[0]
    for k in range(at.SAMPLES):
        x = AHEAD_FROM + AHEAD_STEP * k
        y = beside_axis(st, base, k)
        shows = IN_VIEW if abs(y) < EDGE_OF_VIEW * x - WITHIN_VIEW else 0
        if x > st.hides_at[0]:
            ray = y if base == 0 else -y
            if ray > st.hides_from[0] * x and ray < st.hides_to[0] * x:
                shows += HIDDEN
        if st.piece_shows[pieces + k] != shows:
            st.piece_shows[pieces + k] = shows
            stay = 0
    st.view[base + at.S_BESIDE] = beside_axis(st, base, 0)
    if stay == 0:
        sum_up_side(st, base)
    note_votes(st, base)


@compiled
def sum_up_side(st: State, base: int) -> None:
    """Write the features of a side that are sums over the pieces of its line."""
    side = 1 if base > 0 else 0
    pieces = at.SAMPLES * side
    tone = line_tone(st, base, st.line_colour[side])
    st.side_anew[side] = 1
    window = 0
    strength_seen = 0.0
    votes = 0.0
    farthest = 0.4
    share_seen = 0.0
    strong = 0.0
    share_hidden = 0.0
    share_in_view = 0.0
    quality_near = 0.0
    pieces_in_view = 0.0
    for k in range(at.SAMPLES):
        shows = st.piece_shows[pieces + k]
        quality = st.piece_quality[pieces + k]
        strength = tone * left_of_paint(quality) * st.stands_out[k]
        seen = st.piece_share[pieces + k] if shows == IN_VIEW else 0.0
        voted = min(strength, ENOUGH) * seen
        if window_of(k) != window:
            st.view[base + at.S_STRENGTH + window] = strength_seen
            window = window_of(k)
            strength_seen = 0.0
        strength_seen += window_share(k) * voted
        votes += voted
        pieces_in_view += shows & IN_VIEW
        if seen > SHOWN_SHARE and strength > SHOWN:
            farthest = 0.1 * (AHEAD_FROM + AHEAD_STEP * k)
        if k == 3:
            st.view[base + at.S_CONTRAST] = log(max(LEAST_STRENGTH + strength, LEAST_STRENGTH))
        if k < NEAR_PIECES:
            share_seen += seen / NEAR_PIECES
            strong += min(strength, STRONGEST) / NEAR_PIECES
            share_hidden += 1.0 / NEAR_PIECES if shows >= HIDDEN else 0.0
            share_in_view += 1.0 / NEAR_PIECES if shows & IN_VIEW == IN_VIEW else 0.0
            if k > 0:
                quality_near += quality / BUT_ONE
    st.view[base + at.S_STRENGTH + window] = strength_seen
    st.view[base + at.S_FARTHEST] = farthest
    st.view[base + at.S_SEEN] = share_seen
    st.view[base + at.S_STRONG] = strong
    st.view[base + at.S_HIDDEN] = share_hidden
    st.view[base + at.S_IN_VIEW] = share_in_view
    st.view[base + at.S_QUALITY] = quality_near
    st.view[base + at.S_VOTES] = votes / max(safe_sqrt(pieces_in_view), 1.0)


@compiled
def note_votes(st: State, base: int) -> None:
    """Note the running mean over the images of a side's votes, which are per square root of the pieces in view."""
    share = NEWEST if st.view_looks[0] > 0 else 1.0
    st.view[base + at.S_VOTES_LATELY] += share * (st.view[base + at.S_VOTES] - st.view[base + at.S_VOTES_LATELY])


@compiled
def line_tone(st: State, base: int, colour: int) -> float:
    """Return how much a side's new paint is brighter than the ground, grey levels; 0 where no line is."""
    width = st.view[base + at.S_WIDTH]
    if width <= 0.0:
        width = WHOLE_WIDTH
    brighter = max(brightness_of(colour) - st.air_ground[0], 0.0)
    return brighter * st.air_contrast[0] * clip(width / WHOLE_WIDTH, NARROWEST, 1.0)


@compiled
def lay_piece(st: State, k: int, half: float) -> None:
    """Note where the lane's lines lie in a piece: half of its width, and its centre beside the ego's axis, m.

    The way is a curve whose bend changes evenly.
    """
    d = CAMERA_AT + AHEAD_FROM + AHEAD_STEP * k
    centre = -st.path_off[0] - st.path_heading[0] * d
    centre += d * d * (0.5 * st.way_bend[0] + d * st.way_bend_rate[0] / 6.0)
    st.way_half[k] = half
    st.way_centre[k] = centre


@compiled
def beside_axis(st: State, base: int, k: int) -> float:
    """Return how far a side's line lies beside the ego's axis in a piece, m."""
    return st.way_half[k] + st.way_centre[k] if base == 0 else st.way_half[k] - st.way_centre[k]


@compiled
def lay_lines(n: RoadTables, p: Program, st: State) -> None:
    """Note the place and the paint of both lines, piece by piece as the way goes on."""
    near = 0.0
    far = 0.0
    half = 0.5 * st.lane_width[0]
    for k in range(at.SAMPLES):
        ahead = CAMERA_AT + AHEAD_FROM + AHEAD_STEP * k
        road, lane, row, s, rest = path_ahead(n, p, st, ahead)
        outer = 0.0
        inner = 0.0
        outer_share = 0.0
        inner_share = 0.0
        if rest <= 0.0 and row >= 0:
            half = 0.5 * row_width(n, row, s)
            inside = lane_inside(lane)
            outer_mark = row_mark(n, row, s)
            inner_mark = border_mark(n, n.lane_section[row], inside, s)
            outer_share = usual_share(n, outer_mark, s - HALF_PIECE, s + HALF_PIECE)
            inner_share = usual_share(n, inner_mark, s - HALF_PIECE, s + HALF_PIECE)
            outer = visibility_of(n, p, outer_mark, road, lane, s)
            inner = visibility_of(n, p, inner_mark, road, inside, s)
        if rest <= 0.0 and n.road_junction[road] >= 0:
            if k < NEAR_PIECES:
                near += 1.0 / NEAR_PIECES
            else:
                far += 1.0 / FAR_PIECES
        lay_piece(st, k, half)
        outer_is_left = (lane > 0) == (lane_direction(n, road, lane, s) > 0)
        st.piece_quality[k] = outer if outer_is_left else inner
        st.piece_quality[at.SAMPLES + k] = inner if outer_is_left else outer
        st.piece_share[k] = outer_share if outer_is_left else inner_share
        st.piece_share[at.SAMPLES + k] = inner_share if outer_is_left else outer_share
    st.view[at.V_JUNCTION_NEAR] = near
    st.view[at.V_JUNCTION_FAR] = far


@compiled
def lay_even_line(n: RoadTables, st: State, first: int, mark: int, quality: float) -> None:
    """Note the paint in the pieces of a line whose mark and quality are the same in all of them.

    `first` is the first piece of its side. Where the share that is painted differs between pieces, `view_dashed`
    becomes 1; where it may differ from place to place, `lines_laid` becomes 0.
    """
    even = evenly_painted(n, mark)
    if even == 0:
        st.lines_laid[0] = 0
    share = 0.0
    for k in range(at.SAMPLES):
        if k == 0 or even == 0:
            s = st.path_s[0] + st.path_sense[0] * (CAMERA_AT + AHEAD_FROM + AHEAD_STEP * k)
            share = usual_share(n, mark, s - HALF_PIECE, s + HALF_PIECE)
        st.piece_share[first + k] = share
        st.piece_quality[first + k] = quality
        if share != st.piece_share[first]:
            st.view_dashed[0] = 1


@compiled
def lay_even_lines(n: RoadTables, st: State) -> None:
    """Note the paint of both lines where the marks on both sides are known to stay as they are."""
    row = st.path_row[0]
    lane = st.path_lane[0]
    here = st.path_s[0]
    outer = row_mark(n, row, here)
    inner = border_mark(n, n.lane_section[row], lane_inside(lane), here)
    outer_is_left = (lane > 0) == (st.path_sense[0] > 0)
    st.view_dashed[0] = 0
    st.lines_laid[0] = 1
    lay_even_line(n, st, 0, outer if outer_is_left else inner, st.even_left[0])
    lay_even_line(n, st, at.SAMPLES, inner if outer_is_left else outer, st.even_right[0])
    inside_junction = 1.0 if n.road_junction[st.path_road[0]] >= 0 else 0.0
    st.view[at.V_JUNCTION_NEAR] = inside_junction
    st.view[at.V_JUNCTION_FAR] = inside_junction


@compiled
def lay_way(n: RoadTables, st: State) -> None:
    """Note the place of both lines where they follow the path's lane."""
    for k in range(at.SAMPLES):
        s = st.path_s[0] + st.path_sense[0] * (CAMERA_AT + AHEAD_FROM + AHEAD_STEP * k)
        lay_piece(st, k, 0.5 * row_width(n, st.path_row[0], s))
