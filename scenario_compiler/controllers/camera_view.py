"""Checks that the camera sees the ground on which the built-in automation searches for its lane."""

from __future__ import annotations

import numpy as np

from scenario_compiler.controllers.data import CameraMounting
from scenario_compiler.diagnostics import Code, Diagnostics, Severity
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.detectors import DETECTORS
from scenario_compiler.plan.model import Plan

NO_LANE_IN_VIEW = Code(
    "SC532",
    "no-lane-in-view",
    "Lane detection searches for the boundaries of the lane on the ground 5 to 30 m ahead of the camera, up to 3 m to "
    "the left and to the right. From its position, and with its direction and field of view, the camera does not see "
    "4 m of a straight boundary on each side there. The automation does not find its lane.\n\n"
    '    <camera yaw="180"/>     looks back\n'
    '    <camera pitch="60"/>    looks into the sky\n\n'
    "Turn the camera to the road ahead, or give the automation a controller of your own that uses this view.",
    Severity.WARNING,
)

AHEAD = np.arange(5.25, 30.0, 0.5)
ASIDE = np.arange(0.75, 3.1, 0.25)
"""Places at which a boundary of the lane may be, m ahead of the camera and to one side of it."""

LEAST = 9
"""Least number of visible places ahead at which a boundary can be detected."""


def check_camera_view(plan: Plan, sink: Diagnostics) -> None:
    """Report a camera of the plan that does not see the lane."""
    word, controller = plan.camera, plan.controller
    if controller is None or controller.model != "lane_detection":
        return
    if controller.detector is not None and controller.detector.model not in DETECTORS:
        return
    if sees_lane(CameraMounting.of(word).camera()):
        return
    turned = next((name for name in ("yaw", "pitch", "roll") if word.written(name) is not None), "")
    message = "the camera does not see both sides of the lane 5 to 30 m ahead, where lane detection searches for it"
    sink.add(NO_LANE_IN_VIEW, message, word.place_of(turned) if turned else word.origin)


def sees_lane(camera: Camera) -> bool:
    """Return whether a straight boundary may be visible on each side of the camera."""
    for side in (1.0, -1.0):
        u, v = camera.project_ground(AHEAD[None], side * ASIDE[:, None])
        seen = (u >= 1.0) & (u < camera.width - 2.0) & (v >= 0.0) & (v < camera.height - 1.0)
        if int(seen.sum(axis=1).max()) < LEAST:
            return False
    return True
