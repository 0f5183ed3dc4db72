"""Latitude and longitude to a map's plane, as its `geoReference` states it."""

from __future__ import annotations

from math import radians

import pytest

from scenario_compiler.roads.georeference import read_georeference


def projected(text: str, latitude: float, longitude: float) -> tuple[float, float]:
    """Return (x, y) in m of a place by latitude and longitude, degrees."""
    georeference = read_georeference(text)
    assert georeference is not None
    found = georeference.project(radians(latitude), radians(longitude))
    assert found is not None
    return found


def test_utm_of_a_known_place() -> None:
    """The CN tower's UTM coordinates, as published: zone 17, 630084 m east, 4833438 m north."""
    there = (43 + 38 / 60 + 33.24 / 3600, -(79 + 23 / 60 + 13.7 / 3600))
    x, y = projected("+proj=utm +zone=17 +datum=WGS84 +units=m +no_defs", *there)
    assert x == pytest.approx(630084.0, abs=1.0)
    assert y == pytest.approx(4833438.0, abs=1.0)


def test_a_quarter_of_the_meridian() -> None:
    """The pole is 10 001 965.729 m from the equator on WGS 84."""
    x, y = projected("+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=0 +y_0=0 +datum=WGS84", 90.0, 9.0)
    assert x == pytest.approx(0.0, abs=1e-6)
    assert y == pytest.approx(10001965.729, abs=1e-3)


def test_the_origin_is_where_the_reference_puts_it() -> None:
    """At its origin a projection gives its false easting and northing; south of it y is less."""
    text = "+proj=tmerc +lat_0=37.4168716 +lon_0=-122.1030492 +k=1 +x_0=100 +y_0=-20 +datum=WGS84 +units=m"
    assert projected(text, 37.4168716, -122.1030492) == pytest.approx((100.0, -20.0), abs=1e-6)
    x, y = projected(text, 37.4158716, -122.1020492)
    assert x == pytest.approx(100.0 + 88.54, abs=0.1)
    assert y == pytest.approx(-20.0 - 110.98, abs=0.1)


def test_on_a_sphere() -> None:
    """A degree of latitude on a sphere is its part of the circle."""
    _, y = projected("+proj=tmerc +a=6378137 +b=6378137 +lat_0=0 +lon_0=0", 1.0, 0.0)
    assert y == pytest.approx(6378137.0 * radians(1.0), abs=1e-3)


BY_PROJ = [
    ("+proj=utm +zone=32 +datum=WGS84", 456391.246, 5428394.107),
    ("proj=utm zone=32 datum=WGS84", 456391.246, 5428394.107),
    ("+proj=merc +lat_ts=48 +lon_0=9 +ellps=GRS80", -44499.098, 4185637.699),
    ("+proj=merc +k=0.9 +lon_0=10 +x_0=5 +ellps=WGS84", -159924.373, 5619387.133),
    ("+proj=webmerc +datum=WGS84", 935495.605, 6276032.261),
    ("+proj=merc +a=6378137 +b=6378137 +nadgrids=@null +wktext", 935495.605, 6276032.261),
    ("+proj=lcc +lat_1=48 +lat_2=51 +lat_0=49 +lon_0=10 +ellps=GRS80", -116743.785, 2003.938),
    ("+proj=lcc +lat_0=47 +lat_1=47 +lon_0=10 +k_0=0.999 +ellps=GRS80", -116735.448, 224160.068),
    ("+proj=tmerc +lat_0=49 +lon_0=8 +R=6371000", 29445.977, 845.545),
    ("+proj=tmerc +lat_0=48 +lon_0=8 +ellps=intl +towgs84=-87,-98,-121", 29620.472, 112144.385),
    (
        "+proj=tmerc +lon_0=9 +x_0=3500000 +ellps=bessel +towgs84=598.1,73.7,418.2,0.202,0.045,-2.455,6.7",
        3456449.191,
        5430125.906,
    ),
    ("EPSG:32632", 456391.246, 5428394.107),
    ("epsg:25832", 456391.246, 5428394.106),
    ("+init=epsg:25832 +no_defs", 456391.246, 5428394.106),
    ("urn:ogc:def:crs:EPSG::25832", 456391.246, 5428394.106),
    (
        'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",AUTHORITY["EPSG","4258"]],AUTHORITY["EPSG","25832"]]',
        456391.246,
        5428394.106,
    ),
    ('PROJCRS["ETRS89 / UTM zone 32N",BASEGEOGCRS["ETRS89"],ID["EPSG",25832]]', 456391.246, 5428394.106),
    ("EPSG:3006", 17746.111, 5449219.294),
    ("EPSG:3857", 935495.605, 6276032.261),
    ("EPSG:2154", 1095037.400, 6892076.279),
    ("EPSG:31467", 3456449.191, 5430125.906),
]


@pytest.mark.parametrize(("text", "x", "y"), BY_PROJ, ids=[text[:60] for text, _, _ in BY_PROJ])
def test_a_place_is_projected_as_proj_projects_it(text: str, x: float, y: float) -> None:
    """The place has the coordinates that PROJ 9.5.1 gives it, by any spelling of the reference."""
    assert projected(text, 49.0069, 8.4037) == pytest.approx((x, y), abs=1.1e-3)


def test_a_zone_of_the_south() -> None:
    """A place 2 degrees south of the equator on the central meridian: 0.9996 of its arc, 221149 m, below 10 000 km."""
    x, y = projected("EPSG:32756", -2.0, 153.0)
    assert x == pytest.approx(500000.0, abs=1e-3)
    assert y == pytest.approx(10000000.0 - 0.9996 * 221149.453, abs=0.1)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "local",
        "+proj=aea +lat_1=29 +lat_2=45",
        "+proj=longlat +datum=WGS84",
        "+proj=utm +zone=north +datum=WGS84",
        "+proj=utm +zone=61 +datum=WGS84",
        "+proj=utm +datum=WGS84",
        "+proj=tmerc +lat_0=x",
        "+proj=tmerc +lat_0=91",
        "+proj=tmerc +ellps=none",
        "+proj=tmerc +datum=NAD27",
        "+proj=tmerc +units=us-ft",
        "+proj=tmerc +pm=paris",
        "+proj=tmerc +axis=neu",
        "+proj=tmerc +nadgrids=BETA2007.gsb",
        "+proj=tmerc +towgs84=1,2",
        "+proj=tmerc +towgs84=1,2,nan",
        "+proj=tmerc +gamma=3",
        "+proj=tmerc +k=0",
        "+proj=merc +lat_ts=90",
        "+proj=lcc +lon_0=10",
        "+proj=lcc +lat_0=0 +lat_1=40 +lat_2=-40",
        "+lat_0=49 +lon_0=8",
        "+proj=tmerc +a=0 +b=0",
        "+proj=tmerc +a=6378137 +b=9000000",
        "+proj=tmerc +a=6378137 +rf=0",
        "+proj=tmerc +R=1e400",
        "+proj=tmerc +lon_0=nan",
        "EPSG:4326",
        "EPSG:99999",
    ],
)
def test_other_references_have_no_meaning(text: str) -> None:
    """Other projections, units, datums and codes, and unreadable numbers are not guessed at."""
    assert read_georeference(text) is None


def test_a_place_that_a_projection_does_not_have() -> None:
    """The poles are infinitely far away on Mercator's map."""
    georeference = read_georeference("+proj=merc +datum=WGS84")
    assert georeference is not None
    assert georeference.project(radians(90.0), 0.0) is None
