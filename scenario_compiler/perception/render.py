"""A first-person image of the road, drawn on the CPU with OpenCV alone, in eight-bit steps and a fixed order.

Equal arguments give equal bytes on one platform and version of OpenCV, with any number of threads; between
versions single grey levels differ.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from types import MappingProxyType

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.camera import Camera, View
from scenario_compiler.perception.glare import Glare
from scenario_compiler.perception.ground import (
    BARE,
    FIRST,
    MATERIAL_TAGS,
    PAINT_SEEN,
    SKY,
    Ground,
    GroundWeather,
    Traced,
)
from scenario_compiler.perception.labels import FARTHEST_DEPTH, Tag
from scenario_compiler.perception.lens import Lens
from scenario_compiler.perception.lighting import Air, Light
from scenario_compiler.perception.polygons import SUBPIXEL, Floats, nearness_planes
from scenario_compiler.perception.rain import add_rain
from scenario_compiler.perception.reflection import Reflection
from scenario_compiler.perception.scene import Scene
from scenario_compiler.perception.sky import TREE, Sky, panorama_of
from scenario_compiler.perception.solids import (
    FAR_REACH,
    REACH,
    Box,
    Faces,
    Placed,
    draw_faces,
    faces_of,
    place,
    spots_of,
)
from scenario_compiler.perception.strokes import Stroke, draw_strokes
from scenario_compiler.perception.weather_look import Look

Image = NDArray[np.uint8]

HALF = 127
"""Coverage above which more than half of a pixel is covered."""


class Renderer:
    """Draws one scene for one camera. It keeps only what can be recomputed: a frame does not affect the next.

    Its working memory is reused for each picture, so a renderer must be used by one thread at a time.
    """

    def __init__(self, scene: Scene, camera: Camera) -> None:
        """Prepare everything that depends on neither pose nor weather."""
        self.scene, self.camera = scene, camera
        self.lens = Lens(camera)
        self.buffers = Buffers()
        self.ground = Ground(scene, self.lens, self.buffers)
        self.sky = Sky(self.lens, self.buffers)
        self.glare = Glare(self.lens, self.buffers)
        self.reflection = Reflection(self.lens, self.buffers)
        self._weather: _Weather | None = None

    def draw(
        self, view: View, boxes: Sequence[Box], look: Look, signals: Mapping[str, str] = MappingProxyType({})
    ) -> Drawing:
        """Determine what is visible where; image and labels are made from this on request.

        Args:
            view: The camera in the world; its camera must be this renderer's.
            boxes: All others, in any order.
            look: The weather.
            signals: States of traffic lights by their id, as scenarios write them; others are dark.
        """
        surfaces, marks, uprights = self.scene.seen(view)
        traced = self.ground.trace(view, surfaces, marks)
        placed = place(view, boxes, REACH if self.scene.relief else FAR_REACH)
        faces = faces_of(placed, traced, uprights, self.scene, look, signals)
        return Drawing(self, self._weather_of(look), traced, placed, faces)

    def _weather_of(self, look: Look) -> _Weather:
        if self._weather is None or self._weather.look != look:
            self._weather = _Weather(self.ground, look)
        return self._weather


class _Weather:
    """The parts of a renderer for one weather."""

    def __init__(self, ground: Ground, look: Look) -> None:
        self.look = look
        self.light, self.air = Light(ground.camera, look), Air(look)
        self.ground = GroundWeather(ground, self.light)
        self.panorama = panorama_of(look)


class Drawing:
    """The view of one camera at one instant: the picture, and for each pixel its depth, kind and thing.

    All are made of the same polygons in the same order, each on request. A pixel that lies partly on one thing and
    partly on another is labelled as the nearer one, and has a colour between both.
    """

    def __init__(self, renderer: Renderer, weather: _Weather, traced: Traced, placed: Placed, faces: Faces) -> None:
        """Store what is visible."""
        self._renderer, self._weather = renderer, weather
        self._traced, self._placed, self._faces = traced, placed, faces

    @property
    def view(self) -> View:
        """The camera in the world."""
        return self._traced.view

    def image(self, seed: int, frame_index: int, strokes: Sequence[Stroke] = ()) -> Image:
        """Return the image (height, width, 3), BGR.

        Args:
            seed: Seed of the run; together with `frame_index` it places rain.
            frame_index: Number of the frame.
            strokes: Debug lines to draw into the world.
        """
        part, weather, look, traced = self._renderer, self._weather, self._weather.look, self._traced
        view, camera = traced.view, part.camera
        image = part.buffers.get("image", (camera.height, camera.width, 4), np.uint8)
        spots = spots_of(self._placed, traced, weather.light)
        mirror, veil = part.ground.shade(traced, weather.ground, spots, image)
        if mirror is not None:
            part.reflection.add(image[traced.top :], mirror, weather.panorama, traced, self._faces, weather.light)
        weather.ground.add_veil(image, traced, veil)
        self._draw_sky(image)
        part.glare.add(image, view.pose.heading, look)
        draw_faces(image, view, self._faces, weather.light, weather.air)
        add_rain(image, camera, look, seed, frame_index, part.buffers)
        picture = np.asarray(cv2.cvtColor(image, cv2.COLOR_BGRA2BGR), np.uint8)
        if strokes:
            draw_strokes(picture, self.depth, view, strokes)
        return picture

    def _draw_sky(self, image: Image) -> None:
        """Draw the sky where no ground is seen."""
        part, traced = self._renderer, self._traced
        heading, rows = traced.view.pose.heading, part.sky.rows
        if rows <= traced.top:
            part.sky.draw(self._weather.panorama, heading, image[:rows])
            return
        sky = part.buffers.get("four", image.shape, np.uint8)[:rows]
        part.sky.draw(self._weather.panorama, heading, sky)
        cv2.copyTo(sky, (traced.ids[:rows] == SKY).view(np.uint8), image[:rows])

    @cached_property
    def depth(self) -> NDArray[np.float32]:
        """(height, width) distance of each pixel along the optical axis, m, at most `FARTHEST_DEPTH`."""
        camera, points = self._renderer.camera, self._corners
        planes = self._planes.astype(np.float32)
        bounds = np.full((len(planes), 2), 1.0 / FARTHEST_DEPTH, np.float32)
        bounds[BARE, 1] = np.inf
        corners = np.maximum(points[2], 1e-2)
        bounds[FIRST:, 0], bounds[FIRST:, 1] = 1.0 / corners.max(axis=0), 1.0 / corners.min(axis=0)
        near, term = (self._renderer.buffers.get(name, self._ids.shape, np.float32) for name in ("near", "term"))
        ids = self._renderer.buffers.get("index", self._ids.shape, np.intp)
        ids[:] = self._ids
        x = ((np.arange(camera.width) - camera.width / 2.0) / camera.focal).astype(np.float32)
        y = ((np.arange(camera.height) - camera.height / 2.0) / camera.focal).astype(np.float32)[:, None]
        np.multiply(_looked_up(planes[:, 0], ids, near), x, out=near)
        near += np.multiply(_looked_up(planes[:, 1], ids, term), y, out=term)
        near += _looked_up(planes[:, 2], ids, term)
        np.maximum(near, _looked_up(bounds[:, 0], ids, term), out=near)
        np.minimum(near, _looked_up(bounds[:, 1], ids, term), out=near)
        depth = np.full(near.shape, FARTHEST_DEPTH, np.float32)
        return np.divide(np.float32(1.0), near, out=depth, where=near > np.float32(1.0 / FARTHEST_DEPTH))

    @cached_property
    def normals(self) -> NDArray[np.float32]:
        """(height, width, 3) unit normals of the surface in each pixel, world axes, towards the camera; 0 for sky.

        Where a plane is seen, 1 / depth is a linear function of the pixel, whose coefficients point along the plane's
        normal, away from the camera.
        """
        length = np.sqrt((self._planes * self._planes).sum(axis=1, keepdims=True))
        normals = -(self._planes / np.where(length > 0.0, length, 1.0)) @ self.view.rotation
        return np.asarray(np.take(normals.astype(np.float32), self._ids.astype(np.intp), axis=0))

    @cached_property
    def _corners(self) -> Floats:
        """(3, 4, polygons) corners of everything drawn except the bare plane, in camera axes."""
        traced = self._traced
        slopes = traced.surfaces.points[:, :, : traced.slopes]
        return np.concatenate([traced.surfaces.points, slopes, self._faces.points], axis=2)

    @cached_property
    def _planes(self) -> Floats:
        """(polygons + FIRST, 3) coefficients of 1 / depth, by `_ids` (see `nearness_planes`); 0 for sky."""
        return np.concatenate([self._traced.planes, nearness_planes(self._faces.points).T])

    @cached_property
    def semantic(self) -> NDArray[np.uint8]:
        """(height, width) uint8, the kind of thing in each pixel, a `Tag`."""
        part, traced, ids = self._renderer, self._traced, self._ids
        first = len(traced.material)
        tags = np.concatenate([MATERIAL_TAGS[traced.material], self._faces.tags])
        tags[SKY] = Tag.SKY
        semantic = np.take(tags, ids.astype(np.intp))
        paint, _ = part.ground.paint(traced)
        full, left = paint[..., 0], paint[..., 1]
        painted = np.flatnonzero((full > HALF).ravel())
        painted = painted[left.ravel()[painted] > PAINT_SEEN * full.ravel()[painted]]
        ground = painted[ids.ravel()[painted] < first]
        semantic.ravel()[ground[ids.ravel()[ground] >= BARE]] = Tag.ROAD_LINE
        rows = part.sky.rows
        sky = part.buffers.get("four", (part.camera.height, part.camera.width, 4), np.uint8)[:rows]
        part.sky.draw(self._weather.panorama, traced.view.pose.heading, sky)
        semantic[:rows][(sky[..., TREE] > HALF) & (ids[:rows] == SKY)] = Tag.VEGETATION
        return np.asarray(semantic, np.uint8)

    @cached_property
    def instance(self) -> NDArray[np.int32]:
        """(height, width) int32, the thing in each pixel.

        It is the number of a box, a negative number for a thing of the map (see `roadside`), or 0 for ground and sky.
        """
        numbers = np.concatenate([np.zeros(len(self._traced.material), np.int32), self._faces.instances])
        return np.asarray(np.take(numbers, self._ids.astype(np.intp)), np.int32)

    @cached_property
    def _ids(self) -> NDArray[np.uint16]:
        """(height, width) the polygon in each pixel: those of the ground as in `Traced.ids`, then faces."""
        ids = self._traced.ids.copy()
        for k, shape in enumerate(self._faces.shapes, len(self._traced.material)):
            cv2.fillConvexPoly(ids, shape, k, cv2.LINE_8, SUBPIXEL)
        return ids


def _looked_up(table: NDArray[np.float32], ids: NDArray[np.intp], out: NDArray[np.float32]) -> NDArray[np.float32]:
    """Write the entries of a table with some indices, which it has, into an array of their shape, and return it."""
    return np.take(np.ascontiguousarray(table), ids, out=out, mode="clip")


def opaque(picture: Image) -> Image:
    """Return a picture (height, width, 3), BGR, as (height, width, 4), BGRA, all of it opaque."""
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2BGRA), np.uint8)
