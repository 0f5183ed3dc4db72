"""What a camera sees by casting rays on every quad of a scene: slow, and independent of how pictures are painted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scenario_compiler.perception.camera import View, vehicle_axes
from scenario_compiler.perception.ground import MATERIAL_TAGS
from scenario_compiler.perception.labels import FARTHEST_DEPTH, Tag
from scenario_compiler.perception.models import model_of
from scenario_compiler.perception.polygons import near_plane
from scenario_compiler.perception.scene import SURFACE_DISTANCE, Scene
from scenario_compiler.perception.solids import Box
from scenario_compiler.roads.positions import Pose

SAME = 0.06
"""Surfaces that a ray meets within this distance, m, lie on each other: any of them may be shown."""


@dataclass(frozen=True, eq=False)
class Quads:
    """Quads (N, 4, 3) of the world, each with a tag and the number of what it belongs to."""

    corners: np.ndarray
    tags: np.ndarray
    instances: np.ndarray


@dataclass(frozen=True, eq=False)
class Hits:
    """What rays meet. R rays.

    Attributes:
        depth: (R,) depth of the nearest hit, m; that of the sky where there is none.
        seen: (R, Q) bool, which quads, the plane below the vehicle last, are hit at that depth.
    """

    depth: np.ndarray
    seen: np.ndarray


def quads_of(scene: Scene, boxes: Sequence[Box], view: View) -> Quads:
    """Return the quads of a scene near a camera, and of boxes."""
    surfaces = scene.surface.quads + scene.origin
    uprights = scene.uprights.quads + scene.origin
    corners, tags, instances = [surfaces, uprights], [MATERIAL_TAGS[scene.surface.material], scene.uprights.tag], []
    instances = [np.zeros(len(surfaces), np.int32), scene.uprights.instance]
    for box in boxes:
        model = model_of(box.kind, box.length, box.width, box.height)
        axes = vehicle_axes(Pose(box.x, box.y, box.z, box.heading, box.pitch, box.roll))
        place = np.array([box.x, box.y, box.z])
        corners.append(np.tensordot(axes, model.points, axes=1).transpose(2, 1, 0) + place)
        tags.append(model.tags)
        instances.append(np.full(len(model.tags), box.instance, np.int32))
    every = np.concatenate(corners)
    near = np.linalg.norm(every.mean(axis=1) - view.position, axis=1) < SURFACE_DISTANCE
    return Quads(every[near], np.concatenate(tags)[near], np.concatenate(instances)[near])


def cast(view: View, pixels: np.ndarray, quads: Quads) -> Hits:
    """Cast rays through pixels (R, 2) of a camera. The plane below the vehicle lies behind all else."""
    camera = view.camera
    directions = np.stack(
        [
            (pixels[:, 0] - camera.width / 2.0) / camera.focal,
            (pixels[:, 1] - camera.height / 2.0) / camera.focal,
            np.ones(len(pixels)),
        ]
    )
    corners = view.to_camera(quads.corners)
    depth = np.minimum(
        *(_hits(corners[:, triangle], directions, near_plane(camera)) for triangle in ((0, 1, 2), (0, 2, 3)))
    )
    fall = -(view.rotation @ vehicle_axes(view.pose)[:, 2]) @ directions
    plane = np.where(fall > 1.0 / camera.focal, camera.z / np.maximum(fall, 1e-9), np.inf)
    plane = np.where(np.isfinite(depth).any(axis=0), np.inf, plane)
    every = np.concatenate([depth, plane[None]]).T
    nearest = every.min(axis=1)
    seen = np.isfinite(every) & (every <= nearest[:, None] + np.maximum(SAME, 0.01 * nearest[:, None]))
    return Hits(np.minimum(nearest, FARTHEST_DEPTH), seen)


def _hits(triangles: np.ndarray, directions: np.ndarray, nearest: float) -> np.ndarray:
    """Return the depths (T, R) beyond `nearest` at which rays meet triangles (T, 3, 3), by Cramer's rule."""
    edge, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    origin = -triangles[:, 0]
    normal = np.cross(edge, other)
    along = normal @ directions
    scale = 1.0 / np.where(np.abs(along) > 1e-12, along, 1e-12)
    u = (np.cross(origin, other) @ directions) * scale
    v = (np.cross(edge, origin) @ directions) * scale
    depth = -(normal * origin).sum(axis=1)[:, None] * scale
    inside = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1.0 + 1e-9) & (depth > nearest)
    return np.where(inside, depth, np.inf)


def tags_and_instances(quads: Quads) -> tuple[np.ndarray, np.ndarray]:
    """Return the tags and the numbers of all quads, the plane below the vehicle last."""
    return np.append(quads.tags, Tag.TERRAIN), np.append(quads.instances, 0)
