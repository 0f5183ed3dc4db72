"""Worlds that a plan is executed in, and the table of their names.

In: a plan, its map and the engine's snapshots. Out: camera images, and where the world's own physics has moved the ego
vehicle. Imports controllers' types, perception, the plan, roads and the hall.
"""

from __future__ import annotations

from scenario_compiler.worlds.model import (
    EgoCommand,
    EgoState,
    Entities,
    EntityState,
    Snapshot,
    World,
    WorldError,
    WorldEvent,
    WorldFinding,
    WorldOptions,
)

WORLDS: dict[str, str] = {
    "carla": "scenario_compiler.worlds.carla:CarlaWorld",
    "kinematic": "scenario_compiler.worlds.kinematic:KinematicWorld",
}
"""Name of a world to its class; the modules are imported only when a world is opened."""

__all__ = [
    "WORLDS",
    "EgoCommand",
    "EgoState",
    "Entities",
    "EntityState",
    "Snapshot",
    "World",
    "WorldError",
    "WorldEvent",
    "WorldFinding",
    "WorldOptions",
]
