"""Recordings of the server: actors, poses and collisions of each frame, in a format of our own."""

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

MAGIC = "scenario-compiler recording 1"
MOST_STATES = 2_000_000
"""Greatest number of states of bodies in a recording, over all frames; later ones are left out."""

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
        frames: Frame, time, step, states (id, transform, speed) and collisions (ids). As in CARLA's recordings, frames
            are counted from 1, and times from the first frame on.
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
            states.append([body.id, list(stage.transform_of(body)), stage.simulation.state.v[body.place]])
        met = [[one.id, other.id] for one, other, _ in stage.collisions]
        self.kept += len(states) + 1
        self.frames.append([len(self.frames) + 1, stage.time - self.begin, dt, states, met])

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
        """Return CARLA's text on a recording: the actors as they appear, with `every` also their states by frame."""
        lines = ["Version: 1", f"Map: {self.town}", ""]
        known: set[int] = set()
        for frame, time, _, states, met in self.frames:
            new = [state[0] for state in states if state[0] not in known]
            if new or met or every:
                lines.append(f"Frame {frame} at {time:g} seconds")
            for number in new:
                (_, name, attributes), kind = self.actors[number]
                lines.append(f" Create {number}: {name} ({kind})")
                lines += [f"  {key} = {value}" for key, _, value in attributes]
            known.update(new)
            lines += [f" Collision between {one} and {other}" for one, other in met]
            if every:
                lines += [f"  {number}: {', '.join(f'{x:.3f}' for x in at)}" for number, at, _ in states]
        return "\n".join([*lines, "", self._length()])

    def collisions(self, first: str, second: str) -> str:
        """Return the collisions between two kinds of actors, in the columns of CARLA's.

        A kind is h (hero), v (vehicle), w (walker), t (traffic light), o (other) or a (any), as clients ask for them.
        """
        lines = [f"{'Time':>8}  Types     Id Actor 1                     Id Actor 2", ""]
        touching: set[tuple[int, int]] = set()
        for _, time, _, _, met in self.frames:
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
    """A recording that is played: its bodies are posed frame by frame.

    As in CARLA (`CarlaReplayerHelper`, `FActorRegistry::Register`), a body that is still there, with its id and of its
    blueprint, is used again, another one is spawned with its old id, or with a new one if somebody else has that.

    Attributes:
        recording: The recording.
        at: Place of the next frame.
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

    def pose(self, stage: Stage, version: str, dt: float, played: Played) -> bool:
        """Put its bodies at their recorded places; return False if it is over."""
        frames = self.recording.frames
        self.time += dt * played.pace
        while self.at < len(frames) and frames[self.at][1] < self.time - 1e-6:
            self.at += 1
        if self.at >= len(frames) or self.time > self.end:
            return False
        for number, at, speed in frames[self.at][3]:
            body = self._body(stage, version, number, CarlaTransform(*at))
            if body is None or (played.without_hero and self.recording.is_hero(number)):
                continue
            self._put(stage, body, CarlaTransform(*at))
            stage.driving.set_speed(body, speed)
            if isinstance(body, Car):
                stage.let_simulate(body, False)
        followed = stage.actors.get(self.ids.get(self.followed, 0))
        if followed is not None:
            self._put(stage, stage.spectator, carla_attached(stage.transform_of(followed), self.offset))
        return True

    def _put(self, stage: Stage, actor: Actor, at: CarlaTransform) -> None:
        """Put an actor at a transform; it stays where it is if that is too far away."""
        with contextlib.suppress(CallError):
            stage.put(actor, at)

    def _body(self, stage: Stage, version: str, number: int, at: CarlaTransform) -> Body | None:
        """Return the body of a recorded id, spawned if necessary; None if there is no room for it."""
        found = stage.actors.get(self.ids.get(number, number))
        description, _ = self.recording.actors[number]
        if not isinstance(found, Body) or found.blueprint.name != description[1]:
            try:
                found = stage.add_body(new_body(version, description, at), number)
            except CallError:
                return None
        self.ids[number] = found.id
        return found

    def finish(self, stage: Stage) -> None:
        """Let physics move its vehicles again, and its walkers stand."""
        for number in self.ids.values():
            body = stage.actors.get(number)
            if isinstance(body, Car):
                body.control = [0.0, 0.0, 0.0, False, False, False, 0]
                stage.driving.command(body)
                stage.let_simulate(body, True)
            elif isinstance(body, Walker):
                body.control = [body.control[0], 0.0, False]
                stage.driving.walk(body)


def _kind(body: Body) -> str:
    return "vehicle" if isinstance(body, Car) else "walker" if isinstance(body, Walker) else "other"
