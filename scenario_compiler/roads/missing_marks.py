"""Adds road marks of type none to lanes without marks: CARLA's client dies when its lane sensor crosses such a lane."""

from __future__ import annotations

from collections.abc import Iterator

from lxml import etree

from scenario_compiler.roads.text_edits import TextEdits, number_of

_BEFORE = ("{*}link", "{*}width", "{*}border")
"""The children of a lane that precede its road marks."""


def complete_marks(edits: TextEdits, road: etree._Element) -> None:
    """Add a mark of type none to each lane of a road, the centre lane too, that has no mark at its start.

    Args:
        edits: Receives the changes.
        road: The road's element.
    """
    for lane in _unmarked_lanes(road):
        before = list(lane.iterchildren(*_BEFORE))
        text = etree.tostring(_no_mark(), encoding="unicode")
        if before:
            edits.insert_after(before[-1], text)
        else:
            edits.insert_inside(lane, text)


def mark_lanes(road: etree._Element) -> None:
    """Do the same to a road that is not in a document."""
    for lane in _unmarked_lanes(road):
        lane.insert(len(list(lane.iterchildren(*_BEFORE))), _no_mark())


def _unmarked_lanes(road: etree._Element) -> Iterator[etree._Element]:
    for lane in road.iterfind("{*}lanes/{*}laneSection/{*}*/{*}lane"):
        if all(number_of(mark, "sOffset") > 0.0 for mark in lane.iterfind("{*}roadMark")):
            yield lane


def _no_mark() -> etree._Element:
    attributes = {"sOffset": "0", "type": "none", "weight": "standard", "color": "standard", "width": "0"}
    return etree.Element("roadMark", attributes)
