"""The server's state that outlives a map (clock, settings, weather, listeners), and the work of a tick."""

from __future__ import annotations

import asyncio
import math
import struct
import time
import traceback
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgpack

from scenario_compiler.carla_server.actors import Actor, Car, Sensor
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.recorder import Played, Recorder, Replay
from scenario_compiler.carla_server.sensors.instrument import Instrument
from scenario_compiler.carla_server.snapshot import HEADER, LIGHTS_CHANGED, MAP_CHANGED, SENSORS
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.towns import Town, load_town
from scenario_compiler.carla_server.transport import Streams
from scenario_compiler.vocabulary.weather import WEATHER_PRESETS, Weather

SNAPSHOTS = 1
"""Number of the stream of snapshots."""

TOKEN = struct.Struct("<IHBB16x")
"""Stream, port, protocol (1 is TCP), and kind of address (0: that of the calls)."""

FREE_STEP = 0.05
"""Time step in asynchronous mode where none is fixed, s."""

LONGEST_STEP = 10.0
"""Longest time step, s."""

ANNOUNCED = 0.3
DRAINED = 1.0
PREPARED = 60.0
"""Longest time for which a tick waits for a listener that will connect next, for one that is behind, and for cameras
to be ready, s: a camera that is heard sends a picture of every tick, however busy the machine is.
"""

JOINING = 1.0
"""Longest time for which a new episode waits until the client that has loaded it joins the snapshots' stream again, s.

A client leaves that stream when its call to load a map is answered, asks for the episode and joins it again. Only then
may it see the new episode's first snapshot, as with CARLA's own worlds, which take long to load: on it, the client's
Traffic Manager starts again, and its process ends where it has no episode at that time (`Simulator::LoadEpisode`,
`TrafficManagerLocal::Reset`).
"""

SETTLING = 0.001
"""Least time from a Traffic Manager's call for the settings to the next tick, s.

It asks in its own thread at the end of each step and then waits to be woken for the next one; LibCarla's
`TrafficManagerLocal::SynchronousTick` wakes it without holding the lock under which it waits, so that a tick which
comes just then is missed, and the client waits for ever. CARLA's own ticks take longer than that.
"""

HELD = 0.5
SEEN = 2
"""Longest time for which a vehicle that a client destroys in asynchronous mode waits until a Traffic Manager is between
two of its steps, s; and the number of snapshots after which the Traffic Manager may go on.

A client forgets a vehicle when the call is answered; its Traffic Manager, which is in the middle of a step with that
vehicle, ends the process then. It asks for the settings at the beginning of each step (`TrafficManagerLocal::Run`), and
is held there until the client has the next snapshot, which lacks the vehicle: until the one after that is sent. In
synchronous mode it is not held.
"""

PERCENT = (
    *("cloudiness", "precipitation", "precipitation_deposits", "wind_intensity", "fog_density", "wetness"),
    "dust_storm",
)
"""Numbers of a weather that are percentages; others are as a client has given them."""


def described(fault: Exception) -> str:
    """Return where a fault of ours has happened, and its text, for the log."""
    where = traceback.extract_tb(fault.__traceback__)[-1]
    return f"at {Path(where.filename).name}:{where.lineno}: {type(fault).__name__}: {str(fault)[:200]}"


def sky_of(numbers: Sequence[float]) -> Weather:
    """Return the weather of CARLA's 14 numbers; -1 leaves one to the map, percentages stay from 0 to 100."""
    names = [name for name in Weather.model_fields if name not in ("word", "preset")]
    given = dict(zip(names, numbers, strict=True))
    for name in PERCENT:
        value = given[name]
        given[name] = -1.0 if value == -1.0 and name != "dust_storm" else min(max(value, 0.0), 100.0)
    return Weather.model_validate(given)


@dataclass
class Settings:
    """The settings of an episode, in the order of the wire. Only `synchronous` and `step` have an effect here.

    Attributes:
        synchronous: Whether clients ask for each tick.
        no_rendering: CARLA's `no_rendering_mode`.
        step: Length of a time step, s; None if it is not fixed.
        substepping: Whether CARLA's physics divides a step.
        substep: Longest part of a divided step, s.
        substeps: Greatest number of its parts.
        culling: CARLA's `max_culling_distance`; 0 for none.
        ragdolls: CARLA's `deterministic_ragdolls`.
        tiles: Distance from the ego vehicle up to which CARLA loads tiles of large maps, m.
        active: Distance from the ego vehicle up to which actors are active on CARLA's large maps, m.
        spectator_as_ego: Whether tiles are also loaded around the spectator.
    """

    synchronous: bool = False
    no_rendering: bool = False
    step: float | None = None
    substepping: bool = True
    substep: float = 0.01
    substeps: int = 10
    culling: float = 0.0
    ragdolls: bool = True
    tiles: float = 3000.0
    active: float = 2000.0
    spectator_as_ego: bool = True

    def on_wire(self) -> list[Any]:
        """Return them in the layout of the wire."""
        step = [False] if self.step is None else [True, self.step]
        return [
            *(self.synchronous, self.no_rendering, step, self.substepping, self.substep, self.substeps, self.culling),
            *(self.ragdolls, self.tiles, self.active, self.spectator_as_ego),
        ]

    @classmethod
    def of(cls, wire: Sequence[Any]) -> Settings:
        """Read them from the wire.

        Raises:
            CallError: The time step is out of bounds.
        """
        step = wire[2][1] if wire[2][0] else 0.0
        if not 0.0 <= step <= LONGEST_STEP:
            raise CallError(f"fixed_delta_seconds is {step:g}: 0 to {LONGEST_STEP:g} s can be served")
        return cls(wire[0], wire[1], step if step > 0.0 else None, *wire[3:])


@dataclass(eq=False)
class Work:
    """A sensor at work: its instrument, and the task that prepares it."""

    instrument: Instrument
    ready: asyncio.Future[None]


@dataclass(eq=False)
class Host:
    """The state of the server.

    Attributes:
        version: Version of CARLA whose protocol is spoken.
        folders: Folders in which maps are looked for first.
        files: Folder of recordings.
        port: Port of the streams.
        log: Called with each line of the server's log.
        stage: The actors on the present map.
        streams: The streams and their listeners.
        settings: The settings of the episode.
        weather: The weather as CARLA's 14 numbers, as a client gave them: percentages, degrees and m, in the order of
            `carla.WeatherParameters`.
        sky: The same weather, as cameras draw it.
        episode: Number of the episode; each map that is loaded begins another one.
        frame: Number of the last snapshot.
        managers: Addresses (host, port) of Traffic Managers, by their ports.
        generated: The OpenDRIVE text from which a client generates a world; empty for none.
        recorder: The recording under way, or None.
        replay: The recording that is played, or None.
        played: How recordings are played.
        told: Lines that are logged only once and have been.
        beginning: Waits until the episode begins that a client has loaded; None if none is about to begin.
        gate: Opens when Traffic Managers that are held may go on; None if none is held.
    """

    version: str
    folders: tuple[Path, ...]
    files: Path
    port: int
    log: Callable[[str], None]
    stage: Stage
    streams: Streams = field(init=False)
    settings: Settings = field(default_factory=Settings)
    weather: tuple[float, ...] = WEATHER_PRESETS["ClearNoon"]
    sky: Weather = field(default_factory=lambda: sky_of(WEATHER_PRESETS["ClearNoon"]))
    episode: int = 1
    frame: int = 1
    managers: dict[int, list[Any]] = field(default_factory=dict)
    generated: str = ""
    recorder: Recorder | None = None
    replay: Replay | None = None
    played: Played = field(default_factory=Played)
    told: set[str] = field(default_factory=set)
    beginning: asyncio.Future[None] | None = None
    gate: asyncio.Event | None = None
    _work: dict[int, Work] = field(default_factory=dict)
    _bits: int = 0
    _free: asyncio.Event = field(default_factory=asyncio.Event)
    _began: float = 0.0
    _asked: float = -math.inf
    _held: bool = False
    _held_for: int = 0

    def __post_init__(self) -> None:
        self.streams = Streams(self.knows, self.log)
        self._free.set()

    def knows(self, number: int) -> bool:
        """Return whether there is a stream with a number."""
        return number == SNAPSHOTS or isinstance(self.stage.actors.get(number), Sensor)

    def once(self, text: str) -> None:
        """Log a line unless it has been logged before."""
        if text not in self.told and len(self.told) < 1000:
            self.told.add(text)
            self.log(text)

    def token(self, number: int) -> bytes:
        """Return the token of a stream."""
        return TOKEN.pack(number, self.port, 1, 0)

    def wire(self, actor: Actor) -> list[Any]:
        """Return an actor in the layout of the wire."""
        found = self.stage.wire(actor)
        if actor.stream:
            found[5] = self.token(actor.stream)
        return found

    def employ(self, sensor: Sensor, instrument: Instrument) -> None:
        """Start an instrument; a thread prepares what takes long."""
        self._work[sensor.id] = Work(instrument, asyncio.ensure_future(asyncio.to_thread(instrument.prepare)))

    def dismiss(self, number: int) -> None:
        """End a sensor's stream and its measurements."""
        self._work.pop(number, None)
        self.streams.close(number)

    @property
    def step_length(self) -> float:
        """Length of the next time step, s."""
        return FREE_STEP if self.settings.step is None else self.settings.step

    def change_settings(self, settings: Settings) -> int:
        """Apply settings; in asynchronous mode they hold from the next snapshot on, which is made at once."""
        self.settings = settings
        if settings.synchronous:
            self._let_managers_go()
            self._free.clear()
            return self.frame
        self._free.set()
        return self.tick()

    def finish_recording(self) -> None:
        """End the recording under way, if there is one, and write it; the log says if that is not possible."""
        recorder, self.recorder = self.recorder, None
        if recorder is not None:
            try:
                recorder.write()
            except OSError as fault:
                self.log(f"the recording {recorder.path.name} cannot be written: {fault.strerror}")

    def change_town(self, town: Town, *, reset: bool) -> None:
        """Begin a new episode on a map.

        Its actors have other ids than those of the episodes before, as in CARLA (`FActorRegistry::ID_COUNTER`): clients
        keep what they know of an id.

        Its first snapshot says that the map has changed, as CARLA's does: before, a client of 0.9.15 has the old one.
        """
        for number in list(self._work):
            self.dismiss(number)
        before, self.stage = self.stage, Stage(town, self.version, self.stage.next_id)
        self.stage.remember(before)
        self.episode += 1
        self.finish_recording()
        self.replay = None
        if reset:
            self.settings = Settings()
            self._free.set()
        self._bits |= MAP_CHANGED
        asyncio.get_running_loop().run_in_executor(None, town.prepare)
        self.tick()
        self._let_managers_go()

    def change_town_when_joined(self, town: Town, *, reset: bool) -> None:
        """Begin a new episode on a map as soon as the client that asked for it listens to the snapshots again."""
        self.beginning = asyncio.ensure_future(self._change_later(town, reset))

    async def _change_later(self, town: Town, reset: bool) -> None:
        try:
            if self.streams.heard(SNAPSHOTS):
                await self.streams.wait_for_another(SNAPSHOTS, JOINING)
            self.change_town(town, reset=reset)
        finally:
            self.beginning = None

    async def load(self, name: str) -> Town:
        """Load a map in a thread; an empty name is the present one."""
        return self.stage.town if not name else await asyncio.to_thread(load_town, name, self.folders)

    def note_question(self) -> None:
        """Note that a client has asked for the settings."""
        self._asked = time.monotonic()
        self._held = True

    async def hold_managers(self) -> None:
        """Wait until a Traffic Manager is between two of its steps, where it stays for two snapshots."""
        loop = asyncio.get_running_loop()
        end = loop.time() + HELD
        if self.gate is None:
            self.gate = asyncio.Event()
            self._held = False
        self._held_for = SEEN
        while not self._held and loop.time() < end:
            await asyncio.sleep(0.001)
            self._held_for = SEEN
        self._held = True

    def _let_managers_go(self) -> None:
        if self.gate is not None:
            self.gate.set()
            self.gate = None

    def note_lights(self) -> None:
        """Let the next snapshot say that lights have changed."""
        self._bits |= LIGHTS_CHANGED

    def cue(self) -> int | Awaitable[int]:
        """Do a tick for a client, after waiting for clients that join a stream, for cameras and for slow listeners."""
        busy = any(not work.ready.done() for number, work in self._work.items() if self.streams.heard(number))
        settles = self.managers and time.monotonic() < self._asked + SETTLING
        if self.streams.announced or busy or self.streams.behind or settles:
            return self._patiently()
        return self.tick()

    async def _patiently(self) -> int:
        await self.streams.wait_for_announced(ANNOUNCED)
        waiting = [work.ready for number, work in self._work.items() if self.streams.heard(number)]
        if waiting:
            await asyncio.wait(waiting, timeout=PREPARED)
        if self.managers:
            await asyncio.sleep(max(self._asked + SETTLING - time.monotonic(), 0.0))
        loop = asyncio.get_running_loop()
        end = loop.time() + DRAINED
        while self.streams.behind and loop.time() < end:
            await asyncio.sleep(0.001)
        return self.tick()

    async def run_freely(self) -> None:
        """Tick in real time for as long as the mode is asynchronous."""
        loop = asyncio.get_running_loop()
        self._began = loop.time()
        due = loop.time()
        while True:
            await self._free.wait()
            due = max(due + self.step_length, loop.time() - self.step_length)
            await asyncio.sleep(max(due - loop.time(), 0.001))
            if not self.settings.synchronous and self.beginning is None:
                try:
                    self.tick()
                except Exception as fault:  # a fault of ours does not stop the clock
                    self.once(f"a tick failed {described(fault)}")

    def tick(self) -> int:
        """Step the world and send the snapshot to all listeners; return the number of the frame."""
        dt = self.step_length
        if self.replay is not None and not self.replay.play(self.stage, dt, self.played):
            self.replay.finish(self.stage)
            self.replay = None
        self.stage.step(dt, switches=self.replay is None)
        self.frame += 1
        if self.recorder is not None:
            self.recorder.note(self.stage, dt)
        for car in self.stage.bodies():
            if isinstance(car, Car) and not car.sticky:
                car.control = [0.0, 0.0, 0.0, False, False, False, 0]
                self.stage.driving.command(car)
        self._send(dt)
        self._held_for -= 1
        if self._held_for <= 0:
            self._let_managers_go()
        return self.frame

    def _send(self, dt: float) -> None:
        if self.streams.heard(SNAPSHOTS):
            platform = asyncio.get_running_loop().time() - self._began
            message = self.stage.measured.rows.message(
                self.version, self.frame, self.stage.time, self.episode, platform, dt, self._bits
            )
            self.streams.send(SNAPSHOTS, message)
            self._bits = 0
        for number, work in list(self._work.items()):
            if self.streams.heard(number) and work.ready.done():
                try:
                    self._measure(number, work, dt)
                except Exception as fault:  # a fault of ours stops this sensor only
                    del self._work[number]
                    name = self.stage.actors[number].blueprint.name
                    self.log(f"sensor {number} ({name}) is stopped: it failed {described(fault)}")
        self._tell_collisions()

    def _measure(self, number: int, work: Work, dt: float) -> None:
        sensor = self.stage.actors[number]
        assert isinstance(sensor, Sensor)
        every = sensor.number("sensor_tick")
        if every > 0.0:
            if self.stage.time < sensor.due - 1e-6:
                return
            late = sensor.due < self.stage.time - every
            sensor.due = self.stage.time + every if late else sensor.due + every
        work.ready.result()
        body = work.instrument.measure(self.stage, sensor, self.frame, dt, self.sky)
        sensor.measured += 1
        if body is not None:
            self.streams.send(number, self._head(sensor) + body)

    def _head(self, sensor: Sensor) -> bytes:
        kind = SENSORS.index(sensor.blueprint.name.rpartition(".")[2])
        return HEADER.pack(kind, self.frame, self.stage.time, *self.stage.transform_of(sensor))

    def _tell_collisions(self) -> None:
        for one, other, impulse in self.stage.collisions:
            for body, met, sign in ((one, other, 1.0), (other, one, -1.0)):
                for number in body.children:
                    sensor = self.stage.actors.get(number)
                    if not isinstance(sensor, Sensor) or sensor.blueprint.name != "sensor.other.collision":
                        continue
                    pushed = [sign * value for value in impulse]
                    packed = msgpack.packb([self.wire(body), self.wire(met), pushed], use_single_float=True)
                    self.streams.send(number, self._head(sensor) + packed)
