"""Summarises a road network in numbers, for readers."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from scenario_compiler.roads.lane_types import LANE_TYPES
from scenario_compiler.roads.network import Network
from scenario_compiler.roads.tables import ARC, LINE, NO_SPEED, SPIRAL, RoadTables


@dataclass(frozen=True, slots=True)
class NetworkDescription:
    """A summary of a map.

    Attributes:
        name: File's name without its suffix.
        title: Name in the header, often empty.
        version: Such as "1.6".
        vendor, date: As in the header.
        geo_reference: PROJ string, empty if the map has no place on the earth.
        bounds: (x_min, y_min, x_max, y_max) of the lanes, m.
        roads: Number of roads, including those in junctions.
        roads_in_junctions: Number of roads in junctions.
        length: Length of all reference lines, m.
        length_outside_junctions: That of the roads outside junctions, m.
        rules: Number of roads by traffic rule ("RHT", "LHT").
        geometries: Number of geometries of reference lines by kind.
        junctions: Number of junctions by type.
        lane_sections: Number of lane sections.
        lanes: Number of lanes by type, one for each lane section.
        lane_length: Length by type, m.
        speed_limits: Number of stated limits by limit, m/s (`inf`: "no limit").
        signals: Number of signals by type, without references.
        signal_references: Number of references to signals.
        controllers: Number of controllers.
        objects: Number of objects by type; a repeated one counts once.
        structures: Number of tunnels and bridges by kind.
    """

    name: str
    title: str
    version: str
    vendor: str
    date: str
    geo_reference: str
    bounds: tuple[float, float, float, float]
    roads: int
    roads_in_junctions: int
    length: float
    length_outside_junctions: float
    rules: dict[str, int]
    geometries: dict[str, int]
    junctions: dict[str, int]
    lane_sections: int
    lanes: dict[str, int]
    lane_length: dict[str, float]
    speed_limits: dict[float, int]
    signals: dict[str, int]
    signal_references: int
    controllers: int
    objects: dict[str, int]
    structures: dict[str, int]


def describe_network(network: Network) -> NetworkDescription:
    """Summarise a network; counts are ordered by name, speed limits by value.

    Raises:
        CompileError: The file can no longer be read as before.
    """
    n = network.tables
    model = network.model()
    roads = range(len(n.road_length))
    lanes: Counter[str] = Counter()
    lane_length: dict[str, float] = {}
    for row, lane in enumerate(n.lane_id):
        if lane != 0:
            section = n.lane_section[row]
            kind = LANE_TYPES[n.lane_type[row]]
            lanes[kind] += 1
            lane_length[kind] = lane_length.get(kind, 0.0) + n.section_end[section] - n.section_s[section]
    limits = Counter(speed for speed in (*n.speed_max, *n.type_speed) if speed != NO_SPEED)
    return NetworkDescription(
        name=network.name,
        title=model.header.name,
        version=".".join(str(part) for part in model.header.version),
        vendor=model.header.vendor,
        date=model.header.date,
        geo_reference=model.header.geo_reference,
        bounds=network.bounds(),
        roads=len(roads),
        roads_in_junctions=sum(n.road_junction[i] >= 0 for i in roads),
        length=sum(n.road_length),
        length_outside_junctions=sum(n.road_length[i] for i in roads if n.road_junction[i] < 0),
        rules=_sorted(Counter("RHT" if rule > 0 else "LHT" for rule in n.road_rule)),
        geometries=_sorted(_geometries(n)),
        junctions=_sorted(Counter(one.type for one in model.junctions)),
        lane_sections=len(n.section_s),
        lanes=_sorted(lanes),
        lane_length={kind: lane_length[kind] for kind in sorted(lane_length)},
        speed_limits={limit: limits[limit] for limit in sorted(limits)},
        signals=_sorted(Counter(one.type for one in model.signals if not one.reference)),
        signal_references=sum(one.reference for one in model.signals),
        controllers=len(model.controllers),
        objects=_sorted(Counter(one.type or "none" for one in model.objects)),
        structures=_sorted(Counter(one.kind for one in model.structures)),
    )


def _geometries(n: RoadTables) -> Counter[str]:
    """Count geometries by kind; a spiral is cut into several pieces, which have the same rate of curvature."""
    kinds = {LINE: "line", ARC: "arc", SPIRAL: "spiral"}
    counts: Counter[str] = Counter()
    for road in range(len(n.road_length)):
        before: tuple[int, float] | None = None
        for piece in range(n.road_piece[road], n.road_piece[road + 1]):
            here = n.piece_kind[piece], n.piece_dk[piece]
            if here[0] != SPIRAL or here != before:
                counts[kinds.get(here[0], "polynomial")] += 1
            before = here
    return counts


def _sorted(counts: Counter[str]) -> dict[str, int]:
    return {name: counts[name] for name in sorted(counts)}
