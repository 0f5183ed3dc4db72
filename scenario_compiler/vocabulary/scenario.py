"""The scenario: what both languages end in once templates, catalogs and structural parameters are gone."""

from collections.abc import Iterable, Mapping
from typing import Literal

from scenario_compiler.expressions import ExpressionError, Value
from scenario_compiler.vocabulary.criteria import Criterion
from scenario_compiler.vocabulary.entities import Actor, Ego, Traffic, Vehicle
from scenario_compiler.vocabulary.grammar import out_of_limits
from scenario_compiler.vocabulary.markings import LineBeside, Markings, SecondaryMarkings
from scenario_compiler.vocabulary.positions import SpawnPoints
from scenario_compiler.vocabulary.signals import SignalController
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.takeover import Takeover
from scenario_compiler.vocabulary.variables import Variable
from scenario_compiler.vocabulary.variation import Vary
from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.vocabulary.word import (
    IDENTIFIER,
    AttributeSpelling,
    Number,
    Word,
    attribute,
    child,
    number_value,
)


class Classification(Word):
    """Where the conflict stands in a published taxonomy. What the source does not rate stays empty."""

    word: Literal["classification"] = "classification"

    scheme: str = attribute("Short name of the taxonomy: gold2018, r157, euroncap, or one of your own.", names="scheme")
    number: int | None = attribute("Number of the situation in it.", default=None, minimum=0)
    situation: str = attribute(
        "Name of the situation in it, such as 4.2_1 or CCRs, where it has no number.", default="", names="situation"
    )
    urgency: str = attribute("Rated urgency.", default="")
    response: str = attribute("Rated complexity of the driver's response.", default="")
    predictability: str = attribute("Rated predictability.", default="")
    criticality: str = attribute("Rated criticality.", default="")

    @property
    def place(self) -> str:
        """The situation's name or number in the taxonomy, empty without one."""
        return self.situation or ("" if self.number is None else str(self.number))


ParameterKind = Literal[
    "number", "fraction", "length", "time", "speed", "acceleration", "angle", "grey_levels", "integer", "text",
    "boolean",
]  # fmt: skip


class Parameter(Word):
    """A typed parameter of a scenario or a template."""

    word: Literal["parameter"] = "parameter"

    name: str = attribute("Name that `$name` and `--set name=value` use.", defines="parameter", pattern=IDENTIFIER)
    type: ParameterKind = attribute("What it measures; numbers are in the unit that XML uses for it.")
    default: str | None = attribute("Value when none is given; without one, each use must give it.", default=None)
    min: Number | None = attribute("Least value.", default=None)
    max: Number | None = attribute("Greatest value.", default=None)
    summary: str = attribute("What it does.", default="")

    @property
    def limits(self) -> AttributeSpelling:
        """Its limits, in XML units; a fraction lies between 0 and 1 without saying so."""
        low = self.min if isinstance(self.min, float) else None
        high = self.max if isinstance(self.max, float) else None
        if self.type == "fraction":
            low, high = (0.0 if low is None else low), (1.0 if high is None else high)
        return AttributeSpelling(minimum=low, maximum=high)

    def value(self) -> Value:
        """Return the default as a value of the parameter's type, numbers in the unit that XML uses.

        Raises:
            ValueError: There is no default, or it is no number where one is due.
        """
        if self.default is None:
            raise ValueError(f"the parameter '{self.name}' has no value")
        if self.type == "text":
            return self.default
        if self.type == "boolean":
            return self.default == "true"
        return float(self.default)


def parameter_values(parameters: Iterable[Parameter]) -> dict[str, Value]:
    """Return the values of parameters by name."""
    return {parameter.name: parameter.value() for parameter in parameters}


class NumberLimit(Word):
    """What a number that depends on parameters must keep, whatever their values are.

    The attribute that holds the number gives its limits, or the template's parameter that it is an argument of.
    """

    word: Literal["limit"] = "limit"

    holder: str = attribute("Name of the attribute or parameter.")
    value: Number = attribute("The number, in the unit that XML uses.")
    least: float | None = attribute("Least value.", default=None)
    exclusive: bool = attribute("The least value itself is left out.", default=False)
    greatest: float | None = attribute("Greatest value.", default=None)

    def fault(self, values: Mapping[str, Value]) -> str:
        """Return what is wrong with the number at values of the parameters; empty where it is as it must be."""
        try:
            number = number_value(self.value, values)
        except ExpressionError as error:
            return str(error)
        return out_of_limits(
            self.holder, number, AttributeSpelling(minimum=self.least, maximum=self.greatest, exclusive=self.exclusive)
        )


class Scenario(Word):
    """A whole scenario: a map, an ego vehicle, the other actors, what happens, and how it is judged."""

    word: Literal["scenario"] = "scenario"

    name: str = attribute("Name of the scenario.", defines="scenario")
    summary: str = attribute("One sentence: what happens.", default="")
    source: str = attribute("Where the situation comes from.", default="")
    map: str = attribute("Name or path of the OpenDRIVE map.", names="map")
    duration: float | None = attribute(
        "When the run ends at the latest, s.", default=None, quantity="time", minimum=0, exclusive=True
    )
    step: float = attribute("Length of a time step, s.", default=0.05, quantity="time", minimum=0.001, maximum=1)
    control_every: int = attribute("Number of time steps between two control steps.", default=1, minimum=1)
    weather: Weather = child("The weather.")
    parameters: tuple[Parameter, ...] = child("Parameters that numbers of the scenario use.", default=())
    limits: tuple[NumberLimit, ...] = child("Limits of the numbers that depend on parameters.", default=())
    vary: Vary | None = child("How a sweep varies it.", default=None)
    classifications: tuple[Classification, ...] = child("Its places in published taxonomies.", default=())
    spawn_points: SpawnPoints | None = child("Spawn points of the scenario's own.", default=None)
    ego: Ego | None = child("The automated vehicle.", default=None)
    actors: tuple[Actor, ...] = child("The other actors, in document order.", default=())
    traffic: tuple[Traffic, ...] = child("Background traffic.", default=())
    vehicles: tuple[Vehicle, ...] = child("The vehicles that the entities are.", default=())
    markings: tuple[Markings, ...] = child("Where the paint differs from the map's.", default=())
    secondary_markings: tuple[SecondaryMarkings | LineBeside, ...] = child("Lines beside the map's paint.", default=())
    variables: tuple[Variable, ...] = child("Values that change while it runs.", default=())
    signal_controllers: tuple[SignalController, ...] = child("Controllers of traffic signals.", default=())
    storyboard: Storyboard = child("What happens.", default_factory=Storyboard.model_construct)
    takeover: Takeover = child("The takeover policy.", default_factory=Takeover.model_construct)
    criteria: tuple[Criterion, ...] = child("What the run is judged by.", default=())
