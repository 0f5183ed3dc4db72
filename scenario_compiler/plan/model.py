"""The plan: a scenario bound to a map, as a frozen, versioned, canonical value.

A plan holds the vocabulary's own words, with every position bound to a road, a lane, s and an offset, every default
filled in and every reference resolved. Its digest covers the words, the numbers as written and the map's content;
`origins` and `derived` are not part of the digest.
"""

from collections.abc import Iterator
from typing import Any, ClassVar, Literal

from scenario_compiler.records import Record, field
from scenario_compiler.vocabulary.actions.path import Path
from scenario_compiler.vocabulary.criteria import Criterion
from scenario_compiler.vocabulary.entities import Controller, Follow, Vehicle
from scenario_compiler.vocabulary.markings import LineBeside, Markings, SecondaryMarkings
from scenario_compiler.vocabulary.positions import BoundPosition, LanePositionWord
from scenario_compiler.vocabulary.scenario import Classification, NumberLimit, Parameter
from scenario_compiler.vocabulary.sensors import Camera, Failure, ForwardSensor, Odometry, Perception
from scenario_compiler.vocabulary.signals import SignalController
from scenario_compiler.vocabulary.storyboard import Storyboard
from scenario_compiler.vocabulary.takeover import Takeover
from scenario_compiler.vocabulary.traversal import walk
from scenario_compiler.vocabulary.variables import Variable
from scenario_compiler.vocabulary.weather import Weather
from scenario_compiler.vocabulary.word import Number, Word


class PlanPart(Record):
    """A part of a plan."""

    model_config: ClassVar[dict[str, Any]] = {**Record.model_config, "allow_inf_nan": True}


class MapReference(PlanPart):
    """The map of a plan."""

    name: str = field(description="Name or path as the author wrote it.")
    file: str = field(description="Path of the file that was found; outside the digest.")
    sha256: str = field(description="Hash of the file's content.")


class RouteLeg(PlanPart):
    """A section of one lane on the route to the destination."""

    road: str = field(description="Id of the road.")
    lane: int = field(description="Id of the lane.")
    s_from: float = field(description="Start of the section, m.")
    s_to: float = field(description="End of the section, m.")


class Entity(PlanPart):
    """An entity; its index in `Plan.entities` is its number in the engine. An automated ego vehicle is number 0."""

    id: str = field(description="Id as the author wrote it, with the prefix of the use for templates.")
    kind: Literal["ego", "static", "dynamic", "traffic", "walker"] = field(
        description="ego: the automation and the driver drive it; static: it stands; dynamic: the storyboard moves it; "
        "traffic: a vehicle of background traffic; walker: a pedestrian of background traffic."
    )
    vehicle: Vehicle = field(description="Its dimensions and limits.")
    start: BoundPosition | None = field(
        default=None, description="Start position; without one it is at the world's origin, off every road."
    )
    speed: Number = field(description="Speed at the start, m/s.")
    desired_speed: Number = field(description="Speed that it aims for, m/s.")
    follow: Follow | None = field(default=None, description="Car following, for dynamic actors and traffic.")
    route: tuple[RouteLeg, ...] = field(default=(), description="A dynamic actor's way to its destination.")
    path: Path | None = field(default=None, description="The path that a dynamic actor moves on from the start.")
    share: float = field(default=1.0, description="Share of the speed limit that a driver of traffic aims for.")
    seed: int | None = field(
        default=None, description="Seed of the turns of a traffic vehicle; the run's seed by default."
    )


class StartPose(PlanPart):
    """Start pose of an entity in the world, at the default values of the parameters."""

    x: float = field(description="x of the reference point, m.")
    y: float = field(description="y of the reference point, m.")
    z: float = field(description="z of the reference point, m.")
    heading: float = field(description="Heading, rad in [0, 2 pi).")


class PlanOrigin(PlanPart):
    """The place in the author's file at which a part of the plan is written."""

    file: str = field(description="Path of the file.")
    line: int = field(description="Line, counted from 1.")
    column: int = field(description="Column, counted from 1; 0 when unknown.")
    length: int = field(default=0, description="Number of characters that it covers; 0 when unknown.")
    source_line: str = field(default="", description="Text of the line.")
    within: "PlanOrigin | None" = field(default=None, description="The <use> of the template that contains it.")


class Plan(PlanPart):
    """A scenario that can be executed."""

    format: Literal["scenario-compiler/plan/1"] = field(
        default="scenario-compiler/plan/1", description="Version of this format."
    )
    name: str = field(description="Name of the scenario.")
    summary: str = field(default="", description="Summary of the scenario.")
    map: MapReference = field(description="The map.")
    step: float = field(ge=0.001, le=1.0, description="Length of a time step, s.")
    control_every: int = field(ge=1, description="Number of time steps between two control steps.")
    duration: float = field(gt=0.0, description="Latest end of the run, s.")
    parameters: tuple[Parameter, ...] = field(default=(), description="Parameters that numbers still depend on.")
    limits: tuple[NumberLimit, ...] = field(
        default=(), description="Limits of numbers that depend on parameters; outside the digest."
    )
    weather: Weather = field(description="The weather.")
    entities: tuple[Entity, ...] = field(description="All entities in document order, an automated ego vehicle first.")
    camera: Camera = field(description="The ego vehicle's camera.")
    forward_sensor: ForwardSensor = field(
        default_factory=ForwardSensor.model_construct, description="The ego vehicle's sensor for objects ahead."
    )
    odometry: Odometry = field(
        default_factory=Odometry.model_construct,
        description="Errors of the ego vehicle's odometry, by which it drives while it does not see its lane.",
    )
    controller: Controller | None = field(
        default=None, description="The ego vehicle's controller; none without an automated vehicle."
    )
    perception: Perception = field(description="Source of the lane confidence.")
    destination: LanePositionWord | None = field(
        default=None, description="The ego vehicle's destination, at which the run ends."
    )
    route: tuple[RouteLeg, ...] = field(default=(), description="The ego vehicle's way to the destination.")
    markings: tuple[Markings, ...] = field(
        default=(), description="Stretches on which the paint differs from the map's."
    )
    secondary_markings: tuple[SecondaryMarkings | LineBeside, ...] = field(
        default=(), description="Lines beside the map's paint."
    )
    variables: tuple[Variable, ...] = field(default=(), description="Variables, whose values can change during a run.")
    signal_controllers: tuple[SignalController, ...] = field(default=(), description="Controllers of traffic signals.")
    storyboard: Storyboard = field(description="Actions and their triggers.")
    takeover: Takeover = field(description="The takeover policy, with every number filled in.")
    criteria: tuple[Criterion, ...] = field(default=(), description="Criteria by which a run is judged.")
    classifications: tuple[Classification, ...] = field(
        default=(), description="The scenario's situations in published taxonomies."
    )
    derived: dict[str, StartPose] = field(default={}, description="Start poses by entity id; outside the digest.")
    origins: dict[str, PlanOrigin] = field(default={}, description="Provenance by part; outside the digest.")
    digest: str = field(default="", description="SHA-256 of the canonical form.")

    @property
    def step_limit(self) -> int:
        """Greatest number of time steps of a run of the plan."""
        return int(self.duration / self.step) + 2

    @property
    def ego(self) -> Entity:
        """The vehicle of the reports, which is the first entity; raises IndexError if there is none."""
        return self.entities[0]

    def words(self) -> Iterator[Word]:
        """Yield every word of the storyboard and of the entities' starts and paths."""
        yield from walk(self.storyboard)
        for entity in self.entities:
            for part in (entity.start, entity.path):
                if part is not None:
                    yield from walk(part)

    @property
    def failures(self) -> tuple[Failure, ...]:
        """All failures of the camera: those in <camera>, and those that actions start."""
        begun = (action for _, action in self.storyboard.actions() if isinstance(action, Failure))
        return (*self.camera.failures, *begun)
