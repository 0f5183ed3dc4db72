"""Builds the links of lanes: joins the lanes at every joint of lane sections and roads, and lists the exits of roads.

An end of a lane is numbered as in `RoadTables.lane_link`: 2 x its row + `AT_START` or `AT_END`. What a file states
about links comes as the arrays of `topology.StatedLinks`.
"""

from math import pi

from scenario_compiler.marker import compiled
from scenario_compiler.roads.geometry import road_heading, wrap_angle
from scenario_compiler.roads.lanes import lane_row_in
from scenario_compiler.roads.ordering import order_by_key
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables


@compiled
def end_section(n: RoadTables, road: int, end: int) -> int:
    """Return the first or last lane section of a road, -1 if it has none."""
    if n.road_section[road] == n.road_section[road + 1]:
        return -1
    if end == AT_START:
        return n.road_section[road]
    return n.road_section[road + 1] - 1


@compiled
def may_touch(n: RoadTables, road: int, contact: int, other: int, end: int) -> bool:
    """Return whether an end of a road does not name another road, or another end of that road, as its neighbour."""
    named = n.road_start_road[road]
    named_end = n.road_start_contact[road]
    if contact != AT_START:
        named = n.road_end_road[road]
        named_end = n.road_end_contact[road]
    return named != other or named_end == end


@compiled
def list_link(end: int, other: int, count: int, ends: list[int], others: list[int]) -> int:
    """List a link in both directions, behind the first `count` entries, if there is room; return the new count."""
    if count + 1 < len(ends):
        ends[count] = end
        others[count] = other
        ends[count + 1] = other
        others[count + 1] = end
    return count + 2


@compiled
def list_stated(
    n: RoadTables,
    section: int,
    end: int,
    target: int,
    contact: int,
    stated: list[int],
    lanes: list[int],
    count: int,
    ends: list[int],
    others: list[int],
) -> tuple[int, int]:
    """List the links that the lanes of a section state at one end; return whether there are any, and the new count."""
    named = 0
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        for k in range(stated[2 * row + end], stated[2 * row + end + 1]):
            named = 1
            found = lane_row_in(n, target, lanes[k])
            if found >= 0 and lanes[k] != 0 and n.lane_id[row] != 0:
                count = list_link(2 * row + end, 2 * found + contact, count, ends, others)
    return named, count


@compiled
def list_joint(
    n: RoadTables,
    section: int,
    end: int,
    target: int,
    contact: int,
    stated: list[int],
    lanes: list[int],
    count: int,
    ends: list[int],
    others: list[int],
) -> int:
    """List the links between two touching sections, each given with the end that is touched; return the new count."""
    named, count = list_stated(n, section, end, target, contact, stated, lanes, count, ends, others)
    also, count = list_stated(n, target, contact, section, end, stated, lanes, count, ends, others)
    if named == 1 or also == 1:
        return count
    sign = 1
    if end == contact:
        sign = -1
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        found = lane_row_in(n, target, sign * n.lane_id[row])
        if n.lane_id[row] != 0 and found >= 0:
            count = list_link(2 * row + end, 2 * found + contact, count, ends, others)
    return count


@compiled
def list_road_end(
    n: RoadTables,
    road: int,
    end: int,
    stated: list[int],
    lanes: list[int],
    connected: list[int],
    connections: list[int],
    pairs: list[int],
    count: int,
    ends: list[int],
    others: list[int],
) -> int:
    """List the links of a road's end to the road that it names, or to those that its junction connects; see there."""
    section = end_section(n, road, end)
    if section < 0:
        return count
    other = n.road_start_road[road]
    touched = n.road_start_contact[road]
    junction = n.road_start_junction[road]
    if end != AT_START:
        other = n.road_end_road[road]
        touched = n.road_end_contact[road]
        junction = n.road_end_junction[road]
    if other >= 0:
        target = end_section(n, other, touched)
        if target >= 0 and may_touch(n, other, touched, road, end):
            count = list_joint(n, section, end, target, touched, stated, lanes, count, ends, others)
    if junction < 0:
        return count
    for i in range(connected[junction], connected[junction + 1]):
        to = connections[4 * i + 1]
        contact = connections[4 * i + 2]
        target = end_section(n, to, contact)
        if connections[4 * i] == road and may_touch(n, to, contact, road, end) and target >= 0:
            first = connections[4 * i + 3]
            last = connections[4 * i + 7]
            for k in range(first, last):
                row = lane_row_in(n, section, pairs[2 * k])
                found = lane_row_in(n, target, pairs[2 * k + 1])
                if row >= 0 and found >= 0 and pairs[2 * k] != 0 and pairs[2 * k + 1] != 0:
                    count = list_link(2 * row + end, 2 * found + contact, count, ends, others)
            if first == last:
                count = list_joint(n, target, contact, section, end, stated, lanes, count, ends, others)
    return count


@compiled
def list_links(
    n: RoadTables,
    stated: list[int],
    lanes: list[int],
    connected: list[int],
    connections: list[int],
    pairs: list[int],
    ends: list[int],
    others: list[int],
) -> int:
    """List the links at all joints, each in both directions, as far as there is room; return the number of entries.

    Args:
        n: The tables; roads, sections, lanes and links of roads have been read.
        stated: Row starts of `lanes`, by ends.
        lanes: The lanes that the file states for each end.
        connected: Row starts of the connections, by junctions.
        connections: Four numbers of each: road it comes from, road it leads to, touched end, start of its pairs. The
            last four numbers are only the end of the last one's pairs.
        pairs: The two lanes of each pair of lanes that a connection names.
        ends: Filled with one end of each link.
        others: Filled with the other one.
    """
    count = 0
    for road in range(len(n.road_length)):
        for section in range(n.road_section[road], n.road_section[road + 1] - 1):
            count = list_joint(n, section, AT_END, section + 1, AT_START, stated, lanes, count, ends, others)
    for road in range(len(n.road_length)):
        for end in range(2):
            count = list_road_end(n, road, end, stated, lanes, connected, connections, pairs, count, ends, others)
    return count


@compiled
def road_turn(n: RoadTables, road: int) -> float:
    """Return the absolute change of heading between the ends of a road in a junction, else 0; rad, at most pi."""
    if n.road_junction[road] < 0:
        return 0.0
    return min(pi, abs(wrap_angle(road_heading(n, road, n.road_length[road]) - road_heading(n, road, 0.0))))


@compiled
def store_links(
    n: RoadTables,
    ends: list[int],
    others: list[int],
    branches: int,
    places: list[int],
    order: list[int],
    merged: list[int],
) -> int:
    """Fill the columns of links from listed ones, each once; return their number.

    Args:
        n: The tables.
        ends: One end of each link.
        others: The other one.
        branches: Number of the first entry that is a link to a place inside another road.
        places: A 0 for each end of a lane.
        order: Working memory, a number for each entry.
        merged: The same.
    """
    order_by_key(ends, order, merged)
    count = 0
    at_end = 0
    for k in range(len(order)):
        end = ends[order[k]]
        other = others[order[k]]
        while at_end < end:
            at_end = at_end + 1
            n.lane_link[at_end] = count
        link = places[other] - 1
        if link < n.lane_link[end]:
            link = count
            count = count + 1
            places[other] = count
        lane = other // 2
        n.link_lane[link] = lane
        n.link_contact[link] = other - 2 * lane
        n.link_turn[link] = pi
        if order[k] < branches:
            n.link_turn[link] = road_turn(n, n.section_road[n.lane_section[lane]])
    while at_end + 1 < len(n.lane_link):
        at_end = at_end + 1
        n.lane_link[at_end] = count
    return count


@compiled
def store_exits(n: RoadTables, known: list[int]) -> int:
    """Fill the columns of exits, the ends of roads that an end of a road's lanes is linked to; return their number.

    Args:
        n: The tables; the links of lanes are stored.
        known: A 0 for each end of a road.
    """
    count = 0
    for road in range(len(n.road_length)):
        for end in range(2):
            exit_of = 2 * road + end
            section = end_section(n, road, end)
            if section >= 0:
                for row in range(n.section_lane[section], n.section_lane[section + 1]):
                    for link in range(n.lane_link[2 * row + end], n.lane_link[2 * row + end + 1]):
                        there = n.lane_section[n.link_lane[link]]
                        to = n.section_road[there]
                        contact = n.link_contact[link]
                        if there == end_section(n, to, contact) and known[2 * to + contact] != exit_of + 1:
                            known[2 * to + contact] = exit_of + 1
                            n.exit_road[count] = to
                            n.exit_contact[count] = contact
                            count = count + 1
            n.road_exit[exit_of + 1] = count
    return count
