"""Markings: the road's paint where the scenario overrides the map by stretch, and paint that it adds."""

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute, same_as

MarkColour = Literal["white", "yellow", "orange", "red", "blue"]


class Markings(Word):
    """The marks along a stretch of a road: quality, linear from its begin to its end, colour, and what covers them."""

    word: Literal["markings"] = "markings"

    road: str = attribute("Id of the road in the map.", names="road")
    s_from: Number = attribute(
        "Begin of the stretch along the reference line, m.", name="from", quantity="length", minimum=0
    )
    s_to: Number = attribute("End of the stretch along the reference line, m.", name="to", quantity="length", minimum=0)
    lane: int | None = attribute(
        "Id of the lane on whose outer border the mark lies, 0 for the centre line; all marks when left out.",
        default=None,
    )
    quality: Number | None = attribute(
        "Quality at the begin: 1 is fresh paint, 0 is no paint. The map's when left out.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    quality_to: Number | None = attribute(
        "Quality at the end; the same as at the begin when left out.",
        default=None,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    coverage: Number = attribute(
        "Share of the paint that is covered, by leaves, snow or dirt: pieces of 2 m of it are not to be seen.",
        default=0.0,
        quantity="fraction",
        minimum=0,
        maximum=1,
    )
    colour: MarkColour | None = attribute(
        "Colour that the camera sees the marks in; the map's when left out.", default=None
    )


class SecondaryMarkings(Word):
    """A line painted beside the old marks, such as a temporary one in a work zone; the old marks stay.

    It matters to the camera alone: with ideal perception a lane is bounded by the map's own marks.
    """

    word: Literal["secondary_markings"] = "secondary_markings"

    road: str = attribute("Id of the road in the map.", names="road")
    s_from: Number = attribute(
        "Begin of the line along the reference line, m.", name="from", quantity="length", minimum=0
    )
    s_to: Number = attribute("End of the line along the reference line, m.", name="to", quantity="length", minimum=0)
    t: Number = attribute(
        "Distance of the line's middle from the reference line, m, positive to the left of increasing s.",
        quantity="length",
    )
    colour: MarkColour = attribute("Colour of the line.", default="yellow")
    type: Literal["solid", "broken"] = attribute("A broken line has 3 m of paint and 9 m of gap.", default="solid")
    width: Number = attribute("Width of the line, m.", default=0.12, quantity="length", minimum=0.01, maximum=1)
    quality: Number = attribute(
        "Quality: 1 is fresh paint, 0 is no paint.", default=1.0, quantity="fraction", minimum=0, maximum=1
    )


class LineBeside(Word):
    """A line painted beside where an entity starts, such as the temporary one along a work zone's cones.

    It lies on the road that the entity starts on, along it, and ends with it. It matters to the camera alone.
    """

    word: Literal["line_beside"] = "line_beside"

    entity: str = attribute("Id of the entity that the line is measured from.", names="entity")
    s_from: Number = attribute(
        "Begin of the line along the road from the entity, m, positive to where it faces.",
        name="from",
        default=0.0,
        quantity="length",
    )
    s_to: Number = attribute("End of the line, m, counted likewise.", name="to", quantity="length")
    across: Number = attribute(
        "Distance of the line's middle from the entity, m, positive to the left of where it faces.",
        default=0.0,
        quantity="length",
    )
    colour: MarkColour = same_as(SecondaryMarkings, "colour")
    type: Literal["solid", "broken"] = same_as(SecondaryMarkings, "type")
    width: Number = same_as(SecondaryMarkings, "width")
    quality: Number = same_as(SecondaryMarkings, "quality")
