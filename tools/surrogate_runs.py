"""The closed-loop runs to which surrogate perception is fitted and on which it is evaluated.

The number of a run determines everything that is random in it. There are three kinds:

    road       a random road of clothoids, with random lanes, widths, marks and grades
    map        a lane of a road file of another author
    conflict   a variant of one of the library's five conflicts, on the maps that come with the program

Runs of the fit are on random roads and on maps. The runs for evaluation are variants of the conflicts, random roads of
other numbers, and maps that no run of the fit is on. The first half of them is also made a little faster: no function
of the place can agree with the camera much better than the camera agrees with itself.
"""

from __future__ import annotations

import json
import math
import multiprocessing
import re
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import count, islice, pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler import compile_scenario, load_network, open_world
from scenario_compiler.batch.measuring import row_of_recording
from scenario_compiler.compiler import Overrides
from scenario_compiler.controllers import Control, ControllerModel
from scenario_compiler.diagnostics import CompileError
from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import State
from scenario_compiler.engine.columns.view import VIEW_SIZE
from scenario_compiler.plan.model import Plan
from scenario_compiler.resources import library_folder
from scenario_compiler.roads import Network
from scenario_compiler.roads.lane_types import is_drivable
from scenario_compiler.roads.lanes import lane_width
from scenario_compiler.roads.tables import RoadTables
from scenario_compiler.runtime.loop import Execution
from scenario_compiler.vocabulary.lane_keeping import LANE_KEEPING
from scenario_compiler.vocabulary.sensors import Perception
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS
from scenario_compiler.worlds import World

Floats = NDArray[np.float64]
Kind = Literal["road", "map", "conflict"]

UNSEEN_MAPS = (
    *("Town03", "e6mini", "multi_intersections", "town_grid", "highway_loop"),
    *("Crossing8Course", "highway_exit"),
)
"""Names of the maps that are not used in the fit."""

CONFLICTS = ("markings_missing", "obstacle_ahead", "ramp_blocked", "road_narrows", "sensor_failure")
JUDGED: dict[Kind, tuple[int, int]] = {"conflict": (-6001, 100), "road": (-7001, 60), "map": (-8001, 40)}
"""First number and count of the runs for evaluation, by kind; the numbers count downwards.

The numbers -1 to -5040 are not used: those runs evaluated earlier features.
"""

SECOND: dict[Kind, tuple[int, int]] = {"conflict": (-16001, 100), "road": (-17001, 60), "map": (-18001, 40)}
"""The same for the second half of the runs for evaluation."""

SECOND_FROM = -10000
"""Runs for evaluation with numbers below this belong to the second half."""

FASTER = 0.01
"""Share by which the runs for evaluation are faster the second time."""

NARROWEST = 2.4
"""Width that the lane of a start exceeds, m."""

RUNS_IN_FILE = 600
"""Number of runs that are written to one file."""

MAPS_SHARE = 0.45
"""Share of maps in the runs of the fit."""

BY_HAND = (op.TAKEOVER_MANUAL, op.TAKEOVER_HAND_BACK)
WITHOUT_LOOKS = (*BY_HAND, op.TAKEOVER_STANDSTILL)
AUTOMATED = (op.TAKEOVER_AUTOMATED, op.TAKEOVER_WARNING)

KEPT = ("takeover_time", "minimum_time_to_collision", "maximum_lateral_offset", "request_time", "lane_departures")
"""Names of the measures that are stored for each run."""

TEXT_OF_SCENARIO = """<scenarios version="1"><allow code="SC512"/><allow code="SC513"/>
<scenario name="drawn" map="{map}" duration="{duration}" step="0.05" control_every="2" summary="Drawn">
  <weather {weather}/>
  <ego speed="{speed}"><start><lane road="{road}" lane="{lane}" s="{s}" offset="{offset}"/></start>
    <camera sensor_noise="{noise}">{failure}</camera></ego>
  {actors}
  {markings}
  <takeover budget="7"><cause kind="lane_confidence"/>{causes}<driver takeover_time="{driver}"/></takeover>
</scenario></scenarios>"""


class Case(NamedTuple):
    """The specification of a run.

    Attributes:
        kind: The kind of run.
        number: Seed of everything that is random in the run.
        map: Path of the road file; empty except for the kind map.
        faster: Share by which the ego's initial and desired speed exceeds the scenario's.
    """

    kind: Kind
    number: int
    map: str
    faster: float = 0.0

    @property
    def set(self) -> Literal["fit", "first", "second"]:
        """The runs of the fit, or the half of the runs for evaluation, that the run belongs to."""
        return "fit" if self.number >= 0 else "first" if self.number > SECOND_FROM else "second"

    def on(self, maps: Path) -> Case:
        """Return the same run with its road file in another folder."""
        return self._replace(map=str(maps / Path(self.map).name)) if self.map else self


@dataclass(frozen=True, eq=False)
class Made:
    """A finished run.

    Attributes:
        case: The run.
        looks: (N, 9) one row a look until the driver drives: `LOOK_COLUMNS`.
        commands: (M, 7) what the controller has told the engine at each control step: `COMMANDS`; with single
            precision, a repeated run can come to a standstill one step earlier.
        outcome: Measures by name, NaN where undefined; `cause` and `resolution` as texts.
    """

    case: Case
    looks: NDArray[np.float32]
    commands: Floats
    outcome: dict[str, Any]


LOOK_COLUMNS = ("p_left", "p_right", "health", "path_error", "road", "lane", "s", "t", "asking")
"""What is stored of a look.

It is the confidence of each side without the factor of the sensor's health; that health; how far left of the lane's
centre the followed path lies at the look-ahead distance, m; the ego's road, lane and s; the time, s; and 1 from the
takeover request on, else 0.
"""

COMMANDS = ("auto_throttle", "auto_steer", "auto_brake", "conf_left", "conf_right", "health", "auto_request")
"""Columns of the engine's state that the controller writes. With them a run is repeated without a camera, which works
out its features (`views_of`): they are not stored, so that a change of the features needs no other runs.
"""


def cases(maps: Sequence[Path], first: int, fitted: int) -> list[Case]:
    """Return both halves of judged runs, the first also a little faster, and the runs of the fit, from a number on."""
    unseen = sorted(str(one) for one in maps if one.stem in UNSEEN_MAPS)
    seen = sorted(str(one) for one in maps if one.stem not in UNSEEN_MAPS)
    known, fresh = (
        [
            Case(kind, number - k, unseen[k % len(unseen)] if kind == "map" else "")
            for kind, (number, many) in of_set.items()
            for k in range(many if kind != "map" or unseen else 0)
        ]
        for of_set in (JUDGED, SECOND)
    )
    judged = [*known, *(one._replace(faster=FASTER) for one in known), *fresh]
    on_maps = round(MAPS_SHARE * fitted) if seen else 0
    kinds = np.random.default_rng(first).permutation(fitted) < on_maps
    learned = [
        Case("map", first + k, seen[k % len(seen)]) if on_map else Case("road", first + k, "")
        for k, on_map in enumerate(kinds)
    ]
    return judged + learned


def run_case(case: Case, perception: Perception, *, looks: bool) -> Made | None:
    """Make a run; None if its scenario does not compile.

    With `looks` a run of the fit ends as soon as the driver drives or the ego has stopped, because there are no looks
    from then on, and one that is a little faster ends with its request, whose time is all that is compared. Measures of
    what comes later have no meaning in such runs. Without `looks` only the measures are kept.
    """
    cv2.setNumThreads(1)
    with _opened(case, perception) as opened:
        if opened is None:
            return None
        plan, world = opened
        execution = Unpictured(plan, world, seed=_seed(case))
        rows: list[Sequence[float]] = []
        commands: list[Sequence[float]] = []
        while execution.going and not (looks and _has_enough(execution, case)):
            before = _Before.of(execution) if looks else None
            execution.advance()
            if before is not None and execution.control is not None:
                rows += before.looks(execution.control)
                commands += before.commands(execution.control, execution.state)
        recording = execution.finish("user")
    row = row_of_recording(plan, recording)
    outcome: dict[str, Any] = {name: _number(row[name][0]) for name in KEPT}
    outcome |= {"cause": row["cause"][0], "resolution": row["resolution"][0], "result": row["result"][0]}
    outcome |= {"name": plan.name, "map": Path(plan.map.file).stem}
    return Made(case, _table(rows, LOOK_COLUMNS).astype(np.float32), _table(commands, COMMANDS), outcome)


def _has_enough(execution: Execution, case: Case) -> bool:
    """Return whether nothing that comes later in a camera run is used."""
    state = execution.state.takeover_state[0]
    if case.faster:
        return state not in AUTOMATED
    return case.number >= 0 and state in WITHOUT_LOOKS


def _table(rows: Sequence[Sequence[float]], columns: Sequence[str]) -> Floats:
    return np.array(rows, np.float64).reshape(-1, len(columns))


def _number(value: Any) -> float:
    return math.nan if value is None else float(value)


def _seed(case: Case) -> int:
    return 1 + case.number % 1000


@contextmanager
def _opened(case: Case, perception: Perception) -> Iterator[tuple[Plan, World] | None]:
    """Compile a run's scenario and open its world; None if it does not compile or the map has no lane for it."""
    with TemporaryDirectory() as folder:
        draw = np.random.default_rng([7, case.number % (1 << 32)])
        try:
            path, arguments = _scenario(case, Path(folder), draw)
            plan = compile_scenario(path, overrides=Overrides(perception=perception), **arguments)
        except (CompileError, NoWideLane):
            yield None
            return
        network = load_network(plan.map.file)
        assert network is not None
        with open_world("kinematic", plan, network) as world:
            yield plan, world


@dataclass(frozen=True)
class _Before:
    """What is noted before a step: whether it is a control step, and the place of a look of the automation.

    Attributes:
        controls: Whether the controller is called in the step.
        place: Road, lane, s, time and 1 from the request on; None if the step has no look.
        way: The lane's centre line ahead, in the ego's frame, m.
        speed: The ego's speed, m/s.
    """

    controls: bool
    place: tuple[float, ...] | None
    way: Sequence[tuple[float, float]]
    speed: float

    @classmethod
    def of(cls, execution: Execution) -> _Before:
        st = execution.state
        controls = st.frame[0] % execution.plan.control_every == 0
        if not looks_now(execution):
            return cls(controls, None, (), 0.0)
        asking = 0.0 if st.takeover_state[0] in AUTOMATED else 1.0
        place = st.path_road[0], st.path_lane[0], st.path_s[0], st.clock[0], asking
        return cls(controls, place, execution.simulation.look_out().way, st.v[0])

    def looks(self, control: Control) -> list[Sequence[float]]:
        if self.place is None or control.lanes is None:
            return []
        error = _path_error(control.trajectory, self.way, _look_ahead(self.speed))
        return [(control.lanes.left.p, control.lanes.right.p, control.sensor_health, error, *self.place)]

    def commands(self, control: Control, st: State) -> list[Sequence[float]]:
        if not self.controls:
            return []
        sides = control.confidence_left, control.confidence_right
        asks = st.auto_request[0]
        return [(control.throttle, control.steer, control.brake, *sides, control.sensor_health, asks)]


def looks_now(execution: Execution) -> bool:
    """Return whether the next step has a look of the automation."""
    st = execution.state
    return st.frame[0] % execution.program.image_every[0] == 0 and st.takeover_state[0] not in BY_HAND


def views_of(made: Made) -> NDArray[np.float32]:
    """Return the features of a camera run's looks, (N, VIEW_SIZE) as the left side has them; NaN where there are none.

    The run is repeated with its stored commands in place of camera and controller.

    Raises:
        RuntimeError: The engine no longer drives the run as it did.
    """
    views: dict[float, Floats] = {}
    with _opened(made.case, "camera") as opened:
        if opened is None:
            raise RuntimeError(f"{made.case} cannot be driven any more")
        execution = Repeated(*opened, seed=_seed(made.case), commands=made.commands.tolist())
        while execution.going and not _has_enough(execution, made.case):
            if looks_now(execution):
                view = execution.simulation.look_at_view()
                views[round(execution.state.clock[0], 3)] = np.full(VIEW_SIZE, math.nan) if view is None else view[0]
            execution.advance()
    times = [round(float(t), 3) for t in made.looks[:, LOOK_COLUMNS.index("t")]]
    if not views.keys() >= set(times):
        raise RuntimeError(f"{made.case} does not go as it went")
    return np.array([views[t] for t in times], np.float32).reshape(-1, VIEW_SIZE)


def all_views(runs: Sequence[Made], jobs: int) -> list[NDArray[np.float32]]:
    """Return the features of several runs, worked out in `jobs` processes."""
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        return pool.map(views_of, runs, chunksize=8)


class Unpictured(Execution):
    """A run whose events have no pictures: drawing and encoding them takes a tenth of a camera run's time."""

    def _picture(self, t: float, kind: str, cause: str) -> None:
        pass


class Repeated(Unpictured):
    """A run in which stored commands take the place of the controller."""

    def __init__(self, plan: Plan, world: World, seed: int, commands: Sequence[Sequence[float]]) -> None:
        """Prepare everything for the start of the run.

        Args:
            plan: The plan.
            world: The world.
            seed: The seed of the run.
            commands: `COMMANDS` of each control step.
        """
        super().__init__(plan, world, seed)
        self.told = iter(commands)

    def _let_control(self, _: ControllerModel) -> None:
        for name, value in zip(COMMANDS, next(self.told), strict=True):
            getattr(self.state, name)[0] = int(value) if name == "auto_request" else value


def _look_ahead(speed: float) -> float:
    """Return the distance ahead of the ego of the point for which the automation steers, m, at a speed in m/s."""
    return min(
        max(LANE_KEEPING["look_ahead_time"] * speed, LANE_KEEPING["look_ahead_min"]), LANE_KEEPING["look_ahead_max"]
    )


def _path_error(path: Sequence[tuple[float, float]], way: Sequence[tuple[float, float]], reach: float) -> float:
    """Return how far left of the lane's centre line the path lies at a distance from the ego, m.

    Args:
        path: The planned path, (x, y) in the ego's frame, m.
        way: The lane's centre line in the same frame, m.
        reach: The distance from the ego, m.

    Returns:
        The lateral distance; NaN if either line does not reach so far.
    """
    x, y = _reached(path, reach)
    for (x0, y0), (x1, y1) in pairwise(way):
        if x0 <= x <= x1 and x1 > x0:
            slope = (y1 - y0) / (x1 - x0)
            return (y - y0 - slope * (x - x0)) / math.hypot(1.0, slope)
    return math.nan


def _reached(path: Sequence[tuple[float, float]], reach: float) -> tuple[float, float]:
    for (x0, y0), (x1, y1) in pairwise(path):
        near, far = math.hypot(x0, y0), math.hypot(x1, y1)
        if far >= reach > near:
            share = (reach - near) / (far - near)
            return x0 + share * (x1 - x0), y0 + share * (y1 - y0)
    return math.nan, math.nan


def make(todo: Sequence[Case], jobs: int, seconds: float, perception: Perception = "camera") -> Iterator[Made]:
    """Make runs with their looks in `jobs` processes.

    Yields:
        The runs that are made within `seconds`, in the order in which they end.
    """
    began = time.monotonic()
    with multiprocessing.get_context("spawn").Pool(jobs) as pool:
        for made in pool.imap_unordered(_make, [(case, perception) for case in todo]):
            if made is not None:
                yield made
            if time.monotonic() - began > seconds:
                pool.terminate()
                break


def _make(job: tuple[Case, Perception]) -> Made | None:
    return run_case(job[0], job[1], looks=True)


def keep(runs: Iterable[Made], folder: Path) -> None:
    """Write runs to files in a folder as they come, so that what is made is there if the making is ended."""
    folder.mkdir(parents=True, exist_ok=True)
    coming = iter(runs)
    for number in count():
        some = list(islice(coming, RUNS_IN_FILE))
        if not some:
            return
        np.savez_compressed(
            folder / f"runs{number:03d}.npz",
            looks=np.concatenate([one.looks for one in some]),
            commands=np.concatenate([one.commands for one in some]),
            about=np.array(json.dumps([(one.case, len(one.looks), len(one.commands), one.outcome) for one in some])),
        )


def kept(folder: Path, maps: Path) -> list[Made]:
    """Return the runs in the files of a folder and its subfolders, by number, with road files of another folder."""
    found = []
    for file in sorted(folder.rglob("*.npz")):
        with np.load(file) as stored:
            looks, commands = stored["looks"], stored["commands"]
            look = told = 0
            for case, looks_of, told_of, outcome in json.loads(str(stored["about"])):
                mine = looks[look : look + looks_of], commands[told : told + told_of]
                found.append(Made(Case(*case).on(maps), *mine, outcome))
                look, told = look + looks_of, told + told_of
    return sorted(found, key=lambda one: one.case.number)


def _scenario(case: Case, folder: Path, draw: np.random.Generator) -> tuple[Path, dict[str, Any]]:
    if case.kind == "conflict":
        return _conflict(case, folder, draw)
    if case.kind == "road":
        file = folder / "road.xodr"
        file.write_text(road_text(draw), encoding="utf-8")
    else:
        file = Path(case.map)
    network = load_network(file, cache=case.kind == "map")
    assert network is not None
    path = folder / "drawn.xml"
    path.write_text(_hurried(_drawn(file, network, draw), case.faster), encoding="utf-8")
    return path, {}


def _conflict(case: Case, folder: Path, draw: np.random.Generator) -> tuple[Path, dict[str, float]]:
    """Return the file and the parameters of a variant of a conflict, some with another weather or with sensor noise."""
    name = CONFLICTS[-case.number % len(CONFLICTS)]
    text = (library_folder() / "conflicts" / f"{name}.xml").read_text(encoding="utf-8")
    if draw.random() < 0.6:
        text = text.replace('weather="ClearNoon"', f'weather="{draw.choice(list(WEATHER_PRESETS))}"')
    if draw.random() < 0.3 and name != "sensor_failure":
        before = "<forward_sensor" if "<forward_sensor" in text else "</ego>"
        text = text.replace(before, f'<camera sensor_noise="{draw.uniform(0.0, 35.0):.1f}"/>{before}')
    path = folder / f"{name}.xml"
    path.write_text(_hurried(text, case.faster), encoding="utf-8")
    drawn = {
        "markings_missing": lambda: {"from": draw.uniform(100, 400), "over": draw.uniform(1, 250)},
        "obstacle_ahead": lambda: {"distance": draw.uniform(80, 300)},
        "ramp_blocked": lambda: {"spacing": draw.uniform(10, 60)},
        "road_narrows": lambda: {"distance": draw.uniform(80, 300), "intrusion": draw.uniform(0, 2)},
        "sensor_failure": lambda: {"sigma": draw.uniform(0, 120), "onset": draw.uniform(2, 15)},
    }
    return path, {key: round(float(value), 2) for key, value in drawn[name]().items()}


def _hurried(text: str, faster: float) -> str:
    """Return the scenario's text with the ego's speed multiplied by 1 + faster."""
    return re.sub(r'<ego speed="([0-9.]+)"', lambda found: f'<ego speed="{float(found[1]) * (1.0 + faster):.4f}"', text)


class NoWideLane(Exception):
    """A map has no lane in which a car could start."""


class Start(NamedTuple):
    """A run's start: a position in a lane and the rest of its road.

    Attributes:
        road: Identifier of the road.
        lane: OpenDRIVE lane id.
        s: Position along the road, m.
        sense: 1 if traffic in the lane drives along s, otherwise -1.
        room: Distance to the road's end in the driving direction, m.
    """

    road: str
    lane: int
    s: float
    sense: int
    room: float


def _start(network: Network, draw: np.random.Generator) -> Start:
    """Return a random start outside junctions in a drivable lane wider than 2.4 m, uniform over the lanes' lengths.

    Raises:
        NoWideLane: No lane is so wide at the beginning or at the end of its section.
    """
    n = network.tables
    rows = [row for row, lane in enumerate(n.lane_id) if lane != 0 and is_drivable(n.lane_type[row])]
    if not any(_is_wide(n, row) for row in rows):
        raise NoWideLane
    lengths = np.array([n.section_end[n.lane_section[row]] - n.section_s[n.lane_section[row]] for row in rows])
    while True:
        row = rows[int(draw.choice(len(rows), p=lengths / lengths.sum()))]
        section = n.lane_section[row]
        road, lane = n.section_road[section], n.lane_id[row]
        s = float(draw.uniform(n.section_s[section], n.section_end[section]))
        sense = n.lane_sense[row]
        if n.road_junction[road] < 0 and lane_width(n, road, lane, s) > NARROWEST:
            room = n.road_length[road] - s if sense > 0 else s
            return Start(network.road_ids[road], lane, s, sense, room)


def _is_wide(n: RoadTables, row: int) -> bool:
    section = n.lane_section[row]
    road, ends = n.section_road[section], (n.section_s[section], n.section_end[section] - 1e-3)
    return n.road_junction[road] < 0 and max(lane_width(n, road, n.lane_id[row], s) for s in ends) > NARROWEST


def _drawn(file: Path, network: Network, draw: np.random.Generator) -> str:
    start = _start(network, draw)
    bend = max(abs(network.curvature(start.road, start.s)), 1e-4)
    speed = min(float(draw.uniform(4.0, 32.0)), math.sqrt(2.5 / bend))
    driver = 1000.0 if draw.random() < 0.3 else draw.uniform(1.0, 6.0)
    causes = '<cause kind="path_blocked"/>' if draw.random() < 0.5 else ""
    causes += '<cause kind="sensor_health"/>' if draw.random() < 0.5 else ""
    noise = draw.uniform(0.0, 60.0) if draw.random() < 0.3 else 0.0
    return TEXT_OF_SCENARIO.format(
        map=file,
        duration=round(float(draw.uniform(12.0, 22.0))),
        weather=_weather(draw),
        speed=f"{speed:.2f}",
        road=start.road,
        lane=start.lane,
        s=f"{start.s:.2f}",
        offset=f"{draw.normal(0.0, 0.15):.2f}",
        noise=f"{noise:.1f}",
        failure=_failure(draw),
        actors=_actors(draw, speed),
        markings=_markings(draw, start, speed),
        causes=causes,
        driver=f"{driver:.2f}",
    )


def _weather(draw: np.random.Generator) -> str:
    """Return the attributes of a weather: a clear noon, a preset, or random values."""
    kind = draw.random()
    if kind < 0.35:
        return 'preset="ClearNoon"'
    if kind < 0.75:
        return f'preset="{draw.choice(list(WEATHER_PRESETS))}"'
    wet, rain, dust = draw.uniform(0, 100), draw.uniform(0, 100) * (draw.random() < 0.6), 0.0
    fog = draw.uniform(0, 100) * (draw.random() < 0.3)
    sun = draw.uniform(-20.0, 60.0)
    if draw.random() < 0.1:
        dust = draw.uniform(0, 100)
    numbers: dict[str, str | float] = {
        "preset": "custom", "cloudiness": rain, "precipitation": rain, "precipitation_deposits": wet,
        "wind_intensity": 10.0, "sun_azimuth_angle": draw.uniform(0, 360), "sun_altitude_angle": sun,
        "fog_density": fog, "fog_distance": draw.uniform(0, 20), "fog_falloff": draw.uniform(0.1, 2.0),
        "wetness": wet, "dust_storm": dust,
    }  # fmt: skip
    return " ".join(
        f'{name}="{value if isinstance(value, str) else round(value, 2)}"' for name, value in numbers.items()
    )


FAILURES = ("blackout", "blur", "dirt", "impulse_noise", "overexposure", "dead_rows", "quantisation", "latency")


def _failure(draw: np.random.Generator) -> str:
    if draw.random() > 0.15:
        return ""
    kind, amount = draw.choice(FAILURES), draw.uniform(0.0, 1.0)
    onset, ramp = draw.uniform(0.0, 8.0), draw.uniform(0.0, 3.0)
    return f'<failure kind="{kind}" amount="{amount:.2f}" onset="{onset:.1f}" ramp="{ramp:.1f}"/>'


def _actors(draw: np.random.Generator, speed: float) -> str:
    """Return the element of a leader, of a vehicle alongside or of a parked one; in half of the runs nothing."""
    kind = draw.random()
    model = draw.choice(("vehicle.tesla.model3", "vehicle.carlamotors.carlacola", "vehicle.audi.tt"))
    if kind < 0.2:
        ahead, slower = draw.uniform(12.0, 60.0), speed * draw.uniform(0.5, 1.05)
        return (
            f'<dynamic id="leader" model="{model}" speed="{slower:.2f}">'
            f'<start><ahead_of entity="ego" distance="{ahead:.1f}"/></start></dynamic>'
        )
    if kind < 0.3:
        ahead, lanes = draw.uniform(4.0, 20.0), draw.choice((-1, 1))
        return (
            f'<dynamic id="beside" model="{model}" speed="{speed:.2f}">'
            f'<start><ahead_of entity="ego" distance="{ahead:.1f}" lanes="{lanes}"/></start></dynamic>'
        )
    if kind < 0.45:
        ahead, offset = draw.uniform(60.0, 200.0), draw.uniform(-2.5, 2.5)
        return (
            f'<static id="parked" model="{model}">'
            f'<at><ahead_of entity="ego" distance="{ahead:.1f}" offset="{offset:.2f}"/></at></static>'
        )
    return ""


def _markings(draw: np.random.Generator, start: Start, speed: float) -> str:
    """Return the elements for worn lane marks on the first road: none, one along all of it, or several stretches."""
    kind = draw.random()
    if kind < 0.2:
        return ""
    texts = []
    whole = start.s + start.sense * start.room
    if kind < 0.45:
        low, high = sorted((start.s, whole))
        quality = draw.uniform(0.02, 0.7)
        texts.append((low, high, quality, quality, "", 0.0))
    for _ in range(int(draw.integers(1, 4)) if kind > 0.4 else 0):
        begin = start.s + start.sense * draw.uniform(1.0, 14.0) * speed
        end = begin + start.sense * 10.0 ** draw.uniform(0.5, 2.4)
        lane = (
            "" if draw.random() < 0.5 else f'lane="{draw.choice((start.lane, start.lane - int(np.sign(start.lane))))}"'
        )
        first, last = (0.0, 0.0) if draw.random() < 0.4 else draw.uniform(0.0, 1.0, 2)
        cover = draw.uniform(0.0, 1.0) if draw.random() < 0.1 else 0.0
        low, high = min(begin, end), max(begin, end)
        texts.append((low, high, first, last, lane, cover))
    limit = max(start.s, whole)
    return "".join(
        f'<markings road="{start.road}" {lane} from="{max(low, 0.0):.1f}" to="{min(high, limit):.1f}" '
        f'quality="{first:.2f}" quality_to="{last:.2f}" coverage="{cover:.2f}"/>'
        for low, high, first, last, lane, cover in texts
        if min(high, limit) - max(low, 0.0) > 2.0
    )


def road_text(draw: np.random.Generator) -> str:
    """Return an OpenDRIVE file with one random road of about 900 m."""
    pieces: list[tuple[float, float, float]] = []
    while sum(length for length, _, _ in pieces) < 900.0:
        if draw.random() < 0.4:
            pieces.append((draw.uniform(30.0, 250.0), 0.0, 0.0))
            continue
        k = draw.choice((-1.0, 1.0)) / 10.0 ** draw.uniform(1.5, 2.9)
        ease = draw.uniform(8.0, 60.0)
        angle = draw.uniform(0.2, 1.4)
        pieces += [(ease, 0.0, k), (max(angle / abs(k) - ease, 5.0), k, k), (ease, k, 0.0)]
    x = y = heading = s = 0.0
    shapes = []
    for length, first, last in pieces:
        kind = "<line/>" if first == last == 0.0 else f'<arc curvature="{first:.12f}"/>'
        if first != last:
            kind = f'<spiral curvStart="{first:.12f}" curvEnd="{last:.12f}"/>'
        shapes.append(
            f'<geometry s="{s:.12f}" x="{x:.12f}" y="{y:.12f}" hdg="{heading:.12f}" length="{length:.12f}">'
            f"{kind}</geometry>"
        )
        steps = 400
        for k in range(steps):
            middle = (k + 0.5) / steps * length
            h = heading + first * middle + 0.5 * (last - first) / length * middle * middle
            x, y = x + length / steps * math.cos(h), y + length / steps * math.sin(h)
        heading, s = heading + 0.5 * (first + last) * length, s + length
    heights = ['<elevation s="0" a="0" b="0" c="0" d="0"/>']
    if draw.random() < 0.4:
        at, z, grade, heights = 0.0, 0.0, 0.0, []
        while at < s:
            span, after = draw.uniform(40.0, 200.0), draw.uniform(-0.06, 0.06)
            c = (after - grade) / (2.0 * span)
            heights.append(f'<elevation s="{at:.12f}" a="{z:.12f}" b="{grade:.12f}" c="{c:.12f}" d="0"/>')
            at, z, grade = at + span, z + grade * span + c * span * span, after
    right, left = int(draw.integers(1, 4)), int(draw.integers(0, 3))
    lanes = _lanes_text(draw, right, left)
    return (
        '<OpenDRIVE><header revMajor="1" revMinor="6" name="drawn" version="1"/>'
        f'<road name="drawn" length="{s:.12f}" id="1" junction="-1"><planView>{"".join(shapes)}</planView>'
        f"<elevationProfile>{''.join(heights)}</elevationProfile>"
        f'<lanes><laneSection s="0">{lanes}</laneSection></lanes></road></OpenDRIVE>'
    )


def _lanes_text(draw: np.random.Generator, right: int, left: int) -> str:
    width, line = draw.uniform(2.8, 3.9), draw.choice((0.12, 0.15, 0.2, 0.25))
    edges = ("solid", "solid", "solid", "broken", "none")
    centre = draw.choice(("broken", "broken", "solid", "solid solid", "none")) if left else "solid"
    colour = draw.choice(("white", "white", "white", "yellow"))
    shoulder = draw.uniform(0.5, 3.0) if draw.random() < 0.6 else 0.0

    def mark(kind: str, paint: str = "white") -> str:
        return f'<roadMark sOffset="0" type="{kind}" width="{line}" color="{paint}"/>'

    def side(count: int, sign: int) -> str:
        kinds = [draw.choice(("broken", "broken", "solid")) for _ in range(count - 1)] + [draw.choice(edges)]
        texts = [
            f'<lane id="{sign * (k + 1)}" type="driving" level="false"><width sOffset="0" a="{width:.12f}" b="0" c="0" '
            f'd="0"/>{mark(kind)}</lane>'
            for k, kind in enumerate(kinds)
        ]
        if shoulder:
            texts.append(
                f'<lane id="{sign * (count + 1)}" type="shoulder" level="false"><width sOffset="0" a="{shoulder:.12f}" '
                f'b="0" c="0" d="0"/>{mark("none")}</lane>'
            )
        return "".join(texts if sign < 0 else texts[::-1])

    on_left = f"<left>{side(left, 1)}</left>" if left else ""
    centre_line = f'<center><lane id="0" type="none" level="false">{mark(centre, colour)}</lane></center>'
    return f"{on_left}{centre_line}<right>{side(right, -1)}</right>"
