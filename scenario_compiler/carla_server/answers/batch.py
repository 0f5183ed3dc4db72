"""Batches: several commands in one call, each with its own response."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

from scenario_compiler.carla_server.actors import transform_of
from scenario_compiler.carla_server.answers import actors, vehicles
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.layouts import (
    ACKERMANN,
    ANYTHING,
    BOOL,
    CONTROL,
    DESCRIPTION,
    PHYSICS,
    REAL,
    TEXT,
    TRANSFORM,
    U16,
    U32,
    VECTOR,
    WALKER_CONTROL,
    Layout,
    optional,
    struct,
)

MOST_AFTER = 64
"""Greatest number of commands that follow the spawning of an actor."""


def nothing(host: Host, number: int, *values: Any) -> None:
    """Find the actor; do nothing else."""
    del values
    host.stage.get(number)


def _destroy(host: Host, number: int) -> None:
    actors.remove(host, number)


def _set_lights(host: Host, number: int, state: int) -> None:
    vehicles.set_lights(host, number, [state])


@dataclass(frozen=True)
class Command:
    """A command of a batch.

    Attributes:
        name: CARLA's name of it.
        layouts: Layouts of its fields after the actor's id.
        does: The function that executes it.
    """

    name: str
    layouts: tuple[Layout, ...]
    does: Callable[..., None]


COMMANDS = (
    Command("SpawnActor", (), nothing),  # see `_spawn`
    Command("DestroyActor", (), _destroy),
    Command("ApplyVehicleControl", (CONTROL,), vehicles.control),
    Command("ApplyVehicleAckermannControl", (ACKERMANN,), vehicles.ackermann),
    Command("ApplyWalkerControl", (WALKER_CONTROL,), vehicles.walk),
    Command("ApplyVehiclePhysicsControl", (PHYSICS,), vehicles.set_physics),
    Command("ApplyTransform", (TRANSFORM,), actors.set_transform),
    Command("ApplyWalkerState", (TRANSFORM, REAL), vehicles.walk_state),
    Command("ApplyTargetVelocity", (VECTOR,), actors.set_velocity),
    Command("ApplyTargetAngularVelocity", (VECTOR,), nothing),
    Command("ApplyImpulse", (VECTOR,), actors.add_impulse),
    Command("ApplyForce", (VECTOR,), actors.add_force),
    Command("ApplyAngularImpulse", (VECTOR,), nothing),
    Command("ApplyTorque", (VECTOR,), nothing),
    Command("SetSimulatePhysics", (BOOL,), actors.simulate_physics),
    Command("SetEnableGravity", (BOOL,), actors.let_weigh),
    Command("SetAutopilot", (BOOL, U16), nothing),
    Command("ShowDebugTelemetry", (BOOL,), nothing),
    Command("SetVehicleLightState", (U32,), _set_lights),
)
"""The commands, by their number on the wire; LibCarla's `rpc/Command.h`."""

SPAWN = {
    "0.9.15": struct(
        "SpawnActor", DESCRIPTION, TRANSFORM, optional(U32), Layout("commands", lambda v: type(v) is list)
    ),
    "0.9.16": struct(
        "SpawnActor",
        *(DESCRIPTION, TRANSFORM, optional(U32), ANYTHING, TEXT, Layout("commands", lambda v: type(v) is list)),
    ),
}
"""Layout of the first command on the wire, by version; an unused type of attachment is not initialised."""


def apply(host: Host, commands: list[Any], tick: bool) -> Any:
    """Execute commands, and do a tick if the client asks for it; answer with a response for each command."""
    found = [_carry_out(host, one) for one in commands]
    if not tick:
        return found
    cued = host.cue()
    return _after(cued, found) if isinstance(cued, Awaitable) else found


async def _after(cued: Awaitable[int], found: list[Any]) -> list[Any]:
    await cued
    return found


def _carry_out(host: Host, wrapped: Any, spawned: int = 0) -> list[Any]:
    """Execute one command; return its response. One that follows a spawning is for the spawned actor, as in CARLA."""
    try:
        number, values = _unwrapped(wrapped)
        if number == 0:
            return [[1, _spawn(host, values)]]
        command = COMMANDS[number]
        if not values or not U32.holds(values[0]):
            raise CallError(f"{command.name}: the command does not begin with an actor's id")
        actor = spawned or values[0]
        given = values[1:]
        wanted = command.layouts[: len(given)] if command.name == "SetAutopilot" else command.layouts
        if len(given) != len(wanted) or not all(one.holds(value) for one, value in zip(wanted, given, strict=True)):
            raise CallError(f"{command.name}: the command does not have the layout of its version")
        command.does(host, actor, *given)
    except CallError as fault:
        return [[0, [str(fault)]]]
    return [[1, actor]]


def _unwrapped(wrapped: Any) -> tuple[int, list[Any]]:
    if type(wrapped) is list and len(wrapped) == 1 and type(wrapped[0]) is list and len(wrapped[0]) == 2:
        number, values = wrapped[0]
        if type(number) is int and 0 <= number < len(COMMANDS) and type(values) is list:
            return number, values
    raise CallError("the batch contains something that is not a command")


def _spawn(host: Host, values: list[Any]) -> int:
    if not SPAWN[host.version].holds(values):
        raise CallError("SpawnActor: the command does not have the layout of its version")
    if values[2][0]:
        host.stage.get(values[2][1])  # CARLA does not put the spawned actor into the place of its parent
    parent = values[2][1] if values[2][0] else 0
    actor = actors.spawn(host, values[0], transform_of(values[1]), parent)
    for one in values[-1][:MOST_AFTER]:
        _carry_out(host, one, actor.id)
    return actor.id
