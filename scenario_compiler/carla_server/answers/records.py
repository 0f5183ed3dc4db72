"""Calls about recordings."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from scenario_compiler.carla_server.actors import transform_of
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.recorder import BEHIND, Recorder, Recording, Replay, file_below

FASTEST_PACE = 100.0
"""Greatest pace at which a recording is played, as a multiple of its own."""


def start(host: Host, name: str, additional: bool) -> str:
    """Begin to record.

    Raises:
        CallError: There is no folder for the file, or nothing can be written into it.
    """
    del additional
    path = file_below(host.files, name)
    host.finish_recording()
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise CallError(f"the recording '{name}' cannot be written: {fault.strerror}") from None
    if not os.access(path.parent, os.W_OK):
        raise CallError(f"the recording '{name}' cannot be written: its folder is read-only")
    host.recorder = Recorder(path, host.stage.town.name)
    return f"Recording on file: {path.name}"


def stop(host: Host) -> None:
    """End the recording and write it."""
    host.finish_recording()


async def info(host: Host, name: str, everything: bool) -> str:
    """Answer with the contents of a recording."""
    return await _told_of(host, name, lambda recording: recording.info(everything))


async def collisions(host: Host, name: str, first: int, second: int) -> str:
    """Answer with the collisions of a recording between two kinds of actors."""
    return await _told_of(host, name, lambda recording: recording.collisions(chr(first & 255), chr(second & 255)))


async def blocked(host: Host, name: str, least_time: float, least_distance: float) -> str:
    """Answer with the actors that stood still in a recording."""
    return await _told_of(host, name, lambda recording: recording.blocked(least_time, least_distance))


async def replay(
    host: Host, name: str, begin: float, duration: float, follow: int, sensors: bool, offset: Any = None
) -> str:
    """Play a recording: its bodies appear at their recorded poses, and the spectator follows one of them."""
    del sensors
    recording = await _read(host, name)
    if recording is None:
        return _missing(name)
    if recording.town != host.stage.town.name:
        host.change_town(await host.load(recording.town), reset=False)
    last = recording.frames[-1][1] if recording.frames else 0.0
    first = recording.frames[0][1] if recording.frames else 0.0
    start_at = first + begin if begin >= 0.0 else last + begin
    end = start_at + duration if duration > 0.0 else last
    stop_replay(host, keep=False)
    host.replay = Replay(recording, 0, start_at, end, follow, BEHIND if offset is None else transform_of(offset))
    return f"Replaying File: {name}\n\nReplaying from {begin:g} s, {end - start_at:g} s of {last - first:g} s."


def stop_replay(host: Host, keep: bool) -> None:
    """Stop playing a recording; without `keep`, the bodies that its rest destroys are removed, as in CARLA."""
    playing, host.replay = host.replay, None
    if playing is not None and keep:
        playing.finish(host.stage)
    elif playing is not None:
        playing.stop(host.stage, host.played)


def set_pace(host: Host, factor: float) -> None:
    """Set how fast recordings are played."""
    if not 0.0 <= factor <= FASTEST_PACE:
        raise CallError(f"the time factor of a recording is from 0 to {FASTEST_PACE:g}")
    host.played = replace(host.played, pace=factor)


def ignore_hero(host: Host, ignored: bool) -> None:
    """Set whether recordings that are played leave heroes where they are."""
    host.played = replace(host.played, without_hero=ignored)


async def _read(host: Host, name: str) -> Recording | None:
    """Return the recording of a name; None if there is none."""
    if not file_below(host.files, name).is_file():
        return None
    return await asyncio.to_thread(Recording.read, host.files, name)


async def _told_of(host: Host, name: str, tell: Callable[[Recording], str]) -> str:
    """Return the text that `tell` makes of a recording, or the text that there is no such file."""
    recording = await _read(host, name)
    return _missing(name) if recording is None else tell(recording)


def _missing(name: str) -> str:
    """Return CARLA's answer about a missing file, which is a text and not an error."""
    return f"File {name} not found on server\n"
