"""Positions by latitude and longitude on a map that says how it is projected."""

from __future__ import annotations

from math import cos, pi, radians, sin
from pathlib import Path

import pytest

from scenario_compiler.diagnostics import Diagnostics
from scenario_compiler.plan.binding import Binder
from scenario_compiler.roads import load_network
from scenario_compiler.roads.georeference import read_georeference
from scenario_compiler.vocabulary.positions import FreePosition, GeoPosition
from tests.engine.make import lane, road

UTM = "+proj=utm +zone=32 +datum=WGS84"
PLACE = GeoPosition(latitude=49.0069, longitude=8.4037, heading=0.5)


def bound(folder: Path, header: str, place: GeoPosition = PLACE, hdg: float = 0.0) -> FreePosition | None:
    """Return the place bound to a map with something in its header, and a road from its origin with a heading, rad."""
    text = f'<header revMajor="1" revMinor="6" name="" version="1" date="2026">{header}</header>'
    path = folder / "map.xodr"
    turned = road(1, 100.0, lane(-1)).replace('hdg="0"', f'hdg="{hdg}"')
    path.write_text(f"<OpenDRIVE>{text}{turned}</OpenDRIVE>", encoding="utf-8")
    network = load_network(path, cache=False)
    assert network is not None
    sink = Diagnostics()
    found = Binder(network, {}, sink).bind(place, 0.0)
    assert [one.code.id for one in sink] == ([] if found else ["SC385"])
    assert found is None or isinstance(found, FreePosition)
    return found


def test_a_place_is_projected(tmp_path: Path) -> None:
    georeference = read_georeference(UTM)
    assert georeference is not None
    there = georeference.project(radians(PLACE.latitude), radians(PLACE.longitude))
    assert there is not None
    x, y = there
    found = bound(tmp_path, f"<geoReference><![CDATA[{UTM}]]></geoReference>")
    assert found is not None
    assert (found.x, found.y, found.heading) == pytest.approx((x, y, 0.5))


def test_the_offset_of_the_map_counts(tmp_path: Path) -> None:
    plain = bound(tmp_path, f"<geoReference><![CDATA[{UTM}]]></geoReference>")
    offset = '<offset x="400000" y="5000000" z="0" hdg="0.25"/>'
    found = bound(tmp_path, f"<geoReference><![CDATA[{UTM}]]></geoReference>{offset}")
    assert plain is not None
    assert found is not None
    x, y = float(found.x), float(found.y)  # type: ignore[arg-type]
    there = (400000 + x * cos(0.25) - y * sin(0.25), 5000000 + x * sin(0.25) + y * cos(0.25))
    assert there == pytest.approx((plain.x, plain.y))


@pytest.mark.parametrize(("at", "along"), [(10.0, 1.2), (-10.0, 0.0)])
@pytest.mark.parametrize(("turn", "heading"), [(0.0, None), (0.3, None), (0.3, 0.5)])
def test_a_turn_is_against_the_road_there(
    tmp_path: Path, at: float, along: float, turn: float, heading: float | None
) -> None:
    """Before the road's start there is no road, and the turn is against the x axis."""
    georeference = read_georeference(UTM)
    assert georeference is not None
    there = georeference.project(radians(PLACE.latitude), radians(PLACE.longitude))
    assert there is not None
    x, y = at * cos(1.2) + 1.75 * sin(1.2), at * sin(1.2) - 1.75 * cos(1.2)
    offset = f'<offset x="{there[0] - x}" y="{there[1] - y}" z="0" hdg="0"/>'
    place = GeoPosition(latitude=PLACE.latitude, longitude=PLACE.longitude, turn=turn, heading=heading)
    found = bound(tmp_path, f"<geoReference><![CDATA[{UTM}]]></geoReference>{offset}", place, 1.2)
    assert found is not None
    assert (found.x, found.y) == pytest.approx((x, y))
    assert found.heading == pytest.approx(along + turn if heading is None else heading)


@pytest.mark.parametrize("header", ["", "<geoReference>+proj=aea</geoReference>", f"<geoReference>{pi}</geoReference>"])
def test_a_map_without_a_known_projection_is_reported(tmp_path: Path, header: str) -> None:
    assert bound(tmp_path, header) is None
