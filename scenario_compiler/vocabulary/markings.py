"""Markings: stretches on which the scenario overrides the map's paint, and paint that the scenario adds."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, same_as

MarkColour = Literal["white", "yellow", "orange", "red", "blue"]


class Markings(Word):
    """The paint along a stretch of a road: colour, cover, and a quality that changes linearly from start to end."""

    word: Literal["markings"] = "markings"

    road: str = attribute("Id of the road in the map.", names="road")
    s_from: Number = attribute(
        "Start of the stretch along the reference line, m.", name="from", quantity="length", minimum=0
    )
    s_to: Number = attribute("End of the stretch along the reference line, m.", name="to", quantity="length", minimum=0)
    lane: int | None = attribute(
        "Id of the lane whose outer border the mark lies on, 0 for the centre line; all marks if left out.",
        default=None,
    )
    quality: Number | None = attribute(
        "Quality at the start: 1 is fresh paint, 0 is no paint. The map's quality if left out.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    quality_to: Number | None = attribute(
        "Quality at the end; the same as at the start if left out.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    coverage: Number = attribute(
        "Share of the paint that leaves, snow or dirt cover. Covered pieces are 2 m long.",
        default=0.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    colour: MarkColour | None = attribute(
        "Colour of the marks in the camera's image; the map's colour if left out.", default=None
    )


class SecondaryMarkings(Word):
    """A line painted in addition to the old marks, such as a temporary line in a work zone. The old marks stay.

    Only the camera sees it: with ideal perception, the map's own marks bound a lane.
    """

    word: Literal["secondary_markings"] = "secondary_markings"

    road: str = attribute("Id of the road in the map.", names="road")
    s_from: Number = attribute(
        "Start of the line along the reference line, m.", name="from", quantity="length", minimum=0
    )
    s_to: Number = attribute("End of the line along the reference line, m.", name="to", quantity="length", minimum=0)
    t: Number = attribute(
        "Distance of the line's middle from the reference line, m, positive to the left in the direction of s.",
        quantity="length",
    )
    colour: MarkColour = attribute("Colour of the line.", default="yellow")
    type: Literal["solid", "broken"] = attribute("A broken line has 3 m of paint and 9 m of gap.", default="solid")
    width: Number = attribute("Width of the line, m.", default=0.12, quantity="length", minimum=0.01, maximum=1)
    quality: Number = attribute(
        "Quality: 1 is fresh paint, 0 is no paint.", default=1.0, quantity="fraction", minimum=0, maximum=1
    )


class LineBeside(Word):
    """A line painted beside an entity's start position, such as the temporary line along a work zone's cones.

    It lies along the road on which the entity starts, and ends where that road ends. Only the camera sees it.
    """

    word: Literal["line_beside"] = "line_beside"

    entity: str = attribute("Id of the entity from which the line is measured.", names="entity")
    s_from: Number = attribute(
        "Start of the line, m along the road from the entity, positive in the direction that the entity faces.",
        name="from",
        default=0.0,
        quantity="length",
    )
    s_to: Number = attribute("End of the line, m, measured in the same way.", name="to", quantity="length")
    across: Number = attribute(
        "Distance of the line's middle from the entity, m, positive to the entity's left.",
        default=0.0,
        quantity="length",
    )
    colour: MarkColour = same_as(SecondaryMarkings, "colour")
    type: Literal["solid", "broken"] = same_as(SecondaryMarkings, "type")
    width: Number = same_as(SecondaryMarkings, "width")
    quality: Number = same_as(SecondaryMarkings, "quality")
