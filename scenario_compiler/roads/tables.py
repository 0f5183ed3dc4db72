"""`RoadTables`: a whole road network as flat columns, the container `n` of every compiled road function.

Ragged data is in CSR form: the rows of owner `i` in a child table are `start[i] .. start[i + 1] - 1`. Ranges
into the pool of
cubics are given by `*_first` and `*_last` (exclusive), because lanes may share them. Indices are 0-based, -1
is "none".
Lengths are in metres, angles in radians, OpenDRIVE axes (x east, y north, z up).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import numpy as np

LINE = 0
ARC = 1
SPIRAL = 2
POLYNOMIAL = 3

AT_START = 0
AT_END = 1

NO_SPEED = -1.0
"""Speed column where the file states no limit; `inf` is an explicit "no limit"."""


class RoadTables:
    """The columns. Interpreted they are lists; `arrays()` gives the numpy form of the compiled engine.

    Attributes:
        road_length: Length along the reference line, m.
        road_rule: 1 in right-hand traffic, -1 in left-hand traffic.
        road_junction: Index of the junction that the road lies in, or -1.
        road_flat: 1 where height, pitch and roll are 0 everywhere.
        road_directions: 1 where a lane declares a direction other than its side's.
        road_piece: CSR into the pieces of the reference line.
        road_cell: CSR into `cell_piece`, the uniform s-index: the last piece that starts at or before each
            cell.
        road_cell_scale: Cells per metre of s.
        road_elevation_first, road_superelevation_first, road_offset_first, road_crossfall_left_first,
        road_crossfall_right_first (and `*_last`): Ranges of cubics over s: z in m, roll in rad, lane offset
        in m, crossfall in rad.
        road_shape: CSR into the stations of the lateral shape.
        road_section: CSR into the lane sections.
        road_type: CSR into the road type records.
        road_start_road, road_start_contact, road_end_road, road_end_contact: The road that the start (end)
            is linked to and the end
            of it that is touched (`AT_START`, `AT_END`), or -1.
        road_start_junction, road_end_junction: The junction that the start (end) leads into, or -1.
        road_exit: CSR with two rows a road (start, then end) into the exits, the roads whose lanes are
            linked there.
        exit_road, exit_contact: Such a road and its end that is touched.
        piece_s, piece_x, piece_y, piece_h: s, position and heading at the piece's start.
        piece_cos, piece_sin: Cosine and sine of that heading.
        piece_k, piece_dk: Curvature there, 1/m, and its rate, 1/m2; 0 of lines and polynomials.
        piece_kind: LINE, ARC, SPIRAL or POLYNOMIAL.
        piece_poly: Row of the polynomial's coefficients, or -1.
        poly_au .. poly_dv: Coefficients of u(p) and v(p) in the frame of the piece's start.
        poly_scale: dp/ds, constant over the piece.
        cubic_s, cubic_a, cubic_b, cubic_c, cubic_d: a + b d + c d2 + d d3 with d = s - cubic_s.
        shape_s, shape_first, shape_last: A station of the lateral shape and its cubics over t.
        section_s, section_end: The section's range of s.
        section_road: The road.
        section_left: Number of its left lanes.
        section_lane: CSR into the lanes, from left to right, the centre lane included.
        lane_id, lane_type, lane_section, lane_level: As in the file (type by `lane_types`).
        lane_direction: 0 by the side and the rule, 1 reversed, 2 both.
        lane_width_first, lane_width_last: Range of cubics over absolute s, m.
        lane_steady: 1 where t of the lane's centre is the same all along its section.
        lane_middle: That t, m; 0 elsewhere.
        lane_wide: Width of such a lane, which is the same all along too, m; 0 elsewhere.
        lane_height: CSR into the height records.
        lane_speed: CSR into the lane's speed records.
        lane_mark: CSR into the marks on the lane's outer border.
        lane_link: CSR with two rows a lane (its low-s end, then its high-s end) into the links.
        link_lane: The linked lane's row.
        link_contact: The end of that lane that is touched.
        link_turn: Absolute change of heading along the linked road when it lies in a junction, else 0; rad. Pi where a
            road is linked to a place inside another one: the main road goes on.
        height_s, height_inner, height_outer: Lane height above the road surface at its inner and outer
            border, m.
        type_s, type_code, type_speed: Road type records; speed in m/s.
        speed_s, speed_max: Lane speed records, m/s.
        mark_s, mark_end: Range of s that the mark covers.
        mark_type, mark_colour, mark_change, mark_width: Codes of `marks`; width in m.
        mark_quality_from, mark_quality_to: Quality at both ends, 0 (gone) to 1 (new), linear between.
        mark_sway_first, mark_sway_last: Range of cubics over absolute s: lateral offset of the whole mark, m.
        mark_line: CSR into the explicit lines of the mark's type.
        line_length, line_space, line_t, line_s, line_width, line_colour: A line: dash and gap length (gap 0:
            solid), lateral offset,
            start within the mark, width in m.
        line_once: 1 for a single explicit line, 0 for one that repeats.
        chunk_road, chunk_section, chunk_piece, chunk_s, chunk_end: Short parts of the reference line, each
            in one piece and section.
        chunk_before, chunk_after: How far beyond each end a point still belongs to it (over a kink of the
            reference line), m.
        chunk_right, chunk_left: Bounds of t of the lanes, m.
        chunk_x0, chunk_x1, chunk_y0, chunk_y1: Bounds of the surface in the plane.
        cell_key: Sorted keys of the occupied cells of the plane.
        cell_chunk: CSR into `chunk_of_cell`.
        chunk_of_cell: The chunks that touch the cell.
        wide_chunk: Chunks too wide for the cells; they are always looked at.
    """

    __slots__ = (
        *(
            "road_length",
            "road_rule",
            "road_junction",
            "road_flat",
            "road_directions",
            "road_piece",
            "road_cell",
        ),
        *("road_cell_scale", "road_elevation_first", "road_elevation_last", "road_superelevation_first"),
        *("road_superelevation_last", "road_offset_first", "road_offset_last", "road_crossfall_left_first"),
        *(
            "road_crossfall_left_last",
            "road_crossfall_right_first",
            "road_crossfall_right_last",
            "road_shape",
        ),
        *("road_section", "road_type", "road_start_road", "road_start_contact", "road_end_road"),
        *(
            "road_end_contact",
            "road_start_junction",
            "road_end_junction",
            "road_exit",
            "exit_road",
            "exit_contact",
        ),
        *("piece_s", "piece_x", "piece_y", "piece_h", "piece_cos", "piece_sin", "piece_k"),
        *("piece_dk", "piece_kind", "piece_poly"),
        *(
            "cell_piece",
            "poly_au",
            "poly_bu",
            "poly_cu",
            "poly_du",
            "poly_av",
            "poly_bv",
            "poly_cv",
            "poly_dv",
        ),
        *("poly_scale", "cubic_s", "cubic_a", "cubic_b", "cubic_c", "cubic_d", "shape_s", "shape_first"),
        *(
            "shape_last",
            "section_s",
            "section_end",
            "section_road",
            "section_left",
            "section_lane",
            "lane_id",
        ),
        *("lane_type", "lane_section", "lane_level", "lane_direction", "lane_width_first", "lane_width_last"),
        *("lane_steady", "lane_middle", "lane_wide"),
        *("lane_height", "lane_speed", "lane_mark", "lane_link", "link_lane", "link_contact", "link_turn"),
        *("height_s", "height_inner", "height_outer", "type_s", "type_code", "type_speed", "speed_s"),
        *("speed_max", "mark_s", "mark_end", "mark_type", "mark_colour", "mark_change", "mark_width"),
        *(
            "mark_quality_from",
            "mark_quality_to",
            "mark_sway_first",
            "mark_sway_last",
            "mark_line",
            "line_length",
            "line_space",
            "line_t",
            "line_s",
        ),
        *("line_width", "line_colour", "line_once", "chunk_road", "chunk_section", "chunk_piece", "chunk_s"),
        *("chunk_end", "chunk_before", "chunk_after", "chunk_right", "chunk_left", "chunk_x0", "chunk_x1"),
        *("chunk_y0", "chunk_y1", "cell_key", "cell_chunk", "chunk_of_cell", "wide_chunk"),
    )

    road_length: list[float]
    road_rule: list[int]
    road_junction: list[int]
    road_flat: list[int]
    road_directions: list[int]
    road_piece: list[int]
    road_cell: list[int]
    road_cell_scale: list[float]
    road_elevation_first: list[int]
    road_elevation_last: list[int]
    road_superelevation_first: list[int]
    road_superelevation_last: list[int]
    road_offset_first: list[int]
    road_offset_last: list[int]
    road_crossfall_left_first: list[int]
    road_crossfall_left_last: list[int]
    road_crossfall_right_first: list[int]
    road_crossfall_right_last: list[int]
    road_shape: list[int]
    road_section: list[int]
    road_type: list[int]
    road_start_road: list[int]
    road_start_contact: list[int]
    road_end_road: list[int]
    road_end_contact: list[int]
    road_start_junction: list[int]
    road_end_junction: list[int]
    road_exit: list[int]
    exit_road: list[int]
    exit_contact: list[int]
    piece_s: list[float]
    piece_x: list[float]
    piece_y: list[float]
    piece_h: list[float]
    piece_cos: list[float]
    piece_sin: list[float]
    piece_k: list[float]
    piece_dk: list[float]
    piece_kind: list[int]
    piece_poly: list[int]
    cell_piece: list[int]
    poly_au: list[float]
    poly_bu: list[float]
    poly_cu: list[float]
    poly_du: list[float]
    poly_av: list[float]
    poly_bv: list[float]
    poly_cv: list[float]
    poly_dv: list[float]
    poly_scale: list[float]
    cubic_s: list[float]
    cubic_a: list[float]
    cubic_b: list[float]
    cubic_c: list[float]
    cubic_d: list[float]
    shape_s: list[float]
    shape_first: list[int]
    shape_last: list[int]
    section_s: list[float]
    section_end: list[float]
    section_road: list[int]
    section_left: list[int]
    section_lane: list[int]
    lane_id: list[int]
    lane_type: list[int]
    lane_section: list[int]
    lane_level: list[int]
    lane_direction: list[int]
    lane_width_first: list[int]
    lane_width_last: list[int]
    lane_steady: list[int]
    lane_middle: list[float]
    lane_wide: list[float]
    lane_height: list[int]
    lane_speed: list[int]
    lane_mark: list[int]
    lane_link: list[int]
    link_lane: list[int]
    link_contact: list[int]
    link_turn: list[float]
    height_s: list[float]
    height_inner: list[float]
    height_outer: list[float]
    type_s: list[float]
    type_code: list[int]
    type_speed: list[float]
    speed_s: list[float]
    speed_max: list[float]
    mark_s: list[float]
    mark_end: list[float]
    mark_type: list[int]
    mark_colour: list[int]
    mark_change: list[int]
    mark_width: list[float]
    mark_quality_from: list[float]
    mark_quality_to: list[float]
    mark_sway_first: list[int]
    mark_sway_last: list[int]
    mark_line: list[int]
    line_length: list[float]
    line_space: list[float]
    line_t: list[float]
    line_s: list[float]
    line_width: list[float]
    line_colour: list[int]
    line_once: list[int]
    chunk_road: list[int]
    chunk_section: list[int]
    chunk_piece: list[int]
    chunk_s: list[float]
    chunk_end: list[float]
    chunk_before: list[float]
    chunk_after: list[float]
    chunk_right: list[float]
    chunk_left: list[float]
    chunk_x0: list[float]
    chunk_x1: list[float]
    chunk_y0: list[float]
    chunk_y1: list[float]
    cell_key: list[int]
    cell_chunk: list[int]
    chunk_of_cell: list[int]
    wide_chunk: list[int]

    def __init__(self) -> None:
        """Start with every column empty."""
        for name in self.__slots__:
            setattr(self, name, [])

    def arrays(self) -> tuple[np.ndarray, ...]:
        """Return the columns in the order of `__slots__` as arrays of float64 and int64."""
        import numpy as np

        return tuple(
            np.array(getattr(self, name), dtype=np.float64 if name in FLOAT_COLUMNS else np.int64)
            for name in self.__slots__
        )


FLOAT_COLUMNS = frozenset(name for name, kind in RoadTables.__annotations__.items() if "float" in str(kind))
"""Names of the columns that hold floats; the others hold ints."""


@dataclass
class ParsedNetwork:
    """The tables of a network and the names that its indices stand for."""

    tables: RoadTables = field(default_factory=RoadTables)
    road_ids: list[str] = field(default_factory=list)
    junction_ids: list[str] = field(default_factory=list)
