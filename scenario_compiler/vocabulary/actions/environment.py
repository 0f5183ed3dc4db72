"""Actions on the environment."""

from scenario_compiler.vocabulary.kept import KEPT
from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.vocabulary.word import Number, attribute


class WeatherAction(Weather):
    """Change the weather. Each number changes linearly from its present value.

    A number that is left out, or that the preset leaves to the map (-1), keeps its present value.
    """

    scattering_intensity: float = attribute("Light scattered by fog.", default=KEPT)
    mie_scattering_scale: float = attribute("Scattering by large particles.", default=KEPT)
    rayleigh_scattering_scale: float = attribute("Scattering by air.", default=KEPT)
    dust_storm: float = attribute("Dust, percent.", default=KEPT, minimum=-1, maximum=100)
    over_time: Number = attribute(
        "Duration of the change, s; with 0 it is immediate.", default=0.0, quantity="time", minimum=0
    )
