"""From latitude and longitude to a map's plane, for maps whose `geoReference` is a transverse Mercator projection.

The series is Krueger's, to the fourth order in the third flattening, as in C. F. F. Karney, "Transverse Mercator with
an accuracy of a few nanometers", Journal of Geodesy 85 (2011), equations 7 to 12 and 35: exact to 1 mm within 3000 km
of the central meridian. Parameters have the names of PROJ strings.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from math import asinh, atan2, atanh, cos, cosh, hypot, isfinite, pi, radians, sin, sinh, sqrt, tan

ELLIPSOIDS = {
    "WGS84": (6378137.0, 298.257223563),
    "GRS80": (6378137.0, 298.257222101),
    "bessel": (6377397.155, 299.1528128),
    "intl": (6378388.0, 297.0),
    "clrk66": (6378206.4, 294.978698214),
    "airy": (6377563.396, 299.3249646),
    "krass": (6378245.0, 298.3),
    "sphere": (6370997.0, 0.0),
}
"""Equatorial radius, m, and inverse flattening (0: a sphere) of PROJ's ellipsoids, as its documentation lists them."""

UTM_SCALE = 0.9996
UTM_EASTING = 500000.0
UTM_SOUTHERN_NORTHING = 10000000.0


@dataclass(frozen=True, slots=True)
class TransverseMercator:
    """A transverse Mercator projection.

    Attributes:
        radius: Equatorial radius, m.
        flattening: Of the ellipsoid.
        latitude: Of the origin, rad.
        longitude: Of the central meridian, rad.
        scale: On the central meridian.
        easting: x of the origin, m.
        northing: y of the origin, m.
    """

    radius: float
    flattening: float
    latitude: float
    longitude: float
    scale: float
    easting: float
    northing: float

    def project(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return (x, y) in m of a point by its latitude and longitude, rad."""
        x, y = self._on_meridian(latitude, longitude - self.longitude)
        _, origin = self._on_meridian(self.latitude, 0.0)
        return self.easting + x, self.northing + y - origin

    def _on_meridian(self, latitude: float, away: float) -> tuple[float, float]:
        """Return (x, y) from the equator and the central meridian; `away` is the longitude from that, rad."""
        n = self.flattening / (2.0 - self.flattening)
        rectifying = self.radius / (1.0 + n) * (1.0 + n * n / 4.0 + n**4 / 64.0)
        eccentricity = sqrt(self.flattening * (2.0 - self.flattening))
        tangent = tan(min(max(latitude, -0.5 * pi), 0.5 * pi))
        sigma = sinh(eccentricity * atanh(eccentricity * tangent / hypot(1.0, tangent)))
        conformal = tangent * hypot(1.0, sigma) - sigma * hypot(1.0, tangent)
        xi = atan2(conformal, cos(away))
        eta = asinh(sin(away) / hypot(conformal, cos(away)))
        north, east = xi, eta
        for order, factor in enumerate(_series(n), start=1):
            north += factor * sin(2 * order * xi) * cosh(2 * order * eta)
            east += factor * cos(2 * order * xi) * sinh(2 * order * eta)
        return self.scale * rectifying * east, self.scale * rectifying * north


def _series(n: float) -> tuple[float, float, float, float]:
    """Return the coefficients of Krueger's series to the fourth order in the third flattening n."""
    return (
        n / 2.0 - 2.0 * n**2 / 3.0 + 5.0 * n**3 / 16.0 + 41.0 * n**4 / 180.0,
        13.0 * n**2 / 48.0 - 3.0 * n**3 / 5.0 + 557.0 * n**4 / 1440.0,
        61.0 * n**3 / 240.0 - 103.0 * n**4 / 140.0,
        49561.0 * n**4 / 161280.0,
    )


def read_projection(text: str) -> TransverseMercator | None:
    """Return the projection of a PROJ string; None unless it is a transverse Mercator or UTM projection."""
    found = _read(text)
    return found if found is not None and all(isfinite(number) for number in astuple(found)) else None


def _read(text: str) -> TransverseMercator | None:
    words = (word.lstrip("+").partition("=") for word in text.split() if word.startswith("+"))
    given = {name: value for name, _, value in words}
    shape = _ellipsoid(given)
    if shape is None or given.get("units", "m") != "m":
        return None
    try:
        if given.get("proj") == "utm":
            zone = int(given.get("zone", ""))
            northing = UTM_SOUTHERN_NORTHING if "south" in given else 0.0
            meridian = radians(6.0 * zone - 183.0)
            return TransverseMercator(*shape, 0.0, meridian, UTM_SCALE, UTM_EASTING, northing)
        if given.get("proj") != "tmerc":
            return None
        latitude, longitude = (radians(float(given.get(name, "0"))) for name in ("lat_0", "lon_0"))
        scale = float(given.get("k", given.get("k_0", "1")))
        return TransverseMercator(
            *shape, latitude, longitude, scale, float(given.get("x_0", "0")), float(given.get("y_0", "0"))
        )
    except ValueError:
        return None


def _ellipsoid(given: dict[str, str]) -> tuple[float, float] | None:
    """Return (equatorial radius in m, flattening) from a PROJ string's words; None for an unknown ellipsoid."""
    try:
        if "R" in given:
            return float(given["R"]), 0.0
        if "a" in given:
            radius = float(given["a"])
            flattening = 1.0 - float(given.get("b", given["a"])) / radius
            return (radius, flattening) if 0.0 <= flattening < 0.5 else None
    except (ValueError, ZeroDivisionError):
        return None
    datums = {"WGS84": "WGS84", "NAD83": "GRS80", "potsdam": "bessel"}
    name = given.get("ellps") or datums.get(given.get("datum", "WGS84"), "")
    if name not in ELLIPSOIDS:
        return None
    radius, inverse = ELLIPSOIDS[name]
    return radius, 1.0 / inverse if inverse else 0.0
