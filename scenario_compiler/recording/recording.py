"""The recording: everything that happened in one run, as arrays, and the builder that writes it."""

import hashlib
from array import array
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.engine.columns.opcodes import FAR
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.names import CODES, EventKind, StopReason
from scenario_compiler.records import Record, field
from scenario_compiler.vocabulary.driver import ReferenceName
from scenario_compiler.vocabulary.sensors import Perception

if TYPE_CHECKING:
    import pandas as pd

Floats: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
Booleans: TypeAlias = NDArray[np.bool_]


class Header(Record):
    """The origin of a recording."""

    plan_digest: str = field(description="Digest of the plan.")
    plan_name: str = field(description="Name of the plan.")
    seed: int = field(description="Seed of the run.")
    variant: int = field(default=0, description="Index of the variant in a sweep.")
    parameters: dict[str, float | bool | str] = field(
        default={}, description="Value of each parameter that the plan leaves open."
    )
    avoided: dict[ReferenceName, bool] = field(
        default={},
        description="Whether each reference driver of a criterion avoids a collision when it drives from the start.",
    )
    step: float = field(description="Length of a time step, s.")
    entities: tuple[str, ...] = field(
        description="Ids of the entities in document order, an automated ego vehicle first."
    )
    perception: Perception = field(description="Source of the lane confidence.")
    world: str = field(default="kinematic", description="Name of the world in which the run took place.")
    choices: dict[str, str] = field(
        default={}, description="Given options of the world on which the run depends, as `ego` and `camera` of CARLA."
    )
    versions: dict[str, str] = field(
        default={},
        description="Versions of the software on which the result depends: this package, Python, libraries, the world; "
        "for a run with a camera also the environment variables that say which code NumPy and OpenBLAS use.",
    )
    processor: str = field(
        default="",
        description="Architecture and model of the processor, and the features by which libraries choose their code.",
    )


class Frame(NamedTuple):
    """A first-person picture.

    Attributes:
        t: Time, s.
        label: The moment that it shows: an event's kind, such as "request".
        png: The picture as a PNG file.
    """

    t: float
    label: str
    png: bytes


class Column(NamedTuple):
    """A column of a recording.

    Attributes:
        per: "entity": an array (n, entities); "run": an array (n,).
        unit: SI unit, empty for numbers without one.
        description: What it holds.
        name: Its name, the same in the type and in the file.
        kind: "float"; "integer"; "flag"; "road" and "entity": index into `Recording.lists`; "state", "cause",
            "source" and "wish": code of `names`.
        nothing: Value that means a missing one.
        far: The engine's `FAR` stands for "none" and is recorded as NaN.
        trajectory: Part of the trajectory hash.
    """

    per: Literal["entity", "run"]
    unit: str
    description: str
    name: str = ""
    kind: Literal["float", "integer", "flag", "road", "entity", "state", "cause", "source", "wish"] = "float"
    nothing: float = float("nan")
    far: bool = False
    trajectory: bool = False

    @property
    def dtype(self) -> type[np.generic]:
        """Type of the array's elements."""
        return np.float64 if self.kind == "float" else np.bool_ if self.kind == "flag" else np.int64


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """One run: n rows (t = 0 and one per step) of m entities in OpenDRIVE axes; an automated ego vehicle is entity 0.

    The position of an entity is that of its reference point: the rear axle's centre on the ground. Rows in which an
    entity is absent contain NaN, 0 or -1; `present` marks them. Two recordings are equal if their whole contents are
    equal; NaN equals NaN.

    Attributes:
        header: Origin of the recording.
        roads: Ids of the roads; `road` is an index into them.
        events: Events, ordered by time.
        frames: First-person pictures, ordered by time.
        stop_reason: Why the run ended.
        error: The engine's fault code; 0 if there is none.
    """

    header: Header
    roads: tuple[str, ...]
    t: Annotated[Floats, Column("run", "s", "Time.", trajectory=True)]
    present: Annotated[
        Booleans, Column("entity", "", "Whether the entity is in the world.", kind="flag", nothing=0, trajectory=True)
    ]
    x: Annotated[Floats, Column("entity", "m", "x.", trajectory=True)]
    y: Annotated[Floats, Column("entity", "m", "y.", trajectory=True)]
    z: Annotated[Floats, Column("entity", "m", "z.", trajectory=True)]
    h: Annotated[Floats, Column("entity", "rad", "Heading in [0, 2 pi).", trajectory=True)]
    v: Annotated[Floats, Column("entity", "m/s", "Speed, signed along the heading.", trajectory=True)]
    a: Annotated[Floats, Column("entity", "m/s2", "Acceleration along the heading.", trajectory=True)]
    road: Annotated[
        Integers, Column("entity", "", "Road; no road if off every road.", kind="road", nothing=-1, trajectory=True)
    ]
    lane: Annotated[
        Integers,
        Column("entity", "", "OpenDRIVE lane id; 0 off the lanes.", kind="integer", nothing=0, trajectory=True),
    ]
    s: Annotated[Floats, Column("entity", "m", "Distance along the road's reference line.", trajectory=True)]
    off: Annotated[
        Floats, Column("entity", "m", "Distance left of the lane's centre in the road's s direction.", trajectory=True)
    ]
    pitch: Annotated[Floats, Column("entity", "rad", "Pitch, positive with the nose down.")]
    roll: Annotated[Floats, Column("entity", "rad", "Roll, positive with the left side up.")]
    throttle: Annotated[Floats, Column("entity", "1", "Throttle, 0 to 1.")]
    steer: Annotated[Floats, Column("entity", "rad", "Angle of the front wheels, positive to the left.")]
    brake: Annotated[Floats, Column("entity", "1", "Brake, 0 to 1.")]
    towed_by: Annotated[
        Integers,
        Column("entity", "", "Entity that tows it; empty if none does.", kind="entity", nothing=-1),
    ]

    takeover_state: Annotated[Integers, Column("run", "", "State of the takeover.", kind="state", nothing=0)]
    control: Annotated[
        Integers, Column("run", "", "The source of the automated vehicle's commands.", kind="source", nothing=0)
    ]
    person_throttle: Annotated[Floats, Column("run", "1", "Throttle of the person at the wheel, 0 to 1.")]
    person_brake: Annotated[Floats, Column("run", "1", "Brake of the person at the wheel, 0 to 1.")]
    person_steer: Annotated[
        Floats,
        Column(
            "run",
            "1",
            "Steering of the person at the wheel, as a share of the greatest angle, -1 to 1, positive to the left.",
        ),
    ]
    person_wish: Annotated[
        Integers, Column("run", "", "What the person wants the automation to do.", kind="wish", nothing=0)
    ]
    cause: Annotated[Integers, Column("run", "", "Cause of the present warning or request.", kind="cause", nothing=0)]
    confidence_left: Annotated[Floats, Column("run", "1", "Lane confidence on the left, 0 to 1.")]
    confidence_right: Annotated[Floats, Column("run", "1", "Lane confidence on the right, 0 to 1.")]
    sensor_health: Annotated[Floats, Column("run", "1", "Health of the camera, 0 to 1.")]
    sigma: Annotated[Floats, Column("run", "grey levels", "Standard deviation of the camera's noise.")]
    blocked_distance: Annotated[
        Floats,
        Column(
            "run",
            "m",
            "Distance from the front bumper to the place at which the path is blocked, along the lane.",
            far=True,
        ),
    ]
    blocked_speed: Annotated[
        Floats,
        Column(
            "run",
            "m/s",
            "Speed at which the obstacle in the path comes towards the vehicle along the lane; 0 if it does not.",
            nothing=0.0,
        ),
    ]
    lane_end_distance: Annotated[
        Floats, Column("run", "m", "Distance to where the ego vehicle's lane ends or leaves the route.", far=True)
    ]
    limit_time: Annotated[
        Floats,
        Column("run", "s", "Time budget of the last request, if it was not about an obstacle.", far=True),
    ]
    traffic_density: Annotated[
        Floats,
        Column("run", "1/km", "Density of vehicles in the ego vehicle's direction at the last request.", nothing=0.0),
    ]
    lane_time_to_collision: Annotated[
        Floats,
        Column("run", "s", "Least time to collision along the lane at the lateral position of the front.", far=True),
    ]
    lane_width: Annotated[Floats, Column("run", "m", "Width of the ego vehicle's lane; 0 off the lanes.")]
    lane_heading: Annotated[
        Floats,
        Column("run", "rad", "Heading of the ego vehicle relative to its lane's direction, positive to the left."),
    ]
    on_road: Annotated[
        Booleans,
        Column(
            "run",
            "",
            "Whether the ego vehicle is on a lane for motor traffic, a shoulder or a parking lane.",
            kind="flag",
            nothing=0,
        ),
    ]
    left_y0: Annotated[Floats, Column("run", "m", "Detected left boundary: distance to the left at the camera.")]
    left_slope: Annotated[Floats, Column("run", "1", "Detected left boundary: slope at the camera.")]
    left_curvature: Annotated[Floats, Column("run", "1/m", "Detected left boundary: curvature.")]
    right_y0: Annotated[Floats, Column("run", "m", "Detected right boundary: distance to the left at the camera.")]
    right_slope: Annotated[Floats, Column("run", "1", "Detected right boundary: slope at the camera.")]
    right_curvature: Annotated[Floats, Column("run", "1/m", "Detected right boundary: curvature.")]

    events: tuple[EventRow, ...] = ()
    frames: tuple[Frame, ...] = ()
    stop_reason: StopReason = ""
    error: int = 0

    @property
    def lists(self) -> dict[str, tuple[str, ...]]:
        """The names for indices, by the kind of column; index -1 is no name."""
        return {"road": self.roads, "entity": self.header.entities}

    @cached_property
    def trajectory_hash(self) -> str:
        """SHA-256 of names, entities and roads and of the little-endian bytes of the trajectory's columns."""
        digest = hashlib.sha256()
        for text in (*self.header.entities, "", *self.roads):
            digest.update(text.encode() + b"\0")
        for column in COLUMNS:
            if column.trajectory:
                values = np.asarray(getattr(self, column.name))
                digest.update(column.name.encode() + b"\0")
                digest.update(np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<")).tobytes())
        return digest.hexdigest()

    def to_pandas(self) -> "pd.DataFrame":
        """Return the rows as a pandas DataFrame: one row per step for each entity that is present, in document order.

        The columns are those of recording.parquet, in SI units. Values of the run are in the first entity's rows and
        NaN in the others. Codes and roads appear by name.
        """
        import pandas as pd

        row, entity = np.nonzero(self.present)
        made: dict[str, Any] = {"t": self.t[row], "name": np.array(self.header.entities, object)[entity]}
        for column in COLUMNS:
            if column.name not in ("t", "present"):
                values = getattr(self, column.name)
                held = self._named(column, values[self.present] if column.per == "entity" else values[row])
                made[column.name] = pd.Series(held).where(entity == 0) if column.per == "run" else held
        return pd.DataFrame(made)

    def _named(self, column: Column, values: NDArray[Any]) -> NDArray[Any]:
        """Return values with names instead of codes and roads."""
        if column.kind in self.lists:
            return np.asarray(np.array([*self.lists[column.kind], None], object)[values])
        if column.kind in CODES:
            table = CODES[column.kind]
            return np.array([table[code] for code in values.tolist()], object)
        return values

    def __repr__(self) -> str:
        """Return one line: a notebook would display all arrays otherwise."""
        rows, entities = self.present.shape
        size = f"{rows} rows, entities: {entities}"
        return f"<Recording of {self.header.plan_name}, seed {self.header.seed}; {size}; see to_pandas()>"

    def __eq__(self, other: object) -> bool:
        """Compare everything bit for bit, except that NaN equals NaN."""
        if not isinstance(other, Recording):
            return NotImplemented
        plain = ("header", "roads", "events", "frames", "stop_reason", "error")
        return all(getattr(self, name) == getattr(other, name) for name in plain) and all(
            np.array_equal(getattr(self, c.name), getattr(other, c.name), equal_nan=c.kind == "float") for c in COLUMNS
        )

    __hash__ = None  # type: ignore[assignment]  # equal recordings have no equal hash, as arrays have none


def _named_columns() -> tuple[Column, ...]:
    marked = ((name, getattr(kind, "__metadata__", ())) for name, kind in Recording.__annotations__.items())
    return tuple(marks[0]._replace(name=name) for name, marks in marked if marks)


COLUMNS: tuple[Column, ...] = _named_columns()
"""All columns, in the order in which `Recording` declares them."""


class RecordingBuilder:
    """Builds the recording of a run.

    The columns are bound once; each `append` copies their present values. An entity's column is a sequence with one
    value per entity; a run's column has one value. `road` contains indices into `road_ids`, as in the engine. If a
    column is a `memoryview`, as in the compiled form, its bytes are collected in an array, and no number becomes an
    object.
    """

    def __init__(self, header: Header, road_ids: Sequence[str], columns: Mapping[str, Sequence[float]]) -> None:
        """Bind the columns. A column that is not named is recorded as empty; an unknown one raises ValueError."""
        known = {column.name: column for column in COLUMNS if column.name != "t"}
        if unknown := sorted(set(columns) - set(known)):
            raise ValueError(f"not columns of a recording: {', '.join(unknown)}")
        for name, values in columns.items():
            expected = len(header.entities) if known[name].per == "entity" else 1
            if len(values) != expected:
                raise ValueError(f"column {name} has {len(values)} values instead of {expected}")
        self._header = header
        self._road_ids = road_ids
        self._t: list[float] = []
        self._events: list[EventRow] = []
        self._frames: list[Frame] = []
        self._rows: dict[str, list[float] | array[float]] = {}
        self._live: list[tuple[Callable[[Any], None], Sequence[float]]] = []
        for name, values in columns.items():
            if isinstance(values, memoryview):
                rows: array[float] = array(values.format)
                self._rows[name] = rows
                self._live.append((rows.frombytes, values.cast("B")))
            else:
                listed: list[float] = []
                self._rows[name] = listed
                self._live.append((listed.extend, values))

    def append(self, t: float) -> None:
        """Record one row from the present values of the columns."""
        self._t.append(t)
        for add, values in self._live:
            add(values)

    def event(
        self,
        t: float,
        kind: EventKind,
        *,
        entity: str = "",
        cause: str = "",
        message: str = "",
        value: float | None = None,
    ) -> None:
        """Record an event."""
        self._events.append(
            EventRow.model_construct(t=t, kind=kind, entity=entity, cause=cause, message=message, value=value)
        )

    def add(self, row: EventRow) -> None:
        """Record an existing event."""
        self._events.append(row)

    def events_since(self, count: int) -> list[EventRow]:
        """Return the events that were recorded after the first `count`."""
        return self._events[count:]

    def frame(self, t: float, label: str, png: bytes) -> None:
        """Record a first-person picture."""
        self._frames.append(Frame(t, label, png))

    def finish(self, stop_reason: StopReason, error: int = 0) -> Recording:
        """Return the recording of all rows so far; events with the same time keep their order."""
        arrays = {column.name: self._array(column) for column in COLUMNS}
        absent = ~arrays["present"]
        for column in COLUMNS:
            if column.per == "entity":
                arrays[column.name][absent] = column.nothing
        arrays["h"] = _wrapped(arrays["h"])
        off_road = arrays["road"] < 0
        for name, value in (("lane", 0), ("s", 0.0), ("off", 0.0)):
            arrays[name][off_road & arrays["present"]] = value
        roads, arrays["road"] = _used_roads(arrays["road"], self._road_ids)
        for values in arrays.values():
            values.setflags(write=False)
        return Recording(
            header=self._header,
            roads=roads,
            **arrays,
            events=tuple(sorted(self._events, key=lambda event: event.t)),
            frames=tuple(sorted(self._frames, key=lambda frame: frame.t)),
            stop_reason=stop_reason,
            error=error,
        )

    def _array(self, column: Column) -> NDArray[Any]:
        rows, entities = len(self._t), len(self._header.entities)
        shape = (rows, entities) if column.per == "entity" else (rows,)
        if column.name == "t":
            return np.array(self._t, dtype=np.float64)
        if column.name not in self._rows:
            nothing = 1 if column.kind == "flag" else column.nothing
            return np.full(shape, nothing, dtype=column.dtype)
        made = np.array(self._rows[column.name], dtype=column.dtype).reshape(shape)
        if column.far:
            made[made >= FAR] = np.nan
        return made


def _wrapped(h: Floats) -> Floats:
    turned = np.where((h >= 0) & (h < 2 * np.pi), h, np.mod(h, 2 * np.pi))
    return np.where(turned >= 2 * np.pi, 0.0, turned)


def _used_roads(road: Integers, road_ids: Sequence[str]) -> tuple[tuple[str, ...], Integers]:
    """Return the ids of the roads that occur, in order of first occurrence, and the indices into them."""
    used, first = np.unique(road[road >= 0], return_index=True)
    order = used[np.argsort(first)]
    number = np.full(len(road_ids) + 1, -1, dtype=np.int64)
    number[order] = np.arange(len(order))
    return tuple(road_ids[index] for index in order), number[np.maximum(road, -1)]
