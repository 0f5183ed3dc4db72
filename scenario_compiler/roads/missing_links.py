"""Adds lane links that a road file leaves out and that follow from its other links."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.roads.tables import AT_END, AT_START, RoadTables
from scenario_compiler.roads.text_edits import TextEdits, number_of

_NAMES = ("predecessor", "successor")


def complete_lane_links(edits: TextEdits, element: etree._Element, n: RoadTables, road: int, *, goes_on: bool) -> None:
    """Add to each lane of a road the predecessor and successor that follow from the links of the neighbouring lanes.

    Lane ends at a junction get none, because the junction's connections define them.

    Args:
        edits: Receives the changes.
        element: The road's element.
        n: The tables of the network.
        road: Index of the road.
        goes_on: Whether the road's end is split off, so that the same lanes continue there.
    """
    rows = range(n.road_section[road], n.road_section[road + 1])
    sections = sorted(element.iterfind("{*}lanes/{*}laneSection"), key=lambda one: number_of(one, "s"))
    if len(rows) != len(sections):
        return
    for row, section in zip(rows, sections, strict=True):
        lanes = {one.get("id"): one for one in section.iterfind("{*}*/{*}lane")}
        for lane in range(n.section_lane[row], n.section_lane[row + 1]):
            found = lanes.get(str(n.lane_id[lane]))
            if found is not None and n.lane_id[lane] != 0:
                ends = [_linked_lane(n, road, row, lane, end) for end in (AT_START, AT_END)]
                if goes_on and row == rows[-1]:
                    ends[1] = n.lane_id[lane]
                    for stated in found.iterfind("{*}link/{*}successor"):
                        edits.set(stated, "id", str(ends[1]))
                _write_links(edits, found, ends)


def _linked_lane(n: RoadTables, road: int, section: int, lane: int, end: int) -> int:
    """Return the id of the lane to which a lane's end is linked, 0 if there is none or a junction lies there."""
    last = n.road_section[road + 1] - 1
    inside = section > n.road_section[road] if end == AT_START else section < last
    neighbour = n.road_start_road[road] if end == AT_START else n.road_end_road[road]
    target = road if inside else neighbour
    for link in range(n.lane_link[2 * lane + end], n.lane_link[2 * lane + end + 1]):
        other = n.link_lane[link]
        if target >= 0 and n.section_road[n.lane_section[other]] == target:
            return n.lane_id[other]
    return 0


def _write_links(edits: TextEdits, lane: etree._Element, ends: list[int]) -> None:
    link = lane.find("{*}link")
    missing = [
        f'<{name} id="{linked}"/>'
        for name, linked in zip(_NAMES, ends, strict=True)
        if linked != 0 and (link is None or link.find(f"{{*}}{name}") is None)
    ]
    if not missing:
        return
    children = [] if link is None else list(link)
    if children and link is not None:
        place = edits.insert_inside if "predecessor" in missing[0] else edits.insert_after
        place(link if "predecessor" in missing[0] else children[-1], "\n".join(missing))
    elif len(lane) > 0:
        if link is not None:
            edits.remove(link)
        edits.insert_inside(lane, "\n".join(("<link>", *(f"    {one}" for one in missing), "</link>")))
