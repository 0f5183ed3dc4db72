"""Rings of one or two roads: CARLA 0.9.16 joins none of their lanes unless there are more roads between."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.roads.connecting_road import Stretch, build_road
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.shorten import cut_range, free_id, name_end
from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables
from scenario_compiler.roads.text_edits import TextEdits


def find_short_rings(n: RoadTables) -> dict[int, int]:
    """Return, for one road of each such ring, the number of additional roads that make it a ring of three.

    In a ring of one, a road's end is linked to its own start; in a ring of two, two roads are linked at both ends.
    """
    rings: dict[int, int] = {}
    for road in range(len(n.road_length)):
        other = n.road_end_road[road]
        if n.road_section[road] == n.road_section[road + 1] or other != n.road_start_road[road]:
            continue
        if other == road and n.road_end_contact[road] == AT_START:
            rings[road] = 2
        elif other > road and n.road_start_road[other] == n.road_end_road[other] == road:
            rings[road] = 1
    return rings


def break_ring(
    edits: TextEdits,
    network: Network,
    roads: dict[str, etree._Element],
    road: int,
    pieces: int,
    length: float,
    taken: set[str],
) -> list[etree._Element]:
    """Divide the last `length` m of a road of a ring into roads, and link them; the road itself is cut elsewhere.

    Args:
        edits: Receives the changes of links.
        network: The network.
        roads: The roads' elements by id.
        road: Index of the road.
        pieces: Number of roads to make.
        length: Length of the divided end, m.
        taken: The road ids in use; those of the new roads are added.

    Returns:
        The new roads.
    """
    n = network.tables
    other, contact = n.road_end_road[road], n.road_end_contact[road]
    names = [free_id(taken) for _ in range(pieces)]
    low, high = cut_range(n, (road, AT_END), length)
    chain = [name_end(network, (road, AT_END)), *((name, "end") for name in names)]
    nexts = [*((name, "start") for name in names[1:]), name_end(network, (other, contact))]
    links = _lanes_ahead(n, road, other)
    made: list[etree._Element] = []
    for k, name in enumerate(names):
        lanes = tuple((a, a, b if k == pieces - 1 else a) for a, b in links)
        start, end = (low + (high - low) * part / pieces for part in (k, k + 1))
        stretch = Stretch(road, start, end, True, chain[k], nexts[k], lanes)
        made.append(build_road(network, roads, stretch, name, "-1")[0])
    side = "predecessor" if contact == AT_START else "successor"
    _redirect(edits, roads[network.road_ids[road]], "successor", (names[0], "start"))
    _redirect(edits, roads[network.road_ids[other]], side, (names[-1], "end"))
    return made


def _lanes_ahead(n: RoadTables, road: int, other: int) -> list[tuple[int, int]]:
    """Return (lane at the road's end, lane of the other road to which it is linked, or 0)."""
    section = n.road_section[road + 1] - 1
    pairs = []
    for row in range(n.section_lane[section], n.section_lane[section + 1]):
        if n.lane_id[row] != 0:
            linked = n.link_lane[n.lane_link[2 * row + AT_END] : n.lane_link[2 * row + AT_END + 1]]
            lanes = [n.lane_id[one] for one in linked if n.section_road[n.lane_section[one]] == other]
            pairs.append((n.lane_id[row], lanes[0] if lanes else 0))
    return pairs


def _redirect(edits: TextEdits, road: etree._Element, side: str, target: tuple[str, str]) -> None:
    link = road.find(f"{{*}}link/{{*}}{side}")
    if link is not None:
        edits.set(link, "elementId", target[0])
        edits.set(link, "contactPoint", target[1])
