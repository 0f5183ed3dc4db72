"""Recordings of the server: bodies, collisions and traffic lights of each frame, in a format of our own."""

from __future__ import annotations

import contextlib
import math
import zlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgpack

from scenario_compiler.carla_server.actors import Actor, Body, Car, Walker
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.spawning import new_body
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.files import MAX_BYTES
from scenario_compiler.frames import CarlaTransform, carla_attached
from scenario_compiler.outputs import write_whole

MAGIC = "scenario-compiler recording 2"
MOST_STATES = 2_000_000
"""Greatest number of states of bodies and lights in a recording, over all frames; later ones are left out."""

BEHIND = CarlaTransform(-10.0, 0.0, 5.0, -25.0, 0.0, 0.0)
"""Transform of a spectator relative to the body that it follows (`CarlaReplayer`)."""


def file_below(folder: Path, name: str) -> Path:
    """Return the file of a recording.

    Raises:
        CallError: It is not below the served folder.
    """
    if not name or "\x00" in name:
        raise CallError("the recording has no name")
    path = (folder / name.replace("\\", "/")).resolve()
    if not path.is_relative_to(folder.resolve()) or path == folder.resolve():
        raise CallError(f"'{name}' is not below the served folder: give a name without a path")
    return path


@dataclass(eq=False)
class Recorder:
    """A recording under way.

    Attributes:
        path: File into which it is written when it ends.
        town: Name of the map.
        actors: Bodies that have been there: id to description and kind.
        frames: Frame, time, step, states (id, transform, speed, control with the gear that a vehicle is in, bits of its
            lights), collisions (ids) and traffic lights (signal, state, elapsed time, whether it is frozen). As in
            CARLA's recordings, frames are counted from 1, and times from the first frame on.
        kept: Number of states recorded so far.
        begin: Time of the first frame in the episode, s.
    """

    path: Path
    town: str
    actors: dict[int, list[Any]] = field(default_factory=dict)
    frames: list[Any] = field(default_factory=list)
    kept: int = 0
    begin: float = 0.0

    def note(self, stage: Stage, dt: float) -> None:
        """Record a frame; a recording that is too long is not continued."""
        if self.kept >= MOST_STATES:
            return
        if not self.frames:
            self.begin = stage.time
        states = []
        for body in stage.bodies():
            if body.id not in self.actors:
                self.actors[body.id] = [body.description, _kind(body)]
            speed = stage.simulation.state.v[body.place]
            states.append([body.id, list(stage.transform_of(body)), speed, *_control_of(body)])
        met = [[one.id, other.id] for one, other, _ in stage.collisions]
        lights = [
            [light.signal, light.state, light.elapsed, light.frozen] for group in stage.groups for light in group.lights
        ]
        self.kept += len(states) + len(lights) + 1
        self.frames.append([len(self.frames) + 1, stage.time - self.begin, dt, states, met, lights])

    def write(self) -> None:
        """Write it."""
        packed = msgpack.packb([MAGIC, self.town, self.actors, self.frames])
        write_whole(self.path, zlib.compress(packed))


@dataclass(frozen=True, eq=False)
class Recording:
    """A recording that is read; see `Recorder`."""

    name: str
    town: str
    actors: dict[int, list[Any]]
    frames: list[Any]

    @classmethod
    def read(cls, folder: Path, name: str) -> Recording:
        """Read an existing recording.

        Raises:
            CallError: It is not one of ours.
        """
        path = file_below(folder, name)
        try:
            unpacked = zlib.decompressobj().decompress(path.read_bytes(), MAX_BYTES)
            magic, town, actors, frames = msgpack.unpackb(unpacked, strict_map_key=False)
        except (OSError, ValueError, zlib.error, msgpack.UnpackException) as fault:
            raise CallError(f"File {name} is not a recording of this server") from fault
        if magic != MAGIC:
            raise CallError(f"File {name} is not a recording of this server")
        return cls(name, town, actors, frames)

    def info(self, every: bool) -> str:
        """Return CARLA's text on a recording: actors as they come and go, with `every` also their states by frame."""
        lines = ["Version: 1", f"Map: {self.town}", ""]
        before: dict[int, None] = {}
        for frame, time, _, states, met, _ in self.frames:
            there = {state[0]: None for state in states}
            new = [number for number in there if number not in before]
            gone = [number for number in before if number not in there]
            if new or gone or met or every:
                lines.append(f"Frame {frame} at {time:g} seconds")
            for number in new:
                (_, name, attributes), kind = self.actors[number]
                lines.append(f" Create {number}: {name} ({kind})")
                lines += [f"  {key} = {value}" for key, _, value in attributes]
            lines += [f" Destroy {number}" for number in gone]
            lines += [f" Collision between {one} and {other}" for one, other in met]
            if every:
                lines += [f"  {number}: {', '.join(f'{x:.3f}' for x in at)}" for number, at, *_ in states]
            before = there
        return "\n".join([*lines, "", self._length()])

    def collisions(self, first: str, second: str) -> str:
        """Return the collisions between two kinds of actors, in the columns of CARLA's.

        A kind is h (hero), v (vehicle), w (walker), t (traffic light), o (other) or a (any), as clients ask for them.
        """
        lines = [f"{'Time':>8}  Types     Id Actor 1                     Id Actor 2", ""]
        touching: set[tuple[int, int]] = set()
        for _, time, _, _, met, _ in self.frames:
            now = {(one, other) for one, other in met}
            for one, other in sorted(now - touching):
                kinds = [self._letter(number) for number in (one, other)]
                for (a, b), wanted in (((one, other), kinds), ((other, one), kinds[::-1])):
                    if first in ("a", wanted[0]) and second in ("a", wanted[1]):
                        names = [self._name(number) for number in (a, b)]
                        lines.append(f"{time:8.1f}  {wanted[0]} {wanted[1]}   {a:>6} {names[0]:<28} {b:>6} {names[1]}")
                        break
            touching = now
        return "\n".join([*lines, "", self._length()])

    def blocked(self, least_time: float, least_distance: float) -> str:
        """Return each stop of an actor, in CARLA's columns, the longest first (`CarlaRecorderQuery::QueryBlocked`).

        Args:
            least_time: Least duration of a stop, s.
            least_distance: Distance from where the actor stopped at which the stop is over, cm.
        """
        lines = [f"{'Time':>8}      Id Actor                                Duration", ""]
        places: dict[int, list[float]] = {}
        stops: dict[int, tuple[float, float]] = {}
        found: list[tuple[float, float, int]] = []
        for _, time, dt, states, *_ in self.frames:
            for number, at, *_ in states:
                if number in places and 100.0 * math.dist(at[:3], places[number]) < least_distance:
                    begin, lasted = stops.get(number, (time, 0.0))
                    stops[number] = (begin, lasted + dt)
                    continue
                places[number] = at[:3]
                if number in stops:
                    found.append((*stops.pop(number), number))
        found += [(*stop, number) for number, stop in stops.items()]
        for begin, lasted, number in sorted(found, key=lambda one: -one[1]):
            if lasted >= least_time:
                lines.append(f"{begin:8.1f}  {number:>6} {self._name(number):<36} {lasted:8.1f}")
        return "\n".join([*lines, "", self._length()])

    def _length(self) -> str:
        last = self.frames[-1] if self.frames else [0, 0.0]
        return f"Frames: {len(self.frames)}\nDuration: {last[1]:g} seconds"

    def _name(self, number: int) -> str:
        name: str = self.actors[number][0][1]
        return name

    def is_hero(self, number: int) -> bool:
        """Return whether a body's role is that of a hero."""
        _, _, attributes = self.actors[number][0]
        return ["role_name", "hero"] in [[one[0], one[2]] for one in attributes]

    def _letter(self, number: int) -> str:
        return "h" if self.is_hero(number) else str(self.actors[number][1][:1])


@dataclass(frozen=True)
class Played:
    """Settings for playing recordings, which clients make before or while they play one.

    Attributes:
        pace: Seconds of the recording in a second.
        without_hero: Whether heroes are left where they are.
    """

    pace: float = 1.0
    without_hero: bool = False


@dataclass(eq=False)
class Replay:
    """A recording that is played: its bodies and the map's traffic lights get their recorded states frame by frame.

    As in CARLA (`CarlaReplayerHelper`, `FActorRegistry::Register`), a body that is still there, with its id and of its
    blueprint, is used again, another one is spawned with its old id, or with a new one if somebody else has that. A
    body is removed where it was destroyed in the recording.

    Attributes:
        recording: The recording.
        at: Place of the present frame.
        time: Time in the recording, s.
        end: Time at which it ends, s.
        followed: Id of the body that the spectator follows, 0 for none.
        offset: The spectator's place relative to that body.
        ids: The id of each of its bodies now.
    """

    recording: Recording
    at: int
    time: float
    end: float
    followed: int = 0
    offset: CarlaTransform = BEHIND
    ids: dict[int, int] = field(default_factory=dict)

    def play(self, stage: Stage, dt: float, played: Played) -> bool:
        """Go on by a step and show the frame of that time; return False if the recording is over."""
        frames, place = self.recording.frames, self.at
        self.time += dt * played.pace
        while place < len(frames) and frames[place][1] < self.time - 1e-6:
            place += 1
        self._go_to(stage, place, played)
        if place >= len(frames) or self.time > self.end + 1e-6:
            return False
        for number, at, speed, control, lamps in frames[place][3]:
            body = stage.actors.get(self.ids.get(number, 0))
            if isinstance(body, Body) and not self._leaves_out(number, played):
                self._show(stage, body, CarlaTransform(*at), speed)
                if isinstance(body, Car):
                    body.control, body.gear, body.ackermann, body.lights = control, control[6], None, lamps
                elif isinstance(body, Walker):
                    body.control = [*control[:2], False]  # its height is recorded
        lights = {light.signal: light for group in stage.groups for light in group.lights}
        for signal, state, elapsed, frozen in frames[place][5]:
            light = lights.get(signal)
            if light is not None:
                light.state, light.elapsed, light.frozen = state, elapsed, frozen
        followed = stage.actors.get(self.ids.get(self.followed, 0))
        if followed is not None:
            self._put(stage, stage.spectator, carla_attached(stage.transform_of(followed), self.offset))
        return True

    def stop(self, stage: Stage, played: Played) -> None:
        """End it as CARLA does: bodies come and go as in its rest, and vehicles can be driven again."""
        self._go_to(stage, len(self.recording.frames), played)
        self.finish(stage)

    def finish(self, stage: Stage) -> None:
        """Let physics move its vehicles again, and its walkers stand."""
        for number in self.ids.values():
            body = stage.actors.get(number)
            if isinstance(body, Car):
                body.control, body.gear = [0.0, 0.0, 0.0, False, False, False, 0], 1
                stage.driving.command(body)
                stage.let_simulate(body, True)
            elif isinstance(body, Walker):
                body.control = [body.control[0], 0.0, False]
                stage.simulation.let_pose(body.place, posed=not body.simulates)
                stage.driving.walk(body)

    def _go_to(self, stage: Stage, place: int, played: Played) -> None:
        """Spawn and remove bodies as in the frames up to a place; beyond the last frame, up to that."""
        passed = self.recording.frames[self.at : place + 1]
        if not passed:
            return
        self.at = place
        there = {number: CarlaTransform(*at) for number, at, *_ in passed[-1][3]}
        seen = {*self.ids, *(state[0] for frame in passed for state in frame[3])}
        for number in sorted(seen - there.keys()):
            body = self._found(stage, number)
            self.ids.pop(number, None)
            if body is not None and not self._leaves_out(number, played):
                stage.destroy(body.id)
        for number, at in there.items():
            if number not in self.ids and not self._leaves_out(number, played):
                self._appear(stage, number, at)

    def _appear(self, stage: Stage, number: int, at: CarlaTransform) -> None:
        """Find or spawn the body of a recorded id, if there is room for it."""
        body = self._found(stage, number)
        if body is None:
            description, _ = self.recording.actors[number]
            try:
                body = stage.add_body(new_body(stage.version, description, at), number)
            except CallError:
                return
        self.ids[number] = body.id

    def _found(self, stage: Stage, number: int) -> Body | None:
        """Return the body of a recorded id; None if there is none of its blueprint."""
        body = stage.actors.get(self.ids.get(number, number))
        (_, name, _), _ = self.recording.actors[number]
        return body if isinstance(body, Body) and body.blueprint.name == name else None

    def _leaves_out(self, number: int, played: Played) -> bool:
        return played.without_hero and self.recording.is_hero(number)

    def _show(self, stage: Stage, body: Body, at: CarlaTransform, speed: float) -> None:
        """Put a body where it was, at its speed; one that is attached goes along with its carrier."""
        if body.parent in stage.actors:
            return
        if isinstance(body, Car):
            stage.let_simulate(body, False)
        elif isinstance(body, Walker):
            stage.simulation.let_pose(body.place, posed=True)
        self._put(stage, body, at)
        stage.driving.set_speed(body, speed)

    def _put(self, stage: Stage, actor: Actor, at: CarlaTransform) -> None:
        """Put an actor at a transform; it stays where it is if that is too far away."""
        with contextlib.suppress(CallError):
            stage.put(actor, at)


def _kind(body: Body) -> str:
    return "vehicle" if isinstance(body, Car) else "walker" if isinstance(body, Walker) else "other"


def _control_of(body: Body) -> tuple[list[Any], int]:
    """Return the control of a body and the bits of its lights, as recordings have them."""
    if isinstance(body, Car):
        return [*body.control[:6], body.gear], body.lights
    return body.control if isinstance(body, Walker) else [], 0
