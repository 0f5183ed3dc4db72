"""Actions on what surrounds the vehicles."""

from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.vocabulary.word import Number, attribute


class WeatherAction(Weather):
    """Change the weather, each of its numbers in a straight line from what it is now."""

    over_time: Number = attribute(
        "Duration of the change, s; 0 changes at once.", default=0.0, quantity="time", minimum=0
    )
