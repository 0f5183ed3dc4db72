"""Latitude and longitude to a map's plane."""

from __future__ import annotations

from math import radians

import pytest

from scenario_compiler.roads.projection import read_projection


def test_utm_of_a_known_place() -> None:
    """The CN tower's UTM coordinates, as published: zone 17, 630084 m east, 4833438 m north."""
    projection = read_projection("+proj=utm +zone=17 +datum=WGS84 +units=m +no_defs")
    assert projection is not None
    x, y = projection.project(radians(43 + 38 / 60 + 33.24 / 3600), radians(-(79 + 23 / 60 + 13.7 / 3600)))
    assert x == pytest.approx(630084.0, abs=1.0)
    assert y == pytest.approx(4833438.0, abs=1.0)


def test_a_quarter_of_the_meridian() -> None:
    """The pole is 10 001 965.729 m from the equator on WGS 84."""
    projection = read_projection("+proj=tmerc +lat_0=0 +lon_0=9 +k=1 +x_0=0 +y_0=0 +datum=WGS84")
    assert projection is not None
    x, y = projection.project(radians(90.0), radians(9.0))
    assert x == pytest.approx(0.0, abs=1e-6)
    assert y == pytest.approx(10001965.729, abs=1e-3)


def test_the_origin_is_where_the_reference_puts_it() -> None:
    """At its origin a projection gives its false easting and northing; south of it y is less."""
    text = "+proj=tmerc +lat_0=37.4168716 +lon_0=-122.1030492 +k=1 +x_0=100 +y_0=-20 +datum=WGS84 +units=m"
    projection = read_projection(text)
    assert projection is not None
    assert projection.project(radians(37.4168716), radians(-122.1030492)) == pytest.approx((100.0, -20.0), abs=1e-6)
    x, y = projection.project(radians(37.4158716), radians(-122.1020492))
    assert x == pytest.approx(100.0 + 88.54, abs=0.1)
    assert y == pytest.approx(-20.0 - 110.98, abs=0.1)


def test_on_a_sphere() -> None:
    """A degree of latitude on a sphere is its part of the circle."""
    projection = read_projection("+proj=tmerc +a=6378137 +b=6378137 +lat_0=0 +lon_0=0")
    assert projection is not None
    assert projection.project(radians(1.0), 0.0)[1] == pytest.approx(6378137.0 * radians(1.0), abs=1e-3)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "+proj=merc +datum=WGS84",
        "+proj=utm +zone=north +datum=WGS84",
        "+proj=tmerc +lat_0=x",
        "+proj=tmerc +ellps=none",
        "+proj=tmerc +units=us-ft",
        "+lat_0=49 +lon_0=8",
        "+proj=tmerc +a=0 +b=0",
        "+proj=tmerc +a=6378137 +b=9000000",
        "+proj=tmerc +R=1e400",
        "+proj=tmerc +lon_0=nan",
    ],
)
def test_other_projections_than_transverse_mercator_are_not_supported(text: str) -> None:
    """Other projections, units and unreadable numbers are not guessed at."""
    assert read_projection(text) is None
