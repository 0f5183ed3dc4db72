"""Properties of a lane other than its shape: access, rules, material, and its state in OpenDRIVE 1.8."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from lxml import etree

from scenario_compiler.roads.reading import LENGTH_LIMIT, Reader


class LaneAccess(NamedTuple):
    """The access to a lane from s on, m.

    `rule` is "allow" (only the named users may use it) or "deny" (all others may), or "" if the file does not state it,
    as before 1.5. `restrictions` are the standard's words ("bus", "pedestrian"); a record of 1.8 can have several.
    """

    s: float
    rule: str
    restrictions: tuple[str, ...]


class LaneMaterial(NamedTuple):
    """The surface of a lane from s on, m: coefficient of friction, and roughness in m, None if not given."""

    s: float
    friction: float
    roughness: float | None
    surface: str


class LaneRule(NamedTuple):
    """A rule for a lane from s on, m, as free text ("no stopping at any time")."""

    s: float
    value: str


class LaneVisibility(NamedTuple):
    """The sight distances of a lane from s on, all in m, in four directions relative to the lane (until 1.5)."""

    s: float
    forward: float
    back: float
    left: float
    right: float


@dataclass(frozen=True, slots=True)
class LaneDetails:
    """The details of a lane from the start of its lane section to its end, m; records are in ascending order of s.

    Attributes:
        road: Id of the road.
        lane: Id of the lane.
        s_from: Where it begins, m.
        s_to: Where the next lane section with its side begins, `inf` for the last one, m.
        access: Who may use it.
        materials: Its surface.
        rules: Rules as free text.
        visibility: Sight distances, m.
        advisory: "inner", "outer", "both" or "none": advisory lanes beside it (1.8); "" if not given.
        dynamic_direction: Whether its direction can change over time (1.8).
        dynamic_type: Whether its type can change over time (1.8).
        road_works: Whether it lies in road works (1.8).
        user_data: (code, value) of additional data of the file's author.
    """

    road: str
    lane: int
    s_from: float
    s_to: float
    access: tuple[LaneAccess, ...]
    materials: tuple[LaneMaterial, ...]
    rules: tuple[LaneRule, ...]
    visibility: tuple[LaneVisibility, ...]
    advisory: str
    dynamic_direction: bool
    dynamic_type: bool
    road_works: bool
    user_data: tuple[tuple[str, str], ...]

    def access_at(self, s: float) -> tuple[LaneAccess, ...]:
        """Return the records that are valid at s: those of the last place at or before it; () for free access."""
        before = [one for one in self.access if one.s <= s]
        return tuple(one for one in before if one.s == before[-1].s)


_TAGS = {"access", "material", "rule", "visibility", "userData"}
_ATTRIBUTES = ("advisory", "dynamicLaneDirection", "dynamicLaneType", "roadWorks")


def read_lane_details(reader: Reader, roads: list[etree._Element]) -> Iterator[LaneDetails]:
    """Yield the details of the lanes that have any."""
    for road in roads:
        sections = [
            (reader.number(one, "s", 0.0, limit=LENGTH_LIMIT), one) for one in road.iterfind("lanes/laneSection")
        ]
        sections.sort(key=lambda pair: pair[0])
        for side in ("left", "center", "right"):
            filed = [pair for pair in sections if not _left_as_it_is(pair[1], side)]
            ends = [*(s for s, _ in filed[1:]), inf]
            for (s_from, section), s_to in zip(filed, ends, strict=False):
                for lane in section.iterfind(f"{side}/lane"):
                    if any(lane.get(name) for name in _ATTRIBUTES) or any(one.tag in _TAGS for one in lane):
                        yield _details(reader, road.get("id", ""), lane, s_from, s_to)


def _left_as_it_is(section: etree._Element, side: str) -> bool:
    """Return whether a one-sided section leaves out a side, which then continues."""
    return section.get("singleSide") in {"true", "1"} and section.find(side) is None


def _details(reader: Reader, road: str, lane: etree._Element, origin: float, end: float) -> LaneDetails:
    def number(element: etree._Element, name: str) -> float:
        return reader.number(element, name, 0.0)

    def records(tag: str) -> list[tuple[float, etree._Element]]:
        found = [(origin + reader.number(one, "sOffset", 0.0, limit=LENGTH_LIMIT), one) for one in lane.iterfind(tag)]
        return sorted(found, key=lambda pair: pair[0])

    return LaneDetails(
        road=road,
        lane=reader.integer(lane, "id") or 0,
        s_from=origin,
        s_to=end,
        access=tuple(LaneAccess(s, one.get("rule", ""), _restrictions(one)) for s, one in records("access")),
        materials=tuple(
            LaneMaterial(
                s,
                number(one, "friction"),
                number(one, "roughness") if one.get("roughness") is not None else None,
                one.get("surface", ""),
            )
            for s, one in records("material")
        ),
        rules=tuple(LaneRule(s, one.get("value", "")) for s, one in records("rule")),
        visibility=tuple(
            LaneVisibility(s, *(number(one, name) for name in ("forward", "back", "left", "right")))
            for s, one in records("visibility")
        ),
        advisory=lane.get("advisory", ""),
        dynamic_direction=lane.get("dynamicLaneDirection") in {"true", "1"},
        dynamic_type=lane.get("dynamicLaneType") in {"true", "1"},
        road_works=lane.get("roadWorks") in {"true", "1"},
        user_data=tuple((one.get("code", ""), one.get("value", "")) for one in lane.iterfind("userData")),
    )


def _restrictions(access: etree._Element) -> tuple[str, ...]:
    """Return the words of an access record: its attribute (until 1.7, deprecated in 1.8) and its children (1.8)."""
    own = access.get("restriction")
    return (*((own,) if own else ()), *(one.get("type", "") for one in access.iterfind("restriction")))
