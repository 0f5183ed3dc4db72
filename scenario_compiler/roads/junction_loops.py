"""Roads that leave a junction and come back to it: CARLA 0.9.16 confuses their two ends unless they are two roads.

`MapBuilder::GetJunctionLanes` of its client searches a junction's connecting roads for a road by its id alone, so a
lane that leaves by one end is also joined with the connecting roads that lead into the other one; and `Map::GetNext`
leaves out everything that leads back at once (read in the sources of CarlaAir, which has CARLA's 0.9.16; seen with its
wheel).
"""

from __future__ import annotations

from collections.abc import Mapping

from lxml import etree

from scenario_compiler.roads.connecting_road import Stretch, build_road
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.shorten import End
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.roads.text_edits import TextEdits


def find_junction_loops(n: RoadTables) -> list[int]:
    """Return the roads with lanes that begin and end at the same junction."""
    return [
        road
        for road, junction in enumerate(n.road_start_junction)
        if junction >= 0 and junction == n.road_end_junction[road] and n.road_section[road] < n.road_section[road + 1]
    ]


def split_off_end(
    edits: TextEdits,
    network: Network,
    roads: dict[str, etree._Element],
    end: End,
    name: str,
    reach: tuple[float, float],
    junction: str,
) -> etree._Element:
    """Make a road of the end of another one, and link it; the other road itself is cut elsewhere.

    Args:
        edits: Receives the changes of links.
        network: The network.
        roads: The roads' elements by id.
        end: The road's end.
        name: Id of the new road.
        reach: Range of s of the original road, m.
        junction: Id of the junction to which it leads.

    Returns:
        The new road.
    """
    n, road = network.tables, end[0]
    element = roads[network.road_ids[road]]
    section = n.road_section[road + 1] - 1
    rows = range(n.section_lane[section], n.section_lane[section + 1])
    lanes = tuple((n.lane_id[row], n.lane_id[row], 0) for row in rows if n.lane_id[row] != 0)
    stretch = Stretch(road, *reach, True, (network.road_ids[road], "end"), (junction, ""), lanes)
    link = element.find("{*}link/{*}successor")
    if link is not None:
        for attribute, value in (("elementType", "road"), ("elementId", name), ("contactPoint", "start")):
            edits.set(link, attribute, value)
    return build_road(network, roads, stretch, name, "-1")[0]


def redirect_to_ends(
    edits: TextEdits, root: etree._Element, roads: dict[str, etree._Element], moved: Mapping[tuple[str, str], str]
) -> None:
    """Let connecting roads and connections refer to the roads that have replaced road ends.

    Args:
        edits: Receives the changes.
        root: The document's root.
        roads: The roads' elements by id.
        moved: Id of the road that replaces an end, by the original road and the standard's word for the end.
    """
    for road in roads.values():
        for link in road.iterfind("{*}link/*"):
            name = moved.get(_named(link))
            if name is not None:
                edits.set(link, "elementId", name)
    for connection in root.iterfind("{*}junction/{*}connection"):
        connecting = roads.get(str(connection.get("connectingRoad")))
        side = "successor" if connection.get("contactPoint") == "end" else "predecessor"
        entered = None if connecting is None else connecting.find(f"{{*}}link/{{*}}{side}")
        if entered is not None and entered.get("elementId") == connection.get("incomingRoad"):
            name = moved.get(_named(entered))
            if name is not None:
                edits.set(connection, "incomingRoad", name)


def _named(link: etree._Element) -> tuple[str, str]:
    """Return the road and the end to which a link refers; ("", "") for a junction."""
    if link.get("elementType") != "road":
        return "", ""
    return str(link.get("elementId")), str(link.get("contactPoint"))
