"""Pictures of one moment: how weather looks, what cameras see that look elsewhere, and what is seen in each pixel.

`python examples/camera.py [FOLDER]` writes three pictures; those of the documentation are made by it.
"""

from __future__ import annotations

import math
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from scenario_compiler import Weather, find_map, load_network, weather_preset
from scenario_compiler.perception import (
    FARTHEST_DEPTH,
    Box,
    Camera,
    Drawing,
    Kind,
    Lamp,
    RoadCamera,
    Tag,
    scene_of,
)

FRONT = Camera(width=480, height=270, fov=math.radians(80.0), x=0.3, z=1.35, pitch=math.radians(-4.0))
CAMERAS = {
    "front": FRONT,
    "left": replace(FRONT, x=0.0, y=0.9, z=1.1, yaw=math.radians(90.0), pitch=math.radians(-8.0)),
    "rear": replace(FRONT, x=-1.8, yaw=math.pi, pitch=math.radians(-6.0)),
    "behind": replace(FRONT, x=-8.0, z=3.2, pitch=math.radians(-12.0), windscreen=False),
    "above": replace(FRONT, x=2.0, z=26.0, pitch=math.radians(-90.0), windscreen=False),
    "rolled": replace(FRONT, yaw=math.radians(-20.0), roll=math.radians(15.0)),
}
Placed = tuple[Kind, int, float, float, tuple[float, float, float], tuple[int, int, int]]
TRAFFIC: tuple[Placed, ...] = (
    ("car", -1, 0.0, 0.0, (4.2, 1.83, 1.38), (40, 120, 60)),
    ("car", -1, 14.0, 0.1, (4.4, 1.85, 1.45), (38, 38, 160)),
    ("truck", 1, 26.0, 0.0, (9.0, 2.5, 3.4), (150, 92, 40)),
    ("bicycle", -1, -9.0, -1.0, (1.8, 0.6, 1.7), (30, 140, 190)),
    ("van", 1, -14.0, 0.0, (5.4, 2.0, 2.3), (205, 205, 205)),
    ("pedestrian", 1, 3.0, 4.4, (0.5, 0.6, 1.75), (60, 60, 170)),
)
"""What is on the road, the ego first: kind, lane, m ahead and to the left, size, colour (blue, green, red)."""

QUALITY = (cv2.IMWRITE_JPEG_QUALITY, 88)

PRESETS = ("ClearNoon", "CloudyNoon", "HardRainNoon", "WetSunset", "HardRainSunset", "ClearNight")
COLOURS = {
    Tag.ROAD: (128, 64, 128), Tag.SIDEWALK: (232, 35, 244), Tag.TERRAIN: (152, 251, 152), Tag.SKY: (180, 130, 70),
    Tag.VEGETATION: (35, 142, 107), Tag.ROAD_LINE: (50, 234, 157), Tag.CAR: (142, 0, 0), Tag.TRUCK: (70, 0, 0),
    Tag.BICYCLE: (32, 11, 119), Tag.RIDER: (0, 0, 255), Tag.PEDESTRIAN: (60, 20, 220), Tag.STATIC: (160, 190, 110),
}  # fmt: skip
"""Colours of tags (blue, green, red), those of the Cityscapes data set and of CARLA."""


def preset(name: str) -> Weather:
    """Return one of CARLA's presets."""
    found = weather_preset(name)
    assert found is not None
    return found


def written(image: np.ndarray, text: str) -> np.ndarray:
    """Return an image with a word in its corner."""
    image = image.copy()
    for place, colour in (((9, 23), (0, 0, 0)), ((8, 22), (255, 255, 255))):
        cv2.putText(image, text, place, cv2.FONT_HERSHEY_SIMPLEX, 0.6, colour, 1, cv2.LINE_AA)
    return image


def montage(images: list[np.ndarray], columns: int) -> np.ndarray:
    """Return images of one size side by side, in rows."""
    return np.vstack([np.hstack(images[k : k + columns]) for k in range(0, len(images), columns)])


def coloured(drawing: Drawing) -> list[np.ndarray]:
    """Return depth, kinds and things as pictures."""
    near = 1.0 - np.log(drawing.depth) / math.log(FARTHEST_DEPTH)
    depth = cv2.applyColorMap((255.0 * np.clip(near, 0.0, 1.0)).astype(np.uint8), cv2.COLORMAP_TURBO)
    kinds = np.zeros((256, 3), np.uint8)
    for tag, colour in COLOURS.items():
        kinds[tag] = colour
    things = np.random.default_rng(6).integers(60, 256, (256, 3)).astype(np.uint8)
    things[0] = 0
    return [np.asarray(depth), kinds[drawing.semantic], things[drawing.instance & 255]]


def main(folder: Path) -> None:
    """Draw the pictures into a folder, which is made if it does not exist."""
    folder.mkdir(parents=True, exist_ok=True)
    network = load_network(find_map("town_grid"))
    scene = scene_of(network)
    pose = network.lane_pose("1", -1, 60.0)
    others = []
    for number, (kind, lane, ahead, across, size, colour) in enumerate(TRAFFIC, 1):
        at = network.lane_pose("1", lane, 60.0 + ahead, across)
        heading = at.heading + (math.pi if lane > 0 else 0.0)
        lamps = Lamp.AUTOMATIC | Lamp.BRAKE if number == 2 else Lamp.AUTOMATIC
        others.append(Box(at.x, at.y, at.z, heading, *size, colour, kind, lamps=lamps, instance=number))
    own, traffic = others[0], others[1:]
    camera = RoadCamera(scene, FRONT)
    weathers = [written(camera.frame(pose, traffic, preset(name), 0.0, 5), name) for name in PRESETS]
    cv2.imwrite(str(folder / "camera_weather.jpg"), montage(weathers, 3), QUALITY)
    views = []
    for name, mounting in CAMERAS.items():
        boxes = [own, *traffic] if name in {"behind", "above"} else traffic
        views.append(written(RoadCamera(scene, mounting).frame(pose, boxes, preset("ClearNoon"), 0.0, 5), name))
    cv2.imwrite(str(folder / "camera_views.jpg"), montage(views, 3), QUALITY)
    drawing = camera.draw(pose, traffic, preset("ClearNoon"))
    pictures = [drawing.image(seed=1, frame_index=5), *coloured(drawing)]
    cv2.imwrite(str(folder / "camera_labels.png"), montage(pictures, 2))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
