"""The environment: weather in OpenSCENARIO's terms and in CARLA's 14 numbers, time of day, friction.

Conversion of the standard's terms when reading:

    cloudiness    eighths of the sky (okta) as percent; cloudState free 0, cloudy 60, overcast and rainy 100, skyOff 0
    precipitation rain: 2 % for each mm/h, to 50 mm/h (a cloudburst in the German weather service's terms); 1.0's
                  intensity 0 to 1 as percent; snow is reported and treated as rain of the same intensity
    deposits, wetness
                  from `wetness`: dry 0 and 0, moist 0 and 40, wetWithPuddles 50 and 80, lowFlooded 80 and 100,
                  highFlooded 100 and 100; without it, half of the precipitation and all of it
    fog           the density whose extinction leaves 5 % of a contrast at the visual range (Koschmieder), from the
                  lens on and the same at all heights
    wind          its speed relative to that of a hurricane (Beaufort 12, 32.7 m/s), as percent
    sun           the azimuth is measured from north (y) over east (x), CARLA's from x

Writing does the reverse, for the numbers that a change of the weather names, and adds CARLA's numbers as properties of
the road's condition, which take precedence when the file is read. 1.0 requires all parts of the weather; there the
others are those of a clear noon, which is reported.
"""

from __future__ import annotations

import math
from typing import Any

from lxml import etree

from scenario_compiler.diagnostics import Code, Severity
from scenario_compiler.openscenario.catalogs import given
from scenario_compiler.openscenario.node import Node
from scenario_compiler.openscenario.output import Output
from scenario_compiler.openscenario.parameters import with_parameters
from scenario_compiler.openscenario.spelling import Form, made
from scenario_compiler.vocabulary.actions import EnvironmentAction, WeatherAction
from scenario_compiler.vocabulary.kept import KEPT
from scenario_compiler.vocabulary.weather import CLEAR_NOON, WEATHER_NUMBERS, complete_weather, weather_numbers

SNOW = Code(
    "SC784",
    "snow-as-rain",
    "The weather of a file has snow. CARLA's weather has no snow, so rain of the same intensity is used instead:\n\n"
    '    <Precipitation precipitationType="snow" precipitationIntensity="10"/>\n\n'
    "In the conflict language, the `coverage` of <markings> describes snow on road marks.",
    Severity.WARNING,
)

_OKTAS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
_CLOUD_STATES = {"free": 0.0, "skyOff": 0.0, "cloudy": 60.0, "overcast": 100.0, "rainy": 100.0}
_WETNESS = {
    "dry": (0.0, 0.0),
    "moist": (0.0, 40.0),
    "wetWithPuddles": (50.0, 80.0),
    "lowFlooded": (80.0, 100.0),
    "highFlooded": (100.0, 100.0),
}
_WATER = ("precipitation_deposits", "wetness")
"""CARLA's numbers that `wetness` stands for, in the order of its pairs."""

_TOGETHER = {"sun_altitude_angle": ("sun_azimuth_angle",), "fog_density": ("fog_distance", "fog_falloff")}
"""Numbers that have an element of the standard only together with another one."""

_PERCENT_PER_MM = 2.0
_HURRICANE = 32.7
FOG_AT_ONE, FOG_THINNED = 0.07, 0.083
"""Extinction of the thickest fog in CARLA's numbers, 1/m, and the effect of its falloff, as in the camera pictures."""

_FIVE_PERCENT = math.log(20.0)
_CLEAREST = 100000.0
"""Visual range that is written if there is no fog, m."""


def read_environment(node: Node) -> list[WeatherAction | EnvironmentAction]:
    """Return the actions of an <EnvironmentAction>: the weather, and the time of day and friction if it has them."""
    found = given(node, "Environment")
    if found is None:
        if node.child("CatalogReference") is None:
            node.required("Environment", "CatalogReference")
        return []
    environment = with_parameters(found)
    environment.text("name", "")
    exact = _exact_weather(environment)
    if exact is not None:
        return [exact]
    actions: list[WeatherAction | EnvironmentAction] = []
    numbers = _weather(environment)
    if numbers:
        actions.append(WeatherAction.model_construct(**numbers).written_at(environment.origin))
    other = _time_and_road(environment)
    return actions if other is None else [*actions, other]


def _weather(environment: Node) -> dict[str, Any]:
    weather, road = environment.child("Weather"), environment.child("RoadCondition")
    numbers: dict[str, Any] = {}
    if weather is not None:
        numbers.update(_clouds(weather))
        numbers.update(_precipitation(weather))
        numbers.update(_sun_fog_wind(weather))
    wetness = "" if road is None or not road.has("wetness") else road.choice("wetness", tuple(_WETNESS))
    if wetness:
        numbers["precipitation_deposits"], numbers["wetness"] = _WETNESS[wetness]
    elif "precipitation" in numbers:
        numbers["precipitation_deposits"], numbers["wetness"] = numbers["precipitation"] / 2, numbers["precipitation"]
    return numbers


def _clouds(weather: Node) -> dict[str, float]:
    for unused in ("atmosphericPressure", "temperature"):
        weather.has(unused)
    if weather.has("fractionalCloudCover"):
        cover = weather.choice("fractionalCloudCover", tuple(f"{name}Oktas" for name in _OKTAS))
        return {"cloudiness": min(12.5 * _OKTAS.index(cover.removesuffix("Oktas")), 100.0)}
    if weather.has("cloudState"):
        return {"cloudiness": _CLOUD_STATES[weather.choice("cloudState", tuple(_CLOUD_STATES))]}
    return {}


def _precipitation(weather: Node) -> dict[str, float]:
    inner = weather.child("Precipitation")
    if inner is None:
        return {}
    kind = inner.choice("precipitationType", ("dry", "rain", "snow"))
    share = 0.0
    if inner.has("precipitationIntensity"):
        share = _PERCENT_PER_MM * inner.float("precipitationIntensity")
    elif inner.has("intensity"):
        share = 100.0 * inner.float("intensity")
    if kind == "snow":
        inner.report(SNOW, "snow is not supported; rain is used instead", "precipitationType")
    return {"precipitation": 0.0 if kind == "dry" else _percent(share)}


def _sun_fog_wind(weather: Node) -> dict[str, float]:
    numbers: dict[str, float] = {}
    sun, fog, wind = weather.child("Sun"), weather.child("Fog"), weather.child("Wind")
    if sun is not None:
        for unused in ("intensity", "illuminance"):
            sun.has(unused)
        elevation = sun.float("elevation")
        beyond_zenith = 180.0 if math.cos(elevation) < 0.0 else 0.0
        numbers["sun_azimuth_angle"] = (math.degrees(sun.float("azimuth")) - 90.0 + beyond_zenith) % 360.0
        numbers["sun_altitude_angle"] = math.degrees(math.asin(math.sin(elevation)))
    if fog is not None:
        extinction = _FIVE_PERCENT / max(fog.float("visualRange"), 1.0)
        density = _percent(100.0 * (extinction / FOG_AT_ONE) ** (2.0 / 3.0))
        numbers.update(fog_density=density, fog_distance=0.0, fog_falloff=0.0)
    if wind is not None:
        wind.has("direction")
        numbers["wind_intensity"] = _percent(100.0 * wind.float("speed") / _HURRICANE)
    return numbers


def _percent(number: float) -> float:
    return min(max(number, 0.0), 100.0)


def _time_and_road(environment: Node) -> EnvironmentAction | None:
    time, road = environment.child("TimeOfDay"), environment.child("RoadCondition")
    fields: dict[str, Any] = {}
    if road is not None:
        fields["friction"] = road.number("frictionScaleFactor", 1.0)
    if time is not None:
        fields |= {"date_time": time.text("dateTime"), "animated": time.boolean("animation")}
    return EnvironmentAction.model_construct(**fields).written_at(environment.origin) if fields else None


def _exact_weather(environment: Node) -> WeatherAction | None:
    """Return the weather of the road condition's properties in CARLA's numbers; None if any of them is missing."""
    road = environment.child("RoadCondition")
    groups = [] if road is None else road.children("Properties")
    numbers: dict[str, Any] = {
        one.text("name"): one.number("value", 0.0)
        for group in groups
        for one in group.children("Property")
        if one.text("name") in (*WEATHER_NUMBERS, "over_time")
    }
    if not numbers.keys() >= set(WEATHER_NUMBERS):
        return None
    environment.read_whole()
    over_time = numbers.pop("over_time", 0.0)
    return WeatherAction.model_construct(**numbers, over_time=over_time).written_at(environment.origin)


def _write_weather(word: WeatherAction, output: Output) -> etree._Element:
    full = complete_weather(word) or word
    written = {name: getattr(full, name) for name in WEATHER_NUMBERS}
    numbers = {name: number for name, number in written.items() if number != KEPT}
    _tell_unsaid(numbers, word, output)
    properties = [
        made("Property", name=name, value=output.text(value, word))
        for name, value in [*written.items(), ("over_time", word.over_time)]
    ]
    road = made("RoadCondition", made("Properties", *properties), frictionScaleFactor="1")
    if output.version >= (1, 2) and not numbers.keys().isdisjoint(_WATER):
        road.set("wetness", _nearest_wetness(numbers))
    environment = made("Environment", name="weather")
    if output.version == (1, 0):
        environment.append(made("TimeOfDay", animation="false", dateTime="2020-06-21T12:00:00"))
        numbers = dict(zip(WEATHER_NUMBERS, weather_numbers(full), strict=True))
    weather = _weather_element(numbers, word, output)
    if len(weather) or weather.attrib:
        environment.append(weather)
    environment.append(road)
    return made("EnvironmentAction", environment)


def _tell_unsaid(numbers: dict[str, float], word: WeatherAction, output: Output) -> None:
    """Report numbers that the standard has only together with one that is kept, and that 1.0 requires all parts."""
    for needed, others in _TOGETHER.items():
        alone = [name for name in others if name in numbers and needed not in numbers]
        if alone:
            output.tell_lost(word, f"{' and '.join(alone)} of the weather cannot be expressed without {needed}")
    if output.version == (1, 0):
        unsaid = [name for name in ("cloudiness", "precipitation", *_TOGETHER) if name not in numbers]
        if unsaid:
            kept = ", ".join(unsaid)
            output.tell_lost(word, f"1.0 has no change of a part of the weather: {kept} are those of a clear noon")


def _weather_element(numbers: dict[str, float], word: WeatherAction, output: Output) -> etree._Element:
    """Return the <Weather> of some of CARLA's numbers; a missing azimuth, and details of fog, are those of noon."""
    weather = made("Weather")
    noon = dict(zip(WEATHER_NUMBERS, CLEAR_NOON, strict=True))
    if "sun_altitude_angle" in numbers:
        weather.append(_sun({**noon, **numbers}, word, output))
    if "fog_density" in numbers:
        weather.append(_fog({**noon, **numbers}, word, output))
    if "precipitation" in numbers:
        weather.append(_falling(numbers["precipitation"], word, output))
    if "wind_intensity" in numbers and output.version > (1, 0):
        speed = output.text(_HURRICANE * numbers["wind_intensity"] / 100.0, word)
        weather.append(made("Wind", direction="0", speed=speed))
    if "cloudiness" in numbers:
        cloudiness = numbers["cloudiness"]
        if output.version >= (1, 2):
            weather.set("fractionalCloudCover", f"{_OKTAS[round(cloudiness / 12.5)]}Oktas")
        else:
            weather.set("cloudState", "free" if cloudiness < 30 else "cloudy" if cloudiness < 80 else "overcast")
    return weather


def _sun(numbers: dict[str, float], word: WeatherAction, output: Output) -> etree._Element:
    azimuth = math.radians(numbers["sun_azimuth_angle"] + 90.0) % (2.0 * math.pi)
    light = "illuminance" if output.version >= (1, 2) else "intensity"
    altitude = math.radians(numbers["sun_altitude_angle"])
    bright = max(math.sin(altitude), 0.0)
    sun = made("Sun", azimuth=output.text(azimuth, word), elevation=output.text(altitude, word))
    sun.set(light, output.text(100000.0 * bright if light == "illuminance" else bright, word))
    return sun


def _fog(numbers: dict[str, float], word: WeatherAction, output: Output) -> etree._Element:
    dense = numbers["fog_density"] / 100.0 * math.exp(-FOG_THINNED * min(max(numbers["fog_falloff"], 0.0), 5.0))
    seen = _FIVE_PERCENT / (FOG_AT_ONE * dense**1.5) if dense > 1.0e-6 else _CLEAREST
    return made("Fog", visualRange=output.text(min(seen + max(numbers["fog_distance"], 0.0), _CLEAREST), word))


def _falling(rain: float, word: WeatherAction, output: Output) -> etree._Element:
    falling = made("Precipitation", precipitationType="rain" if rain > 0.0 else "dry")
    if output.version == (1, 0):
        falling.set("intensity", output.text(rain / 100.0, word))
    else:
        falling.set("precipitationIntensity", output.text(rain / _PERCENT_PER_MM, word))
    return falling


def _nearest_wetness(numbers: dict[str, float]) -> str:
    """Return the standard's word that is nearest to the deposits and the wetness, or to the one that is given."""
    places = [place for place, name in enumerate(_WATER) if name in numbers]
    water = [numbers[_WATER[place]] for place in places]
    return min(_WETNESS, key=lambda name: math.dist([_WETNESS[name][place] for place in places], water))


def _write_environment(word: EnvironmentAction, output: Output) -> etree._Element:
    environment = made("Environment", name="environment")
    if word.date_time:
        time = made("TimeOfDay", animation=output.text(word.animated, word), dateTime=word.date_time)
        environment.append(time)
    if word.friction is not None:
        friction = output.text(word.friction, word)
        environment.append(made("RoadCondition", frictionScaleFactor=friction))
    return made("EnvironmentAction", environment)


def _read_nothing(node: Node) -> None:
    raise AssertionError(f"<{node.tag}> is read by read_environment")


ENVIRONMENT: tuple[Form[Any], ...] = (
    Form("EnvironmentAction", WeatherAction, _read_nothing, _write_weather, ("GlobalAction",)),
    Form("EnvironmentAction", EnvironmentAction, _read_nothing, _write_environment, ("GlobalAction",), (1, 1)),
)
"""<EnvironmentAction> for the weather, and for the time of day and friction."""
