"""Reads the `geoReference` of a road file: how latitude and longitude on WGS 84 become the file's own coordinates.

It is a PROJ string, or the EPSG code of a projected coordinate system, alone or at the end of its well-known text. The
words of PROJ strings, and the constants of their ellipsoids and datums, are those of PROJ's documentation. A string
with a word whose effect is not worked out here has no meaning rather than a wrong one.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import atan2, cos, hypot, isfinite, pi, radians, sin, sqrt

from scenario_compiler.roads.projection import Ellipsoid, LambertConic, Mercator, Projection, TransverseMercator

ELLIPSOIDS = {
    "WGS84": (6378137.0, 298.257223563),
    "WGS72": (6378135.0, 298.26),
    "GRS80": (6378137.0, 298.257222101),
    "GRS67": (6378160.0, 298.2471674270),
    "bessel": (6377397.155, 299.1528128),
    "intl": (6378388.0, 297.0),
    "clrk66": (6378206.4, 294.978698214),
    "clrk80ign": (6378249.2, 293.4660212936269),
    "airy": (6377563.396, 299.3249646),
    "mod_airy": (6377340.189, 299.3249646),
    "krass": (6378245.0, 298.3),
    "aust_SA": (6378160.0, 298.25),
    "sphere": (6370997.0, 0.0),
}
"""Equatorial radius, m, and inverse flattening (0: a sphere) of PROJ's ellipsoids."""

DATUMS = {
    "WGS84": ("WGS84", ""),
    "NAD83": ("GRS80", ""),
    "GGRS87": ("GRS80", "-199.87,74.79,246.62"),
    "potsdam": ("bessel", "598.1,73.7,418.2,0.202,0.045,-2.455,6.7"),
    "hermannskogel": ("bessel", "577.326,90.129,463.919,5.137,1.474,5.297,2.4232"),
    "ire65": ("mod_airy", "482.530,-130.596,564.557,-1.042,-0.214,-0.631,8.15"),
    "OSGB36": ("airy", "446.448,-125.157,542.060,0.1502,0.2470,0.8421,-20.4894"),
}
"""Ellipsoid of PROJ's datums, and the numbers of `+towgs84` that lead from them to WGS 84."""

UTM_SCALE = 0.9996
UTM_EASTING = 500000.0
UTM_SOUTHERN_NORTHING = 10000000.0
UTM_ZONES = 60

WITHOUT_EFFECT = frozenset(
    {
        "no_defs", "type", "title", "wktext", "over", "approx", "algo",
        "vunits", "vto_meter", "geoidgrids", "geoid_crs",
    }
)  # fmt: skip
"""Words of a PROJ string that change neither x nor y."""

WITH_EFFECT = frozenset(
    {
        "proj", "zone", "south", "lat_0", "lon_0", "lat_1", "lat_2", "lat_ts", "k", "k_0", "x_0", "y_0",
        "R", "a", "b", "f", "rf", "ellps", "datum", "towgs84",
    }
)  # fmt: skip
"""Words of a PROJ string that are worked out."""

ONLY = {"units": {"m"}, "to_meter": {"1", "1.0"}, "axis": {"enu"}, "pm": {"greenwich", "0"}, "nadgrids": {"@null"}}
"""Words of a PROJ string with the values that change nothing; other values are not worked out."""


@dataclass(frozen=True, slots=True)
class DatumShift:
    """From an ellipsoid of its own to WGS 84, as `+towgs84`: metres, radians (position vector rule) and a factor."""

    ellipsoid: Ellipsoid
    moved: tuple[float, float, float]
    turned: tuple[float, float, float]
    scale: float

    def from_wgs84(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Return latitude and longitude, rad, on the datum's ellipsoid of a point at height 0 on WGS 84."""
        x, y, z = _geocentric(WGS84, latitude, longitude)
        dx, dy, dz = (one - away for one, away in zip((x, y, z), self.moved, strict=True))
        rx, ry, rz = self.turned
        x = (dx + rz * dy - ry * dz) / self.scale
        y = (dy - rz * dx + rx * dz) / self.scale
        z = (dz + ry * dx - rx * dy) / self.scale
        return _latitude(self.ellipsoid, hypot(x, y), z), atan2(y, x)


@dataclass(frozen=True, slots=True)
class Georeference:
    """A projection, with the shift to its datum if that is not WGS 84."""

    projection: Projection
    shift: DatumShift | None = None

    def project(self, latitude: float, longitude: float) -> tuple[float, float] | None:
        """Return (x, y) in m of a point by latitude and longitude on WGS 84, rad; None if the projection has none."""
        if self.shift is not None:
            latitude, longitude = self.shift.from_wgs84(latitude, longitude)
        try:
            x, y = self.projection.project(latitude, longitude)
        except (ValueError, ArithmeticError):
            return None
        return (x, y) if isfinite(x) and isfinite(y) else None


def _named(name: str) -> Ellipsoid:
    radius, inverse = ELLIPSOIDS[name]
    return Ellipsoid(radius, 1.0 / inverse if inverse else 0.0)


WGS84 = _named("WGS84")


def _geocentric(ellipsoid: Ellipsoid, latitude: float, longitude: float) -> tuple[float, float, float]:
    """Return (x, y, z) in m from the Earth's centre of a point on an ellipsoid."""
    squared = ellipsoid.eccentricity**2
    vertical = ellipsoid.radius / sqrt(1.0 - squared * sin(latitude) ** 2)
    across = vertical * cos(latitude)
    return across * cos(longitude), across * sin(longitude), vertical * (1.0 - squared) * sin(latitude)


def _latitude(ellipsoid: Ellipsoid, across: float, z: float) -> float:
    """Return the latitude, rad, of a point near the surface by its distance from the Earth's axis and z, m.

    A fixed number of steps of Bowring's iteration, which starts right to 1e-9 rad (B. R. Bowring, "Transformation from
    spatial to geographical coordinates", Survey Review 23 (1976)).
    """
    squared, polar = ellipsoid.eccentricity**2, ellipsoid.radius * (1.0 - ellipsoid.flattening)
    reduced = atan2(z * ellipsoid.radius, across * polar)
    latitude = 0.0
    for _ in range(3):
        above = z + squared / (1.0 - squared) * polar * sin(reduced) ** 3
        latitude = atan2(above, across - squared * ellipsoid.radius * cos(reduced) ** 3)
        reduced = atan2((1.0 - ellipsoid.flattening) * sin(latitude), cos(latitude))
    return latitude


def read_georeference(text: str) -> Georeference | None:
    """Return the meaning of a `geoReference`; None if it is not known."""
    code = _epsg_code(text)
    words = text if code is None else _by_code(code)
    if words is None:
        return None
    given = {name: value for name, _, value in (word.lstrip("+").partition("=") for word in words.split())}
    unknown = given.keys() - WITH_EFFECT - WITHOUT_EFFECT - ONLY.keys()
    if unknown or any(name in given and given[name] not in allowed for name, allowed in ONLY.items()):
        return None
    try:
        shape = _ellipsoid(given)
        projection, shift = _projection(given, shape), _shift(given, shape)
    except (ValueError, ArithmeticError):
        return None
    return None if projection is None else Georeference(projection, shift)


_EPSG = (
    re.compile(r"(?:\+?init=)?EPSG:(\d{4,6})(?:\s+\+no_defs|\s+\+type=crs)*", re.IGNORECASE),
    re.compile(r"urn:ogc:def:crs:EPSG:[\d.]*:(\d{4,6})", re.IGNORECASE),
    re.compile(r'(?:PROJCS|PROJCRS)\[.*(?:AUTHORITY|ID)\["EPSG",\s*"?(\d{4,6})"?\]\s*\]', re.DOTALL),
)


def _epsg_code(text: str) -> int | None:
    found = next((match for one in _EPSG if (match := one.fullmatch(text.strip()))), None)
    return None if found is None else int(found[1])


_UTM_CODES: Iterable[tuple[range, int, str]] = (
    (range(32601, 32661), 32600, "+datum=WGS84"),
    (range(32701, 32761), 32700, "+datum=WGS84 +south"),
    (range(25828, 25839), 25800, "+ellps=GRS80"),
    (range(3040, 3050), 3012, "+ellps=GRS80"),
    (range(26901, 26924), 26900, "+datum=NAD83"),
    (range(6330, 6349), 6329, "+ellps=GRS80"),
    (range(28348, 28359), 28300, "+ellps=GRS80 +south"),
    (range(7846, 7860), 7800, "+ellps=GRS80 +south"),
    (range(3006, 3007), 2973, "+ellps=GRS80"),
    (range(3067, 3068), 3032, "+ellps=GRS80"),
)
"""Codes of coordinate systems in UTM zones, the code before that of zone 1, and their datum.

WGS 84; ETRS89 (also with northing first, and those of Sweden and Finland); NAD83 and NAD83(2011); GDA94 and GDA2020.
"""

_OTHER_CODES: Mapping[int, str] = {
    3857: "+proj=webmerc +datum=WGS84",
    900913: "+proj=webmerc +datum=WGS84",
    3395: "+proj=merc +datum=WGS84",
    2154: "+proj=lcc +lat_0=46.5 +lon_0=3 +lat_1=49 +lat_2=44 +x_0=700000 +y_0=6600000 +ellps=GRS80",
    2180: "+proj=tmerc +lat_0=0 +lon_0=19 +k=0.9993 +x_0=500000 +y_0=-5300000 +ellps=GRS80",
    27700: "+proj=tmerc +lat_0=49 +lon_0=-2 +k=0.9996012717 +x_0=400000 +y_0=-100000 +datum=OSGB36",
    2157: "+proj=tmerc +lat_0=53.5 +lon_0=-8 +k=0.99982 +x_0=600000 +y_0=750000 +ellps=GRS80",
}
"""Codes with their PROJ strings: the web's maps, and the grids of France, Poland, Great Britain and Ireland."""

_GAUSS_KRUEGER = range(31466, 31470)
"""Codes of the German Gauss-Krueger zones 2 to 5 on DHDN."""


def _by_code(code: int) -> str | None:
    """Return the PROJ string of an EPSG code; None if it is not known. The axes of a map are always east and north."""
    for codes, before, datum in _UTM_CODES:
        if code in codes:
            return f"+proj=utm +zone={code - before} {datum}"
    if code in _GAUSS_KRUEGER:
        zone = code - 31464
        return f"+proj=tmerc +lat_0=0 +lon_0={3 * zone} +k=1 +x_0={zone}500000 +y_0=0 +datum=potsdam"
    return _OTHER_CODES.get(code)


def _ellipsoid(given: Mapping[str, str]) -> Ellipsoid:
    """Return the ellipsoid of a PROJ string's words.

    Raises:
        ValueError: It is not known, or its numbers are not those of one.
        ZeroDivisionError: The same.
    """
    if "R" in given:
        return _sized(float(given["R"]), 0.0)
    if "a" in given:
        radius = float(given["a"])
        if "b" in given:
            return _sized(radius, 1.0 - float(given["b"]) / radius)
        if "rf" in given:
            return _sized(radius, 1.0 / float(given["rf"]))
        return _sized(radius, float(given.get("f", "0")))
    name = given.get("ellps") or DATUMS.get(given.get("datum", "WGS84"), ("", ""))[0]
    if name not in ELLIPSOIDS:
        raise ValueError
    return _named(name)


def _sized(radius: float, flattening: float) -> Ellipsoid:
    if not (0.0 < radius < float("inf") and 0.0 <= flattening < 0.5):
        raise ValueError
    return Ellipsoid(radius, flattening)


def _shift(given: Mapping[str, str], ellipsoid: Ellipsoid) -> DatumShift | None:
    """Return the shift by `+towgs84`, or by that of the datum; None if it moves nothing.

    Raises:
        ValueError: It does not consist of three or seven numbers.
    """
    usual = DATUMS.get(given.get("datum", "WGS84"), ("", ""))[1]
    numbers = tuple(_number(one) for one in given.get("towgs84", usual).split(",") if one)
    if len(numbers) not in (0, 3, 7):
        raise ValueError
    if not any(numbers):
        return None
    x, y, z, *seconds, millionths = numbers + (0.0,) * (7 - len(numbers))
    turned = [radians(one / 3600.0) for one in seconds]
    return DatumShift(ellipsoid, (x, y, z), (turned[0], turned[1], turned[2]), 1.0 + millionths * 1.0e-6)


def _number(text: str) -> float:
    number = float(text)
    if not isfinite(number):
        raise ValueError
    return number


def _projection(given: Mapping[str, str], shape: Ellipsoid) -> Projection | None:
    """Return the projection of a PROJ string's words; None if it is not known.

    Raises:
        ValueError: A number is not one.
    """

    def angle(name: str, usual: float = 0.0) -> float:
        return radians(_number(given[name])) if name in given else usual

    kind, longitude = given.get("proj"), angle("lon_0")
    if kind == "utm":
        return _utm(given, shape)
    latitude = angle("lat_0")
    scale = _number(given.get("k_0", given.get("k", "1")))
    origin = _number(given.get("x_0", "0")), _number(given.get("y_0", "0"))
    if abs(latitude) > 0.5 * pi or scale <= 0.0:
        return None
    if kind in ("tmerc", "etmerc"):
        return TransverseMercator(shape, latitude, longitude, scale, *origin)
    if kind == "webmerc":
        return Mercator(Ellipsoid(shape.radius, 0.0), longitude, 1.0, *origin)
    if kind == "merc":
        true = angle("lat_ts")
        if abs(true) >= 0.5 * pi:
            return None
        return Mercator(shape, longitude, shape.parallel(true) if "lat_ts" in given else scale, *origin)
    if kind == "lcc":
        if "lat_0" not in given and "lat_2" not in given:
            return None
        first = angle("lat_1", latitude)
        second = angle("lat_2", first)
        if max(abs(first), abs(second)) >= 0.5 * pi or abs(first + second) < 1.0e-10:
            return None
        return LambertConic(shape, latitude, longitude, (first, second), scale, *origin)
    return None


def _utm(given: Mapping[str, str], shape: Ellipsoid) -> TransverseMercator | None:
    zone = int(given.get("zone", ""))
    if not 1 <= zone <= UTM_ZONES:
        return None
    northing = UTM_SOUTHERN_NORTHING if "south" in given else 0.0
    return TransverseMercator(shape, 0.0, radians(6.0 * zone - 183.0), UTM_SCALE, UTM_EASTING, northing)
