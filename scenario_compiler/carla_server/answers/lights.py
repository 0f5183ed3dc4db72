"""Calls about traffic lights."""

from __future__ import annotations

import asyncio
from typing import Any

from scenario_compiler.carla_server.actors import LightActor
from scenario_compiler.carla_server.call_error import CallError
from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.traffic_lights import Light


def light_of(host: Host, number: int) -> Light:
    """Return a traffic light; raise CallError if the actor is not a traffic light."""
    actor = host.stage.get(number)
    if not isinstance(actor, LightActor):
        raise CallError(f"actor {number} is {actor.blueprint.name}, not a traffic light")
    return actor.light


def set_state(host: Host, number: int, state: int) -> None:
    """Let a light show a state until its group switches."""
    light = light_of(host, number)
    light.group.put(light, state)


def set_green(host: Host, number: int, seconds: float) -> None:
    """Set how long a light, and with it all lights of its controller, is green."""
    light_of(host, number).times[0] = max(seconds, 0.0)


def set_yellow(host: Host, number: int, seconds: float) -> None:
    """Set how long a light, and with it all lights of its controller, is yellow."""
    light_of(host, number).times[1] = max(seconds, 0.0)


def set_red(host: Host, number: int, seconds: float) -> None:
    """Set for how long all lights of the group are red after the turn of a light's controller."""
    light_of(host, number).times[2] = max(seconds, 0.0)


def freeze(host: Host, number: int, frozen: bool) -> None:
    """Freeze a light, and with it its group, in its present state, or let it go on."""
    light_of(host, number).frozen = frozen


def reset_group(host: Host, number: int) -> None:
    """Let the group of a light begin again with its first phase."""
    light_of(host, number).group.reset()


def reset_all(host: Host) -> None:
    """Let all groups begin again with their first phases."""
    for group in host.stage.groups:
        group.reset()


def freeze_all(host: Host, frozen: bool) -> None:
    """Freeze all lights in their present state, or let them go on."""
    for group in host.stage.groups:
        for light in group.lights:
            light.frozen = frozen


def group_of(host: Host, number: int) -> list[int]:
    """Answer with the lights of a light's group."""
    return [light.actor for light in light_of(host, number).group.lights]


async def boxes(host: Host, number: int) -> list[Any]:
    """Answer with the boxes about a light's lamps, in the world's axes."""
    light = light_of(host, number)
    of_lights = (await asyncio.to_thread(host.stage.town.level_boxes)).of_lights
    return [[*box, number] for box in of_lights.get(light.signal, ())]
