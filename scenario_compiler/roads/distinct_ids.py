"""Renumbers junctions that have the id of a road, because CARLA's clients confuse links to the two."""

from __future__ import annotations

from lxml import etree

from scenario_compiler.roads.shorten import free_id
from scenario_compiler.roads.text_edits import TextEdits


def separate_junction_ids(edits: TextEdits, root: etree._Element, taken: set[str]) -> dict[str, str]:
    """Give each junction whose id is also a road's a new one, wherever it is named.

    Args:
        edits: Receives the changes.
        root: The document's root.
        taken: The ids of roads and junctions; the new ones are added.

    Returns:
        The new ids of the renamed junctions by the old ones.
    """
    roads = {one.get("id") for one in root.iterfind("{*}road")}
    renamed: dict[str, str] = {}
    for junction in root.iterfind("{*}junction"):
        name = junction.get("id")
        if name is not None and name in roads:
            renamed.setdefault(name, "")
    for name in renamed:
        renamed[name] = free_id(taken)
    if not renamed:
        return renamed
    for element in root.iter("{*}junction", "{*}road", "{*}predecessor", "{*}successor", "{*}junctionReference"):
        attribute = _JUNCTION_ATTRIBUTES[etree.QName(element).localname]
        named = element.get(attribute)
        if named in renamed and not (attribute == "elementId" and element.get("elementType") != "junction"):
            edits.set(element, attribute, renamed[named])
    return renamed


_JUNCTION_ATTRIBUTES = {
    "junction": "id",
    "road": "junction",
    "predecessor": "elementId",
    "successor": "elementId",
    "junctionReference": "junction",
}
