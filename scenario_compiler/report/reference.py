"""The page on the run folder (docs/run-folder.md), made from the declarations of what its files hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from pydantic import BaseModel

from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.names import EVENT_TEXTS, StopReason
from scenario_compiler.recording.outcome import Interval, MeasureValue, Outcome
from scenario_compiler.recording.recording import COLUMNS, Header
from scenario_compiler.recording.trajectory import TRAJECTORY_COLUMNS

STOPS: Mapping[StopReason, str] = {
    "duration": "The scenario's duration, or `--duration`, was reached.",
    "trigger": "The storyboard's stop trigger, or an action that ends the run.",
    "destination": "The automated vehicle reached its destination.",
    "standstill": "It has stood for a while after a minimum-risk manoeuvre, or a driver's stop.",
    "collision": "It has stood for a while after a collision.",
    "error": "The engine broke off; an event `broken_off` says which entity, which quantity and what value.",
    "world_lost": "The world could not go on, such as a server that ended; the event `broken_off` says why.",
    "controller_failed": "The controller failed; the event `broken_off` says where.",
    "user": "A person or a program ended it.",
    "": "Unknown: a trajectory of another program.",
}
"""What each reason of an end means."""

TRAJECTORY_UNITS: Mapping[str, str] = {
    "t": "s",
    "name": "the entity's id",
    "x": "m",
    "y": "m",
    "h": "rad, 0 to 2 pi",
    "v": "m/s, signed along the heading",
    "road": "id of the road, -1 off every road",
    "lane": "OpenDRIVE lane id, 0 off the lanes",
    "s": "m, along the road's reference line",
    "off": "m, left of the lane's centre in the road's s direction",
}
"""What the columns of a trajectory's CSV file hold."""

_HEAD = """# The run folder

Made from the program's own declarations by `make generate`. `scenario-compiler run FILE -o DIR` writes:

| file | holds |
|---|---|
| `plan.json` | what was run: `run DIR/plan.json` runs it again |
| `map.xodr` | the road file, with which the folder is whole on another machine; left out if it changed during the run |
| `recording.parquet` | everything that moved or was measured, row by row |
| `events.csv` | what happened, and when |
| `outcome.json` | criteria, the takeover's timeline, measures with their definitions |
| `report.html` | all of it for a reader, with pictures; in one file (`report DIR` writes it again) |

The folder holds all of these or none of them. Cells of events.csv that a spreadsheet would take for a formula begin
with an apostrophe. The same plan and seed give the same bytes, on one platform and set of versions. JSON schemas are in
`schemas/`: `plan.schema.json`, `events.schema.json`, `outcome.schema.json`. From Python: `read_recording` of
`scenario_compiler.recording.store` gives the `Recording` that `run` returned, `read_outcome` of
`scenario_compiler.recording.outcome` its `Outcome`.

## Units, axes, times

Everything is in SI units and radians. Axes are those of the road file (OpenDRIVE): x and y as it says, z up, headings
from the x axis to the left. CARLA's are (x, -y, z), with yaw = -heading in degrees.

**The point** of an entity is its reference point: the middle of the rear axle, on the ground. The middle of the box
lies `vehicle.center` metres (plan.json) ahead of it; CARLA's actors are placed there.

**Headings**: a vehicle that starts in a lane faces the lane's direction of travel: along s on negative lanes in
right-hand traffic, against it (h + pi) on positive ones, and the other way round in left-hand traffic. What is placed
by road, s and t faces along s.

**Times**: t is the number of steps times their length; events.csv and the timeline are rounded
to the nanosecond. The first row, t = 0, is the state after the init actions. There is one row a step and entity that is
present, entities in document order, an automated vehicle first. Where the stop trigger is true, that row is the last; a
duration D ends with the first row of t >= D - 1e-6 s.
"""

_OF_RECORDING = """A row an entity and step. What is of the run, not of an entity, stands in the rows of the first
entity, is null in the others, and means nothing without an automated vehicle. NaN stands for a number that there is
none of.
"""

_OF_METADATA = """The file's metadata has, as JSON under `scenario-compiler`: `columns` (units and descriptions),
`events`, `stop_reason`, `error`, `trajectory_hash` and `header`; and the first-person pictures, as PNG in base64, under
`frame.0`, `frame.1`, ... The header holds:
"""

_OF_EVENTS = """Where nothing else is said, `entity` is the automated vehicle, or the first entity; what concerns none,
as messages and the stop do, has an empty one.
"""

_OF_MEASURES = """The `value` of a measure is null where it is not defined, and `undefined` says why. A run without an
automated vehicle has only those that are not about a takeover. commonroad-crime 0.4.5 finds the same times to collision
and decelerations to avoid a crash within 1 % on five recordings, and on five others post-encroachment times that are
shorter by two steps, as it counts between the steps outside the conflict area
(`tests/recording/test_against_commonroad.py`). The measures are:
"""

_OF_TRAJECTORIES = """`run --trajectory FILE.csv` writes a row an entity present and step, for and from other programs:
`compare` reads it. Numbers are the shortest decimals that read back to the same bits. Off every road,
`road,lane,s,off` is `-1,0,0,0`.
"""


def run_folder_page() -> str:
    """Return the page on the files that a run leaves."""
    parts = [
        _HEAD,
        "## plan.json\n",
        _fields(Plan),
        "Positions are bound: `road`, `lane`, `s` and `offset`, in whatever way the author wrote them.\n",
        "## recording.parquet\n",
        _OF_RECORDING,
        _table(("column", "unit", "of", "holds"), _recorded()),
        _OF_METADATA,
        _fields(Header),
        "## events.csv\n",
        _fields(EventRow, "column"),
        _table(("kind", "tells"), ((f"`{kind}`", text) for kind, text in EVENT_TEXTS.items())),
        _OF_EVENTS,
        "## outcome.json\n",
        _fields(Outcome),
        _table(("stop_reason", "means"), ((f"`{reason}`", text) for reason, text in STOPS.items() if reason)),
        f"A part of the timeline has {_names(Interval)}; a measure has {_names(MeasureValue)}.\n",
        _OF_MEASURES,
        _table(("measure", "unit", "definition"), ((f"`{one.name}`", one.unit, one.definition) for one in MEASURES)),
        "## Trajectories\n",
        _OF_TRAJECTORIES,
        _table(("column", "holds"), ((f"`{name}`", TRAJECTORY_UNITS[name]) for name in TRAJECTORY_COLUMNS)),
    ]
    return "\n".join(parts)


def _recorded() -> Iterable[tuple[str, str, str, str]]:
    """Yield the columns as the file has them: `name` in place of the flag that an entity is present."""
    for column in COLUMNS:
        if column.name == "present":
            yield "`name`", "", "entity", "The entity's id."
        else:
            of = "row" if column.name == "t" else column.per
            yield f"`{column.name}`", column.unit, of, column.description


def _fields(model: type[BaseModel], head: str = "key") -> str:
    fields = model.model_fields.items()
    return _table((head, "holds"), ((f"`{name}`", field.description or "") for name, field in fields))


def _names(model: type[BaseModel]) -> str:
    return ", ".join(f"`{name}`" for name in model.model_fields)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = (f"| {' | '.join(row)} |" for row in (heads, *rows))
    return "\n".join((next(lines), f"|{'---|' * len(heads)}", *lines)) + "\n"
