"""Lines that a run draws into CARLA's world: the route and the path that the controller predicts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

from scenario_compiler.frames import carla_from_pose
from scenario_compiler.plan.model import RouteLeg
from scenario_compiler.roads import Network, Pose

YELLOW, PURPLE = (255, 200, 0), (190, 40, 210)
"""Colours of the route and of the predicted path: red, green, blue."""

LIFTED_LINE, LINE_WIDTH, DISPLAY_WIDTH = 0.3, 0.1, 2.0
"""Height of drawn lines above the road, m, and their width in the world, m, and on the server's display, pixels."""

PATH_STEP = 2.0
"""Least length of the segments of the predicted path, m."""


class Lines:
    """Draws lines."""

    def __init__(self, carla: Any, world: Any, *, on_display: bool) -> None:
        """Draw in the world, or only on the server's display if the automation sees CARLA's images.

        Clients before 0.9.16 cannot draw on the display, and then no line is drawn.
        """
        self._carla, self._width = carla, DISPLAY_WIDTH if on_display else LINE_WIDTH
        self._draw_line = getattr(world.debug, "draw_hud_line", None) if on_display else world.debug.draw_line

    def draw_route(self, route: Sequence[RouteLeg], network: Network) -> None:
        """Draw the middle of the lanes of a route, for the whole run."""
        for leg in route:
            count = max(math.ceil(abs(leg.s_to - leg.s_from) / 10.0), 1)
            places = [leg.s_from + (leg.s_to - leg.s_from) * k / count for k in range(count + 1)]
            points = [carla_from_pose(network.lane_pose(leg.road, leg.lane, s)) for s in places]
            self._draw([(at.x, at.y, at.z) for at in points], YELLOW, 0.0)

    def draw_path(self, pose: Pose, path: Sequence[tuple[float, float]], lasts: float) -> None:
        """Draw the path that the controller predicts, points ahead and to the left of the ego's pose, for a time, s."""
        points: list[tuple[float, float, float]] = []
        last = (-math.inf, -math.inf)
        c, s = math.cos(pose.heading), math.sin(pose.heading)
        for x, y in path:
            if math.isfinite(x + y) and math.dist((x, y), last) >= PATH_STEP:
                last = (x, y)
                at = (pose.x + c * x - s * y, pose.y + s * x + c * y, pose.z - math.tan(pose.pitch) * x)
                points.append(carla_from_pose((*at, 0.0, 0.0, 0.0))[:3])
        self._draw(points, PURPLE, lasts)

    def _draw(self, points: Sequence[tuple[float, float, float]], colour: tuple[int, int, int], lasts: float) -> None:
        if self._draw_line is None:
            return
        carla = self._carla
        for pair in pairwise(points):
            begin, end = (carla.Location(x, y, z + LIFTED_LINE) for x, y, z in pair)
            self._draw_line(begin, end, self._width, carla.Color(*colour), lasts)
