"""Reflections in a wet road: the sky, the trees at the horizon, the sides and the lamps of other vehicles."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.camera import vehicle_axes
from scenario_compiler.perception.ground import Traced
from scenario_compiler.perception.lens import Lens
from scenario_compiler.perception.lighting import Light
from scenario_compiler.perception.polygons import SUBPIXEL, Polygon, flatten
from scenario_compiler.perception.sky import SkyView
from scenario_compiler.perception.solids import Faces

Image = NDArray[np.uint8]
Table = NDArray[np.float32]

STEP_BITS = 2
"""A reflection is computed for every fourth pixel, because ripples blur it anyway."""

BLUR = 31.0 / 512.0
"""Vertical blur of a reflection by ripples, as a share of the image's height."""

SMALLEST = 6.0
"""Least height and width of a reflected face, pixels, unless it shines."""

FAINT = 0.6
"""Share of the light of a vehicle's sides in the reflection, where they are seen from below, in their own shade."""


STREAK = 3.0
"""Length of the reflection of a lamp relative to the lamp itself."""

_Shape = tuple[Polygon, list[float]]


class Reflection:
    """The reflections in the ground for one camera."""

    def __init__(self, lens: Lens, buffers: Buffers) -> None:
        """Prepare which part of the sky each piece of ground reflects."""
        self.lens, self._buffers = lens, buffers
        step = 1 << STEP_BITS
        ahead, left, up = (one[lens.top :: step, ::step] for one in lens.directions())
        self._sky = SkyView(ahead, left, -up)
        self._blur = max(round(BLUR * lens.camera.height / step), 1)

    def add(self, ground: Image, mirror: Table, panorama: Image, traced: Traced, faces: Faces, light: Light) -> None:
        """Add reflections to the image of the ground, in place.

        Args:
            ground: (rows, width, 4) the ground from row `Traced.top` on.
            mirror: (reflecting rows, columns) the share of light that it reflects (see `Shaded`).
            panorama: The sky.
            traced: The ground.
            faces: The things on the ground.
            light: The light.
        """
        step = -(-ground.shape[1] // mirror.shape[1])
        ground = ground[: len(mirror) * step]
        high = -(-len(ground) >> STEP_BITS)
        get = self._buffers.get
        sky_view, rows = (self._sky, high) if traced.even == traced.top else (self._uneven(traced, len(ground)), None)
        sky = sky_view.draw(panorama, traced.view.pose.heading, rows)
        faint, lamps = self._mirrored(traced, faces, light)
        for shape, tone in faint:
            cv2.fillConvexPoly(sky, shape, tone, cv2.LINE_8, SUBPIXEL + STEP_BITS)
        blurred = np.asarray(cv2.blur(sky, (1, self._blur)), np.uint8)
        for shape, tone in lamps:
            cv2.fillConvexPoly(blurred, _stretched(shape), tone, cv2.LINE_AA, SUBPIXEL + STEP_BITS)
        size = (*mirror.shape, 4)
        image = np.asarray(cv2.resize(blurred, mirror.shape[::-1], get("mirrored", size, np.uint8)), np.uint8)
        share = cv2.convertScaleAbs(mirror, get("channel", mirror.shape, np.uint8), 255.0)
        cv2.multiply(image, cv2.merge((share, share, share, share), get("shares", size, np.uint8)), image, 1.0 / 255.0)
        if step > 1:
            four = get("four", (self.lens.camera.height, *ground.shape[1:]), np.uint8)[: len(ground)]
            image = np.asarray(cv2.resize(image, ground.shape[1::-1], four, interpolation=cv2.INTER_NEAREST), np.uint8)
        cv2.add(ground, image, ground)

    def _uneven(self, traced: Traced, rows: int) -> SkyView:
        """Return the part of the sky that the ground reflects in rows from the topmost on."""
        camera, step = self.lens.camera, 1 << STEP_BITS
        x = (np.arange(0, camera.width, step) - camera.width / 2.0) / camera.focal
        y = (np.arange(traced.top, traced.top + rows, step) - camera.height / 2.0) / camera.focal
        index = traced.ids[traced.top : traced.top + rows : step, ::step].astype(np.intp)
        ways = np.stack(np.broadcast_arrays(x, y[:, None], 1.0)).astype(np.float32)
        planes = traced.planes / np.maximum(np.linalg.norm(traced.planes, axis=1, keepdims=True), 1e-9)
        normal = np.take(planes.T.astype(np.float32), index, axis=1)
        ways -= normal * (2.0 * (normal * ways).sum(axis=0))
        ahead, left, up = np.tensordot(camera.rotation.T.astype(np.float32), ways, axes=1)
        return SkyView(ahead, left, up)

    def _mirrored(self, traced: Traced, faces: Faces, light: Light) -> tuple[list[_Shape], list[_Shape]]:
        """Return the faces mirrored at the plane that the vehicle stands on: lit ones, and lamps."""
        if not faces.shapes:
            return [], []
        view = traced.view
        up = view.rotation @ vehicle_axes(view.pose)[:, 2]
        x, y, z = faces.points
        height = up[0] * x + up[1] * y + up[2] * z + view.camera.z
        flat = flatten(faces.points - 2.0 * up[:, None, None] * height, view.camera)
        large = (np.ptp(flat.pixels, axis=1).min(axis=0) > SMALLEST) | ~flat.whole
        first = np.array((0, traced.top << SUBPIXEL), np.int32)
        shines = faces.shines[flat.index]
        lit = np.where(shines[:, None], 1.0, FAINT * light.look.luminance) * faces.colours[flat.index]
        shapes = list(zip((shape - first for shape in flat.shapes), lit.tolist(), strict=True))
        return (
            [shapes[k] for k in np.flatnonzero(large & ~shines).tolist()],
            [shapes[k] for k in np.flatnonzero(shines).tolist()],
        )


def _stretched(shape: Polygon) -> Polygon:
    """Return the reflection of a lamp, stretched up and down by ripples."""
    middle = shape[:, 1].mean()
    drawn_out = shape.copy()
    drawn_out[:, 1] = np.rint(middle + STREAK * (shape[:, 1] - middle))
    return drawn_out
