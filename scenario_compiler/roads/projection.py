"""Map projections of an ellipsoid: transverse Mercator, Mercator and Lambert's conformal conic.

The series of the transverse Mercator projection is Krueger's, to the fourth order in the third flattening, as in
C. F. F. Karney, "Transverse Mercator with an accuracy of a few nanometers", Journal of Geodesy 85 (2011), equations 7
to 12 and 35: exact to 1 mm within 3000 km of the central meridian. The other formulas are those of J. P. Snyder, "Map
Projections: A Working Manual", USGS Professional Paper 1395 (1987), equations 7-7 and 14-15 to 15-11.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asinh, atan2, atanh, cos, cosh, exp, hypot, log, pi, remainder, sin, sinh, sqrt, tan
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Ellipsoid:
    """The shape of the Earth: its equatorial radius, m, and its flattening."""

    radius: float
    flattening: float

    @property
    def eccentricity(self) -> float:
        """The first eccentricity."""
        return sqrt(self.flattening * (2.0 - self.flattening))

    def isometric(self, latitude: float) -> float:
        """Return the isometric latitude, rad, of a latitude, rad; infinite at the poles."""
        e, s = self.eccentricity, sin(latitude)
        return atanh(s) - e * atanh(e * s)

    def parallel(self, latitude: float) -> float:
        """Return the radius of a parallel of latitude for an equatorial radius of 1."""
        return cos(latitude) / sqrt(1.0 - (self.eccentricity * sin(latitude)) ** 2)


class Projection(Protocol):
    """What maps a latitude and a longitude to a plane."""

    def project(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return (x, y) in m of a point by its latitude and longitude, rad; x points east, y north."""


@dataclass(frozen=True, slots=True)
class TransverseMercator:
    """A transverse Mercator projection.

    Attributes:
        ellipsoid: The ellipsoid.
        latitude: Of the origin, rad.
        longitude: Of the central meridian, rad.
        scale: On the central meridian.
        easting: x of the origin, m.
        northing: y of the origin, m.
    """

    ellipsoid: Ellipsoid
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
        flattening = self.ellipsoid.flattening
        n = flattening / (2.0 - flattening)
        rectifying = self.ellipsoid.radius / (1.0 + n) * (1.0 + n * n / 4.0 + n**4 / 64.0)
        eccentricity = self.ellipsoid.eccentricity
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


@dataclass(frozen=True, slots=True)
class Mercator:
    """A Mercator projection; its attributes have the meanings of `TransverseMercator`, `scale` is on the equator."""

    ellipsoid: Ellipsoid
    longitude: float
    scale: float
    easting: float
    northing: float

    def project(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return (x, y) in m of a point by its latitude and longitude, rad."""
        radius = self.scale * self.ellipsoid.radius
        east = radius * remainder(longitude - self.longitude, 2.0 * pi)
        return self.easting + east, self.northing + radius * self.ellipsoid.isometric(latitude)


@dataclass(frozen=True, slots=True)
class LambertConic:
    """Lambert's conformal conic projection.

    Attributes:
        ellipsoid: The ellipsoid.
        latitude: Of the origin, rad.
        longitude: Of the central meridian, rad.
        parallels: The two standard parallels, rad; equal if there is one.
        scale: On the standard parallels.
        easting: x of the origin, m.
        northing: y of the origin, m.
    """

    ellipsoid: Ellipsoid
    latitude: float
    longitude: float
    parallels: tuple[float, float]
    scale: float
    easting: float
    northing: float

    def project(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return (x, y) in m of a point by its latitude and longitude, rad."""
        cone = self._cone()
        radius, origin = self._radius(latitude, cone), self._radius(self.latitude, cone)
        turned = cone * remainder(longitude - self.longitude, 2.0 * pi)
        return self.easting + radius * sin(turned), self.northing + origin - radius * cos(turned)

    def _cone(self) -> float:
        """Return the constant of the cone: by how much a meridian turns for a radian of longitude."""
        first, second = self.parallels
        if abs(first - second) < 1.0e-10:
            return sin(first)
        wide = log(self.ellipsoid.parallel(first) / self.ellipsoid.parallel(second))
        return wide / (self.ellipsoid.isometric(second) - self.ellipsoid.isometric(first))

    def _radius(self, latitude: float, cone: float) -> float:
        """Return the radius of a parallel on the map, m."""
        first = self.parallels[0]
        there = self.ellipsoid.isometric(first) - self.ellipsoid.isometric(latitude)
        return self.scale * self.ellipsoid.radius * self.ellipsoid.parallel(first) / cone * exp(cone * there)
