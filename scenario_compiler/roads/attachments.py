"""Roads that begin or end inside another road, as those of virtual junctions do.

Instead of an end (`contactPoint`), their link names a place of the main road (`elementS`) and the direction in which
the main road is left or entered there (`elementDir`). The main road's lane section is cut at that place, so that the
lanes of both are linked as at any joint; without a preference, travel continues on the main road. Source: OpenDRIVE
1.7, section 10.4.
"""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.roads.elements import PlainElement
from scenario_compiler.roads.reading import LENGTH_LIMIT, Reader
from scenario_compiler.roads.tables import AT_END, AT_START

CUT_TOLERANCE = 0.01
"""Distance to an end or to another cut below which a place counts as the same, m."""


@dataclass(frozen=True, slots=True)
class Attachment:
    """An end of a road that lies inside another road.

    Attributes:
        road: Id of the road.
        end: `AT_START` or `AT_END`.
        main: Id of the road that it is attached to.
        s: Place on the main road, m.
        contact: End of the main road's part that it touches: `AT_END` of the part before s, `AT_START` of that after.
    """

    road: str
    end: int
    main: str
    s: float
    contact: int


def read_attachments(reader: Reader, root: PlainElement) -> list[Attachment]:
    """Return the ends of roads that are linked to a place inside another road, in the order of the file."""
    found = []
    lengths: dict[str, float] | None = None
    ends = [(road, link) for road in root.findall("road") for links in road.findall("link") for link in links]
    for road, link in ends:
        if link.get("elementS") is None or link.tag not in {"predecessor", "successor"}:
            continue
        if link.get("elementType") == "junction":
            continue
        if lengths is None:
            roads = reversed(root.findall("road"))
            lengths = {one.get("id", ""): reader.number(one, "length", 0.0, limit=LENGTH_LIMIT) for one in roads}
        s, main = reader.number(link, "elementS", 0.0, limit=LENGTH_LIMIT), link.get("elementId", "")
        if CUT_TOLERANCE < s < lengths.get(main, 0.0) - CUT_TOLERANCE:
            end = AT_START if link.tag == "predecessor" else AT_END
            along = link.get("elementDir", "+") != "-"
            contact = AT_END if along == (end == AT_START) else AT_START
            found.append(Attachment(road.get("id", ""), end, main, s, contact))
    return found


def cuts_of(attachments: list[Attachment]) -> dict[str, list[float]]:
    """Return, by road, the places of attached roads, ascending and at least `CUT_TOLERANCE` apart."""
    cuts: dict[str, list[float]] = {}
    for one in sorted(attachments, key=lambda attachment: attachment.s):
        places = cuts.setdefault(one.main, [])
        if not places or one.s - places[-1] > CUT_TOLERANCE:
            places.append(one.s)
    return cuts
