"""The ground: surfaces and paint drawn as polygons, then one world-fixed texture over all of them.

Texture, light and haze of the plane that the vehicle's wheels stand on are prepared in tables. In the rows of the image
where the ground leaves this plane, they are computed for each picture (see `slopes`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

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
from scenario_compiler.perception.slopes import Far, Slopes, uneven_rows
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

GRAIN_GONE, PATCH_GONE = 0.12, 1.5
"""Lengths of a pixel on the ground at which the texture's grain and its patches disappear, m."""

GRAIN_SEEN = 0.384
"""Contrast of the grain next to the camera."""

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
        paint: The paint, each mark before those that cover it.
        lens: The camera's view of the plane that the vehicle stands on.
        relief: Whether the map is hilly.
    """

    view: View
    top: int
    surfaces: Seen
    material: NDArray[np.uint8]
    paint: Seen
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
        _fill_below_hills(_upright(ids[self.top : self.lens.sky_rows], self.view), self.material, self.slopes)
        return ids

    @cached_property
    def even(self) -> int:
        """First row from which on all ground is about the plane that the vehicle stands on; `top` if all of it is."""
        if not self.relief:
            return self.top
        limits = np.full(len(self.material), -1, np.int16)
        limits[FIRST : FIRST + len(self.surfaces.index)] = self._uneven
        last = int(limits.max())
        if last < 0 and self.top == self.lens.top:
            return self.top
        first = max(self.lens.sky_rows, self.lens.top)
        rows = np.arange(first, last + 1)[:, None]
        uneven = np.flatnonzero((np.take(limits, self.ids[first : last + 1], mode="clip") >= rows).any(axis=1))
        return first + (int(uneven[-1]) + 1 if len(uneven) else 0)

    @cached_property
    def _uneven(self) -> NDArray[np.int16]:
        return uneven_rows(self.surfaces, self.view)

    @property
    def hides(self) -> bool:
        """Whether the ground may hide something: not all of it is the plane that the vehicle stands on."""
        return self.relief and bool((self._uneven >= 0).any())

    @property
    def slopes(self) -> int:
        """Number of the slopes below surfaces."""
        return len(self.surfaces.index) if self.relief else 0

    @cached_property
    def planes(self) -> Floats:
        """(ids, 3) coefficients of 1 / depth of each id (see `nearness_planes`); 0 for the sky."""
        planes = np.zeros((len(self.material), 3))
        planes[BARE] = bare_plane(self.view)
        count = len(self.surfaces.index)
        planes[FIRST : FIRST + count] = nearness_planes(self.surfaces.points).T
        planes[FIRST + count :] = planes[FIRST : FIRST + self.slopes]
        return planes

    @cached_property
    def centres(self) -> Floats:
        """(ids,) 1 / depth of the centre of each id, 1/m; that of a surface is positive."""
        centres = np.full(len(self.material), np.inf)
        count = len(self.surfaces.index)
        centres[FIRST : FIRST + count] = 1.0 / np.maximum(self.surfaces.middle[2], 1e-2)
        centres[FIRST + count :] = centres[FIRST : FIRST + self.slopes]
        return centres

    @cached_property
    def marks(self) -> Seen:
        """The paint that no hill hides."""
        if not self.hides:
            return self.paint
        return self.paint.only(np.flatnonzero(~hidden(self, self.paint.points)))


@dataclass(frozen=True, eq=False)
class Spots:
    """Shadows and lights on parts of the ground."""

    shadows: Sequence[Spot] = ()
    beams: Sequence[Spot] = ()


class Shaded(NamedTuple):
    """What is still to be added to the drawn ground.

    Attributes:
        mirror: (reflecting rows, columns) the share of light that the ground reflects, from row `Traced.top` on as far
            as it is visible, in steps of `Ground.step` pixels; None if it is dry.
        veil: (rows, width, 4) the light of the air before the ground, from row `Traced.top` on as far as the ground is
            uneven; None if all of it is even.
    """

    mirror: Table | None
    veil: Image | None


class Lit(NamedTuple):
    """Tables of some rows of the ground in one weather, in steps of `Ground.step` pixels.

    Attributes:
        footprint: Length of a pixel on the ground along the line of sight, m.
        light: The light, less the share that the air takes.
        road: Factors of the texture's grain and patches on hard ground, and what is added.
        meadow: Factor of the texture's grass, and what is added.
        mirror: Share of the light that the ground reflects, as far down as it is visible; None if there is none.
    """

    footprint: Table
    light: Table
    road: tuple[Table, Table, Table]
    meadow: tuple[Table, Table]
    mirror: Table | None

    def after(self, row: int) -> Lit:
        """Return the tables from a row on."""
        if not row:
            return self
        (a, b, rest), (c, base), mirror = self.road, self.meadow, self.mirror
        left = None if mirror is None or row >= len(mirror) else mirror[row:]
        road, meadow = (a[row:], b[row:], rest[row:]), (c[row:], base[row:])
        return Lit(self.footprint[row:], self.light[row:], road, meadow, left)


class _Part(NamedTuple):
    """Rows of the drawn ground, in steps of `Ground.step` pixels, and their tables."""

    rows: slice
    lit: Lit

    def looked_up(self, table: Table, index: NDArray[np.intp]) -> Table:
        """Return the entries of one of its tables at places in all rows."""
        return np.asarray(table.ravel()[index - self.rows.start * table.shape[1]], np.float32)


class Ground:
    """Draws the ground of one scene for one camera.

    Attributes:
        step: The texture is looked up for every `step`-th pixel.
        shape: Most rows and columns of the ground in these steps.
    """

    def __init__(self, scene: Scene, lens: Lens, buffers: Buffers) -> None:
        """Prepare everything that depends on neither pose nor weather."""
        self.scene, self.lens, self.buffers = scene, lens, buffers
        self.camera = lens.camera
        self.step = 2 if self.camera.width > FINE else 1
        coarse = (slice(None, None, self.step), slice(None, None, self.step))
        self.x, self.y = (np.ascontiguousarray(table[coarse]) for table in (lens.x, lens.y))
        self.distance = np.ascontiguousarray(lens.distance[coarse])
        self.footprint = np.ascontiguousarray(lens.footprint[coarse])
        self.slopes = Slopes(self.camera, self.step, buffers)
        high = -(-self.camera.height // self.step) if scene.relief else len(self.x)
        self.shape = high, self.x.shape[1]

    def trace(self, view: View, surfaces: Seen, marks: Seen) -> Traced:
        """Sort surfaces and marks in drawing order, and remove the marks that a hill hides."""
        layer, relief = self.scene.layer[surfaces.index], self.scene.relief
        if relief:
            surfaces, from_below = _from_far(view, surfaces, layer)
            bridge = self.scene.bridge[surfaces.index]
        else:
            surfaces = surfaces.only(np.argsort(layer, kind="stable"))
            from_below = bridge = np.zeros(len(layer), np.bool_)
        count = len(surfaces.index)
        material = np.full(FIRST + (2 * count if relief else count), Material.VERGE, np.uint8)
        below = np.where(bridge, np.uint8(DECK), np.uint8(Material.VERGE))
        material[FIRST : FIRST + count] = np.where(from_below, below, self.scene.material[surfaces.index])
        top = self.lens.top
        if relief and count:
            top = min(max(_first_row(surfaces) - 1, 0), top)
        marks = marks.only(np.argsort(-marks.middle[2], kind="stable"))
        return Traced(view, top, surfaces, material, marks, self.lens, relief)

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

    def shade(self, traced: Traced, weather: GroundWeather, spots: Spots, into: Image) -> Shaded:
        """Draw the lit ground, before the effects of the air.

        Args:
            traced: The ground.
            weather: The weather.
            spots: Shadows, and light from lamps.
            into: (height, width, 4) the image; pixels of the sky are undefined.
        """
        below, step = into[traced.top :], self.step
        self._colour(traced, weather.palette(traced), into)
        count = -(-len(below) // step)
        uneven = min(-(-(traced.even - traced.top) // step), count)
        even = len(self.x) - (count - uneven)
        parts, veil, far = [], None, None
        if uneven:
            far = self.slopes.measure(traced, uneven)
            lit, veil = weather.uneven(far, min(uneven * step, len(below)))
            parts.append(_Part(slice(0, uneven), lit))
        if uneven < count:
            parts.append(_Part(slice(uneven, count), weather.even.after(even)))
        texture = self._texture(traced, far, count)
        hard = self.buffers.get("hard", self.shape, np.uint8)[:count]
        np.copyto(hard, below[::step, ::step, HARD])
        mirrored = sum(weather.light_up(part.rows, texture, hard, part.lit) for part in parts)
        gain, mirror = weather.gain(count), weather.mirror(mirrored) if mirrored else None
        shadow, beam = self._shadow(spots.shadows, traced.top, count), self._beam(spots.beams, traced.top, count)
        if shadow is not None:
            cv2.multiply(gain, shadow, gain, scale=1.0 / 255.0)
        if beam is not None:
            cv2.add(gain, beam, gain)
        if step > 1:
            fine = self.buffers.get("gain", into.shape[:2], np.uint8)[: len(below)]
            gain = np.asarray(cv2.resize(gain, below.shape[1::-1], fine))
        four = self.buffers.get("four", into.shape, np.uint8)[traced.top :]
        cv2.multiply(below, cv2.merge((gain, gain, gain, gain), four), below, scale=1.0 / 128.0)
        self._apply_paint(below, traced, texture, parts, (shadow, beam), weather)
        return Shaded(mirror, veil)

    def _colour(self, traced: Traced, palette: Image, into: Image) -> None:
        """Draw the surfaces in full light, and in the channel `HARD` whether they are hard."""
        pixels = into.view(np.uint32)[traced.top :, :, 0]
        colours = palette.view(np.uint32)[:, 0]
        if traced.even > traced.top:
            np.take(colours, traced.ids[traced.top :], out=pixels, mode="clip")
            return
        pixels[:] = colours[BARE]
        for shape, colour in zip(traced.surfaces.shapes, palette[FIRST:].tolist(), strict=False):
            cv2.fillConvexPoly(into, shape, colour, cv2.LINE_8, SUBPIXEL)

    def _shadow(self, spots: Sequence[Spot], first: int, count: int) -> Image | None:
        """Return the share of the light that shadows leave, of 255, by the texture's pixels; None if there are none.

        Args:
            spots: The shadows.
            first: First row of the image.
            count: Number of rows, in steps of pixels.
        """
        if not spots:
            return None
        shift = SUBPIXEL + self.step - 1
        corner = np.array((0, first << SUBPIXEL), np.int32)
        left = self.buffers.get("shadow", self.shape, np.uint8)[:count]
        left.fill(255)
        for polygon, share in spots:
            cv2.fillConvexPoly(left, polygon - corner, 255.0 * share, cv2.LINE_AA, shift)
        return left

    def _beam(self, spots: Sequence[Spot], first: int, count: int) -> Image | None:
        """Return the light that lamps add, 128 for that of a clear noon, by the texture's pixels; None if none do."""
        if not spots:
            return None
        light = self.buffers.get("beam", self.shape, np.uint8)[:count]
        light.fill(0)
        for polygon, strength in spots:
            _add_beam(light, polygon - np.array((0, first << SUBPIXEL), np.int32), strength, self.step)
        return light

    def _texture(self, traced: Traced, far: Far | None, count: int) -> Image:
        """Return the texture of each of `count` rows; `far` is the uneven ground in the first of them."""
        view, whole_tile = traced.view, TEXEL * TILE
        axes = vehicle_axes(view.pose if self.scene.relief else view.pose._replace(pitch=0.0, roll=0.0))
        foot = (view.foot - self.scene.origin) / whole_tile
        column, row, whole = (
            self.buffers.get(name, self.shape, np.float32)[:count] for name in ("column", "row", "whole")
        )
        uneven = 0 if far is None else len(far.depth)
        even = len(self.x) - (count - uneven)
        for axis, table in enumerate((column, row)):
            if uneven < count:
                ahead, left = (axes[axis, :2] / whole_tile).tolist()
                part = table[uneven:]
                cv2.addWeighted(self.x[even:], ahead, self.y[even:], left, float(foot[axis] % 1.0), part)
            if far is not None:
                eye = (view.position[axis] - self.scene.origin[axis]) / whole_tile
                far.along(view.rotation[:, axis] / whole_tile, table[:uneven])
                table[:uneven] += np.float32(eye % 1.0)
            np.subtract(table, np.floor(table, out=whole), out=table)
            np.multiply(table, np.float32(TILE), out=table)
        texels = self.buffers.get("texels", (*self.shape, 4), np.uint8)[:count]
        cv2.remap(ground_tile(self.scene.texture), column, row, cv2.INTER_LINEAR, texels, borderMode=cv2.BORDER_WRAP)
        return texels

    def _apply_paint(
        self,
        image: Image,
        traced: Traced,
        texture: Image,
        parts: Sequence[_Part],
        lit_by: tuple[Image | None, Image | None],
        weather: GroundWeather,
    ) -> None:
        """Blend paint over the ground; it wears away in patches, following the wear texture.

        Args:
            image: The ground from row `Traced.top` on; it is changed.
            traced: The ground.
            texture: The ground's texture.
            parts: All parts of the ground.
            lit_by: The light that shadows leave and that lamps add (see `_shadow` and `_beam`).
            weather: The weather.
        """
        first, width = traced.top, self.camera.width
        covered, tones = self.paint(traced)
        paint = covered.view(np.uint32)[first:].ravel()
        found = self.buffers.get("painted", (self.camera.height * width,), np.bool_)[: len(paint)]
        place = np.flatnonzero(np.not_equal(paint, 0, out=found))
        if not len(place):
            return
        coarse = place
        if self.step > 1:
            row, column = np.divmod(place, width)
            coarse = row // self.step * texture.shape[1] + column // self.step
        coverage, kept = paint[place].view(np.uint8).reshape(-1, 4).T[:2, None].astype(np.float32)
        texels = texture.view(np.uint32).ravel()[coarse].view(np.uint8).reshape(-1, 4)
        quality = kept / coverage
        ends = np.searchsorted(place, [part.rows.stop * self.step * width for part in parts])
        pieces = [(part, coarse[begin:end]) for part, begin, end in zip(parts, [0, *ends], ends, strict=False)]
        footprint = np.concatenate([part.looked_up(part.lit.footprint, index) for part, index in pieces])
        light = np.concatenate([part.looked_up(part.lit.light, index) for part, index in pieces])
        near = np.clip(np.float32(1.2) - footprint / np.float32(0.35), 0, 1)
        eroded = np.clip((quality * 1.12 - texels[:, WEAR] * np.float32(1.0 / 255.0)) * 7.0 + 0.4, 0, 1)
        left = (eroded * near + quality * (1.0 - near)) * (0.45 + 0.55 * quality)
        alpha = cv2.convertScaleAbs(coverage * left, alpha=weather.contrast)
        rough = 1.0 + (texels[:, GRAIN] - np.float32(128.0)) * (
            np.float32(0.0042) * _visible(footprint, GRAIN_GONE, GRAIN_SEEN)
        )
        shadow, beam = (None if one is None else one.ravel()[coarse] for one in lit_by)
        if shadow is not None:
            light *= shadow * np.float32(1.0 / 255.0)
        if beam is not None:
            light += beam * np.float32(1.0 / 128.0)
        bright = cv2.convertScaleAbs((rough * light)[None], alpha=128.0)
        pixels = image.view(np.uint32).ravel()
        below = pixels[place].view(np.uint8).reshape(1, -1, 4)
        colours = np.zeros(len(place), np.uint8) if tones is None else tones[first:].ravel()[place]
        target = np.take(weather.paint, colours).view(np.uint8).reshape(1, -1, 4)
        full = cv2.multiply(target, cv2.merge((bright,) * 4), scale=1.0 / 128.0)
        mixed = cv2.multiply(full, cv2.merge((alpha,) * 4), scale=1.0 / 255.0)
        rest = cv2.bitwise_not(alpha)
        mixed = cv2.add(mixed, cv2.multiply(below, cv2.merge((rest,) * 4), scale=1.0 / 255.0))
        pixels[place] = mixed.view(np.uint32).ravel()


class GroundWeather:
    """Prepared tables for one weather and one camera.

    Attributes:
        even: Those of the plane that the vehicle stands on, from row `lens.top` on.
        veil: (rows, width, 4) the light of the air before this plane.
        contrast: Share of the contrast of paint that is left.
        paint: Colours of paint in full light.
    """

    def __init__(self, ground: Ground, light: Light) -> None:
        """Combine the light and the haze with the tables of the texture."""
        look = light.look
        self._light, self._air, self._buffers, self._shape = light, Air(look), ground.buffers, ground.shape
        self._width = ground.camera.width
        self.contrast = look.contrast
        seen = self._air.seen(ground.distance)
        mirror = self._mirrored(np.degrees(np.arctan2(np.float32(ground.camera.z), ground.distance)), seen)
        if mirror is not None:
            rows = np.flatnonzero((mirror > LEAST_MIRRORED).any(axis=1))
            mirror = mirror[: rows[-1] + 1] if len(rows) else None
        spare = [np.empty_like(seen) for _ in range(5)]
        self.even = _lit(ground.footprint, light.at(ground.x, ground.y) * seen, mirror, spare)
        wet = np.where(_SOFT, 1.0 - _SOFT_WHEN_WET * look.wet, 1.0 - _HARD_WHEN_WET * look.wet)
        self._palette = _packed(_ALBEDO * wet[:, None] * look.tint).view(np.uint8).reshape(-1, 4)
        self._palette[:, HARD] = np.where(_SOFT, 0, 255)
        self.paint = _packed(_PAINT * look.tint)
        veil = self._air.colour * (1.0 - self._air.seen(ground.lens.distance))[..., None]
        self.veil = np.zeros((*veil.shape[:2], 4), np.uint8)
        self.veil[..., :3] = np.rint(veil)

    def _mirrored(self, depression: Table, seen: Table) -> Table | None:
        """Return the share of the light that ground reflects; None if it is dry.

        Args:
            depression: Angle between the line of sight and the ground, degrees; the array is used for the result.
            seen: Share of the ground that is visible through the air.
        """
        wet = self._light.look.wet
        if wet <= LEAST_WATER:
            return None
        share = np.negative(depression, out=depression)
        share /= np.float32(2.6)
        np.exp(share, out=share)
        for factor in (np.float32(0.75), np.float32(wet), seen):
            share *= factor
        return share

    def add_veil(self, image: Image, traced: Traced, uneven: Image | None) -> None:
        """Add the light of the air before the ground to an image (height, width, 4), in place.

        Args:
            image: The image.
            traced: The ground.
            uneven: The light before uneven ground (see `Shaded.veil`).
        """
        first = traced.top
        if uneven is not None:
            first += len(uneven)
            cv2.add(image[traced.top : first], uneven, image[traced.top : first])
        if first < len(image):
            cv2.add(image[first:], self.veil[len(self.veil) - len(image) + first :], image[first:])

    def palette(self, traced: Traced) -> Image:
        """Return for each id its colour in full light, and 255 for hard ground, (K + FIRST, 4)."""
        return self._palette[traced.material]

    def uneven(self, far: Far, rows: int) -> tuple[Lit, Image]:
        """Return the tables of uneven ground, and the light of the air before it, (rows, width, 4)."""
        count, look = len(far.depth), self._light.look
        light, seen, angle, *spare = (
            self._buffers.get(f"uneven {k}", self._shape, np.float32)[:count] for k in range(8)
        )
        self._air.seen(far.distance, seen)
        np.multiply(seen, self._light.at(*far.level()) if self._light.lamps else np.float32(look.luminance), out=light)
        mirror = self._mirrored(far.depression(angle), seen) if look.wet > LEAST_WATER else None
        return _lit(far.footprint, light, mirror, spare), self._veil(seen, rows)

    def _veil(self, seen: Table, rows: int) -> Image:
        """Return the light of the air before ground of which these shares are visible, (rows, width, 4)."""
        veil = self._buffers.get("veil", (*self._shape, 4), np.uint8)[: len(seen)]
        tone = self._buffers.get("tone", self._shape, np.uint8)[: len(seen)]
        for channel, most in enumerate(self._air.colour.tolist()):
            cv2.insertChannel(cv2.convertScaleAbs(seen, tone, -most, most), veil, channel)
        if veil.shape[1] < self._width:
            veil = np.asarray(cv2.resize(veil, (self._width, rows)), np.uint8)
        return veil

    def light_up(self, part: slice, texture: Image, hard: Image, lit: Lit) -> int:
        """Determine how bright part of the ground is and what it reflects; return how many rows reflect.

        Args:
            part: Its rows, in steps of pixels.
            texture: The texture of all rows.
            hard: All rows, 255 where the ground is hard.
            lit: The tables of the part.
        """
        road, meadow, spare = (
            self._buffers.get(name, self._shape, np.float32)[part] for name in ("road", "meadow", "whole")
        )
        channel, patch = (self._buffers.get(name, self._shape, np.uint8)[part] for name in ("brightness", "patch"))
        texture, hard = texture[part], hard[part]
        a, b, rest = lit.road
        cv2.multiply(cv2.extractChannel(texture, GRAIN, channel), a, road, dtype=cv2.CV_32F)
        cv2.extractChannel(texture, PATCH, patch)
        road += np.asarray(cv2.multiply(patch, b, spare, dtype=cv2.CV_32F), np.float32)
        road += rest
        c, base = lit.meadow
        cv2.multiply(cv2.extractChannel(texture, GRASS, channel), c, meadow, dtype=cv2.CV_32F)
        meadow += base
        cv2.copyTo(road, hard, meadow)
        rows = 0 if lit.mirror is None else len(lit.mirror)
        if lit.mirror is not None:
            mirror, rest = road[:rows], spare[:rows]
            mirror.fill(_MEADOW_MIRRORS)
            cv2.copyTo(cv2.LUT(patch[:rows], _PUDDLES), hard[:rows], mirror)
            mirror *= lit.mirror
            meadow[:rows] *= np.subtract(np.float32(1.0), mirror, out=rest)
        cv2.convertScaleAbs(meadow, channel)
        return rows

    def gain(self, count: int) -> Image:
        """Return the brightness of `count` rows after `light_up`, 128 for that of their colour."""
        return self._buffers.get("brightness", self._shape, np.uint8)[:count]

    def mirror(self, count: int) -> Table:
        """Return the share of light that the first `count` rows reflect, after `light_up`."""
        return self._buffers.get("road", self._shape, np.float32)[:count]


def _visible(footprint: Table, finest: float, most: float, into: Table | None = None) -> Table:
    """Return how much of a texture is visible where pixels have some length on the ground, m.

    Args:
        footprint: The length.
        finest: Length of a pixel from which on it disappears, m; it has gone when pixels are a tenth longer.
        most: Result for the shortest pixels.
        into: Where to write it.
    """
    share = np.divide(footprint, np.float32(finest), out=into)
    np.subtract(np.float32(1.1), share, out=share)
    np.clip(share, 0, 1, out=share)
    return np.multiply(np.float32(most), share, out=share)


def _lit(footprint: Table, light: Table, mirror: Table | None, spare: Sequence[Table]) -> Lit:
    """Return the tables of ground in some light, of which the air has taken its share, in five spare arrays."""
    one = np.float32(128.0)
    grain, patch, rest, grass, base = spare
    _visible(footprint, GRAIN_GONE, GRAIN_SEEN, grain)
    _visible(footprint, PATCH_GONE, 1.0, patch)
    np.multiply(np.float32(0.576), patch, out=grass)
    patch *= np.float32(0.384)
    np.subtract(one, np.multiply(one, np.add(grain, patch, out=rest), out=rest), out=rest)
    np.subtract(one, np.multiply(one, grass, out=base), out=base)
    for table in spare:
        table *= light
    return Lit(footprint, light, (grain, patch, rest), (grass, base), mirror)


def _first_row(surfaces: Seen) -> int:
    """Return the first row of the image that a surface reaches, before the image's first row too."""
    rows = [int(surfaces.shapes[k][:, 1].min()) for k in np.flatnonzero(~surfaces.whole).tolist()]
    whole = surfaces.pixels[1][:, surfaces.whole]
    if whole.size:
        rows.append(int(np.rint(whole.min() * (1 << SUBPIXEL))))
    return min(rows) >> SUBPIXEL


def bare_plane(view: View) -> Floats:
    """Return the coefficients (3,) of 1 / depth of the plane that the vehicle stands on."""
    up = view.rotation @ vehicle_axes(view.pose)[:, 2]
    return np.asarray(-up / max(view.camera.z, 1e-3))


def hidden(traced: Traced, points: Floats) -> NDArray[np.bool_]:
    """Return which things the ground hides: those with a surface in front of at least half of their corners.

    Args:
        traced: The ground.
        points: (3, N, K) corners of K things, camera axes.
    """
    camera, ids = traced.view.camera, traced.ids
    depth = np.maximum(points[2], 1e-3)
    x, y = points[0] / depth, points[1] / depth
    u = np.rint(np.clip(x * camera.focal + camera.width / 2.0, -1, camera.width)).astype(np.int64)
    v = np.rint(np.clip(y * camera.focal + camera.height / 2.0, -1, camera.height)).astype(np.int64)
    inside = (u >= 0) & (u < camera.width) & (v >= 0) & (v < camera.height) & (points[2] > 0.0)
    there = np.where(inside, ids[np.where(inside, v, 0), np.where(inside, u, 0)], SKY).astype(np.int64)
    inside &= (there >= FIRST) & (there < FIRST + len(traced.surfaces.index))
    a, b, c = traced.planes.T[:, np.where(inside, there, SKY)]
    in_front = inside & ((a * x + b * y + c) * (depth - HIDDEN_MARGIN) > HIDDEN_SHARE)
    return np.asarray(2 * in_front.sum(axis=0) >= len(depth))


def _from_far(view: View, surfaces: Seen, layer: NDArray[np.uint8]) -> tuple[Seen, NDArray[np.bool_]]:
    """Return the surfaces in drawing order, and which of them show their underside.

    A level surface below the eye is covered only by higher ones, one above it by lower ones, because a falling line of
    sight meets the higher one first. So the height difference to the eye determines the order. A surface below the eye
    that shows its underside is the far side of a crest, which hides it.
    """
    height, from_below = view.rotation[:, 2] @ surfaces.middle, facing(surfaces.points)
    order = np.argsort(LAYER_LIFT * layer - np.abs(height), kind="stable")
    order = order[~(from_below & (height < 0.0))[order]]
    return surfaces.only(order), from_below[order]


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
    rows = np.arange(len(strip), dtype=np.int16)[:, None]
    last = np.maximum.accumulate(np.where(solid, rows, np.int16(-1)), axis=0)
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
