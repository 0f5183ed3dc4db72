"""The interface of a world, in which the ego moves and its camera takes images.

The engine moves everything else and gives the world the positions. In a step, the engine begins (storyboard, commands),
moves its entities, the world steps, and the engine ends the step (collisions, stop). When a world steps, all others are
therefore at their positions at the end of the step already.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, Protocol, overload

from scenario_compiler.diagnostics import Code
from scenario_compiler.perception.faults import FAULTLESS, CameraFaults
from scenario_compiler.records import Record
from scenario_compiler.roads.positions import Pose
from scenario_compiler.vocabulary.weather import Weather

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from scenario_compiler.controllers.data import SensorData
    from scenario_compiler.roads import Network

WORLD_LOST = Code(
    "SC520",
    "world-lost",
    "The world of a run failed: its server ended, did not answer in time, or answered with an error. The recording up "
    "to that step is kept, and the run's stop reason is `world_lost`. Check the server's output, and start it "
    "again.\n\n"
    "    scenario-compiler run conflict.xml --world carla --carla-port 2000",
)

UNKNOWN_WORLD = Code(
    "SC533",
    "unknown-world",
    "A program asks for a world that does not exist. The worlds are `kinematic`, which is built in, and `carla`.\n\n"
    '    open_world("kinematic", plan, network)\n\n'
    "Correct the name. A world of your own is not opened by its name: give `run` an instance of its class.",
)


class WorldError(Exception):
    """A world cannot be opened, or cannot continue.

    Attributes:
        code: The code of the diagnostic.
    """

    def __init__(self, message: str, code: Code = WORLD_LOST) -> None:
        """Keep the message and the code."""
        super().__init__(message)
        self.code = code


class WorldOptions(Record):
    """Options of a world; subclasses declare fields, which are checked before the world is opened."""

    model_config: ClassVar[dict[str, Any]] = {**Record.model_config, "allow_inf_nan": True}


class EntityState(NamedTuple):
    """An entity at one instant.

    Attributes:
        there: Whether it is in the world, so that others can collide with it.
        shown: Whether pictures show it; an absent entity is never shown.
        pose: Pose of its reference point, OpenDRIVE axes, m and rad.
        speed: Speed, m/s, signed along its heading.
        steering: Angle of the front wheels, rad, positive to the left.
        throttle: 0 to 1, of a vehicle that is driven by commands.
        brake: 0 to 1, of a vehicle that is driven by commands.
        braking: Whether its brake lights are on.
        velocity: Velocity of its reference point in the last step, (x, y, z) in the world, m/s.
        lights: Lights that the scenario has switched on, by ASAM OpenSCENARIO's names.
    """

    there: bool
    shown: bool
    pose: Pose
    speed: float = 0.0
    steering: float = 0.0
    throttle: float = 0.0
    brake: float = 0.0
    braking: bool = False
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lights: frozenset[str] = frozenset()


class Entities(Sequence[EntityState]):
    """The entities at one instant; the state of an entity is built when it is first read.

    Two instances are equal if all their states are equal.
    """

    def __init__(self, count: int, state_of: Callable[[int], EntityState]) -> None:
        """Store the number of entities, and a function that builds an entity's state from unchanging columns."""
        self._state_of = state_of
        self._built: list[EntityState | None] = [None] * count

    def __len__(self) -> int:
        return len(self._built)

    @overload
    def __getitem__(self, index: int) -> EntityState: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[EntityState, ...]: ...

    def __getitem__(self, index: int | slice) -> EntityState | tuple[EntityState, ...]:
        if isinstance(index, slice):
            return tuple(self[k] for k in range(*index.indices(len(self))))
        built = self._built[index]
        if built is None:
            built = self._built[index] = self._state_of(range(len(self))[index])
        return built

    def __eq__(self, other: object) -> bool:
        return tuple(self) == tuple(other) if isinstance(other, Sequence) else NotImplemented

    def __hash__(self) -> int:
        return hash(tuple(self))


class Snapshot(NamedTuple):
    """The state of a run at one instant, as the engine knows it.

    Attributes:
        t: Time, s.
        frame: Number of the time step.
        entities: Every entity, in the plan's order.
        sigma: Standard deviation of the camera's noise, grey levels.
        faults: The camera's failures other than noise.
        weather: The present weather; None for that of the plan.
        signals: State of each traffic signal that the scenario names, in the order of its words; empty for unknown.
        hazard_lights: Whether the ego's hazard lights flash.
    """

    t: float
    frame: int
    entities: Sequence[EntityState]
    sigma: float = 0.0
    faults: CameraFaults = FAULTLESS
    weather: Weather | None = None
    signals: tuple[tuple[str, str], ...] = ()
    hazard_lights: bool = False

    @property
    def poses(self) -> tuple[Pose, ...]:
        """The pose of each entity, in the plan's order."""
        return tuple(entity.pose for entity in self.entities)


class EgoCommand(NamedTuple):
    """The command to the ego in a step.

    Attributes:
        throttle: 0 to 1.
        steer: -1 to 1 of its greatest steering angle, positive to the left.
        brake: 0 to 1.
        path: Path that the controller predicts, points (x ahead, y left) of the rear axle, m; empty without one.
    """

    throttle: float
    steer: float
    brake: float
    path: tuple[tuple[float, float], ...] = ()


class EgoState(NamedTuple):
    """The new state of the ego in a world that moves it.

    Attributes:
        pose: Pose of its reference point, OpenDRIVE axes, m and rad.
        speed: Speed, m/s, signed along its heading.
        steering: Angle of the front wheels, rad, positive to the left.
        throttle: The throttle that took effect, 0 to 1.
        brake: The brake that took effect, 0 to 1.
    """

    pose: Pose
    speed: float
    steering: float
    throttle: float
    brake: float


class WorldFinding(NamedTuple):
    """A part of a plan from which a world deviates.

    Attributes:
        code: The code of the diagnostic.
        message: What the world does instead.
        part: The part of the plan, named as in `plan.provenance.place_of`.
    """

    code: Code
    message: str
    part: str


class WorldEvent(NamedTuple):
    """An event that a world's own sensors reported.

    Attributes:
        kind: What happened.
        t: Time, s.
        entity: Id of the touched entity; empty if it is not an entity of the plan.
        message: The world's description of it.
    """

    kind: Literal["world_collision", "lane_invasion"]
    t: float
    entity: str = ""
    message: str = ""


class World(Protocol):
    """A world in which a plan is executed; a context manager that closes the world.

    A method that raises a `WorldError` ends the run, whose recording up to that step is kept; other exceptions pass
    through `run`. A world on whose given options a run depends also has `choices`, the values of these options by the
    names that `run` has for them, such as `ego`.
    """

    name: ClassVar[str]
    Options: ClassVar[type[WorldOptions]]
    moves_ego: bool
    """Whether the world's own physics moves the automated vehicle; the engine moves it otherwise."""
    network: Network

    @property
    def findings(self) -> Sequence[WorldFinding]:
        """The deviations of the world from the plan that are known so far."""
        ...

    @property
    def versions(self) -> dict[str, str]:
        """Versions of the parts of the world: client, server, map."""
        ...

    def reset(self, snapshot: Snapshot, seed: int) -> None:
        """Put every entity at its start."""
        ...

    def observe(self, snapshot: Snapshot) -> SensorData:
        """Return the present data of the ego's sensors."""
        ...

    def picture(self, snapshot: Snapshot) -> NDArray[np.uint8]:
        """Return the driver's view for people, (height, width, 3) uint8, BGR."""
        ...

    def step(self, snapshot: Snapshot, command: EgoCommand) -> EgoState | None:
        """Do a step, with the others at the poses in the snapshot.

        In a world that moves the ego, its pose in the snapshot is that which the last step returned, unless an action
        has teleported it since.

        Returns:
            The ego's new state if the world moves it; None if it does not, or if the plan has no automated vehicle.
        """
        ...

    def events(self) -> Sequence[WorldEvent]:
        """Return the events that the world has noticed since the last call."""
        ...

    def close(self) -> None:
        """Release everything that the world uses; it may be called twice, and raises nothing if the world is lost."""
        ...

    def __enter__(self) -> Self:
        """Return the world."""
        ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the world."""
        ...
