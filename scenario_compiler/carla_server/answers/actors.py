"""Calls about all actors: spawn, destroy, move."""

from __future__ import annotations

from collections.abc import Awaitable
from typing import Any

from scenario_compiler.carla_server.actors import Actor, Body, Car, Sensor, Walker, transform_of
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.driving import FASTEST
from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.sensors.kinds import INSTRUMENTS
from scenario_compiler.carla_server.spawning import check_attributes, new_actor
from scenario_compiler.carla_server.stage import FARTHEST
from scenario_compiler.frames import CarlaTransform, carla_attached

MOST_WORK = 256
"""Greatest number of sensors at the same time."""


def spawn_actor(host: Host, description: list[Any], transform: list[Any]) -> list[Any]:
    """Spawn an actor; answer with it."""
    return host.wire(spawn(host, description, transform_of(transform)))


def spawn_with_parent(
    host: Host, description: list[Any], transform: list[Any], parent: int, attachment: int, socket: str = ""
) -> list[Any]:
    """Spawn an actor that is attached to another; answer with it. A spring arm is stiff here."""
    del attachment, socket
    return host.wire(spawn(host, description, transform_of(transform), parent))


def spawn(host: Host, description: list[Any], transform: CarlaTransform, parent: int = 0) -> Actor:
    """Spawn an actor.

    Raises:
        CallError: There is no such blueprint or parent, no client can read an attribute, something is in the way, or
            there are too many.
    """
    stage = host.stage
    if max(abs(value) for value in transform[:3]) > FARTHEST or max(abs(value) for value in transform[3:]) > 1e6:
        raise CallError("unable to spawn actor: the transform is out of bounds")
    check_attributes(host.version, description)
    actor = new_actor(host.version, description, transform)
    if parent:
        carrier = stage.get(parent)
        actor.transform = carla_attached(stage.transform_of(carrier), transform)
        if not isinstance(actor, Car | Walker):
            actor.parent, actor.relative = parent, transform
    if isinstance(actor, Body):
        return stage.add_body(actor)
    if not isinstance(actor, Sensor):
        return stage.add(actor)
    if sum(isinstance(one, Sensor) for one in stage.actors.values()) >= MOST_WORK:
        raise CallError(f"unable to spawn actor: there are {MOST_WORK} sensors already")
    made = INSTRUMENTS.get(actor.blueprint.name)
    instrument = None if made is None else made(stage, actor)
    stage.add(actor)
    if instrument is not None:
        host.employ(actor, instrument)
    return actor


def destroy(host: Host, number: int) -> bool | Awaitable[bool]:
    """Destroy an actor; answer with true."""
    if isinstance(host.stage.get(number), Car) and host.managers and not host.settings.synchronous:
        return _destroy_beside_managers(host, number)
    return remove(host, number)


async def _destroy_beside_managers(host: Host, number: int) -> bool:
    await host.hold_managers()
    return remove(host, number)


def remove(host: Host, number: int) -> bool:
    """Remove an actor from the world at once; return true.

    Raises:
        CallError: There is none, or it belongs to the map.
    """
    actor = host.stage.get(number)
    host.stage.destroy(number)
    if isinstance(actor, Sensor):
        host.dismiss(number)
    return True


def ignore_vehicles(host: Host, number: int, unseen: list[int]) -> None:
    """Hide some actors from a lidar.

    Raises:
        CallError: It is not a sensor.
    """
    sensor = host.stage.get(number)
    if not isinstance(sensor, Sensor):
        raise CallError(f"unable to ignore vehicles: actor {number} is not a sensor")
    sensor.unseen = frozenset(unseen)


def actors_by_id(host: Host, numbers: list[int]) -> list[Any]:
    """Answer with the actors that have the given ids; unknown ids are left out."""
    return [host.wire(host.stage.actors[number]) for number in numbers if number in host.stage.actors]


def spectator(host: Host) -> list[Any]:
    """Answer with the spectator."""
    return host.wire(host.stage.spectator)


def bounding_box(host: Host, number: int) -> list[Any]:
    """Answer with an actor's box."""
    return host.stage.box_of(number)


def set_location(host: Host, number: int, location: list[float]) -> None:
    """Move an actor and keep its rotation."""
    actor = host.stage.get(number)
    now = actor.relative if actor.relative is not None else host.stage.transform_of(actor)
    x, y, z = location
    host.stage.put(actor, now._replace(x=x, y=y, z=z))


def set_transform(host: Host, number: int, transform: list[Any]) -> None:
    """Move and turn an actor."""
    host.stage.put(host.stage.get(number), transform_of(transform))


def set_velocity(host: Host, number: int, velocity: list[float]) -> None:
    """Give a body the component of a velocity along its heading, since wheels do not slip here."""
    body = body_of(host, number)
    ahead = host.stage.ahead_of(body)
    host.stage.driving.set_speed(body, _bounded(sum(a * b for a, b in zip(ahead, velocity, strict=True))))


def keep_velocity(host: Host, number: int, velocity: list[float]) -> None:
    """Let a vehicle keep the forward component of a velocity in its own axes."""
    body = body_of(host, number)
    if isinstance(body, Car):
        body.constant = _bounded(velocity[0])


def let_velocity(host: Host, number: int) -> None:
    """Let a vehicle be driven by its pedals again."""
    body = body_of(host, number)
    if isinstance(body, Car):
        body.constant = None
        host.stage.driving.command(body)


def add_impulse(host: Host, number: int, impulse: list[float], at: list[float] | None = None) -> None:
    """Push a vehicle by the component of an impulse (N s) along its heading."""
    del at
    body = body_of(host, number)
    if isinstance(body, Car) and body.simulates:
        ahead = host.stage.ahead_of(body)
        along = sum(a * b for a, b in zip(ahead, impulse, strict=True))
        body.pushed = _bounded(body.pushed + along / body.mass)


def add_force(host: Host, number: int, force: list[float], at: list[float] | None = None) -> None:
    """Push a body for the next step, N."""
    add_impulse(host, number, [value * host.step_length for value in force], at)


def simulate_physics(host: Host, number: int, enabled: bool) -> None:
    """Switch the physics of a body on or off."""
    actor = host.stage.get(number)
    if isinstance(actor, Body):
        host.stage.let_simulate(actor, enabled)


def let_weigh(host: Host, number: int, enabled: bool) -> None:
    """Switch the gravity of a body on or off; without gravity, tires transmit no force to the road."""
    body = body_of(host, number)
    body.weighs = enabled
    if isinstance(body, Car):
        host.stage.driving.command(body)


def collide(host: Host, number: int, enabled: bool) -> None:
    """Switch the collisions of a body on or off."""
    actor = host.stage.get(number)
    if isinstance(actor, Body):
        actor.collides = enabled


def body_of(host: Host, number: int) -> Body:
    """Return a body; raise CallError if the actor has none."""
    actor = host.stage.get(number)
    if not isinstance(actor, Body):
        raise CallError(f"actor {number} is {actor.blueprint.name}: it has no body")
    return actor


def car_of(host: Host, number: int) -> Car:
    """Return a vehicle; raise CallError if the actor is not a vehicle."""
    actor = host.stage.get(number)
    if not isinstance(actor, Car):
        raise CallError(f"actor {number} is {actor.blueprint.name}, not a vehicle")
    return actor


def walker_of(host: Host, number: int) -> Walker:
    """Return a walker; raise CallError if the actor is not a walker."""
    actor = host.stage.get(number)
    if not isinstance(actor, Walker):
        raise CallError(f"actor {number} is {actor.blueprint.name}, not a walker")
    return actor


def _bounded(speed: float) -> float:
    return min(max(speed, -FASTEST), FASTEST)
