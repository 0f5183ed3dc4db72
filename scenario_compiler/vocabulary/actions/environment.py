"""Actions on the environment."""

from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.vocabulary.word import Number, attribute


class WeatherAction(Weather):
    """Change the weather. Each number changes linearly from its present value."""

    over_time: Number = attribute(
        "Duration of the change, s; with 0 it is immediate.", default=0.0, quantity="time", minimum=0
    )
