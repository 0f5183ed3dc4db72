"""`Network`: queries of a road network, by ids and with values as results.

The compiled functions do the work.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, overload

from scenario_compiler.diagnostics import Code, CompileError, Diagnostics, FilePlace
from scenario_compiler.document import parse_document, read_document
from scenario_compiler.files import MAX_BYTES, read_file
from scenario_compiler.garbage_collection import paused
from scenario_compiler.roads import geometry, lanes, marks, travel
from scenario_compiler.roads.cache import read_cached, write_cached
from scenario_compiler.roads.lane_types import LANE_TYPES, ROAD_TYPES, is_drivable
from scenario_compiler.roads.locate_many import Locator
from scenario_compiler.roads.nearest import nearest_lane
from scenario_compiler.roads.positions import (
    LaneAt,
    LanePosition,
    Located,
    Mark,
    MarkStretch,
    Pose,
    RoadDescription,
    Route,
)
from scenario_compiler.roads.quality import with_mark_quality
from scenario_compiler.roads.routing import find_route
from scenario_compiler.roads.tables import AT_END, AT_START, NO_SPEED, ParsedNetwork, RoadTables

if TYPE_CHECKING:
    import numpy.typing as npt

    from scenario_compiler.roads.lane_details import LaneDetails
    from scenario_compiler.roads.model import RoadModel

CHANGED_FILE = Code(
    "SC315",
    "changed-road-file",
    "The road file was changed while a program that had loaded it was running.\n\n"
    '    network = load_network("town.xodr")     then town.xodr is written again\n\n'
    "Load the map again, and do not change the file while the program runs.",
)

END_TOLERANCE = 1e-6
"""Distance beyond a road's ends up to which s does not count as outside, m: rounding of written decimals."""


class Network:
    """A road network. Frames and units: OpenDRIVE axes, metres, radians; left and right as seen along increasing s."""

    def __init__(self, path: str, sha256: str, parsed: ParsedNetwork) -> None:
        """Wrap parsed tables; use `load_network`."""
        self.path = path
        self.sha256 = sha256
        self.name = Path(path).stem
        self._arrays = parsed.arrays
        self.road_ids = parsed.road_ids
        self.junction_ids = parsed.junction_ids
        self._model: RoadModel | None = None
        self._details: dict[tuple[str, int], list[LaneDetails]] | None = None
        self._index = {name: i for i, name in enumerate(parsed.road_ids)}

    @cached_property
    def tables(self) -> RoadTables:
        """The columns of the network as lists; `tables.in_arrays()` has them as arrays."""
        return RoadTables.of_arrays(self._arrays)

    @cached_property
    def _locator(self) -> Locator:
        return Locator(self._arrays)

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

    def model(self) -> RoadModel:
        """Return header, objects, signals, controllers, junctions and lane details, read when first asked for.

        Raises:
            CompileError: When the file can no longer be read, or has changed.
        """
        if self._model is None:
            from scenario_compiler.document import drop_namespace
            from scenario_compiler.roads.model import read_model

            findings = Diagnostics()
            raw = _read(Path(self.path), findings)
            document = None if raw is None else parse_document(raw, self.path, findings)
            if raw is None or document is None:
                raise CompileError(findings)
            if hashlib.sha256(raw).hexdigest() != self.sha256:
                findings.add(CHANGED_FILE, "the road file has changed since it was loaded", FilePlace(self.path))
                raise CompileError(findings)
            drop_namespace(document.root)
            self._model = read_model(document, findings)
        return self._model

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
        """Return every lane, of any type, that contains the point, the nearest lane centre first; [] off the road.

        With `nearest`, the closest lane is returned for a point that no lane contains.
        """
        found = self._locator.one(x, y)
        if not found and nearest:
            closest = nearest_lane(self.tables, x, y)
            found = [] if closest is None else [closest]
        return [self._position(*place) for place in found]

    def locate_many(self, xs: npt.ArrayLike, ys: npt.ArrayLike) -> Located:
        """Return the results of `locate` for many points; see `Located`."""
        import numpy as np

        start, row, s, offset = self._locator.many(np.asarray(xs, np.float64), np.asarray(ys, np.float64))
        columns = (self._arrays.section_road, self._arrays.lane_section, self._arrays.lane_id)
        road, section, lane = (np.asarray(one, np.int64) for one in columns)
        return Located(start, road[section[row]], lane[row], s, offset)

    def _position(self, row: int, s: float, offset: float) -> LanePosition:
        n = self.tables
        section, lane = n.lane_section[row], n.lane_id[row]
        road = n.section_road[section]
        if lanes.lane_row(n, road, lane, s) != row:  # found at the end of its section, where the next one starts
            s = min(max(s, n.section_s[section]), math.nextafter(n.section_end[section], n.section_s[section]))
        return LanePosition(self.road_ids[road], lane, s, offset)

    def lane_width(self, road: str, lane: int, s: float) -> float:
        """Return a lane's width, m; 0 if the lane does not exist. ValueError outside the road."""
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
        """Return the lane's speed limit, else the road's, m/s; `inf` for "no limit", None if none is given."""
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

    def lane_details(self, road: str, lane: int, s: float) -> LaneDetails | None:
        """Return access, rules, material and state of a lane at s; None if the file states none.

        They are read from the file when first asked for.

        Raises:
            ValueError: When s lies outside the road.
            CompileError: When the file can no longer be read, or has changed.
        """
        _, s = self._place(road, s)
        if self._details is None:
            self._details = {}
            for one in self.model().lanes:
                self._details.setdefault((one.road, one.lane), []).append(one)
        found = [one for one in self._details.get((road, lane), ()) if one.s_from <= s]
        return found[-1] if found and s < found[-1].s_to else None

    def marks(self, road: str, lane: int, s: float) -> tuple[Mark | None, Mark | None]:
        """Return (outer mark, inner mark) of a lane at s.

        The inner one belongs to the neighbouring lane towards the centre.
        """
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
        """Return the position a distance ahead in the direction of travel, or None beyond the lane's end.

        At a junction the straightest exit is taken. The offset stays on the same side of the lane, so its sign changes
        where s turns round.
        """
        i, s = self._place(position.road, position.s)
        n = self.tables
        start = lanes.lane_row(n, i, position.lane, s)
        if start < 0:
            return None
        row, s, left = travel.advance_row(n, start, s, distance, -1)
        if left > 0.0:
            return None
        turned = n.lane_sense[start] != n.lane_sense[row]
        return self._position(row, s, 0.0 - position.offset if turned else position.offset)

    def previous(self, position: LanePosition, distance: float) -> LanePosition | None:
        """Return the position a distance behind against the direction of travel, None beyond the lane's start."""
        return self.next(position, -distance)

    def left(self, position: LanePosition) -> LanePosition | None:
        """Return the position on the lane to the left as seen in the direction of travel, None if there is none."""
        return self._beside(position, 1)

    def right(self, position: LanePosition) -> LanePosition | None:
        """Return the position on the lane to the right as seen in the direction of travel, None if there is none."""
        return self._beside(position, -1)

    def _beside(self, position: LanePosition, side: int) -> LanePosition | None:
        i, s = self._place(position.road, position.s)
        step = side * lanes.lane_direction(self.tables, i, position.lane, s)
        lane = position.lane + step
        if lane == 0:
            lane += step
        if lanes.lane_exists(self.tables, i, lane, s) == 0:
            return None
        return LanePosition(position.road, lane, s, position.offset)

    def route(self, start: LanePosition, goal: LanePosition) -> Route | None:
        """Return the shortest route, with the fewest lane changes among equals, None if there is none.

        Raises:
            ValueError: When the start or the goal lies on no lane.
        """
        return find_route(self.tables, self.road_ids, start, goal)

    def topology(self) -> list[tuple[LanePosition, LanePosition]]:
        """Return pairs of entries of drivable lanes, one lane following the other, in file order.

        An entry is where travel enters the lane in one lane section.
        """
        n = self.tables
        pairs = []
        for row in range(len(n.lane_id)):
            if n.lane_id[row] == 0 or not is_drivable(n.lane_type[row]):
                continue
            forward = n.lane_sense[row] == 1
            end = AT_END if forward else AT_START
            for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
                other = n.link_lane[link]
                follows = n.lane_sense[other] == 1
                if is_drivable(n.lane_type[other]) and follows == (n.link_contact[link] == AT_START):
                    pairs.append((self._entry(row, forward), self._entry(other, follows)))
        return pairs

    def _entry(self, row: int, forward: bool) -> LanePosition:
        n = self.tables
        section = n.lane_section[row]
        s = n.section_s[section] if forward else n.section_end[section]
        return LanePosition(self.road_ids[n.section_road[section]], n.lane_id[row], s)

    def with_mark_quality(self, overrides: Sequence[MarkStretch]) -> Network:
        """Return a network whose marks have the overrides; everything else is shared with this one.

        Raises:
            KeyError: A stretch names a road or a colour that does not exist.
            ValueError: A quality is outside 0 to 1.
        """
        arrays = with_mark_quality(self.tables, self._index, overrides)
        painted = Network(self.path, self.sha256, ParsedNetwork(arrays, self.road_ids, self.junction_ids))
        painted._model = self._model
        return painted


@overload
def load_network(path: str | Path, *, cache: bool = True, sink: None = None) -> Network: ...


@overload
def load_network(path: str | Path, *, cache: bool = True, sink: Diagnostics) -> Network | None: ...


def load_network(path: str | Path, *, cache: bool = True, sink: Diagnostics | None = None) -> Network | None:
    """Read an OpenDRIVE file.

    Args:
        path: The file.
        cache: Whether the tables may be read from, and are written to, the user's cache.
        sink: Receives the findings.

    Returns:
        The network; None if the file is unreadable and a sink was given.

    Raises:
        CompileError: The file is unreadable and no sink was given.
    """
    findings = Diagnostics() if sink is None else sink
    raw = _read(Path(path), findings)
    sha256 = "" if raw is None else hashlib.sha256(raw).hexdigest()
    parsed = None if raw is None else _parse(raw, sha256, str(path), findings, cache)
    if parsed is None:
        if sink is None:
            raise CompileError(findings)
        return None
    return Network(str(path), sha256, parsed)


def _read(path: Path, sink: Diagnostics) -> bytes | None:
    """Return the contents of a file; `read_document` finds and reports the faults of an unreadable one."""
    try:
        return read_file(path)
    except (OSError, ValueError):
        pass
    read_document(path, sink, MAX_BYTES)
    return None


def _parse(raw: bytes, sha256: str, path: str, sink: Diagnostics, cache: bool) -> ParsedNetwork | None:
    parsed = read_cached(sha256, path, sink) if cache else None
    if parsed is not None:
        return parsed
    from scenario_compiler.roads.elements import RoadFile
    from scenario_compiler.roads.parse import read_network

    findings = Diagnostics()
    with paused():
        parsed = read_network(RoadFile(path, raw), findings)
    if parsed is not None and cache:
        write_cached(sha256, parsed, findings)
    sink.absorb(findings)
    return parsed
