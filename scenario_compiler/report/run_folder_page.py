"""The page on the run folder (docs/run-folder.md), generated from the declarations of its files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from scenario_compiler.plan.model import Plan
from scenario_compiler.recording.events import EventRow
from scenario_compiler.recording.measures import MEASURES
from scenario_compiler.recording.names import EVENT_TEXTS, StopReason
from scenario_compiler.recording.outcome import Interval, MeasureValue, Outcome
from scenario_compiler.recording.recording import COLUMNS, Header
from scenario_compiler.recording.trajectory import TRAJECTORY_COLUMNS
from scenario_compiler.records import Record

STOPS: Mapping[StopReason, str] = {
    "duration": "The scenario's duration, or `--duration`, was reached.",
    "trigger": "The storyboard's stop trigger, or an action that ends the run.",
    "destination": "The automated vehicle reached its destination.",
    "standstill": "The automated vehicle stood for a while after a minimum-risk manoeuvre or a driver's stop.",
    "collision": "The automated vehicle stood for a while after a collision.",
    "error": "The engine broke the run off; the event `broken_off` names the entity, the quantity and its value.",
    "world_lost": "The world failed, for example because a server ended; the event `broken_off` gives the reason.",
    "controller_failed": "The controller failed; the event `broken_off` names the place.",
    "user": "A person or a program ended the run.",
    "": "Unknown: the trajectory is another program's.",
}
"""Meaning of each stop reason."""

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
"""Content of the columns of a trajectory's CSV file."""

_HEAD = """# The run folder

`make generate` writes this page from the program's own declarations. `scenario-compiler run FILE -o DIR` writes:

| file | content |
|---|---|
| `plan.json` | the plan of the run; `run DIR/plan.json --seed N --variant K` repeats the run of this seed and variant |
| `map.xodr` | the road file, so that the folder is complete on another machine; left out if it changed during the run |
| `recording.parquet` | all motion and measurements, row by row |
| `events.csv` | the events with their times |
| `outcome.json` | criteria, the takeover's timeline, measures with their definitions |
| `report.html` | the report with pictures, in one file; `report DIR` writes it again |

The folder contains all of these files or none of them. If a spreadsheet would interpret a cell of events.csv as a
formula, the cell begins with an apostrophe. The same plan and seed give the same bytes, on one platform and set of
versions. JSON schemas are in `schemas/`: `plan.schema.json`, `events.schema.json`, `outcome.schema.json`. In Python,
`read_recording` of `scenario_compiler.recording.store` returns the `Recording` that `run` returned, and `read_outcome`
of `scenario_compiler.recording.outcome` returns its `Outcome`.

## Units, axes, times

All quantities are in SI units and radians. The axes are those of the road file (OpenDRIVE): x and y as in the file, z
up, headings counter-clockwise from the x axis. CARLA's coordinates are (x, -y, z), with yaw = -heading in degrees.

**Position**: the position of an entity is that of its reference point, the middle of the rear axle, on the ground. The
middle of the box is `vehicle.center` metres (plan.json) ahead of it; CARLA places its actors there.

**Heading**: a vehicle that starts in a lane faces the lane's direction of travel. In right-hand traffic this is along s
on negative lanes and against s (h + pi) on positive lanes; in left-hand traffic it is the opposite. An entity that is
placed by road, s and t faces along s. Where a lane's centre moves sideways, the heading includes the arc tangent of the
change of its t per metre of s, as in esmini. In a bend, the direction of the centre line itself differs from this by
about the product of that change, the curvature and t: by 0.8 mrad for 0.05, 0.005 1/m and 3.2 m.

**Slopes**: OpenDRIVE measures s in the plane, as seen from above, and speeds count in the plane too, as in esmini: a
vehicle at speed v covers v metres of s per second on the reference line. On a grade of 10 %, its way in space is 0.5 %
longer than that.

**Time**: t is the number of steps times their length. Times in events.csv and the timeline are rounded to the
nanosecond. The first row, t = 0, is the state after the init actions. A row has positions, speeds and lanes at its t.
What the automation measured, its state, the source of control and the inputs in a row are those of the last control
step before t, which led to this row: an event at t shows in the first row after t, and `blocked_distance` in that row
was measured at t. There is one row per step for each entity that is present, with entities in document order and an
automated vehicle first. The row in which the stop trigger is true is the last; with a duration D, the last row is the
first with t >= D - 1e-6 s.
"""

_OF_RECORDING = """There is one row for each step and each entity that is present. Values of the run, which belong to no
entity, are in the first row of each step, which is that of the first entity if it is present, and null in the others;
without an automated vehicle they have no meaning. A number that does not exist is NaN.
"""

_OF_METADATA = """The file's metadata contains the following as JSON under `scenario-compiler`: `format`, `columns`
(units and descriptions), `roads` (the ids of the map's roads), `events`, `frames` (the time and the event of each
first-person picture), `stop_reason`, `error`, `trajectory_hash` and `header`. The pictures themselves are PNG in base64
under `frame.0`, `frame.1`, ... The header contains:
"""

_OF_EVENTS = """Unless stated otherwise, `entity` is the automated vehicle, or the first entity. It is empty for
events that concern no entity, such as messages and the stop.
"""

_OF_MEASURES = """The `value` of a measure is null if it is not defined; `undefined` gives the reason. A run without
an automated vehicle has only the measures that do not concern a takeover. Rows after the first collision do not change
a measure, except `final_speed`. On ten recordings, commonroad-crime 0.4.5
finds the same times to collision and decelerations to avoid a crash within 1 %. On ten others, its post-encroachment
times are shorter by up to two steps, because it measures between steps in which the vehicles are outside the conflict
area, and this program between the moments at which they leave and reach it
(`tests/recording/test_against_commonroad.py`).

Measures converge as the time step becomes shorter. The 62 conflicts of the library were run with three seeds and ideal
perception, with steps of 0.05 s and of 0.005 s. Warnings, requests and responses came at the same times, except the
request of one conflict, which came one control step earlier. With the shorter step, the median `steering_time` and
`braking_time` were 0.045 s shorter, because an input shows in the row after it, and `standstill_time` 0.11 s. Half of
the least times to collision differed by no more than 0.3 %, 95 of 100 by no more than 8 %; of the least distances 0.1 %
and 5 %, of `maximum_drac` 0.2 % and 11 %. What remains is decided by thresholds, so that a difference of a centimetre
can change it at any step: whether a box that the path grazes counts as ahead (`minimum_time_to_collision`,
`minimum_time_headway`, `maximum_drac`), whether a departure ends or goes on (`longest_lane_departure`: by more than
10 % in 4 of 73 runs), whether a turn of the wheel reaches the angle of a reversal (`steering_reversal_rate`: in 4 of
172 runs), and whether a driver evades or waits. For such runs, look at `minimum_lane_time_to_collision` and
`minimum_distance` too, and at more seeds.

The measures are:
"""

_OF_TRAJECTORIES = """`run --trajectory FILE.csv` writes one row per step for each entity that is present, for
exchange with other programs; `compare` reads it. Numbers are the shortest decimals that read back to the same bits.
Off every road, `road,lane,s,off` is `-1,0,0,0`.
"""


def run_folder_page() -> str:
    """Return the page on the files of a run."""
    parts = [
        _HEAD,
        "## plan.json\n",
        _fields(Plan),
        "Positions are bound to `road`, `lane`, `s` and `offset`, however the author wrote them.\n",
        "## recording.parquet\n",
        _OF_RECORDING,
        _table(("column", "unit", "of", "content"), _recorded()),
        _OF_METADATA,
        _fields(Header),
        "## events.csv\n",
        _fields(EventRow, "column"),
        _table(("kind", "meaning"), ((f"`{kind}`", text) for kind, text in EVENT_TEXTS.items())),
        _OF_EVENTS,
        "## outcome.json\n",
        _fields(Outcome),
        _table(("stop_reason", "meaning"), ((f"`{reason}`", text) for reason, text in STOPS.items() if reason)),
        f"An interval of the timeline has {_names(Interval)}; a measure has {_names(MeasureValue)}.\n",
        _OF_MEASURES,
        _table(("measure", "unit", "definition"), ((f"`{one.name}`", one.unit, one.definition) for one in MEASURES)),
        "## Trajectories\n",
        _OF_TRAJECTORIES,
        _table(("column", "content"), ((f"`{name}`", TRAJECTORY_UNITS[name]) for name in TRAJECTORY_COLUMNS)),
    ]
    return "\n".join(parts)


def _recorded() -> Iterable[tuple[str, str, str, str]]:
    """Yield the columns as in the file: `name` instead of the flag that an entity is present."""
    for column in COLUMNS:
        if column.name == "present":
            yield "`name`", "", "entity", "The entity's id."
        else:
            of = "row" if column.name == "t" else column.per
            yield f"`{column.name}`", column.unit, of, column.description


def _fields(model: type[Record], head: str = "key") -> str:
    fields = model.model_fields.items()
    return _table((head, "content"), ((f"`{name}`", field.description) for name, field in fields))


def _names(model: type[Record]) -> str:
    return ", ".join(f"`{name}`" for name in model.model_fields)


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = (f"| {' | '.join(row)} |" for row in (heads, *rows))
    return "\n".join((next(lines), f"|{'---|' * len(heads)}", *lines)) + "\n"
