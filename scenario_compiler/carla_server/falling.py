"""The fall of a vehicle onto the road, from where it has been spawned or put, and of a walker that has jumped."""

from __future__ import annotations

from dataclasses import dataclass

from scenario_compiler.roads import Pose

GRAVITY = 9.81

JUMP = 5.0
"""Speed with which a walker jumps up, m/s: CARLA's (`AWalkerController::OnPossess`)."""

SETTLES = 0.2
"""Time after which a vehicle that was put somewhere has settled on its springs and leans as the road does, s."""


@dataclass(frozen=True)
class Fall:
    """A fall: the pose of the body's reference point when it began, OpenDRIVE axes; the time and the speed up then."""

    begin: Pose
    since: float
    rise: float = 0.0

    def height(self, time: float) -> float:
        """Return the height of the falling body at a time, m, if nothing is below it."""
        lasts = time - self.since
        return self.begin.z + (self.rise - 0.5 * GRAVITY * lasts) * lasts

    def is_over(self, ground: float, time: float) -> bool:
        """Return whether the body stands on the ground at a height, m, and leans as that does."""
        return self.height(time) <= ground and time > self.since + SETTLES

    def pose(self, on_ground: Pose, time: float) -> Pose:
        """Return the body's pose over its pose on the ground; it leans as when the fall began."""
        height = max(on_ground.z, self.height(time))
        return on_ground._replace(z=height, pitch=self.begin.pitch, roll=self.begin.roll)
