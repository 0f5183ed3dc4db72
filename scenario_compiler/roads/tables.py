"""`RoadTables`: a whole road network as flat columns, the container `n` of every marked road function.

Ragged data is in CSR form: the rows of owner `i` in a child table are `start[i] .. start[i + 1] - 1`. Ranges into the
pool of cubics are given by `*_first` and `*_last` (exclusive), because lanes may share them. Indices are 0-based, -1 is
"none". Lengths are in metres, angles in radians, OpenDRIVE axes (x east, y north, z up).
"""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.forms.arrays import BothForms
from scenario_compiler.forms.declaration import (
    FLAG,
    Allowed,
    Of,
    codes,
    column,
    container,
    index,
    index_or_none,
    row_starts,
    whole,
)
from scenario_compiler.roads.lane_types import LANE_TYPES, ROAD_TYPES

LINE = 0
ARC = 1
SPIRAL = 2
POLYNOMIAL = 3

AT_START = 0
AT_END = 1

LANE_LIMIT = 1 << 20
"""Magnitude that no lane's id reaches."""

NO_SPEED = -1.0
"""Value of a speed column if the file states no limit; `inf` is an explicit "no limit"."""

ROAD = Of("road", lambda n: len(n.road_length))
ROAD_END = Of("end of a road", lambda n: 2 * len(n.road_length))
EXIT = Of("exit", lambda n: len(n.exit_road))
PIECE = Of("piece of a reference line", lambda n: len(n.piece_s))
STRETCH = Of("stretch of s", lambda n: len(n.cell_piece))
POLYNOMIAL_PIECE = Of("polynomial", lambda n: len(n.poly_last))
KNOT = Of("knot of a polynomial", lambda n: len(n.knot_p))
CUBIC = Of("cubic", lambda n: len(n.cubic_s))
STATION = Of("station of a lateral shape", lambda n: len(n.shape_s))
TYPE = Of("road type record", lambda n: len(n.type_s))
SECTION = Of("lane section", lambda n: len(n.section_s))
LANE = Of("lane in a section", lambda n: len(n.lane_id))
LANE_END = Of("end of a lane", lambda n: 2 * len(n.lane_id))
LINK = Of("link", lambda n: len(n.link_lane))
HEIGHT = Of("height record", lambda n: len(n.height_s))
SPEED = Of("speed record", lambda n: len(n.speed_s))
MARK = Of("mark", lambda n: len(n.mark_s))
MARK_LINE = Of("line of a mark", lambda n: len(n.line_length))
CHUNK = Of("chunk", lambda n: len(n.chunk_s))
CELL = Of("cell of the plane", lambda n: len(n.cell_key))
CELL_CHUNK = Of("chunk of a cell", lambda n: len(n.chunk_of_cell))
WIDE = Of("wide chunk", lambda n: len(n.wide_chunk))

PLACE = Allowed(Of("begin or end of a range of cubics", lambda n: len(n.cubic_s) + 1))
JUNCTION = whole(-1)
CODE = whole(0, 100)
CONTACT = codes(AT_END + 1, least=-1)


@container("n", 0)
class RoadTables(BothForms):
    """The columns of a network."""

    # Roads.
    road_length: list[float] = column(ROAD)
    """Length along the reference line, m."""
    road_rule: list[int] = column(ROAD, 1, whole(-1, 2))
    """1 in right-hand traffic, -1 in left-hand traffic."""
    road_junction: list[int] = column(ROAD, -1, JUNCTION)
    """Index of the road's junction, or -1."""
    road_flat: list[int] = column(ROAD, 0, FLAG)
    """1 if height, pitch and roll are 0 everywhere."""
    road_directions: list[int] = column(ROAD, 0, FLAG)
    """1 if a lane declares a direction other than its side's."""
    road_piece: list[int] = row_starts(ROAD, PIECE)
    road_cell: list[int] = row_starts(ROAD, STRETCH)
    """Row starts of `cell_piece`, the uniform s-index."""
    road_cell_scale: list[float] = column(ROAD)
    """Cells of the s-index per metre of s."""
    road_elevation_first: list[int] = column(ROAD, 0, PLACE)
    """Range of cubics over s: z of the reference line, m."""
    road_elevation_last: list[int] = column(ROAD, 0, PLACE)
    road_superelevation_first: list[int] = column(ROAD, 0, PLACE)
    """Range of cubics over s: roll, rad."""
    road_superelevation_last: list[int] = column(ROAD, 0, PLACE)
    road_offset_first: list[int] = column(ROAD, 0, PLACE)
    """Range of cubics over s: t of the centre lane, m."""
    road_offset_last: list[int] = column(ROAD, 0, PLACE)
    road_crossfall_left_first: list[int] = column(ROAD, 0, PLACE)
    """Range of cubics over s: crossfall of a side, rad."""
    road_crossfall_left_last: list[int] = column(ROAD, 0, PLACE)
    road_crossfall_right_first: list[int] = column(ROAD, 0, PLACE)
    road_crossfall_right_last: list[int] = column(ROAD, 0, PLACE)
    road_shape: list[int] = row_starts(ROAD, STATION)
    road_section: list[int] = row_starts(ROAD, SECTION)
    road_type: list[int] = row_starts(ROAD, TYPE)
    road_start_road: list[int] = column(ROAD, -1, index_or_none(ROAD))
    """Road to which the start is linked, or -1."""
    road_start_contact: list[int] = column(ROAD, -1, CONTACT)
    """End of that road that is touched, AT_START or AT_END, or -1."""
    road_end_road: list[int] = column(ROAD, -1, index_or_none(ROAD))
    road_end_contact: list[int] = column(ROAD, -1, CONTACT)
    road_start_junction: list[int] = column(ROAD, -1, JUNCTION)
    """Junction into which the start leads, or -1."""
    road_end_junction: list[int] = column(ROAD, -1, JUNCTION)
    road_exit: list[int] = row_starts(ROAD_END, EXIT, written=True)
    """Row starts of the exits, two rows for each road (start, then end): the roads whose lanes are linked there."""
    exit_road: list[int] = column(EXIT, 0, index(ROAD), written=True)
    exit_contact: list[int] = column(EXIT, 0, CONTACT, written=True)
    """The end of that road that is touched."""

    # Reference lines.
    piece_s: list[float] = column(PIECE)
    """s, position and heading at the piece's start."""
    piece_x: list[float] = column(PIECE)
    piece_y: list[float] = column(PIECE)
    piece_h: list[float] = column(PIECE)
    piece_cos: list[float] = column(PIECE)
    """Cosine and sine of that heading."""
    piece_sin: list[float] = column(PIECE)
    piece_k: list[float] = column(PIECE)
    """Curvature at the piece's start, 1/m, and its rate, 1/m2; 0 for lines and polynomials."""
    piece_dk: list[float] = column(PIECE)
    piece_kind: list[int] = column(PIECE, 0, codes(POLYNOMIAL + 1))
    """LINE, ARC, SPIRAL or POLYNOMIAL."""
    piece_poly: list[int] = column(PIECE, -1, index_or_none(POLYNOMIAL_PIECE))
    """Row of the polynomial's coefficients, or -1."""
    cell_piece: list[int] = column(STRETCH, 0, index(PIECE))
    """Last piece that starts at or before each cell."""
    poly_au: list[float] = column(POLYNOMIAL_PIECE)
    """Coefficients of u(p) and v(p) in the frame of the piece's start."""
    poly_bu: list[float] = column(POLYNOMIAL_PIECE)
    poly_cu: list[float] = column(POLYNOMIAL_PIECE)
    poly_du: list[float] = column(POLYNOMIAL_PIECE)
    poly_av: list[float] = column(POLYNOMIAL_PIECE)
    poly_bv: list[float] = column(POLYNOMIAL_PIECE)
    poly_cv: list[float] = column(POLYNOMIAL_PIECE)
    poly_dv: list[float] = column(POLYNOMIAL_PIECE)
    poly_last: list[float] = column(POLYNOMIAL_PIECE)
    """p at the curve's end; 0 for a poly3, which ends where its length does."""
    poly_length: list[float] = column(POLYNOMIAL_PIECE)
    """Length of the curve as the file states it, m."""
    poly_knot: list[int] = row_starts(POLYNOMIAL_PIECE, KNOT, written=True)
    """Row starts of the knots of p over s, which are evenly spaced; at least two."""
    poly_scale: list[float] = column(POLYNOMIAL_PIECE, written=True)
    """Steps between knots per metre of s."""
    knot_p: list[float] = column(KNOT, written=True)
    """p, and its increase in one step at the rate that it has at the knot."""
    knot_slope: list[float] = column(KNOT, written=True)

    # Profiles.
    cubic_s: list[float] = column(CUBIC)
    """A cubic: a + b d + c d2 + d d3 with d = s - cubic_s."""
    cubic_a: list[float] = column(CUBIC)
    cubic_b: list[float] = column(CUBIC)
    cubic_c: list[float] = column(CUBIC)
    cubic_d: list[float] = column(CUBIC)
    shape_s: list[float] = column(STATION)
    """A station of the lateral shape and its cubics over t."""
    shape_first: list[int] = column(STATION, 0, PLACE)
    shape_last: list[int] = column(STATION, 0, PLACE)
    type_s: list[float] = column(TYPE)
    type_code: list[int] = column(TYPE, 0, codes(len(ROAD_TYPES)))
    type_speed: list[float] = column(TYPE)
    """Speed limit, m/s; NO_SPEED if none is stated."""

    # Lanes.
    section_s: list[float] = column(SECTION)
    section_end: list[float] = column(SECTION)
    section_road: list[int] = column(SECTION, 0, index(ROAD))
    section_left: list[int] = column(SECTION, 0, whole(0))
    """Number of its left lanes."""
    section_lane: list[int] = row_starts(SECTION, LANE)
    """Row starts of its lanes, from left to right, including the centre lane."""
    lane_id: list[int] = column(LANE, 0, whole(1 - LANE_LIMIT, LANE_LIMIT))
    lane_type: list[int] = column(LANE, 0, codes(len(LANE_TYPES)))
    """Code of the type (`lane_types`)."""
    lane_section: list[int] = column(LANE, 0, index(SECTION))
    lane_level: list[int] = column(LANE, 0, FLAG)
    lane_direction: list[int] = column(LANE, 0, codes(3))
    """0 as for the side and the traffic rule, 1 reversed, 2 both."""
    lane_width_first: list[int] = column(LANE, 0, PLACE)
    """Range of cubics over s: width, m."""
    lane_width_last: list[int] = column(LANE, 0, PLACE)
    lane_steady: list[int] = column(LANE, 0, FLAG, written=True)
    """1 if t of the lane's centre is constant in its section."""
    lane_middle: list[float] = column(LANE, written=True)
    """That t, m; 0 for other lanes."""
    lane_wide: list[float] = column(LANE, written=True)
    """Width of such a lane, which is constant too, m; 0 for other lanes."""
    lane_sense: list[int] = column(LANE, 0, written=True)
    """Direction of travel: 1 along increasing s, -1 against it."""
    lane_height: list[int] = row_starts(LANE, HEIGHT)
    lane_speed: list[int] = row_starts(LANE, SPEED)
    lane_mark: list[int] = row_starts(LANE, MARK)
    """Row starts of the marks on the lane's outer border."""
    lane_link: list[int] = row_starts(LANE_END, LINK, written=True)
    """Row starts of the links, two rows for each lane: its end of low s, then that of high s."""
    link_lane: list[int] = column(LINK, 0, index(LANE), written=True)
    link_contact: list[int] = column(LINK, 0, CONTACT, written=True)
    """The end of that lane that is touched."""
    link_turn: list[float] = column(LINK, written=True)
    """Absolute change of heading along the linked road if it lies in a junction, else 0; rad. Pi for a link to a place
    inside another road, so that travel continues on the main road.
    """
    height_s: list[float] = column(HEIGHT)
    height_inner: list[float] = column(HEIGHT)
    """Height above the road surface at the lane's inner and outer border, m."""
    height_outer: list[float] = column(HEIGHT)
    speed_s: list[float] = column(SPEED)
    speed_max: list[float] = column(SPEED)
    """Speed limit of the lane, m/s; NO_SPEED if none is stated."""

    # Marks.
    mark_s: list[float] = column(MARK)
    """Range of s that the mark covers."""
    mark_end: list[float] = column(MARK)
    mark_type: list[int] = column(MARK, 0, CODE)
    """Codes of `marks`."""
    mark_colour: list[int] = column(MARK, 0, CODE)
    mark_change: list[int] = column(MARK, 0, CODE)
    mark_width: list[float] = column(MARK)
    mark_quality_from: list[float] = column(MARK)
    """Quality at both ends, 0 (gone) to 1 (new), linear between."""
    mark_quality_to: list[float] = column(MARK)
    mark_sway_first: list[int] = column(MARK, 0, PLACE)
    """Range of cubics over s: lateral offset of the whole mark, m."""
    mark_sway_last: list[int] = column(MARK, 0, PLACE)
    mark_line: list[int] = row_starts(MARK, MARK_LINE)
    """Row starts of the explicit lines of the mark's type."""
    line_length: list[float] = column(MARK_LINE)
    """Length of a dash, m, of the gap after it (0: solid), lateral offset, start within the mark, and width, m."""
    line_space: list[float] = column(MARK_LINE)
    line_t: list[float] = column(MARK_LINE)
    line_s: list[float] = column(MARK_LINE)
    line_width: list[float] = column(MARK_LINE)
    line_colour: list[int] = column(MARK_LINE, 0, CODE)
    line_once: list[int] = column(MARK_LINE, 0, FLAG)
    """1 for a single explicit line, 0 for one that repeats."""

    # The index over the plane: short parts of reference lines, each in one piece and section, and the cells they touch.
    chunk_road: list[int] = column(CHUNK, 0, index(ROAD), written=True)
    chunk_section: list[int] = column(CHUNK, 0, index(SECTION), written=True)
    chunk_piece: list[int] = column(CHUNK, 0, index(PIECE), written=True)
    chunk_s: list[float] = column(CHUNK, written=True)
    chunk_end: list[float] = column(CHUNK, written=True)
    chunk_before: list[float] = column(CHUNK, written=True)
    """Distance beyond each end in which a point still belongs to the chunk (at a kink of the reference line), m."""
    chunk_after: list[float] = column(CHUNK, written=True)
    chunk_right: list[float] = column(CHUNK, written=True)
    """Bounds of t of the lanes, m."""
    chunk_left: list[float] = column(CHUNK, written=True)
    chunk_x0: list[float] = column(CHUNK, written=True)
    """Bounds of the surface in the plane."""
    chunk_x1: list[float] = column(CHUNK, written=True)
    chunk_y0: list[float] = column(CHUNK, written=True)
    chunk_y1: list[float] = column(CHUNK, written=True)
    cell_key: list[int] = column(CELL, 0, whole(0, 1 << 62), written=True)
    """Sorted keys of the occupied cells of the plane."""
    cell_chunk: list[int] = row_starts(CELL, CELL_CHUNK, written=True)
    chunk_of_cell: list[int] = column(CELL_CHUNK, 0, index(CHUNK), written=True)
    """The chunks that touch the cell."""
    wide_chunk: list[int] = column(WIDE, 0, index(CHUNK), written=True)
    """Chunks that are too wide for the cells and are always checked."""


@dataclass
class ParsedNetwork:
    """The result of reading a road file.

    Attributes:
        arrays: The tables, their columns as arrays.
        road_ids: Ids of the roads, by their indices in the tables.
        junction_ids: Ids of the junctions.
    """

    arrays: RoadTables
    road_ids: list[str]
    junction_ids: list[str]
