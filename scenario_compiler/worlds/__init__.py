"""The worlds in which plans are executed, and the table of their names.

In: a plan, its map and the engine's snapshots. Out: camera images, and the ego's new state if the world's own physics
moves it. Imports controllers' types, perception, the plan, roads and the hall.
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
"""Class of each world by its name; a module is imported only when its world is opened."""

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
