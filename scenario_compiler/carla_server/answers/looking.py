"""Calls that query the world: rays, boxes of the map, objects beside the roads."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import numpy as np

from scenario_compiler.carla_server.host import Host
from scenario_compiler.carla_server.sensors.rays import Rays


def project_point(
    host: Host, start: list[float], direction: list[float], reach: float
) -> list[Any] | Awaitable[list[Any]]:
    """Answer with what a ray meets first: whether, where, and its semantic tag."""

    def look() -> list[Any]:
        length = float(np.linalg.norm(direction))
        if length < 1e-9:
            return [False, [[0.0, 0.0, 0.0], 0]]
        met = _met(host, np.array(start, np.float64), np.array(direction, np.float64) / length, reach)
        return [bool(met), met[0] if met else [[0.0, 0.0, 0.0], 0]]

    return _on_ground(host, look)


def cast_ray(host: Host, start: list[float], end: list[float]) -> list[Any] | Awaitable[list[Any]]:
    """Answer with what lies on the line between two points: where, and its semantic tag."""

    def look() -> list[Any]:
        begin, way = np.array(start, np.float64), np.array(end, np.float64) - np.array(start, np.float64)
        length = float(np.linalg.norm(way))
        return [] if length < 1e-9 else _met(host, begin, way / length, length)

    return _on_ground(host, look)


def _on_ground(host: Host, look: Callable[[], list[Any]]) -> list[Any] | Awaitable[list[Any]]:
    """Look now, or when the ground of a map that has just been loaded is prepared, which others need not wait for."""
    return look() if host.stage.town.has_terrain else _later(host, look)


async def _later(host: Host, look: Callable[[], list[Any]]) -> list[Any]:
    await asyncio.to_thread(host.stage.town.terrain)
    return look()


def _met(host: Host, begin: Any, direction: Any, reach: float) -> list[Any]:
    rays = Rays(host.stage, begin, direction[None], reach, 0)
    if not np.isfinite(rays.distance[0]):
        return []
    return [[(begin + direction * rays.distance[0]).tolist(), int(rays.tags()[0])]]


def level_boxes(host: Host, tag: int) -> list[Any]:
    """Answer with no box: what stands beside the roads has none here."""
    del host, tag
    return []


def environment_objects(host: Host, tag: int) -> list[Any]:
    """Answer with no thing: what stands beside the roads cannot be switched here."""
    del host, tag
    return []


def lamps(host: Host, client: str) -> list[Any]:
    """Answer with no street lamp: the map has none."""
    del host, client
    return []


def names_of_objects(host: Host) -> list[str]:
    """Answer with the names of all bodies: those are the objects here."""
    return [f"{body.blueprint.name}_{body.id}" for body in host.stage.bodies()]
