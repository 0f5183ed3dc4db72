"""Routes: the shortest route over the lanes, with the fewest lane changes among equally short ones."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_row, row_width
from scenario_compiler.roads.marks import CHANGE_BOTH, CHANGE_DECREASE, CHANGE_INCREASE
from scenario_compiler.roads.positions import LanePosition, Leg, Route
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables

CHANGE_STEP = 5.0
"""Distance between the places where a lane change is tested, m."""

MIN_CHANGE_WIDTH = 0.5
"""Least width of a lane where it is entered by a lane change, m."""


@dataclass(slots=True)
class _Step:
    """A lane row entered at s, after `length` metres and `changes` lane changes."""

    row: int
    s: float
    length: float
    changes: int
    before: _Step | None
    changed: bool


def find_route(n: RoadTables, road_ids: list[str], start: LanePosition, goal: LanePosition) -> Route | None:
    """Return the shortest route in the lanes' directions of travel, or None.

    Lanes are changed as early as marks allow it (`laneChange`, or the mark's type if the file does not state it);
    forbidden changes are only used if there is no other route. Offsets are ignored. A start on a lane for motor traffic
    stays on such lanes, another one on lanes of its own type.

    Raises:
        ValueError: The start or the goal lies on no lane.
    """
    rows = []
    for place in (start, goal):
        road = road_ids.index(place.road) if place.road in road_ids else -1
        row = lane_row(n, road, place.lane, place.s) if road >= 0 else -1
        if row < 0 or not 0.0 <= place.s <= n.road_length[road]:
            raise ValueError(f"there is no lane {place.lane} on road {place.road} at s = {place.s:g}")
        rows.append(row)
    search = _Search(n, rows[0], rows[1], goal.s)
    last = search.run(start.s, True) or search.run(start.s, False)
    return None if last is None else _route(n, road_ids, last, goal.s)


class _Search:
    """Dijkstra's search over (lane row, whether it was entered by driving on or lies beside the start)."""

    def __init__(self, n: RoadTables, start: int, goal: int, goal_s: float) -> None:
        self._n = n
        self._start = start
        self._goal = goal
        self._goal_s = goal_s

    def run(self, s: float, lawful: bool) -> _Step | None:
        """Return the last step of the best route from s on the start's row."""
        heap: list[tuple[float, int, int, _Step]] = []
        count = 0
        done: set[tuple[int, bool]] = set()
        first = _Step(self._start, s, 0.0, 0, None, False)
        open_steps = [first]
        best: tuple[tuple[float, int], _Step] | None = None
        while True:
            for step in open_steps:
                count += 1
                heapq.heappush(heap, (round(step.length, 3), step.changes, count, step))
            if not heap:
                break
            cost, changes, _, step = heapq.heappop(heap)
            if best is not None and (cost, changes) >= best[0]:
                break
            section = self._n.lane_section[step.row]
            near_start = _entry(step).before is None and section == self._n.lane_section[self._start]
            open_steps = []
            if (step.row, near_start) in done:
                continue
            done.add((step.row, near_start))
            ahead = self._ahead(step)
            if step.row == self._goal and ahead >= 0.0:
                total = (round(step.length + ahead, 3), step.changes)
                if best is None or total < best[0]:
                    best = (total, step)
            open_steps = self._changes(step, lawful) + self._onward(step)
        return None if best is None else best[1]

    def _sense(self, row: int) -> int:
        return self._n.lane_sense[row]

    def _ahead(self, step: _Step) -> float:
        """Return the distance to the goal's s, m; negative if it lies behind."""
        return (self._goal_s - step.s) * self._sense(step.row)

    def _allowed(self, row: int) -> bool:
        n = self._n
        if is_drivable(n.lane_type[self._start]):
            return is_drivable(n.lane_type[row]) == 1
        return n.lane_type[row] == n.lane_type[self._start]

    def _onward(self, step: _Step) -> list[_Step]:
        n, row = self._n, step.row
        section = n.lane_section[row]
        forward = self._sense(row) == 1
        end = AT_END if forward else AT_START
        room = n.section_end[section] - step.s if forward else step.s - n.section_s[section]
        found = []
        for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
            other, contact = n.link_lane[link], n.link_contact[link]
            if self._allowed(other) and (self._sense(other) == 1) == (contact == AT_START):
                target = n.lane_section[other]
                s = n.section_s[target] if contact == AT_START else n.section_end[target]
                found.append(_Step(other, s, step.length + room, step.changes, step, False))
        return found

    def _changes(self, step: _Step, lawful: bool) -> list[_Step]:
        n, row = self._n, step.row
        section = n.lane_section[row]
        found = []
        for other in (row - 1, row + 1):
            if not n.section_lane[section] <= other < n.section_lane[section + 1]:
                continue
            if n.lane_id[other] == 0 or not self._allowed(other) or self._sense(other) != self._sense(row):
                continue
            s = self._change_place(step, other, lawful)
            if s is not None:
                gone = step.length + abs(s - step.s)
                found.append(_Step(other, s, gone, step.changes + 1, step, True))
        return found

    def _change_place(self, step: _Step, other: int, lawful: bool) -> float | None:
        """Return the first s, from that of the step on, where a change to the neighbouring lane is possible."""
        n = self._n
        section = n.lane_section[step.row]
        sense = self._sense(step.row)
        end = n.section_end[section] if sense == 1 else n.section_s[section]
        room = (end - step.s) * sense
        for i in range(int(room / CHANGE_STEP) + 1):
            s = step.s + sense * CHANGE_STEP * i
            wide = row_width(n, other, s) >= MIN_CHANGE_WIDTH
            if wide and (not lawful or _may_change(n, step.row, other, s)):
                return s
        return None


def _entry(step: _Step) -> _Step:
    """Return the step that entered the section, before any lane changes in it."""
    while step.changed and step.before is not None:
        step = step.before
    return step


def _may_change(n: RoadTables, row: int, other: int, s: float) -> bool:
    """Return whether the mark between two neighbouring lanes allows a change at s."""
    inner = row if abs(n.lane_id[row]) < abs(n.lane_id[other]) else other
    code = CHANGE_BOTH
    for mark in range(n.lane_mark[inner], n.lane_mark[inner + 1]):
        if n.mark_s[mark] <= s:
            code = n.mark_change[mark]
    if code == CHANGE_BOTH:
        return True
    return code == (CHANGE_INCREASE if n.lane_id[other] > n.lane_id[row] else CHANGE_DECREASE)


def _route(n: RoadTables, road_ids: list[str], last: _Step, goal_s: float) -> Route:
    steps: list[_Step] = []
    step: _Step | None = last
    while step is not None:
        steps.append(step)
        step = step.before
    steps.reverse()
    legs: list[Leg] = []
    for i, one in enumerate(steps):
        section = n.lane_section[one.row]
        road = n.section_road[section]
        following = steps[i + 1] if i + 1 < len(steps) else None
        if following is None:
            s_to = goal_s
        elif following.changed:
            s_to = following.s
        else:
            forward = n.lane_sense[one.row] == 1
            s_to = n.section_end[section] if forward else n.section_s[section]
        leg = Leg(road_ids[road], n.lane_id[one.row], one.s, s_to, one.changed)
        joined = legs and not leg.changes_lane and legs[-1][:2] == leg[:2] and legs[-1].s_to == leg.s_from
        if joined:
            legs[-1] = legs[-1]._replace(s_to=leg.s_to)
        else:
            legs.append(leg)
    return Route(tuple(legs), sum(abs(leg.s_to - leg.s_from) for leg in legs), last.changes)
