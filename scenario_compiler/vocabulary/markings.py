"""Markings: how well the road's paint can be seen, by stretch, where the scenario overrides the map."""

from __future__ import annotations

from typing import Literal

from scenario_compiler.vocabulary.word import Number, Word, attribute


class Markings(Word):
    """The marks along a stretch of a road: their quality, linear from its begin to its end, and what covers them."""

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
        "Quality at the begin: 1 is fresh paint, 0 is none. The map's when left out.",
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
