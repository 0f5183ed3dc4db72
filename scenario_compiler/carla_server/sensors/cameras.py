"""Cameras for colours, depth, normals, semantic and instance images, drawn by our own renderer."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from scenario_compiler.carla_server.actors import Body, Car, Sensor, channels_of
from scenario_compiler.carla_server.shared_camera import SEED, SharedCamera
from scenario_compiler.carla_server.stage import Stage
from scenario_compiler.carla_server.traffic_lights import GREEN, RED, YELLOW
from scenario_compiler.frames import pose_from_carla
from scenario_compiler.perception.camera import Camera
from scenario_compiler.perception.labels import FARTHEST_DEPTH
from scenario_compiler.perception.models import Lamp
from scenario_compiler.perception.render import Drawing, opaque
from scenario_compiler.perception.road_camera import RoadCamera
from scenario_compiler.perception.solids import Box
from scenario_compiler.perception.strokes import Stroke
from scenario_compiler.roads import Pose
from scenario_compiler.vocabulary.weather import Weather

Image = NDArray[np.uint8]

IMAGE = struct.Struct("<IIf")
"""Width, height and field of view, before the pixels."""

CLOSE = 0.3
"""Distance outside its carrier's box up to which a camera does not see its carrier, m."""

MIRRORED = np.array([1.0, -1.0, 1.0], np.float32)
"""Factors that turn a vector in OpenDRIVE's axes into one in CARLA's."""

DEPTH_STEPS = (1 << 24) - 1
"""Steps of the depth that three bytes hold, from 0 to 1000 m."""

LAMPS = {1: Lamp.AUTOMATIC, 2: Lamp.LOW_BEAM, 4: Lamp.HIGH_BEAM, 8: Lamp.BRAKE}
"""Lamps by the bits of CARLA's light state: position, low beam, high beam, brake."""

SHOWN = {RED: "red", YELLOW: "yellow", GREEN: "green"}


class CameraInstrument:
    """Base class of cameras; the drawing is prepared for each mounting."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Read its attributes."""
        self.width, self.height = (int(sensor.number(f"image_size_{axis}")) for axis in "xy")
        self.fov = sensor.number("fov")
        self.town = stage.town
        self._camera: SharedCamera | None = None
        self._mounted: tuple[float, ...] = ()
        self._first = self._mounting(stage, sensor)
        self._carrier = sensor.parent

    def prepare(self) -> None:
        """Make the map's scene and the renderer."""
        _, mounting, center = self._first
        self._mount(mounting, center)

    def _mount(self, mounting: tuple[float, ...], center: float) -> SharedCamera:
        """Return the camera for a mounting: x, y, z, yaw, pitch, roll relative to what carries it."""
        if self._camera is None or mounting != self._mounted:
            x, y, z, yaw, pitch, roll = mounting
            fov = math.radians(self.fov)
            camera = Camera(self.width, self.height, fov, x, y, z, yaw, pitch, roll, windscreen=False)
            self._camera = self.town.camera(camera, self._carrier, center)
            self._mounted = mounting
        return self._camera

    def _mounting(self, stage: Stage, sensor: Sensor) -> tuple[Pose, tuple[float, ...], float]:
        """Return the carrier's pose, the camera's mounting there, and the distance from it to the mount's origin."""
        parent = stage.actors.get(sensor.parent)
        if isinstance(parent, Body) and sensor.relative is not None:
            x, y, z, pitch, yaw, roll = sensor.relative
            turned = (-math.radians(yaw), math.radians(pitch), math.radians(roll))
            return stage.pose_of(parent), (x, -y, z + parent.up, *turned), parent.shape.center
        at = stage.transform_of(sensor)
        placed = pose_from_carla(at)
        ground = stage.town.ground_at(placed.x, placed.y)
        below = 0.0 if ground is None else ground.z
        pose = Pose(placed.x, placed.y, below, placed.heading, 0.0, 0.0)
        height = round(placed.z - below, 3)
        return pose, (0.0, 0.0, height, 0.0, -placed.pitch, placed.roll), 0.0

    def draw(self, stage: Stage, sensor: Sensor, frame: int, weather: Weather) -> Drawing:
        """Return the drawing of a frame; sensors at the same mount share it."""
        pose, mounting, center = self._mounting(stage, sensor)
        without = sensor.parent if self._is_inside(stage, sensor) else 0

        def draw(camera: RoadCamera) -> Drawing:
            return camera.draw(pose, boxes_of(stage, without), weather, signals_of(stage))

        return self._mount(mounting, center).see((frame, pose, without), draw)

    def message(self, pixels: NDArray[np.generic]) -> bytes:
        """Return the body of a message: width, height and field of view, then the pixels."""
        return b"".join((IMAGE.pack(self.width, self.height, self.fov), np.ascontiguousarray(pixels).data))

    @staticmethod
    def _is_inside(stage: Stage, sensor: Sensor) -> bool:
        """Return whether the camera is in or close to its carrier's box; it then does not see the carrier."""
        parent = stage.actors.get(sensor.parent)
        if not isinstance(parent, Body) or sensor.relative is None:
            return False
        x, y, z, *_ = sensor.relative
        length, width, height = parent.box
        return abs(x) < length + CLOSE and abs(y) < width + CLOSE and -CLOSE < z + parent.up < 2.0 * height + CLOSE


class ImageCamera(CameraInstrument):
    """A camera whose image shows one instant."""

    def __init__(self, stage: Stage, sensor: Sensor) -> None:
        """Choose the encoding of its pixels; see `CameraInstrument`."""
        super().__init__(stage, sensor)
        self._encode = ENCODINGS[sensor.blueprint.name]

    def measure(self, stage: Stage, sensor: Sensor, frame: int, dt: float, weather: Weather) -> bytes:
        """Draw the image."""
        del dt
        return self.message(self._encode(self.draw(stage, sensor, frame, weather), frame, stage.shapes.at(stage.time)))


def boxes_of(stage: Stage, without: int) -> list[Box]:
    """Return every body except one as the renderer draws it."""
    boxes = []
    for body in stage.bodies():
        if body.id == without:
            continue
        pose, shape = stage.pose_of(body), body.shape
        level = math.cos(pose.pitch) * shape.center
        braking = False
        lamps = Lamp.AUTOMATIC
        if isinstance(body, Car):
            braking = body.control[2] > 0.0
            for bit, lamp in LAMPS.items():
                lamps |= lamp if body.lights & bit else Lamp.NONE
        boxes.append(
            Box(
                pose.x + level * math.cos(pose.heading),
                pose.y + level * math.sin(pose.heading),
                pose.z - math.sin(pose.pitch) * shape.center,
                pose.heading,
                shape.length,
                shape.width,
                shape.height,
                _colour_of(body),
                shape.category,
                pose.pitch,
                pose.roll,
                lamps | Lamp.BRAKE if braking else lamps,
                body.id,
                body.tag,
            )
        )
    return boxes


def signals_of(stage: Stage) -> Mapping[str, str]:
    """Return the state of each traffic light."""
    return {
        light.signal: SHOWN[light.state] for group in stage.groups for light in group.lights if light.state in SHOWN
    }


def _colour_of(body: Body) -> tuple[int, int, int]:
    """Return a body's colour (blue, green, red): that of its attribute, otherwise one that depends on its id."""
    given = channels_of(body.attributes.get("color", ""))
    if given is not None:
        red, green, blue = given
        return blue, green, red
    mixed = zlib.crc32(str(body.id).encode())
    return 60 + mixed % 160, 60 + mixed // 256 % 160, 60 + mixed // 65536 % 160


def _of_words(words: NDArray[np.uint32]) -> Image:
    """Return an image whose red, green and blue are the lowest, the middle and the highest byte of 24 bits a pixel."""
    turned = (words.byteswap() >> np.uint32(8) | np.uint32(0xFF000000)).astype("<u4", copy=False)
    return turned.view(np.uint8).reshape(*words.shape, 4)


def colours(drawing: Drawing, frame: int, strokes: Sequence[Stroke]) -> Image:
    """Return the picture, (height, width, 4), BGRA, with what clients have drawn into the world."""
    return opaque(drawing.image(SEED, frame, strokes))


def depth(drawing: Drawing, frame: int, strokes: Sequence[Stroke]) -> Image:
    """Return the depth: R + 256 G + 65536 B of 2^24 - 1 steps up to 1000 m, as CARLA encodes it."""
    del frame, strokes
    return _of_words((drawing.depth.astype(np.float64) * (DEPTH_STEPS / FARTHEST_DEPTH)).astype(np.uint32))


def kinds(drawing: Drawing, frame: int, strokes: Sequence[Stroke]) -> Image:
    """Return the semantic tag in the red channel."""
    del frame, strokes
    return _of_words(drawing.semantic.astype(np.uint32))


def instances(drawing: Drawing, frame: int, strokes: Sequence[Stroke]) -> Image:
    """Return the semantic tag in the red channel and the thing's number in green (low) and blue (high)."""
    del frame, strokes
    return _of_words((drawing.instance << 8 | drawing.semantic).astype(np.uint32))


def normals(drawing: Drawing, frame: int, strokes: Sequence[Stroke]) -> Image:
    """Return the surfaces' normals in CARLA's axes of the world: red, green, blue are x, y, z, 0 to 255 for -1 to 1.

    That is how Unreal shows the normals of the world. CARLA's own material is a binary asset; whether it has the same
    axes is not verified.
    """
    del frame, strokes
    scaled = np.rint((drawing.normals * MIRRORED + np.float32(1.0)) * np.float32(127.5))
    return opaque(scaled[..., ::-1].astype(np.uint8))


ENCODINGS: dict[str, Callable[[Drawing, int, Sequence[Stroke]], Image]] = {
    "sensor.camera.rgb": colours,
    "sensor.camera.depth": depth,
    "sensor.camera.normals": normals,
    "sensor.camera.semantic_segmentation": kinds,
    "sensor.camera.instance_segmentation": instances,
}
