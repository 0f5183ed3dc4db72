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


def bound(folder: Path, header: str) -> FreePosition | None:
    """Return the place bound to a map with something in its header."""
    text = f'<header revMajor="1" revMinor="6" name="" version="1" date="2026">{header}</header>'
    path = folder / "map.xodr"
    path.write_text(f"<OpenDRIVE>{text}{road(1, 100.0, lane(-1))}</OpenDRIVE>", encoding="utf-8")
    network = load_network(path, cache=False)
    assert network is not None
    sink = Diagnostics()
    found = Binder(network, {}, sink).bind(PLACE, 0.0)
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


@pytest.mark.parametrize("header", ["", "<geoReference>+proj=aea</geoReference>", f"<geoReference>{pi}</geoReference>"])
def test_a_map_without_a_known_projection_is_reported(tmp_path: Path, header: str) -> None:
    assert bound(tmp_path, header) is None
