"""Weather: CARLA's 14 numbers, and its presets by name and by index.

The presets' values and their order (the sorted names, which is the index that the AISA toolkit's WeatherId counts) are
those of the CARLA 0.9.15 and 0.9.16 clients.
"""

from collections.abc import Sequence
from typing import Any, Literal, TypeVar

from scenario_compiler.vocabulary.word import Word, attribute

CUSTOM = "custom"
"""Preset name of a weather that is not derived from a preset."""

USUAL_WEATHER = "ClearNoon"
"""Preset of a scenario that does not set the weather."""


class Weather(Word):
    """The weather as CARLA's numbers, or as a preset with some numbers changed.

    A number that is left out is the preset's. Without a preset, the number is left to the map (-1), which is
    interpreted as a clear noon.
    """

    word: Literal["weather"] = "weather"

    preset: str = attribute("Name or index of the preset that supplies the numbers.", default=CUSTOM, names="weather")
    cloudiness: float = attribute("Clouds, percent.", default=-1.0, minimum=-1, maximum=100)
    precipitation: float = attribute("Rain, percent.", default=-1.0, minimum=-1, maximum=100)
    precipitation_deposits: float = attribute("Puddles, percent.", default=-1.0, minimum=-1, maximum=100)
    wind_intensity: float = attribute("Wind, percent.", default=-1.0, minimum=-1, maximum=100)
    sun_azimuth_angle: float = attribute("Azimuth of the sun, degrees.", default=-1.0)
    sun_altitude_angle: float = attribute("Altitude of the sun, degrees; negative at night.", default=-1.0)
    fog_density: float = attribute("Fog, percent.", default=-1.0, minimum=-1, maximum=100)
    fog_distance: float = attribute("Distance at which the fog begins, m.", default=-1.0)
    fog_falloff: float = attribute("Density of the fog with height.", default=-1.0)
    wetness: float = attribute("Wetness of the road, percent.", default=-1.0, minimum=-1, maximum=100)
    scattering_intensity: float = attribute("Light scattered by fog.", default=1.0)
    mie_scattering_scale: float = attribute("Scattering by large particles.", default=0.03)
    rayleigh_scattering_scale: float = attribute("Scattering by air.", default=0.0331)
    dust_storm: float = attribute("Dust, percent.", default=0.0, minimum=0, maximum=100)


WEATHER_NUMBERS = (
    "cloudiness", "precipitation", "precipitation_deposits", "wind_intensity", "sun_azimuth_angle",
    "sun_altitude_angle", "fog_density", "fog_distance", "fog_falloff", "wetness", "scattering_intensity",
    "mie_scattering_scale", "rayleigh_scattering_scale", "dust_storm",
)  # fmt: skip
"""CARLA's numbers, in the order of a weather."""

_TABLE = """
ClearNight 5 0 0 10 -1 -90 60 75 1 0 1 0.03 0.0331 0
ClearNoon 5 0 0 10 -1 45 2 0.75 0.1 0 1 0.03 0.0331 0
ClearSunset 5 0 0 10 -1 15 2 0.75 0.1 0 1 0.03 0.0331 0
CloudyNight 60 0 0 10 -1 -90 60 0.75 0.1 0 1 0.03 0.0331 0
CloudyNoon 60 0 0 10 -1 45 3 0.75 0.1 0 1 0.03 0.0331 0
CloudySunset 60 0 0 10 -1 15 3 0.75 0.1 0 1 0.03 0.0331 0
Default -1 -1 -1 -1 -1 -1 -1 -1 -1 -1 1 0.03 0.0331 0
DustStorm 100 0 0 100 -1 45 2 0.75 0.1 0 1 0.03 0.0331 100
HardRainNight 100 100 90 100 -1 -90 100 0.75 0.1 100 1 0.03 0.0331 0
HardRainNoon 100 100 90 100 -1 45 7 0.75 0.1 0 1 0.03 0.0331 0
HardRainSunset 100 100 90 100 -1 15 7 0.75 0.1 0 1 0.03 0.0331 0
MidRainSunset 60 60 60 60 -1 15 3 0.75 0.1 0 1 0.03 0.0331 0
MidRainyNight 80 60 60 60 -1 -90 60 0.75 0.1 80 1 0.03 0.0331 0
MidRainyNoon 60 60 60 60 -1 45 3 0.75 0.1 0 1 0.03 0.0331 0
SoftRainNight 60 30 50 30 -1 -90 60 0.75 0.1 60 1 0.03 0.0331 0
SoftRainNoon 20 30 50 30 -1 45 3 0.75 0.1 0 1 0.03 0.0331 0
SoftRainSunset 20 30 50 30 -1 15 2 0.75 0.1 0 1 0.03 0.0331 0
WetCloudyNight 60 0 50 10 -1 -90 60 0.75 0.1 60 1 0.03 0.0331 0
WetCloudyNoon 60 0 50 10 -1 45 3 0.75 0.1 0 1 0.03 0.0331 0
WetCloudySunset 60 0 50 10 -1 15 2 0.75 0.1 0 1 0.03 0.0331 0
WetNight 5 0 50 10 -1 -90 60 75 1 60 1 0.03 0.0331 0
WetNoon 5 0 50 10 -1 45 3 0.75 0.1 0 1 0.03 0.0331 0
WetSunset 5 0 50 10 -1 15 2 0.75 0.1 0 1 0.03 0.0331 0
"""

WEATHER_PRESETS: dict[str, tuple[float, ...]] = {
    name: tuple(float(number) for number in numbers)
    for name, *numbers in (line.split() for line in _TABLE.strip().splitlines())
}
"""Preset name to its 14 numbers, in the order that WeatherId counts."""


def weather_preset(name_or_index: str) -> Weather | None:
    """Return a preset by its name, or by its index as text; None if there is no such preset."""
    names = list(WEATHER_PRESETS)
    if name_or_index.isdecimal() and int(name_or_index) < len(names):
        name_or_index = names[int(name_or_index)]
    if name_or_index not in WEATHER_PRESETS:
        return None
    numbers: dict[str, Any] = dict(zip(WEATHER_NUMBERS, WEATHER_PRESETS[name_or_index], strict=True))
    return Weather.model_construct(preset=name_or_index, **numbers)


AnyWeather = TypeVar("AnyWeather", bound=Weather)

CLEAR_NOON = (5.0, 0.0, 0.0, 10.0, 0.0, 45.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.03, 0.0331, 0.0)
"""Values used for numbers that are left to the map."""


def complete_weather(weather: AnyWeather) -> AnyWeather | None:
    """Return a weather whose missing numbers are filled in from its preset; None for an unknown preset."""
    if weather.preset == CUSTOM:
        return weather
    preset = weather_preset(weather.preset)
    if preset is None:
        return None
    usual = {name: type(weather).model_fields[name].default for name in WEATHER_NUMBERS}
    numbers = {name: getattr(preset, name) for name in WEATHER_NUMBERS if getattr(weather, name) == usual[name]}
    own = len(numbers) < len(WEATHER_NUMBERS)
    return weather.model_copy(update={**numbers, "preset": CUSTOM if own else preset.preset})


def written_numbers(weather: Weather) -> tuple[float, ...]:
    """Return the 14 numbers as they are written, in CARLA's order."""
    return tuple(getattr(weather, name) for name in WEATHER_NUMBERS)


def weather_numbers(weather: Weather) -> tuple[float, ...]:
    """Return the 14 numbers; those that are left to the map take their values of a clear noon."""
    written = written_numbers(weather)
    return tuple(clear if number == -1.0 else number for number, clear in zip(written, CLEAR_NOON, strict=True))


def is_clear(weather: Weather) -> bool:
    """Return whether the weather is dry: no dust, fog of at most 5 %, and the sun above the horizon."""
    named = dict(zip(WEATHER_NUMBERS, weather_numbers(weather), strict=True))
    water = max(named["precipitation"], named["precipitation_deposits"], named["wetness"], named["dust_storm"])
    return water <= 0.0 and named["fog_density"] <= 5.0 and named["sun_altitude_angle"] > 0.0


def weather_of(numbers: Sequence[float]) -> Weather:
    """Return the weather of 14 numbers, none of which is left to the map."""
    return Weather.model_validate({name: _told(one) for name, one in zip(WEATHER_NUMBERS, numbers, strict=True)})


def _told(number: float) -> float:
    """Return a number that passes -1 while it changes as the next number, because -1 would leave it to the map."""
    return -1.0 - 1e-9 if number == -1.0 else number
