"""Draws first-person pictures of a recorded run, at any time, from the rows of the recording.

All poses are those of the recording. Facts that a recording does not contain (changing weather, the states of traffic
signals, invisible entities) come from the engine, which executes the run again with the first vehicle at its recorded
poses.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from scenario_compiler.engine.columns import opcodes as op
from scenario_compiler.engine.columns.state import State, make_draws
from scenario_compiler.engine.program.build import Lowered, lowered
from scenario_compiler.engine.simulation import Simulation
from scenario_compiler.plan.painted import lines_beside
from scenario_compiler.recording.names import TAKEOVER_STATES
from scenario_compiler.report.blocked import Blocks, blocks_of
from scenario_compiler.report.replay import Picture, starts_of
from scenario_compiler.report.run import Run
from scenario_compiler.roads.positions import Pose
from scenario_compiler.runtime.snapshot import BRAKE_LIGHTS
from scenario_compiler.vocabulary.weather import Weather, weather_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from scenario_compiler.perception.camera import Camera
    from scenario_compiler.perception.overlay import Caption
    from scenario_compiler.perception.road_camera import RoadCamera
    from scenario_compiler.perception.stage import Stage

PER_SECOND = 5.0
"""Number of pictures for each second of the run, in a page."""

DOWN = math.radians(-60.0)
"""Pitch below which a camera looks down onto its own vehicle, rad."""


def camera_pictures(run: Run, per_second: float = PER_SECOND, *, width: int = 640) -> tuple[Picture, ...]:
    """Draw pictures of a run for a page, at regular times and at its moments; WebP, without texts."""
    from scenario_compiler.perception.overlay import encode_webp

    recording = run.recording
    labels = {row_at(run, t): "" for t in even_times(run, per_second)} | {
        row_at(run, t): kind for kind, t in run.moments
    }
    sights = Sights(run, width)
    drawn = ((still.row, sights.draw(still)) for still in stills(run, labels))
    return tuple(
        Picture(float(recording.t[row]), labels[row], "image/webp", encode_webp(image)) for row, image in drawn
    )


def even_times(run: Run, per_second: float) -> list[float]:
    """Return regular times of a run, s, from its first row to its last at most."""
    begin, end = float(run.recording.t[0]), float(run.recording.t[-1])
    return [begin + k / per_second for k in range(math.floor((end - begin) * per_second + 1e-6) + 1)]


def row_at(run: Run, t: float) -> int:
    """Return the last row that is not after a time; the first one for times before the run."""
    times = run.recording.t
    return max(0, int((times <= t + 1e-6).sum()) - 1)


@dataclass(frozen=True, slots=True)
class Still:
    """A row of a recording, for a picture.

    Attributes:
        row: Its number.
        there: For each visible entity its number, the pose of its reference point, and whether it brakes.
        weather: The weather.
        signals: State of each traffic signal that the scenario names, empty if unknown.
    """

    row: int
    there: Sequence[tuple[int, Pose, bool]]
    weather: Weather
    signals: Mapping[str, str]


class Sights:
    """The driver's view of a recorded run, with an outline of what blocks the path."""

    def __init__(self, run: Run, width: int = 960, fov: float | None = None) -> None:
        """Prepare pictures with a width, pixels, half as high, and a field of view, rad; None for the driver's."""
        from scenario_compiler.perception.overlay import DRIVER

        self._run = run
        self._camera: Camera = replace(DRIVER, width=width, height=width // 2, fov=DRIVER.fov if fov is None else fov)
        self._blocks: Blocks = blocks_of(run)
        self._stage: Stage | None = None
        self._cameras: dict[Camera, RoadCamera] = {}

    def draw(self, still: Still, *, caption: bool = False, labelled: bool = True) -> NDArray[np.uint8]:
        """Return the driver's view of a row, (width / 2, width, 3) uint8, BGR.

        Args:
            still: The row, as from `stills`; the first vehicle must be present.
            caption: Whether to write state, speed and messages.
            labelled: Whether to write a text beside what blocks the path.
        """
        from scenario_compiler.perception.overlay import annotate

        image = self.draw_from(still, self._camera, labelled=labelled)
        if caption:
            annotate(image, self._caption(still.row))
        return image

    def draw_from(self, still: Still, camera: Camera, *, labelled: bool = True) -> NDArray[np.uint8]:
        """Return the view of any camera on the first vehicle; that vehicle is outlined if the camera sees it."""
        from scenario_compiler.perception.overlay import RED, WHITE, outline_box, write_above

        poses = {number: pose for number, pose, _ in still.there}
        stage, viewer = self._stage_of(), self._viewer(camera)
        boxes = stage.boxes(one for one in still.there if one[0] > 0)
        image = viewer.frame(poses[0], boxes, still.weather, 0.0, still.row, still.signals)
        entities, blocker = self._run.plan.entities, int(self._blocks.by[still.row])
        view = camera.view(poses[0], entities[0].vehicle.center)
        for i, colour in ((0, WHITE), (blocker, RED)):
            if i not in poses or (i == 0 and camera.pitch > DOWN):
                continue
            vehicle = entities[i].vehicle
            box = (vehicle.length, vehicle.width, vehicle.height, vehicle.center)
            outline = outline_box(image, view, poses[i], box, colour)
            if outline is not None and i == blocker and labelled:
                apart = float(self._run.recording.blocked_distance[still.row])
                write_above(image, outline, f"blocks the path, {apart:.0f} m", colour)
        return image

    def _stage_of(self) -> Stage:
        from scenario_compiler.perception.stage import Stage

        if self._stage is None:
            run = self._run
            self._stage = Stage(run.plan, run.network, lines_beside(run.plan, run.network, starts_of(run.recording)))
        return self._stage

    def _viewer(self, camera: Camera) -> RoadCamera:
        from scenario_compiler.perception.road_camera import RoadCamera

        if camera not in self._cameras:
            seed, center = self._run.recording.header.seed, self._run.plan.ego.vehicle.center
            self._cameras[camera] = RoadCamera(self._stage_of().scene, camera, seed, center)
        return self._cameras[camera]

    def _caption(self, row: int) -> Caption:
        from scenario_compiler.perception.overlay import Caption

        recording, plan = self._run.recording, self._run.plan
        t = float(recording.t[row])
        notes = []
        if plan.controller is not None:
            left, right = float(recording.confidence_left[row]), float(recording.confidence_right[row])
            notes.append(f"confidence left {left:.2f}   right {right:.2f}")
        state = "" if plan.controller is None else TAKEOVER_STATES[int(recording.takeover_state[row])]
        texts = said_at(run=self._run, t=t)
        warns = state in ("automated", "warning")
        return Caption(
            time=t,
            speed=float(recording.v[row, 0]),
            state=state,
            notes=notes,
            warnings=texts if warns else (),
            alarms=() if warns else texts,
        )


def said_at(run: Run, t: float) -> list[str]:
    """Return the messages to the driver at a time: those that have begun and whose reason has not ended."""
    shown: dict[tuple[str, str], None] = {}
    for event in run.recording.events:
        if event.t <= t + 1e-6 and event.kind == "message":
            shown[event.cause, event.message] = None
        elif event.t <= t + 1e-6 and event.kind == "message_over":
            shown.pop((event.cause, event.message), None)
    return list(dict.fromkeys(text for _, text in shown if text))[-1:]


def stills(run: Run, rows: Iterable[int]) -> Iterator[Still]:
    """Yield rows of a recording for pictures, in ascending order."""
    wanted = sorted(set(rows))
    plan, recording = run.plan, run.recording
    program = lowered(plan, run.network, posed=plan.controller is not None)
    simulation = Simulation(run.network.tables, program.program)
    simulation.reset(make_draws(recording.header.seed, recording.header.variant))
    row = 0
    for target in wanted:
        while row < target:
            row += 1
            _follow(simulation, run, row)
        yield _still(simulation.state, program, run, row)


def _follow(simulation: Simulation, run: Run, row: int) -> None:
    """Advance the engine to a row, with the first vehicle and its camera's results from the recording."""
    st, recording = simulation.state, run.recording
    if run.plan.controller is not None:
        st.conf_left[0] = float(recording.confidence_left[row])
        st.conf_right[0] = float(recording.confidence_right[row])
        st.health[0] = float(recording.sensor_health[row])
    if not simulation.begin():
        return
    simulation.move()
    if run.plan.controller is not None and recording.present[row, 0]:
        for column in ("x", "y", "z", "h", "pitch", "roll", "v", "steer", "throttle", "brake"):
            getattr(st, column)[0] = float(getattr(recording, column)[row, 0])
    simulation.end()


def _still(st: State, program: Lowered, run: Run, row: int) -> Still:
    """Return the data of a row for pictures: poses from the recording, everything else from the engine."""
    recording, there = run.recording, []
    for i in range(len(run.plan.entities)):
        visible = st.present[i] == 0 or st.visible[i] & op.SEEN_IN_PICTURES != 0
        if recording.present[row, i] and visible:
            x, y, z, h, pitch, roll, brake, a = (
                _number(float(getattr(recording, column)[row, i]))
                for column in ("x", "y", "z", "h", "pitch", "roll", "brake", "a")
            )
            there.append((i, Pose(x, y, z, h, pitch, roll), brake > 0.0 or a < -BRAKE_LIGHTS))
    changes = program.program.weather_count[0] > 1
    signals = zip(program.signals, st.signal_state, strict=True)
    return Still(
        row,
        there,
        weather_of(st.weather) if changes else run.plan.weather,
        {name: program.texts[state] if state >= 0 else "" for name, state in signals},
    )


def _number(value: float) -> float:
    """Return 0 for a value that a recording lacks, such as one made from a trajectory."""
    return 0.0 if math.isnan(value) else value
