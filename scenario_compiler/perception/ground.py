"""The ground: surfaces and paint drawn as polygons, then one world-fixed texture over all of them.

The texture is laid on the plane that the vehicle's wheels stand on, so it is fixed to the world on flat and
on evenly graded roads, and slides a little, far ahead, where the grade changes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.buffers import Buffers
from scenario_compiler.perception.camera import View, vehicle_axes
from scenario_compiler.perception.labels import Tag
from scenario_compiler.perception.lens import Lens
from scenario_compiler.perception.lighting import Air, Light
from scenario_compiler.perception.polygons import SUBPIXEL, Floats, Polygon, facing, nearness_planes
from scenario_compiler.perception.scene import Scene, Seen
from scenario_compiler.perception.textures import GRAIN, GRASS, PATCH, TEXEL, TILE, WEAR, ground_tile
from scenario_compiler.roads.mesh import Material, Paint

Image = NDArray[np.uint8]
Ids = NDArray[np.uint16]
Table = NDArray[np.float32]
Spot = tuple[Polygon, float]
"""A polygon of the image, and the share of the light that a shadow leaves in it, or the light that a lamp adds."""

LAYER_LIFT = 0.25
"""Height of a surface relative to one of the next layer below, m, that is assumed for the drawing order, so that of two
surfaces at one place the right one is drawn last although their heights differ by some centimetres.
"""

SKY, BARE, FIRST = 0, 1, 2
"""Numbers in the picture of surfaces: nothing drawn, the plane that the vehicle stands on, the first drawn surface."""

DECK = len(Material)
"""Material of the underside of a road."""

FINE = 700
"""Width above which the ground's texture is looked up for every second pixel only, because the texels are larger there.
"""

HARD = 3
"""Channel of an image of the ground that is 255 on hard ground and 0 on a meadow, until it is lit."""

SOFTEST = 64
"""Widest border of the light of a lamp on the ground, pixels."""

LEAST_WATER = 0.05
"""Least amount of water on the road that reflects."""

LEAST_MIRRORED = 0.02
"""Least share of reflected light that is visible."""

HIDDEN_MARGIN, HIDDEN_SHARE = 0.3, 1.03
"""A surface counts as in front of a thing if it is nearer by 0.3 m and 3 %."""

PAINT_SEEN = 0.15
"""Least share of the paint that must be left for a line in the labels."""

_MATERIALS: dict[int, tuple[tuple[int, int, int], bool, Tag]] = {
    Material.VERGE: ((58, 98, 82), True, Tag.TERRAIN),
    Material.ASPHALT: ((79, 80, 80), False, Tag.ROAD),
    Material.SHOULDER: ((72, 73, 75), False, Tag.ROAD),
    Material.CONCRETE: ((126, 131, 134), False, Tag.SIDEWALK),
    Material.GRASS: ((60, 106, 86), True, Tag.TERRAIN),
    Material.CYCLE: ((76, 82, 122), False, Tag.ROAD),
    DECK: ((50, 52, 54), False, Tag.BRIDGE),
}
"""Colour of each material (blue, green, red), whether it is a meadow, and its tag."""

_ALBEDO = np.array([_MATERIALS[k][0] for k in range(DECK + 1)], np.float32)
_SOFT = np.array([_MATERIALS[k][1] for k in range(DECK + 1)])
MATERIAL_TAGS = np.array([_MATERIALS[k][2] for k in range(DECK + 1)], np.uint8)

_PAINTS = {
    Paint.WHITE: (227, 227, 227),
    Paint.YELLOW: (50, 172, 209),
    Paint.BLUE: (185, 110, 50),
    Paint.GREEN: (80, 160, 60),
    Paint.RED: (50, 50, 190),
    Paint.ORANGE: (40, 125, 225),
    Paint.VIOLET: (150, 60, 130),
    Paint.BLACK: (40, 40, 40),
}
_PAINT = np.array([_PAINTS[paint] for paint in Paint], np.float32)

_HARD_WHEN_WET, _SOFT_WHEN_WET = 0.45, 0.15
"""Factors by which water darkens hard ground and meadows."""


_PUDDLES = (0.8 + 0.4 * np.clip(np.abs(2.0 * np.arange(256) - 230.0), 0, 255) / 255.0).astype(np.float32)
"""Additional reflection of hard ground in the hollows of its patches, by the texture."""

_MEADOW_MIRRORS = 0.25


@dataclass(frozen=True, eq=False)
class Traced:
    """The ground that a camera sees. K surfaces.

    Attributes:
        view: The camera in the world.
        top: First row of the image that may show anything but sky.
        surfaces: The surfaces, each before those that cover it.
        material: (K + FIRST,) uint8 material by id, a `Material` or DECK; that of SKY has no meaning. On hilly maps
            (2 K + FIRST,): after the surfaces come the slopes below them, which are verge.
        marks: The paint, each mark before those that cover it.
        lens: The camera's view of the plane that the vehicle stands on.
        relief: Whether the map is hilly.
    """

    view: View
    top: int
    surfaces: Seen
    material: NDArray[np.uint8]
    marks: Seen
    lens: Lens
    relief: bool

    @cached_property
    def ids(self) -> Ids:
        """(height, width) uint16, the surface in each pixel: SKY, BARE, or `FIRST` plus the number of a surface.

        Numbers after those of the surfaces are the slopes below them.
        """
        ids = np.zeros((self.view.camera.height, self.view.camera.width), np.uint16)
        ids[self.lens.top :] = self.lens.sees_ground
        for k, shape in enumerate(self.surfaces.shapes, FIRST):
            cv2.fillConvexPoly(ids, shape, k, cv2.LINE_8, SUBPIXEL)
        slopes = (len(self.material) - FIRST) // 2 if self.relief else 0
        _fill_below_hills(_upright(ids[self.top : self.lens.sky_rows], self.view), self.material, slopes)
        return ids


@dataclass(frozen=True, eq=False)
class Spots:
    """Shadows and lights on parts of the ground."""

    shadows: Sequence[Spot] = ()
    beams: Sequence[Spot] = ()


class Ground:
    """Draws the ground of one scene for one camera."""

    def __init__(self, scene: Scene, lens: Lens, buffers: Buffers) -> None:
        """Prepare everything that depends on neither pose nor weather."""
        self.scene, self.lens, self.buffers = scene, lens, buffers
        self.camera = lens.camera
        self.step = 2 if self.camera.width > FINE else 1
        coarse = (slice(None, None, self.step), slice(None, None, self.step))
        self.x, self.y = (np.ascontiguousarray(table[coarse]) for table in (lens.x, lens.y))
        self.distance = np.ascontiguousarray(lens.distance[coarse])
        footprint = lens.footprint[coarse]
        self.grain = (0.384 * np.clip(1.1 - footprint / 0.12, 0, 1)).astype(np.float32)
        self.patch = np.clip(1.1 - footprint / 1.5, 0, 1).astype(np.float32)
        self.wear = np.clip(1.2 - footprint / 0.35, 0, 1).astype(np.float32)

    def trace(self, view: View, surfaces: Seen, marks: Seen) -> Traced:
        """Sort surfaces and marks in drawing order, and remove the marks that a hill hides."""
        layer, relief = self.scene.layer[surfaces.index], self.scene.relief
        if relief:
            surfaces, from_below = _from_far(view, surfaces, layer)
            bridge = self.scene.bridge[surfaces.index]
        else:
            surfaces = surfaces.only(np.argsort(layer, kind="stable"))
            from_below = bridge = np.zeros(len(layer), np.bool_)
        count = len(layer)
        material = np.full(FIRST + (2 * count if relief else count), Material.VERGE, np.uint8)
        below = np.where(bridge, np.uint8(DECK), np.uint8(Material.VERGE))
        material[FIRST : FIRST + count] = np.where(from_below, below, self.scene.material[surfaces.index])
        top = self.lens.top
        if relief:
            highest = min((int(shape[:, 1].min()) for shape in surfaces.shapes), default=top << SUBPIXEL)
            top = min(max((highest >> SUBPIXEL) - 1, 0), top)
        marks = marks.only(np.argsort(-marks.middle[2], kind="stable"))
        traced = Traced(view, top, surfaces, material, marks, self.lens, relief)
        if not relief:
            return traced
        seen = ~hidden(traced.ids, surfaces, marks.points, view)
        return replace(traced, marks=marks.only(np.flatnonzero(seen)))

    def paint(self, traced: Traced) -> tuple[Image, Image | None]:
        """Draw the paint.

        Returns:
            (height, width, 4) uint8 coverage, and coverage times quality, whose ratio is the quality up to the rim; the
            other
            channels are 0, because OpenCV smooths the edges only in images of one, three or four channels; (height,
            width)
            uint8 a `Paint`, None if all is white.
        """
        table, marks = self.scene.marks, traced.marks
        coverage = 255.0 * np.minimum(marks.thickness, 1.0)
        left = coverage * np.clip(table.quality[marks.index], 0.0, 1.0)
        tones = table.colour[marks.index]
        paint = self.buffers.get("paint", (self.camera.height, self.camera.width, 4), np.uint8)
        paint.fill(0)
        colours = np.zeros(paint.shape[:2], np.uint8) if tones.any() else None
        for shape, full, part, tone in zip(marks.shapes, coverage.tolist(), left.tolist(), tones.tolist(), strict=True):
            if part < 2.0:
                continue
            cv2.fillConvexPoly(paint, shape, (full, part), cv2.LINE_AA, SUBPIXEL)
            if colours is not None:
                cv2.fillConvexPoly(colours, shape, tone, cv2.LINE_8, SUBPIXEL)
        return paint, None if colours is None else np.asarray(cv2.dilate(colours, np.ones((3, 3), np.uint8)), np.uint8)

    def shade(self, traced: Traced, weather: GroundWeather, spots: Spots, into: Image) -> Table | None:
        """Draw the lit ground, before the effects of the air.

        Args:
            traced: The ground.
            weather: The weather.
            spots: Shadows, and light from lamps.
            into: (height, width, 4) the image; pixels of the sky are undefined.

        Returns:
            The share of light that the ground reflects, for rows from `lens.top` as far as it is visible, in steps of
            `step`
            pixels; None if it is dry.
        """
        first = self.lens.top
        palette = weather.palette(traced)
        into.view(np.uint32)[first:] = palette[BARE].view(np.uint32)
        for shape, colour in zip(traced.surfaces.shapes, palette[FIRST:].tolist(), strict=False):
            cv2.fillConvexPoly(into, shape, colour, cv2.LINE_8, SUBPIXEL)
        if traced.top < first:
            hills = np.take(weather.hills(traced), traced.ids[traced.top : first])
            into[traced.top : first] = hills.view(np.uint8).reshape(*hills.shape, 4)
        below = into[first:]
        texture = self._texture(traced.view)
        hard = self.buffers.get("hard", self.x.shape, np.uint8)
        np.copyto(hard, below[:: self.step, :: self.step, HARD])
        gain, mirror = weather.gain(texture, hard)
        shadow, beam = self._shadow(spots.shadows), self._beam(spots.beams)
        if shadow is not None:
            cv2.multiply(gain, shadow, gain, scale=1.0 / 255.0)
        if beam is not None:
            cv2.add(gain, beam, gain)
        if self.step > 1:
            gain = np.asarray(cv2.resize(gain, below.shape[1::-1], self.buffers.get("gain", below.shape[:2], np.uint8)))
        four = self.buffers.get("four", into.shape, np.uint8)[first:]
        cv2.multiply(below, cv2.merge((gain, gain, gain, gain), four), below, scale=1.0 / 128.0)
        self._apply_paint(below, traced, texture, (shadow, beam), weather)
        return mirror

    def _shadow(self, spots: Sequence[Spot]) -> Image | None:
        """Return the share of the light that shadows leave, of 255, by the texture's pixels; None if there are none."""
        if not spots:
            return None
        shift = SUBPIXEL + self.step - 1
        first = np.array((0, self.lens.top << SUBPIXEL), np.int32)
        left = self.buffers.get("shadow", self.x.shape, np.uint8)
        left.fill(255)
        for polygon, share in spots:
            cv2.fillConvexPoly(left, polygon - first, 255.0 * share, cv2.LINE_AA, shift)
        return left

    def _beam(self, spots: Sequence[Spot]) -> Image | None:
        """Return the light that lamps add, 128 for that of a clear noon, by the texture's pixels; None if none do."""
        if not spots:
            return None
        light = self.buffers.get("beam", self.x.shape, np.uint8)
        light.fill(0)
        for polygon, strength in spots:
            _add_beam(light, polygon - np.array((0, self.lens.top << SUBPIXEL), np.int32), strength, self.step)
        return light

    def _texture(self, view: View) -> Image:
        heading = view.pose.heading
        cos, sin = math.cos(heading) / (TEXEL * TILE), math.sin(heading) / (TEXEL * TILE)
        foot = (view.foot - self.scene.origin) / (TEXEL * TILE)
        shape = self.x.shape
        column, row, whole = (self.buffers.get(name, shape, np.float32) for name in ("column", "row", "whole"))
        cv2.addWeighted(self.x, cos, self.y, -sin, float(foot[0] % 1.0), column)
        cv2.addWeighted(self.x, sin, self.y, cos, float(foot[1] % 1.0), row)
        for table in (column, row):
            np.subtract(table, np.floor(table, out=whole), out=table)
            np.multiply(table, np.float32(TILE), out=table)
        texels = self.buffers.get("texels", (*shape, 4), np.uint8)
        cv2.remap(ground_tile(self.scene.texture), column, row, cv2.INTER_LINEAR, texels, borderMode=cv2.BORDER_WRAP)
        return texels

    def _apply_paint(
        self,
        image: Image,
        traced: Traced,
        texture: Image,
        lit_by: tuple[Image | None, Image | None],
        weather: GroundWeather,
    ) -> None:
        """Blend paint over the ground; it wears away in patches, following the wear texture.

        Args:
            image: The ground from row `lens.top` on; it is changed.
            traced: The ground.
            texture: The ground's texture.
            lit_by: The light that shadows leave and that lamps add (see `_shadow` and `_beam`).
            weather: The weather.
        """
        first, width = self.lens.top, self.camera.width
        covered, tones = self.paint(traced)
        paint = covered.view(np.uint32)[first:].ravel()
        place = np.flatnonzero(np.not_equal(paint, 0, out=self.buffers.get("painted", paint.shape, np.bool_)))
        if not len(place):
            return
        coarse = place
        if self.step > 1:
            row, column = np.divmod(place, width)
            coarse = row // self.step * texture.shape[1] + column // self.step
        coverage, part = paint[place].view(np.uint8).reshape(-1, 4).T[:2, None].astype(np.float32)
        texels = texture.view(np.uint32).ravel()[coarse].view(np.uint8).reshape(-1, 4)
        quality = part / coverage
        near = self.wear.ravel()[coarse]
        eroded = np.clip((quality * 1.12 - texels[:, WEAR] * np.float32(1.0 / 255.0)) * 7.0 + 0.4, 0, 1)
        left = (eroded * near + quality * (1.0 - near)) * (0.45 + 0.55 * quality)
        alpha = cv2.convertScaleAbs(coverage * left, alpha=weather.contrast)
        rough = 1.0 + (texels[:, GRAIN] - np.float32(128.0)) * (np.float32(0.0042) * self.grain.ravel()[coarse])
        shadow, beam = (None if one is None else one.ravel()[coarse] for one in lit_by)
        light = weather.light.ravel()[coarse]
        if shadow is not None:
            light *= shadow * np.float32(1.0 / 255.0)
        if beam is not None:
            light += beam * np.float32(1.0 / 128.0)
        lit = cv2.convertScaleAbs((rough * light)[None], alpha=128.0)
        pixels = image.view(np.uint32).ravel()
        below = pixels[place].view(np.uint8).reshape(1, -1, 4)
        colours = np.zeros(len(place), np.uint8) if tones is None else tones[first:].ravel()[place]
        target = np.take(weather.paint, colours).view(np.uint8).reshape(1, -1, 4)
        full = cv2.multiply(target, cv2.merge((lit,) * 4), scale=1.0 / 128.0)
        mixed = cv2.multiply(full, cv2.merge((alpha,) * 4), scale=1.0 / 255.0)
        rest = cv2.bitwise_not(alpha)
        mixed = cv2.add(mixed, cv2.multiply(below, cv2.merge((rest,) * 4), scale=1.0 / 255.0))
        pixels[place] = mixed.view(np.uint32).ravel()


class GroundWeather:
    """Prepared tables for one weather and one camera."""

    def __init__(self, ground: Ground, light: Light) -> None:
        """Combine the light and the haze with the tables of the texture."""
        look = light.look
        self._luminance, self._air, self._buffers = look.luminance, Air(look), ground.buffers
        self.contrast = look.contrast
        seen = self._air.seen(ground.distance)
        self.light = light.at(ground.x, ground.y) * seen
        patch = np.float32(0.384) * ground.patch
        self._road = (
            ground.grain * self.light,
            patch * self.light,
            (128.0 - 128.0 * (ground.grain + patch)) * self.light,
        )
        meadow = np.float32(0.576) * ground.patch
        self._meadow = meadow * self.light, (128.0 - 128.0 * meadow) * self.light
        wet = np.where(_SOFT, 1.0 - _SOFT_WHEN_WET * look.wet, 1.0 - _HARD_WHEN_WET * look.wet)
        self._colours = _ALBEDO * wet[:, None] * look.tint
        self._palette = _packed(self._colours).view(np.uint8).reshape(-1, 4)
        self._palette[:, HARD] = np.where(_SOFT, 0, 255)
        self.paint = _packed(_PAINT * look.tint)
        veil = self._air.colour * (1.0 - self._air.seen(ground.lens.distance))[..., None]
        self.veil = np.zeros((*veil.shape[:2], 4), np.uint8)
        self.veil[..., :3] = np.rint(veil)
        self._mirror: Table | None = None
        if look.wet > LEAST_WATER:
            depression = np.degrees(np.arctan2(np.float32(ground.camera.z), ground.distance))
            mirror = 0.75 * np.exp(-depression / 2.6) * np.float32(look.wet) * seen
            rows = np.flatnonzero((mirror > LEAST_MIRRORED).any(axis=1))
            self._mirror = mirror[: rows[-1] + 1] if len(rows) else None

    def palette(self, traced: Traced) -> NDArray[np.uint8]:
        """Return for each id its colour in full light, and 255 for hard ground, (K + FIRST, 4)."""
        return self._palette[traced.material]

    def hills(self, traced: Traced) -> NDArray[np.uint32]:
        """Return the lit and hazed colour of each id where it rises above the plane that the vehicle stands on.

        Such ground is far away: its texture is not visible, and the haze is the same for a whole surface.
        """
        middle = traced.surfaces.middle
        away = np.sqrt((middle * middle).sum(axis=0)).astype(np.float32)
        distance = np.concatenate([np.full(FIRST, 150.0, np.float32), away, away])
        seen = self._air.seen(distance)[:, None]
        lit = self._colours[traced.material] * self._luminance
        return _packed(lit * seen + self._air.colour * (1.0 - seen))

    def gain(self, texture: Image, hard: Image) -> tuple[Image, Table | None]:
        """Return the brightness of the ground, 128 for that of its colour, and the share of light that it reflects."""
        shape, get = hard.shape, self._buffers.get
        road, meadow, part = (get(name, shape, np.float32) for name in ("road", "meadow", "whole"))
        channel = get("channel", shape, np.uint8)
        a, b, rest = self._road
        cv2.multiply(cv2.extractChannel(texture, GRAIN, channel), a, road, dtype=cv2.CV_32F)
        patch = cv2.extractChannel(texture, PATCH, get("patch", shape, np.uint8))
        road += np.asarray(cv2.multiply(patch, b, part, dtype=cv2.CV_32F), np.float32)
        road += rest
        c, base = self._meadow
        cv2.multiply(cv2.extractChannel(texture, GRASS, channel), c, meadow, dtype=cv2.CV_32F)
        meadow += base
        cv2.copyTo(road, hard, meadow)
        mirror = None
        if self._mirror is not None:
            rows = len(self._mirror)
            mirror, rest = road[:rows], part[:rows]
            mirror.fill(_MEADOW_MIRRORS)
            cv2.copyTo(cv2.LUT(patch[:rows], _PUDDLES), hard[:rows], mirror)
            mirror *= self._mirror
            meadow[:rows] *= np.subtract(np.float32(1.0), mirror, out=rest)
        return np.asarray(cv2.convertScaleAbs(meadow, channel), np.uint8), mirror


def bare_plane(view: View) -> Floats:
    """Return the coefficients (3,) of 1 / depth of the plane that the vehicle stands on."""
    up = view.rotation @ vehicle_axes(view.pose)[:, 2]
    return np.asarray(-up / max(view.camera.z, 1e-3))


def hidden(ids: Ids, surfaces: Seen, points: Floats, view: View) -> NDArray[np.bool_]:
    """Return which things the ground hides: those with a surface in front of at least half of their corners.

    Args:
        ids: The picture of surfaces.
        surfaces: The surfaces in it.
        points: (3, N, K) corners of K things, camera axes.
        view: The camera in the world.
    """
    camera = view.camera
    planes = nearness_planes(surfaces.points)
    depth = np.maximum(points[2], 1e-3)
    x, y = points[0] / depth, points[1] / depth
    u = np.rint(np.clip(x * camera.focal + camera.width / 2.0, -1, camera.width)).astype(np.int64)
    v = np.rint(np.clip(y * camera.focal + camera.height / 2.0, -1, camera.height)).astype(np.int64)
    inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height) & (points[2] > 0.0)
    there = np.where(inside, ids[np.where(inside, v, 0), np.where(inside, u, 0)], SKY).astype(np.int64)
    inside &= (there >= FIRST) & (there < FIRST + len(surfaces.index))
    a, b, c = planes[:, np.where(inside, there - FIRST, 0)] if planes.size else np.zeros((3, *there.shape))
    in_front = inside & ((a * x + b * y + c) * (depth - HIDDEN_MARGIN) > HIDDEN_SHARE)
    return np.asarray(2 * in_front.sum(axis=0) >= len(depth))


def _from_far(view: View, surfaces: Seen, layer: NDArray[np.uint8]) -> tuple[Seen, NDArray[np.bool_]]:
    """Return the surfaces in drawing order, and which of them show their underside.

    A level surface below the eye is covered only by higher ones, one above it by lower ones, because a falling line of
    sight meets the higher one first. So the height difference to the eye determines the order.
    """
    height = view.rotation[:, 2] @ surfaces.middle
    order = np.argsort(LAYER_LIFT * layer - np.abs(height), kind="stable")
    surfaces = surfaces.only(order)
    return surfaces, facing(surfaces.points)


def _upright(ids: Ids, view: View) -> Ids:
    """Return a view of the picture that is turned by quarters so that down in the world is about down in it."""
    right, down, _ = -view.camera.rotation[:, 2]
    if abs(right) <= abs(down):
        return ids if down >= 0.0 else np.rot90(ids, 2)
    return np.rot90(ids, -1 if right > 0.0 else 1)


def _fill_below_hills(strip: Ids, material: NDArray[np.uint8], slopes: int) -> None:
    """Replace sky below ground that rises above the horizon by the slope below it, but not below a bridge.

    Args:
        strip: The picture of surfaces, which is changed; its rows go downwards in the world.
        material: The materials by id.
        slopes: Number of the slopes, which come after the surfaces; 0 on a plane, where the bare ground is below.
    """
    if not len(strip):
        return
    solid = (strip >= FIRST) & (material[strip] != DECK)
    if not solid.any():
        return
    rows = np.arange(len(strip))[:, None]
    last = np.maximum.accumulate(np.where(solid, rows, -1), axis=0)
    sky = np.nonzero((last >= 0) & (strip == SKY))
    strip[sky] = strip[last[sky], sky[1]] + slopes if slopes else BARE


def _add_beam(light: Image, polygon: Polygon, strength: float, step: int) -> None:
    """Add the light of a lamp in a polygon, with soft borders; `light` is in steps of pixels, the polygon in pixels."""
    shift = SUBPIXEL + step - 1
    low, high = polygon.min(axis=0) >> shift, polygon.max(axis=0) >> shift
    soft = np.minimum((high - low) // 3 + 1, SOFTEST)
    x0, y0 = np.maximum(low - soft - 1, 0).tolist()
    x1, y1 = np.minimum(high + soft + 2, light.shape[1::-1]).tolist()
    if x1 - x0 < 2 or y1 - y0 < 2:
        return
    part = light[y0:y1, x0:x1]
    mask = np.zeros(part.shape, np.uint8)
    corner = np.array((x0, y0), np.int32) << shift
    cv2.fillConvexPoly(mask, polygon - corner, 128.0 * strength, cv2.LINE_AA, shift)
    cv2.add(part, np.asarray(cv2.blur(mask, soft.tolist()), np.uint8), part)


def _packed(colours: NDArray[np.floating]) -> NDArray[np.uint32]:
    """Return colours (N, 3), blue, green, red, as four bytes each."""
    whole = np.zeros((len(colours), 4), np.uint8)
    whole[:, :3] = np.clip(np.rint(colours), 0, 255)
    return whole.view(np.uint32)[:, 0]
