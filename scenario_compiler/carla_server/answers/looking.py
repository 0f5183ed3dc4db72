"""Calls that query the world: rays, boxes of the map, objects beside the roads."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import numpy as np

from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.level_boxes import NO_ACTOR
from scenario_compiler.carla_server.sensors.rays import Rays
from scenario_compiler.frames import carla_axes

MOST_HITS = 64
BEYOND = 0.05
"""Greatest number of hits of a ray, and the distance behind a surface at which it goes on, m."""

ANY_TAG = 255
"""The tag with which clients ask for things of every tag."""


def project_point(
    host: Host, start: list[float], direction: list[float], reach: float
) -> list[Any] | Awaitable[list[Any]]:
    """Answer whether a ray hits anything, and with the place and the semantic tag of its first hit."""

    def look() -> list[Any]:
        length = float(np.linalg.norm(direction))
        if length < 1e-9:
            return [False, [[0.0, 0.0, 0.0], 0]]
        met = _met(host, np.array(start, np.float64), np.array(direction, np.float64) / length, reach)
        return [bool(met), met[0] if met else [[0.0, 0.0, 0.0], 0]]

    return _on_ground(host, look)


def cast_ray(host: Host, start: list[float], end: list[float]) -> list[Any] | Awaitable[list[Any]]:
    """Answer with the place and the semantic tag of every hit of the line between two points, in order."""

    def look() -> list[Any]:
        begin, way = np.array(start, np.float64), np.array(end, np.float64) - np.array(start, np.float64)
        length = float(np.linalg.norm(way))
        return [] if length < 1e-9 else _met(host, begin, way / length, length, MOST_HITS)

    return _on_ground(host, look)


def _on_ground(host: Host, look: Callable[[], list[Any]]) -> list[Any] | Awaitable[list[Any]]:
    """Look now, or as soon as the ground of a map that has just been loaded is prepared; other calls do not wait."""
    return look() if host.stage.town.has_terrain else _later(host, look)


async def _later(host: Host, look: Callable[[], list[Any]]) -> list[Any]:
    await asyncio.to_thread(host.stage.town.terrain)
    return look()


def _met(host: Host, begin: Any, direction: Any, reach: float, most: int = 1) -> list[Any]:
    found: list[Any] = []
    passed: set[int] = set()
    way = 0.0
    while len(found) < most and way < reach:
        rays = Rays(host.stage, begin + direction * way, direction[None], reach - way, 0, passed)
        distance = way + float(rays.distance[0])
        if not np.isfinite(distance):
            break
        found.append([(begin + direction * distance).tolist(), int(rays.tags()[0])])
        if rays.target[0] >= 0:
            passed.add(rays.bodies[rays.target[0]].id)
        else:
            way = distance + BEYOND
    return found


async def level_boxes(host: Host, tag: int) -> list[Any]:
    """Answer with the boxes of vehicles, walkers, props and things beside the roads of a semantic tag, world's axes."""
    of_map = (await asyncio.to_thread(host.stage.town.level_boxes)).by_tag
    found: list[Any] = []
    for body in host.stage.bodies():
        if tag in (ANY_TAG, body.tag):
            x, y, z, pitch, yaw, roll = host.stage.transform_of(body)
            up = np.array(carla_axes(pitch, yaw, roll)[2]) * (body.box[2] - body.up)
            found.append([(np.array([x, y, z]) + up).tolist(), list(body.box), [pitch, yaw, roll], body.id])
    for of, boxes in of_map.items():
        if tag in (ANY_TAG, of):
            found += [[*box, NO_ACTOR] for box in boxes]
    return found


def environment_objects(host: Host, tag: int) -> list[Any]:
    """Answer with an empty list: the server has no objects beside the roads that can be switched on and off."""
    del host, tag
    return []


def lamps(host: Host, client: str) -> list[Any]:
    """Answer with an empty list: the maps have no street lamps."""
    del host, client
    return []


def names_of_objects(host: Host) -> list[str]:
    """Answer with the names of all vehicles, walkers and props: the maps have no other objects."""
    return [f"{body.blueprint.name}_{body.id}" for body in host.stage.bodies()]
