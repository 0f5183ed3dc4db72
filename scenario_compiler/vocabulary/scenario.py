"""The scenario: both languages are lowered to it once templates, catalogs and structural parameters are expanded."""

from collections.abc import Iterable, Mapping
from functools import cache
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
from scenario_compiler.vocabulary.weather import USUAL_WEATHER, Weather
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
    """The place of the conflict in a published taxonomy. Leave out what the source does not rate."""

    word: Literal["classification"] = "classification"

    scheme: str = attribute(
        "Short name of the taxonomy: gold2018, r157, euroncap, or a name of your own.", names="scheme"
    )
    number: int | None = attribute("Number of the situation in the taxonomy.", default=None, minimum=0)
    situation: str = attribute(
        "Name of the situation in the taxonomy, such as 4.2_1 or CCRs, if it has no number.",
        default="",
        names="situation",
    )
    urgency: str = attribute("Rated urgency.", default="")
    response: str = attribute("Rated complexity of the driver's response.", default="")
    predictability: str = attribute("Rated predictability.", default="")
    criticality: str = attribute("Rated criticality.", default="")

    @property
    def place(self) -> str:
        """The situation's name or number in the taxonomy; empty if it has neither."""
        return self.situation or ("" if self.number is None else str(self.number))


ParameterKind = Literal[
    "number", "fraction", "length", "time", "speed", "acceleration", "angle", "grey_levels", "integer", "text",
    "boolean",
]  # fmt: skip

OTHER_KINDS = (
    ("duration", "time"),
    ("distance", "length"),
    ("double", "number"),
    ("float", "number"),
    ("int", "integer"),
    ("bool", "boolean"),
    ("string", "text"),
)
"""Words of OpenSCENARIO and of programming languages for kinds of parameters, each with ours."""


class Parameter(Word):
    """A typed parameter of a scenario or a template."""

    word: Literal["parameter"] = "parameter"

    name: str = attribute(
        "Name by which `$name` and `--set name=value` refer to the parameter.", defines="parameter", pattern=IDENTIFIER
    )
    type: ParameterKind = attribute(
        "Quantity that the parameter measures. Numbers are in the unit that XML uses for this quantity. A fraction is "
        "from 0 to 1, unless `min` and `max` set other limits.",
        retired=OTHER_KINDS,
    )
    default: str | None = attribute(
        "Default value, which cannot depend on other parameters. "
        "A parameter without a default must be given a value at each use.",
        default=None,
    )
    min: Number | None = attribute("Least value.", default=None)
    max: Number | None = attribute("Greatest value.", default=None)
    summary: str = attribute("Meaning of the parameter.", default="")

    @property
    def limits(self) -> AttributeSpelling:
        """The parameter's limits, in XML units; a fraction lies between 0 and 1 unless it declares other limits."""
        low = self.min if isinstance(self.min, float) else None
        high = self.max if isinstance(self.max, float) else None
        if self.type == "fraction":
            low, high = (0.0 if low is None else low), (1.0 if high is None else high)
        return AttributeSpelling(minimum=low, maximum=high)

    def value(self) -> Value:
        """Return the default as a value of the parameter's type, with numbers in the unit that XML uses.

        Raises:
            ValueError: There is no default, or the default is not a number although the type requires one.
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
    """Limits that a number which depends on parameters must respect for all values of the parameters.

    The limits come from the attribute that contains the number, or from the template's parameter to which it is passed.
    """

    word: Literal["limit"] = "limit"

    holder: str = attribute("Name of the attribute or parameter.")
    value: Number = attribute("The number, in the unit that XML uses.")
    least: float | None = attribute("Least value.", default=None)
    exclusive: bool = attribute("Whether the least value itself is excluded.", default=False)
    greatest: float | None = attribute("Greatest value.", default=None)

    def fault(self, values: Mapping[str, Value]) -> str:
        """Return why the number breaks its limits at the given parameter values; empty if it respects them."""
        try:
            number = number_value(self.value, values)
        except ExpressionError as error:
            return str(error)
        return out_of_limits(self.holder, number, _spelling(self.least, self.greatest, self.exclusive))


@cache
def _spelling(least: float | None, greatest: float | None, exclusive: bool) -> AttributeSpelling:
    """Return limits as attributes have them; a sweep asks for those of a number once for each variant."""
    return AttributeSpelling(minimum=least, maximum=greatest, exclusive=exclusive)


class Scenario(Word):
    """A whole scenario: a map, an ego vehicle, other actors, events, and criteria."""

    word: Literal["scenario"] = "scenario"

    name: str = attribute("Name of the scenario.", defines="scenario")
    summary: str = attribute("Summary of the events in one sentence.", default="")
    source: str = attribute("Publication or observation that describes the situation.", default="")
    map: str = attribute("Name or path of the OpenDRIVE map.", names="map")
    duration: float | None = attribute(
        "Latest end of the run, s; a part of a step counts as a whole one.",
        default=None,
        quantity="time",
        minimum=0,
        exclusive=True,
    )
    step: float = attribute("Length of a time step, s.", default=0.05, quantity="time", minimum=0.001, maximum=1)
    control_every: int = attribute(
        "Number of time steps between two control steps. `--dt` changes it, so that the time between them stays, "
        "rounded to a whole number of time steps.",
        default=1,
        minimum=1,
    )
    weather: Weather = child("The weather.", default_factory=lambda: Weather.model_construct(preset=USUAL_WEATHER))
    parameters: tuple[Parameter, ...] = child("Parameters that the scenario's numbers depend on.", default=())
    limits: tuple[NumberLimit, ...] = child("Limits of the numbers that depend on parameters.", default=())
    vary: Vary | None = child("How a sweep varies the scenario.", default=None)
    classifications: tuple[Classification, ...] = child("Places of the conflict in published taxonomies.", default=())
    spawn_points: SpawnPoints | None = child("The scenario's own spawn points.", default=None)
    ego: Ego | None = child("The automated vehicle.", default=None)
    actors: tuple[Actor, ...] = child("The other actors, in document order.", default=())
    traffic: tuple[Traffic, ...] = child("Background traffic.", default=())
    vehicles: tuple[Vehicle, ...] = child("The vehicles that the entities use.", default=())
    markings: tuple[Markings, ...] = child("Stretches on which the paint differs from the map's.", default=())
    secondary_markings: tuple[SecondaryMarkings | LineBeside, ...] = child(
        "Lines painted in addition to the map's.", default=()
    )
    variables: tuple[Variable, ...] = child("Values that change during the run.", default=())
    signal_controllers: tuple[SignalController, ...] = child("Controllers of traffic signals.", default=())
    storyboard: Storyboard = child("What happens.", default_factory=Storyboard.model_construct)
    takeover: Takeover = child("The takeover policy.", default_factory=Takeover.model_construct)
    criteria: tuple[Criterion, ...] = child("Criteria by which the run is judged.", default=())
