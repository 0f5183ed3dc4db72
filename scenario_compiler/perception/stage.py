"""A plan's map with its paint, and its entities as solids: what all cameras of a run see."""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Sequence

from scenario_compiler.perception.camera import vehicle_axes
from scenario_compiler.perception.models import Lamp
from scenario_compiler.perception.road_camera import scene_of
from scenario_compiler.perception.solids import Box
from scenario_compiler.plan.model import Plan
from scenario_compiler.plan.painted import mark_stretches, secondary_lines
from scenario_compiler.roads import Network, Pose, SecondaryLine

PAINTS = ((38, 38, 160), (150, 92, 40), (60, 60, 60), (205, 205, 205), (40, 120, 60), (30, 140, 190))
"""Colours of vehicles (blue, green, red); an entity's is chosen by its id."""


class Stage:
    """The scene of a plan."""

    def __init__(self, plan: Plan, network: Network, lines_beside: Sequence[SecondaryLine] = ()) -> None:
        """Prepare the painted map.

        Args:
            plan: The plan.
            network: Its map.
            lines_beside: The lines that the plan paints beside entities (`plan.painted.lines_beside`).
        """
        self.plan = plan
        self.scene = scene_of(network.with_mark_quality(mark_stretches(plan)), [*secondary_lines(plan), *lines_beside])

    def boxes(self, there: Iterable[tuple[int, Pose, bool]]) -> list[Box]:
        """Return entities as they are drawn.

        Args:
            there: For each visible entity its number in the plan, the pose of its reference point, and whether it
                brakes.
        """
        return [self._box(number, pose, braking) for number, pose, braking in there]

    def _box(self, number: int, pose: Pose, braking: bool) -> Box:
        entity = self.plan.entities[number]
        vehicle = entity.vehicle
        x, y, z = vehicle_axes(pose)[:, 0] * vehicle.center
        return Box(
            pose.x + x,
            pose.y + y,
            pose.z + z,
            pose.heading,
            vehicle.length,
            vehicle.width,
            vehicle.height,
            PAINTS[zlib.crc32(entity.id.encode()) % len(PAINTS)],
            vehicle.category,
            pose.pitch,
            pose.roll,
            Lamp.AUTOMATIC | Lamp.BRAKE if braking else Lamp.AUTOMATIC,
            number,
        )
