"""`Network`: the questions that can be asked of a road network, by ids and in values; the work is done by the compiled functions."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from scenario_compiler.diagnostics import CompileError, Diagnostics
from scenario_compiler.document import read_document
from scenario_compiler.roads import geometry, lanes, locate, marks, travel
from scenario_compiler.roads.lane_types import LANE_TYPES, ROAD_TYPES
from scenario_compiler.roads.parse import ParsedNetwork, read_network
from scenario_compiler.roads.positions import (
    LaneAt,
    LanePosition,
    Mark,
    Pose,
    RoadDescription,
)
from scenario_compiler.roads.tables import NO_SPEED, RoadTables

if TYPE_CHECKING:
    import numpy as np

END_TOLERANCE = 1e-6
"""How far beyond a road's ends s may lie before it counts as outside, m: rounding of written decimals."""


class Network:
    """A road network. Frames and units: OpenDRIVE axes, metres, radians; left and right as seen along increasing s."""

    def __init__(self, path: str, sha256: str, parsed: ParsedNetwork) -> None:
        """Wrap parsed tables; use `load_network`."""
        self.path = path
        self.sha256 = sha256
        self.name = Path(path).stem
        self.tables: RoadTables = parsed.tables
        self.road_ids = parsed.road_ids
        self.junction_ids = parsed.junction_ids
        self._index = {name: i for i, name in enumerate(parsed.road_ids)}

    def tables_as_arrays(self) -> tuple[np.ndarray, ...]:
        """Return the tables' columns as numpy arrays, in the order of `RoadTables.__slots__`."""
        return self.tables.arrays()

    def road_index(self, road: str) -> int:
        """Return the index of a road in the tables; KeyError when there is none of that id."""
        return self._index[road]

    def road(self, road: str) -> RoadDescription:
        """Describe a road; KeyError when there is none of that id."""
        n, i = self.tables, self._index[road]
        sections = tuple(
            (n.section_s[k], tuple(n.lane_id[n.section_lane[k] : n.section_lane[k + 1]]))
            for k in range(n.road_section[i], n.road_section[i + 1])
        )
        kind = n.type_code[n.road_type[i]] if n.road_type[i] < n.road_type[i + 1] else 0
        return RoadDescription(
            road,
            n.road_length[i],
            "RHT" if n.road_rule[i] > 0 else "LHT",
            self.junction_ids[n.road_junction[i]] if n.road_junction[i] >= 0 else None,
            self._neighbour(n.road_start_road[i], n.road_start_junction[i]),
            self._neighbour(n.road_end_road[i], n.road_end_junction[i]),
            sections,
            ROAD_TYPES[kind],
        )

    def _neighbour(self, road: int, junction: int) -> tuple[str, str] | None:
        if road >= 0:
            return "road", self.road_ids[road]
        return ("junction", self.junction_ids[junction]) if junction >= 0 else None

    def lane_pose(self, road: str, lane: int, s: float, offset: float = 0.0) -> Pose:
        """Return the pose at an offset to the left of a lane's centre, heading along increasing s.

        Raises:
            ValueError: When the road does not exist, s lies outside it, or it has no such lane there.
        """
        i, s = self._place(road, s)
        if lanes.lane_exists(self.tables, i, lane, s) == 0:
            raise ValueError(f"road {road} has no lane {lane} at s = {s:g}")
        return Pose(*lanes.lane_pose(self.tables, i, lane, s, offset))

    def road_pose(self, road: str, s: float, t: float) -> Pose:
        """Return the pose at (s, t) of a road, heading along increasing s; ValueError outside the road's range of s."""
        i, s = self._place(road, s)
        return Pose(*geometry.road_pose(self.tables, i, s, t))

    def _place(self, road: str, s: float) -> tuple[int, float]:
        """Return (road index, s clamped to the road); ValueError outside it."""
        i = self._index.get(road, -1)
        if i < 0:
            raise ValueError(f"there is no road {road}")
        length = self.tables.road_length[i]
        if not -END_TOLERANCE <= s <= length + END_TOLERANCE:
            raise ValueError(f"s = {s:g} lies outside road {road}, which is {length:g} m long")
        return i, min(max(s, 0.0), length)

    def locate(self, x: float, y: float, nearest: bool = False) -> list[LanePosition]:
        """Return every lane, of any type, that holds the point, nearest lane centre first; [] off the road.

        With `nearest`, the closest lane is returned for a point that no lane holds.
        """
        n = self.tables
        found = []
        for chunk in _chunks_near(n, x, y):
            kind, row, s, offset = locate.lane_on_chunk(n, chunk, x, y)
            if kind > 0:
                found.append((kind, abs(offset), row, s, offset))
        places = [self._position(row, s, offset) for row, s, offset in _distinct(n, found)]
        return places

    def _position(self, row: int, s: float, offset: float) -> LanePosition:
        n = self.tables
        return LanePosition(self.road_ids[n.section_road[n.lane_section[row]]], n.lane_id[row], s, offset)

    def lane_width(self, road: str, lane: int, s: float) -> float:
        """Return a lane's width, m; 0 where the lane does not exist. ValueError outside the road."""
        i, s = self._place(road, s)
        return lanes.lane_width(self.tables, i, lane, s)

    def curvature(self, road: str, s: float) -> float:
        """Return the curvature of the reference line, 1/m, positive to the left. ValueError outside the road."""
        i, s = self._place(road, s)
        return geometry.road_reference(self.tables, i, s)[3]

    def grade(self, road: str, s: float) -> float:
        """Return dz/ds of the reference line, positive uphill along s. ValueError outside the road."""
        i, s = self._place(road, s)
        return geometry.road_grade(self.tables, i, s)

    def speed_limit(self, road: str, lane: int, s: float) -> float | None:
        """Return the lane's speed limit, else the road's, m/s; `inf` for "no limit", None where none is stated."""
        i, s = self._place(road, s)
        n = self.tables
        row = lanes.lane_row(n, i, lane, s)
        speed = NO_SPEED
        if row >= 0:
            for k in range(n.lane_speed[row], n.lane_speed[row + 1]):
                if n.speed_s[k] <= s:
                    speed = n.speed_max[k]
        if speed == NO_SPEED:
            for k in range(n.road_type[i], n.road_type[i + 1]):
                if n.type_s[k] <= s:
                    speed = n.type_speed[k]
        return None if speed == NO_SPEED else speed

    def marks(self, road: str, lane: int, s: float) -> tuple[Mark | None, Mark | None]:
        """Return (outer mark, inner mark) of a lane at s; the inner one belongs to the lane beside it towards the centre."""
        i, s = self._place(road, s)
        inner = lane - 1 if lane > 0 else lane + 1
        return self._mark(i, lane, s), self._mark(i, inner, s) if lane != 0 else None

    def _mark(self, road: int, lane: int, s: float) -> Mark | None:
        n = self.tables
        row = marks.mark_row(n, road, lane, s)
        if row < 0:
            return None
        code, quality, colour, width = marks.mark_at(n, road, lane, s)
        change = marks.LANE_CHANGES[n.mark_change[row]]
        return Mark(marks.MARK_TYPES[code], marks.MARK_COLOURS[colour], width, quality, change)

    def lanes_at(self, road: str, s: float) -> list[LaneAt]:
        """Return the lanes at s from left to right, without the centre lane."""
        i, s = self._place(road, s)
        n = self.tables
        section = lanes.section_at(n, i, s)
        if section < 0:
            return []
        found = []
        for row in range(n.section_lane[section], n.section_lane[section + 1]):
            lane = n.lane_id[row]
            if lane != 0:
                left, right = lanes.lane_borders(n, i, lane, s)
                found.append(LaneAt(lane, LANE_TYPES[n.lane_type[row]], left, right))
        return found

    def bounds(self) -> tuple[float, float, float, float]:
        """Return (x_min, y_min, x_max, y_max) of the surface of all lanes; zeros when there is none."""
        n = self.tables
        if not n.chunk_x0:
            return 0.0, 0.0, 0.0, 0.0
        return min(n.chunk_x0), min(n.chunk_y0), max(n.chunk_x1), max(n.chunk_y1)

    def next(self, position: LanePosition, distance: float) -> LanePosition | None:
        """Return the position a distance ahead in the direction of travel (straightest exits), None beyond the lane's end."""
        i, s = self._place(position.road, position.s)
        road, lane, s, left = travel.advance(self.tables, i, position.lane, s, distance, -1)
        if left > 0.0:
            return None
        return LanePosition(self.road_ids[road], lane, s, position.offset)

    def previous(self, position: LanePosition, distance: float) -> LanePosition | None:
        """Return the position a distance behind against the direction of travel, None beyond the lane's start."""
        return self.next(position, -distance)


def _chunks_near(n: RoadTables, x: float, y: float) -> Sequence[int]:
    cell = locate.cell_at(n, x, y)
    if cell < 0:
        return n.wide_chunk
    near = n.chunk_of_cell[n.cell_chunk[cell] : n.cell_chunk[cell + 1]]
    return near + n.wide_chunk if n.wide_chunk else near


def _distinct(
    n: RoadTables, found: list[tuple[int, float, int, float, float]]
) -> list[tuple[int, float, float]]:
    """Return (row, s, offset) by distance to the lane's centre, each place once.

    A place found across a kink counts only where no lane of its road holds the point near there exactly.
    """
    found.sort()
    kept: list[tuple[float, int, float, float]] = []
    for kind, distance, row, s, offset in found:
        road = n.section_road[n.lane_section[row]]
        near = 1.0 if kind == 2 else 1e-6
        if not any(
            n.section_road[n.lane_section[other]] == road and abs(at - s) < near for _, other, at, _ in kept
        ):
            kept.append((distance, row, s, offset))
    kept.sort()
    return [(row, s, offset) for _, row, s, offset in kept]


def load_network(path: str | Path, *, cache: bool = True, sink: Diagnostics | None = None) -> Network | None:
    """Read an OpenDRIVE file.

    Args:
        path: The file.
        cache: Whether the tables may be taken from, and are put into, the user's cache.
        sink: Where findings go.

    Returns:
        The network; None when the file is unreadable and a sink was given.

    Raises:
        CompileError: When the file is unreadable and no sink was given.
    """
    findings = Diagnostics() if sink is None else sink
    document = read_document(path, findings)
    parsed = read_network(document, findings) if document is not None else None
    if document is None or parsed is None:
        if sink is None:
            raise CompileError(findings)
        return None
    sha256 = hashlib.sha256(Path(path).read_bytes()).hexdigest()
    return Network(str(path), sha256, parsed)
