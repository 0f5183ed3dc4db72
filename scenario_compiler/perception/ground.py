"""The ground below the horizon: surfaces and paint drawn as quads, then one world-fixed texture over all of them.

The texture is laid on the plane that the vehicle's wheels stand on, so it is fixed to the world on flat and
on evenly graded roads, and slides a little, far ahead, where the grade changes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from scenario_compiler.perception.camera import Camera, View
from scenario_compiler.perception.scene import SUBPIXEL, Projected, RoadScene, project
from scenario_compiler.perception.textures import TEXEL, TILE, ground_tile
from scenario_compiler.perception.weather_look import Look
from scenario_compiler.roads.mesh import Material, Paint

Image = NDArray[np.uint8]

SURFACE_DISTANCE, MARK_DISTANCE = 220.0, 130.0
"""How far surfaces and marks are drawn, m; a mark 0.12 m wide covers half a pixel at 150 m."""

STOREY = 3.0
"""Height apart, m, from which a road counts as crossing over or under this one (clearances are 4 m and more)."""

SKY, DECK = 255, 254
"""Codes in the drawing of surfaces beside `Material`: nothing drawn, the underside of a road."""

_ALBEDO = {
    Material.VERGE: (58, 98, 82),
    Material.ASPHALT: (79, 80, 80),
    Material.SHOULDER: (72, 73, 75),
    Material.CONCRETE: (126, 131, 134),
    Material.GRASS: (60, 106, 86),
    Material.CYCLE: (76, 82, 122),
}
_PAINT = {
    Paint.WHITE: (227, 227, 227),
    Paint.YELLOW: (50, 172, 209),
    Paint.BLUE: (185, 110, 50),
    Paint.GREEN: (80, 160, 60),
    Paint.RED: (50, 50, 190),
    Paint.ORANGE: (40, 125, 225),
    Paint.VIOLET: (150, 60, 130),
    Paint.BLACK: (40, 40, 40),
}
_SOFT = np.array([Material.VERGE, Material.GRASS], np.uint8)


class Ground:
    """Draws the ground of one scene for one camera."""

    def __init__(self, scene: RoadScene, camera: Camera) -> None:
        """Prepare what depends on neither pose nor weather."""
        self.scene = scene
        self.camera = camera
        self.relief = scene.relief
        horizon = min(max(math.ceil(camera.horizon) + 1, 0), camera.height)
        self.top = 0 if self.relief else min(horizon, camera.height - 1)
        self.sky_rows = horizon - self.top
        x, y = camera.ground_coordinates(self.top)
        self.x, self.y = x.astype(np.float32), y.astype(np.float32)
        row_distance = self.x[:, :1]
        footprint = row_distance**2 / (camera.z * camera.focal)
        self.grain_gain = (0.384 * np.clip(1.1 - footprint / 0.12, 0, 1)).astype(np.float32)
        self.patch_gain = np.clip(1.1 - footprint / 1.5, 0, 1).astype(np.float32)
        self.wear_gain = np.clip(1.2 - footprint / 0.35, 0, 1).astype(np.float32)
        self.row_distance = row_distance
        albedo = np.zeros((256, 1, 3), np.uint8)
        for material, colour in _ALBEDO.items():
            albedo[material, 0] = colour
        albedo[DECK, 0] = (50, 52, 54)
        self.albedo = albedo
        self.hard = np.full(256, 255, np.uint8)
        self.hard[_SOFT] = 0
        self.paint = np.array([_PAINT[paint] for paint in Paint], np.float32)

    def draw(self, view: View, look: Look) -> tuple[Image, Image, Image]:
        """Return the ground before lighting, (rows, width, 3), from row `top` on.

        Returns:
            The image; the codes of what is seen, (rows, width), `Material`, SKY or DECK; the texture's
            patches, (rows, width).
        """
        codes = np.full(self.x.shape, Material.VERGE, np.uint8)
        codes[: self.sky_rows] = SKY
        paint = np.zeros((*self.x.shape, 2), np.uint8)
        colours = np.zeros(self.x.shape, np.uint8)
        self._draw_quads(view, codes, paint, colours)
        if self.relief:
            self._ground_below_hills(codes)
        if colours.any():
            colours = np.asarray(cv2.dilate(colours, np.ones((3, 3), np.uint8)), np.uint8)
        grain, wear, patch, grass = (np.asarray(c, np.uint8) for c in cv2.split(self._texture(view)))
        image = self._shade(codes, grain, patch, grass, look)
        self._apply_paint(image, paint, colours, grain, wear, look)
        return image, codes, patch

    def _draw_quads(self, view: View, codes: Image, paint: Image, colours: Image) -> None:
        scene = self.scene
        ground = project(view, scene.surface_grid, SURFACE_DISTANCE, self.top)
        lines = project(view, scene.mark_grid, MARK_DISTANCE, self.top)
        if not self.relief:
            self._fill(ground, np.arange(len(ground.index)), codes)
            self._mark(lines, np.arange(len(lines.index)), paint, colours)
            return
        bridge = ground.from_below & (ground.height > STOREY)
        for k in np.nonzero(bridge & (scene.material[ground.index] != Material.VERGE))[0].tolist():
            cv2.fillConvexPoly(codes, ground.polygons[k], DECK, cv2.LINE_8, SUBPIXEL)
        for below in (True, False):
            level = ~ground.from_below & ((ground.height < -STOREY) == below)
            self._fill(ground, np.nonzero(level)[0], codes, (paint, colours) if paint.any() else ())
            level = ~lines.from_below & ((lines.height < -STOREY) == below)
            self._mark(lines, np.nonzero(level)[0], paint, colours)

    def _ground_below_hills(self, codes: Image) -> None:
        """Turn sky below a piece of ground that rises over the horizon into ground; below a bridge it stays."""
        strip = codes[: self.sky_rows]
        solid = strip < DECK
        if solid.any():
            strip[np.logical_or.accumulate(solid, axis=0) & (strip == SKY)] = Material.VERGE

    def _fill(self, ground: Projected, chosen: NDArray[np.int64], codes: Image, covered: Sequence[Image] = ()) -> None:
        """Draw surfaces, the lower layers first; they cover paint that lies below them, on a road underneath."""
        index = ground.index[chosen]
        order = np.argsort(self.scene.layer[index], kind="stable")
        for k, material in zip(chosen[order].tolist(), self.scene.material[index[order]].tolist(), strict=True):
            cv2.fillConvexPoly(codes, ground.polygons[k], material, cv2.LINE_8, SUBPIXEL)
            for image in covered:
                cv2.fillConvexPoly(image, ground.polygons[k], (0, 0), cv2.LINE_8, SUBPIXEL)

    def _mark(self, lines: Projected, chosen: NDArray[np.int64], paint: Image, colours: Image) -> None:
        """Draw into `paint` coverage and coverage times quality, whose ratio is quality up to the rim."""
        marks = self.scene.marks
        index = lines.index[chosen]
        coverage = 255.0 * np.minimum(lines.thickness[chosen], 1.0)
        left = coverage * np.clip(marks.quality[index], 0.0, 1.0)
        tones = marks.colour[index]
        for k, full, part, tone in zip(chosen.tolist(), coverage.tolist(), left.tolist(), tones.tolist(), strict=True):
            if part < 2.0:
                continue
            polygon = lines.polygons[k]
            cv2.fillConvexPoly(paint, polygon, (full, part), cv2.LINE_AA, SUBPIXEL)
            if tone:
                cv2.fillConvexPoly(colours, polygon, tone, cv2.LINE_8, SUBPIXEL)

    def _texture(self, view: View) -> Image:
        heading = view.pose.heading
        cos, sin = math.cos(heading) / TEXEL, math.sin(heading) / TEXEL
        foot = view.foot - self.scene.origin
        x0, y0 = float(foot[0] / TEXEL % TILE), float(foot[1] / TEXEL % TILE)
        column = cv2.addWeighted(self.x, cos, self.y, -sin, x0)
        row = cv2.addWeighted(self.x, sin, self.y, cos, y0)
        tile = ground_tile()
        return np.asarray(cv2.remap(tile, column, row, cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP), np.uint8)

    def _shade(self, codes: Image, grain: Image, patch: Image, grass: Image, look: Look) -> Image:
        """Return albedo times texture; wet ground is darker."""
        hard, soft = 1.0 - 0.45 * look.wet, 1.0 - 0.15 * look.wet
        road = (grain.astype(np.float32) - 128.0) * (self.grain_gain * hard)
        road += (patch.astype(np.float32) - 128.0) * (self.patch_gain * (0.384 * hard))
        road += 128.0 * hard
        meadow = (grass.astype(np.float32) - 128.0) * (self.patch_gain * (0.576 * soft))
        meadow += 128.0 * soft
        cv2.copyTo(road, cv2.LUT(codes, self.hard), meadow)
        gain = cv2.convertScaleAbs(meadow)
        base = cv2.LUT(cv2.merge((codes, codes, codes)), self.albedo)
        return np.asarray(cv2.multiply(base, cv2.merge((gain, gain, gain)), scale=1.0 / 128.0), np.uint8)

    def _apply_paint(self, image: Image, paint: Image, colours: Image, grain: Image, wear: Image, look: Look) -> None:
        """Blend paint over the ground where there is any: it wears away in patches, as the wear texture says."""
        rows, columns = np.nonzero(paint[:, :, 0])
        if not len(rows):
            return
        coverage = paint[rows, columns, 0].astype(np.float32)
        quality = paint[rows, columns, 1] / coverage
        near = self.wear_gain[rows, 0]
        eroded = np.clip((quality * 1.12 - wear[rows, columns] / np.float32(255.0)) * 7.0 + 0.4, 0, 1)
        left = (eroded * near + quality * (1.0 - near)) * (0.45 + 0.55 * quality)
        alpha = (coverage / np.float32(255.0) * left * np.float32(look.contrast))[:, None]
        rough = 1.0 + (grain[rows, columns].astype(np.float32) - 128.0) * (0.0042 * self.grain_gain[rows, 0])
        target = self.paint[colours[rows, columns]] * rough[:, None]
        below = image[rows, columns].astype(np.float32)
        image[rows, columns] = np.clip(below + alpha * (target - below), 0, 255).astype(np.uint8)
